"""Derivatives against exact ones. Problems are planted: M = L L' of whole numbers with an inverse of whole numbers, so that a solution
and the modes of its contacts are chosen first, and all numbers of the problem are doubles. Run by ctest: gradient_test.py [thorough]."""
import itertools
import math
import random
import sys
import unittest
from fractions import Fraction

import numpy
import scipy.sparse

import zwang
from zwang.enclosure import Rows

MANY = "thorough" in sys.argv[1:]
PLANTED, TIED = (1200, 500) if MANY else (120, 60)
ALONG = [(3, 0), (-2, 0), (0, 1), (0, -4)]  # the edges of a pyramid
SLIPS = [(3, 4), (-4, 3), (5, -12), (-8, -15), (4, 3), (0, 5)]


def solve(rows, right):
    """x with rows x = right in fractions, or None."""
    n = len(rows)
    A = [[Fraction(v) for v in row] + [Fraction(b)] for row, b in zip(rows, right)]
    for k in range(n):
        pivot = next((i for i in range(k, n) if A[i][k]), None)
        if pivot is None:
            return None
        A[k], A[pivot] = A[pivot], A[k]
        A[k] = [v / A[k][k] for v in A[k]]
        for i in range(n):
            if i != k and A[i][k]:
                A[i] = [a - A[i][k] * b for a, b in zip(A[i], A[k])]
    return [row[n] for row in A]


def root(x):
    return Fraction(math.isqrt(x.numerator), math.isqrt(x.denominator))


def dot(a, b):
    return sum((Fraction(x) * Fraction(y) for x, y in zip(a, b)), Fraction(0))


class Planted:
    """modes: of each contact "open", "held", "slides", and the ties "touch", "apex", "edge"."""

    def __init__(self, seed, law, tie=None):
        draw = random.Random(f"{seed} {law} {tie}")
        self.law, n = law, draw.randint(4, 7)
        L = [[draw.randint(-1, 1) if j < i else int(i == j) for j in range(n)] for i in range(n)]
        self.M = [[sum(a * b for a, b in zip(r, s)) for s in L] for r in L]
        z = [draw.randint(-4, 4) for _ in range(n)]
        friction = law != "frictionless"
        self.J, self.c, self.force, self.equal, self.tangent, self.mu = [], [], [], [], [], []
        self.contacts = []

        def row(gap, push, equal=False, tangent=False, mu=0.0):
            J = [draw.randint(-2, 2) for _ in range(n)]
            self.J.append(J)
            self.c.append(float(sum(a * b for a, b in zip(J, z)) - Fraction(gap)))
            self.force.append(Fraction(push))
            self.equal.append(equal)
            self.tangent.append(tangent)
            self.mu.append(mu)
        for _ in range(draw.randint(0, 1)):
            row(0, draw.randint(-3, 3), equal=True)
        for k in range(draw.randint(1, 3)):
            several = draw.choice(["touch"] + ["edge"] * friction)
            mode = several if tie == "several" else tie if tie and k == 0 else draw.choice(["open", "held"] + ["slides"] * 2 * friction)
            planar, mu = draw.random() < 0.4, draw.choice([0.5, 0.25, 1.0])
            if mode == "apex" and not planar and draw.random() < 0.5:
                planar = True
            slip = [draw.choice([-3, 2])] if planar else list(draw.choice(SLIPS if law != "pyramid" else ALONG))
            r = abs(slip[0]) if planar else int((slip[0]**2 + slip[1]**2) ** 0.5)
            push = 4 * r * draw.randint(1, 3)
            lift = Fraction(mu) * r if law in ("convex", "pyramid") else 0
            first = len(self.J)
            if not friction:
                row(draw.randint(1, 4) if mode == "open" else 0, push if mode == "held" else 0)
                self.contacts.append((mode, first, [], 0.0))
                continue
            against = [-Fraction(mu) * push * Fraction(a, r) for a in slip]
            gap, s, f, t = {"open": (lift + draw.randint(1, 3), slip, 0, [0, 0]), "held": (0, [0, 0], push, [a / 2 for a in against]),
                            "slides": (lift, slip, push, against), "touch": (lift, slip, 0, [0, 0]), "apex": (0, [0, 0], 0, [0, 0]),
                            "edge": (0, [0, 0], push, against)}[mode]
            row(gap, f, mu=mu)
            for a, b, _ in zip(s, t, slip):
                row(a, b, tangent=True)
            self.contacts.append((mode, first, list(range(first + 1, len(self.J))), mu))
        if draw.random() < 0.3:  # other units, of each contact and of all masses
            heavy = 2.0 ** draw.randint(-20, 20)
            self.M = [[a * heavy for a in row] for row in self.M]
            self.force = [f * Fraction(heavy) for f in self.force]
            for rows in [[i] for i, equal in enumerate(self.equal) if equal] + [[i, *t] for _, i, t, _ in self.contacts]:
                unit = 2.0 ** draw.randint(-20, 20)
                for i in rows:
                    self.J[i], self.c[i], self.force[i] = [a * unit for a in self.J[i]], self.c[i] * unit, self.force[i] / Fraction(unit)
        self.z, self.n, self.m = z, n, len(self.J)
        pushed = [dot([r[j] for r in self.J], self.force) for j in range(n)]
        moved = solve(self.M, pushed)
        self.z_u = [float(a - b) for a, b in zip(z, moved)]
        assert all(Fraction(a) == b - c for a, b, c in zip(self.z_u, z, moved))
        self.problem = zwang.Problem(self.M, self.z_u, self.J, self.c, equality=self.equal, name=f"planted {law} {seed}",
                                     **(dict(tangent=self.tangent, mu=self.mu, law="convex" if law == "convex" else "coulomb") if any(self.tangent) else {}))
        half = [[draw.randint(-1, 1) for _ in range(n)] for _ in range(n)]
        self.change = {"dM": [[half[i][j] + half[j][i] for j in range(n)] for i in range(n)],
                       "dz_u": [draw.randint(-3, 3) for _ in range(n)], "dJ": [[draw.randint(-1, 1) for _ in range(n)] for _ in range(self.m)],
                       "dc": [draw.randint(-3, 3) for _ in range(self.m)],
                       "dmu": [draw.randint(-1, 1) if any(self.tangent[i + 1:i + 2]) and not self.tangent[i] else 0 for i in range(self.m)]}

    def given(self):
        return numpy.array(self.z, dtype=float), numpy.array([float(f) for f in self.force])

    def derivative(self, modes):
        """(dz, dlambda) of these modes in fractions, by their linear system in these unknowns alone; None where it is singular."""
        n, m, d = self.n, self.m, self.change
        rows, right = [], []

        def unit(i):
            return [int(k == n + i) for k in range(n + m)]

        def motion(i):
            return self.J[i] + [0] * m

        def level(i):
            return d["dc"][i] - dot(d["dJ"][i], self.z)
        for j in range(n):
            rows.append(list(self.M[j]) + [-self.J[i][j] for i in range(m)])
            right.append(dot(self.M[j], d["dz_u"]) + dot([r[j] for r in d["dJ"]], self.force)
                         - dot(d["dM"][j], [a - Fraction(b) for a, b in zip(self.z, self.z_u)]))
        for i in range(m):
            if self.equal[i]:
                rows.append(motion(i))
                right.append(level(i))
        for mode, (_, i, t, mu) in zip(modes, self.contacts):
            if mode == "open":
                for k in [i, *t]:
                    rows.append(unit(k))
                    right.append(0)
            elif mode == "held":
                for k in [i, *t]:
                    rows.append(motion(k))
                    right.append(level(k))
            elif self.law == "pyramid":
                mu, s = Fraction(mu), [dot(self.J[k], self.z) - Fraction(self.c[k]) for k in t]
                at = next(k for k, a in enumerate(s) if a)
                sign, k = -1 if s[at] > 0 else 1, t[at]
                rows.append([a + sign * mu * b for a, b in zip(motion(i), motion(k))])
                right.append(level(i) + sign * (mu * level(k) - d["dmu"][i] * s[at]))
                for j in t:
                    rows.append([a - sign * mu * b * (j == k) for a, b in zip(unit(j), unit(i))])
                    right.append(sign * d["dmu"][i] * self.force[i] * (j == k))
            else:
                mu = Fraction(mu)
                s = [dot(self.J[k], self.z) - Fraction(self.c[k]) for k in t]
                edge = [-f / (mu * self.force[i]) for k, f in zip(t, [self.force[k] for k in t])] if mode == "at edge" else None
                size = root(dot(s, s)) if edge is None else None
                e = [a / size for a in s] if edge is None else edge
                rise, base = motion(i), level(i)
                if self.law == "convex":
                    rise = [a - mu * dot(e, [self.J[k][j] if j < n else 0 for k in t]) for j, a in enumerate(rise)]
                    base += d["dmu"][i] * (size or 0) - mu * dot(e, [level(k) for k in t])
                rows.append(rise)
                right.append(base)
                if edge is not None:
                    along = [0] * n + [0] * m
                    along[n + i] = mu
                    for a, k in zip(e, t):
                        along[n + k] = a
                    rows.append(along)
                    right.append(-d["dmu"][i] * self.force[i])
                    if len(t) == 2:
                        rows.append([e[1] * a - e[0] * b for a, b in zip(motion(t[0]), motion(t[1]))])
                        right.append(e[1] * level(t[0]) - e[0] * level(t[1]))
                    continue
                for a, k in enumerate(t):
                    # l_t' = -dmu l_n e - mu l_n' e - mu l_n (1 - e e') s_t' / |s_t|
                    line = [Fraction(x) for x in unit(k)]
                    line[n + i] += mu * e[a]
                    turn = [mu * self.force[i] / size * ((a == b) - e[a] * e[b]) for b in range(len(t))]
                    for b, h in zip(turn, t):
                        for j in range(n):
                            line[j] += b * self.J[h][j]
                    rows.append(line)
                    right.append(-d["dmu"][i] * self.force[i] * e[a] + dot(turn, [level(h) for h in t]))
        x = solve(rows, right)
        return None if x is None else (x[:n], x[n:])

    def rise(self, i, dz):
        """The change of J z - c in a row."""
        return dot(self.J[i], dz) + dot(self.change["dJ"][i], self.z) - self.change["dc"][i]

    def one_sided(self):
        """All (dz, dlambda) that fit ties of the kinds touch and edge, to either side; None where a choice of sides has no one answer."""
        sides = {"touch": lambda t: ["open", "slides" if t else "held"], "edge": lambda t: ["held", "at edge"]}
        out = []
        for modes in itertools.product(*(sides[tie](t) if tie in sides else [tie] for tie, _, t, _ in self.contacts)):
            found = self.derivative(modes)
            if found is None:
                return None
            if all(self.spare(mode, contact, *found) >= 0 for mode, contact in zip(modes, self.contacts) if contact[0] in sides):
                out.append(found)
        return out

    def spare(self, mode, contact, dz, force):
        """What may not be negative at a tie on this side of it."""
        tie, i, t, mu = contact
        mu = Fraction(mu)
        if tie == "edge":
            e = [-self.force[k] / (mu * self.force[i]) for k in t]
            if mode == "held":
                return self.change["dmu"][i] * self.force[i] + mu * force[i] + dot(e, [force[k] for k in t])
            return dot(e, [self.rise(k, dz) for k in t])
        if mode != "open":
            return force[i]
        value = self.rise(i, dz)
        if self.law == "convex" and t:
            s = [dot(self.J[k], self.z) - Fraction(self.c[k]) for k in t]
            size = root(dot(s, s))
            value -= self.change["dmu"][i] * size + mu * dot([a / size for a in s], [self.rise(k, dz) for k in t])
        return value


def contained(test, derivative, dz, dlambda, width=True):
    for got, off, exact in [(derivative.dz, derivative.enclosure, dz), (derivative.dlambda, derivative.enclosure_lambda, dlambda)]:
        if not len(exact):
            continue
        for a, r, e in zip(got, off, exact):
            test.assertLessEqual(abs(Fraction(float(a)) - e), Fraction(float(r)), f"{float(a)} is not within {r} of {float(e)}")
        size = max((abs(float(e)) for e in [*dz, *dlambda]), default=0)
        if width:
            test.assertLessEqual(max(off, default=0), 1e-10 * size)


class Products(unittest.TestCase):
    def test_a_product_is_within_its_bound(self):
        random_ = numpy.random.default_rng(3)

        def spread(size):
            return random_.normal(size=size) * 2.0**random_.integers(-30, 30, size)

        for trial in range(100):
            A = scipy.sparse.random(trial % 8, 1 + trial % 37, density=trial / 99, random_state=random_, format="csr")
            A.data = spread(A.nnz)
            high = spread(A.shape[1])
            low, plus = high * 2.0**-40 * spread(len(high)), [-(A @ high), spread(A.shape[0])][:trial % 3]
            first, second, off = Rows(A).times(high, low, plus)
            for i, row in enumerate(A):
                exact = sum((Fraction(a) * (Fraction(high[j]) + Fraction(low[j])) for a, j in zip(row.data, row.indices)),
                            sum(Fraction(p[i]) for p in plus))
                terms = abs(row) @ (abs(high) + 2.0**53 * abs(low)) + sum(abs(p[i]) for p in plus)
                self.assertLessEqual(abs(exact - Fraction(first[i]) - Fraction(second[i])), Fraction(off[i]))
                self.assertLessEqual(off[i], 2.0**-100 * terms + 2.0**-1000)

    def test_where_nothing_is_rounded_the_bound_is_of_underflow_alone(self):
        first, second, off = Rows(numpy.array([[1.0, 2.0**60, 3.0], [0, 0, 0]])).times(numpy.array([5.0, 1.0, -1.0]), numpy.zeros(3))
        self.assertEqual((list(first), list(second)), ([2.0**60, 0], [2.0, 0]))
        self.assertLess(max(off), 2.0**-1000)


class Strict(unittest.TestCase):
    def test_enclosures_hold_the_exact_derivatives(self):
        count = {law: 0 for law in ("frictionless", "convex", "coulomb")}
        for law in count:
            for seed in itertools.count():
                if count[law] == PLANTED // 3:
                    break
                p = Planted(seed, law)
                exact = p.derivative([mode for mode, *_ in p.contacts])
                if exact is None:
                    continue
                count[law] += 1
                with self.subTest(law=law, seed=seed):
                    g = zwang.gradient_of(p.problem, p.given())
                    self.assertEqual(g.kink, [])
                    along = g.jvp(**p.change)
                    self.assertFalse(along.one_sided)
                    contained(self, along, *exact)
                    draw = numpy.random.default_rng(seed)
                    z_bar, lambda_bar = draw.normal(size=p.n), draw.normal(size=p.m)
                    bars = g.vjp(z_bar, lambda_bar)
                    terms = [numpy.sum(bars[name] * numpy.array(p.change["d" + name], dtype=float)) for name in bars]
                    forward = z_bar @ along.dz + lambda_bar @ along.dlambda
                    size = sum(numpy.abs(bars[name] * numpy.array(p.change["d" + name])).sum() for name in bars)
                    self.assertLessEqual(abs(sum(terms) - forward), 1e-12 * size)


class Pyramid(unittest.TestCase):
    """Under the law, the derivative with respect to the problem as it is given."""

    def test_enclosures_hold_the_exact_derivatives(self):
        count = smooth = 0
        for seed in itertools.count():
            if count == PLANTED // 4:
                break
            p = Planted(seed, "pyramid")
            exact = p.derivative([mode for mode, *_ in p.contacts])
            if exact is None or not any(p.tangent):
                continue
            count += 1
            with self.subTest(seed=seed):
                g = zwang.gradient_of(p.problem, numpy.array(p.z, dtype=float), law="pyramid")
                self.assertEqual(g.kink, [])
                along = g.jvp(**p.change)
                self.assertFalse(along.one_sided)
                contained(self, along, exact[0], ())
                z_bar = numpy.random.default_rng(seed).normal(size=p.n)
                bars = g.vjp(z_bar)
                if bars["J"] is None:
                    continue  # contacts depend on each other
                smooth += 1
                terms = [(bars[name] * numpy.array(p.change["d" + name])).ravel() for name in bars]
                self.assertLessEqual(abs(sum(t.sum() for t in terms) - z_bar @ along.dz), 1e-12 * sum(abs(t).sum() for t in terms))
        self.assertGreater(smooth, count // 2)


class Ties(unittest.TestCase):
    def test_planted_ties_are_named_and_the_one_sided_derivative_is_right(self):
        kinds = [("frictionless", "touch"), ("frictionless", "several"),
                 *itertools.product(("convex", "coulomb"), ("touch", "edge", "apex", "several"))]
        done = numbers = 0
        for seed in itertools.count():
            if done >= TIED:
                break
            for law, tie in kinds:
                p = Planted(seed, law, tie)
                pushes = {"edge": "held", "apex": "held", "touch": "slides" if law != "frictionless" else "held"}
                rests = {"edge": "held", "apex": "open", "touch": "open"}
                if any(p.derivative([to.get(mode, mode) for mode, *_ in p.contacts]) is None for to in (pushes, rests)):
                    continue  # forces are not unique
                done += 1
                with self.subTest(law=law, tie=tie, seed=seed):
                    g = zwang.gradient_of(p.problem, p.given())
                    rows = [row for mode, row, *_ in p.contacts if mode in rests]
                    self.assertEqual(g.kink, rows)
                    along = g.jvp(**p.change)
                    self.assertEqual(along.kink, rows)
                    self.assertTrue(along.one_sided)
                    if along.dz is None:
                        self.assertIn("kink", along.note)
                    with self.assertRaisesRegex(ValueError, "kink"):
                        g.vjp(numpy.ones(p.n))
                    if tie == "apex":
                        continue
                    exact = p.one_sided()
                    if exact is None:
                        continue
                    if law == "coulomb" and len(exact) != 1:
                        self.assertTrue(along.dz is None or exact[0] == exact[-1])
                        continue
                    numbers += 1
                    self.assertIsNotNone(along.dz, along.note)
                    contained(self, along, *exact[0], width=False)
        self.assertGreater(numbers, TIED // 2)


class Judged(unittest.TestCase):
    def test_right_and_wrong_gradients_are_told_apart(self):
        counted = 0
        for law, seed in itertools.product(("frictionless", "convex", "coulomb"), range(12)):
            p = Planted(seed, law)
            exact = p.derivative([mode for mode, *_ in p.contacts])
            if exact is None:
                continue
            counted += 1
            with self.subTest(law=law, seed=seed):
                dz = numpy.array([float(a) for a in exact[0]])
                wrt = {name[1:]: value for name, value in p.change.items()}
                good = zwang.judge_gradient(p.problem, p.given(), dz, wrt)
                self.assertEqual((good.verdict, good.at_least < 1e-13), ("right", True))
                free = zwang.gradient(p.problem, p.given(), wrt).free
                bad = zwang.judge_gradient(p.problem, p.given(), dz + 1e-6 * max(abs(dz).max(), abs(free).max()), wrt)
                self.assertEqual(bad.verdict, "wrong")
                self.assertLessEqual(bad.at_least, bad.at_most)
                z_bar = numpy.arange(1.0, p.n + 1)
                bars = zwang.gradient_of(p.problem, p.given()).vjp(z_bar)
                for name, bar in bars.items():
                    self.assertEqual(zwang.judge_gradient(p.problem, p.given(), bar, name, z_bar=z_bar).verdict, "right", name)
                    scale = zwang.judge_gradient(p.problem, p.given(), bar, name, z_bar=z_bar).scale
                    spoilt = zwang.judge_gradient(p.problem, p.given(), bar + (1e-6 * scale or 1.0), name, z_bar=z_bar)
                    self.assertEqual(spoilt.verdict, "wrong", name)
                self.assertEqual(zwang.judge_gradient(p.problem, p.given(), dz * numpy.nan, wrt).verdict, "wrong")
        self.assertGreater(counted, 20)

    def test_a_derivative_whose_parts_cancel_is_judged_at_the_size_of_its_parts(self):
        """A block slides to the right: s_n = mu s_t stays as it is where c changes by (mu, 1)."""
        for law, mu in itertools.product(("pyramid", "convex"), (0.5, 0.3)):
            block = zwang.Problem(numpy.eye(2), [4, -1], [[0, 1], [1, 0]], [0, 0], tangent=[False, True], mu=[mu, 0])
            answer = zwang.solve(block, "cone" if law == "convex" else "auto", law=law, tolerance=1e-14)
            for off, verdict in ((0, "right"), (1e-8, "wrong")):
                judged = zwang.judge_gradient(block, answer, [off, 0], "c", [mu, 1], law=law)
                self.assertEqual(judged.verdict, verdict, (law, mu))
                self.assertTrue(0.4 * mu < judged.scale < 1, judged.scale)
            own = zwang.gradient(block, answer, "c", [mu, 1], law=law).dz
            self.assertEqual(zwang.judge_gradient(block, answer, own, "c", [mu, 1], law=law).verdict, "right")

    def test_bounds_of_a_backward_pass_hold(self):
        for seed in range(30):
            p = Planted(seed, "coulomb")
            if p.derivative([mode for mode, *_ in p.contacts]) is None:
                continue
            z_bar = [1] + [0] * (p.n - 1)
            bars, off = zwang.gradient_of(p.problem, p.given()).backward(z_bar, None)
            for j in range(p.n):
                p.change = {name: numpy.zeros_like(numpy.array(value)).tolist() for name, value in p.change.items()}
                p.change["dz_u"][j] = 1
                exact = p.derivative([mode for mode, *_ in p.contacts])[0][0]
                self.assertLessEqual(abs(Fraction(float(bars["z_u"][j])) - exact), Fraction(float(off["z_u"][j])))
            for i in range(p.m):
                p.change["dz_u"], p.change["dc"] = [0] * p.n, [int(k == i) for k in range(p.m)]
                exact = p.derivative([mode for mode, *_ in p.contacts])[0][0]
                self.assertLessEqual(abs(Fraction(float(bars["c"][i])) - exact), Fraction(float(off["c"][i])))

    def test_a_kink_is_said_instead_of_a_verdict(self):
        p = zwang.Problem(numpy.eye(2), [0.0, 0.0], [[0, 1]], [0])
        forward = zwang.judge_gradient(p, zwang.solve(p), [0, 1], "z_u", [0, 1])
        self.assertEqual((forward.verdict, forward.kink, forward.at_most < 1e-14), ("kink: [0]", [0], True))
        central = zwang.judge_gradient(p, zwang.solve(p), [0, 0.5], "z_u", [0, 1])
        self.assertEqual((central.verdict, round(central.at_least, 9)), ("kink: [0]", 0.5))
        self.assertEqual(zwang.judge_gradient(p, zwang.solve(p), [0, 1], "z_u", z_bar=[0, 1]).verdict, "kink: [0]")


class Reach(unittest.TestCase):
    def test_the_row_that_changes_first_is_named(self):
        p = zwang.Problem(numpy.eye(3), [1, 2, -1.0], numpy.eye(3), [0.5, -3, 0])
        along = zwang.gradient(p, zwang.solve(p), "z_u", [-1, -1, -1])
        self.assertEqual((along.reach, along.reach_row), (0.5, 0))
        along = zwang.gradient(p, zwang.solve(p), "z_u", [0, 0, -2])
        self.assertEqual((along.reach, along.reach_row), (0.5, 2))

    def test_a_tilted_block_reaches_the_edge_of_its_cone(self):
        p = zwang.Problem(numpy.eye(3), [1, 0, -4.0], [[0, 0, 1], [1, 0, 0], [0, 1, 0]], [0, 0, 0], tangent=[False, True, True],
                          mu=[0.5, 0, 0])
        along = zwang.gradient(p, zwang.solve(p, "cone"), "z_u", [1, 0, 0])
        self.assertEqual((along.reach, along.reach_row), (1.0, 0))
        edge = zwang.Problem(numpy.eye(3), [2, 0, -4.0], p.J, p.c, tangent=p.tangent, mu=p.mu)
        at = zwang.gradient(edge, zwang.solve(edge, "cone"), "z_u", [1, 0, 0])
        numpy.testing.assert_allclose(at.dz, [1, 0, 0], atol=1e-14)
        self.assertEqual((at.kink, at.reach), ([0], 0.0))
        back = zwang.gradient(edge, zwang.solve(edge, "cone"), "z_u", [-1, 0, 0])
        numpy.testing.assert_allclose(back.dz, [0, 0, 0], atol=1e-14)


class Nothing(unittest.TestCase):
    def test_where_nothing_moves_an_answer_of_zeros_is_right(self):
        p = zwang.Problem(numpy.eye(2), [0, 0], [[-1, 2], [-1, -2], [0, -1], [-1, -1]], numpy.zeros(4), tangent=[False, True, False, True],
                          mu=[0.5, 0, 1, 0])
        g = zwang.gradient_of(p, zwang.solve(p, "cone"))
        self.assertEqual(g.distance, 0)


class ManyTies(unittest.TestCase):
    def test_forty_ties_at_once(self):
        n = 40
        p = zwang.Problem(numpy.eye(n), numpy.zeros(n), numpy.eye(n), numpy.zeros(n))
        direction = numpy.where(numpy.arange(n) % 3 == 0, -1.0, 2.0)
        along = zwang.gradient(p, zwang.solve(p), "z_u", direction)
        self.assertEqual(along.kink, list(range(n)))
        numpy.testing.assert_array_equal(along.dz, numpy.maximum(direction, 0))

    def test_ties_that_depend_on_each_other(self):
        p = zwang.Problem(numpy.eye(2), [0, 0], [[0, 1], [0, 2], [1, 1]], [0, 0, 0])
        for direction, dz in [([0, -1], [0.0, 0.0]), ([1, -1], [1, 0]), ([-2, 1], [-1.5, 1.5])]:
            along = zwang.gradient(p, [0, 0], "z_u", direction)
            self.assertEqual(along.kink, [0, 1, 2])
            numpy.testing.assert_allclose(along.dz, dz, atol=1e-14)


class SlipsThatBegin(unittest.TestCase):
    """A point of mass 1 on the ground, without weight: dz is what the law makes of the push."""

    def make(self, law):
        rows = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
        p = zwang.Problem(numpy.eye(3), numpy.zeros(3), rows, numpy.zeros(3), tangent=[False, True, True], mu=[0.5, 0, 0], law=law)
        return zwang.gradient_of(p, zwang.solve(p, "cone"))

    def test_under_the_convex_law_the_push_is_projected(self):
        g = self.make("convex")
        for push, dz in [([3, 4, -2], [1.92, 2.56, 1.6]), ([1, 1, 3], [1, 1, 3]), ([0.25, 0, -1], [0, 0, 0])]:
            along = g.jvp(dz_u=push)
            self.assertEqual((along.kink, along.one_sided), ([0], True))
            numpy.testing.assert_allclose(along.dz, dz, atol=1e-14)
            self.assertLess(along.enclosure.max(), 1e-12)
            for got, off, exact in zip(along.dz, along.enclosure, dz):
                self.assertLessEqual(abs(Fraction(float(got)) - Fraction(str(exact))), Fraction(float(off)) or 0)

    def test_under_coulombs_law_it_is_not_known_which_way_it_slides(self):
        along = self.make("coulomb").jvp(dz_u=[3, 4, -2])
        self.assertIsNone(along.dz)
        self.assertIn("kink", along.note)
        self.assertEqual(along.kink, [0])


class AtAWall(unittest.TestCase):
    """A box on the ground, flush with a wall that it does not press: four corners each, mu = 1/2 at the wall."""

    def make(self, law, ground=0.0):
        corners = [numpy.array([x, y, z]) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]
        rows = []
        for axis, side in ((2, -0.5), (0, -0.5)):
            for r in corners:
                if r[axis] != side:
                    continue
                n, t, u = (numpy.roll(numpy.eye(3)[axis], k) for k in range(3))
                rows += [numpy.r_[d, numpy.cross(r, d)] for d in (n, t, u)]
        m = len(rows)
        box = zwang.Problem(numpy.diag([2.0, 2, 2, 1, 1, 1]), [0, 0, -8, 0, 0, 0], rows, numpy.zeros(m), tangent=numpy.arange(m) % 3 > 0,
                            mu=numpy.where(numpy.arange(m) % 3, 0, numpy.where(numpy.arange(m) < 12, ground, 0.5)),
                            law="convex" if law == "convex" else "coulomb")
        return (box, [12, 15, 18, 21]) if law != "frictionless" else (box.under(law), [4, 5, 6, 7])

    def test_its_corners_are_named_though_they_depend_on_each_other(self):
        for law in ("frictionless", "convex", "coulomb"):
            with self.subTest(law):
                box, wall = self.make(law)
                g = zwang.gradient_of(box, zwang.solve(box, "cone" if box.tangent.any() else "dual_active_set"))
                self.assertEqual(g.kink, wall)
                away, into = ([side, 0, 0, 0, 0, 0] for side in (1, -1))
                if law == "frictionless":
                    numpy.testing.assert_allclose(g.jvp(dz_u=away).dz, away, atol=1e-14)
                    numpy.testing.assert_allclose(g.jvp(dz_u=into).dz, numpy.zeros(6), atol=1e-14)
                for direction in (away, into):
                    along = g.jvp(dz_u=direction)
                    self.assertTrue(along.dz is not None or "kink" in along.note)

    def test_where_the_ground_holds_it_by_friction_the_wall_can_push_and_there_is_no_kink(self):
        box, _ = self.make("coulomb", ground=0.5)
        g = zwang.gradient_of(box, zwang.solve(box, "cone"))
        self.assertEqual((g.kink, g.unique_forces), ([], False))
        numpy.testing.assert_allclose(g.jvp(dz_u=[1, 0, 0, 0, 0, 0]).dz, numpy.zeros(6), atol=1e-14)


class Usual(unittest.TestCase):
    def test_errors_of_differences_and_of_soft_rows(self):
        for row in zwang.compare_gradients("hand(contacts=4)") + zwang.compare_gradients(zwang.scene("ball", mu=0.5), law="convex"):
            self.assertLess(row["width"], 1e-12)
            self.assertLess(row["differences"][1e-5], 1e-7)
            soft = [row["soft"][a] for a in (1e-2, 1e-4, 1e-6)]
            self.assertTrue(soft[0] > 3 * soft[1] > 9 * soft[2], soft)
        still, = zwang.compare_gradients(zwang.Problem(numpy.eye(1), [-1.0], [[1.0]], [0.0]))
        self.assertIn("hardly", still["note"])


class NotUnique(unittest.TestCase):
    """A box on four corners: its weight can be shared out in many ways."""

    def setUp(self):
        self.box = zwang.scene("tower(boxes=1)")
        self.gradient = zwang.gradient_of(self.box, zwang.solve(self.box))

    def test_z_has_a_derivative_and_lambda_has_none(self):
        self.assertFalse(self.gradient.unique_forces)
        for dc, dz in [([1, 1, 1, 1], [0, 0, 1, 0, 0, 0]), ([1, 0, 1, 0], [0, 0, 0.5, 0, 1, 0])]:
            along = self.gradient.jvp(dc=dc)
            self.assertIsNone(along.dlambda)
            self.assertIn("not unique", along.note)
            self.assertFalse(along.one_sided)
            numpy.testing.assert_allclose(along.dz, dz, atol=1e-15)
        bars = self.gradient.vjp([0, 0, 1, 0, 0, 0])
        self.assertIsNone(bars["c"])
        numpy.testing.assert_allclose(bars["z_u"], 0, atol=1e-15)
        with self.assertRaisesRegex(ValueError, "not unique"):
            self.gradient.vjp(numpy.zeros(6), numpy.zeros(4))

    def test_a_corner_that_is_lifted_tips_the_box_and_one_that_is_lowered_does_not(self):
        up, down = self.gradient.jvp(dc=[1, 0, 0, 0]), self.gradient.jvp(dc=[-1, 0, 0, 0])
        numpy.testing.assert_allclose(up.dz, [0, 0, 0.5, -0.5, 0.5, 0], atol=1e-15)
        numpy.testing.assert_allclose(down.dz, numpy.zeros(6), atol=1e-15)
        self.assertTrue(up.one_sided and down.one_sided)
        self.assertEqual((up.kink, down.kink), ([1, 2], [0, 3]))

    def test_a_force_that_is_small_to_a_linear_program_is_a_force(self):
        """z_y is held between two rows; the lower one carries f, beside a force of 1, and is lowered."""
        for f in (1e-3, 1e-7, 5e-10, 1e-12, 1e-15):
            between = zwang.Problem(numpy.eye(2), [-1, -f], [[1, 0], [0, 1], [0, -1]], [0, 0, 0])
            try:
                along = zwang.gradient(between, zwang.solve(between), "c", [0, -1, 0])
            except ValueError as none:
                self.assertLess(f, 1e-10)
                self.assertIn("no share of them was found", str(none))
            else:
                numpy.testing.assert_allclose(along.dz, [0, -1], atol=1e-15)

    def test_rows_that_contradict_each_other_in_this_direction_are_refused(self):
        twice = zwang.Problem(numpy.diag([1.0, 2, 1]), [0, -2, 1], [[-1, 1, -1], [-1, 1, 1], [-2, 2, -2]], [1, 1, 2], equality=[False, False, True])
        change = {"J": [[0, -1, -1], [-1, -2, 2], [-1, -1, 1]], "c": [0, 0, -1]}
        with self.assertRaisesRegex(ValueError, "contradict each other"):
            zwang.gradient(twice, zwang.solve(twice), change)

    def test_a_row_of_zeros_that_gets_entries_has_none(self):
        empty = zwang.Problem([[0.1]], [0.0], [[0.0]], [0.0], equality=[True])
        of = zwang.gradient_of(empty, zwang.solve(empty), proof=False)
        self.assertEqual(of.jvp(dz_u=[1.0]).dz, 1)
        with self.assertRaisesRegex(ValueError, "a row without entries"):
            of.jvp(dz_u=[1.0], dJ=[[1.0]])

    def test_rows_that_turn_apart_have_none_though_they_fit_to_first_order(self):
        """x >= 0 and -x >= 0 become x + t y >= 0 and -x + t y >= 0: what was a line is a cone, for any t."""
        slot = zwang.Problem(numpy.eye(2), [0, 0], [[1, 0], [-1, 0]], [0, 0])
        along = zwang.gradient_of(slot, zwang.solve(slot)).jvp(dJ=[[0, 1], [0, 1]], dz_u=[0, -1])
        self.assertIsNone(along.dz)
        self.assertIn("no number", along.note)
        turned = zwang.gradient_of(slot, zwang.solve(slot)).jvp(dJ=[[0, 1], [0, -1]], dz_u=[0, -1])
        numpy.testing.assert_allclose(turned.dz, [0, -1], atol=1e-15)
        self.assertFalse(turned.one_sided)

    def test_where_the_load_of_what_slides_can_be_shared_out_there_is_none(self):
        for name in ("PUCK", "belt"):
            p = zwang.scene(name, mu=0.5) if name == "belt" else zwang.scene(name)
            with self.assertRaisesRegex(ValueError, "forces of contacts that slide are not unique"):
                zwang.gradient_of(p, zwang.solve(p, "cone"))

    def test_rows_that_come_to_contradict_each_other_have_no_derivative(self):
        twice = zwang.Problem(numpy.eye(2), [1, 1], [[1, 0], [2, 0]], [0, 0], equality=2)
        of = zwang.gradient_of(twice, [0.0, 1.0])
        numpy.testing.assert_allclose(of.jvp(dc=[1, 2]).dz, [1, 0], atol=1e-15)
        with self.assertRaisesRegex(ValueError, "contradict"):
            of.jvp(dc=[1, 0])


class Several(unittest.TestCase):
    """Painleve's rod: it falls free, sticks or slides, and each is a solution of Coulomb's law."""

    def test_each_solution_has_a_derivative_of_its_own_and_what_is_none_is_refused(self):
        rod = zwang.scene("ROD")
        J, mu = rod.J.toarray(), rod.mu[0]  # M is the identity
        stuck = numpy.linalg.solve(J @ J.T, rod.c - J @ rod.z_u)
        normal = (rod.c[0] - J[0] @ rod.z_u) / (J[0] @ (J[0] - mu * J[1]))
        answers = {force: rod.z_u + J.T @ force for force in [(0.0, 0.0), tuple(stuck), (normal, -mu * normal)]}
        slopes = []
        for force, z in answers.items():
            g = zwang.gradient_of(rod, (z, force))
            self.assertEqual((g.kink, g.distance < 1e-15), ([], True))
            along = g.jvp(dc=[1, 0])
            slopes.append(tuple(along.dz.round(12)))
        self.assertEqual(len(set(slopes)), 3)
        wrong = (rod.c[0] - J[0] @ rod.z_u) / (J[0] @ (J[0] + mu * J[1]))
        with self.assertRaisesRegex(ValueError, "no solution"):
            zwang.gradient_of(rod, (rod.z_u + J.T @ [wrong, mu * wrong], [wrong, mu * wrong]))
        with self.assertRaisesRegex(ValueError, r"expected its forces, too, \(z, lambda\)$"):
            zwang.gradient_of(rod, z)

    def test_one_of_a_continuum_of_solutions_is_called_no_wrong_one(self):
        z, force = numpy.array([0, -1, -1.0]), numpy.array([5120.0, -10240])
        many = zwang.Problem([[3, -2, -2], [-2, 4, 3], [-2, 3, 4]], [0, -16, -16],
                             [[0, -(2.0**-10), 2.0**-10], [3 * 2.0**-9, -11 * 2.0**-10, -5 * 2.0**-9]], [0, 2.0**-10],
                             tangent=[False, True], mu=[2, 0])
        numpy.testing.assert_array_equal(many.M @ (z - many.z_u), many.J.T @ force)
        numpy.testing.assert_array_equal(many.J @ z - many.c, [0, 5 * 2.0**-8])  # it slides, and the force stands against it
        for wrt, direction in (("z_u", [1, 0, 0]), ("mu", [1, 0])):
            with self.assertRaisesRegex(ValueError, "^no gradient: there are several solutions, or nearly so: the answer meets its conditions, and it is .* off one that is proven$"):
                zwang.gradient(many, (z, force), wrt, direction)


class Refused(unittest.TestCase):
    def test_what_has_no_derivative_costs_one_line(self):
        p = zwang.Problem(numpy.eye(2), [1, -1], [[0, 1]], [0])
        shut = zwang.Problem(numpy.eye(1), [0], [[1], [-1]], [1, 1])
        huge = zwang.Problem([[1e300]], [1e300], [[1e300]], [1e300])
        of, by = zwang.gradient_of, zwang.gradient
        for word, call in [
                ("infeasible", lambda: of(shut, [0.0])), ("infeasible", lambda: of(shut, zwang.solve(shut))),
                ("finite", lambda: of(p, [numpy.nan, 1])), ("entries", lambda: of(p, [1.0])), ("solution", lambda: of(p, "x")),
                ("no solution: it is", lambda: of(p, [5.0, 1.0])), ("too large", lambda: of(huge, [1.0])),
                ("one of", lambda: by(p, [1, 0], "q", [1])), ("entries", lambda: by(p, [1, 0], "c", [1, 2])),
                ("finite", lambda: by(p, [1, 0], "c", [numpy.inf])), ("symmetric", lambda: by(p, [1, 0], "M", [[0, 1], [0, 0]])),
                ("missing", lambda: by(p, [1, 0], "c")), ("shape", lambda: by(p, [1, 0], "J", [1, 2, 3])),
                ("reads", lambda: by(p, [1, 0], "mu", [1])), ("one name", lambda: by(p, [1, 0], {"c": [1]}, [1])),
                ("numbers", lambda: by(p, [1, 0], "c", ["a"]))]:
            with self.subTest(word):
                with self.assertRaisesRegex(ValueError, word) as caught:
                    call()
                self.assertNotIn("\n", str(caught.exception))

    def test_rows_near_a_tie_are_told_apart_by_their_last_digit(self):
        for gap in (2.0**-52, -2.0**-52):
            p = zwang.Problem(numpy.eye(1), [1.0], [[1.0]], [1.0 + gap])
            along = zwang.gradient(p, zwang.solve(p), "z_u", [1.0])
            self.assertEqual((along.kink, along.dz[0]), ([], 0.0 if gap > 0 else 1.0))


class WithoutProof(unittest.TestCase):
    """gradient_of(..., proof=False) against the exact derivatives, and where it says that it has none."""

    def near(self, got, exact, size):
        numpy.testing.assert_allclose(got, [float(e) for e in exact], rtol=0, atol=1e-11 * size)

    def test_what_is_no_direction_is_said(self):
        p = zwang.scene("hand(contacts=4)")
        g, n = zwang.gradient_of(p, zwang.solve(p), proof=False), p.size
        rubs = zwang.scene("crate", mu=0.5)
        under = zwang.gradient_of(rubs, zwang.solve(rubs, law="pyramid"), law="pyramid", proof=False)
        one, bad = numpy.ones(n), numpy.r_[numpy.ones(n - 1), numpy.nan]
        for name, ask in (("dz_u", lambda v: g.jvp(dz_u=v)), ("z_bar", g.vjp)):
            for v, says in ((bad, f"{n} finite entries"), (one[1:], f"{n} finite entries"), (one[:0], f"{n} finite entries"),
                            (one[:, None], f"{n} finite entries"), (one + 1j, "numbers: it has complex entries"), ("a", "numbers")):
                with self.subTest(name=name, says=says), self.assertRaisesRegex(ValueError, f"^{name} should (have|be) {says}"):
                    ask(v)
        for wrt in ((), ("Q",), (1,), (["M"],), [["M"]], "Q"):
            with self.subTest(wrt=wrt), self.assertRaisesRegex(ValueError, "^wrt should be names among M, z_u, J, c, mu"):
                g.vjp(one, wrt=wrt)
            with self.subTest(wrt=wrt, law="pyramid"), self.assertRaisesRegex(ValueError, "^wrt should be names among M, z_u, J, c, mu"):
                under.vjp(numpy.ones(rubs.size), wrt=wrt)
        numpy.testing.assert_array_equal(g.jvp(dz_u=numpy.arange(2.0 * n)[::2]).dz, g.jvp(dz_u=list(range(0, 2 * n, 2))).dz)

    FIRST = {"convex": (228, 377, 385), "coulomb": (350,)}  # tangent rows without entries; what much larger motions leave

    def test_planted_problems_of_all_laws(self):
        for law in ("frictionless", "pyramid", "convex", "coulomb"):
            count = 0
            for seed in itertools.chain(self.FIRST.get(law, ()), itertools.count()):
                if count == PLANTED // 3:
                    break
                p = Planted(seed, law)
                exact = p.derivative([mode for mode, *_ in p.contacts])
                if exact is None or law == "pyramid" and not any(p.tangent):
                    continue
                count += 1
                with self.subTest(law=law, seed=seed):
                    given = zwang.solve(p.problem, law="pyramid") if law == "pyramid" else p.given()
                    try:
                        g = zwang.gradient_of(p.problem, given, law="pyramid" if law == "pyramid" else None, proof=False)
                        along = g.jvp(**p.change)
                    except ValueError as none:  # edges of a pyramid may depend on each other
                        self.assertTrue(law == "pyramid" and "only a proof tells" in str(none), none)
                        continue
                    if law == "pyramid" and g.kink:  # one of such edges may carry all
                        continue
                    self.assertEqual((g.kink, along.one_sided, along.enclosure), ([], False, None))
                    size = max(abs(float(e)) for e in [1, *exact[0], *exact[1]])
                    self.near(along.dz, exact[0], size)
                    if law == "pyramid":
                        continue
                    self.near(along.dlambda, exact[1], size)
                    draw = numpy.random.default_rng(seed)
                    z_bar, lambda_bar = draw.normal(size=p.n), draw.normal(size=p.m)
                    bars = g.vjp(z_bar, lambda_bar)
                    terms = [bars[name] * numpy.array(p.change["d" + name], dtype=float) for name in bars]
                    forward = z_bar @ along.dz + lambda_bar @ along.dlambda
                    self.assertLessEqual(abs(sum(t.sum() for t in terms) - forward), 1e-12 * sum(abs(t).sum() for t in terms))

    def test_ties_are_named_and_have_a_number_where_nothing_rubs(self):
        for law, tie in (("frictionless", "touch"), ("convex", "touch"), ("coulomb", "edge"), ("convex", "apex")):
            for seed in range(40):
                p = Planted(seed, law, tie)
                exact = p.one_sided() if tie != "apex" else None
                g = zwang.gradient_of(p.problem, p.given(), proof=False)
                with self.subTest(law=law, tie=tie, seed=seed):
                    self.assertEqual(g.kink, [row for mode, row, *_ in p.contacts if mode in ("touch", "edge", "apex")])
                    with self.assertRaisesRegex(ValueError, "kink: row"):
                        g.vjp(numpy.ones(p.n))
                    if law != "frictionless":
                        with self.assertRaisesRegex(ValueError, "only a proof tells"):
                            g.jvp(**p.change)
                    elif exact:
                        along = g.jvp(**p.change)
                        self.assertTrue(along.one_sided)
                        self.near(along.dz, exact[0][0], max(abs(float(e)) for e in [1, *exact[0][0], *exact[0][1]]))

    def test_a_backward_pass_gives_what_it_is_asked_for(self):
        p = zwang.scene("hand(contacts=4,mu=0.5)").under("convex")
        solution, z_bar = zwang.solve(p, "cone", tolerance=1e-12), numpy.ones(p.size)
        for proof in (False, True):
            g = zwang.gradient_of(p, solution, proof=proof)
            every = g.vjp(z_bar)
            self.assertEqual(sorted(every), ["J", "M", "c", "mu", "z_u"])
            for wrt in ("c", ("mu", "z_u"), ["J", "M"]):
                some = g.vjp(z_bar, wrt=wrt)
                self.assertEqual(list(some), [wrt] if isinstance(wrt, str) else list(wrt))
                for name, bar in some.items():
                    numpy.testing.assert_array_equal(bar, every[name])
            for wrong in ("z", (), ("c", "lambda")):
                with self.assertRaisesRegex(ValueError, "wrt should be names among M, z_u, J, c, mu"):
                    g.vjp(z_bar, wrt=wrong)

    def test_directions_in_turn_are_those_of_each_gradient_alone(self):
        """A thread keeps the factor of the gradient that it asked last, and which way that was."""
        def ask(g):
            d = numpy.arange(1.0, g.problem.size + 1)
            return g.jvp(dz_u=d).dz, g.kink or g.vjp(d, wrt="z_u")["z_u"], g.jvp(dz_u=-d).dz

        problems = [zwang.scene(name) for name in ("hand(contacts=4)", "hand(contacts=16,mu=0.5)", "tower(boxes=3)", "wall(boxes=50,mu=0.5)")]
        solutions = [zwang.solve(p, tolerance=1e-12) for p in problems]
        alone = [ask(zwang.gradient_of(p, s, proof=False)) for p, s in zip(problems, solutions)]
        kept = [zwang.gradient_of(p, s, proof=False) for p, s in zip(problems, solutions)]
        for _ in range(2):
            for g, expected in zip(kept, alone):
                for got, same in zip(ask(g), expected):
                    numpy.testing.assert_array_equal(got, same)

    def test_what_only_a_proof_tells_is_refused(self):
        box = zwang.scene("tower(boxes=1)")
        g = zwang.gradient_of(box, zwang.solve(box), proof=False)
        along = g.jvp(dz_u=numpy.ones(6))
        numpy.testing.assert_allclose(along.dz, [1, 1, 0, 0, 0, 1], atol=1e-15)
        self.assertIsNone(along.dlambda)
        self.assertFalse(g.unique_forces)
        puck = zwang.scene("PUCK")
        lying = zwang.Problem(numpy.eye(2), [1, 1], [[1, 0], [2, 0]], [0, 0], equality=2)
        of = zwang.gradient_of
        for word, call in [("forces are not unique", lambda: of(puck, zwang.solve(puck, "cone"), proof=False).jvp(dz_u=numpy.ones(puck.size))),
                           ("only a proof tells", lambda: of(lying, ([0.0, 1.0], [-1.0, 0.0]), proof=False).jvp(dc=[1, 2])),
                           ("do not hold together", lambda: of(lying, ([0.0, 1.0], [-1.0, 0.0]), proof=False).jvp(dc=[1, 0])),
                           ("off by 1.0e-06 of the motion", lambda: of(lying, ([0.0, 1.0 + 2**0.5 * 1e-6], [-1.0, 0.0]), proof=False)),
                           ("z and lambda", lambda: of(lying, [0.0, 1.0], proof=False)), ("finite", lambda: of(lying, [0.0, numpy.nan], proof=False))]:
            with self.subTest(word), self.assertRaisesRegex(ValueError, word) as caught:
                call()
            self.assertNotIn("\n", str(caught.exception))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
