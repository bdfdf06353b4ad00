#!/usr/bin/python3
"""Writes FCLIB files with h5py and numpy alone, one for each trap of the format.

fclib_files.py FOLDER    the FCLIB files of tests/data
"""
import os
import sys

import h5py
import numpy as np


def put_matrix(group, A, storage, extra=0, split=False):
    """Writes a matrix group; `extra` entries beyond the used ones, `split` halves each entry into two."""
    m, n = A.shape
    i, p = np.nonzero(A)
    x = A[i, p]
    if split:
        i, p, x = np.repeat(i, 2), np.repeat(p, 2), np.repeat(x / 2, 2)
    nz = len(x)
    if storage == "columns":
        order = np.lexsort((i, p))
        i, x, p, nz = i[order], x[order], np.searchsorted(p[order], range(n + 1)), -1
    elif storage == "rows":
        order = np.lexsort((p, i))
        i, x, p, nz = p[order], x[order], np.searchsorted(i[order], range(m + 1)), -2
    else:
        p = np.concatenate([p, np.full(extra, 99)])
    i, x = np.concatenate([i, np.full(extra, 99)]), np.concatenate([x, np.full(extra, np.nan)])
    for key, value in (("m", m), ("n", n), ("nz", nz), ("nzmax", len(x))):
        group[key] = np.array([value], "i4")
    group["i"], group["p"], group["x"] = i.astype("i4"), p.astype("i4"), x


def write(file, kind="fclib_global", dim=3, storage="triplets", mass=lambda M: M, mu=(0.5, 0), equality=True,
          exact_motion=False, **options):
    """A random problem of two contacts and two equality rows; the same numbers for the same arguments."""
    random, n, contacts, e = np.random.default_rng(1), 6, 2, 2
    B = random.standard_normal((n, n))
    M = B @ B.T + n * np.eye(n)
    H, G = random.standard_normal((n, dim * contacts)), random.standard_normal((n, e))
    f, z_u = random.standard_normal(n), random.standard_normal(n)
    w, b = random.standard_normal(dim * contacts), random.standard_normal(e)
    with h5py.File(file, "w") as h:
        g = h.create_group(kind)
        if kind == "fclib_local":
            S = np.hstack([G, H]).T @ np.hstack([G, H])
            put_matrix(g.create_group("W"), S[e:, e:], storage, **options)
            put_matrix(g.create_group("V"), S[e:, :e], storage, **options)
            put_matrix(g.create_group("R"), S[:e, :e], storage, **options)
            g["vectors/q"], g["vectors/s"] = w, b
        else:
            put_matrix(g.create_group("M"), mass((M + M.T) / 2), storage, **options)
            put_matrix(g.create_group("H"), H, storage, **options)
            if equality:
                put_matrix(g.create_group("G"), G, storage, **options)
                g["vectors/b"] = b
            g["vectors/f"], g["vectors/w"] = f, w
            if exact_motion:
                g["vectors/z_u"] = z_u
        g["vectors/mu"], g["spacedim"] = np.array(mu, float), np.array([dim], "i4")
        # Real files declare a solution and write only part of it.
        h.create_dataset("solution/v", (n,), "f8")
        h["solution/u"] = np.ones(dim * contacts)


if __name__ == "__main__":
    folder = sys.argv[1]
    write(os.path.join(folder, "fclib_global.hdf5"))
    write(os.path.join(folder, "fclib_local.hdf5"), kind="fclib_local", storage="rows")
