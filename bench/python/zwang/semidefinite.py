"""Judges an answer of a convex quadratic program whose P is singular, a linear program among them (docs/python.md).

    minimize 1/2 x'Px + q'x   subject to   J x = c (equality rows),  J x >= c (inequality rows)

An interior point guesses which rows hold at a solution. The conditions of Karush, Kuhn and Tucker of these rows are one
linear system of stored doubles, solved in integers to far beyond what is asked; its rank, and which of the other
numbers are zero, is decided by elimination modulo primes (core/referee/exact_rank.h). Rows that hold or push only by
rounding are exchanged one by one until the signs are right. Nothing else is believed.
"""
import math
from fractions import Fraction

import numpy
import scipy.linalg
import scipy.sparse

from . import _zwang

DIGITS = 400  # bits behind the point, of unknowns scaled to about 1
LARGEST = 3000  # unknowns and rows of one dense system
ROUNDS = 60  # rows exchanged because they differ by rounding
DEPENDENT = 1e-9  # what is left of a unit row that is taken for a combination of others
ROUNDING = 2.0**-40  # P's eigenvalues may be that much below zero, relative to its largest entry, by rounding
CONVERGED = 1e-4  # the residual of a guess that is worth a proof
BY_ROUNDING = "rows that hold at a solution seem to contradict each other by the rounding of their entries"
CAUTION = 1e-12  # relative, of what doubles add to numbers that were known exactly


class NotConvex(ValueError):
    """d'Pd < 0, evaluated without error, by more than rounding of P explains."""


def powers_of_two(sizes):
    """Near 1 / sizes: scaling by them rounds nothing."""
    sizes = numpy.where(sizes > 0, sizes, 1)
    return numpy.exp2(-numpy.round(numpy.log2(sizes)))


def integers(A):
    """Rows of (columns, whole numbers) and the exponents by which the rows were multiplied: A[i] = row 2^-exponent."""
    A = scipy.sparse.csr_matrix(A)
    rows, exponents = [], []
    for i in range(A.shape[0]):
        part = slice(A.indptr[i], A.indptr[i + 1])
        mantissa, power = numpy.frexp(A.data[part])
        exponent = max(0, 53 - int(power.min())) if len(power) else 0
        rows.append((A.indices[part].tolist(),
                     [int(m) << (p - 53 + exponent) for m, p in zip(numpy.ldexp(mantissa, 53), power.tolist())]))
        exponents.append(exponent)
    return rows, exponents


def times(rows, v):
    return [sum(a * v[j] for j, a in zip(*row)) for row in rows]


def whole(x, bits):
    """The double x times 2^bits, cut off."""
    numerator, denominator = float(x).as_integer_ratio()
    return (numerator << bits) // denominator


def real(number, bits):
    """number 2^-bits as a double: whole numbers divide with one rounding."""
    return number / (1 << bits) if bits >= 0 else float(number << -bits)


def product(A, v, right=None):
    """A v - right as doubles, each with one rounding, for whole v in units of 2^-DIGITS."""
    rows, exponents = integers(A)
    right = [0.0] * len(rows) if right is None else right
    return numpy.array([real(s - whole(c, DIGITS + e), DIGITS + e)
                        for s, c, e in zip(times(rows, v), right, exponents)])


def solve_exactly(B, right):
    """v with B v = right, as whole numbers in units of 2^-DIGITS, and a bound on what each is off; None where B is not
    proven to be regular."""
    B = scipy.sparse.csr_matrix(B, dtype=float)
    n = B.shape[0]
    if n == 0:
        return [], numpy.zeros(0)
    left, across = numpy.ones(n), numpy.ones(n)
    for _ in range(6):
        D = abs(scipy.sparse.diags(left) @ B @ scipy.sparse.diags(across))
        left = left * powers_of_two(numpy.sqrt(D.max(axis=1).toarray().ravel()))
        across = across * powers_of_two(numpy.sqrt(D.max(axis=0).toarray().ravel()))
    scaled = (scipy.sparse.diags(left) @ B @ scipy.sparse.diags(across)).tocsr()
    dense = scaled.toarray()
    try:
        inverse = numpy.linalg.inv(dense)
    except numpy.linalg.LinAlgError:
        return None
    off = abs(numpy.identity(n) - inverse @ dense) + (n + 4) * 2.0**-52 * (abs(inverse) @ abs(dense) + numpy.identity(n))
    contraction = off.sum(axis=1).max()
    if not contraction < 0.5:
        return None
    rows, exponents = integers(scaled)
    goal = [whole(r, DIGITS + e) for r, e in zip(numpy.asarray(right) * left, exponents)]
    v = [0] * n
    for _ in range(DIGITS):
        residual = [g - s for g, s in zip(goal, times(rows, v))]
        r = numpy.array([real(x, DIGITS + e) for x, e in zip(residual, exponents)])
        step = inverse @ r
        if abs(step).max() < 2.0 ** (1 - DIGITS):
            break
        v = [a + whole(b, DIGITS) for a, b in zip(v, step)]
    bound = 2 * ((abs(inverse) @ (abs(r) + 2.0**-DIGITS)).max() / (1 - contraction) + 2.0**-DIGITS)
    shifts = numpy.log2(across).astype(int).tolist()
    return [x << s if s >= 0 else x >> -s for x, s in zip(v, shifts)], bound * across + 2.0**-DIGITS


def exact_basis(A, right):
    """Rows independent of those before them, rows that contradict those before them."""
    A = scipy.sparse.csr_matrix(A, dtype=float)
    A.sort_indices()
    return _zwang.exact_basis(A, numpy.asarray(right, dtype=float))


class Program:
    """Rows are in the order of _zwang.from_qp: equalities, inequalities -G x >= -h, lower and upper bounds."""

    def __init__(self, P, q, J, c, equal, names=None):
        self.P, self.q = scipy.sparse.csc_matrix(P, dtype=float), numpy.asarray(q, dtype=float)
        self.J, self.c = scipy.sparse.csr_matrix(J, dtype=float), numpy.asarray(c, dtype=float)
        self.equal = numpy.asarray(equal, dtype=bool)
        self.names = names

    @staticmethod
    def of(P, q, G, h, A, b, lb, ub):
        n = len(q)
        blocks, right, names = [scipy.sparse.csr_matrix((0, n))], [], []

        def add(word, matrix, values, sign):
            keep = numpy.flatnonzero(numpy.isfinite(values))
            if len(keep):
                blocks.append(sign * scipy.sparse.csr_matrix(matrix)[keep])
            right.extend(sign * values[keep])
            names.extend(f"{word}/{k}" for k in keep)
        add("equality", A, b, 1)
        equalities = len(right)
        add("inequality", G, h, -1)
        add("lower bound", scipy.sparse.identity(n), lb, 1)
        add("upper bound", scipy.sparse.identity(n), ub, -1)
        return Program(P, q, scipy.sparse.vstack(blocks), right, numpy.arange(len(right)) < equalities, names)


def interior_point(p):
    """x and multipliers of all rows, about right, and slack / multiplier in units in which both are about 1. A guess."""
    n, m = len(p.q), len(p.c)
    across, left = numpy.ones(n), numpy.ones(m)
    for _ in range(4):
        J = abs(scipy.sparse.diags(left) @ p.J @ scipy.sparse.diags(across))
        P = abs(scipy.sparse.diags(across) @ p.P @ scipy.sparse.diags(across))
        sizes = numpy.maximum(J.max(axis=0).toarray().ravel() if m else 0, numpy.sqrt(P.diagonal()))
        across = across * powers_of_two(numpy.sqrt(sizes))
        if m:
            left = left * powers_of_two(numpy.sqrt(J.max(axis=1).toarray().ravel()))
    J = (scipy.sparse.diags(left) @ p.J @ scipy.sparse.diags(across)).tocsr()
    P = (scipy.sparse.diags(across) @ p.P @ scipy.sparse.diags(across)).toarray()
    size = max(abs(p.q * across).max(initial=0), abs(P).max(initial=0)) or 1.0
    P, q, c = P / size, p.q * across / size, p.c * left
    E, I, e, k = J[p.equal].toarray(), J[~p.equal].toarray(), c[p.equal], c[~p.equal]
    many = max(len(k), 1)
    length = max(abs(c).max(initial=0), 1e-300)

    def factor(weights, small):
        K = numpy.block([[P + (I.T * weights) @ I, E.T], [E, numpy.zeros((len(e), len(e)))]])
        regular = K + numpy.diag(numpy.r_[numpy.full(n, small), numpy.full(len(e), -small)])
        lu = scipy.linalg.lapack.dgetrf(regular)[:2]

        def solve(right):
            v = scipy.linalg.lu_solve(lu, right, check_finite=False)
            for _ in range(3):
                v = v + scipy.linalg.lu_solve(lu, right - K @ v, check_finite=False)
            return v
        return solve
    v = factor(numpy.ones(len(k)), 1e-8)(numpy.r_[-q + I.T @ k, e])
    x, y, s = v[:n], -v[n:], I @ v[:n] - k
    z = -s
    s, z = (t + max(0, -1.5 * t.min(initial=0)) for t in (s, z))
    together = s @ z + 1e-30
    s, z = s + 0.5 * together / (z.sum() or 1) + 1e-3 * min(length, 1), z + 0.5 * together / (s.sum() or 1) + 1e-3
    best = (math.inf, x, y, s, z)
    with numpy.errstate(all="ignore"):
        for _ in range(150):
            dual, equal, inner, mu = P @ x + q - E.T @ y - I.T @ z, E @ x - e, I @ x - s - k, s @ z / many
            worst = max(abs(dual).max(initial=0) / (1 + abs(q).max(initial=0)),
                        abs(numpy.r_[equal, inner]).max(initial=0) / (1 + min(length, abs(x).max(initial=0))),
                        mu / (1 + abs(q @ x)))
            if not math.isfinite(worst):
                break
            if worst < best[0]:
                best = (worst, x, y, s, z)
            if mu < 1e-16 and worst < 1e-14:
                break
            try:
                solve = factor(z / s, 1e-13)
            except (ValueError, numpy.linalg.LinAlgError):
                break

            def step(target):
                d = solve(numpy.r_[-dual - I.T @ (target / s + z / s * inner), -equal])
                ds = I @ d[:n] + inner
                return d[:n], -d[n:], ds, -(target + z * ds) / s

            def longest(t, dt):
                return min(1, (-t[dt < 0] / dt[dt < 0]).min(initial=1e30))
            dx, dy, ds, dz = step(s * z)
            ahead = (s + longest(s, ds) * ds) @ (z + longest(z, dz) * dz) / many
            sigma = min(1, (ahead / mu)**3) if mu > 0 else 0
            dx, dy, ds, dz = step(s * z + ds * dz - sigma * mu)
            a, b = 0.995 * longest(s, ds), 0.995 * longest(z, dz)
            if p.P.nnz:
                a = b = min(a, b)
            if not numpy.isfinite(dx).all() or max(a, b) < 1e-10:
                break
            x, s, y, z = x + a * dx, s + a * ds, y + b * dy, z + b * dz
    worst, x, y, s, z = best
    multipliers = numpy.zeros(m)
    multipliers[p.equal], multipliers[~p.equal] = y, z
    ratio = numpy.zeros(m)
    ratio[~p.equal] = numpy.maximum(s, 1e-300) / numpy.maximum(z, 1e-300)
    return x * across, multipliers * left * size, ratio, worst


class Solved:
    """A solution, to far beyond doubles. x and multipliers: whole numbers in units of 2^-DIGITS; what they are off."""

    def __init__(self, x, x_off, multipliers, strict, tight):
        self.x, self.x_off, self.multipliers, self.strict, self.tight = x, x_off, multipliers, strict, tight

    def unique(self, p):
        """Whether x is the only solution: True, False, or None where neither is proven."""
        def full(rows):
            A = scipy.sparse.vstack([p.P, p.J[rows]], format="csr")
            return len(exact_basis(A, numpy.zeros(A.shape[0]))[0]) == len(p.q)
        return True if full(self.strict) else None if full(self.tight) else False


def prove(p):
    """A Solved, or why there is none."""
    n, m = len(p.q), len(p.c)
    if n + m > LARGEST:
        return f"more than {LARGEST} unknowns and rows"
    x, multipliers, ratio, residual = interior_point(p)
    if not residual < CONVERGED:
        return "no solution was guessed"
    outcome = prove_active(p, p.equal | (ratio < 1), x, multipliers, ratio)
    if isinstance(outcome, Solved):
        return outcome
    # What holds but for rounding, or pushes but for rounding, is told apart one row at a time.
    active = few_rows(p, p.equal | (ratio < 1), multipliers, ratio)
    seen = set()
    for _ in range(ROUNDS):
        if active.tobytes() in seen:
            return "rows that differ by rounding were exchanged in a circle"
        seen.add(active.tobytes())
        outcome = prove_active(p, active, x, multipliers, ratio)
        if isinstance(outcome, Solved):
            return outcome
        why, drop, add = outcome
        if not len(drop) and not len(add):
            return why
        active = active.copy()
        active[drop] = False
        active[add] = True
    return "too many rows differ by rounding"


def unit_rows(p):
    norms = numpy.sqrt(numpy.asarray(p.J.multiply(p.J).sum(axis=1)).ravel())
    return p.J.toarray() / numpy.where(norms > 0, norms, 1)[:, None], norms


def few_rows(p, active, multipliers, ratio):
    """Rows independent of each other that can push as all the active ones do together (Caratheodory)."""
    J, norms = unit_rows(p)
    force, chosen, Q = multipliers * norms, [], numpy.zeros((0, len(p.q)))
    held = numpy.flatnonzero(active)
    for i in held[numpy.lexsort((ratio[held], ~p.equal[held]))]:
        rest = J[i] - (J[i] @ Q.T) @ Q
        rest = rest - (rest @ Q.T) @ Q
        size = numpy.linalg.norm(rest)
        if size > DEPENDENT:
            chosen, Q = chosen + [i], numpy.vstack([Q, rest / size])
            continue
        parts = scipy.linalg.lstsq(J[chosen].T, J[i], lapack_driver="gelsy")[0]
        room = [force[k] / -u if u < -DEPENDENT and not p.equal[k] else math.inf for k, u in zip(chosen, parts)]
        least = int(numpy.argmin(room)) if room else 0
        moved = min(force[i], room[least]) if room and not p.equal[i] else force[i]
        force[chosen] += moved * parts
        force[i] -= moved
        if force[i] > 0 and not p.equal[i]:
            force[chosen[least]] = 0
            chosen[least] = i
            Q = numpy.linalg.qr(J[chosen].T)[0].T
    fewer = numpy.zeros(len(active), dtype=bool)
    fewer[chosen] = True
    return fewer


def exchange(p, held, force, i):
    """Rows to drop so that row i, which is broken by rounding, can push (Goldfarb and Idnani's step)."""
    J, norms = unit_rows(p)
    k, n = len(held), len(p.q)
    K = numpy.block([[numpy.zeros((k, k)), J[held]], [-J[held].T, p.P.toarray()]])
    goal = numpy.r_[numpy.zeros(k), J[i]]
    step = scipy.linalg.lstsq(K, goal, cond=1e-13, lapack_driver="gelsy")[0]
    if numpy.linalg.norm(K @ step - goal) > DEPENDENT or J[i] @ step[k:] > DEPENDENT:
        return []  # x can move there
    falls = -step[:k]
    room = [f * norms[j] / u if u > DEPENDENT and not p.equal[j] else math.inf for j, f, u in zip(held, force, falls)]
    least = int(numpy.argmin(room)) if room else 0
    return [held[least]] if room and math.isfinite(room[least]) else None


def prove_active(p, active, x, multipliers, ratio):
    """A Solved whose tight rows are the active ones, or (why not, rows to drop, rows to add)."""
    n, nothing = len(p.q), numpy.zeros(0, dtype=int)
    held = numpy.flatnonzero(active)
    held = held[numpy.lexsort((ratio[held], numpy.diff(p.J.indptr)[held] > 1, ~p.equal[held]))]
    J, m = p.J[held], len(held)
    # Unknowns: multipliers, then x. Rows: those that hold, then the balance P x - J'lambda = -q.
    K = scipy.sparse.bmat([[scipy.sparse.csr_matrix((m, m)), J], [-J.T, p.P]], format="csr")
    right = numpy.r_[p.c[held], -p.q]
    rows, contradictory = exact_basis(K, right)
    bad = held[[i for i in contradictory if i < m]]
    if p.equal[bad].any():
        return "equality rows contradict each other by rounding", nothing, nothing
    if len(bad):
        return "rows that seem to hold contradict each other", bad, nothing
    guess = numpy.r_[multipliers[held], x]
    basis, level = K[rows], right[rows]
    if len(rows) < n + m:  # the other unknowns stay where the guess has them
        columns = numpy.arange(n + m)
        if rows:
            columns = scipy.linalg.qr(basis.toarray(), mode="r", pivoting=True)[1][len(rows):]
        fixed = scipy.sparse.identity(n + m, format="csr")[columns]
        basis, level = scipy.sparse.vstack([basis, fixed], format="csr"), numpy.r_[level, guess[columns]]
    solved = solve_exactly(basis, level)
    if solved is None:
        return "the rows that hold are too close to dependent ones", nothing, nothing
    v, off = solved
    exact_x, x_off = v[m:], off[m:]
    loose = numpy.flatnonzero(~active)
    slack, slack_off = product(p.J[loose], exact_x, p.c[loose]), 2 * (abs(p.J[loose]) @ x_off)
    force, force_off = numpy.array([real(a, DIGITS) for a in v[:m]]), 2 * off[:m]
    if contradictory:  # the objective falls along what no row holds: as far as the next row
        pull = numpy.zeros(n)
        at = numpy.array(contradictory) - m
        pull[at] = product(K[contradictory], v, right[contradictory])
        flat = scipy.linalg.null_space(numpy.vstack([unit_rows(p)[0][held], p.P.toarray()]), rcond=DEPENDENT)
        fall = -flat @ (flat.T @ (pull / abs(pull).max()))
        speed = -(p.J[loose] @ fall)
        room = numpy.full(len(loose), math.inf)
        ahead = speed > DEPENDENT * abs(speed).max(initial=0)
        room[ahead] = numpy.maximum(slack[ahead], 0) / speed[ahead]
        if not len(room) or not math.isfinite(room.min()):
            return "the forces of the rows that hold do not balance", nothing, nothing
        return "the forces of the rows that hold do not balance", nothing, loose[[int(room.argmin())]]
    one_sided = ~p.equal[held]
    pulls, broken = one_sided & (force < -force_off), slack < -slack_off
    if pulls.any():
        return "a row pulls", held[[int(numpy.where(pulls, force, 0).argmin())]], nothing
    if broken.any():
        i = loose[int(numpy.where(broken, slack, 0).argmin())]
        drop = exchange(p, held, force, i)
        if drop is None:
            return BY_ROUNDING, nothing, nothing
        return "a row is broken", numpy.array(drop, dtype=int), numpy.array([i])
    zero_force = numpy.flatnonzero(one_sided & (abs(force) <= force_off))
    zero_slack = numpy.flatnonzero(abs(slack) <= slack_off)
    if len(zero_force) + len(zero_slack):
        claims = scipy.sparse.vstack([
            basis, scipy.sparse.identity(n + m, format="csr")[zero_force],
            scipy.sparse.hstack([scipy.sparse.csr_matrix((len(zero_slack), m)), p.J[loose[zero_slack]]])], format="csr")
        levels = numpy.r_[level, numpy.zeros(len(zero_force)), p.c[loose[zero_slack]]]
        independent, contradictory = exact_basis(claims, levels)
        if contradictory or len(independent) != n + m:
            return f"a number below 2^-{DIGITS} is not zero", nothing, nothing
    forces = [0] * len(p.c)
    for i, f in zip(held, v):
        forces[i] = f
    strict = numpy.r_[held[~one_sided], held[one_sided & (force > force_off)]]
    return Solved(exact_x, x_off, forces, numpy.sort(strict), numpy.sort(numpy.r_[held, loose[zero_slack]]))


def objective(p, v):
    """1/2 v'Pv + q'v without error, for whole v in units of 2^-DIGITS."""
    rows, exponents = integers(p.P)
    twice = sum((Fraction(a * s, 1 << e) for a, s, e in zip(v, times(rows, v), exponents) if a and s), Fraction(0))
    linear = sum((Fraction(c) * a for c, a in zip(p.q.tolist(), v) if c and a), Fraction(0))
    return twice / (2 << 2 * DIGITS) + linear / (1 << DIGITS)


def objective_off(p, solved):
    """How far the objective at solved.x can be from the least one."""
    x = abs(numpy.array([real(a, DIGITS) for a in solved.x])) + solved.x_off
    return Fraction(float(2 * (abs(p.P) @ x + abs(p.q)) @ solved.x_off))


def without_conflict(p):
    """The program of the least t by which all unit rows can be violated at once; row i of it is row i of p, and the
    equalities come once more, turned round."""
    size = powers_of_two(numpy.sqrt(numpy.asarray(p.J.multiply(p.J).sum(axis=1)).ravel()))
    t = scipy.sparse.csr_matrix(1 / size).T
    turned = numpy.flatnonzero(p.equal)
    n = len(p.q)
    J = scipy.sparse.bmat([[p.J, t], [-p.J[turned], t[turned]], [scipy.sparse.csr_matrix((1, n)), [[1.0]]]], format="csr")
    return Program(scipy.sparse.csc_matrix((n + 1, n + 1)), numpy.r_[numpy.zeros(n), 1.0], J,
                   numpy.r_[p.c, -p.c[turned], 0.0], numpy.zeros(J.shape[0], dtype=bool))


def downhill(p):
    """The program of the steepest direction along which the objective falls for ever."""
    n, I = len(p.q), scipy.sparse.identity(len(p.q))
    J = scipy.sparse.vstack([p.P, p.J, I, -I], format="csr")
    equal = numpy.r_[numpy.full(n, True), p.equal, numpy.full(2 * n, False)]
    right = numpy.r_[numpy.zeros(n + len(p.c)), numpy.full(2 * n, -1.0)]
    used = numpy.diff(J.indptr) > 0
    return Program(scipy.sparse.csc_matrix((n, n)), p.q, J[used], right[used], equal[used])


def without_solution(p):
    """("infeasible", weights of the rows), ("unbounded", direction), or (None, None)."""
    conflict = without_conflict(p)
    solved = prove(conflict)
    if not isinstance(solved, Solved):
        return None, None
    least, off = objective(conflict, solved.x), objective_off(conflict, solved)
    if least > off:
        weights = numpy.array([real(a, DIGITS) for a in solved.multipliers])
        together = weights[:len(p.c)].copy()
        together[p.equal] -= weights[len(p.c):-1]
        return "infeasible", together
    if least != 0 and abs(solved.x[-1]) > whole(solved.x_off[-1], DIGITS) + 1:
        return None, None
    fall = downhill(p)
    solved = prove(fall)
    if isinstance(solved, Solved) and objective(fall, solved.x) < -objective_off(fall, solved):
        return "unbounded", numpy.array([real(a, DIGITS) for a in solved.x])
    return None, None


def is_definite(P):
    try:
        n = P.shape[0]
        none = scipy.sparse.csr_matrix((0, n))
        nothing = numpy.zeros(0)
        _zwang.from_qp(_zwang.Program(scipy.sparse.csc_matrix(P), numpy.zeros(n), none, nothing, none, nothing, nothing, nothing))
        return True
    except ValueError:
        return False


def make_semidefinite(p):
    """p, and by how much its P was changed: 0 where P is proven semidefinite as it stands. Else, where rounding explains
    it, P is replaced by P[:, R] P[R, R]^-1 P[R, :], which is semidefinite: by unknowns u with P[R, R] u = P[R, :] x."""
    P = scipy.sparse.csr_matrix(p.P)
    n, largest = P.shape[0], abs(P.data).max(initial=0)
    if largest == 0:
        return p, 0.0
    chosen, _ = exact_basis(P, numpy.zeros(n))
    if is_definite(P[chosen][:, chosen]):
        return p, 0.0
    dense = P.toarray()
    values, vectors = numpy.linalg.eigh(dense)
    d = vectors[:, 0]
    form = Program(P, numpy.zeros(n), scipy.sparse.csr_matrix((0, n)), [], [])
    value = 2 * objective(form, [whole(a, DIGITS) for a in d])
    if value < -Fraction(ROUNDING * largest) * sum(Fraction(a)**2 for a in d.tolist()):
        raise NotConvex(f"P is not positive semidefinite: its smallest eigenvalue is {values[0]:.3g}, and d'Pd = "
                        f"{float(value):.3g} for a d of length 1, evaluated without error")
    rest, chosen = dense.copy(), []
    while len(chosen) < n:
        k = int(numpy.argmax(rest.diagonal()))
        if rest[k, k] <= ROUNDING * largest:
            break
        chosen.append(k)
        rest = rest - numpy.outer(rest[:, k], rest[k]) / rest[k, k]
        rest[k] = rest[:, k] = 0
    chosen.sort()
    part, changed = P[chosen][:, chosen], abs(rest).max(initial=0)
    if changed > 2 * math.sqrt(ROUNDING) * largest or not is_definite(part):
        return None, changed
    m, r = len(p.c), len(chosen)
    J = scipy.sparse.bmat([[p.J, scipy.sparse.csr_matrix((m, r))], [P[chosen], -part]], format="csr")
    return Program(scipy.sparse.block_diag([scipy.sparse.csc_matrix((n, n)), part], format="csc"),
                   numpy.r_[p.q, numpy.zeros(r)], J, numpy.r_[p.c, numpy.zeros(r)],
                   numpy.r_[p.equal, numpy.full(r, True)], p.names), changed


class ConvexJudgement:
    """What is known of an answer x of a convex program whose P is singular; docs/python.md has the attributes."""

    def __init__(self):
        self.verdict, self.program, self.proof, self.worst_row = "undecided", "unknown", "", ""
        self.at_least, self.at_most, self.scale, self.scale_over_answer = 0.0, math.nan, math.nan, math.nan
        self.primal, self.objective_error = math.nan, math.nan
        self.objective, self.objective_at_least, self.objective_at_most = math.nan, -math.inf, math.inf
        self.unique, self.certificate, self.changed = None, None, 0.0

    def __str__(self):
        text = self.verdict
        if self.program in ("infeasible", "unbounded"):
            text += f": the program is {self.program}"
        elif self.program == "solvable":
            text += (f": |x - x*|_P is at least {self.at_least:.3g} and at most {self.at_most:.3g} (relative to s), the "
                     f"objective is off by {self.objective_error:.3g} of its terms from the least one, between "
                     f"{self.objective_at_least!r} and {self.objective_at_most!r}")
            text += {True: "; x* is the only solution", False: "; x* is not unique", None: ""}[self.unique]
            if self.worst_row:
                text += f"; worst row: {self.worst_row}, violated by {self.primal:.3g}"
        if self.changed:
            text += f"; P was judged as a semidefinite matrix that differs by {self.changed:.3g}"
        return text + (f"; proof: {self.proof}" if self.proof else "")

    def __repr__(self):
        return f"<{self}>"


class Truth:
    """What is known of a program, whatever the answer."""

    def __init__(self, given):
        self.given = given
        self.p, self.changed = make_semidefinite(given)
        self.solved = self.state = self.certificate = None
        self.why = "P is neither proven semidefinite nor proven indefinite"
        if self.p is None:
            return
        outcome = prove(self.p)
        if isinstance(outcome, Solved):
            self.solved, self.why = outcome, ""
            self.unique = outcome.unique(self.p)
            self.least, self.off = objective(self.p, outcome.x), objective_off(self.p, outcome)
            return
        self.why = outcome
        if outcome == BY_ROUNDING:
            return
        self.state, self.certificate = without_solution(self.p)


_truths = {}


def truth_of(p):
    parts = [p.P.indptr, p.P.indices, p.P.data, p.q, p.J.indptr, p.J.indices, p.J.data, p.c, p.equal]
    key = tuple(part.tobytes() for part in parts)
    if key not in _truths:
        while len(_truths) > 7:
            _truths.pop(next(iter(_truths)))
        _truths[key] = Truth(p)
    return _truths[key]


def judge(P, q, G, h, A, b, lb, ub, x, tolerance):
    """Arrays as judge_qp checked them; absent vectors are empty."""
    n = len(q)
    if len(x) != n:
        raise ValueError(f"x should have {n} entries, and has {len(x)}")
    given = Program.of(P, q, G, h, A, b, lb, ub)
    truth = truth_of(given)
    out = ConvexJudgement()
    out.changed = truth.changed
    if truth.solved is None:
        out.proof = truth.why
        if truth.state:
            out.program, out.certificate, out.verdict = truth.state, truth.certificate, "wrong"
            out.proof = {"infeasible": "weights of the rows that no x can meet",
                         "unbounded": "a direction along which the objective falls for ever"}[truth.state]
        return out
    p, solved = truth.p, truth.solved
    out.program, out.unique = "solvable", truth.unique
    out.proof = f"the rows that hold, solved to {DIGITS} bits; rank modulo two primes of 61 bits"
    out.objective_at_least = math.nextafter(float(truth.least - truth.off), -math.inf)
    out.objective_at_most = math.nextafter(float(truth.least + truth.off), math.inf)
    if not numpy.isfinite(x).all():
        out.verdict, out.at_most = "wrong", math.inf
        return out
    v = [whole(a, DIGITS) for a in x]
    if len(p.q) > n:
        rows = p.J[len(given.c):]
        system = scipy.sparse.vstack([scipy.sparse.identity(n + rows.shape[0], format="csr")[:n], rows])
        point = solve_exactly(system, numpy.r_[x, numpy.zeros(rows.shape[0])])
        if point is None:
            out.proof = "P is too close to a matrix of lower rank"
            return out
        v = v + point[0][n:]
    form = Program(p.P, numpy.zeros(len(p.q)), p.J, p.c, p.equal)
    apart = math.sqrt(max(2 * objective(form, [a - s for a, s in zip(v, solved.x)]), 0))
    energy = 2 * objective(form, solved.x)
    answer = numpy.array([real(a, DIGITS) for a in solved.x[:n]])
    found = objective(p, v)
    terms = float(energy) / 2 + abs(q) @ abs(answer)
    if terms == 0:
        terms = float(objective(form, v)) + abs(q) @ abs(x)
    terms = terms or 1.0
    out.scale = math.sqrt(2 * terms)
    size = math.sqrt(float(energy))
    out.scale_over_answer = out.scale / size if size > 0 else math.inf
    off = float((solved.x_off @ (abs(p.P) @ solved.x_off)))**0.5 / out.scale
    out.at_least = max(apart / out.scale * (1 - CAUTION) - off, 0)
    out.at_most = apart / out.scale * (1 + CAUTION) + off
    out.objective = float(found)
    out.objective_error = float(abs(found - truth.least)) / terms
    length = numpy.linalg.norm(answer) or numpy.linalg.norm(x) or 1.0
    norms = numpy.sqrt(numpy.asarray(given.J.multiply(given.J).sum(axis=1)).ravel())
    slack = product(given.J, v[:n], given.c)
    broken = numpy.where(given.equal, abs(slack), numpy.maximum(-slack, 0)) / numpy.where(norms > 0, norms, 1) / length
    out.primal = float(broken.max(initial=0))
    if out.primal > 0:
        out.worst_row = given.names[int(broken.argmax())]
    error = max(apart / out.scale, out.primal, out.objective_error)
    out.verdict = _zwang.by_error(error * (1 + CAUTION) + off, error * (1 - CAUTION) - off, tolerance)
    return out
