"""Aggregations against values worked out by hand; what a folder of a run may hold.

Usage: report_test.py SOURCE PROGRAM
"""
import contextlib
import importlib.util
import io
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import types
import unittest

source, program = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])


def text_of(file):
    with open(os.path.join(source, "bench/report", file), encoding="utf-8") as text:
        return text.read()


sys.modules["held"] = types.ModuleType("held")
sys.modules["held"].files = {"stability.json": text_of("page/stability.json"), "tables.json": text_of("tables/tables.json")}
for name, file in (("results", "results"), ("aggregation", "tables/aggregation"), ("tables", "tables/tables"), ("charts", "page/charts"),
                   ("report", "report")):
    spec = importlib.util.spec_from_file_location(name, os.path.join(source, "bench/report", f"{file}.py"))
    sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules[name])

import charts
import results
from aggregation import (accuracy_headline, accuracy_matched, break_points, data_profile, fit_power_law, geometric_mean, median, natural_shift,
                         performance_profile, quantile, ratio_text, scaling, shifted_geometric_means, sweep_mark, sweep_state, time_to_error)
from charts import chart_rows, drawn_as
from report import dump, edit_distance, headline, page_data, page_text, single_run_scripts, split_solvers
from results import BadFile, Result, Run, Solver, by_class, duration, exactly, merged, read_run, scientific
from tables import (break_point_table, claim_counts_table, claims_table, class_tables, comparison_table, conformance_table, knob_text, law_table,
                    means_table, phenomenon_table, recorded_table, sequence_table, speed_change_table, speed_exponent_table, speed_table)

INF, NAN, NONE = math.inf, math.nan, None


def result(problem, solver, tolerance, error, seconds, claimed="solved", verified="solved", **more):
    """Of the family f."""
    return Result({"problem": problem, "family": "f", "solver": solver, "tolerance": tolerance, "z_error": error, "solve_s": seconds,
                   "claimed": claimed, "verified": verified, **more})


def run_of(*results, **more):
    solvers = more.pop("solvers", list(dict.fromkeys(r.solver for r in results)))
    return Run(results=list(results), solvers=[Solver(name) for name in solvers], **more)


def value(cell):
    return cell.get("value")


class Statistics(unittest.TestCase):
    def test_median_skips_the_unknown(self):
        self.assertEqual(median([3, 1, 2]), 2)
        self.assertEqual(median([4, 1, NAN, 2, 3]), 2.5)
        self.assertTrue(math.isnan(median([])))
        self.assertEqual(quantile([1, 2, 3, 4, 5], 0.25), 2)

    def test_geometric_mean_with_and_without_shift(self):
        self.assertAlmostEqual(geometric_mean([1, 100]), 10, delta=1e-12)
        self.assertAlmostEqual(geometric_mean([1, 7], 1), 3, delta=1e-12)  # sqrt(2 * 8) - 1
        self.assertEqual(geometric_mean([0, 1]), 0)

    def test_a_power_law_of_exact_data_has_no_error(self):
        factor, exponent, error = fit_power_law([1, 2, 4, 8], [3, 12, 48, 192])
        self.assertAlmostEqual(factor, 3, delta=1e-12)
        self.assertAlmostEqual(exponent, 2, delta=1e-12)
        self.assertAlmostEqual(error, 0, delta=1e-7)

    def test_a_power_laws_error_of_three_points(self):
        # In logarithms to base e: x = 0, 1, 2; y = 0, 2, 1. Slope 1/2, residuals -1/2, 1, -1/2: s.e. = sqrt(1.5 / 1 / 2).
        _, exponent, error = fit_power_law([1, math.e, math.e ** 2], [1, math.e ** 2, math.e])
        self.assertAlmostEqual(exponent, 0.5, delta=1e-12)
        self.assertAlmostEqual(error, math.sqrt(0.75), delta=1e-12)

    def test_numbers_for_people(self):
        for value, digits, text in ((3.24e-9, 1, "3.2e-9"), (1e-12, 0, "1e-12"), (2, 1, "2.0"), (0, 1, "0"), (NAN, 1, "unknown"),
                                    (1.7976931348623157e308, 1, "infinite"), (1e300, 0, "1e300")):
            self.assertEqual(scientific(value, digits), text)
        for value, text in ((1e-8, "1e-8"), (2.5e-7, "2.5e-7"), (0.1 + 0.2, "3.0000000000000004e-1")):
            self.assertEqual(exactly(value), text)
        for seconds, text in ((18.4e-6, "18 us"), (1.94e-3, "1.9 ms"), (2.41, "2.4 s"), (3e-10, "0.3 ns"), (INF, "unknown")):
            self.assertEqual(duration(seconds), text)
        for knob, text in ((2.0 ** -27, "2^-27"), (2.0 ** 48, "2^48"), (64.0, "64"), (-2.0 ** -20, "-2^-20"), (0.001, "0.001"), (NAN, "")):
            self.assertEqual(knob_text(knob), text)
        for ratio, text in ((1000, "1000x"), (12.4, "12x"), (3.42, "3.4x"), (1, "1.0x"), (0.12, "0.12x"), (0.0351, "0.035x"), (INF, "")):
            self.assertEqual(ratio_text(ratio), text)


class Accuracy(unittest.TestCase):
    def test_interpolates_between_rungs_in_logarithms(self):
        # 1e-2 in 1 s, 1e-6 in 100 s: 1e-4 lies half way, at 10 s.
        ladder = [result("p", "s", 1e-2, 1e-2, 1), result("p", "s", 1e-6, 1e-6, 100)]
        self.assertAlmostEqual(time_to_error(ladder, 1e-4), 10, delta=1e-9)
        self.assertEqual(time_to_error(ladder, 1e-1), 1)
        self.assertAlmostEqual(time_to_error(ladder, 1e-6), 100, delta=1e-9)
        self.assertEqual(time_to_error(ladder, 1e-7), INF)

    def test_takes_the_cheapest_run_that_reaches_the_error(self):
        self.assertEqual(time_to_error([result("p", "s", *run) for run in ((1e-2, 2e-15, 7), (1e-6, 1e-15, 5), (1e-8, 0, 6))], 1e-9), 5)

    def test_runs_that_did_the_same_are_one_with_the_median_of_their_times(self):
        exact = [result("p", "s", tolerance, 1e-15, seconds, verified=verified, iterations=3)
                 for tolerance, seconds, verified in ((1e-2, 7, "solved"), (1e-6, 5, "solved"), (1e-15, 8, "near"))]
        self.assertEqual(time_to_error(exact, 1e-9), 7)
        self.assertEqual(time_to_error([*exact, result("p", "s", 1e-3, 1e-15, 6, iterations=2)], 1e-9), 6)
        proofs = [result("p", "s", 10.0 ** -k, NONE, seconds, "infeasible", "infeasible, proven") for k, seconds in enumerate((4, 2, 9))]
        self.assertEqual(time_to_error(proofs, 1e-9), 4)

    def test_without_a_reference_the_upper_bound_stands_in(self):
        bounded = [result("p", "s", 1e-8, NONE, 3, z_bound=1e-10)]
        self.assertEqual(time_to_error(bounded, 1e-9), 3)
        self.assertEqual(time_to_error(bounded, 1e-11), INF)

    def test_no_family_is_called_as_all_of_them_are(self):
        self.assertEqual([Result({"problem": name, "family": ""}).family for name in ("p", "")], ["p", "unnamed"])

    def test_lies_never_count(self):
        self.assertEqual(time_to_error([result("p", "s", 1e-14, 1e-4, 1, "solved", "wrong")], 1e-3), INF)
        self.assertEqual(time_to_error([result("p", "s", 1e-14, 1e-4, 1, "iteration limit", "wrong")], 1e-3), 1)

    def test_only_a_proof_counts_on_an_infeasible_problem(self):
        for verified, time in (("infeasible, proven", 2), ("infeasible, claimed only", INF)):
            self.assertEqual(time_to_error([result("p", "s", 1e-6, NONE, 2, "infeasible", verified)], 1e-9), time)

    def test_parts_are_of_the_problems_that_a_solver_reads(self):
        def of(problem, solver, seconds, verified):
            solved = verified == "solved"
            return result(problem, solver, 1e-9, 1e-12 if solved else NONE, seconds, "solved" if solved else "unsupported", verified)

        run = run_of(of("p", "every", 1, "solved"), of("q", "every", 1, "solved"), of("r", "every", 1, "solved"), of("p", "some", 3, "solved"),
                     of("q", "some", 2, "no answer"), of("r", "some", 9, "unsupported"), problem_class="QP")
        table = accuracy_matched(run, "f", 1e-9)
        self.assertEqual(len(table), 2)
        self.assertEqual((table[1].reached, table[1].reads, table[1].problems), (1, 2, 3))
        self.assertEqual(accuracy_headline(run), "QP: on 3 f problems at 1e-9 achieved error: every 1.0 s; not on all: some 3.0 s (3.0x, 1 of 2)")
        self.assertTrue(math.isnan(time_to_error(run.results[5:], 1e-9)))

    def test_ranks_by_solved_problems_then_by_time_with_ratios_on_common_problems(self):
        run = run_of(result("p", "slow", 1e-9, 1e-12, 4), result("q", "slow", 1e-9, 1e-12, 9), result("p", "quick", 1e-9, 1e-12, 1),
                     result("q", "quick", 1e-9, 1e-12, 1), result("p", "partial", 1e-9, 1e-12, 0.5), result("q", "partial", 1e-9, 1e-3, 0.5))
        quick, slow, partial = accuracy_matched(run, "f", 1e-9)
        self.assertEqual([entry.solver for entry in (quick, slow, partial)], ["quick", "slow", "partial"])
        self.assertEqual(quick.ratio, 1)
        self.assertAlmostEqual(slow.time_s, 6, delta=1e-12)
        self.assertAlmostEqual(slow.ratio, 6, delta=1e-12)
        self.assertEqual((partial.reached, partial.problems), (1, 2))
        self.assertAlmostEqual(partial.ratio, 0.5, delta=1e-12)
        self.assertEqual(accuracy_headline(run, 1e-9), "On 2 f problems at 1e-9 achieved error: quick 1.0 s, slow 6.0 s (6.0x); not on all: "
                                                       "partial 500 ms (0.5x, 1 of 2)")
        apart = run_of(result("p", "a", 1e-9, 1e-12, 1), result("q", "a", 1e-9, 1e-12, 1), result("r", "b", 1e-9, 1e-12, 2))
        self.assertEqual(accuracy_headline(apart), "On 3 f problems at 1e-9 achieved error: a 1.0 s (2 of 2), b 2.0 s (1 of 1)")
        self.assertEqual(accuracy_matched(run, "another", 1e-9), [])
        self.assertEqual(accuracy_headline(run, 1e-14), "")


class Profiles(unittest.TestCase):
    TIMES = [[1, 6, INF], [2, 3, INF]]  # two solvers on three problems; nobody solves the third

    def test_a_staircase_of_ratios_keeps_unsolved_problems_in_the_denominator(self):
        curves = performance_profile(self.TIMES)
        self.assertEqual([step for step, _ in curves[0]], [1, 2])
        self.assertEqual([share for _, share in curves[0]], [1 / 3, 2 / 3])

    def test_equal_ratios_are_one_step(self):
        self.assertEqual(performance_profile([[1, 2], [2, 4]])[1], [(2, 1)])

    def test_a_problem_that_a_solver_does_not_read_is_no_failure(self):
        read_in_part = [[1, 2, INF, INF], [NAN, 4, 3, INF]]
        ratios, budgets = performance_profile(read_in_part), data_profile(read_in_part)
        self.assertEqual(ratios[0][-1][1], 2 / 4)
        self.assertEqual(ratios[1][-1], (2, 2 / 3))
        self.assertEqual(budgets[1][-1][1], 2 / 3)
        self.assertAlmostEqual(shifted_geometric_means(read_in_part, 0, 10)[1], math.sqrt(12), delta=1e-12)

    def test_a_data_profile_counts_seconds(self):
        self.assertEqual(data_profile(self.TIMES)[0], [(1, 1 / 3), (6, 2 / 3)])

    def test_a_failure_costs_the_mean_ten_times_the_slowest_success(self):
        means = shifted_geometric_means([[1, 4], [INF, 1]], 0, 10)
        self.assertAlmostEqual(means[0], 2, delta=1e-12)
        self.assertAlmostEqual(means[1], math.sqrt(10), delta=1e-12)
        self.assertEqual(natural_shift([[1.9e-5, 3.3e-5], [INF, 2.4e-5]]), 2e-5)


def sweep_run(knob, error, claimed="solved", verified="solved", **more):
    return result(f"mr {knob}", "s", more.pop("tolerance", 1e-10), error, 1, claimed, verified, family="MR", knob="ratio", knob_value=knob, **more)


class Sweeps(unittest.TestCase):
    def test_first_failure_and_first_lie_in_file_order(self):
        run = run_of(sweep_run(1, 1e-15), sweep_run(16, 1e-5, "iteration limit", "wrong"), sweep_run(256, NONE, "solved", "undecided"),
                     sweep_run(4096, 1e-2, "solved", "wrong"))
        [point] = break_points(run).values()
        self.assertEqual((point.fails.knob_value, point.lies.knob_value, point.undecided, point.problems), (16, 4096, 1, 4))

    def test_what_was_handed_over_is_said_and_no_success(self):
        run = run_of(sweep_run(1, 1e-15), sweep_run(16, 1e-15), result("mr 16", "t", 1e-10, 1e-15, 1, family="MR", knob="ratio", knob_value=16))
        run.results[1].solver, run.handed_over = "t", {("s", "t"): {"mr 16"}}
        point = break_points(run)["MR", "s"]
        self.assertEqual((point.fails, point.problems, point.handed_over), (None, 1, 1))
        cells = {row["solver"]: row["cells"][1]["text"] for row in break_point_table(run).rows}
        self.assertEqual(cells, {"s": "never / never (1 handed over)", "t": "never / never"})

    def test_the_tightest_tolerance_speaks_for_a_solver(self):
        [point] = break_points(run_of(sweep_run(1, 1e-3, tolerance=1e-2), sweep_run(1, 1e-12))).values()
        self.assertIsNone(point.fails)

    def test_marks_of_a_single_run(self):
        flagged = "solved, ill-conditioned"
        for mark, *run in (("", 1e-15), ("f", 1e-15, "solved", "solved", True), ("w", 1e-15, flagged), ("wf", 1e-15, flagged, "solved", True),
                           ("w", 1e-2, flagged, "wrong"), ("t", NONE, "time limit", "timeout"), ("c", NONE, "crashed", "crashed"),
                           ("\u00d7", 1e-2, "iteration limit", "wrong"), ("", 1e-2, "solved", "wrong")):  # a lie has a mark of its own
            self.assertEqual(sweep_mark(sweep_run(1, *run[:3], fallback=len(run) > 3)), mark)

    def test_states_of_a_single_run(self):
        for state, *run in (("right", NONE, "infeasible", "infeasible, proven"), ("lies", NONE, "infeasible", "wrong"),
                            ("", NONE, "unsupported", "unsupported"), ("fails", NONE, "time limit", "timeout"),
                            ("fails", 1e-4, "solved, ill-conditioned", "wrong")):
            self.assertEqual(sweep_state(sweep_run(1, *run)), state)

    def test_exponent_over_the_upper_half_of_the_sizes(self):
        [family] = scaling(run_of(*(result(str(size), "s", 1e-8, 1e-9, 1 if size < 8 else size * size / 64, knob="boxes", knob_value=size,
                                           m=size, n=6 * size) for size in (1, 2, 4, 8, 16, 32, 64))), 1e-6)
        self.assertEqual((family.axis, len(family.points)), ("boxes", 7))
        [(solver, low, high, (_, exponent, _))] = family.fits
        self.assertEqual((solver, low, high), ("s", 8, 64))
        self.assertAlmostEqual(exponent, 2, delta=1e-9)


LINE = json.dumps({"problem": "p", "family": "f", "problem_file": "problems/0.h5", "solver": "nnls", "tolerance": 1e-8, "claimed": "solved",
                   "verified": "wrong", "z_error": None, "solve_s": 2e-5})


class Folders(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, name="results.jsonl"):
        return os.path.join(self.folder.name, name)

    def text_of(self, name):
        with open(self.path(name), encoding="utf-8") as text:
            return text.read()

    def read(self, text):
        with open(self.path(), "w", encoding="utf-8") as file:
            file.write(text)
        return read_run(self.folder.name)

    def test_problems_of_one_name_without_a_family_are_one(self):
        def line(problem):
            return LINE.replace('"problem": "p", "family": "f"', f'"problem": "{problem}", "family": ""') + "\n"

        run = self.read("".join(map(line, ("problem", "problem (2)", "box (a) (3)", "problem (10)", "", " (2)"))))
        self.assertEqual([r.family for r in run.results], ["problem", "problem", "box (a)", "problem", "unnamed", "unnamed"])
        self.assertEqual(results.trace_point({"problem": "problem (2)", "solver": "s"})["family"], "problem")

    def test_null_is_unknown_and_a_command_replays_the_run(self):
        run = self.read(LINE + "\n")
        [r] = run.results
        self.assertTrue(math.isnan(r.z_error))
        self.assertEqual(r.solve_s, 2e-5)
        self.assertEqual(r.replay, f"./zwang solve {self.path('problems/0.h5')} --solver nnls --tolerance 1e-8")
        self.assertEqual(run.names(), ["nnls"])
        self.assertEqual(Run("runs").replay_command(Result({"problem_file": "problems/a b.h5", "solver": "nnls:reduce=on", "tolerance": 1e-10})),
                         "./zwang solve 'runs/problems/a b.h5' --solver nnls:reduce=on --tolerance 1e-10")

    def test_an_answer_counts_for_the_solver_that_gave_it_once(self):
        def by(problem, solver, handed_to, seconds, verified="solved"):
            return json.dumps({"problem": problem, "solver": solver, "handed_to": handed_to, "tolerance": 1e-8, "claimed": "solved",
                               "verified": verified, "z_error": 0, "solve_s": seconds}) + "\n"

        run = self.read(by("p", "cone", "dual_active_set", 1) + by("p", "dual_active_set", "", 2) + by("q", "cone", "newton", 3)
                        + by("q", "fixed_point", "newton", 4) + by("r", "cone", "", 5) + by("p", "nsgs", "dual_active_set", 6, "wrong"))
        self.assertEqual([(r.solver, r.solve_s) for r in run.results],
                         [("dual_active_set", 2), ("newton", 3), ("cone", 5), ("dual_active_set", 6)])
        self.assertIn("--solver cone", run.results[1].replay)
        self.assertTrue(run.results[3].lies)  # though another run of its solver on p is right
        self.assertEqual(run.handed_over["cone", "newton"], {"q"})
        self.assertEqual(run.handed_over["cone", "dual_active_set"], {"p"})
        self.assertEqual(len(run.solvers), 3)

    def test_a_torn_last_line_is_left_out_and_said(self):
        run = self.read(LINE + "\n" + LINE[:40])
        self.assertEqual(len(run.results), 1)
        self.assertIn("results.jsonl", run.torn)

    def test_a_bad_line_in_the_middle_is_named(self):
        with self.assertRaisesRegex(BadFile, "results.jsonl line 2: not what zwang writes"):
            self.read(LINE + "\n{broken\n" + LINE + "\n")

    def test_a_foreign_file_costs_one_clear_line(self):
        for foreign in ('{"solver": "nnls", "time": 1}', "[1, 2]", "7", '{"problem": 1, "solver": 2, "tolerance": 3, "claimed": 4, '
                        '"verified": 5, "conflicting": 6}', LINE[:-1] + ', "solve_s": Infinity}', LINE[:-1] + ', "solve_s": 1e999}'):
            with self.assertRaisesRegex(BadFile, r"^[^\n\[]*results.jsonl line 1: [^\n\[]*$"):
                self.read(foreign + "\n")

    def test_a_missing_file_is_named(self):
        with self.assertRaisesRegex(BadFile, "^cannot read /nowhere/at/all/results.jsonl$"):
            read_run("/nowhere/at/all")

    def test_every_column_that_is_read_is_one_of_the_documented(self):
        with open(os.path.join(source, "docs/formats.md"), encoding="utf-8") as text:
            documented = text.read()
        for key in (*results.TEXTS, *results.NUMBERS, *results.COUNTS, *charts.STAGES, "feasible", "fallback", "worst_by_type"):
            self.assertIn(f"`{key}`", documented)

    def test_a_lie_is_a_false_claim_and_nothing_else(self):
        self.assertTrue(result("p", "s", 1, 1, 1, "solved", "wrong").lies)
        self.assertTrue(result("p", "s", 1, 1, 1, "infeasible", "wrong").lies)
        self.assertTrue(result("p", "s", 1, 1, 1, promise="broken").lies)
        for claimed, verified in (("solved, ill-conditioned", "wrong"), ("iteration limit", "wrong"), ("solved", "near"), ("solved", "undecided")):
            self.assertFalse(result("p", "s", 1, 1, 1, claimed, verified).lies)

    def test_no_module_of_the_folder_where_the_user_is_takes_part(self):
        self.read(LINE + "\n")
        for name in ("json", "types", "results", "argparse"):
            with open(self.path(f"{name}.py"), "w", encoding="utf-8") as module:
                module.write("raise SystemExit('not asked for')\n")
        subprocess.run([program, "report", "."], cwd=self.folder.name, capture_output=True, check=True)
        subprocess.run([program, "report", ".", ".", "--out", "two.html"], cwd=self.folder.name, capture_output=True, check=True)

    def test_a_page_stands_from_the_first_problem_on_and_is_replaced_in_one_step(self):
        with open(self.path("run.json"), "w", encoding="utf-8") as record:
            json.dump({"finished": None, "runs": 12}, record)
        page = self.path("report.html")
        for runs in (4, 8, 12):
            with open(self.path(), "w", encoding="utf-8") as file:
                file.write((LINE + "\n") * runs)
            before, old = (open(page, encoding="utf-8"), self.text_of("report.html")) if runs > 4 else (None, "")
            said = subprocess.run([program, "report", self.folder.name], capture_output=True, text=True, check=True).stdout
            self.assertEqual(said, f"Report: {page}\n")
            self.assertEqual(f"Not finished: {runs} of 12 runs so far." in self.text_of("report.html"), runs < 12)
            if before:
                self.assertEqual(before.read(), old, "whoever reads the old page has all of it")
                before.close()
            self.assertEqual(sorted(os.listdir(self.folder.name)), ["report.html", "results.jsonl", "run.json"], "no part of a page stays behind")


class Tables(unittest.TestCase):
    def test_laws_stand_side_by_side(self):
        """A right answer to a simpler law is right, and how far it is from Coulomb's stands beside it."""
        results = [result("a" if law == "coulomb" else f"a ({law})", "newton" if law == "pyramid" else "cone", 1e-10, 1e-14, 1e-3, law=law,
                          z_bound=1e-14, **{} if law == "coulomb" else {"family": f"f ({law})", "coulomb_error": 0.25})
                   for law in ("pyramid", "convex", "coulomb")]
        results.append(result("b", "newton", 1e-10, 1e-14, 1e-3, family="g", law="frictionless"))
        table = law_table(run_of(*results))
        self.assertEqual(len(table.rows), 3)
        for row in table.rows:
            self.assertEqual((row["group"], row["cells"][4]["text"]), ("f", "1 of 1"))
            self.assertEqual(value(row["cells"][8]), 1e-14 if row["cells"][1]["text"] == "coulomb" else 0.25)
        self.assertEqual(law_table(Run()).rows, [])

    def test_phenomena_say_pass_or_by_how_much(self):
        keys = ("solver", "law", "check", "expected", "off", "passes", "applies")
        run = Run(phenomena=[dict(zip(keys, row)) for row in (
            ("cone", "coulomb", "ROD", "one of three", 0, True, True), ("cone", "coulomb", "belt", "carried", 0.375, False, True),
            ("pgs", "pyramid", "ROD", "one of three", NAN, False, True), ("pgs", "pyramid", "belt", "carried", NAN, False, False))])
        table = conformance_table(run)
        self.assertEqual(len(table.columns), 5)
        self.assertEqual([[cell["text"] for cell in row["cells"]] for row in table.rows],
                         [["cone", "coulomb", "1", "ok", "0.38"], ["pgs", "pyramid", "0", "none", ""]])
        self.assertEqual(len(phenomenon_table(run).rows), 2)

    def test_lies_stand_first_with_the_command_that_replays_the_worst(self):
        results = [result("p", "s", *run) for run in ((1e-8, 1e-3, 1, "solved, ill-conditioned", "wrong"), (1e-10, 1e-2, 1, "solved", "wrong"),
                                                      (1e-12, 1e-1, 1, "solved", "wrong"), (1e-2, 1e-1, 1, "iteration limit", "wrong"))]
        for r in results:
            r.replay = scientific(r.tolerance, 0)
        worst, flagged = claims_table(run_of(*results)).rows
        self.assertEqual((worst["command"], worst["cells"][2]["text"], worst["cells"][4]["tone"]), ("1e-12", "1e-10 to 1e-12", "bad"))
        self.assertEqual(flagged["cells"][4]["text"], "solved, ill-conditioned")

    def test_false_claims_are_counted_by_solver(self):
        first, second = claim_counts_table(run_of(
            result("p", "s", 1e-8, 1e-3, 1, "solved, ill-conditioned", "wrong"), result("p", "s", 1e-10, 1e-2, 1, "solved", "wrong"),
            result("p", "t", 1e-12, 1e-3, 1, "solved", "wrong"), result("q", "t", 1e-12, 1e-1, 1, "solved", "wrong"),
            result("q", "honest", 1e-2, 1e-1, 1, "iteration limit", "wrong"), solvers=["honest", "s", "t"])).rows
        self.assertEqual((first["solver"], *(value(first["cells"][k]) for k in (1, 3, 4))), ("t", 2, 2, 1e-1))
        self.assertEqual([value(second["cells"][k]) for k in (1, 5)], [1, 1])  # the latter flagged, but wrong

    def test_recorded_answers_count_by_verdict_and_their_errors_are_those_that_were_measured(self):
        recorded = [result(name, "recorded:somebody", 1e-10, error, NONE, "unsolved", verified, z_bound=bound)
                    for name, error, verified, bound in (("a", 1e-3, "wrong", NONE), ("b", 1e-16, "solved", NONE), ("c", NONE, "undecided", 1e308))]
        [row] = recorded_table(Run(recorded=recorded)).rows
        self.assertEqual([value(cell) for cell in row["cells"][2:]], [3, 1, 0, 1, 1, 1e-16, (1e-16 + 1e-3) / 2, 1e-3])
        self.assertEqual(recorded_table(Run()).rows, [])

    def test_two_versions_of_a_solver_stand_side_by_side_on_the_same_problems(self):
        a = run_of(result("p", "s", 1e-8, 1e-9, 4, problem_sha256="same"), result("q", "s", 1e-8, 1e-9, 1), solvers=["s", "gone"])
        b = run_of(result("p renamed", "s", 1e-8, 1e-9, 1, problem_sha256="same"), result("r", "s", 1e-8, 1e-9, 1),
                   result("p renamed", "new", 1e-8, 1e-9, 2, problem_sha256="same"), solvers=["s", "new"])
        a.handed_over, b.handed_over = {("asked", "s"): {"p", "q"}}, {("asked", "s"): {"p renamed"}, ("asked", "new"): {"r"}}
        b.traces = [{"problem": "p renamed", "solver": "s"}]
        both = merged(a, b)
        self.assertEqual(both.traces, [{"problem": "p", "solver": "s @B"}])
        self.assertEqual(both.handed_over, {("asked", "s @A"): {"p"}, ("asked", "s @B"): {"p"}})
        self.assertEqual(both.names(), ["s @A", "s @B", "gone", "new"])
        self.assertEqual([(r.problem, r.solver) for r in both.results], [("p", "s @A"), ("p", "s @B"), ("p", "new")])
        self.assertEqual(b.results[0].problem, "p renamed")
        self.assertIn("Of solvers in both runs, 2 problems that only one of the two has: left out.", both.notes)
        table = comparison_table(a, b)
        [row] = table.rows
        self.assertEqual(value(row["cells"][1]), 1)                          # one problem in both
        self.assertAlmostEqual(value(row["cells"][4]), 0.25, delta=1e-12)  # B needs a quarter of the time
        self.assertTrue(table.note.endswith("Only in run A: gone. Only in run B: new."), table.note)
        a.conditions, b.conditions = [("CPU", "one"), ("flags", "-O3")], [("CPU", "another"), ("flags", "-O3")]
        self.assertTrue(comparison_table(a, b).note.endswith("The runs are of different CPU, which times depend on."))

    def test_problems_are_the_same_where_their_contents_are(self):
        a = run_of(result("p", "s", 1e-8, 1e-9, 4, problem_sha256="one"), result("q", "s", 1e-8, 1e-9, 1, problem_sha256="both"))
        b = run_of(result("p", "t", 1e-8, 1e-9, 4, problem_sha256="two"), result("q", "t", 1e-8, 1e-9, 1, problem_sha256="both"))
        self.assertEqual([r.problem for r in merged(a, b).results], ["p", "q", "p @B", "q"])
        b.results.pop()
        with contextlib.redirect_stderr(io.StringIO()) as said, self.assertRaises(SystemExit) as end:
            merged(a, b)
        self.assertEqual(end.exception.code, 3)
        self.assertIn("no problem in common", said.getvalue())

    def test_each_table_has_its_place_on_a_page(self):
        pages = pathlib.Path(source, "bench/report/page").glob("*.html")
        places = {name for page in pages for name in re.findall(r'data-table="([\w-]+)"', page.read_text())}
        named = set(json.loads(pathlib.Path(source, "bench/report/tables/tables.json").read_text()))
        self.assertEqual(named - places, set())

    def test_each_speed_figure_of_two_runs_in_kernels(self):
        def run(seconds, kernel, *more):
            shown = result("p", "s", 1e-10, 1e-12, seconds, problem_sha256="same", knob="contacts", knob_value=4, kernel_s=kernel, repetitions=3)
            return run_of(shown, *more, solvers=["s"])
        a = run(3, 2, result("alone", "s", 1e-10, 1e-12, 9, kernel_s=2))
        [row] = speed_change_table(a, run(2, 4)).rows  # slower machine, faster solver
        self.assertEqual([value(row["cells"][k]) for k in (1, 3, 4)], [4, 1.5, 0.5])
        self.assertAlmostEqual(value(row["cells"][5]), 1 / 3, delta=1e-12)
        self.assertEqual(speed_change_table(a, run_of(result("q", "s", 1e-10, 1e-12, 1, kernel_s=1), solvers=["s"])).rows, [])

    def test_a_page_holds_the_first_rows_of_a_long_table_and_a_figure_all(self):
        run = run_of(*(result(f"p{k}", "s", 1e-10, 1e-2, 1, "solved", "wrong") for k in range(12)))
        for most, rows in ((5, 5), (None, 12)):
            table = page_data(page_text(run), by_class(run), most_rows=most)["tables"]["claims"]
            self.assertEqual(len(table["rows"]), rows)
            self.assertEqual("The first 5 rows of 12 rows;" in table["note"], most == 5)


class Headlines(unittest.TestCase):
    def test_whose_answers_and_times_they_are(self):
        run = run_of(*(result(str(k % 600), "cone", 1e-8, 1e-9, 1) for k in range(1200)),
                     handed_over={("cone", "dual_active_set"): {"p0", "p1"}})
        lines = headline(run)
        self.assertEqual(lines[0], "1,200 runs of 1 solver on 600 problems: 1,200 right.")
        self.assertEqual(lines[-1], "Handed over, and counted for the solver that answered alone: cone to dual_active_set on 2 problems.")
        run.handed_over.clear()
        self.assertNotIn("Handed over", headline(run)[-1])


def under_three_laws(laws=("frictionless", "pyramid", "convex", "coulomb")):
    """One family under three laws, in which a solver of one class is a thousand times as fast as those of another."""
    results = []
    for law in laws:
        for solver in ("qp_solver", "cone_solver"):
            reads, cone = law in ("frictionless", "pyramid") or solver == "cone_solver", solver == "cone_solver"
            verdict = "solved" if reads else "unsupported"
            results.append(result(f"p under {law}", solver, 1e-10, 1e-14 if reads else NONE, 1 if cone else 1e-3, verdict, verdict, law=law,
                                  z_bound=1e-14 if reads else NONE))
    return run_of(*results, traces=[{"problem": r.problem, "solver": r.solver} for r in results])


class Classes(unittest.TestCase):
    def test_are_never_averaged(self):
        qp, convex, coulomb = classes = by_class(under_three_laws())
        self.assertEqual([part.problem_class for part in classes], ["QP", "convex cone", "Coulomb"])
        self.assertEqual([len(part.solvers) for part in classes], [2, 1, 1], "who reads no problem of a class is not in it")
        self.assertEqual([len(part.traces) for part in classes], [4, 2, 2])
        self.assertEqual(accuracy_headline(qp), "QP: on 2 f problems at 1e-9 achieved error: qp_solver 1.0 ms, cone_solver 1.0 s (1000x)")
        self.assertEqual(accuracy_headline(coulomb), "Coulomb: on one f problem at 1e-9 achieved error: cone_solver 1.0 s")
        means = means_table(qp).rows[0]["cells"]
        self.assertEqual(means[1]["text"], "2 of 2")
        self.assertAlmostEqual(value(means[2]), 1e-3, delta=1e-12)
        self.assertEqual(means_table(convex).rows[0]["cells"][1]["text"], "1 of 1")
        for part in (convex, coulomb):
            self.assertNotIn("qp_solver", [row["cells"][0]["text"] for table in class_tables(part) for row in table.rows])

    def test_a_run_of_one_class_has_no_name_for_it(self):
        [part] = by_class(under_three_laws(("frictionless", "pyramid")))
        self.assertEqual((part.problem_class, len(part.results)), ("", 4))
        self.assertEqual(len(by_class(Run())), 1)


class Charts(unittest.TestCase):
    def test_errors_at_the_edge_of_double_are_still_numbers(self):
        self.assertIn("1e+300", dump(chart_rows(run_of(result("p", "s", 1e-8, 1.7976931348623157e308, 1, "iteration limit", "wrong")))))

    def test_how_a_run_is_drawn(self):
        for drawn, *run in (("ok", 1e-9, 1), ("wrong", 1e-3, 1, "solved", "wrong"), ("missed", 1e-3, 1, "iteration limit", "wrong"),
                            ("undecided", NONE, 1, "solved", "undecided"), ("failed", NONE, 1, "time limit", "timeout"),
                            ("", NONE, 1, "unsupported", "unsupported"), ("", NONE, 1, "infeasible", "infeasible, proven")):
            self.assertEqual(drawn_as(result("p", "s", 1e-8, *run)), drawn)

    def test_single_runs_stand_in_scripts_of_whole_problems(self):
        run = run_of(*(result(f"p{k}", solver, 1e-8, 1e-9, 1) for k in range(1300) for solver in "abcd"))
        scripts, index = single_run_scripts(run)
        self.assertEqual(len(scripts), 2)
        self.assertEqual([script for _, script in index["f"]], [0] * 1250 + [1] * 50)
        self.assertTrue(scripts[1].startswith('zwang_runs(1,{"p1250":[["a",'))


def timed(family, size, solver, seconds, claimed="solved", verified="solved"):
    return result(family, solver, 1e-10, 2e-16, seconds, claimed, verified, family=family, knob="contacts", knob_value=size, kernel_s=50e-6,
                  allocations=0, iterations=20, repetitions=25)


def speed_run():
    start = {"frames": 9, "solve_s": 1e-3}
    return run_of(*(timed(family, size, solver, time) for size in (4, 16, 64)
                    for solver, time in (("dual_active_set", 1e-6 * size), ("ipopt", 1e-3 * size * size)) for family in ("hand", "hands")),
                  speed=[{"kind": "sequence", "sequence": "hand", "solver": "ipopt", "cold": start, "warm": {**start, "solve_s": 2e-3}},
                         {"kind": "assembly", "scene": "hand", "contacts": 64, "kernel_s": 50e-6, "assemble_s": 5e-6, "islands_s": 4e-6}])


def row_of(table, solver, size):
    [cells] = [row["cells"] for row in table.rows if row["solver"] == solver and row["cells"][1]["text"] == size and row["group"] != "hands"]
    return cells


class SpeedTables(unittest.TestCase):
    def test_times_stand_against_the_kernel_and_against_ours(self):
        table = speed_table(speed_run())
        ours = row_of(table, "dual_active_set", "16 contacts")
        self.assertAlmostEqual(value(ours[4]), 16e-6 / 50e-6, delta=1e-15)
        self.assertEqual(ours[7]["text"], "1 of 1")
        self.assertAlmostEqual(value(row_of(table, "ipopt", "16 contacts")[5]), 16000, delta=1e-6)

    def test_a_stopped_solver_gives_a_lower_bound_against_newton_where_ours_is_not_run(self):
        peer = row_of(speed_table(run_of(timed("wall", 1000, "newton", 1e-2), timed("wall", 1000, "ipopt", 20, "time limit", "timeout"))),
                      "ipopt", "1000 contacts")
        self.assertEqual((peer[3]["text"][:2], peer[5]["text"][:2]), ("> ", "> "))
        self.assertAlmostEqual(value(peer[5]), 2000, delta=1e-9)

    def test_exponents_are_fitted_to_all_sizes(self):
        first, second = speed_exponent_table(speed_run()).rows  # one family sweeps its size here
        self.assertAlmostEqual(value(first["cells"][3]), 1, delta=1e-12)
        self.assertAlmostEqual(value(second["cells"][3]), 2, delta=1e-12)

    def test_a_warm_start_that_loses_is_shown(self):
        [row] = sequence_table(speed_run()).rows
        self.assertEqual((value(row["cells"][5]), row["cells"][5]["tone"]), (0.5, "warn"))

    def test_stand_on_the_page_of_a_speed_run_only(self):
        run = speed_run()
        self.assertIn("speed", [table.id for table in class_tables(run)])
        run.speed.clear()
        self.assertNotIn("speed", [table.id for table in class_tables(run)])


class Words(unittest.TestCase):
    def test_settings_stay_with_their_solver(self):
        self.assertEqual(split_solvers("a,b:key=1,other=2,c"), ["a", "b:key=1,other=2", "c"])

    def test_slips(self):
        for a, b, slips in (("pfd", "pdf", 1), ("nnls", "nnls", 0), ("nnsl", "nnls", 1), ("", "abc", 3), ("wrok-precision", "work-precision", 1)):
            self.assertEqual(edit_distance(a, b), slips)


unittest.main(argv=sys.argv[:1])
