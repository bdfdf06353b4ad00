#!/usr/bin/python3
"""Reads FCLIB files with h5py and numpy alone, and compares with what the project reads from them.

fclib_reference.py CONVERT variants          files made by fclib_files.py, one for each trap of the format
fclib_reference.py CONVERT bad               the same spoilt here, each refused in one line
fclib_reference.py CONVERT files FOLDER      every *.hdf5 of a folder
CONVERT is the test program convert_problems. Exit code 77: the folder is not there.
"""
import glob
import hashlib
import os
import struct
import subprocess
import sys
import tempfile

import h5py
import numpy as np

from fclib_files import write


def dense(group):
    """A matrix group of FCLIB, entry by entry."""
    m, n, nz = (int(group[k][0]) for k in ("m", "n", "nz"))
    p, i, x = group["p"][:], group["i"][:], group["x"][:]
    A = np.zeros((m, n))
    if nz >= 0:
        for k in range(nz):
            A[i[k], p[k]] += x[k]
    elif nz == -1:
        for col in range(n):
            for k in range(p[col], p[col + 1]):
                A[i[k], col] += x[k]
    else:
        for row in range(m):
            for k in range(p[row], p[row + 1]):
                A[row, i[k]] += x[k]
    return A


def sparse(group, m, n, by_row):
    """A matrix of the project's own layout."""
    A = np.zeros((m, n))
    p, i, x = group["p"][:], group["i"][:], group["x"][:]
    for line in range(len(p) - 1):
        for k in range(p[line], p[line + 1]):
            A[(line, i[k]) if by_row else (i[k], line)] += x[k]
    return A


def read_own(group):
    n, m = len(group["z_u"]), len(group["c"])
    return {"M": sparse(group["M"], n, n, False), "J": sparse(group["J"], m, n, True), "z_u": group["z_u"][:],
            "c": group["c"][:], "kind": group["kind"][:], "mu": group["mu"][:] if "mu" in group else None}


def notes_in(file):
    return [text.decode() for text in file["zwang"].get("notes", [])]


def sha256(own):
    """The problem's name, computed from its arrays."""
    digest = hashlib.sha256(struct.pack("<qq", len(own["z_u"]), len(own["c"])))
    M, J = own["M"], own["J"]
    for A, lines in ((M, [(i, j) for j in range(len(M)) for i in range(len(M))]),
                     (J, [(i, j) for i in range(len(J)) for j in range(J.shape[1])])):
        for i, j in lines:
            if A[i, j] != 0:
                digest.update(struct.pack("<qqd", i, j, A[i, j]))
        digest.update(struct.pack("<q", -1))
    digest.update(own["z_u"].tobytes() + own["c"].tobytes() + own["kind"].astype("<u8").tobytes())
    if own["mu"] is not None:
        digest.update(own["mu"].tobytes() + struct.pack("<q", 3))  # Coulomb's law
    return digest.hexdigest()


def contact_rows(H, w, mu, dim, sliding, law):
    """Normal rows, the edges of the friction pyramids, or normal and tangent rows: rows of J, entries of c, and the
    coefficient of each row, -1 for a tangent."""
    J, c, rows = [], [], []
    for k in range(H.shape[1] // dim):
        N, wN = H[:, k * dim], w[k * dim]
        if law != "pyramid" or mu[k] == 0:
            slips = sliding if law == "coulomb" and mu[k] > 0 else 0
            J += [H[:, k * dim + r] for r in range(1 + slips)]
            c += [-w[k * dim + r] for r in range(1 + slips)]
            rows += [mu[k]] + slips * [-1]
            continue
        rows += 2 * sliding * [0]
        for t in range(1, sliding + 1):
            for sign in (1, -1):
                J.append(N + sign * mu[k] * H[:, k * dim + t])
                c.append(-(wN + sign * mu[k] * w[k * dim + t]))
    return np.array(J).reshape(-1, H.shape[0]), np.array(c), np.array(rows)


def check_kinds(own, equalities, rows, law):
    expected = [0] * equalities + [2 if mu < 0 else 1 for mu in rows]
    assert own["kind"].tolist() == expected, "equality rows come first, tangent rows after their contact's"
    if law == "coulomb" and (rows < 0).any():
        assert own["mu"].tolist() == [0] * equalities + [max(mu, 0) for mu in rows], "mu stands at inequality rows"
    else:
        assert own["mu"] is None


def close(name, a, b, tolerance, scale=None):
    assert a.shape == b.shape, f"{name}: {a.shape} read, {b.shape} expected"
    scale = scale or max(np.abs(b).max(initial=0), np.finfo(float).tiny)
    error = np.abs(a - b).max(initial=0) / scale
    assert error <= tolerance, f"{name}: relative difference {error}"


def check_global(own, group, law, rolling):
    vectors = {k: v[:] for k, v in group["vectors"].items()}
    M, H, dim = dense(group["M"]), dense(group["H"]), int(group["spacedim"][0])
    if np.count_nonzero(np.tril(M, -1)) == 0 or np.count_nonzero(np.triu(M, 1)) == 0:
        M = M + M.T - np.diag(np.diag(M))
    G = dense(group["G"]) if "G" in group else np.zeros((len(M), 0))
    b = vectors["b"] if "G" in group else np.zeros(0)
    z_u = vectors["z_u"] if "z_u" in vectors else np.linalg.solve(M, vectors["f"])
    sliding = (dim - 1) // 2 if rolling else dim - 1
    J, c, rows = contact_rows(H, vectors["w"], vectors["mu"], dim, sliding, law)
    close("M", own["M"], M, 0)
    close("z_u", own["z_u"], z_u, 0 if "z_u" in vectors else 1e-11)
    close("J", own["J"], np.vstack([G.T, J]), 0)
    close("c", own["c"], np.concatenate([-b, c]), 0)
    check_kinds(own, len(b), rows, law)


def check_local(own, group, law):
    vectors = {k: v[:] for k, v in group["vectors"].items()}
    W, dim = dense(group["W"]), int(group["spacedim"][0])
    e = len(vectors["s"]) if "R" in group else 0
    S = np.zeros((e + len(W), e + len(W)))
    S[e:, e:] = (W + W.T) / 2
    s = np.zeros(0)
    if e:
        S[:e, :e], S[e:, :e], s = dense(group["R"]), dense(group["V"]), vectors["s"]
        S[:e, e:] = S[e:, :e].T
    # Rows are combinations of the Delassus form's unit directions: J J' = P S P'.
    P, c, rows = contact_rows(np.eye(len(W)), vectors["q"], vectors["mu"], dim, dim - 1, law)
    check_kinds(own, e, rows, law)
    P = np.block([[np.eye(e), np.zeros((e, len(W)))], [np.zeros((len(P), e)), P]])
    expected = P @ S @ P.T
    close("J J'", own["J"] @ own["J"].T, expected, 1e-12)
    close("M", own["M"], np.eye(own["J"].shape[1]), 0)
    assert not own["z_u"].any()
    close("c", own["c"], np.concatenate([-s, c]), 0)
    assert own["J"].shape[1] <= np.linalg.matrix_rank(S, tol=1e-15 * np.abs(S).max()), "J is rank-revealing"


def check(convert, file):
    """Reads one file under three laws; a short description."""
    with h5py.File(file) as source, tempfile.TemporaryDirectory() as folder:
        name = next(k for k in source if k.startswith("fclib"))
        for law in ("frictionless", "pyramid", "coulomb"):
            out = os.path.join(folder, "out.h5")
            run = subprocess.run([convert, file, out, law], capture_output=True, text=True)
            assert run.returncode == 0, run.stderr
            with h5py.File(out) as converted:
                own = read_own(converted["zwang"])
                notes = notes_in(converted)
            if name == "fclib_local":
                check_local(own, source[name], law)
            else:
                check_global(own, source[name], law, name.endswith("rolling"))
            assert run.stdout.split()[-1] == sha256(own), "the SHA-256 computed outside differs"
            print(f"{os.path.basename(file)}: {law}: n {own['J'].shape[1]}, m {own['J'].shape[0]}", *notes, sep="; ")
        return notes


def variants(convert):
    with tempfile.TemporaryDirectory() as folder:
        def notes_of(name, **options):
            file = os.path.join(folder, name + ".hdf5")
            write(file, **options)
            return check(convert, file)

        assert notes_of("triplets") == []
        notes_of("unused_entries", extra=3)
        notes_of("duplicate_entries", split=True)
        notes_of("columns", storage="columns", extra=2)
        notes_of("rows", storage="rows", extra=2)
        notes_of("planar", dim=2)
        notes_of("no_equality", equality=False)
        notes_of("exact_motion", exact_motion=True)
        assert any("upper triangle only" in note for note in notes_of("upper", mass=np.triu))
        assert any("lower triangle only" in note for note in notes_of("lower", mass=np.tril, storage="rows"))
        assert any("rolling" in note for note in notes_of("rolling", kind="fclib_global_rolling", dim=5))
        notes_of("local", kind="fclib_local")
        notes_of("local_rows", kind="fclib_local", storage="rows", dim=2)


def rounding(M):
    M[0, 1] *= 1 + 1e-15
    return M


def shear(M):
    M[0, 1] += 0.1
    return M


def bad(convert):
    """Each spoilt file is refused with one line that names the place."""
    def replace(path, value):
        def spoil(g):
            del g[path]
            if value is not None:
                g[path] = np.array(value)
        return spoil

    def change(path, k, value):
        def spoil(g):
            g[path][k] = value
        return spoil

    cases = [
        ({}, replace("vectors/w", None), "/fclib_global/vectors/w: missing; expected a dataset"),
        ({}, replace("M", None), "/fclib_global/M: missing; expected a group"),
        ({}, replace("vectors/w", np.zeros(7)), "/fclib_global: 7 contact rows; expected a multiple of spacedim 3"),
        ({}, replace("vectors/w", np.zeros(9)), "/fclib_global/H: is 6 x 6; expected 6 x 9"),
        ({}, replace("vectors/mu", np.zeros(1)), "/fclib_global/vectors/mu: holds 1 numbers; expected 2"),
        ({}, replace("vectors/mu", [0.5, -0.5]), "/fclib_global/vectors/mu[1]: negative"),
        ({}, replace("spacedim", [4]), "/fclib_global/spacedim: is 4; expected 2 or 3"),
        ({}, replace("spacedim", [2.5]), "/fclib_global/spacedim: not of the right type; expected integers"),
        ({}, replace("H/nz", [-3]), "/fclib_global/H/nz: is -3"),
        ({}, replace("H/nz", [999]), "/fclib_global/H/i: holds 36 numbers; expected 999"),
        ({}, change("H/i", 2, 6), "/fclib_global/H/i[2]: is 6; expected an index below 6"),
        ({}, change("G/p", 0, -1), "/fclib_global/G/p[0]: is -1; expected an index below 2"),
        ({}, change("M/x", 5, np.nan), "/fclib_global/M/x[5]: not a number or infinite"),
        ({}, change("vectors/f", 1, np.inf), "/fclib_global/vectors/f[1]: not a number or infinite"),
        ({}, change("vectors/w", 3, np.nan), "/fclib_global: c("),
        ({}, change("vectors/b", 1, np.inf), "/fclib_global/vectors/b[1]: not a number or infinite"),
        ({"mass": lambda M: -M}, lambda g: None, "/fclib_global/M: not positive definite; expected a mass matrix"),
        ({"mass": shear}, lambda g: None, "/fclib_global/M: not symmetric"),
        ({"kind": "fclib_local"}, change("W/x", 0, -9), "/fclib_local/W: not positive semi-definite"),
        ({"kind": "fclib_local"}, replace("vectors/q", None), "/fclib_local/vectors/q: missing; expected a dataset"),
    ]
    with tempfile.TemporaryDirectory() as folder:
        file, out = os.path.join(folder, "bad.hdf5"), os.path.join(folder, "out.h5")
        for options, spoil, expected in cases:
            write(file, **options)
            with h5py.File(file, "a") as h:
                spoil(h[options.get("kind", "fclib_global")])
            run = subprocess.run([convert, file, out, "pyramid"], capture_output=True, text=True)
            assert run.returncode == 2 and run.stderr.count("\n") == 1, (expected, run)
            assert run.stderr.startswith(f"{file}: {expected}"), (expected, run.stderr)
        write(file, mass=rounding)
        subprocess.run([convert, file, out], check=True, stdout=subprocess.DEVNULL)
        with h5py.File(out) as converted:
            assert "symmetric up to rounding" in notes_in(converted)[0]


def files(convert, folder):
    all_files = sorted(glob.glob(os.path.join(folder, "*.hdf5")))
    if not all_files:
        print(f"skipped: no real contact files in {folder}")
        sys.exit(77)
    for file in all_files:
        check(convert, file)


if __name__ == "__main__":
    {"variants": variants, "bad": bad, "files": files}[sys.argv[2]](sys.argv[1], *sys.argv[3:])
