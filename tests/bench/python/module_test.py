"""The Python module as its users meet it. Run by ctest with PYTHONPATH set to the built package."""
import copy
import doctest
import functools
import gc
import json
import math
import os
import pathlib
import pickle
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy
import scipy.sparse

import zwang
import zwang.formats


def random_program(seed, n=12, rows=9, equalities=2):
    draw = numpy.random.default_rng(seed)
    L = draw.normal(size=(n, n))
    P = L @ L.T + numpy.eye(n)
    x0 = draw.normal(size=n)
    G, A = draw.normal(size=(rows, n)), draw.normal(size=(equalities, n))
    return dict(P=P, q=draw.normal(size=n) * 3, G=G, h=G @ x0 + draw.uniform(0, 0.3, rows), A=A, b=A @ x0,
                lb=x0 - draw.uniform(0, 2, n), ub=x0 + draw.uniform(0, 2, n))


def solution_of(program):
    """x*, by zwang's own solver on the problem stated by hand."""
    n = len(program["q"])
    I = numpy.eye(n)
    J = numpy.vstack([program["A"], -program["G"], I, -I])
    c = numpy.concatenate([program["b"], -program["h"], program["lb"], -program["ub"]])
    problem = zwang.Problem(program["P"], -numpy.linalg.solve(program["P"], program["q"]), J, c,
                            equality=len(program["b"]))
    return zwang.solve(problem, tolerance=1e-12)


class Packs(unittest.TestCase):
    """A pack of two problems, made here, and answers of two kinds of file."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.pack = os.path.join(self.folder.name, "pack")
        os.mkdir(self.pack)
        self.problems = zwang.scene("hand(contacts=4,16)")
        listed = []
        for k, p in enumerate(self.problems):
            zwang.save(os.path.join(self.pack, f"{k}.h5"), p)
            listed.append({"file": f"{k}.h5", "sha256": p.sha256, "name": p.name, "family": "hand", "law": "frictionless",
                           "n": p.size, "m": p.rows, "equalities": int(p.equality.sum()), "known": "nothing", "method": ""})
        with open(os.path.join(self.pack, "pack.json"), "w", encoding="utf-8") as out:
            json.dump({"zwang_pack": 1, "made_by": "a test", "problems": listed}, out)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def test_right_and_wrong_answers_are_told_apart_in_both_formats(self):
        right = [zwang.solve(p) for p in self.problems]
        zwang.write_answers(self.path("right.jsonl"), solver="mine", tolerance=1e-9, answers=[
            {"sha256": p.sha256, "status": "solved", "z": s.z, "lambda": s.lambda_, "iterations": s.iterations}
            for p, s in zip(self.problems, right)])
        arrays = {}
        for p, s in zip(self.problems, right):
            arrays |= {p.sha256 + "/status": "solved", p.sha256 + "/z": s.z * (1 + 1e-4)}
        numpy.savez(self.path("spoilt.npz"), solver="spoilt", tolerance=1e-9, **arrays)
        rows = zwang.judge_pack(self.pack, self.path("right.jsonl"), self.path("spoilt.npz"), out=self.path("judged"))
        with self.assertRaisesRegex(ValueError, "holds a run already"):
            zwang.judge_pack(self.pack, self.path("right.jsonl"), out=self.path("judged"))
        said = sorted((r["solver"], r["problem"], r["verified"]) for r in rows)
        names = [p.name for p in self.problems]
        self.assertEqual(said, sorted([("mine", n, "solved") for n in names] + [("spoilt", n, "wrong") for n in names]))
        for row in rows:
            if row["solver"] == "mine":
                problem = self.problems[names.index(row["problem"])]
                judged = zwang.judge(problem, right[names.index(row["problem"])].z, tolerance=1e-9)
                self.assertLessEqual(row["z_error"], judged.at_most)

    def test_answers_that_nobody_would_read_are_not_written(self):
        p = self.problems[0]
        for solver, z, says in (("my solver", p.z_u, "solver should have letters"), ("mine", p.z_u * math.nan, f"z of {p.sha256} is not finite")):
            with self.assertRaisesRegex(ValueError, says):
                zwang.write_answers(self.path("no.jsonl"), [{"sha256": p.sha256, "status": "solved", "z": z}], solver=solver)
        self.assertFalse(os.path.exists(self.path("no.jsonl")))

    def test_damaged_answers_are_refused_with_one_line(self):
        p = self.problems[0]
        with open(self.path("text.npz"), "w", encoding="utf-8") as out:
            out.write("no archive")
        numpy.savez(self.path("nobody.npz"), **{p.sha256 + "/z": numpy.zeros(p.size)})
        numpy.savez(self.path("short.npz"), solver="s", **{p.sha256 + "/status": "solved", p.sha256 + "/z": numpy.zeros(3)})
        numpy.savez(self.path("nan.npz"), solver="s", **{p.sha256 + "/status": "solved",
                                                         p.sha256 + "/z": numpy.full(p.size, math.nan)})
        for name, says in (("text.npz", "line 1"), ("nobody.npz", "solver"), ("short.npz", "96"), ("nan.npz", "z"),
                           ("absent.npz", "no such file"), ("absent.jsonl", "absent.jsonl")):
            with self.assertRaises(zwang.BadFile) as refused:
                zwang.judge_pack(self.pack, self.path(name))
            self.assertIn(says, str(refused.exception))
            self.assertNotIn("\n", str(refused.exception))


class Problems(unittest.TestCase):
    def test_round_trip_keeps_every_bit(self):
        problem = zwang.scene("hand(contacts=4)")
        again = zwang.Problem(problem.M, problem.z_u, problem.J, problem.c, equality=problem.equality)
        self.assertEqual(again.sha256, problem.sha256)
        with tempfile.TemporaryDirectory() as folder:
            zwang.save(os.path.join(folder, "p.h5"), problem)
            self.assertEqual(zwang.load(os.path.join(folder, "p.h5"))[0].sha256, problem.sha256)

    def test_sparse_formats_orders_and_strides_give_the_same_problem(self):
        problem = zwang.scene("tower(boxes=3)")
        dense = problem.J.toarray()
        wanted = problem.sha256
        forms = [dense, numpy.asfortranarray(dense), numpy.repeat(dense, 2, axis=1)[:, ::2], problem.J.tocsc(),
                 problem.J.tocoo(), problem.J.tolil(), problem.J.todok(), problem.J.tobsr(), dense.tolist()]
        twice = scipy.sparse.coo_matrix(problem.J)
        twice = scipy.sparse.coo_matrix((numpy.r_[twice.data / 2, twice.data / 2], (numpy.r_[twice.row, twice.row],
                                                                                numpy.r_[twice.col, twice.col])))
        for J in forms + [twice]:
            again = zwang.Problem(problem.M.toarray(), problem.z_u.astype(">f8"), J, list(problem.c),
                                  equality=problem.equality)
            self.assertEqual(again.J.toarray().tobytes(), problem.J.toarray().tobytes())
        self.assertEqual(zwang.Problem(problem.M, problem.z_u, problem.J, problem.c,
                                       equality=problem.equality).sha256, wanted)

    def test_bad_input_is_one_line(self):
        good = dict(M=numpy.eye(2), z_u=[0, 0], J=[[1, 0]], c=[1])
        for spoilt, word in [(dict(M=numpy.eye(3)), "M"), (dict(M=[[1, 2], [0, 1]]), "symmetric"),
                             (dict(M=-numpy.eye(2)), "positive definite"), (dict(z_u=[math.nan, 0]), "z_u(0)"),
                             (dict(c=[math.inf]), "c(0)"), (dict(J=[[1, 0, 0]]), "J"), (dict(z_u="x"), "z_u"),
                             (dict(M=[["a"]]), "M"), (dict(equality=2), "equality"), (dict(J=numpy.ones((1, 1, 2))), "J"),
                             (dict(equality=[0.5]), "equality"), (dict(z_u=numpy.ones((2, 2))), "z_u"),
                             (dict(c=None), "c is missing: expected 1 entries"), (dict(J=None), "J should be 1 x 2, as c has 1 entries and z_u 2"),
                             (dict(c=[1, 2]), "J should be 2 x 2, as c has 2"), (dict(z_u=[10**400, 0]), "z_u")]:
            with self.assertRaises(ValueError) as raised:
                zwang.Problem(**{**good, **spoilt})
            self.assertIn(word, str(raised.exception))
            self.assertEqual(len(str(raised.exception).splitlines()), 1, raised.exception)

    def test_one_number_stands_for_all_entries_and_mu_is_never_dropped(self):
        rows = {"J": [[0, 0, 1], [1, 0, 0], [0, 1, 0]], "c": [0, 0, 0]}
        block = zwang.Problem(numpy.eye(3), [4, 0, -10], **rows, tangent=[False, True, True], mu=0.25)
        answer = zwang.solve(block, "cone")
        self.assertAlmostEqual(answer.z[0], 1.5)
        self.assertEqual(repr(answer), f"<zwang.Solution: solved, {answer.iterations} iterations>")
        with self.assertRaisesRegex(ValueError, "no tangent rows"):
            zwang.Problem(numpy.eye(3), [4, 0, -10], **rows, mu=[0.25, 0, 0])
        with self.assertRaisesRegex(ValueError, "mu should have 3 entries, one a row"):
            zwang.Problem(numpy.eye(3), [4, 0, -10], **rows, tangent=[False, True, True], mu=[0.25, 0.25])
        judged = zwang.judge_qp(numpy.eye(3), [-5.0, 0, 0], lb=0, ub=1, x=[1.0, 0, 0])
        self.assertEqual(judged.verdict, "solved")

    def test_all_problems_are_of_one_class_and_go_to_other_processes(self):
        block = zwang.scene("incline(slope=0.5)", mu=0.25)
        mine = zwang.Problem(numpy.eye(2), [1, 2], name="mine")
        for p in (zwang.scene("hand(contacts=4)"), block, block.under("convex"), block.under("pyramid"), mine):
            self.assertIsInstance(p, zwang.Problem)
            again = pickle.loads(pickle.dumps(p))
            self.assertIs(type(again), type(p))
            self.assertEqual((again.sha256, again.law, again.name, again.row_names), (p.sha256, p.law, p.name, p.row_names))
            self.assertIs(copy.deepcopy(p), copy.copy(p))

    def test_an_unreadable_file_is_one_line(self):
        with tempfile.NamedTemporaryFile(suffix=".h5") as file:
            file.write(b"no file of this kind")
            file.flush()
            with self.assertRaises(zwang.BadFile) as raised:
                zwang.load(file.name)
        self.assertEqual(len(str(raised.exception).splitlines()), 1)


class Solving(unittest.TestCase):
    def test_every_native_solver_on_a_scene(self):
        problem = zwang.scene("hand(contacts=4)")
        for solver in zwang.solvers():
            if solver["exact"] and solver["name"] != "nnls_paper":
                answer = zwang.solve(problem, solver["name"])
                self.assertEqual(answer.status, "solved")
                self.assertEqual(zwang.judge(problem, answer.z).verdict, "solved", solver["name"])

    def test_a_solver_in_a_child_gets_the_problem(self):
        problem = zwang.scene("tower(boxes=2)")
        foreign = [s["name"] for s in zwang.solvers() if s["foreign"] and s["exact"]] or ["nlopt_slsqp"]
        for name in {*foreign, "ipopt", "nlopt_slsqp"} & {s["name"] for s in zwang.solvers()}:
            answer = zwang.solve(problem, name, tolerance=1e-8)
            self.assertEqual(len(answer.z), problem.size, name)
            self.assertIn(zwang.judge(problem, answer.z, tolerance=1e-6).verdict, ("solved", "near"), name)

    def test_a_bench_is_quiet_unless_asked(self):
        program = ("import zwang\n"
                   "zwang.bench('tower(boxes=2)', solvers='nnls', tolerances=[1e-6], repetitions=1, progress={})")
        for progress in (False, True):
            done = subprocess.run([sys.executable, "-c", program.format(progress)], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual("%" in done.stderr, progress, done.stderr)

    def test_knobs_of_a_scene_stand_in_its_text_or_beside_it(self):
        self.assertEqual(zwang.scene("hand", contacts=8, seed=3).c.tobytes(), zwang.scene("hand(contacts=8)", seed=3).c.tobytes())
        with self.assertRaisesRegex(ValueError, "did you mean 'contacts'"):
            zwang.scene("hand", contact=8)
        with self.assertRaisesRegex(ValueError, "not both"):
            zwang.scene("hand(contacts=8)", hands=2)

    def test_settings_and_knobs_are_text_numbers_or_yes_and_no(self):
        block, box = zwang.scene("incline(slope=0.5)", mu=0.25), zwang.scene("tower(boxes=1)")
        self.assertEqual(zwang.solve(block, "fixed_point", inner="cone").status, "solved")
        for no in ("off", False, numpy.bool_(False)):
            self.assertEqual(zwang.solve(box, "newton", polish=no).status, "solved")
        self.assertEqual(zwang.solve(box, "pgs", max_sweeps=numpy.int64(5)).status, "iteration limit")
        self.assertEqual([p.name for p in zwang.scene("tower", boxes="1..3")], [f"tower(boxes={k})" for k in (1, 2, 3)])
        self.assertEqual(zwang.solve(box, reduce=False).status, "solved")
        with self.assertRaisesRegex(ValueError, "solver 'dual_active_set'.*'no_such'"):
            zwang.solve(box, no_such=1)

    def test_the_usual_solver_is_the_default(self):
        for text, mu in [("hand(contacts=4)", None), ("hand(contacts=4)", 0.5)]:
            problem = zwang.scene(text, mu=mu)
            answer = zwang.solve(problem)
            self.assertEqual(answer.z.tobytes(), zwang.solve(problem, "dual_active_set" if mu is None else "cone").z.tobytes())
            self.assertEqual(zwang.judge(problem, answer).verdict, "solved")
        settings = {s["name"]: s["settings"] for s in zwang.solvers()}
        self.assertEqual(settings["nnls"]["reduce"]["default"], "false")
        with self.assertRaisesRegex(TypeError, "should be a zwang.Problem"):
            zwang.solve("hand")

    def test_ctrl_c_ends_bench_and_keeps_what_is_finished(self):
        program = """if 1:
            import os, signal, sys, zwang
            if sys.argv[2] == "own":
                signal.signal(signal.SIGINT, lambda *_: print("own"))
            try:
                runs = zwang.bench("tower(boxes=1..400)", solvers=["dual_active_set", "nnls", *([len] if sys.argv[2] == "python" else [])],
                                   tolerances=[1e-10], out=sys.argv[1])
                print(len(runs) < 800)
            except KeyboardInterrupt:
                print("interrupted")
            os.kill(os.getpid(), signal.SIGINT)  # as before
        """
        for kind, says in (("plain", "interrupted"), ("python", "interrupted"), ("own", "own\nTrue\nown\n")):
            folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "run"
            process = subprocess.Popen([sys.executable, "-c", program, folder, kind], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            results = folder / "results.jsonl"
            while process.poll() is None and not (results.exists() and results.stat().st_size > 0):
                time.sleep(0.01)
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=60)[0]
            self.assertEqual(said.strip(), says.strip(), kind)
            self.assertEqual(process.returncode, 0 if kind == "own" else -signal.SIGINT, kind)
            self.assertLess(len(results.read_text().splitlines()), 800)

    def test_a_wrong_name_or_setting_is_one_line(self):
        problem = zwang.scene("tower(boxes=2)")
        for wrong in [dict(max_iterations=-1), dict(solver="nnlss"), dict(solver="nnls", no_such=1), dict(solver="pgs", max_sweeps="many"),
                      dict(tolerance=2.0), dict(warm_start=[1.0]), dict(max_iterations=10**10), dict(max_iterations=1.5),
                      dict(max_iterations="many"), dict(time_limit=-1), dict(time_limit=math.nan), dict(time_limit="x"), dict(tolerance=[]),
                      dict(accuracy=""), dict(accuracy=[1e-4]), dict(warm_start=[math.nan] * 8)]:
            with self.assertRaises(ValueError) as raised:
                zwang.solve(problem, **wrong)
            self.assertEqual(len(str(raised.exception).splitlines()), 1)
        for wrong in [dict(seed=-1), dict(seed=2**64), dict(seed=0.5), dict(mu="a"), dict(mu=-1), dict(text=3)]:
            with self.assertRaises((ValueError, TypeError)) as raised:
                zwang.scene(**{"text": "hand(contacts=4)", **wrong})
            self.assertEqual(len(str(raised.exception).splitlines()), 1, raised.exception)
        answer, folder = zwang.solve(problem), self.enterContext(tempfile.TemporaryDirectory())
        for call, says in ((lambda: zwang.judge("hand", [0]), "problem should be a zwang.Problem"),
                           (lambda: zwang.save(f"{folder}/x.h5", ["a"]), "problem should be a zwang.Problem"),
                           (lambda: zwang.save(f"{folder}/x.h5", 3), "problem should be a zwang.Problem"),
                           (lambda: zwang.save(f"{folder}/x.h5", []), "there are no problems to save"),
                           (lambda: zwang.formats.save_qpbenchmark(f"{folder}/x", ["a"]), "problem should be a zwang.Problem"),
                           (lambda: zwang.formats.save_qpbenchmark(f"{folder}/x", []), "there are no problems to save"),
                           (lambda: zwang.solve(problem, law=3), "law should be frictionless, pyramid, convex or coulomb: 3"),
                           (lambda: zwang.add_solver(3, len), "name should be a text"),
                           (lambda: zwang.add_solver("three", 3), "function should be one of a problem and a tolerance"),
                           (lambda: zwang.bench(problem, tolerances="few"), "a tolerance should be a number"),
                           (lambda: zwang.bench(suite="collision"), "the suite collision compares no solvers"),
                           (lambda: zwang.compare_gradients([3]), "problem should be a zwang.Problem"),
                           (lambda: zwang.compare_gradients([], steps=[1e-3, 0]), "steps: entry 1 is 0; expected a finite number above 0"),
                           (lambda: zwang.compare_gradients([], smoothings=[-1]), "smoothings: entry 0 is -1; expected a finite"),
                           (lambda: zwang.gradient(None, answer, "c", [1]), "problem should be a zwang.Problem"),
                           (lambda: zwang.gradient_of(None, answer, proof=False), "problem should be a zwang.Problem"),
                           (lambda: zwang.gradient_of(problem, answer, proof="no"), "proof should be True or False: 'no'"),
                           (lambda: zwang.gradient(problem, answer, "c", [10**400] * 8), "dc should be a vector of numbers: int too large"),
                           (lambda: zwang.gradient_of(problem, answer).vjp(problem.z_u, wrt=None), "wrt should be names among"),
                           (lambda: zwang.judge(problem, answer, tolerance="a"), "tolerance should be a number: 'a'"),
                           (lambda: zwang.solve(problem, accuracy=[1e-4]), r"accuracy should be a number: \[0.0001\]"),
                           (lambda: zwang.solve(problem, warm_start=[0] * 3 + [math.nan] * 5), r"warm_start\(3\) is nan; expected a finite number"),
                           (lambda: zwang.gradient(problem, answer, "z_u", 1j * problem.z_u), "dz_u .* it has complex entries"),
                           (lambda: zwang.gradient(problem, answer, "M", 1j * problem.M), "dM .* it has complex entries"),
                           (lambda: zwang.judge_qp(numpy.zeros((1, 1)), [1e200], lb=1e200, x=[1e200]), "the objective is beyond doubles")):
            with self.assertRaisesRegex((ValueError, TypeError), f"{says}.*$") as raised:
                call()
            self.assertEqual(len(str(raised.exception).splitlines()), 1, raised.exception)
        self.assertEqual(os.listdir(folder), [])
        self.assertEqual(zwang.scene("hand(contacts=4)", seed=2**64 - 1).rows, zwang.scene("hand(contacts=4)").rows)
        self.assertEqual([r["problem"] for r in zwang.compare_gradients(["hand(contacts=4,5)", problem], steps=[1e-5], smoothings=[])],
                         ["hand(contacts=4)", "hand(contacts=5)", problem.name])

    def test_an_accuracy_is_promised_and_kept(self):
        hand = zwang.scene("hand(contacts=8)")
        for solver in ("pgs", "newton", "nnls"):
            self.assertTrue(math.isnan(zwang.solve(hand, solver).error_bound))
            answer = zwang.solve(hand, solver, accuracy=1e-4)
            self.assertLessEqual(answer.error_bound, 1e-4)
            self.assertLessEqual(zwang.judge(hand, answer.z).at_least, answer.error_bound + 1e-12)
        self.assertLessEqual(zwang.solve(hand, "pgs", accuracy="1e-3m/s").error_bound, 1)
        for bad in (0, -1e-4, "1e-4 m", "nan"):
            with self.assertRaisesRegex(ValueError, "accuracy: expected a number"):
                zwang.solve(hand, "pgs", accuracy=bad)

    def test_two_threads_give_the_bits_of_one(self):
        problems = [zwang.scene(f"hand(contacts={c})") for c in (4, 16, 64)]
        alone = [zwang.solve(p).z.tobytes() for p in problems]
        together = {}

        def work(which):
            together[which] = [[zwang.solve(p).z.tobytes() for p in problems] for _ in range(5)]
        threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
        [t.start() for t in threads]
        [t.join() for t in threads]
        for results in together.values():
            for result in results:
                self.assertEqual(result, alone)

    def test_a_function_is_a_solver_of_a_bench(self):
        def by_numpy(problem, tolerance):
            active = problem.equality
            J, M = problem.J[active].toarray(), problem.M.toarray()
            K = numpy.block([[M, -J.T], [J, numpy.zeros((len(J), len(J)))]])
            return numpy.linalg.lstsq(K, numpy.r_[M @ problem.z_u, problem.c[active]], rcond=None)[0][:problem.size]

        def forgets(problem, tolerance):
            return None

        def dies(problem, tolerance):
            os._exit(3)

        def raises(problem, tolerance):
            raise RuntimeError("not today")

        rows = zwang.bench("chain(links=2),tower(boxes=2)", solvers=["dual_active_set", by_numpy, forgets, dies, raises],
                           tolerances=[1e-8], repetitions=1)
        of = {(row["solver"], row["problem"].split("(")[0]): row for row in rows}
        self.assertEqual(of["by_numpy", "chain"]["verified"], "solved")
        self.assertEqual(of["by_numpy", "tower"]["verified"], "wrong")  # it knows no contacts
        self.assertEqual(of["forgets", "chain"]["verified"], "no answer")
        self.assertEqual(of["dies", "chain"]["verified"], "crashed")
        self.assertIn("not today", of["raises", "chain"]["message"])

    def test_the_function_that_is_given_is_the_one_that_is_judged(self):
        tower = zwang.scene("tower(boxes=2)")

        def verdicts(*solvers):
            return [(row["solver"], row["verified"]) for row in zwang.bench(tower, solvers=solvers, tolerances=[1e-6], repetitions=1)]

        def mine(problem, tolerance):
            return problem.z_u
        wrong = mine

        def mine(problem, tolerance):
            return zwang.solve(problem).z
        self.assertEqual(verdicts(wrong), [("mine", "wrong")])
        self.assertEqual(verdicts(mine), [("mine", "solved")])
        self.assertEqual(verdicts(wrong, mine), [("mine", "wrong"), ("mine-2", "solved")])
        self.assertEqual(verdicts(lambda p, t: p.z_u, lambda p, t: zwang.solve(p).z), [("lambda", "wrong"), ("lambda-2", "solved")])
        self.assertEqual(verdicts(functools.partial(wrong)), [("partial", "wrong")])
        zwang.add_solver("kept", wrong)
        zwang.add_solver("kept", mine)
        self.assertEqual(verdicts("kept"), [("kept", "solved")])

    def test_a_bench_runs_what_it_is_asked_and_into_a_new_folder(self):
        tower, folder = zwang.scene("tower(boxes=2)"), os.path.join(self.enterContext(tempfile.TemporaryDirectory()), "run")
        given = ["chain(links=2)", tower, pathlib.Path(folder).parent / "box.h5"]
        zwang.save(given[2], zwang.Problem([[1.0]], [1.0], name="box"))
        once = dict(solvers="dual_active_set", tolerances=1e-6, repetitions=1)
        self.assertEqual({row["problem"] for row in zwang.bench(given, **once, out=folder)}, {"chain(links=2)", tower.name, "box"})
        with self.assertRaisesRegex(ValueError, "holds a run already: choose another"):
            zwang.bench(tower, **once, out=folder)
        with self.assertRaisesRegex(ValueError, "holds other files: choose a new or empty --out"):
            zwang.bench(tower, **once, out=os.path.dirname(folder))
        with self.assertRaisesRegex(ValueError, "knob 'boxes' is given twice"):
            zwang.scene("tower(boxes=2,boxes=3)")
        for empty in ({"scenes": []}, {"scenes": ""}, {"solvers": []}, {"tolerances": []}):
            with self.assertRaisesRegex(ValueError, f"{[*empty][0]} is empty"):
                zwang.bench(**{"scenes": tower, **once, **empty})
        with self.assertRaisesRegex(TypeError, "scenes should be"):
            zwang.bench([tower, 3], **once)

    def test_who_works_for_a_function_is_charged_and_ends_with_it(self):
        busy = "import time\nend = time.thread_time() + 0.05\nwhile time.thread_time() < end: pass"
        note = os.path.join(self.enterContext(tempfile.TemporaryDirectory()), "pid")

        def in_a_thread(problem, tolerance):
            worker = threading.Thread(target=exec, args=(busy, {}))
            worker.start()
            worker.join()
            return problem.z_u

        def by_a_program(problem, tolerance):
            subprocess.run([sys.executable, "-c", busy])
            return problem.z_u

        def returns_twice(problem, tolerance):
            os.fork()
            return problem.z_u

        def leaves_a_program(problem, tolerance):
            with open(note, "w") as out:
                print(subprocess.Popen(["sleep", "1000"]).pid, file=out)
            os.abort()

        functions = [in_a_thread, by_a_program, returns_twice, leaves_a_program]
        of = {row["solver"]: row for row in zwang.bench("chain(links=2)", solvers=functions, tolerances=[1e-8], repetitions=1)}
        for name in ("in_a_thread", "by_a_program"):
            self.assertGreater(of[name]["solve_s"], 0.05, name)
        self.assertEqual([of[f.__name__]["verified"] for f in functions], ["wrong", "wrong", "wrong", "crashed"])
        with open(note) as pid:
            status = f"/proc/{int(pid.read())}/stat"
        if os.path.exists(status):  # ended, and nobody has asked for it
            with open(status) as words:
                self.assertEqual(words.read().split(") ")[1][0], "Z")


class Judging(unittest.TestCase):
    def test_spoilt_answers_are_told_by_what_they_are_off(self):
        for seed in range(4):
            program = random_program(seed)
            x = solution_of(program).z
            self.assertEqual(zwang.judge_qp(**program, x=x).verdict, "solved")
            size = max(math.sqrt(v @ program["P"] @ v) for v in (x, numpy.linalg.solve(program["P"], program["q"])))
            for off, verdict in [(1e-4, "wrong"), (1e-7, "near"), (1e-12, "solved")]:
                d = numpy.random.default_rng(seed).normal(size=len(x))
                d *= off * size / math.sqrt(d @ program["P"] @ d)
                judged = zwang.judge_qp(**program, x=x + d)
                self.assertEqual(judged.verdict, verdict, str(judged))
                self.assertIn(verdict, str(judged))
                self.assertLessEqual(judged.at_least, off * 1.001 + 1e-15)
                self.assertGreaterEqual(judged.at_most, off * 0.999)

    def test_that_no_z_meets_the_rows_is_judged_by_its_certificate(self):
        once_twice = zwang.Problem(numpy.eye(2), [1, 2], J=[[1, 0], [1, 0]], c=[1, 2], equality=2)
        self.assertEqual(zwang.judge(once_twice, zwang.solve(once_twice)).verdict, "infeasible, proven")
        nothing = zwang.Problem(numpy.eye(2), [1, 2], J=[[0, 0]], c=[1])
        said = zwang.solve(nothing)
        self.assertEqual(str(zwang.judge(nothing, said)), "infeasible, proven; proof: the certificate")
        meets_all = zwang.Problem(numpy.eye(2), [1, 2], J=[[1, 0]], c=[1])
        self.assertEqual(zwang.judge(meets_all, said).verdict, "wrong")

    def test_a_tolerance_lies_between_0_and_1(self):
        box = zwang.scene("tower(boxes=1)")
        for bad in (0, -1, 1, math.inf, math.nan):
            with self.assertRaisesRegex(ValueError, "tolerance should lie between 0 and 1"):
                zwang.judge(box, box.z_u, tolerance=bad)

    def test_programs_that_have_no_verdict(self):
        program = random_program(1)
        with self.assertRaisesRegex(ValueError, "smallest eigenvalue is -1"):
            zwang.judge_qp(numpy.diag([1.0, -1.0]), [0, 0], x=[0, 0])
        with self.assertRaisesRegex(ValueError, "symmetric"):
            zwang.judge_qp(numpy.triu(program["P"]), program["q"], x=program["q"])
        for name in ("h", "b", "q", "x"):
            with self.assertRaises(ValueError):
                zwang.judge_qp(**{**program, "x": program["q"], name: numpy.zeros(5)})
        for name in ("P", "q", "G", "h", "A", "b", "lb", "ub"):
            spoilt = {**program, name: numpy.full_like(program[name], math.nan)}
            with self.assertRaisesRegex(ValueError, rf"^{name}(\(0\))? is nan; expected a number$"):
                zwang.judge_qp(**spoilt, x=program["q"])
        impossible = zwang.judge_qp(numpy.eye(1), [0], G=[[1], [-1]], h=[-1, -1], x=[0])
        self.assertEqual(impossible.verdict, "wrong")

    def test_linear_programs(self):
        corner = dict(P=numpy.zeros((2, 2)), q=[-1, -2], G=[[1, 1]], h=[1], lb=[0, 0])
        judged = zwang.judge_qp(**corner, x=[0, 1])
        self.assertEqual((judged.verdict, judged.program, judged.unique), ("solved", "solvable", True), str(judged))
        self.assertLess(judged.objective_at_least, -2)
        self.assertGreater(judged.objective_at_most, -2)
        self.assertLess(judged.objective_at_most - judged.objective_at_least, 1e-15)
        for x, verdict in [([0, 1 - 1e-4], "wrong"), ([0, 1 - 1e-7], "near"), ([0, 1 - 1e-12], "solved"),
                           ([0, 1 + 1e-4], "wrong"), ([1, 0], "wrong"), ([math.nan, 1], "wrong")]:
            self.assertEqual(zwang.judge_qp(**corner, x=x).verdict, verdict)
        judged = zwang.judge_qp(**corner, x=[0, 1 + 1e-4])
        self.assertEqual(judged.worst_row, "inequality/0")
        self.assertAlmostEqual(judged.primal / (1e-4 / math.sqrt(2)), 1, 6)
        self.assertAlmostEqual(judged.objective_error / 1e-4, 1, 6)
        side = {**corner, "q": [-1, -1]}
        for x in ([0, 1], [1, 0], [0.3, 0.7]):
            judged = zwang.judge_qp(**side, x=x)
            self.assertEqual((judged.verdict, judged.unique), ("solved", False), str(judged))
        self.assertIn("not unique", str(judged))
        with self.assertRaisesRegex(ValueError, "x should have 2 entries"):
            zwang.judge_qp(**corner, x=[1])

    def test_programs_without_a_solution(self):
        q, J = numpy.array([-1.0, -2.0]), numpy.array([[1.0, -1.0]])
        falls = zwang.judge_qp(numpy.zeros((2, 2)), q, J, [1], lb=[0, 0], x=[1, 0])
        self.assertEqual((falls.verdict, falls.program), ("wrong", "unbounded"), str(falls))
        self.assertIn("unbounded", str(falls))
        d = falls.certificate
        self.assertTrue(q @ d < 0 and (J @ d <= 0).all() and (d >= 0).all())
        flat = zwang.judge_qp(numpy.ones((2, 2)), [-1, 1], x=[0.5, 0.5])
        self.assertEqual(flat.program, "unbounded")
        self.assertEqual(flat.certificate.sum(), 0)
        none = zwang.judge_qp(numpy.zeros((2, 2)), [0, 0], A=[[1, 1]], b=[-1], lb=[0, 0], x=[0, 0])
        self.assertEqual((none.verdict, none.program), ("wrong", "infeasible"), str(none))
        weights = none.certificate  # of the equality, x0 >= 0, x1 >= 0
        self.assertTrue((weights[1:] >= 0).all() and -weights[0] > 0)
        self.assertTrue(numpy.array_equal(weights[0] + weights[1:], [0, 0]))
        # Unbounded, were it feasible.
        both = zwang.judge_qp(numpy.zeros((2, 2)), [-1, 0], A=[[0, 1], [0, 1]], b=[0, 1], x=[0, 0])
        self.assertEqual(both.program, "infeasible")

    def test_singular_quadratic_programs(self):
        ridge = dict(P=numpy.ones((2, 2)), q=[-1, -1], lb=[0, 0])
        for x in ([0.5, 0.5], [1, 0]):
            judged = zwang.judge_qp(**ridge, x=x)
            self.assertEqual((judged.verdict, judged.unique, judged.at_least), ("solved", False, 0), str(judged))
        judged = zwang.judge_qp(**ridge, x=[0.5, 0.5 + 1e-4])
        self.assertEqual(judged.verdict, "wrong")
        self.assertAlmostEqual(judged.at_most * judged.scale_over_answer / 1e-4, 1, 6)
        self.assertAlmostEqual(judged.at_least * judged.scale_over_answer / 1e-4, 1, 6)
        # x0 is seen by P; x1 is held by its bound alone, x2 by nothing.
        part = dict(P=numpy.diag([2.0, 0, 0]), q=[-2, 3, 0], lb=[-numpy.inf, 0, -1], ub=[numpy.inf, 5, 1])
        self.assertFalse(zwang.judge_qp(**part, x=[1, 0, 0.5]).unique)
        self.assertTrue(zwang.judge_qp(**{**part, "q": [-2, 3, 1]}, x=[1, 0, -1]).unique)
        # Planted: B'B of rank 4 in 7 unknowns, rows that hold with forces.
        draw = numpy.random.default_rng(5)
        for _ in range(20):
            B, G = draw.integers(-3, 4, (4, 7)).astype(float), draw.integers(-3, 4, (6, 7)).astype(float)
            x, force = draw.integers(-2, 3, 7).astype(float), draw.integers(0, 3, 6).astype(float)
            P, h = B.T @ B, G @ x + numpy.where(force > 0, 0, draw.integers(0, 2, 6))
            q = -P @ x - G.T @ force
            judged = zwang.judge_qp(P, q, G, h, x=x)
            self.assertEqual((judged.verdict, judged.at_most < 1e-30), ("solved", True), str(judged))
            self.assertTrue(judged.objective_at_least <= x @ P @ x / 2 + q @ x <= judged.objective_at_most)
            d = draw.normal(size=7)
            moved = zwang.judge_qp(P, q, G, h, x=x + 1e-6 * d)
            self.assertAlmostEqual(moved.at_most * moved.scale / (1e-6 * numpy.linalg.norm(B @ d)), 1, 6)

    def test_indefinite_by_rounding_or_truly(self):
        for tiny in (1e-16, 1e-13):
            judged = zwang.judge_qp(numpy.diag([1.0, -tiny]), [-1, 0], lb=[-1, -1], ub=[1, 1], x=[1, 0.5])
            self.assertEqual((judged.verdict, judged.changed), ("solved", tiny), str(judged))
            self.assertIn("semidefinite matrix that differs by", str(judged))
        for tiny in (1e-10, 1e-3):
            with self.assertRaisesRegex(ValueError, f"smallest eigenvalue is -{tiny:.3g}, and d'Pd = .* without error"):
                zwang.judge_qp(numpy.diag([1.0, -tiny]), [-1, 0], lb=[-1, -1], ub=[1, 1], x=[1, 0.5])
        thirds = numpy.array([[1, 1 / 3], [2 / 3, 0.1], [0.7, 0.9]])
        judged = zwang.judge_qp(thirds @ thirds.T, [1, 2, 3], lb=[-1, -1, -1], ub=[1, 1, 1], x=[0, 0, 0])
        self.assertEqual(judged.program, "solvable", str(judged))
        self.assertLess(judged.changed, 1e-15)

    def test_no_call_crashes(self):
        draw = random.Random(3)
        odd = [None, 0, -1, 3.5, math.nan, "x", b"y", [], [[]], [1, 2], [[1, 2], [3, 4]], numpy.zeros((0, 2)),
               numpy.zeros(3, dtype=complex), numpy.array([object()]), numpy.zeros((2, 2, 2)), numpy.ones(2)[::-1],
               numpy.array([1, 2], dtype=numpy.int8), scipy.sparse.eye(2), scipy.sparse.random(2, 3, 0.5),
               scipy.sparse.coo_matrix((2, 2)), numpy.full(2, numpy.inf), True, {}, lambda: 0, "1e400", 10**400]
        bad_csr = scipy.sparse.csr_matrix(numpy.eye(2))
        bad_csr.indices[:] = 77
        odd.append(bad_csr)
        problem = zwang.scene("tower(boxes=2)")
        calls = [lambda v: zwang.Problem(v(), v(), v(), v(), equality=v()), lambda v: zwang.Problem(numpy.eye(2), [0, 0], v(), v()),
                 lambda v: zwang.judge(problem, v(), v()), lambda v: zwang.judge_qp(v(), v(), v(), v(), x=v()),
                 lambda v: zwang.judge_qp(numpy.eye(2), [1, 2], v(), v(), v(), v(), v(), v(), x=v(), y=v(), z=v(), z_box=v()),
                 lambda v: zwang.solve(problem, warm_start=v()), lambda v: zwang.solve(v()), lambda v: zwang.scene(v()),
                 lambda v: zwang.load(v()), lambda v: zwang.save("/nonexistent/x.h5", v())]
        for _ in range(1500):
            try:
                draw.choice(calls)(lambda: draw.choice(odd))
            except (ValueError, TypeError, OverflowError, RuntimeError, OSError, AttributeError, IndexError) as expected:
                self.assertTrue(str(expected))
        for made in (zwang.Problem, zwang.Solution, zwang.Judgement):
            for bare in (made.__new__, object.__new__):
                with self.assertRaises(TypeError):
                    bare(made)
        for spoilt in (lambda: zwang.solve(problem, None), lambda: zwang.bench("tower(boxes=2)", solvers=[3])):
            with self.assertRaisesRegex(TypeError, "should be"):
                spoilt()
        gc.collect()


def load_tests(loader, tests, ignore):
    tests.addTests(doctest.DocTestSuite(zwang))
    return tests


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
