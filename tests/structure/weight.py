#!/usr/bin/python3
"""What a file makes the compiler read: weight.py SOURCE_DIR [--list]

For each object (.cpp) and each header: how many headers of the project its #include lines lead to, and how many lines of code
stand in them (no blank lines, no comments). Above its mark it is named, and the test fails. Dear headers of others may be
included by .cpp files alone. Nothing is timed: the same tree gives the same counts. --list: all counts, the dearest last.
"""
import pathlib
import re
import sys

# Just above the dearest of the tree, (headers, lines of code). Who passes a mark first tries a forward declaration, a header
# in two, or what a header includes for its .cpp alone; then a higher mark, with the reason in the commit.
marks = {".cpp": (71, 4200), ".h": (57, 3750)}
# Dearer, for a reason.
higher = {"solvers/registry.cpp": (97, 5000)}  # lists every solver, and gives each what it hands on to
dear = re.compile(r"nlohmann/json\.hpp|CLI/|mujoco/|bullet/|Bullet|LinearMath/|bt[A-Z]\w*\.h|fcl/|CGAL/|boost/|assimp/|Ip[A-Z]\w*\.hpp|"
                  r"nlopt|hdf5|H5|benchmark/|meshoptimizer|iostream$|regex$")
may = {"tests/god_hand/leap_document.h": "nlohmann/",    # writes JSON, for two tests
       "tests/constraints/conformance.h": "boost/",      # differences in 100 digits, for one test
       "tests/core/referee/hundred_digits.h": "boost/"}  # what the referee is measured by
folders = ("core", "constraints", "solvers", "collision", "bench", "experiments", "tests", "docs/examples")

root = pathlib.Path(sys.argv[1]).resolve()
include = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.M)
files = {}  # path -> (lines of code, own headers it includes, others' headers)


def read(path):
    if path not in files:
        text = path.read_text(errors="replace")
        own, others = [], []
        for quote, name in include.findall(text):
            near = [path.parent / name, root / name] if quote == '"' else [root / name[6:]] if name.startswith("zwang/") else []
            found = next((p.resolve() for p in near if p.is_file()), None)
            own.append(found) if found else others.append(name)
        code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
        files[path] = sum(bool(re.sub(r"//.*", "", line).strip()) for line in code.splitlines()), own, others
    return files[path]


def reached(path):
    seen, ahead = set(), [path]
    while ahead:
        for header in read(ahead.pop())[1]:
            if header not in seen and header != path:
                seen.add(header)
                ahead.append(header)
    return seen


counts, faults = [], []
for path in sorted(p for folder in folders for p in (root / folder).rglob("*") if p.suffix in marks and "node_modules" not in p.parts):
    name, headers = str(path.relative_to(root)), reached(path)
    count = len(headers), sum(read(h)[0] for h in headers)
    counts.append((*reversed(count), name))
    for what, found, mark in zip(("headers of the project", "lines in headers of the project"), count, higher.get(name, marks[path.suffix])):
        if found > mark:
            faults.append(f"{name}: {what}: {found}, mark {mark}")
    if path.suffix == ".h":
        faults += [f"{name}: includes <{other}>: .cpp files alone may" for other in read(path)[2]
                   if dear.match(other) and not other.startswith(may.get(name, " "))]
if len(counts) < 500:
    faults.append(f"only {len(counts)} files found in {root}")
if "--list" in sys.argv:
    for lines, headers, name in sorted(counts):
        print(f"{headers:4} headers {lines:6} lines  {name}")
print("\n".join(faults) or f"{len(counts)} files are below their marks")
sys.exit(bool(faults))
