"""Problem files of any kind as arrays, through the program's own reader."""
import argparse
import fcntl
import json
import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import tempfile

import h5py
import numpy as np

WRONG_USE, BAD_FILE = 2, 3
SUFFIXES = (".h5", ".hdf5", ".dat")


def fail(line, code=WRONG_USE):
    print(line, file=sys.stderr)
    sys.exit(code)


def as_program(main):
    """Ends with what main() returns; that nobody reads on, or a file cannot be written, as in any other program."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # what was found before is written
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        try:
            code = main()
        finally:
            sys.stdout.flush()
    except OSError as bad:
        print(f"{bad.filename or 'output'}: {bad.strerror or bad}", file=sys.stderr)
        os._exit(BAD_FILE)  # nothing is written once more
    sys.exit(code)


def made(folder):
    """The folder as a path, which is this program's alone from here on. That it cannot be written is said before minutes are spent."""
    folder = pathlib.Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as bad:
        fail(f"{folder}: {bad.strerror}", BAD_FILE)
    try:
        fcntl.flock(os.open(folder, os.O_RDONLY), fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        fail(f"{folder}: another ./zwang experiment writes into it")
    except OSError:
        pass  # NFS locks no folders
    return folder


class Options(argparse.ArgumentParser):
    """Wrong use costs one line."""

    def error(self, message):
        fail(f"{message} ({self.prog} --help lists the options)")


class Problem:
    """M [n, n], J [m, n], c [m]; equalities: rows; contacts: a list of rows each, normal first; mu of each contact; z_u [n]."""

    def __init__(self, M, J, c, kind, mu, name="", notes=(), z_u=None):
        keep = np.flatnonzero(np.isfinite(c))  # c = -inf: the contact cannot be met
        for row in np.flatnonzero(~np.isfinite(c)):
            while row + 1 < len(kind) and kind[row + 1] == 2:
                row += 1
                keep = keep[keep != row]
        self.M, self.J, self.c, kind, mu = M, J[keep], c[keep], kind[keep], mu[keep]
        self.name, self.notes, self.z_u = name, list(notes), z_u
        self.equalities = [int(row) for row in np.flatnonzero(kind == 0)]
        self.contacts, self.mu = [], []
        for row, what in enumerate(kind):
            if what == 1:
                self.contacts.append([row])
                self.mu.append(float(mu[row]))
            elif what == 2:
                self.contacts[-1].append(row)
        self.rolling = any("rolling" in note for note in self.notes)


def dense(group, shape, by_columns):
    if isinstance(group, h5py.Dataset):
        return np.array(group, float)
    out, p, i, x = np.zeros(shape), group["p"][:], group["i"][:], group["x"][:]
    lines = np.repeat(np.arange(len(p) - 1), np.diff(p))
    np.add.at(out, (i, lines) if by_columns else (lines, i), x)
    return out


def read(path):
    """The problem of a file in the project's own layout (docs/formats.md)."""
    with h5py.File(path) as file:
        g = file["zwang"]
        n, m = len(g["z_u"]), len(g["c"])
        text = lambda key: [t.decode() if isinstance(t, bytes) else str(t) for t in g[key][:]] if key in g else []
        mu = g["mu"][:] if "mu" in g else np.zeros(m)
        return Problem(dense(g["M"], (n, n), True), dense(g["J"], (m, n), False), g["c"][:], g["kind"][:], mu,
                       (text("name") or [pathlib.Path(path).stem])[0], text("notes"), g["z_u"][:])


def write(path, name, family, z_u, J, c, mu):
    """A problem of contacts alone with M = I, in the project's own layout; J [3 k, n] with the normal of each contact first."""
    k = len(mu)
    full = np.zeros(3 * k)
    full[::3] = mu
    with h5py.File(path, "w") as file:
        g = file.create_group("zwang")
        for key, value in (("M", np.eye(len(z_u))), ("z_u", z_u), ("J", J), ("c", c), ("kind", np.array([1, 2, 2] * k, "u1")), ("mu", full)):
            g[key] = value
        for key, value in (("name", name), ("family", family), ("law", "coulomb")):
            g[key] = [value]


def run(words):
    """Standard output of a command of the program; its error, where it has one, ends this one the same way."""
    done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE, text=True)
    if done.returncode not in (0, 1):
        sys.exit(done.returncode)
    return done.stdout


def expanded(what):
    """Each folder as its problem files, HDF5 and .dat beside each other; names of scenes as they are."""
    out = []
    for word in what:
        path = pathlib.Path(word)
        inside = sorted(p for p in path.rglob("*") if p.suffix in SUFFIXES) if path.is_dir() else []
        if path.is_dir() and not inside:
            fail(f"{word}: no problem files ({', '.join(SUFFIXES)}) in this folder", BAD_FILE)
        out += [str(p.resolve()) for p in inside] or [str(path.resolve()) if path.exists() else word]
    return out


def packed(program, what, out):
    """Writes the problems into OUT/problems, unless they are there, and returns their files."""
    index, what = out / "pack.json", expanded(what)
    if not index.exists():
        run([program, "pack", *what, "--out", out])
    elif shlex.split(json.loads(index.read_text())["made_by"])[2:-2] != what:
        fail(f"{out} holds other problems: --out DIR names another folder")
    return [out / p["file"] for p in json.loads(index.read_text())["problems"]]


def readers(program, law):
    """Names of the solvers that are built in and read the law."""
    lines = run([program, "solvers"]).splitlines()
    return [line.split()[0] for line in lines if line.startswith("  ") and "not built in" not in line and law in line[:60]]


def solutions(program, path):
    return json.loads(run([program, "solve", path, "--law", "coulomb", "--solutions", "--json"]))


def asymmetry(notes):
    """Largest |W - W'| entry where the file stored W; None where it did not."""
    for note in notes:
        if found := re.match(r"W is asymmetric by up to ([0-9.e+-]+\d)", note):
            return float(found[1])
    return 0.0 if any(note.startswith("Delassus form") for note in notes) else None
