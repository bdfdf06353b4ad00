"""Derivatives of a solution without a proof, for inner loops (docs/python.md#gradients).

With t = dJ z - dc the change of a solution keeps the rows that push, J dz + t = 0, and of a contact that slides the plane of its ray, while its
force turns with the slip: linear equations, which one factor solves (solvers/friction/solution_derivative.h).
"""
import functools

import numpy

from . import _zwang
from .gradients import NAMES, NOT_UNIQUE, Change, Derivative, Parts, answer, finite, wanted

class QuickDerivative(Derivative):
    enclosure = enclosure_lambda = reach = reach_row = free = None

    def __init__(self, dz, kink, names, note):
        self.dz, self.dlambda, self.kink, self.kink_names, self.one_sided, self.note = dz, None, kink, names, bool(kink), note


class QuickGradient:
    """The derivatives of one solution, as zwang.gradient_of(..., proof=False) makes it: as Gradient, less enclosure and reach."""

    def __init__(self, problem, solution, laid=None):
        self.problem, self.solution, self.laid, self.unique_forces = problem, solution, laid, True
        try:
            solved = isinstance(solution, _zwang.Solution)
            keeps = self.keeps = _zwang.SolutionDerivative(problem, *((solution.z, solution.lambda_) if solved else self.given))
        except ValueError as bad:
            raise ValueError(f"no gradient: {bad}") from None
        if not keeps.off <= keeps.tie * keeps.motion:
            raise ValueError(f"no gradient: the answer is off by {keeps.off / (keeps.motion or 1):.1e} of the motion, and modes are read to "
                             f"{keeps.tie:.0e}")
        self.held, self.kink = keeps.rows, keeps.ties
        self.has_number = not self.kink or not (self.slides or self.rubs())

    def __repr__(self):
        return f"<zwang.Gradient of {self.problem.name}, without proof: {'kink: ' + ', '.join(self.kink_names) if self.kink else 'smooth'}>"

    def rubs(self):
        """Is there friction at a kink?"""
        mu, tangent = self.problem.mu, self.problem.tangent
        return any(mu[i] > 0 and i + 1 < len(tangent) and tangent[i + 1] for i in self.kink)

    @functools.cached_property
    def given(self):
        return answer(self.problem, self.solution)

    @functools.cached_property
    def slides(self):
        return bool(self.keeps.by_mu.any())

    @functools.cached_property
    def owner(self):
        """Of each row the contact, which has its mu."""
        return numpy.maximum.accumulate(numpy.where(self.problem.tangent, 0, numpy.arange(self.problem.rows)))

    @functools.cached_property
    def kink_names(self):
        names = self.problem.row_names if self.kink else []
        return [names[i] for i in self.kink]

    def one_sided(self, z_u, force, moved):
        """Of rows that neither push nor open: Gauss' problem once more, in which they may do either."""
        from . import Problem, solve
        p, rows = self.problem, self.held
        free = z_u + Parts(p).solve_mass(force) if force.any() else z_u
        found = solve(Problem(p.M, free, p.J[rows], -moved[rows], equality=len(rows) - len(self.kink)), "dual_active_set", tolerance=1e-12)
        if found.status != "solved":
            raise ValueError(f"no gradient: rows that push do not hold together: {found.status}")
        own = numpy.zeros(p.rows)
        own[rows] = found.lambda_
        return found.z, own

    def once(self, z_u, force, moved, back):
        own = numpy.zeros(self.problem.rows)
        try:
            z, own[self.held], *words = self.keeps.solve(z_u, force, moved[self.held], back)
        except ValueError as bad:
            raise ValueError(f"no gradient: {bad}") from None
        return z, own, *words

    def left(self, z_u, force, moved, z, own, back):
        """What z and own leave of the force and of the rows, in long doubles: of what slides the plane's part, in its normal row."""
        p, wide = self.problem, numpy.longdouble
        J = p.J.astype(wide)
        rest = force + p.M.astype(wide) @ (z_u - z.astype(wide)) + J.T @ own.astype(wide)
        missed = J @ z.astype(wide) + moved
        if self.slides:
            along = numpy.where(p.tangent, self.keeps.by_mu, 0)
            turned, load = numpy.zeros((2, p.rows), dtype=wide)
            numpy.add.at(turned, self.owner, along * missed)
            numpy.add.at(load, self.owner, along.astype(wide) ** 2)
            slides = load > 0
            opening = 1 if back or p.law == "convex" else 0
            missed[slides] += opening * p.mu[slides] * turned[slides] / numpy.sqrt(load[slides])
            missed[slides[self.owner] & p.tangent] = 0
        return rest.astype(float), missed.astype(float)

    def solve(self, z_u, force, moved, back):
        if not self.has_number:
            raise ValueError("no gradient: a kink of friction, or beside what slides: only a proof tells (proof=True)")
        z, own, unique, settled, small = self.once(z_u, force, moved, back)
        if self.kink and (small or not settled):
            z, own = self.one_sided(z_u, force, moved)
        elif small:
            more_z, more, *_ = self.once(0 * z, *self.left(z_u, force, moved, z, own, back), back)
            z, own = z + more_z, own + more
        self.unique_forces = self.unique_forces and unique
        if not self.unique_forces and self.slides:
            raise ValueError("no gradient: forces are not unique beside contacts that slide: only a proof tells (proof=True)")
        return z, own

    def jvp(self, dM=None, dz_u=None, dJ=None, dc=None, dmu=None):
        """As Gradient.jvp; its Derivative has no enclosure and no reach."""
        p, bends, extra = self.problem, False, None
        if dM is None and dJ is None and dc is None and dmu is None:
            t, force = numpy.zeros(p.rows), numpy.zeros(p.size)
            dz_u = force if dz_u is None else finite(dz_u, "dz_u", p.size)
        else:
            change = Change(Parts(self.laid.given if self.laid else p), dM, dz_u, dJ, dc, dmu)
            change = self.laid.forward(change) if self.laid else change
            if change.dJ.nnz:
                bent, rows = (abs(J[self.held]).sum(axis=1).A1 > 0 for J in (change.dJ, p.J))
                slides = numpy.bincount(self.owner, abs(self.keeps.by_mu), p.rows)[self.owner] > 0
                if (bent & ~rows & ~slides[self.held]).any():
                    raise ValueError("no gradient: a row without entries gets some: it may ask for any motion")
            z, lambda_ = self.given
            t, dz_u = change.dJ @ z - change.dc, change.dz_u
            force = change.dM @ (p.z_u - z) + change.dJ.T @ lambda_
            bends = change.dJ.nnz > 0 or t[self.held].any()
            if self.slides:
                extra = self.keeps.by_mu * change.dmu[self.owner]
                t = t + numpy.where(p.tangent, 0, extra)
                extra[~p.tangent] = 0
                force = force + p._push(extra)
        dz, own = self.solve(dz_u, force, t, False)
        if bends and not self.unique_forces:
            raise ValueError("no gradient: forces are not unique, and J or c change: only a proof tells (proof=True)")
        out = QuickDerivative(dz, self.kink, self.kink_names, "" if self.unique_forces else NOT_UNIQUE)
        if self.unique_forces:
            out.dlambda = own if extra is None else own + extra
        return out

    def vjp(self, z_bar, lambda_bar=None, wrt=NAMES):
        """As Gradient.vjp."""
        p, names = self.problem, wanted(wrt)
        asked = NAMES if self.laid else names
        if self.kink:
            raise ValueError(f"no gradient: kink: {', '.join(self.kink_names)}")
        z_bar = finite(z_bar, "z_bar", p.size)
        bar = numpy.zeros(p.rows) if lambda_bar is None else finite(lambda_bar, "lambda_bar", p.rows)
        push, t_bar = self.solve(numpy.zeros(p.size), z_bar, bar, True)
        if lambda_bar is not None and not self.unique_forces:
            raise ValueError(f"no gradient: {NOT_UNIQUE}")
        out, (z, lambda_) = dict.fromkeys(asked), self.given
        if "M" in asked:
            by_M = numpy.outer(push, z - p.z_u)
            out["M"] = -0.5 * (by_M + by_M.T)
        if "z_u" in asked:
            out["z_u"] = p._weigh(push)
        if "mu" in asked:
            out["mu"] = numpy.zeros(p.rows)
            if self.slides:
                numpy.add.at(out["mu"], self.owner, self.keeps.by_mu * numpy.where(p.tangent, p.J @ push + bar, t_bar))
        if "J" in asked and self.unique_forces:
            out["J"] = numpy.outer(lambda_, push) + numpy.outer(t_bar, z)
        if "c" in asked and self.unique_forces:
            out["c"] = -t_bar
        if self.laid:
            out = self.laid.back(out, {name: 0 * bar for name, bar in out.items() if bar is not None})[0]
        return {name: out[name] for name in names}
