#!/usr/bin/python3
"""Draws gradients.svg beside itself, and prints the paragraph of docs/tutorials/gradients.md: how far off gradients are that are made by
finite differences, and by rows made soft. Takes some minutes. Needs the Python module (./zwang python).

Left, a block of mass 1 that rests on the ground, mu = 1/2, and is pushed by its weight times x: how fast it slides. Right, on the problems
below, what zwang.compare_gradients says.
"""
import math
import pathlib

import numpy

import zwang
from zwang.usual_gradients import Soft

ink, muted, blue, red, amber, light = "#1b1f24", "#57606a", "#0b5fa5", "#b3261e", "#9a6700", "#d0d7de"
steps = [10.0**-k for k in range(1, 13)]
names = ["hand(contacts=4)", "hand(contacts=16)", "tower(boxes=4)", "pile", "chain", "four_bar", "leash", "MRC", "NPE", "WEAK", "NPI", "WED",
         "CHAIN", "FLIP", "UNIT", "ANI", "planted", "stack(boxes=2)", "MU0", "MUL", "APEX", "SLIP", "ball"]


def errors():
    out, kinks = [], 0
    for name in names:
        for law in ("frictionless", "convex", "coulomb"):
            for seed in (1, 2):
                try:
                    p = zwang.scene(name, seed=seed, mu=None if law == "frictionless" else 0.5)
                except ValueError:
                    p = zwang.scene(name, seed=seed)
                p = p if p.law == law else p.under(law)
                if p.law != law or p.size > 100:
                    continue
                row, = zwang.compare_gradients(p, steps=steps, smoothings=steps, seed=seed)
                kinks += bool(row["kink"])
                if row["width"] >= 0 and not row["kink"]:
                    out.append(row)
    return out, kinks


def text(x, y, words, size=13, color=ink, anchor="start", weight="normal"):
    return f'<text x="{x:g}" y="{y:g}" font-size="{size}" fill="{color}" text-anchor="{anchor}" font-weight="{weight}">{words}</text>'


def path(points, color, width=2.0, dash=""):
    line = "L".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<path d="M{line}" fill="none" stroke="{color}" stroke-width="{width}"' + (f' stroke-dasharray="{dash}"' if dash else "") + "/>"


def block(push):
    return zwang.Problem(numpy.eye(3), [push, 0, -1.0], [[0, 0, 1], [1, 0, 0], [0, 1, 0]], [0, 0, 0], tangent=[False, True, True],
                         mu=[0.5, 0, 0], law="coulomb")


def left():
    """Slip over push: a kink at 1/2."""
    X, Y = lambda x: 60 + 260 * x, lambda y: 250 - 330 * y
    pushes = [k / 50 for k in range(51)]
    slips = [zwang.solve(block(x), "cone", tolerance=1e-12).z[0] for x in pushes]
    soft = [Soft(block(x).under("convex"), 0.1).solve(numpy.zeros(3))[0][0] for x in pushes]
    at = block(0.5)
    answer = zwang.solve(at, "cone")
    forward, back = (zwang.gradient(at, answer, "z_u", [sign, 0, 0]) for sign in (1, -1))
    assert forward.kink == back.kink == [0]
    parts = [text(16, 24, "A block that is pushed: how fast it slides", 14, weight="bold"), path([(X(0), Y(0)), (X(1.05), Y(0))], muted, 1),
             path([(X(0), Y(0)), (X(0), Y(0.58))], muted, 1), path([(X(x), Y(y)) for x, y in zip(pushes, soft)], amber, 1.5, "5 3"),
             path([(X(x), Y(y)) for x, y in zip(pushes, slips)], blue, 2.5)]
    for derivative, sign in ((forward, 1), (back, -1)):
        slope = derivative.dz[0] * sign
        parts.append(path([(X(0.5), Y(0)), (X(0.5 + sign * 0.28), Y(sign * 0.28 * slope))], red, 4, "2 3"))
        parts.append(text(X(0.72) if sign > 0 else X(0.27), Y(0.3) if sign > 0 else Y(0.03), f"{round(slope)} forward" if sign > 0 else f"{round(slope)} back", 13, red,
                          "end" if sign > 0 else "middle"))
    parts += [f'<circle cx="{X(0.5)}" cy="{Y(0)}" r="4" fill="{red}"/>', text(X(0.5), Y(0) + 34, "kink: at the edge of its cone", 12, red, "middle"),
              text(X(0.98), Y(0.05), "rows made soft", 12, amber, "end")]
    for x in (0, 0.5, 1):
        parts.append(text(X(x), Y(0) + 17, f"{x:g}", 12, muted, "middle"))
    return parts + [text(X(1.05), Y(0) + 50, "push over weight", 12, muted, "end")]


def right(found):
    X = lambda h: 430 + 36 * -math.log10(h)
    Y = lambda e: 40 + 210 * math.log10(max(min(e, 10), 1e-17) / 10) / -18
    parts = [text(410, 24, f"Error of dz on {len(found)} problems: median, and nine in ten (dashed)", 14, weight="bold")]
    for k in range(0, -17, -4):
        parts += [path([(X(0.1), Y(10.0**k)), (X(1e-12), Y(10.0**k))], light, 1), text(X(0.1) - 8, Y(10.0**k) + 4, f"1e{k}" if k else "1", 11, muted, "end")]
    for h in steps[1::2]:
        parts.append(text(X(h), 268, f"1e{round(math.log10(h))}", 11, muted, "middle"))
    said = {}
    for which, color, name, place in (("differences", blue, "finite differences, by step", (11, "end")), ("soft", amber, "rows made soft, by smoothing", (1, "start"))):
        bands = []
        for h in steps:
            values = sorted(row[which][h] for row in found if h in row[which])
            bands.append((h, values[len(values) // 2], values[(9 * len(values)) // 10]))
        said[name] = {h: (mid, high) for h, mid, high in bands}
        parts += [path([(X(h), Y(mid)) for h, mid, _ in bands], color, 2.5), path([(X(h), Y(high)) for h, _, high in bands], color, 1.2, "4 3")]
        at = bands[place[0]]
        parts.append(text(X(at[0]), Y(at[2]) - 9, name, 12, color, place[1]))
    width = sorted(row["width"] for row in found)
    parts += [path([(X(0.1), Y(width[(9 * len(width)) // 10])), (X(1e-12), Y(width[(9 * len(width)) // 10]))], red, 2.5),
              text(X(1e-12), Y(width[(9 * len(width)) // 10]) - 6, "zwang.gradient, proven, nine in ten", 12, red, "end"),
              text(X(1e-12), 286, "step, or smoothing, relative", 12, muted, "end")]
    return parts, said, width


found, kinks = errors()
parts, said, width = right(found)
svg = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 880 312" width="880" height="312" font-family="Liberation Sans, Arial, sans-serif">',
       '<rect width="880" height="312" fill="white"/>', *left(), *parts, "</svg>\n"]
pathlib.Path(__file__).with_suffix(".svg").with_name("gradients.svg").write_text("\n".join(svg))
for name, bands in said.items():
    print(name, {f"{h:.0e}": f"{mid:.1e} {high:.1e}" for h, (mid, high) in bands.items()})
print(f"{len(found)} problems; proven to {width[len(width) // 2]:.1e} (median), {width[(9 * len(width)) // 10]:.1e} (nine in ten), {width[-1]:.1e}; "
      f"kinks left out: {kinks}; reach below 1e-2: {sum(row['reach'] < 1e-2 for row in found)}, below 1e-4: {sum(row['reach'] < 1e-4 for row in found)}")
