"""Square systems in doubles, with bounds that are proven: what zwang.gradient rests on (docs/python.md).

Products and sums are split into two doubles without error (Dekker, 1971), so that residuals are right to twice the digits. An
approximate inverse is believed as far as |I - R K| < 1 is shown, with the a priori bounds of products of matrices in any order of
summation (Higham 2002, section 3.5).
"""
import functools

import numpy
import scipy.linalg
import scipy.sparse

from .semidefinite import LARGEST, powers_of_two

EPSILON = 2.0**-53
UNDERFLOW = 2.0**-1060  # more than what one product of two doubles loses there
UP = 1 + 2.0**-36  # more than what sums of up to LARGEST terms that are not negative can lose
SCALINGS = 20  # of rows and columns, at most
SPLIT = 2.0**27 + 1


class Unproven(Exception):
    """Why nothing is proven, in one line."""


def two_products(a, b):
    """p + e = a b without error, but for underflow."""
    def halves(x):
        large = SPLIT * x
        high = large - (large - x)
        return high, x - high
    p = a * b
    (ah, al), (bh, bl) = halves(a), halves(b)
    return p, ((ah * bh - p) + ah * bl + al * bh) + al * bl


def added(a, b):
    """a + b as two doubles, without error."""
    s = a + b
    t = s - a
    return s, (a - (s - t)) + (b - t)


class Rows:
    """A sparse matrix whose products with vectors, each the sum of two, come as two doubles and a bound.

    The terms of a row are added in pairs, and the sums in pairs again: all rows take a step together. What a sum is rounded by is kept
    without error (Knuth 1998, section 4.2.2), and summed in the same way; of the sums of these small parts the size of what they are
    rounded by is kept alone. math.fsum would round once; it takes a row at a time.
    """

    def __init__(self, A):
        A = scipy.sparse.csr_matrix(A)
        self.data, self.indices, self.starts, self.absolute = A.data, A.indices, A.indptr[:-1], abs(A)
        self.terms = numpy.diff(A.indptr)

    @functools.cached_property
    def pairs(self):
        """Of each step (first, second) of each pair, and where the sums of the rows stand in the end. A zero follows the last term."""
        steps, starts, sizes = [], self.starts, self.terms
        while sizes.max(initial=0) > 1:
            halves = (sizes + 1) // 2
            ends = numpy.cumsum(halves)
            place = 2 * (numpy.arange(ends[-1]) - numpy.repeat(ends - halves, halves))
            first = numpy.repeat(starts, halves) + place
            steps.append((first, numpy.where(place + 1 < numpy.repeat(sizes, halves), first + 1, sizes.sum())))
            starts, sizes = ends - halves, halves
        return steps, numpy.where(sizes > 0, starts, sizes.sum())

    def times(self, high, low, plus=()):
        """A (high + low) + the sum of plus: (high, low, what these are off)."""
        def with_zero(v):
            return numpy.concatenate([v, [0.0]])

        def summed(small, more, lost):
            small, off = added(small, more)
            return small, lost + abs(off)

        pairs, last = self.pairs
        with numpy.errstate(over="ignore", invalid="ignore"):
            large, small = two_products(self.data, high[self.indices])
            more, lost = two_products(self.data, low[self.indices])
            large, (small, lost) = with_zero(large), map(with_zero, summed(small, more, abs(lost)))
            for first, second in pairs:
                sums, rest = added(large[first], large[second])
                small, lost = summed(small[first], small[second], lost[first] + lost[second])
                large, (small, lost) = with_zero(sums), map(with_zero, summed(small, rest, lost))
            large, small, lost = large[last], small[last], lost[last]
            for term in plus:
                large, rest = added(large, term)
                small, lost = summed(small, rest, lost)
            large, small = added(large, small)
        if not numpy.isfinite(large + small + lost).all():
            raise Unproven("numbers are too large for a proof")
        return large, small, lost * UP + 2 * (self.terms + 1) * UNDERFLOW


class Regular:
    """A square matrix K, each entry off by at most off, proven to be regular; else Unproven. units: of the unknowns, where
    they are known."""

    def __init__(self, K, off=None, units=None):
        n = len(K)
        if n > LARGEST:
            raise Unproven(f"more than {LARGEST} unknowns and forces")
        left, across = numpy.ones(n), numpy.ones(n) if units is None else 1 / powers_of_two(units)
        size = abs(K)
        if units is not None and n:
            left = powers_of_two((size * across).max(axis=1))
        for _ in range(SCALINGS if units is None and n else 0):
            across = across * powers_of_two(numpy.sqrt((size * left[:, None] * across).max(axis=0)))
            rows = (size * left[:, None] * across).max(axis=1)
            left = left * powers_of_two(numpy.sqrt(rows))
            if rows.max() <= 4 and rows.min() >= 0.25:
                break
        self.K, self.off, self.left, self.across, self.rows, self.columns = K, off, left, across, None, None
        S = K * left[:, None] * across
        try:
            self.inverse = scipy.linalg.inv(S, check_finite=False)
        except (scipy.linalg.LinAlgError, ValueError):
            raise Unproven("its equations depend on each other") from None
        self.size = abs(self.inverse)
        rest = abs(numpy.identity(n) - self.inverse @ S).sum(axis=1)
        slack = 2 * (n + 4) * EPSILON * (self.size @ abs(S).sum(axis=1) + 1)
        if off is not None:
            slack = slack + self.size @ ((off * left[:, None]) @ across)
        self.rest = (rest + slack) * UP
        self.contraction = self.rest.max(initial=0)
        if not self.contraction < 0.5:
            raise Unproven("its equations are too close to dependent ones")

    def step(self, right):
        return self.across * (self.inverse @ (self.left * right))

    def transposed(self, right):
        """v with K'v = right, and what its entries are off."""
        def once(r):
            return self.left * (self.inverse.T @ (self.across * r))
        if self.columns is None:
            self.columns = Rows(scipy.sparse.csr_matrix(self.K.T))
        rows = self.columns
        v, low = once(right), numpy.zeros(len(right))
        for turn in range(3):
            residual, small, off = rows.times(-v, -low, (right,))
            step = once(residual)
            if turn == 2 or (abs(step) <= 2.0**-80 * abs(v).max(initial=0)).all():
                break
            v, rest = added(v, step)
            v, low = added(v, low + rest)
        if self.off is not None:
            off = off + (self.off.T @ (abs(v) + abs(low))) * UP
        # K^-T = R' (1 - E)^-T in scaled numbers, and sums of columns of E' are those of rows of E, which are bounded.
        rest = self.across * (abs(residual) + abs(small) + off)
        more = rest.sum() * self.contraction / (1 - self.contraction)
        return v, (self.left * (self.size.T @ rest + self.size.max(axis=0, initial=0) * more) + abs(low)) * UP

    def first(self, residual, off):
        """A bound on |R r|, scaled, for a residual and what it is off."""
        r = self.left * residual
        return (abs(self.inverse @ r) + self.size @ ((len(r) + 4) * EPSILON * abs(r) + self.left * off)) * UP

    def radius(self, residual, off, curvature=None):
        """How far the solution is from the point of that residual. curvature: of quadratic equations, a bound on what the second
        order adds to each for a step of 1 in scaled unknowns."""
        delta = self.first(residual, off)
        largest = delta.max(initial=0)
        ball = 2 * largest / (1 - self.contraction)
        bent = numpy.zeros(len(delta)) if curvature is None else self.size @ (self.left * curvature) * UP
        total = (delta + self.rest * ball + bent * ball * ball) * UP
        if not (total <= ball).all() or not (self.rest + 2 * bent * ball < 1).all():
            raise Unproven("no solution is proven near the answer")
        return self.across * total

    def solve(self, right, right_low, right_off):
        """K y = right as two doubles and what they are off."""
        if self.rows is None:
            self.rows = Rows(scipy.sparse.csr_matrix(self.K))
        rows = self.rows
        high, low = self.step(right), numpy.zeros(len(right))
        for turn in range(4):
            residual, small, off = rows.times(-high, -low, (right, right_low))
            off = off + right_off
            if self.off is not None:
                off = off + (self.off @ (abs(high) + abs(low))) * UP
            step = self.step(residual)
            if turn == 3 or (abs(step) <= 2.0**-80 * abs(high).max(initial=0)).all():
                break
            high, rest = added(high, step)
            low = low + rest
            high, low = added(high, low)
        return high, low, self.radius(residual, off + abs(small))


def is_definite(M):
    """Whether the sparse symmetric M is proven positive definite (Rump 2006: a shifted factorization in doubles)."""
    M = M.toarray()
    n = len(M)
    if not n:
        return True
    if not (M.diagonal() > 0).all():
        return False
    scale = powers_of_two(numpy.sqrt(M.diagonal()))
    M = M * scale[:, None] * scale
    shift = 4 * (n + 2) * EPSILON * M.trace()
    try:
        scipy.linalg.cholesky(M - shift * numpy.identity(n), check_finite=False)
        return True
    except scipy.linalg.LinAlgError:
        return False
