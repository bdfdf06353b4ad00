from pathlib import Path
from typing import Any, Callable, Iterable, Sequence

import numpy
import numpy.typing
import scipy.sparse

__version__: str

Numbers = numpy.typing.ArrayLike
Matrix = numpy.typing.ArrayLike | scipy.sparse.spmatrix
Answer = Numbers | tuple[Numbers, Numbers] | None

class BadFile(ValueError): ...

class Problem:
    def __init__(self, M: Matrix, z_u: Numbers, J: Matrix | None = None, c: Numbers | None = None, *,
                 equality: int | Sequence[bool] = 0, tangent: Sequence[bool] | None = None,
                 mu: Numbers | None = None, law: str | None = None, name: str = "problem") -> None: ...
    @property
    def M(self) -> scipy.sparse.csc_matrix: ...
    @property
    def J(self) -> scipy.sparse.csr_matrix: ...
    @property
    def z_u(self) -> numpy.ndarray: ...
    @property
    def c(self) -> numpy.ndarray: ...
    @property
    def equality(self) -> numpy.ndarray: ...
    @property
    def tangent(self) -> numpy.ndarray: ...
    @property
    def mu(self) -> numpy.ndarray: ...
    @property
    def law(self) -> str: ...
    def under(self, law: str) -> Problem: ...
    @property
    def size(self) -> int: ...
    @property
    def rows(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def family(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def row_names(self) -> list[str]: ...
    @property
    def sha256(self) -> str: ...
    @property
    def reference(self) -> dict[str, Any] | None: ...

class Solution:
    status: str
    z: numpy.ndarray
    lambda_: numpy.ndarray
    certificate: numpy.ndarray
    iterations: int
    message: str
    handed_to: str
    error_bound: float
    redundant: list[int]
    seconds: float

class Judgement:
    verdict: str
    at_least: float
    at_most: float
    proof: str
    worst_row: str
    scale_over_answer: float
    primal: float
    dual: float
    stationarity: float
    complementarity: float
    natural: float
    scale: float

class ConvexJudgement:
    verdict: str
    program: str
    at_least: float
    at_most: float
    scale: float
    scale_over_answer: float
    objective: float
    objective_at_least: float
    objective_at_most: float
    objective_error: float
    primal: float
    worst_row: str
    unique: bool | None
    certificate: numpy.ndarray | None
    changed: float
    proof: str

class Derivative:
    dz: numpy.ndarray | None
    @property
    def free(self) -> numpy.ndarray: ...
    dlambda: numpy.ndarray | None
    enclosure: numpy.ndarray | None
    enclosure_lambda: numpy.ndarray | None
    reach: float
    reach_row: int | None
    one_sided: bool
    kink: list[int]
    kink_names: list[str]
    note: str

class GradientJudgement:
    verdict: str
    kink: list[int]
    at_least: float
    at_most: float
    scale: float
    note: str

class Gradient:
    kink: list[int]
    kink_names: list[str]
    unique_forces: bool
    distance: float
    def jvp(self, dM: Matrix | None = None, dz_u: Numbers | None = None, dJ: Matrix | None = None,
            dc: Numbers | None = None, dmu: Numbers | None = None) -> Derivative: ...
    def vjp(self, z_bar: Numbers, lambda_bar: Numbers | None = None,
            wrt: str | Sequence[str] = ...) -> dict[str, numpy.ndarray | None]: ...

def scenes() -> list[dict[str, Any]]: ...
def scene(text: str, seed: int = 1, mu: float | None = None, **knobs: float | str) -> Problem | list[Problem]: ...
def load(file: str | Path) -> list[Problem]: ...
def save(file: str | Path, problems: Problem | Iterable[Problem]) -> None: ...
def solvers() -> list[dict[str, Any]]: ...
def solve(problem: Problem, solver: str = "auto", *, tolerance: float = 1e-10, accuracy: float | str | None = None,
          max_iterations: int = 1000000, time_limit: float = 60.0, warm_start: Numbers | None = None, law: str | None = None, **settings: bool | int | float | str) -> Solution: ...
def judge(problem: Problem, z: Numbers | Solution, lambda_: Numbers | None = None, *, tolerance: float = 1e-9) -> Judgement: ...
def judge_qp(P: Matrix, q: Numbers, G: Matrix | None = None, h: Numbers | None = None, A: Matrix | None = None,
             b: Numbers | None = None, lb: Numbers | None = None, ub: Numbers | None = None, *, x: Numbers,
             y: Numbers | None = None, z: Numbers | None = None, z_box: Numbers | None = None,
             tolerance: float = 1e-9) -> Judgement | ConvexJudgement: ...
def judge_pack(pack: str | Path, *answers: str | Path, out: str | Path | None = None) -> list[dict[str, Any]]: ...
def write_answers(file: str | Path, answers: Iterable[dict[str, Any]], *, solver: str, **header: str | float) -> None: ...
def gradient_of(problem: Problem, solution: Solution | Answer, *, law: str | None = None, proof: bool = True) -> Gradient: ...
def gradient(problem: Problem, solution: Solution | Answer, wrt: str | dict[str, Matrix | Numbers],
             direction: Matrix | Numbers | None = None, *, law: str | None = None, proof: bool = True) -> Derivative: ...
def judge_gradient(problem: Problem, solution: Solution | Answer, gradient: Matrix | Numbers, wrt: str | dict[str, Matrix | Numbers],
                   direction: Matrix | Numbers | None = None, *, z_bar: Numbers | None = None, law: str | None = None,
                   tolerance: float = 1e-9) -> GradientJudgement: ...
def compare_gradients(scenes: str | Problem | Iterable[str | Problem], *, steps: Iterable[float] = (1e-3, 1e-5, 1e-7),
                      smoothings: Iterable[float] = (1e-2, 1e-4, 1e-6), law: str | None = None,
                      seed: int = 1) -> list[dict[str, Any]]: ...
def scene_change(problem: Problem, body: int | None = None, *, pose: Numbers | None = None, velocity: Numbers | None = None,
                 mass: float = 0.0, mu: float = 0.0) -> dict[str, Any]: ...
def scene_gradient(problem: Problem, bars: dict[str, numpy.ndarray | None]) -> dict[str, Any]: ...
def add_solver(name: str, function: Callable[[Problem, float], Answer], method: str = "a Python function") -> None: ...
def bench(scenes: str | Path | Problem | Iterable[str | Path | Problem] | None = None, *, suite: str = "quick",
          solvers: str | Callable[[Problem, float], Answer] | Iterable[str | Callable[[Problem, float], Answer]] | None = None,
          tolerances: float | Iterable[float] | None = None, repetitions: int = 0, seed: int = 1,
          law: str | None = None, out: str | Path | None = None, progress: bool = False) -> list[dict[str, Any]]: ...
