"""The picture of a comparison: what became of each solver's runs, by the rank of W. One SVG, for light and dark pages."""
from html import escape

# Of a problem's two runs, and the colour: the first that holds.
KINDS = (("called solved, wrong", "#c0392b"), ("right at 1e-8", "#2e8b57"), ("right at 1e-4 alone", "#a6d4b4"), ("at a limit", "#e3b04b"), ("undecided", "#b9c4d0"),
         ("no answer, crash", "#6b7785"))
ROW, BAR, LEFT, WIDE, TOP = 22, 14, 170, 250, 64


def kind(study, solver, name, loose, tight):
    """Which of KINDS a problem is for a solver; None where it was not tried."""
    rows = [row for t in (tight, loose) if (row := study.row(solver, t, name)) and row["claimed"] != "unsupported"]
    if not rows:
        return None
    if any(row["claimed"] == "solved" and row["verified"] == "wrong" for row in rows):
        return 0
    for row in rows:
        if study.right(row):
            return 1 if row["tolerance"] == tight else 2
    return 3 if rows[0]["claimed"] in ("time limit", "iteration limit") else 4 if rows[0]["claimed"] == "solved" else 5


def svg(study, loose, tight, groups):
    """`groups`: (title, names of problems) a column."""
    columns = [(title, names) for title, names in groups if names]
    solvers = [s for s in study.solvers if any(kind(study, s, name, loose, tight) is not None for _, names in columns for name in names)]
    height, width = TOP + ROW * len(solvers) + 14, max(LEFT + len(columns) * (WIDE + 60), 740)
    parts, x = [], 10
    for what, colour in KINDS:
        parts.append(f'<rect x="{x}" y="8" width="12" height="12" fill="{colour}"/><text x="{x + 16}" y="18">{what}</text>')
        x += 28 + 6.4 * len(what)
    for k, solver in enumerate(solvers):
        parts.append(f'<text x="{LEFT - 8}" y="{TOP + ROW * k + 12}" text-anchor="end">{escape(solver)}</text>')
    for column, (title, names) in enumerate(columns):
        left = LEFT + column * (WIDE + 60)
        parts.append(f'<text x="{left}" y="{TOP - 12}" font-weight="600">{escape(title)}: {len(names)} problems</text>')
        for k, solver in enumerate(solvers):
            kinds = [kind(study, solver, name, loose, tight) for name in names]
            x, y = left, TOP + ROW * k
            for which, (what, colour) in enumerate(KINDS):
                if count := kinds.count(which):
                    size = WIDE * count / len(names)
                    parts.append(f'<rect x="{x:.1f}" y="{y}" width="{size:.1f}" height="{BAR}" fill="{colour}"><title>{escape(solver)}: {count} {what}</title></rect>')
                    x += size
            right = kinds.count(1)
            parts.append(f'<text x="{x + 5:.1f}" y="{y + 12}" class="small">{f"{right} of {len(names) - kinds.count(None)}" if x > left else "not tried"}</text>')
    style = "text{font:12px sans-serif;fill:#1f2933}.small{font-size:11px;fill:#6b7785}@media(prefers-color-scheme:dark){text{fill:#e4e7eb}.small{fill:#9aa5b1}}"
    return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}">'
            f'<style>{style}</style>{"".join(parts)}</svg>\n')
