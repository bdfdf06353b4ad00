"""The part of qpsolvers that zwang.qpsolvers uses, for machines without it: the same names, fields and signs."""
import dataclasses

import numpy

from .solvers import available_solvers, dense_solvers, solve_function, sparse_solvers


@dataclasses.dataclass
class Problem:
    P: object
    q: object
    G: object = None
    h: object = None
    A: object = None
    b: object = None
    lb: object = None
    ub: object = None


@dataclasses.dataclass
class Solution:
    problem: Problem
    extras: dict = dataclasses.field(default_factory=dict)
    found: object = None
    obj: object = None
    x: object = None
    y: object = None
    z: object = None
    z_box: object = None

    def primal_residual(self):
        p, worst = self.problem, [0.0]
        if p.G is not None:
            worst.append(numpy.max(p.G @ self.x - p.h))
        if p.A is not None:
            worst.append(numpy.max(abs(p.A @ self.x - p.b)))
        if p.lb is not None:
            worst.append(numpy.max(p.lb - self.x))
        if p.ub is not None:
            worst.append(numpy.max(self.x - p.ub))
        return max(worst)

    def dual_residual(self):
        p = self.problem
        r = p.P @ self.x + p.q
        for matrix, multipliers in ((p.G, self.z), (p.A, self.y)):
            if matrix is not None:
                r = r + matrix.T @ multipliers
        return numpy.max(abs(r + self.z_box if p.lb is not None or p.ub is not None else r))


def solve_problem(problem, solver, initvals=None, verbose=False, **settings):
    return solve_function[solver](problem, initvals, verbose, **settings)
