#!/usr/bin/env python3
"""Checks proofs that `./zwang judge --proofs` wrote, from the numbers of the problem alone.

PROOF: a proof file or a folder of them. One sentence a file; exit code 0: all hold, 1: one does not, 2: wrong use, 3: bad input.
Python 3.9 is all it needs. Every double enters as the rational that it is; integers and fractions decide everything (docs/packs.md).
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
    shift = root = 0
    while square and len(str(root)) != digits:
        shift += digits - len(str(root))
        above = square * Fraction(100)**shift
        root = isqrt(int(above))
        root += root * root < above
    return f"{str(root)[0]}.{str(root)[1:]}e{digits - 1 - shift}" if square else "0"


def solve(rows, *rights, positive_definite=False):
    """An x with rows x = right for each right, by elimination in integers, the shortest row first."""
    left, done, size, x = {}, [], len(rows), [[None] * len(rows) for _ in rights]
    for i, row in enumerate(rows):
        whole = {**row, **{size + k: right[i] for k, right in enumerate(rights)}}
        factor = lcm(*(v.denominator for v in whole.values()))
        left[i] = {j: int(v * factor) for j, v in whole.items() if v}
    while left:
        i = min(left, key=lambda k: len(left[k]))
        row = left.pop(i)
        columns = {j: sum(j in other for other in left.values()) for j in row if j < size}
        column = i if positive_definite else min(columns, key=columns.get, default=None)
        expect(row.get(column, 0) > 0 or not positive_definite, "M is not positive definite")
        expect(column in row, "its equations depend on each other")
        for k, other in left.items():
            if column in other:
                keep, take = row[column], other.pop(column)
                both = {j: keep * other.get(j, 0) - take * row.get(j, 0) for j in {**other, **row} if j != column}
                common = gcd(*both.values())
                left[k] = {j: v // common for j, v in both.items() if v}
        done.append((column, row))
    for column, row in reversed(done):
        for k, found in enumerate(x):
            rest = dot((Fraction(v), found[j]) for j, v in row.items() if j != column and j < size)
            found[column] = (row.get(size + k, 0) - rest) / row[column]
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
        words += struct.pack(f"<{self.m}dq", *doubles["mu"], {"convex": 2, "coulomb": 3}[self.law]) if self.mu else b""
        self.sha256 = hashlib.sha256(words).hexdigest()  # the name of its contents (docs/formats.md)
        expect(all(self.M[j].get(i) == x for i, row in enumerate(self.M) for j, x in row.items()), "M is not symmetric", 3)
        solve(self.M, self.z_u, positive_definite=True)
        heads = [i for i, kind in enumerate(self.kind) if kind != TANGENT] + [self.m]
        groups = [(i, range(i + 1, end), self.mu[i] if self.mu else 0) for i, end in zip(heads, heads[1:])]  # row, tangent rows, mu
        expect(heads[0] == 0 and all(self.kind[i] in (EQUALITY, INEQUALITY)[len(rows) > 0:] for i, rows, _ in groups), "bad kinds", 3)
        self.silent = {k for i, rows, _ in groups if self.c[i] is None for k in (i, *rows)}
        self.contacts = [group for group in groups if self.kind[group[0]] == INEQUALITY and group[0] not in self.silent]

    def balance(self, rows):
        """M y - J_B'w of these rows B, as rows in y and w."""
        system = [dict(row) for row in self.M]
        for k, i in enumerate(rows):
            for j, x in self.J[i].items():
                system[j][self.n + k] = -x
        return system

    def combined(self, terms):
        """The sum of rows of J times numbers."""
        return {j: sum(x * self.J[i].get(j, 0) for i, x in terms) for i, _ in terms for j in self.J[i]}

    def squared(self, z):
        return dot((x, times(row, z)) for x, row in zip(z, self.M))

    def named(self, rows):
        expect(len(set(rows)) == len(rows) and all(0 <= i < self.m and i not in self.silent for i in rows), "rows that are none", 3)
        return rows


def solution(p, proof):
    """z and r^2, for a solution that is at most r from z. At z the rows of the basis hold, with forces on them in balance. frozen: forces
    that are given. slides: contacts that slide, and near the solution their force l, k = slip / friction, direction d. For them |f| = mu l,
    d x (slip + k f) = 0 and, where slip lifts, s = mu |slip| are equations, linear but for terms of second order. These are at most as
    large as the proof says wherever they are that, and so somewhere what they have to be (Brouwer)."""
    frozen, lifts, curved = dict(proof.get("frozen", ())), p.law == "convex", {}
    met = [(p.J[i], p.c[i]) for i, kind in enumerate(p.kind) if kind == EQUALITY]
    slides = {i: [Fraction(x) for x in near] for i, *near in proof.get("slides", ())}
    rows = p.named([*proof["basis"], *frozen])
    place = {i: p.n + k for k, i in enumerate(rows)}
    system = p.balance(rows) + [{place[i]: 1} if i in frozen else p.J[i] for i in rows]
    right = [times(row, p.z_u) for row in p.M] + [Fraction(frozen[i]) if i in frozen else p.c[i] for i in rows]
    for i, tangents, mu in (contact for contact in p.contacts if contact[0] in slides):
        l, k, most, *d = slides[i]
        at, bent = [place[t] for t in tangents], mu * l * (1 - dot(zip(d, d))) / 2
        system[at[0]], right[at[0]] = {place[i]: mu, **dict(zip(at, d))}, bent
        if len(at) == 2:
            terms = (tangents[1], d[0] / k), (tangents[0], -d[1] / k)
            system[at[1]], right[at[1]] = {**p.combined(terms), at[0]: -d[1], at[1]: d[0]}, sum(x * p.c[t] for t, x in terms)
            curved.update(dict.fromkeys([*at, place[i]][:2 + lifts], most))
        if lifts:
            terms = (i, 1 / (k * mu)), *((t, -x / k) for t, x in zip(tangents, d))
            lifted = p.combined(terms), sum(x * p.c[t] for t, x in terms) + bent
            met += [lifted] * (i in frozen)
            system[place[i]], right[place[i]] = (system[place[i]], right[place[i]]) if i in frozen else lifted
    x, *bends = solve(system, right, *([int(j == row) for j in range(len(system))] for row in curved))

    def between(row, less=0):
        """What the row's product with the solution, less this, is between."""
        middle, bent = times(row, x) - less, dot((abs(times(row, bend)), most) for bend, most in zip(bends, curved.values()))
        return middle - bent, middle + bent

    def off(ends, near=0):
        return max(abs(end - near) for end in ends)

    expect(all(between(*row) == (0, 0) for row in met), "an equality row does not hold, or one that should lift")
    for i, tangents, mu in p.contacts:
        s, *slips = (between(p.J[t], p.c[t]) for t in (i, *tangents))
        push, *along = (between({place[t]: 1} if t in place else {}) for t in (i, *tangents))
        expect(s[0] >= 0 and push[0] >= 0 and ((0, 0) in (s, push) or lifts and i in slides), f"row {i} does not hold, or pushes otherwise")
        if i in slides:
            l, k, most, *d = slides[i]
            far = mu * off(push, l) + off(s, lifts * k * mu * mu * l) / (k * mu)
            far += sum(off(f, -mu * l * y) + off(slip, k * mu * l * y) / k for f, slip, y in zip(along, slips, d))
            bounded = len(d) == len(tangents) == 2 and min(k, most) >= 0 and far * far <= mu * l * most and not (lifts and i in frozen)
            aligned = most == 0 and sorted(map(abs, d)) == [0, 1][-len(d):]
            straight = aligned and all(f == slip == (0, 0) for f, slip, y in zip(along, slips, d) if y == 0)
            expect(bounded or straight, f"row {i} is farther from what is linear than the proof says")
            expect(sum(max(u * v for u in f for v in slip) for f, slip in zip(along, slips)) <= 0, f"row {i} slides along its force")
        else:
            expect(mu * push[1] == 0 or all(slip == (0, 0) for slip in slips), f"row {i} slides otherwise")
            lift, friction = (sum(off(ends)**2 for ends in of) for of in (slips, along))
            expect(friction <= (mu * push[0])**2 and lifts * mu * mu * lift <= s[0]**2, f"row {i} leaves its cone")
    return x[:p.n], sum(Fraction(root_up(p.squared(bend[:p.n]))) * most for bend, most in zip(bends, curved.values()))**2


def contradiction(p, proof):
    """Motion / distance, as text: of all z that meet the rows of the basis and one more, from z_u. "0": there are none. Weights u of these
    rows, u_I >= 0, leave c'u <= z'J'u, and so |z - z_u| >= (c - J z_u)'u / |J'u|."""
    basis, more = p.named(proof["basis"]), proof["more"]
    expect(all(p.kind[i] != TANGENT for i in p.named([*basis, more])), "rows that cannot contradict", 3)
    dense = {i: [p.J[i].get(j, Fraction(0)) for j in range(p.n)] for i in (more, *basis)}
    x, = solve(p.balance(basis) + [p.J[i] for i in basis], dense[more] + [Fraction(0)] * len(basis))
    u, slack = {more: Fraction(1), **dict(zip(basis, x[p.n:]))}, {i: times(p.J[i], p.z_u) - p.c[i] for i in dense}
    gain, left = -dot((u[i], slack[i]) for i in u), times(p.J[more], x)
    sign = -1 if p.kind[more] == EQUALITY and gain < 0 else 1
    expect(sign * gain > 0 and all(p.kind[i] == EQUALITY or sign * x >= 0 for i, x in u.items()), "its rows do not contradict each other")
    units = [dot(zip(row, pulled)) for row, pulled in zip(dense.values(), solve(p.M, *dense.values()))]
    motion = max([p.squared(p.z_u), *(slack[i]**2 / unit for i, unit in zip(dense, units) if unit)])
    return root_up(left * motion / gain**2)


def answer_sha256(answer):
    """Of its status, a line break, the doubles of z, those of lambda."""
    numbers = [float(x) for key in ("z", "lambda") for x in answer.get(key) or ()]
    return hashlib.sha256(answer["status"].encode() + b"\n" + struct.pack(f"<{len(numbers)}d", *numbers)).hexdigest()


def check(proof, p):
    """Holds every statement of the proof against the problem; returns the sentence."""
    expect((proof["zwang_proof"], proof["sha256"]) == (2, p.sha256), "the problem's numbers are not those that the proof names")
    expect(answer_sha256(proof) == proof["answer_sha256"], "the answer is not the one that the proof names")
    z, forces = ([Fraction(x) for x in proof.get(key) or ()] for key in ("z", "lambda"))
    expect(len(z) in (0, p.n) and len(forces) in (0, p.m), "an answer of another length", 3)
    found = {"verdict": "wrong"}
    if "more" in proof:
        found["contradiction"] = contradiction(p, proof)
        expect(Fraction(found["contradiction"]) <= Fraction(1e-8), "its rows can be met within 1e8 motions")
        found["verdict"] = "infeasible, proven" if proof["status"] == "infeasible" else "wrong"
        said = f"no z meets the rows {sorted([*proof['basis'], proof['more']])}, motions / distance {found['contradiction']}"
    else:
        true, square = solution(p, proof)
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
            left = [times(row, [x - y for x, y in zip(z, p.z_u)] + forces) for row in p.balance(range(p.m))]
            found["imbalance"] = root_up(dot(zip(left, solve(p.M, left)[0])) / (motion or 1))
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
    pack = {p["sha256"]: p["file"] for p in read(os.path.join(options.pack, "pack.json"))["problems"]} if options.pack else {}
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
                    stored = read(os.path.join(options.pack, pack[name]))
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
