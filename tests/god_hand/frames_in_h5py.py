"""h5py reads the frames of a run, with their units, also when the run was killed or met its limits.

Usage: frames_in_h5py.py WRITE_REPLAY PROGRAM
"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

write_replay, program = map(os.path.abspath, sys.argv[1:])


def simulate(*words):
    return subprocess.Popen([program, "simulate", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    os.environ["XDG_CACHE_HOME"] = folder

    listed = "(./zwang simulate --help lists all)"
    for words, says in ((["box", "--gap", "5e-3", "--activation", "1e-3"], "--gap 0.005 is above --activation 0.001"),
                        (["foo"], f"no scene 'foo' {listed}"), (["box", "--motion", "foo"], f"no motion 'foo' {listed}"),
                        (["box", "--god", "foo"], f"no god object 'foo' {listed}")):
        refused = simulate(*words)
        error = refused.communicate(timeout=60)[1]
        assert refused.returncode == 2 and says in error and error.count("\n") == 1, error

    # A fabricated run (write_replay.cpp) of 700 frames: one hand, three loose objects.
    subprocess.run([write_replay, "made", "700"], check=True, stdout=subprocess.DEVNULL)
    with h5py.File("made/frames.h5") as file:
        assert file["god"].shape == file["target"].shape == (700, 16, 7) and file["loose"].shape == (700, 3, 7)
        assert file["god"].attrs["unit"] == "m" and file["speed"].attrs["unit"] == "m/s"
        assert file["times"].attrs["meaning"].split(", ")[3] == "solve"
        assert np.allclose(np.linalg.norm(file["god"][..., 3:], axis=2), 1)
        assert list(file["n"][:]) == list(range(700)) and np.allclose(np.diff(file["t"][:]), 0.01)
        assert np.flatnonzero(file["held"][:]).tolist() == [60] and np.flatnonzero(file["stuck"][:]).tolist() == [90]
        assert file["contacts"][:].sum() == len(file["contact_point"]) == len(file["contact_push"]) > 0
        assert "0 unsolved, 1 solved" in file["claimed"].attrs["meaning"] and set(file["claimed"][:]) == {1}
        assert file["origin"].attrs["meaning"].endswith("5 held, 6 limited")

    # kill -9 in mid-run: the checkpoint's frames are there, and the resumed run has the numbers of one in one piece.
    options = ["box", "--motion", "lift", "--pads", "5000", "--frames", "2300", "--verify", "0"]
    whole = simulate(*options, "--out", "whole")
    whole.communicate(timeout=300)
    assert whole.returncode == 0
    killed = simulate(*options, "--out", "killed")
    deadline = time.time() + 120
    while not os.path.exists("killed/checkpoint.h5") and time.time() < deadline:
        time.sleep(0.002)
    time.sleep(0.05)
    killed.send_signal(signal.SIGKILL)
    killed.communicate(timeout=60)
    with h5py.File("killed/checkpoint.h5") as file:
        done = int(file["frames"][0])
    with h5py.File("killed/frames.h5", swmr=True) as file:
        there = len(file["n"])
    assert 500 <= done <= there < 2300, (done, there)
    resumed = simulate("--resume", "killed")
    out, error = resumed.communicate(timeout=300)
    assert resumed.returncode == 0, error
    with h5py.File("whole/frames.h5") as one, h5py.File("killed/frames.h5") as other:
        assert set(one) == set(other)
        for name in one:
            assert name == "times" or np.array_equal(one[name][:], other[name][:], equal_nan=True), name

    # Solves of one iteration: frames that press are limited, and counted so.
    limited = simulate("box", "--motion", "slide", "--frames", "2300", "--verify", "0", "--iterations", "1", "--out", "limited")
    out, error = limited.communicate(timeout=300)
    with h5py.File("limited/frames.h5") as file, open("limited/summary.json") as summary:
        count = int((file["origin"][:] == 6).sum())
        assert limited.returncode == 0 and count > 0, error
        assert file["gap"][:].min() >= 0 and file["joint"][:].max() <= 1e-9
        assert f"{count:,} limited" in out and json.load(summary)["origins"]["limited"] == count
    for words in [["--budget", "-1"], ["--budget", "abc"], ["--mu", "0", "--pads", "1000"]]:
        wrong = simulate("box", *words)
        out, error = wrong.communicate(timeout=60)
        assert wrong.returncode == 2 and out == "" and error.count("\n") == 1 and words[-2] in error, (out, error)
    os.chdir("/")
