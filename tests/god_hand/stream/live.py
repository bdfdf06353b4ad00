# `zwang live` with readers that keep up, send poses, die, and outlive it, over a local socket and over TCP; its choices; wrong use.
import os, re, socket, struct, subprocess, sys, tempfile, threading, time

program, reader, client = sys.argv[1:]
run = lambda *words: subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def port_of(live):
    """Its head lines are read."""
    for line in live.stdout:
        if found := re.search(r"127\.0\.0\.1:(\d+)", line):
            return int(found[1])


with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "hand")
    live = run(program, "live", "box", "--socket", path, "--listen", "0", "--rate", "500", "--seconds", "4")
    port = port_of(live)
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
    late = re.search(r"^2,000 frames at 500 Hz, ([\d,]+) late: ([\d,]+) took longer than 2 ms, ([\d,]+) came after a late one, "
                     r"for ([\d,]+) the processor was busy$", out, re.M)
    counts = [int(n.replace(",", "")) for n in late.groups()]
    assert counts[0] == sum(counts[1:]), out
    assert re.search(r"^median [\d.]+ ms a step \(.*collision \d+ %.*\), 99th percentile [\d.]+ ms, worst [\d.]+ ms \(CPU\)", out, re.M), out
    assert re.search(r"a reader has left at frame \d+, which missed 0 frames", errors), errors
    lines = re.findall(r"frame (\d+): (\d+) came, (\d+) missing, (\d+) answers, (\d+) us old", said)
    assert len(lines) >= 2, said
    assert all(missing == "0" for _, _, missing, _, _ in lines), said
    assert sorted(int(age) for *_, age in lines)[len(lines) // 2] < 1000, said
    assert re.search(r"zwang has gone after frame 1999; waiting for it", said), said
    assert int(re.findall(r"(\d+) answers", lowered)[-1]) > 100, lowered

    # The same frames over both, while a Python client moves the hand over TCP.
    live = run(program, "live", "box", "--socket", path, "--listen", "0", "--rate", "500", "--seconds", "4", "--mu", "0", "--god", "gripper")
    port = port_of(live)
    local, tcp = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET), socket.create_connection(("127.0.0.1", port))
    local.connect(path)
    frames = {"local": {}, "tcp": {}}

    def read_local():
        while message := local.recv(1 << 20):
            frames["local"][struct.unpack_from("<Q", message, 8)[0]] = message

    def read_tcp():
        stream = tcp.makefile("rb")
        while len(head := stream.read(64)) == 64:
            bodies, loose, contacts = struct.unpack_from("<III", head, 40)
            message = head + stream.read(160 * bodies + 56 * loose + 72 * contacts)
            frames["tcp"][struct.unpack_from("<Q", message, 8)[0]] = message

    threads = [threading.Thread(target=read_local), threading.Thread(target=read_tcp)]
    for thread in threads:
        thread.start()
    moves = subprocess.run([sys.executable, client, str(port)], capture_output=True, text=True, timeout=300)
    out, errors = live.communicate(timeout=300)
    for thread in threads:
        thread.join()
    assert live.returncode == 0 and moves.returncode == 0, errors + moves.stderr
    felt = re.findall(r"frame \d+: \d+000 came, follows frame [1-9]\d*, palm ([\d.]+) N", moves.stdout)
    assert max(map(float, felt)) > 0.1, moves.stdout
    both = frames["local"].keys() & frames["tcp"].keys()
    assert len(both) > 1500, {name: len(all) for name, all in frames.items()}
    assert all(frames["local"][number] == frames["tcp"][number] for number in both)
    assert any(struct.unpack_from("<Q", frames["tcp"][number], 32)[0] > 0 for number in both), "no frame follows the client"
    assert all(struct.unpack_from("<I", frames["tcp"][number], 40)[0] == 3 for number in both), "a gripper has three bodies"

for words in (["--socket", "/nowhere/at/all"], [], ["--listen", "70000"], ["--listen", "0", "--mu", "-1"], ["--listen", "0", "--god", "griper"],
              ["--listen", "0", "--law", "coulob"], ["--listen", "0", "--verify", "1"], ["--listen", "0", "--solver", "nnls"],
              ["--listen", "0", "--motion", "lif"], ["--listen", "0", "--sub-steps", "0"], ["--listen", "0", "--method", "papr"]):
    wrong = subprocess.run([program, "live", "box", "--seconds", "1", *words], capture_output=True, text=True)
    assert wrong.returncode == (0 if "nnls" in words else 2), (words, wrong)
    assert wrong.returncode == 0 or wrong.stderr.count("\n") == 1, (words, wrong.stderr)
