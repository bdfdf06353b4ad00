"""What `zwang guard` says of historic defects, and of changes that do no harm.

    mutants.py PROGRAM MUTANTS [--quick] [--changes N] [--others MUTANTS,...] [--jobs N] [--keep DIR]

Prints the table of docs/guard.md. MUTANTS is the test program beside this file: solvers with one defect each, and the
same problems in other words. --others: the same program built with other flags. The exit code is 1 where fewer than 13
of the 14 defects are caught, one of the two whose answers still converge is not, or a harmless change is an alarm.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

# A defect: whose solver has it, asked for what tolerance, what it is, and where it happened.
DEFECTS = {
    "wrong_merge": ("newton", "1e-10", "fronts merged that have different descendants: a wrong factor", "mujoco#3767"),
    "no_mass": ("newton", "1e-10", "Newton's matrix without M", "mujoco_warp#1405"),
    "no_joint_rows": ("pgs", "1e-8", "joint rows left out of the residual", "newton#3891"),
    "gap_as_residual": ("pgs", "1e-8", "\\|gap\\| as residual, of open contacts, too", "newton#3666"),
    "loose_tolerance": ("pgs", "1e-8", "tolerance loosened tenfold", "newton#1538"),
    "infinite_impulse": ("dual_active_set", "1e-10", "success with an infinite impulse", "dart#3384"),
    "unconverged": ("pgs", "1e-8", "what 50 sweeps leave is applied", "dart#3361"),
    "stale_warm_start": ("pgs", "1e-8", "forces of the problem before, whose motion is left out", ""),
    "float_stop": ("pgs", "1e-8", "stop at a step that float32 does not see", ""),
    "dropped_contacts": ("dual_active_set", "1e-10", "contacts beyond the 24th dropped", ""),
    "tangent_directions": ("nsgs", "1e-8", "friction in a box of the tangents, in place of a disc", ""),
    "row_order": ("pgs", "1e-8", "steps of a force clamped, not the force: the order of rows decides", ""),
    "nan_body": ("dual_active_set", "1e-10", "NaN in one body", "newton#3975"),
    "limit_sign": ("dual_active_set", "1e-10", "force on joint limits told with the wrong sign; z is right", ""),
}
STILL_CONVERGE = "wrong_merge", "no_mass"
SAMPLE = ("hand(contacts=0,4,16,seed=1..6),hand(contacts=16,feasible=0,seed=1..2),stack(boxes=3,seed=1..4),tower(boxes=5),"
          "chain(links=4,8,seed=1..3),four_bar(lean=-1,0,1),leash(dogs=4),arch(stones=5),pile(spheres=14,seed=1..2),"
          "MR(k=0,24),MRC(k=24),NPE(k=14),LOOP(k=14),GAP(k=4,14),INC(k=4,14),CYCLE(n=5,6),PIVOT(n=4),random(n=20,seed=1..6)")
FRICTION = ("incline(mu=0.5),crate(push=0.75),ladder(slope=0.5),belt,peg,cards,hand(contacts=4,mu=0.5,seed=1..8),stack(boxes=3,mu=0.5,seed=1..3),"
            "planted(k=1,seed=1..10),STKF(boxes=1,2),JAM(k=5,24),ROD(k=3,24),HELD,PINCH,PUCK")
CHANGES = {"rows": "all rows in another order", "ties": "contacts in another order: ties are decided otherwise",
           "bodies": "bodies in another order", "units": "rows, time, mass and length times powers of two", "all": "all of these at once"}
SOLVERS = {"dual_active_set": "1e-10", "newton": "1e-10", "pgs": "1e-6", "nnls": "1e-10", "cone": "1e-8"}

options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
options.add_argument("program")
options.add_argument("mutants")
options.add_argument("--quick", action="store_true", help="small problems")
options.add_argument("--changes", type=int, default=1000)
options.add_argument("--others", default="")
options.add_argument("--jobs", type=int, default=1)
options.add_argument("--keep", default="")
options.add_argument("--only", default=",".join(DEFECTS), help="some of the defects")
asked = options.parse_args()
program, mutants = os.path.abspath(asked.program), os.path.abspath(asked.mutants)
others = [os.path.abspath(other) for other in asked.others.split(",") if other]


def run(*words):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True)
    if done.returncode not in (0, 1, 3):
        sys.exit(f"{' '.join(map(str, words))}\n{done.stderr}")
    return done


def pack(name, *scenes):
    if not os.path.exists(name):
        made = run(program, "pack", *scenes, "--out", name)
        if made.returncode:
            sys.exit(made.stderr)
    return name


def answers(folder, solver, tolerance, change, which, by=mutants):
    file = f"{folder}.{solver}.{tolerance}.{change}.{which}{others.index(by) if by in others else ''}.jsonl"
    if not os.path.exists(file):
        made = run(by, folder, solver, tolerance, change, which, file)
        if made.returncode:
            sys.exit(made.stderr)
    return file


def guard(folder, before, after):
    """The exit code, and in short why."""
    done = run(program, "guard", folder, before, after, "--out", "guarded." + os.path.basename(after))
    if done.returncode == 3:
        return 3, "refused: " + done.stderr.strip().split(": ", 1)[1]
    said = [part for part in done.stdout.splitlines()[0].split(", ") if not re.match("0 |.* (better|same)$", part)]
    said += [re.sub(" +more than chance", "", line) for line in done.stdout.splitlines() if line.endswith("more than chance")]
    return done.returncode, "; ".join(said) or "nothing"


def same_bits(folder, solver, tolerance):
    """The copy that holds the defects, without one, is the solver."""
    file = f"{folder}.{solver}.jsonl"
    run(program, "solve-pack", folder, "--solver", solver, "--tolerance", tolerance, "--out", file)
    one, other = ([{k: v for k, v in json.loads(line).items() if k != "seconds"} for line in list(open(name))[1:]]
                  for name in (file, answers(folder, solver, tolerance, "mutant", "none")))
    return one == other


def caught(name, guarded, with_friction):
    solver, tolerance, what, where = DEFECTS[name]
    folder = with_friction if solver == "nsgs" else guarded
    code, said = guard(folder, answers(folder, solver, tolerance, "mutant", "none"),
                       answers(folder, solver, tolerance, "mutant", name))
    return name, code, f"| {what} | {where} | `{solver}` | {'yes' if code else '**no**'} | {said} |"


def harmless(k, folders):
    """One change of one solver. Every tenth round of all solvers and changes is on the whole of `guarded`."""
    one, solver = k // len(SOLVERS), list(SOLVERS)[k % len(SOLVERS)]
    k, change = one // len(CHANGES), list(CHANGES)[(k + one) % len(CHANGES)]
    by = [mutants, *others][(k + k // 10) % (1 + len(others))]
    folder = folders["guarded" if k % 10 == 3 else "friction" if solver == "cone" else "sample"]
    after = answers(folder, solver, SOLVERS[solver], change, k, by)
    code, said = guard(folder, answers(folder, solver, SOLVERS[solver], "mutant", "none"), after)
    if not code and not asked.keep:
        os.remove(after)
        shutil.rmtree("guarded." + os.path.basename(after))
    return change, solver, by, folder, code, said


def count(folder):
    return len(json.load(open(folder + "/pack.json"))["problems"])


def main():
    folders = {"sample": pack("sample", SAMPLE), "friction": pack("friction", FRICTION)}
    folders["guarded"] = folders["sample"] if asked.quick else pack("guard", "guard")
    for folder, solver, tolerance in (("sample", "newton", "1e-10"), ("sample", "pgs", "1e-8"), ("friction", "nsgs", "1e-8")):
        if not same_bits(folder, solver, tolerance):
            sys.exit(f"the copy of {solver} without a defect has other answers than {solver}")
    names = asked.only.split(",")
    found, tally, alarms = {}, collections.Counter(), 0
    with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        print("| defect | as in | in | caught | what guard said |\n|---|---|---|---|---|")
        for name, code, line in pool.map(lambda name: caught(name, folders["guarded"], folders["friction"]), names):
            found[name] = code
            print(line, flush=True)
        for done in pool.map(lambda k: harmless(k, folders), range(asked.changes)):
            change, solver, by, folder, code, said = done
            tally[change, count(folder)] += 1
            tally["flags"] += by != mutants
            if code:
                alarms += 1
                print(f"ALARM: {change} {solver} {folder} {os.path.basename(os.path.dirname(by))}: {said}", flush=True)
    print("\n| harmless change | made | on problems |\n|---|---|---|")
    for change, what in CHANGES.items():
        made = {problems: n for (other, problems), n in ((k, n) for k, n in tally.items() if k != "flags") if other == change}
        print(f"| {what} | {sum(made.values())} | {', '.join(f'{n} on {problems}' for problems, n in sorted(made.items()))} |")
    print(f"| of these with a program of other flags | {tally['flags']} | |")
    right = sum(map(bool, found.values()))
    print(f"\n{right} of {len(found)} defects are caught; {alarms} alarms in {asked.changes} harmless changes")
    missed = [name for name in names if not found[name]]
    return 1 if alarms or len(missed) > (len(names) == len(DEFECTS)) or set(missed) & set(STILL_CONVERGE) else 0


if asked.keep:
    os.makedirs(asked.keep, exist_ok=True)
with tempfile.TemporaryDirectory() as folder:
    os.chdir(asked.keep or folder)
    result = main()
    os.chdir("/")
sys.exit(result)
