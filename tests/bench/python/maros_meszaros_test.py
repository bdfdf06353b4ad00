"""judge_qp on the problems of Maros and Meszaros, and on the linear programs that they are without P, with answers of solvers that are not zwang's, spoilt by
known errors. Run by ctest with PYTHONPATH set to the built package and the folder of recorded data as its argument."""
import glob
import math
import os
import re
import sys
import unittest
from fractions import Fraction

import numpy
import scipy.io
import scipy.optimize
import scipy.sparse

import zwang
import zwang.formats
import zwang.semidefinite

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


class NoSolution(Exception):
    pass


def by_scipy(program, problem):
    """HiGHS where P = 0, else Kraft's SLSQP, of programs that it solves in seconds."""
    P, q, G, h, A, b = (program[name] for name in ("P", "q", "G", "h", "A", "b"))
    n = len(q)
    low, high = (v if v is not None else numpy.full(n, s * numpy.inf) for v, s in ((program["lb"], -1), (program["ub"], 1)))
    if P.nnz == 0:
        found = scipy.optimize.linprog(q, G, h, A, b, bounds=numpy.c_[low, high], method="highs")
        if found.status in (2, 3):
            raise NoSolution({2: "infeasible", 3: "unbounded"}[found.status])
        return found.x if found.status == 0 else None
    if n > 90:
        return None
    G, A = G.toarray(), A.toarray()
    rows = [{"type": "ineq", "fun": lambda x: h - G @ x, "jac": lambda x: -G},
            {"type": "eq", "fun": lambda x: A @ x - b, "jac": lambda x: A}]
    found = scipy.optimize.minimize(lambda x: x @ (P @ x) / 2 + q @ x, numpy.clip(numpy.zeros(n), low, high), method="SLSQP",
                                    jac=lambda x: P @ x + q, bounds=list(zip(low, high)),
                                    constraints=[row for row, right in zip(rows, (h, b)) if len(right)],
                                    options={"ftol": 1e-15, "maxiter": 300})
    return found.x if numpy.isfinite(found.x).all() else None


def published():
    """The least objectives, to eight digits."""
    with open(os.path.join(DATA, "qp_maros_meszaros", "maros_meszaros_00readme.txt"), encoding="latin-1") as lines:
        table = [line.split() for line in lines]
    return {words[0]: float(words[6]) for words in table
            if len(words) == 7 and re.fullmatch(r"-?\d\.\d+e[+-]\d+", words[6])}


class Known:
    """What an answer is off, in rationals, given the truth of zwang.semidefinite."""

    def __init__(self, program):
        given = zwang.semidefinite.Program.of(**{k: v if v is not None else numpy.zeros(0) for k, v in program.items()})
        self.truth = zwang.semidefinite.truth_of(given)
        self.given, self.P = given, scipy.sparse.csr_matrix(program["P"])
        if self.truth.solved is None:
            return
        unit = Fraction(1, 2**zwang.semidefinite.DIGITS)
        self.x = [a * unit for a in self.truth.solved.x[:len(given.q)]]
        self.forces = [a * unit for a in self.truth.solved.multipliers]
        self.doubles = numpy.array([float(a) for a in self.x])
        self.terms = float(self.squared(self.x)) / 2 + abs(given.q) @ abs(self.doubles)

    @staticmethod
    def times(A, v):
        A = scipy.sparse.csr_matrix(A)
        return [sum((Fraction(a) * v[j] for j, a in zip(A.indices[s:e].tolist(), A.data[s:e].tolist())), Fraction(0))
                for s, e in zip(A.indptr, A.indptr[1:])]

    def squared(self, d):
        return sum((a * b for a, b in zip(d, self.times(self.P, d))), Fraction(0))

    def objective(self, x):
        return self.squared(x) / 2 + sum((Fraction(a) * b for a, b in zip(self.given.q.tolist(), x)), Fraction(0))

    def conditions(self):
        """The largest violation of the conditions of Karush, Kuhn and Tucker, given the forces."""
        g = self.given
        slack = [a - Fraction(c) for a, c in zip(self.times(g.J, self.x), g.c.tolist())]
        pull = self.times(g.J.T, self.forces[:len(g.c)])
        balance = [a + Fraction(q) - f for a, q, f in zip(self.times(self.P, self.x), g.q.tolist(), pull)]
        return max(abs(a) for a in balance + [s if e else min(s, 0) for s, e in zip(slack, g.equal)]
                   + [Fraction(0)] + [min(f, 0) for f, e in zip(self.forces, g.equal) if not e]
                   + [f * s for f, s in zip(self.forces, slack)])

    def off(self, x):
        """Distance in P's part, violation, error of the objective, each over its scale."""
        exact = [Fraction(a) for a in x.tolist()]
        terms = self.terms or float(self.squared(exact)) / 2 + abs(self.given.q) @ abs(x) or 1
        apart = math.sqrt(self.squared([a - b for a, b in zip(exact, self.x)])) / math.sqrt(2 * terms)
        slack = [float(a - Fraction(c)) for a, c in zip(self.times(self.given.J, exact), self.given.c.tolist())]
        norms = numpy.sqrt(numpy.asarray(self.given.J.multiply(self.given.J).sum(axis=1)).ravel())
        broken = numpy.where(self.given.equal, numpy.abs(slack), numpy.maximum(numpy.negative(slack), 0))
        worst = (broken / numpy.where(norms > 0, norms, 1)).max(initial=0) / (numpy.linalg.norm(self.doubles) or numpy.linalg.norm(x) or 1)
        return apart, worst, float(abs(self.objective(exact) - self.objective(self.x))) / terms


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

    def judge_spoilt(self, file, program, known, answer, solver, claims):
        for off in (0, 1e-12, 1e-8, 1e-4):
            d = numpy.random.default_rng(len(answer)).normal(size=len(answer))
            spoilt = answer + d * (off * numpy.linalg.norm(answer) / numpy.linalg.norm(d))
            errors = known.off(spoilt)
            judged = zwang.judge_qp(**program, x=spoilt, tolerance=TOLERANCE)
            what = f"{file}, {solver} spoilt by {off}, off by {errors}: {judged}"
            self.assertLessEqual(judged.at_least, errors[0] * (1 + 1e-9) + 1e-30, what)
            self.assertGreaterEqual(judged.at_most, errors[0] * (1 - 1e-9), what)
            self.assertLessEqual(judged.at_most, errors[0] * 1.001 + 1e-30, "the bound is sharp: " + what)
            self.assertAlmostEqual(judged.primal / (errors[1] or 1), 1 if errors[1] else 0, 6, what)
            self.assertAlmostEqual(judged.objective_error / (errors[2] or 1), 1 if errors[2] else 0, 6, what)
            error = max(errors)
            expected = "solved" if error < RIGHT else "near" if error < NEAR else "wrong"
            if min(abs(math.log(max(error, 1e-16) / edge)) for edge in (RIGHT, NEAR)) > 0.01:
                self.assertEqual(judged.verdict, expected, what)
            claims.append((file, solver, off, *errors, judged.verdict))

    def test_singular_and_linear_programs(self):
        solvers = {"scipy": by_scipy, **({"cvxopt": by_cvxopt} if "cvxopt" in outside_solvers() else {})}
        optima, claims, counts, undecided = published(), [], {}, []
        for file in FILES:
            name = os.path.basename(file)[:-4]
            program = program_of(file)
            linear = {**program, "P": scipy.sparse.csc_matrix(program["P"].shape)}
            for kind, stated in (("quadratic", program), ("linear", linear)):
                if kind == "quadratic":
                    try:
                        zwang.load(file)
                        continue
                    except zwang.BadFile:
                        pass
                    if name == "VALUES":
                        with self.assertRaisesRegex(ValueError, "P is not positive semidefinite: .* without error"):
                            zwang.judge_qp(**stated, x=numpy.zeros(len(program["q"])))
                        continue
                known = Known(stated)
                state = known.truth.state or ("solvable" if known.truth.solved else "undecided")
                counts[kind, state] = counts.get((kind, state), 0) + 1
                answers, said = {}, None
                for word, solve in solvers.items():
                    try:
                        answers[word] = solve(stated, None)
                    except NoSolution as why:
                        said = str(why)
                if state == "undecided":
                    undecided.append((name, kind, known.truth.why))
                    self.assertTrue(known.truth.why)
                elif state != "solvable":
                    self.assertEqual((kind, said), ("linear", state), name)
                else:
                    if known.truth.changed == 0:
                        self.assertLess(known.conditions(), Fraction(1, 2**200), name)
                    if kind == "quadratic" and len(known.x) <= 150:
                        # x* solves the strictly convex program with |x - x*|^2 added: the referee's own 100 digits.
                        stiff = 2.0**round(math.log2(abs(stated["P"]).max()))
                        near = {**stated, "P": stated["P"] + stiff * scipy.sparse.identity(len(known.x)),
                                "q": stated["q"] - stiff * known.doubles}
                        self.assertLess(zwang.judge_qp(**near, x=known.doubles).at_most, 1e-14, name)
                    least = float(known.truth.least)
                    if kind == "quadratic":
                        constant = float(scipy.io.loadmat(file)["r"].reshape(-1)[0])
                        goal = optima[name.lower().replace("_", "")]
                        self.assertLess(abs(least + constant - goal), 1e-7 * max(abs(goal), abs(constant), 1), name)
                    self.assertIsNone(said, name)
                    for word, x in answers.items():
                        if x is None:
                            continue
                        self.judge_spoilt(f"{name}, {kind}", stated, known, x, word, claims)
        if os.environ.get("ZWANG_VERBOSE"):
            for claim in claims:
                print("%-22s %-8s spoilt by %-6g off by %-9.2e %-9.2e %-9.2e %s" % claim)
            print(counts, undecided)
        self.assertGreaterEqual(len(claims), 100)
        self.assertEqual(sum(k for (kind, _), k in counts.items() if kind == "quadratic"), 20)
        self.assertLessEqual(len([1 for _, kind, _ in undecided if kind == "quadratic"]), 3)

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
