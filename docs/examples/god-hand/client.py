"""client.py [HOST:]PORT [SECONDS]: a client of `./zwang live SCENE --listen PORT`, of Python alone. It reads every frame, sends the
hand 170 mm down, onto what lies there, and up again, and says once a second the most that a device would have shown at the palm."""
import contextlib, math, socket, struct, sys, time

host, _, port = sys.argv[1].rpartition(":")
seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 60
while True:  # until it is there
    try:
        live = socket.create_connection((host or "127.0.0.1", int(port)))
        break
    except ConnectionRefusedError:
        time.sleep(0.1)
live.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
stream = live.makefile("rb")
header = struct.Struct("<IHHQdqQIIIIQ")  # magic, version, kind, number, time, sent, answers, bodies, loose, contacts, flags, 0
start, begun, frames, felt = None, time.monotonic(), 0, 0.0
with contextlib.suppress(ConnectionError):  # zwang has gone
    while time.monotonic() < begun + seconds and len(head := stream.read(header.size)) == header.size:
        magic, version, kind, number, t, sent, answers, bodies, loose, contacts, flags, _ = header.unpack(head)
        assert (magic, version, kind) == (0x646f677a, 1, 1), "not frames of this version"
        body = [struct.unpack("<20d", stream.read(160)) for _ in range(bodies)]  # god object 7, target 7, force 3, torque 3
        stream.read(56 * loose + 72 * contacts)
        start = start or [b[7:14] for b in body]
        down = 0.085 * (1 - math.cos(2 * (time.monotonic() - begun)))  # m
        poses = [struct.pack("<7d", x, y, z - down, *turn) for x, y, z, *turn in start]
        live.sendall(header.pack(magic, version, 2, number, 0, 0, 0, bodies, 0, 0, 0, 0) + b"".join(poses))
        frames, felt = frames + 1, max(felt, math.hypot(*body[0][14:17]))
        if frames % 1000 == 0:
            print(f"frame {number}: {frames} came, follows frame {answers}, palm {felt:.2f} N", flush=True)
            felt = 0.0
