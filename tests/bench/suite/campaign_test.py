"""A campaign of four tasks equals one uninterrupted run, in its columns that do not depend on the clock and in order.

Usage: campaign_test.py PROGRAM ENGINE     exit code 77: the engine is not installed
"""
import fcntl
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from campaign_support import assert_equal, run, suite

program, engine = os.path.abspath(sys.argv[1]), sys.argv[2]
if engine == "parallel" and not shutil.which("parallel"):
    print("skipped: GNU parallel is not installed")
    sys.exit(77)


def started(campaign):
    try:
        with open(f"{campaign}/campaign.json") as file:
            return bool(json.load(file)["started"])
    except FileNotFoundError:
        return False


def catches(process, number):
    """Whether a process has a handler of that signal."""
    with open(f"/proc/{process}/status") as file:
        return int(next(line for line in file if line.startswith("SigCgt:")).split()[1], 16) >> (number - 1) & 1


with tempfile.TemporaryDirectory() as folder:
    os.environ["XDG_CACHE_HOME"] = folder
    folder = os.path.join(folder, "K ' {}")  # nothing in a path means anything
    os.mkdir(folder)
    os.chdir(folder)
    words = suite(8)
    run([program, "bench", *words, "--out", "whole"])
    campaign = [program, "campaign", "quick", "--engine", engine, "--tasks", "4", "--at-once", "2", "--out", "it"]
    out = run([*campaign, *words])
    assert "72 of 72 runs" in out and os.path.exists("it/result/report.html"), out
    assert_equal("whole", "it/result")

    # The parts are all that stands in parts/.
    parts = sorted(f"it/parts/{name}" for name in os.listdir("it/parts"))
    assert "0 of 72 runs are missing" in run([program, "bench", "--missing", *parts]), parts

    # More tasks than problems: some have nothing to do, and say nothing of it.
    out = run([program, "campaign", "quick", "--engine", engine, "--tasks", "5", "--out", "many", "--scenes", "tower(boxes=1..4)", *words[2:]])
    assert "24 of 24 runs" in out and sorted(os.listdir("many/parts")) == list("01234"), out

    # Nothing is missing: coming back starts nothing and joins again.
    before = os.path.getmtime("it/parts/0/results.jsonl")
    run([program, "campaign", "--resume", "it"])
    assert os.path.getmtime("it/parts/0/results.jsonl") == before
    assert_equal("whole", "it/result")

    # A lost part and a damaged line are made again, and only they.
    shutil.rmtree("it/parts/1")
    with open("it/parts/2/results.jsonl", "r+b") as file:
        text = file.read()
        file.seek(text.index(b'"z_error":', 300) + 11)
        file.write(b"x")
    kept = os.path.getmtime("it/parts/0/results.jsonl")
    run([program, "campaign", "--resume", "it"])
    assert os.path.getmtime("it/parts/0/results.jsonl") == kept, "a complete part ran again"
    assert_equal("whole", "it/result")

    # Ctrl-C leaves the tasks running and says how to come back.
    again = [program, "campaign", "--engine", engine, "--tasks", "4", "--at-once", "2", "--out", "left", *words]
    process = subprocess.Popen(again, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not started("left"):
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    said, _ = process.communicate(timeout=60)
    if process.returncode == 130:
        assert "Come back with: ./zwang campaign --resume" in said, said
        run([program, "campaign", "--resume", "left"])
    assert_equal("whole", "left/result")

    # Where nothing runs, Ctrl-C says so, whenever it comes, and the result that was there stays.
    for wait in (0, 0.3, 0.6, 0.9, 1.2):
        process = subprocess.Popen([program, "campaign", "--resume", "it"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   start_new_session=True)
        while process.poll() is None and not catches(process.pid, signal.SIGTERM):
            time.sleep(0.01)
        time.sleep(wait)
        os.killpg(process.pid, signal.SIGINT)
        said, error = process.communicate(timeout=60)
        assert "Traceback" not in error and "to end them" not in said, (said, error)
        assert process.returncode != 130 or not said or "Stopped; no task runs. Come back with: ./zwang campaign --resume" in said, said
        assert_equal("whole", "it/result")
        assert os.path.exists("it/result/report.html") and not os.path.exists("it/result.before"), wait

    # Problems of a relative path are found wherever one comes back from.
    os.makedirs("files")
    for k in (1, 2):
        run([program, "export", "tower", f"--boxes={k}", "--out", f"files/{k}.h5"])
    few = ["--problems", "files", "--solvers", "nnls", "--tolerances", "1e-3", "--accuracy"]
    run([program, "campaign", "--engine", engine, "--tasks", "2", "--out", "near", *few])
    shutil.rmtree("near/parts/1")
    os.chdir("files")
    assert "2 of 2 runs" in run([program, "campaign", "--resume", "../near"])
    os.chdir("..")

    # Wrong use costs one line, and so does a damaged record.
    with open("it/campaign.json") as file:
        record = json.load(file)
    for name, change in (("lacks", {"tasks": None}), ("other", {"engine": "slrm"}), ("text", {"started": "17"})):
        os.makedirs(name)
        with open(f"{name}/campaign.json", "w") as file:
            json.dump({key: value for key, value in {**record, **change}.items() if value is not None}, file)
    for wrong in (["campaign", "quick", "--engine", "slrm", "--out", "x"], ["campaign", "quick"], ["campaign", "speed", "--out", "x"],
                  ["campaign", "quick", "--out", "x", "--solver", "nnls"], ["campaign", "--resume", "whole"],
                  *(["campaign", "--resume", name] for name in ("lacks", "other", "text"))):
        done = subprocess.run([program, *wrong], capture_output=True, text=True, timeout=60)
        assert done.returncode in (2, 3) and done.stderr.count("\n") == 1, (wrong, done)
        assert not os.path.exists("x"), wrong

    # Of two at a time the second is refused.
    for held, second in (("it/logs/campaign.lock", ["campaign", "--resume", "it"]), ("it/parts/0", ["bench", "--resume", "it/parts/0"])):
        folder = os.open(held, os.O_RDONLY)
        fcntl.flock(folder, fcntl.LOCK_EX)
        done = subprocess.run([program, *second], capture_output=True, text=True, timeout=60)
        assert done.returncode == 2 and "another " in done.stderr and done.stderr.count("\n") == 1, done
        os.close(folder)
        run([program, *second])

    # An engine that is not there leaves no folder behind.
    for absent in (name for name, word in (("slurm", "sbatch"), ("parallel", "parallel")) if not shutil.which(word)):
        done = subprocess.run([program, "campaign", "--engine", absent, "--out", "x", *words], capture_output=True, text=True)
        assert done.returncode == 3 and "not installed" in done.stderr and not os.path.exists("x"), done
    os.chdir("/")
