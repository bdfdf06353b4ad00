"""Derivatives of a solution without a proof, for inner loops (docs/python.md#gradients).

With t = dJ z - dc the change of a solution keeps the rows that push, J dz + t = 0, and of a contact that slides the plane of its ray, while its
force turns with the slip: linear equations, which one factor solves (solvers/friction/solution_derivative.h).
"""
import functools

import numpy

from . import _zwang
from .gradients import NAMES, NOT_UNIQUE, Change, Derivative, Parts, answer, finite, plain, read, wanted

NONE = numpy.empty(0)


class Kink:
    """The rows of a kink, named when asked."""

    @property
    def kink_names(self):
        names = self.problem.row_names if self.kink else []
        return [names[i] for i in self.kink]


class QuickDerivative(Kink, Derivative):
    enclosure = enclosure_lambda = reach = reach_row = free = None

    def __init__(self, problem, dz, dlambda, kink):
        self.problem, self.dz, self.dlambda, self.kink, self.one_sided = problem, dz, dlambda, kink, bool(kink)
        self.note = NOT_UNIQUE if dlambda is None else ""


class QuickGradient(Kink):
    """The derivatives of one solution, as zwang.gradient_of(..., proof=False) makes it: as Gradient, less enclosure and reach."""

    def __init__(self, problem, solution, laid=None):
        self.problem, self.solution, self.laid, self.unique_forces = problem, solution, laid, True
        try:
            if isinstance(solution, _zwang.Solution):
                self.keeps = _zwang.SolutionDerivative(problem, solution)
            else:
                self.keeps = _zwang.SolutionDerivative(problem, *self.given)
        except ValueError as bad:
            raise ValueError(f"no gradient: {bad}") from None
        self.kink = self.keeps.ties

    def __repr__(self):
        return f"<zwang.Gradient of {self.problem.name}, without proof: {'kink: ' + ', '.join(self.kink_names) if self.kink else 'smooth'}>"

    @functools.cached_property
    def given(self):
        solution = self.solution
        return (solution.z, solution.lambda_) if isinstance(solution, _zwang.Solution) else answer(self.problem, solution)

    def one_sided(self, z_u, force, moved):
        """Of rows that neither push nor open: Gauss' problem once more, in which they may do either."""
        from . import Problem, solve
        p, rows = self.problem, self.keeps.rows
        z_u, moved = z_u if z_u.size else numpy.zeros(p.size), moved if moved.size else numpy.zeros(p.rows)
        free = z_u + Parts(p).solve_mass(force) if force.any() else z_u
        found = solve(Problem(p.M, free, p.J[rows], -moved[rows], equality=len(rows) - len(self.kink)), "dual_active_set", tolerance=1e-12)
        if found.status != "solved":
            raise ValueError(f"no gradient: rows that push do not hold together: {found.status}")
        own = numpy.zeros(p.rows)
        own[rows] = found.lambda_
        return found.z, own

    def require_unique(self, unique):
        self.unique_forces = self.unique_forces and unique
        if not self.unique_forces and self.keeps.slides:
            raise ValueError("no gradient: forces are not unique beside contacts that slide: only a proof tells (proof=True)")

    def require_entries(self, dJ):
        p, rows = self.problem, self.keeps.rows
        bent, old = (abs(J[rows]).sum(axis=1).A1 > 0 for J in (dJ, p.J))
        owner = numpy.maximum.accumulate(numpy.where(p.tangent, 0, numpy.arange(p.rows)))
        slides = numpy.bincount(owner, abs(self.keeps.by_mu), p.rows)[owner] > 0
        if (bent & ~old & ~slides[rows]).any():
            raise ValueError("no gradient: a row without entries gets some: it may ask for any motion")

    def jvp(self, dM=None, dz_u=None, dJ=None, dc=None, dmu=None):
        """As Gradient.jvp; its Derivative has no enclosure and no reach."""
        p, force, moved, bends = self.problem, NONE, NONE, False
        if dM is None and dJ is None and not self.laid:
            dz_u = NONE if dz_u is None else plain(dz_u, "dz_u", p)
            moved = NONE if dc is None else -finite(dc, "dc", p.rows)
            dmu = NONE if dmu is None else read(p, finite(dmu, "dmu", p.rows))
            sides = (dz_u, force, moved, dmu) if moved.size or dmu.size else (dz_u,)
        else:
            change = Change(Parts(self.laid.given if self.laid else p), dM, dz_u, dJ, dc, dmu)
            change = self.laid.forward(change) if self.laid else change
            bends = change.dJ.nnz > 0
            if bends:
                self.require_entries(change.dJ)
            z, lambda_ = self.given
            moved, dz_u, dmu = change.dJ @ z - change.dc, change.dz_u, change.dmu
            force = change.dM @ (p.z_u - z) + change.dJ.T @ lambda_
            sides = dz_u, force, moved, dmu
        if self.kink and (self.keeps.slides or self.keeps.ties_rub):
            raise ValueError("no gradient: a kink of friction, or beside what slides: only a proof tells (proof=True)")
        try:
            dz, dlambda, unique, settled, small = self.keeps.along(*sides)
        except ValueError as bad:
            if dz_u is not NONE:
                finite(dz_u, "dz_u", p.size)
            raise ValueError(f"no gradient: {bad}") from None
        if self.kink and (small or not settled):
            dz, dlambda = self.one_sided(dz_u, force, moved)
        self.require_unique(unique)
        if not self.unique_forces and (bends or len(moved) and moved[self.keeps.rows].any()):
            raise ValueError("no gradient: forces are not unique, and J or c change: only a proof tells (proof=True)")
        return QuickDerivative(p, dz, dlambda if self.unique_forces else None, self.kink)

    def vjp(self, z_bar, lambda_bar=None, wrt=NAMES):
        """As Gradient.vjp."""
        p, names = self.problem, wrt if type(wrt) is tuple and not self.laid else wanted(wrt)  # else the C++ refuses wrong ones
        if self.kink:
            raise ValueError(f"no gradient: kink: {', '.join(self.kink_names)}")
        z_bar = plain(z_bar, "z_bar", p)
        lambda_bar = NONE if lambda_bar is None else finite(lambda_bar, "lambda_bar", p.rows)
        try:
            out, unique = self.keeps.back(z_bar, lambda_bar, NAMES if self.laid else names)
        except ValueError as bad:
            wanted(names)
            finite(z_bar, "z_bar", p.size)
            raise ValueError(f"no gradient: {bad}") from None
        self.require_unique(unique)
        if lambda_bar is not NONE and not self.unique_forces:
            raise ValueError(f"no gradient: {NOT_UNIQUE}")
        if not self.laid:
            return out
        out = self.laid.back(out, {name: 0 * bar for name, bar in out.items() if bar is not None})[0]
        return {name: out[name] for name in names}
