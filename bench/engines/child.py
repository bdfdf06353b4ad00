"""An engine in a process of its own: questions in, answers out, each with a deadline."""
import json
import os
import pathlib
import selectors
import signal
import subprocess
import tempfile
import time


class Failure(Exception):
    """Why there is no answer; `lost`: the process is gone; `late`: its time was over."""

    def __init__(self, why, lost=True, late=False):
        super().__init__(why)
        self.lost, self.late = lost, late


def one_line(text):
    return "".join(c if c.isprintable() else " " for c in text)[:200].strip()


class Child:
    """`apart`: in a folder of its own, where it may leave what it likes."""

    def __init__(self, command, environment, deadline, apart=False):
        self.folder, self.talk = tempfile.TemporaryDirectory() if apart else None, tempfile.TemporaryFile()
        try:
            self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.talk,
                                            env={**os.environ, **environment}, cwd=self.folder.name if apart else None, start_new_session=True)
        except OSError as error:
            raise Failure(f"cannot be started: {error.strerror}")
        os.set_blocking(self.process.stdout.fileno(), False)
        self.rest = b""
        self.allow(deadline)
        self.hello = self.read()

    def allow(self, seconds):
        """From now on the process has so long, not counting the time for which it stands ready and others have the processor."""
        self.seconds, self.end = seconds, time.monotonic() + seconds - self.stood()

    def stood(self):
        try:
            return int(pathlib.Path(f"/proc/{self.process.pid}/schedstat").read_text().split()[1]) * 1e-9
        except (OSError, IndexError):  # not every kernel counts it
            return 0.0

    def left(self):
        return self.end + self.stood() - time.monotonic()

    def ask(self, question):
        self.talk.seek(0)  # for the process, too
        self.talk.truncate()
        try:
            self.process.stdin.write(json.dumps(question).encode() + b"\n")
            self.process.stdin.flush()
        except OSError:
            raise Failure(self.why_ended())
        return self.read()

    def read(self):
        with selectors.DefaultSelector() as selector:
            selector.register(self.process.stdout, selectors.EVENT_READ)
            pieces = [self.rest]
            while b"\n" not in pieces[-1]:
                if not selector.select(max(0, self.left())):
                    if self.left() > 0:
                        continue
                    self.close()
                    raise Failure(f"no answer in {self.seconds:g} s", late=True)
                piece = self.process.stdout.read()
                if piece == b"":
                    raise Failure(self.why_ended())
                pieces.append(piece or b"")
        line, _, self.rest = b"".join(pieces).partition(b"\n")
        try:
            answer = json.loads(line)
        except ValueError:
            answer = None
        if not isinstance(answer, dict):
            self.close()
            raise Failure("an answer that is not the protocol's")
        if "error" in answer:
            self.close()
            raise Failure(f"fails: {one_line(str(answer['error']))}")
        if "absent" in answer:
            raise Failure(f"has no {answer['absent']}", lost=False)
        return answer

    def why_ended(self):
        try:
            code = self.process.wait(max(0.1, self.left()))
        except subprocess.TimeoutExpired:
            code = 0
        self.talk.seek(max(0, self.talk.seek(0, os.SEEK_END) - 2000))
        last = self.talk.read().decode(errors="replace").strip().rpartition("\n")[2]
        self.close()
        return (f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with exit code {code}") + (f": {one_line(last)}" if last else "")

    def close(self):
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout, self.talk):
            try:
                pipe.close()
            except OSError:  # what it was still to be told
                pass
        if self.folder:
            self.folder.cleanup()
