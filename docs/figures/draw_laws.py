#!/usr/bin/python3
"""Draws law-*.svg beside itself: the forces that each law of friction allows, and what a sliding block does under it.

The block of mass 1 approaches the ground at 1 m/s, slides at 4 m/s, mu = 1/2: docs/friction.md has the formulas.
"""
import math
import pathlib

ink, muted, blue, red, light = "#1b1f24", "#57606a", "#0b5fa5", "#b3261e", "#dce9f5"
mu, slide, approach = 0.5, 4.0, 1.0


def convex(friction):
    """(slip, lift, normal force, friction) where the law is Gauss' principle on the dual cone."""
    slip = (slide - friction * approach) / (1 + friction**2)
    return slip, friction * slip, friction * slip + approach, slide - slip


laws = {
    "frictionless": ("Frictionless: a contact pushes, and nothing else", (slide, 0, approach, 0), "point"),
    "pyramid": ("Pyramid: four edges, a quadratic program; here along the diagonal, where it is weakest", convex(mu / math.sqrt(2)), "diamond"),
    "convex": ("Convex: the whole cone, one answer; what slides lifts off", convex(mu), "circle"),
    "coulomb": ("Coulomb: the whole cone, and what slides stays down", (slide - mu * approach, 0, approach, mu * approach), "circle"),
}


def text(x, y, words, size=13, color=ink, anchor="start", weight="normal"):
    return f'<text x="{x}" y="{y}" font-size="{size}" fill="{color}" text-anchor="{anchor}" font-weight="{weight}">{words}</text>'


def arrow(x1, y1, x2, y2, color):
    if math.hypot(x2 - x1, y2 - y1) < 4:
        return ""
    return f'<line x1="{x1:g}" y1="{y1:g}" x2="{x2:g}" y2="{y2:g}" stroke="{color}" stroke-width="2.5" marker-end="url(#{color[1:]})"/>'


def head(color):
    return (f'<marker id="{color[1:]}" viewBox="0 0 10 10" refX="8" refY="5" markerWidth="6" markerHeight="6" orient="auto">'
            f'<path d="M0,0L10,5L0,10z" fill="{color}"/></marker>')


def allowed(shape, x, y):
    """The forces along the ground that a normal force allows, seen from above."""
    r = 52
    area = {"point": f'<circle cx="{x}" cy="{y}" r="4" fill="{blue}"/>',
            "circle": f'<circle cx="{x}" cy="{y}" r="{r}" fill="{light}" stroke="{blue}" stroke-width="2"/>',
            "diamond": f'<path d="M{x - r},{y}L{x},{y - r}L{x + r},{y}L{x},{y + r}z" fill="{light}" stroke="{blue}" stroke-width="2"/>'}[shape]
    axes = f'<path d="M{x - 66},{y}H{x + 66}M{x},{y - 66}V{y + 66}" stroke="{muted}" stroke-width="1" stroke-dasharray="3 3"/>'
    caption = "none" if shape == "point" else "at most mu l_n" if shape == "circle" else "|l_x| + |l_y| at most mu l_n"
    return area + axes + text(x, y + 86, caption, 12, muted, "middle")


def picture(title, numbers, shape):
    slip, lift, normal, friction = numbers
    x, floor, scale = 330, 168, 26
    top = floor - 56
    # The motion leaves from the block's lower right corner, forces act at the middle of its lower edge.
    parts = [
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 660 240" width="660" height="240" font-family="Liberation Sans, Arial, sans-serif">',
        f'<defs>{head(blue)}{head(red)}</defs><rect width="660" height="240" fill="white"/>',
        text(16, 26, title, 15, ink, weight="bold"),
        allowed(shape, 110, 126),
        f'<path d="M240,{floor}H640" stroke="{muted}" stroke-width="2"/>',
        f'<rect x="{x - 45}" y="{top}" width="90" height="56" fill="#f2f3f5" stroke="{ink}" stroke-width="1.5"/>',
        arrow(x + 45, floor - 28, x + 45 + scale * slip, floor - 28 - scale * lift, red),
        arrow(x, floor, x, floor - scale * normal, blue),
        arrow(x, floor - 3, x - scale * friction, floor - 3, blue),
        text(x + 60 + scale * slip, floor - 28 - scale * lift - 4, f"slides at {slip:.3g} m/s", 13, red),
        text(x + 60 + scale * slip, floor - 28 - scale * lift + 13, f"lifts at {lift:.3g} m/s" if lift else "stays down", 13, red),
        text(x, floor + 24, f"normal {normal:.3g}, friction {friction:.3g}", 13, blue, "middle"),
        text(110, 44, "friction, from above", 12, muted, "middle"),
        text(640, 226, "block of mass 1: approaches at 1 m/s, slides at 4 m/s, mu = 1/2", 12, muted, "end"),
        "</svg>\n",
    ]
    return "\n".join(part for part in parts if part)


here = pathlib.Path(__file__).resolve().parent
for name, (title, numbers, shape) in laws.items():
    (here / f"law-{name}.svg").write_text(picture(title, numbers, shape))
