#!/usr/bin/python3
"""What a build and its tests took: slowest.py BUILD_FOLDER

The ten objects that took longest to compile when they were compiled last (.ninja_log: seconds on the wall, which other work on
the machine and the compiler cache change), and the ten slowest tests (ctest's mean over their runs).
"""
import pathlib
import sys

build = pathlib.Path(sys.argv[1])


def lines(name):
    return (build / name).read_text().splitlines() if (build / name).exists() else []


objects, tests = {}, {}
for line in lines(".ninja_log"):  # start and end [ms], time stamp, output, hash; the last line of an output counts
    words = line.split("\t")
    if len(words) == 5 and words[3].endswith((".o", ".gch")) and (build / words[3]).exists():
        objects[words[3]] = (int(words[1]) - int(words[0])) / 1000
for line in lines("Testing/Temporary/CTestCostData.txt"):  # name, runs, mean [s]; after "---" what failed last time
    if line == "---":
        break
    name, _, seconds = line.rsplit(" ", 2)
    tests[name] = float(seconds)
for what, took in (("objects", objects), ("tests", tests)):
    print(f"\n{len(took):,} {what}, {sum(took.values()):,.0f} s; those that took longest:")
    for name in sorted(took, key=took.get, reverse=True)[:10]:
        print(f"{took[name]:7.1f} s  {name}")
