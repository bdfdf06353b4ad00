"""A million synthetic records in 64 parts: joined and reported within 2 GiB and minutes; the page opens in 3 s. Prints the figures.

Usage: million_test.py PROGRAM PAGE_TEST     exit code 77: no Node for the page
"""
import glob
import os
import shutil
import subprocess
import sys
import tempfile
import time

import synthetic_run
from campaign_support import run

program, page_test = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])


def measured(command):
    """What it prints; its wall seconds, CPU seconds and peak memory [bytes]."""
    start = time.time()
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    assert os.waitstatus_to_exitcode(status) == 0, said
    cpu, memory = usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024
    print(f"{command[1]}: {time.time() - start:.0f} s, {cpu:.0f} s of CPU time, {memory / 2**30:.2f} GiB", flush=True)
    assert memory < 2 * 2**30, f"{command[1]}: {memory} bytes"
    return said, cpu


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    run([program, "bench", "--suite", "big", "--shard", "0/800", "--out", "small"])
    start = time.time()
    synthetic_run.write("small", 17858, 64, "parts")
    print(f"written: {time.time() - start:.0f} s")
    said, cpu = measured([program, "merge", *glob.glob("parts/*"), "--out", "all"])
    assert "1,000,048 of 1,000,048 runs" in said, said
    assert cpu < 600, f"{cpu} s of CPU time"
    shutil.rmtree("parts")
    _, cpu = measured([program, "report", "all"])
    assert cpu < 300, f"{cpu} s of CPU time"
    print(f"{os.path.getsize('all/results.jsonl') / 1000048:.0f} bytes a record")
    if not shutil.which("node"):
        print("skipped: no Node to open the page with")
        sys.exit(77)
    print(run(["node", page_test, "--measure", "all"]), end="")
    os.chdir("/")
