#!/usr/bin/python3
"""engines_test.py SOURCE_DIR: the kit of engines, with an engine of its own that falls exactly and misbehaves where it is told to."""
from fractions import Fraction as F
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

source = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(source / "bench/engines"))
import engines
import exact
import phenomena

# A ball that falls; mode: what it does where a scene has a floor.
FAKE = """
import json, os, sys, time
mode = sys.argv[1]
def say(answer): print(json.dumps(answer), flush=True)
if mode == "never": sys.exit("no licence")
scenes = 0
say(dict(engine="fake", version="1", licence="none", bits=64, order=0 if mode == "slow" else 1, substeps=dict(default=1, **{} if mode == "half" else dict(tuned=1)), alone=mode == "alone"))
for line in sys.stdin:
    ask = json.loads(line)
    if "scene" in ask:
        scene, scenes = ask["scene"], scenes + 1
        states = [b["at"] + b["turn"] + b["velocity"] + b["spin"] for b in scene["bodies"]]
    else:
        for _ in range(ask["step"]):
            for b, s in zip(scene["bodies"], states):
                if b["motion"] != "free": continue
                for k in range(3):
                    gained = scene["dt"] * scene["gravity"][k] * (1.01 if mode == "wrong" else 1)
                    s[7 + k] += gained
                    s[k] += scene["dt"] * (s[7 + k] - (gained / 2 if mode == "slow" else 0))
    floor = any(s["kind"] == "plane" for b in scene["bodies"] for s in b["shapes"])
    if floor and scene["dt"] == 1 / 120:
        if mode in ("hangs", "slow"): time.sleep(60)
        if mode == "crashes": os.abort()
        if mode == "ends": sys.exit(7)
        if mode == "screams": sys.exit("buffer\\t full")
        if mode == "throws": say(dict(error="no memory\\nat all")); continue
        if mode == "talks": print("hello"); continue
        if mode == "numbers": say(dict(states=[1.0] * len(states))); continue
        if mode == "nan": states[-1][0] = float("nan")
        if mode == "lacks": say(dict(absent="floors")); continue
    if mode in ("remembers", "alone") and floor: states[-1][0] = float(scenes if mode == "alone" else os.getpid())
    say(dict(states=states))
"""


def stepped(v, a, t, clock, stops):
    """The way after t seconds, step by step."""
    x = F(0)
    for _ in range(int(t / clock.h)):
        new = v + a * clock.h
        if stops and new < 0:
            new = F(0)
        x += clock.h * {1: new, -1: v, 0: (v + new) / 2}[clock.order]
        v = new
    return x


class Exact(unittest.TestCase):
    def test_ways_are_those_of_the_steps(self):
        for h in (F(1, 60), F(1, 240), F(1, 1000), F(1, 7)):
            for order in (1, 0, -1):
                clock = exact.Clock(h, order)
                for v, a in ((F(2), F(-3)), (F(0), F(981, 200)), (F(-1, 3), F(1, 9))):
                    self.assertEqual(exact.travel(v, a, 70 * h, clock), stepped(v, a, 70 * h, clock, False))

    def test_stopping_is_that_of_the_steps(self):
        for h in (F(1, 60), F(1, 240), F(1, 1000), F(1, 7)):
            for v in (F(2), F(12, 5), F(3) * h):
                for order in (1, -1):
                    clock, a = exact.Clock(h, order), F(981, 200)
                    self.assertEqual(exact.stop(v, a, clock), stepped(v, -a, 3, clock, True))
        self.assertEqual(exact.stop(F(2), F(1), exact.Clock(F(1, 60), 0)), 2)

    def test_answers_are_rational_and_their_steps_whole(self):
        for p in phenomena.ALL.values():
            for dt in engines.STEPS:
                self.assertIsInstance(p.exact(exact.Clock(dt)), (F, int), p.name)
                self.assertEqual((p.seconds / dt).denominator, 1, p.name)
            self.assertGreater(p.mark, 0)

    def test_answers_are_those_of_the_steps(self):
        for p in phenomena.ALL.values():
            for h in engines.STEPS:
                answer = p.exact(exact.Clock(h))
                self.assertEqual(answer, last(p.name)(h) if answer else 0, p.name)


def last(name):
    """What stepping comes to, of answers that are neither rest nor a way of exact.py; F in, F out, in steps of h."""
    g, mu = phenomena.G, F(1, 2)

    def rolling(v, spin, pull, t, h):
        for _ in range(int(t / h)):
            v += pull * h
            slip = v - spin  # of a solid ball's lowest point; spin is times its radius
            push = min(max(slip * F(2, 7), -mu * g * h), mu * g * h)
            v, spin = v - push, spin + push * F(5, 2)
        return v

    def way(speed_after, t, h):
        speeds = [speed_after(k * h) for k in range(1, int(t / h) + 1)]
        return h * sum(speeds)

    def struck(mass, restitution):  # by a ball of 1 kg at 1 m/s: (its speed, that of the other)
        impulse = (1 + restitution) / (1 + F(1, mass))
        return 1 - impulse, impulse / mass

    def fallen(h):  # a ball from rest on a slope
        v = x = F(0)
        for _ in range(int(1 / h)):
            v += mu * g / 2 * h
            v -= mu * g / 2 * h * F(2, 7)  # sticking takes 2/7 of what pulls
            x += h * v
        return x
    return {
        "torque": lambda h: sum((F(1, 10) / F(1, 5) * h for _ in range(int(1 / h))), F(0)),
        "wall": lambda h: -F(1), "equal_balls": lambda h: struck(1, F(1))[1], "unequal_balls": lambda h: struck(1000, F(1))[0],
        "sticky_balls": lambda h: struck(1, F(0))[1],
        "frictionless": lambda h: F(1), "bounce": lambda h: F(1), "topples": lambda h: F(1), "spins_on": lambda h: F(10), "ladder_slips": lambda h: F(1, 50),
        "slowing": lambda h: F(2) - sum((mu * g * h for _ in range(int(F(1, 5) / h))), F(0)),
        "rolling": lambda h: rolling(F(2), F(0), F(0), F(1), h), "rolls_on": lambda h: rolling(F(1), F(1), F(0), F(5), h),
        "roll_down": fallen,
        "turning": lambda h: 10 - sum((F(1, 4) * g * F(2, 5) / F(1, 10) * h for _ in range(int(F(1, 2) / h))), F(0)),
        "free_fall": lambda h: way(lambda t: -g * t, F(1), h), "projectile": lambda h: way(lambda t: 4 - g * t, F(1), h),
        "slide": lambda h: way(lambda t: max(2 - mu * g * t, 0), F(1), h),
        "slip": lambda h: way(lambda t: (F(11, 10) * mu - mu) * g * t, F(1), h), "diagonal": lambda h: way(lambda t: (F(6, 5) * mu - mu) * g * t, F(1), h),
        "belt": lambda h: way(lambda t: min(mu * g * t, 1), F(1), h),
        "wall_slips": lambda h: way(lambda t: (mu * F(19, 20) * 2 * g - g) * t, F(1), h),
        "table_slides": lambda h: way(lambda t: (F(3, 2) - 1) * mu * g * t, F(1), h),
    }.get(name)


class Rest(unittest.TestCase):
    """Scenes that rest have forces in their cones that balance them, and those next to them have none."""

    def test_ladder(self):
        r = F(1, 50)  # of its ends

        def stays(mu):
            # The wall's friction helps most when it is all there; then the floor's has to be enough (moments about the middle, weight 1).
            push = F(3, 10) / (F(8, 10) + r + mu * (F(6, 10) + r))
            return push <= mu * (1 - mu * push)
        self.assertTrue(stays(F(3, 8)))
        self.assertFalse(stays(F(3, 10)))

    def test_box_on_a_slope(self):
        for ratio, stays in ((F(19, 20), True), (F(21, 20), False)):
            half = phenomena.leaning(ratio)["bodies"][1]["shapes"][0]["half"]
            pull, _, weight = phenomena.leaning(ratio)["gravity"]
            self.assertEqual(pull * half[2] <= -weight * half[0], stays)
            self.assertLess(pull, -weight)  # and does not slide, mu = 1

    def test_held_by_friction(self):
        for ratio, stays in ((F(21, 20), True), (F(19, 20), False)):
            scene = phenomena.against_wall(ratio)
            self.assertEqual(scene["mu"] * scene["bodies"][1]["force"][0] >= phenomena.G, stays)
        pads = phenomena.pinch(F(6, 5))
        self.assertGreater(2 * pads["mu"] * pads["bodies"][0]["force"][0], phenomena.G)
        self.assertEqual(sum(b["force"][2] for b in pads["bodies"]), 3 * phenomena.G)
        self.assertEqual(sum(b["force"][0] for b in pads["bodies"]), 0)
        for ratio in (F(1, 2), F(99, 100)):
            scene = phenomena.incline(ratio)
            self.assertLess(scene["gravity"][0], scene["mu"] * -scene["gravity"][2])
        for ratio, stays in ((F(9, 10), True), (F(3, 2), False)):
            x, y, _ = phenomena.table(ratio)["bodies"][1]["force"]
            self.assertEqual(x * x + y * y < (F(1, 2) * 4 * phenomena.G) ** 2, stays)
            # None of its feet lifts: the push is 32 cm above the floor.
            self.assertLess(F(32, 100) * (x / F(4, 5) + y / F(3, 5)), 4 * phenomena.G / 2)

    def test_gyroscope(self):
        b = phenomena.gyroscope()["bodies"][0]
        arm, spin, rate = b["at"][0], b["spin"][0], b["spin"][2]
        self.assertEqual(b["inertia"][0] * spin * rate, b["mass"] * phenomena.G * arm)  # its momentum turns as the weight asks
        self.assertEqual(b["velocity"][1], rate * arm)


class Kit(unittest.TestCase):
    def run_fake(self, mode, *more, code=0):
        with tempfile.TemporaryDirectory() as folder:
            fake = pathlib.Path(folder) / "fake.py"
            fake.write_text(FAKE)
            done = subprocess.run([sys.executable, source / "bench/engines/engines.py", "--engines", "fake", "--adapter", f"fake={sys.executable} {fake} {mode}",
                                   "--phenomena", "free_fall,slide", "--deadline", "2", "--out", f"{folder}/out", *more], capture_output=True, text=True)
            self.assertEqual(done.returncode, code, done.stderr)
            page = pathlib.Path(folder) / "out/index.html"
            self.assertIn("Free fall", page.read_text())
            if mode == "hangs":
                subprocess.run(["node", source / "tests/bench/engines/page_test.mjs", page], check=True)
            return json.loads((pathlib.Path(folder) / "out/results.json").read_text()), done.stdout

    def test_a_fall_is_exact_and_twice_the_same(self):
        numbers, said = self.run_fake("falls", "--twice")
        self.assertIn("The same numbers twice", said)
        for setting in engines.SETTINGS:
            for cell in numbers["cells"]["fake"][setting]["free_fall"].values():
                self.assertLess(abs(cell["off"]), 1e-12)
            self.assertGreater(abs(numbers["cells"]["fake"][setting]["slide"]["1/60"]["off"]), 1)  # it knows no friction

    def test_a_failure_costs_its_cell_alone(self):
        for mode, why in dict(hangs="no answer in 2 s", crashes="ended by SIGABRT", ends="ended with exit code 7", screams="ended with exit code 1: buffer  full",
                              throws="fails: no memory at all", talks="an answer that is not the protocol's",
                              numbers="an answer that is not the protocol's", nan="an answer that is no number", lacks="has no floors").items():
            cells = self.run_fake(mode)[0]["cells"]["fake"]["default"]
            self.assertEqual(cells["slide"].pop("1/120"), {"why": why})
            for cell in [*cells["slide"].values(), *cells["free_fall"].values()]:
                self.assertIn("off", cell, mode)

    def test_who_differs_is_named_and_who_remembers_may_be_alone(self):
        self.assertIn("Not the same twice: fake (slide", self.run_fake("remembers", "--twice")[1])
        self.assertIn("The same numbers twice", self.run_fake("alone", "--twice")[1])

    def test_who_never_starts_is_asked_once(self):
        for of in self.run_fake("never")[0]["cells"]["fake"].values():
            for cells in of.values():
                self.assertEqual(list(cells.values()), [{"why": "ended with exit code 1: no licence"}] * 4)

    def test_who_chooses_his_own_steps_is_late_once(self):
        cells = self.run_fake("slow")[0]["cells"]["fake"]["default"]["slide"]
        self.assertIn("off", cells["1/60"])
        self.assertEqual(cells["1/120"], {"why": "no answer in 2 s"})
        self.assertIn("in larger steps", cells["1/240"]["why"])
        self.assertIn("in larger steps", cells["1/1000"]["why"])

    def test_who_falls_wrongly_is_not_believed(self):
        for cell in self.run_fake("wrong")[0]["cells"]["fake"]["tuned"]["free_fall"].values():
            self.assertIn("not believed", cell["why"])

    def test_a_first_line_that_lacks_something_costs_all_cells(self):
        for cell in self.run_fake("half")[0]["cells"]["fake"]["default"]["slide"].values():
            self.assertEqual(cell, {"why": "a first line that is not the protocol's"})

    def test_a_program_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, source / "bench/engines/engines.py", "--engines", "none", "--adapter", f"none={folder}/none", "--phenomena", "free_fall",
                                   "--out", folder], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("cannot be started: No such file or directory", (pathlib.Path(folder) / "results.json").read_text())

    def test_help(self):
        done = subprocess.run([sys.executable, source / "bench/engines/engines.py", "--engines", "--help"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("--phenomena", done.stdout)

    def test_wrong_use_is_one_line(self):
        for words in (["--engines", "nobody"], ["--engines", "all", "--phenomena", "nothing"], ["--engines", "all", "--adapter", "x"],
                      ["--engines"], ["--engines", "all", "--deadline", "0"], ["--engines", "all", "--nothing"]):
            done = subprocess.run([sys.executable, source / "bench/engines/engines.py", *words], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), (words, done.stderr))

    def test_what_cannot_be_written_is_one_line(self):
        run = [sys.executable, source / "bench/engines/engines.py", "--engines"]
        for out in ("/proc/x", __file__):
            done = subprocess.run([*run, "none", "--adapter", "none=/nowhere/none", "--out", out], capture_output=True, text=True, timeout=60)
            self.assertEqual((done.returncode, done.stderr.count("\n"), done.stdout), (3, 1, ""), done.stderr)
            self.assertTrue(done.stderr.startswith(f"{out}: "), done.stderr)
        with open("/dev/full", "w") as full:
            done = subprocess.run(["env", "-u", "PYTHONUNBUFFERED", *run, "--help"], stdout=full, stderr=subprocess.PIPE, text=True)
        self.assertEqual((done.returncode, done.stderr), (3, "output: No space left on device\n"))


if __name__ == "__main__":
    unittest.main()
