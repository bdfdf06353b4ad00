"""`./zwang experiment`: the questions of the paper, each a table beside its figures, and charts. docs/experiments.md.

The program holds this text (held.py), and is asked for frames of the god hand and for solves, a line of JSON each
(experiments/program/experiment_command.cpp).
"""
import argparse
import csv
import difflib
import glob
import io
import json
import math
import os
import re
import signal
import subprocess
import sys
import tempfile

WRONG_USE, BAD_FILE, STOPPED = 2, 3, 130
STAGES = ("physics", "resolution", "assembly", "solve", "collision", "other")
ASSEMBLY, SOLVE, COLLISION = 2, 3, 4
MOST_SHOWN = 600  # frames of a chart's line; stretches of more are drawn by their median and their largest
TOLERANCE = "1e-10"  # that the solvers of a hand are asked for
SAMPLED = 5       # problems of a bin, at least, that `growth` times
NEW_LINE = {"lineterminator": "\n"}


def fail(line, code=WRONG_USE):
    print(line, file=sys.stderr)
    sys.exit(code)


# ---- Numbers -------------------------------------------------------------------------------------------------------------


def number(value, digits=3):
    """ "1,234", "0.0123", "1.2e-09"."""
    if 10 ** (digits - 1) <= abs(value) < 1e7:
        return f"{'-' if value < 0 else ''}{math.floor(abs(value) + 0.5):,}"
    far = value != 0 and not 1e-3 <= abs(value) < 1e7
    return f"{value:.{digits - 1}e}" if far else f"{value:.{digits}g}"


def median(values):
    """Linear between the two in the middle; NaN of none."""
    values = sorted(value for value in values if not math.isnan(value))
    if not values:
        return math.nan
    place = (len(values) - 1) / 2
    below, above = values[math.floor(place)], values[math.ceil(place)]
    return above if above == below else below + (place - math.floor(place)) * (above - below)


def power_law(x, y):
    """y = a x^p by least squares in logarithms: p and its standard error."""
    n, logs = len(x), [(math.log(a), math.log(b)) for a, b in zip(x, y)]
    mean = [sum(pair[k] for pair in logs) / n for k in (0, 1)]
    sxx = sum((a - mean[0]) ** 2 for a, _ in logs)
    p = sum((a - mean[0]) * (b - mean[1]) for a, b in logs) / sxx
    rest = sum((b - mean[1] - p * (a - mean[0])) ** 2 for a, b in logs)
    return p, math.sqrt(rest / (n - 2) / sxx)


def distance(p, q):
    return math.sqrt(sum((a - b) ** 2 for a, b in zip(p, q)))


def mm(metres, digits=3):
    return number(1e3 * metres, digits) + " mm"


def us(seconds):
    return number(1e6 * seconds) + " us"


# ---- What is asked of the program ------------------------------------------------------------------------------------------


class Asked:
    """How a question is asked, and of which program."""

    def __init__(self, data, circumstances, program, options):
        self.data, self.circumstances, self.program, self.options = data, circumstances, program, options

    def lines(self, *words):
        """Of JSON, one after the other. Ends this program with the other's exit code where that is not 0."""
        with subprocess.Popen([self.program, "experiment", *words], stdout=subprocess.PIPE, encoding="utf-8") as answering:
            for sign in (signal.SIGINT, signal.SIGTERM):  # Ctrl-C is for the program that answers, which says so and ends
                signal.signal(sign, lambda sign, _: answering.send_signal(sign) if sign == signal.SIGTERM else None)
            for line in map(json.loads, answering.stdout):
                yield {key: math.nan if value is None else value for key, value in line.items()} if isinstance(line, dict) else line
        if answering.returncode:
            raise Unanswered(answering.returncode)

    def draw(self, *words):
        if code := subprocess.run([self.program, "experiment", ":draw", *words]).returncode:
            raise Unanswered(code)

    def frames(self, scene, motion, options="", what="", after=()):
        """Of a motion by name, or of the recording that was asked for, under options of ./zwang simulate."""
        seconds = ("--seconds", repr(self.options.seconds)) if self.options.seconds else ()
        parts = ("--parts", self.options.parts) if self.options.parts else ()
        return self.lines(":frames", scene, "--motion", motion, *parts, "--what", what or motion, *seconds, *self.under(options), *after)

    def play(self, *words, **more):
        return list(self.frames(*words, **more))

    def under(self, options):
        """Without friction and the referee, by the solver that was asked for, where the options do not say otherwise."""
        usual = {} if "--method" in options else {"--mu": "0", "--verify": "0", "--solver": self.options.solver}
        return [*options.split(), *(word for key, value in usual.items() if key not in options for word in (key, value))]

    def motion(self, name):
        return self.options.motion or name


class Unanswered(Exception):
    """The program ended with this exit code, and has said why."""


def all_of(frames, key):
    return [value for frame in frames if not math.isnan(value := frame[key])]


def most(frames, key):
    return max(all_of(frames, key), default=math.nan)


def least(frames, key):
    return min(all_of(frames, key), default=math.nan)


def total(frames, key):
    return sum(all_of(frames, key), 0.0)


def touching(frames):
    return sum(frame["touches"] for frame in frames)


def rates(frames):
    """Frames a second: median, mean, of the slowest frame; and the share of collision detection."""
    times = [frame["total"] for frame in frames]
    whole = sum(times)
    return 1 / median(times), len(frames) / whole, 1 / max(times), sum(frame["stages"][COLLISION] for frame in frames) / whole


def farthest(a, b):
    """The farthest that a god object of one run is from the same in the other, in any frame that both have [m]."""
    return max((distance(p, q) for one, two in zip(a, b) for p, q in zip(one["god"], two["god"])), default=0.0)


# ---- What is found ---------------------------------------------------------------------------------------------------------


class Chart:
    """kind: lines, points, or shares, which are stacked to 100 %. Charts of one figure are drawn into one file of that name."""

    def __init__(self, name, title, x, y, kind="lines", log="", levels=(), figure=""):
        self.json = {"name": name, "title": title, "x": x, "y": y, "kind": kind, "log_x": "x" in log, "log_y": "y" in log,
                     "levels": [{"y": y, "text": text} for y, text in levels], "figure": figure, "points": []}

    def add(self, series, x, y):
        self.json["points"].append({"series": series, "x": float(x), "y": float(y) if math.isfinite(y) else None})
        return self

    def add_frames(self, series, frames, value):
        """One value a frame, or the median and the largest of each of 600 stretches, as "NAME" and "NAME, largest"."""
        stretch = max(1, math.ceil(len(frames) / MOST_SHOWN))
        pieces = [(frames[k]["t"], list(map(value, frames[k:k + stretch]))) for k in range(0, len(frames), stretch)]
        for time, values in pieces:
            self.add(series, time, median(values))
        for time, values in pieces if stretch > 1 else ():
            self.add(series + ", largest", time, max(values))
        return self


class Findings:
    """A table (first column: what; the paper's own figures stand in a column of theirs), charts, and what else there is to say."""

    def __init__(self, *columns, rows=(), charts=(), remarks=()):
        self.columns, self.rows, self.charts, self.remarks = list(columns), list(rows), list(charts), list(remarks)

    def text(self):
        table = [self.columns, *self.rows]
        width = [max(map(len, column)) for column in zip(*table)]
        lines = ["  ".join(cell.ljust(w) for cell, w in zip(row, width)).rstrip(" ") for row in table]
        return "".join(line + "\n" for line in lines + self.remarks)

    def csv(self):
        text = io.StringIO()
        csv.writer(text, **NEW_LINE).writerows([self.columns, *self.rows])
        return text.getvalue()

    def record(self, name, question, paper, command, asked):
        """DIR/NAME.csv, DIR/NAME.json and DIR/CHART.svg for each chart, drawn by Vega; needs Node. Returns the files."""
        out = asked.options.out
        charts = [chart.json for chart in self.charts]
        everything = {"question": question, "paper": paper, "command": command, "circumstances": asked.circumstances, "charts": charts,
                      "columns": self.columns, "rows": self.rows, "remarks": self.remarks}
        files = [os.path.join(out, name + ".csv"), os.path.join(out, name + ".json")]
        for file, text in zip(files, (self.csv(), json.dumps(everything, indent=1, sort_keys=True, ensure_ascii=False))):
            write(file, text)
        if charts:
            asked.draw(files[1], out)
        for chart in charts:
            file = os.path.join(out, (chart["figure"] or chart["name"]) + ".svg")
            if file not in files:
                files.append(file)
        return files


def write(file, text):
    try:
        os.makedirs(os.path.dirname(file) or ".", exist_ok=True)
        with open(file + ".new", "w", encoding="utf-8") as out:
            out.write(text)
        os.replace(file + ".new", file)
    except OSError as bad:
        fail(f"{file}: {bad.strerror}", BAD_FILE)


# ---- Figures 8, 9 and 10 of the paper and the detailed parts of its section 7 --------------------------------------------------


def contacts(name, title, frames):
    chart = Chart(name, title, "time (s)", "contacts")
    return chart.add_frames("found", frames, lambda f: f["raw"]).add_frames("kept as rows", frames, lambda f: f["kept"])


def frame_times(name, title, frames, *levels):
    chart = Chart(name, title, "time (s)", "time of a frame (ms)", log="y", levels=levels)
    return chart.add_frames("frame", frames, lambda f: 1e3 * f["total"]).add_frames(
        "collision", frames, lambda f: 1e3 * f["stages"][COLLISION])


def rate_rows(frames, mean, slowest, collision):
    middle, average, worst, share = rates(frames)
    return [["frames a second, median", number(middle), ""],
            ["frames a second, mean", number(average), mean],
            ["frames a second, slowest frame", number(worst), slowest],
            ["share of collision detection", number(100 * share) + " %", collision],
            ["frames that touch", number(100 * touching(frames) / len(frames)) + " %", ""],
            ["contacts, most in a frame: found, kept", f"{number(most(frames, 'raw'))}, {number(most(frames, 'kept'))}", ""]]


def grasp_in(asked, scene):
    return asked.play(scene, asked.motion("grasp"), what=scene)


def simple_scene(asked):
    frames = grasp_in(asked, "simple")
    return Findings("simple scene, 100,000 triangles", "here", "paper (2012)", rows=rate_rows(frames, "600", "100", "about 40 %"), charts=[
        contacts("fig8-contacts", "Contacts over an interaction, simple scene", frames),
        frame_times("fig8-times", "Time of a frame over the same interaction", frames,
                    (1e3 / 600, "paper, mean"), (1e3 / 100, "paper, slowest"))])


def stages(asked):
    frames = grasp_in(asked, "simple")
    chart = Chart("fig9", "Where the time of a frame goes, simple scene", "time (s)", "share of the frame's time", "shares")
    found = Findings("stage, simple scene", "here", "paper (2012)", charts=[chart])
    whole = sum(frame["total"] for frame in frames)
    stretch = max(1, len(frames) // 200)  # sums, so that the shares of a stretch are those of its time
    for k, stage in enumerate(STAGES):
        part = sum(frame["stages"][k] for frame in frames)
        found.rows.append([stage, number(100 * part / whole) + " %", "about 40 %" if stage == "collision" else ""])
        for begin in range(0, len(frames), stretch):
            chart.add(stage, frames[begin]["t"], sum(frame["stages"][k] for frame in frames[begin:begin + stretch]))
    return found


def engine(asked):
    frames = grasp_in(asked, "engine")
    return Findings("engine compartment, 1,000,000 triangles", "here", "paper (2012)", rows=rate_rows(frames, "50 to 70", "below 20", "up to 80 %"), charts=[
        contacts("fig10-contacts", "Contacts over an interaction, engine compartment", frames),
        frame_times("fig10-times", "Time of a frame, engine compartment", frames, (1e3 / 60, "paper, typical"), (1e3 / 20, "paper, slow"))])


def detailed_parts(asked):
    frames = grasp_in(asked, "detailed")
    return Findings("parts of 400,000 triangles", "here", "paper (2012)", rows=rate_rows(frames, "10 to 15", "", "70 to 80 %"), charts=[
        frame_times("detailed-times", "Time of a frame, parts of 400,000 triangles", frames, (1e3 / 12.5, "paper, typical"))])


# ---- Section 7 in numbers: contacts, clusters, thinning, and what it costs to model more than the scene needs --------------------


def side_by_side(asked, column, variants, motion):
    """The same motion under several options, beside the first one's: frame by frame from the first one's state, where the options
    have the same states (clusters), and as a whole. Whole motions that differ by rounding once part at the next frame in which a
    finger may slip or not; only the first figure compares the forms. Medians are over the frames that have contacts: the others
    cost the same everywhere."""
    found = Findings(column, "assembly and solve", "whole frame", "rows", "contacts found, kept",
                     "apart within a frame (largest, median)", "over the whole motion")
    (_, options_of_first), *_ = variants
    first = None
    for name, options in variants:
        frames = asked.play("simple", motion, options, name)
        first = first or frames
        touched = [frame for frame in frames if frame["kept"] > 0]

        def of(value):
            return median(map(value, touched))
        apart = ""
        if frames is not first and ("--clusters" in options) == ("--clusters" in options_of_first):
            within = all_of(asked.frames("simple", motion, options_of_first, name, after=("--", *asked.under(options))), "apart")
            apart = f"{mm(max(within))}, {mm(median(within))}"
        found.rows.append([
            name, us(of(lambda f: f["stages"][ASSEMBLY] + f["stages"][SOLVE])), us(of(lambda f: f["total"])), number(of(lambda f: f["rows"])),
            f"{number(of(lambda f: f['raw']))}, {number(of(lambda f: f['kept']))}", apart, mm(farthest(first, frames))])
    found.remarks = ["Times, rows and contacts: medians over the frames with contacts. Apart: the farthest that a god object is from "
                     "the same one of the first line; within a frame: both from the first line's state, in every frame."]
    return found


def growth_with_contacts(asked):
    """Every touch a row. The problems that come up in a grasp, in bins of a quarter of an octave of their contacts, so that a rare
    count does not stand for itself; some of each bin are timed apart from the simulation, as the suites time theirs."""
    ask = ("simple", asked.motion("grasp"), "--thinning off --lazy off", "growth")
    bins = {}
    for k, frame in enumerate(asked.play(*ask), 1):
        if frame["contacts"]:
            bins.setdefault(math.floor(4 * math.log2(frame["contacts"])), []).append((k, frame["contacts"], frame["stages"][ASSEMBLY]))
    taken = {}
    for which, frames in bins.items():
        stride = 1  # the smallest power of two that leaves less than twice the sample
        while math.ceil(len(frames) / stride) >= 2 * SAMPLED:
            stride *= 2
        taken[which] = [k for k, _, _ in frames[::stride]]
    with tempfile.TemporaryDirectory() as folder:
        numbers = sorted(k for of in taken.values() for k in of)
        for _ in asked.frames(*ask, after=("--keep", folder, "--time", ",".join(map(str, numbers)))) if numbers else ():
            pass
        files = [os.path.join(folder, f"{k}.h5") for k in numbers]
        solved = dict(zip(numbers, asked.lines(":times", asked.options.solver, TOLERANCE, *files)))

    chart = Chart("growth", "Assembly and solve against the number of contacts", "contacts (rows)", "time (us)", "points", "xy")
    found = Findings("contacts", "assembly, in a frame", "solve", "verified", charts=[chart])
    counts, costs = [], []
    for which, frames in sorted(bins.items()):
        verdicts = [solved[k]["verdict"] for k in taken[which]]
        assembly, solve = median(time for _, _, time in frames), median(solved[k]["solve"] for k in taken[which])
        counts.append(median(float(count) for _, count, _ in frames))
        costs.append(assembly + solve)
        chart.add(asked.options.solver, counts[-1], 1e6 * costs[-1])
        found.rows.append([number(counts[-1]), us(assembly), us(solve), ", ".join(f"{verdicts.count(v)} {v}" for v in sorted(set(verdicts)))])
    if len(counts) >= 3:
        exponent, error = power_law(counts, costs)
        found.remarks.append(f"Fitted exponent over all counts: {number(exponent)} +- {number(error, 2)} (the paper: 1, 'a linear "
                             "relationship'; a constant part for the joints pulls it down).")
    return found


def two_hands(asked):
    found = side_by_side(asked, "two hands", [
        ("two clusters", ""), ("one system", "--clusters off"), ("nnls, two clusters", "--solver nnls"),
        ("nnls, one system", "--clusters off --solver nnls")], asked.motion("two_hands"))
    found.remarks.append("The paper: clusters make computing the accelerations faster by a factor of about 1.7; that is assembly and solve.")
    return found


def thinning(asked):
    return side_by_side(asked, "contacts", [
        ("few, completed after each solve", ""), ("all that they may be completed by", "--lazy off"),
        ("a row for each triangle touched", "--thinning off")], asked.motion("grasp"))


def no_more_than_needed(asked):
    return side_by_side(asked, "model", [
        ("26 freedoms, contacts thinned and completed", ""), ("the same with all contacts", "--lazy off"),
        ("96 unknowns and 70 joint rows", "--model maximal"), ("96 unknowns, 70 joint rows, all contacts", "--lazy off --model maximal"),
        ("nnls on 26 freedoms", "--solver nnls:reduce=on"), ("nnls on 96 unknowns and 70 joint rows", "--solver nnls")], asked.motion("grasp"))


# ---- What the paper's method does as printed, and what the commit cycle makes of it ---------------------------------------------


def from_paper_to_ours(solver):
    """The paper's method, then one of its choices after the other replaced until nothing of it is left."""
    options = "--method paper --verify 0"
    steps = [("the paper, as printed", ""), (f"its solver replaced: {solver}", f"--solver {solver}"), ("and time of contact once", "--toc once --toc-of cluster"),
             ("and c of joints and limits mends their drift", "--drift on"), ("and contacts near by, with a gap", "--contacts near"),
             ("and contacts thinned", "--thinning on --lazy on"), ("and steps bounded", "--bounds on"), ("and three sub-steps", "--sub-steps 3")]
    for name, more in steps:
        options += f" {more}"
        yield name, options
    yield "and the commit cycle, limits ahead, 26 unknowns", "--damping off --straight off"
    yield "and damped or straight: zwang's own", ""


def separation(asked):
    chart = Chart("separation", "Joints of the hand: how far the phalanxes come apart", "time (s)", "widest gap of a joint (m)", log="y")
    found = Findings("method", "widest gap of a joint", "limits left by", "smallest gap", "from its target", "frames held, stuck", "contacts, most",
                     "frame, median, slowest", charts=[chart])
    for name, options in (*from_paper_to_ours(asked.options.solver),
                          ("zwang's own with the paper's solver", "--solver nnls_paper"), ("zwang's own with the linear step", "--commit printed"),
                          ("zwang's own with the paper's solver and linear step", "--solver nnls_paper --commit printed")):
        frames = asked.play("simple", asked.motion("grasp"), options, name)
        times = [frame["total"] for frame in frames]
        found.rows.append([
            name, number(most(frames, "joint")) + " m", number(most(frames, "limit")) + " rad", number(1e6 * least(frames, "gap")) + " um",
            mm(most(frames, "dist")), f"{number(total(frames, 'held'))}, {number(total(frames, 'stuck'))}", number(most(frames, "kept")),
            f"{us(median(times))}, {number(1e3 * max(times))} ms"])
        chart.add_frames(name, frames, lambda f: max(f["joint"], 1e-17))
    return found


def printed_step(asked):
    chart = Chart("printed-step", "Up to a wall: the time of contact applied once, and twice as printed", "frame", "gap (m)", log="y")
    found = Findings("frame", "gap, TOC once", "gap, TOC twice (as printed)", charts=[chart], remarks=[
        "Without contact rows, which would stop the body by themselves: what the printed step does alone."])
    [once], [twice] = asked.lines(":wall", "once"), asked.lines(":wall", "twice")
    for series, gaps in (("TOC once", once), ("TOC twice (Eq. 29-30 as printed)", twice)):
        for k, gap in enumerate(gaps):
            chart.add(series, k, gap)
    found.rows = [[number(k), mm(once[k]), mm(twice[k])] for k in (0, 1, 2, 3, 5, 10, 20, len(once) - 1)]
    return found


def swap_solvers(asked, name, method):
    chart = Chart(name, "One grasp, driven by each solver: speed against what becomes of the motion",
                  "farthest from dual_active_set's motion in the first second of contact (m)", "time of a frame's solves (us)", "points", "xy")
    found = Findings("solver", "solve, median", "frames looked at, right", "wrong, undecided", "frames held", "joints",
                     "farthest from the first, first contact second", charts=[chart])
    first = None
    for solver in ("dual_active_set", "nnls", "nnls:reduce=on", "cholesky", "cholesky:reduce=on", "newton", "nnls_paper", "pgs", "apgd",
                   "bullet_dantzig", "bullet_pgs", "nlopt_slsqp", "ipopt"):
        frames = asked.play("simple", asked.motion("grasp"), f"{method} --solver {solver}", solver, after=("--contact", "1"))
        first = first or frames
        looked_at = [frame["verified"] for frame in frames if frame["verified"]]
        right = sum(verdict in ("solved", "infeasible, proven") for verdict in looked_at)
        time, apart = median(frame["stages"][SOLVE] for frame in frames), farthest(first, frames)
        found.rows.append([solver, us(time), number(right), number(len(looked_at) - right), number(total(frames, "held")),
                           number(most(frames, "joint")) + " m", number(apart) + " m"])
        chart.add(solver, max(apart, 1e-17), 1e6 * time)
    return found


def solver_swap(asked):
    return swap_solvers(asked, "solvers", "--verify 20")


def solvers_of_the_paper(asked):
    return swap_solvers(asked, "solvers-paper", "--method paper")


# ---- What a hand does to things, and things to a hand ----------------------------------------------------------------------------


def artificial_friction(asked):
    frames = asked.play("wall", asked.motion("slide"))
    touched = [(before, frame) for before, frame in zip(frames, frames[1:]) if frame["touches"]]
    lost = max([0.0, *all_of((frame for _, frame in touched), "slide")])
    way = sum(distance(frame["target"][0], before["target"][0]) for before, frame in touched)
    chart = Chart("friction", "How far a pressed hand lags behind its target along a frictionless plane", "time (s)", "distance (m)", log="y")
    chart.add_frames("of the centre of mass", frames, lambda f: max(f["slide"], 1e-20))
    return Findings("sliding on a frictionless plane", "here", "paper (2012)", charts=[chart], rows=[
        ["way of the pressed hand's target", number(way) + " m", ""],
        ["farthest that the hand lags along the plane", number(lost) + " m", ""],
        ["share of the way", number(lost / way if way else math.nan), "artificial friction does not occur"]])


def rate_of_a_push(asked):
    chart = Chart("rates", "One push of a box at three rates", "time (s)", "way of the box (m)")
    found = Findings("rate", "box moved", "fastest", "fastest against the hand", "worst balance of impulses", charts=[chart])
    for rate in (250, 500, 1000):
        name = number(rate) + " Hz"
        frames = asked.play("box", "push", f"--rate {rate}", name)
        start, fastest = frames[0]["loose"][0], most(frames, "speed")
        found.rows.append([name, mm(distance(frames[-1]["loose"][0], start), 4), number(fastest) + " m/s", number(fastest / 0.4),
                           number(most(frames, "impulse"))])
        chart.add_frames(name, frames, lambda f: distance(f["loose"][0], start))
    return found


def recordings(asked):
    found = Findings("recording, scene", "frames", "that touch", "target deepest inside", "smallest gap", "joints", "limits left by", "held", "stuck",
                     "median rate", "slowest")
    files = sorted(glob.glob(os.path.join(glob.escape(asked.data), "motion_leap_bones", "*.json")))
    if not files:
        found.remarks.append(f"There are no recordings in {asked.data}.")
    for file in files:
        stem = os.path.splitext(os.path.basename(file))[0]
        for scene in ("simple", "engine"):
            frames = asked.play(scene, file, what=stem)
            middle, _, slowest, _ = rates(frames)
            found.rows.append([
                f"{stem}, {scene}", number(len(frames)), number(touching(frames)), mm(most(frames, "depth")), number(1e6 * least(frames, "gap")) + " um",
                number(most(frames, "joint")) + " m", number(most(frames, "limit")) + " rad", number(total(frames, "held")),
                number(total(frames, "stuck")), number(middle) + " Hz", number(slowest) + " Hz"])
    return found


# ---- What a simpler law of friction costs: lift, creep, distance and time of the pyramid, the cone and Coulomb's law --------------

READINGS = (("pyramid", "pyramid", "dual_active_set"), ("convex", "convex", "cone"), ("Coulomb", "coulomb", "cone"))  # exact under the law
MEASURES = {"lift": "lift (m/s^2)", "creep": "creep (m/s^2)", "distance": "|z - z*| / s (1)", "time": "time (neutral kernels)"}
LEAST_SHOWN = 1e-9  # below, differences are those of the reference's rounding
SWEEPS = {"mu": ("mu, boxes pushed with up to half their weight", "stack(boxes=3,push=0.5,seed=1..3,mu={})", (0.03125, 0.0625, 0.125, 0.25, 0.5, 1, 2)),
          "push": ("largest push (weights), mu = 1/4", "stack(boxes=3,mu=0.25,seed=1..3,push={})", (0.0625, 0.125, 0.25, 0.5, 1, 2, 4))}


def right(prices):
    return sum(price["verdict"] in ("solved", "consistent") for price in prices)


def paragraph(found, scenes, left_out):
    def largest(law, key):
        return number(max(price[key] for price in found[law]), 2)

    def time(law):
        return number(median(price["time"] for price in found[law]), 2)
    return (f"On {scenes} stacks of three boxes (12 contacts; mu from 1/32 to 2, pushes up to four weights) the convex law is off a proven solution of "
            f"Coulomb's law by up to {largest('convex', 'distance')} of the motion, the pyramid of four facets by up to {largest('pyramid', 'distance')}; "
            f"contacts that slide open by up to {largest('convex', 'lift')} and {largest('pyramid', 'lift')} m/s^2 where they should stay closed, and slip "
            f"by up to {largest('convex', 'creep')} and {largest('pyramid', 'creep')} m/s^2 otherwise. Where nothing slides all laws agree. Median times "
            f"are {time('pyramid')} (pyramid), {time('convex')} (convex) and {time('Coulomb')} (Coulomb) neutral kernels; Coulomb's answers are proven or "
            f"consistent on {right(found['Coulomb'])} of {scenes}." +
            (f" On {left_out} more stacks no solution was proven; they are left out." if left_out else ""))


def laws_of_friction(asked):
    charts = {(measure, sweep): Chart(f"laws-{measure}-{sweep}", "What a simpler law of friction costs: pyramid, cone and Coulomb's law", x, y, "points", "xy",
                                      figure="laws")
              for measure, y in MEASURES.items() for sweep, (x, _, _) in SWEEPS.items()}
    found = Findings("scene", "law", "solver", "right", "lift (m/s^2)", "creep (m/s^2)", "|z - z*| / s", "time (kernels)", charts=charts.values())
    of_all, left_out = {law: [] for law, _, _ in READINGS}, 0
    for sweep, (_, spec, values) in SWEEPS.items():
        for x in values:
            scene = spec.format(number(x, 6))
            answers = list(asked.lines(":prices", scene, *(word for _, law, solver in READINGS for word in (law, solver))))
            left_out += answers.count([])
            for k, (law, _, solver) in enumerate(READINGS):
                prices = [answer[k] for answer in answers if answer]
                of_all[law] += prices
                middles = {measure: median(price[measure] for price in prices) for measure in MEASURES}
                for measure, value in middles.items():
                    if value >= LEAST_SHOWN:
                        charts[measure, sweep].add(law, x, value)
                if prices:
                    found.rows.append([scene, law, solver, f"{right(prices)} of {len(prices)}", *map(number, middles.values())])
    if scenes := len(of_all["Coulomb"]):
        found.remarks.append(paragraph(of_all, scenes, left_out))
    return found


# ---- Soft pads -------------------------------------------------------------------------------------------------------------------

PADS = (0, 100_000, 10_000, 2_000)  # N/m, of each contact; 0: hard
HOLDERS = (("coulomb", "cone"), ("convex", "cone"), ("coulomb", "alart_curnier"))  # others take minutes for a lift
LIFTED = 0.15  # m: of the 0.2 m of the motion
LIMITED = 6   # of the origins of a frame
RESTS, GRASPED = 4.2, 3  # s into the motion: the targets stand still until 5 s; the box is up


def soft_pads(asked):
    charts = [Chart(f"pads-{key}", "A box lifted on soft finger pads", "stiffness of a contact's pad (N/m)", label, "points", "x", figure="pads")
              for key, label in (("grip", "force of the grip (N)"), ("creep", "creep (um/s)"), ("withstands", "largest disturbance held (N)"))]
    found = Findings("pads", "law, solver", "lifted", "grip", "creep, median and largest", "withstands", "slips below mu", "frames limited",
                     "solve, median", charts=charts)
    for law, solver in HOLDERS:
        for stiffness in PADS:
            name = f"{law}, {solver}"
            pads = f"{number(stiffness)} N/m" if stiffness else "hard"

            def lift(mu, length, *more):
                return asked.play("box", "lift", f"--rate 500 --mu {mu:g} --law {law} --solver {solver} --pads {stiffness}", f"{pads}, {name}",
                                  after=(*(() if asked.options.seconds else ("--seconds", f"{length:g}")), *more))

            def height(frames):
                return frames[-1]["loose"][0][2] - frames[0]["loose"][0][2]
            frames = lift(0.8, 5, "--withstands", "0.1")
            rests = [frame for frame in frames if frame["t"] >= RESTS]
            creep = [1e6 * frame["creep"] for frame in rests if frame["creep"] > 0] or [0.0]
            firm = [frame["withstands"] for frame in rests if "withstands" in frame] or [0.0]
            slips, holds = 0, 80  # hundredths
            while height(frames) > LIFTED and holds - slips > 1:
                middle = (slips + holds) // 2
                if height(lift(middle / 100, GRASPED)) > LIFTED:
                    holds = middle
                else:
                    slips = middle
            grip = median(frame["grip"] for frame in rests)
            found.rows.append([pads, name, mm(height(frames)), number(grip) + " N", f"{number(median(creep))}, {number(max(creep))} um/s",
                               number(median(firm)) + " N", number(holds / 100) if height(frames) > LIFTED else "",
                               number(sum(frame["origin"] == LIMITED for frame in frames)), us(median(frame["stages"][SOLVE] for frame in frames))])
            if stiffness:
                for chart, value in zip(charts, (grip, median(creep), median(firm))):
                    chart.add(name, stiffness, value)
    return found


# ---- All of them, in the order of the paper: the question; where the paper answers it, and how -------------------------------------

QUESTIONS = {
    "fig8": ("How many contacts are there, and what does a frame cost, in the simple scene?", "Fig. 8: above 600 Hz on average, at least 100 Hz", simple_scene),
    "fig9": ("Where does the time of a frame go?", "Fig. 9: about 40 % in collision detection", stages),
    "fig10": ("And in an engine compartment of a million triangles?", "Fig. 10: 50 to 70 Hz, below 20 Hz near detailed parts", engine),
    "detailed": ("And on parts of 400,000 triangles?", "Section 7: 10 to 15 Hz", detailed_parts),
    "growth": ("How does the time grow with the number of contacts?", "Section 7: linearly", growth_with_contacts),
    "two-hands": ("What do clusters buy when there are two hands?", "Section 7: a factor of 1.7", two_hands),
    "thinning": ("What do fewer contacts per body cost, and buy?", "Section 7: 'further potential for optimization'", thinning),
    "separation": ("Do the phalanxes come apart?", "Section 7: slightly, in some situations", separation),
    "printed-step": ("What do Eq. 29-30 do as printed, with the time of contact in both?", "Section 6.3", printed_step),
    "solvers": ("Does it matter which solver drives the hand?", "Section 4.1 uses NNLS (TSNNLS)", solver_swap),
    "solvers-paper": ("And where the rest is the paper's method, too?", "Section 4.1", solvers_of_the_paper),
    "minimal": ("What does it cost to model more than the scene needs?", "Section 5: clusters", no_more_than_needed),
    "friction": ("Does a hand stick to a frictionless plane?", "Section 7: no artificial friction", artificial_friction),
    "rates": ("Does the same push move a box equally at every rate?", "Section 6.2: forces are handed over", rate_of_a_push),
    "laws": ("What does a simpler law of friction cost?", "Section 7: friction is left out", laws_of_friction),
    "pads": ("What do soft finger pads do to a grip?", "Section 6.2: bodies are rigid", soft_pads),
    "recordings": ("Do recorded hands stay out of the objects, whole and unstuck?", "Section 7: always non-penetrating", recordings),
}


class Options(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message.removeprefix('argument ')} (./zwang experiment --help)")


def seconds(text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} should be a number above 0 s")
    return value


def main(data, circumstances, program, *words):
    questions = "\n".join(f"  {name:13} {line}\n{'':16}paper: {paper}" for name, (line, paper, _) in QUESTIONS.items())
    options = Options(
        prog="./zwang experiment", usage="./zwang experiment NAME [OPTIONS]", allow_abbrev=False,
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, max_help_position=34, width=100),
        description="Asks a question that the paper answers, and puts the answer of a run here beside it: a\ntable, charts.",
        epilog=f"""Examples:
  ./zwang experiment fig8
  ./zwang experiment separation --out docs/figures
  ./zwang experiment all --seconds 2

Questions:
{questions}""")
    options.add_argument("NAME", help="of the question, or all")
    options.add_argument("--out", default="results/experiments", metavar="DIR", help="folder of the table and the charts; default: results/experiments")
    options.add_argument("--solver", metavar="NAME", help="of the questions that compare no solvers")
    options.add_argument("--motion", default="", metavar="FILE", help="a recording in place of the question's own motion")
    options.add_argument("--parts", default="", metavar="DIR", help="folder of real parts in place of procedural ones")
    options.add_argument("--seconds", type=seconds, metavar="S", help="of motion; above 0 s; default: all of it")
    asked = options.parse_args(words)
    names = [*QUESTIONS, "all"]
    if asked.NAME not in names:
        close = difflib.get_close_matches(asked.NAME, names, 1)
        fail(f"no question '{asked.NAME}'" + (f"; did you mean '{close[0]}'?" if close else "") + " (./zwang experiment --help lists all)")
    # What decides the answer, for whoever repeats it.
    chosen = "".join(f" --{key} {number(value) if key == 'seconds' else value}" for key in ("solver", "motion", "parts", "seconds")
                     if (value := getattr(asked, key)))
    asked.solver = asked.solver or "dual_active_set"
    # A place that cannot be written is said before minutes are spent.
    try:
        os.makedirs(asked.out, exist_ok=True)
        tempfile.TemporaryFile(dir=asked.out).close()
    except OSError as bad:
        fail(f"{asked.out}: {bad.strerror}", BAD_FILE)
    answered = 0
    for name in QUESTIONS if asked.NAME == "all" else (asked.NAME,):
        question, paper, answer = QUESTIONS[name]
        print(question, flush=True)
        ask = Asked(data, circumstances, program, asked)
        try:
            found = answer(ask)
            print(found.text(), end="")
            for file in found.record(name, question, paper, f"./zwang experiment {name}{chosen}", ask):
                print(f"  {file}")
            answered += 1
        except Unanswered as ended:
            [code] = ended.args
            if code == STOPPED:
                print(f"Stopped within '{name}'; " + (f"what was finished before is in {asked.out}" if answered else "nothing was finished"))
            return code
        print(flush=True)
    return 0
