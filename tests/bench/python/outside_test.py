"""What the module exchanges with other people's programs: libfclib, qpbenchmark, qpsolvers. Where one of them is not
installed, what only it can say is skipped. Run by ctest with PYTHONPATH set to the built package."""
import csv
import ctypes
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
from fractions import Fraction

import numpy
import scipy.sparse

import zwang
import zwang.formats

HERE = pathlib.Path(__file__).parent
REAL_QPSOLVERS = importlib.util.find_spec("qpsolvers") is not None
if not REAL_QPSOLVERS:
    sys.path.insert(0, str(HERE / "stand_in"))
import qpsolvers  # noqa: E402

import zwang.qpsolvers  # noqa: E402


class Matrix(ctypes.Structure):
    _fields_ = [("nzmax", ctypes.c_int), ("m", ctypes.c_int), ("n", ctypes.c_int), ("p", ctypes.POINTER(ctypes.c_int)),
                ("i", ctypes.POINTER(ctypes.c_int)), ("x", ctypes.POINTER(ctypes.c_double)), ("nz", ctypes.c_int),
                ("info", ctypes.c_void_p)]

    def dense(self):
        parts = [numpy.ctypeslib.as_array(part, (self.nz,)) for part in (self.x, self.i, self.p)]
        return scipy.sparse.coo_matrix((parts[0], (parts[1], parts[2])), shape=(self.m, self.n)).toarray()


Numbers, AMatrix = ctypes.POINTER(ctypes.c_double), ctypes.POINTER(Matrix)


class Global(ctypes.Structure):
    _fields_ = [("M", AMatrix), ("H", AMatrix), ("G", AMatrix), ("mu", Numbers), ("f", Numbers), ("b", Numbers),
                ("w", Numbers), ("spacedim", ctypes.c_int), ("info", ctypes.c_void_p)]


class Local(ctypes.Structure):
    _fields_ = [("W", AMatrix), ("V", AMatrix), ("R", AMatrix), ("mu", Numbers), ("q", Numbers), ("s", Numbers),
                ("spacedim", ctypes.c_int), ("info", ctypes.c_void_p)]


def libfclib():
    try:
        library = ctypes.CDLL("libfclib.so.0")
    except OSError:
        raise unittest.SkipTest("libfclib is not installed") from None
    library.fclib_read_global.restype = ctypes.POINTER(Global)
    library.fclib_read_local.restype = ctypes.POINTER(Local)
    return library


def same_bits(test, one, other):
    test.assertEqual(numpy.ascontiguousarray(one, float).tobytes(), numpy.ascontiguousarray(other, float).tobytes())


def equalities_first(problem):
    order = numpy.r_[numpy.flatnonzero(problem.equality), numpy.flatnonzero(~problem.equality)]
    return problem.J[order].toarray(), problem.c[order]


class Layouts(unittest.TestCase):
    def test_a_contact_that_bounds_nothing_is_left_out_with_its_tangents(self):
        rows = [2, 0, 1, 5, 3, 4, 8, 6, 7]
        for idle in ([1], [0], [2], [0, 1], [0, 1, 2]):
            c = numpy.zeros(9)
            c[[3 * k for k in idle]] = -numpy.inf
            problem = zwang.Problem(numpy.eye(9), [1, 2, -3] * 3, J=numpy.eye(9)[rows], c=c, tangent=[False, True, True] * 3, mu=[.5, 0, 0] * 3)
            with tempfile.TemporaryDirectory() as folder:
                zwang.formats.save_fclib(f"{folder}/a.hdf5", problem)
                [read] = zwang.load(f"{folder}/a.hdf5")
            self.assertEqual(read.rows, 3 * (3 - len(idle)))
            numpy.testing.assert_allclose(zwang.solve(read, "cone").z, zwang.solve(problem, "cone").z, rtol=1e-12)

    def test_a_row_type_that_is_none_is_named(self):
        lines = ["NAME", "ROWS", " N cost", " LE r", "COLUMNS", " x r 1", "RHS", " b r 1", "QUADOBJ", " x x 1", "ENDATA"]
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "a.qps")
            file.write_text("\n".join(lines))
            with self.assertRaisesRegex(ValueError, "line 4: ROWS: cannot read 'LE r' .*expected N, L, G or E"):
                zwang.load(file)
            file.write_text("\n".join(lines).replace("LE", "L"))
            self.assertEqual(zwang.load(file)[0].rows, 2)


class Fclib(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.file = os.path.join(self.folder.name, "problem.hdf5")
        self.problem = zwang.scene("hand(contacts=4)")
        self.equal = self.problem.equality
        self.addCleanup(self.folder.cleanup)

    def test_libfclib_reads_a_global_file(self):
        library, p = libfclib(), self.problem
        zwang.formats.save_fclib(self.file, p, mu=0.25)
        read = library.fclib_read_global(self.file.encode()).contents
        contacts, equalities = int((~self.equal).sum()), int(self.equal.sum())
        self.assertEqual(read.spacedim, 3)
        same_bits(self, read.M.contents.dense(), p.M.toarray())
        same_bits(self, read.G.contents.dense(), p.J[self.equal].toarray().T)
        H = read.H.contents.dense()
        same_bits(self, H[:, ::3], p.J[~self.equal].toarray().T)
        self.assertEqual(numpy.count_nonzero(H[:, 1::3]) + numpy.count_nonzero(H[:, 2::3]), 0)
        vector = numpy.ctypeslib.as_array
        same_bits(self, vector(read.f, (p.size,)), p.M @ p.z_u)
        same_bits(self, vector(read.w, (3 * contacts,))[::3], -p.c[~self.equal])
        same_bits(self, vector(read.b, (equalities,)), -p.c[self.equal])
        same_bits(self, vector(read.mu, (contacts,)), numpy.full(contacts, 0.25))
        library.fclib_delete_global(ctypes.byref(read))

    def test_libfclib_reads_a_local_file(self):
        library, p = libfclib(), self.problem
        zwang.formats.save_fclib(self.file, p, form="local")
        read = library.fclib_read_local(self.file.encode()).contents
        N, E = p.J[~self.equal].toarray(), p.J[self.equal].toarray()
        inverse = numpy.linalg.inv(p.M.toarray())
        vector = numpy.ctypeslib.as_array
        W = read.W.contents.dense()
        same_bits(self, W, W.T)
        for found, true in ((W[::3, ::3], N @ inverse @ N.T), (read.V.contents.dense()[::3], N @ inverse @ E.T),
                            (read.R.contents.dense(), E @ inverse @ E.T),
                            (vector(read.q, (3 * len(N),))[::3], N @ p.z_u - p.c[~self.equal]),
                            (vector(read.s, (len(E),)), E @ p.z_u - p.c[self.equal])):
            self.assertLessEqual(abs(found - true).max(), 1e-11 * abs(true).max())
        library.fclib_delete_local(ctypes.byref(read))

    def test_a_global_file_comes_back_bit_for_bit(self):
        for scene in ("hand(contacts=4)", "chain(links=3)", "tower(boxes=2)"):
            p = zwang.scene(scene)
            zwang.formats.save_fclib(self.file, p)
            (again,) = zwang.load(self.file)
            same_bits(self, again.M.toarray(), p.M.toarray())
            same_bits(self, again.z_u, p.z_u)
            for read, written in zip(equalities_first(again), equalities_first(p)):
                same_bits(self, read, written)

    def test_a_local_file_is_the_same_problem(self):
        p = self.problem
        zwang.formats.save_fclib(self.file, p, form="local")
        (again,) = zwang.load(self.file)
        ours, theirs = zwang.solve(p), zwang.solve(again)
        # Of z only the energy is left: |z - z_u|_M.
        d = ours.z - p.z_u
        self.assertAlmostEqual(numpy.linalg.norm(theirs.z) / numpy.sqrt(d @ p.M @ d), 1, 9)

    def test_a_law_that_the_layout_cannot_say_is_refused(self):
        block = zwang.scene("incline(slope=0.5)", mu=0.25)
        with self.assertRaisesRegex(ValueError, "^.*FCLIB means Coulomb's law, and this problem's is convex; save .*$"):
            zwang.formats.save_fclib(self.file, block.under("convex"))
        self.assertFalse(os.path.exists(self.file))
        zwang.formats.save_fclib(self.file, block.under("convex").under("coulomb"))
        self.assertEqual(zwang.load(self.file)[0].law, "coulomb")

    def test_tangents_that_do_not_fit_the_layout_come_back_as_is_said(self):
        rows = dict(J=numpy.eye(8), c=numpy.zeros(8), tangent=[False, True, True, False, True, False, True, True], mu=[.5, 0, 0, .25, 0, 0, 0, 0])
        zwang.formats.save_fclib(self.file, zwang.Problem(numpy.eye(8), numpy.arange(8.0), **rows))
        (again,) = zwang.load(self.file)
        self.assertEqual(again.tangent.tolist(), [False, True, True, False, True, True, False])
        self.assertEqual((numpy.count_nonzero(again.J.toarray()[5]), again.mu[3], again.mu[6]), (0, 0.25, 0))

    def test_a_negative_mu_is_one_line(self):
        with self.assertRaisesRegex(ValueError, "mu is negative"):
            zwang.formats.save_fclib(self.file, self.problem, mu=-1)


class Programs(unittest.TestCase):
    """QPS, .npz and Matrix Market: what a file says is read or refused, and nothing is left out."""
    QPS = ("NAME T\nROWS\n N obj\n G r1\nCOLUMNS\n x obj -2 r1 1\n y obj -8 r1 1\nRHS\n RHS r1 1\nQUADOBJ\n x x 2\n y y 4\n"
           "BOUNDS\n LO BND x 1\n LO BND y 75\nENDATA\n")

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def of_qps(self, text):
        (self.folder / "t.qps").write_text(text)
        return zwang.load(self.folder / "t.qps")[0]

    def refused(self, file, says):
        with self.assertRaisesRegex(zwang.BadFile, says) as refused:
            zwang.load(file)
        self.assertTrue(str(refused.exception).startswith(str(file)) and "\n" not in str(refused.exception), refused.exception)

    def test_what_a_qps_says_is_read_or_refused(self):
        problem = self.of_qps(self.QPS)
        self.assertEqual(((-problem.M @ problem.z_u).tolist(), problem.c.tolist()), ([-2, -8], [1, 1, 75]))
        turned = self.QPS.replace("obj -", "obj ").replace("x x 2", "x x -2").replace("y y 4", "y y -4")
        for sense in ("OBJSENSE\n    MAX\n", "OBJSENSE MAXIMIZE\n"):
            self.assertEqual(self.of_qps(turned.replace("ROWS", sense + "ROWS", 1)).sha256, problem.sha256)
        for old, new, says in (("ENDATA", "QCMATRIX r1\n x x 1\nENDATA", "line 16: QCMATRIX"), ("BOUNDS", "BOUND", "line 13: BOUND"),
                               ("5\nENDATA\n", "", "no ENDATA"), (" LO BND y 75\nENDATA\n", "", "no ENDATA"),
                               ("RHS r1 1", "RHS r1 nan", "line 9"), ("RHS r1 1", "RHS r1 inf", "row 0 is inf"),
                               ("BND y 75", "BND y nan", "line 15"), ("ROWS", "OBJSENSE\n odd\nROWS", "line 3"), ("NAME T", "NAME T\n x", "line 2")):
            (self.folder / "bad.qps").write_text(self.QPS.replace(old, new, 1))
            self.refused(self.folder / "bad.qps", says)

    def test_no_part_of_an_npz_is_left_out(self):
        file, program = self.folder / "t.npz", {"P": numpy.diag([2.0, 4]), "q": numpy.array([-2.0, -8])}
        for lb, c in ((numpy.array(5.0), [5, 5]), (numpy.array(None), []), (numpy.array([5.0, -numpy.inf]), [5])):
            numpy.savez(file, **program, lb=lb)
            self.assertEqual(zwang.load(file)[0].c.tolist(), c)
        for bad, says in (({"lb": numpy.array([5, None])}, "lb holds objects"), ({"h": [numpy.nan], "G": [[1, 1]]}, r"h\(0\) is nan")):
            numpy.savez(file, **program, **bad)
            self.refused(file, says)
        whole = file.read_bytes()
        for part in (0.1, 0.5, 0.9):
            file.write_bytes(whole[:int(part * len(whole))])
            self.refused(file, "")
        numpy.savez(file, P=[[3e-20]], q=[1.0])
        (note,) = zwang.load(file)[0].notes
        off = Fraction(float(zwang.load(file)[0].z_u[0])) + 1 / Fraction(3e-20)
        self.assertTrue(0 < off**2 * Fraction(3e-20) <= Fraction(note.rsplit(" ", 1)[1])**2, note)

    def test_a_problem_without_rows_comes_back_from_matrix_market(self):
        free = zwang.Problem(numpy.eye(3), [1, 2, 3])
        zwang.formats.save_matrix_market(self.folder / "free", free)
        self.assertEqual(zwang.load(self.folder / "free")[0].sha256, free.sha256)
        with self.assertRaisesRegex(ValueError, "no unknowns"):
            zwang.formats.save_matrix_market(self.folder / "none", zwang.Problem(numpy.eye(0), []))
        self.assertFalse((self.folder / "none").exists())

    def test_a_matrix_market_file_is_named(self):
        zwang.formats.save_matrix_market(self.folder / "box", zwang.scene("tower(boxes=1)"))
        (self.folder / "box" / "c.mtx").write_text("%%MatrixMarket matrix array\n")
        self.refused(self.folder / "box", "c.mtx: not of Matrix Market's format")


class TestSet(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.place = pathlib.Path(self.folder.name) / "contact_qpbenchmark"
        self.problems = [zwang.scene("hand(contacts=4)"), zwang.scene("tower(boxes=2)"), zwang.scene("chain(links=3)")]
        zwang.formats.save_qpbenchmark(self.place, self.problems)

    def test_every_bit_comes_back(self):
        files = sorted((self.place / "data").iterdir())
        self.assertEqual(len(files), 3)
        for file, problem in zip(files, self.problems):
            (again,) = zwang.load(file)
            self.assertEqual(again.sha256, problem.sha256)
            self.assertEqual(again.name, problem.name)

    def test_the_program_is_the_same(self):
        for file, problem in zip(sorted((self.place / "data").iterdir()), self.problems):
            with numpy.load(file, allow_pickle=False) as parts:
                same_bits(self, parts["q"], -(problem.M @ problem.z_u))
                same_bits(self, parts["h"], -problem.c[~problem.equality])
                self.assertEqual(len(parts["A_indptr"]), problem.equality.sum() + 1)

    @unittest.skipUnless(importlib.util.find_spec("qpbenchmark") and REAL_QPSOLVERS, "qpbenchmark is not installed")
    def test_qpbenchmark_runs_it_as_it_is(self):
        # numpy before 1.25 has no numpy.dtypes, which qpbenchmark asks for.
        shim = ("import numpy, types\n"
                "if not hasattr(numpy, 'dtypes'): numpy.dtypes = types.SimpleNamespace(BoolDType=type(numpy.dtype(bool)))\n")
        place, results = str(self.place / "contact_qpbenchmark.py"), str(self.place / "results" / "contact_qpbenchmark.csv")

        def python(program, *words):
            done = subprocess.run([sys.executable, "-c", shim + program, *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            return done.stdout
        listed = python("from qpbenchmark.benchmark import main; main()", place, "list_problems")
        self.assertEqual(listed.splitlines(), [p.name for p in self.problems])
        python("import qpbenchmark, sys\n"
               "from qpbenchmark.benchmark import load_test_set\n"
               "tests = load_test_set(sys.argv[1])\n"
               "results = qpbenchmark.Results(sys.argv[2], tests)\n"
               "qpbenchmark.run(tests, results)\n"
               "results.write()\n", place, results)
        with open(results, encoding="utf-8") as lines:
            rows = list(csv.DictReader(lines))
        ours = [row for row in rows if row["solver"] == "zwang"]
        self.assertEqual(len(ours), 3 * 4)  # four settings of qpbenchmark
        for row in ours:
            self.assertEqual(row["found"], "True", row)
            for residual in ("primal_residual", "dual_residual", "duality_gap"):
                self.assertLess(float(row[residual]), 1e-9, row)


def random_program(seed, bounds=True):
    draw = numpy.random.default_rng(seed)
    n = 10
    L, x0 = draw.normal(size=(n, n)), draw.normal(size=n)
    G, A = draw.normal(size=(6, n)), draw.normal(size=(2, n))
    h = G @ x0 + draw.uniform(0, 0.3, 6)
    h[5] = numpy.inf
    box = [x0 - draw.uniform(0, 2, n), numpy.where(draw.uniform(size=n) < 0.5, numpy.inf, x0 + 0.1)] if bounds else []
    return qpsolvers.Problem(L @ L.T + numpy.eye(n), draw.normal(size=n) * 3, G, h, A, A @ x0, *box)


class Qpsolvers(unittest.TestCase):
    def test_zwang_is_a_solver_of_qpsolvers(self):
        names = zwang.qpsolvers.register()
        self.assertIn("zwang", names)
        self.assertEqual(zwang.qpsolvers.register().count("zwang"), 1)
        for seed in range(4):
            problem = random_program(seed, seed % 2 == 0)
            for algorithm in ("dual_active_set", "newton"):
                answer = qpsolvers.solve_problem(problem, solver="zwang", algorithm=algorithm)
                self.assertTrue(answer.found)
                self.assertLess(answer.primal_residual(), 1e-10)
                self.assertLess(answer.dual_residual(), 1e-10)
                judged = zwang.judge_qp(problem.P, problem.q, problem.G, problem.h, problem.A, problem.b, problem.lb,
                                        problem.ub, x=answer.x, y=answer.y, z=answer.z, z_box=answer.z_box)
                self.assertEqual(judged.verdict, "solved", str(judged))
                self.assertLess(judged.stationarity, 1e-10, "the multipliers have qpsolvers' signs")

    def test_what_has_no_solution_is_not_found(self):
        zwang.qpsolvers.register()
        problem = qpsolvers.Problem(numpy.eye(1), numpy.zeros(1), numpy.array([[1.0], [-1.0]]), numpy.array([-1.0, -1.0]))
        answer = qpsolvers.solve_problem(problem, solver="zwang")
        self.assertFalse(answer.found)
        self.assertIn("infeasible", answer.extras["status"])

    def test_a_solver_of_qpsolvers_is_one_of_a_bench(self):
        if REAL_QPSOLVERS:
            others = [name for name in qpsolvers.available_solvers if name != "zwang"]
            if not others:
                self.skipTest("qpsolvers finds no solver")
            name = others[0]
        else:
            name = "stands_in"
            qpsolvers.solvers.solve_function[name] = zwang.qpsolvers.solve_problem
            qpsolvers.available_solvers.append(name)
            qpsolvers.dense_solvers.append(name)
        rows = zwang.bench("tower(boxes=2),chain(links=2)", solvers=[f"qpsolvers:{name}", "dual_active_set"],
                           tolerances=[1e-6], repetitions=1)
        found = [row for row in rows if row["solver"] == f"qpsolvers_{name}"]
        self.assertEqual(len(found), 2)
        for row in found:
            self.assertIn(row["verified"], ("solved", "near"), row["message"])
            self.assertLess(row["z_error"], 1e-4)
        with self.assertRaisesRegex(ValueError, "finds no solver 'nobody'"):
            zwang.bench("tower(boxes=2)", solvers=["qpsolvers:nobody"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
