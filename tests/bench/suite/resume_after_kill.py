"""kill -9 in mid-suite, then --resume: no finished line lost, none repeated. Ctrl-C: says how to go on.

Usage: resume_after_kill.py PROGRAM
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

program = os.path.abspath(sys.argv[1])
BENCH = [program, "bench", "--scenes", "tower(boxes=1..12)", "--solvers", "pgs,apgd", "--tolerances", "1e-3,1e-6",
         "--repetitions", "20", "--out", "run"]
RUNS = 12 * 2 * 2


def lines():
    try:
        with open("run/results.jsonl") as file:
            return [line for line in file.read().split("\n") if line]
    except FileNotFoundError:
        return []


def start_and_stop(command, after, how):
    """Runs the command until that many lines are there, then sends it the signal."""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.time() + 60
    while len(lines()) < after and process.poll() is None and time.time() < deadline:
        time.sleep(0.002)
    process.send_signal(how)
    out, _ = process.communicate(timeout=60)
    return process.returncode, out


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    start_and_stop(BENCH, 4, signal.SIGKILL)
    killed = lines()
    assert 4 <= len(killed) < RUNS, f"killed too late to mean anything: {len(killed)} lines"

    resume = [program, "bench", "--resume", "run"]
    code, out = start_and_stop(resume, len(killed) + 4, signal.SIGINT)
    assert code == 130, (code, out)
    assert "nothing lost. Go on with: ./zwang bench --resume run" in out, out
    stopped = lines()
    assert f"Stopped after {len(stopped)} of {RUNS} runs" in out, out
    with open("run/run.json") as file:
        assert json.load(file)["finished"] is None

    # A line that the kill tore.
    with open("run/results.jsonl", "a") as file:
        file.write(killed[0][:100])
    done = subprocess.run(resume, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    final = lines()
    assert final[:len(stopped)] == stopped, "a finished line was touched"
    names = [(r["problem_file"], r["solver"], r["tolerance"]) for r in map(json.loads, final)]
    assert len(names) == len(set(names)) == RUNS, f"{len(names)} lines, {len(set(names))} of them different"
    os.chdir("/")
