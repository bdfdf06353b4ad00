#!/usr/bin/python3
"""Draws accuracy.svg beside itself, and prints a table: what a solver that may end at an accuracy takes, against its own
solve to a tolerance of 1e-10, and how far what it promises is from the truth, which the referee finds but under Coulomb's law. Where the rows that carry were the right
ones the answer is exact and the promise is rounding: how often, and what the others promise over what is true. Takes some minutes. Needs the
Python module (./zwang python).

Times are CPU times of first solves of a new object, the least of three, both kinds in turn.
"""
import math
import pathlib
import statistics
import sys

import zwang

ink, muted, light = "#1b1f24", "#57606a", "#d0d7de"
colors = {"cone": "#0b5fa5", "newton": "#1a7f37", "pgs": "#b3261e", "apgd": "#9a6700", "projected_gradient": "#8250df", "nsgs": "#b3261e",
          "admm": "#9a6700", "fixed_point": "#8250df"}
accuracies = [1e-2, 1e-3, 1e-4, 1e-6, 1e-8]
friction = "crate,stack(boxes=3),tower(boxes=3),pile,hand(contacts=4),hand(contacts=16)"
families = [  # title, scenes, mu, law, solvers
    ("Hands, 4 to 200 contacts", "hand(contacts=4,16,64,200,seed=1..2)", None, None, ("cone", "newton", "pgs", "apgd", "projected_gradient")),
    ("Walls, 10 to 100 bricks", "wall(boxes=10,30,100)", None, None, ("cone", "newton", "pgs", "apgd", "projected_gradient")),
    ("Friction, convex law", friction, 0.5, "convex", ("cone", "admm")),
    ("Friction, Coulomb's law", friction, 0.5, "coulomb", ("cone", "nsgs", "admm", "fixed_point")),
]
limit_s, exact = 2, 1e-9


def measure(problem, solver):
    """A dict for each accuracy: part of the time to 1e-10, promise, and the proven range of the error; None where 1e-10 is not reached."""
    asked = [None, *accuracies]
    least, last = {a: math.inf for a in asked}, {}
    for turn in range(3):
        for a in asked:
            s = zwang.solve(problem, solver, accuracy=a, time_limit=limit_s)
            least[a], last[a] = min(least[a], s.seconds), s
        if turn == 0 and (last[None].status != "solved" or last[None].seconds > 1):
            break
    if last[None].status != "solved":
        return None
    out = []
    for a in accuracies:
        s = last[a]
        row = dict(accuracy=a, part=least[a] / least[None], steps=s.iterations / max(1, last[None].iterations), promise=s.error_bound)
        if problem.law != "coulomb" and math.isfinite(s.error_bound):
            judged = zwang.judge(problem, s.z)
            row.update(least=judged.at_least, most=judged.at_most)
        out.append(row)
    return out


def text(x, y, words, size=13, color=ink, anchor="start", weight="normal"):
    return f'<text x="{x:g}" y="{y:g}" font-size="{size}" fill="{color}" text-anchor="{anchor}" font-weight="{weight}">{words}</text>'


def line(points, color, width=2.0):
    return f'<path d="M{"L".join(f"{x:.1f},{y:.1f}" for x, y in points)}" fill="none" stroke="{color}" stroke-width="{width}"/>'


parts, broken, judged, promises = [], 0, 0, 0
print("| problems | solver | accuracies promised | of them exact | time for 1e-4, of that for 1e-10 | steps, the same | promised over true, of the others |\n"
      "|---|---|---|---|---|---|---|")
for place, (title, scenes, mu, law, solvers) in enumerate(families):
    left, top = 60 + 440 * (place % 2), 44 + 250 * (place // 2)
    X = lambda a: left + 42 * -math.log10(a) - 60
    Y = lambda part: top + 180 - 75 * min(part, 2.3)
    parts.append(text(left - 40, top - 20, title, 14, weight="bold"))
    for y in (0, 1, 2):
        parts += [line([(left, Y(y)), (left + 300, Y(y))], light, 1), text(left - 8, Y(y) + 4, f"{y:g}", 11, muted, "end")]
    parts += [text(X(a), top + 198, f"1e{round(math.log10(a))}", 11, muted, "middle") for a in accuracies]
    problems = zwang.scene(scenes, mu=mu) if mu else zwang.scene(scenes)
    problems = [p if law is None or p.law == law else p.under(law) for p in problems]
    ends = []
    for solver in solvers:
        rows = [row for p in problems for row in measure(p, solver) or []]
        if not rows:
            print(f"| {title} | `{solver}` | to 1e-10 on none | | | | |")
            continue
        at = lambda a, key: statistics.median(r[key] for r in rows if r["accuracy"] == a)
        promised = [r for r in rows if math.isfinite(r["promise"])]
        promises += len(promised)
        judged += sum("least" in r for r in promised)
        broken += sum(r.get("least", 0) > r["promise"] for r in promised)
        others = [r for r in promised if r["promise"] > exact]
        over = [r["promise"] / r["most"] for r in others if r.get("most", 0) > 0]
        print(f"| {title} | `{solver}` | {len(promised)} of {len(rows)} | {len(promised) - len(others)} | {at(1e-4, 'part'):.2f} | {at(1e-4, 'steps'):.2f} | "
              f"{f'{statistics.median(over):.1f}' if over else ''} |", flush=True)
        parts.append(line([(X(a), Y(at(a, "part"))) for a in accuracies], colors[solver]))
        ends.append((Y(at(1e-8, "part")), solver))
    below = -math.inf
    for y, solver in sorted(ends):
        below = max(y, below + 14)
        parts.append(text(left + 306, below + 4, solver, 12, colors[solver]))
print(f"\n{promises} promises, {judged} of them judged, {broken} broken", file=sys.stderr)
svg = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 940 530" width="940" height="530" font-family="Liberation Sans, Arial, sans-serif">',
       '<rect width="940" height="530" fill="white"/>', *parts,
       text(20, 518, "Time of a solve that may end at an accuracy, over the time to a tolerance of 1e-10; medians. Below 1 it pays.", 12, muted), "</svg>\n"]
pathlib.Path(__file__).with_name("accuracy.svg").write_text("\n".join(svg))
