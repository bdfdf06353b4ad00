"""qpsolvers on both sides: zwang as a solver of qpsolvers, and qpsolvers' solvers in zwang's bench.

    >>> import qpsolvers, zwang.qpsolvers                           # doctest: +SKIP
    >>> zwang.qpsolvers.register()                                  # doctest: +SKIP
    >>> qpsolvers.solve_qp(P, q, G, h, solver="zwang")              # doctest: +SKIP
    >>> zwang.bench("hand", solvers=["dual_active_set", "qpsolvers:clarabel"])   # doctest: +SKIP
"""
import numpy
import scipy.sparse
import scipy.sparse.linalg

import zwang


def _stack(problem):
    """The rows of a qpsolvers.Problem as J, c and the number of equality rows, with what each row came from."""
    n = len(problem.q)
    blocks, c, parts = [], [], []
    for name, matrix, right, sign in (("A", problem.A, problem.b, 1), ("G", problem.G, problem.h, -1)):
        if matrix is None:
            continue
        matrix = scipy.sparse.csr_matrix(matrix if scipy.sparse.issparse(matrix) else numpy.atleast_2d(matrix))
        right = numpy.atleast_1d(numpy.asarray(right, dtype=float))
        keep = numpy.isfinite(right) if name == "G" else numpy.ones(len(right), bool)
        blocks.append(sign * matrix[keep])
        c.append(sign * right[keep])
        parts.append((name, numpy.flatnonzero(keep)))
    for name, bound, sign in (("lb", problem.lb, 1), ("ub", problem.ub, -1)):
        if bound is None:
            continue
        bound = numpy.asarray(bound, dtype=float)
        keep = numpy.flatnonzero(numpy.isfinite(bound))
        blocks.append(sign * scipy.sparse.identity(n, format="csr")[keep])
        c.append(sign * bound[keep])
        parts.append((name, keep))
    J = scipy.sparse.vstack(blocks, format="csr") if blocks else scipy.sparse.csr_matrix((0, n))
    equalities = len(parts[0][1]) if parts and parts[0][0] == "A" else 0
    return J, numpy.concatenate(c) if c else numpy.empty(0), equalities, parts


def solve_problem(problem, initvals=None, verbose=False, *, algorithm="dual_active_set", tolerance=1e-10, **settings):
    """Solves a qpsolvers.Problem (strictly convex) with a solver of zwang; returns a qpsolvers.Solution."""
    import qpsolvers
    P = scipy.sparse.csc_matrix(problem.P, dtype=float)
    z_u = -scipy.sparse.linalg.spsolve(P, problem.q) if P.shape[0] > 1 else -problem.q / P.toarray()[0, 0]
    J, c, equalities, parts = _stack(problem)
    answer = zwang.solve(zwang.Problem(P, z_u, J, c, equality=equalities), algorithm, tolerance=tolerance, **settings)
    found = answer.status.startswith("solved")
    solution = qpsolvers.Solution(problem, found=found)
    if found:
        x = answer.z
        y, z, box = numpy.zeros(0), numpy.zeros(0), numpy.zeros(len(x))
        at = 0
        for name, rows in parts:
            part = answer.lambda_[at:at + len(rows)]
            at += len(rows)
            if name == "A":
                y = -part
            elif name == "G":
                z = numpy.zeros(len(numpy.atleast_1d(problem.h)))
                z[rows] = part
            else:
                box[rows] += -part if name == "lb" else part
        solution.x, solution.y, solution.z = x, y, z
        solution.z_box = box if problem.lb is not None or problem.ub is not None else numpy.zeros(0)
        solution.obj = 0.5 * x @ (P @ x) + problem.q @ x
    solution.extras = {"status": answer.status, "iterations": answer.iterations, "message": answer.message}
    return solution


def register():
    """Makes qpsolvers.solve_qp(..., solver="zwang") work; returns the names that qpsolvers now finds."""
    import qpsolvers
    import qpsolvers.solvers
    qpsolvers.solvers.solve_function["zwang"] = solve_problem
    for known in (qpsolvers.available_solvers, qpsolvers.dense_solvers, qpsolvers.sparse_solvers):
        if "zwang" not in known:
            known.append("zwang")
    return list(qpsolvers.available_solvers)


def add(name):
    """A solver of qpsolvers as a solver of zwang's bench, by its name there; returns its name here."""
    ours = f"qpsolvers_{name}"
    if ours in zwang._python_solvers:
        return ours
    try:
        import qpsolvers
    except ImportError:
        raise ValueError(f"qpsolvers:{name} needs the package qpsolvers (pip install qpsolvers)") from None
    if name not in qpsolvers.available_solvers:
        raise ValueError(f"qpsolvers finds no solver '{name}': it has {', '.join(qpsolvers.available_solvers)}")
    options = _tolerance_of.get(name, lambda t: {})

    def call(problem, tolerance):
        M, J, c, equal = problem.M, problem.J, problem.c, problem.equality
        bounds = ~equal & numpy.isfinite(c)
        program = qpsolvers.Problem(
            M if name in qpsolvers.sparse_solvers else M.toarray(), -(M @ problem.z_u),
            *((-J[bounds], -c[bounds]) if bounds.any() else (None, None)),
            *((J[equal], c[equal]) if equal.any() else (None, None)))
        if name not in qpsolvers.sparse_solvers:
            program.G = program.G.toarray() if program.G is not None else None
            program.A = program.A.toarray() if program.A is not None else None
        answer = qpsolvers.solve_problem(program, solver=name, **options(tolerance))
        if not answer.found or answer.x is None:
            return None
        lambda_ = numpy.zeros(len(c))
        if answer.y is not None and len(answer.y):
            lambda_[equal] = -answer.y
        if answer.z is not None and len(answer.z):
            lambda_[bounds] = answer.z
        return answer.x, lambda_

    zwang.add_solver(ours, call, method=f"{name}, through qpsolvers")
    return ours


# How each is asked for a tolerance: its own settings, as tight as the referee wants.
_tolerance_of = {
    "clarabel": lambda t: {"tol_gap_abs": t, "tol_gap_rel": t, "tol_feas": t},
    "cvxopt": lambda t: {"abstol": t, "reltol": t, "feastol": t},
    "daqp": lambda t: {"primal_tol": max(t, 1e-14), "dual_tol": max(t, 1e-14)},
    "ecos": lambda t: {"abstol": t, "reltol": t, "feastol": t},
    "highs": lambda t: {"primal_feasibility_tolerance": max(t, 1e-10), "dual_feasibility_tolerance": max(t, 1e-10)},
    "osqp": lambda t: {"eps_abs": t, "eps_rel": t, "max_iter": 1000000, "polish": True},
    "piqp": lambda t: {"eps_abs": t, "eps_rel": t},
    "proxqp": lambda t: {"eps_abs": t, "eps_rel": 0.0},
    "scs": lambda t: {"eps_abs": t, "eps_rel": t, "max_iters": 1000000},
}
