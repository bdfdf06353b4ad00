"""Small complementarity problems of ties (docs/python.md#gradients).

A tie's u = q + G w may become positive or its w, never both: the gap and the force of a contact that touches, the slip and what the force
has to spare at the edge of its cone; of a contact at the apex both are vectors, and the law of friction holds between them. q and G are
known up to bounds, and so are answers.
"""
import math

import numpy

from .enclosure import EPSILON, UP, Regular, Unproven
from .modes import length

PROJECTIONS = 2000  # of gradients, for a guess
STEPS = 30  # of Newton's method after it


def project(x, mu):
    """P_K(x) of the cone |x_t| <= mu x_n, and its derivative."""
    n, t = x[0], x[1:]
    if not len(t):
        return numpy.maximum(x, 0), numpy.array([[float(n > 0)]])
    size = numpy.linalg.norm(t)
    if size <= mu * n:
        return x.copy(), numpy.eye(len(x))
    if mu * size <= -n:
        return 0 * x, numpy.zeros((len(x), len(x)))
    d, a = t / size, (n + mu * size) / (1 + mu * mu)
    along = numpy.r_[1, mu * d] / (1 + mu * mu)
    bend = numpy.zeros((len(x), len(x)))
    bend[1:, 1:] = mu * a / size * (numpy.eye(len(t)) - numpy.outer(d, d))
    return numpy.r_[a, mu * a * d], numpy.outer(numpy.r_[1, mu * d], along) + bend


class Complementarity:
    """Ties, u = q + G w, and whether the law is the convex one."""

    def __init__(self, ties, q, q_off, G, G_off, convex):
        self.ties, self.q, self.q_off, self.G, self.G_off, self.convex = ties, q, q_off, G, G_off, convex

    def combination(self, modes):
        """(w, what it is off, whether all signs are strict, what opens) of one choice of modes; "no" where it is refuted, "unknown" where
        nothing is known of it, "singular" where that is because of what pushes."""
        q, q_off, G, G_off, k = self.q, self.q_off, self.G, self.G_off, len(self.q)
        B, B_off, right, right_off = numpy.zeros((k, k)), numpy.zeros((k, k)), numpy.zeros(k), numpy.zeros(k)
        line = 0

        def still(at):
            nonlocal line
            B[line, at] = 1
            line += 1

        def zero(at, more=None, factor=0.0):
            """u[at] + factor u[more] = 0."""
            nonlocal line
            B[line], B_off[line], right[line], right_off[line] = G[at], G_off[at], -q[at], q_off[at]
            if more is not None:
                B[line] += factor * G[more]
                B_off[line] += abs(factor) * G_off[more] + 4 * EPSILON * (abs(G[at]) + abs(factor * G[more]))
                right[line] -= factor * q[more]
                right_off[line] += abs(factor) * q_off[more] + 4 * EPSILON * (abs(q[at]) + abs(factor * q[more]))
            line += 1
        for tie, (word, at, *sign) in zip(self.ties, modes):
            size = len(tie.contact.rows) if tie.word == "apex" else 1
            if word == "unknown":
                return "unknown"
            if word in ("rest", "open"):
                for a in range(size):
                    still(at + a)
            elif word in ("act", "stick"):
                for a in range(size):
                    zero(at + a)
            else:
                B[line, at], B[line, at + 1] = tie.contact.mu * sign[0], 1
                line += 1
                zero(at, at + 1, -tie.contact.mu * sign[0]) if self.convex else zero(at)
        try:
            w, low, w_off = Regular(B, B_off).solve(right, numpy.zeros(k), right_off)
        except Unproven:
            return "singular"
        w_off = (w_off + abs(low)) * UP
        u, u_off = self.rises(w, w_off)
        strict = True
        for value, off in self.signs(modes, w, w_off, u, u_off):
            if value < -off:
                return "no"
            strict = strict and value > off
        return w, w_off, strict, u > u_off

    def rises(self, w, w_off):
        """u, and what it is off."""
        rounded = (len(w) + 8) * EPSILON * (abs(self.q) + abs(self.G) @ abs(w))
        off = self.q_off + self.G_off @ (abs(w) + w_off) + abs(self.G) @ w_off + rounded
        return self.q + self.G @ w, off * UP

    def signs(self, modes, w, w_off, u, u_off, ties=None):
        """Numbers that may not be negative, and what they are off."""
        for tie, (word, at, *sign) in zip(self.ties if ties is None else ties, modes):
            mu, size = tie.contact.mu, len(tie.contact.rows)
            part = slice(at + 1, at + size)
            if word == "rest":
                yield u[at], u_off[at]
            elif word == "act":
                yield w[at], w_off[at]
            elif word == "open":
                if self.convex:
                    slip = length(u[part])
                    yield u[at] - mu * slip, (u_off[at] + mu * (u_off[part].sum() + 8 * EPSILON * slip) + EPSILON * abs(u[at])) * UP
                else:
                    yield u[at], u_off[at]
            elif word == "stick":
                along = length(w[part])
                yield mu * w[at] - along, (mu * w_off[at] + w_off[part].sum() + 8 * EPSILON * (along + mu * abs(w[at]))) * UP
            else:
                yield w[at], w_off[at]
                yield sign[0] * u[at + 1], u_off[at + 1]

    def slips_that_begin(self):
        """Under the convex law: [(w, what it is off, True, what opens)] where contacts in space begin to slide, whose directions are
        unknowns, too: w is guessed by projected gradients, and proven by Newton's method. [] where it is not."""
        q, G, k = self.q, self.G, len(self.q)
        mu = [t.contact.mu for t in self.ties]
        starts = numpy.cumsum([0] + [len(t.contact.rows) if t.word == "apex" else 1 for t in self.ties])
        parts = [slice(a, b) for a, b in zip(starts, starts[1:])]
        w, step = numpy.zeros(k), 1 / (numpy.linalg.norm(G, 2) or 1.0)
        for _ in range(PROJECTIONS):
            w = w - step * (q + G @ w)
            for part, m in zip(parts, mu):
                w[part] = project(w[part], m)[0]
        u = q + G @ w
        slides = [(part, m) for part, m in zip(parts, mu) if part.stop - part.start == 3 and
                  numpy.linalg.norm(u[part][1:]) * step > abs(m * w[part][0] - numpy.linalg.norm(w[part][1:]))]
        modes, x = [], numpy.r_[w, [numpy.linalg.norm(u[part][1:]) for part, _ in slides]]
        for tie, part, m in zip(self.ties, parts, mu):
            pushes = w[part.start] > step * abs(u[part.start])
            if tie.word != "apex":
                modes.append(("act" if pushes else "rest", part.start))
            elif part.stop - part.start == 2 and pushes and (
                    abs(u[part.start + 1]) * step > abs(m * w[part.start] - abs(w[part.start + 1]))):
                modes.append(("slide", part.start, math.copysign(1.0, u[part.start + 1])))
            else:
                modes.append(("slide" if (part, m) in slides else "stick" if pushes else "open", part.start))
        size = k + len(slides)

        def system(x):
            """The equations, what they are off, their matrix, what it is off, and what their second order adds for steps `across`."""
            w = x[:k]
            u, u_off = self.rises(w, 0 * w)
            (F, F_off), (K, K_off), lines = numpy.zeros((2, size)), numpy.zeros((2, size, size)), []
            line = 0
            for tie, part, m, (word, at, *sign) in zip(self.ties, parts, mu, modes):
                for a in range(part.start, part.stop):
                    if word in ("rest", "open"):
                        F[line], K[line, a] = w[a], 1
                    elif word in ("act", "stick"):
                        F[line], F_off[line], K[line, :k], K_off[line, :k] = u[a], u_off[a], G[a], self.G_off[a]
                    elif sign and a == at:
                        F[line], K[line, at], K[line, at + 1] = w[at + 1] + m * sign[0] * w[at], m * sign[0], 1
                        F_off[line] = 4 * EPSILON * (abs(w[at + 1]) + m * abs(w[at]))
                    elif sign or a == at:  # u_n = mu |u_t|
                        slip, row = ((sign[0] * u[at + 1], sign[0] * G[at + 1]) if sign else
                                     (x[k + slides.index((part, m))], 0 * G[at]))
                        F[line], K[line, :k] = u[at] - m * slip, G[at] - m * row
                        F_off[line] = u_off[at] + m * u_off[at + 1] * bool(sign) + 4 * EPSILON * (abs(u[at]) + m * abs(slip))
                        K_off[line, :k] = (self.G_off[at] + m * self.G_off[at + 1] * bool(sign)
                                           + 4 * EPSILON * (abs(G[at]) + m * abs(row)))
                        if not sign:
                            K[line, k + slides.index((part, m))] = -m
                    else:  # |u_t| w_t + mu w_n u_t = 0
                        r = k + slides.index((part, m))
                        F[line] = x[r] * w[a] + m * w[at] * u[a]
                        F_off[line] = m * abs(w[at]) * u_off[a] + 8 * EPSILON * (abs(x[r] * w[a]) + m * abs(w[at] * u[a]))
                        K[line, :k] = m * w[at] * G[a]
                        K_off[line, :k] = m * abs(w[at]) * self.G_off[a] + 8 * EPSILON * abs(K[line, :k])
                        K[line, a] += x[r]
                        K[line, at] += m * u[a]
                        K[line, r] = w[a]
                        K_off[line, at] += m * u_off[a] + 8 * EPSILON * (abs(m * u[a]) + abs(K[line, at]))
                        K_off[line, a] += 8 * EPSILON * (abs(x[r]) + abs(K[line, a]))
                        lines.append((line, r, at, a, m))
                    line += 1
            for (part, m), r in zip(slides, range(k, size)):
                v, v_off, H, H_off = u[part][1:], u_off[part][1:], G[part][1:], self.G_off[part][1:]
                F[line], F_off[line] = x[r] ** 2 - v @ v, (2 * abs(v) + v_off) @ v_off + 8 * EPSILON * (x[r] ** 2 + v @ v)
                K[line, :k], K[line, r] = -2 * v @ H, 2 * x[r]
                K_off[line, :k] = 2 * (v_off @ abs(H) + (abs(v) + v_off) @ H_off) + 16 * EPSILON * (abs(v) @ abs(H))
                lines.append((line, r, part, None, m))
                line += 1
            return F, F_off, K, K_off, lines
        for _ in range(STEPS):
            F, _, K, _, _ = system(x)
            try:
                x = x - numpy.linalg.solve(K, F)
            except numpy.linalg.LinAlgError:
                return []
        if not numpy.isfinite(x).all():
            return []
        F, F_off, K, K_off, lines = system(x)
        try:
            regular = Regular(K, K_off)
            across, bent = regular.across, numpy.zeros(size)
            reach = (abs(G) + self.G_off) @ across[:k]
            for line, r, at, a, m in lines:
                bent[line] = (across[r] ** 2 + reach[at][1:] @ reach[at][1:] if a is None
                              else across[r] * across[a] + m * across[at] * reach[a])
            off = regular.radius(F, F_off * UP, bent * UP)
        except Unproven:
            return []
        w, w_off, r, r_off = x[:k], off[:k], x[k:], off[k:]
        u, u_off = self.rises(w, w_off)
        spare = [(w[part.start], w_off[part.start]) for part, _ in slides] + list(zip(r, r_off))
        rest = [(tie, mode) for tie, mode, part, m in zip(self.ties, modes, parts, mu) if (part, m) not in slides]
        spare += self.signs([mode for _, mode in rest], w, w_off, u, u_off, [tie for tie, _ in rest])
        return [(w, w_off, True, u > u_off)] if all(value > bound for value, bound in spare) else []
