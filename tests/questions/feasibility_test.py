"""experiments/acary/feasibility.py against enumeration in rationals, and on scenes whose answer is known.

Usage: feasibility_test.py PROGRAM [COUNT]: so many generated problems; default: 200
"""
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile
from fractions import Fraction as F

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments/acary"))
import feasibility  # noqa: E402
import files  # noqa: E402

PROGRAM = sys.argv[1]
COUNT = int(sys.argv[2]) if len(sys.argv) > 2 else 200
failures = 0


def check(what, holds, detail=""):
    global failures
    if not holds:
        failures += 1
        print(f"FAILED: {what} {detail}")


def dependency(columns):
    """Weights of the only dependency of the columns (up to its length), or None."""
    rows = [list(row) for row in zip(*columns)]
    pivots = []
    for k in range(len(columns)):
        at = next((i for i in range(len(pivots), len(rows)) if rows[i][k]), None)
        if at is None:
            continue
        i = len(pivots)
        rows[i], rows[at] = rows[at], rows[i]
        rows[i] = [x / rows[i][k] for x in rows[i]]
        rows = [row if j == i or not row[k] else [a - row[k] * b for a, b in zip(row, rows[i])] for j, row in enumerate(rows)]
        pivots.append(k)
    free = [k for k in range(len(columns)) if k not in pivots]
    if len(free) != 1:
        return None
    weights = [F(0)] * len(columns)
    weights[free[0]] = F(1)
    for i, k in enumerate(pivots):
        weights[k] = -rows[i][free[0]]
    return weights


def strictly_feasible(problem):
    """In the plane: by all smallest dependencies of the cones' edges, the equality rows and s > 0 (Carathéodory, Gordan)."""
    n = problem.J.shape[1]
    lifted = [[F(a) for a in row] + [-F(c)] for row, c in zip(problem.J, problem.c)]
    edges = [[F(0)] * n + [F(1)]]
    for (normal, tangent), mu in zip(problem.contacts, problem.mu):
        for sign in (1, -1):
            edges.append([a + sign * F(mu) * b for a, b in zip(lifted[normal], lifted[tangent])])
    equalities = [lifted[row] for row in problem.equalities if any(lifted[row])]
    for size in range(1, n + 3):
        for chosen in itertools.combinations(edges, size):
            weights = dependency([*chosen, *equalities])
            if weights and (all(w > 0 for w in weights[:size]) or all(w < 0 for w in weights[:size])):
                return False
    return True


def coulomb_solutions(problem):
    """Whether Coulomb's law has a solution in the plane with M = I, z_u given: all choices of modes, in rationals."""
    n = problem.J.shape[1]
    J = [[F(a) for a in row] for row in problem.J]
    for modes in itertools.product(("open", "stick", 1, -1), repeat=len(problem.contacts)):
        # Unknowns: z, then a force for each row in use; a force of slip is -sign * mu of the normal's.
        pushes, rows = [], []
        for (normal, tangent), mu, mode in zip(problem.contacts, problem.mu, modes):
            if mode == "stick":
                pushes += [(normal, J[normal]), (tangent, J[tangent])]
                rows += [normal, tangent]
            elif mode != "open":
                pushes.append((normal, [a - mode * F(mu) * b for a, b in zip(J[normal], J[tangent])]))
                rows.append(normal)
        pushes += [(row, J[row]) for row in problem.equalities]
        rows += problem.equalities
        # J z = c with z = z_u + push' f.
        system = [[sum(a * b for a, b in zip(J[row], push)) for _, push in pushes] +
                  [F(problem.c[row]) - sum(a * F(b) for a, b in zip(J[row], problem.z_u))] for row in rows]
        force = unique(system, len(pushes))
        if force is None:
            continue
        z = [F(u) + sum(f * push[k] for f, (_, push) in zip(force, pushes)) for k, u in enumerate(problem.z_u)]
        at = {row: f for f, (row, _) in zip(force, pushes)}
        good = True
        for (normal, tangent), mu, mode in zip(problem.contacts, problem.mu, modes):
            s, slip = (sum(a * b for a, b in zip(J[row], z)) - F(problem.c[row]) for row in (normal, tangent))
            if mode == "open":
                good &= s >= 0
            elif mode == "stick":
                good &= at[normal] >= 0 and abs(at[tangent]) <= F(mu) * at[normal]
            else:
                good &= at[normal] >= 0 and slip * mode >= 0
        if good:
            return True
    return False


def unique(system, width):
    """The one solution of a square system; None where there is none or more."""
    rows = [list(row) for row in system]
    for k in range(width):
        at = next((i for i in range(k, len(rows)) if rows[i][k]), None)
        if at is None:
            return None
        rows[k], rows[at] = rows[at], rows[k]
        rows[k] = [x / rows[k][k] for x in rows[k]]
        rows = [row if j == k or not row[k] else [a - row[k] * b for a, b in zip(row, rows[k])] for j, row in enumerate(rows)]
    return None if any(row[-1] for row in rows[width:]) else [row[-1] for row in rows[:width]]


def generated(seed):
    """In the plane, of small integers, so that many have no interior; with an equality row at times."""
    rng = np.random.default_rng(seed)
    n, contacts = int(rng.integers(2, 4)), int(rng.integers(1, 4))
    equalities = int(rng.integers(0, n - 1))
    m = equalities + 2 * contacts
    J, c = rng.integers(-2, 3, (m, n)).astype(float), rng.integers(-1, 2, m) * float(rng.random() < 0.6)
    kind, mu = np.array([0] * equalities + [1, 2] * contacts), np.zeros(m)
    mu[equalities::2] = rng.choice([0, 0.5, 1, 2], contacts)
    problem = files.Problem(np.eye(n), J, c, kind, mu)
    problem.z_u = rng.integers(-2, 3, n)
    return problem


def holds(problem, answer):
    """What decide says, checked by nothing but the definition."""
    if answer["feasible"] == "strictly":
        s = [sum(F(a) * F(b) for a, b in zip(row, answer["z"])) - F(c) for row, c in zip(problem.J, problem.c)]
        return (all(abs(s[row]) < F(1, 10**9) for row in problem.equalities) and
                all(s[n] > F(mu) * abs(s[t]) for (n, t), mu in zip(problem.contacts, problem.mu)))
    force = {int(row): F(value) for row, value in answer["lambda"].items()}
    balanced = all(sum(v * F(problem.J[row, k]) for row, v in force.items()) == 0 for k in range(problem.J.shape[1]))
    inside = all(abs(force.get(t, 0)) <= F(mu) * force.get(n, 0) for (n, t), mu in zip(problem.contacts, problem.mu))
    return balanced and inside and sum(v * F(problem.c[row]) for row, v in force.items()) >= 0


def test_generated():
    count = {"strictly": 0, "not strictly": 0, "undecided": 0}
    without = 0
    for seed in range(COUNT):
        problem = generated(seed)
        answer = feasibility.decide(problem)
        count[answer["feasible"]] += 1
        if answer["feasible"] == "undecided":
            continue
        check(f"problem {seed}", (answer["feasible"] == "strictly") == strictly_feasible(problem) and holds(problem, answer), answer)
        # A strictly feasible problem has a solution under Coulomb's law. Enumeration may miss one only where forces are free.
        if COUNT <= 200 and answer["feasible"] == "strictly" and not coulomb_solutions(problem):
            without += np.linalg.matrix_rank(problem.J) == len(problem.J)
    print(f"{COUNT} generated problems: {count}")
    check("all are decided", count["undecided"] == 0, count)
    check("both answers occur", min(count["strictly"], count["not strictly"]) > COUNT // 5, count)
    check("a strictly feasible one of independent rows has a solution", without == 0, without)


def spatial(J, c, mu):
    contacts = len(mu)
    full = np.zeros(3 * contacts)
    full[::3] = mu
    return files.Problem(np.eye(J.shape[1]), np.array(J, float), np.array(c, float), np.array([1, 2, 2] * contacts), full)


def test_spatial():
    floor = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    ceiling = floor * [[-1], [1], [1]]
    for gap, expected in ((-1, "strictly"), (0, "not strictly"), (1, "not strictly")):  # between plates that far too near
        answer = feasibility.decide(spatial(np.vstack([floor, ceiling]), [0, 0, 0, gap, 0, 0], [0.5, 0.5]))
        check(f"plates, {gap}", answer["feasible"] == expected, answer)
        if expected != "strictly":
            check(f"plates, {gap}: what is left", answer["anything"] == ("nothing" if gap > 0 else "at most the boundary"), answer)


def test_edge(out):
    """Before, at and beyond the edge by as little as 2^-34: all are decided."""
    done = subprocess.run([sys.executable, str(ROOT / "experiments/acary/feasibility.py"), PROGRAM, "--edge", "--solvers", "cone,nsgs", "--out", out],
                          capture_output=True, text=True)
    check("the edge runs", done.returncode == 0, done.stderr)
    found = json.loads((out / "feasibility.json").read_text())
    check("many problems", len(found["problems"]) == 99, len(found["problems"]))
    for answer in found["problems"]:
        scene, side = answer["problem"].replace(",", "").split()[:2]
        check(answer["problem"], answer["feasible"] == ("strictly" if side == "before" else "not strictly"), answer["feasible"])
        if answer["feasible"] == "not strictly":
            check(answer["problem"], answer["anything"] == ("nothing" if (scene, side) == ("plates", "beyond") else "at most the boundary"), answer["anything"])
    runs = [sum(row[word] for word in feasibility.OUTCOMES) for row in found["solvers"]]
    check("each solver has a row a kind of problem", len(runs) == 6 and sum(runs) == 2 * 99, found["solvers"])
    strict = [row for row in found["solvers"] if row["problems"] == "strictly feasible"]
    check("no false claim where there is a strict motion", all(row["false claim"] == 0 for row in strict), strict)


def test_program():
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "edge"
        scenes = ["JAM", "JAM(beyond=1)", "HELD", "HELD(above=0)", "ROD", "PINCH", "PUCK"]
        done = subprocess.run([sys.executable, str(ROOT / "experiments/acary/feasibility.py"), PROGRAM, *scenes, "--solutions", "--out", out],
                              capture_output=True, text=True)
        check("the command runs", done.returncode == 0, done.stderr)
        found = [(a["feasible"], a["solutions"].split(" and")[0]) for a in json.loads((out / "feasibility.json").read_text())["problems"]]
        expected = ["strictly", "not strictly", "not strictly", "strictly", "strictly", "not strictly", "strictly"]
        check("wedges, rods, pinches", [word for word, _ in found] == expected, found)
        check("solutions", [s.split(":")[0] for _, s in found][:5] == ["1", "none", "2", "1", "3"], found)
        test_edge(pathlib.Path(folder) / "edges")
        done = subprocess.run([sys.executable, str(ROOT / "experiments/acary/feasibility.py"), PROGRAM, "no_such_thing", "--out", out / "no"],
                              capture_output=True, text=True)
        again = [subprocess.run([sys.executable, str(ROOT / "experiments/acary/feasibility.py"), PROGRAM, *what, "--out", out],
                                capture_output=True, text=True).returncode for what in (scenes, ["JAM"])]
        check("a folder is gone on with, and not for others", again == [0, 2], again)
        check("a wrong name is one line", done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr)
        done = subprocess.run([sys.executable, str(ROOT / "experiments/acary/feasibility.py"), PROGRAM, "JAM", "--out", "/proc/x"], capture_output=True, text=True)
        check("a folder that cannot be is one line", (done.returncode, done.stderr) == (3, "/proc/x: No such file or directory\n"), done.stderr)


test_spatial()
test_program()
test_generated()
sys.exit(failures > 0)
