#!/usr/bin/python3
"""Questions of the paper (`./zwang experiment`), asked for a short time.

Usage: questions_test.py PROGRAM
"""
import csv
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

program = os.path.abspath(sys.argv[1])
failures = 0


def check(what, holds, detail=""):
    global failures
    if not holds:
        failures += 1
        print(f"FAILED: {what}\n{detail}")


def ask(*words):
    """Exit code, both outputs; of one that was answered the table's rows and the charts."""
    done = subprocess.run([program, "experiment", *words, "--out", "out"], capture_output=True, text=True, timeout=900)
    if done.returncode:
        return done, [], []
    with open(f"out/{words[0]}.csv", encoding="utf-8") as table, open(f"out/{words[0]}.json", encoding="utf-8") as found:
        return done, list(csv.reader(table)), json.load(found)["charts"]


def growth():
    """The problems of a simulated grasp go through the flow of the suites: timed, and verified by the referee."""
    done, table, charts = ask("growth", "--seconds", "1.6")
    check("growth is answered", done.returncode == 0 and len(table) > 5 and len(charts) == 1, done.stdout + done.stderr)
    points = charts[0]["points"]
    check("a point a row", len(points) == len(table) - 1, table)
    check("more contacts from row to row", all(a["x"] < b["x"] for a, b in zip(points, points[1:])), points)
    check("times", all(p["y"] > 0 for p in points), points)
    check("all are solved", all(row[3].endswith(" solved") and "," not in row[3] for row in table[1:]), table)
    check("a chart is drawn", os.path.getsize("out/growth.svg") > 1000)


def side_by_side():
    """Lazily completed rows are those of all at once, but in a few frames; other forms of one problem differ by rounding."""
    done, table, _ = ask("minimal", "--seconds", "1.3")
    check("minimal is answered", done.returncode == 0 and len(table) == 7, done.stdout + done.stderr)
    apart = {row[0]: [float(text.split()[0]) for text in row[5].split(", ")] for row in table[2:]}
    check("a frame is the same to rounding in both forms", apart["96 unknowns and 70 joint rows"][0] < 1e-9, apart)
    check("and by another solver", apart["nnls on 26 freedoms"][0] < 1e-9, apart)


def printed_step():
    """As printed the share of a step that is free counts twice: the gap never falls below half of what is left."""
    _, table, _ = ask("printed-step")
    once, twice = (float(cell.split()[0]) for cell in table[-1][1:])
    check("the printed step stops short of the wall", 0 < once < 0.11 and twice > 10 * once, table)


def a_push():
    _, table, charts = ask("rates")
    check("the box moves as far at every rate", all(abs(float(row[1].split()[0]) - 207.5) < 2 for row in table[1:]), table)
    check("a line a rate", {p["series"].removesuffix(", largest") for p in charts[0]["points"]} == {"250 Hz", "500 Hz", "1,000 Hz"}, charts)


def mistakes():
    for words, code, says in ((("fig88",), 2, "did you mean 'fig8'?"), ((), 2, "NAME"), (("fig8", "--seconds", "0"), 2, "0 should be a number above 0 s"),
                              (("growth", "--solver", "nnlss"), 2, "did you mean 'nnls'?"), (("growth", "--motion", "none.json"), 3, "none.json"),
                              (("growth", "--sekonds", "1"), 2, "--sekonds"), (("growth", "--out", "/proc/x"), 3, "/proc/x: ")):
        done = subprocess.run([program, "experiment", *words], capture_output=True, text=True, timeout=300)
        check(f"{words} costs one line", done.returncode == code and says in done.stderr and done.stderr.count("\n") == 1, done.stdout + done.stderr)


def interrupted():
    asking = subprocess.Popen([program, "experiment", "fig8", "--out", "out"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                              start_new_session=True)
    asking.stdout.readline()
    time.sleep(2)
    os.killpg(asking.pid, signal.SIGINT)  # as a terminal does
    said = asking.communicate(timeout=300)[0]
    check("an interrupted one says so", asking.returncode == 130 and "Stopped within 'fig8'; nothing was finished" in said, said)


def unread():
    """Where nobody reads on it ends as any other program does."""
    drawing = subprocess.Popen([program, "hand", "--matrix"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    drawing.stdout.close()
    check("an unread matrix ends quietly", drawing.stderr.read() == "" and drawing.wait() == -signal.SIGPIPE, drawing.returncode)
    for words in (("hand", "--matrix"), ("experiment", "--help"), ("experiment", "printed-step", "--out", "out"), ("campaign", "--help"), ("guard", "--help")):
        with open("/dev/full", "w", encoding="utf-8") as full:
            writing = subprocess.run(["env", "-u", "PYTHONUNBUFFERED", program, *words], stdout=full, stderr=subprocess.PIPE, text=True, timeout=300)
        check(f"a full disk costs {words} one line", writing.returncode == 3 and writing.stderr == "output: No space left on device\n", writing)


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    growth()
    side_by_side()
    printed_step()
    a_push()
    mistakes()
    interrupted()
    unread()
    os.chdir("/")
sys.exit(1 if failures else 0)
