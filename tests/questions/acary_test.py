"""experiments/acary/acary.py on a folder of exported scenes and one local file: bands, verdicts, tables, and that a folder is gone on with.

Usage: acary_test.py PROGRAM
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
from xml.etree import ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "experiments/acary"))
import acary  # noqa: E402

PROGRAM = sys.argv[1]
SCRIPT = str(ROOT / "experiments/acary/acary.py")
failures = 0


def check(what, holds, detail=""):
    global failures
    if not holds:
        failures += 1
        print(f"FAILED: {what} {detail}")


def close(pair, expected):
    return all(math.isclose(a, b, abs_tol=5e-4) for a, b in zip(pair, expected))


# Newcombe, Statistics in Medicine 17 (1998): 81 of 263; 56 of 70 against 48 of 80.
check("Wilson's band", close(acary.wilson(81, 263), (0.2553, 0.3662)), acary.wilson(81, 263))
check("of none", acary.wilson(0, 0) == (0, 1))
check("Newcombe's band", close(acary.newcombe(56, 70, 48, 80), (0.0524, 0.3339)), acary.newcombe(56, 70, 48, 80))
check("a band above the mark confirms, below it refutes", [acary.word(*band, 0.5) for band in ((0.6, 1), (0, 0.4), (0.4, 0.6))] ==
      ["confirmed", "refuted", "undecided"])
check("few say nothing", acary.Checks.share(3, 3, 0.8, "")[0] == "undecided" and acary.Checks.share(30, 30, 0.8, "")[0] == "confirmed")
check("one of all refutes", acary.Checks.all_hold(9, 10, "")[0] == "refuted" and acary.Checks.all_hold(0, 0, "")[0] == "undecided")

clock = acary.Clock(1000, 10, 2)
shares = [clock.share() for _ in range(10)]
check("a file's share of the time: as if all were alike, then what others have left, a quarter of all at most", all(abs(s - due) < 5 for s, due in
      zip(shares, [200, 222, 250] + [250] * 7)), shares)

# A local problem as Siconos prints it: one contact whose W is not symmetric, mu = 1/2.
LOCAL = "3\n1\n0\n3 3\n3 3\n1 0 0\n0 1 0.001\n0 0 1\n-1\n0.2\n0\n0.5\n"
SCENES = {"block": ["stack", "--boxes=1", "--mu=0.5"], "rod": ["ROD"], "wedge": ["JAM"], "corner": ["HELD"], "slip": ["SLIP"]}

with tempfile.TemporaryDirectory() as folder:
    folder = pathlib.Path(folder)
    problems, out = folder / "problems", folder / "out"
    problems.mkdir()
    for name, words in SCENES.items():
        subprocess.run([PROGRAM, "export", *words, "--out", problems / f"{name}.h5"], check=True, stdout=subprocess.DEVNULL)
    (problems / "Capsules-local.dat").write_text(LOCAL)
    (problems / "notes.txt").write_text("no problem")
    command = [sys.executable, SCRIPT, PROGRAM, problems, "--out", out, "--search", "60", "--time-limit", "2"]
    done = subprocess.run(command, capture_output=True, text=True)
    check("it runs", done.returncode == 0, done.stderr)
    found = json.loads((out / "acary.json").read_text())
    verdicts = [c["verdict"] for c in found["checks"]]
    check("each claim has one of three words and says what was counted", set(verdicts) <= {"confirmed", "refuted", "undecided"} and
          all(c["found"] and c["where"] for c in found["checks"]) and len(verdicts) > 30, verdicts)
    said = {c["claim"]: c for c in found["checks"]}
    check("what no solver here can test is undecided", said["the proximal point helps Newton on rigid sets"]["verdict"] == "undecided")
    check("an asymmetric W of theirs is confirmed, with its size", said["Capsules, Chain, LowWall, Chute, Cubes: W is not symmetric"]["verdict"] == "confirmed" and
          "1.0e-03" in said["Capsules, Chain, LowWall, Chute, Cubes: W is not symmetric"]["found"], said["Capsules, Chain, LowWall, Chute, Cubes: W is not symmetric"])
    by_name = {p["problem"]: p for p in found["problems"]}
    check("all files are there, .dat beside HDF5", len(by_name) == len(SCENES) + 1, list(by_name))
    check("numbers of solutions", by_name["ROD"]["solutions"] == "3 and no more" and by_name["JAM"]["solutions"] == "1 and no more", by_name)
    check("strict motions", by_name["HELD"]["strictly"] == "not strictly" and by_name["ROD"]["strictly"] == "strictly", by_name)
    local = by_name["Capsules-local"]
    check("the local file: rank, asymmetry, modes by hand (it pushes with 1, slips at 0.2 < mu: it sticks)",
          (local["rank"], local["asymmetry of W"], local["stick"], local["slide"]) == (3, 0.001, 1, 0), local)
    tried = {row["solver"]: row for row in found["solvers"] if row["tolerance"] == acary.TIGHT}
    check("the solvers", {"cone", "nsgs", "alart_curnier"} <= set(tried) and tried["cone"]["right"] == tried["cone"]["tried"] == len(by_name) and
          all(row["called solved, wrong"] == 0 for name, row in tried.items() if not name.startswith("vi_")), tried)
    check("the variational inequality's, and what their residual is worth", set(acary.variational.RULES) <= set(tried) and tried["vi_fixed_point"]["right"] > 0, tried)
    check("the page", all(f"## {part}" in (out / "acary.md").read_text() for part in ("Solvers", "Problems")))
    drawn = ElementTree.parse(out / "acary.svg").getroot()
    bars = [bar.text for bar in drawn.iter("{http://www.w3.org/2000/svg}title")]
    check("the picture: cone is right on all of each column", [b for b in bars if b.startswith("cone:")] ==
          [f"cone: {sum(1 for p in by_name.values() if (p['rank'] == p['rows']) == full)} right at 1e-8" for full in (True, False)], bars)
    check("it is gone on with", subprocess.run(command, capture_output=True).returncode == 0 and
          [c["claim"] for c in json.loads((out / "acary.json").read_text())["checks"]] == list(said))
    whole = subprocess.run([sys.executable, SCRIPT, PROGRAM, "--run", next(out.glob("runs/block-*/0")), "--out", folder / "again", "--search", "0", "--time-limit", "1"], capture_output=True, text=True)
    check("a run made before is read", whole.returncode == 0 and (folder / "again/acary.json").exists(), whole.stderr)
    (folder / "empty").mkdir()
    (problems / "broken.dat").write_text("3\n1\n0\n3 3\n3 3\n1 0 0\n")
    wrong = subprocess.run([*command, "--within", "60"], capture_output=True, text=True)
    check("a broken file costs one line, and the others are compared", wrong.returncode == 3 and [line for line in wrong.stderr.splitlines() if " files, " not in line] == [line for line in wrong.stderr.splitlines() if "broken.dat" in line] and
          len(json.loads((out / "acary.json").read_text())["problems"]) == len(by_name), (wrong.returncode, wrong.stderr))
    slow = subprocess.run([sys.executable, SCRIPT, PROGRAM, problems / "rod.h5", "/nowhere/one.h5", "--out", folder / "cut", "--within", "0.001"], capture_output=True, text=True)
    check("who gets no time is told", slow.returncode == 3 and "one.h5" in slow.stderr, (slow.returncode, slow.stderr))
    for words, code in ((["--run", folder], 3), ([], 2), ([folder / "empty"], 3), ([problems, "--within", "0"], 2), ([problems, "--jobs", "x"], 2), (["--nothing"], 2), ([problems, "--jobs", "0"], 2), ([folder / "again" / "none"], 3)):
        wrong = subprocess.run([sys.executable, SCRIPT, PROGRAM, *words, "--out", folder / "wrong"], capture_output=True, text=True)
        check(f"wrong use of {words}", wrong.returncode == code and wrong.stderr.count("\n") == 1, (wrong.returncode, wrong.stderr))
    for out in ("/proc/x", SCRIPT):
        wrong = subprocess.run([sys.executable, SCRIPT, PROGRAM, problems, "--out", out], capture_output=True, text=True)
        check(f"{out} costs one line", wrong.returncode == 3 and wrong.stderr.startswith(f"{out}: ") and wrong.stderr.count("\n") == 1, (wrong.returncode, wrong.stderr))
sys.exit(failures > 0)
