"""`./zwang merge` and `./zwang bench --missing`: parts of a suite joined into one run; which of its runs are not there. docs/campaigns.md.

The program holds this text (held.py), gives it the words or --missing DIR..., and is asked whether stored problems are what
their hash says.
"""
import argparse
import array
import hashlib
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
import zlib

WRONG_USE, BAD_FILE = 2, 3
CONDITIONS = ("zwang", "commit", "dirty", "compiler", "flags", "build_type", "libraries")
RECORDED = "recorded:"  # and a name, in place of a solver: an answer that came with its problem, judged, and no run
# Columns that depend on the clock or the machine (docs/formats.md).
CLOCK = {"setup_s", "solve_s", "solve_s_q1", "solve_s_q3", "prepare_s", "kernel_s", "allocations", "repetitions", "machine", "check"}
OF_RUNS = ("run.json", "results.jsonl", "frames.h5", "collision.json")  # a folder with one of these holds a run
SEAL = len(',"check":"01234567"}')
MOST_REPORTED = 100  # disagreements


def fail(line, code=BAD_FILE):
    print(line, file=sys.stderr)
    sys.exit(code)


def dump(value):
    return json.dumps(value, separators=(",", ":"), ensure_ascii=False)


def read_record(directory):
    """DIR/run.json."""
    file = os.path.join(directory, "run.json")
    try:
        with open(file, encoding="utf-8") as text:
            record = json.load(text)
    except OSError:
        fail(f"{directory} holds no run: run.json is missing")
    except (ValueError, RecursionError):
        record = None
    if not isinstance(record, dict):
        fail(f"{file}: not a JSON object")
    return record


def first_difference(ours, theirs):
    """The first value that differs: "commit "a", not "b""."""
    return next((f"{name} {dump(theirs.get(name))}, not {dump(value)}" for name, value in ours.items() if theirs.get(name) != value), "")


def of(kind, values):
    if isinstance(values, list) and all(isinstance(value, kind) for value in values):
        return values
    raise ValueError(f"expected a list of {kind.__name__}")


class Cells:
    """The cells of a run, as its run.json states them: problem by problem, solver by solver, from loose to tight."""

    def __init__(self, directory):
        self.directory, record = directory, read_record(directory)
        try:
            self.conditions = {name: record[name] for name in CONDITIONS}
            self.options = dict(record["options"])
            part, _, parts = (self.options.pop("shard") or "0/1").partition("/")
            self.part, self.parts = int(part), int(parts)
            if not 0 <= self.part < self.parts:
                raise ValueError("shard")
            self.names, self.hashes = of(str, record["problem_names"]), of(str, record["problem_sha256"])
            self.solvers = of(str, [solver["name"] for solver in record["solvers"]])
            self.tolerances = of(float, record["tolerances"])
            if len(self.names) != len(self.hashes):
                raise ValueError("problem_names are not as many as problem_sha256")
        except KeyError as missing:
            fail(f"{directory}/run.json: no key {missing}")
        except (AttributeError, TypeError, ValueError) as wrong:
            fail(f"{directory}/run.json: {wrong}")
        self.commit = self.conditions["commit"]
        self.runs = len(self.solvers) * len(self.tolerances)  # of a problem
        self.size = len(self.hashes) * self.runs              # of all parts
        self.places = {pair: k for k, pair in enumerate((solver, tolerance) for solver in self.solvers for tolerance in self.tolerances)}

    def holds(self, cell):
        return cell // self.runs % self.parts == self.part

    def describe(self, cell):
        """ "problems/0007.h5 hand(contacts=4)   nnls @ 1e-06"."""
        problem, run = divmod(cell, self.runs)
        solver, tolerance = divmod(run, len(self.tolerances))
        return f"{file_of(problem)} {self.names[problem]}   {self.solvers[solver]} @ {self.tolerances[tolerance]:g}"

    def find(self, line):
        """The place of a stored line in this list; (problem, by whom) of a recorded answer; None where it is none of the list's."""
        problem, solver, tolerance = line.get("batch"), line.get("solver"), line.get("tolerance")
        if not isinstance(problem, int) or not isinstance(solver, str) or not isinstance(tolerance, float):
            return None
        run = solver if solver.startswith(RECORDED) else self.places.get((solver, tolerance))
        if not 0 <= problem < len(self.hashes) or run is None:
            return None
        key = f"{self.commit}\n{file_of(problem)}\n{self.hashes[problem]}\n{solver}\n{tolerance:.17g}"
        if hashlib.sha256(key.encode()).hexdigest()[:32] != line.get("cell"):
            return None
        return (problem, run) if isinstance(run, str) else problem * self.runs + run

    def refuse_unless_same(self, other):
        """Fails where the other is not the same suite under the same program. Machines and parts may differ."""
        difference = first_difference(self.conditions, other.conditions)
        pairs = list(zip(self.names, self.hashes)), list(zip(other.names, other.hashes))
        if not difference:
            difference = next((f"its {file_of(i)} is another problem of the name {a[0]}" for i, (a, b) in enumerate(zip(*pairs))
                               if a[0] == b[0] and a[1] != b[1]), "")
        difference = difference or first_difference(self.options, other.options)
        if not difference and self.hashes != other.hashes:
            same = next((i for i, (a, b) in enumerate(zip(self.hashes, other.hashes)) if a != b), min(map(len, pairs)))
            difference = f"its list of problems is another one from {file_of(same)} on"
        if difference:
            fail(f"{other.directory} does not mix with {self.directory}: {difference}")

    def lines(self, directory):
        """Of DIR/results.jsonl: what `find` says (of a damaged line: None), place and bytes of each line, and what it says."""
        start = 0
        try:
            with open(os.path.join(directory, "results.jsonl"), "rb") as file:
                for text in file:
                    line = opened(text)
                    yield self.find(line), start, text.rstrip(b"\n"), line
                    start += len(text)
        except FileNotFoundError:
            pass


def file_of(problem):
    return f"problems/{problem:04}.h5"


def opened(text):
    """What a line of results.jsonl says; {} where it is torn, or not what its check says."""
    body, seal = text[:-SEAL - 1], text[-SEAL - 1:]
    if not body or seal != b',"check":"%08x"}\n' % zlib.crc32(body):
        return {}
    try:
        line = json.loads(text)
    except (ValueError, RecursionError):
        return {}
    return line if isinstance(line, dict) else {}


def without_clock(line):
    """What two runs of one cell have to agree on; of one that a time limit ended only that."""
    return "time limit" if line.get("claimed") == "time limit" else {key: value for key, value in line.items() if key not in CLOCK}


def differing_column(a, b):
    if a.get("claimed") != b.get("claimed"):
        return "claimed"
    return next((name for name in sorted(a.keys() - CLOCK) if a[name] != b.get(name)), "its columns")


class Lines:
    """Lines of results.jsonl by their places, 16 bytes a run; the file read last stays open."""

    def __init__(self, parts, cells):
        self.parts, self.file, self.name = parts, None, ""
        self.part, self.length, self.start = (array.array(kind, bytes(array.array(kind).itemsize * cells)) for kind in "IIQ")

    def __contains__(self, cell):
        return self.length[cell] > 0

    def keep(self, cell, part, start, text):
        self.part[cell], self.length[cell], self.start[cell] = part, len(text), start

    def read(self, cell):
        return self.text(self.part[cell], self.start[cell], self.length[cell])

    def text(self, part, start, length):
        name = os.path.join(self.parts[part], "results.jsonl")
        if name != self.name:
            self.file, self.name = open(name, "rb"), name
        self.file.seek(start)
        text = self.file.read(length)
        if len(text) != length:
            fail(f"{name}: changed while read")
        return text


def append_others(parts, out):
    """Everything but results: phenomena and sequences, which one part has, and curves of all. Of a point that is there twice the first is
    kept; what is torn is left out."""
    def of_all(name):
        return [file for part in parts if os.path.exists(file := os.path.join(part, name))]
    for file in [*of_all("conformance.jsonl")[:1], *of_all("speed.jsonl")[:1]]:
        shutil.copy(file, out)
    files, there = of_all("traces.jsonl"), set()

    def is_new(line):
        try:
            point = json.loads(line)
            key = tuple(point[name] for name in ("problem", "family", "solver", "iteration"))
            return key not in there and not there.add(key)
        except (ValueError, KeyError, TypeError, RecursionError):
            return False
    if files:
        with open(os.path.join(out, "traces.jsonl"), "wb") as traces:
            for file in files:
                with open(file, "rb") as lines:
                    traces.writelines(line.rstrip(b"\n") + b"\n" for line in lines if is_new(line))


def copy_problems(program, cells, there, parts, out):
    """Each problem with a run from the first part that has an undamaged file. Returns the files that no part has."""
    bad = []
    with subprocess.Popen([program, "merge", ":sound"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as answering:
        def is_sound(file, sha256):
            answering.stdin.write(f"{file}\n{sha256}\n")
            answering.stdin.flush()
            return answering.stdout.readline() == "sound\n"
        for problem, sha256 in enumerate(cells.hashes):
            if any(cell in there for cell in range(problem * cells.runs, (problem + 1) * cells.runs)):
                files = (os.path.join(part, file_of(problem)) for part in parts)
                sound = next((file for file in files if os.path.exists(file) and is_sound(file, sha256)), None)
                if sound:
                    shutil.copy(sound, os.path.join(out, file_of(problem)))
                else:
                    bad.append(file_of(problem))
    return bad


def write_record(parts, out, command, cells, present, machines, disagreeing):
    """run.json of the whole: that of the first part, without its part."""
    records = [read_record(part) for part in parts]
    record, machines = records[0], dict(sorted(machines.items()))
    notes = list(dict.fromkeys(note for one in records for note in one.get("notes", [])))
    if machines:
        record["cpu"] = max(machines, key=machines.get)
    if len(machines) > 1:
        kinds = ";".join(f" {machine} ({runs:,})" for machine, runs in machines.items())
        notes.append(f"Runs were made on {len(machines)} kinds of machine, whose times do not compare:{kinds}.")
    finished = max((one["finished"] for one in records if isinstance(one.get("finished"), str)), default="")
    record.update(command=command, started=min(one.get("started", "") for one in records), finished=finished if present == cells.size else None,
                  problems=len(cells.hashes), runs=cells.size, machines=machines, notes=notes + disagreeing)
    record["options"]["shard"] = ""
    new = os.path.join(out, "run.json.new")
    with open(new, "w", encoding="utf-8") as file:
        file.write(json.dumps(record, indent=2, ensure_ascii=False) + "\n")
    os.replace(new, os.path.join(out, "run.json"))


def merge(program, parts, out, command):
    """One run, its lines in the order of the suite, whatever the parts' order was. Of a run that is there twice the first is kept."""
    if any(os.path.exists(os.path.join(out, name)) for name in OF_RUNS):
        fail(f"{out} holds a run already: choose another --out", WRONG_USE)
    cells = Cells(parts[0])
    for part in parts[1:]:
        cells.refuse_unless_same(Cells(part))
    os.makedirs(os.path.join(out, "problems"), exist_ok=True)
    there, machines, disagreeing, present, damaged, twice = Lines(parts, cells.size), {}, [], 0, 0, 0
    recorded = {}  # of a problem, by whom: the place of the answer
    for p, part in enumerate(parts):
        for cell, start, text, line in cells.lines(part):
            if cell is None:
                damaged += 1
            elif isinstance(cell, tuple):
                recorded.setdefault(cell[0], {}).setdefault(cell[1], (p, start, len(text)))
            elif cell not in there:
                there.keep(cell, p, start, text)
                present += 1
                machine = line.get("machine", "")
                machines[machine] = machines.get(machine, 0) + 1
            elif without_clock(line) == without_clock(first := json.loads(there.read(cell))):
                twice += 1
            elif len(disagreeing) < MOST_REPORTED:
                disagreeing.append(f"{cells.describe(cell)}: {parts[there.part[cell]]} and {part} disagree in {differing_column(first, line)}")
    with open(os.path.join(out, "results.jsonl"), "wb") as results:
        for problem in range(len(cells.hashes)):
            results.writelines(there.text(*place) + b"\n" for place in recorded.get(problem, {}).values())
            results.writelines(there.read(cell) + b"\n" for cell in range(problem * cells.runs, (problem + 1) * cells.runs) if cell in there)
    append_others(parts, out)
    bad = copy_problems(program, cells, there, parts, out)
    write_record(parts, out, command, cells, present, machines, disagreeing)

    judged = sum(map(len, recorded.values()))
    said = [f"{present:,} of {cells.size:,} runs" + (f", {twice:,} of them twice and alike" if twice else "") +
            (f", {judged:,} recorded answer{'s' if judged > 1 else ''}" if judged else "") +
            (f", {damaged:,} damaged lines left out" if damaged else "")]
    said += [*disagreeing, *(f"{file} is missing or damaged in every part: its runs are kept" for file in bad)]
    if len(machines) > 1:
        said += [f"{runs:,} runs on {machine}" for machine, runs in sorted(machines.items())]
    missing = cells.size - present
    if missing:
        said.append(("1 run is missing" if missing == 1 else f"{missing:,} runs are missing") +
                    f": ./zwang bench --missing {shlex.quote(out)} lists them")
    try:
        print("\n".join(said), flush=True)
    finally:  # the report is made though nobody reads on
        code = subprocess.run([program, "report", out]).returncode
    return code or (1 if disagreeing else 0)


def print_missing(directories):
    """The cells that none of the folders has; of parts, those that would be theirs."""
    cells, *others = parts = [Cells(directory) for directory in directories]
    for other in others:
        cells.refuse_unless_same(other)
    there = {cell for directory in directories for cell, *_ in cells.lines(directory)}
    wanted = [cell for cell in range(cells.size) if any(part.holds(cell) for part in parts)]
    missing = [cell for cell in wanted if cell not in there]
    for cell in missing:
        print(cells.describe(cell))
    print(f"{len(missing):,} of {len(wanted):,} runs are missing")
    return 1 if missing else 0


class Options(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message.removeprefix('argument ')} (./zwang merge --help)", WRONG_USE)


def main(program, *words):
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    if words[:1] == ("--missing",):
        return print_missing(words[1:])
    options = Options(
        prog="./zwang merge", usage="./zwang merge DIR... --out DIR", allow_abbrev=False,
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, max_help_position=34, width=100),
        description="Joins the parts of a suite into one run, and writes its report.",
        epilog="""Examples:
  ./zwang bench --suite quick --shard 0/2 --out part0
  ./zwang bench --suite quick --shard 1/2 --out part1
  ./zwang merge part0 part1 --out whole""")
    options.add_argument("DIR", nargs="+", help="folders of runs of one suite (--shard, or whole)")
    options.add_argument("--out", required=True, metavar="DIR", help="folder of the joined run")
    asked = options.parse_args(words)
    return merge(program, asked.DIR, asked.out, "./zwang merge " + shlex.join(words))
