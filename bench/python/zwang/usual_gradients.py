"""Gradients as they are usually made, against proven ones (docs/tutorials/gradients.md).

Rows made soft, as in MuJoCo: minimize 1/2 |z - z_u|_M^2 + sum |lambda_i|^2 R_i / 2, lambda_i = P_K(-s_i) / R_i,
R_i = smoothing J_i M^-1 J_i'. Their gradient is exact, of a softer problem.
"""
import math

import numpy

from .complementarity import project

NEWTON = 60  # steps on a soft problem
CONVERGED = 1e-26  # of the objective, relative, that a step still gains
MOVES = 1e-3  # of the change of the free motion: a dz that is less is none to compare by


class Soft:
    """A problem with soft rows, under any law but Coulomb's."""

    def __init__(self, p, smoothing):
        self.p, self.M, self.J = p, p.M.toarray(), p.J.toarray()
        unit = numpy.einsum("ij,ji->i", self.J, numpy.linalg.solve(self.M, self.J.T))
        tangent, self.blocks, self.R, i = p.tangent, [], numpy.ones(p.rows), 0
        while i < p.rows:
            end = i + 1
            while end < p.rows and tangent[end]:
                end += 1
            if p.c[i] > -math.inf and unit[i] > 0:
                self.blocks.append((slice(i, end), p.mu[i], p.equality[i]))
                self.R[i:end] = smoothing * unit[i]
            i = end

    def at(self, z, bend=True):
        """The objective, its gradient and Hessian."""
        s, d = self.J @ z - numpy.where(numpy.isfinite(self.p.c), self.p.c, 0), z - self.p.z_u
        force, D = numpy.zeros(len(s)), numpy.zeros((len(s), len(s)))
        for rows, mu, equal in self.blocks:
            force[rows], D[rows, rows] = (-s[rows], numpy.eye(rows.stop - rows.start)) if equal else project(-s[rows], mu)
        value, slope = 0.5 * d @ self.M @ d + 0.5 * force @ (force / self.R), self.M @ d - self.J.T @ (force / self.R)
        return value, slope, self.M + self.J.T @ (D / self.R[:, None]) @ self.J if bend else None

    def solve(self, z):
        for _ in range(NEWTON):
            value, slope, H = self.at(z)
            step, t = -numpy.linalg.solve(H, slope), 1.0
            if abs(slope @ step) < CONVERGED * (1 + abs(value)):
                break
            while self.at(z + t * step, False)[0] > value + 1e-4 * t * (slope @ step) and t > 1e-6:
                t /= 2
            z = z + t * step
        return z, H


def changed(p, d, h):
    from . import Problem
    friction = dict(tangent=p.tangent, mu=p.mu, law=p.law) if p.tangent.any() else {}
    return Problem(p.M, p.z_u + h * d, p.J, p.c, equality=p.equality, **friction)


def compare(p, steps, smoothings, seed):
    from . import gradient, solve
    solver = "cone" if p.tangent.any() else "dual_active_set"
    answer = solve(p, solver, tolerance=1e-12)
    out = {"problem": p.name, "law": p.law, "kink": [], "note": "", "width": math.nan, "reach": 0.0, "differences": {}, "soft": {}}

    def norm(v):
        return math.sqrt(max(v @ (p.M @ v), 0.0))
    d = numpy.random.default_rng(seed).normal(size=p.size)
    d *= norm(p.z_u) / norm(d)
    try:
        true = gradient(p, answer, "z_u", d)
    except ValueError as why:
        out["note"] = str(why)
        return out
    out["kink"], out["reach"] = true.kink, true.reach
    if true.dz is None or norm(true.dz) < MOVES * norm(d):
        out["note"] = true.note if true.dz is None else "hardly anything moves"
        return out
    size = norm(true.dz)
    out["width"] = norm(true.enclosure) / size
    for h in steps:
        ahead, behind = (solve(changed(p, d, t), solver, tolerance=1e-12) for t in (h, -h))
        if len(ahead.z) and len(behind.z):
            out["differences"][h] = norm((ahead.z - behind.z) / (2 * h) - true.dz) / size
    for smoothing in smoothings if p.law != "coulomb" else ():
        z, H = Soft(p, smoothing).solve(answer.z)
        out["soft"][smoothing] = norm(numpy.linalg.solve(H, p.M @ d) - true.dz) / size
    return out
