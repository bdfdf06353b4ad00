"""`./zwang bench --gradients`: gradients as they are usually made against proven ones.

The program holds this text and runs it: python3 -c TEXT PROGRAM OUT SEED LAWS SCENES; LAWS and SCENES may be empty.
"""
import os
import pathlib
import sys

sys.path = [folder for folder in sys.path if folder]  # nothing of the folder where the user is
_, program, out, seed, laws, scenes = sys.argv
place = pathlib.Path(program).resolve().parent.parent  # of a build, or of an installation
sys.path += [str(place / "bench/python"), str(place / "lib/python3/dist-packages")]
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
try:
    import zwang
    from zwang import usual_gradients
except ImportError as missing:
    system = "/usr/bin/python3"
    if os.path.exists(system) and os.path.realpath(sys.executable) != os.path.realpath(system):
        os.execv(system, [system, "-c", sys.orig_argv[sys.orig_argv.index("-c") + 1], *sys.argv[1:]])
    print(f"bench --gradients needs the Python module, which ./zwang python builds: {missing}", file=sys.stderr)
    sys.exit(3)
folder = pathlib.Path(out)
try:
    found, kinks = usual_gradients.bench(folder, scenes or usual_gradients.SCENES, laws.split(",") if laws else usual_gradients.LAWS, int(seed),
                                         lambda line: print(line, file=sys.stderr, flush=True))
except KeyboardInterrupt:
    print(f"Stopped. What was compared is in {folder / 'gradients.csv'}", file=sys.stderr)
    sys.exit(130)
except ValueError as bad:
    print(bad, file=sys.stderr)
    sys.exit(3 if isinstance(bad, zwang.BadFile) else 2)
except OSError as bad:
    print(f"{bad.filename}: {bad.strerror}", file=sys.stderr)
    sys.exit(3)
print(usual_gradients.sentence(found, kinks))
print(f"Chart: {folder / 'gradients.svg'}, and gradients.csv")
