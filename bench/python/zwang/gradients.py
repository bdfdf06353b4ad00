"""Derivatives of a solution, proven (docs/python.md#gradients).

Inside of the enclosure of a solution (modes.py) the derivative solves F_x x' = -F', with the inverse that proved the solution. At ties
(ties.py) it solves a problem of its own: numbers that are zero, and may grow to either side, complement each other.
"""
import itertools
import math

import numpy
import scipy.sparse

from . import _part, _real
from .complementarity import Complementarity
from .enclosure import EPSILON, UP, Regular, Rows, Unproven
from .modes import HELD, OPEN, SLIDES, Branch, Parts, Settled, length
from .semidefinite import exact_basis
from .ties import Exactly, Tie

FAR = 1e-2  # an answer that is farther from the solution, relative to the motion, is none: where the referee's `near` ends
NOT_UNIQUE = "forces are not unique: z has a derivative, and lambda has none"
COMBINATIONS = 512  # of modes of ties that are tried
NAMES = ("M", "z_u", "J", "c", "mu")
UP_TO = 2.0**-36  # what sums of products of doubles may lose, relative, where terms are not negative
DOUBLE = numpy.dtype(float)
AGREE = 2.0**-30  # relative: derivatives of two combinations that differ by less are one number


class Derivative:
    """How a solution changes in one direction, for a step of 1 in that direction.

    dz: n; free: the same of a motion that the same forces push, and no row holds. dlambda: m, or None where `note` says why.
    enclosure, enclosure_lambda: what each entry is off at most, proven.
    reach, reach_row: to first order, the step to either side at which a row first changes its mode, and that row.
    one_sided: it holds for steps forward alone. kink: the rows that make it so. Where dz is None, `note` says why.
    """

    def __init__(self, problem, p, kink, one_sided):
        self.p, self.pushed = p, numpy.zeros(p.n)
        self.dz = self.dlambda = self.enclosure = self.enclosure_lambda = None
        self.kink, self.one_sided, self.note = list(kink), one_sided, ""
        self.reach, self.reach_row = 0.0 if one_sided else math.inf, None
        names = problem.row_names
        self.kink_names = [names[i] for i in self.kink]

    @property
    def free(self):
        return self.p.solve_mass(self.pushed)

    def __repr__(self):
        text = "no number" if self.dz is None else f"{'one-sided, ' if self.one_sided else ''}{len(self.dz)} entries"
        if self.kink:
            text += f"; kink: {', '.join(self.kink_names)}"
        return f"<zwang.Derivative: {text}{'; ' + self.note if self.note else ''}>"


class FarOff(Unproven):
    """What is proven is not the given answer."""


class Change:
    """One direction: dM, dz_u, dJ, dc, dmu."""

    def __init__(self, p, dM=None, dz_u=None, dJ=None, dc=None, dmu=None):
        def matrix(value, name, shape):
            if value is None:
                return scipy.sparse.csr_matrix(shape)
            try:
                A = scipy.sparse.csr_matrix(_real(value), dtype=float, copy=True)
            except (TypeError, ValueError, OverflowError) as bad:
                raise ValueError(f"{name} should be a matrix of numbers: {str(bad).splitlines()[0]}") from None
            if A.shape != shape:
                raise ValueError(f"{name} should have the shape {shape}, and has {A.shape}")
            if not numpy.isfinite(A.data).all():
                raise ValueError(f"{name} has entries that are not finite")
            A.sum_duplicates()
            A.eliminate_zeros()
            A.sort_indices()
            return A

        def vector(value, name, size):
            try:
                v = numpy.zeros(size) if value is None else numpy.array(_real(value), dtype=float)
            except (TypeError, ValueError, OverflowError) as bad:
                raise ValueError(f"{name} should be a vector of numbers: {bad}") from None
            if v.shape != (size,):
                raise ValueError(f"{name} should have {size} entries, and has the shape {v.shape}")
            if not numpy.isfinite(v).all():
                raise ValueError(f"{name} has entries that are not finite")
            return v
        self.dM, self.dJ = matrix(dM, "dM", (p.n, p.n)), matrix(dJ, "dJ", (p.m, p.n))
        self.dz_u, self.dc, self.dmu = vector(dz_u, "dz_u", p.n), vector(dc, "dc", p.m), vector(dmu, "dmu", p.m)
        if self.dM.nnz and abs(self.dM - self.dM.T).max() != 0:
            raise ValueError("dM is not symmetric")
        read(p.problem, self.dmu)


class Gradient:
    """The derivatives of one solution, from one factorization; zwang.gradient_of makes it.

    kink, kink_names: rows that make a kink. unique_forces: whether lambda is unique. distance: of the given z from the proven
    solution, in the M-norm, relative to the larger of it and z_u.
    """

    def __init__(self, problem, given, z, force, laid=None):
        self.problem, self.laid = problem, laid
        self.p = p = Parts(problem)
        self.settled = Settled(p, z, force)
        self.branch = b = self.settled.branch
        self.unique_forces = len(b.frozen) == 0
        off = given - b.high[:p.n]
        off = numpy.where(abs(off) > 2 * (b.radius + abs(b.low))[:p.n], off, 0)
        size = max(self.norm(p.z_u), self.norm(b.high[:p.n]))
        self.distance = self.norm(off) / size if size else self.norm(off)
        if not self.distance <= FAR:
            raise FarOff(f"it is {self.distance:.3g} of the motion off one")
        self.exactly = Exactly(self.settled)
        self.ties = [self.tie(contact) for contact in self.settled.ties]
        if self.ties:
            self.borders()
            self.require_weak()
        self.kink = sorted(t.contact.row for t in self.ties)
        names = problem.row_names
        self.kink_names = [names[i] for i in self.kink]
        self.coefficients()

    def norm(self, v):
        return math.sqrt(max(v @ (self.p.M @ v), 0.0))

    def __repr__(self):
        text = f"kink: {', '.join(self.kink_names)}" if self.kink else "smooth"
        return f"<zwang.Gradient of {self.problem.name}: {text}{'' if self.unique_forces else '; ' + NOT_UNIQUE}>"

    def tie(self, contact):
        """What is zero at this contact, proven."""
        p, b, i, t = self.p, self.branch, contact.row, contact.tangents
        undecided = Unproven(f"{p.name(i)} is too near a tie to be told from one")
        index = p.contacts.index(contact)
        if b.modes[index] == HELD:
            if not self.exactly.force_at_edge(contact):
                raise undecided
            others = scipy.sparse.vstack([p.J[numpy.setdiff1d(b.basis, contact.rows)], p.J[b.frozen]], format="csr")
            rank = len(exact_basis(others, numpy.zeros(others.shape[0]))[0]) if others.shape[0] else 0
            if rank > len(b.basis) - len(contact.rows) or any(k not in b.column for k in contact.rows):
                raise Unproven(f"{p.name(i)} is at the edge of its cone, and its force is not unique")
            return Tie(contact, "edge", *self.direction(-b.force[t], b.force_off[t]))
        slip, off = b.slip_at(contact) if t else (numpy.zeros(0), numpy.zeros(0))
        if t and b.still(contact):
            if not self.exactly.gaps(contact.rows):
                raise undecided
            return Tie(contact, "apex", None, None)
        if not (self.exactly.at_edge(contact) if t and p.convex else self.exactly.gaps([i])):
            raise undecided
        if t and not any(abs(slip) > off):
            raise undecided
        return Tie(contact, "touch", *self.direction(slip, off))

    @staticmethod
    def direction(v, off):
        """v / |v| and what it is off."""
        if not len(v):
            return v, off
        size = length(v)
        return v / size, ((off + off.sum()) / size + 8 * EPSILON) * UP

    def require_weak(self):
        """Proves that no choice of forces lets a tie push."""
        p, b = self.p, self.branch
        rows = [k for t in self.ties for k in t.contact.rows if t.word != "edge"]
        if not rows:
            return
        new = [k for k, (tie, _) in enumerate(self.columns[-1]) if tie.word != "edge"]
        try:
            Regular(self.G[new][:, new], self.G_off[new][:, new])
        except Unproven:
            if b.sliding or not open_together(p, b, [t.contact for t in self.ties if t.word != "edge"]):
                raise Unproven(f"forces are not unique, and it is not known which of these rows can push: {p.named(rows)}") from None

    def coefficients(self):
        """F' of the equations below the balance of forces is W (dJ z - dc) + V dmu."""
        p, b, n = self.p, self.branch, self.p.n
        k = b.size - n
        W, V = numpy.zeros((k, p.m)), numpy.zeros((k, p.m))
        for row, i in enumerate(b.basis):
            W[row, i] = 1
        self.W_off, self.V_off = numpy.zeros((k, p.m)), numpy.zeros((k, p.m))
        for contact in b.sliding:
            i, t, mu, row = contact.row, contact.tangents, contact.mu, b.edges[contact.row] - n
            r, normal = b.slip[i], b.column[i]
            if p.convex:
                W[row - 1, i], V[row - 1, i] = 1, -b.high[r]
                self.V_off[row - 1, i] = b.radius[r] + EPSILON * abs(b.high[r])
            if len(t) == 1:
                V[row, i] = b.sign[i] * b.high[normal]
                self.V_off[row, i] = b.radius[normal] + EPSILON * abs(b.high[normal])
                W[row + 1, t[0]] = -b.sign[i]
                continue
            s, off = b.slip_at(contact)
            for a, j in enumerate(t):
                W[row + a, j] = mu * b.high[normal]
                self.W_off[row + a, j] = mu * b.radius[normal]
                V[row + a, i] = b.high[normal] * s[a]
                self.V_off[row + a, i] = (abs(b.high[normal]) + b.radius[normal]) * off[a] + b.radius[normal] * abs(s[a])
                W[row + 2, j] = -2 * s[a]
                self.W_off[row + 2, j] = 2 * off[a]
            self.W_off[row:row + 3] += 4 * EPSILON * abs(W[row:row + 3])
            self.V_off[row:row + 3] += 4 * EPSILON * abs(V[row:row + 3])
        self.W, self.V = W, V

    def change_of_equations(self, change):
        """-F' as two doubles and a bound; dJ z - dc with its bound."""
        p, b, n = self.p, self.branch, self.p.n
        nothing = numpy.zeros(len(b.constants))
        full, low = numpy.r_[b.high, b.constants], numpy.r_[b.low, nothing]
        off = numpy.r_[b.radius, nothing]
        first, second, bound = p.mass.times(change.dz_u, numpy.zeros(n))
        t, t_low, t_off = -change.dc, numpy.zeros(p.m), numpy.zeros(p.m)
        if change.dM.nnz or change.dJ.nnz:
            rest = scipy.sparse.csr_matrix((n, b.size - n - len(b.pushing)))
            D = scipy.sparse.hstack([-change.dM, change.dJ[b.pushing].T, rest, change.dM, change.dJ[b.frozen].T], format="csr")
            pushed_off = bound
            first, second, bound = Rows(D).times(full, low, (first, second))
            bound = bound + pushed_off + (abs(D) @ off) * UP
        if change.dJ.nnz:
            t, t_low, t_off = Rows(change.dJ).times(b.high[:n], b.low[:n], (-change.dc,))
            t_off = t_off + (abs(change.dJ) @ b.radius[:n]) * UP
        W, V = self.W, self.V
        below = -(W @ t + V @ change.dmu)
        below_off = (abs(W) @ t_off + self.W_off @ (abs(t) + abs(t_low)) + self.V_off @ abs(change.dmu)) * UP
        rounded = numpy.count_nonzero(W, axis=1) + numpy.count_nonzero(V, axis=1) > 1
        below_off[rounded] += 8 * EPSILON * (abs(W) @ abs(t) + abs(V) @ abs(change.dmu))[rounded]
        return (numpy.r_[first, below], numpy.r_[second, -(W @ t_low)],
                numpy.r_[bound, below_off + EPSILON * EPSILON * (abs(W) @ abs(t))], t, (t_off + abs(t_low)) * UP)

    def holds_together(self, change):
        """Whether rows that depend on each other go on holding together in this direction."""
        p, b = self.p, self.branch
        bend, held = change.dJ[b.held], [*b.basis, *b.frozen]
        if not bend.nnz:
            return not change.dc[b.held].any() or self.depend(p.J[held], change.dc[held])
        columns = [scipy.sparse.csr_matrix(p.c[held]).T, change.dJ[held], scipy.sparse.csr_matrix(change.dc[held]).T]
        if self.depend(scipy.sparse.hstack([p.J[held], *columns], format="csr"), numpy.zeros(len(held))):
            return True  # they depend on each other in the same way, however far
        # To first order is enough where a motion opens them all: then the problem goes on having solutions.
        none = scipy.sparse.csr_matrix((len(b.basis), p.n))
        rows = scipy.sparse.vstack([scipy.sparse.hstack([p.J[b.basis], none]),
                                    scipy.sparse.hstack([change.dJ[held], p.J[held]])], format="csr")
        right = numpy.r_[p.c[b.basis], change.dc[held]]
        return not any(c.tangents for c in p.contacts) and self.depend(rows, right, 2 * len(b.basis)) and self.have_room()

    def depend(self, rows, right, rank=None):
        """Whether equations have the rank of the rows that hold, and do not contradict each other."""
        independent, contradictory = exact_basis(rows, right)
        return not contradictory and len(independent) == (len(self.branch.basis) if rank is None else rank)

    def have_room(self):
        """Whether equality rows are independent, and a motion that keeps them opens all rows that touch."""
        p = self.p
        free = Branch(p, [OPEN] * len(p.contacts), numpy.zeros(p.m), numpy.zeros(p.m))
        if len(free.contradictory) or len(free.frozen):
            return False
        free.regular = Regular(*free.matrix(numpy.zeros(free.size), numpy.zeros(free.size)))
        touching = {*map(int, self.branch.held), *(t.contact.row for t in self.ties)}
        return open_together(p, free, [c for c in p.contacts if c.row in touching])

    def jvp(self, dM=None, dz_u=None, dJ=None, dc=None, dmu=None):
        """The Derivative in a direction: dM n x n and symmetric, dz_u n, dJ m x n, dc m, dmu m, each 0 where it is not given."""
        change = Change(Parts(self.laid.given) if self.laid else self.p, dM, dz_u, dJ, dc, dmu)
        try:
            return self.along(self.laid.forward(change) if self.laid else change)
        except Unproven as unproven:
            raise ValueError(f"no gradient: {unproven}") from None

    def along(self, change):
        if not self.unique_forces and not self.holds_together(change):
            return self.shared_anew(change)
        right, low, off, t, t_off = self.change_of_equations(change)
        y = self.branch.regular.solve(right, low, off)
        out = Derivative(self.problem, self.p, self.kink, bool(self.ties))
        out.pushed = right[:self.p.n]
        if self.ties:
            return self.with_ties(out, change, y, t, t_off)
        self.fill(out, y[0], abs(y[1]) + y[2])
        self.look_ahead(out, y[0], change, t)
        return out

    def alone(self, change):
        """The largest motion, in the M-norm, that one part of a change makes by itself: a force where no row holds, or the move of one row
        where no other one holds. A derivative that is smaller, because parts of it cancel, is rounded at this size."""
        p, b, z = self.p, self.branch, self.branch.high[:self.p.n]
        moves = [abs(change.dJ @ z), abs(change.dc)]
        if self.laid:
            moves, change = self.laid.moves(moves, change, z), self.laid.forward(change)
        moves, ties = numpy.max(moves, axis=0), {t.contact.row: t for t in self.ties}
        forces = [p.M @ change.dz_u, change.dM @ (z - p.z_u), change.dJ.T @ b.force]
        lines = []  # a row, how far it moves, and how it gives way to a force

        def holds(rows):
            lines.extend((p.J[i].toarray()[0], moves[i], 0.0) for i in rows if moves[i])
        holds(b.held)
        for c, mode in zip(p.contacts, b.modes):
            tie, i, t = ties.get(c.row), c.row, c.tangents
            if tie and tie.word != "edge":
                holds(c.rows if tie.word == "apex" else [i])
            if not t or not (mode == SLIDES or tie and tie.word != "apex"):
                continue
            rubs, slip = p.J[t].toarray(), length(b.slack[t])
            direction = tie.direction if tie else b.slack[t] / slip
            forces.append(change.dmu[i] * b.force[i] * (direction @ rubs))
            if mode == SLIDES and len(t) == 2:
                lines += [(row, moves[k], slip / (c.mu * b.force[i])) for row, k in zip(rubs, t)]
            if p.convex and mode != HELD:
                lines.append((p.J[i].toarray()[0] - c.mu * (direction @ rubs),
                              max(moves[i], c.mu * max(moves[t]), abs(change.dmu[i]) * slip), 0.0))
        A = numpy.array([*forces, *(row for row, *_ in lines)]).T
        squares = numpy.maximum((A * p.solve_mass(A).reshape(A.shape)).sum(axis=0), 0)
        of_rows = [move * math.sqrt(square) / (give + square) for (_, move, give), square in zip(lines, squares[len(forces):]) if square]
        return float(max([*numpy.sqrt(squares[:len(forces)]), *of_rows]))

    def look_ahead(self, out, x, change, t):
        """To first order, the step at which a row first changes its mode."""
        p, b = self.p, self.branch
        rise = p.J @ x[:p.n] + t
        force = numpy.zeros(p.m)
        force[b.pushing] = x[p.n:p.n + len(b.pushing)]
        steps = {}
        for contact, mode in zip(p.contacts, b.modes):
            i, tangents, mu = contact.row, contact.tangents, contact.mu
            left = []
            if mode == "open":
                s, ds = b.slack[i], rise[i]
                if p.convex and tangents:
                    size = length(b.slack[tangents])
                    s, ds = s - mu * size, ds - change.dmu[i] * size - (mu * (b.slack[tangents] @ rise[tangents]) / size if size else 0)
                left.append((s, ds))
            else:
                left.append((b.force[i], force[i]))
            if mode == "held" and tangents:
                size = length(b.force[tangents])
                left.append((mu * b.force[i] - size, change.dmu[i] * b.force[i] + mu * force[i]
                             - (b.force[tangents] @ force[tangents] / size if size else 0)))
            elif mode == "slides":
                r = b.slip[i]
                left.append((b.high[r], x[r]))
            steps[i] = min((value / abs(slope) for value, slope in left if slope), default=math.inf)
        if steps:
            out.reach_row = min(steps, key=steps.get)
            out.reach = steps[out.reach_row]
            if out.reach == math.inf:
                out.reach_row = None

    def fill(self, out, x, off, extra=()):
        p, b, n = self.p, self.branch, self.p.n
        out.dz, out.enclosure = x[:n].copy(), off[:n] * UP
        if not self.unique_forces:
            out.note = NOT_UNIQUE
            return
        out.dlambda, out.enclosure_lambda = numpy.zeros(p.m), numpy.zeros(p.m)
        part = slice(n, n + len(b.pushing))
        out.dlambda[b.pushing], out.enclosure_lambda[b.pushing] = x[part], off[part] * UP
        for i, value, bound in extra:
            out.dlambda[i], out.enclosure_lambda[i] = value, bound * UP

    # Ties: complementarity of few numbers.

    def borders(self):
        """Of each number that ties complement: (columns of K^-1 C, what they are off), rows D, their bound, and (tie, index)."""
        p, b, n = self.p, self.branch, self.p.n
        pushes, rows, rows_off, owners = [], [], [], []
        for tie in self.ties:
            contact, i, t = tie.contact, tie.contact.row, tie.contact.tangents
            J = p.J[contact.rows].toarray()
            if tie.word == "apex":
                for k in range(len(contact.rows)):
                    push, row = numpy.zeros(b.size), numpy.zeros(b.size)
                    push[:n], row[:n] = -J[k], J[k]
                    pushes.append((push, numpy.zeros(b.size)))
                    rows.append(row)
                    rows_off.append(numpy.zeros(b.size))
                    owners.append((tie, k))
                continue
            push, row, push_off, row_off = (numpy.zeros(b.size) for _ in range(4))
            d, d_off = tie.direction, tie.direction_off
            if tie.word == "edge":
                row[b.column[i]] = contact.mu
                for k, j in enumerate(t):
                    row[b.column[j]], row_off[b.column[j]] = d[k], d_off[k]
                    at = n + int(numpy.flatnonzero(b.basis == j)[0])
                    push[at], push_off[at] = -d[k], d_off[k]
                if p.convex:
                    push[n + int(numpy.flatnonzero(b.basis == i)[0])] = -contact.mu
            else:
                along = J[0] - contact.mu * (d @ J[1:]) if t else J[0]
                along_off = (contact.mu * (d_off @ abs(J[1:])) + 8 * EPSILON * (abs(J[0]) + contact.mu * (abs(d) @ abs(J[1:]))) if t
                             else numpy.zeros(n))
                push[:n], push_off[:n] = -along, along_off
                row[:n], row_off[:n] = (along, along_off) if p.convex else (J[0], 0)
            pushes.append((push, push_off))
            rows.append(row)
            rows_off.append(row_off)
            owners.append((tie, 0))
        columns = []
        for push, off in pushes:
            high, low, radius = b.regular.solve(push, numpy.zeros(b.size), off)
            columns.append((high, (abs(low) + radius) * UP))
        Y, Y_off = numpy.array([c for c, _ in columns]).T, numpy.array([o for _, o in columns]).T
        D, D_off = numpy.array(rows), numpy.array(rows_off)
        self.columns = Y, Y_off, D, D_off, owners
        self.G = -(D @ Y)
        self.G_off = (abs(D) @ Y_off + D_off @ (abs(Y) + Y_off) + (b.size + 8) * EPSILON * (abs(D) @ abs(Y))) * UP

    def own_change(self, change, t, t_off):
        """Of each number that ties complement the change that does not come from x'."""
        b, values, bounds = self.branch, [], []
        for tie, k in self.columns[-1]:
            contact, i = tie.contact, tie.contact.row
            if tie.word == "apex":
                value, off = t[contact.rows[k]], t_off[contact.rows[k]]
            elif tie.word == "edge":
                value = change.dmu[i] * b.force[i]
                off = abs(change.dmu[i]) * b.force_off[i] + EPSILON * abs(value)
            else:
                value, off = t[i], t_off[i]
                if self.p.convex and contact.tangents:
                    s, s_off = b.slip_at(contact)
                    at = contact.tangents
                    terms = numpy.r_[value, -contact.mu * tie.direction * t[at], -change.dmu[i] * length(s)]
                    value = terms.sum()
                    off = off + (contact.mu * (tie.direction_off @ (abs(t[at]) + t_off[at]) + abs(tie.direction) @ t_off[at])
                                 + abs(change.dmu[i]) * s_off.sum() + 16 * EPSILON * abs(terms).sum())
            values.append(value)
            bounds.append(off * UP)
        return numpy.array(values), numpy.array(bounds)

    def with_ties(self, out, change, y, t, t_off):
        """The one-sided derivative, where one combination of modes of the ties is left."""
        p, b = self.p, self.branch
        Y, Y_off, D, D_off, owners = self.columns
        x, x_off = y[0], (abs(y[1]) + y[2]) * UP
        k, count = len(owners), b.size + 8
        own, own_off = self.own_change(change, t, t_off)
        q = own + D @ x
        q_off = (own_off + abs(D) @ x_off + D_off @ (abs(x) + x_off) + count * EPSILON * (abs(D) @ abs(x)) + EPSILON * abs(q)) * UP
        choices, at = [], 0
        for tie in self.ties:
            if tie.word != "apex":
                choices.append([("rest", at), ("act", at)])
                at += 1
            else:
                size = len(tie.contact.rows)
                slides = [("slide", at, 1.0), ("slide", at, -1.0)] if size == 2 else [("unknown", at)]
                choices.append([("open", at), ("stick", at), *slides])
                at += size
        if math.prod(len(c) for c in choices) > COMBINATIONS and not any(c.tangents for c in p.contacts):
            choices = self.pushing(out.free, t, choices)
        if math.prod(len(c) for c in choices) > COMBINATIONS:
            out.note = f"kink: too many ties for a number ({len(self.ties)})"
            return out
        found, open_questions, small = [], False, Complementarity(self.ties, q, q_off, self.G, self.G_off, p.convex)
        for modes in itertools.product(*choices):
            answer = small.combination(modes)
            if answer == "no" or answer == "singular" and self.depend_on_each_other(modes):
                continue
            if answer in ("unknown", "singular"):
                open_questions = True
                continue
            found.append(answer)
        certain = [f for f in found if f[2]]
        monotone = p.law != "coulomb"
        if p.convex and not certain and open_questions:
            certain = small.slips_that_begin()
        if monotone and certain:
            found = certain[:1]
        elif open_questions:
            found = []
        if not found:
            out.note = "kink: no number, since it is not known which of the ties push, slide or open in this direction"
            return out
        self.tight = [(tie.contact.row, not any(loose[at] for *_, loose in found)) for at, (tie, _) in enumerate(owners)]
        points = []
        for w, w_off, *_ in found:
            z = x - Y @ w
            z_off = (x_off + Y_off @ (abs(w) + w_off) + abs(Y) @ w_off + (k + 4) * EPSILON * (abs(x) + abs(Y) @ abs(w))) * UP
            points.append((z, z_off, w, w_off))
        z, z_off, w, w_off = points[0]
        for other, other_off, v, v_off in points[1:]:
            apart = abs(other - z)
            size = max(self.norm(out.free), self.norm((abs(x) + abs(Y) @ (abs(w) + abs(v)))[:p.n]))
            if self.norm(apart[:p.n]) > AGREE * size:
                out.note = f"kink: no number, since {len(points)} combinations of modes fit this direction"
                return out
            z_off, w_off = numpy.maximum(z_off, (apart + other_off) * UP), numpy.maximum(w_off, (abs(v - w) + v_off) * UP)
        extra = []
        for (tie, a), value, bound in zip(owners, w, w_off):
            contact = tie.contact
            if tie.word == "apex":
                extra.append((contact.rows[a], value, bound))
            elif tie.word == "touch":
                extra.append((contact.row, value, bound))
                for j, d, d_off in zip(contact.tangents, tie.direction, tie.direction_off):
                    size = contact.mu * abs(d * value)
                    extra.append((j, -contact.mu * d * value,
                                  (contact.mu * (abs(d) * bound + d_off * (abs(value) + bound)) + 4 * EPSILON * size) * UP))
        self.fill(out, z, z_off, extra)
        return out

    def pushing(self, free, t, choices):
        """The choice that a solver makes, for ties too many to try them all."""
        from . import Problem, solve
        b, rows = self.branch, [tie.contact.row for tie in self.ties]
        both = [*b.basis, *rows]
        found = solve(Problem(self.p.M, free, self.p.J[both], -t[both], equality=len(b.basis)), tolerance=1e-12)
        if len(found.lambda_) != len(both):
            return choices
        slack = self.p.J[rows] @ found.z + t[rows]
        act = found.lambda_[len(b.basis):] * self.p.unit[rows] > slack / self.p.unit[rows]
        return [[choice[int(a)]] for choice, a in zip(choices, act)]

    def depend_on_each_other(self, modes):
        """Whether rows that this choice lets push are proven to depend on each other: then another one gives the same motion."""
        if self.p.law == "coulomb" or any(c.tangents for c in self.p.contacts):
            return False
        rows = [t.contact.row for t, (word, *_) in zip(self.ties, modes) if word == "act"]
        together = scipy.sparse.vstack([self.p.J[self.branch.basis], self.p.J[rows]], format="csr")
        return len(exact_basis(together, numpy.zeros(together.shape[0]))[0]) < together.shape[0]

    def shared_anew(self, change):
        """Where redundant rows no longer hold together: the load goes to those rows that gain most by it."""
        p, b = self.p, self.branch
        if any(c.tangents for c in p.contacts):
            out = Derivative(self.problem, self.p, self.kink, True)
            out.note = "forces are not unique, and rows that hold do not hold together in this direction: no number"
            return out
        from scipy.optimize import linprog
        high = b.high[:p.n]
        rows = numpy.array(sorted({*map(int, b.held), *(t.contact.row for t in self.ties)}))
        *_, t, t_off = self.change_of_equations(change)
        gain = numpy.where(abs(t) > t_off, -t, 0)
        goal = p.M @ (high - p.z_u)
        size = abs(goal).max(initial=0) or 1.0
        unit = p.unit[rows]
        equal = numpy.isin(rows, p.equal)
        found = linprog(-(gain[rows] / unit) / (abs(gain[rows] / unit).max(initial=0) or 1.0),
                        A_eq=(scipy.sparse.diags(1 / unit) @ p.J[rows]).T, b_eq=goal / size,
                        bounds=[(None if e else 0, None) for e in equal], method="highs-ds",
                        options={"presolve": False, "primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10})
        if found.status == 3:
            raise Unproven("pushed in this direction, rows that hold contradict each other")
        if found.status != 0:
            raise Unproven("forces are not unique, and no share of them was found in this direction")
        force = numpy.zeros(p.m)
        force[rows] = found.x * size / unit
        pushing = {int(i) for i, f, e in zip(rows, found.x, equal) if e or f > 1e-12 * abs(found.x).max()}
        if not self.carries_alone(sorted(pushing), rows):
            raise Unproven("forces are not unique, and no share of them was found in this direction")
        modes = [HELD if c.row in pushing else OPEN for c in p.contacts]
        vertex = object.__new__(Gradient)
        vertex.problem, vertex.p, vertex.unique_forces = self.problem, p, True
        vertex.branch = Branch(p, modes, force, p.J @ high - p.finite)
        if len(vertex.branch.frozen):
            raise Unproven("forces are not unique, and more than one share of them fits this direction")
        vertex.branch.prove(high)
        vertex.settled, vertex.tight = self.settled, []
        tied = [c for c in p.contacts if c.row in set(map(int, rows)) - pushing]
        if any(vertex.branch.force[c.row] <= vertex.branch.force_off[c.row] for c in p.contacts if c.row in pushing):
            raise Unproven("forces are not unique, and no share of them was found in this direction")
        vertex.ties = [Tie(c, "touch", numpy.zeros(0), numpy.zeros(0)) for c in tied]
        vertex.kink = sorted({c.row for c in tied} | set(self.kink))
        vertex.coefficients()
        vertex.borders()
        out = vertex.along(change)
        out.one_sided, out.dlambda, out.enclosure_lambda = True, None, None
        out.note = out.note or NOT_UNIQUE
        if out.dz is not None and change.dJ[rows].nnz and not self.one_share(vertex, out):
            out.dz = out.enclosure = None
            out.note = "forces are not unique, and a change of J acts on them: no number"
        return out

    def carries_alone(self, pushing, held):
        """Whether forces of `pushing` and of no other row can hold z where all of `held` meet: M (z - z_u) = J_pushing' lambda and
        J_held z = c contradict each other nowhere, which is decided in rationals. (A linear program takes forces for nothing that
        are small to it: rows with a force of 1e-7 of the largest once went for rows without one.)"""
        p, one = self.p, scipy.sparse.identity(self.p.n)
        system = scipy.sparse.bmat([[one, -one, None], [None, p.M, -p.J[pushing].T], [p.J[held], None, None]], format="csr")
        return not len(exact_basis(system, numpy.r_[p.z_u, numpy.zeros(p.n), p.c[held]])[1])

    @staticmethod
    def one_share(vertex, out):
        """Whether the rows that stay tight depend on no others, so that one share of the forces is left."""
        rows = [*vertex.branch.basis, *(i for i, tight in vertex.tight if tight)]
        together = vertex.p.J[rows]
        return len(exact_basis(together, numpy.zeros(len(rows)))[0]) == len(rows)

    def vjp(self, z_bar, lambda_bar=None, wrt=NAMES):
        """The gradient of a number whose gradient with respect to z is z_bar (n), and to lambda lambda_bar (m), with respect to the
        problem: a dict of "M" (n x n, symmetric), "z_u" (n), "J" (m x n), "c" (m), "mu" (m), or of those of them that wrt names (M and
        J are full matrices). Where forces are not unique, J and c have none, and None stands there. Raises ValueError at a kink."""
        names, out = wanted(wrt), self.backward(z_bar, lambda_bar)[0]
        return {name: out[name] for name in names}

    def within_contacts(self):
        """Whether the only rows that depend on each other are the edges of one contact: they do so whatever changes."""
        if not self.laid:
            return False
        groups = {}
        for row, i, *_ in self.laid.edges:
            if row in self.branch.held:
                groups.setdefault(i, []).append(row)
        spare = sum(len(rows) - len(exact_basis(self.p.J[rows], self.p.c[rows])[0]) for rows in groups.values())
        return spare == len(self.branch.frozen)

    def backward(self, z_bar, lambda_bar):
        """What vjp gives, and what each entry is off."""
        p, b, n = self.p, self.branch, self.p.n
        if self.ties:
            raise ValueError(f"no gradient: kink: {', '.join(self.kink_names)}")
        bars = []
        for name, value, size in (("z_bar", z_bar, n), ("lambda_bar", numpy.zeros(p.m) if lambda_bar is None else lambda_bar, p.m)):
            bars.append(finite(value, name, size))
        if lambda_bar is not None and not self.unique_forces:
            raise ValueError(f"no gradient: {NOT_UNIQUE}")
        right = numpy.zeros(b.size)
        right[:n], right[n:n + len(b.pushing)] = bars[0], bars[1][b.pushing]
        v, off = b.regular.transposed(right)
        (push, rest), (push_off, rest_off) = (v[:n], v[n:]), (off[:n], off[n:])
        z, z_off = b.high[:n], abs(b.low[:n]) + b.radius[:n]
        moved = z - p.z_u
        moved_off = z_off + EPSILON * abs(moved)
        M, M_off = outer(push, push_off, moved, moved_off)
        out = {"M": -0.5 * (M + M.T), "z_u": p.M @ push, "J": None, "c": None, "mu": -(rest @ self.V)}
        rounded = (len(rest) + 4) * EPSILON * abs(rest)
        bound = {"M": 0.5 * (M_off + M_off.T) + EPSILON * (abs(M) + abs(M.T)),
                 "z_u": abs(p.M) @ (push_off + (n + 4) * EPSILON * abs(push)),
                 "mu": (rest_off + rounded) @ abs(self.V) + (abs(rest) + rest_off) @ self.V_off}
        if self.unique_forces or self.within_contacts():
            along = rest @ self.W
            along_off = (rest_off + rounded) @ abs(self.W) + (abs(rest) + rest_off) @ self.W_off
            (one, one_off), (two, two_off) = outer(b.force, b.force_off, push, push_off), outer(along, along_off, z, z_off)
            out["J"], out["c"] = one - two, along
            bound["J"], bound["c"] = one_off + two_off + 2 * EPSILON * (abs(one) + abs(two)), along_off
        bound = {name: value * UP for name, value in bound.items()}
        return self.laid.back(out, bound) if self.laid else (out, bound)


def open_together(p, b, contacts):
    """Whether a motion that moves no row that holds in the branch is proven to open all these contacts, s_n > mu |s_t|."""
    from scipy.optimize import linprog
    n = p.n
    unit, lines = scipy.sparse.diags(1 / p.unit) @ p.J, []
    for c in contacts:
        for signs in itertools.product((1, -1), repeat=len(c.tangents)):
            factors = numpy.r_[1.0, [c.mu * sign * p.unit[k] / p.unit[c.row] for sign, k in zip(signs, c.tangents)]]
            lines.append(-(factors @ unit[c.rows].toarray()))
    found = linprog(numpy.r_[numpy.zeros(n), -1.0], A_ub=numpy.c_[lines, numpy.ones(len(lines))], b_ub=numpy.zeros(len(lines)),
                    A_eq=scipy.sparse.hstack([unit[b.held], scipy.sparse.csr_matrix((len(b.held), 1))]), b_eq=numpy.zeros(len(b.held)),
                    bounds=[(-1, 1)] * n + [(0, 1)], method="highs")
    if found.status != 0:
        return False
    zero = numpy.zeros(b.size)
    y, low, off = b.regular.solve(numpy.r_[p.M @ found.x[:n], zero[n:]], zero, zero)
    for c in contacts:
        s, small, bound = Rows(p.J[c.rows]).times(y[:n], low[:n])
        bound = (abs(small) + bound + abs(p.J[c.rows]) @ off[:n]) * UP
        if not s[0] - bound[0] > c.mu * (abs(s[1:]) + bound[1:]).sum() * UP:
            return False
    return True


def outer(a, a_off, b, b_off):
    """a b' and what it is off."""
    both = numpy.outer(a, b)
    return both, numpy.outer(a_off, abs(b) + b_off) + numpy.outer(abs(a), b_off) + EPSILON * abs(both)


def numbers(value, name):
    try:
        return numpy.array(_real(value), dtype=float)
    except (TypeError, ValueError, OverflowError) as bad:
        raise ValueError(f"{name} should be numbers: {str(bad).splitlines()[0]}") from None


def plain(value, name, problem):
    """finite(); but size and entries of a line of doubles are left to the C++ that reads them, and refuses them."""
    if type(value) is numpy.ndarray and value.dtype is DOUBLE and value.ndim == 1 and value.size:
        return value
    return finite(value, name, problem.size)


def finite(value, name, size):
    v = value if type(value) is numpy.ndarray and value.dtype is DOUBLE else numbers(value, name)
    if v.shape != (size,) or not (math.isfinite(v @ v) or numpy.isfinite(v).all()):  # the first is cheap, and may overflow
        raise ValueError(f"{name} should have {size} finite entries")
    return v


def read(problem, dmu):
    """A change of mu, where contacts with friction read it."""
    tangent, mu = numpy.append(problem.tangent, False), problem.mu
    wrong = numpy.flatnonzero((dmu != 0) & ((mu <= 0) | tangent[:-1] | ~tangent[1:] | (problem.c == -math.inf)))
    if len(wrong):
        raise ValueError(f"dmu({wrong[0]}) should be 0: no contact with friction reads mu({wrong[0]})")
    return dmu


class Laid:
    """The problem under a simpler law: how changes of the given rows change those of the law (core/problem/law.h)."""

    def __init__(self, given, law):
        self.given, self.problem = given, given.under(law)
        tangent, mu, edges = given.tangent, given.mu, self.problem.law == "pyramid"
        at, self.edges, i = [], [], 0
        while i < given.rows:
            end = i + 1
            while end < given.rows and tangent[end]:
                end += 1
            slips = end > i + 1 and bool(mu[i] > 0)
            for t in range(i + 1, end) if edges and slips else ():
                for sign in (1.0, -1.0):
                    self.edges.append((len(at), i, t, sign))
                    at.append({i: 1.0, t: sign * mu[i]})
            if not (edges and slips):
                at += [{k: 1.0} for k in range(i, end if slips and self.problem.law in ("convex", "coulomb") else i + 1)]
            i = end
        self.T = scipy.sparse.csr_matrix(([v for row in at for v in row.values()],
                                          ([k for k, row in enumerate(at) for _ in row], [j for row in at for j in row])),
                                         shape=(len(at), given.rows))
        rows, owners, tangents, signs = ([edge[k] for edge in self.edges] for k in range(4))
        self.turn = scipy.sparse.csr_matrix((signs, (rows, tangents)), shape=self.T.shape)
        self.owner = scipy.sparse.csr_matrix((numpy.ones(len(rows)), (rows, owners)), shape=self.T.shape)

    def forward(self, change):
        """The Change of the law's rows. Its entries are rounded where mu or dmu are not powers of two."""
        rows, c = self.given.J, numpy.where(numpy.isfinite(self.given.c), self.given.c, 0)
        turned = self.owner @ change.dmu
        change.dJ = scipy.sparse.csr_matrix(self.T @ change.dJ + scipy.sparse.diags(turned) @ (self.turn @ rows))
        change.dJ.sort_indices()
        change.dc = self.T @ change.dc + turned * (self.turn @ c)
        change.dmu = numpy.zeros(self.T.shape[0]) if self.edges else self.T @ change.dmu
        return change

    def moves(self, moves, change, z):
        """How far the law's rows move by each of the moves of the given ones, and by dmu."""
        slack = self.given.J @ z - numpy.where(numpy.isfinite(self.given.c), self.given.c, 0)
        return [*(abs(self.T) @ move for move in moves), abs((self.owner @ change.dmu) * (self.turn @ slack))]

    def back(self, out, bound):
        rows, c = self.given.J, numpy.where(numpy.isfinite(self.given.c), self.given.c, 0)
        T, size = self.T, 8 * EPSILON
        out, bound = dict(out), dict(bound)
        mu = T.T @ out["mu"] if not self.edges else None
        mu_off = T.T @ bound["mu"] if not self.edges else None
        if out["J"] is not None:
            J, c_bar, J_off, c_off = out["J"], out["c"], bound["J"], bound["c"]
            if self.edges:
                along, turn = self.turn @ rows, self.turn @ c
                terms = along.multiply(J).sum(axis=1).A1 + turn * c_bar
                many = (self.given.size + 8) * EPSILON
                terms_off = abs(along).multiply(J_off + many * abs(J)).sum(axis=1).A1 + abs(turn) * (c_off + many * abs(c_bar))
                mu, mu_off = self.owner.T @ terms, self.owner.T @ (terms_off + size * abs(terms))
            out["J"], out["c"] = T.T @ J, T.T @ c_bar
            bound["J"], bound["c"] = abs(T).T @ (J_off + size * abs(J)), abs(T).T @ (c_off + size * abs(c_bar))
        out["mu"], bound["mu"] = mu, None if mu_off is None else mu_off * UP
        return out, bound


def answer(problem, solution):
    """z and forces of what a solver returned, of a pair of them, or of z alone."""
    if hasattr(solution, "lambda_"):
        z, force = solution.z, solution.lambda_
        if len(z) != problem.size:
            raise ValueError(f"the solution has no z: {solution.status}")
    else:
        z, force = solution if isinstance(solution, tuple) and len(solution) == 2 else (solution, [])
    try:
        z, force = numpy.array(_real(z), dtype=float), numpy.array(_real(force), dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise ValueError("solution should be what zwang.solve returns, z, or (z, lambda)") from None
    for name, v, size in (("z", z, problem.size), ("lambda", force, problem.rows)):
        if v.shape != (size,) and not (name == "lambda" and not v.size):
            raise ValueError(f"{name} should have {size} entries, and has the shape {v.shape}")
        if not numpy.isfinite(v).all():
            raise ValueError(f"{name} has entries that are not finite")
    return z, force


def gradient_of(problem, solution, law, proof=True):
    laid = Laid(problem, law) if law is not None and problem.tangent.any() else None
    problem = laid.problem if laid else problem
    if not proof:
        return _part("quick_gradients").QuickGradient(problem, solution, laid)
    from . import solve
    z, force = answer(problem, solution)
    first = None
    if len(force) == problem.rows:
        try:
            return Gradient(problem, z, z, force, laid)
        except (Unproven, OverflowError) as unproven:
            first = unproven
    found = solve(problem, "cone" if problem.tangent.any() else "dual_active_set", tolerance=1e-12)
    if found.status == "infeasible":
        raise ValueError("no gradient: the problem is infeasible")
    if len(found.z) != problem.size or len(found.lambda_) != problem.rows:
        raise ValueError(f"no gradient: {why_not(first, problem, z, force) if first else found.status}")
    try:
        return Gradient(problem, z, z if problem.law == "coulomb" else found.z, found.lambda_, laid)
    except (Unproven, OverflowError) as unproven:
        raise ValueError(f"no gradient: {why_not(unproven, problem, z, force)}") from None


def why_not(unproven, problem, z, force):
    """Why there is no gradient, in words that are true of the answer: under Coulomb's law it may be a solution beside the proven one."""
    if isinstance(unproven, OverflowError):
        return "the answer's squares are beyond doubles"
    if not isinstance(unproven, FarOff):
        return str(unproven)
    from . import judge
    verdict = judge(problem, z, force).verdict if problem.law == "coulomb" else "wrong"
    if verdict == "wrong":
        return f"the answer is no solution: {unproven}"
    if not len(force):
        return "there may be several solutions, and the answer is not near the one that is proven: expected its forces, too, (z, lambda)"
    if verdict == "undecided":
        return f"it is not known whether the answer is a solution, and {unproven} that is proven"
    return f"there are several solutions, or nearly so: the answer meets its conditions, and {unproven} that is proven"


def wanted(wrt):
    names = (wrt,) if isinstance(wrt, str) else tuple(wrt) if numpy.iterable(wrt) else ()
    if not names or not all(name in NAMES for name in names):
        raise ValueError(f"wrt should be names among {', '.join(NAMES)}")
    return names


def parameters(wrt, direction):
    if isinstance(wrt, str):
        if direction is None:
            raise ValueError("a direction is missing")
        wrt = {wrt: direction}
    elif direction is not None:
        raise ValueError("direction goes with one name: wrt should be a name, or a dict of names and directions")
    if not isinstance(wrt, dict) or not wrt or not all(name in NAMES for name in wrt):
        raise ValueError(f"wrt should be one of {', '.join(NAMES)}, or a dict of them")
    return {"d" + name: value for name, value in wrt.items()}


class GradientJudgement:
    """What is proven of a gradient. verdict: "right", "wrong", "undecided" or "kink: [rows]". at_least, at_most: of its distance from the
    true one, over `scale`; at a kink from the one-sided one, where there is one. note: why there is none."""

    def __init__(self, kink, at_least, at_most, scale, tolerance, note=""):
        self.kink, self.at_least, self.at_most, self.scale, self.note = kink, at_least, at_most, scale, note
        self.verdict = (f"kink: [{', '.join(map(str, kink))}]" if kink else "right" if at_most <= tolerance else
                        "wrong" if at_least > tolerance else "undecided")

    def __repr__(self):
        text = f"{self.verdict}: off by at least {self.at_least:.3g} and at most {self.at_most:.3g}"
        return f"<{text}{'; ' + self.note if self.note else ''}>"


def apart(low, high, off, scale):
    """Proven bounds of a distance between low and high that is off by so much, over the scale."""
    low, high = max(low * (1 - UP_TO) - off, 0.0), high * (1 + UP_TO) + off
    return (low / scale, high / scale) if scale > 0 else (math.inf if low > 0 else 0.0, math.inf if high > 0 else 0.0)


def judge_gradient(problem, solution, given, wrt, direction, z_bar, law, tolerance):
    of = gradient_of(problem, solution, law)
    if z_bar is None:
        named = parameters(wrt, direction)
        true = of.jvp(**named)
        got = numbers(given, "gradient")
        if got.shape != (of.p.n,):
            raise ValueError(f"gradient should have {of.p.n} entries, and has the shape {got.shape}")
        if true.dz is None:
            return GradientJudgement(true.kink, 0.0, math.inf, 0.0, tolerance, true.note)
        if not numpy.isfinite(got).all():
            return GradientJudgement(true.kink, math.inf, math.inf, 0.0, tolerance, "it has entries that are not finite")
        # |v|_M <= |v'| over the diagonal times the root of the size holds for any positive definite M.
        width = math.sqrt(of.p.n) * math.sqrt(of.p.M.diagonal() @ true.enclosure**2) * UP
        alone = of.alone(Change(Parts(of.laid.given) if of.laid else of.p, **named))
        d, scale = got - true.dz, max(of.norm(true.dz), of.norm(true.free), alone)
        square, off = d @ (of.p.M @ d), (of.p.n + 8) * EPSILON * (abs(d) @ (abs(of.p.M) @ abs(d)))
        low, high = apart(math.sqrt(max(square - off, 0.0)), math.sqrt(max(square + off, 0.0)), width, scale)
        return GradientJudgement(true.kink, low, high, scale, tolerance, true.note if true.kink else "")
    if direction is not None or wrt not in NAMES:
        raise ValueError(f"with z_bar, wrt should be one of {', '.join(NAMES)}, and direction is left out")
    if of.ties:
        return GradientJudgement(of.kink, 0.0, math.inf, 0.0, tolerance)
    true, bound = of.backward(z_bar, None)
    if true[wrt] is None:
        raise ValueError(f"no gradient with respect to {wrt}: forces are not unique")
    got = numbers(given.toarray() if scipy.sparse.issparse(given) else given, "gradient")
    if got.shape != true[wrt].shape:
        raise ValueError(f"gradient should have the shape {true[wrt].shape}, and has {got.shape}")
    if not numpy.isfinite(got).all():
        return GradientJudgement([], math.inf, math.inf, 0.0, tolerance, "it has entries that are not finite")
    p, norm = of.p, numpy.linalg.norm
    free = p.solve_mass(numbers(z_bar, "z_bar"))
    moved, force = of.branch.high[:p.n] - p.z_u, of.branch.force
    along = abs(p.J @ free)
    alone = {"z_u": norm(z_bar), "M": norm(free) * norm(moved), "J": norm(free) * norm(force), "c": norm(along / p.unit**2),
             "mu": norm([force[c.row] * along[k] for c in p.contacts for k in c.tangents])}
    size = float(max(norm(true[wrt]), alone[wrt]))
    far = float(norm(got - true[wrt]))
    return GradientJudgement([], *apart(far, far, float(norm(bound[wrt])) * UP, size), size, tolerance)
