"""Answers to a pack of problems (docs/packs.md): written, and judged."""
import json
import pathlib
import tempfile

import numpy

from . import _zwang


def _plain(value):
    """Numbers and vectors as JSON has them: Python prints every double with the digits that bring it back."""
    if isinstance(value, numpy.ndarray):
        return value.tolist()
    return value.item() if isinstance(value, numpy.generic) else value


def write_answers(file, answers, *, solver, **header):
    """Writes one solver's answers to a pack as lines of JSON.

    answers: dicts with sha256, status, z and what else there is (lambda, certificate, iterations, seconds, residual);
    vectors may be lists or NumPy arrays. header: version, settings, machine, tolerance.
    """
    with open(file, "w", encoding="utf-8") as out:
        for line in [{"zwang_answers": 1, "solver": solver, **header}, *answers]:
            print(json.dumps({key: _plain(value) for key, value in line.items()}), file=out)


def read_npz(file):
    """The answers of a .npz as (header, answers), as write_answers takes them. It holds solver, other keys of the header,
    and of each answer SHA256/status, SHA256/z and so on: numpy.savez(file, solver="mine", **{sha + "/z": z, ...}).
    Raises BadFile."""
    header, answers = {}, {}
    try:
        with numpy.load(file, allow_pickle=False) as arrays:
            for name in arrays.files:
                sha256, _, key = name.rpartition("/")
                value = arrays[name]
                place = answers.setdefault(sha256, {"sha256": sha256}) if sha256 else header
                place[key] = value.item() if value.ndim == 0 else value
    except OSError as bad:
        raise _zwang.BadFile(f"{file}: cannot be read: {bad.strerror or bad}") from None
    except Exception as bad:  # NumPy says what is wrong with the archive in many ways
        raise _zwang.BadFile(f"{file}: expected an archive of numpy.savez: {' '.join(str(bad).split())}") from None
    if not isinstance(header.get("solver"), str):
        raise _zwang.BadFile(f"{file}: solver: expected a name")
    return header, list(answers.values())


def judge_pack(pack, *answers, out=None):
    """Judges answers to a pack as `zwang judge` does; returns one dict an answer with the keys of results.jsonl
    (docs/formats.md): solver, problem, claimed, verified, z_error, z_bound, primal, worst_row, ...

    pack: its folder. answers: files, lines of JSON or .npz, one a solver. out: a new folder that keeps the judgement for
    `zwang report`. Raises BadFile with file, line and what was expected.
    """
    with tempfile.TemporaryDirectory() as scratch:
        files = []
        for file in map(pathlib.Path, answers):
            if file.suffix == ".npz":
                header, records = read_npz(file)
                file = pathlib.Path(scratch) / (file.stem + ".jsonl")
                write_answers(file, records, **header)
            files.append(file)
        folder = pathlib.Path(out) if out is not None else pathlib.Path(scratch) / "run"
        _zwang.judge_pack(pathlib.Path(pack), files, folder)
        with open(folder / "results.jsonl", encoding="utf-8") as lines:
            return [json.loads(line) for line in lines]
