#!/usr/bin/python3
"""./zwang experiment feasibility FILE|DIR...: does a motion lie strictly inside every cone? Proven in rationals (docs/acary.md).

Strictly feasible: there is z with J_E z = c_E and, for each contact, s = J z - c, s_n > mu |s_t|. Otherwise there is
lambda, not 0 on the contacts, with J' lambda = 0, c' lambda >= 0 and |lambda_t| <= mu lambda_n, which proves that there is none.
"""
import argparse
import itertools
import json
import pathlib
import sys
from fractions import Fraction as F

import numpy as np

import edge
import files

GAP = 1e-23       # of t where the search ends: a relative margin near 1e-11, for t is its square
SUPPORTS = (1e-7, 1e-3, 1e-11)  # shares of the largest force below which a contact has no part in a proof; tried in turn
FACES = (1e-4, 1e-13)  # relative distances to a cone's edge below which a force is taken to lie on it; tried in turn
SNAP = 1e-5       # by which a direction of slip may miss a rational one of length 1
EXACT_ROWS = 120  # of a proof by elimination in rationals
DENSE = 3e7       # entries of J
NEWTON = 60       # steps for one weight of the barrier
NEAR = 1e-2       # of Newton's decrement: near enough to go on to the next weight


def dyadic(values):
    """Integers and the power of two that they are to be multiplied by: exactly the doubles."""
    mantissa, exponent = np.frexp(np.asarray(values, float))
    whole = (mantissa * 2.0**53).astype(np.int64)
    exponent = np.where(whole == 0, 0, exponent - 53)
    least = int(exponent.min(initial=0))
    return [int(w) << int(e - least) for w, e in zip(whole.ravel(), exponent.ravel())], least


def slacks(problem, z):
    """J z - c in rationals, for z of doubles [n]. Returns a list of Fractions [m]."""
    zs, z_exponent = dyadic(z)
    out = []
    for row, c in zip(problem.J, problem.c):
        at = np.flatnonzero(row)
        js, exponent = dyadic(row[at])
        total, power = sum(j * zs[k] for j, k in zip(js, at)), exponent + z_exponent
        out.append((F(total << power) if power >= 0 else F(total, 1 << -power)) - F(c))
    return out


def inside(s, contact, mu):
    """s_n > mu |s_t| in rationals."""
    normal, *tangents = (s[row] for row in contact)
    return normal > 0 and normal**2 > F(mu)**2 * sum(t**2 for t in tangents)


def certifies(problem, force):
    """force {row: Fraction}: lies in the cones, J' force = 0, and c' force > 0, or = 0 with force on a contact; in rationals."""
    total = [F(0)] * problem.J.shape[1]
    for row, value in force.items():
        for k in np.flatnonzero(problem.J[row]):
            total[k] += value * F(problem.J[row, k])
    at = [[force.get(row, F(0)) for row in contact] for contact in problem.contacts]
    level = sum(v * F(problem.c[row]) for row, v in force.items())
    return (not any(total) and (level > 0 or level == 0 and any(f[0] > 0 for f in at)) and
            all(f[0] >= 0 and sum(t**2 for t in f[1:]) <= F(mu)**2 * f[0]**2 for f, mu in zip(at, problem.mu)))


class Cones:
    """min t + |y|^2 / 2 so that A y + t e lies in the dual cones: y = (z, 1) whitened and without its equality rows.

    t < 0: y is strictly inside. At t = 0 the barrier's forces prove that nothing is.
    """

    def __init__(self, problem):
        L = np.linalg.cholesky(problem.M)
        B = np.linalg.solve(L, problem.J.T).T
        lengths = np.ones(len(B))
        for contact in problem.contacts:
            lengths[contact] = max(np.linalg.norm(B[contact[0]]), np.finfo(float).tiny) if B[contact[0]].any() else 1
        for row in problem.equalities:
            lengths[row] = np.linalg.norm(B[row]) or 1
        self.scale = max(np.abs(problem.c / lengths).max(initial=0), np.finfo(float).tiny) if problem.c.any() else 1.0
        A = np.column_stack([B, -problem.c / self.scale]) / lengths[:, None]
        self.basis = np.eye(A.shape[1])
        if len(problem.equalities):
            _, sigma, V = np.linalg.svd(A[problem.equalities], full_matrices=True)
            self.basis = V[int((sigma > sigma[0] * max(A.shape) * np.finfo(float).eps).sum()):].T
        self.L, self.lengths, self.rows = L, lengths, A
        self.normal = np.vstack([A[[c[0] for c in problem.contacts]], np.eye(A.shape[1])[-1:]]) @ self.basis
        tangents = max((len(c) - 1 for c in problem.contacts), default=0)
        self.tangent = [np.vstack([mu * A[c[1 + t]] if len(c) > 1 + t else np.zeros(A.shape[1])
                                   for c, mu in zip(problem.contacts, problem.mu)] + [np.zeros(A.shape[1])]) @ self.basis
                        for t in range(tangents)]

    def motion(self, y):
        full = self.basis @ y
        return np.linalg.solve(self.L.T, full[:-1]) * (self.scale / full[-1]) if full[-1] > 0 else None

    def solve(self, found):
        """Until found(y), or the gap is closed. Returns (witness or None, forces n, forces t): of contacts, then of the last row."""
        parts = len(self.normal) + 1
        y, t, weight = np.zeros(self.basis.shape[1]), 1.0, 2.0 * parts
        least, forces = np.inf, None  # of the weight whose forces balance best: at the last ones there may be no digit left
        while True:
            for _ in range(NEWTON):
                n = self.normal @ y + t
                s = [T @ y for T in self.tangent]
                det = n**2 - sum(v**2 for v in s)
                gn, gs = -2 * n / det, [2 * v / det for v in s]
                g = np.append(self.normal.T @ gn + sum((T.T @ v for T, v in zip(self.tangent, gs)), 0) + weight * y, weight + gn.sum())
                rows = np.column_stack([self.normal, np.ones(len(n))])
                flat = [np.column_stack([T, np.zeros(len(n))]) for T in self.tangent]
                turned = rows * gn[:, None] + sum((T * v[:, None] for T, v in zip(flat, gs)), 0)
                H = turned.T @ turned - rows.T @ (rows * (2 / det)[:, None]) + sum((T.T @ (T * (2 / det)[:, None]) for T in flat), 0)
                H[range(len(y)), range(len(y))] += weight
                size = 1 / np.sqrt(np.diag(H))
                step = -size * np.linalg.lstsq(H * np.outer(size, size), size * g, rcond=None)[0]
                decrease = -g @ step
                length = 1.0
                while length > np.finfo(float).eps and not self.stays(y + length * step[:-1], t + length * step[-1], weight, y, t, length * decrease):
                    length /= 2
                if length <= np.finfo(float).eps:
                    break
                y, t = y + length * step[:-1], t + length * step[-1]
                if t < 0 and found(y):
                    return y, None, None
                if decrease < NEAR:
                    break
            n = self.normal @ y + t
            s = [T @ y for T in self.tangent]
            det = n**2 - sum(v**2 for v in s)
            now = 2 * n / det / weight, [-2 * v / det / weight for v in s]
            off = np.linalg.norm(self.normal.T @ now[0] + sum((T.T @ v for T, v in zip(self.tangent, now[1])), 0))
            if forces is None or off < least:
                least, forces = off, now
            if 2 * parts / weight < GAP:
                return None, *forces
            weight *= 10

    def value(self, y, t, weight):
        n = self.normal @ y + t
        det = n**2 - sum(((T @ y)**2 for T in self.tangent), np.zeros(len(n)))
        if (n <= 0).any() or (det <= 0).any():
            return np.inf
        return weight * (t + y @ y / 2) - np.log(det).sum()

    def stays(self, y, t, weight, y0, t0, decrease):
        after = self.value(y, t, weight)
        before = self.value(y0, t0, weight)
        return after <= before - decrease / 10 + 1e-14 * abs(before)


def met_exactly(problem, z):
    """z of doubles, strictly inside with room: is there an exact one beside it that also meets the equality rows?"""
    s = slacks(problem, z)
    if not all(inside(s, contact, mu) for contact, mu in zip(problem.contacts, problem.mu)):
        return False
    E = problem.equalities
    if not any(s[row] for row in E):
        return True
    # J_E X = I + R with |R| < 1 gives a correction d of J_E d = -s_E with |d| <= |X| |s_E| / (1 - |R|), all norms largest entries.
    X = np.linalg.pinv(problem.J[E])
    R = max(sum((abs(sum((F(a) * F(b) for a, b in zip(row, X[:, k]) if a and b), F(-(i == k)))) for k in range(len(E))), F(0))
            for i, row in enumerate(problem.J[E]))
    if R >= 1:
        return False
    d = max(sum(map(F, np.abs(x)), F(0)) for x in X) * max(abs(s[row]) for row in E) / (1 - R)
    reach = [sum(map(F, np.abs(row[row != 0])), F(0)) * d for row in problem.J]
    return all(s[c[0]] > reach[c[0]] and (s[c[0]] - reach[c[0]])**2 >
               F(mu)**2 * sum((abs(s[row]) + reach[row])**2 for row in c[1:]) for c, mu in zip(problem.contacts, problem.mu))


def null_vectors(columns):
    """(pivots, reduced rows) of the columns' dependencies, by elimination in rationals."""
    height = len(columns[0])
    rows = [[column[k] for column in columns] for k in range(height)]
    pivots, reduced = [], []
    for k in range(len(columns)):
        at = next((i for i, row in enumerate(rows) if row[k]), None)
        if at is None:
            continue
        pivot = rows.pop(at)
        pivot = [x / pivot[k] for x in pivot]
        rows = [[a - row[k] * b for a, b in zip(row, pivot)] if row[k] else row for row in rows]
        reduced = [[a - row[k] * b for a, b in zip(row, pivot)] if row[k] else row for row in reduced] + [pivot]
        pivots.append(k)
    return pivots, reduced


def rational_unit(x):
    """A vector of length 1 in rationals beside x of length nearly 1, or None."""
    if len(x) == 1:
        return [F(1 if x[0] > 0 else -1)]
    for most in (1, 10, 100, 1000):
        snapped = [F(float(v)).limit_denominator(most) for v in x]
        if sum(v * v for v in snapped) == 1 and max(abs(float(v) - w) for v, w in zip(snapped, x)) < SNAP:
            return snapped
    return None


def exact_certificate(problem, normal, tangents, level, support, face):
    """{row: Fraction} that proves that nothing is strictly inside, from forces nearly so; or None."""
    columns, guesses = [], []  # a column: {row: share}
    for i, (contact, mu) in enumerate(zip(problem.contacts, problem.mu)):
        if normal[i] < support * max(normal.max(), level):
            continue
        rows, force = list(contact), [normal[i]] + [mu * T[i] for T in tangents][:len(contact) - 1]
        if len(rows) == 2:  # in the plane the cone is spanned by its two edges
            slip = force[1] / mu if mu else 0
            for sign in (1, -1):
                weight = (normal[i] + sign * slip) / 2
                if weight > support * normal.max():
                    columns.append({rows[0]: F(1), rows[1]: sign * F(mu)})
                    guesses.append(weight)
            continue
        length = np.linalg.norm(force[1:])
        unit = rational_unit(np.array(force[1:]) / length) if length > (1 - face) * mu * normal[i] and length else None
        if unit:
            columns.append({rows[0]: F(1), **{row: F(mu) * u for row, u in zip(rows[1:], unit)}})
            guesses.append(normal[i])
            continue
        for row, value in zip(rows, force):
            if row == rows[0] or mu:
                columns.append({row: F(1)})
                guesses.append(value)
    for row, value in zip(problem.equalities, spread_of(problem, columns, guesses, level)):
        columns.append({row: F(1)})
        guesses.append(value)
    if not columns or len(columns) > EXACT_ROWS:
        return None
    full = [[sum(share * F(problem.J[row, k]) for row, share in column.items()) for k in range(problem.J.shape[1])] for column in columns]
    levels = [sum(share * F(problem.c[row]) for row, share in column.items()) for column in columns]
    for height in ([c + [l] for c, l in zip(full, levels)], full):  # c' lambda = 0 first, then without
        pivots, reduced = null_vectors(height)
        # Least squares among the dependencies, then each free weight a double.
        free = [k for k in range(len(columns)) if k not in pivots]
        if not free:
            continue
        span = np.zeros((len(columns), len(free)))
        span[free, range(len(free))] = 1
        for k, row in zip(pivots, reduced):
            span[k] = [-float(row[f]) for f in free]
        near = np.linalg.lstsq(span, np.array(guesses), rcond=None)[0]
        weight = {f: F(float(v)) for f, v in zip(free, near)}
        for k, row in zip(pivots, reduced):
            weight[k] = -sum((row[f] * weight[f] for f in free), F(0))
        force = {}
        for k, column in enumerate(columns):
            for row, share in column.items():
                force[row] = force.get(row, F(0)) + weight[k] * share
        if certifies(problem, force):
            return force
    return None


def spread_of(problem, columns, guesses, level):
    """Forces of the equality rows that balance the contacts' as well as they can, where c' lambda is to be level."""
    if not problem.equalities:
        return []
    rows = np.column_stack([problem.J, -problem.c])
    pull = np.append(np.zeros(problem.J.shape[1]), level)
    for column, guess in zip(columns, guesses):
        pull += guess * sum(float(share) * rows[row] for row, share in column.items())
    return np.linalg.lstsq(rows[problem.equalities].T, -pull, rcond=None)[0]


def decide(problem):
    """{"feasible": "strictly" | "not strictly" | "undecided", ...}: what is proven, and what proves it.

    z [n] is the witness; lambda {row: "p/q"} the proof that there is none; delta by how much the rows would have to be
    changed, relative to their lengths, for the forces found to prove it; margin the least (s_n - mu |s_t|) over the rows'
    lengths and |(z, 1)|.
    """
    if not problem.contacts:
        return {"feasible": "strictly", "why": "no contacts"}
    if problem.J.size > DENSE:
        return {"feasible": "undecided", "why": f"J has {problem.J.size:,} entries"}
    cones = Cones(problem)
    y, normal, tangents = cones.solve(lambda y: (z := cones.motion(y)) is not None and np.isfinite(z).all() and met_exactly(problem, z))
    if y is not None:
        n = cones.normal[:-1] @ y
        slip = np.sqrt(sum(((T[:-1] @ y)**2 for T in cones.tangent), np.zeros(len(n))))
        return {"feasible": "strictly", "z": cones.motion(y).tolist(), "margin": float((n - slip).min())}
    # Forces on unit rows -> of the problem's own rows.
    length = np.array([cones.lengths[c[0]] for c in problem.contacts])
    tangents = [T[:-1] / length for T in tangents]
    balance = np.linalg.norm(cones.normal.T @ normal + sum((T.T @ v for T, v in zip(cones.tangent, [np.append(t * length, 0) for t in tangents])), 0))
    forces = (exact_certificate(problem, normal[:-1] / length, tangents, normal[-1] * cones.scale, *marks) for marks in itertools.product(SUPPORTS, FACES))
    force = next((f for f in forces if f), None)
    if force is None:
        return {"feasible": "undecided", "why": "no strict motion found; what speaks against one holds for rows that are off by delta", "delta": float(balance)}
    level = sum(v * F(problem.c[row]) for row, v in force.items())
    return {"feasible": "not strictly", "lambda": {str(row): str(v) for row, v in sorted(force.items()) if v},
            "anything": "nothing" if level > 0 else "at most the boundary"}


WORDS = {"strictly": "strictly feasible", "not strictly": "no strict motion", "undecided": "undecided"}


def kind(answer):
    return f"{answer['anything']} feasible" if answer["feasible"] == "not strictly" else WORDS[answer["feasible"]]


def outcome(row):
    """What became of a run, in one word of the table."""
    if row["claimed"] in ("crashed", "bad input") or row["verified"] == "crashed":
        return "crashed"
    if row["claimed"] in ("solved", "infeasible"):
        return {"wrong": "false claim", "solved": "right", "infeasible, proven": "right"}.get(row["verified"], "claim open")
    return "no answer" if row["verified"] == "no answer" else "gave up"


OUTCOMES = ("right", "claim open", "false claim", "gave up", "no answer", "crashed")


def charted(program, out, found, solvers, seconds):
    """A row for each solver and kind of problem: how many runs became what."""
    known = {answer["problem"]: kind(answer) for answer in found}
    run = out / "run"
    how = ["--resume", run] if run.exists() else ["--problems", out / "problems", "--law", "coulomb", "--solvers", solvers, "--tolerances", "1e-8",
                                                  "--time-limit", f"{seconds:g}", "--accuracy", "--out", run]
    files.run([program, "bench", *how])
    table = {}
    for line in (run / "results.jsonl").read_text().splitlines():
        row = json.loads(line)
        if row["problem"] in known and row["claimed"] not in ("unsupported", "unsolved"):
            cell = table.setdefault((row["solver"], known[row["problem"]]), dict.fromkeys(OUTCOMES, 0))
            cell[outcome(row)] += 1
    return [{"solver": solver, "problems": what, **cell} for (solver, what), cell in table.items()]


def line_of(answer):
    proven = {"strictly": f"strictly feasible, margin {answer.get('margin', 0):.1e}",
              "not strictly": f"no strict motion, proven: {answer.get('anything')} is feasible",
              "undecided": f"undecided: {answer.get('why')}" + (f" {answer['delta']:.1e}" if "delta" in answer else "")}[answer["feasible"]]
    return (f"{answer['problem']:36.36} {answer['contacts']:4} contacts   {proven}" + (f"   solutions: {answer['solutions']}" if "solutions" in answer else "") +
            ("   rolling left out" if answer["rolling"] else ""))


def main():
    options = files.Options(prog="./zwang experiment feasibility", description=__doc__.split("\n")[0])
    options.add_argument("program", help=argparse.SUPPRESS)
    options.add_argument("what", nargs="*", metavar="FILE|DIR|SCENE", help="problem files of any kind that ./zwang reads, folders of them, or scenes")
    options.add_argument("--edge", action="store_true", help="also problems made at the edge of strict feasibility and beyond: wedge, corner of a chute, plates")
    options.add_argument("--out", default="results/feasibility", metavar="DIR", help="where feasibility.json goes; default: results/feasibility")
    options.add_argument("--solutions", action="store_true", help="also count Coulomb's solutions of each (up to a minute each)")
    options.add_argument("--solvers", metavar="A,B", help="also run these, and say what becomes of them; all: those that read Coulomb's law")
    options.add_argument("--time-limit", type=float, default=2, metavar="S", help="CPU time of a solve; default: 2")
    asked = options.parse_args()
    if not (asked.what or asked.edge) or not asked.time_limit > 0:
        files.fail("expected files, folders, scenes or --edge; --time-limit above 0 s")
    out = files.made(asked.out)
    what = asked.what + ([str(path) for path in edge.write(out / "edge")] if asked.edge else [])
    found, written = [], {}

    def keep(**more):
        written.update(problems=found, **more)
        draft = out / "feasibility.json.new"
        draft.write_text(json.dumps(written, indent=1) + "\n")
        draft.replace(out / "feasibility.json")
    for path in files.packed(asked.program, what, out):
        problem = files.read(path)
        answer = {"problem": problem.name, "file": str(path.relative_to(out)), "n": problem.J.shape[1], "contacts": len(problem.contacts),
                  "rolling": problem.rolling, **decide(problem)}
        if asked.solutions:
            answer["solutions"] = files.solutions(asked.program, path)["in_words"]
        found.append(answer)
        print(line_of(answer), flush=True)
        keep()
    if asked.solvers:
        names = ",".join(files.readers(asked.program, "coulomb")) if asked.solvers == "all" else asked.solvers
        keep(solvers=charted(asked.program, out, found, names, asked.time_limit))
        print(f"\n{'solver':20} {'problems':32}" + "".join(f"{word:>12}" for word in OUTCOMES))
        for row in written["solvers"]:
            print(f"{row['solver']:20} {row['problems']:32}" + "".join(f"{row[word] or '.':>12}" for word in OUTCOMES))
        print()
    count = {word: sum(a["feasible"] == word for a in found) for word in WORDS}
    print(f"{len(found)} problems: {count['strictly']} strictly feasible, {count['not strictly']} proven not to be, {count['undecided']} undecided   -> {out}/feasibility.json")


if __name__ == "__main__":
    files.as_program(main)
