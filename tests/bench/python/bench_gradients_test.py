"""`zwang bench --gradients` as a user runs it: bench_gradients_test.py PROGRAM. Run by ctest."""
import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())


class BenchGradients(unittest.TestCase):
    def run_in(self, folder, *words):
        return subprocess.run([PROGRAM, "bench", "--gradients", *words], cwd=folder, capture_output=True, text=True)

    def test_writes_a_table_a_chart_and_a_paragraph(self):
        with tempfile.TemporaryDirectory() as folder:
            ran = self.run_in(folder, "--scenes", "hand(contacts=4),ball", "--law", "convex,coulomb", "--out", "run/first")
            self.assertEqual(ran.returncode, 0, ran.stderr)
            self.assertIn("central differences are off by", ran.stdout)
            out = pathlib.Path(folder) / "run/first"
            with open(out / "gradients.csv", newline="") as file:
                rows = list(csv.DictReader(file))
            self.assertEqual({row["law"] for row in rows}, {"convex", "coulomb"})
            error = {(row["problem"], row["law"], row["seed"], row["made by"], float(row["amount"])): float(row["error"])
                     for row in rows if row["error"]}
            by_differences = {key: e for key, e in error.items() if key[3] == "differences"}
            self.assertGreaterEqual(len(by_differences), 4 * 12)
            # Rounding spoils the smallest steps, by its share over the step; softness what it is larger than.
            for (problem, law, seed, made_by, _), e in error.items():
                if made_by == "differences":
                    self.assertLess(error[problem, law, seed, made_by, 1e-6], 1e-6)
                else:
                    self.assertEqual(law, "convex")
                    self.assertLess(error[problem, law, seed, made_by, 1e-8], 0.01 * error[problem, law, seed, made_by, 1e-2])
            xml.etree.ElementTree.parse(out / "gradients.svg")
            again = self.run_in(folder, "--scenes", "ball", "--out", "run/first")
            self.assertEqual((again.returncode, len(again.stderr.splitlines())), (2, 1))

    def test_wrong_use_costs_one_line_and_writes_nothing(self):
        for words, code in ((("--scenes", "bal"), 2), (("--solvers", "nnls"), 2), (("--law", "fair"), 2), (("--scenes", "no.json"), 3)):
            with self.subTest(words), tempfile.TemporaryDirectory() as folder:
                ran = self.run_in(folder, *words)
                self.assertEqual((ran.returncode, len(ran.stderr.splitlines())), (code, 1), ran.stderr)
                self.assertEqual(list(pathlib.Path(folder).iterdir()), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
