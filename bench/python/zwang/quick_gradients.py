"""Derivatives of a solution without a proof, for inner loops (docs/python.md#gradients).

With t = dJ z - dc the change of a solution keeps the rows that push: M dz = force + N dlambda, S dz = -t. _zwang.Kept solves that with S' in
place of N, and without friction that turns with its slip. Both are few unknowns, each of them one more solve.
"""
import functools

import numpy

from . import _zwang
from .gradients import NOT_UNIQUE, Change, Derivative, Parts, answer, finite

CLEAR = 1e-8  # of the motion: less counts as zero
FEW = 150  # unknowns


class Slide:
    """A contact that slides: rows, |s_t| and lambda_n, mu and what the law adds to the gap for a slip, s_t / |s_t| and what is across it."""

    def __init__(self, problem, row, tangents, place, slip, load, mu, lift):
        self.row, self.t, self.place, self.slip, self.load = row, slice(row + 1, row + 1 + tangents), place, numpy.linalg.norm(slip), load
        self.mu, self.lift, self.direction = mu, lift, slip / numpy.linalg.norm(slip)
        self.turned = numpy.array([-self.direction[1], self.direction[0]]) if tangents > 1 else numpy.zeros(1)
        self.turns = mu * load / self.slip if tangents > 1 else 0.0
        self.along, self.across = self.pushed(problem, self.direction), self.pushed(problem, self.turned)

    def pushed(self, problem, force):
        f = numpy.zeros(problem.rows)
        f[self.t] = force
        return problem._push(f)


class QuickDerivative(Derivative):
    enclosure = enclosure_lambda = reach = reach_row = free = None

    def __init__(self, dz, kink, names, note):
        self.dz, self.dlambda, self.kink, self.kink_names, self.one_sided, self.note = dz, None, kink, names, bool(kink), note


class QuickGradient:
    """The derivatives of one solution, as zwang.gradient_of(..., proof=False) makes it: as Gradient, less enclosure and reach."""

    def __init__(self, problem, solution, laid=None):
        self.problem, self.solution, self.laid = problem, solution, laid
        try:
            solved = isinstance(solution, _zwang.Solution)
            self.unit, self.slack, self.off, self.motion = problem._residuals(*((solution,) if solved else self.given))
        except ValueError as bad:
            raise ValueError(f"no gradient: {bad}") from None
        self.force = solution.lambda_ if solved else self.given[1]
        self.zero, self.slides, self.has_number = CLEAR * self.motion, [], True
        self.kept, self.tied = problem.equality, numpy.zeros(problem.rows, dtype=bool)
        with_friction = numpy.flatnonzero((problem.mu > 0) & numpy.r_[problem.tangent[1:], False]).tolist()
        self.read_single_rows(with_friction)
        sliding = list(self.read_friction(with_friction))
        if not self.off <= self.zero:
            raise ValueError(f"no gradient: the answer is off by {self.off / (self.motion or 1):.1e} of the motion, and modes are read to "
                             f"{CLEAR:.0e}")
        self.has_number = self.has_number and not (sliding and self.tied.any())
        self.kink, self.held = numpy.flatnonzero(self.tied).tolist(), numpy.flatnonzero(self.kept | self.tied)
        self.hold(sliding)
        self.unknowns = [(s, turns) for s in self.slides for turns in (False, True) if (s.turns if turns else s.lift) > 0]
        self.responses, self.unique_forces = {}, True

    def read_single_rows(self, with_friction):
        """Which push, and which neither push nor open. Gaps of unit rows and forces on them are compared as motions."""
        p, size = self.problem, numpy.where(self.unit > 0, self.unit, 1)
        gap, push = self.slack / size, self.force * size
        rows = ~self.kept & ~p.tangent
        rows[with_friction] = False
        self.size, f, s = size, push[rows], gap[rows]
        self.off = max(self.off, abs(gap[self.kept]).max(initial=0), (-f).max(initial=0), (-s).max(initial=0),
                       numpy.minimum(f, s).max(initial=0))
        self.tied[rows] = (f <= self.zero) & (s <= self.zero)
        self.kept[rows] = f > self.zero

    def __repr__(self):
        return f"<zwang.Gradient of {self.problem.name}, without proof: {'kink: ' + ', '.join(self.kink_names) if self.kink else 'smooth'}>"

    def read_friction(self, with_friction):
        """The same of contacts with friction, and which stick; yields what slides."""
        p, force, slack, size, zero = self.problem, self.force, self.slack, self.size, self.zero
        tangent, mus = [*p.tangent.tolist(), False], p.mu
        for i in with_friction:
            end = tangent.index(False, i + 1)
            mu, t, across = mus[i], slice(i + 1, end), size[i + 1]
            lift = 0.0 if p.law == "convex" else mu
            slip = numpy.linalg.norm(slack[t])
            f, s, moves = force[i] * size[i], (slack[i] - (mu - lift) * slip) / size[i], slip / across
            spare = (mu * force[i] - numpy.linalg.norm(force[t])) * across
            self.off = max(self.off, -f, -s, min(f, s), -spare, min(spare, moves) if f > zero else 0.0)
            if f <= zero and s > zero:
                continue
            if f <= zero or spare <= zero and moves <= zero:
                self.tied[i], self.has_number = True, False
                continue
            self.kept[i] = True
            if moves <= zero:
                self.kept[t] = True
            else:
                yield i, end - i - 1, slack[t], force[i], mu, lift

    def hold(self, sliding):
        """S: rows of J, and of what slides the gap under the law."""
        place, row, factor = numpy.arange(len(self.held)), self.held, numpy.ones(len(self.held))
        for i, tangents, slip, load, mu, lift in sliding:
            s = Slide(self.problem, i, tangents, int(numpy.searchsorted(self.held, i)), slip, load, mu, lift)
            self.slides.append(s)
            if lift < mu:
                place, row = numpy.r_[place, [s.place] * tangents], numpy.r_[row, i + 1 + numpy.arange(tangents)]
                factor = numpy.r_[factor, (lift - mu) * s.direction]
        # Where joints tie the unknowns few rows of contacts push. Where many do they are sparse, and newton is fast; but it does not say
        # whether forces are unique, which has to be known of what slides.
        sparse = not self.slides and self.problem.size > FEW and not self.problem.equality.any()
        self.keeps = _zwang.Kept(self.problem, place, row, factor, self.kept[self.held], sparse)

    @functools.cached_property
    def given(self):
        return answer(self.problem, self.solution)

    @property
    def kink_names(self):
        return [self.problem.row_names[i] for i in self.kink] if self.kink else []

    def read(self, back, z, force):
        """What the unknowns that friction couples are at an answer."""
        return numpy.array([s.turns * (s.across @ z) if turns else s.lift * (s.along @ z) if back else force[s.place]
                            for s, turns in self.unknowns])

    def one(self, z_u, force, rows):
        try:
            z, own, unique = self.keeps.solve(z_u, force, rows)
        except ValueError as bad:
            raise ValueError(f"no gradient: {bad}") from None
        self.unique_forces = self.unique_forces and unique
        return z, own

    def solve(self, back, z_u, force, rows):
        if not self.has_number:
            raise ValueError("no gradient: a kink of friction, or beside what slides: only a proof tells (proof=True)")
        z, own = self.one(z_u, force, rows)
        if not self.unknowns:
            return z, own
        if back not in self.responses:
            answers, none, nothing = [], numpy.zeros(len(z)), numpy.zeros(len(rows))
            for s, turns in self.unknowns:
                moved = nothing.copy()
                moved[s.place] = float(back and not turns)
                answers.append(self.one(none, -s.across if turns else none if back else -s.lift * s.along, moved))
            coupled = numpy.eye(len(answers)) - numpy.array([self.read(back, *each) for each in answers]).T
            self.responses[back] = [numpy.array([each[k] for each in answers]).T for k in (0, 1)], coupled
        if not self.unique_forces:
            raise ValueError("no gradient: forces are not unique beside contacts that slide: only a proof tells (proof=True)")
        (by_z, by_force), coupled = self.responses[back]
        x = numpy.linalg.solve(coupled, self.read(back, z, own))
        return z + by_z @ x, own + by_force @ x

    def jvp(self, dM=None, dz_u=None, dJ=None, dc=None, dmu=None):
        """As Gradient.jvp; its Derivative has no enclosure and no reach."""
        p, bends = self.problem, False
        if dM is None and dJ is None and dc is None and dmu is None:
            t = dmu = numpy.zeros(p.rows)
            force = numpy.zeros(p.size)
            dz_u = force if dz_u is None else finite(dz_u, "dz_u", p.size)
        else:
            change = Change(Parts(self.laid.given if self.laid else p), dM, dz_u, dJ, dc, dmu)
            change = self.laid.forward(change) if self.laid else change
            z, lambda_ = self.given
            t, dz_u, dmu = change.dJ @ z - change.dc, change.dz_u, change.dmu
            force = change.dM @ (p.z_u - z) + change.dJ.T @ lambda_
            bends = change.dJ.nnz > 0 or t[self.held].any()
        rows = -t[self.held]
        for s in self.slides:
            rows[s.place] += (1 - s.lift / s.mu) * dmu[s.row] * s.slip + (s.mu - s.lift) * (s.direction @ t[s.t])
            force = force - s.load * dmu[s.row] * s.along - s.turns * (s.turned @ t[s.t]) * s.across
        dz, own = self.solve(False, dz_u, force, rows)
        if bends and not self.unique_forces:
            raise ValueError("no gradient: forces are not unique, and J or c change: only a proof tells (proof=True)")
        out = QuickDerivative(dz, self.kink, self.kink_names, "" if self.unique_forces else NOT_UNIQUE)
        if self.unique_forces:
            out.dlambda = numpy.zeros(p.rows)
            out.dlambda[self.held] = own
            for s in self.slides:
                out.dlambda[s.t] = (-(s.mu * own[s.place] + s.load * dmu[s.row]) * s.direction
                                    - s.turns * (s.across @ dz + s.turned @ t[s.t]) * s.turned)
        return out

    def vjp(self, z_bar, lambda_bar=None):
        """As Gradient.vjp."""
        p = self.problem
        if self.kink:
            raise ValueError(f"no gradient: kink: {', '.join(self.kink_names)}")
        z_bar = finite(z_bar, "z_bar", p.size)
        bar = numpy.zeros(p.rows) if lambda_bar is None else finite(lambda_bar, "lambda_bar", p.rows)
        force, rows = z_bar, -bar[self.held]
        for s in self.slides:
            rows[s.place] += s.mu * (s.direction @ bar[s.t])
            force = force - s.turns * (s.turned @ bar[s.t]) * s.across
        push, own = self.solve(True, numpy.zeros(p.size), force, rows)
        if lambda_bar is not None and not self.unique_forces:
            raise ValueError(f"no gradient: {NOT_UNIQUE}")
        t_bar, mu_bar = numpy.zeros(p.rows), numpy.zeros(p.rows)
        t_bar[self.held] = own
        for s in self.slides:
            t_bar[s.t] = -s.turns * (s.across @ push + s.turned @ bar[s.t]) * s.turned - (s.mu - s.lift) * own[s.place] * s.direction
            mu_bar[s.row] = -s.load * (s.along @ push + s.direction @ bar[s.t]) - (1 - s.lift / s.mu) * s.slip * own[s.place]
        M, (z, lambda_) = p.M, self.given
        by_M = numpy.outer(push, z - p.z_u)
        out = {"M": -0.5 * (by_M + by_M.T), "z_u": M @ push, "J": None, "c": None, "mu": mu_bar}
        if self.unique_forces:
            out["J"], out["c"] = numpy.outer(lambda_, push) + numpy.outer(t_bar, z), -t_bar
        return self.laid.back(out, {name: 0 * bar for name, bar in out.items() if bar is not None})[0] if self.laid else out
