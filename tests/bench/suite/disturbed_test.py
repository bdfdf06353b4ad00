"""A campaign of 64 tasks: tasks killed, a part lost, under Slurm (a real slurmctld and slurmd on loopback) the controller
restarted; the joined result equals one uninterrupted run, and only what had no valid record ran again.

Usage: disturbed_test.py PROGRAM ENGINE     exit code 77: the engine is not installed
"""
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from campaign_support import assert_equal, run, suite
from slurm_support import Slurm, adopt_orphans, kill_descendants

program, engine = os.path.abspath(sys.argv[1]), sys.argv[2]
os.environ["PATH"] += ":/usr/sbin"
needs = {"slurm": ("slurmctld", "slurmd", "sbatch", "squeue"), "parallel": ("parallel",), "local": ()}[engine]
if not all(shutil.which(name) for name in needs):
    print(f"skipped: {engine} is not installed (Debian: apt install {'slurm-wlm' if engine == 'slurm' else engine})")
    sys.exit(77)


def tasks_running(folder):
    """Process ids of the tasks' programs."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/cmdline", "rb") as file:
                words = file.read().decode(errors="replace").split("\0")
        except OSError:
            continue
        if words[0] in (program, program + "-all") and any(word.startswith(f"{folder}/it/parts/") for word in words):
            found.append(int(pid))
    return found


def parts_with_results():
    return [k for k in range(64) if os.path.exists(f"it/parts/{k}/results.jsonl") and os.path.getsize(f"it/parts/{k}/results.jsonl")]


adopt_orphans()
folder = os.path.realpath(tempfile.mkdtemp(prefix="zwang-disturbed-"))
os.chdir(folder)
os.environ["XDG_CACHE_HOME"] = folder
words = suite(252)
try:
    slurm = Slurm(folder, 4) if engine == "slurm" else None
    run([program, "bench", *words, "--out", "whole"])
    campaign = subprocess.Popen([program, "campaign", "quick", "--engine", engine, "--tasks", "64", "--at-once", "4", "--out", "it", *words],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    chance = random.Random(1)
    killed = restarted = lost = 0
    deadline = time.time() + 800
    while campaign.poll() is None and time.time() < deadline:
        running = tasks_running(folder)
        done = parts_with_results()
        if running and killed < 12:
            try:
                os.kill(chance.choice(running), signal.SIGKILL)
                killed += 1
            except ProcessLookupError:
                pass
        if slurm and not restarted and len(done) >= 8:
            slurm.restart_controller()
            restarted = 1
        if not lost and len(done) >= 16:
            shutil.rmtree(f"it/parts/{done[0]}", ignore_errors=True)
            lost = 1
        time.sleep(chance.uniform(0.05, 0.4 if slurm else 0.1))
    assert campaign.poll() is not None, f"{len(parts_with_results())} of 64 tasks after 800 s"
    said = campaign.communicate()[0]
    assert campaign.returncode == 0, said
    assert killed >= 8 and restarted == (slurm is not None) and lost, (killed, restarted, lost)
    assert "1,536 of 1,536 runs" in said, said
    assert_equal("whole", "it/result")
    # No run was made twice: what had a valid record did not run again.
    lines = 0
    for k in range(64):
        with open(f"it/parts/{k}/results.jsonl") as file:
            lines += sum(1 for _ in file)
    assert lines == 1536, lines
    if engine == "parallel":
        with open("it/joblog.txt") as file:
            assert len(file.readlines()) > 1
    print(f"{killed} tasks killed, {restarted} times the controller restarted, one part lost: equal")
finally:
    kill_descendants()
    os.chdir("/")
    shutil.rmtree(folder, ignore_errors=True)
