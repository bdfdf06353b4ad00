#!/usr/bin/python3
"""Draws gradients.svg beside itself, and prints the paragraph of docs/tutorials/gradients.md: how far off gradients are that are made by
finite differences, and by rows made soft. Takes some minutes. Needs the Python module (./zwang python).

Left, a block of mass 1 that rests on the ground, mu = 1/2, and is pushed by its weight times x: how fast it slides. Right, what
./zwang bench --gradients says.
"""
import pathlib
import tempfile

import numpy

import zwang
from zwang.usual_gradients import AMBER as amber, BLUE as blue, LAWS, MUTED as muted, RED as red, SCENES, Soft, bench, chart, path, sentence, svg, text


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


found, kinks = bench(pathlib.Path(tempfile.mkdtemp()), SCENES, LAWS, 1, print)
(pathlib.Path(__file__).parent / "gradients.svg").write_text(svg(880, left() + chart(found, 410)))
print(sentence(found, kinks))
