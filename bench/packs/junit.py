"""`./zwang judge --junit FILE`: verdicts as JUnit's XML, a test case an answer.

The program holds this text (held.py), which ends with the exit code that it is given.
"""
import json
import sys

RIGHT, OPEN = ("solved", "infeasible, proven"), ("undecided", "consistent", "rows off", "infeasible, claimed only")


def quoted(text):
    for mark, name in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;")):
        text = text.replace(mark, name)
    return f'"{text}"'


def case(row):
    """A failure where there is no right answer, nor an open one."""
    if row["verified"] == "unsupported":
        return "><skipped/></testcase>"
    if row["verified"] in OPEN:
        return f"><system-out>{row['verified']}</system-out></testcase>"
    if row["verified"] in RIGHT:
        return "/>"
    return f"><failure message={quoted('claimed ' + row['claimed'] + ', verified ' + row['verified'])}/></testcase>"


def main(_, results, file, code):
    try:
        with open(results, encoding="utf-8") as lines:
            rows = [row for row in map(json.loads, lines) if not row["solver"].startswith("recorded:")]
        cases = [f"  <testcase classname={quoted(row['solver'])} name={quoted(row['problem'])}{case(row)}\n" for row in rows]
        failures, skipped = (sum(mark in one for one in cases) for mark in ("><failure message=", "><skipped/>"))
        with open(file, "w", encoding="utf-8") as out:
            out.write(f'<?xml version="1.0" encoding="UTF-8"?>\n<testsuite name="zwang" tests="{len(rows)}" failures="{failures}" '
                      f'skipped="{skipped}">\n{"".join(cases)}</testsuite>\n')
    except OSError:
        print(f"{file}: cannot be written", file=sys.stderr)
        return 3
    return int(code)
