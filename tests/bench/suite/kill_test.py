"""kill -9 at 100 random moments while records are written: none lost, none torn accepted.

Usage: kill_test.py PROGRAM
"""
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zlib

from campaign_support import assert_equal, run, suite

program = os.path.abspath(sys.argv[1])


def intact_cells():
    cells = set()
    try:
        with open("run/results.jsonl", "rb") as file:
            for line in file.read().split(b"\n")[:-1]:
                body, _, check = line.rpartition(b',"check":"')
                if check == b'%08x"}' % zlib.crc32(body):
                    cells.add(json.loads(line)["cell"])
    except FileNotFoundError:
        pass
    return cells


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    words = suite(60)
    run([program, "bench", *words, "--out", "whole"])
    chance = random.Random(1)
    before, in_middle, finished = set(), 0, 0
    for kill in range(100):
        begun = os.path.exists("run/run.json")
        command = [program, "bench", "--resume", "run"] if begun else [program, "bench", *words, "--out", "run"]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        # From the first new record on, else all kills would hit the start of the program.
        deadline = time.time() + 20
        size = os.path.getsize("run/results.jsonl") if os.path.exists("run/results.jsonl") else 0
        while process.poll() is None and time.time() < deadline:
            if os.path.exists("run/results.jsonl") and os.path.getsize("run/results.jsonl") > size:
                break
            time.sleep(0.0005)
        time.sleep(chance.uniform(0, 0.02))
        process.send_signal(signal.SIGKILL)
        process.wait()
        now = intact_cells()
        assert before <= now, f"{len(before - now)} records lost by kill {kill}"
        in_middle += len(now) < 384
        before = now
        if len(now) == 384:
            run([program, "bench", "--resume", "run"])
            assert_equal("whole", "run")
            finished += 1
            shutil.rmtree("run")
            before = set()
    assert in_middle > 50, f"only {in_middle} kills hit a run in its middle"
    if os.path.exists("run/run.json"):
        run([program, "bench", "--resume", "run"])
        assert_equal("whole", "run")
    os.chdir("/")
