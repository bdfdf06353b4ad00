#!/usr/bin/python3
"""bullet_test.py SOURCE_DIR PROGRAMS: Bullet through its adapter: what is known of it comes out, twice the same."""
import json
import pathlib
import subprocess
import sys
import tempfile

source, programs = sys.argv[1:]
with tempfile.TemporaryDirectory() as folder:
    done = subprocess.run([sys.executable, f"{source}/bench/engines/engines.py", "--programs", programs, "--engines", "bullet", "--twice",
                           "--phenomena", "free_fall,momentum,rolling,slide,stack_1,stack_1e6", "--out", folder], check=True, capture_output=True, text=True)
    numbers = json.loads((pathlib.Path(folder) / "results.json").read_text())
assert "The same numbers twice" in done.stdout, done.stdout
for setting, of in numbers["cells"]["bullet"].items():
    def off(phenomenon, step="1/240"):
        return abs(of[phenomenon][step]["off"])
    for step in numbers["steps"]:
        assert off("free_fall", step) < 1e-12 and off("momentum", step) < 1e-12 and off("rolling", step) < 1e-12, (setting, step)
    # Its projected Gauss-Seidel method carries a box, and does not carry a million times its weight.
    assert off("stack_1") < 1e-2 and off("stack_1e6") > 0.1, setting
assert abs(numbers["cells"]["bullet"]["default"]["slide"]["1/60"]["off"]) > 1e-2  # the corners come one by one
assert abs(numbers["cells"]["bullet"]["tuned"]["slide"]["1/60"]["off"]) < 1e-3
print(done.stdout)
