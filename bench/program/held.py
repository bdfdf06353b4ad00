"""Runs a script of several files that the program holds: python3 -c THIS COUNT NAME TEXT NAME TEXT ... ARGUMENTS.

A NAME.py may import those before it, and other texts from `held`; what runs is main(*ARGUMENTS) of the last.
"""
import os
import signal
import sys

if __name__ == "__main__":
    sys.path = [folder for folder in sys.path if folder]  # nothing of the folder where the user is

import types


def module(name, **members):
    sys.modules[name] = types.ModuleType(name)
    vars(sys.modules[name]).update(members)
    return sys.modules[name]


def end_by(main, *arguments):
    """Ends the program as main(*arguments) says: with its exit code, or where nobody reads on, or nothing can be written, as any other program."""
    try:
        try:
            code = main(*arguments)
        finally:
            if sys.stdout:  # else it is closed
                sys.stdout.flush()
    except BrokenPipeError:
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGPIPE)
    except OSError as bad:
        print(f"{bad.filename or 'output'}: {bad.strerror}", file=sys.stderr)
        os._exit(3)  # nothing is written once more
    sys.exit(code)


if __name__ == "__main__":
    count = int(sys.argv[1])
    given, arguments = sys.argv[2:2 + 2 * count], sys.argv[2 + 2 * count:]
    files = module("held", files=dict(zip(given[::2], given[1::2]))).files
    for name, text in files.items():
        if name.endswith(".py"):
            last = module(name.removesuffix(".py"))
            exec(compile(text, name, "exec"), vars(last))
    end_by(last.main, *arguments)
