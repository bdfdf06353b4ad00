#!/usr/bin/python3
"""./zwang experiment acary DIR...: what Acary, Bremond and Huber's comparison (RR-9118, 2017) says, checked on the files of DIR.

Runs solvers of Coulomb's law and of the convex law on every file, has each answer judged, and prints each claim as
confirmed, refuted or undecided, with counts and bands (docs/acary.md).
"""
import argparse
import concurrent.futures
import csv
import hashlib
import json
import math
import pathlib
import shutil
import statistics
import subprocess
import sys
import threading
import time

import h5py
import numpy as np

import chart
import feasibility
import files
import variational

# The report's families, and the solvers here that belong to them. Those of the last line are of none.
FAMILIES = {
    "VI": ("fixed points of a variational inequality", tuple(variational.RULES)),
    "NSN": ("nonsmooth Newton", ("alart_curnier", "siconos_nsn_ac", "siconos_nsn_fb")),
    "NSGS": ("Gauss-Seidel over contacts", ("nsgs", "siconos_nsgs", "siconos_global_nsgs")),
    "OPT": ("convex problems in an outer fixed point", ("fixed_point",)),
    "new": ("since the report: interior point with Newton, alternating directions", ("cone", "admm", "siconos_admm", "siconos_global_admm", "siconos_soclcp")),
}
RIGHT = ("solved", "rows off", "consistent")
LOOSE, TIGHT = 1e-4, 1e-8  # the two accuracies of the report
MOST = 0.8                 # share of problems that "robust" asks for
SMALLEST = 30              # problems that the solvers in NumPy are tried on
SHARE = 0.2                # of the time limit that they get
FEW = 10                   # problems, below which nobody is called the best of all
DENSE_CONTACTS = 1.5       # rows a rank: a high contact density
SLOW = 2                   # factor in time that "slow" asks for
ROUNDING = 1e-12           # of W, relative to its largest entry: symmetric; of rows, relative to the motion: as good as exact
NORMAL = 1.96              # bands are of 95 %
EDGE = 1e-6                # of a force against its cone: sliding; against the largest force: none
RANK_LIMIT = 3e6           # entries of J
NEWS = 20                  # s between lines of progress


def wilson(k, n):
    """Band of 95 % of a share, k of n."""
    if not n:
        return 0.0, 1.0
    z2, p = NORMAL**2, k / n
    middle, half = (p + z2 / (2 * n)) / (1 + z2 / n), NORMAL / (1 + z2 / n) * math.sqrt(p * (1 - p) / n + z2 / (4 * n * n))
    return max(0.0, middle - half), min(1.0, middle + half)


def newcombe(k1, n1, k2, n2):
    """Band of 95 % of the difference of two shares."""
    if not n1 or not n2:
        return -1.0, 1.0
    (l1, u1), (l2, u2), d = wilson(k1, n1), wilson(k2, n2), k1 / n1 - k2 / n2
    return d - math.hypot(k1 / n1 - l1, u2 - k2 / n2), d + math.hypot(u1 - k1 / n1, k2 / n2 - l2)


def word(low, high, mark):
    return "confirmed" if low > mark else "refuted" if high < mark else "undecided"


class File:
    """What is known of one problem without any solver."""

    def __init__(self, path, name):
        self.problem, self.name, self.path = files.read(path), name, path
        p = self.problem
        self.n, self.rows, self.contacts = p.J.shape[1], len(p.J), len(p.contacts)
        self.asymmetry = files.asymmetry(p.notes)
        self.local = any(note.startswith("Delassus form") for note in p.notes)
        self.largest = float((p.J**2).sum(1).max(initial=0)) if self.local else math.nan
        self.rank = None
        if p.J.size <= RANK_LIMIT:
            lengths = np.linalg.norm(p.J, axis=1, keepdims=True)
            self.rank = int(np.linalg.matrix_rank(p.J / np.where(lengths > 0, lengths, 1)))
        self.full = self.rank == self.rows
        self.shares = self.of_reference(path)

    def of_reference(self, path):
        """Shares of contacts that stick, slide and are open in the stored solution, or None."""
        with h5py.File(path) as file:
            stored = file["zwang"].get("reference")
            if stored is None or "lambda" not in stored or len(stored["lambda"]) != self.rows or not self.contacts:
                return None
            force = stored["lambda"][:]
        most, count = np.abs(force).max(initial=0), [0, 0, 0]
        for contact, mu in zip(self.problem.contacts, self.problem.mu):
            normal, slip = force[contact[0]], np.linalg.norm(force[contact[1:]])
            count[2 if normal <= EDGE * most else 1 if slip >= (1 - EDGE) * mu * normal else 0] += 1
        return [c / self.contacts for c in count]

    def take_modes(self, modes):
        """Shares by the modes of a proven solution, where the stored one says none."""
        if self.shares is None and len(modes) == self.contacts > 0:
            self.shares = [modes.count(mode) / self.contacts for mode in ("stick", "slide", "open")]


def records(folders):
    """The rows of runs, whose problem files are named from here."""
    rows = []
    for folder in folders:
        for line in (folder / "results.jsonl").read_text().splitlines():
            try:
                row = json.loads(line)
            except ValueError:  # the last one of a process that was ended
                continue
            rows.append({**row, "problem_file": folder / row["problem_file"]})
    return rows


def proof_of(row):
    """(by how much the rows of the proven solution are off, how far it is from the numbers stored of it), relative to the motion; None.

    It is the reference's, or that of a solution near the answer.
    """
    if row["reference"] and row["reference_bound"] is not None:
        return 0.0, row["reference_bound"]
    return None if row["delta"] is None or row["radius"] is None or row["delta"] > ROUNDING else (row["delta"], row["radius"])


def nearer(one, other):
    return min((proof for proof in (one, other) if proof), default=None)


class Study:
    def __init__(self, runs, judged):
        self.rows, self.files, self.references = {}, {}, {}
        for row in records(runs) + records(judged):
            if row["solver"].startswith("recorded:") or row["claimed"] == "unsolved":
                continue
            row["solver"] = row["solver"].partition("@")[0]  # judge tells files of one solver apart by their names
            name = row["problem"].removesuffix(" (convex)").removesuffix(" (coulomb)")
            self.rows[row["law"], name, row["solver"], row["tolerance"]] = row
            if row["law"] == "coulomb" and name not in self.files:
                self.files[name] = File(row["problem_file"], name)
            if row["law"] == "coulomb":
                self.references[name] = nearer(self.references.get(name), proof_of(row))
        known = [v for _, family in FAMILIES.values() for v in family]  # the report's order, then others
        self.solvers = sorted(dict.fromkeys(key[2] for key in self.rows), key=lambda v: (known + [v.partition(":")[0]]).index(v.partition(":")[0]))

    def row(self, solver, tolerance, name, law="coulomb"):
        return self.rows.get((law, name, solver, tolerance))

    @staticmethod
    def right(row):
        return row is not None and row["claimed"] == "solved" and row["verified"] in RIGHT

    def family(self, family):
        return [s for s in self.solvers if s.partition(":")[0] in FAMILIES[family][1]]

    def tried(self, family, name):
        return any((row := self.row(s, TIGHT, name)) is not None and row["claimed"] != "unsupported" for s in self.family(family))

    def seconds(self, solvers, tolerance, name):
        """Of the fastest that is right; infinite where none is."""
        return min((row["solve_s"] for s in solvers if self.right(row := self.row(s, tolerance, name))), default=math.inf)

    def names(self, which=lambda file: True):
        return [name for name, file in self.files.items() if which(file)]

    def solved(self, family, tolerance, names):
        """(problems solved, tried)"""
        names = [name for name in names if self.tried(family, name)]
        return sum(self.seconds(self.family(family), tolerance, name) < math.inf for name in names), len(names)

    def faster(self, one, other, tolerance, names, factor=1.0):
        """(problems on which family one is faster than the other by the factor, and on which it is not); a failure is slowest."""
        first = second = 0
        for name in names:
            a, b = (self.seconds(self.family(f), tolerance, name) for f in (one, other))
            if min(a, b) < math.inf and self.tried(one, name) and self.tried(other, name):
                first, second = first + (a * factor < b), second + (a * factor >= b)
        return first, second


def full(file):
    return file.rank is not None and file.full


def deficient(file):
    return file.rank is not None and not file.full


class Checks:
    """The claims, in the report's order. Each check returns (word, what was counted)."""

    def __init__(self, study):
        self.study, self.done = study, []

    def add(self, where, claim, result):
        self.done.append({"where": where, "claim": claim, "verdict": result[0], "found": result[1]})

    # Kinds of checks.
    @staticmethod
    def share(k, n, mark, what):
        """Is it so on more than the share `mark`?"""
        low, high = wilson(k, n)
        return (word(low, high, mark) if n else "undecided", f"{k} of {n} {what} ({low:.2f} to {high:.2f}; mark {mark:g})" if n else f"no such problem: {what}")

    @staticmethod
    def less(k1, n1, k2, n2, what):
        """Is the first share below the second?"""
        low, high = newcombe(k2, n2, k1, n1)
        return (word(low, high, 0) if n1 and n2 else "undecided", f"{what}: {k1} of {n1} against {k2} of {n2}" + (f" (apart by {low:+.2f} to {high:+.2f})" if n1 and n2 else ""))

    def paired(self, first, second, what):
        return self.share(first, first + second, 0.5, what)

    @staticmethod
    def all_hold(k, n, what):
        """A claim about all: one that is otherwise refutes it."""
        return ("undecided" if not n else "confirmed" if k == n else "refuted", f"{k} of {n} {what}")

    @staticmethod
    def untested(why):
        return "undecided", why

    def run(self):
        s, names = self.study, self.study.names()
        some, none = s.names(full), s.names(deficient)
        many = [name for name in names if s.files[name].contacts > 1]

        # 10.3, the table of test sets
        over = [f for f in s.files.values() if not f.local and f.rank is not None and f.rows > f.n]
        self.add("table of sets", "where contact unknowns exceed the freedoms, the rank of W is near the number of freedoms",
                 self.share(sum(f.rank >= 0.9 * f.n for f in over), len(over), 0.5, "global files with more rows than freedoms have a rank of at least 0.9 of these"))
        under = [f for f in s.files.values() if not f.local and f.rank is not None and f.rows <= f.n]
        self.add("table of sets", "where the freedoms exceed the contact unknowns (flexible bodies), W has full rank",
                 self.all_hold(sum(f.full for f in under), len(under), "global files with no more rows than freedoms have full rank"))
        stored = [f for f in s.files.values() if f.asymmetry is not None]
        for label, marks, expected in (("Capsules, Chain, LowWall, Chute, Cubes: W is not symmetric", ("capsules", "chain", "lowwall", "chute", "cube"), True),
                                       ("BoxesStack, PerioBox, Bridge, Aqueduct: W is symmetric to rounding", ("boxesstack", "periobox", "bridge", "aqueduc"), False)):
            named = [f for f in stored if any(m in f.name.lower() for m in marks)]
            worst = max((f.asymmetry for f in named), default=0)
            self.add("table of sets", label, self.all_hold(sum((f.asymmetry > ROUNDING * f.largest) == expected for f in named), len(named),
                                                           f"files that store W and are named so; at most {worst:.1e} off"))

        # Unsolved problems
        for tolerance in (LOOSE, TIGHT):
            solved = [name for name in names if s.seconds(s.solvers, tolerance, name) < math.inf]
            self.add("campaign; comparison 1", f"every problem is solved by at least one solver, at {tolerance:g}",
                     self.all_hold(len(solved), len(names), f"problems, judged; not {', '.join(n for n in names if n not in solved) or 'any'}"[:300]))
        best = [min(s.solvers, key=lambda v: s.seconds([v], TIGHT, name)) for name in names if s.seconds(s.solvers, TIGHT, name) < math.inf]
        most = max(((best.count(v), v) for v in set(best)), default=(0, ""))
        self.add("comparison 1", "no solver outperforms all others on all problems",
                 ("undecided" if len(best) < FEW else "refuted" if most[0] == len(best) else "confirmed", f"the most often fastest, {most[1]}, is so on {most[0]} of {len(best)}"))

        # Variational inequalities
        where = "variational inequalities"
        fixed, adapting = (self.of_rules(rules, LOOSE) for rules in (["vi_fixed_step"], ["vi_fixed_point", "vi_extragradient"]))
        self.add(where + " 1", "a step that is fixed diverges often, one that adapts itself does not", self.less(*fixed, *adapting, "runs that are right at 1e-4, fixed and adapting"))
        self.add(where + " 2", "with steps that adapt themselves these solvers are robust", self.share(*s.solved("VI", LOOSE, names), MOST, "problems solved at 1e-4"))
        self.add(where + " 2", "and slow: tight tolerances are not reached in time",
                 self.less(*s.solved("VI", TIGHT, names), *s.solved("VI", LOOSE, names), "solved at 1e-8 and at 1e-4"))
        work = {rule: {n: row["iterations"] for n in names if s.right(row := s.row(rule, LOOSE, n))} for rule in variational.RULES}
        both = [(work["vi_extragradient"][n], work["vi_fixed_point"][n]) for n in work["vi_fixed_point"] if n in work["vi_extragradient"]]
        self.add(where + " 3", "the extragradient is faster than the fixed point",
                 self.paired(sum(a < b for a, b in both), sum(a > b for a, b in both), "problems take fewer products with W"))
        both = [(work["vi_fixed_point"][n], work["vi_fixed_point_2"][n]) for n in work["vi_fixed_point"] if n in work["vi_fixed_point_2"]]
        self.add(where + " 4", "the two rules for the steps hardly differ",
                 self.share(sum(max(p) <= SLOW * min(p) for p in both), len(both), 0.5, f"problems take products with W within a factor of {SLOW}"))

        # Gauss-Seidel
        self.add("Gauss-Seidel, local solver 1", "NSGS is robust at 1e-4", self.share(*s.solved("NSGS", LOOSE, names), MOST, "problems solved"))
        self.add("Gauss-Seidel, local solver 2", "NSGS has difficulties at 1e-8",
                 self.less(*s.solved("NSGS", TIGHT, names), *s.solved("NSGS", LOOSE, names), "solved at 1e-8 and at 1e-4"))
        ended = [row for solver in s.family("NSGS") for name in names if (row := s.row(solver, TIGHT, name)) and row["claimed"] not in ("solved", "unsupported")]
        self.add("Gauss-Seidel, local solver 2", "where NSGS does not get there, it is for slow convergence, not divergence",
                 self.share(sum(r["claimed"] in ("time limit", "iteration limit") for r in ended), len(ended), 0.5, "failures at 1e-8 are limits of time or sweeps"))
        for claim in ("the local tolerance changes the time of NSGS", "rho = 1 in the local solver harms rigid sets", "the shuffled order harms rigid sets", "and helps flexible ones", "no local solver outperforms the others",
                      "over-relaxation helps for some omega, and harms for others"):
            self.add("Gauss-Seidel, parameters", claim, self.untested("NSGS here solves each contact exactly, in order: it has no such parameter"))

        # Newton
        self.add("Newton 1; conclusion", "nonsmooth Newton is robust where W has full rank, at 1e-8", self.share(*s.solved("NSN", TIGHT, some), MOST, "full-rank problems solved"))
        self.add("Newton 2; conclusion", "and is not where W is deficient",
                 self.less(*s.solved("NSN", TIGHT, none), *s.solved("NSN", TIGHT, some), "solved at 1e-8, deficient and full rank"))
        k, n = s.solved("NSN", TIGHT, none)
        self.add("Newton 2", "where W is deficient nonsmooth Newton fails on most", self.share(n - k, n, 0.5, "deficient problems not solved at 1e-8"))
        if "siconos_nsn_fb" in s.solvers:
            sets = [name for name in names if any(m in name.lower() for m in ("kaplas", "capsules"))]
            k = sum(s.seconds(["siconos_nsn_fb"], TIGHT, name) < math.inf for name in sets)
            self.add("Newton 4", "on KaplasTower and Capsules Fischer-Burmeister's Newton solves more than 80 %", self.share(k, len(sets), MOST, "solved by siconos_nsn_fb"))
        else:
            self.add("Newton 4", "on KaplasTower and Capsules Fischer-Burmeister's Newton solves more than 80 %", self.untested("siconos_nsn_fb is not built in"))
        high, low = ([n for n in none if (s.files[n].rows > DENSE_CONTACTS * s.files[n].rank) == dense] for dense in (True, False))
        self.add("Newton, general conclusion", f"deficient rank: the more contacts the worse, above and below {DENSE_CONTACTS} rows a rank",
                 self.less(*s.solved("NSN", TIGHT, high), *s.solved("NSN", TIGHT, low), "solved at 1e-8"))
        pair = ("siconos_nsn_ac", "siconos_nsn_fb")
        if set(pair) <= set(s.solvers):
            times = [(s.seconds([pair[0]], TIGHT, n), s.seconds([pair[1]], TIGHT, n)) for n in some]
            self.add("Newton 1", "full rank: Alart-Curnier's function is faster than Fischer-Burmeister's",
                     self.paired(sum(a < b for a, b in times), sum(a > b for a, b in times), "full-rank problems, at 1e-8"))
        else:
            self.add("Newton 1", "full rank: Alart-Curnier's function is faster than Fischer-Burmeister's", self.untested("siconos_nsn_ac and siconos_nsn_fb are not built in"))
        for claim in ("a line search slows Newton down on flexible sets", "and makes it more robust on rigid ones", "a start by a fixed point makes it more robust"):
            self.add("Newton 1, 3", claim, self.untested("whole steps from zero alone are built in"))

        # Proximal points
        for claim in ("the proximal point helps Newton on rigid sets", "and has no use where W has full rank", "no rule for its parameter serves all sets",
                      "Gauss-Seidel gains little by it",
                      "rigid sets at 1e-8: proximal points are the most efficient"):
            self.add("proximal points", claim, self.untested("no solver of that family is built in"))

        # Optimization
        self.add("optimization 2", "convex problems in an outer fixed point are robust", self.share(*s.solved("OPT", LOOSE, names), MOST, "problems solved at 1e-4"))
        self.add("optimization 2", f"but slow: the best other family of the report is faster by more than {SLOW}",
                 self.paired(*self.against_best("OPT", LOOSE, names), "problems on which another is"))
        convex = [(s.row(v, TIGHT, name, "convex"), s.row(v, TIGHT, name)) for v in s.solvers for name in names]
        convex = [(a, b) for a, b in convex if a and b and "unsupported" not in (a["claimed"], b["claimed"])]
        good = [(s.right(a), s.right(b)) for a, b in convex]
        self.add("optimization 1", "the convex relaxation is easier: the same solver, the same file",
                 self.paired(sum(a and not b for a, b in good), sum(b and not a for a, b in good), "runs that only one law lets solve are the convex law's"))
        self.add("optimization 1", "the lack of convexity is not the only difficulty: the relaxation is not always solved, either",
                 ("undecided" if not good else "confirmed" if any(not a for a, _ in good) else "refuted", f"{sum(not a for a, _ in good)} of {len(good)} runs of the convex law fail"))
        high, low = ([name for name in many if s.files[name].shares and (s.files[name].shares[1] > 0.5) == slides] for slides in (True, False))
        self.add("optimization 3", "where few contacts slide the outer fixed point does better",
                 self.less(*s.solved("OPT", TIGHT, high), *s.solved("OPT", TIGHT, low), "solved at 1e-8, more and less than half sliding"))

        self.add("optimization 3", "which of the three outer iterations is best depends on the set", self.untested("one is built in"))
        local = s.names(lambda f: f.contacts == 1 and f.asymmetry is not None)
        self.add("comparison 5", "local problems of one contact: the outer fixed point solves what Newton does not",
                 self.paired(*self.only(("OPT", "NSN"), TIGHT, local), "problems of one contact that only one family solves are its"))

        # Between the families
        self.add("comparison 2", "full rank: nonsmooth Newton is faster than Gauss-Seidel, at 1e-8",
                 self.paired(*s.faster("NSN", "NSGS", TIGHT, some), "full-rank problems"))
        grows = [(s.seconds(s.family("NSGS"), TIGHT, n) / s.seconds(s.family("NSN"), TIGHT, n), s.seconds(s.family("NSGS"), LOOSE, n) / s.seconds(s.family("NSN"), LOOSE, n))
                 for n in some if all(s.seconds(s.family(f), t, n) < math.inf for f in ("NSN", "NSGS") for t in (LOOSE, TIGHT))]
        self.add("comparison 2", "its lead grows from 1e-4 to 1e-8", self.paired(sum(a > b for a, b in grows), sum(a <= b for a, b in grows), "full-rank problems solved by both"))
        self.add("comparison 3", "deficient rank at 1e-4: Gauss-Seidel is faster than Newton", self.paired(*s.faster("NSGS", "NSN", LOOSE, none), "deficient problems"))
        self.add("comparison 3", "deficient rank at 1e-4: and than convex problems in an outer fixed point",
                 self.paired(*s.faster("NSGS", "OPT", LOOSE, none), "deficient problems"))
        self.add("comparison 5", "where W is far from symmetric, convexification is the most robust", self.untested("W is made symmetric on reading: what is solved is (W + W')/2"))
        self.add("conclusion", "deficient rank is the main cause of slow convergence and failure",
                 self.less(*self.runs_right(none), *self.runs_right(some), "runs of the report's families that are right at 1e-8, deficient and full rank"))
        self.add("conclusion", "... more than contact status", self.cause(many))
        self.add("measure of error", "a residual of the natural map below tolerance times |q| is a solved problem", self.trust())
        return self.done

    def of_rules(self, rules, tolerance):
        rows = [row for rule in rules for name in self.study.files if (row := self.study.row(rule, tolerance, name))]
        return sum(map(self.study.right, rows)), len(rows)

    def only(self, pair, tolerance, names):
        """(problems that family one alone solves, that the other alone does)"""
        got = [[self.study.seconds(self.study.family(f), tolerance, name) < math.inf for f in pair] for name in names]
        return sum(a and not b for a, b in got), sum(b and not a for a, b in got)

    def against_best(self, family, tolerance, names):
        others = [v for f in ("NSN", "NSGS") for v in self.study.family(f)]
        slower = faster = 0
        for name in names:
            mine, best = self.study.seconds(self.study.family(family), tolerance, name), self.study.seconds(others, tolerance, name)
            if best < math.inf:
                slower, faster = slower + (mine > SLOW * best), faster + (mine <= SLOW * best)
        return slower, faster

    def runs_right(self, names):
        rows = [row for f in ("NSN", "NSGS", "OPT") for v in self.study.family(f) for name in names
                if (row := self.study.row(v, TIGHT, name)) and row["claimed"] != "unsupported"]
        return sum(map(self.study.right, rows)), len(rows)

    def cause(self, names):
        """Is the gap by rank wider than that by the share of sliding contacts?"""
        s = self.study
        gaps = {}
        known = [n for n in names if s.files[n].shares and s.files[n].rank is not None]
        for what, split in (("rank", lambda f: f.full), ("sliding", lambda f: f.shares[1] <= 0.5)):
            (a, b), (c, d) = (self.runs_right([n for n in known if split(s.files[n]) == side]) for side in (True, False))
            if not b or not d:
                return self.untested("not both kinds are among the files")
            gaps[what] = (a / b - c / d, newcombe(a, b, c, d))
        (_, (low, high)), (_, (l2, h2)) = gaps["rank"], gaps["sliding"]
        text = "; ".join(f"right more often by {g:+.2f} ({l:+.2f} to {h:+.2f}) {w}" for (g, (l, h)), w in
                         zip(gaps.values(), ("at full rank", "where at most half slide")))
        return ("confirmed" if low > max(h2, 0) else "refuted" if high < l2 else "undecided"), text

    def trust(self):
        """Of the solvers that stop by the report's measure; what the others call solved beside it."""
        text, verdict = [], "undecided"
        for theirs in (True, False):
            claims = [row for (law, _, solver, _), row in self.study.rows.items()
                      if law == "coulomb" and row["claimed"] == "solved" and (solver in variational.RULES) == theirs]
            false = [row for row in claims if row["verified"] == "wrong"]
            off = max((row["z_error"] for row in false if row["z_error"] is not None), default=None)
            text.append(f"of {len(claims)} answers that {'it' if theirs else 'other solvers'} called solved {len(false)} are wrong"
                        + (f", by up to {off:.1e} of the motion" if off is not None else ""))
            if theirs and claims:
                verdict = "refuted" if false else "confirmed"
        return verdict, "; ".join(text)


def tables(study, counted):
    """(rows of files, rows of solvers) as dictionaries."""
    by_file = []
    for name, f in study.files.items():
        rows = [row for (law, problem, *_), row in study.rows.items() if law == "coulomb" and problem == name]
        best = [row["z_error"] if row["z_error"] is not None else row["z_bound"] for row in rows if study.right(row) and row["tolerance"] == TIGHT]
        by_file.append({
            "problem": name, "contacts": f.contacts, "rows": f.rows, "n": f.n, "rank": f.rank, "rank ratio": f.rows / f.rank if f.rank else None,
            "asymmetry of W": f.asymmetry, "rolling left out": f.problem.rolling, "proven of rows off by": study.references[name] and study.references[name][0],
            "stick": f.shares and round(f.shares[0], 3), "slide": f.shares and round(f.shares[1], 3), "open": f.shares and round(f.shares[2], 3),
            "isolated": next((row["isolated"] for row in rows if row.get("isolated") is not None), None), "strictly": counted.get(name, {}).get("feasible"),
            "solutions": counted.get(name, {}).get("solutions"), "proven distance at 1e-8": min((b for b in best if b is not None), default=None),
            "solved by": sum(study.right(row) for row in rows if row["tolerance"] == TIGHT), "of": sum(row["tolerance"] == TIGHT for row in rows),
            "false": sum(row["claimed"] == "solved" and row["verified"] == "wrong" for row in rows)})
    by_solver = []
    for solver in study.solvers:
        for tolerance in sorted({key[3] for key in study.rows}, reverse=True):
            rows = [(name, row) for name in study.files if (row := study.row(solver, tolerance, name)) and row["claimed"] != "unsupported"]
            if not rows:
                continue
            ended = [row["z_error"] for _, row in rows if row["claimed"] in ("time limit", "iteration limit") and row["z_error"] is not None]
            ratio = [row["solve_s"] / study.files[name].contacts * 1e6 for name, row in rows if study.right(row) and study.files[name].contacts]
            by_solver.append({
                "solver": solver, "tolerance": tolerance, "tried": len(rows), "right": sum(study.right(row) for _, row in rows),
                "called solved, wrong": sum(row["claimed"] == "solved" and row["verified"] == "wrong" for _, row in rows),
                "limits": sum(row["claimed"] in ("time limit", "iteration limit") for _, row in rows),
                "error at a limit, median": statistics.median(ended) if ended else None, "error at a limit, largest": max(ended, default=None),
                "crashed or no answer": sum(row["claimed"] in ("crashed", "numerical failure", "bad input") for _, row in rows),
                "us a contact, median": statistics.median(ratio) if ratio else None,
                **{f"right, {label}": f"{sum(study.right(row) for name, row in rows if which(study.files[name]))} of {sum(which(study.files[name]) for name, _ in rows)}"
                   for label, which in (("full rank", full), ("deficient", deficient),
                                        ("most stick", lambda f: f.shares is not None and f.shares[0] > 0.5), ("most slide", lambda f: f.shares is not None and f.shares[1] > 0.5),
                                        ("most open", lambda f: f.shares is not None and f.shares[2] > 0.5))}})
    return by_file, by_solver


def short(value):
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.3g}" if isinstance(value, float) else str(value).replace("|", "\\|")


def as_markdown(rows):
    head = list(rows[0]) if rows else []
    return "\n".join(["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(short(r[k]) for k in head) + " |" for r in rows)]) + "\n"


class Clock:
    """Shares out the time that is left: each of `workers` gets for the next file what all that are left would get, were they alike; but no more than a quarter
    of all the time, where that is not less than its part: who has not ended by then will not."""

    def __init__(self, seconds, files, workers):
        self.end, self.files, self.workers, self.lock = time.monotonic() + seconds, files, workers, threading.Lock()
        self.most = max(seconds / 4, seconds * workers / files)

    def share(self):
        with self.lock:
            self.files -= 1
            left = self.end - time.monotonic()
            return max(1.0, min(left, self.most, left * self.workers / (self.files + 1)))


def compare(asked, out):
    """Runs the solvers on each file, small ones first, in a process of its own that ends when its share of the time is over; whole runs are kept.

    Returns (folders of runs, names of files that were cut short, whether any could not be read).
    """
    known = {line.split()[0] for line in files.run([asked.program, "solvers"]).splitlines() if line.startswith("  ") and "not built in" not in line}
    solvers = asked.solvers or ",".join(v for _, family in FAMILIES.values() for v in family if v in known)
    words = ["--law", "coulomb,convex", "--solvers", solvers, "--tolerances", f"{LOOSE:g},{TIGHT:g}", "--time-limit", f"{asked.time_limit:g}", "--accuracy"]
    paths = [pathlib.Path(path) for path in files.expanded(asked.problems)]
    paths.sort(key=lambda path: path.stat().st_size if path.exists() else 0)
    folders = {path: out / "runs" / f"{path.stem}-{hashlib.sha256(str(path).encode()).hexdigest()[:8]}" for path in paths}
    (out / "runs").mkdir(exist_ok=True)
    clock = Clock(asked.within, len(paths), asked.jobs)

    def one(path):
        """The exit code, None where the time was over, and what was said."""
        # A law a shard: rows of the first are kept where the second takes too long, and no convergence is traced.
        ended, seconds = [], clock.share()
        end = time.monotonic() + seconds
        for k in range(2):
            part = folders[path] / str(k)
            if (part / "whole").exists():
                continue
            how = ["--resume", part] if part.exists() else ["--problems", path, *words, "--shard", f"{k}/2", "--out", part]
            # Ends with this one, whatever ends it.
            with subprocess.Popen(["setpriv", "--pdeathsig", "TERM", *map(str, (asked.program, "bench", *how))], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
                try:
                    said = process.communicate(timeout=max(1.0, end - time.monotonic()))[1]
                except subprocess.TimeoutExpired:
                    process.kill()
                    return None, ""
            if process.returncode not in (0, 1):
                shutil.rmtree(part, ignore_errors=True)
                return process.returncode, said.strip().rpartition("\n")[2]
            (part / "whole").touch()
        return 0, ""
    cut, bad, told = [], 0, time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        for count, (path, (code, said)) in enumerate(zip(paths, pool.map(one, paths)), 1):
            if code is None:
                cut.append(path.name)
            elif code:
                bad = max(bad, code)
                print(said or f"{path}: bench ended with exit code {code}", file=sys.stderr)
            if count < len(paths) and time.monotonic() > told + NEWS:
                told = time.monotonic()
                print(f"{count} of {len(paths)} files, at most {math.ceil((clock.end - time.monotonic()) / 60)} min left of the solvers' time", file=sys.stderr)
    runs = [folder / str(k) for folder in folders.values() for k in range(2) if (folder / str(k) / "results.jsonl").exists()]
    if not runs:
        sys.exit(bad or 1)
    return runs, cut, bad


def by_rules(program, runs, out, seconds, within):
    """The variational inequality's solvers on the smallest problems, judged as far as `within` seconds go. Returns the judgement's folder in a list, or none."""
    judged = out / "judged"
    if not (judged / "results.jsonl").exists():
        rows = sorted((row for row in records(runs) if row["law"] == "coulomb"), key=lambda row: row["m"])
        names = list(dict.fromkeys(row["problem"] for row in rows))[:SMALLEST]
        pack, answers = variational.answers(out / "variational", [row for row in rows if row["problem"] in names], (LOOSE, TIGHT), seconds)
        shutil.rmtree(judged, ignore_errors=True)
        if not json.loads((pack / "pack.json").read_text())["problems"]:
            return []
        try:
            subprocess.run([program, "judge", pack, *answers, "--out", judged], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=within)
        except subprocess.TimeoutExpired:
            print("the answers of the variational inequality's solvers on the largest of their files are not judged: the time is over", file=sys.stderr)
    return [judged] if (judged / "results.jsonl").exists() else []


def look(study, asked):
    """Strictly feasible or not, and Coulomb's solutions, of the smallest problems first, until the time is over."""
    started, counted = time.monotonic(), {}
    for name in sorted(study.files, key=lambda n: study.files[n].rows):
        f = study.files[name]
        if time.monotonic() - started > asked.search:
            break
        counted[name] = {"feasible": feasibility.decide(f.problem)["feasible"]}
        left = asked.search - (time.monotonic() - started)
        try:
            said = subprocess.run([asked.program, "solve", str(f.path), "--law", "coulomb", "--solutions", "--json"], capture_output=True, text=True, timeout=max(left, 1))
            found = json.loads(said.stdout) if said.returncode == 0 else {"in_words": "not searched", "solutions": []}
            counted[name]["solutions"] = found["in_words"].partition(":")[0].partition(";")[0]
            if found["solutions"]:
                f.take_modes(found["solutions"][0]["modes"])
        except subprocess.TimeoutExpired:
            counted[name]["solutions"] = "not searched"
    return counted


def main():
    options = files.Options(prog="./zwang experiment acary", description=__doc__.split("\n")[0])
    options.add_argument("program", help=argparse.SUPPRESS)
    options.add_argument("problems", nargs="*", metavar="FILE|DIR", help="FCLIB's or Siconos' files, or folders of them")
    options.add_argument("--run", metavar="DIR", help="results of ./zwang bench or campaign, made before, in place of files")
    options.add_argument("--out", default="results/acary", metavar="DIR", help="where tables go, and a run is gone on with; default: results/acary")
    options.add_argument("--solvers", metavar="A,B:KEY=VALUE", help="default: those of the report's families that are built in")
    options.add_argument("--time-limit", type=float, default=10, metavar="S", help="CPU time of a solve; default: 10")
    options.add_argument("--search", type=float, default=600, metavar="S", help="for strict motions and numbers of solutions, in all; default: 600")
    options.add_argument("--within", type=float, default=2400, metavar="S", help="for all solvers and files, in all: a file that takes more than its share is cut short; default: 2400")
    options.add_argument("--jobs", type=int, default=2, metavar="N", help="processes; default: 2")
    asked = options.parse_args()
    if bool(asked.problems) == bool(asked.run) or asked.jobs < 1 or not asked.time_limit > 0 or not asked.within > 0 or not asked.search >= 0:
        files.fail("expected files or folders, or --run DIR; --jobs from 1 on; times of at least 0 s")
    out = files.made(asked.out)
    if asked.run and not (pathlib.Path(asked.run) / "results.jsonl").exists():
        files.fail(f"{asked.run}: no results.jsonl there", files.BAD_FILE)
    runs, cut, bad = ([pathlib.Path(asked.run)], [], 0) if asked.run else compare(asked, out)
    study = Study(runs, by_rules(asked.program, runs, out, asked.time_limit * SHARE, asked.within / 4))
    if not study.files:
        files.fail(f"{asked.run or ', '.join(asked.problems)}: no problem under Coulomb's law", files.BAD_FILE)
    counted = look(study, asked)
    checks = Checks(study).run()
    by_file, by_solver = tables(study, counted)
    exact, near = (sum(proof is not None and (proof[0] == 0) == how for proof in study.references.values()) for how in (True, False))
    for check in checks:
        print(f"{check['verdict']:10} {check['claim']}\n{'':10} {check['found']}   [{check['where']}]")
    words = {w: sum(c["verdict"] == w for c in checks) for w in ("confirmed", "refuted", "undecided")}
    head = (f"{len(study.files)} problems, {len(study.solvers)} solvers; a solution is proven of {exact} problems as they are stored and of {near} more but for rounding (rows off by at most "
            f"{ROUNDING:g} of the motion); of {len(checks)} claims {words['confirmed']} confirmed, "
            f"{words['refuted']} refuted, {words['undecided']} undecided")
    if smooth := sorted({row["problem"] for row in records(runs) if row["law"] == "frictionless"}):
        head += f". Without friction, and left out: {', '.join(smooth)}"
    if cut:
        head += f". Cut short, for their share of the time was over: {', '.join(cut)}"
    print(f"\n{head}   -> {out}/acary.md")
    (out / "acary.json").write_text(json.dumps({"checks": checks, "problems": by_file, "solvers": by_solver}, indent=1) + "\n")
    for name, rows in (("checks", checks), ("problems", by_file), ("solvers", by_solver)):
        with open(out / f"{name}.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]))
            writer.writeheader()
            writer.writerows(rows)
    kinds = (("W has full rank", full), ("W is rank deficient", deficient), ("rank not known", lambda f: f.rank is None))
    (out / "acary.svg").write_text(chart.svg(study, LOOSE, TIGHT, [(title, study.names(which)) for title, which in kinds]))
    (out / "acary.md").write_text(f"# RR-9118 on {', '.join(asked.problems) or asked.run}\n\n{head}.\n\n![Runs by solver and rank](acary.svg)\n\n{as_markdown(checks)}\n## Solvers\n\n{as_markdown(by_solver)}\n## Problems\n\n{as_markdown(by_file)}")
    return bad


if __name__ == "__main__":
    files.as_program(main)
