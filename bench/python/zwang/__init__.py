"""Compare solvers for contact problems, and judge their answers.

    minimize 1/2 (z - z_u)' M (z - z_u)   subject to   J z = c (equality rows),  J z >= c (inequality rows)

Units are SI: z and z_u in m/s^2 and rad/s^2, M in kg and kg m^2; each row of J and its c share the row's own unit.
Distances are taken in the M-norm, |d| = sqrt(d' M d), relative to s = max(|z_u|, |z*|).

    >>> import zwang
    >>> problem = zwang.scene("hand(contacts=16)")
    >>> answer = zwang.solve(problem, "dual_active_set")
    >>> print(zwang.judge(problem, answer.z))        # doctest: +ELLIPSIS
    solved: |z - z*| is at least 0 and at most ...
"""
import functools
import importlib
import itertools
import json
import pathlib
import tempfile

import numpy
import scipy.sparse

from . import _zwang
from ._zwang import BadFile, Judgement, Solution, __version__
from .packs import judge_pack, write_answers

__all__ = ["BadFile", "Judgement", "Problem", "Solution", "__version__", "add_solver", "bench", "compare_gradients",
           "gradient", "gradient_of", "judge", "judge_gradient", "judge_pack", "judge_qp", "load", "save", "scene",
           "scene_change", "scene_gradient", "scenes", "solve", "solvers", "write_answers"]


@functools.cache
def _part(name):
    """A module of the package, loaded when it is first asked for: an import within a function takes its time in every call."""
    return importlib.import_module("." + name, __name__)


def _real(value):
    if numpy.iscomplexobj(value):
        raise ValueError("it has complex entries")
    return value


def _numbers(value, name, size=None):
    """A float64 vector, or one line saying why not."""
    if value is None:
        return numpy.empty(0)
    try:
        array = numpy.array(_real(value), dtype=numpy.float64, order="C")
    except (TypeError, ValueError, OverflowError) as bad:
        raise ValueError(f"{name} should be a vector of numbers: {bad}") from None
    if array.ndim == 0:
        array = numpy.full(1 if size is None else size, float(array))
    if array.ndim != 1:
        array = array.reshape(-1) if array.ndim == 2 and 1 in array.shape else array
    if array.ndim != 1:
        raise ValueError(f"{name} should have one dimension, and has the shape {array.shape}")
    return array


def _number(value, name):
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name} should be a number: {value!r:.80}") from None


def _whole(value, name, most=2**31 - 1):
    if not numpy.isfinite(_number(value, name)) or int(value) != value or not 0 <= int(value) <= most:
        raise ValueError(f"{name} should be a whole number from 0 to {most}: {value!r:.80}")
    return int(value)


def _yes(value, name):
    if not isinstance(value, (bool, numpy.bool_)):
        raise ValueError(f"{name} should be True or False: {value!r:.80}")
    return bool(value)


def _positive(values, name):
    """A list of finite numbers above 0."""
    numbers = _numbers(values, name)
    bad = numpy.flatnonzero(~(numpy.isfinite(numbers) & (numbers > 0)))
    if len(bad):
        raise ValueError(f"{name}: entry {bad[0]} is {numbers[bad[0]]:g}; expected a finite number above 0")
    return numbers.tolist()


def _problem(problem):
    if not isinstance(problem, _zwang.Problem):
        raise TypeError(f"problem should be a zwang.Problem, as scene() and load() make them: {problem!r:.80}")
    return problem


def _problems(problems):
    """One problem or several of them, as a list."""
    return [_problem(p) for p in (problems if numpy.iterable(problems) and not isinstance(problems, str) else [problems])]


def _check_indices(matrix):
    """That indices lie inside the matrix: scipy's own conversions write wherever they point."""
    if hasattr(matrix, "check_format"):
        matrix.check_format(full_check=True)
    elif matrix.format == "coo":
        for index, size in zip((matrix.row, matrix.col), matrix.shape):
            if len(index) != len(matrix.data) or (len(index) and not 0 <= index.min() <= index.max() < size):
                raise ValueError("an index lies outside")
    elif matrix.format in ("lil", "dok", "dia"):
        return
    else:
        raise ValueError(f"the sparse format {matrix.format} is not known")


def _matrix(matrix, name, columns, by_rows):
    """Any matrix as float64 in compressed columns or rows, sorted, without duplicates."""
    kind = scipy.sparse.csr_matrix if by_rows else scipy.sparse.csc_matrix
    if matrix is None:
        matrix = kind((0, columns))
    try:
        if scipy.sparse.issparse(_real(matrix)):
            _check_indices(matrix)
        else:
            matrix = numpy.asarray(matrix, dtype=numpy.float64)
            if matrix.ndim == 1 and by_rows:
                matrix = matrix.reshape(1, -1)
            if matrix.ndim != 2:
                raise ValueError(f"it has the shape {matrix.shape}")
        matrix = kind(matrix, dtype=numpy.float64, copy=True)
        matrix.sum_duplicates()
        matrix.sort_indices()
    except (TypeError, ValueError, OverflowError, IndexError) as bad:
        raise ValueError(f"{name} should be a matrix of numbers: {bad}") from None
    if matrix.nnz >= 2**31 or max(matrix.shape) >= 2**31:
        raise ValueError(f"{name} is too large: expected fewer than 2^31 entries")
    return matrix


def _program(P, q, G, h, A, b, lb, ub):
    """A quadratic program's arrays, or one line that names the one with an entry no program has."""
    q = _numbers(q, "q")
    n = len(q)
    parts = (_matrix(P, "P", n, False), q, _matrix(G, "G", n, True), _numbers(h, "h", 1), _matrix(A, "A", n, True),
             _numbers(b, "b", 1), _numbers(lb, "lb", n), _numbers(ub, "ub", n))
    for name, part in zip(("P", "q", "G", "h", "A", "b", "lb", "ub"), parts):
        entries = part.data if scipy.sparse.issparse(part) else part
        bad = ~(numpy.isfinite(entries) | (entries == {"lb": -numpy.inf, "ub": numpy.inf, "h": numpy.inf}.get(name, 0)))
        if bad.any():
            place = "" if scipy.sparse.issparse(part) else f"({numpy.flatnonzero(bad)[0]})"
            raise ValueError(f"{name}{place} is {entries[bad][0]}; expected a number")
    return parts


def _init(self, M, z_u, J=None, c=None, *, equality=0, tangent=None, mu=None, law=None, name="problem"):
    z_u = _numbers(z_u, "z_u")
    rows_given, c, n = c is not None, _numbers(c, "c"), len(z_u)
    M, J = _matrix(M, "M", n, False), _matrix(J, "J", n, True)
    if J.shape[0] and not rows_given:
        raise ValueError(f"c is missing: expected {J.shape[0]} entries, one a row of J")
    for which, matrix, shape, of in (("M", M, (n, n), f"z_u has {n} entries"), ("J", J, (len(c), n), f"c has {len(c)} entries and z_u {n}")):
        if matrix.shape != shape:
            raise ValueError(f"{which} should be {shape[0]} x {shape[1]}, as {of}, and is {matrix.shape[0]} x {matrix.shape[1]}")
    mask = numpy.asarray(equality)
    if mask.ndim == 0:
        if mask.dtype == bool or not numpy.issubdtype(mask.dtype, numpy.integer) or not 0 <= int(mask) <= len(c):
            raise ValueError(f"equality should be a number of rows from 0 to {len(c)}, or {len(c)} booleans")
        mask = numpy.arange(len(c)) < int(mask)
    if mask.dtype != bool or mask.shape != c.shape:
        raise ValueError(f"equality should be a number of rows from 0 to {len(c)}, or {len(c)} booleans")
    slips = numpy.zeros(len(c), dtype=bool) if tangent is None else numpy.asarray(tangent)
    if slips.dtype != bool or slips.shape != c.shape or (slips & mask).any():
        raise ValueError(f"tangent should be {len(c)} booleans, none of them of an equality row")
    mu = _numbers(mu, "mu", len(c)) if mu is not None or slips.any() else numpy.empty(0)
    if mu.size not in (0, len(c)):
        raise ValueError(f"mu should have {len(c)} entries, one a row, or be one number; it has {mu.size}")
    if not slips.any() and (mu != 0).any():
        raise ValueError(f"mu({numpy.flatnonzero(mu != 0)[0]}) is not 0, but there are no tangent rows: tangent=")
    mu = mu if slips.any() else numpy.empty(0)
    if law is None:
        law = "coulomb" if slips.any() else "frictionless"
    _made(self, M, z_u, J, c, mask, slips, mu, str(law), str(name))


def _under(problem, law):
    """The problem under another law: "frictionless" (tangent rows left out), "pyramid" (four facets a contact, a QP),
    "convex" or "coulomb". From the first two there is no way back."""
    if not isinstance(law, str):
        raise TypeError(f"law should be frictionless, pyramid, convex or coulomb: {law!r:.80}")
    return problem._under(law)


def _pickled(problem):
    """As a file holds it; where a scene made it, its bodies are not kept."""
    with tempfile.TemporaryDirectory() as scratch:
        file = pathlib.Path(scratch) / "problem.h5"
        _zwang.save(file, [problem])
        return _unpickled, (file.read_bytes(),)


def _unpickled(held):
    with tempfile.TemporaryDirectory() as scratch:
        file = pathlib.Path(scratch) / "problem.h5"
        file.write_bytes(held)
        return _zwang.load(file)[0]


# The class of all problems, whoever made them: what is Python of it is put into the compiled one.
Problem = _zwang.Problem
_made = Problem.__init__
_init.__name__, _init.__qualname__ = "__init__", "Problem.__init__"
Problem.__init__, Problem.__module__ = _init, __name__
Problem.__doc__ = """A problem of least constraint.

M: n x n, symmetric positive definite (dense or any scipy.sparse format). z_u: n. J: m x n. c: m; -inf on an
inequality row bounds nothing. equality: how many of the first rows are equalities, or m booleans. Raises
ValueError, with the place, for sizes that do not fit, NaN, an M that is not symmetric or not positive definite.

Friction: tangent says of each row whether J z - c is a slip of the contact whose inequality row stands before it
(one or two a contact); mu, m numbers, is read at inequality rows; law is "coulomb" or "convex" (docs/formulation.md).
"""
Problem.reference = property(lambda p: p._reference, doc="what the file or the scene knows to be true, or None")
Problem.under = _under
Problem.__repr__ = lambda p: f"<zwang.Problem {p.name}: {p.size} unknowns, {p.rows} rows>"
Problem.__reduce__ = _pickled
Problem.__copy__ = lambda p: p  # nothing of it can be changed
Problem.__deepcopy__ = lambda p, known: p
Solution.__repr__ = lambda s: f"<zwang.Solution: {s.status}, {s.iterations} iterations>"


def scenes():
    """The scenes and their knobs, one dict each."""
    return _zwang.scenes()


def scene(text, seed=1, mu=None, **knobs):
    """The problem of a scene: "hand(contacts=16)", or "hand", contacts=16. A list where the text names several:
    "hand(contacts=16,64)". mu: the coefficient of friction of the scenes whose text does not say one."""
    if not isinstance(text, str):
        raise TypeError(f"a scene should be a text: {text!r:.80}")
    if knobs:
        if "(" in text:
            raise ValueError(f"{text}: expected knobs in the text or beside it, not both")
        text += "(" + ",".join(f"{name}={_setting(value)}" for name, value in knobs.items()) + ")"
    problems = _zwang.make_scenes(text, _whole(seed, "seed", 2**64 - 1), None if mu is None else _number(mu, "mu"))
    return problems[0] if len(problems) == 1 else problems


def load(file):
    """The problems of a file, as a list: zwang's own layout, FCLIB, Siconos' text, Maros-Meszaros, qpbenchmark, QPS,
    Matrix Market (zwang.formats). Raises BadFile with file, place and what was expected."""
    from . import formats
    return formats.load(file)


def save(file, problems):
    """Writes one problem or a list of them; every double comes back bit for bit."""
    listed = _problems(problems)
    if not listed:
        raise ValueError(f"{file}: there are no problems to save")
    _zwang.save(pathlib.Path(file), listed)


def solvers():
    """The solvers and what each cannot do, one dict each."""
    return _zwang.solvers()


def _setting(value):
    value = value.item() if isinstance(value, numpy.generic) else value
    return ("on" if value else "off") if isinstance(value, bool) else value if isinstance(value, str) else repr(value)


def _share(tolerance):
    if not 0 < _number(tolerance, "tolerance") < 1:
        raise ValueError(f"tolerance should lie between 0 and 1: {tolerance!r}")
    return float(tolerance)


def solve(problem, solver="auto", *, tolerance=1e-10, accuracy=None, max_iterations=1000000, time_limit=60.0,
          warm_start=None, law=None, **settings):
    """Solves a problem. solver: "auto" takes what docs/performance.md says: "cone" where there is friction, "newton" where more than a
    thousand rows hang together, else "dual_active_set". settings are the solver's own (solvers() lists them). law: solves problem.under(law).

    time_limit: s of CPU time. warm_start: m multipliers of an earlier answer. accuracy: the error at which a method may
    end before the tolerance, relative to the motion (1e-4) or as a speed of any body ("1e-4m/s"). Returns a Solution:
    status (what the solver claims), z (n), lambda_ (m), iterations, message, seconds; error_bound, with an accuracy: a
    bound, rounding aside, on |z - z*|_M / max(|z_u|_M, |z*|_M), NaN where none was had (docs/tutorials/accuracy.md).
    """
    if not isinstance(solver, str):
        raise TypeError(f"solver should be a name: {solver!r}")
    if not _number(time_limit, "time_limit") > 0:
        raise ValueError(f"time_limit should be above 0 s: {time_limit!r}")
    text = solver + (":" + ",".join(f"{k}={_setting(v)}" for k, v in settings.items()) if settings else "")
    problem = _problem(problem) if law is None else _problem(problem).under(law)
    warm = None if warm_start is None else _numbers(warm_start, "warm_start")
    if warm is not None and not numpy.isfinite(warm).all():
        bad = numpy.flatnonzero(~numpy.isfinite(warm))[0]
        raise ValueError(f"warm_start({bad}) is {warm[bad]}; expected a finite number")
    if accuracy == "":
        raise ValueError("accuracy: expected a value, and it is empty")
    accuracy = "" if accuracy is None else accuracy if isinstance(accuracy, str) else repr(_number(accuracy, "accuracy"))
    return _zwang.solve(problem, text, _number(tolerance, "tolerance"), accuracy, _whole(max_iterations, "max_iterations"),
                        float(time_limit), warm, solver.split(":")[0] in _python_solvers)


def judge(problem, z, lambda_=None, *, tolerance=1e-9):
    """Whether z solves the problem, whoever found it: a Judgement with verdict, at_least and at_most (proven bounds on
    |z - z*|_M / s, s = max(|z_u|_M, |z*|_M)), residuals and the worst row. scale_over_answer = s / |z*|_M: times it, the
    bounds are relative to the answer alone. The truth is found and certified independently of any solver. z: n numbers, or what
    solve() returned, whose forces are then judged, too, or whose certificate where it says that no z meets the rows."""
    if isinstance(z, _zwang.Solution):
        if z.status == "infeasible":
            return _zwang.judge_infeasible(_problem(problem), z.certificate)
        z, lambda_ = z.z, z.lambda_ if lambda_ is None else lambda_
    return _zwang.judge(_problem(problem), _numbers(z, "z"), _numbers(lambda_, "lambda_"), _share(tolerance))


def judge_qp(P, q, G=None, h=None, A=None, b=None, lb=None, ub=None, *, x, y=None, z=None, z_box=None,
             tolerance=1e-9):
    """Whether x solves a convex quadratic program, or a linear one (P = 0), in qpsolvers' convention:

        minimize 1/2 x'Px + q'x   subject to   G x <= h,  A x = b,  lb <= x <= ub

    P: n x n, symmetric; a triangular P is refused, and one that is proven indefinite beyond rounding. Where P is positive
    definite, multipliers (y of A, z of G, z_box of the bounds) may be given, P x + q + A'y + G'z + z_box = 0, and the
    Judgement's bounds are on |x - x*|_P, relative to s = max(|P^-1 q|_P, |x*|_P); times its scale_over_answer =
    s / |x*|_P they are relative to the answer alone. Where P is singular a ConvexJudgement (docs/python.md) bounds
    |x - x*|_P and the least objective, and says whether x* is unique and whether the program has a solution.
    """
    parts, x = _program(P, q, G, h, A, b, lb, ub), _numbers(x, "x")
    try:
        return _zwang.judge_qp(_zwang.Program(*parts), x, _numbers(y, "y", 1), _numbers(z, "z", 1),
                               _numbers(z_box, "z_box", len(parts[1])), _share(tolerance))
    except _zwang.NotDefinite:
        pass
    from . import semidefinite
    try:
        return semidefinite.judge(*parts, x, _share(tolerance))
    except OverflowError:
        raise ValueError("the objective is beyond doubles: expected smaller entries of x, or of P, q and the bounds") from None


def gradient_of(problem, solution, *, law=None, proof=True):
    """The derivatives of a solution with respect to the numbers of its problem, proven: a Gradient, which factors once.

    solution: what solve() returned, (z, lambda), or z. law: the solution is one of problem.under(law), and derivatives are those with
    respect to the problem as it is given, mu included. g.jvp(dM=, dz_u=, dJ=, dc=, dmu=) gives a Derivative in that direction,
    g.vjp(z_bar, lambda_bar=None, wrt=...) a dict of gradients, one a name. Which rows hold, open and slide is proven at the solution itself,
    to which the given one need only be near. Raises ValueError, with one line, where there is no solution or nothing is proven.

    proof=False: for inner loops. Modes are read off (z, lambda), which has to be a solution to 1e-8 of the motion; what is closer to a
    tie than that is named as a kink. The derivative is one factorization, or a few at a kink, without enclosure and reach, and refused where only the
    proof tells: at a kink of friction, and where forces are not unique and J, c or mu change, or contacts slide.
    """
    problem = _problem(problem)
    if law is None and proof is False:  # calls less, in an inner loop
        return _part("quick_gradients").QuickGradient(problem, solution)
    return _part("gradients").gradient_of(problem, solution, law, _yes(proof, "proof"))


def gradient(problem, solution, wrt, direction=None, *, law=None, proof=True):
    """How the solution changes with the problem: a Derivative dz (n), dlambda (m), with the enclosure of each entry.

    wrt: "M" (direction n x n, symmetric), "z_u" (n), "J" (m x n), "c" (m), "mu" (m), or a dict of such names and directions.
    Where rows are about to open, close, stick or slide, `kink` names them, and the derivative is that of a step forward
    (`one_sided`); dz is None where there is no one number. Where forces are not unique dlambda is None, and `note` says so.
    proof=False: without the proof and the enclosure, in less than the time of a solve, but for some kinks (gradient_of).
    """
    gradients = _part("gradients")
    return gradient_of(problem, solution, law=law, proof=proof).jvp(**gradients.parameters(wrt, direction))


def judge_gradient(problem, solution, gradient, wrt, direction=None, *, z_bar=None, law=None, tolerance=1e-9):
    """Whether a gradient is right, whoever computed it: a GradientJudgement with the verdict "right", "wrong", "undecided" or
    "kink: [rows]", and proven bounds at_least and at_most on its distance from the true one.

    gradient: dz (n) in a direction, as in gradient(); its distance is in the M-norm, relative to the largest of dz, of the change of the
    free motion, and of what the move of one row alone would do. Or, with z_bar (n), the gradient with respect to `wrt` of a number whose
    gradient with respect to z is z_bar, as a backward pass gives it; its distance is in the sum of squares, relative to the larger of the
    true gradient and that of a motion that no row holds. Raises ValueError as gradient() does.
    """
    from . import gradients
    return gradients.judge_gradient(_problem(problem), solution, gradient, wrt, direction, z_bar, law, _share(tolerance))


def compare_gradients(scenes, *, steps=(1e-3, 1e-5, 1e-7), smoothings=(1e-2, 1e-4, 1e-6), law=None, seed=1):
    """How far off gradients are that are made as usual: dz for a random change of z_u, as large as z_u, by central differences with these
    steps, and of rows made soft by these amounts (not under Coulomb's law), relative to the proven dz.

    scenes: as in scene(), a Problem, or a list of them; law: each under this law. Returns one dict a problem: problem, law, kink (rows),
    reach, width (of the enclosure), differences {step: error}, soft {smoothing: error}, note (why there is nothing to compare with).
    """
    from . import usual_gradients
    steps, smoothings = _positive(steps, "steps"), _positive(smoothings, "smoothings")
    given = [scenes] if isinstance(scenes, str) or not numpy.iterable(scenes) else scenes
    problems = [p for one in given for p in _problems(scene(one, seed) if isinstance(one, str) else one)]
    return [usual_gradients.compare(p if law is None else p.under(law), steps, smoothings, seed) for p in problems]


def scene_change(problem, body=None, *, pose=None, velocity=None, mass=0.0, mu=0.0):
    """How a scene's problem changes with its bodies: a dict of dM, dz_u, dJ, dc, dmu, right to rounding, for gradient_of(...).jvp(**change).

    body: its number in problem.bodies, which has the first unknown of each, -1 for those that are not free. pose (6): a twist [m; rad] in
    the world's axes, about the centre of mass, that moves it with its contacts and joints; velocity (6) [m/s; rad/s]; mass [kg], by
    density: the inertia grows in proportion. mu: of every contact that has friction. Changes may be added up. Which rows there are is
    not changed. Raises ValueError where no scene made the problem (files, random rows, problems under the pyramid).

    A contact keeps its point in the axes of its first body, and its face (point, normal, tangents) in those of its second. Where a body
    rolls or slides over another, this is the derivative of that point against that face, which depends on which body is the first, and
    not of the contact that would be detected anew: for that one build the scene at two poses and take the difference of the answers, or
    give the contact by hand, with its point on the body on which it stays.
    """
    from . import scene_changes
    return scene_changes.change(_problem(problem), body, pose, velocity, mass, mu)


def scene_gradient(problem, bars):
    """What a backward pass leaves at the scene: bars is what gradient_of(...).vjp(z_bar) returned. A dict of "pose" (bodies x 6),
    "velocity" (bodies x 6), "mass" (bodies) and "mu", each the gradient with respect to that argument of scene_change()."""
    from . import scene_changes
    return scene_changes.gradient(_problem(problem), bars)


def add_solver(name, function, method="a Python function"):
    """Makes a Python function a solver of that name, for solve() and bench(), in place of an earlier function of that name:
    function(problem, tolerance) returns z, or (z, lambda), or None where it has no answer. It runs in a child process with a deadline."""
    if not isinstance(name, str):
        raise TypeError(f"name should be a text: {name!r:.80}")
    if not callable(function):
        raise TypeError(f"function should be one of a problem and a tolerance: {function!r:.80}")

    def call(problem, tolerance):
        answer = _python_solvers[name](problem, tolerance)
        if answer is None:
            return None
        if isinstance(answer, tuple) and len(answer) != 2:
            raise ValueError("expected z or (z, lambda)")
        z, force = answer if isinstance(answer, tuple) else (answer, None)
        return _numbers(z, "z"), _numbers(force, "lambda")
    if name not in _python_solvers:
        _zwang.add_solver(name, call, str(method))
    _python_solvers[name] = function


_python_solvers = {}


def _name_of(function, taken):
    """Under which bench() runs a function: its own name, with -2, -3, ... where `taken` has another function of that name."""
    own = getattr(function, "__name__", type(function).__name__).replace("<", "").replace(">", "")
    names = itertools.chain([own], (f"{own}-{k}" for k in itertools.count(2)))
    return next(name for name in names if taken.get(name, function) is function)


def bench(scenes=None, *, suite="quick", solvers=None, tolerances=None, repetitions=0, seed=1, law=None, out=None,
          progress=False):
    """Runs solvers on scenes ("hand(contacts=16,64)"), files, problems (a Problem, or a list), or a suite; returns one
    dict a run, with the keys of results.jsonl (docs/formats.md): pandas.DataFrame(zwang.bench(...)).

    solvers: names, or Python functions (see add_solver; two of one name are told apart as mine and mine-2), or "qpsolvers:NAME" for a
    solver that qpsolvers finds.
    law: of every problem ("frictionless", "pyramid", "convex", "coulomb"); None: its own.
    out: a new folder that keeps the run, for `zwang report`, and at Ctrl-C what is finished. progress: how far it is, on stderr.
    """
    from . import qpsolvers as outside
    asked = [] if solvers is None else [solvers] if isinstance(solvers, str) or callable(solvers) else list(solvers)
    taken = {solver: _python_solvers.get(solver) for solver in asked if isinstance(solver, str)}
    names = []
    for solver in asked:
        if callable(solver):
            name = _name_of(solver, taken)
            taken[name] = solver
            add_solver(name, solver)
            solver = name
        elif not isinstance(solver, str):
            raise TypeError(f"solvers should be names or functions: {solver!r}")
        elif solver.startswith("qpsolvers:"):
            solver = outside.add(solver.split(":", 1)[1])
        names.append(solver)
    given = [scenes] if isinstance(scenes, (str, _zwang.Problem, pathlib.PurePath)) else [] if scenes is None else list(scenes)
    if suite == "collision":
        raise ValueError("the suite collision compares no solvers: ./zwang bench --suite collision runs it")
    problems, files, texts = ([p for p in given if isinstance(p, kind)] for kind in (_zwang.Problem, pathlib.PurePath, str))
    if len(problems) + len(files) + len(texts) != len(given):
        raise TypeError("scenes should be a text, a pathlib.Path, a Problem, or a list of such")
    several = numpy.iterable(tolerances) and not isinstance(tolerances, str)
    wanted = [] if tolerances is None else [_number(t, "a tolerance") for t in (tolerances if several else [tolerances])]
    for name, value, found in (("scenes", scenes, ",".join(texts) or problems or files), ("solvers", solvers, ",".join(names)),
                               ("tolerances", tolerances, wanted)):
        if value is not None and not found:
            raise ValueError(f"{name} is empty: leave it out for those of the suite")
    python = any(name.split(":")[0] in _python_solvers for name in names) or (not names and bool(_python_solvers))
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(out) if out is not None else pathlib.Path(scratch) / "run"
        _zwang.bench(str(suite), ",".join(texts), problems, files, ",".join(names), wanted, _whole(repetitions, "repetitions"),
                     _whole(seed, "seed", 2**64 - 1), None if law is None else str(law), python, folder, bool(progress))
        with open(folder / "results.jsonl", encoding="utf-8") as lines:
            return [json.loads(line) for line in lines]
