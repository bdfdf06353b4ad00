"""Rows of all charts: {chart: {fields: [..], rows: [[..], ..]}}, aggregated so that a page draws at most 2,000 marks a chart; every single
run stays in results.jsonl."""
import collections
import math

from aggregation import LEVELS, STABILITY, data_profile, median, performance_profile, scaling, sweep_mark, sweep_state, tightest, times_to_error
from results import count_of, number_of, over
from tables import knob_text

CURVE_STEPS = TRACE_POINTS = SWEEP_COLUMNS = 60
MARKS = 2000            # of a chart of a large run
SINGLE_RUNS = 6000      # more, and runs that went well are shown by their medians alone
ALONE_OF_KIND = 20      # of a large run, marks of one family, solver and kind
STAGES = ("checks", "whiten", "joints", "climb", "refine")  # docs/formats.md


def is_chosen(i, of, most):
    """Whether the i-th of `of` is among the `most` evenly chosen ones."""
    return of <= most or i == 0 or i * most // of != (i - 1) * most // of


def chosen(items, most):
    return [item for i, item in enumerate(items) if is_chosen(i, len(items), most)]


def known(value, digits=4):
    """None where it is not: four digits draw the same picture in a third of the bytes."""
    return float(f"{min(max(value, -1e300), 1e300):.{digits - 1}e}") if math.isfinite(value) else None


def chart(fields, rows):
    return {"fields": fields.split(), "rows": rows}


# The work-precision diagram.

def drawn_as(r):
    """ok, missed (stopped short, and said so), wrong (claimed success), undecided, failed (no answer), or "" (blank: unsupported, or a proof
    of infeasibility)."""
    if r.is_blank or r.verified == "infeasible, proven":
        return ""
    if r.lies:
        return "wrong"
    if r.verified == "solved":
        return "ok" if math.isfinite(r.error) else ""
    if math.isfinite(r.z_error):
        return "missed"
    return "undecided" if r.is_open or r.verified == "near" else "failed"


def work_precision_rows(run):
    problems, infeasible, slowest = {}, {}, {}
    for r in run.results:
        problems.setdefault(r.family, set()).add(r.problem)
        if r.feasible is False:
            infeasible.setdefault(r.family, set()).add(r.problem)
        if math.isfinite(r.solve_s):
            slowest[r.family] = max(slowest.get(r.family, 0), r.solve_s)
    # A family of which most problems have no z has no error to draw: the sweep shows who proves it.
    undrawn = {family for family, without in infeasible.items() if 2 * len(without) > len(problems[family])}
    drawn = [(r, kind) for r, kind in ((r, drawn_as(r)) for r in run.results if r.family not in undrawn) if kind]

    def row(level, r, error, seconds, of):
        return [level, r.family, r.problem, r.solver, known(r.tolerance), drawn_as(r), known(error), *map(known, seconds[:4]),
                known(seconds[4], 6), r.claimed, r.verified, of, run.replay_of(r)]

    # Medians over the problems of a family that the solver got right at this tolerance, where those are more than half: medians over few easy
    # ones, others at every tolerance, would draw a line to and fro.
    rows, lone, cells = [], set(), {}  # lone: right, but not part of a median
    for r, kind in drawn:
        cells.setdefault((r.family, r.solver, r.tolerance), []).append((r, kind))
    for key in sorted(cells):
        runs, right = cells[key], [r for r, kind in cells[key] if kind == "ok"]
        if 2 * len(right) <= len(runs):
            lone.update(map(id, right))
            continue
        middle = median([r.solve_s for r in right])
        typical = min(right, key=lambda r: abs(r.solve_s - middle))
        several = len(problems[typical.family]) > 1
        seconds = [middle, *(median([getattr(r, column) for r in right]) for column in ("solve_s_q1", "solve_s_q3", "prepare_s", "iterations"))]
        rows.append(row("median" if several else "single", typical, median([r.error for r in right]), seconds,
                        f"median of {len(right)} solved of {len(runs)}" if several else "one run"))
    every, alone = len(run.results) <= SINGLE_RUNS, {}
    for r, kind in drawn:
        if kind == "ok" and id(r) not in lone and (not every or len(problems[r.family]) == 1):
            continue
        alone[r.family, r.solver, kind] = alone.get((r.family, r.solver, kind), 0) + 1
        if run.is_large and alone[r.family, r.solver, kind] > ALONE_OF_KIND:
            continue
        seconds = r.solve_s if math.isfinite(r.solve_s) and r.solve_s > 0 else slowest.get(r.family, 0)
        rows.append(row("lone" if id(r) in lone else "run", r, r.error if math.isfinite(r.error) else r.self_bound,
                        (seconds, r.solve_s_q1, r.solve_s_q3, r.prepare_s, r.iterations), "one run"))
    return rows


def recorded_rows(run):
    """An answer that came with a problem has an error and no time: one row a problem, and the median of each family."""
    rows, families = [], {}

    def add(level, r, error, verified, of):
        rows.append([level, r.family, r.problem, r.solver, known(r.tolerance), "recorded", known(error), *[None] * 5, r.claimed, verified, of, ""])

    for r in run.recorded:
        if math.isfinite(r.z_error):
            add("run", r, r.z_error, r.verified, "a recorded answer")
            families.setdefault((r.family, r.solver), []).append(r)
    for answers in families.values():
        add("median", answers[0], median([r.z_error for r in answers]), answers[0].verified if len(answers) == 1 else "",
            f"median of {len(answers)} recorded answers")
    return rows


def work_precision(run):
    return chart("level family problem solver tolerance drawn error time q1 q3 prepare iterations claimed verified of replay",
                 work_precision_rows(run) + recorded_rows(run))


def thinned(curve):
    """At most CURVE_STEPS steps, evenly chosen, the last one kept."""
    if len(curve) <= CURVE_STEPS:
        return curve
    return [curve[i * (len(curve) - 1) // (CURVE_STEPS - 1)] for i in range(CURVE_STEPS)]


def profiles(run):
    rows, solvers = [], run.names()
    for family in ["", *run.families()]:
        for error in LEVELS:
            of = times_to_error(run, error, family)
            times = [of[solver] for solver in solvers]
            first = min((t for column in times for t in column if t == t), default=math.inf)
            if not math.isfinite(first):
                continue
            for kind, curves, start in (("ratio", performance_profile(times), 1), ("time", data_profile(times), 0.8 * first)):
                end = max([start, *(curve[-1][0] for curve in curves if curve)])
                for solver, column, curve in zip(solvers, times, map(thinned, curves)):
                    reads = sum(t == t for t in column)
                    if reads == 0:
                        continue
                    # Every staircase runs from the left edge to the right one, also that of a solver that solves nothing.
                    left = [] if curve and curve[0][0] <= start else [(start, 0)]
                    rows += [[kind, family, known(error), solver, known(at), known(share), reads]
                             for at, share in (*left, *curve, (1.3 * end, curve[-1][1] if curve else 0))]
    return chart("kind family level solver at share reads", rows)


def sweep_states(run):
    rows, positions = [], {}  # problems in file order, benign to hard
    problems = collections.Counter(group.family for group in run.groups)
    for group in run.groups:
        if group.family not in STABILITY:
            continue
        position = positions[group.family] = positions.get(group.family, -1) + 1
        if run.is_large and not is_chosen(position, problems[group.family], SWEEP_COLUMNS):
            continue
        for solver in run.names():
            if r := tightest(group.by_solver.get(solver, ())):
                rows.append([r.family, r.problem, r.knob, knob_text(r.knob_value) or r.problem, position, r.solver, sweep_state(r),
                             known(r.error), r.claimed, r.verified, run.replay_of(r), sweep_mark(r), r.problem_file])
    return chart("family problem knob value position solver state error claimed verified replay mark file", rows)


def scaling_points(run, found):
    rows = []
    for scale in found:
        for r, solver, size, seconds in chosen(scale.points, MARKS) if run.is_large else scale.points:
            rows.append([scale.family, scale.axis, solver, r.problem, known(size, 9), known(seconds), r.n, r.m, run.replay_of(r)])
    return chart("family axis solver problem size time n m replay", rows)


def scaling_fits(found):
    rows = []
    for scale in found:
        for solver, low, high, (factor, exponent, _) in scale.fits:
            for size in (low, high):
                try:
                    seconds = factor * size ** exponent
                except OverflowError:
                    seconds = math.inf
                rows.append([scale.family, solver, known(size, 9), known(seconds), known(exponent, 3)])
    return chart("family solver size time exponent", rows)


def convergence(run):
    rows, traces = [], {}
    for point in run.traces:
        traces.setdefault((point["problem"], point["solver"]), []).append(point)
    for trace in traces.values():
        trace.sort(key=lambda point: point["iteration"])
        # Each point is a solve of its own, and times scatter; but who stops earlier cannot have needed longer.
        seconds, least = [], math.inf
        for point in reversed(trace):
            least = min(least, point["time_s"]) if point["time_s"] == point["time_s"] else least
            seconds.append(least)
        # Long traces are thinned evenly in the logarithm of the iteration; first and last stay.
        later, growth = 0, max(trace[-1]["iteration"], 2) ** (1 / TRACE_POINTS)
        for point, time in zip(trace, reversed(seconds)):
            if len(trace) > TRACE_POINTS and point["iteration"] < later and point is not trace[-1]:
                continue
            later = max(point["iteration"] + 1, int(point["iteration"] * growth))
            rows.append([point["family"], point["problem"], point["solver"], point["iteration"], known(time),
                         *(known(point[key]) for key in ("z_error", "primal", "stationarity", "gap"))])
    return chart("family problem solver iteration time z_error primal stationarity gap", rows)


def range_gaps(run):
    drawn = [r for r in run.results if math.isfinite(r.range_gap) and math.isfinite(r.z_error)]
    return chart("family problem solver m tolerance gap error claimed verified replay",
                 [[r.family, r.problem, r.solver, r.m, known(r.tolerance), known(r.range_gap), known(r.z_error), r.claimed, r.verified,
                   run.replay_of(r)] for r in (chosen(drawn, MARKS) if run.is_large else drawn)])


def stages(run):
    rows = []
    for line in run.of_kind("stages"):
        seconds = [number_of(line.get(stage)) for stage in STAGES]
        whole = sum(t for t in seconds if t == t)
        rows += [[count_of(line.get("contacts")), stage, k, known(t), known(over(t, whole), 3)] for k, (stage, t) in enumerate(zip(STAGES, seconds))]
    return chart("contacts stage order time share", rows)


def chart_rows(run):
    found = scaling(run, 1e-6)
    return {"work-precision": work_precision(run), "profile": profiles(run), "sweep": sweep_states(run), "scaling": scaling_points(run, found),
            "fit": scaling_fits(found), "convergence": convergence(run), "range-gap": range_gaps(run), "stages": stages(run)}
