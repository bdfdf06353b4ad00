"""Times at equal achieved error, profiles, sweeps: what tables and charts are made of."""
import json
import math

from held import files
from results import NAN, OPEN, duration, over, scientific

INFINITE = math.inf
LEVELS = (1e-3, 1e-6, 1e-9, 1e-12)  # the achieved errors at which solvers are compared
HEADLINE = 1e-9
BROKEN = 1e-6  # an error above this is a broken answer, whatever the tolerance


def quantile(values, share):
    """Linear between order statistics, of the values that are not NaN; NaN when there are none."""
    values = sorted(v for v in values if v == v)
    if not values:
        return NAN
    place = share * (len(values) - 1)
    k, part = int(place), place - int(place)
    above = values[k + 1] if part > 0 else values[k]
    return above if above == values[k] else values[k] + part * (above - values[k])


def median(values):
    return quantile(values, 0.5)


def log(value):
    return math.log(value) if value > 0 else -INFINITE if value == 0 else NAN


def exp(value):
    return math.exp(value) if value < 709 else INFINITE


def geometric_mean(values, shift=0):
    """exp(mean log(v + shift)) - shift; NaN when empty. The shift keeps the tiniest times from ruling the mean."""
    return exp(sum(log(v + shift) for v in values) / len(values)) - shift if values else NAN


def fit_power_law(x, y):
    """a, p and the standard error of p in y = a x^p, by least squares in logarithms (NaN with fewer than three points)."""
    n, x, y = len(x), list(map(log, x)), list(map(log, y))
    mean_x, mean_y = sum(x) / n, sum(y) / n
    squares = sum((a - mean_x) ** 2 for a in x)
    p = over(sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)), squares)
    rest = sum((b - mean_y - p * (a - mean_x)) ** 2 for a, b in zip(x, y))
    return exp(mean_y - p * mean_x), p, math.sqrt(over(rest / (n - 2), squares)) if n > 2 else NAN


# Time to an achieved error.

def time_to_error(runs, error):
    """Time [s] in which one solver reaches the error on one problem: the cheapest of the runs that achieved it and of the crossings between
    neighbours on the tolerance ladder (interpolated in logarithms). Infinite where none does; NaN where every run is blank: the solver does
    not read the problem. Runs that lie never count, and on an infeasible problem only a proof does. Runs that did the same, whatever was
    asked for, are one with the median of their times: the least of all tolerances would flatter methods that are exact at each of them."""
    if all(r.is_blank for r in runs):
        return NAN
    timed = [r for r in runs if not r.lies and math.isfinite(r.solve_s) and (r.verified == "infeasible, proven" or math.isfinite(r.error))]
    alike = {}
    for r in timed:
        alike.setdefault((r.error if math.isfinite(r.error) else None, r.iterations), []).append(r.solve_s)
    seconds = {id(r): median(alike[r.error if math.isfinite(r.error) else None, r.iterations]) for r in timed}
    best, before = min((seconds[id(r)] for r in timed if r.verified == "infeasible, proven"), default=INFINITE), None
    for r in sorted((r for r in timed if math.isfinite(r.error)), key=lambda r: -r.tolerance):
        if r.error <= error:
            best = min(best, seconds[id(r)])
            if before and before.error > error:
                e0, e1 = (log(max(x.error, 1e-17)) for x in (before, r))  # an error of 0 has a logarithm here
                t0, t1 = log(seconds[id(before)]), log(seconds[id(r)])
                crossing = exp(t0 + over(log(error) - e0, e1 - e0) * (t1 - t0)) if math.isfinite(t0) and math.isfinite(t1) else NAN
                best = min(best, crossing) if crossing == crossing else best
        before = r
    return best


def times_to_error(run, error, family=""):
    """times[solver], problem by problem [s] of this family ("": of all), in the order of run.groups."""
    if error not in run.reached:
        names = list(dict.fromkeys([*run.names(), *(r.solver for r in run.results)]))
        run.reached[error] = {name: [time_to_error(group.by_solver.get(name, ()), error) for group in run.groups] for name in names}
    times = run.reached[error]
    if not family:
        return times
    of_family = [k for k, group in enumerate(run.groups) if group.family == family]
    return {name: [column[k] for k in of_family] for name, column in times.items()}


class Matched:
    """One solver's time in a family at equal achieved error."""

    def __init__(self, solver, mean, times, leader):
        self.solver = solver
        self.time_s = mean  # geometric, over the problems on which the error was reached
        # To the leading solver, geometric mean over the problems both reached; 1 for the leader.
        self.ratio = geometric_mean([over(t, lead) for t, lead in zip(times, leader) if math.isfinite(t) and math.isfinite(lead)])
        self.reached = sum(map(math.isfinite, times))
        self.reads = sum(t == t for t in times)
        self.problems = len(times)  # all: of these it reads some, and reaches the error on some of those


def accuracy_matched(run, family, error):
    """Most problems first, then the fastest. Solvers that reach the error nowhere are left out. family "" means all. Of one class."""
    times, order = times_to_error(run, error, family), []
    for place, solver in enumerate(dict.fromkeys(r.solver for r in run.results)):
        reached = [t for t in times[solver] if math.isfinite(t)]
        if reached:
            order.append((-len(reached), geometric_mean(reached), place, solver))
    order.sort()
    return [Matched(solver, mean, times[solver], times[order[0][3]]) for _, mean, _, solver in order]


def is_hand(family):
    """hand, and "hand with friction (convex)"."""
    return family == "hand" or family.startswith("hand ")


def headline_family(run):
    """The family a run is best summed up by: the hands, else the one most solvers reach 1e-9 on. "" when there is none."""
    best, most = "", 0
    for family in run.families():
        solvers = len(accuracy_matched(run, family, HEADLINE))
        if solvers > most or solvers > 0 and is_hand(family):
            best, most = family, solvers
        if is_hand(family) and solvers > 0:
            break
    return best


def ratio_text(ratio):
    """ "12x", "3.4x", "0.035x": two digits at least."""
    return f"{ratio:{'.0f' if ratio >= 9.95 else '.1f' if ratio >= 0.995 else '.2g'}}x" if math.isfinite(ratio) else ""


def accuracy_headline(run, error=HEADLINE):
    """ "On 3 hands at 1e-9 achieved error: dual_active_set 18 us, nnls 104 us (5.8x); not on all: pgs 90 us (4.1x, 2 of 3)", of the headline
    family, behind the class's name; "" when no solver reaches it. The leader is the fastest of those that reach it most often; a part is of
    the problems that the solver reads."""
    family, on_all, on_some = headline_family(run), [], []
    matched = accuracy_matched(run, family, error)
    if not matched:
        return ""
    problems = matched[0].problems
    for entry in matched:
        ratio = "" if entry.ratio == 1 else ratio_text(entry.ratio)  # none where it and the leader reached no problem in common
        asides = [ratio] if ratio else []
        if entry.reached < problems:
            asides.append(f"{entry.reached} of {entry.reads}")
        (on_some if entry.reached < problems else on_all).append(
            f"{entry.solver} {duration(entry.time_s)}" + (f" ({', '.join(asides)})" if asides else ""))
    subject = "hand" if is_hand(family) else family if family.endswith("problem") else family + " problem"
    subject = f"one {subject}" if problems == 1 else f"{problems} {subject}s"
    return ((f"{run.problem_class}: on" if run.problem_class else "On") + f" {subject} at {scientific(error, 0)} achieved error: "
            + "; not on all: ".join(", ".join(part) for part in (on_all, on_some) if part))


# Profiles. times[solver][problem]: infinite where the solver failed, was wrong or lied, NaN where it does not read the problem. A curve is
# a staircase: pairs of where it steps and the share of the problems that the solver reads.

def staircase(values):
    read, finite, steps = sum(v == v for v in values), sorted(v for v in values if math.isfinite(v)), {}
    for k, value in enumerate(finite, 1):
        steps[value] = k / read
    return list(steps.items())


def performance_profile(times):
    """Dolan-More: share of problems solved within tau times the fastest solver's time. A problem that no solver solves stays in the
    denominator: it is a failure of all."""
    fastest = [min((t for t in row if t == t), default=INFINITE) for row in zip(*times)]
    return [staircase([t if math.isinf(t) else over(t, lead) for t, lead in zip(column, fastest)]) for column in times]


def data_profile(times):
    """More-Wild, with seconds as the budget: share of problems solved within that time."""
    return [staircase(column) for column in times]


def shifted_geometric_means(times, shift, penalty):
    """[s] per solver over the problems that it reads and at least one solver solved; a failure counts as `penalty` times the slowest success
    on that problem (a mean cannot hold an infinity; the profile does)."""
    slowest = [max((t for t in row if math.isfinite(t)), default=0) for row in zip(*times)]
    return [geometric_mean([t if math.isfinite(t) else penalty * most for t, most in zip(column, slowest) if most > 0 and t == t], shift)
            for column in times]


def natural_shift(times):
    """Median of all successes [s], rounded to one digit: the shift that treats half the times as small."""
    middle = median([t for column in times for t in column if math.isfinite(t)])
    if not middle > 0:
        return 0
    decade = 10 ** math.floor(math.log10(middle))
    return math.floor(middle / decade + 0.5) * decade


# Sweeps: families of the stability atlas, whose knob goes from benign to impossible at a fixed size.

STABILITY = [entry["family"] for entry in json.loads(files["stability.json"])]


def tightest(runs):
    """The run at the tightest tolerance; None where there is none."""
    return min(runs, key=lambda r: r.tolerance, default=None)


def sweep_state(r):
    """right, fails, lies, undecided, or "": unsupported."""
    if r.is_blank:
        return ""
    if r.verified == "infeasible, proven" or (r.z_error <= BROKEN and r.feasible is not False):
        return "right"
    answer = math.isfinite(r.z_error)
    if r.lies or answer and r.claimed == "solved":  # wrong by more than 1e-6 and says solved, at the tightest tolerance
        return "lies"
    if not answer and r.verified in OPEN or r.verified == "infeasible, claimed only" and r.feasible is False:
        return "undecided"
    if not answer and r.verified in ("solved", "near"):
        return "right" if r.z_bound <= BROKEN else "undecided"
    return "fails"


def sweep_mark(r):
    """What is written into its cell beside the colour: "c" crashed, "t" timed out, "w" margins warned, "f" a fallback ran, "wf" both, a cross
    where it fails, a tick where infeasibility is proven, "?" undecided, ""."""
    state, warned = sweep_state(r), r.claimed == "solved, ill-conditioned"
    if state in ("", "lies"):
        return ""
    if r.verified in ("crashed", "timeout"):
        return r.verified[0]
    if state == "fails":
        return "w" if warned else "\u00d7"
    if state == "undecided":
        return "?"
    return "w" * warned + "f" * r.fallback or ("" if math.isfinite(r.z_error) else "\u2713")


class BreakPoint:
    """What one solver does over a sweep, problems in file order (benign to hard), each at the tightest tolerance it ran."""

    def __init__(self, knob):
        self.knob, self.problems, self.undecided, self.handed_over = knob, 0, 0, 0
        self.fails = None  # first problem with error > 1e-6, or no answer, or a claim the referee rejects
        self.lies = None   # first of them where the solver claims to be right

    def add(self, r):
        state = sweep_state(r)
        self.problems += state != ""
        self.undecided += state == "undecided"
        if state in ("fails", "lies"):
            self.fails = self.fails or r
        if state == "lies":
            self.lies = self.lies or r


def break_points(run):
    """By family and solver."""
    found = {}
    for group in run.groups:
        if group.family in STABILITY:
            for solver in run.names():
                if r := tightest(group.by_solver.get(solver, ())):
                    found.setdefault((group.family, solver), BreakPoint(r.knob)).add(r)
                elif any(solver == who and group.problem in problems for (who, _), problems in run.handed_over.items()):
                    knob = next(iter(group.by_solver.values()))[0].knob
                    found.setdefault((group.family, solver), BreakPoint(knob)).handed_over += 1
    return found


def size_of(r):
    """What a family sweeps: its knob where rows or columns grow with it, else the rows."""
    return r.knob_value if math.isfinite(r.knob_value) else float(r.m)


class Scaling:
    """Time against size in one family."""

    def __init__(self, family, axis):
        self.family, self.axis = family, axis  # axis: the knob's name, or "rows m"
        self.points = []  # the run drawn, solver, size, time [s]
        self.fits = []    # solver, sizes from and to, power law: the upper half of the range, where overheads matter least; three at least


def scaling(run, error):
    """Families with three or more sizes. Time to the achieved error given; median over problems of equal size."""
    found, seconds = [], times_to_error(run, error)
    by_family = {}
    for r in run.results:
        if size_of(r) > 0:
            by_family.setdefault(r.family, []).append(r)
    for family, results in ((family, by_family.get(family, [])) for family in run.families()):
        sizes = sorted({size_of(r) for r in results})
        if len(sizes) < 3 or len({(r.n, r.m) for r in results}) < 3:
            continue
        axis = next((r.knob for r in reversed(results) if r.knob and math.isfinite(r.knob_value)), "rows m")
        middle, scale = min(math.sqrt(sizes[0]) * math.sqrt(sizes[-1]), sizes[-3]), Scaling(family, axis)
        for solver in run.names():
            times, example = {}, {}
            for k, group in enumerate(run.groups):
                if group.family != family or solver not in group.by_solver:
                    continue
                r, t = tightest(group.by_solver[solver]), seconds[solver][k]
                if math.isfinite(t) and size_of(r) > 0:
                    times.setdefault(size_of(r), []).append(t)
                    example[size_of(r)] = r
            upper = []
            for size in sorted(times):
                t = max(median(times[size]), 1e-9)
                scale.points.append((example[size], solver, size, t))
                if size >= middle * (1 - 1e-12):
                    upper.append((size, t))
            if len(upper) >= 3:
                x, y = zip(*upper)
                scale.fits.append((solver, x[0], x[-1], fit_power_law(x, y)))
        found.append(scale)
    return found
