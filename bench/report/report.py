"""`./zwang report`: the page of a run, the comparison of two, figures and tables for print. docs/report.md.

The program holds this text and runs it: main(PROGRAM, WORDS...). It fills the pages and draws the figures.
"""
import argparse
import json
import math
import os
import shlex
import shutil
import signal
import subprocess

from aggregation import HEADLINE, LEVELS, STABILITY, accuracy_headline, accuracy_matched
from charts import chart_rows
from results import BAD_FILE, BLANK, RIGHT, WRONG_USE, BadFile, by_class, counted, fail, merged, read_run
from tables import class_tables, common_tables, comparison_table, speed_change_table

MOST_ROWS = 2000  # of a table on a page
SHOWN = 8         # solvers that charts draw until a reader chooses
RUNS_OF_SCRIPT = 5000  # consecutive problems share a script, up to so many runs: 1 MB or so, read in a few milliseconds
CHARTS = ("work-precision", "families", "profile", "data-profile", "convergence-iteration", "convergence-time", "scaling", "speed-ratios",
          "speed-exponents", "sweep", "range-gap", "stages")
INCHES = {"in": 1, "cm": 1 / 2.54, "mm": 1 / 25.4, "pt": 1 / 72.27}


# What a page says of its run as a whole.

def handed_over(run):
    parts = [f"{asked} to {answered} on {counted(len(problems), 'problem')}" for (asked, answered), problems in sorted(run.handed_over.items())]
    return [f"Handed over, and counted for the solver that answered alone: {', '.join(parts)}."] if parts else []


def headline(run):
    """Sentences, most important first."""
    if not run.results:
        return ["The run holds no results yet."]
    kinds = {**dict.fromkeys(RIGHT, "right"), "near": "near", "wrong": "wrong", "consistent": "consistent",
             "rows off": "right for rows that are off", **dict.fromkeys(("undecided", "infeasible, claimed only"), "undecided"),
             **dict.fromkeys(BLANK, "not applicable")}
    found = {kind: 0 for kind in ("right", "near", "wrong", "consistent", "right for rows that are off", "undecided", "without an answer",
                                  "not applicable")}
    for r in run.results:
        found[kinds.get(r.verified, "without an answer")] += 1
    lies = sum(r.lies for r in run.results)
    counts = ", ".join(f"{n:,} {kind}" for kind, n in found.items() if n or kind == "right")
    lines = [f"{counted(len(run.results), 'run')} of {counted(len(run.solvers), 'solver')} on "
             f"{counted(len({r.problem for r in run.results}), 'problem')}: {counts}.{' ' if run.torn else ''}{run.torn}"]
    if lies:
        lines.append(f"{counted(lies, 'run')} claimed an answer and {'was' if lies == 1 else 'were'} wrong: see the table of false claims.")
    else:
        lines.append("No run claimed success, or infeasibility, where the referee found the opposite.")
    lines += handed_over(run)
    if run.recorded:
        lines.append(f"{counted(len(run.recorded), 'recorded answer')} judged beside the runs, {sum(r.is_right for r in run.recorded)} right.")
    return lines


def notes(run):
    """What a reader must know to compare fairly, beside the run's own notes."""
    def any_of(part):
        return any(part in name for name in run.names())

    return run.notes + [note for holds, note in (
        (run.is_large, "A run of this size is drawn by its medians; of runs drawn alone at most 20 of a family, solver and kind are shown. "
                       "Counts, tables and profiles are of all runs; single ones are below."),
        (any_of("slsqp") and any_of("nnls"), "NLopt's SLSQP contains the Lawson-Hanson NNLS kernel: nnls against SLSQP is in part one method "
                                             "against itself."),
        (True, "Times are thread CPU times; BLAS runs on one thread."),
        (any_of("cholesky"), "CHOLMOD's modify and supernodal modules are under the GPL."),
        (any("CGAL" in r.reference for r in run.results), "CGAL's QP solver, a witness of references, is under the GPL.")) if holds]


def opening(run):
    """The section whose picture answers the question of the run's suite."""
    families = run.families()
    atlas = families and all(family in STABILITY for family in families)
    return "speed-ratios" if run.is_of_speed else "break-points" if atlas else "work-precision"


def page_text(run):
    about = []
    for name, value in run.conditions:
        if name in ("commit", "seed"):
            about.append(f"{name} {value[:12] if name == 'commit' else value}")
        elif name in ("compiler", "CPU"):
            about.append(value)
    title = f"zwang: {run.title}" if run.title else f"zwang: {run.suite} suite" if run.suite else "zwang report"
    return {"title": title, "headline": headline(run), "opening": opening(run), "circumstances": ", ".join(about), "notes": notes(run),
            "solvers": run.solvers, "tables": common_tables(run)}


def shown_by_default(run):
    """The solvers that charts show until a reader chooses, best first: those that reach the headline's error on most problems of the class,
    the fastest of those first; then the others. Both versions of a solver stay together."""
    style_of = {s.name: s.style or s.name for s in run.solvers}
    versions, shown = {}, []
    for name, style in style_of.items():
        versions.setdefault(style, []).append(name)
    for name in [*(entry.solver for entry in accuracy_matched(run, "", HEADLINE)), *run.names()]:
        of_style = versions.pop(style_of.get(name), [])
        if len(shown) + len(of_style) <= SHOWN:
            shown += of_style
    return shown


def page_data(text, classes, single=None, most_rows=MOST_ROWS):
    """Everything the page and the figures draw. `single`: the index of single_run_scripts()."""
    def to_json(tables):
        return {table.id: table.to_json(most_rows) for table in tables}

    parts = []
    for run in classes:
        ranking = accuracy_headline(run)
        parts.append({"name": run.problem_class, "ranking": ranking and ranking + ".", "families": run.families(), "solvers": run.names(),
                      "shown": shown_by_default(run), "tables": to_json(class_tables(run)), "charts": chart_rows(run)})
    shown = {name for part in parts for name in part["shown"]}
    solvers = [{"name": s.name, "method": s.method, "style": s.style or s.name, "second": s.second, "exact": s.exact, "shown": s.name in shown}
               for s in text["solvers"]]
    about = {**text, "solvers": solvers, "levels": LEVELS, "tables": to_json(text["tables"]), "classes": parts}
    return {**about, "single": single} if single else about


def dump(data):
    return json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


def single_run_scripts(run):
    """The runs of a large run one by one, for scripts beside the page, which may load a script, but not fetch data: their texts,
    zwang_runs(0, {"problem": [row, ...], ...}), and {"family": [["problem", script], ...], ...}."""
    scripts, index, rows, count = [], {}, {}, 0

    def finish():
        if rows:
            scripts.append(f"zwang_runs({len(scripts)},{dump(rows)});\n")
        rows.clear()

    def number(x):
        return x if math.isfinite(x) else None

    for group in run.groups:
        runs = sum(map(len, group.by_solver.values()))
        if count and count + runs > RUNS_OF_SCRIPT:
            finish()
            count = 0
        rows[group.problem] = [[r.solver, number(r.tolerance), r.claimed, r.verified, number(r.error), number(r.solve_s), r.iterations,
                                run.replay_of(r)] for results in group.by_solver.values() for r in results]
        index.setdefault(group.family, []).append([group.problem, len(scripts)])
        count += runs
    finish()
    return scripts, index


# Files.

def write(file, text):
    """In one step: who reads the old file has all of it."""
    os.makedirs(os.path.dirname(file) or ".", exist_ok=True)
    try:
        with open(file + ".new", "wb") as out:
            out.write(text if isinstance(text, bytes) else text.encode(errors="replace"))
        os.replace(file + ".new", file)
    except OSError as broken:
        if os.path.exists(file + ".new"):
            os.remove(file + ".new")
        raise BadFile(f"{file}: {broken.strerror}") from None


class Pages:
    """What the program holds: pages with a slot for their data, and the scripts that draw for print."""

    def __init__(self, program):
        self.program = program

    def ask(self, *words, data=b""):
        answer = subprocess.run([self.program, "report", *words], input=data, stdout=subprocess.PIPE)
        if answer.returncode:
            raise SystemExit(answer.returncode)
        return answer.stdout

    def filled(self, kind, data):
        return self.ask(":page", kind, data=dump(data).encode(errors="replace"))

    def report(self, directory):
        """DIR/report.html: one file that opens offline. Of a suite's results or, where they are there, of collision.json. And the run."""
        file, collision, run = os.path.join(directory, "report.html"), os.path.join(directory, "collision.json"), None
        if os.path.exists(collision):
            try:
                with open(collision, encoding="utf-8") as text:
                    page = self.filled("collision", json.load(text))
            except (ValueError, RecursionError):
                raise BadFile(f"{collision}: not the results of a collision run") from None
        else:
            run = read_run(directory)
            shutil.rmtree(os.path.join(directory, "runs"), ignore_errors=True)
            scripts, index = single_run_scripts(run) if run.is_large else ((), None)
            for k, script in enumerate(scripts):
                write(os.path.join(directory, "runs", f"{k}.js"), script)
            page = self.filled("large" if scripts else "run", page_data(page_text(run), by_class(run), index))
        write(file, page)
        return file, run

    def comparison(self, first, second, out):
        """Two runs side by side: two commits, or a solver added to stored results. A solver that both runs hold appears twice, as "name @A"
        and "name @B"; problems are the same where their contents are."""
        a, b = read_run(first), read_run(second)
        both = merged(a, b)
        text = page_text(both)
        text["title"] = f"zwang: {a.label} against {b.label}"
        text["headline"][0] = f"Run A is {a.label}, run B is {b.label}. {text['headline'][0]}"
        text["tables"].append(comparison_table(a, b))
        if a.is_of_speed and b.is_of_speed:
            text["tables"].append(speed_change_table(a, b))
        write(out, self.filled("run", page_data(text, by_class(both))))

    def figures(self, directory, asked):
        """DIR/figures/*.svg and *.pdf, to each its caption as *.txt; DIR/tables/*.tex and *.csv: only these charts, solvers and families.
        Empty: all charts and families, and the six best solvers of each class of problems. Returns the files written."""
        require_known("figure format", asked["formats"], ("svg", "pdf"))
        require_known("chart", asked["charts"], CHARTS)
        run = read_run(directory)
        require_known("solver", asked["solvers"], list(dict.fromkeys(r.solver for r in run.results)))
        require_known("family", asked["families"], run.families())
        figures, tables = os.path.join(directory, "figures"), os.path.join(directory, "tables")
        os.makedirs(tables, exist_ok=True)
        data = os.path.join(figures, "data.json")
        write(data, dump({"print": asked, "page": page_data(page_text(run), by_class(run), most_rows=None)}))
        try:
            self.ask(":draw", data, figures, tables)
        finally:
            os.remove(data)
        return sorted(os.path.join(folder, name) for folder in (figures, tables) for name in os.listdir(folder))


# Names and words.

def edit_distance(a, b):
    """Levenshtein's, two neighbours in the wrong order counted once."""
    before, row = [], list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        last, before, row = before, row, [i]
        for j, y in enumerate(b, 1):
            row.append(min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (x != y)))
            if i > 1 and j > 1 and x == b[j - 2] and a[i - 2] == y:
                row[j] = min(row[j], last[j - 2] + 1)
    return row[-1]


def require_known(what, names, known):
    for name in names:
        if name not in known:
            nearest = min(known, key=lambda other: edit_distance(name, other), default="")
            # Two slips; in a short word one, or anything would be near it.
            near = known and edit_distance(name, nearest) <= min(max(len(name) // 3, 1), 2)
            hint = f"; did you mean '{nearest}'?" if near else ""
            fail(f"no {what} '{name}'{hint} ({', '.join(known)})", WRONG_USE)


def split_solvers(text):
    """ "a,b:key=value,key=value" -> a | b:key=value,key=value."""
    names = []
    for part in text.split(","):
        if "=" in part and ":" not in part and names:
            names[-1] += "," + part
        else:
            names.append(part)
    return names


def inches(text):
    """3.4in, 86mm, 8.6cm, 245pt."""
    try:
        length = float(text[:-2]) * INCHES[text[-2:]]
    except (ValueError, KeyError):
        length = 0
    if not 1.5 <= length <= 20:
        fail(f"--width {text} should be a length from 1.5in to 20in, such as 3.4in, 86mm or 245pt", WRONG_USE)
    return length


class Options(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message.removeprefix('argument ')} (./zwang report --help)", WRONG_USE)


def asked_for(words):
    options = Options(
        prog="./zwang report", usage="./zwang report DIR [DIR] [OPTIONS]", allow_abbrev=False,
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, max_help_position=34, width=100),
        description="Charts of stored results: DIR/report.html, files for a paper, or two runs side by side.",
        epilog="""Examples:
  ./zwang report results/20261120-2354
  ./zwang report results/20261120-2354 --figures svg,pdf   DIR/figures/*, DIR/tables/*
  ./zwang report results/20261120-2354 --figures pdf --chart work-precision --families hand \\
                 --solvers nnls,dual_active_set --width 3.4in
  ./zwang report before after --out compared.html""")
    listed = {"type": lambda text: text.split(","), "action": "extend", "default": [], "metavar": "a,b,..."}
    options.add_argument("DIR", nargs="+", help="a run's folder, or two to compare")
    options.add_argument("--out", metavar="FILE", help="the page that compares two runs; default: comparison.html")
    options.add_argument("--figures", **{**listed, "metavar": "svg,pdf"}, help="svg, pdf or svg,pdf: charts as files with their captions, tables")
    options.add_argument("--chart", **listed, help="only these: work-precision, profile, ...; default: all")
    options.add_argument("--solvers", **{**listed, "type": split_solvers}, help="the figures' lines; default: the six best of each class")
    options.add_argument("--families", **listed, help="only figures of these; default: all")
    options.add_argument("--width", default=0, type=inches, metavar="LENGTH",
                         help="of a figure: 3.4in, 86mm, 245pt; type is 8 pt at any width")
    asked = options.parse_args(words)
    if len(asked.DIR) > 2:
        options.error("DIR: a run's folder, or two to compare")
    for name in ("chart", "solvers", "families", "width"):
        if getattr(asked, name) and not asked.figures:
            options.error(f"--{name} needs --figures")
    if len(asked.DIR) == 1 and asked.out:
        options.error("--out is for two runs; the page of one stands in its folder")
    if len(asked.DIR) == 2 and asked.figures:
        fail("--figures draws one run, not two", WRONG_USE)
    if asked.out and os.path.isdir(asked.out):
        fail(f"--out {asked.out} is a folder; expected the page's file, as in {os.path.join(asked.out, 'comparison.html')}", WRONG_USE)
    asked.out = asked.out or "comparison.html"
    return asked


def run_words(pages, words):
    """`:so-far DIR`: of a run that goes on; a page that cannot be written is no reason to end it. `:end DIR`: of one that has ended, whose
    rankings are printed, too."""
    if words[:1] == [":so-far"]:
        pages.report(words[1])
    elif words[:1] == [":end"]:
        try:
            file, run = pages.report(words[1])
        except BadFile as broken:
            raise BadFile(f"No report: {broken} (the results are kept; again with: ./zwang report {shlex.quote(words[1])})") from None
        for line in filter(None, map(accuracy_headline, by_class(run))):
            print(line)
        print(f"Report: {file}")
    else:
        asked = asked_for(words)
        if len(asked.DIR) == 2:
            pages.comparison(*asked.DIR, asked.out)
            print(f"Report: {asked.out}")
            return
        chosen = {"formats": asked.figures, "charts": asked.chart, "solvers": asked.solvers, "families": asked.families, "width": asked.width}
        files = pages.figures(asked.DIR[0], chosen) if asked.figures else []
        print("\n".join([f"Report: {pages.report(asked.DIR[0])[0]}", *files]))


def main(program, *words):
    signal.signal(signal.SIGINT, signal.SIG_IGN if words[:1] == (":so-far",) else signal.SIG_DFL)
    try:
        run_words(Pages(program), list(words))
    except BadFile as broken:
        fail(str(broken))
    except OSError as broken:
        if not broken.filename:  # what is printed: held.py's
            raise
        fail(f"{broken.filename}: {broken.strerror}")
    except (ArithmeticError, ValueError, TypeError) as odd:
        fail(f"{words[-1]}: holds what zwang does not write ({odd})", BAD_FILE)
