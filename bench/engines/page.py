"""The page of the engines: one map, a section a phenomenon, the makers' replies. One file, which opens offline."""
from fractions import Fraction as F
from html import escape
import colorsys
import math

import phenomena
from exact import Clock

STYLE = """
table.map { border-collapse: separate; border-spacing: 1px; }
.map th { cursor: default; border: 0; }
.map thead th + th { writing-mode: vertical-rl; transform: rotate(180deg); padding: 4px 2px; font-weight: 400; white-space: nowrap; }
.map tbody th { position: sticky; left: 0; background: var(--card); font-weight: 400; max-width: 190px; padding: 1px 4px 1px 0; }
.map tbody th a { color: inherit; }
.map td { padding: 0; border: 0; text-align: right; white-space: nowrap; font-size: 12px; min-width: 40px; }
.map [data-setting=default] { border-left: 3px solid transparent; }
.map td > span { display: none; padding: 2px 3px; }
.at0 .s0, .at1 .s1, .at2 .s2, .at3 .s3 { display: block !important; }
.none { color: var(--muted); background: repeating-linear-gradient(-45deg, transparent 0 4px, var(--line) 4px 5px); }
.shades span { display: inline-block; padding: 0 7px; border: 1px solid var(--line); border-radius: 4px; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 330px), 1fr)); gap: 10px; margin: 6px 0; }
.pictures svg { width: 100%; height: auto; max-height: 260px; }
svg .start { fill: none; stroke: var(--muted); } svg .best { fill: none; stroke: #2f7ed8; } svg .worst { fill: none; stroke: var(--wrong); }
svg .way { stroke-width: 0.8; stroke-dasharray: 2 2; vector-effect: non-scaling-stroke; } svg .ground { stroke: var(--ink); stroke-width: 1.5; } svg .axis { stroke: var(--line); fill: none; } svg text { fill: var(--muted); font-size: 11px; }
svg .curve { fill: none; stroke-width: 1.3; } svg .tuned { stroke-dasharray: 4 3; } svg .due { fill: var(--ink); } svg :is(.start, .best, .worst) { vector-effect: non-scaling-stroke; }
pre { white-space: pre-wrap; margin: 2px 0 8px; }
.cells td { white-space: nowrap; } .cells td.none { white-space: normal; min-width: 110px; }
.scroll table { max-width: none; }
.key span { white-space: nowrap; }
@media (max-width: 700px) { .map tbody th { white-space: normal; min-width: 116px; max-width: 116px; } }
"""

SCRIPT = """
const map = document.querySelector('.map');
document.getElementById('step').onchange = event => { map.className = `map at${event.target.value}`; };
document.getElementById('setting').onchange = event => {
  for (const cell of document.querySelectorAll('[data-setting]')) cell.hidden = event.target.value !== 'both' && cell.dataset.setting !== event.target.value;
};
const dark = on => { document.documentElement.dataset.theme = on ? 'dark' : 'light'; theme.textContent = on ? 'light' : 'dark'; };
const theme = document.getElementById('theme');
theme.onclick = () => dark(document.documentElement.dataset.theme !== 'dark');
dark(matchMedia('(prefers-color-scheme: dark)').matches);
"""

SHADES = [("good", "less than 1/1000 of the mark", 1e-3), ("", "less than 1/10", 0.1), ("warn", "less than the mark", 1), ("bad", "beyond it", math.inf)]


def number(x):
    return "0" if x == 0 else f"{x:.2g}" if 1e-3 <= abs(x) < 1000 else f"{x:.0e}".replace("e-0", "e-")


def shade(cell, mark):
    if "off" not in cell:
        return "none"
    return next(name for name, _, below in SHADES if abs(cell["off"]) < below * mark)


def columns(numbers):
    return [(engine, setting) for engine, settings in numbers["cells"].items() for setting in settings]


def map_of(numbers, chosen):
    head = "".join(f'<th data-setting="{setting}">{escape(engine)} {setting}</th>' for engine, setting in columns(numbers))
    lines = []
    for p in chosen:
        cells = []
        for engine, setting in columns(numbers):
            spans = []
            for k, cell in enumerate(numbers["cells"][engine][setting][p.name].values()):
                text, title = (number(cell["off"]), f"{cell['off']:.17g} {p.unit}") if "off" in cell else ("–", cell["why"])
                spans.append(f'<span class="s{k} {shade(cell, p.mark)}" title="{escape(title)}">{text}</span>')
            cells.append(f'<td data-setting="{setting}">{"".join(spans)}</td>')
        lines.append(f'<tr><th><a href="#{p.name}">{escape(p.title)}</a>, {p.unit}</th>{"".join(cells)}</tr>')
    return f'<div class="scroll"><table class="map at2"><thead><tr><th></th>{head}</tr></thead><tbody>{"".join(lines)}</tbody></table></div>'


# ---- Pictures -----------------------------------------------------------------------------------------------------------------------------------

def outline(b, pose, across, up):
    """Points and circles of a body in a view: [(x, y, radius)], and polygons."""
    circles, polygons = [], []
    at, turn = pose[:3], pose[3:7]
    for s in b["shapes"]:
        middle = phenomena.plus(at, phenomena.turned(turn, [float(x) for x in s["at"]]))
        if s["kind"] == "sphere":
            circles.append((middle[across], middle[up], float(s["radius"])))
        elif s["kind"] == "box":
            h = [float(x) for x in s["half"]]
            corners = [phenomena.plus(middle, phenomena.turned(turn, [i * h[0], j * h[1], k * h[2]])) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]
            polygons.append(hull([(c[across], c[up]) for c in corners]))
    if len(circles) > 1:
        polygons += [[(at[across], at[up]), (x, y)] for x, y, _ in circles]
    return circles, polygons


def hull(points):
    def half(ordered):
        chain = []
        for p in ordered:
            while len(chain) > 1 and (chain[-1][0] - chain[-2][0]) * (p[1] - chain[-2][1]) <= (chain[-1][1] - chain[-2][1]) * (p[0] - chain[-2][0]):
                chain.pop()
            chain.append(p)
        return chain[:-1]
    points = sorted({(round(x, 5), round(y, 5)) for x, y in points})
    return half(points) + half(points[::-1])


def sketch(p, motions, cells):
    """The scene at its start, and at its end in the engines that come nearest and farthest."""
    across, up = (0, 1) if p.view == "xy" else (0, 2)
    ranked = sorted((abs(cells[e][s][p.name]["1/60"]["off"]), f"{e} {s}") for e in cells for s in cells[e]
                    if "off" in cells[e][s][p.name]["1/60"] and motions.get(f"{e} {s}"))
    if not ranked:
        return ""
    ends = {"best": ranked[0][1], "worst": ranked[-1][1]}
    poses = {"start": motions[ends["best"]]["poses"][0], **{kind: motions[name]["poses"][-1] for kind, name in ends.items()}}
    drawn, seen = [], []
    for kind in ("worst", "best", "start"):
        for place, (b, pose) in enumerate(zip(p.scene["bodies"], poses[kind])):
            if b["shapes"][0]["kind"] == "plane" or (b["motion"] == "fixed" and kind != "start"):
                continue
            if kind != "start":
                way = " ".join(f"{x[across]:.4g},{-x[up]:.4g}" for x in motions[ends[kind]]["ways"][place])
                drawn.append(f'<polyline class="{kind} way" points="{way}"/>')
                seen += [(x[across], x[up]) for x in motions[ends["best"]]["ways"][place]]
            circles, polygons = outline(b, pose, across, up)
            drawn += [f'<circle class="{kind}" cx="{x:.4g}" cy="{-y:.4g}" r="{r:.4g}"/>' for x, y, r in circles]
            drawn += [f'<polygon class="{kind}" points="{" ".join(f"{x:.4g},{-y:.4g}" for x, y in polygon)}"/>' for polygon in polygons]
            if kind != "worst":
                seen += [(x + i * r, y + i * r) for x, y, r in circles for i in (-1, 1)] + [point for polygon in polygons for point in polygon]
    low = [min(s[i] for s in seen) for i in (0, 1)]
    size = [max(max(s[i] for s in seen) - low[i], 0.3) for i in (0, 1)]
    margin = 0.12 * max(size)
    left, top, width, height = low[0] - margin, -low[1] - size[1] - margin, size[0] + 2 * margin, size[1] + 2 * margin
    for b in p.scene["bodies"]:
        if b["shapes"][0]["kind"] != "plane":
            continue
        normal = phenomena.turned([float(x) for x in b["turn"]], [0, 0, 1])
        x, y, far = float(b["at"][across]), -float(b["at"][up]), 50
        if abs(normal[across]) + abs(normal[up]) > 0.5:
            drawn.append(f'<line class="ground" vector-effect="non-scaling-stroke" x1="{x - far * normal[up]:.4g}" y1="{y - far * normal[across]:.4g}" '
                         f'x2="{x + far * normal[up]:.4g}" y2="{y + far * normal[across]:.4g}"/>')
    names = f"Grey: the start; blue: the way and the end by {ends['best']}, the nearest; red: by {ends['worst']}, the farthest"
    return (f'<div><svg viewBox="{left:.4g} {top:.4g} {width:.4g} {height:.4g}" role="img" aria-label="{escape(p.title)}">'
            f'<g stroke-width="1.4">{"".join(drawn)}</g></svg><p class="how">{escape(names)}</p></div>')


def curves(p, motions, names):
    """How what is measured comes about, of every engine, in the largest step; the exact answer is the dot at the end."""
    due = float(p.exact(Clock(F(1, 60))))
    shown = [(name, m["curve"]) for name, m in motions.items() if m]
    if not shown:
        return ""
    # As high as the curve of whoever comes nearest, and the mark around it.
    nearest = min((c for _, c in shown), key=lambda c: abs(c[-1] - due))
    low, high = min(*nearest, due - p.mark), max(*nearest, due + p.mark)
    spread = high - low
    width, height = 330, 190

    def place(k, n, y):
        return f"{8 + k / max(1, n - 1) * (width - 70):.1f},{height - 22 - (min(max(y, low - spread / 20), high + spread / 20) - low) / spread * (height - 40):.1f}"
    lines = []
    for name, c in shown:
        engine, setting = name.rsplit(" ", 1)
        points = " ".join(place(k, len(c), y) for k, y in enumerate(c))
        lines.append(f'<polyline class="curve {setting}" stroke="{colour(names.index(engine), len(names))}" points="{points}"><title>{escape(name)}</title></polyline>')
    x, y = place(1, 2, due).split(",")
    return (f'<div><svg viewBox="0 0 {width} {height}" role="img" aria-label="{escape(p.title)}: what is measured over time">'
            f'<path class="axis" d="M8 {height - 18}H{width - 60}"/>{"".join(lines)}<circle class="due" cx="{x}" cy="{y}" r="3"/>'
            f'<text x="{float(x) + 5}" y="{float(y) + 4}">{due:.4g} {p.unit}</text><text x="8" y="{height - 4}">0 s</text>'
            f'<text x="{width - 62}" y="{height - 4}" text-anchor="end">{float(p.seconds):g} s</text></svg>'
            f'<p class="how">What is measured, over time, in steps of 1/60 s; dashed: tuned; the dot is exact. <span class="key">{key(names)}</span></p></div>')


def swatch(k, n):
    return f'<svg width="22" height="8"><path d="M0 4H22" stroke="{colour(k, n)}" stroke-width="3"/></svg>'


def key(names):
    return "".join(f"<span>{swatch(k, len(names))}{escape(name)}</span>" for k, name in enumerate(names))


def colour(k, n):
    return "#" + "".join(f"{round(255 * c):02x}" for c in colorsys.hls_to_rgb(k / n, 0.5, 0.65))


def section(p, numbers, motions):
    steps = numbers["steps"]
    head = "".join(f'<th class="number">{step} s</th>' for step in steps)
    lines = []
    for engine, setting in columns(numbers):
        cells = numbers["cells"][engine][setting][p.name]
        row = "".join(f'<td class="number {shade(cells[s], p.mark)}">{number(cells[s]["off"]) if "off" in cells[s] else escape(cells[s]["why"])}</td>' for s in steps)
        lines.append(f'<tr data-setting="{setting}"><td>{escape(engine)}</td><td>{setting}</td>{row}</tr>')
    due = ", ".join(f"{float(p.exact(Clock(F(s)))):.6g}" for s in steps)
    same = len({p.exact(Clock(F(s))) for s in steps}) == 1
    exact = f"{float(p.exact(Clock(F(1, 60)))):.6g} {p.unit} in every step" if same else (
        f"{due} {p.unit} in these steps for a semi-implicit integrator; in continuous time {float(p.exact(Clock(F(0), 0))):.6g} {p.unit}")
    names = list(numbers["cells"])
    return (f'<section id="{p.name}"><h2>{escape(p.title)}</h2><p>{escape(p.what)}</p><p class="how">Exact: {exact}. The mark: {p.mark:g} {p.unit}.</p>'
            f'<div class="pictures">{sketch(p, motions, numbers["cells"])}{curves(p, motions, names)}</div>'
            f'<details><summary>Off by, in {p.unit}, of every engine</summary><div class="scroll"><table class="cells"><thead><tr><th>engine</th><th>setting</th>{head}</tr></thead>'
            f'<tbody>{"".join(lines)}</tbody></table></div></details>'
            f'<p><code>./zwang conformance --engines NAME --phenomena {p.name}</code></p></section>')


def makers(numbers, here):
    orders = {1: "semi-implicit", -1: "explicit", 0: "as in continuous time"}
    parts = []
    for k, (engine, about) in enumerate(numbers["engines"].items()):
        said = "no adapter answered" if not about else (
            f"version {about['version']}, licence {about['licence']}, {about['bits']} bits, {orders[about['order']]}"
            + "".join(f", {n} steps of its own in one ({s})" for s, n in about["substeps"].items() if n != 1))
        reply = here / f"replies/{engine}.txt"
        text = reply.read_text().strip() if reply.exists() else ""
        parts.append(f'<h3>{swatch(k, len(numbers["engines"]))} {escape(engine)}</h3>'
                     f'<p class="how">{escape(said)}</p><pre>{escape(text) or "No reply yet."}</pre>')
    absent = "".join(f"<li>{escape(name)}: <code>{escape(how)}</code></li>" for name, how in numbers["absent"].items())
    return "".join(parts) + (f"<h3>Not here</h3><ul>{absent}</ul>" if absent else "")


def html(numbers, motions, chosen, here, root):
    count, all_cells = len(numbers["cells"]), [c for s in numbers["cells"].values() for of in s.values() for cells in of.values() for c in cells.values()]
    silent = sum("off" not in c for c in all_cells)
    twice = "" if numbers["differ"] is None else (
        "Run twice: the same numbers to the bit." if not numbers["differ"] else "Not the same numbers twice: " + ", ".join(numbers["differ"]) + ".")
    shades = " ".join(f'<span class="{name}">{text}</span>' for name, text, _ in SHADES)
    steps = "".join(f'<option value="{k}"{" selected" if k == 2 else ""}>{step} s</option>' for k, step in enumerate(numbers["steps"]))
    body = f"""<header><div class="bar"><h1>zwang engines</h1><nav><a href="#map">Map</a><a href="#phenomena">Phenomena</a><a href="#makers">Makers</a></nav><button id="theme">dark</button></div></header>
<main>
<section class="summary"><p>{count} engines, {len(chosen)} phenomena, {len(numbers["steps"])} steps: what each engine is off by.</p>
<p class="how">{silent} of {len(all_cells)} cells have no answer. {escape(twice)}</p></section>
<section id="map"><h2>The map</h2>
<p class="how">Each number is what was measured less what is exact, in the unit that stands at the left. Exact is Coulomb's law with rigid bodies in the same discrete time: an engine is charged
nothing for the integrator that it states. The mark of a phenomenon is what nobody would call right; it colours cells and is not a verdict.</p>
<p class="controls"><label>Step <select id="step">{steps}</select></label>
<label>Setting <select id="setting"><option value="both">both</option><option>default</option><option>tuned</option></select></label>
<span class="shades">{shades} <span class="none">no answer</span></span></p>
{map_of(numbers, chosen)}</section>
<div id="phenomena"></div>
{"".join(section(p, numbers, motions[p.name]) for p in chosen)}
<section id="makers"><h2>The engines, and their makers' right of reply</h2>
<p class="how">Whoever makes an engine may answer here, in their own words (bench/engines/replies), which nobody else edits.</p>{makers(numbers, here)}</section>
</main>"""
    style = (root / "bench/report/page/page.css").read_text() + STYLE
    return ('<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>zwang engines</title>'
            f"<style>{style}</style></head><body>{body}<script>{SCRIPT}</script></body></html>\n")
