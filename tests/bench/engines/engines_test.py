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
import json, sys, time
mode = sys.argv[1]
def say(answer): print(json.dumps(answer), flush=True)
say(dict(engine="fake", version="1", licence="none", bits=64, order=1, substeps=dict(default=1, tuned=1)))
for line in sys.stdin:
    ask = json.loads(line)
    if "scene" in ask:
        scene = ask["scene"]
        states = [b["at"] + b["turn"] + b["velocity"] + b["spin"] for b in scene["bodies"]]
    else:
        for _ in range(ask["step"]):
            for b, s in zip(scene["bodies"], states):
                if b["motion"] != "free": continue
                for k in range(3):
                    s[7 + k] += scene["dt"] * scene["gravity"][k] * (1.01 if mode == "wrong" else 1)
                    s[k] += scene["dt"] * s[7 + k]
    floor = any(s["kind"] == "plane" for b in scene["bodies"] for s in b["shapes"])
    if floor and scene["dt"] == 1 / 120:
        if mode == "hangs": time.sleep(60)
        if mode == "crashes": import os; os.abort()
        if mode == "ends": sys.exit(7)
        if mode == "talks": print("hello"); continue
        if mode == "nan": states[-1][0] = float("nan")
        if mode == "lacks": say(dict(absent="floors")); continue
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


class Kit(unittest.TestCase):
    def run_fake(self, mode, *more, code=0):
        with tempfile.TemporaryDirectory() as folder:
            fake = pathlib.Path(folder) / "fake.py"
            fake.write_text(FAKE)
            done = subprocess.run([sys.executable, source / "bench/engines/engines.py", "--engines", "fake", "--adapter", f"fake={sys.executable} {fake} {mode}",
                                   "--phenomena", "free_fall,slide", "--deadline", "2", "--out", f"{folder}/out", *more], capture_output=True, text=True)
            self.assertEqual(done.returncode, code, done.stderr)
            page = (pathlib.Path(folder) / "out/index.html").read_text()
            self.assertIn("Free fall", page)
            return json.loads((pathlib.Path(folder) / "out/results.json").read_text()), done.stdout

    def test_a_fall_is_exact_and_twice_the_same(self):
        numbers, said = self.run_fake("falls", "--twice")
        self.assertIn("The same numbers twice", said)
        for setting in engines.SETTINGS:
            for cell in numbers["cells"]["fake"][setting]["free_fall"].values():
                self.assertLess(abs(cell["off"]), 1e-12)
            self.assertGreater(abs(numbers["cells"]["fake"][setting]["slide"]["1/60"]["off"]), 1)  # it knows no friction

    def test_a_failure_costs_its_cell_alone(self):
        for mode, why in dict(hangs="no answer in 2 s", crashes="ended by SIGABRT", ends="ended with exit code 7", talks="an answer that is not the protocol's",
                              nan="an answer that is no number", lacks="has no floors").items():
            cells = self.run_fake(mode)[0]["cells"]["fake"]["default"]
            self.assertEqual(cells["slide"].pop("1/120"), {"why": why})
            for cell in [*cells["slide"].values(), *cells["free_fall"].values()]:
                self.assertIn("off", cell, mode)

    def test_who_falls_wrongly_is_not_believed(self):
        for cell in self.run_fake("wrong")[0]["cells"]["fake"]["tuned"]["free_fall"].values():
            self.assertIn("not believed", cell["why"])

    def test_wrong_use_is_one_line(self):
        for words in (["--engines", "nobody"], ["--engines", "all", "--phenomena", "nothing"], ["--engines", "all", "--adapter", "x"],
                      ["--engines"], ["--engines", "all", "--deadline", "0"], ["--engines", "all", "--nothing"]):
            done = subprocess.run([sys.executable, source / "bench/engines/engines.py", *words], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr.count("\n")), (2, 1), (words, done.stderr))


if __name__ == "__main__":
    unittest.main()
