"""The tables of a page, of .csv and of .tex files. tables.json has of each its columns, what its figures mean, and why there may be none."""
import json
import math

from aggregation import (HEADLINE, LEVELS, accuracy_matched, break_points, fit_power_law, geometric_mean, median, natural_shift, ratio_text,
                         scaling, shifted_geometric_means, tightest, time_to_error, times_to_error)
from held import files
from results import NAN, VERDICTS, Result, count_of, counted, duration, exactly, fixed, number_of, over, scientific, text_of

TEXTS = json.loads(files["tables.json"])


def cell(text, value=NAN, tone=""):
    """value: what .csv holds and sorting uses, none where the text is all there is. tone: "bad", "good", "warn" or ""."""
    made = {"text": text}
    if math.isfinite(value):
        made["value"] = value
    if tone:
        made["tone"] = tone
    return made


def count(n, tone=""):
    """Empty for 0."""
    return cell(str(n), n, tone) if n else cell("", 0)


def whole(n, tone=""):
    return cell(str(n), n, tone)


def part(n, of, tone=""):
    """ "3 of 5", of the value 3."""
    return cell(f"{n} of {of}", n, tone)


def number(value, digits=1):
    return cell(scientific(value, digits), value)


def rounded(value, digits):
    return cell(fixed(value, digits), value)


def time(seconds):
    return cell(duration(seconds), seconds)


def knob_text(value):
    """2^-27 for far powers of two, else 64 or 0.001."""
    if not math.isfinite(value):
        return ""
    mantissa, exponent = math.frexp(abs(value))
    if mantissa == 0.5 and not -2 <= exponent <= 10:
        return f"{'-' if value < 0 else ''}2^{exponent - 1}"
    return f"{value:.6g}"


def knob(value):
    return cell(knob_text(value), value)


def tone_of(bad, good):
    return "bad" if bad else "good" if good else ""


def error_cell(r):
    """The error the referee measured, or the bound where there is no reference."""
    if math.isfinite(r.z_error):
        return number(r.z_error)
    if math.isfinite(r.z_bound):
        return cell(f"<= {scientific(r.z_bound)}", r.z_bound)
    return cell("no z exists" if r.feasible is False else "no number" if r.reference else "no reference")


class Table:
    def __init__(self, name):
        self.id, self.note, self.columns, self.rows = name, "", [], []
        self.add_columns(*TEXTS[name]["columns"].split("; "))

    def add_columns(self, *titles):
        """ "#" before a title: a column of numbers."""
        self.columns += [{"name": title.removeprefix("#"), "numeric": title.startswith("#")} for title in titles]

    def add(self, solver, group, cells, command=""):
        """solver, group: what the chips and the family selector show and hide; "" stays. command: replays the row's run."""
        row = {"solver": solver, "group": group, "cells": [cell(c) if isinstance(c, str) else c for c in cells]}
        self.rows.append({**row, "command": command} if command else row)

    def explained(self, with_rows="rows"):
        """With the note of this name; "none" where there are no rows."""
        texts = TEXTS[self.id]
        self.note = texts[with_rows] if self.rows else texts.get("none", texts["rows"])
        return self

    def to_json(self, most_rows=None):
        rows, note = self.rows, self.note
        if most_rows is not None and len(rows) > most_rows:
            note += (f" The first {counted(most_rows, 'row')} of {counted(len(rows), 'row')}; ./zwang report --figures svg writes all to "
                     "tables/.")
            rows = rows[:most_rows]
        return {"note": note, "columns": self.columns, "rows": rows}


# What solvers claim, against what the referee finds.

def gravity(r):
    """Rejected claims, worst first: 0 false, 1 flagged as ill-conditioned but wrong, 2 infeasible without proof."""
    if r.lies:
        return 0
    if r.claimed == "solved, ill-conditioned" and r.verified == "wrong":
        return 1
    return 2 if r.verified == "infeasible, claimed only" else 3


def reason(r):
    if r.feasible is True and r.claimed == "infeasible":
        return "the rows are consistent"
    if r.claimed == "solved":
        if r.feasible is False:
            return "the rows are inconsistent"
        if not math.isfinite(r.primal):
            return "its z holds NaN or infinities"
    if math.isfinite(r.range_gap) and r.range_gap > 1e-12:
        return f"c leaves range(J): |J k - c|/|c| = {scientific(r.range_gap)}"
    if r.worst_row and math.isfinite(r.primal):
        return f"worst row {r.worst_row}, violation {scientific(r.primal)} of the scale"
    return ""


def claim_counts_table(run):
    """False claims, counted by solver."""
    table, found = Table("claim-counts"), {name: [0, [], 0, 0] for name in run.names()}
    for r in run.results:
        counts, kind = found.setdefault(r.solver, [0, [], 0, 0]), gravity(r)
        counts[0] += 1
        if kind == 0:
            counts[1].append(r)
        elif kind < 3:
            counts[1 + kind] += 1
    for solver in sorted(run.names(), key=lambda name: -len(found[name][1])):
        runs, lies, flagged, unproven = found[solver]
        if lies or flagged or unproven:
            worst = max(lies, key=lambda r: r.error if math.isfinite(r.error) else -1, default=None)
            table.add(solver, "", [solver, count(len(lies), "bad"), count(runs), count(len({r.problem for r in lies})),
                                   error_cell(worst) if worst else "", count(flagged, "warn"), count(unproven, "warn"),
                                   ", ".join(sorted({r.family for r in lies}))])
    return table.explained()


def claims_table(run):
    """Every claim the referee rejects, false ones first."""
    table, groups = Table("claims"), {}
    for place, r in enumerate(run.results):
        if gravity(r) > 2:
            continue
        group = groups.setdefault((r.solver, r.problem, r.claimed, r.verified), {"worst": r, "place": place, "tolerances": []})
        group["tolerances"].append(r.tolerance)
        if r.z_error > group["worst"].z_error:
            group["worst"], group["place"] = r, place

    def badness(group):
        """The worst kind first; within a kind answers where none exists, then by error, largest first."""
        r = group["worst"]
        return gravity(r), -r.z_error if math.isfinite(r.z_error) else -math.inf, group["place"]

    for group in sorted(groups.values(), key=badness):
        r, tolerances = group["worst"], group["tolerances"]
        low, high, tone = exactly(min(tolerances)), exactly(max(tolerances)), "bad" if r.lies else "warn"
        asked = low if len(set(tolerances)) == 1 else f"{high} to {low}"
        table.add(r.solver, r.family, [r.solver, r.problem, cell(asked, min(tolerances)), whole(len(tolerances)), cell(r.claimed, NAN, tone),
                                       cell(r.verified, NAN, tone), error_cell(r), reason(r)], run.replay_of(r))
    return table.explained("rows" if any(r.lies for r in run.results) else "no lies")


def recorded_table(run):
    """Answers that came with the problems."""
    table, groups = Table("recorded"), {}
    for r in run.recorded:
        groups.setdefault((r.family, r.solver), []).append(r)
    for (family, answer), answers in groups.items():
        errors = sorted(r.z_error for r in answers if math.isfinite(r.z_error))
        right, near, wrong = sum(r.is_right for r in answers), *(sum(r.verified == v for r in answers) for v in ("near", "wrong"))
        table.add("", family, [family, answer, *map(whole, (len(answers), right, near, wrong, len(answers) - right - near - wrong)),
                               *map(number, (errors[0] if errors else NAN, median(errors), errors[-1] if errors else NAN))])
    table.explained()
    table.note = table.note.replace("@", exactly(run.recorded[0].tolerance) if run.recorded else "", 1)
    return table


def verdict_table(run):
    """Counts of claimed against verified, per solver."""
    table, found = Table("verdicts"), {}
    for r in run.results:
        runs = found.setdefault((r.solver, r.claimed), {"fallbacks": 0})
        runs[r.verified] = runs.get(r.verified, 0) + 1
        runs["fallbacks"] += r.fallback
    present = {verdict for runs in found.values() for verdict in runs}
    verdicts = [verdict for verdict in VERDICTS if verdict in present]
    table.add_columns(*("#" + verdict for verdict in verdicts), "#fallback used")
    for solver in run.names():
        for claimed in sorted(claimed for name, claimed in found if name == solver):
            runs, cells = found[solver, claimed], [solver, claimed]
            for verdict in verdicts:
                of_kind = Result({"claimed": claimed, "verified": verdict})
                flagged = verdict == "wrong" and not of_kind.lies
                cells.append(count(runs.get(verdict, 0), "warn" if flagged else tone_of(of_kind.lies, of_kind.is_right)))
            table.add(solver, "", [*cells, count(runs["fallbacks"])])
    return table.explained()


def worst_row_table(run):
    """Worst violated row per constraint type, among claims of success."""
    table, worst = Table("worst-rows"), {}
    for place, r in enumerate(run.results):
        for row in r.worst_by_type if r.claimed == "solved" else ():
            kind, _, relative, _, _ = row
            if math.isfinite(relative) and relative > 0 and relative > worst.get((kind, r.solver), (0,))[0]:
                worst[kind, r.solver] = relative, place, row, r
    for relative, _, (kind, violation, _, unit, name), r in sorted(worst.values(), key=lambda found: (found[2][0], -found[0], found[1])):
        table.add(r.solver, r.family,
                  [kind, r.solver, cell(f"{scientific(violation)} {unit}".rstrip(), violation), number(relative), name, r.problem,
                   number(r.tolerance, 0), cell(r.verified, NAN, tone_of(r.lies, False))], run.replay_of(r))
    return table.explained()


def range_gap_table(run):
    """|J k - c| / |c| against the error, where a solver reports it."""
    table, kept = Table("range-gap"), {}
    for r in run.results:
        if math.isfinite(r.range_gap):
            known = kept.setdefault((r.solver, r.problem), r)
            if r.tolerance < known.tolerance:
                kept[r.solver, r.problem] = r
    for r in kept.values():
        table.add(r.solver, r.family, [r.problem, whole(r.m), knob(r.knob_value), number(r.range_gap), error_cell(r), r.claimed,
                                       cell(r.verified, NAN, tone_of(r.lies, r.verified == "solved"))], run.replay_of(r))
    return table.explained()


# What accuracy costs.

def accuracy_table(run):
    """Time at equal achieved error, per family and over all."""
    table, families = Table("accuracy"), run.families()
    table.add_columns(*(f"#at {scientific(error, 0)}" for error in LEVELS))
    for family in ["", *families] if len(families) > 1 else families:
        # Ordered as at the headline's error; solvers that reach only looser ones follow, by the tightest they reach.
        rows = {entry.solver: [family or "all", entry.solver] + ["not reached"] * len(LEVELS)
                for error in (HEADLINE, 1e-6, 1e-3) for entry in accuracy_matched(run, family, error)}
        for level, error in enumerate(LEVELS, 2):
            for entry in accuracy_matched(run, family, error):
                everywhere = entry.reached == entry.problems
                text = f"{duration(entry.time_s)} ({ratio_text(entry.ratio)})"
                rows[entry.solver][level] = cell(text if everywhere else f"{text} on {entry.reached} of {entry.reads}", entry.time_s,
                                                 tone_of(False, entry.ratio == 1 and everywhere))
        for solver, cells in rows.items():
            table.add(solver, family or "all", cells)
    return table.explained()


def means_table(run):
    """Shifted geometric means, two shifts."""
    table, solvers = Table("means"), run.names()
    rows = {solver: [solver] for solver in solvers}
    for error in (1e-6, 1e-12):
        times = [times_to_error(run, error)[solver] for solver in solvers]
        near = natural_shift(times)
        if near == 0:
            continue
        table.add_columns(f"#solved at {scientific(error, 0)}")
        for solver, column in zip(solvers, times):
            rows[solver].append(part(sum(map(math.isfinite, column)), sum(t == t for t in column)))
        for shift in (near, 10 * near):
            table.add_columns(f"#mean at {scientific(error, 0)}, shift {duration(shift)}")
            for solver, mean in zip(solvers, shifted_geometric_means(times, shift, penalty=10)):
                rows[solver].append(time(mean))
    if len(table.columns) > 1:
        for solver, cells in rows.items():
            table.add(solver, "", cells)
    return table.explained()


def exponent_table(run):
    """Fitted scaling exponents."""
    table = Table("exponents")
    for found in scaling(run, 1e-6):
        for solver, low, high, (_, exponent, error) in found.fits:
            table.add(solver, found.family, [found.family, solver, found.axis, knob(low), knob(high), rounded(exponent, 2),
                                             rounded(2 * error, 2)])
    return table.explained()


def break_point_table(run):
    """First failure and first false claim of each solver on each stability family."""
    table, found = Table("break-points"), break_points(run)
    knobs = {}
    for (family, _), point in found.items():
        knobs.setdefault(family, point.knob)
    table.add_columns(*(family + (f" ({name})" if name else "") for family, name in knobs.items()))

    def at(r):
        return "never" if not r else knob_text(r.knob_value) or r.problem

    for solver in run.names():
        points = [found.get((family, solver)) for family in knobs]
        if not any(points):
            continue
        cells = [solver]
        for p in points:
            beside = "".join(f" ({n} {what})" for n, what in ((p.undecided, "undecided"), (p.handed_over, "handed over")) if n) if p else ""
            if not p or not p.problems:
                cells.append(beside.strip(" ()") or "unsupported")
                continue
            tone = "warn" if p.fails and not p.lies else tone_of(p.lies, True)
            text = f"{at(p.fails)} / {at(p.lies)}{beside}"
            cells.append(cell(text, p.fails.knob_value if p.fails else NAN, tone))
        table.add(solver, "", cells)
    return table.explained()


# Friction: one problem under several laws side by side, and which solver shows which phenomenon.

def without_law(family, law):
    """ "hand (convex)" is the family hand."""
    return family.removesuffix(f" ({law})")


def law_table(run):
    table = Table("laws")
    compared = {without_law(r.family, r.law) for r in run.results if math.isfinite(r.coulomb_error)}  # that stand under several laws
    rows = {}
    for group in run.groups if compared else ():
        for solver in run.names():
            r = tightest(group.by_solver.get(solver, ()))
            if r and r.law and not r.is_blank and without_law(r.family, r.law) in compared:
                rows.setdefault((without_law(r.family, r.law), r.law, r.solver), []).append(r)
    for (family, law, solver), runs in rows.items():
        right, lies = sum(r.is_right for r in runs), sum(r.lies for r in runs)
        off = [value for value in (r.z_error if law == "coulomb" else r.coulomb_error for r in runs) if math.isfinite(value)]
        error, seconds = ([value for value in map(of, runs) if math.isfinite(value)] for of in (lambda r: r.z_error, lambda r: r.solve_s))
        table.add(solver, family, [family, law, solver, count(len(runs)), part(right, len(runs), tone_of(lies, right == len(runs))),
                                   count(sum(r.verified == "consistent" for r in runs)), count(lies, "bad"), number(median(error)),
                                   number(median(off)), number(max(off, default=NAN)), time(median(seconds))])
    return table.explained()


def phenomenon_cell(row):
    """ok, or by how much it is off: 0.38, 2.3, 4e-3."""
    off = row["off"]
    if not row["applies"]:
        return ""
    if row["passes"]:
        return cell("ok", off, "good")
    if not math.isfinite(off):
        return cell("none", NAN, "warn")
    return cell(f"{off:.2g}" if 0.01 <= off < 100 else scientific(off, 0), off, "bad")


def conformance_table(run):
    """Which solver shows which phenomenon of friction."""
    table, by_solver = Table("conformance"), {}
    for row in run.phenomena:
        by_solver.setdefault(row["solver"], {}).setdefault(row["check"], row)
    checks = list(dict.fromkeys(row["check"] for row in run.phenomena))
    table.add_columns(*("#" + check for check in checks))
    for solver, rows in by_solver.items():
        law = next(iter(rows.values()))["law"] if any(row["applies"] for row in rows.values()) else ""
        table.add(solver, "", [solver, law, whole(sum(row["passes"] for row in rows.values())),
                               *(phenomenon_cell(rows[check]) if check in rows else "" for check in checks)])
    return table.explained()


def phenomenon_table(run):
    """What they are."""
    table = Table("phenomena")
    for row in run.phenomena:
        if row["solver"] == run.phenomena[0]["solver"]:
            table.add("", "", [row["check"], row["expected"]])
    return table.explained()


# What the speed suite measures: times against a neutral kernel and against each other, warm starts, assembly.

OURS = ("dual_active_set", "newton", "cone")  # the first of these that was run is what others stand against


class SpeedTimes:
    """One solver on all problems of one size of a family."""

    def __init__(self, runs):
        timed = [r for r in runs if r.repetitions and not r.is_blank]
        errors = [r for r in runs if math.isfinite(r.error)]
        self.problems, self.right, self.lies = len(runs), sum(r.is_right for r in runs), sum(r.lies for r in runs)
        self.unsupported = all(r.is_blank for r in runs)
        self.verdict = next((r.verified for r in reversed(runs) if not r.is_right), "")
        self.error, self.bound = max((r.error for r in errors), default=NAN), any(not math.isfinite(r.z_error) for r in errors)
        self.stopped, self.timed = any(r.claimed == "time limit" for r in timed), bool(timed)
        self.time, self.allocations = median([r.solve_s for r in timed]), median([r.allocations for r in timed])
        self.kernels = median([over(r.solve_s, r.kernel_s) for r in timed])

    def verdict_cell(self):
        if self.unsupported:
            return "not applicable"
        made = part(self.right, self.problems, "bad" if self.lies else "warn" if self.right < self.problems else "good")
        return {**made, "text": f"{made['text']} ({self.verdict})"} if self.right < self.problems else made

    def at_least(self, value, text):
        """ "> 1.2 ms" where a solver was stopped, "" where there is no value."""
        return cell(("> " if self.stopped else "") + text if math.isfinite(value) else "", value)


def by_size(run, identities=None):
    """Of each family, knob and value of it, in order: the times by solver. identities: of these problems only."""
    sizes = {}
    for r in run.results:
        if identities is not None and r.identity not in identities:
            continue
        size = r.family, r.knob, 0 if math.isnan(r.knob_value) else r.knob_value
        sizes.setdefault(size, {}).setdefault(r.solver, []).append(r)
    return {size: {solver: SpeedTimes(runs) for solver, runs in sorted(sizes[size].items())} for size in sorted(sizes)}


def size_cell(size):
    family, name, value = size
    return cell(f"{knob_text(value)} {name}" if name else family, value)


def change_cell(ratio):
    """Of times, B over A."""
    return cell(f"{fixed(ratio, 2)}x", ratio, "warn" if ratio > 1.1 else tone_of(False, ratio < 0.9)) if math.isfinite(ratio) else "-"


def speed_table(run):
    """Time, kernels, ratios, error and verdict per size and solver."""
    table = Table("speed")
    for size, solvers in by_size(run).items():
        family = size[0]
        reference = next((solvers[ours].time for ours in OURS if ours in solvers and solvers[ours].time == solvers[ours].time), NAN)
        for solver, t in sorted(solvers.items(), key=lambda item: (1e300 if math.isnan(item[1].time) else item[1].time, item[0])):
            ratio = over(t.time, reference)
            table.add(solver, family,
                      [family, size_cell(size), solver, t.at_least(t.time, duration(t.time)),
                       rounded(t.kernels, 2), t.at_least(ratio, ratio_text(ratio)),
                       cell(("<= " if t.bound else "") + scientific(t.error) if math.isfinite(t.error) else "", t.error), t.verdict_cell(),
                       rounded(t.allocations, 0)])
    return table.explained()


def speed_change_table(a, b):
    """What each figure of the speed page was in run A and is in run B, on the problems both hold."""
    table = Table("speed-changes")
    same = {r.identity for r in a.results} & {r.identity for r in b.results}
    before, after = by_size(a, same), by_size(b, same)
    for size, solvers in before.items():
        for solver, was in solvers.items():
            if now := after.get(size, {}).get(solver):
                table.add("", "",
                          [size[0], size_cell(size), solver, *(t.at_least(t.kernels, fixed(t.kernels, 3)) for t in (was, now)),
                           change_cell(over(now.kernels, was.kernels)), was.verdict_cell(), now.verdict_cell()])
    return table.explained()


def speed_exponent_table(run):
    """Time against the number of hands, boxes or rows."""
    table, sizes = Table("speed-exponents"), by_size(run)
    # Walls begin at 100 boxes: below, set-up dominates.
    for family, least in (("K", 1), ("hands", 1), ("random", 1), ("tower", 10), ("wall", 100)):
        for solver in run.names():
            points = [(value, solvers[solver].time) for (name, _, value), solvers in sizes.items()
                      if name == family and value >= least and solver in solvers and solvers[solver].timed
                      and (solvers[solver].right or solvers[solver].verdict == "undecided")]
            if len(points) >= 3:
                x, y = zip(*points)
                _, exponent, error = fit_power_law(x, y)
                table.add(solver, family, [family, solver, f"{knob_text(x[0])} to {knob_text(x[-1])}", rounded(exponent, 2),
                                           rounded(2 * error, 2)])
    return table.explained()


def sequence_table(run):
    """Cold and warm over frames."""
    table = Table("sequences")
    for row in run.of_kind("sequence"):
        sequence, solver = text_of(row.get("sequence")), text_of(row.get("solver"))
        cold, warm = (row.get(start) if isinstance(row.get(start), dict) else {} for start in ("cold", "warm"))
        gain = over(number_of(cold.get("solve_s")), number_of(warm.get("solve_s")))
        right, checked = (count_of(cold.get(key)) + count_of(warm.get(key)) for key in ("right", "checked"))
        errors = [e for e in (number_of(start.get("worst_z_error")) for start in (cold, warm)) if e == e]
        table.add(solver, sequence,
                  [sequence, solver, whole(count_of(cold.get("frames"))), *(time(number_of(start.get("solve_s"))) for start in (cold, warm)),
                   cell(fixed(gain, 2) + "x", gain, "warn" if gain < 1 else ""),
                   ", ".join(fixed(number_of(start.get("iterations")), 0) for start in (cold, warm)), number(max(errors, default=NAN)),
                   part(right, checked, "good" if right == checked else "warn"), rounded(number_of(warm.get("allocations")), 0)])
    return table.explained()


def assembly_table(run):
    table = Table("assembly")
    for row in run.of_kind("assembly"):
        seconds = number_of(row.get("assemble_s"))
        table.add("", "", [text_of(row.get("scene")), whole(count_of(row.get("contacts"))), whole(count_of(row.get("m"))), time(seconds),
                           rounded(over(seconds, number_of(row.get("kernel_s"))), 3), time(number_of(row.get("islands_s"))),
                           whole(count_of(row.get("allocations")))])
    return table.explained()


# What a run is, and which tables a page has.

def reference_table(run):
    """Where the true answers come from, per family."""
    table, families = Table("references"), {}
    for r in run.results:
        by_reference, infeasible = families.setdefault(r.family, ({}, set()))
        by_reference.setdefault(r.reference or "none (bound only)", set()).add(r.problem)
        if r.feasible is False:
            infeasible.add(r.problem)
    for family, (by_reference, infeasible) in families.items():
        origins = [f"{name}: {len(problems)}" if len(by_reference) > 1 else name for name, problems in sorted(by_reference.items())]
        table.add("", family, [family, whole(len(set().union(*by_reference.values()))), "; ".join(origins), count(len(infeasible))])
    return table.explained()


def solver_table(run):
    """Method and limits."""
    table = Table("solvers")
    for s in run.solvers:
        table.add(s.name, "", [s.name, s.method, s.limits, "a child process" if s.foreign else "this process"])
    return table.explained()


def conditions_table(run):
    """Commit, compiler, CPU, libraries, seed."""
    table = Table("conditions")
    for name, value in run.conditions:
        table.add("", "", [name, value])
    return table.explained()


def comparison_table(a, b):
    """Per solver of both runs, on the problems both hold: what is reached at 1e-6, the time ratio, lies."""
    table = Table("comparison")

    def by_problem(run, solver):
        found = {}
        for r in run.results:
            if r.solver == solver:
                found.setdefault(r.identity, []).append(r)
        return found

    for solver in (name for name in a.names() if name in b.names()):
        in_a, in_b = by_problem(a, solver), by_problem(b, solver)
        both = [(in_a[problem], in_b[problem]) for problem in sorted(in_a) if problem in in_b]
        times = [tuple(time_to_error(runs, 1e-6) for runs in pair) for pair in both]
        reached_a, reached_b = (sum(math.isfinite(pair[k]) for pair in times) for k in (0, 1))
        lies_a, lies_b = (sum(r.lies for pair in both for r in pair[k]) for k in (0, 1))
        ratios = [over(tb, ta) for ta, tb in times if math.isfinite(ta) and math.isfinite(tb)]
        table.add("", "", [solver, whole(len(both)), whole(reached_a), whole(reached_b, tone_of(reached_b < reached_a, reached_b > reached_a)),
                           change_cell(geometric_mean(ratios)),
                           whole(lies_a), whole(lies_b, tone_of(lies_b > lies_a, lies_b < lies_a))])
    table.explained()
    for run, other, mark in ((a, b, "A"), (b, a, "B")):
        alone = [name for name in run.names() if name not in other.names()]
        table.note += f" Only in run {mark}: {', '.join(alone)}." if alone else ""
    differ = [name for name in ("CPU", "compiler", "flags", "build type") if dict(a.conditions).get(name) != dict(b.conditions).get(name)]
    table.note += f" The runs are of different {', '.join(differ)}, which times depend on." if differ else ""
    return table


def common_tables(run):
    """Those of all problems, some only where there is something to say."""
    tables = [make(run) for make in (claim_counts_table, claims_table, verdict_table, worst_row_table, reference_table, solver_table,
                                     conditions_table)]
    if run.is_of_speed:
        tables.append(assembly_table(run))
    tables += [table for table in (make(run) for make in (law_table, conformance_table, phenomenon_table)) if table.rows]
    if run.of_kind("sequence"):
        tables.append(sequence_table(run))
    if run.recorded:
        tables.append(recorded_table(run))
    return tables


def class_tables(run):
    """Those of one class of problems."""
    of_speed = (speed_table, speed_exponent_table) if run.is_of_speed else ()
    return [make(run) for make in (accuracy_table, means_table, break_point_table, exponent_table, range_gap_table, *of_speed)]
