"""Contact problems as a test set of qpbenchmark, written by zwang.formats.save_qpbenchmark():

    qpbenchmark contact_qpbenchmark.py --results-path results/contact_qpbenchmark.csv run

Needs numpy, scipy and qpbenchmark alone; where zwang is installed, it runs among the solvers. Of problems of up to 500
unknowns each solver gets dense matrices, of larger ones only solvers with sparse matrices are run.
"""
import pathlib

import numpy
import qpbenchmark
import scipy.sparse
from qpbenchmark.solver_settings import SolverSettings

try:
    import zwang.qpsolvers
    zwang.qpsolvers.register()
    SolverSettings.IMPLEMENTED_SOLVERS.add("zwang")
except ImportError:
    pass


class ContactQpbenchmark(qpbenchmark.TestSet):
    title = "Contact problems"
    description = "Least-constraint problems of bodies with joints and contacts: which accelerations meet all of them?"
    most_dense = 500  # unknowns

    def __init__(self):
        self.files = sorted((pathlib.Path(__file__).resolve().parent / "data").glob("*.npz"))
        super().__init__()

    @property
    def sparse_only(self):
        return any(len(numpy.load(file)["q"]) > self.most_dense for file in self.files)

    def define_solver_settings(self):
        super().define_solver_settings()
        if SolverSettings.is_implemented("zwang"):
            for name, settings in self.solver_settings.items():
                settings.set_param("zwang", "time_limit", self.tolerances[name].runtime)

    def __iter__(self):
        dense = not self.sparse_only
        for file in self.files:
            with numpy.load(file) as parts:
                n = len(parts["q"])

                def matrix(name, rows):
                    if rows == 0:
                        return None
                    stored = tuple(parts[f"{name}_{part}"] for part in ("data", "indices", "indptr"))
                    return scipy.sparse.csc_matrix(scipy.sparse.csr_matrix(stored, shape=(rows, n)))

                h, b = parts["h"], parts["b"]
                problem = qpbenchmark.Problem(matrix("P", n), parts["q"], matrix("G", len(h)), h if len(h) else None,
                                              matrix("A", len(b)), b if len(b) else None, None, None,
                                              name=str(parts["name"]))
            yield problem.to_dense() if dense else problem
