#!/usr/bin/python3
"""Runs the examples of a page: examples.py PROGRAM PYTHONPATH|- PAGE.md...

```console    Lines that begin with "$ " are commands, run in one scratch folder a page, where ./zwang is PROGRAM. The lines
              after each are what it prints; none: not looked at.
```python     Run one after another, in one interpreter a page, with the module of PYTHONPATH; a ```text block right after it
              is what it prints. "-": left out.
```cpp        Is a file below docs/examples, or a part of one; the first blocks of the guides are compiled (docs/CMakeLists.txt).
    ./zwang   Indented lines, and the same in `backquotes`: every one is run, on first.h5 (a problem) and the runs DIR,
              RUN_A and RUN_B, as `shorter` below has it.

A comment `<!-- not run: why -->` on the line before a block leaves it out; after `<!-- begun: why -->` its command is
interrupted once it has printed a line, which is compared, and with it the number of runs.
Printed text is compared loosely: "..." stands for anything, a line "..." for any lines, a time for any time, "(8.2x)" for any
ratio, rounding noise for any rounding noise.
"""
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

few = "--scenes 'tower(boxes=2)' --solvers nnls --tolerances 1e-6"
# How a line is run that would take long, or names what is not there. None: it takes minutes, or is a test of its own.
shorter = [
    ("./zwang bench", None), ("./zwang test.*", None), ("./zwang docs", None), ("./zwang python", None),
    (r"./zwang bench --suite (quick|speed|atlas|collision)", None), (r"./zwang bench --gradients", r"./zwang bench --gradients --scenes ball --out G"),
    (r"(./zwang bench --suite atlas --families) .*", r"\1 PIVOT --solvers dual_active_set,cholesky --out atlas"),
    (r"./zwang campaign \w+ --engine slurm .*--out (\w+)", rf"./zwang campaign {few} --engine local --tasks 2 --out campaign_\1"),
    (r"./zwang campaign --resume (\w+)", r"./zwang campaign --resume campaign_\1"), (r"./zwang (campaign|merge)", r"./zwang \1 --help"),
    (r"./zwang bench --suite full --shard 3/64 --out parts/3",
     rf"for k in 0 1; do ./zwang bench {few} --shard $k/2 --out parts/$((k + 3)); done"),
    (r"./zwang merge PART... --out DIR",
     rf"for k in 0 1; do ./zwang bench {few} --shard $k/2 --out some/$k; done; ./zwang merge some/* --out whole"),
    (r"./zwang report big/result --figures svg", r"./zwang report DIR --figures svg"),
    (r"(./zwang bench --problems) DIR --sequence", r"\1 first.h5 --sequence --solvers nnls --out sequence"),
    (r"(./zwang bench --problems) FILE... --suite speed", r"\1 first.h5 --solvers nnls --out speed"),
    (r"(./zwang bench) --resume DIR", r"\1 --resume DIR"),
    (r"(./zwang simulate (?:simple --motion grasp|box --motion lift))(.*)", r"\1 --frames 20 --out $(mktemp -u)\2"),
    (r"(./zwang simulate simple) --motion RECORDING --audit", r"\1 --motion grasp --frames 20 --audit --out audited"),
    (r"(./zwang simulate) engine --motion recording.json", r"\1 --help"),
    (r"(./zwang simulate box --god) (docs/\S+)( --motion )?(docs/\S+)?",
     lambda m: f"{m[1]} SOURCE/{m[2]} --frames 20 --out $(mktemp -u)" + (f"{m[3]}SOURCE/{m[4]}" if m[4] else "")),
    (r"./zwang simulate simple --god hand.xml@x-z .*", None),
    (r"(./zwang simulate gear.stl@mm .*)", r"\1 --frames 5 --out gear"),
    (r"./zwang experiment (all|acary|feasibility) .*", None),  # acary, feasibility: scripts, with tests of their own
    (r"./zwang experiment fig8", "./zwang experiment fig8 --seconds 0.05 --out questions"),
    (r"./zwang experiment laws.*", "./zwang experiment --help"),
    (r"(./zwang bench --scenes .* --law pyramid,convex,coulomb)", r"\1 --solvers cone,newton --tolerances 1e-6 --out laws"),
    (r"./zwang conformance --engines all", None),
    (r"./zwang (guard|league) [A-Z].*", r"./zwang \1 --help"), (r"./zwang judge", "./zwang judge --help"), (r"./zwang judge PACK .*", "./zwang judge --help"),
    (r"./zwang conformance", "./zwang conformance || test $? = 1"),  # 1: some are off
    (r"./zwang pack atlas --out DIR", "./zwang pack --help"),
    (r"(./zwang fuzz --friction(?: --accuracy \S+)?).*", r"\1 --count 100 --solvers cone"), (r"./zwang live SCENE.*", None),
    (r"(./zwang fuzz --referee).*", r"\1 --count 50"),
    (r"(./zwang fuzz --near.*)", r"\1 --count 5 || test $? = 1"),  # 1: it found something
    (r"(./zwang solve FILE --solver) NAME (.*)", r"./zwang solve first.h5 --solver nnls \2"),
    (r"./zwang solve", "./zwang solve first.h5 --solver nnls"), (r"./zwang solve FILE", "./zwang solve first.h5 --solver nnls"),
    (r"./zwang export", "./zwang export tower --out tower.h5"), (r"./zwang report", "./zwang report DIR"),
    (r"./zwang simulate", "./zwang simulate --help"),
    (r"./zwang live (simple|box) --socket /tmp/hand.*", r"./zwang live \1 --socket hand --seconds 0.1"), (r"./zwang live( .*)?", "./zwang live --help"),
    ("./zwang", "./zwang --help"),
    (r"./zwang bench --scenes my.json", "./zwang bench --scenes SOURCE/docs/examples/scenes/crane.json --solvers nnls --out mine"),
    (r"(./zwang bench --solvers) projected_gradient,nnls", r"\1 nnls --scenes 'tower(boxes=2)' --out guide"),
    (r"(./zwang bench --scenes) \"tower.*", r'\1 "tower(boxes=10),hand(contacts=64,seed=1..2)" --solvers nnls,dual_active_set,ipopt '
                                            r"--tolerances 1e-6 --out own"),
    (r"(./zwang bench --problems) FILE...", r"\1 first.h5 --solvers nnls --out problems"),
    (r"(./zwang bench --problems) FOLDER (.*)", r"\1 first.h5 \2 --out folder"),
    (r"(./zwang bench --problems) FILE (.*) --solvers nsgs (.*)", r"\1 first.h5 \2 --solvers nnls \3 --out cell"),
    (r"(./zwang solve) FILE --solver nsgs (.*)", r"\1 first.h5 --solver nnls \2"), (r"(./zwang solve) FILE (.*)", r"\1 first.h5 \2"),
    ("./zwang judge PACK ANSWERS --proofs DIR", "./zwang judge --help"),
    (r"./zwang pack (guard|DIR) .*", None), ("./zwang guard pack b1.*", None),
    (r"(./zwang fuzz --count) \d+ (.*)", r"\1 20 \2"),
    (r"(./zwang report DIR) --figures (svg,pdf|pdf)", r"\1 --figures svg"),
    (r"(./zwang capture) (docs/\S+) --steps \d+ (.*)", r"\1 SOURCE/\2 --steps 5 \3"), (r"./zwang capture.*", None),
    (r"(./zwang bench --scenes) (\S+\.json).*", r"\1 SOURCE/\2 --solvers nnls --out scene"),
]
# Corners of its twelve triangles, seen from outside.
cube = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]
time = r"\d[\d,.]*(?: min \d+)? (?:us|ms|s|min)\b"
noise = r"(?:0|\d(?:\.\d+)?e-(?:1[1-9]|[2-9]\d))"
token = re.compile(rf"(?P<dots> *\.\.\.)|(?P<time>{time})|\((?P<ratio>[\d.,]+)x\)|(?P<noise>\b\d(?:\.\d+)?e-(?:1[1-9]|[2-9]\d)\b)|(?P<space> +)")


def pattern(expected):
    lines = []
    for line in expected.rstrip().splitlines():
        if line.strip() == "...":
            lines.append(r"(?:.*\n)*")
            continue
        text, at = "", 0
        for found in token.finditer(line):
            text += re.escape(line[at:found.start()])
            text += {"dots": ".*", "time": time, "ratio": r"\([\d.,]+x\)", "noise": noise, "space": " +"}[found.lastgroup]
            at = found.end()
        lines.append(text + re.escape(line[at:].rstrip()) + " *\n")
    return "".join(lines)


def blocks(text):
    """(kind, text, "not run", "begun" or None) of each fenced block, in order."""
    for found in re.finditer(r"^(?:<!-- *(?P<how>not run|begun):.*?-->\n)?(?P<fence>```+)(?P<kind>\w*)\n(?P<body>.*?)^(?P=fence)$",
                             re.sub(r"^  (?=<!--|```|\$)", "", text, flags=re.M), re.S | re.M):
        yield found["kind"], found["body"], found["how"]


class Page:
    def __init__(self, program, module, page):
        self.faults, self.run, self.left_out, self.page = [], 0, 0, page
        self.module, self.env = module, dict(os.environ, TERM="dumb")
        with tempfile.TemporaryDirectory() as folder:
            self.folder = folder
            wrapper = pathlib.Path(folder, "zwang")
            wrapper.write_text(f'#!/bin/sh\nexec "{program}" "$@"\n')
            wrapper.chmod(0o755)
            pathlib.Path(folder, "docs").symlink_to(root / "docs")
            self.env["XDG_CACHE_HOME"] = folder + "/.cache"
            self.walk(page.read_text())

    def compare(self, what, expected, printed):
        if not expected.strip():
            return
        if not re.fullmatch(pattern(expected), printed.rstrip() + "\n"):
            self.faults.append(f"{self.page.name}: {what}\n--- the page says\n{expected.rstrip()}\n--- it prints\n{printed.rstrip()}\n")

    def command(self, line, expected, must_succeed=False):
        self.run += 1
        limit = 300  # seconds
        try:
            done = subprocess.run(["bash", "-c", line], cwd=self.folder, env=self.env, text=True, timeout=limit,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        except subprocess.TimeoutExpired:
            self.faults.append(f"{self.page.name}: {line}: not done after {limit} s")
            return
        printed = re.sub(r"^ *\d+ %(?:.* left| *)\n", "", done.stdout.replace("\r", "\n"), flags=re.M)
        if must_succeed and done.returncode:
            self.faults.append(f"{self.page.name}: {line}: exit code {done.returncode}\n{printed}")
        self.compare(line, expected, printed)

    def begin(self, line, expected):
        """A bench: its head line, and the number of runs that follows from it."""
        self.run += 1
        started = subprocess.Popen(["bash", "-c", "exec " + line], cwd=self.folder, env=self.env, text=True, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        head = started.stdout.readline()
        started.send_signal(signal.SIGINT)
        started.communicate(timeout=60)
        self.compare(line, expected.partition("\n")[0], head)
        counts = re.search(r"(\d+) solvers x (\d+) problems x (\d+) tolerances", head)
        runs = f"{math.prod(map(int, counts.groups())):,} runs in " if counts else head
        if not re.search("^" + runs, expected, re.M):
            self.faults.append(f"{self.page.name}: {line}: the page does not say '{runs}'\n")

    def python(self, code):
        """In a process that stays for the page."""
        if not hasattr(self, "interpreter"):
            script = ("import contextlib, io, json, sys, traceback\nvariables = {'__name__': '__main__'}\n"
                      "for line in sys.stdin:\n"
                      "    out, good = io.StringIO(), True\n"
                      "    with contextlib.redirect_stdout(out):\n"
                      "        try: exec(json.loads(line), variables)\n"
                      "        except BaseException: good = False; traceback.print_exc(file=out)\n"
                      "    print('\\0' + json.dumps([good, out.getvalue()]), flush=True)\n")
            env = dict(self.env, PYTHONPATH=self.module)
            self.interpreter = subprocess.Popen(["/usr/bin/python3", "-c", script], cwd=self.folder, env=env, text=True,
                                                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.run += 1
        self.interpreter.stdin.write(json.dumps(code) + "\n")
        self.interpreter.stdin.flush()
        for line in self.interpreter.stdout:
            if line.startswith("\0"):
                return json.loads(line[1:])
        return [False, "the interpreter died"]

    def lines(self, text):
        plain = re.sub(r"^( *)(```+).*?^ *\2 *$|<!--.*?-->", "", text, flags=re.S | re.M)
        found = re.findall(r"^(?:    )?(\./zwang.*)", plain, re.M) + re.findall(r"`(\./zwang[^`]*)`", plain)
        if not found:
            return
        a_run = "bench --problems first.h5 --solvers nnls --out "
        made = ["export hand --contacts=4 --out first.h5", a_run + "RUN_A", a_run + "RUN_B",
                "simulate simple --motion grasp --frames 20 --out DIR" if "frames.h5" in text else a_run + "DIR"]
        for command in made:
            self.command("./zwang " + command, "", True)
        self.run -= len(made)
        block = "".join(f"facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {30 * (c & 1)} {30 * (c >> 1 & 1)} {30 * (c >> 2)}\n" for c in corners)
                        + "endloop\nendfacet\n" for corners in cube)
        for name in ("part.stl", "gear.stl", "tool.stl"):
            pathlib.Path(self.folder, name).write_text(f"solid cube\n{block}endsolid cube\n")
        pathlib.Path(self.folder, "path.csv").write_text("time,x,y,z,qw,qx,qy,qz\n0,0,0,0.3,1,0,0,0\n0.1,0,0,0.2,1,0,0,0\n")
        for line in dict.fromkeys(re.sub(r"  *#.*", "", line).replace("\n", " ").strip() for line in found):
            for shape, instead in shorter:
                if re.fullmatch(shape, line):
                    line = instead and re.sub(shape, instead, line).replace("SOURCE", str(root))
                    break
            if line:
                self.command(line, "", True)
            else:
                self.left_out += 1

    def source(self, body):
        """A guide's first block is compiled into the tests; another one is part of a file of docs/examples."""
        self.run += 1
        files = [p.read_text() for p in (root / "docs" / "examples").rglob("*") if p.suffix in (".cpp", ".h")]
        if self.page.name not in ("add-a-constraint.md", "add-a-law.md", "add-a-solver.md") and not any(body.strip() in t for t in files):
            self.faults.append(f"{self.page.name}: this is in no file of docs/examples:\n{body}")

    def walk(self, text):
        items = list(blocks(text))
        self.lines(text)
        for (kind, body, how), (next_kind, following, _) in zip(items, items[1:] + [("", "", None)]):
            if kind == "cpp":
                self.source(body)
            if kind not in ("console", "python"):
                continue
            if how == "not run" or (kind == "python" and self.module == "-"):
                self.left_out += 1
                continue
            if kind == "python":
                good, printed = self.python(body)
                if not good:
                    self.faults.append(f"{self.page.name}: this fails:\n{body}{printed}")
                elif next_kind == "text":
                    self.compare(body, following, printed)
                continue
            for part in re.split(r"^\$ ", body, flags=re.M)[1:]:
                line, _, expected = part.partition("\n")
                (self.begin if how == "begun" else self.command)(line, expected)
        if hasattr(self, "interpreter"):
            self.interpreter.stdin.close()
            self.interpreter.wait()


root = pathlib.Path(__file__).resolve().parents[2]
program, module, *pages = sys.argv[1:]
if module == "-":  # what asks the Python module
    shorter.insert(0, (r"./zwang bench --gradients.*", None))
pages = [pathlib.Path(name).resolve() for name in pages]
program, module = os.path.abspath(program), module if module == "-" else os.path.abspath(module)
faults = 0
for name in pages:
    page = Page(program, module, name)
    print(f"{name.name}: {page.run} examples run, {page.left_out} left out, {len(page.faults)} faults")
    print("\n".join(page.faults), end="", flush=True)
    faults += len(page.faults)
sys.exit(bool(faults))
