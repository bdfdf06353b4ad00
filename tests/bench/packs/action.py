"""The GitHub action and the GitLab snippet of docs/guard.md, run as they are written, but for what installs and builds.

Usage: action.py PROGRAM SOURCE_DIR
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml

try:
    import yaml
except ImportError:
    sys.exit(77)

program, source = os.path.abspath(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
action = yaml.safe_load((source / ".github/actions/guard/action.yml").read_text())
page = (source / "docs/guard.md").read_text()
snippets = [yaml.safe_load(block) for block in re.findall(r"```yaml\n(.*?)```", page, re.S)]
failures = 0


def check(what, holds, detail=""):
    global failures
    if not holds:
        failures += 1
        print(f"FAILED: {what}\n{detail}")


def script(name, text):
    path = pathlib.Path(name)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/usr/bin/env bash\n{text}\n")
    path.chmod(0o755)


def bash(lines, **environment):
    return subprocess.run(["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", lines], env={**os.environ, **environment},
                          capture_output=True, text=True, timeout=300)


def run_action(**given):
    """The exit code of the first step that fails, or 0."""
    inputs = {name: given.get(name, what.get("default")) for name, what in action["inputs"].items()}
    check("all inputs are there", None not in inputs.values() and not given.keys() - inputs.keys(), str(inputs))

    def filled(text):
        text = text.replace("${{ github.action_path }}", "there/.github/actions/guard")
        return re.sub(r"\$\{\{ inputs\.(\w+) \}\}", lambda name: inputs[name[1]], text)

    for step in action["runs"]["steps"]:
        if "run" not in step:
            continue
        check("no input is pasted into a script", "${{" not in step["run"], step["run"])
        done = bash(step["run"], **{name: filled(value) for name, value in step["env"].items()})
        if done.returncode:
            return done.returncode
    return 0


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    for name in ("there/zwang", "zwang/zwang"):
        script(name, f'[ "$1" = setup ] || exec "{program}" "$@"')
    os.makedirs("there/.github/actions/guard")
    solve = f'"{program}" solve-pack "$PACK" --solver %s --out "$ANSWERS"'
    small = {"pack": "hand(contacts=4,16,seed=1..3)", "seed": "1"}
    check("without answers before", run_action(**small, solve=solve % "nnls", out="first") == 0)
    check("judged", xml.parse("first/judged.xml").getroot().get("failures") == "0" and os.path.exists("first/judged/report.html"))
    before = {"before": "first/after.jsonl"}
    check("no worse", run_action(**small, **before, solve=solve % "nnls", out="same") == 0)
    check("map, badge, JUnit", all(os.path.exists(f"same/{name}") for name in ("compared/map.svg", "compared/badge.svg", "guard.xml")))
    check("worse", run_action(**small, **before, solve=solve % "pgs:max_sweeps=3", out="worse") == 1)
    check("worse, in JUnit", xml.parse("worse/guard.xml").getroot().get("failures") == "6")
    check("a solver that fails", run_action(**small, **before, solve="exit 4", out="failed") == 4)
    uses = snippets[0]["jobs"]["guard"]["steps"][-1]
    check("the page names the action and its inputs", uses["uses"].endswith("/zwang/.github/actions/guard@main") and
          not uses["with"].keys() - action["inputs"].keys(), str(uses))

    script("my-solver", f'"{program}" solve-pack "$1" --solver nnls --out said.jsonl >/dev/null && cat said.jsonl')
    os.replace("first/after.jsonl", "before.jsonl")
    job = snippets[1]["guard"]
    lines = [line.replace("pack guard", f'pack "{small["pack"]}"') for line in job["script"] if not re.match("apt-get|git ", line)]
    done = bash("\n".join(lines))
    kept = job["artifacts"]["paths"] + job["artifacts"]["reports"]["junit"]
    check("GitLab", done.returncode == 0 and len(lines) == 4 and all(map(os.path.exists, kept)), done.stdout + done.stderr)
    os.chdir("/")
sys.exit(1 if failures else 0)
