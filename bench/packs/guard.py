"""`./zwang guard`: one solver's answers to a pack before and after a change. docs/guard.md.

Both sides are judged as `./zwang judge` does; this compares the judgements' rows (docs/formats.md). The program holds
this text (held.py).
"""
import argparse
import json
import math
import os
import signal
import statistics
import subprocess
import sys
from xml.sax.saxutils import quoteattr

WRONG_USE, BAD_FILE = 2, 3
# An error that grew more than this, from above rounding, is told by the problem's name. Harmless changes (other flags,
# another order of the rows) move errors of rounding by one or two digits.
TOLD = 1000
ROUNDING = 1e-13  # relative errors below are equal
MOVED = 2         # factor by which an error moves before it counts
DEARER = 1.25     # the same of iterations, which another order of the rows changes by a few
SIGMAS = 5        # standard deviations of a fair coin: beyond, more problems went one way than chance explains
SHOWN = 20        # problems that are printed by name

RIGHT = ("solved", "infeasible, proven")
# From best to worst, as the referee ranks them.
VERDICTS = (*RIGHT, "near", "rows off", "consistent", "undecided", "infeasible, claimed only", "no answer", "unsupported", "timeout",
            "crashed", "bad input", "wrong")
# What may have happened to a problem, with its colour on the map.
KINDS = {"newly wrong": "#b00020", "newly unsolved": "#d96c06", "wrong forces": "#8a5a00", "less accurate": "#f0a202",
         "better": "#2e7d32", "same": "#c8ccd0"}
NO_WORSE = ("better", "same")


def fail(line, code=WRONG_USE):
    print(line, file=sys.stderr)
    sys.exit(code)


def largest(values):
    """NaN stands for what is not known, and where it is alone."""
    return max((v for v in values if not math.isnan(v)), default=math.nan)


def number(row, key):
    value = row.get(key)
    return math.nan if value is None else float(value)


class Side:
    """A problem's rows in the runs of one side; the worst of them stands for all."""

    def __init__(self, rows):
        self.verdict = max((row["verified"] for row in rows), key=VERDICTS.index)
        self.tolerance = rows[0]["tolerance"]
        self.error = largest(self.proven(row) for row in rows)
        self.forces = largest(largest([number(row, "natural"), number(row, "stationarity"), ROUNDING]) for row in rows)
        self.seconds = [row["solve_s"] for row in rows if row["solve_s"] is not None]
        self.iterations = max(row["iterations"] for row in rows)
        self.claims = all(row["claimed"] in ("solved", "infeasible") for row in rows)
        self.handed = any(row.get("handed_to") for row in rows)
        self.right = self.verdict in RIGHT

    @staticmethod
    def proven(row):
        error = number(row, "z_bound" if row["z_error"] is None else "z_error")
        return max(error, ROUNDING) if math.isfinite(error) else math.nan

    def costs_more_than(self, other):
        return self.iterations > DEARER * other.iterations and not other.error > MOVED * self.error and self.handed == other.handed


def kind_of(before, after):
    if after.verdict == "wrong" != before.verdict:
        return "newly wrong"
    far = after.error > TOLD * before.error
    # An iterate at a limit of sweeps, of which nothing was said, is near or right by chance.
    if before.right and not after.right and (before.claims or after.verdict != "near" or far):
        return "newly unsolved"
    if before.right and far:
        return "less accurate"
    accepted = max(10 * after.tolerance, 1e-12)
    near = max(accepted, min(1000 * accepted, 1e-2))
    # Rounding of forces grows with them: 2^24 motions between rows nearly parallel.
    if before.right and after.forces > max(TOLD * before.forces, near):
        return "wrong forces"
    if after.right and (not before.right or before.error > TOLD * after.error):
        return "better"
    return "same"


class Drift:
    """How many problems, right before and after, moved one way and the other."""

    def __init__(self, what, worse, better):
        self.what, self.worse, self.better, self.up, self.down, self.note = what, worse, better, 0, 0, ""

    def count(self, up, down):
        self.up += bool(up)
        self.down += bool(down)

    def alarm(self):
        return self.up - self.down > SIGMAS * math.sqrt(self.up + self.down)

    def __str__(self):
        return (f"{self.what}{self.note}: {self.worse} on {self.up:,}, {self.better} on {self.down:,}" +
                ("   more than chance" if self.alarm() else ""))


class Guarded:
    """rows: of a judgement, in their order. runs: how many a side, before and after."""

    def __init__(self, rows, runs):
        self.changes = []  # (problem, kind, before, after)
        error, iterations = Drift("proven error", "larger", "smaller"), Drift("iterations", "more", "fewer")
        claims, handed = Drift("claims of an answer", "lost", "won"), Drift("answers of another solver", "more", "fewer")
        time, ratios = Drift("time", "slower", "faster"), []
        problems = {}
        for row in rows:
            sides = problems.setdefault(row["problem_sha256"], (row["problem"], [], []))
            sides[1 if row["solver"].startswith("before") else 2].append(row)
        for name, first, second in problems.values():
            a, b = Side(first), Side(second)
            self.changes.append((name, kind_of(a, b), a, b))
            if not (a.right and b.right):
                continue
            error.count(b.error > MOVED * a.error, a.error > MOVED * b.error)
            iterations.count(b.costs_more_than(a), a.costs_more_than(b))
            claims.count(a.claims and not b.claims, b.claims and not a.claims)
            handed.count(b.handed and not a.handed, a.handed and not b.handed)
            if min(runs) >= 2 and (len(a.seconds), len(b.seconds)) == runs:
                time.count(min(b.seconds) > max(a.seconds), max(b.seconds) < min(a.seconds))
                ratios.append(statistics.median(b.seconds) / statistics.median(a.seconds))
        if ratios:
            time.note = f" x {statistics.median(ratios):.2f}"
        self.timed = bool(ratios)
        self.drifts = [error, iterations, claims, handed, time]
        self.worse = sum(kind not in NO_WORSE for _, kind, _, _ in self.changes)
        self.alarm = next((drift for drift in self.drifts if drift.alarm()), None)

    def count(self, kind):
        return sum(kind == other for _, other, _, _ in self.changes)

    def is_worse(self):
        return self.worse > 0 or self.alarm is not None

    def describe(self):
        lines = [", ".join(f"{self.count(kind):,} {kind}" for kind in KINDS), *map(str, self.drifts)]
        if not self.timed:
            lines[-1] = "time: not compared, which takes two runs or more a side"
        told = [change for change in self.changes if change[1] not in NO_WORSE]
        for name, kind, a, b in told[:SHOWN]:
            was, now = (a.forces, b.forces) if kind == "wrong forces" else (a.error, b.error)
            lines.append(f"{kind}: {name}   {a.verdict} -> {b.verdict}, error {was:.1e} -> {now:.1e}")
        return "\n".join(lines + ["..."] * (len(told) > SHOWN))

    def map(self):
        """SVG: a square a problem, coloured by what happened to it."""
        columns, side = 32, 22
        height = -(-len(self.changes) // columns) * side + 44
        parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{columns * side + 20}" height="{height}" font-family="sans-serif" font-size="12">',
                 '<rect width="100%" height="100%" fill="#ffffff"/>']
        for k, (name, kind, a, b) in enumerate(self.changes):
            x, y = 10 + k % columns * side, 10 + k // columns * side
            title = quoteattr(f"{name}: {a.verdict} -> {b.verdict}")[1:-1]
            parts.append(f'<rect x="{x}" y="{y}" width="20" height="20" rx="3" fill="{KINDS[kind]}"><title>{title}</title></rect>')
        x = 10
        for kind, colour in reversed(KINDS.items()):
            label = f"{self.count(kind):,} {kind}"
            parts.append(f'<rect x="{x}" y="{height - 24}" width="12" height="12" fill="{colour}"/>'
                         f'<text x="{x + 16}" y="{height - 14}">{label}</text>')
            x += 30 + 6 * len(label)
        return "\n".join([*parts, "</svg>\n"])

    def badge(self):
        said = f"{self.worse:,} worse" if self.worse else f"{self.alarm.what}: {self.alarm.worse}" if self.alarm else "no worse"
        width, colour = 110 + 7 * len(said), KINDS["newly wrong" if self.is_worse() else "better"]
        return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="20" font-family="sans-serif" font-size="11">\n'
                f'<rect width="96" height="20" fill="#444444"/><rect x="96" width="{width - 96}" height="20" fill="{colour}"/>\n'
                f'<text x="8" y="14" fill="#ffffff">contact guard</text><text x="103" y="14" fill="#ffffff">{said}</text>\n</svg>\n')

    def junit(self):
        cases = [(name, "" if kind in NO_WORSE else f"{kind}: {a.verdict} -> {b.verdict}") for name, kind, a, b in self.changes]
        cases += [(f"{d.what} over the pack", f"{d.worse} on more problems than chance explains" if d.alarm() else "") for d in self.drifts]
        lines = [f"  <testcase classname=\"guard\" name={quoteattr(name)}" +
                 (f"><failure message={quoteattr(failure)}/></testcase>" if failure else "/>") for name, failure in cases]
        failures = sum(failure != "" for _, failure in cases)
        head = f'<testsuite name="zwang" tests="{len(cases)}" failures="{failures}" skipped="0">'
        return "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', head, *lines, "</testsuite>\n"])


def write(file, text):
    try:
        with open(file, "w", encoding="utf-8") as out:
            out.write(text)
    except OSError as bad:
        fail(f"{file}: {bad.strerror}", BAD_FILE)


class Options(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message} (./zwang guard --help)")


def main(program, *words):
    options = Options(
        prog="./zwang guard", usage="./zwang guard PACK BEFORE AFTER [OPTIONS]", allow_abbrev=False,
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, max_help_position=34, width=100),
        description="Compares one solver's answers to a pack before and after a change. Exit code 1: newly wrong or\n"
                    "unsolved, less accurate, wrong forces, or more work or time beyond chance (docs/guard.md).",
        epilog="""Examples:
  ./zwang guard guard before.jsonl after.jsonl --out guarded
  ./zwang guard guard b1.jsonl,b2.jsonl,b3.jsonl a1.jsonl,a2.jsonl,a3.jsonl      times, too""")
    options.add_argument("PACK", help="the pack's folder")
    options.add_argument("BEFORE", help="files of answers, with commas between repeated runs")
    options.add_argument("AFTER", help="likewise")
    options.add_argument("--out", metavar="DIR", help="folder for map.svg, badge.svg and both judgements; default: results/<date>-<time>")
    options.add_argument("--junit", metavar="FILE", help="also: a test case a problem")
    asked = options.parse_args(words)
    files = [[file for file in side.split(",") if file] for side in (asked.BEFORE, asked.AFTER)]
    if not all(files):
        options.error("guard takes a file or more a side")
    names = [word if len(side) == 1 else f"{word}-{k + 1}" for word, side in zip(("before", "after"), files) for k in range(len(side))]
    judge = [program, "judge", asked.PACK, *files[0], *files[1], "--names", ",".join(names), *(["--out", asked.out] if asked.out else [])]
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the program that judges, which says so and ends
    judged = subprocess.run(judge, stdout=subprocess.PIPE, text=True)
    said = judged.stdout.splitlines()
    if judged.returncode > 1:
        print(judged.stdout, end="")
        sys.exit(judged.returncode)
    report = said[-1].removeprefix("Report: ")
    for line in said:
        if ": no answer to " in line:
            print(line)
    folder = os.path.dirname(report)
    with open(os.path.join(folder, "results.jsonl"), encoding="utf-8") as lines:
        rows = [row for row in map(json.loads, lines) if row["solver"] in names]
    asked_for = {row["solver"]: row["tolerance"] for row in rows}
    for name, file in zip(names, files[0] + files[1]):
        if asked_for[name] != asked_for[names[0]]:
            fail(f"{file} was asked for another tolerance than {files[0][0]}")
    guarded = Guarded(rows, (len(files[0]), len(files[1])))
    print(guarded.describe())
    write(os.path.join(folder, "map.svg"), guarded.map())
    write(os.path.join(folder, "badge.svg"), guarded.badge())
    if asked.junit:
        write(asked.junit, guarded.junit())
    print(f"Map: {os.path.join(folder, 'map.svg')}   report: {report}")
    return 1 if guarded.is_worse() else 0
