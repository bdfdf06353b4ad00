"""Decides whether a contact is at a tie: whether numbers that cannot be told from zero are zero (docs/python.md#gradients)."""
import math
from fractions import Fraction

import numpy
import scipy.sparse

from .semidefinite import exact_basis

RATIONAL = 80  # unknowns and forces of a system whose solution is looked for in rationals
DIGITS = (320, 1280, 5120)  # bits of it


def rational(branch):
    """The solution in rationals, which solve the equations without error; None where none was found."""
    if branch.size > RATIONAL:
        return None
    A = branch.A.tocsr()
    rows = [(A.indices[a:b].tolist(), [Fraction(v) for v in A.data[a:b].tolist()]) for a, b in zip(A.indptr, A.indptr[1:])]
    constants = [Fraction(v) for v in branch.constants.tolist()]
    right = [Fraction(v) for v in branch.right.tolist()]

    def residual(x):
        full = x + constants
        out = [sum((a * full[j] for j, a in zip(*row)), -b) for row, b in zip(rows, right)]
        nothing = [Fraction(0)] * len(x)
        for contact, row in branch.bent:
            out[row:row + 3] = branch.bent_values(contact, x, nothing)
        return out
    x = [Fraction(a) + Fraction(b) for a, b in zip(branch.high.tolist(), branch.low.tolist())]
    for bits in DIGITS:
        for _ in range(bits):
            r = residual(x)
            largest = max(map(abs, r), default=Fraction(0))
            if not largest:
                return near_enough(branch, x)
            shift = largest.denominator.bit_length() - largest.numerator.bit_length()
            if shift > bits:
                break
            scaled = numpy.array([float(v * (1 << shift) if shift >= 0 else v / (1 << -shift)) for v in r])
            step = branch.regular.step(scaled)
            size = Fraction(1, 1 << shift) if shift >= 0 else Fraction(1 << -shift)
            x = [Fraction(((a - Fraction(b) * size) * (1 << bits + 64)).__floor__(), 1 << bits + 64) for a, b in zip(x, step.tolist())]
        near = [a.limit_denominator(1 << bits // 2 - 8) for a in x]
        if not any(residual(near)):
            return near_enough(branch, near)
    return None


def near_enough(branch, x):
    """x, where it lies in the ball in which there is one solution."""
    inside = all(abs(a - Fraction(b) - Fraction(c)) <= Fraction(r) for a, b, c, r in zip(x, branch.high, branch.low, branch.radius))
    return x if inside else None


class Tie:
    """A contact with something that is zero and may grow to either side. touch: gap and force; apex: those and the slip; edge: the slip
    and what the force has to spare. direction: of the slip."""

    def __init__(self, contact, word, direction, direction_off):
        self.contact, self.word, self.direction, self.direction_off = contact, word, direction, direction_off


class Exactly:
    """Decides of numbers that are zero to all digits whether they are zero."""

    def __init__(self, settled):
        self.p, self.branch = settled.p, settled.branch
        self.claims, self.tried = [], False
        self.x = None

    def point(self):
        if not self.tried:
            self.x, self.tried = rational(self.branch), True
        return self.x

    def linear(self, lines):
        """Whether these rows of (columns of x and constants, entries, right side), with further unknowns at the end, hold."""
        b = self.branch
        width = b.A.shape[1]
        more = max((j - width + 1 for columns, *_ in lines for j in columns), default=0)
        more = max(more, 0)
        k = len(b.constants)
        base = scipy.sparse.vstack([b.A, scipy.sparse.hstack([scipy.sparse.csr_matrix((k, b.size)), scipy.sparse.identity(k)])])
        base = scipy.sparse.hstack([base, scipy.sparse.csr_matrix((base.shape[0], more))])
        at = [(r, j, v) for r, (columns, entries, _) in enumerate(lines) for j, v in zip(columns, entries)]
        claims = scipy.sparse.csr_matrix(([v for *_, v in at], ([r for r, *_ in at], [j for _, j, _ in at])),
                                         shape=(len(lines), width + more))
        independent, contradictory = exact_basis(scipy.sparse.vstack([base, claims], format="csr"),
                                                 numpy.r_[b.right, b.constants, [c for *_, c in lines]])
        return not contradictory and len(independent) == width + more

    def line(self, i, columns=(), entries=()):
        part = slice(self.p.J.indptr[i], self.p.J.indptr[i + 1])
        return self.p.J.indices[part].tolist() + list(columns), self.p.J.data[part].tolist() + list(entries), float(self.p.c[i])

    def value(self, i):
        """The slack of a row at the rational point."""
        columns, entries, c = self.line(i)
        return sum((Fraction(a) * self.x[j] for j, a in zip(columns, entries)), -Fraction(c))

    def force(self, i):
        b = self.branch
        if i in b.column:
            return self.x[b.column[i]]
        return Fraction(float(b.force[i]))

    def gaps(self, rows):
        """Whether the slack of these rows is zero."""
        if not self.branch.bent:
            return self.linear([self.line(i) for i in rows])
        return self.point() is not None and not any(self.value(i) for i in rows)

    def at_edge(self, contact):
        """Whether an open contact of the convex law has s_n = mu |s_t|."""
        b, i, t = self.branch, contact.row, contact.tangents
        if not b.bent and len(t) == 1:
            sign = math.copysign(1, b.slack[t[0]])
            width = b.A.shape[1]
            return self.linear([self.line(t[0], [width], [-1.0]), self.line(i, [width], [-sign * contact.mu])])
        return self.point() is not None and self.value(i) ** 2 == Fraction(contact.mu) ** 2 * sum(self.value(k) ** 2 for k in t)

    def force_at_edge(self, contact):
        b, i, t = self.branch, contact.row, contact.tangents
        if not b.bent and len(t) == 1:
            place = {int(k): b.size + self.p.n + a for a, k in enumerate(b.frozen)} | b.column
            return self.linear([([place[t[0]], place[i]], [1.0, -math.copysign(contact.mu, b.force[t[0]])], 0.0)])
        if self.point() is None:
            return False
        return Fraction(contact.mu) ** 2 * self.force(i) ** 2 == sum(self.force(k) ** 2 for k in t)
