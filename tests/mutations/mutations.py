#!/usr/bin/python3
"""Damaged files of every format that the program reads: each ends within 10 s (CPU) with exit code 0, or 3 and one line.

mutations.py PROGRAM [--count N] [--seed S] [--formats a,b] [--data FOLDER] [--jobs N] [--keep FOLDER]

Base files come from bases.py (and from --data, recorded ones); each is cut, flipped, shortened, lengthened, given
other numbers. The case of a number K of a seed is always the same one: --only FORMAT:K repeats it. --keep stores the
files of the cases that failed.
"""
import argparse
import collections
import concurrent.futures
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile

import bases

DEADLINE = 10  # s of CPU time: the machine may have other work; six times that on the clock
SANITIZED = 99  # exit code of a program that a sanitizer stopped

PROGRESS = re.compile(r"\d+ % ")
NUMBER = re.compile(rb"-?\d+(\.\d*)?([eE][-+]?\d+)?")
NUMBERS = [b"0", b"-1", b"1", b"255", b"65536", b"2147483647", b"-2147483648", b"4294967295", b"18446744073709551615",
           b"1e308", b"-1e308", b"1e-308", b"1e999", b"nan", b"inf", b"null", b"", b"99999999999999999999999", b"0.5"]


def place(random, size):
    """A third of all places are near the start, where headers are."""
    return random.randrange(min(size, 400) if random.random() < 1 / 3 else size) if size else 0


def stretch(random, size):
    begin = place(random, size)
    return begin, min(size, begin + (random.randint(1, 16) if random.random() < 0.7 else random.randint(1, size + 1)))


def cut(random, data):
    return data[:place(random, len(data))]


def flip(random, data):
    data = bytearray(data)
    for _ in range(random.choice([1, 1, 1, 2, 8, 64])):
        if data:
            data[place(random, len(data))] ^= 1 << random.randrange(8)
    return bytes(data)


def delete(random, data):
    begin, end = stretch(random, len(data))
    return data[:begin] + data[end:]


def insert(random, data):
    at = place(random, len(data))
    count = random.choice([1, 2, 4, 8, 100, 5000])
    fill = random.choice([random.randbytes(count), bytes(count), b"\xff" * count, b"9" * count, b"[" * count,
                          b"\n" * count, b" " * count])
    return data[:at] + fill + data[at:]


def duplicate(random, data):
    begin, end = stretch(random, len(data))
    at = place(random, len(data))
    return data[:at] + data[begin:end] + data[at:]


def overwrite(random, data):
    begin, end = stretch(random, len(data))
    byte = random.choice([b"\x00", b"\xff", b"\x7f", b"\x80", b"0"])
    return data[:begin] + byte * (end - begin) + data[end:]


def number(random, data):
    found = list(NUMBER.finditer(data))
    if not found:
        return flip(random, data)
    at = random.choice(found[:60] if random.random() < 0.5 else found)
    return data[:at.start()] + random.choice(NUMBERS) + data[at.end():]


def field(random, data):
    """A binary number of 1 to 8 bytes, at a multiple of its size."""
    width = random.choice([1, 2, 4, 8])
    at = place(random, len(data)) // width * width
    value = random.choice([0, 1, 2, 127, 128, 255, 256, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**40, 2**63 - 1, 2**64 - 1,
                           len(data), len(data) - 1])
    return data[:at] + (value % 2 ** (8 * width)).to_bytes(width, random.choice(["little", "big"])) + data[at + width:]


MUTATIONS = [cut, flip, delete, insert, duplicate, overwrite, number, field, flip, field]


def mutated(random, data):
    for _ in range(random.choice([1, 1, 1, 1, 2, 3])):
        data = random.choice(MUTATIONS)(random, data)
    return data


def run(program, words, folder):
    """Exit code (None: over the deadline) and stderr."""
    environment = {**os.environ, "XDG_CACHE_HOME": os.path.join(folder, "cache"), "TMPDIR": folder,
                   "ASAN_OPTIONS": f"exitcode={SANITIZED}:allocator_may_return_null=1:detect_leaks=0",
                   "UBSAN_OPTIONS": f"exitcode={SANITIZED}"}
    try:
        done = subprocess.run(["prlimit", f"--cpu={DEADLINE}", program] + words, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=6 * DEADLINE)
    except subprocess.TimeoutExpired:
        return None, ""
    return done.returncode, done.stderr.decode(errors="replace")


def fault(form, code, errors):
    """What is wrong with how the program ended; "" where nothing is."""
    lines = [line for line in errors.split("\n") if line and not PROGRESS.match(line)]
    if code is None or code == -signal.SIGXCPU:
        return f"still busy after {DEADLINE} s"
    if code not in (*form.fine, 3):
        return f"exit code {code}"
    if code == 3 and len(lines) != 1:
        return f"exit code 3 with {len(lines)} lines"
    return ""


class Case:
    """Number `k` of a format: which base, which file of it, which mutation."""

    def __init__(self, form, k, seed):
        self.form, self.k = form, k
        self.random = random.Random(f"{seed} {form.name} {k}")
        self.base = form.bases[k % len(form.bases)]
        self.victim = self.random.choice(form.victims(self.base))

    def write(self, folder):
        """The base in `folder`, one file of it mutated. Returns the words for the program."""
        if os.path.isdir(self.base):
            shutil.copytree(self.base, os.path.join(folder, "base"))
            name = os.path.join(folder, "base", self.victim)
        else:
            name = os.path.join(folder, os.path.basename(self.base))
            shutil.copyfile(self.base, name)
        with open(name, "rb") as file:
            data = file.read()
        with open(name, "wb") as file:
            file.write(self.form.damage(self.random, data, mutated))
        return self.form.words(os.path.relpath(name, folder))

    def try_it(self, program, scratch, keep):
        folder = tempfile.mkdtemp(dir=scratch)
        words = self.write(folder)
        spoilt = os.path.join(scratch, "spoilt-" + os.path.basename(folder))
        if keep:
            shutil.copytree(folder, spoilt)
        code, errors = run(program, words, folder)
        wrong = fault(self.form, code, errors)
        if wrong and keep:
            shutil.copytree(spoilt, os.path.join(keep, f"{self.form.name}-{self.k}"), dirs_exist_ok=True)
        shutil.rmtree(spoilt, ignore_errors=True)
        shutil.rmtree(folder, ignore_errors=True)
        line = f"FAILED: {self.form.name}:{self.k} ({os.path.basename(self.base)}/{self.victim}): {wrong}: " \
               f"{' '.join(words)}\n{errors[:600]}"
        return self.form.name, code, line if wrong else ""


def odd_files(program, form, scratch):
    """In place of a file: nothing, a folder, a pipe without a writer, an endless device, a link to itself."""
    for kind in ("empty", "folder", "pipe", "endless", "loop", "absent"):
        folder = tempfile.mkdtemp(dir=scratch)
        name = os.path.join(folder, os.path.basename(form.bases[0]))
        if kind == "empty":
            open(name, "wb").close()
        elif kind == "folder":
            os.mkdir(name)
        elif kind == "pipe":
            os.mkfifo(name)
        elif kind == "endless":
            os.symlink("/dev/zero", name)
        elif kind == "loop":
            os.symlink(name, name)
        code, errors = run(program, form.words(os.path.basename(name)), folder)
        wrong = fault(form, code, errors) or ("" if code == 3 else f"exit code {code}")
        if wrong:
            yield f"FAILED: {form.name}: {kind}: {wrong}\n{errors[:600]}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--count", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--formats", default="")
    parser.add_argument("--only", default="")
    parser.add_argument("--data", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--keep", default="")
    asked = parser.parse_args()
    program = os.path.abspath(asked.program)

    failures, codes = [], collections.defaultdict(collections.Counter)
    with tempfile.TemporaryDirectory() as scratch:
        forms = bases.formats(program, os.path.join(scratch, "bases"), asked.data)
        for form in forms:  # a base that is not read itself would make every mutation pass
            for base in form.bases:
                folder = tempfile.mkdtemp(dir=scratch)
                if os.path.isdir(base):
                    shutil.copytree(base, os.path.join(folder, "base"))
                code, errors = run(program, form.words(base), folder)
                if code != 0:
                    failures.append(f"FAILED: {form.name}: the base {base} itself: exit code {code}: {errors}")
        if asked.formats:
            forms = [form for form in forms if form.name in asked.formats.split(",")]
        if asked.only:
            name, k = asked.only.split(":")
            cases = [Case(form, int(k), asked.seed) for form in forms if form.name == name]
        else:
            cases = [Case(forms[i % len(forms)], i // len(forms), asked.seed) for i in range(asked.count)]
            for form in forms:
                if not os.path.isdir(form.bases[0]):
                    failures += odd_files(program, form, scratch)
        with concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
            for name, code, line in pool.map(lambda case: case.try_it(program, scratch, asked.keep), cases):
                codes[name][code] += 1
                if line:
                    failures.append(line)
                    print(line, flush=True)
    for line in failures:
        print(line)
    for name, counter in codes.items():
        print(f"{name}: " + ", ".join(f"{n} with exit code {code}" for code, n in sorted(counter.items(), key=str)))
    print(f"{len(cases)} damaged files, {len(failures)} faults")
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
