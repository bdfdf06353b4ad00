"""bridge.py [HOST:]PORT [WEB_PORT]: browsers' hand tracking to `./zwang live SCENE --listen PORT`, of Python alone.

Serves the page at http://localhost:WEB_PORT (8080), and a WebSocket there. The page sends float32: a number, and for each hand of `live`,
the right one first, 25 joints of 7: position [m], quaternion x y z w; NaN where it is not tracked. Back comes the first frame of `live`
that follows them, as docs/stream.md has it, or a text that says what is wrong.
"""
import asyncio, base64, contextlib, hashlib, json, pathlib, struct, sys, time
from joints import bones, poses_of

header = struct.Struct("<IHHQdqQIIIIQ")  # magic, version, kind, number, time, sent, answers, bodies, loose, contacts, flags, 0


def between(a, b, s):
    """The pose that is a share s of the way from a to b; b where a is not tracked."""
    sign = 1 if sum(x * y for x, y in zip(a[3:], b[3:])) > 0 else -1  # q and -q turn alike
    return b if a[0] != a[0] else [x + s * (y - x) for x, y in zip((*a[:3], *(sign * x for x in a[3:])), b)]


async def receive(reader):
    """The next WebSocket message of a browser (RFC 6455); None: it closes."""
    first, second = await reader.readexactly(2)
    size = second & 127
    if size > 125:
        size = int.from_bytes(await reader.readexactly(2 if size == 126 else 8), "big")
    mask, data = await reader.readexactly(4), await reader.readexactly(size)
    return bytes(byte ^ mask[i % 4] for i, byte in enumerate(data)) if first & 15 == 2 else None


def message(data):
    """A WebSocket message, of text or of bytes."""
    kind, data = (0x81, data.encode()) if isinstance(data, str) else (0x82, data)
    form, *size = ("B", len(data)) if len(data) < 126 else ("BH", 126, len(data)) if len(data) < 65536 else ("BQ", 127, len(data))
    return struct.pack(">B" + form, kind, *size) + data


async def pass_on(reader, writer, live_reader, live_writer):
    """Joints to live, in its 1,000 steps a second from the last ones to the newest, so that a tracker's 72 are no jerks; frames back."""
    number, answered, start, sent, newest, came, interval = 0, True, [], [], [], 0, 0.05

    async def from_page():
        nonlocal number, answered, start, newest, came, interval
        while (data := await receive(reader)) is not None:
            number, *values = struct.unpack(f"<{len(data) // 4}f", data)
            hands = [[values[k + j:k + j + 7] for j in range(0, 175, 7)] for k in range(0, len(values), 175)]
            newest = [pose for k, hand in enumerate(hands) for pose in poses_of(hand, left=k == 1)]
            now, start, answered = time.monotonic(), sent or newest, False
            interval, came = interval + 0.2 * (min(now - came, 0.2) - interval), now  # their mean: two that come at once are no jerk

    async def from_live():
        nonlocal answered, sent
        rest = b""
        while data := await live_reader.read(1 << 20):
            rest, frame = rest + data, None
            while len(rest) >= header.size:
                magic, version, kind, *_, answers, bodies, loose, contacts, _, _ = header.unpack_from(rest)
                if (magic, version, kind) != (0x646f677a, 1, 1) or bodies not in (16, 32):
                    return f"live has {bodies} god objects; expected a hand (16) or two (32), and version 1 of the stream"
                if len(rest) < (size := header.size + 160 * bodies + 56 * loose + 72 * contacts):
                    break
                frame, follows, rest = rest[:size], answers, rest[size:]  # the newest counts
            if frame and not answered and follows >= number:
                answered = True
                writer.write(message(frame))
            if frame and newest:
                share = min((time.monotonic() - came) / interval, 1)
                sent = [between(a, b, share) for a, b in zip(start, newest)]
                live_writer.write(header.pack(magic, 1, 2, int(number), 0, 0, 0, len(sent), 0, 0, 0, 0)
                                  + b"".join(struct.pack("<7d", *pose) for pose in sent))
        return f"live has ended: {start_live}"

    tasks = [asyncio.create_task(work()) for work in (from_page, from_live)]
    await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
    if tasks[1].done():
        writer.write(message(f"live has ended: {start_live}" if tasks[1].exception() else tasks[1].result()))
    for task in tasks:
        task.cancel()


async def serve(reader, writer):
    """One connection of a browser: the page, its data, or the WebSocket."""
    request, *lines = (await reader.readuntil(b"\r\n\r\n")).decode("latin-1").split("\r\n")
    fields = {name.lower(): value for name, _, value in (line.partition(": ") for line in lines)}
    if "sec-websocket-key" in fields and fields.get("origin", "").endswith("//" + fields.get("host", "")):  # no other site's page
        digest = hashlib.sha1(fields["sec-websocket-key"].encode() + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest()
        writer.write(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: "
                     + base64.b64encode(digest) + b"\r\n\r\n")
        try:
            live_reader, live_writer = await asyncio.open_connection(host, int(port))
            await pass_on(reader, writer, live_reader, live_writer)
            live_writer.close()
        except OSError:
            writer.write(message(f"live is not there: {start_live}"))
    else:
        name = {"/": "page.html", "/joints.json": "joints.json"}.get(request.split()[1])
        body = pathlib.Path(__file__).with_name(name).read_bytes() if name else json.dumps(bones).encode()
        writer.write(f"HTTP/1.1 200 OK\r\nContent-Type: text/html; charset=utf-8\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body)
    with contextlib.suppress(ConnectionError):  # the browser has left
        await writer.drain()
    writer.close()


async def main():
    server = await asyncio.start_server(serve, "127.0.0.1", web_port)
    print(f"http://localhost:{server.sockets[0].getsockname()[1]}/ for live at {host}:{port}; Ctrl-C ends it", flush=True)
    await server.serve_forever()


if __name__ == "__main__":
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__.splitlines()[0])
    host, _, port = sys.argv[1].rpartition(":")
    host, web_port = host or "127.0.0.1", int(sys.argv[2]) if len(sys.argv) > 2 else 8080
    start_live = f"./zwang live box --listen {port}"
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(main())
