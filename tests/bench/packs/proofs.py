"""Proofs of answers: what zwang writes is verified by docs/checker/check.py in a folder without zwang, and what was tampered with is not.

Usage: proofs.py PROGRAM CHECKER [COUNT]

COUNT: this many true proofs of small problems, and as many tampered ones, alone; otherwise 100 after the files of a hand, a chain and such.
"""
import copy
import importlib.util
import json
import os
import random
import shutil
import subprocess
import sys
import tempfile

import h5py
import numpy

program, checker = map(os.path.abspath, sys.argv[1:3])
count = int(sys.argv[3]) if len(sys.argv) > 3 else 100
loaded = importlib.util.spec_from_file_location("check", checker)
check = importlib.util.module_from_spec(loaded)
loaded.loader.exec_module(check)
failures = 0


def run(*words):
    return subprocess.run(words, capture_output=True, text=True, timeout=600)


def holds(what, true, detail=""):
    global failures
    if not true:
        failures += 1
        print(f"FAILED: {what}\n{detail}")


def accepts(proof, problem):
    try:
        check.check(proof, check.Problem(problem))
        return True
    except (check.Refused, KeyError, IndexError, ValueError, ArithmeticError):
        return False


def other_digit(number, draw, first=20):
    """The number with one of its 17 digits changed, or of its first ones."""
    text = repr(float(number)) if not isinstance(number, str) else number
    end = text.find("e") if "e" in text else len(text)
    digits = [k for k in range(end) if text[k].isdigit()]
    places = digits[:next((n for n, k in enumerate(digits) if text[k] != "0"), 0) + first]
    while True:
        k = draw.choice(places)
        changed = text[:k] + draw.choice("0123456789") + text[k + 1:]
        if float(changed) != float(text) or isinstance(number, str) and changed != text:
            return changed if isinstance(number, str) else float(changed)


def tampered(proof, problem, others, draw):
    """What was done, and the two after it; a forger who renews the names, too."""
    proof, problem = copy.deepcopy(proof), copy.deepcopy(problem)
    numbers = [(problem, key, None) for key in ("z_u", "c") if problem[key]] + [(problem, key, 2) for key in ("M", "J") if problem[key]]
    answer = [(proof, key, None) for key in ("z", "lambda") if proof[key] and "distance" in proof]
    stated = [(proof, key, 0) for key in ("distance", "imbalance", "contradiction") if proof.get(key, "0") != "0"]
    kind = draw.choice(["problem"] + ["answer"] * 2 * bool(answer) + ["stated"] * 2 * bool(stated) + ["verdict", "swapped"] +
                       ["rows"] * (not problem["mu"]) + ["slide"] * 2 * ("slides" in proof))
    if kind == "problem":
        of, key, place = draw.choice(numbers)
        k = draw.choice([k for k, x in enumerate(of[key]) if x is not None])
        if place is None:
            of[key][k] = other_digit(of[key][k], draw)
        else:
            of[key][k][place] = other_digit(of[key][k][place], draw)
            if key == "M" and draw.random() < 0.5:
                for entry in of[key]:
                    if entry[:2] == of[key][k][1::-1]:
                        entry[2] = of[key][k][2]
    elif kind == "answer":
        of, key, _ = draw.choice(answer)
        pushing = sorted({i for i, _, x in problem["J"] if x})  # what stands for a row of zeros changes nothing that is stated
        k = draw.choice(pushing) if key == "lambda" else draw.randrange(len(of[key]))
        of[key][k] = other_digit(of[key][k], draw)
        if draw.random() < 0.5:
            kind += ", renamed"
            proof["answer_sha256"] = check.answer_sha256(proof)
    elif kind == "stated":
        of, key, _ = draw.choice(stated)
        of[key] = other_digit(of[key], draw)
    elif kind == "rows":
        rows = proof["basis"]
        exact = check.Problem(problem)
        needed, loose = rows, [i for i in range(exact.m) if i not in rows and i != proof.get("more")]
        if "more" not in proof:  # another basis of the same point, or one without a row that does not push, is no forgery
            found, = check.solve(exact.balance(rows) + [exact.J[i] for i in rows],
                                 [check.times(row, exact.z_u) for row in exact.M] + [exact.c[i] for i in rows])
            z = found[:exact.n]
            needed = [i for i, x in zip(rows, found[exact.n:]) if x]
            loose = [i for i in loose if exact.c[i] is not None and check.times(exact.J[i], z) != exact.c[i]]
        if rows and loose and draw.random() < 0.5:
            rows[draw.randrange(len(rows))] = draw.choice(loose)
            kind += ", one exchanged"
        elif needed:
            rows.remove(draw.choice(needed))
            kind += ", one left out"
        elif loose:
            rows.append(draw.choice(loose))
            kind += ", one added"
        else:
            return tampered(proof, problem, others, draw)
    elif kind == "slide":  # what it is near to; the last digits are means, too, and may leave a proof true
        slide = draw.choice(proof["slides"])
        k = draw.choice((1, 2, 4, 5) if len(slide) == 6 else (4,))
        slide[k] = other_digit(slide[k], draw, 8)
    elif kind == "verdict":
        proof["verdict"] = draw.choice([v for v in ("solved", "near", "wrong", "infeasible, proven") if v != proof["verdict"]])
    else:
        other = draw.choice([p for p in others if p["sha256"] != proof["sha256"] and ("more" in p, p.get("distance")) !=
                             ("more" in proof, proof.get("distance"))])
        for key in ("basis", "more", "frozen", "slides", "verdict", "distance", "imbalance", "pulling", "contradiction"):
            proof.pop(key, None)
            if key in other:
                proof[key] = other[key]
    return kind, proof, problem


def write_answers(name, header, answers):
    with open(name, "w") as file:
        for line in (header, *answers):
            print(json.dumps(line), file=file)


def make(scenes, solvers, draw):
    """A pack, answers to it, right and spoilt, and their proofs: [(path, proof, problem)]."""
    made = run(program, "pack", *scenes, "--out", "pack")
    holds("a pack", made.returncode == 0, made.stderr)
    files = []
    for solver in solvers:
        run(program, "solve-pack", "pack", "--solver", solver, "--out", solver + ".jsonl")
        header, *answers = (json.loads(line) for line in open(solver + ".jsonl"))
        spoilt = []
        for answer in answers:
            size = draw.choice([1e-4, 1e-8, 1e-12])
            spoilt.append({**answer, **({"z": [x + size * draw.uniform(-1, 1) for x in answer["z"]]} if "z" in answer else {})})
            if draw.random() < 0.1:
                spoilt[-1] = {"sha256": answer["sha256"], "status": "infeasible"}
            elif answer["status"] == "infeasible":
                spoilt[-1] = {"sha256": answer["sha256"], "status": "solved", "z": [1.0] * problem_size(answer)}
        write_answers(f"spoilt_{solver}.jsonl", {**header, "solver": "spoilt_" + solver}, spoilt)
        files += [solver + ".jsonl", f"spoilt_{solver}.jsonl"]
    judged = run(program, "judge", "pack", *files, "--out", "judged", "--proofs", "proofs")
    holds("judged", judged.returncode in (0, 1), judged.stdout + judged.stderr)
    print(*(line for line in judged.stdout.splitlines() if "proof" in line), sep="\n")
    rows = {(r["solver"], r["problem_sha256"]): r for r in map(json.loads, open("judged/results.jsonl"))}
    proofs = []
    for place, _, names in sorted(os.walk("proofs")):
        for name in sorted(names) if place != "proofs/problems" else ():
            proof = json.load(open(os.path.join(place, name)))
            proofs.append((os.path.join(place, name), proof, json.load(open(os.path.join(place, proof["problem"])))))
            row = rows[proof["solver"], proof["sha256"]]
            holds("the referee says the same", row["verified"] in (proof["verdict"], "undecided", "infeasible, claimed only"), f"{row}{proof}")
    return proofs


def problem_size(answer):
    return next(p["n"] for p in json.load(open("pack/pack.json"))["problems"] if p["sha256"] == answer["sha256"])


def check_files(draw):
    for law in ("pyramid", "convex"):
        run(program, "export", "incline(mu=0.5)", "--law", law, "--out", law + ".h5")
    for name, J, c in ("free", numpy.zeros((0, 3)), []), ("zero_row", [[0, 0, 0], [0, 0, 1]], [1, -numpy.inf]):
        with h5py.File(name + ".h5", "w") as file:
            for key, value in {"M": numpy.diag([2.0, 2, 3]), "z_u": [0, 0.5, -9.81], "J": J, "c": c, "kind": numpy.ones(len(c), "u1")}.items():
                file["zwang/" + key] = numpy.array(value, None if key == "kind" else float)
    scenes = ["hand(contacts=4),chain(links=4),GAP(k=4),GAP(k=4,feasible=1),four_bar(lean=0),LOOP(k=14),random(n=20,seed=1..2),stack(boxes=2,mu=0.5),"
              "planted(k=1,seed=40)", "pyramid.h5", "convex.h5", "free.h5", "zero_row.h5"]
    proofs = make(scenes, ["dual_active_set", "nnls", "cone"], draw)
    holds("a proof of most answers", len(proofs) >= 50, str(len(proofs)))
    holds("under each law", {q["law"] for _, _, q in proofs} == {"frictionless", "pyramid", "convex", "coulomb"})
    holds("of right ones, wrong ones and infeasibility", {p["verdict"] for _, p, _ in proofs} >= {"solved", "wrong", "infeasible, proven"})
    shutil.copytree("proofs", "elsewhere/proofs")
    shutil.copytree("pack", "elsewhere/pack")
    shutil.copy(checker, "elsewhere/check.py")
    os.chdir("elsewhere")
    python = (sys.executable, "check.py")
    true = run(*python, "proofs", "--pack", "pack")
    holds("true proofs are accepted elsewhere", true.returncode == 0 and true.stdout.count("\n") == len(proofs) and
          true.stdout.count("the pack's ") == len(proofs), true.stdout + true.stderr)
    with_answers = run(*python, "proofs/nnls", "--answers", "../nnls.jsonl")
    holds("answers are looked up", with_answers.returncode == 0, with_answers.stdout + with_answers.stderr)
    others = run(*python, "proofs/nnls", "--answers", "../spoilt_nnls.jsonl")
    holds("other answers are told apart", others.returncode == 1 and others.stdout.count("NOT PROVEN") > 5, others.stdout)
    for words, code, said in ((("nosuch",), 3, "nosuch"), ((), 2, "usage"), (("check.py",), 3, "check.py"), (("pack/pack.json",), 3, "pack.json"),
                              (("proofs", "--pack", "proofs"), 3, "pack.json")):
        bad = run(*python, *words)
        holds(f"{words}", bad.returncode == code and said in bad.stderr and (code == 2 or bad.stderr.count("\n") == 1), bad.stdout + bad.stderr)
    path, proof, _ = proofs[0]
    with open(path, "w") as file:
        json.dump({**proof, "distance": "1" + proof["distance"][1:] if proof["distance"][0] != "1" else "2" + proof["distance"][1:]}, file)
    forged = run(*python, "proofs")
    holds("a forged file is named", forged.returncode == 1 and forged.stdout.count("NOT PROVEN") == 1 and f"{path}: NOT PROVEN" in forged.stdout,
          forged.stdout + forged.stderr)
    os.chdir("..")


def check_many(draw):
    """True proofs of small problems, and what a forger makes of each."""
    seeds = max(1, count // 43)
    proofs = make([f"random(n=4,seed=1..{4 * seeds}),random(n=7,seed=1..{seeds}),NPE(k=4,seed=1..{seeds}),"
                   f"planted(k=1,seed=1..{12 * seeds})"], ["dual_active_set", "cone"], draw)
    sliding = sum("slides" in proof for _, proof, _ in proofs)
    holds("a third of them with contacts that slide", 3 * sliding >= len(proofs), f"{sliding} of {len(proofs)}")
    refused, forged = 0, {}
    for path, proof, problem in proofs:
        if not accepts(proof, problem):
            refused += 1
            print(f"refused: {path}")
    for k in range(len(proofs)):
        path, proof, problem = proofs[k]
        kind, false, changed = tampered(proof, problem, [p for _, p, _ in draw.sample(proofs, 40)], draw)
        forged.setdefault(kind, [0, 0])
        forged[kind][0] += 1
        if accepts(false, changed):
            forged[kind][1] += 1
            print(f"accepted: {path}, {kind}")
    holds("true proofs are accepted", refused == 0, str(refused))
    holds("tampered ones are not", not any(accepted for _, accepted in forged.values()), str(forged))
    print(f"{len(proofs)} true proofs, {sliding} of them with contacts that slide, {refused} refused; tampered with (accepted): " +
          "; ".join(f"{kind} {all_} ({accepted})" for kind, (all_, accepted) in sorted(forged.items())))


for part in (check_files, check_many)[len(sys.argv) > 3:]:
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        os.environ["XDG_CACHE_HOME"] = folder
        part(random.Random(7))
        os.chdir("/")
sys.exit(1 if failures else 0)
