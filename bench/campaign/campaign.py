"""`./zwang campaign`: a suite in tasks, started by Slurm, GNU parallel or xargs. docs/campaigns.md.

DIR/job.sh runs one task, DIR/parts/K is its result, DIR/campaign.json what is asked and what was started. The program
holds this text (held.py) and the job's.
"""
import argparse
import contextlib
import difflib
import fcntl
import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time

ENGINES = ("slurm", "parallel", "local")
WRONG_USE, BAD_FILE, STOPPED = 2, 3, 130
KEYS = {"program": str, "suite": list, "engine": str, "tasks": int, "at_once": int, "timing": bool, "hours": (int, float), "started": list}
MOST_IDLE_ROUNDS = 2  # in a row, without a new line


def fail(line, code=WRONG_USE):
    print(line, file=sys.stderr)
    sys.exit(code)


def shell(command):
    """Exit code and what was printed, of a line for the shell."""
    done = subprocess.run(["sh", "-c", command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return done.returncode, done.stdout.strip()


def require_engine(engine):
    if engine == "slurm" and not shutil.which("sbatch"):
        fail("Slurm is not installed here: there is no sbatch; or use --engine local", BAD_FILE)
    if engine == "parallel" and not shutil.which("parallel"):
        fail("GNU parallel is not installed (Debian: apt install parallel); or use --engine local", BAD_FILE)


def ranges(numbers):
    """[0, 1, 2, 5] -> "0-2,5"."""
    runs = []
    for n in numbers:
        if runs and runs[-1][1] == n - 1:
            runs[-1][1] = n
        else:
            runs.append([n, n])
    return ",".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def start_of(process):
    """When it began, in clock ticks since boot; "" where there is none or it has ended. proc(5): the 22nd field."""
    try:
        with open(f"/proc/{process}/stat") as file:
            fields = file.read().rpartition(")")[2].split()
    except OSError:
        return ""
    return "" if fields[0] in "ZX" else fields[19]


class Campaign:
    def __init__(self, folder, record):
        self.folder = os.path.abspath(folder)
        self.record = record
        self.counted = {}  # file -> bytes read, lines in them
        self.planned = 0

    @classmethod
    def read(cls, folder):
        try:
            with open(os.path.join(folder, "campaign.json")) as file:
                record = json.load(file)
            for name, kind in KEYS.items():
                if not isinstance(record[name], kind):
                    raise ValueError(f"{name} is {record[name]!r}")
            if record["engine"] not in ENGINES:
                raise ValueError(f"no engine {record['engine']!r}")
        except OSError:
            fail(f"{folder} holds no campaign: campaign.json is missing", BAD_FILE)
        except (ValueError, KeyError, TypeError) as wrong:
            fail(f"{folder}/campaign.json: {wrong!r}; expected what ./zwang campaign writes", BAD_FILE)
        return cls(folder, record)

    def at(self, *names):
        return os.path.join(self.folder, *map(str, names))

    def write_record(self):
        with open(self.at("campaign.json.new"), "w") as file:
            json.dump(self.record, file, indent=2)
            file.write("\n")
        os.replace(file.name, self.at("campaign.json"))

    def write(self, job):
        """A script to be read, changed and run by hand, and the record."""
        r = self.record
        for name in ("parts", "logs"):
            os.makedirs(self.at(name), exist_ok=True)
        values = {
            "tasks": r["tasks"], "last": r["tasks"] - 1, "minutes": max(1, round(r["hours"] * 60)),
            # Alone on a node, and pinned to a core there; or neither.
            "exclusive": "#SBATCH --exclusive" if r["timing"] else "#",
            "core": "$(taskset -cp $$ | sed 's/.*: //; s/[,-].*//')" if r["timing"] else "",
            "dir": shlex.quote(self.folder), "here": shlex.quote(os.getcwd()), "program": shlex.quote(r["program"]), "suite": " " + shlex.join(r["suite"])}
        for word, value in values.items():
            job = job.replace(f"@{word}@", str(value))
        with open(self.at("job.sh"), "w") as file:
            file.write(job)
        os.chmod(self.at("job.sh"), 0o755)
        self.write_record()

    def started_parts(self):
        return [self.at("parts", k) for k in range(self.record["tasks"]) if os.path.exists(self.at("parts", k, "run.json"))]

    def unfinished(self):
        """Tasks whose part lacks a run, or that left none."""
        def whole(part):
            if not os.path.exists(os.path.join(part, "run.json")):
                return False
            done = subprocess.run([self.record["program"], "bench", "--missing", part], capture_output=True, text=True)
            if done.returncode > 1:
                fail(done.stderr.strip(), done.returncode)
            return done.returncode == 0
        return [k for k in range(self.record["tasks"]) if not whole(self.at("parts", k))]

    def lines(self):
        """Of all results so far, each byte read once."""
        for part in self.started_parts():
            name = os.path.join(part, "results.jsonl")
            read, n = self.counted.get(name, (0, 0))
            try:
                if os.path.getsize(name) < read:
                    read, n = 0, 0  # begun anew
                with open(name, "rb") as file:
                    file.seek(read)
                    while block := file.read(1 << 20):
                        read, n = read + len(block), n + block.count(b"\n")
            except OSError:
                continue
            self.counted[name] = read, n
            if not self.planned:
                with open(os.path.join(part, "run.json")) as file:
                    run = json.load(file)
                self.planned = len(run["problem_sha256"]) * len(run["solvers"]) * len(run["tolerances"])
        return sum(n for _, n in self.counted.values())

    def start(self, tasks):
        """At most at_once of them at a time. What is started goes on when this program ends."""
        r, job = self.record, shlex.quote(self.at("job.sh"))
        require_engine(r["engine"])
        if r["engine"] == "slurm":
            code, said = shell(f"sbatch --parsable --array={ranges(tasks)}%{r['at_once']} {job}")
            if code:
                fail("sbatch: " + " ".join(said.split()), BAD_FILE)
            r["started"].append({"id": said.partition(";")[0], "started": ""})
        else:
            # Their numbers are in a file: a command has no room for 25,000.
            with open(self.at("logs", "tasks.txt"), "w") as file:
                file.writelines(f"{task}\n" for task in tasks)
            listed = shlex.quote(file.name)
            # A session of its own: Ctrl-C at a terminal does not reach it. xargs would end with a task that is killed.
            if r["engine"] == "parallel":
                joblog = shlex.quote(self.at("joblog.txt"))
                command = f"setsid nohup parallel --joblog {joblog} -j {r['at_once']} {job} :::: {listed} </dev/null"
            else:
                each = shlex.quote(f'{job} "$0" || :')
                command = f"setsid nohup xargs -a {listed} -P {r['at_once']} -n 1 sh -c {each}"
            code, said = shell(f"{{ {command} >>{shlex.quote(self.at('logs', 'engine.log'))} 2>&1 & }} ; echo $!")
            if code:
                fail("starting tasks: " + " ".join(said.split()), BAD_FILE)
            r["started"].append({"id": said, "started": start_of(said)})
        self.write_record()

    def active(self):
        """Whether what was started last waits or runs. True also where a scheduler does not answer."""
        if not self.record["started"]:
            return False
        last = self.record["started"][-1]
        if self.record["engine"] != "slurm":
            return last["started"] != "" and start_of(last["id"]) == last["started"]
        code, said = shell(f"squeue --noheader --format=%i --jobs={shlex.quote(last['id'])}")
        return said != "" if code == 0 else "Invalid job id" not in said

    def follow(self):
        """Starts what is unfinished, follows it, starts again what is missing when all have ended. True: nothing is missing;
        False: rounds brought nothing."""
        idle, shown = 0, -1
        while True:
            before, begin = self.lines(), time.monotonic()
            if not self.active():
                tasks = self.unfinished()
                if not tasks:
                    return True
                if idle == MOST_IDLE_ROUNDS:
                    return False
                self.start(tasks)
            while self.active():
                now = self.lines()
                left = (time.monotonic() - begin) * (self.planned - now) / (now - before) if now > before else None
                shown = self.show(now, left, shown)
                time.sleep(2 if self.record["engine"] == "slurm" else 0.3)  # a scheduler is asked less often
            if sys.stderr.isatty():
                print("\r\033[K", end="", file=sys.stderr)
            idle = 0 if self.lines() > before else idle + 1

    def show(self, now, left, shown):
        """One line that is redrawn on a terminal, a plain line every 10 % elsewhere. Returns the tenths that were shown."""
        if not self.planned:
            return shown
        percent = min(100, 100 * now // self.planned)
        rest = "" if left is None else f"{round(left / 60)} min left" if left > 90 else f"{max(1, round(left))} s left"
        if sys.stderr.isatty():
            text = f"{percent:3} %   {now:,} of {self.planned:,} runs   {rest}"
            print("\r" + text[:shutil.get_terminal_size().columns - 1] + "\033[K", end="", file=sys.stderr, flush=True)
        elif percent // 10 > shown:
            print(f"{percent // 10 * 10} %   {rest}", file=sys.stderr)
        return percent // 10

    def finish(self):
        """The result of an earlier attempt goes when there is another."""
        parts = self.started_parts()
        if not parts:
            fail(f"no task of {self.folder} left a run: see its logs/", BAD_FILE)
        result, before, merging = self.at("result"), self.at("result.before"), None
        shutil.rmtree(before, ignore_errors=True)
        sys.stdout.flush()
        try:
            if os.path.exists(result):
                os.rename(result, before)
            merging = subprocess.Popen([self.record["program"], "merge", *parts, "--out", result], start_new_session=True)
            code = merging.wait()
        except KeyboardInterrupt:
            if merging:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(merging.pid, signal.SIGTERM)
                merging.wait()
            if os.path.exists(before):
                shutil.rmtree(result, ignore_errors=True)
                os.rename(before, result)
            raise
        shutil.rmtree(before, ignore_errors=True)
        return code

    def take(self):
        """Two that follow it would start what is missing twice, and join it into one folder."""
        self.lock = open(self.at("logs", "campaign.lock"), "w")
        try:
            fcntl.flock(self.lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            fail(f"{self.folder}: another ./zwang campaign follows it")

    def run(self):
        self.take()
        folder = shlex.quote(self.folder)
        again = f"./zwang campaign --resume {folder}"
        try:
            complete = self.follow()
            if not complete:
                print(f"{len(self.unfinished())} of {self.record['tasks']} tasks are not finished and made no progress: see {folder}/logs, "
                      f"then {again}")
            code = self.finish()
        except KeyboardInterrupt:
            if self.active():
                stop = f"{'scancel ' if self.record['engine'] == 'slurm' else 'kill -- -'}{self.record['started'][-1]['id']}"
                print(f"The tasks go on. Come back with: {again}   (to end them: {stop})")
            else:
                print(f"Stopped; no task runs. Come back with: {again}")
            return STOPPED
        return code if complete else BAD_FILE


class Options(argparse.ArgumentParser):
    def error(self, message):
        fail(f"{message} (./zwang campaign --help)")


def number_from(kind, low, high=None, unit=""):
    words = f"a number from {low} to {high:,}" if high else f"a number from {low} on" if kind is int else f"a number above {low}{unit}"

    def read(text):
        try:
            value = kind(text)
        except ValueError:
            value = float("nan")
        if not (low <= value <= (high or float("inf")) and (kind is int or value > low)):
            raise argparse.ArgumentTypeError(f"{text} should be {words}")
        return value
    return read


def engine_named(name):
    if name not in ENGINES:
        close = difflib.get_close_matches(name, ENGINES, 1)
        fail(f"no engine '{name}'" + (f"; did you mean '{close[0]}'?" if close else "") + f" ({', '.join(ENGINES)})")
    return name


def asked_for(job, program, words):
    options = Options(
        prog="./zwang campaign", usage="./zwang campaign [SUITE] [OPTIONS]", allow_abbrev=False,
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, max_help_position=34, width=100),
        description="Runs a suite in tasks on a cluster or on this machine, joins their results, writes the report.",
        epilog="""Examples:
  ./zwang campaign big --engine slurm --tasks 64 --out big
  ./zwang campaign quick --engine parallel --tasks 8 --out runs --solvers nnls,pgs
  ./zwang campaign --resume big
The first word names a suite (./zwang bench --help); without one it is standard.
What is run is said as for ./zwang bench: --scenes, --problems, --solvers, --tolerances, ...""")
    options.add_argument("--engine", type=engine_named, default="local", metavar="WORD",
                         help="slurm, parallel (GNU parallel) or local (the default)")
    options.add_argument("--tasks", type=number_from(int, 1, 100000), default=1, metavar="N",
                         help="parts that the problems are dealt out to; from 1 to 100,000")
    options.add_argument("--at-once", type=number_from(int, 1), default=len(os.sched_getaffinity(0)),
                         metavar="N", help="tasks that run at a time; from 1 on; default: the cores of this machine")
    options.add_argument("--hours", type=number_from(float, 0, unit=" h"), default=4, metavar="H",
                         help="a task's time limit under Slurm; above 0 h; default: 4")
    options.add_argument("--timing", action="store_true", help="each task alone on its node (Slurm --exclusive), pinned to a core")
    options.add_argument("--out", metavar="DIR", help="folder of the campaign")
    options.add_argument("--resume", metavar="DIR", help="come back to a campaign: follow it, start what is missing")
    # After options of bench, which are passed on unread, their values would be taken for the suite.
    named = words[:1] if words and not words[0].startswith("-") else ()
    asked, rest = options.parse_known_args(words[len(named):])
    if asked.resume:
        if named or rest or asked.out:
            options.error("--resume DIR takes what is run from DIR")
        return Campaign.read(asked.resume).run()
    if not asked.out:
        options.error("a campaign needs a folder: --out DIR")
    if os.path.exists(os.path.join(asked.out, "campaign.json")):
        options.error(f"{asked.out} holds a campaign already: come back with ./zwang campaign --resume {shlex.quote(asked.out)}")
    suite = ["--suite", *(named or ("standard",)), *rest]
    plan = subprocess.run([program, "bench", *suite, "--shard", f"0/{asked.tasks}", "--plan"], capture_output=True, text=True)
    if plan.returncode:
        fail(plan.stderr.strip(), plan.returncode)
    require_engine(asked.engine)
    at_once = 1 if asked.timing and asked.engine != "slurm" else asked.at_once
    campaign = Campaign(asked.out, {"program": program, "suite": suite, "engine": asked.engine, "tasks": asked.tasks, "at_once": at_once,
                                    "timing": asked.timing, "hours": asked.hours, "started": []})
    try:
        campaign.write(job)
    except OSError as bad:
        fail(f"{bad.filename}: {bad.strerror}", BAD_FILE)
    print(f"{asked.tasks} tasks, {at_once} at a time: {campaign.at('job.sh')}", flush=True)
    return campaign.run()


def interrupt(*_):
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a second Ctrl-C ends the program at once
    raise KeyboardInterrupt


def main(job, program, *words):
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, interrupt)
    try:
        return asked_for(job, program, words)
    except KeyboardInterrupt:
        return STOPPED
