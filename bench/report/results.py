"""The records of runs, as their folders hold them (docs/formats.md)."""
import copy
import dataclasses
import functools
import json
import math
import os
import re
import shlex
import sys
import zlib

WRONG_USE, BAD_FILE = 2, 3
NAN = math.nan
LARGE = 20000  # runs: beyond, a page holds no single ones, and of right ones only what charts need is kept

VERDICTS = ("solved", "near", "wrong", "infeasible, proven", "infeasible, claimed only", "undecided", "consistent", "rows off", "no answer",
            "timeout", "crashed", "bad input", "unsupported")
RIGHT = ("solved", "infeasible, proven")
OPEN = ("undecided", "consistent", "rows off")  # proven neither right nor wrong
BLANK = ("unsupported", "bad input")
SEAL = re.compile(rb',"check":"([0-9a-f]{8})"}$')

TEXTS = ("problem", "family", "knob", "problem_sha256", "problem_file", "law", "reference", "solver", "claimed", "verified", "promise",
         "worst_row", "handed_to", "machine")
NUMBERS = ("knob_value", "tolerance", "z_error", "z_bound", "primal", "self_bound", "coulomb_error", "solve_s", "solve_s_q1", "solve_s_q3",
           "prepare_s", "kernel_s", "allocations", "range_gap")
COUNTS = ("n", "m", "repetitions", "iterations")
TIMES = ("solve_s", "solve_s_q1", "solve_s_q3", "prepare_s", "kernel_s")
REQUIRED = ("problem", "solver", "tolerance", "claimed", "verified")


class BadFile(Exception):
    """What is wrong with a file, in one line."""


def fail(line, code=BAD_FILE):
    print(line, file=sys.stderr)
    sys.exit(code)


# Numbers for people.

def scientific(value, digits=1):
    """3.2e-9; 1e-8 with 0 digits; unknown for NaN."""
    if math.isnan(value):
        return "unknown"
    if abs(value) >= sys.float_info.max:
        return "infinite" if value > 0 else "-infinite"
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{mantissa}e{int(exponent)}" if int(exponent) else mantissa


def exactly(value):
    """1e-8, 2.5e-7: as few digits as tell it from every other double."""
    return scientific(value, next((d for d in range(17) if float(f"{value:.{d}e}") == value), 17))


def fixed(value, digits):
    return f"{value:.{digits}f}" if math.isfinite(value) else ""


def duration(seconds):
    """18 us, 1.9 ms, 2.4 s."""
    if not math.isfinite(seconds):
        return "unknown"
    size, unit = next((pair for pair in ((1, "s"), (1e-3, "ms"), (1e-6, "us")) if seconds >= 0.9995 * pair[0]), (1e-9, "ns"))
    value = seconds / size
    return f"{fixed(value, 1 if value < 9.95 else 0)} {unit}"


def counted(count, noun):
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def over(a, b):
    """a / b as doubles divide."""
    return a / b if b else NAN if a == 0 or math.isnan(a) else math.copysign(math.inf, a)


# Values of a line: what is not there, or of another type, is as if it were unknown.

def text_of(value, default=""):
    return default if value is None else value if isinstance(value, str) else json.dumps(value)


def number_of(value):
    if type(value) not in (int, float):
        return NAN
    if math.isfinite(value):
        return float(value)
    raise ValueError("a number out of range")


def count_of(value):
    return value if type(value) is int else 0


def family_of(family, problem):
    """Where a problem has none, problems of its name are one: a second of that name is "name (2)". "" would be all families."""
    return family or re.sub(r" \(\d+\)$", "", problem) or "unnamed"


class Result:
    """A line of results.jsonl: what one solver made of one problem at one tolerance."""

    __slots__ = (*TEXTS, *NUMBERS, *COUNTS, "feasible", "fallback", "worst_by_type", "replay", "error", "lies")

    def __init__(self, row):
        get = row.get
        for key in TEXTS:
            setattr(self, key, sys.intern(text_of(get(key))))
        for key in NUMBERS:
            setattr(self, key, number_of(get(key)))
        for key in COUNTS:
            setattr(self, key, count_of(get(key)))
        self.feasible = get("feasible") if isinstance(get("feasible"), bool) else None
        self.fallback = get("fallback") is True
        self.worst_by_type = [(text_of(worst.get("type")), number_of(worst.get("violation")), number_of(worst.get("relative")),
                               text_of(worst.get("unit")), text_of(worst.get("row"))) for worst in get("worst_by_type") or ()]
        self.replay = ""  # the command that repeats the run
        self.family = sys.intern(family_of(self.family, self.problem))
        # Coulomb's law may have several solutions, and the reference is one of them: what counts is the distance to the
        # nearest one that is proven, where the referee's verdict rests on it.
        if self.law == "coulomb" and (math.isfinite(self.z_bound) or self.verified != "wrong"):
            self.z_error = self.z_bound if self.verified in ("solved", "near", "wrong") else NAN
        # Against the reference, or the proven bound where there is none.
        self.error = self.z_bound if math.isnan(self.z_error) else self.z_error
        # Claims an answer, or that there is none, which the referee refutes, or promises an accuracy that it has not.
        self.lies = self.claimed in ("solved", "infeasible") and self.verified == "wrong" or self.promise == "broken"

    is_right = property(lambda self: self.verified in RIGHT)
    is_open = property(lambda self: self.verified in OPEN)
    is_blank = property(lambda self: self.verified in BLANK)
    is_recorded = property(lambda self: self.solver.startswith("recorded:"))
    identity = property(lambda self: self.problem_sha256 or self.problem)

    def keep_what_charts_need(self):
        self.problem_sha256 = ""
        if self.is_right:
            self.worst_row, self.worst_by_type = "", []


def result_of(row):
    for key in REQUIRED:
        if not isinstance(row, dict) or key not in row:
            raise BadFile(f'no result of this version of zwang: it has no "{key}"')
    if row["verified"] not in VERDICTS or not isinstance(row["claimed"], str):
        word = row["claimed"] if row["verified"] in VERDICTS else row["verified"]
        raise BadFile(f'no result of this version of zwang: "{text_of(word)}" is no word for a claim or a verdict')
    return Result(row)


def trace_point(row):
    """A line of traces.jsonl: the state after `iteration` steps, of a solve stopped there."""
    problem, family, solver = (text_of(row.get(key)) for key in ("problem", "family", "solver"))
    return {"problem": problem, "family": family_of(family, problem), "solver": solver, "iteration": count_of(row.get("iteration")),
            **{key: number_of(row.get(key)) for key in ("time_s", "z_error", "primal", "stationarity", "gap")}}


def phenomenon(row):
    """A line of conformance.jsonl: a solver on a phenomenon of friction with an exact answer."""
    return {**{key: text_of(row.get(key)) for key in ("solver", "law", "check", "expected")}, "off": number_of(row.get("off")),
            "passes": row.get("passes") is True, "applies": row.get("applies") is not False}


def refused(constant):
    raise ValueError(f"{constant} is no number of JSON")


DECODER = json.JSONDecoder(parse_constant=refused)


def each_line(file, take):
    """Hands over each line's object; returns what is not there. A last line without its newline may be bad (a killed run), and lines whose
    check fails are left out. Lines of programs before there were checks have none."""
    torn, checked, damaged, name = "", False, 0, os.path.basename(file)
    try:
        lines = open(file, "rb")
    except OSError:
        raise BadFile(f"cannot read {file}") from None
    with lines:
        for row, line in enumerate(lines, 1):
            whole, line = line.endswith(b"\n"), line.rstrip(b"\n")
            if not line:
                continue
            seal = SEAL.search(line)
            checked = checked or bool(seal)
            if checked and whole and not (seal and zlib.crc32(line[:seal.start()]) == int(seal[1], 16)):
                damaged += 1
                continue
            try:
                take(DECODER.decode(line.decode()))
            except (ValueError, TypeError, AttributeError, OverflowError, RecursionError, BadFile) as wrong:
                if whole:
                    raise BadFile(f"{file} line {row}: {wrong if isinstance(wrong, BadFile) else 'not what zwang writes'}") from None
                torn = f"The last line of {name} is torn (the run was killed) and left out."
    if damaged:
        torn = (f"{counted(damaged, 'damaged line')} of {name} {'is' if damaged == 1 else 'are'} left out; "
                "./zwang bench --resume makes such runs again.")
    return torn


def count_lines(file):
    try:
        with open(file, "rb") as bytes_of:
            return sum(part.count(b"\n") for part in iter(lambda: bytes_of.read(1 << 20), b""))
    except OSError:
        return 0


@dataclasses.dataclass
class Solver:
    name: str
    method: str = ""
    limits: str = ""
    foreign: bool = False
    exact: bool = False   # its answer does not depend on the tolerance
    style: str = ""       # the name that picks its colour: two runs of one solver share it; "": its own
    second: bool = False  # of the second of two runs


class Group:
    """The results of one problem, by solver."""

    def __init__(self, problem, family):
        self.problem, self.family, self.by_solver = problem, family, {}


@dataclasses.dataclass
class Run:
    """What the folder of a run holds."""
    directory: str = ""
    problem_class: str = ""  # of by_class(), where there are several
    label: str = ""          # names the run where two are compared
    suite: str = ""
    title: str = ""          # "standard suite", "your problems"
    conditions: list = dataclasses.field(default_factory=list)  # names and values
    notes: list = dataclasses.field(default_factory=list)
    judged_by: str = ""      # the command, where answers of files were judged: it repeats every line
    solvers: list = dataclasses.field(default_factory=list)     # in the order of the run
    results: list = dataclasses.field(default_factory=list)
    handed_over: dict = dataclasses.field(default_factory=dict)  # the problems by who handed over to whom; in `results` stands who answered
    recorded: list = dataclasses.field(default_factory=list)    # answers that came with the problems: judged, never timed, no solver's
    traces: list = dataclasses.field(default_factory=list)      # rows of traces.jsonl
    speed: list = dataclasses.field(default_factory=list)       # rows of speed.jsonl
    phenomena: list = dataclasses.field(default_factory=list)   # rows of conformance.jsonl
    torn: str = ""           # what is not there: a line cut off by a killed run, runs that are still to come
    reached: dict = dataclasses.field(init=False, default_factory=dict)  # times_to_error(), which are asked for again and again

    @property
    def is_large(self):
        return len(self.results) > LARGE

    @property
    def is_of_speed(self):
        return self.suite == "speed" or bool(self.of_kind("assembly"))

    def of_kind(self, kind):
        return [row for row in self.speed if row.get("kind") == kind]

    def names(self):
        return [solver.name for solver in self.solvers]

    def families(self):
        return list(dict.fromkeys(r.family for r in self.results))

    @functools.cached_property
    def groups(self):
        groups = {}
        for r in self.results:
            group = groups.get(r.problem)
            if group is None:
                group = groups[r.problem] = Group(r.problem, r.family)
            group.by_solver.setdefault(r.solver, []).append(r)
        return list(groups.values())

    def replay_of(self, result):
        return self.judged_by or result.replay or self.replay_command(result)

    def replay_command(self, result):
        file = os.path.join(self.directory, result.problem_file) if result.problem_file else result.problem
        return f"./zwang solve {shlex.quote(file)} --solver {shlex.quote(result.solver)} --tolerance {exactly(result.tolerance)}"


def take_conditions(about, run):
    """What run.json says of the run."""
    def add(name, value):
        if value:
            run.conditions.append((name, value))

    def text(key):
        return text_of(about.get(key))

    run.suite, run.title, commit = text("suite"), text("title"), text("commit")
    add("zwang", text("zwang"))
    add("commit", commit + (" with uncommitted changes" if about.get("dirty") and commit else ""))
    add("suite", run.suite if run.title in ("", run.suite + " suite") else "own scenes")
    add("command", text("command"))
    add("started", text("started"))
    goes_on = "finished" in about and about["finished"] is None
    add("finished", "not finished" if goes_on else text("finished"))
    if goes_on and about.get("runs", 0) > len(run.results):
        run.torn += f"{' ' if run.torn else ''}Not finished: {len(run.results):,} of {about['runs']:,} runs so far."
    add("seed", text("seed"))
    add("tolerances", ", ".join(exactly(t) if isinstance(t, (int, float)) else text_of(t) for t in about.get("tolerances", [])))
    for name in ("problems", "compiler", "flags"):
        add(name, text(name))
    for name, key in (("build type", "build_type"), ("CPU", "cpu"), ("cores", "cores")):
        add(name, text(key))
    for name, version in sorted(about.get("libraries", {}).items()):
        add(name, text_of(version))
    run.judged_by = text("command") if about.get("answers") else ""
    run.notes += [note.encode().decode() for note in about.get("notes", [])]
    for line in about.get("solvers", []):
        run.solvers.append(Solver(*(text_of(line.get(key)) for key in ("name", "method", "limits")),
                                  foreign=bool(line.get("foreign")), exact=bool(line.get("exact"))))


def keep_times_of_one_machine(run):
    """Times of several kinds of machine do not compare: those of the one with most runs stay, the others' become unknown."""
    runs = {}
    for r in run.results:
        runs[r.machine] = runs.get(r.machine, 0) + 1
    if len(runs) < 2:
        return
    machine = max(runs, key=runs.get)
    for r in run.results:
        if r.machine != machine:
            for key in TIMES:
                setattr(r, key, NAN)
    run.notes.append(f"Times are those of {machine} alone: {len(run.results) - runs[machine]} runs were made on other machines, and their "
                     "times do not compare.")


def credit_who_answered(run):
    """An answer counts for the solver that gave it, once: where that one was asked, too, its own run stands. A false claim is never left
    out. A trace that ends in another's answer is nobody's."""
    if not any(r.handed_to for r in run.results):
        return
    answered, kept = {(r.problem, r.law, r.tolerance, r.solver) for r in run.results if not r.handed_to}, []
    for r in run.results:
        if r.handed_to:
            run.handed_over.setdefault((r.solver, r.handed_to), set()).add(r.problem)
            r.replay = r.replay or run.replay_command(r)
            r.solver = r.handed_to
            key = (r.problem, r.law, r.tolerance, r.solver)
            if key in answered and not r.lies:
                continue
            answered.add(key)
        kept.append(r)
    run.results = kept
    nobodys = {(solver, problem) for (solver, _), problems in run.handed_over.items() for problem in problems}
    run.traces = [point for point in run.traces if (point["solver"], point["problem"]) not in nobodys]


def read_run(directory, large=LARGE):
    """The run of a folder. Of more than `large` results only what charts need is kept."""
    run = Run(directory=directory, label=os.path.basename(directory.rstrip("/")))
    file = os.path.join(directory, "results.jsonl")
    whole = count_lines(file) <= large

    def take(row):
        r = result_of(row)
        if r.is_recorded:
            run.recorded.append(r)
            return
        if whole:
            r.replay = run.replay_command(r)
        else:
            r.keep_what_charts_need()
        run.results.append(r)

    run.torn = each_line(file, take)
    for name, rows, read in (("traces", run.traces, trace_point), ("conformance", run.phenomena, phenomenon), ("speed", run.speed, dict)):
        file = os.path.join(directory, f"{name}.jsonl")
        if os.path.exists(file):
            run.torn = each_line(file, lambda row, rows=rows, read=read: rows.append(read(row))) or run.torn
    file = os.path.join(directory, "run.json")
    if os.path.exists(file):
        try:
            with open(file, encoding="utf-8") as text:
                take_conditions(json.load(text, parse_constant=refused), run)
        except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):
            raise BadFile(f"{file}: not what zwang writes") from None
    keep_times_of_one_machine(run)
    credit_who_answered(run)
    present = list(dict.fromkeys(r.solver for r in run.results))
    run.solvers = [solver for solver in run.solvers if solver.name in present]
    known = run.names()
    run.solvers += [Solver(name) for name in present if name not in known]
    return run


def class_of(result):
    return {"coulomb": "Coulomb", "convex": "convex cone"}.get(result.law, "QP")


def by_class(run):
    """The run's problems by class, those without any left out: QP (frictionless, or pyramids of friction), convex cone, Coulomb. Classes are
    never averaged: few solvers read all of them, and they cost differently. A solver is in the classes of which it reads a problem."""
    class_of_problem = {r.problem: class_of(r) for r in run.results}
    present = set(map(class_of, run.results))
    classes = []
    for name in ("QP", "convex cone", "Coulomb"):
        if name not in present:
            continue
        part = dataclasses.replace(run, problem_class=name if len(present) > 1 else "",
                                   results=[r for r in run.results if class_of(r) == name],
                                   recorded=[r for r in run.recorded if class_of(r) == name],
                                   traces=[p for p in run.traces if class_of_problem.get(p["problem"]) == name])
        readers = {r.solver for r in part.results if not r.is_blank}
        part.solvers = [solver for solver in run.solvers if solver.name in readers]
        classes.append(part)
    return classes or [run]


def merged(a, b):
    """One run that holds both: names of solvers in both get " @A" and " @B", problems with the same contents the name that they first had,
    others of that name a mark. Of such solvers the runs on problems that only one of the two has are left out: means over other problems
    compare nothing."""
    out, name_of, owner_of, left_out = Run(), {}, {}, set()
    common = {r.identity for r in a.results} & {r.identity for r in b.results}
    if a.results and b.results and not common:
        fail(f"{a.directory} and {b.directory} hold no problem in common (by contents, not by name): there is nothing to compare")
    for run, other, mark in ((a, b, "A"), (b, a, "B")):
        both = set(other.names())

        def shown(solver):
            return f"{solver} @{mark}" if solver in both else solver

        for s in run.solvers:
            out.solvers.append(dataclasses.replace(s, name=shown(s.name), style=s.name, second=mark == "B"))
        renamed = {}
        for r in map(copy.copy, run.results):
            if r.solver in both and r.identity not in common:
                left_out.add(r.identity)
                continue
            if r.identity not in name_of:
                taken = owner_of.setdefault(r.problem, r.identity) != r.identity
                name_of[r.identity] = f"{r.problem} @{mark}" if taken else r.problem
            renamed[r.problem] = r.problem = name_of[r.identity]
            r.solver = shown(r.solver)
            out.results.append(r)
        for pair, problems in run.handed_over.items():
            if stay := {renamed[problem] for problem in problems if problem in renamed}:
                out.handed_over[tuple(map(shown, pair))] = out.handed_over.get(tuple(map(shown, pair)), set()) | stay
        known = {(r.problem, r.solver) for r in out.recorded}
        for r in map(copy.copy, run.recorded):
            r.problem = renamed.get(r.problem, r.problem)
            if (r.problem, r.solver) not in known:
                known.add((r.problem, r.solver))
                out.recorded.append(r)
        out.traces += [{**p, "problem": renamed.get(p["problem"], p["problem"]), "solver": shown(p["solver"])} for p in run.traces]
        out.conditions += [(f"run {mark}", run.directory)] + [(f"{name} @{mark}", value) for name, value in run.conditions]
        out.notes += [note for note in run.notes if note not in out.notes]
        if run.torn:
            out.torn += f"{' ' if out.torn else ''}Run {mark}: {run.torn}"
    if left_out:
        out.notes.append(f"Of solvers in both runs, {counted(len(left_out), 'problem')} that only one of the two has: left out.")
    first = {}
    for s in out.solvers:
        first.setdefault(s.style, len(first))
    out.solvers.sort(key=lambda s: (first[s.style], s.second))  # a solver's two versions follow each other
    return out
