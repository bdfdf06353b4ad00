"""`./zwang bench --suite collision`: pair queries by triangle count and gap, and a hand in every scene. docs/collision.md.

The program holds this text (held.py), and is asked for each study, a line of JSON (experiments/program/collision_suite.cpp); all
of them are left in DIR/collision.json after every one.
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import time

STOPPED = 130
PAIRS = [(triangles, gap, motion) for triangles in (1000, 10000, 100000, 1000000)
         for gap, motion in ((2e-4, "sliding"), (2e-4, "pressing"), (2e-3, "passing"))]
# How the hands of a scene are run, one after the other.
RUNS = {"frames": "", "audits": ": audit", "audits_with_friction": ": audit with friction"}


class Suite:
    def __init__(self, conditions, program, directory, command):
        self.program, self.file, self.begin, self.tenths = program, os.path.join(directory, "collision.json"), time.monotonic(), 0
        self.results = {"suite": "collision", "command": command, "conditions": json.loads(conditions), "pairs": [], **{key: [] for key in RUNS}}
        self.lines, self.interrupted, self.finished, self.steps = [], False, 0, len(PAIRS)
        os.makedirs(directory, exist_ok=True)

    def ask(self, *words):
        """The program's lines, one after the other; a study that has begun is finished."""
        with subprocess.Popen([self.program, "experiment", *words], stdout=subprocess.PIPE, encoding="utf-8") as answering:
            try:
                yield from map(json.loads, answering.stdout)
            finally:
                answering.terminate()  # of one that is heard to its end nothing is left
        if answering.returncode and not self.interrupted:
            sys.exit(answering.returncode)

    def show(self, what):
        """One line that is redrawn on a terminal, a plain line every 10 % elsewhere. Called before each step."""
        done, spent = self.finished / self.steps, time.monotonic() - self.begin
        left = spent * (1 - done) / done if done > 0.05 else 0
        rest = f"{round(left / 60)} min left" if left > 90 else f"{max(1, round(left))} s left" if left else ""
        if sys.stderr.isatty():
            text = f"{int(100 * done):3} %   {what}   {rest}"
            print("\r" + text[:shutil.get_terminal_size().columns - 1] + "\033[K", end="", file=sys.stderr, flush=True)
        elif int(10 * done) > self.tenths:
            self.tenths = int(10 * done)
            print(f"{10 * self.tenths} %   {rest}", file=sys.stderr)
        self.finished += 1

    def store(self, key=None, study=None):
        if key:
            self.results[key].append(study)
        with open(self.file + ".new", "w", encoding="utf-8") as file:
            file.write(json.dumps(self.results, indent=1, sort_keys=True, ensure_ascii=False) + "\n")
        os.replace(self.file + ".new", self.file)

    def pairs(self):
        for triangles, gap, motion in PAIRS:
            self.show(f"pairs, {triangles:,} triangles, {motion}")
            [study] = self.ask(":pairs", str(triangles), str(gap), motion)
            self.store("pairs", study)
            if triangles == 100000 and gap < 1e-3:
                ours, fcl, bullet = (study["times"][method] for method in ("zwang", "fcl", "bullet"))
                self.lines.append(f"A finger {motion} on 100k triangles: {1e6 * ours:.1f} us; conservative advancement over fcl::distance "
                                  f"{1e6 * fcl:.0f} us ({fcl / ours:.0f}x), Bullet's convexSweepTest {1e6 * bullet:.0f} us ({bullet / ours:.0f}x)")
            if self.interrupted:
                return False
        return True

    def hands(self, scenes):
        """Each once for time, once under audit, and with friction, twice as long, under audit."""
        for k, scene in enumerate(scenes):
            self.show(scene["name"] + ": loading")
            order = [(key, speed) for key in RUNS for speed in scene["speeds"]]
            studies = self.ask(":hands", str(k))
            for key, speed in order:
                self.show(scene["name"] + RUNS[key])
                study = next(studies, None)
                if study is None:
                    return False
                self.store(key, study)
                if key == "frames" and speed <= 0.5:
                    self.lines.append(
                        f"Hand on {study['scene']} at {study['speed']:.1f} m/s: median {1e3 * study['median']:.2f} ms (touching "
                        f"{1e3 * study['touching_median']:.2f}), p99 {1e3 * study['p99']:.2f}, worst {1e3 * study['worst']:.2f}; contacts "
                        f"{study['raw']:.0f} -> {study['kept']:.0f}")
                if self.interrupted:
                    return False
        for words, key in (("Audit", "audits"), ("Audit with friction", "audits_with_friction")):
            of = {name: sum(study[name] for study in self.results[key]) for name in ("penetrations", "body_frames", "touching", "audited")}
            gap = min((study["gap"] for study in self.results[key]), default=1)
            self.lines.append(f"{words}: {of['penetrations']} penetrations in {of['body_frames']:,} body-frames ({of['touching']:,} touching; "
                              f"{of['audited']:,} poses checked by FCL), smallest gap {1e6 * gap:.2g} um")
        self.results["headline"] = self.lines
        self.store()
        return True

    def run(self):
        scenes = list(self.ask(":hands"))
        self.steps += sum(1 + len(RUNS) * len(scene["speeds"]) for scene in scenes)
        whole = self.pairs() and self.hands(scenes)
        if sys.stderr.isatty():
            print("\r\033[K", end="", file=sys.stderr)
        for line in self.lines:
            print(line)
        if not whole:
            print(f"Stopped. What was finished is in {self.file}")
        sys.stdout.flush()
        return subprocess.run([self.program, "report", os.path.dirname(self.file)]).returncode or (0 if whole else STOPPED)


def main(*words):
    suite = Suite(*words)

    def interrupt(*_):
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # a second Ctrl-C ends the program at once
        suite.interrupted = True
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, interrupt)
    return suite.run()
