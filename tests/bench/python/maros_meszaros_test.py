"""judge_qp on the strictly convex problems of Maros and Meszaros, with answers of solvers that are not zwang's, spoilt by
known errors. Run by ctest with PYTHONPATH set to the built package and the folder of recorded data as its argument."""
import glob
import math
import os
import sys
import unittest

import numpy
import scipy.io
import scipy.sparse

import zwang
import zwang.formats

DATA = sys.argv[1] if len(sys.argv) > 1 else ""
FILES = sorted(glob.glob(os.path.join(DATA, "qp_maros_meszaros", "*.mat")))
TOLERANCE = 1e-10
RIGHT, NEAR = 1e-9, 1e-6  # what judge calls solved and near at this tolerance


def program_of(file):
    parts = scipy.io.loadmat(file)
    return zwang.formats._two_sided(*(parts[name] for name in ("P", "q", "A", "l", "u")))


def by_zwangs_child(name):
    def solve(program, problem):
        answer = zwang.solve(problem, name, tolerance=1e-9)
        return answer.z if len(answer.z) == problem.size else None
    return solve


def by_cvxopt(program, problem):
    import cvxopt

    def sparse(A):
        A = scipy.sparse.coo_matrix(A)
        return cvxopt.spmatrix(A.data.tolist(), A.row.tolist(), A.col.tolist(), A.shape)
    n = len(program["q"])
    G, h = program["G"], program["h"]
    if program["lb"] is not None:
        I = scipy.sparse.identity(n, format="csr")
        low, high = numpy.isfinite(program["lb"]), numpy.isfinite(program["ub"])
        G = scipy.sparse.vstack([G, -I[low], I[high]])
        h = numpy.r_[h, -program["lb"][low], program["ub"][high]]
    cvxopt.solvers.options.update(show_progress=False, abstol=1e-9, reltol=1e-9, feastol=1e-9)
    equal = (sparse(program["A"]), cvxopt.matrix(program["b"])) if len(program["b"]) else ()
    try:
        answer = cvxopt.solvers.qp(sparse(program["P"]), cvxopt.matrix(program["q"]), sparse(G), cvxopt.matrix(h), *equal)
    except (ArithmeticError, ValueError):  # it breaks down
        return None
    return numpy.array(answer["x"]).reshape(-1)


def outside_solvers():
    there = {s["name"] for s in zwang.solvers()}
    found = {name: by_zwangs_child(name) for name in ("ipopt", "nlopt_slsqp", "daqp", "piqp", "osqp", "proxqp", "qpoases")
             if name in there}
    try:
        import cvxopt  # noqa: F401
        found["cvxopt"] = by_cvxopt
    except ImportError:
        pass
    return found


@unittest.skipUnless(FILES, "the problems of Maros and Meszaros are not there")
class MarosMeszaros(unittest.TestCase):
    def test_spoilt_answers_of_outside_solvers(self):
        judged, claims = 0, []
        solvers = outside_solvers()
        if len(solvers) < 2:
            self.skipTest("two solvers that are not zwang's are not there")
        for file in FILES:
            try:
                (problem,) = zwang.load(file)
            except zwang.BadFile:
                continue
            program = program_of(file)
            P, q = program["P"], program["q"]

            def norm(v):
                return math.sqrt(max(v @ (P @ v), 0))
            # The truth, certified in 100 digits to be within 1e-14.
            truth = zwang.solve(problem, tolerance=1e-12).z
            self.assertLess(zwang.judge(problem, truth).at_most, 1e-14, file)
            s = max(norm(problem.z_u), norm(truth))
            answers = {name: x for name, solve in solvers.items() if (x := solve(program, problem)) is not None}
            self.assertGreaterEqual(len(answers), 2, file)
            for name, x in answers.items():
                draw = numpy.random.default_rng(len(q))
                for off in (0, 1e-12, 1e-8, 1e-4):
                    d = draw.normal(size=len(q))
                    spoilt = x + d * (off * s / norm(d))
                    error = norm(spoilt - truth) / s
                    verdict = zwang.judge_qp(**program, x=spoilt, tolerance=TOLERANCE)
                    what = f"{os.path.basename(file)}, {name} spoilt by {off}, off by {error:.3g}: {verdict}"
                    self.assertLessEqual(verdict.at_least, error * (1 + 1e-9) + 1e-13, what)
                    self.assertGreaterEqual(verdict.at_most, error * (1 - 1e-9) - 1e-13, what)
                    self.assertLessEqual(verdict.at_most, 1.001 * error + 1e-13, "the bound is sharp: " + what)
                    expected = "solved" if error < RIGHT else "near" if error < NEAR else "wrong"
                    if min(abs(math.log(max(error, 1e-16) / edge)) for edge in (RIGHT, NEAR)) > 0.01:
                        self.assertEqual(verdict.verdict, expected, what)
                    self.assertIn(verdict.verdict, str(verdict))
                    judged += 1
                    claims.append((os.path.basename(file)[:-4], name, off, error, verdict.verdict))
        if os.environ.get("ZWANG_VERBOSE"):
            for claim in claims:
                print("%-9s %-8s spoilt by %-6g off by %-9.2e %s" % claim)
        self.assertGreaterEqual(judged, 10 * 2 * 4)

    # min 1/2 x'Px with one flat direction: x off by 1e-4 there leaves residuals of 1e-12.
    def test_a_small_residual_is_no_proof(self):
        P, q = numpy.diag([1.0, 1e-8]), numpy.array([0.0, -1e-8])
        spoilt = [0.0, 1 + 1e-4]
        self.assertLess(abs(P @ spoilt + q).max(), 1.1e-12)
        verdict = zwang.judge_qp(P, q, x=spoilt)
        self.assertEqual(verdict.verdict, "wrong", str(verdict))
        self.assertAlmostEqual(verdict.at_most / 1e-4, 1, 3)

    def test_the_scale_is_said_where_it_is_not_the_answers_own(self):
        # The unconstrained minimum is 1000 from a solution of size 1.
        verdict = zwang.judge_qp(numpy.eye(1), [-1000.0], G=[[1.0]], h=[1.0], x=[1 - 1e-4])
        self.assertAlmostEqual(verdict.scale_over_answer, 1000, 6)
        self.assertAlmostEqual(verdict.at_most * verdict.scale_over_answer / 1e-4, 1, 3)
        self.assertRegex(str(verdict), r"relative to max\(\|P\^-1 q\|, \|x\*\|\)\), 1e\+03 times that relative to \|x\*\|")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
