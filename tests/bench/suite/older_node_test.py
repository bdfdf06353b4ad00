"""A node without an instruction set of the build says so in one line.

Usage: older_node_test.py PROGRAM     exit code 77: no qemu-x86_64, or the program was built for every x86-64
"""
import shutil
import subprocess
import sys

if not shutil.which("qemu-x86_64"):
    print("skipped: qemu-x86_64 is not installed (Debian: apt install qemu-user)")
    sys.exit(77)
done = subprocess.run(["qemu-x86_64", "-cpu", "qemu64", sys.argv[1], "solvers"], capture_output=True, text=True, timeout=120)
if done.returncode == 0:
    print("skipped: built for every x86-64")
    sys.exit(77)
assert done.returncode == 3 and done.stdout == "" and done.stderr.count("\n") == 1, done
assert "This program was built for " in done.stderr and "which this CPU lacks" in done.stderr, done
