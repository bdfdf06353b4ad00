"""Problems in other people's formats, as zwang problems: load(), and save() for what others read.

    .h5 .hdf5         zwang's own layout and FCLIB (docs/formats.md)
    .dat              Siconos' text files of frictional problems, local and global (docs/formats.md)
    .mat              Maros-Meszaros: P, q, r, l, u, A with l <= A x <= u
    .npz              qpbenchmark: P, q, G, h, A, b, lb, ub; and what save_qpbenchmark() writes
    .qps .qps.gz      quadratic programs (QUADOBJ, QMATRIX)
    a folder          Matrix Market: M.mtx, z_u.mtx, J.mtx, c.mtx, equality.mtx

Quadratic programs must be strictly convex. What cannot be read raises BadFile: one line with file, place and what was
expected.
"""
import gzip
import pathlib

import numpy
import scipy.io
import scipy.sparse

import zwang
from . import _zwang
from ._zwang import BadFile
from .writers import save_fclib, save_matrix_market, save_qpbenchmark  # noqa: F401


def load(file):
    """The problems of a file or folder, as a list."""
    path = pathlib.Path(file)
    name = path.name.lower()
    try:
        if path.is_dir():
            return [_matrix_market(path)]
        for suffix, read in _readers.items():
            if name.endswith(suffix):
                if not path.exists():
                    raise BadFile(f"{path}: there is no such file")
                return read(path)
    except Exception as bad:  # readers of damaged files raise whatever they come upon
        text = str(bad).splitlines()[0] if str(bad) else type(bad).__name__
        raise BadFile(text if text.startswith(str(path)) else f"{path}: {text}") from None
    return _zwang.load(path)


def _named(problem, path, family):
    problem._name_it(path.stem, family)
    return [problem]


def _program(path, family, P, q, G=None, h=None, A=None, b=None, lb=None, ub=None):
    return _named(_zwang.from_qp(_zwang.Program(*zwang._program(P, q, G, h, A, b, lb, ub))), path, family)


def _two_sided(P, q, A, l, u, infinite=1e20):
    """l <= A x <= u as equality rows, inequality rows and bounds: the last n rows of A may be the identity."""
    P, A, q, l, u = map(zwang._real, (P, A, q, l, u))
    P, A = scipy.sparse.csc_matrix(P, dtype=float), scipy.sparse.csr_matrix(A, dtype=float)
    q, l, u = (numpy.asarray(v, dtype=float).reshape(-1) for v in (q, l, u))
    n = len(q)
    if A.shape != (len(l), n) or len(u) != len(l):
        raise ValueError(f"A is {A.shape[0]} x {A.shape[1]}; expected {len(l)} x {n}")
    if not ((l < infinite) & (u > -infinite)).all():
        row = numpy.flatnonzero(~((l < infinite) & (u > -infinite)))[0]
        raise ValueError(f"row {row} is {l[row]} <= A x <= {u[row]}; expected bounds that a number can keep")
    l, u = numpy.where(l <= -infinite, -numpy.inf, l), numpy.where(u >= infinite, numpy.inf, u)
    lb = ub = None
    if len(l) >= n and (A[len(l) - n:] != scipy.sparse.identity(n)).nnz == 0:
        lb, ub, A, l, u = l[-n:], u[-n:], A[:-n], l[:-n], u[:-n]
    equal = l == u
    above, below = ~equal & numpy.isfinite(u), ~equal & numpy.isfinite(l)
    G = scipy.sparse.vstack([A[above], -A[below]], format="csr")
    return dict(P=P, q=q, G=G, h=numpy.r_[u[above], -l[below]], A=A[equal], b=l[equal], lb=lb, ub=ub)


def _mat(path):
    parts = scipy.io.loadmat(path)
    for name in ("P", "q", "A", "l", "u"):
        if name not in parts:
            raise ValueError(f"has no array {name}; expected P, q, A, l, u")
    return _program(path, "maros-meszaros", **_two_sided(*(parts[name] for name in ("P", "q", "A", "l", "u"))))


def _npz(path):
    with numpy.load(path, allow_pickle=False) as parts:
        if "P_indptr" in parts.files:
            return _of_test_set(path, parts)
        given = {}
        for name in ("P", "q", "G", "h", "A", "b", "lb", "ub"):
            if name not in parts.files:
                continue
            with parts.zip.open(name + ".npy") as raw:
                version = numpy.lib.format.read_magic(raw)
                head = numpy.lib.format.read_array_header_1_0 if version == (1, 0) else numpy.lib.format.read_array_header_2_0
                shape, _, kind = head(raw)
            if kind.hasobject and shape == ():  # a pickled None: the part is absent
                continue
            if kind.hasobject:
                raise ValueError(f"{name} holds objects; expected numbers")
            given[name] = parts[name]
    for name in ("P", "q"):
        if given.get(name) is None:
            raise ValueError(f"has no array {name}; expected P and q")
    return _program(path, "qpbenchmark", **given)


def _of_test_set(path, parts):
    """A problem that save_qpbenchmark() wrote, every bit of it."""
    n, equality = len(parts["q"]), parts["equality"]

    def matrix(name, rows):
        return scipy.sparse.csr_matrix(tuple(parts[f"{name}_{part}"] for part in ("data", "indices", "indptr")),
                                       shape=(rows, n))
    J = scipy.sparse.vstack([matrix("A", len(parts["b"])), -matrix("G", len(parts["h"]))], format="csr")
    order = numpy.argsort(numpy.r_[numpy.flatnonzero(equality), numpy.flatnonzero(~equality)])
    if J.shape[0] != len(equality):
        raise ValueError(f"has {J.shape[0]} rows in A and G; expected {len(equality)}")
    problem = zwang.Problem(matrix("P", n), parts["z_u"], J[order], numpy.r_[parts["b"], -parts["h"]][order],
                            equality=equality)
    problem._name_it(str(parts["name"]), "qpbenchmark")
    return [problem]


def _qps(path):
    """QPS, fixed or free: sections by their names, the objective's constant with its minus sign, one triangle. OBJSENSE MAX turns
    the objective's sign."""
    def real(word):
        if numpy.isnan(float(word)):
            raise ValueError("not a number")
        return float(word)
    opened = gzip.open(path, "rt") if path.name.endswith(".gz") else open(path, encoding="ascii", errors="replace")
    with opened as lines:
        section, kinds, rows, columns = "", {}, {}, {}
        entries, objective, right, ranges, quadratic = [], {}, {}, {}, []
        lower, upper, goal, sign = {}, {}, None, 1
        for number, line in enumerate(lines, 1):
            if not line.strip() or line[0] == "*":
                continue
            words = line.split()
            try:
                if not line[0].isspace():
                    section = words[0].upper()
                    if section == "ENDATA":
                        break
                    if section not in _sections:
                        raise ValueError("no such section is known here")
                    words = words[1:] if section == "OBJSENSE" else []
                    if not words:
                        continue
                if section == "OBJSENSE":
                    sign = {"MAX": -1, "MIN": 1}[words[0].upper()[:3]]
                elif section == "ROWS":
                    kind, row = words[0].upper(), words[1]
                    if kind not in ("N", "L", "G", "E"):
                        raise ValueError(f"no row type '{words[0]}'; expected N, L, G or E")
                    if kind == "N" and goal is None:
                        goal = row
                    kinds[row] = kind
                    if kind != "N":
                        rows[row] = len(rows)
                elif section in ("COLUMNS", "RHS", "RANGES"):
                    pairs = words[1:] if len(words) % 2 else words
                    column = words[0]
                    if section == "COLUMNS":
                        if "'MARKER'" in words:
                            raise ValueError("integer columns are not convex")
                        columns.setdefault(column, len(columns))
                    for row, value in zip(pairs[::2], map(real, pairs[1::2])):
                        if row not in kinds:
                            raise ValueError(f"no row '{row}'")
                        if section == "COLUMNS" and row == goal:
                            objective[column] = value
                        elif section == "COLUMNS" and row in rows:
                            entries.append((rows[row], columns[column], value))
                        elif row in rows:
                            (right if section == "RHS" else ranges)[row] = value
                elif section in ("QUADOBJ", "QMATRIX", "QSECTION"):
                    a, b, value = columns[words[0]], columns[words[1]], real(words[2])
                    quadratic.append((a, b, value))
                    if section != "QMATRIX" and a != b:
                        quadratic.append((b, a, value))
                elif section == "BOUNDS":
                    kind = words[0].upper()
                    value = None if kind in ("FR", "MI", "PL") else real(words[-1])
                    column = columns[words[-1] if value is None else words[-2]]
                    if kind in ("LO", "FX"):
                        lower[column] = value
                    if kind in ("UP", "FX"):
                        upper[column] = value
                        if kind == "UP" and value < 0 and column not in lower:
                            lower[column] = -numpy.inf
                    if kind in ("FR", "MI"):
                        lower[column] = -numpy.inf
                    if kind not in ("LO", "UP", "FX", "FR", "MI", "PL"):
                        raise ValueError(f"no bound '{kind}' is known here")
                else:
                    raise ValueError("expected a section that has such lines")
            except (IndexError, KeyError, ValueError) as bad:
                raise ValueError(f"line {number}: {section or 'no section'}: cannot read "
                                 f"'{line.strip()}' ({bad})") from None
        else:
            raise ValueError("cut: no ENDATA at its end")
    n, m = len(columns), len(rows)
    if n == 0:
        raise ValueError("has no columns; expected a QPS file")
    A = scipy.sparse.coo_matrix(([e[2] for e in entries], ([e[0] for e in entries], [e[1] for e in entries])), (m, n))
    P = scipy.sparse.coo_matrix(([e[2] for e in quadratic], ([e[0] for e in quadratic], [e[1] for e in quadratic])),
                                (n, n))
    q = numpy.zeros(n)
    for column, value in objective.items():
        q[columns[column]] = value
    l, u = numpy.full(m, -numpy.inf), numpy.full(m, numpy.inf)
    for row, i in rows.items():
        b, kind, width = right.get(row, 0.0), kinds[row], ranges.get(row)
        if kind in ("E", "G"):
            l[i] = b
        if kind in ("E", "L"):
            u[i] = b
        if width is not None:
            if kind == "G":
                u[i] = b + abs(width)
            elif kind == "L":
                l[i] = b - abs(width)
            else:
                l[i], u[i] = (b, b + width) if width >= 0 else (b + width, b)
    lb = numpy.array([lower.get(j, 0.0) for j in range(n)])
    ub = numpy.array([upper.get(j, numpy.inf) for j in range(n)])
    parts = _two_sided(sign * P, sign * q, scipy.sparse.vstack([A, scipy.sparse.identity(n)]), numpy.r_[l, lb], numpy.r_[u, ub])
    return _program(path, "qps", **parts)


def _matrix_market(folder):
    def read(name, needed=True):
        file = folder / f"{name}.mtx"
        if not file.exists() and not needed:
            return None
        try:
            return scipy.io.mmread(file)
        except Exception as bad:
            raise ValueError(f"{file}: not of Matrix Market's format ({bad})") from None
    z_u, c, mask = read("z_u"), read("c", False), read("equality", False)
    dense = (lambda v: None if v is None else numpy.asarray(v.toarray() if scipy.sparse.issparse(v) else v).reshape(-1))
    problem = zwang.Problem(read("M"), dense(z_u), read("J", False), dense(c),
                            equality=0 if mask is None else dense(mask) != 0, name=folder.name)
    return problem


_sections = ("NAME", "OBJSENSE", "ROWS", "COLUMNS", "RHS", "RANGES", "BOUNDS", "QUADOBJ", "QMATRIX", "QSECTION")
_readers = {".mat": _mat, ".npz": _npz, ".qps": _qps, ".qps.gz": _qps}
