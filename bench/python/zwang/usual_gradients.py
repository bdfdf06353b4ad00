"""Gradients as they are usually made, against proven ones (docs/tutorials/gradients.md).

Rows made soft, as in MuJoCo: minimize 1/2 |z - z_u|_M^2 + sum |lambda_i|^2 R_i / 2, lambda_i = P_K(-s_i) / R_i,
R_i = smoothing J_i M^-1 J_i'. Their gradient is exact, of a softer problem.
"""
import math

import numpy

from .complementarity import project

# What ./zwang bench --gradients asks unless it is told: hands, towers, chains, families of the atlas, frictional ones.
SCENES = ("hand(contacts=4),hand(contacts=16),tower(boxes=4),pile,chain,four_bar,leash,MRC,NPE,WEAK,NPI,WED,CHAIN,FLIP,UNIT,ANI,planted,"
          "stack(boxes=2),MU0,MUL,APEX,SLIP,ball")
LAWS, MU, SEEDS = ("frictionless", "convex", "coulomb"), 0.5, 2
STEPS = tuple(10.0**-k for k in range(1, 13))
INK, MUTED, BLUE, RED, AMBER, LIGHT = "#1b1f24", "#57606a", "#0b5fa5", "#b3261e", "#9a6700", "#d0d7de"
LARGEST = 100  # unknowns: soft rows are solved densely

NEWTON = 60  # steps on a soft problem
CONVERGED = 1e-26  # of the objective, relative, that a step still gains
MOVES = 1e-3  # of the change of the free motion: a dz that is less is none to compare by


class Soft:
    """A problem with soft rows, under any law but Coulomb's."""

    def __init__(self, p, smoothing):
        self.p, self.M, self.J = p, p.M.toarray(), p.J.toarray()
        unit = numpy.einsum("ij,ji->i", self.J, numpy.linalg.solve(self.M, self.J.T))
        tangent, self.blocks, self.R, i = p.tangent, [], numpy.ones(p.rows), 0
        while i < p.rows:
            end = i + 1
            while end < p.rows and tangent[end]:
                end += 1
            if p.c[i] > -math.inf and unit[i] > 0:
                self.blocks.append((slice(i, end), p.mu[i], p.equality[i]))
                self.R[i:end] = smoothing * unit[i]
            i = end

    def at(self, z, bend=True):
        """The objective, its gradient and Hessian."""
        s, d = self.J @ z - numpy.where(numpy.isfinite(self.p.c), self.p.c, 0), z - self.p.z_u
        force, D = numpy.zeros(len(s)), numpy.zeros((len(s), len(s)))
        for rows, mu, equal in self.blocks:
            force[rows], D[rows, rows] = (-s[rows], numpy.eye(rows.stop - rows.start)) if equal else project(-s[rows], mu)
        value, slope = 0.5 * d @ self.M @ d + 0.5 * force @ (force / self.R), self.M @ d - self.J.T @ (force / self.R)
        return value, slope, self.M + self.J.T @ (D / self.R[:, None]) @ self.J if bend else None

    def solve(self, z):
        for _ in range(NEWTON):
            value, slope, H = self.at(z)
            step, t = -numpy.linalg.solve(H, slope), 1.0
            if abs(slope @ step) < CONVERGED * (1 + abs(value)):
                break
            while self.at(z + t * step, False)[0] > value + 1e-4 * t * (slope @ step) and t > 1e-6:
                t /= 2
            z = z + t * step
        return z, H


def changed(p, d, h):
    from . import Problem
    friction = dict(tangent=p.tangent, mu=p.mu, law=p.law) if p.tangent.any() else {}
    return Problem(p.M, p.z_u + h * d, p.J, p.c, equality=p.equality, **friction)


def compare(p, steps, smoothings, seed):
    from . import gradient, solve
    solver = "cone" if p.tangent.any() else "dual_active_set"
    answer = solve(p, solver, tolerance=1e-12)
    out = {"problem": p.name, "law": p.law, "kink": [], "note": "", "width": math.nan, "reach": 0.0, "differences": {}, "soft": {}}

    def norm(v):
        return math.sqrt(max(v @ (p.M @ v), 0.0))
    d = numpy.random.default_rng(seed).normal(size=p.size)
    d *= norm(p.z_u) / norm(d)
    try:
        true = gradient(p, answer, "z_u", d)
    except ValueError as why:
        out["note"] = str(why)
        return out
    out["kink"], out["reach"] = true.kink, true.reach
    if true.dz is None or norm(true.dz) < MOVES * norm(d):
        out["note"] = true.note if true.dz is None else "hardly anything moves"
        return out
    size = norm(true.dz)
    out["width"] = norm(true.enclosure) / size
    for h in steps:
        ahead, behind = (solve(changed(p, d, t), solver, tolerance=1e-12) for t in (h, -h))
        if len(ahead.z) and len(behind.z):
            out["differences"][h] = norm((ahead.z - behind.z) / (2 * h) - true.dz) / size
    for smoothing in smoothings if p.law != "coulomb" else ():
        z, H = Soft(p, smoothing).solve(answer.z)
        out["soft"][smoothing] = norm(numpy.linalg.solve(H, p.M @ d) - true.dz) / size
    return out


def problems(scenes, laws, seed):
    """Each of the scenes, from two seeds, under each law, where it has such contacts; with its seed."""
    from . import scene
    for law in laws:
        for k in range(seed, seed + SEEDS):
            made = scene(scenes, seed=k, mu=None if law == "frictionless" else MU)
            for p in made if isinstance(made, list) else [made]:
                p = p if p.law == law else p.under(law)
                if p.law == law and p.size <= LARGEST:
                    yield p, k


def bands(found, which, amounts):
    """{amount: (median, nine in ten)} of the errors."""
    out = {}
    for h in amounts:
        values = sorted(row[which][h] for row in found if h in row[which])
        if values:
            out[h] = values[len(values) // 2], values[(9 * len(values)) // 10]
    return out


def sentence(found, kinks):
    """What the chart says, in words."""
    at, soft, width = bands(found, "differences", STEPS), bands(found, "soft", STEPS), sorted(row["width"] for row in found)
    if not at:
        return "No problem has a derivative to compare with."
    best = min(at, key=lambda h: at[h][0])
    steps = [f"{at[h][0]:.0e} with a step of {h:.0e}{', their best' if h == best else ''}" for h in sorted({max(at), best, min(at)}, reverse=True)]
    words = f"On {len(found)} problems (kinks left out: {kinks}) central differences are off by {', by '.join(steps)}, in the median."
    for smoothing in (1e-2, 1e-4):
        if smoothing in soft:
            words += (f" Rows made soft are off by {soft[smoothing][0]:.0e} where the smoothing is {smoothing:.0e}, one in ten by more than "
                      f"{soft[smoothing][1]:.0e}.")
    return words + (f" The enclosures of zwang.gradient are {width[len(width) // 2]:.0e} wide in the median, {width[-1]:.0e} at most. A row changes its "
                    f"mode within a step of 1e-2 for {sum(row['reach'] < 1e-2 for row in found)}.")


def text(x, y, words, size=13, color=INK, anchor="start", weight="normal"):
    return f'<text x="{x:g}" y="{y:g}" font-size="{size}" fill="{color}" text-anchor="{anchor}" font-weight="{weight}">{words}</text>'


def path(points, color, width=2.0, dash=""):
    line = "L".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<path d="M{line}" fill="none" stroke="{color}" stroke-width="{width}"' + (f' stroke-dasharray="{dash}"' if dash else "") + "/>"


def svg(width, parts):
    return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} 312" width="{width}" height="312" '
                      'font-family="Liberation Sans, Arial, sans-serif">', f'<rect width="{width}" height="312" fill="white"/>', *parts, "</svg>\n"])


def chart(found, left=0):
    """Error over step and smoothing, 450 wide: parts of an SVG."""
    X = lambda h: left + 20 + 36 * -math.log10(h)
    Y = lambda e: 40 + 210 * math.log10(max(min(e, 10), 1e-17) / 10) / -18
    parts = [text(left, 24, f"Error of dz on {len(found)} problems: median, and nine in ten (dashed)", 14, weight="bold")]
    for k in range(0, -17, -4):
        parts += [path([(X(0.1), Y(10.0**k)), (X(1e-12), Y(10.0**k))], LIGHT, 1), text(X(0.1) - 8, Y(10.0**k) + 4, f"1e{k}" if k else "1", 11, MUTED, "end")]
    for h in STEPS[1::2]:
        parts.append(text(X(h), 268, f"1e{round(math.log10(h))}", 11, MUTED, "middle"))
    for which, color, name, place in (("differences", BLUE, "finite differences, by step", "end"), ("soft", AMBER, "rows made soft, by smoothing", "start")):
        at = bands(found, which, STEPS)
        if not at:
            continue
        parts += [path([(X(h), Y(mid)) for h, (mid, _) in at.items()], color, 2.5), path([(X(h), Y(high)) for h, (_, high) in at.items()], color, 1.2, "4 3")]
        h = list(at)[-1 if place == "end" else min(1, len(at) - 1)]
        parts.append(text(X(h), Y(at[h][1]) - 9, name, 12, color, place))
    width = sorted(row["width"] for row in found)
    if width:
        line = Y(width[(9 * len(width)) // 10])
        parts += [path([(X(0.1), line), (X(1e-12), line)], RED, 2.5), text(X(1e-12), line - 6, "zwang.gradient, proven, nine in ten", 12, RED, "end")]
    return parts + [text(X(1e-12), 286, "step, or smoothing, relative", 12, MUTED, "end")]


def bench(out, scenes, laws, seed, say):
    """./zwang bench --gradients: gradients.csv and gradients.svg in the folder `out`; what is said goes to say()."""
    import csv
    found, kinks, asked = [], 0, list(problems(scenes, laws, seed))
    if (out / "gradients.csv").exists():
        raise ValueError(f"{out / 'gradients.csv'} is there already: choose another --out")
    out.mkdir(parents=True, exist_ok=True)
    with open(out / "gradients.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(("problem", "law", "seed", "kink", "reach", "enclosure", "made by", "amount", "error", "note"))
        for number, (p, k) in enumerate(asked, 1):
            row = compare(p, STEPS, STEPS, k)
            kept = row["width"] >= 0 and not row["kink"]
            kinks += bool(row["kink"])
            head = (row["problem"], row["law"], k, " ".join(map(str, row["kink"])), row["reach"], row["width"])
            for kind in ("differences", "soft") if kept else ():
                table.writerows((*head, kind, h, error, "") for h, error in row[kind].items())
            if not kept:
                table.writerow((*head, "", "", "", row["note"]))
            file.flush()
            found += [row] if kept else []
            say(f"{number} of {len(asked)}  {row['problem']}, {row['law']}: " + ("kink" if row["kink"] else row["note"] or f"within {row['width']:.0e}"))
    (out / "gradients.svg").write_text(svg(490, chart(found, 10)), encoding="utf-8")
    return found, kinks
