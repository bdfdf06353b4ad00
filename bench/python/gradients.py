"""`./zwang bench --gradients`: gradients as they are usually made against proven ones. The program holds this text (held.py)."""
import os
import pathlib
import sys


def module(program):
    """zwang.usual_gradients, of the build or the installation that the program belongs to; by the system's Python where the shell's has none."""
    place = pathlib.Path(program).resolve().parent.parent
    sys.path += [str(place / "bench/python"), str(place / "lib/python3/dist-packages")]
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        from zwang import usual_gradients
    except ImportError as missing:
        system = "/usr/bin/python3"
        if os.path.exists(system) and os.path.realpath(sys.executable) != os.path.realpath(system):
            os.execv(system, [system, *sys.orig_argv[1:]])
        sys.exit(say(f"bench --gradients needs the Python module, which ./zwang python builds: {missing}", 3))
    return usual_gradients


def say(line, code=0):
    print(line, file=sys.stderr, flush=True)
    return code


def main(program, out, seed, laws, scenes):
    """laws, scenes: "" for those that are asked by default."""
    usual, folder = module(program), pathlib.Path(out)
    try:
        found, kinks = usual.bench(folder, scenes or usual.SCENES, laws.split(",") if laws else usual.LAWS, int(seed), say)
    except KeyboardInterrupt:
        sys.exit(say(f"Stopped. What was compared is in {folder / 'gradients.csv'}", 130))
    except ValueError as bad:
        sys.exit(say(bad, 3 if type(bad).__name__ == "BadFile" else 2))
    except OSError as bad:
        sys.exit(say(f"{bad.filename}: {bad.strerror}", 3))
    print(usual.sentence(found, kinks))
    print(f"Chart: {folder / 'gradients.svg'}, and gradients.csv")
