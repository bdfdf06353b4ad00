"""The command line as people meet it: exit codes, one line for each mistake, keys of --json.

Usage: command_line.py PROGRAM
"""
import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile

import h5py
import numpy as np

program = os.path.abspath(sys.argv[1])
source = os.path.abspath(os.path.join(os.path.dirname(__file__), "../../.."))
failures = 0


def run(words, **more):
    return subprocess.run([program] + words, capture_output=True, text=True, timeout=120, **more)


def check(what, holds, detail=""):
    global failures
    if not holds:
        failures += 1
        print(f"FAILED: {what}\n{detail}")


def write(name, **changes):
    """A box on the floor, or what is left of it after the changes (None: leave out)."""
    parts = {
        "M": np.diag([2.0, 2.0, 2.0]), "z_u": np.array([0.0, 0.5, -9.81]), "J": np.array([[0.0, 0.0, 1.0]]),
        "c": np.array([0.0]), "kind": np.array([1], "u1"), **changes}
    with h5py.File(name, "w") as file:
        group = file.create_group("zwang")
        for key, value in parts.items():
            if value is not None:
                group[key] = value


def write_inputs():
    write("box.h5")
    write("nan.h5", J=np.array([[0.0, math.nan, 1.0]]))
    write("sizes.h5", c=np.array([0.0, 1.0]))
    write("indefinite.h5", M=np.diag([2.0, -2.0, 2.0]))
    write("no_c.h5", c=None)
    contact = {"kind": np.array([1, 2, 2], "u1"), "c": np.zeros(3), "J": np.roll(np.eye(3), 1, 0)}
    write("block.h5", **contact, mu=np.array([0.25, 0, 0]))
    write("negative_mu.h5", **contact, mu=np.array([-1e-300, 0, 0]))
    write("no_unknowns.h5", M=np.zeros((0, 0)), z_u=np.zeros(0), J=np.zeros((2, 0)), c=np.zeros(2),
          kind=np.array([1, 2], "u1"), mu=np.array([0.5, 0]))
    with open("box.h5", "rb") as whole, open("truncated.h5", "wb") as part:
        part.write(whole.read()[:1500])
    with open("text.h5", "w") as file:
        file.write("not HDF5\n")
    with h5py.File("two.h5", "w") as file:
        for name in ("first", "second"):
            with h5py.File("box.h5") as box:
                box.copy("zwang", file.create_group(name))
    os.makedirs("empty", exist_ok=True)
    os.makedirs("taken", exist_ok=True)
    open("taken/results.jsonl", "w").close()
    os.makedirs("foreign", exist_ok=True)
    for name in ("results.jsonl", "run.json"):
        with open(f"foreign/{name}", "w") as file:
            file.write('{"solver": "nnls", "time": 1}\n')


# words, exit code, what the one line on stderr says
MISTAKES = [
    (["slove"], 2, "did you mean 'solve'?"),
    (["bench", "--suit", "quick"], 2, "did you mean '--suite'?"),
    (["bench", "--suite", "quik"], 2, "did you mean 'quick'?"),
    (["bench", "--suite"], 2, "--suite"),
    (["bench", "--scenes", ""], 2, "--scenes: expected a value, and it is empty"),
    (["bench", "--suite", "quick", "--solvers", ""], 2, "--solvers: expected a value, and it is empty"),
    (["fuzz", "--count", "10", "--first", "18446744073709551615"], 2, "--first: expected at most"),
    (["solve", "hand(contacts=4)"], 3, "expected an HDF5 file (of this scene: ./zwang export)"),
    (["bench", "--scenes", "towr"], 2, "no scene 'towr'; did you mean 'tower'?"),
    (["bench", "--scenes", "tower(boxs=3)"], 2, "did you mean 'boxes'?"),
    (["bench", "--scenes", "tower(boxes=-3)"], 2, "from 1 to"),
    (["bench", "--scenes", "tower(boxes=3"], 2, "parenthesis"),
    (["bench", "--solvers", "pgz"], 2, "no solver 'pgz'; did you mean 'pgs'?"),
    (["bench", "--solvers", "pgs:max_sweps=3"], 2, "did you mean 'max_sweeps'?"),
    (["bench", "--solvers", "pgs:max_sweeps=many"], 2, "should be an integer"),
    (["bench", "--tolerances", "1e-6,tiny"], 2, "'tiny' should be a number"),
    (["bench", "--tolerances", "2"], 2, "between 0 and 1"),
    (["bench", "--repetitions", "-1"], 2, "--repetitions"),
    (["bench", "--law", "some"], 2, "frictionless, pyramid, convex or coulomb"),
    (["bench", "--out", "taken"], 2, "--resume taken"),
    (["bench", "--resume", "empty"], 3, "holds no run"),
    (["bench", "--resume", "foreign"], 3, "another version"),
    (["report", "foreign"], 3, "results.jsonl line 1"),
    (["bench", "--out", "/dev/full/out"], 3, "/dev/full/out"),
    (["bench", "--problems", "missing.h5"], 3, "missing.h5"),
    (["bench", "--problems", "empty"], 3, "no *.h5, *.hdf5 or *.dat"),
    (["bench", "--problems", "box.h5", "nan.h5"], 3, "nan.h5"),
    (["solve"], 2, "FILE"),
    (["solve", "box.h5", "--solver", "aut"], 2, "no solver 'aut'"),
    (["solve", "box.h5", "--solutions"], 2, "no contact with friction"),
    (["solve", "box.h5", "--solutions", "--solver", "cone"], 2, "neither --solver nor --trace"),
    (["solve", "box.h5", "--solver", "pgz"], 2, "did you mean 'pgs'?"),
    (["solve", "box.h5", "--solver", "pgs", "--tolerance", "0"], 2, "between 0 and 1"),
    (["solve", "box.h5", "--solver", "pgs", "--problem", "bax"], 2, "no problem 'bax'"),
    (["solve", "two.h5", "--solver", "pgs"], 2, "holds 2 problems"),
    (["solve", "two.h5", "--solver", "pgs", "--problem", "secnd"], 2, "did you mean 'second'?"),
    (["solve", "missing.h5", "--solver", "pgs"], 3, "missing.h5"),
    (["solve", "truncated.h5", "--solver", "pgs"], 3, "truncated.h5"),
    (["solve", "text.h5", "--solver", "pgs"], 3, "text.h5"),
    (["solve", "nan.h5", "--solver", "pgs"], 3, "nan.h5"),
    (["solve", "sizes.h5", "--solver", "pgs"], 3, "sizes.h5"),
    (["solve", "indefinite.h5", "--solver", "pgs"], 3, "positive definite"),
    (["solve", "no_c.h5", "--solver", "pgs"], 3, "no_c.h5"),
    (["solve", "negative_mu.h5", "--solver", "cone"], 3, "mu(0) is -1e-300; expected a number >= 0"),
    (["solve", "box.h5", "--accuracy", "1e-4m"], 2, "accuracy: expected a number between 0 and 1"),
    (["solve", "box.h5", "--accuracy", ""], 2, "--accuracy: expected a value, and it is empty"),
    (["export", "towr", "--out", "t.h5"], 2, "did you mean 'tower'?"),
    (["export", "tower", "--boxs=3", "--out", "t.h5"], 2, "did you mean 'boxes'?"),
    (["export", "tower", "--boxes", "--out", "t.h5"], 2, "boxes"),
    (["export", "tower(boxes=3,4)", "--out", "t.h5"], 2, "names 2 problems"),
    (["export", "tower"], 2, "--out"),
    (["export", "tower", "--out", "nowhere/t.h5"], 3, "nowhere/t.h5"),
    (["report", "empty"], 3, "empty"),
    (["report", "box.h5", "--figures", "pfd"], 2, "did you mean 'pdf'?"),
    (["report"], 2, "DIR"),
    (["report", "empty", "--out", "page.html"], 2, "--out is for two runs"),
    (["report", "empty", "empty", "--out", "empty"], 2, "--out empty is a folder; expected the page's file, as in empty/comparison.html"),
    (["bench", "quick"], 2, "./zwang bench --suite quick"),
    (["solvers", "--all"], 2, "no option '--all'"),
    (["scenes", "towr"], 2, "did you mean 'tower'"),
    (["scenes", "hand(contacts=4)"], 2, "should be a scene's name alone"),
    (["solvers", "nnlls"], 2, "did you mean 'nnls'"),
]

KEYS = set("""problem family knob knob_value n m equalities seed problem_sha256 problem_file law solver foreign tolerance
claimed verified z_error z_bound bound_method bound_sigma_min primal dual stationarity complementarity gap natural scale
farkas setup_s solve_s solve_s_q1 solve_s_q3 prepare_s kernel_s allocations repetitions iterations reference reference_bound feasible worst_row
worst_by_type rank smallest_pivot largest_rejected_pivot redundant conflicting fallback handed_to range_gap message batch
z lambda""".split())


def check_mistakes():
    for words, code, says in MISTAKES:
        result = run(words)
        shown = f"zwang {' '.join(words)}\nexit {result.returncode}\n{result.stdout}{result.stderr}"
        check(f"exit code {code}", result.returncode == code, shown)
        check(f"says: {says}", says in result.stderr, shown)
        check("one line", result.stderr.count("\n") == 1, shown)


def check_help():
    for words in (["--help"], *([word, "--help"] for word in "bench solve export scenes solvers report".split())):
        result = run(words)
        check(f"{words} has examples", result.returncode == 0 and "Examples:" in result.stdout, result.stdout)
    with open(os.path.join(source, "bench/program/commands.def")) as file:
        commands = re.findall(r"^COMMAND\(([a-z-]+), zwang", file.read(), re.M)
    check("commands are found", len(commands) > 15, str(commands))
    for words in ([], *([word] for word in commands)):
        lines = run(words + ["--help"]).stdout.splitlines()
        long = [line for line in lines if len(line) > 100 or line.endswith(" ")]
        check(f"{words} --help: at most 100 characters a line", len(lines) > 8 and not long, "\n".join(long))
    numbers = 0
    for word in commands:
        text = run([word, "--help"]).stdout
        for option in re.findall(r"^  --\S+ (?:INT|UINT|FLOAT|S|T|N|HZ|SHARE)\b.*(?:\n {20,}\S.*)*", text, re.M):
            numbers += 1
            check(f"{word}: a number has its range", re.search(r"\b(from|between|above) \d", option), option)
    check("numbers are found", numbers > 30, str(numbers))
    check("version", run(["--version"]).stdout.startswith("zwang "))
    check("no words at all", run([]).returncode == 2)
    scenes, solvers = run(["scenes"]).stdout, run(["solvers"]).stdout
    check("scenes by groups", "Friction decides" in scenes and len(scenes.splitlines()) < 80, scenes)
    check("solvers by what they read", "cone                        QP, convex, coulomb" in solvers, solvers)
    whole = run(["scenes", "hand", "tower"]).stdout
    check("scenes NAME lists knobs", "boxes=10   1..1000" in whole and "96 unknowns" in whole and "2^-13" in whole, whole)
    whole = run(["solvers", "pgs"]).stdout
    check("solvers NAME lists settings", "max_sweeps=" in whole, whole)
    check("settings of a solver do not matter", run(["solvers", "pgs:max_sweeps=5"]).stdout == whole)
    said = run(["solve", "block.h5", "--solver", "pgs"]).stdout
    check("what is not supported has no numbers", "unsupported" in said and "unknown" not in said.replace("unknowns", ""), said)
    said = run(["solve", "no_unknowns.h5", "--solver", "cone"])
    check("no unknowns", said.returncode == 0 and "verified   solved" in said.stdout, said)
    said = run(["bench", "--problems", "box.h5", "--solvers", "pgs", "--tolerances", "1e-6", "--out", "counted"])
    check("counts of one", "1 solver x 1 problem x 1 tolerance," in said.stdout, said)


def check_unread():
    """Where nobody reads on, scripts end as the program does; a full disk costs one line."""
    run(["bench", "--problems", "box.h5", "--solvers", "pgs", "--tolerances", "1e-6", "--accuracy", "--out", "unread"])
    for words in (["report", "unread"], ["merge", "unread", "--out", "unread_again"], ["bench", "--missing", "unread"]):
        asked = subprocess.Popen([program] + words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        asked.stdout.close()
        check(f"{words} unread ends quietly", asked.stderr.read() == "" and asked.wait() == -signal.SIGPIPE, str(asked.returncode))
    check("the report is made", os.path.exists("unread_again/report.html"))
    for words in (["report", "unread"], ["bench", "--missing", "unread"]):
        with open("/dev/full", "w") as full:
            asked = subprocess.run([program] + words, stdout=full, stderr=subprocess.PIPE, text=True)
        check(f"{words} on a full disk", asked.returncode == 3 and asked.stderr == "output: No space left on device\n", asked.stderr)


def check_absent_solvers():
    for line in run(["solvers"]).stdout.splitlines():
        name, absent, how_to_add = line.partition(" not built in: ")
        if not absent:
            continue
        asked = run(["bench", "--solvers", name.strip()])
        says = f"solver '{name.strip()}' is not built in: {how_to_add}"
        check(says, asked.returncode == 2 and says in asked.stderr and asked.stderr.count("\n") == 1, asked.stderr)


def check_solve():
    result = run(["solve", "box.h5", "--solver", "pgs", "--json"])
    box = json.loads(result.stdout)
    check("one line of JSON", result.stdout.count("\n") == 1, result.stdout)
    check("all keys", set(box) == KEYS, str(set(box) ^ KEYS))
    check("z", np.allclose(box["z"], [0, 0.5, 0], atol=1e-9), str(box["z"]))
    check("lambda", np.allclose(box["lambda"], [19.62]), str(box["lambda"]))
    check("verified", box["verified"] == "solved", str(box))
    both = run(["solve", "box.h5", "--solver", "pgs", "--json", "--trace"])
    check("trace", len(json.loads(both.stdout)["trace"]) >= 1, both.stdout)
    people = run(["solve", "two.h5", "--problem", "second", "--solver", "pgs:relaxation=1.2", "--trace"])
    for word in ("claimed", "verified", "residuals", "time", "iteration"):
        check(f"solve prints {word}", people.returncode == 0 and word in people.stdout, people.stdout + people.stderr)
    run(["export", "GAP", "--k=45", "--out", "rounding.h5"])
    why = run(["solve", "rounding.h5", "--solver", "pgs"]).stdout
    check("solve says why where rows contradict each other by rounding", "verified   wrong   no z meets all rows as they are stored (" in why, why)
    run(["export", "GAP", "--k=8", "--out", "gap.h5"])
    for words, code in (([], 0), (["--check"], 1), (["--check", "--json"], 1)):
        false = run(["solve", "gap.h5", "--solver", "nnls_paper", *words])
        check(f"a false claim {words}", false.returncode == code, false.stdout + false.stderr)
        check(f"a false claim {words} is marked", "--json" in words or "FALSE CLAIM" in false.stdout, false.stdout)
    right = run(["solve", "box.h5", "--solver", "cone", "--check"])
    check("a claim that holds", right.returncode == 0 and "FALSE CLAIM" not in right.stdout, right.stdout)
    check("who answered", "answered   by dual_active_set" in right.stdout, right.stdout)
    for file, solver in (("box.h5", "dual_active_set"), ("block.h5", "cone")):
        for words in ([], ["--solver", "auto"]):
            chosen = run(["solve", file, *words])
            check(f"the solver for {file} {words}", chosen.returncode == 0 and re.search(rf"solver +{solver} @ 1.0e-10   chosen", chosen.stdout),
                  chosen.stdout + chosen.stderr)
    stopped = run(["solve", "box.h5", "--solver", "pgs", "--time-limit", "0"])
    check("no time", stopped.returncode == 2 and "above 0 s" in stopped.stderr, stopped.stderr)


def check_solutions():
    for scene, proven, complete, continuum in (("ROD", 3, True, False), ("JAM(beyond=1)", 0, True, False),
                                               ("PUCK", None, False, True)):
        run(["export", scene, "--out", "point.h5"])
        found = json.loads(run(["solve", "point.h5", "--solutions", "--json"]).stdout)
        said = tuple(found[key] for key in ("complete", "continuum"))
        # How many points of a continuum are found is no property of the problem.
        right = found["proven"] >= 1 if proven is None else found["proven"] == proven
        check(f"solutions of {scene}", right and said == (complete, continuum), str(found))
        if scene == "ROD":
            check("second witness", all(s["by_slopes"] for s in found["solutions"]), str(found))
    people = run(["solve", "point.h5", "--solutions"]).stdout
    check("solutions in words", "a continuum: interval Newton" in people and "slide slide" in people, people)
    convex = run(["solve", "point.h5", "--law", "convex", "--solutions"])
    check("solutions of the convex law", convex.returncode == 2 and "--law coulomb" in convex.stderr, convex.stderr)


def check_export_and_bench():
    out = run(["export", "tower", "--boxes=2", "--out", "tower.h5"])
    check("export", out.returncode == 0, out.stderr)
    room = {"preexec_fn": lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (8192, 8192)), "restore_signals": False}
    full = run(["export", "hand", "--contacts=16", "--out", "full.h5"], **room)
    check("no room for a file costs one line", full.returncode == 3 and full.stderr.count("\n") == 1 and
          full.stderr.startswith("full.h5:") and not os.path.exists("full.h5"), full.stderr)
    plan = run(["bench", "--scenes", "tower(boxes=2,3),hand", "--solvers", "pgs", "--tolerances", "1e-6", "--plan"])
    check("a plan counts problems", re.search(r"tower +2 problems, 12 to 18 unknowns\n", plan.stdout) and "3 runs" in plan.stdout, plan.stdout)
    words = ["bench", "--problems", "box.h5", "tower.h5", "--solvers", "pgs", "--tolerances", "1e-6", "--out", "run"]
    bench = run(words + ["--repetitions", "2"])
    check("bench", bench.returncode == 0, bench.stdout + bench.stderr)
    check("counts", "2 runs in" in bench.stdout and bench.stdout.endswith("Report: run/report.html\n"), bench.stdout)
    check("place of the report at once", bench.stdout.splitlines()[1] == "Report: run/report.html (as results come)", bench.stdout)
    lines = [json.loads(line) for line in open("run/results.jsonl")]
    check("a line a run", [line["repetitions"] for line in lines] == [2, 2], str(lines))
    replay = run(["solve", os.path.join("run", lines[1]["problem_file"]), "--solver", "pgs", "--tolerance", "1e-6",
                  "--json"])
    check("a replay gives the same", json.loads(replay.stdout)["z_error"] == lines[1]["z_error"], replay.stdout)
    again = run(["bench", "--resume", "run"])
    check("nothing left to resume", again.returncode == 0 and ", all of them before: " in again.stdout, again.stdout + again.stderr)
    other = run(["bench", "--resume", "run", "--seed", "2"])
    check("other options", other.returncode == 2 and "its seed is 1, not 2" in other.stderr, other.stderr)
    os.remove("run/report.html")
    os.mkdir("run/report.html")
    for words in (["bench", "--resume", "run"], ["report", "run"]):
        broken = run(words)
        check("a report that cannot be written costs one line", broken.returncode == 3 and
              broken.stderr.count("\n") == 1 and "run/report.html" in broken.stderr, broken.stdout + broken.stderr)
    check("and no result", len(open("run/results.jsonl").readlines()) == 2)
    os.rmdir("run/report.html")
    report = run(["report", "run"])
    check("report", report.returncode == 0 and "Report: run/report.html" in report.stdout, report.stderr)


def check_fuzz():
    """Every finding is listed, also those of earlier runs; where the list cannot be written all are printed."""
    count = 0
    for seed in ("1", "2"):
        done = run(["fuzz", "--count", "100", "--seed", seed, "--solvers", "nnls_paper", "--jobs", "1", "--out", "found"])
        count += sum(int(more.replace(",", "")) for more in re.findall(r"^and ([\d,]+) more: found/findings.txt$", done.stdout, re.M))
        count += len(re.findall("^problem ", done.stdout, re.M))
        check("findings", done.returncode == 1 and "  ./zwang solve found/" in done.stdout, done.stdout + done.stderr)
    with open("found/findings.txt") as file:
        listed = file.read()
    check("all are listed", count > 50 and listed.count("\nproblem ") == count and re.findall("^Seed .*", listed, re.M) == ["Seed 1", "Seed 2"], listed)
    again = re.search(r"^problem (\d+),.*\n  \./zwang (fuzz .*)$", listed, re.M)
    done = run([*again[2].split(), "--out", "again"])
    check("one without a file is found again", done.returncode == 1 and f"problem {again[1]}, nnls_paper" in done.stdout, again[0] + done.stdout)
    os.makedirs("unlisted/findings.txt")
    done = run(["fuzz", "--count", "100", "--solvers", "nnls_paper", "--out", "unlisted"])
    check("all are printed", len(re.findall("^problem ", done.stdout, re.M)) > 25 and " more: " not in done.stdout, done.stdout)


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    write_inputs()
    check_mistakes()
    check_help()
    check_absent_solvers()
    check_unread()
    check_solve()
    check_solutions()
    check_fuzz()
    check_export_and_bench()
    os.chdir("/")
sys.exit(1 if failures else 0)
