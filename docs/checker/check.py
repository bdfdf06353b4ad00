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
from collections import Counter
from fractions import Fraction
from math import gcd, inf, isfinite, isqrt, lcm
from random import Random

EQUALITY, INEQUALITY, TANGENT = 0, 1, 2
PRIMES = 2**127 - 1, 2**107 - 1, 2**521 - 1


class BadInput(Exception):
    """One line: what, where, what was expected."""


class NotProven(Exception):
    """Where the proof does not hold."""


def expect(holds, why, kind=NotProven):
    if not holds:
        raise kind(why)


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


# Linear systems, solved modulo powers of a prime (Dixon 1982); what they give is verified by multiplication.

def parts_of(rows, size):
    """Rows and unknowns that hang together, as pairs of lists."""
    above, parts = list(range(size)), {}

    def top(j):
        while above[j] != j:
            above[j] = j = above[above[j]]
        return j
    expect(all(rows), "its equations depend on each other")
    for row in rows:
        for j in row:
            above[top(j)] = top(next(iter(row)))
    for j in range(size):
        parts.setdefault(top(j), ([], []))[1].append(j)
    for i, row in enumerate(rows):
        parts[top(next(iter(row)))][0].append(i)
    return parts.values()


def factored(rows, p):
    """Gaussian elimination modulo p, the shortest row first; None where a pivot is missing."""
    left, count, steps = {i: {j: v % p for j, v in row.items()} for i, row in enumerate(rows)}, Counter(j for row in rows for j in row), []
    while left:
        i = min(left, key=lambda k: len(left[k]))
        row = {j: v for j, v in left.pop(i).items() if v}
        if not row:
            return None
        column, below = min(row, key=count.get), []
        inverse = pow(row.pop(column), -1, p)
        for k, other in left.items():
            if column in other:
                below.append((k, other.pop(column) * inverse % p))
                for j, v in row.items():
                    other[j] = (other.get(j, 0) - below[-1][1] * v) % p
        steps.append((i, column, inverse, below, list(row.items())))
    return steps


def solved_modulo(steps, right, p):
    x, right = [0] * len(right), list(right)
    for i, _, _, below, _ in steps:
        right[i] %= p
        for k, factor in below if right[i] else ():
            right[k] -= factor * right[i]
    for i, column, inverse, _, tail in reversed(steps):
        x[column] = (right[i] - sum(v * x[j] for j, v in tail)) * inverse % p
    return x


def denominator(residue, modulus):
    """Of the fraction of small terms that leaves this residue."""
    a, b, t, u = modulus, residue, 0, 1
    while 2 * b * b > modulus:
        quotient = a // b
        a, b, t, u = b, a - quotient * b, u, t - quotient * u
    return abs(u)


def lifted(rows, right):
    """x with rows x = right, all integers: numerators and their denominator."""
    for p in PRIMES:
        if steps := factored(rows, p):
            break
    expect(steps, "its equations depend on each other")
    rest, x, power, attempt, draw = list(right), [0] * len(right), 1, 0, Random(1)
    most = 4 * sum(sum(map(abs, row.values())).bit_length() for row in rows) + 4 * max(map(abs, right)).bit_length() + 1000
    while True:
        digit = solved_modulo(steps, rest, p)
        rest = [(r - sum(v * digit[j] for j, v in row.items())) // p for r, row in zip(rest, rows)]
        x, power = [a + d * power for a, d in zip(x, digit)], power * p
        if power.bit_length() < attempt and any(rest):
            continue
        attempt, below = power.bit_length() * 4 // 3, 1
        for _ in range(4):  # of a random sum: the denominator of all numbers, but by bad luck
            if below * below << 32 < power:
                below *= denominator(sum(a * draw.getrandbits(64) for a in x) * below % power, power)
        expect(power.bit_length() < most, "its equations have no solution that can be found")
        if below * below << 32 > power:
            continue
        above = [(a * below + power // 2) % power - power // 2 for a in x]
        if all(sum(v * above[j] for j, v in row.items()) == r * below for row, r in zip(rows, right)):
            return above, below


def solve(rows, right):
    """x with rows x = right, fractions."""
    x = [Fraction(0)] * len(rows)
    for own_rows, own in parts_of(rows, len(rows)):
        expect(len(own_rows) == len(own), "its equations depend on each other")
        if not any(right[i] for i in own_rows):
            continue
        place, whole, sides = {j: k for k, j in enumerate(own)}, [], []
        for i in own_rows:
            factor = lcm(*(v.denominator for v in rows[i].values()), right[i].denominator)
            common = gcd(*(int(v * factor) for v in rows[i].values()), int(right[i] * factor))
            whole.append({place[j]: int(v * factor) // common for j, v in rows[i].items()})
            sides.append(int(right[i] * factor) // common)
        above, below = lifted(whole, sides)
        for j, a in zip(own, above):
            x[j] = Fraction(a, below)
    return x


def positive_definite(rows):
    """By the signs of the leading minors, in integers (Bareiss 1968)."""
    for own, columns in parts_of(rows, len(rows)):
        factor, last = lcm(*(v.denominator for i in own for v in rows[i].values())), 1
        a = [[int(rows[i].get(j, 0) * factor) for j in columns] for i in own]
        for k, row in enumerate(a):
            if row[k] <= 0:
                return False
            for other in a[k + 1:]:
                other[k:] = [(x * row[k] - other[k] * y) // last for x, y in zip(other[k:], row[k:])]
            last = row[k]
    return True


class Problem:
    """M, z_u, J, c, kind, mu and law (docs/formulation.md), each number as the fraction that it is."""

    def __init__(self, given):
        self.n, self.m, self.law, self.kind = given["n"], given["m"], given["law"], given["kind"]
        self.doubles = {name: [-inf if x is None else float(x) for x in given[name]] for name in ("z_u", "c", "mu")}
        for name, sizes in ("z_u", (self.n,)), ("c", (self.m,)), ("kind", (self.m,)), ("mu", (0, self.m)):
            expect(len(given[name]) in sizes, f"{name} should have {sizes[-1]} numbers", BadInput)
            expect(name != "kind" or set(self.kind) <= {EQUALITY, INEQUALITY, TANGENT}, "a kind should be 0, 1 or 2", BadInput)
            for i, x in enumerate(self.doubles.get(name, ())):
                expect(isfinite(x) or (name, x, self.kind[i]) == ("c", -inf, INEQUALITY), f"{name}[{i}] is {x}", BadInput)
        self.z_u, self.c = ([None if x == -inf else Fraction(x) for x in self.doubles[name]] for name in ("z_u", "c"))
        self.M, self.J, self.columns = ([{} for _ in range(size)] for size in (self.n, self.m, self.n))
        for name, rows in ("M", self.M), ("J", self.J):
            for i, j, x in given[name]:
                expect(0 <= i < len(rows) and 0 <= j < self.n and j not in rows[i] and isfinite(x), f"{name} has a bad entry at {i}, {j}",
                       BadInput)
                rows[i].update({j: Fraction(x)} if x else {})
        for i, row in enumerate(self.J):
            for j, x in row.items():
                self.columns[j][i] = x
        expect(all(self.M[j].get(i) == x for i, row in enumerate(self.M) for j, x in row.items()), "M is not symmetric", BadInput)
        expect(positive_definite(self.M), "M is not positive definite", BadInput)
        self.sha256 = self.name()

    def name(self):
        """SHA-256 of its contents (docs/formats.md)."""
        words = struct.pack("<2q", self.n, self.m)
        for lines, swap in (self.M, True), (self.J, False):
            for i, row in enumerate(lines):
                words += b"".join(struct.pack("<2qd", *((j, i) if swap else (i, j)), float(x)) for j, x in sorted(row.items()))
            words += struct.pack("<q", -1)
        words += b"".join(struct.pack("<d", x) for name in ("z_u", "c") for x in self.doubles[name])
        words += struct.pack(f"<{self.m}q", *self.kind)
        if self.doubles["mu"]:
            words += struct.pack(f"<{self.m}dq", *self.doubles["mu"], {"convex": 2, "coulomb": 3}[self.law])
        return hashlib.sha256(words).hexdigest()

    def held(self, rows, force, values):
        """y, w with M y - J_B'w = force and J_B y = values on the rows B."""
        place, system = {i: self.n + k for k, i in enumerate(rows)}, [dict(row) for row in self.M + [self.J[i] for i in rows]]
        for j, column in enumerate(self.columns):
            system[j].update((place[i], -x) for i, x in column.items() if i in place)
        x = solve(system, list(force) + list(values))
        return x[:self.n], x[self.n:]

    def slack(self, i, z):
        return times(self.J[i], z) - self.c[i]

    def squared(self, z):
        """z'M z."""
        return dot((x, times(row, z)) for x, row in zip(z, self.M))

    def squared_force(self, force):
        """force' M^-1 force."""
        return dot(zip(force, self.held([], force, [])[0]))

    def dense(self, i):
        return [self.J[i].get(j, Fraction(0)) for j in range(self.n)]

    def named(self, proof, key):
        rows = proof[key]
        expect(len(set(rows)) == len(rows) and all(0 <= i < self.m and self.c[i] is not None and self.kind[i] != TANGENT for i in rows),
               f"{key} should name rows that say something, each once", BadInput)
        return rows


def solution(problem, proof):
    """z* at which the rows of the basis hold with forces that push: the only one, as the program is strictly convex."""
    basis = problem.named(proof, "basis")
    z, force = problem.held(basis, [times(row, problem.z_u) for row in problem.M], [problem.c[i] for i in basis])
    for i, x in zip(basis, force):
        expect(problem.kind[i] == EQUALITY or x >= 0, f"row {i} would have to pull")
    for i in set(range(problem.m)) - set(basis):
        s = problem.slack(i, z) if problem.c[i] is not None else 0
        expect(s == 0 or s > 0 and problem.kind[i] == INEQUALITY, f"row {i} does not hold")
    return z


def contradiction(problem, proof):
    """As text, motion / distance for a distance that every z keeps from z_u which meets the rows of the basis and one more.

    Weights u of these rows, u_I >= 0, leave c'u <= z'J'u; so |z - z_u| >= (c - J z_u)'u / |J'u|. "0": there is no z at all."""
    basis, more = problem.named(proof, "basis"), problem.named(proof, "more")
    expect(len(more) == 1 and more[0] not in basis, "more should name one row beside the basis", BadInput)
    rest, weights = problem.held(basis, problem.dense(more[0]), [Fraction(0)] * len(basis))
    u = {more[0]: Fraction(1), **dict(zip(basis, weights))}
    gain = -dot((x, problem.slack(i, problem.z_u)) for i, x in u.items())
    sign = -1 if problem.kind[more[0]] == EQUALITY and gain < 0 else 1
    for i, x in u.items():
        expect(problem.kind[i] == EQUALITY or sign * x >= 0, f"row {i} has a negative weight")
    expect(gain, "its combination of rows contradicts nothing")
    expect(sign * gain > 0, "its combination of rows contradicts nothing")
    left, motion = times(problem.J[more[0]], rest), problem.squared(problem.z_u)
    for i in u if left else ():
        if any(problem.J[i]):
            motion = max(motion, problem.slack(i, problem.z_u) ** 2 / problem.squared_force(problem.dense(i)))
    return root_up(left * motion / gain**2)


def verdict_of(square, tolerance):
    accepted = max(10 * Fraction(tolerance), Fraction(1e-12))
    near = max(accepted, min(1000 * accepted, Fraction(1e-2)))
    return "solved" if square <= accepted**2 else "near" if square <= near**2 else "wrong"


def answer_sha256(answer):
    """Of its status, a line break, the doubles of z, those of lambda."""
    numbers = [float(x) for key in ("z", "lambda") for x in answer.get(key) or ()]
    return hashlib.sha256(answer["status"].encode() + b"\n" + struct.pack(f"<{len(numbers)}d", *numbers)).hexdigest()


def check(proof, problem):
    """Holds every statement of the proof against the problem; returns the sentence."""
    expect(problem.sha256 == proof["sha256"], "the problem's numbers are not those that the proof names")
    expect(answer_sha256(proof) == proof["answer_sha256"], "the answer is not the one that the proof names")
    z, force = ([Fraction(x) for x in proof.get(key) or ()] for key in ("z", "lambda"))
    expect(len(z) in (0, problem.n) and len(force) in (0, problem.m), "an answer of another length", BadInput)
    found = {"verdict": "wrong"}
    if "more" in proof:
        far = found["contradiction"] = contradiction(problem, proof)
        expect(Fraction(far) <= Fraction(1e-8), "its rows can be met within 1e8 motions")
        if proof["status"] == "infeasible":
            found["verdict"] = "infeasible, proven"
        rows = ", ".join(map(str, sorted(proof["basis"] + proof["more"])))
        said = f"no z meets the rows {rows}" + ("" if far == "0" else f" within {1 / float(far):.3g} motions")
    else:
        true = solution(problem, proof)
        size, said = max(problem.squared(problem.z_u), problem.squared(true)), "some z meets all rows"

        def relative(square):
            expect(size or not square, "there is no motion to measure by")
            return square / size if square else square
        if z:
            square = relative(problem.squared([a - b for a, b in zip(z, true)]))
            found.update(verdict=verdict_of(square, proof["tolerance"]), distance=root_up(square))
            said = f"z is {float(found['distance']):.3g} of the motion away from the solution" if square else "z is the solution"
        if z and force:
            used = [x if problem.c[i] is not None else 0 for i, x in enumerate(force)]
            rest = [times(row, z) - times(row, problem.z_u) - times(column, used) for row, column in zip(problem.M, problem.columns)]
            found["imbalance"] = root_up(relative(problem.squared_force(rest)))
            found["pulling"] = sum(x < 0 for i, x in enumerate(used) if problem.kind[i] == INEQUALITY)
            said += f", its forces are {float(found['imbalance']):.3g} out of balance"
    for key in "verdict", "distance", "imbalance", "pulling", "contradiction":
        expect(proof.get(key) == found.get(key), f"it states {key} {proof.get(key)}, and true is {found.get(key)}")
    return f"{found['verdict']} (said: {proof['status']}): {said}"


def read(path):
    """A JSON file, or a problem of zwang's HDF5 layout."""
    try:
        if not path.endswith(".h5"):
            with open(path, encoding="utf-8") as file:
                return json.load(file)
        import h5py
        with h5py.File(path, "r") as file:
            p, sparse = file["zwang"], {}
            for name, swap in ("M", 1), ("J", 0):
                starts, places, sparse[name] = p[name]["p"][:].tolist(), p[name]["i"][:].tolist(), []
                for line, (start, end) in enumerate(zip(starts, starts[1:])):
                    for k in range(start, end):
                        sparse[name].append((*((places[k], line) if swap else (line, places[k])), float(p[name]["x"][k])))
            rest = {name: p[name][:].tolist() if name in p else [] for name in ("z_u", "c", "kind", "mu")}
            return {**sparse, **rest, "n": len(rest["z_u"]), "m": len(rest["c"]), "law": p["law"].asstr()[0] if "law" in p else "coulomb"}
    except (OSError, ValueError) as wrong:
        raise BadInput(f"{path}: {wrong}") from None


def linked(problem, index):
    """The problem and what ties it to the pack: a file of the same numbers, where h5py is there to read it, or the name."""
    expect(problem.sha256 in index, "the pack names no problem of these numbers")
    try:
        stored = read(index[problem.sha256])
    except ImportError:
        return problem, "; the pack's index names these numbers"
    expect(Problem(stored).sha256 == problem.sha256, f"{index[problem.sha256]} holds other numbers")
    return problem, "; the pack's file holds these numbers"


def main():
    parser = argparse.ArgumentParser(description="Checks proofs that zwang wrote (docs/packs.md).")
    parser.add_argument("proofs", nargs="+", metavar="PROOF", help="a proof file, or a folder of them")
    parser.add_argument("--pack", metavar="DIR", help="its index has to name the problems, and its files (read where h5py is there) to hold them")
    parser.add_argument("--answers", metavar="FILE", help="lines of JSON, in which the answers have to stand")
    options = parser.parse_args()
    getattr(sys, "set_int_max_str_digits", int)(0)
    files, index, given, problems, refused = [], {}, {}, {}, 0
    for path in options.proofs:
        inside = sorted(os.path.join(place, name) for place, _, names in os.walk(path) for name in names if os.path.basename(place) != "problems")
        files += inside or [path]
    if options.pack:
        index = {p["sha256"]: os.path.join(options.pack, p["file"]) for p in read(os.path.join(options.pack, "pack.json"))["problems"]}
    if options.answers:
        with open(options.answers, encoding="utf-8") as lines:
            given = {a["sha256"]: answer_sha256(a) for a in map(json.loads, lines) if "sha256" in a}
    for path in files:
        try:
            proof = read(path)
            twin = os.path.join(os.path.dirname(path), proof["problem"])
            if twin not in problems:
                problems[twin] = linked(Problem(read(twin)), index) if options.pack else (Problem(read(twin)), "")
            problem, link = problems[twin]
            expect(not options.answers or given.get(proof["sha256"]) == proof["answer_sha256"], f"{options.answers} has another answer")
            print(f"{path}: {proof['solver']}, {proof['name']}: {check(proof, problem)}{link}")
        except NotProven as why:
            refused += 1
            print(f"{path}: NOT PROVEN: {why}")
        except (BadInput, KeyError, TypeError, ValueError, OverflowError, AttributeError, IndexError) as why:
            raise BadInput(f"{path}: {why if isinstance(why, BadInput) else repr(why)}") from None
    return 1 if refused else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except BadInput as why:
        print(str(why).replace("\n", " "), file=sys.stderr)
        sys.exit(3)
