"""Problems for other people's programs. The functions are those of zwang.formats."""
import pathlib
import shutil

import numpy
import scipy.io
import scipy.sparse
import scipy.sparse.linalg

from . import _problem, _problems


def write_triplets(group, matrix):
    """FCLIB's triplets: p holds columns, i rows (the header's comment says the reverse; the files say this)."""
    matrix = scipy.sparse.coo_matrix(matrix)
    for name, value in (("nzmax", matrix.nnz), ("m", matrix.shape[0]), ("n", matrix.shape[1]), ("nz", matrix.nnz)):
        group[name] = numpy.array([value], dtype=numpy.int32)
    group["p"], group["i"] = matrix.col.astype(numpy.int32), matrix.row.astype(numpy.int32)
    group["x"] = matrix.data.astype(float)


def _refuse_tangents(file, problem):
    if problem.tangent.any():
        raise ValueError(f"{file}: this format has no friction; save problem.under('pyramid') or under('frictionless')")


def save_matrix_market(folder, problem):
    """M.mtx, z_u.mtx, J.mtx, c.mtx, equality.mtx in a new folder, 17 digits: every double comes back. Row names and keys
    cannot be kept; c = -inf is refused, since the format has no infinity, and so are no unknowns, since it has no empty matrix:
    without rows there are no files of them."""
    folder = pathlib.Path(folder)
    _refuse_tangents(folder, _problem(problem))
    if not numpy.isfinite(problem.c).all():
        raise ValueError(f"{folder}: c holds -inf, which Matrix Market cannot")
    if not problem.size:
        raise ValueError(f"{folder}: the problem has no unknowns, and Matrix Market no empty matrix")
    folder.mkdir(parents=True)
    values = {"M": problem.M, "z_u": problem.z_u[:, None]}
    if problem.rows:
        values |= {"J": problem.J, "c": problem.c[:, None], "equality": problem.equality.astype(float)[:, None]}
    for name, value in values.items():
        scipy.io.mmwrite(folder / f"{name}.mtx", value, precision=17, symmetry="general")


def save_fclib(file, problem, mu=None, form="global"):
    """FCLIB's layouts, contacts [N, T1, T2] (or [N, T1] where every contact slips along one tangent): "global",
    M v = H r + G lambda + f, or "local", u = W r + V lambda + q with W = J M^-1 J'.

    Inequality rows become normals, tangent rows their tangents; those of a contact without friction are zeros and its mu
    is 0. mu: other coefficients, one number or one a contact. Equality rows become G. What cannot be kept: names and keys
    of rows, the order of equality among inequality rows, and contacts whose normal row has c = -inf, which bind nothing. All contacts
    have as many tangents: where one has two, another's one comes back with a row of zeros behind it; tangent rows of a contact with
    mu = 0 do not come back. The global file carries z_u beside f = M z_u, which is rounded, so that zwang reads every other bit
    back; the local one keeps neither M nor z_u, and its W is rounded. The layout has no word for a law and means Coulomb's: "convex" is
    refused.
    """
    import h5py
    if form not in ("global", "local"):
        raise ValueError(f"form should be global or local, and is {form}")
    if _problem(problem).law == "pyramid":
        raise ValueError(f"{file}: the edges of a pyramid are no contacts; save the problem under another law")
    if problem.law == "convex":
        raise ValueError(f"{file}: FCLIB means Coulomb's law, and this problem's is convex; save problem.under('coulomb'), "
                         "or by zwang.save(), which keeps the law")
    J, c, equal, slips = problem.J, problem.c, problem.equality, problem.tangent
    own_normal = numpy.maximum.accumulate(numpy.where(slips, 0, numpy.arange(problem.rows)))
    rows = numpy.flatnonzero(~equal & numpy.isfinite(c[own_normal]))
    normal = rows[~slips[rows]]
    contact = numpy.cumsum(~slips[rows]) - 1  # of each row
    slip = rows - normal[contact]
    if mu is not None:
        mu = numpy.broadcast_to(numpy.asarray(mu, dtype=float), len(normal))
        if not (mu >= 0).all():
            raise ValueError(f"{file}: mu is negative; expected friction coefficients >= 0")
    one = slip.max(initial=0) == 1
    dim = 2 if one else 3
    place = dim * contact + slip
    H = scipy.sparse.coo_matrix(J[rows].T)
    H = scipy.sparse.csc_matrix((H.data, (H.row, place[H.col])), shape=(problem.size, dim * len(normal)))
    w = numpy.zeros(dim * len(normal))
    w[place] = -c[rows]
    G, b = scipy.sparse.csc_matrix(J[equal].T), -c[equal]
    with h5py.File(file, "w") as out:
        group = out.create_group(f"fclib_{form}")
        group["spacedim"] = numpy.array([dim], dtype=numpy.int32)
        vectors = group.create_group("vectors")
        vectors["mu"] = problem.mu[normal] if mu is None else mu
        if form == "global":
            write_triplets(group.create_group("M"), problem.M)
            write_triplets(group.create_group("H"), H)
            vectors["f"], vectors["w"], vectors["z_u"] = problem.M @ problem.z_u, w, problem.z_u
            if equal.any():
                write_triplets(group.create_group("G"), G)
                vectors["b"] = b
            return
        both = scipy.sparse.hstack([G, H], format="csc")
        S = both.T @ scipy.sparse.linalg.splu(scipy.sparse.csc_matrix(problem.M)).solve(both.toarray())
        S, e = (S + S.T) / 2, int(equal.sum())
        write_triplets(group.create_group("W"), S[e:, e:])
        vectors["q"] = H.T @ problem.z_u + w
        if e:
            write_triplets(group.create_group("V"), S[e:, :e])
            write_triplets(group.create_group("R"), S[:e, :e])
            vectors["s"] = G.T @ problem.z_u + b


def save_qpbenchmark(folder, problems):
    """A test set of qpbenchmark in a new folder: contact_qpbenchmark.py, data/*.npz and results/.

        qpbenchmark contact_qpbenchmark.py --results-path results/contact_qpbenchmark.csv run

    Sparse P, q = -M z_u (rounded), G = -J and h = -c of the inequality rows, A = J and b = c of the equality rows. The
    files carry z_u and the order of rows too, so that zwang.load() gives every bit back but the names and keys of rows.
    """
    problems, folder = _problems(problems), pathlib.Path(folder)
    if not problems:
        raise ValueError(f"{folder}: there are no problems to save")
    for problem in problems:
        _refuse_tangents(folder, problem)
    folder.mkdir(parents=True)
    (folder / "data").mkdir()
    (folder / "results").mkdir()
    shutil.copyfile(pathlib.Path(__file__).with_name("contact_qpbenchmark.py"), folder / "contact_qpbenchmark.py")
    for number, problem in enumerate(problems):
        equal = problem.equality
        parts = {"name": numpy.array(problem.name), "q": -(problem.M @ problem.z_u), "h": -problem.c[~equal],
                 "b": problem.c[equal], "z_u": problem.z_u, "equality": equal}
        for name, matrix in (("P", problem.M), ("G", -problem.J[~equal]), ("A", problem.J[equal])):
            matrix = scipy.sparse.csr_matrix(matrix)
            parts |= {f"{name}_{part}": getattr(matrix, part) for part in ("data", "indices", "indptr")}
        numpy.savez_compressed(folder / "data" / f"{number:04}.npz", **parts)
