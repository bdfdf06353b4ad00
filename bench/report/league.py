"""`./zwang league`: a page of solvers and their versions, from judgements of their answers. docs/league.md.

The program holds this text and runs it: main(PROGRAM, WORDS...). It puts what is found here into the page.
"""
import argparse
import collections
import json
import math
import os
import re
import signal
import subprocess
import sys

from results import WRONG_USE, BadFile, Run, credit_who_answered, each_line, fail, result_of


def read_entry(file):
    try:
        with open(file, encoding="utf-8") as text:
            entry = json.load(text)
    except FileNotFoundError:
        fail(f"{file}: no such file")
    except (ValueError, RecursionError):
        entry = None
    entry = {"reply": "", **entry} if isinstance(entry, dict) else {}
    keys = ("solver", "version", "url", "reply")
    for key in keys:
        if not isinstance(entry.get(key), str):
            fail(f'{file}: {key}: expected {{"solver": "...", "version": "...", "url": "...", "reply": "..."}}')
    if entry["url"] and not entry["url"].startswith(("https://", "http://")):
        fail(f"{file}: url: expected https://...")
    return {key: entry[key] for key in keys}


def judgement(directory, solver):
    """What the solver made of each problem, by its hash: [right, claimed falsely, proven error, seconds]; None where another one
    answered in its place. And the problems' names."""
    run = Run(directory)
    each_line(os.path.join(directory, "results.jsonl"), lambda row: run.results.append(result_of(row)))
    run.results = rows = [r for r in run.results if not r.is_recorded]
    [(usual, _)] = collections.Counter(r.machine for r in rows).most_common(1) or [("", 0)]
    names, asked = {r.problem_sha256: r.problem for r in rows}, any(r.solver == solver for r in rows)
    found = dict.fromkeys(names)
    credit_who_answered(run)
    for r in run.results:
        if r.solver == solver:
            error, seconds = (value if math.isfinite(value) else None for value in (r.error, r.solve_s if r.machine == usual else math.nan))
            found[r.problem_sha256] = [r.is_right, r.lies, error, seconds]
    if not asked and not any(found.values()):
        fail(f"{directory}: no answer of {solver}, which entry.json names")
    return {"machine": rows[-1].machine if rows else "", "rows": [found[sha256] for sha256 in sorted(found)]}, names


def natural(version):
    """0.9 before 0.10."""
    return [(0, int(part), part) if part.isdigit() else (1, 0, part) for part in re.split(r"(\d+)", version)]


def league(records):
    """What the page is made of: the same for the same records, in whatever order and wherever they lie."""
    packs, entries = {}, {}
    for record in records:
        entry = read_entry(os.path.join(record, "entry.json"))
        entry["packs"] = {}
        for pack in sorted(os.listdir(record)):
            place = os.path.join(record, pack)
            if not os.path.exists(os.path.join(place, "results.jsonl")):
                continue
            entry["packs"][pack], problems = judgement(place, entry["solver"])
            if packs.setdefault(pack, problems) != problems:
                fail(f"{place}: another pack than the {pack} of other records")
        if not entry["packs"]:
            fail(f"{record}: no judgement; expected what ./zwang judge PACK ANSWERS --out {os.path.join(record, 'PACK')} writes")
        if entries.setdefault((entry["solver"], entry["version"]), entry) is not entry:
            fail(f"{record}: a second record of {entry['solver']} {entry['version']}")
    return {"packs": {pack: [problems[sha256] for sha256 in sorted(problems)] for pack, problems in packs.items()},
            "entries": [entries[key] for key in sorted(entries, key=lambda key: (key[0], natural(key[1])))]}


class Options(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message.removeprefix('argument ')} (./zwang league --help)", WRONG_USE)


def write_page(program, words):
    options = Options(
        prog="./zwang league", usage="./zwang league RECORDS... --out DIR", allow_abbrev=False,
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, max_help_position=34, width=100),
        description="A page that sets solvers and their versions beside each other (docs/league.md):\nDIR/index.html.",
        epilog="""Examples:
  ./zwang league records/mine-1.0 records/mine-1.1 records/theirs-7 --out league""")
    options.add_argument("RECORDS", nargs="+", help="folders with entry.json and, in a folder a pack, what ./zwang judge wrote")
    options.add_argument("--out", required=True, metavar="DIR", help="folder of the page")
    asked = options.parse_args(words)
    data = json.dumps(league(asked.RECORDS), sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    page = subprocess.run([program, "report", ":page", "league"], input=data.encode(errors="replace"), stdout=subprocess.PIPE)
    if page.returncode:
        sys.exit(page.returncode)
    file = os.path.join(asked.out, "index.html")
    os.makedirs(asked.out, exist_ok=True)
    with open(file + ".new", "wb") as out:
        out.write(page.stdout)
    os.replace(file + ".new", file)
    print(f"League: {file}")


def main(program, *words):
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    try:
        write_page(program, words)
    except BadFile as broken:
        fail(str(broken))
    except OSError as broken:
        if not broken.filename:  # what is printed: held.py's
            raise
        fail(f"{broken.filename}: {broken.strerror}")
