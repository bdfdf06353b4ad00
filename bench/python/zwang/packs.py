"""Answers to a pack of problems (docs/packs.md): written, and judged."""
import json
import pathlib
import re
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
    if not re.fullmatch(r"[\w.+-]+", solver, re.ASCII):
        raise ValueError(f"solver should have letters, digits and _ - + . alone: {solver!r}")
    lines = []
    for line in [{"zwang_answers": 1, "solver": solver, **header}, *answers]:
        for key, value in line.items():
            try:
                json.dumps(_plain(value), allow_nan=False)
            except ValueError:
                raise ValueError(f"{key} of {line.get('sha256', 'the head')} is not finite, which JSON does not have") from None
        lines.append(json.dumps({key: _plain(value) for key, value in line.items()}))
    pathlib.Path(file).write_text("".join(line + "\n" for line in lines), encoding="utf-8")


def judge_pack(pack, *answers, out=None):
    """Judges answers to a pack as `zwang judge` does; returns one dict an answer with the keys of results.jsonl
    (docs/formats.md): solver, problem, claimed, verified, z_error, z_bound, primal, worst_row, ...

    pack: its folder. answers: files, lines of JSON, .npz or HDF5, one a solver. out: a new folder that keeps the
    judgement for `zwang report`. Raises BadFile with file, place and what was expected.
    """
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(out) if out is not None else pathlib.Path(scratch) / "run"
        _zwang.judge_pack(pathlib.Path(pack), list(map(pathlib.Path, answers)), folder)
        with open(folder / "results.jsonl", encoding="utf-8") as lines:
            return [json.loads(line) for line in lines]
