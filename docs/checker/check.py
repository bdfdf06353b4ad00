#!/usr/bin/env python3
"""Checks proofs that `./zwang judge --proofs` wrote, from the numbers of the problem alone.

PROOF: a proof file or a folder of them. One sentence a file; exit code 0: all hold, 1: one does not, 2: wrong use, 3: bad input.
Needs Python 3.9 and its standard library, and nothing of zwang. Every double enters as the rational number that it is, and everything is
decided in integers and fractions. docs/packs.md says what a proof file holds, and why what is checked here is a proof.
"""
import argparse
import hashlib
import json
import os
import struct
import sys
from fractions import Fraction
from math import gcd, inf, isfinite, isqrt, lcm

EQUALITY, INEQUALITY, TANGENT = 0, 1, 2


class Refused(Exception):
    """A proof that does not hold (exit code 1), or input that is none (3): why, in one line."""


def expect(holds, why, code=1):
    if not holds:
        raise Refused(code, why)


def dot(pairs):
    """A sum of products of fractions, brought to lowest terms once."""
    pairs = [(a, b) for a, b in pairs if a and b]
    below = lcm(*(a.denominator * b.denominator for a, b in pairs))
    return Fraction(sum(a.numerator * b.numerator * (below // (a.denominator * b.denominator)) for a, b in pairs), below)


def times(row, x):
    return dot((value, x[j]) for j, value in row.items())


def root_up(square, digits=20):
    """The square root as text, rounded up at this digit."""
    if square == 0:
        return "0"
    shift = digits - 1 - (len(str(square.numerator)) - len(str(square.denominator))) // 2
    while True:
        above, below = square.numerator * 10 ** max(2 * shift, 0), square.denominator * 10 ** max(-2 * shift, 0)
        root = isqrt(above // below)
        root += root * root * below < above
        if len(str(root)) == digits:
            return f"{str(root)[0]}.{str(root)[1:]}e{digits - 1 - shift}"
        shift += digits - len(str(root))


def solve(rows, right, positive_definite=False):
    """x with rows x = right, by elimination in integers, the shortest row first. Symmetric rows are positive definite by their pivots."""
    left, done, x = {}, [], [None] * len(rows)
    for i, row in enumerate(rows):
        factor = lcm(*(v.denominator for v in row.values()), right[i].denominator)
        left[i] = {**{j: int(v * factor) for j, v in row.items()}, len(rows): int(right[i] * factor)}
    while left:
        i = min(left, key=lambda k: len(left[k]))
        row = {j: v for j, v in left.pop(i).items() if v}
        columns = {j: sum(j in other for other in left.values()) for j in row if j < len(rows)}
        column = i if positive_definite else min(columns, key=columns.get, default=None)
        expect(row.get(column, 0) > 0 or not positive_definite, "M is not positive definite")
        expect(column in row, "its equations depend on each other")
        for k, other in left.items():
            if column in other:
                common = gcd(other[column], row[column])
                keep, take = row[column] // common, other.pop(column) // common
                both = {j: keep * other.get(j, 0) - take * row.get(j, 0) for j in {**other, **row} if j != column}
                common = gcd(*both.values())
                left[k] = {j: v // common for j, v in both.items() if v}
        done.append((column, row))
    for column, row in reversed(done):
        x[column] = (row.get(len(rows), 0) - dot((Fraction(v), x[j]) for j, v in row.items() if j not in (column, len(rows)))) / row[column]
    return x


class Problem:
    """M, z_u, J, c, kind, mu and law (docs/formulation.md), each number as the fraction that it is."""

    def __init__(self, given):
        self.n, self.m, self.law, self.kind = given["n"], given["m"], given["law"], given["kind"]
        doubles = {name: [-inf if x is None else float(x) for x in given[name]] for name in ("z_u", "c", "kind", "mu")}
        for name, size in ("z_u", self.n), ("c", self.m), ("kind", self.m), ("mu", self.m if TANGENT in self.kind else 0):
            expect(len(doubles[name]) == size, f"{name} should have {size} numbers", 3)
            for i, x in enumerate(doubles[name]):
                expect(isfinite(x) or (name, x, self.kind[i]) == ("c", -inf, INEQUALITY), f"{name}[{i}] is {x}", 3)
        self.z_u, self.c, self.mu = ([None if x == -inf else Fraction(x) for x in doubles[name]] for name in ("z_u", "c", "mu"))
        self.M, self.J = ([{} for _ in range(size)] for size in (self.n, self.m))
        words = struct.pack("<2q", self.n, self.m)
        for name, rows in ("M", self.M), ("J", self.J):
            for i, j, x in sorted(given[name], key=lambda entry: entry[1::-1] if name == "M" else entry[:2]):
                expect(0 <= i < len(rows) and 0 <= j < self.n and j not in rows[i] and isfinite(x), f"{name} has a bad entry {i}, {j}", 3)
                rows[i].update({j: Fraction(x)} if x else {})
                words += struct.pack("<2qd", i, j, x) if x else b""
            words += struct.pack("<q", -1)
        words += struct.pack(f"<{self.n + self.m}d{self.m}q", *doubles["z_u"], *doubles["c"], *self.kind)
        if self.mu:
            words += struct.pack(f"<{self.m}dq", *doubles["mu"], {"convex": 2, "coulomb": 3}[self.law])
        self.sha256 = hashlib.sha256(words).hexdigest()  # the name of its contents (docs/formats.md)
        self.columns = [{i: row[j] for i, row in enumerate(self.J) if j in row} for j in range(self.n)]
        expect(all(self.M[j].get(i) == x for i, row in enumerate(self.M) for j, x in row.items()), "M is not symmetric", 3)
        solve(self.M, self.z_u, positive_definite=True)
        heads = [i for i, kind in enumerate(self.kind) if kind != TANGENT] + [self.m]
        groups = [(i, range(i + 1, end), self.mu[i] if self.mu else 0) for i, end in zip(heads, heads[1:])]  # row, tangent rows, mu
        expect(heads[0] == 0 and all(self.kind[i] in (EQUALITY, INEQUALITY)[len(rows) > 0:] for i, rows, _ in groups), "bad kinds", 3)
        self.silent = {k for i, rows, _ in groups if self.c[i] is None for k in (i, *rows)}
        self.contacts = [group for group in groups if self.kind[group[0]] == INEQUALITY and group[0] not in self.silent]

    def held(self, rows, force, values):
        """y, w with M y - J_B'w = force and J_B y = values of these rows B."""
        system = [dict(row) for row in self.M + [self.J[i] for i in rows]]
        for k, i in enumerate(rows):
            for j, x in self.J[i].items():
                system[j][self.n + k] = -x
        x = solve(system, force + values)
        return x[:self.n], x[self.n:]

    def slack(self, i, z):
        return times(self.J[i], z) - self.c[i]

    def squared(self, z):
        return dot((x, times(row, z)) for x, row in zip(z, self.M))

    def squared_force(self, force):
        """force'M^-1 force."""
        return dot(zip(force, self.held([], force, [])[0]))

    def unbalanced(self, z, forces):
        """|M (z - z_u) - J'forces|^2 in the dual norm."""
        moved = [x - y for x, y in zip(z, self.z_u)]
        return self.squared_force([times(row, moved) - times(column, forces) for row, column in zip(self.M, self.columns)])

    def named(self, rows):
        expect(len(set(rows)) == len(rows) and all(0 <= i < self.m and i not in self.silent for i in rows), "rows that are none", 3)
        return rows

    def complementarity(self, z, forces):
        """forces'(J z - c), where z meets all rows and forces lie in their cones. Coulomb's law: where they also fit the slip."""
        total, equalities = 0, (i for i, kind in enumerate(self.kind) if kind == EQUALITY)
        expect(all(self.slack(i, z) == 0 for i in equalities), "an equality row does not hold")
        for i, tangents, mu in self.contacts:
            s, force = self.slack(i, z), forces[i]
            slips = [self.slack(k, z) for k in tangents]
            slip, along, work = dot(zip(slips, slips)), sum(forces[k]**2 for k in tangents), dot(zip((forces[k] for k in tangents), slips))
            expect(s >= 0 and (self.law == "coulomb" or s * s >= mu * mu * slip), f"row {i} does not hold")
            expect(force >= 0 and along <= (mu * force)**2, f"row {i} would have to pull, or its force leaves the cone")
            expect(self.law != "coulomb" or s * force == 0 and work <= 0 and work**2 == (mu * force)**2 * slip, f"row {i} slides otherwise")
            total += s * force + work
        return total


# What is proven: each function gives z and r^2, for a solution at most r from z.

def solution(p, proof):
    """z where the rows of the basis hold, with forces on them in balance: a solution, if it obeys the law in every row. frozen: forces that
    are given, of rows that depend on the basis."""
    basis, frozen, forces = p.named(proof["basis"]), dict(proof.get("frozen", ())), [Fraction(0)] * p.m
    for i in p.named([*basis, *frozen]):
        forces[i] = Fraction(frozen.get(i, 0))
    pushed = [times(row, p.z_u) + times(column, forces) for row, column in zip(p.M, p.columns)]
    z, held = p.held(basis, pushed, [p.c[i] for i in basis])
    for i, x in zip(basis, held):
        forces[i] = x
    total = p.complementarity(z, forces)
    expect(p.law == "coulomb" or total == 0, "rows push that do not touch")
    return z, Fraction(0)


def enclosure(p, proof):
    """Weak duality: |z - z*|^2 <= |M (z - z_u) - J'l|^2 + 2 l'(J z - c) of a z that meets all rows and forces l in their cones. z: near,
    brought onto the equality rows of the basis; the forces on them that this takes are in balance."""
    near, forces = ([sum(map(Fraction, parts)) for parts in proof[key]] for key in ("near", "forces"))
    expect(p.law != "coulomb" and (len(near), len(forces)) == (p.n, p.m), "no proof under this law, or of another length", 3)
    z, _ = p.held(p.named(proof["basis"]), [times(row, near) for row in p.M], [p.c[i] for i in proof["basis"]])
    return z, p.unbalanced(near, forces) + 2 * p.complementarity(z, forces)


def contradiction(p, proof):
    """Motion / distance, as text: of all z that meet the rows of the basis and one more, from z_u. "0": there are none. Weights u of these
    rows, u_I >= 0, leave c'u <= z'J'u, and so |z - z_u| >= (c - J z_u)'u / |J'u|."""
    basis, more = p.named(proof["basis"]), proof["more"]
    expect(more not in basis and all(p.kind[i] != TANGENT for i in p.named([*basis, more])), "rows that cannot contradict", 3)
    dense = {i: [p.J[i].get(j, Fraction(0)) for j in range(p.n)] for i in (more, *basis)}
    rest, weights = p.held(basis, dense[more], [Fraction(0)] * len(basis))
    u = {more: Fraction(1), **dict(zip(basis, weights))}
    gain, left, motion = -dot((x, p.slack(i, p.z_u)) for i, x in u.items()), times(p.J[more], rest), p.squared(p.z_u)
    sign = -1 if p.kind[more] == EQUALITY and gain < 0 else 1
    expect(sign * gain > 0 and all(p.kind[i] == EQUALITY or sign * x >= 0 for i, x in u.items()), "its rows do not contradict each other")
    for i in u if left else ():
        unit = p.squared_force(dense[i])
        motion = max(motion, p.slack(i, p.z_u)**2 / unit if unit else 0)
    return root_up(left * motion / gain**2)


def answer_sha256(answer):
    """Of its status, a line break, the doubles of z, those of lambda."""
    numbers = [float(x) for key in ("z", "lambda") for x in answer.get(key) or ()]
    return hashlib.sha256(answer["status"].encode() + b"\n" + struct.pack(f"<{len(numbers)}d", *numbers)).hexdigest()


def check(proof, p):
    """Holds every statement of the proof against the problem; returns the sentence."""
    expect((proof["zwang_proof"], proof["sha256"]) == (1, p.sha256), "the problem's numbers are not those that the proof names")
    expect(answer_sha256(proof) == proof["answer_sha256"], "the answer is not the one that the proof names")
    z, forces = ([Fraction(x) for x in proof.get(key) or ()] for key in ("z", "lambda"))
    expect(len(z) in (0, p.n) and len(forces) in (0, p.m), "an answer of another length", 3)
    found = {"verdict": "wrong"}
    if "more" in proof:
        found["contradiction"] = contradiction(p, proof)
        expect(Fraction(found["contradiction"]) <= Fraction(1e-8), "its rows can be met within 1e8 motions")
        found["verdict"] = "infeasible, proven" if proof["status"] == "infeasible" else "wrong"
        said = f"no z meets the rows {', '.join(map(str, sorted([*proof['basis'], proof['more']])))}" + (
            "" if found["contradiction"] == "0" else f" within {1 / float(found['contradiction']):.3g} motions")
    else:
        true, square = enclosure(p, proof) if "near" in proof else solution(p, proof)
        motion, said = max(p.squared(p.z_u), p.squared(true)), "there is a solution"
        if z:
            away = p.squared([x - y for x, y in zip(z, true)])
            expect(square < motion or not away + square, "there is too little motion to measure by")
            away, radius = (Fraction(root_up(x / (motion or 1), 60)) for x in (away, square))  # and |z*| is as near to |true|
            far, near = (away + radius) / (1 - radius), (away * (1 - Fraction(10)**-50) - radius) / (1 + radius)
            accepted = max(10 * Fraction(proof["tolerance"]), Fraction(1e-12))
            allowed = max(accepted, min(1000 * accepted, Fraction(1e-2)))
            found["verdict"] = "solved" if far <= accepted else "near" if far <= allowed else "wrong" if near > allowed else "undecided"
            expect(p.law != "coulomb" or found["verdict"] != "wrong", "another solution may be near")
            found["distance"] = root_up(far * far)
            said = f"z is {float(far):.3g} of the motion off {'a' if p.law == 'coulomb' else 'the'} solution" if far else "z is a solution"
        if z and forces:
            forces = [0 if i in p.silent else x for i, x in enumerate(forces)]
            found["imbalance"] = root_up(p.unbalanced(z, forces) / (motion or 1))
            found["pulling"] = sum(forces[i] < 0 for i, _, _ in p.contacts)
            said += f", its forces are {float(found['imbalance']):.3g} out of balance"
    for key in "verdict", "distance", "imbalance", "pulling", "contradiction":
        expect(proof.get(key) == found.get(key), f"it states {key} {proof.get(key)}, and true is {found.get(key)}")
    return f"{found['verdict']} (said: {proof['status']}, to {float(proof['tolerance'])}): {said}"


def read(path):
    """A JSON file, or a problem in zwang's HDF5 layout; None where there is no h5py to read it."""
    if not path.endswith(".h5"):
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    try:
        import h5py
    except ImportError:
        return None
    p = h5py.File(path, "r")["zwang"]
    found = {name: p[name][:].tolist() if name in p else [] for name in ("z_u", "c", "kind", "mu")}
    for name in "M", "J":
        starts, places, values = (p[name][part][:].tolist() for part in "pix")
        lines = [line for line, (start, end) in enumerate(zip(starts, starts[1:])) for _ in range(start, end)]
        found[name] = list(zip(*((places, lines) if name == "M" else (lines, places)), values))
    return {**found, "n": len(found["z_u"]), "m": len(found["c"]), "law": p["law"].asstr()[0] if "law" in p else "coulomb"}


def main():
    parser = argparse.ArgumentParser(description="Checks proofs that zwang wrote (docs/packs.md).")
    parser.add_argument("proofs", nargs="+", metavar="PROOF", help="a proof file, or a folder of them")
    parser.add_argument("--pack", metavar="DIR", help="its index has to name the problems, and its files (read where h5py is) to hold them")
    parser.add_argument("--answers", metavar="FILE", help="lines of JSON, in which the answers have to stand")
    options = parser.parse_args()
    getattr(sys, "set_int_max_str_digits", int)(0)
    index = read(os.path.join(options.pack, "pack.json"))["problems"] if options.pack else ()
    pack = {p["sha256"]: os.path.join(options.pack, p["file"]) for p in index}
    with open(options.answers or os.devnull, encoding="utf-8") as lines:
        given = {a["sha256"]: answer_sha256(a) for a in map(json.loads, lines) if "sha256" in a}
    problems, refused = {}, 0
    for path in options.proofs:
        inside = (os.path.join(place, name) for place, _, names in os.walk(path) if place[-9:] != "/problems" for name in names)
        for at in sorted(inside) or [path]:
            try:
                proof = read(at)
                twin = os.path.join(os.path.dirname(at), proof["problem"])
                problems[twin] = problems.get(twin) or Problem(read(twin))
                name, link = problems[twin].sha256, ""
                if options.pack:
                    expect(name in pack, "the pack names no problem of these numbers")
                    stored = read(pack[name])
                    expect(not stored or Problem(stored).sha256 == name, f"{pack[name]} holds other numbers")
                    link = "; the pack's file holds these numbers" if stored else "; the pack's index names these numbers"
                expect(not options.answers or given.get(proof["sha256"]) == proof["answer_sha256"], f"{options.answers} has another answer")
                print(f"{at}: {proof['solver']}, {proof['name']}: {check(proof, problems[twin])}{link}", flush=True)
            except Refused as why:
                expect(why.args[0] == 1, f"{at}: {why.args[1]}", 3)
                refused = 1
                print(f"{at}: NOT PROVEN: {why.args[1]}", flush=True)
            except (KeyError, TypeError, ValueError, ArithmeticError, AttributeError, IndexError, struct.error) as why:
                raise Refused(3, f"{at}: {why!r}") from None
    return refused


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (Refused, OSError, ValueError, KeyError, TypeError) as wrong:
        print((wrong.args[1] if isinstance(wrong, Refused) else str(wrong)).replace("\n", " "), file=sys.stderr)
        sys.exit(3)
