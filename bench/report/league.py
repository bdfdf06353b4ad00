"""`./zwang league`: a page of solvers and their versions, from judgements of their answers. docs/league.md.

The program holds this text and runs it: python3 -c TEXT PROGRAM WORDS... It puts what is found here into the page.
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
import zlib

WRONG_USE, BAD_FILE = 2, 3
RIGHT = ("solved", "infeasible, proven")
SEAL = re.compile(rb',"check":"([0-9a-f]{8})"}$')


def fail(line, code=BAD_FILE):
    print(line, file=sys.stderr)
    sys.exit(code)


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


def read_rows(file):
    """Rows of results.jsonl as docs/formats.md has them. A last line without its newline may be torn; lines whose check fails are
    left out, but those of programs before there were checks have none."""
    rows, checked = [], False
    with open(file, "rb") as lines:
        for number, line in enumerate(lines, 1):
            text = line.rstrip(b"\n")
            seal = SEAL.search(text)
            checked = checked or bool(seal)
            if not text or (checked and line.endswith(b"\n") and not (seal and zlib.crc32(text[:seal.start()]) == int(seal[1], 16))):
                continue
            try:
                row = json.loads(text)
                for key in ("problem", "problem_sha256", "solver", "claimed", "verified"):
                    if not isinstance(row[key], str):
                        raise ValueError(key)
                rows.append(row)
            except (ValueError, KeyError, TypeError, RecursionError):
                if line.endswith(b"\n"):
                    fail(f"{file} line {number}: not what zwang writes")
    return [row for row in rows if not row["solver"].startswith("recorded:")]


def number(row, key):
    value = row.get(key)
    return value if isinstance(value, (int, float)) and math.isfinite(value) else None


def error(row):
    """Proven, or against the reference. Coulomb's law may have several solutions: there what is proven counts."""
    bound, off = number(row, "z_bound"), number(row, "z_error")
    if row.get("law") == "coulomb" and (bound is not None or row["verified"] != "wrong"):
        off = bound if row["verified"] in ("solved", "near", "wrong") else None
    return bound if off is None else off


def judgement(directory, solver):
    """What the solver made of each problem, by its hash: [right, claimed falsely, proven error, seconds]; None where another one
    answered in its place. And the problems' names."""
    rows = read_rows(os.path.join(directory, "results.jsonl"))
    [(usual, _)] = collections.Counter(row.get("machine", "") for row in rows).most_common(1) or [("", 0)]
    found = dict.fromkeys(row["problem_sha256"] for row in rows)
    place = ("problem", "law", "tolerance")
    answered = {(row["solver"], *map(row.get, place)) for row in rows if not row.get("handed_to")}
    machine = ""
    for row in rows:
        who, lies = row.get("handed_to") or row["solver"], row["claimed"] in ("solved", "infeasible") and row["verified"] == "wrong"
        if row.get("handed_to"):  # counts for the solver that gave it, once; a false claim is never left out
            key = (who, *map(row.get, place))
            if key in answered and not lies:
                continue
            answered.add(key)
        machine = row.get("machine", "")
        if who == solver:
            seconds = number(row, "solve_s") if machine == usual else None
            found[row["problem_sha256"]] = [row["verified"] in RIGHT, lies, error(row), seconds]
    if not any(row["solver"] == solver for row in rows) and not any(found.values()):
        fail(f"{directory}: no answer of {solver}, which entry.json names")
    names = {row["problem_sha256"]: row["problem"] for row in rows}
    return {"machine": machine, "rows": [found[sha256] for sha256 in sorted(found)]}, names


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


def main(program, *words):
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
    page = subprocess.run([program, "league", ":page"], input=data.encode(errors="replace"), stdout=subprocess.PIPE)
    if page.returncode:
        sys.exit(page.returncode)
    file = os.path.join(asked.out, "index.html")
    os.makedirs(asked.out, exist_ok=True)
    with open(file + ".new", "wb") as out:
        out.write(page.stdout)
    os.replace(file + ".new", file)
    print(f"League: {file}")


signal.signal(signal.SIGINT, signal.SIG_DFL)
try:
    main(*sys.argv[1:])
except OSError as broken:
    fail(f"{broken.filename}: {broken.strerror}")
