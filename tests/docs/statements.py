#!/usr/bin/python3
"""Checks what pages say of the program against it and its sources: statements.py ROOT PROGRAM.

The atlas' counts, the keys of summary.json and the datasets of frames.h5, a picture of every scene, and that every figure comes from
a commit.
"""
import json
import pathlib
import re
import subprocess
import sys

root, program = (pathlib.Path(name).resolve() for name in sys.argv[1:])
faults = []


def text(name):
    return (root / name).read_text()


def says(page, what):
    if what not in text(page):
        faults.append(f"{page}: does not say '{what}'")


# The stability atlas: a line of the table a point. Some scenes are of the family of another one.
families = {scene["name"]: scene.get("family") for scene in json.loads(text("bench/scenes/catalog.json"))}
points = [re.match(r"\w+", line.split("\t")[1])[0] for line in text("tests/data/atlas_points.tsv").splitlines()[1:]]
names = {families.get(scene) or scene for scene in points}
section = re.search(r"\n## With friction\n(.*?)\n## ", text("docs/stability.md"), re.S)[1]
with_friction = {name for name in names if re.search(rf"\b{name}\b", section)}
says("docs/stability.md", f"sweeps {len(names)} families of problems, {len(with_friction)} of them with friction")
says("docs/stability.md", f"all {len(points)} points")
says("docs/notes/stability.md", f"{len(points)} since")
rows = set(re.findall(r"^\| (\w+) \|", text("docs/stability.md"), re.M))
for name in sorted(names - with_friction - rows):
    faults.append(f"docs/stability.md: the table of break points has no row {name}")

# A run of the god hand: every key of its summary, every number of a frame.
page = "docs/god-hand/files.md"
keys = re.findall(r'^ {6}\{"(\w+)", ?', text("experiments/god_hand/run/summary.cpp"), re.M)
keys += re.findall(r'^ {6}\{"(\w+)",$', text("experiments/god_hand/run/summary.cpp"), re.M)
columns = re.findall(r'Column\{"(\w+)"', text("experiments/god_hand/measure/columns.cpp"))
for name in sorted(set(keys + columns)):
    says(page, f"`{name}`")
if len(set(keys)) < 35 or len(columns) < 25:
    faults.append(f"only {len(set(keys))} keys and {len(columns)} columns found in the sources")

# The gallery: every scene once, and pages that load in a moment.
gallery = text("docs/gallery.md")
listed = subprocess.run([program, "scenes"], check=True, capture_output=True, text=True).stdout
scenes = re.findall(r"^  (\w+) ", listed, re.M)
played = re.findall(r'^    \{"(\w+)", "', text("experiments/god_hand/scenes/scenes.cpp"), re.M)
for name in scenes + played:
    if f"/{name}.png)" not in gallery and f"/{name}.webp)" not in gallery:
        faults.append(f"docs/gallery.md: no picture of {name}")
if len(scenes) < 50 or len(played) < 11:
    faults.append(f"only {len(scenes)} and {len(played)} scenes found")
for most, files in ((600_000, [*(root / "docs/figures/scenes").iterdir(), *(root / "docs/figures/patterns").iterdir()]),
                    (1_000_000, [root / "docs/sample-report.html"])):
    if (size := sum(file.stat().st_size for file in files)) > most:
        faults.append(f"{files[0].relative_to(root)} and its like: {size:,} bytes, more than {most:,}")

for figure in (root / "docs").rglob("*.svg"):
    if re.search(r"zwang [0-9a-f]{12}, changed", figure.read_text()):
        faults.append(f"{figure.relative_to(root)}: drawn by changed sources")

print("\n".join(faults) or f"{len(names)} families, {len(points)} points, {len(set(keys + columns))} names as the pages say")
sys.exit(bool(faults))
