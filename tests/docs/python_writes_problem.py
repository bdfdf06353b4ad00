#!/usr/bin/python3
"""Runs the script of docs/formats.md and reads what it wrote: python_writes_problem.py FORMATS.md CONVERT."""
import os
import re
import subprocess
import sys
import tempfile

import h5py

script = re.search(r"```python\n(.*?)```", open(sys.argv[1]).read(), re.S).group(1)
assert 5 <= len(script.splitlines()) <= 10, "the script has at most ten lines"
with tempfile.TemporaryDirectory() as folder:
    subprocess.run(["/usr/bin/python3", "-c", script], cwd=folder, check=True)
    (written,) = os.listdir(folder)
    subprocess.run([os.path.abspath(sys.argv[2]), written, "read.h5"], cwd=folder, check=True)
    with h5py.File(os.path.join(folder, "read.h5")) as file:
        problem = file["zwang"]
        assert problem["name"][0] == b"falling box" and problem["origin"][0] == b"contact/box on floor"
        assert problem["z_u"][:].tolist() == [0, 0.5, -9.81] and problem["kind"][:].tolist() == [1]
        assert problem["M/i"][:].tolist() == [0, 1, 2] and problem["M/x"][:].tolist() == [2, 2, 2]
        assert problem["J/p"][:].tolist() == [0, 1] and problem["J/i"][:].tolist() == [2]
