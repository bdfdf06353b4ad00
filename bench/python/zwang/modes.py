"""The modes of a problem's contacts at a solution, proven (docs/python.md#gradients).

The conditions of one choice of modes are a square system F(x) = 0 of the motion z, the forces of independent rows and the slips |s_t|,
linear but for contacts that slide in space, and at most quadratic. Its solution is enclosed; the signs of what it leaves are
proven there.
"""
import math
from fractions import Fraction

import numpy
import scipy.sparse
import scipy.sparse.linalg

from .enclosure import EPSILON, UP, Regular, Rows, Unproven, added, is_definite
from .semidefinite import exact_basis

OPEN, HELD, SLIDES = "open", "held", "slides"
ROUNDS = 60  # changes of modes before nothing is proven
NEAR_TIE = 1e-7  # relative: below it a guess takes the mode with fewer unknowns
STEPS = 40  # of Newton's method
NAMED = 4  # rows in one line


class Contact:
    """An inequality row, and its tangent rows under a law of friction."""

    def __init__(self, row, tangents, mu):
        self.row, self.tangents, self.mu = row, tangents, mu
        self.rows = [row, *tangents]


class Parts:
    """The numbers of a problem, and its contacts."""

    def __init__(self, problem):
        self.problem, self.law = problem, problem.law
        self.M, self.J = problem.M, problem.J
        self.z_u, self.c = problem.z_u, problem.c
        self.n, self.m = problem.size, problem.rows
        self.equal = numpy.flatnonzero(problem.equality)
        tangent, mu = problem.tangent, problem.mu
        self.contacts = []
        for i in numpy.flatnonzero(~problem.equality & ~tangent & (self.c > -math.inf)):
            end = i + 1
            while end < self.m and tangent[end]:
                end += 1
            self.contacts.append(Contact(int(i), list(range(int(i) + 1, end)) if mu[i] > 0 else [], float(mu[i])))
        self.rows, self.mass = Rows(self.J), Rows(self.M)
        self.finite = numpy.where(self.c > -math.inf, self.c, 0)
        unit = numpy.asarray(self.J.multiply(self.J / self.M.diagonal()[None, :]).sum(axis=1)).ravel()
        self.unit = numpy.sqrt(numpy.where(unit > 0, unit, 1))
        self.convex = self.law == "convex"

    def name(self, row):
        return self.problem.row_names[row]

    def named(self, rows):
        more = f" and {len(rows) - NAMED} more" if len(rows) > NAMED else ""
        return ", ".join(self.name(i) for i in rows[:NAMED]) + more

    def solve_mass(self, v):
        return scipy.sparse.linalg.spsolve(scipy.sparse.csc_matrix(self.M), v) if self.n else v

    def slack(self, high, low):
        """J z - c of all rows, as two doubles and a bound."""
        return self.rows.times(high, low, (-self.finite,))


def guessed(p, z, force):
    """The mode of each contact, by the larger of slack and force, both as motions."""
    s, f = (p.J @ z - p.finite) / p.unit, force * p.unit
    scale = NEAR_TIE * max(math.sqrt(max(z @ (p.M @ z), 0)), math.sqrt(max(p.z_u @ (p.M @ p.z_u), 0)))
    modes = []
    for contact in p.contacts:
        i, t = contact.row, contact.tangents
        if not t:
            modes.append(HELD if f[i] > s[i] else OPEN)
            continue
        slip = numpy.linalg.norm(s[t] * p.unit[t]) / p.unit[i]
        normal = s[i] if not p.convex else s[i] - contact.mu * slip
        modes.append(OPEN if f[i] <= max(normal, scale) else HELD if slip <= scale else SLIDES)
    return modes


class Branch:
    """One choice of modes as a square system. Its unknowns are z, the forces of independent rows, and |s_t| of what slides."""

    def __init__(self, p, modes, force, slips, begins=()):
        self.p, self.modes, self.begins = p, modes, begins
        n = p.n
        held, sliding = [], []
        for contact, mode in zip(p.contacts, modes):
            if mode == HELD:
                held += contact.rows
            elif mode == SLIDES:
                sliding.append(contact)
        first = [c.row for c in sliding] if not p.convex else []
        # Those that slide come last: the others depend on each other alone, and forces that are kept change no friction.
        rows = numpy.array([*p.equal, *held, *first], dtype=int)
        chosen, contradictory = exact_basis(p.J[rows], p.c[rows]) if len(rows) else ([], [])
        self.contradictory = rows[contradictory]
        if len(contradictory):
            return
        self.held, self.basis = rows, rows[chosen]
        self.frozen = numpy.setdiff1d(rows, self.basis)
        if numpy.isin(first, self.frozen).any():
            raise Unproven("the forces of contacts that slide are not unique")
        self.sliding = sliding
        self.pushing = numpy.array([*self.basis, *(i for c in sliding for i in (c.tangents if not p.convex else c.rows))], dtype=int)
        self.column = {int(i): n + k for k, i in enumerate(self.pushing)}
        self.slip = {c.row: n + len(self.pushing) + k for k, c in enumerate(sliding)}
        self.size = n + len(self.pushing) + len(sliding)
        self.sign = {c.row: math.copysign(1, slips[c.tangents[0]]) for c in sliding if len(c.tangents) == 1}
        self.units = numpy.concatenate([1 / numpy.sqrt(p.M.diagonal()), 1 / p.unit[self.pushing], p.unit[[c.row for c in sliding]]])
        self.equations()
        self.constants = numpy.concatenate([p.z_u, force[self.frozen]])
        self.start = numpy.zeros(self.size)
        self.start[n:n + len(self.pushing)] = force[self.pushing]
        for c in sliding:
            self.start[self.slip[c.row]] = numpy.linalg.norm(slips[c.tangents])

    def equations(self):
        """The linear equations A (x, z_u, frozen forces) = b. Quadratic ones have a row of zeros, and stand in `bent`."""
        p, n, N = self.p, self.p.n, self.size
        at, to, value, right = [], [], [], [0.0] * n  # entries of further equations, right sides of all
        self.bent, self.exact, self.tangents = [], {}, {}

        def entries(row, columns, values):
            at.extend([row] * len(columns))
            to.extend(columns)
            value.extend(values)

        def held(row, i, sign=1.0):
            part = slice(p.J.indptr[i], p.J.indptr[i + 1])
            entries(row, p.J.indices[part], sign * p.J.data[part])
        right.extend(p.c[self.basis])
        self.edges = {}
        for contact in self.sliding:
            r, i, t = self.slip[contact.row], contact.row, contact.tangents
            if p.convex:
                held(len(right), i)
                entries(len(right), [r], [-contact.mu])
                right.append(p.c[i])
            self.edges[i] = len(right)
            if len(t) == 1:
                sign = self.sign[i]
                entries(len(right), [self.column[t[0]], self.column[i]], [1.0, sign * contact.mu])
                right.append(0.0)
                held(len(right), t[0], -sign)
                entries(len(right), [r], [1.0])
                right.append(-sign * p.c[t[0]])
            else:
                self.bent.append((contact, len(right)))
                parts = [slice(p.J.indptr[k], p.J.indptr[k + 1]) for k in t]
                entries_of = [zip(p.J.indices[part].tolist(), p.J.data[part].tolist()) for part in parts]
                self.exact[i] = [([(j, Fraction(a)) for j, a in row], Fraction(float(p.c[k]))) for k, row in zip(t, entries_of)]
                self.tangents[i] = p.J[t].toarray()
                right += [0.0] * 3
        M, push, held, rest = p.M.tocoo(), p.J[self.pushing].tocoo(), p.J[self.basis].tocoo(), p.J[self.frozen].tocoo()
        parts = [(at, to, value), (M.row, M.col, M.data), (push.col, push.row + n, -push.data), (held.row + n, held.col, held.data),
                 (M.row, M.col + N, -M.data), (rest.col, rest.row + N + n, -rest.data)]
        self.A = scipy.sparse.csr_matrix((numpy.concatenate([v for *_, v in parts]), (
            numpy.concatenate([i for i, *_ in parts]), numpy.concatenate([j for _, j, _ in parts]))), shape=(N, N + n + len(self.frozen)))
        self.right, self.rows = numpy.array(right), Rows(self.A)
        self.linear = self.A.toarray()[:, :N]

    def slip_of(self, contact, high, low):
        """s_t without error."""
        return [sum((a * (Fraction(high[j]) + Fraction(low[j])) for j, a in row), -c) for row, c in self.exact[contact.row]]

    def bent_values(self, contact, high, low):
        """(force against slip, 2), (slip's size) without error."""
        def of(k):
            return Fraction(high[k]) + Fraction(low[k])
        s, r, mu = self.slip_of(contact, high, low), of(self.slip[contact.row]), Fraction(contact.mu)
        normal = of(self.column[contact.row])
        return [r * of(self.column[i]) + mu * normal * a for i, a in zip(contact.tangents, s)] + [r * r - sum(a * a for a in s)]

    def residual(self, high, low):
        """F, as two doubles and a bound."""
        none = numpy.zeros(len(self.constants))
        first, second, off = self.rows.times(numpy.r_[high, self.constants], numpy.r_[low, none], (-self.right,))
        for contact, row in self.bent:
            for k, value in enumerate(self.bent_values(contact, high, low)):
                first[row + k] = float(value)
                second[row + k] = float(value - Fraction(first[row + k]))
                off[row + k] = EPSILON * abs(second[row + k])
        return first, second, off

    def matrix(self, high, low):
        """F_x, and what its entries are off."""
        p, K = self.p, self.linear.copy()
        off = numpy.zeros_like(K) if self.bent else None
        for contact, row in self.bent:
            s = numpy.array([float(a) for a in self.slip_of(contact, high, low)])
            r, i, J = self.slip[contact.row], self.column[contact.row], self.tangents[contact.row]
            for k, j in enumerate(contact.tangents):
                at = self.column[j]
                K[row + k, :p.n] = contact.mu * high[i] * J[k]
                K[row + k, at], K[row + k, i], K[row + k, r] = high[r], contact.mu * s[k], high[at]
            K[row + 2, :p.n], K[row + 2, r] = -2 * s @ J, 2 * high[r]
            off[row:row + 3] = 16 * EPSILON * abs(K[row:row + 3])
            off[row + 2, :p.n] = 32 * EPSILON * (abs(s) @ abs(J))
        return K, off

    def curvature(self, across):
        if not self.bent:
            return None
        out = numpy.zeros(self.size)
        for contact, row in self.bent:
            r, normal = across[self.slip[contact.row]], across[self.column[contact.row]]
            square = r * r
            for k, i in enumerate(contact.tangents):
                reach = abs(self.tangents[contact.row][k]) @ across[:self.p.n]
                out[row + k] = r * across[self.column[i]] + contact.mu * normal * reach
                square += reach * reach
            out[row + 2] = square
        return out * UP

    def spread(self, radius):
        """What the entries of F_x vary inside of the enclosure."""
        if not self.bent:
            return None
        p, off = self.p, numpy.zeros((self.size, self.size))
        for contact, row in self.bent:
            r, n = radius[self.slip[contact.row]], radius[self.column[contact.row]]
            for k, i in enumerate(contact.tangents):
                tangent = abs(self.tangents[contact.row][k])
                reach = tangent @ radius[:p.n]
                off[row + k, :p.n] += contact.mu * n * tangent
                off[row + k, self.column[i]] += r
                off[row + k, self.column[contact.row]] += contact.mu * reach
                off[row + k, self.slip[contact.row]] += radius[self.column[i]]
                off[row + 2, :p.n] += 2 * reach * tangent
            off[row + 2, self.slip[contact.row]] += 2 * r
        return off * UP

    def begin(self, high, low):
        """A step of Newton's method with the directions kept of slips that begin: their size is near 0, where |s_t| bends."""
        K, first = self.matrix(high, low)[0], self.residual(high, low)[0]
        for contact, row in self.bent:
            if contact.row not in self.begins:
                continue
            K[row:row + 3] = 0
            normal, r = self.column[contact.row], self.slip[contact.row]
            K[row + 2, r], first[row + 2] = 1, high[r]
            direction = self.begins[contact.row]
            for k, (i, d) in enumerate(zip(contact.tangents, direction)):
                K[row + k, self.column[i]], K[row + k, normal] = 1, contact.mu * d
                first[row + k] = high[self.column[i]] + contact.mu * d * high[normal]
                K[row + 2, :self.p.n] -= d * self.tangents[contact.row][k]
                first[row + 2] -= d * (self.tangents[contact.row][k] @ high[:self.p.n] - self.p.c[i])
        return high - Regular(K, units=self.units).step(first)

    def prove(self, z):
        """Encloses the solution: high + low, each off by at most radius."""
        high, low = self.start.copy(), numpy.zeros(self.size)
        high[:self.p.n] = z
        if any(contact.row in self.begins for contact, _ in self.bent):
            high = self.begin(high, low)
        regular, last = None, math.inf
        for _ in range(STEPS):
            if regular is None:
                try:
                    regular = Regular(*self.matrix(high, low), self.units)
                except Unproven:
                    if self.sliding:
                        raise Unproven("the forces of contacts that slide are not unique, or nearly so") from None
                    raise
            first, second, off = self.residual(high, low)
            step = -regular.step(first)
            size = abs(step / regular.across).max(initial=0)
            if not math.isfinite(size) or not size < 1e3 * last:
                raise Unproven("no solution is near the answer with these modes")
            whole = abs(high / regular.across).max(initial=0)
            if size <= whole * 2.0**-90 or last <= size <= whole * 2.0**-70:
                break
            if self.bent and size > 1e-3 * last:
                regular = None
            last = size
            high, rest = added(high, step)
            high, low = added(high, low + rest)
        else:
            first, second, off = self.residual(high, low)
        if self.bent:
            regular = Regular(*self.matrix(high, low), self.units)
        self.radius = regular.radius(first, off + abs(second), self.curvature(regular.across))
        self.high, self.low, self.regular = high, low, regular
        if self.bent:
            spread = self.spread(self.radius)
            regular.off = regular.off + spread
            regular.rest = (regular.rest + regular.size @ ((spread * regular.left[:, None]) @ regular.across)) * UP
            regular.contraction = regular.rest.max()
            if not regular.contraction < 0.5:
                raise Unproven("its equations are too close to dependent ones")
        n, p = self.p.n, self.p
        s, small, off = p.slack(high[:n], low[:n])
        self.slack = s
        self.slack_off = (abs(small) + off + p.rows.absolute @ self.radius[:n]) * UP
        self.force, self.force_off = numpy.zeros(p.m), numpy.zeros(p.m)
        self.force[self.frozen] = self.constants[n:]
        part = slice(n, n + len(self.pushing))
        self.force[self.pushing] = high[part]
        self.force_off[self.pushing] = (abs(low[part]) + self.radius[part]) * UP


    # What holds strictly.

    def force_of(self, contact):
        return self.force[contact.rows], self.force_off[contact.rows]

    def slip_at(self, contact):
        """s_t in doubles, and what it is off."""
        return self.slack[contact.tangents], self.slack_off[contact.tangents]

    def still(self, contact):
        return (abs(self.slack[contact.tangents]) <= self.slack_off[contact.tangents]).all()

    def surplus(self, contact):
        """What an open contact has to spare, and what that is off."""
        s, off = self.slack[contact.row], self.slack_off[contact.row]
        if self.p.convex and contact.tangents:
            t, t_off = self.slip_at(contact)
            s, off = s - contact.mu * length(t), off + contact.mu * (t_off.sum() + 8 * EPSILON * length(t)) + EPSILON * abs(s)
        return s, off * UP

    def changes(self):
        """Of contacts whose mode cannot be right the one it should have, and those that hold by nothing to spare."""
        new, ties = {}, []
        for k, (contact, mode) in enumerate(zip(self.p.contacts, self.modes)):
            f, f_off = self.force_of(contact)
            if mode == OPEN:
                s, off = self.surplus(contact)
                if s < -off:
                    slips = self.p.convex and contact.tangents and self.slack[contact.row] > 0
                    new[k] = SLIDES if slips else HELD
                elif s <= off:
                    ties.append(k)
            elif f[0] <= f_off[0]:
                new[k] = OPEN
            elif mode == HELD and contact.tangents:
                inside = contact.mu * f[0] - length(f[1:])
                off = (contact.mu * f_off[0] + f_off[1:].sum() + 8 * EPSILON * contact.mu * f[0]) * UP
                if inside < -off:
                    new[k] = SLIDES
                elif inside <= off:
                    ties.append(k)
            elif mode == SLIDES and self.high[self.slip[contact.row]] <= 2 * (self.radius + abs(self.low))[self.slip[contact.row]]:
                new[k] = HELD
        return new, ties


def length(v):
    return abs(float(v[0])) if len(v) == 1 else math.hypot(*v)


def full_support(p, rows, push, contacts, goal):
    """Forces of these rows in balance, as many contacts as possible pushing with something to spare; None where none were found."""
    from scipy.optimize import linprog
    rows = numpy.asarray(rows, dtype=int)
    place = {int(i): k for k, i in enumerate(rows)}
    J = scipy.sparse.diags(1 / p.unit[rows]) @ p.J[rows]
    size = abs(goal).max(initial=0) or 1.0
    k, m = len(contacts), len(rows)
    cap = 1e-3 * max(abs(push * p.unit).max(initial=0) / size, 1e-3)
    upper = []
    for c, contact in enumerate(contacts):
        i = place[contact.row]
        line = {i: -1.0, m + c: 1.0}
        upper.append(line)
        tangents = [place[t] for t in contact.tangents]
        for turn in range(0 if not tangents else 2 if len(tangents) == 1 else 8):
            angle = math.pi * turn * (1 if len(tangents) == 1 else 0.25)
            line = {i: -contact.mu * (1 if len(tangents) == 1 else math.cos(math.pi / 8)), m + c: 1.0}
            for t, part in zip(tangents, (math.cos(angle), math.sin(angle))):
                line[t] = part
            upper.append(line)
    at = [(r, j, v) for r, line in enumerate(upper) for j, v in line.items()]
    A = scipy.sparse.csr_matrix(([v for *_, v in at], ([r for r, *_ in at], [j for _, j, _ in at])), shape=(len(upper), m + k))
    found = linprog(numpy.r_[numpy.zeros(m), -numpy.ones(k)], A_ub=A, b_ub=numpy.zeros(len(upper)),
                    A_eq=scipy.sparse.hstack([J.T, scipy.sparse.csr_matrix((p.n, k))]), b_eq=goal / size,
                    bounds=[(None, None)] * m + [(0, cap)] * k, method="highs")
    if found.status != 0:
        return None
    forces = push.copy()
    forces[rows] = found.x[:m] * size / p.unit[rows]
    return forces, found.x[m:] > 1e-3 * cap


class Settled:
    """The branch of a solution, whose contacts are proven to be strict or to be ties."""

    def __init__(self, p, z, force):
        self.p = p
        if not is_definite(p.M):
            raise Unproven("M is not proven to be positive definite")
        modes, seen, begins = guessed(p, z, force), set(), {}
        slips = p.J @ z - p.finite
        shared = False
        for _ in range(ROUNDS):
            branch = Branch(p, modes, force, slips, begins)
            if len(branch.contradictory):
                by_row = {c.row: k for k, c in enumerate(p.contacts)}
                bad = [by_row[i] for i in branch.contradictory if i in by_row]
                if not bad:
                    raise Unproven(f"rows that hold contradict each other: {p.named(branch.contradictory)}")
                for k in bad:
                    modes[k] = OPEN
                continue
            branch.prove(z)
            new, ties = branch.changes()
            free = len(branch.frozen) > 0
            if (free or ties and not new) and not shared and (new or ties):
                # Forces that are not unique may leave a row without force that can have some.
                shared = True
                touching = [k for k, mode in enumerate(modes) if mode == HELD or k in ties and branch.still(p.contacts[k])]
                contacts = [p.contacts[k] for k in touching]
                goal = p.M @ (branch.high[:p.n] - p.z_u)
                for contact, mode in zip(p.contacts, modes):
                    if mode == SLIDES:
                        goal = goal - p.J[contact.rows].T @ branch.force[contact.rows]
                rows = [*p.equal, *(i for c in contacts for i in c.rows)]
                found = full_support(p, rows, branch.force, contacts, goal) if rows else None
                if found is not None:
                    force, pushes = found
                    modes = list(modes)
                    for k, pushing in zip(touching, pushes):
                        if not pushing and k not in ties and len(p.contacts[k].tangents) == 0:
                            modes[k] = OPEN
                        elif pushing and modes[k] == OPEN:
                            modes[k] = HELD
                    continue
            if not new:
                break
            key = tuple(modes)
            if key in seen:
                raise Unproven("rows that differ by rounding were exchanged in a circle")
            seen.add(key)
            modes = [new.get(k, mode) for k, mode in enumerate(modes)]
            force = numpy.where(branch.force_off > 0, branch.force, force)
            slips, begins = branch.slack.copy(), {}
            for k, mode in new.items():
                contact = p.contacts[k]
                if mode == SLIDES and branch.modes[k] == HELD:
                    against = branch.force[contact.tangents]
                    begins[contact.row] = -against / length(against)
                    slips[contact.tangents] = -against
        else:
            raise Unproven("too many rows differ by rounding")
        self.branch = branch
        self.ties = [p.contacts[k] for k in ties]
