"""Timing tasks: alone at a time and pinned, with the neutral kernel beside every sample; a campaign says on which machine.

Usage: timing_test.py PROGRAM
"""
import json
import os
import sys
import tempfile

from campaign_support import run

program = os.path.abspath(sys.argv[1])
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    run([program, "campaign", "quick", "--timing", "--tasks", "2", "--at-once", "2", "--out", "it", "--scenes", "random(n=12,m=6,seed=1..4)",
         "--solvers", "nnls,apgd", "--tolerances", "1e-6", "--repetitions", "5"])
    with open("it/job.sh") as file:
        script = file.read()
    assert "#SBATCH --exclusive" in script and "taskset -c" in script, script
    with open("it/campaign.json") as file:
        assert json.load(file)["at_once"] == 1
    lines = 0
    for k in range(2):
        with open(f"it/parts/{k}/results.jsonl") as file:
            for line in map(json.loads, file):
                lines += 1
                assert line["repetitions"] == 5 and line["solve_s"] > 0, line
                assert line["kernel_s"] and 1e-6 < line["kernel_s"] < 1, line
                assert line["machine"], line
    assert lines == 8, lines
    os.chdir("/")
