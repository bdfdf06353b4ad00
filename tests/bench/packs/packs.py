"""Packs, answers, judge and guard as people meet them.

Usage: packs.py PROGRAM
"""
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import warnings
import zipfile
import xml.etree.ElementTree as xml

program = os.path.abspath(sys.argv[1])
scenes = "hand(contacts=0,4,16,seed=1..12),chain(links=4,8),GAP(k=4,14),random(n=20,seed=1..6),incline(mu=0.5),ROD(k=3)"
failures = 0


def run(*words):
    return subprocess.run([program, *words], capture_output=True, text=True, timeout=120)


def check(what, holds, detail=""):
    global failures
    if not holds:
        failures += 1
        print(f"FAILED: {what}\n{detail}")


def read(name):
    header, *answers = (json.loads(line) for line in open(name))
    return header, answers


def write(name, header, answers):
    with open(name, "w") as file:
        for line in (header, *answers):
            print(json.dumps(line), file=file)
    return name


def spoilt(answers, size, seed=1):
    """Every motion moved by this part of its largest entry."""
    draw, moved = random.Random(seed), []
    for answer in answers:
        z = answer.get("z", [])
        reach = size * max(map(abs, z), default=0)
        moved.append({**answer, **({"z": [x + reach * draw.uniform(-1, 1) for x in z]} if z else {})})
    return moved


def check_packs():
    made = run("pack", scenes, "--out", "pack")
    check("a pack is written", made.returncode == 0 and "48 problems -> pack" in made.stdout, made.stdout + made.stderr)
    run("pack", scenes, "--out", "again")
    files = sorted(os.path.join(place, name) for place, _, names in os.walk("pack") for name in names)
    same = all(open(name, "rb").read() == open(name.replace("pack", "again", 1), "rb").read() for name in files)
    check("the same bytes for the same seed", same and len(files) == 49)
    problems = json.load(open("pack/pack.json"))["problems"]
    known = [p["known"] for p in problems]
    check("what is known", known.count("infeasible") == 2 and known.count("nothing") == 0, str(known))
    check("a whole pack passes", run("pack", "pack", "--check").returncode == 0)
    os.replace("again/problems/0000.h5", "again/problems/0001.h5")
    os.link("again/problems/0001.h5", "again/problems/0000.h5")
    swapped = run("pack", "again", "--check")
    check("a swapped file", swapped.returncode == 3 and "problems/0001.h5" in swapped.stderr, swapped.stderr)
    for words, code, said in ((["pack", "pack"], 2, "--out DIR"), (["pack", "nosuch", "--out", "x"], 2, "nosuch"),
                              (["pack", scenes, "--out", "pack"], 2, "holds a pack already"),
                              (["pack", "nosuch", "--check"], 3, "nosuch/pack.json")):
        wrong = run(*words)
        check(f"{words}", wrong.returncode == code and said in wrong.stderr and wrong.stderr.count("\n") == 1, wrong.stderr)
    return problems


def check_judge(problems):
    for solver in ("dual_active_set", "cone"):
        solved = run("solve-pack", "pack", "--solver", solver, "--out", solver + ".jsonl")
        check(solver, solved.returncode == 0 and "48 of 48 answers" in solved.stdout, solved.stdout + solved.stderr)
    judged = run("judge", "pack", "dual_active_set.jsonl", "cone.jsonl", "--out", "judged", "--junit", "judged.xml")
    check("judged", judged.returncode == 0 and "0 claimed falsely" in judged.stdout, judged.stdout + judged.stderr)
    again = run("judge", "pack", "cone.jsonl", "--out", "judged")
    check("a folder that holds a judgement", again.returncode == 2 and again.stderr.endswith("holds a run already: choose another --out\n"),
          again.stderr)
    shutil.copy("cone.jsonl", "c,o:ne.jsonl")
    both = run("judge", "pack", "cone.jsonl", "c,o:ne.jsonl", "--out", "both")
    check("two files of one solver", both.returncode == 0 and "cone@c_o_ne" in {r["solver"] for r in map(json.loads, open("both/results.jsonl"))},
          both.stdout + both.stderr)
    named = run("judge", "pack", "cone.jsonl", "--names", "x:y", "--out", "named")
    check("no name", named.returncode == 2 and "'x:y': a solver's name holds letters" in named.stderr, named.stderr)
    line = next(line for line in judged.stdout.splitlines() if "claimed falsely" in line)
    answers, *counts, _ = map(int, re.findall(r"\d+", line))
    check("each answer is counted once", answers == sum(counts) and " unsupported" in line, line)
    rows = {(r["solver"], r["problem"]): r for r in map(json.loads, open("judged/results.jsonl"))}
    check("a row an answer", len(rows) == 96)
    run("bench", "--problems", "pack/problems", "--solvers", "dual_active_set,cone", "--tolerances", "1e-10", "--accuracy", "--out",
        "benched")
    for r in map(json.loads, open("benched/results.jsonl")):
        there = rows[r["solver"], r["problem"]]
        check("the bench says the same", all(there[key] == r[key] for key in ("claimed", "verified", "z_error", "primal", "handed_to")),
              f"{there}\n{r}")
    cases = xml.parse("judged.xml").getroot()
    check("JUnit", len(cases) == 96 and cases.get("failures") == "0", open("judged.xml").read()[:300])
    header, answers = read("dual_active_set.jsonl")
    check("times stay", all(rows["dual_active_set", p["name"]]["solve_s"] == a["seconds"] for p, a in zip(problems, answers)
                            if a["status"] != "unsupported"))
    given = [a for a in answers if a["status"] == "solved"]
    for size, verdicts in ((1e-4, ("wrong",)), (3e-8, ("near", "wrong"))):
        write("moved.jsonl", header, spoilt(given, size))
        moved = run("judge", "pack", "moved.jsonl", "--out", f"moved{size}")
        of = [json.loads(line)["verified"] for line in open(f"moved{size}/results.jsonl")]
        check(f"answers moved by {size}", sum(map(of.count, verdicts)) == len(given) and
              moved.returncode == (1 if "wrong" in of else 0), f"{moved.stdout}{of}")
    upside = [{**a, "lambda": [-x for x in a["lambda"]]} if "lambda" in a else a for a in given]
    random.Random(3).shuffle(upside)
    write("upside.jsonl", header, upside[:-1])
    turned = run("judge", "pack", "upside.jsonl", "--out", "upside")
    check("the truth of z does not hang on lambda", f"{len(given) - 1} right" in turned.stdout and "no answer to" in turned.stdout,
          turned.stdout)


def check_bad_answers():
    header, answers = read("dual_active_set.jsonl")
    first = answers[0]
    text = json.dumps(first)
    bad = {
        "no head": [text], "another version": [json.dumps({**header, "zwang_answers": 7})],
        "a name with a comma": [json.dumps({**header, "solver": "a,b"})],
        "tolerance": [json.dumps({**header, "tolerance": 0})],
        "twice": [json.dumps(header), text, text],
        "a key twice": [json.dumps(header), text[:-1] + ", " + json.dumps({"z": first["z"]})[1:]],
        "another pack": [json.dumps(header), json.dumps({**first, "sha256": "0" * 64})],
        "too short": [json.dumps(header), json.dumps({**first, "z": first["z"][1:]})],
        "NaN": [json.dumps(header), json.dumps({**first, "z": [float("nan")] + first["z"][1:]})],
        "Infinity": [json.dumps(header), json.dumps({**first, "lambda": [float("inf")] * len(first["lambda"])})],
        "text in z": [json.dumps(header), json.dumps({**first, "z": ["1"] + first["z"][1:]})],
        "no z": [json.dumps(header), json.dumps({k: v for k, v in first.items() if k != "z"})],
        "status": [json.dumps(header), json.dumps({**first, "status": "sloved"})],
        "a list": [json.dumps(header), "[]"], "torn": [json.dumps(header), text[:300]],
        "answered by": [json.dumps(header), json.dumps({**first, "answered_by": "a, b"})],
        "seconds": [json.dumps(header), json.dumps({**first, "seconds": -1})], "empty": [],
        "line 1: empty; expected one JSON object": [""], "solver is 3; expected a text": [json.dumps({**header, "solver": 3})],
        "status is 3; expected a text": [json.dumps(header), json.dumps({**first, "status": 3})],
        "answered_by is 3; expected a text": [json.dumps(header), json.dumps({**first, "answered_by": 3})],
    }
    for what, lines in bad.items():
        with open("bad.jsonl", "w") as file:
            file.write("".join(line + "\n" for line in lines))
        wrong = run("judge", "pack", "bad.jsonl", "--out", "never")
        check(f"bad answers: {what}", wrong.returncode == 3 and wrong.stderr.startswith("bad.jsonl") and
              ("expected" not in what or what in wrong.stderr) and
              wrong.stderr.count("\n") == 1 and wrong.stderr.count("line ") <= 1 and not os.path.exists("never"), wrong.stdout + wrong.stderr)
    whole, draw = open("dual_active_set.jsonl", "rb").read(), random.Random(5)
    for k in range(40):  # damaged anywhere: refused with one line, or a valid other number
        bytes_ = bytearray(whole)
        for _ in range(draw.randint(1, 3)):
            bytes_[draw.randrange(len(bytes_))] = draw.randrange(256)
        with open("bad.jsonl", "wb") as file:
            file.write(bytes_[:draw.choice((len(bytes_), draw.randrange(len(bytes_))))])
        done = run("judge", "pack", "bad.jsonl", "--out", f"damaged{k}")
        fine = done.returncode == 3 and done.stderr.count("\n") == 1 or done.returncode in (0, 1)
        check("damaged answers", fine, f"{done.returncode} {done.stderr}")


def hand_over(header, answers):
    """The answers in the formats of NumPy and HDF5, told apart by their contents, not their names."""
    import h5py
    import numpy
    arrays = {**header}
    for answer in answers:
        arrays |= {answer["sha256"] + "/" + key: value for key, value in answer.items() if key != "sha256"}
    numpy.savez("plain", **arrays)
    numpy.savez_compressed("packed", **arrays)
    with h5py.File("answers.h5", "w") as file:
        for key, value in header.items():
            file.attrs[key] = value
        for answer in answers:
            group = file.create_group(answer["sha256"])
            for k, (key, value) in enumerate(answer.items()):
                if key == "z" or k % 2:  # datasets and attributes are both read
                    group[key] = value
                elif key != "sha256":
                    group.attrs[key] = value
    return "plain.npz", "packed.npz", "answers.h5"


def check_formats():
    """One reader behind three formats: the same judgement, and one line for what is wrong."""
    import h5py
    import numpy
    header, answers = read("dual_active_set.jsonl")
    files = hand_over({**header, "solver": "mine", "machine": "Größe µ, 漢"}, answers)
    os.rename("packed.npz", "packed.answers")
    judged = run("judge", "pack", "dual_active_set.jsonl", "plain.npz", "packed.answers", "answers.h5", "--out", "formats")
    check("three formats", judged.returncode == 0, judged.stdout + judged.stderr)
    kept = {}
    for r in map(json.loads, open("formats/results.jsonl")):
        kept.setdefault(r["problem"], []).append([r[k] for k in ("claimed", "verified", "z_error", "primal", "iterations", "solve_s")])
    check("the same judgement in each", len(kept) == 48 and all(len(rows) == 4 and all(row == rows[0] for row in rows)
                                                                for rows in kept.values()), str(kept)[:500])
    machines = [r["machine"] for r in map(json.loads, open("formats/results.jsonl"))]
    check("text in each", machines.count("Größe µ, 漢") == 3 * 48, str(set(machines)))
    guarded = run("guard", "pack", *files[::2], "--out", "guard_formats")
    check("guard takes them", guarded.returncode == 0 and "48 same" in guarded.stdout, guarded.stdout + guarded.stderr)
    first = next(a for a in answers if a["status"] == "solved")
    sha256, z = first["sha256"], numpy.array(first["z"])
    good = {"solver": "mine", sha256 + "/status": "solved", sha256 + "/z": z}
    spoilt = numpy.where(numpy.arange(z.size) == 0, numpy.nan, z)
    bad = {
        "solver": {k: v for k, v in good.items() if k != "solver"}, "z has": {**good, sha256 + "/z": z[1:]},
        "z[0]: expected a finite number": {**good, sha256 + "/z": spoilt}, "iterations": {**good, sha256 + "/iterations": -1},
        "no problem": {**good, "0" * 64 + "/status": "solved"}, "sloved": {**good, sha256 + "/status": "sloved"},
        "z: expected": {k: v for k, v in good.items() if not k.endswith("/z")}, "'status' not found": {"solver": "mine", sha256 + "/z": z},
        "dimension": {**good, sha256 + "/z": numpy.array([z, z])}, "tolerance": {**good, "tolerance": 2.0},
        "zwang_answers is 7": {**good, "zwang_answers": 7},
    }
    numpy.savez("ordinary.npz", **good, **{sha256 + "/lambda": numpy.array(first["lambda"], dtype=">f8")})
    check("big-endian", run("judge", "pack", "ordinary.npz", "--out", "ordinary").returncode == 0)
    numpy.savez("object.npz", **{**good, "version": numpy.array([None])})
    with zipfile.ZipFile("ordinary.npz") as whole, zipfile.ZipFile("twice.npz", "w") as twice:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for name in [*whole.namelist(), sha256 + "/z.npy"]:
                twice.writestr(name, whole.read(name))
    cases = [("object.npz", "expected numbers or one text"), ("twice.npz", "twice in the archive")]
    for k, (says, arrays) in enumerate(bad.items()):
        numpy.savez(f"bad{k}.npz", **arrays)
        with h5py.File(f"bad{k}.h5", "w") as file:
            for key, value in arrays.items():
                file[key] = value
        cases += [(f"bad{k}.npz", says), (f"bad{k}.h5", says)]
    with h5py.File("doubled.h5", "w") as file:
        file["solver"] = "mine"
        file.attrs["solver"] = "mine"
    for name, says in [*cases, ("doubled.h5", "solver: twice in the file")]:
        wrong = run("judge", "pack", name, "--out", "never")
        check(f"bad answers in {name}: {says}", wrong.returncode == 3 and wrong.stderr.startswith(name) and says in wrong.stderr and
              wrong.stderr.count("\n") == 1 and wrong.stderr.count("line ") <= 1 and not os.path.exists("never"), wrong.stdout + wrong.stderr)


def check_guard():
    header, answers = read("dual_active_set.jsonl")
    right = [a for a in answers if a["status"] in ("solved", "infeasible")]
    write("before.jsonl", header, right)

    def guard(changed, *more):
        write("after.jsonl", header, changed)
        guard.count = getattr(guard, "count", 0) + 1
        return run("guard", "pack", "before.jsonl", "after.jsonl", "--out", f"guard{guard.count}", *more)

    same = guard(right, "--junit", "guard.xml")
    check("nothing changed", same.returncode == 0 and "48 same" in same.stdout, same.stdout + same.stderr)
    check("map, badge, JUnit", xml.parse("guard1/map.svg") and "no worse" in open("guard1/badge.svg").read() and
          xml.parse("guard.xml").getroot().get("failures") == "0")
    rounding = guard(spoilt(right, 1e-16))
    check("rounding is no alarm", rounding.returncode == 0, rounding.stdout)
    wrong = guard(spoilt(right, 1e-3))
    check("newly wrong", wrong.returncode == 1 and "newly wrong: hand" in wrong.stdout, wrong.stdout)
    lost = guard(right[1:])
    check("newly unsolved", lost.returncode == 1 and ", 1 newly unsolved" in lost.stdout, lost.stdout)
    worse = guard(spoilt(right, 3e-13))
    check("less accurate within the tolerance", worse.returncode == 1 and "more than chance" in worse.stdout, worse.stdout)
    forces = guard([{**a, "lambda": [-x for x in a["lambda"]]} if any(a.get("lambda", [])) else a for a in right])
    check("wrong forces", forces.returncode == 1 and "wrong forces: hand" in forces.stdout, forces.stdout)
    work = guard([{**a, "iterations": 2 * a["iterations"]} for a in right])
    check("more work", work.returncode == 1 and re.search("iterations: more on .* more than chance", work.stdout), work.stdout)
    bought = [{**a, "iterations": 2 * a["iterations"]} for a in right]
    write("bought.jsonl", header, bought)
    write("rough.jsonl", header, spoilt(right, 1e-12))
    dearer = run("guard", "pack", "rough.jsonl", "bought.jsonl", "--out", "bought")
    check("work that buys accuracy", dearer.returncode == 0 and "smaller on 0" not in dearer.stdout, dearer.stdout)
    shy = guard([{**a, "status": "iteration limit"} for a in right if a["status"] == "solved"] +
                [a for a in right if a["status"] != "solved"])
    check("claims", shy.returncode == 1 and re.search("claims of an answer: lost on .* more than chance", shy.stdout), shy.stdout)
    handed = guard([{**a, "answered_by": "nnls"} for a in right])
    check("another solver", handed.returncode == 1 and "answers of another solver: more on" in handed.stdout, handed.stdout)
    for k in range(3):
        write(f"fast{k}.jsonl", header, [{**a, "seconds": 1e-5 * (1 + 0.05 * k)} for a in right])
        write(f"slow{k}.jsonl", header, [{**a, "seconds": 1.5e-5 * (1 + 0.05 * k)} for a in right])
    fast, slow = (",".join(f"{word}{k}.jsonl" for k in range(3)) for word in ("fast", "slow"))
    check("slower", run("guard", "pack", fast, slow, "--out", "slower").returncode == 1)
    timed = run("guard", "pack", slow, fast, "--out", "faster")
    check("times are compared", timed.returncode == 0 and "time x 0.67" in timed.stdout, timed.stdout)
    other = {**header, "tolerance": 1e-6}
    write("other.jsonl", other, right)
    mixed = run("guard", "pack", "before.jsonl", "other.jsonl", "--out", "mixed")
    check("two tolerances", mixed.returncode == 2 and "another tolerance" in mixed.stderr, mixed.stderr)


def check_league():
    """A page of records: the same bytes for the same records, and one line for what is wrong with one."""
    header, answers = read("dual_active_set.jsonl")
    right = [a for a in answers if a["status"] in ("solved", "infeasible")]
    handed = next(a["sha256"] for a in right)
    entries = {"new": (right, "0.10", {"reply": "</script><b>Ours</b>"}), "old": (spoilt(right, 1e-3), "0.9", {}), "cone": (None, "1", {})}
    for name, (given, version, more) in entries.items():
        solver = "cone" if given is None else header["solver"]
        if given is None:
            os.makedirs("records/cone")
            given = [{**a, **({"answered_by": "nnls"} if a["sha256"] == handed else {})} for a in read("cone.jsonl")[1]]
        else:
            os.makedirs("records/" + name)
        write("entered.jsonl", {**header, "solver": solver, "machine": "one"}, [{**a, "seconds": 2e-3} for a in given])
        run("judge", "pack", "entered.jsonl", "--out", f"records/{name}/small")
        with open(f"records/{name}/entry.json", "w") as file:
            json.dump({"solver": solver, "version": version, "url": "https://example.org", **more}, file)
    made = run("league", "records/new", "records/old", "records/cone", "--out", "league")
    check("a league", made.returncode == 0 and "League: league/index.html" in made.stdout, made.stdout + made.stderr)
    page = open("league/index.html", encoding="utf-8").read()
    data = json.loads(re.search(r'id="data">(.*?)</script>', page)[1])
    said = [(e["solver"], e["version"], sum(bool(row and row[0]) for row in e["packs"]["small"]["rows"]),
             sum(bool(row and row[1]) for row in e["packs"]["small"]["rows"])) for e in data["entries"]]
    wrong = sum(1 for r in map(json.loads, open("records/old/small/results.jsonl")) if r["verified"] == "wrong" and r["claimed"] == "solved")
    by_cone = sum(a["status"] in ("solved", "infeasible") and a["sha256"] != handed and "answered_by" not in a for a in read("cone.jsonl")[1])
    check("what it says", said[0] == ("cone", "1", by_cone, 0) and said[1][:2] == (header["solver"], "0.9") and said[1][3] == wrong > 30 and
          said[2] == (header["solver"], "0.10", len(right), 0) and data["entries"][0]["packs"]["small"]["rows"].count(None) >= 1,
          f"{said} {wrong} {by_cone} {len(right)}")
    check("problems and replies", len(data["packs"]["small"]) == 48 and data["entries"][2]["reply"] == "</script><b>Ours</b>")
    os.makedirs("elsewhere")
    shutil.copytree("records", "elsewhere/moved")
    run("league", "elsewhere/moved/cone", "elsewhere/moved/old", "elsewhere/moved/new", "--out", "league2")
    check("the same bytes wherever records lie", open("league2/index.html", encoding="utf-8").read() == page)
    run("pack", "chain(links=4)", "--out", "pack4")
    run("solve-pack", "pack4", "--solver", "cone", "--out", "cone4.jsonl")

    def spoil(says, change):
        shutil.rmtree("spoilt", ignore_errors=True)
        shutil.copytree("records/cone", "spoilt")
        change()
        wrong = run("league", "records/new", "spoilt", "--out", "never")
        check(f"a bad record: {says}", wrong.returncode == 3 and says in wrong.stderr and wrong.stderr.count("\n") == 1 and
              not os.path.exists("never"), wrong.stdout + wrong.stderr)

    def entry(text):
        with open("spoilt/entry.json", "w") as file:
            file.write(text)
    good = {"solver": "cone", "version": "1", "url": ""}
    spoil("entry.json: no such file", lambda: os.remove("spoilt/entry.json"))
    spoil("solver: expected", lambda: entry("{"))
    spoil("version: expected", lambda: entry(json.dumps({**good, "version": 1})))
    spoil("url: expected https", lambda: entry(json.dumps({**good, "url": "javascript:alert(1)"})))
    spoil("no answer of pgs", lambda: entry(json.dumps({**good, "solver": "pgs"})))
    spoil("no judgement", lambda: shutil.rmtree("spoilt/small"))
    spoil("results.jsonl", lambda: open("spoilt/small/results.jsonl", "w").write("{\n{}\n"))
    spoil("another pack than the small", lambda: (shutil.rmtree("spoilt/small"), run("judge", "pack4", "cone4.jsonl", "--out", "spoilt/small")))
    twice = run("league", "records/new", "records/new", "--out", "never")
    check("twice", twice.returncode == 3 and "a second record of" in twice.stderr, twice.stderr)
    row = next(r for r in map(json.loads, open("records/cone/small/results.jsonl")) if r["solver"] == "cone")
    del row["check"]  # of one line as it stands
    os.makedirs("records/cone/many")
    with open("records/cone/many/results.jsonl", "w") as file:
        for k in range(20001):
            print(json.dumps({**row, "problem": str(k), "problem_sha256": f"{k:064x}"}), file=file)
    run("league", "records/cone", "--out", "many")
    names = json.loads(re.search(r'id="data">(.*?)</script>', open("many/index.html", encoding="utf-8").read())[1])["packs"]["many"]
    check("more problems than a report shows one by one", names == list(map(str, range(20001))), str(names)[:200])


def check_own_league():
    """The records of solvers that are built, and the one that is there to be copied."""
    league = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../docs/league")

    def own():
        return subprocess.run([sys.executable, os.path.join(league, "own.py"), "small=chain(links=4)", "--program", program,
                               "--solvers", "nnls,cone", "--out", "own"], capture_output=True, text=True, timeout=120)
    first = own()
    page = open("own/index.html", "rb").read()
    check("records of two solvers", first.returncode == 0 and first.stdout.count("1 answers: 1 right") == 2 and
          all(os.path.exists(f"own/records/{s}/small/{name}.jsonl") for s in ("nnls", "cone") for name in ("answers", "results")),
          first.stdout + first.stderr)
    again = own()
    check("what is there is kept, and the page has the same bytes", again.stdout.count("\n") == 1 and
          open("own/index.html", "rb").read() == page, again.stdout + again.stderr)
    shutil.rmtree("own/records/nnls")
    check("what was removed is made again", own().stdout.count("1 answers: 1 right") == 1)
    example = os.path.join(league, "example")
    made = run("league", "own/records/cone", example, "--out", "beside")  # refused where the pack's problem is another by now
    check("the example stands beside them", made.returncode == 0, made.stderr)
    judged = run("judge", "own/packs/small", example + "/small/answers.jsonl", "--out", "example")
    said = [[json.loads(line)[key] for key in ("problem_sha256", "claimed", "verified")]
            for name in ("example/results.jsonl", example + "/small/results.jsonl") for line in open(name)]
    check("and is judged as it says", judged.returncode == 0 and len(said) == 2 and said[0] == said[1], f"{said}{judged.stderr}")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    check_judge(check_packs())
    check_bad_answers()
    check_formats()
    check_guard()
    check_league()
    check_own_league()
    os.chdir("/")
sys.exit(1 if failures else 0)
