#!/usr/bin/python3
"""./zwang conformance --engines all|NAME,...: physics engines on phenomena with exact answers (docs/engines.md).

Every engine runs in a process of its own, by an adapter of adapters/; none is a part of zwang.
"""
import argparse
import concurrent.futures
import dataclasses
from fractions import Fraction as F
import json
import math
import os
import pathlib
import shlex
import shutil
import sys
import tempfile
import time

import page
import phenomena
from child import Child, Failure
from exact import Clock, travel
from mjcf import mjcf

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
NPM = ROOT / "build/engines"
STEPS = [F(1, 60), F(1, 120), F(1, 240), F(1, 1000)]
SETTINGS = ["default", "tuned"]
# Engine: the package it comes from, Debian's (an adapter in C++) or npm's (one in JavaScript).
DEBIAN = {"bullet": "libbullet-dev", "dart": "libdart-dev", "mujoco": "libmujoco-dev", "ode": "libode-dev", "simbody": "libsimbody-dev"}
PACKAGES = {"cannon-es": "cannon-es@0.20.0", "jolt": "jolt-physics@1.1.0", "mujoco-js": "@mujoco/mujoco@3.14.0", "physx": "physx-js-webidl@2.7.3",
            "rapier": "@dimforge/rapier3d-compat@0.21.0"}
# What scenes may hold and an engine may not have.
LACKING = {"coefficient of restitution": lambda scene: scene["restitution"] > 0, "driven bodies": lambda scene: any(b["motion"] == "driven" for b in scene["bodies"]),
           "boxes that touch each other": lambda scene: sum(b["shapes"][0]["kind"] == "box" for b in scene["bodies"]) > 1}


@dataclasses.dataclass(frozen=True)
class Engine:
    name: str
    command: tuple  # nothing where it is absent
    how: str        # to add it; nothing where it is the caller's own


def known(programs):
    """The engines that have adapters here, in the order of the map."""
    for name, package in DEBIAN.items():
        program = programs.resolve() / f"zwang_engine_{name}"
        yield Engine(name, (str(program),) if program.exists() else (), f"apt-get install {package}")
    for name, package in PACKAGES.items():
        there = (NPM / "node_modules" / package.rpartition("@")[0] / "package.json").exists() and shutil.which("node")
        yield Engine(name, ("node", str(HERE / f"adapters/{name}.mjs")) if there else (), f"npm install --prefix build/engines {package}")


def plain(scene, dt):
    """The scene as an engine gets it: fractions as numbers."""
    def number(x):
        if isinstance(x, dict):
            return {key: number(value) for key, value in x.items()}
        if isinstance(x, (list, tuple)):
            return [number(value) for value in x]
        return float(x) if isinstance(x, F) else x
    return number({**scene, "dt": dt})


def start(engine, deadline):
    child = Child(engine.command, {"ZWANG_ENGINES": str(NPM)}, deadline, apart=engine.how != "")
    said = child.hello
    substeps = said.get("substeps")
    if (not all(isinstance(said.get(key), str) for key in ("engine", "version", "licence")) or said.get("bits") not in (32, 64) or
            said.get("order") not in (-1, 0, 1) or not isinstance(substeps, dict) or
            not all(isinstance(substeps.get(s), int) and substeps[s] > 0 for s in SETTINGS) or not set(said.get("lacks", ())) <= set(LACKING)):
        child.close()
        raise Failure("a first line that is not the protocol's")
    try:
        child.doubts = {setting: disbelief(child, setting) for setting in SETTINGS}
    except Failure:
        child.close()
        raise
    return child


class Children:
    """An engine's processes. One serves many scenes, for most engines of npm take longer to start than to answer."""

    def __init__(self, engine, deadline):
        self.engine, self.deadline, self.idle, self.hello, self.never = engine, deadline, [], None, None

    def take(self):
        if self.never:  # it has never started: all its cells say why
            raise Failure(self.never)
        try:
            child = self.idle.pop() if self.idle else start(self.engine, self.deadline)
        except Failure as failure:
            self.never = None if self.hello else str(failure)
            raise
        self.hello = child.hello
        child.allow(self.deadline)
        return child

    def give(self, child):
        if child.hello.get("alone"):
            child.close()
        else:
            self.idle.append(child)

    def close(self):
        while self.idle:
            self.idle.pop().close()


def clock_of(hello, setting, dt):
    return Clock(dt / hello["substeps"][setting], hello["order"])


def checked(answer, bodies):
    states = answer.get("states")
    if not isinstance(states, list) or len(states) != bodies or any(not isinstance(state, list) or len(state) != 13 for state in states):
        raise Failure("an answer that is not the protocol's", lost=False)
    if not all(isinstance(x, (int, float)) and math.isfinite(x) for state in states for x in state):
        raise Failure("an answer that is no number", lost=False)
    return states


def run(child, scene, setting, dt, samples, steps):
    """The states at the start and after each of `samples` times `steps` steps."""
    for what in child.hello.get("lacks", ()):
        if LACKING[what](scene):
            raise Failure(f"has no {what}", lost=False)
    text = plain(scene, dt)
    if child.hello.get("mjcf"):
        text["mjcf"] = mjcf(text, setting)
    states = [checked(child.ask({"scene": text, "setting": setting}), len(scene["bodies"]))]
    for _ in range(samples):
        states.append(checked(child.ask({"step": steps}), len(scene["bodies"])))
    return states


def disbelief(child, setting):
    """Why an adapter is not believed: one step of free fall, which has to be exact to the engine's precision; None where it is."""
    for dt in STEPS:
        scene = phenomena.scene([phenomena.ball(F(1, 10), (0, 0, 1), velocity=(1, 0, 2), spin=(0, 0, 1))])
        clock = clock_of(child.hello, setting, dt)
        end = run(child, scene, setting, dt, 1, 1)[-1][0]
        due = {0: dt, 1: 0, 2: 1 + travel(F(2), -phenomena.G, dt, clock), 7: 1, 8: 0, 9: 2 - phenomena.G * dt, 10: 0, 11: 0, 12: 1}
        for place, exact in due.items():
            # A rounding of each sum, of numbers below 4, in each of its steps.
            if not abs(end[place] - float(exact)) <= 4 * 2.0 ** (-53 if child.hello["bits"] == 64 else -24) * (1 + child.hello["substeps"][setting]):
                return f"one step of free fall is off by {end[place] - float(exact):.3g} in place {place}, dt {dt}"
    return None


def cells_of(children, setting, phenomenon):
    """What the engine makes of one phenomenon in each step: its cells, and its motion in the largest step."""
    cells, motion, late = {}, None, None
    for dt in STEPS:
        child = None
        try:
            if late:
                raise Failure(f"{late} in larger steps, and its own steps are what takes it long")
            child = children.take()
            if child.doubts[setting]:
                raise Failure(f"not believed: {child.doubts[setting]}", lost=False)
            steps = max(1, round(phenomenon.every / dt))
            states = run(child, phenomenon.scene, setting, dt, round(phenomenon.seconds / dt) // steps, steps)
            measured, exact = phenomenon.measure(states, phenomenon.scene), float(phenomenon.exact(clock_of(child.hello, setting, dt)))
            cells[str(dt)] = {"off": measured - exact, "measured": measured, "exact": exact}
            if dt == STEPS[0]:
                motion = picture(phenomenon, states)
        except Failure as failure:
            cells[str(dt)] = {"why": str(failure)}
            if failure.lost:
                late = late or (str(failure) if failure.late and child and child.hello["order"] == 0 else None)
                continue
        children.give(child)
    return cells, motion


def picture(phenomenon, states):
    """What the page draws of a run: poses at the start and the end, the ways between, and how the measured number came about."""
    few = states[:-1:max(1, len(states) // 40)] + states[-1:]
    return {"curve": [float(f"{phenomenon.measure(few[:k + 1], phenomenon.scene):.5g}") for k in range(len(few))],
            "ways": [[[round(x, 4) for x in sample[b][:3]] for sample in few] for b in range(len(few[0]))],
            "poses": [[[round(x, 4) for x in state[:7]] for state in sample] for sample in (few[0], few[-1])]}


def whole_run(engines, chosen, deadline, say, backwards=False):
    """{engine: {setting: {phenomenon: {step: cell}}}}, and of each engine what it said of itself, and its motions.

    Backwards: each process sees other scenes before a cell, which an engine may remember.
    """
    longest = sorted(chosen, key=lambda p: p.seconds, reverse=not backwards)
    all_of = {e.name: Children(e, deadline) for e in engines}
    jobs = [(all_of[e.name], s, p) for e in engines for p in longest for s in SETTINGS]
    cells = {e.name: {s: {} for s in SETTINGS} for e in engines}
    motions, left = {}, dict.fromkeys(cells, 2 * len(chosen))
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        ahead = {pool.submit(cells_of, *job): job for job in jobs}
        for count, done in enumerate(concurrent.futures.as_completed(ahead), 1):
            children, setting, phenomenon = ahead[done]
            name = children.engine.name
            cells[name][setting][phenomenon.name], motion = done.result()
            motions.setdefault(phenomenon.name, {})[f"{name} {setting}"] = motion
            left[name] -= 1
            if not left[name]:
                children.close()
            say(count, len(jobs), f"{name}   {phenomenon.name}")
    for name in cells:  # the same order whoever came first
        for setting in SETTINGS:
            cells[name][setting] = {p.name: cells[name][setting][p.name] for p in chosen}
    return cells, {name: children.hello for name, children in all_of.items()}, {p.name: dict(sorted(motions[p.name].items())) for p in chosen}


def show(count, all_of_them, what):
    if sys.stderr.isatty():
        print(f"\r{count} of {all_of_them}: {what}\033[K", end="\n" if count == all_of_them else "", file=sys.stderr)
    elif count < all_of_them and count * 10 // all_of_them > (count - 1) * 10 // all_of_them:
        print(f"{count} of {all_of_them}: {what}", file=sys.stderr, flush=True)


def wrong_use(line):
    print(line, file=sys.stderr)
    sys.exit(2)


def split(text, names, what):
    if text == "all":
        return list(names)
    chosen = text.split(",")
    for name in chosen:
        if name not in names:
            wrong_use(f"no {what} '{name}': {', '.join(names)}, or all")
    return chosen


def options(words):
    class Parser(argparse.ArgumentParser):
        def error(self, message):
            wrong_use(f"{message} (./zwang conformance --engines --help lists the options)")
    parser = Parser(prog="./zwang conformance --engines", allow_abbrev=False, description="Physics engines on phenomena with exact answers: a map "
                    "of what each is off by. None of them is a part of zwang; those that are not here are listed with how to add them.")
    parser.add_argument("--engines", required=True, metavar="all|NAME,...", help="engines of the list, and those of --adapter")
    parser.add_argument("--phenomena", default="all", metavar="all|NAME,...", help="default: all")
    parser.add_argument("--adapter", action="append", default=[], metavar="NAME=COMMAND", help="another engine: a program that speaks the protocol")
    parser.add_argument("--deadline", type=float, default=20, metavar="S", help="seconds for each cell; default: 20")
    parser.add_argument("--twice", action="store_true", help="run all of it twice, in another order the second time, and name the engines whose numbers differ")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("engines"), help="folder of the page and its numbers; default: engines")
    parser.add_argument("--programs", type=pathlib.Path, default=ROOT / "build/release/bin", help=argparse.SUPPRESS)
    if {"-h", "--help"} & set(words):  # whatever else stands there
        words = ["--help"]
    return parser.parse_args(words)


def differing(first, second):
    """The engines some of whose numbers are not the same, with a cell of each."""
    found = {}
    for engine, settings in first.items():
        for setting, of in settings.items():
            for name, cells in of.items():
                for step, cell in cells.items():
                    if cell.get("measured") != second[engine][setting][name][step].get("measured"):  # why there is none may have addresses in it
                        found.setdefault(engine, f"{name}, {setting}, {step} s")
    return found


def main(words):
    wanted = options(words)
    engines = {e.name: e for e in known(wanted.programs)}
    for text in wanted.adapter:
        name, equals, command = text.partition("=")
        if not equals or not command:
            wrong_use(f"--adapter '{text}': expected NAME=COMMAND")
        engines[name] = Engine(name, tuple(shlex.split(command)), "")
    names = split(wanted.engines, engines, "engine")
    chosen = [phenomena.ALL[name] for name in split(wanted.phenomena, phenomena.ALL, "phenomenon")]
    if not wanted.deadline > 0:
        wrong_use(f"--deadline {wanted.deadline:g}: expected seconds above 0")
    here, absent = [engines[n] for n in names if engines[n].command], [engines[n] for n in names if not engines[n].command]
    for engine in absent:
        print(f"{engine.name}: not here; {engine.how}")
    if not here:
        wrong_use("no engine is here")
    # A place that cannot be written is said before minutes are spent.
    wanted.out.mkdir(parents=True, exist_ok=True)
    tempfile.TemporaryFile(dir=wanted.out).close()
    began = time.monotonic()
    cells, about, motions = whole_run(here, chosen, wanted.deadline, show)
    others = None
    if wanted.twice:
        others = differing(cells, whole_run(here, chosen, wanted.deadline, show, backwards=True)[0])
    numbers = {"steps": [str(dt) for dt in STEPS], "engines": about, "absent": {e.name: e.how for e in absent}, "differ": others, "cells": cells}
    (wanted.out / "results.json").write_text(json.dumps(numbers, indent=1) + "\n")
    (wanted.out / "index.html").write_text(page.html(numbers, motions, chosen, HERE, ROOT))
    for name, settings in cells.items():
        for setting, of in settings.items():
            every = [cell for steps in of.values() for cell in steps.values()]
            print(f"{name:10} {setting:8} {sum('off' in cell for cell in every)} of {len(every)} cells answered")
    if others is not None:
        print("The same numbers twice" if not others else "Not the same twice: " + "; ".join(f"{e} ({where})" for e, where in others.items()))
    print(f"{wanted.out / 'index.html'}, after {time.monotonic() - began:.0f} s")
    return 0


if __name__ == "__main__":
    sys.path.append(str(ROOT / "bench/program"))
    from held import end_by
    end_by(main, sys.argv[1:])
