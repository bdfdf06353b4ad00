#!/usr/bin/env python3
"""The league of the solvers that are built here: their answers to packs, the judgements as records, the page.

    docs/league/own.py guard friction atlas --out league

PACK: a pack's name, or NAME=SCENES. A record that is there is not made again: so a stopped run goes on, and so one solver is made anew whose
folder was removed. DIR/records/SOLVER holds what docs/league.md asks of a record, DIR/index.html is the page.
"""
import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys

parser = argparse.ArgumentParser(description="Records and page of the solvers that are built here (docs/league.md).")
parser.add_argument("packs", nargs="+", metavar="PACK", help="guard, friction, atlas or another of ./zwang pack --help; or NAME=SCENES")
parser.add_argument("--out", required=True, metavar="DIR", type=pathlib.Path)
parser.add_argument("--solvers", metavar="NAMES", help="with commas between them; default: all of ./zwang solvers that are built")
parser.add_argument("--time-limit", metavar="S", default="10", help="CPU time of a problem; default: 10")
parser.add_argument("--program", metavar="FILE", default=str(pathlib.Path(__file__).resolve().parents[2] / "zwang"), help="default: ./zwang")
options = parser.parse_args()


def zwang(*words, codes=(0,)):
    done = subprocess.run([options.program, *map(str, words)], capture_output=True, text=True)
    if done.returncode not in codes:
        print(done.stderr, end="", file=sys.stderr)
        sys.exit(done.returncode)
    return done.stdout


def solvers():
    built = zwang("solvers").partition("Not built in")[0]
    return options.solvers.split(",") if options.solvers else re.findall(r"^  (\w+) ", built, re.M)


records = options.out / "records"
for word in options.packs:
    name, _, scenes = word.partition("=")
    pack = options.out / "packs" / name
    if not (pack / "pack.json").exists():
        zwang("pack", scenes or name, "--out", pack)
    for solver in solvers():
        record = records / solver / name
        if (record / "results.jsonl").exists():
            continue
        shutil.rmtree(record, ignore_errors=True)
        judged = record / "judged"
        record.mkdir(parents=True)
        answers = record / "answers.jsonl"
        zwang("solve-pack", pack, "--solver", solver, "--time-limit", options.time_limit, "--out", answers)
        print(f"{solver}, {name}: {zwang('judge', pack, answers, '--out', judged, codes=(0, 1)).splitlines()[-2]}", flush=True)
        with open(answers, encoding="utf-8") as lines:
            entry = {"solver": solver, "version": json.loads(next(lines))["version"], "url": "", "reply": ""}
        (records / solver / "entry.json").write_text(json.dumps(entry) + "\n", encoding="utf-8")
        (judged / "results.jsonl").rename(record / "results.jsonl")
        shutil.rmtree(judged)
print(zwang("league", *sorted(records.iterdir()), "--out", options.out), end="")
