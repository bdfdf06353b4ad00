#!/usr/bin/python3
"""Runs the examples of a page: examples.py PROGRAM PYTHONPATH|- PAGE.md...

```console    Lines that begin with "$ " are commands, run in one scratch folder a page, where ./zwang is PROGRAM. The lines
              after each are what it prints; none: not looked at.
```python     Run one after another, in one interpreter a page, with the module of PYTHONPATH; a ```text block right after it
              is what it prints. "-": left out.
    ./zwang   Indented lines of README.md, as `readme` below has them.

A comment `<!-- not run: why -->` on the line before a block leaves it out. Printed text is compared loosely: "..." stands
for anything, a line "..." for any lines, a time for any time, "(8.2x)" for any ratio, rounding noise for any rounding noise.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

# How a line of README.md is run. None: it takes minutes, or is a test of its own.
readme = [
    ("./zwang bench", None), ("./zwang test.*", None), ("./zwang docs", None), ("./zwang python", None),
    (r"./zwang bench --suite (quick|speed|atlas|collision)", None),
    (r"./zwang simulate .*", None),
    (r"(./zwang bench --scenes) \"tower.*", r'\1 "tower(boxes=10),hand(contacts=64,seed=1..2)" --solvers nnls,dual_active_set,ipopt '
                                            r"--tolerances 1e-6 --out RUN_B"),
    (r"(./zwang bench --problems) FILE...", r"\1 first.h5 --solvers nnls --out DIR"),
    (r"(./zwang solve) FILE (.*)", r"\1 first.h5 \2"),
    (r"(./zwang fuzz --count) \d+ (.*)", r"\1 20 \2"),
    (r"(./zwang report DIR) --figures svg,pdf", r"\1 --figures svg"),
    (r"(./zwang report) RUN_A RUN_B", r"\1 DIR RUN_B"),
    (r"(./zwang capture) .*", None),
    (r"(./zwang bench --scenes) (\S+\.json)", r"\1 SOURCE/\2 --solvers nnls --out scene"),
]
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
    """(kind, text, not run) of each fenced block, in order."""
    for found in re.finditer(r"^(?P<not><!-- *not run:.*?-->\n)?(?P<fence>```+)(?P<kind>\w*)\n(?P<body>.*?)^(?P=fence)$",
                             re.sub(r"^  (?=<!--|```|\$)", "", text, flags=re.M), re.S | re.M):
        yield found["kind"], found["body"], bool(found["not"])


class Page:
    def __init__(self, program, module, page):
        self.faults, self.run, self.left_out, self.page = [], 0, 0, page
        self.module, self.env = module, dict(os.environ, TERM="dumb")
        with tempfile.TemporaryDirectory() as folder:
            self.folder = folder
            wrapper = pathlib.Path(folder, "zwang")
            wrapper.write_text(f'#!/bin/sh\nexec "{program}" "$@"\n')
            wrapper.chmod(0o755)
            self.env["XDG_CACHE_HOME"] = folder + "/.cache"
            self.walk(page.read_text())

    def compare(self, what, expected, printed):
        if not expected.strip():
            return
        if not re.fullmatch(pattern(expected), printed.rstrip() + "\n"):
            self.faults.append(f"{self.page.name}: {what}\n--- the page says\n{expected.rstrip()}\n--- it prints\n{printed.rstrip()}\n")

    def command(self, line, expected, must_succeed=False):
        self.run += 1
        done = subprocess.run(["bash", "-c", line], cwd=self.folder, env=self.env, text=True, timeout=300,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        printed = re.sub(r"^ *\d+ %.* left\n", "", done.stdout.replace("\r", "\n"), flags=re.M)
        if must_succeed and done.returncode:
            self.faults.append(f"{self.page.name}: {line}: exit code {done.returncode}\n{printed}")
        self.compare(line, expected, printed)

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

    def walk(self, text):
        if self.page.name == "README.md":
            self.command("./zwang export hand --contacts=4 --out first.h5", "", True)
            for line in re.findall(r"^    (\./zwang.*)", text, re.M):
                line = re.sub(r"  +#.*", "", line).strip()
                for shape, instead in readme:
                    if re.fullmatch(shape, line):
                        line = instead and re.sub(shape, instead, line).replace("SOURCE", str(self.page.parent))
                        break
                if line:
                    self.command(line, "", True)
                else:
                    self.left_out += 1
        items = list(blocks(text))
        for (kind, body, not_run), (next_kind, following, _) in zip(items, items[1:] + [("", "", False)]):
            if kind not in ("console", "python"):
                continue
            if not_run or (kind == "python" and self.module == "-"):
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
                self.command(line, expected)
        if hasattr(self, "interpreter"):
            self.interpreter.stdin.close()
            self.interpreter.wait()


program, module, *pages = sys.argv[1:]
pages = [pathlib.Path(name).resolve() for name in pages]
program = os.path.abspath(program)
faults = 0
for name in pages:
    page = Page(program, module, name)
    print(f"{name.name}: {page.run} examples run, {page.left_out} left out, {len(page.faults)} faults")
    print("\n".join(page.faults), end="", flush=True)
    faults += len(page.faults)
sys.exit(bool(faults))
