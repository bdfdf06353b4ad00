#!/usr/bin/python3
"""Draws what a solver sees of each scene, and lists the scenes in docs/gallery.md: draw_patterns.py PROGRAM.

Each scene of `PROGRAM scenes` is exported at its default knobs; patterns/NAME.png shows which unknowns (across) each row of J
(down) moves. The part of gallery.md from "## Problems" on is written anew. Needs h5py and numpy.
"""
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import zlib

import h5py
import numpy as np

# Equality rows, inequality rows, tangent rows (core/problem/problem.h, Kind); white and the border.
palette = [(255, 255, 255), (11, 95, 165), (179, 38, 30), (217, 140, 20), (208, 215, 222)]
across, down = 240, 160  # largest picture, px


def png(image):
    """An indexed PNG of a matrix of palette entries."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    height, width = image.shape
    rows = b"".join(b"\0" + row.tobytes() for row in image.astype(np.uint8))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 3, 0, 0, 0))
            + chunk(b"PLTE", bytes(sum(palette, ()))) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def pattern(problem):
    """(unknowns, rows, picture) of a problem file's group: whole pixels an entry where there is room, else entries a pixel."""
    pointers, columns, kind = problem["J/p"][:], problem["J/i"][:], problem["kind"][:]
    n, m = len(problem["z_u"]), len(kind)
    side = min(across / n, down / m, 8)
    side = int(side) if side >= 1 else side
    image = np.zeros((max(1, round(m * side)), max(1, round(n * side))), int)
    for row in range(m):
        for column in columns[pointers[row]:pointers[row + 1]]:
            top, left = int(row * side), int(column * side)
            image[top:top + max(1, int(side)), left:left + max(1, int(side))] = 1 + kind[row]
    return n, m, np.pad(image, 1, constant_values=4)


root = pathlib.Path(__file__).resolve().parents[2]
program = os.path.abspath(sys.argv[1])
pictures = root / "docs/figures/patterns"
pictures.mkdir(exist_ok=True)
listed = subprocess.run([program, "scenes"], check=True, capture_output=True, text=True).stdout
text = []
with tempfile.TemporaryDirectory() as folder:
    for line in listed.splitlines():
        if found := re.fullmatch(r"  (\w+) +(.+)", line):
            name, what = found.groups()
            subprocess.run([program, "export", name, "--out", "problem.h5"], check=True, cwd=folder, stdout=subprocess.DEVNULL)
            with h5py.File(folder + "/problem.h5") as file:
                n, m, image = pattern(file["zwang"])
            (pictures / f"{name}.png").write_bytes(png(image))
            text.append(f"| `{name}` | ![{name}](figures/patterns/{name}.png) | {n:,} x {m:,} | {what} |")
        elif line and not line.startswith((" ", "./zwang")):
            text += ["", "### " + line, "", "| scene | J | unknowns x rows | what it is |", "|---|---|---|---|"]
page = root / "docs/gallery.md"
before, heading, rest = page.read_text().partition("## Problems\n")
page.write_text(before + heading + rest.partition("\n### ")[0].rstrip("\n") + "\n" + "\n".join(text) + "\n")
