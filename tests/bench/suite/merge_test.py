"""merge: parts make the whole; what does not belong together is refused by name; damage and disagreement are told.

Usage: merge_test.py PROGRAM
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import zlib

import h5py

from campaign_support import assert_equal, run, suite

program = os.path.abspath(sys.argv[1])


def refused(change, expected):
    """A part whose run.json was changed is refused in one line that names the reason."""
    shutil.rmtree("other", ignore_errors=True)
    shutil.copytree("part1", "other")
    with open("other/run.json") as file:
        record = json.load(file)
    change(record)
    with open("other/run.json", "w") as file:
        json.dump(record, file)
    done = subprocess.run([program, "merge", "part0", "other", "--out", "none"], capture_output=True, text=True)
    assert done.returncode == 3 and done.stderr.count("\n") == 1 and expected in done.stderr, done
    assert not os.path.exists("none/results.jsonl")


def change_line(folder, key, value):
    """The first line with another value and a check that fits it."""
    with open(f"{folder}/results.jsonl") as file:
        lines = file.read().split("\n")
    line = json.loads(lines[0])
    line[key] = value
    del line["check"]
    text = json.dumps(line, separators=(",", ":"), ensure_ascii=False)[:-1]
    lines[0] = f'{text},"check":"{zlib.crc32(text.encode()):08x}"}}'
    with open(f"{folder}/results.jsonl", "w") as file:
        file.write("\n".join(lines))


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder
    words = suite(8)
    run([program, "bench", *words, "--out", "whole"])
    for k in range(3):
        run([program, "bench", *words, "--shard", f"{k}/3", "--out", f"part{k}"])
    out = run([program, "merge", "part2", "part0", "part1", "--out", "joined"])
    assert "72 of 72 runs" in out, out
    assert_equal("whole", "joined")
    assert "0 of 72 runs are missing" in run([program, "bench", "--missing", "joined"])

    # Twice and alike; the whole run among its parts.
    assert "24 of them twice and alike" in run([program, "merge", "whole", "part1", "--out", "twice"])
    assert_equal("whole", "twice")

    # A part that is not there.
    out = run([program, "merge", "part0", "part1", "--out", "less"])
    assert "48 of 72 runs" in out and "24 runs are missing: ./zwang bench --missing less" in out, out
    listed = run([program, "bench", "--missing", "less"], 1)
    assert listed.count("problems/") == 24 and "24 of 72 runs are missing" in listed, listed
    run([program, "bench", "--resume", "less"])
    assert "0 of 72 runs are missing" in run([program, "bench", "--missing", "less"])

    # A torn end and a damaged middle.
    shutil.copytree("part1", "hurt")
    with open("hurt/results.jsonl", "r+b") as file:
        text = file.read()
        lines = text.split(b"\n")
        lines[3] = lines[3].replace(b"solver", b"sOlver", 1)
        file.seek(0)
        file.write(b"\n".join(lines)[:-50])
        file.truncate()
    out = run([program, "merge", "part0", "hurt", "part2", "--out", "mended"])
    assert "70 of 72 runs, 2 damaged lines left out" in out, out
    run([program, "bench", "--resume", "hurt"])
    run([program, "merge", "part0", "hurt", "part2", "--out", "whole_again"])
    assert_equal("whole", "whole_again")

    # A damaged problem file is not taken where another part has a good one, and is named where none has.
    shutil.copytree("whole", "bad")
    with open("bad/problems/0001.h5", "r+b") as file:
        file.truncate(200)
    run([program, "merge", "bad", "part1", "--out", "taken"])
    run([program, "solve", "taken/problems/0001.h5", "--solver", "nnls"])
    assert "problems/0001.h5 is missing or damaged in every part" in run([program, "merge", "bad", "--out", "named"])

    # Curves of parts that overlap are each there once, and what is torn is left out.
    for k in range(2):
        run([program, "bench", *suite(1), "--trace", "--shard", f"{k}/2", "--out", f"traced{k}"])
    with open("traced1/traces.jsonl", "a") as file:
        file.write('{"problem":"tower')
    with open("traced0/traces.jsonl") as one, open("traced1/traces.jsonl") as other:
        points = sorted(one.readlines() + other.readlines()[:-1])
    run([program, "merge", "traced1", "traced0", "traced1", "--out", "traced"])
    with open("traced/traces.jsonl") as file:
        assert len(points) > 3 and sorted(file) == points

    # The phenomena are the first part's.
    for k in range(2):
        run([program, "bench", "--suite", "quick", "--families", "tower", "--solvers", "nnls", "--accuracy", "--shard", f"{k}/2", "--out", f"quick{k}"])
    assert os.path.getsize("quick0/conformance.jsonl") > 0 and not os.path.exists("quick1/conformance.jsonl")
    run([program, "merge", "quick1", "quick0", "--out", "quick"])
    with open("quick0/conformance.jsonl") as one, open("quick/conformance.jsonl") as other:
        assert one.read() == other.read()

    # So are sequences of frames, which are timed whole.
    frames = ["--scenes", "FLIP(k=3,frame=0..3)", "--solvers", "nnls", "--tolerances", "1e-6", "--sequence"]
    for k in range(2):
        run([program, "bench", *frames, "--shard", f"{k}/2", "--out", f"frames{k}"])
    assert os.path.getsize("frames0/speed.jsonl") > 0 and not os.path.exists("frames1/speed.jsonl")
    run([program, "merge", "frames1", "frames0", "--out", "frames"])
    with open("frames0/speed.jsonl") as one, open("frames/speed.jsonl") as other:
        assert one.read() == other.read()

    # Disagreement.
    shutil.copytree("part1", "differs")
    change_line("differs", "iterations", 123456)
    out = run([program, "merge", "part1", "differs", "--out", "told"], 1)
    assert "part1 and differs disagree in iterations" in out, out

    # Another machine is told, and its times are not mixed with the others'.
    shutil.copytree("part1", "elsewhere")
    change_line("elsewhere", "machine", "Another CPU")
    out = run([program, "merge", "part0", "elsewhere", "part2", "--out", "machines"])
    assert "1 runs on Another CPU" in out and "71 runs on " in out, out
    with open("machines/run.json") as file:
        assert any("2 kinds of machine" in note for note in json.load(file)["notes"])

    # Answers that came with their problems are judged in every part, and stay.
    for k in (1, 2):
        run([program, "export", "tower", f"--boxes={k}", "--out", f"with{k}.h5"])
        with h5py.File(f"with{k}.h5", "r+") as file:
            given = file["zwang"].create_group("recorded")
            given["by"] = ["somebody", "nobody"]
            given["z"] = [file["zwang/z_u"][:], 0 * file["zwang/z_u"][:]]
    words = ["--problems", "with1.h5", "with2.h5", "--solvers", "pgs,nnls", "--tolerances", "1e-3,1e-6"]
    run([program, "bench", *words, "--out", "judged"])
    for k in range(2):
        run([program, "bench", *words, "--shard", f"{k}/2", "--out", f"judged{k}"])
    out = run([program, "merge", "judged1", "judged0", "--out", "judged_again"])
    assert "8 of 8 runs, 4 recorded answers" in out and "damaged" not in out, out
    assert_equal("judged", "judged_again")
    assert "8 of 8 runs, 8 of them twice and alike, 4 recorded answers" in run([program, "merge", "judged", "judged0", "judged1", "--out", "once"])
    assert_equal("judged", "once")
    assert "0 of 8 runs are missing" in run([program, "bench", "--missing", "once"])

    refused(lambda r: r.update(commit="another"), 'does not mix with part0: commit "another", not ')
    refused(lambda r: r["options"].update(tolerances=[1e-3]), "does not mix with part0: tolerances [0.001], not ")
    refused(lambda r: r["problem_sha256"].__setitem__(1, "0" * 64), "its problems/0001.h5 is another problem of the name random")
    refused(lambda r: r["options"].update(solvers="pgs"), "does not mix with part0: solvers ")
    refused(lambda r: r.pop("problem_names"), "other/run.json: ")
    os.chdir("/")
