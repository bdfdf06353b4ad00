"""What the tests of campaigns share: a small suite, the uninterrupted run it is compared with, and how two are compared."""
import json
import os
import subprocess

# Columns that depend on the clock or the machine (docs/formats.md).
CLOCK = ("setup_s", "solve_s", "solve_s_q1", "solve_s_q3", "prepare_s", "kernel_s", "allocations", "repetitions", "machine", "check")


def suite(problems):
    return ["--scenes", f"random(n=12,m=6,seed=1..{problems}),tower(boxes=1..4)", "--solvers", "pgs,apgd,nnls",
            "--tolerances", "1e-3,1e-6", "--accuracy"]


def run(command, expect=0):
    done = subprocess.run(command, capture_output=True, text=True, timeout=900)
    assert done.returncode == expect, f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


def without_clock(folder):
    lines = []
    with open(os.path.join(folder, "results.jsonl")) as file:
        for text in file:
            line = json.loads(text)
            if line["claimed"] == "time limit":
                lines.append((line["cell"], "time limit"))
            else:
                lines.append({key: value for key, value in line.items() if key not in CLOCK})
    return lines


def assert_equal(a, b):
    first, second = without_clock(a), without_clock(b)
    assert len(first) == len(second), f"{a} has {len(first)} runs, {b} has {len(second)}"
    for left, right in zip(first, second):
        assert left == right, f"{a}: {left}\n{b}: {right}"
