# `zwang live` with readers that keep up, send poses, die, and outlive it.
import os, re, signal, subprocess, sys, tempfile, time

program, reader = sys.argv[1:]
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "hand")
    run = lambda *words: subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    live = run(program, "live", "box", "--socket", path, "--rate", "500", "--seconds", "4")
    keeps_up, dies = run(reader, path, "600"), run(reader, path, "600")
    time.sleep(1.5)
    dies.kill()
    lowers = run(reader, path, "600", "lower")
    out, errors = live.communicate(timeout=300)
    time.sleep(1)
    keeps_up.terminate()
    said, _ = keeps_up.communicate(timeout=60)
    lowers.terminate()
    lowered, _ = lowers.communicate(timeout=60)
    dies.communicate()

assert live.returncode == 0, errors
assert re.search(r"^2,000 frames", out, re.M), out
assert re.search(r"a reader has left at frame \d+, which missed 0 frames", errors), errors
lines = re.findall(r"frame (\d+): (\d+) came, (\d+) missing, (\d+) answers, (\d+) us old", said)
assert len(lines) >= 2, said
assert all(missing == "0" for _, _, missing, _, _ in lines), said
assert sorted(int(age) for *_, age in lines)[len(lines) // 2] < 1000, said
assert re.search(r"zwang has gone after frame 1999; waiting for it", said), said
assert int(re.findall(r"(\d+) answers", lowered)[-1]) > 100, lowered

again = subprocess.run([program, "live", "box", "--socket", "/nowhere/at/all", "--seconds", "1"], capture_output=True, text=True)
assert again.returncode == 2 and again.stderr.count("\n") == 1, again.stderr
