"""Small sound files of every format that the program reads, and the command that reads each. The table of formats is
`formats`; a new format is an entry there."""
import gzip
import json
import math
import os
import shutil
import struct
import subprocess
import sys

import h5py
import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "core", "files"))
import fclib_files  # noqa: E402


class Format:
    """bases: sound files, or folders of which `victims` names the files that are damaged (by their extensions).
    command: the words for the program; FILE and DIR stand for the damaged file and its folder. fine: the exit codes of
    a file that is read."""

    def __init__(self, name, bases, command, victims=(), packed=False, fine=(0,)):
        self.name, self.bases, self.command, self.endings, self.packed = name, bases, command, victims, packed
        self.fine = fine

    def victims(self, base):
        if not os.path.isdir(base):
            return [""]
        found = [os.path.relpath(os.path.join(at, name), base) for at, _, names in os.walk(base) for name in names]
        return sorted(name for name in found if name.endswith(tuple(self.endings)))

    def words(self, file, folder="base"):
        return [word.replace("FILE", file).replace("DIR", folder) for word in self.command]

    def damage(self, random, data, mutated):
        """Of a packed file the contents, or else the packing."""
        if self.packed and random.random() < 0.7:
            return gzip.compress(mutated(random, gzip.decompress(data)), 1)
        return mutated(random, data)


def sphere(rings=6, sides=8):
    """Vertices and triangles of a ball of radius 1."""
    vertices = [(0, 0, 1), (0, 0, -1)]
    for i in range(1, rings):
        for k in range(sides):
            a, b = math.pi * i / rings, 2 * math.pi * k / sides
            vertices.append((math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)))
    at = lambda i, k: 2 + (i - 1) * sides + k % sides  # noqa: E731
    triangles = []
    for k in range(sides):
        triangles += [(0, at(1, k), at(1, k + 1)), (1, at(rings - 1, k + 1), at(rings - 1, k))]
        for i in range(1, rings - 1):
            triangles += [(at(i, k), at(i + 1, k), at(i + 1, k + 1)), (at(i, k), at(i + 1, k + 1), at(i, k + 1))]
    return vertices, triangles


def stl_binary(v, t):
    records = b"".join(struct.pack("<12fH", 0, 0, 0, *v[a], *v[b], *v[c], 0) for a, b, c in t)
    return b"a ball".ljust(80) + struct.pack("<I", len(t)) + records


def stl_text(v, t):
    corner = lambda i: "      vertex %g %g %g\n" % v[i]  # noqa: E731
    facets = "".join(f"  facet normal 0 0 0\n    outer loop\n{corner(a)}{corner(b)}{corner(c)}    endloop\n  endfacet\n"
                     for a, b, c in t)
    return f"solid ball\n{facets}endsolid ball\n".encode()


def obj(v, t):
    return ("mtllib absent.mtl\no ball\n" + "".join("v %g %g %g\n" % p for p in v) + "vn 0 0 1\n"
            + "".join("f %d//1 %d//1 %d//1\n" % (a + 1, b + 1, c + 1) for a, b, c in t)).encode()


def ply(v, t, form):
    head = (f"ply\nformat {form} 1.0\ncomment a ball\nelement vertex {len(v)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(t)}\nproperty list uchar int vertex_indices\nend_header\n").encode()
    if form == "ascii":
        return head + "".join("%g %g %g\n" % p for p in v).encode() + "".join("3 %d %d %d\n" % f for f in t).encode()
    order = "<" if form == "binary_little_endian" else ">"
    return head + b"".join(struct.pack(order + "3f", *p) for p in v) + b"".join(
        struct.pack(order + "B3i", 3, *f) for f in t)


def glb(v, t):
    points = b"".join(struct.pack("<3f", *p) for p in v)
    indices = b"".join(struct.pack("<3H", *f) for f in t)
    binary = points + indices + b"\0" * (-len(indices) % 4)
    scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
             "nodes": [{"mesh": 0, "translation": [0, 0, 1], "children": [1]}, {"mesh": 0, "scale": [2, 1, 1]}],
             "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
             "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(v), "type": "VEC3",
                            "min": [-1, -1, -1], "max": [1, 1, 1]},
                           {"bufferView": 1, "componentType": 5123, "count": 3 * len(t), "type": "SCALAR"}],
             "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(points)},
                             {"buffer": 0, "byteOffset": len(points), "byteLength": len(indices)}],
             "buffers": [{"byteLength": len(binary)}]}
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    return (struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON")
            + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def dxf(v, t):
    faces = "".join("  0\n3DFACE\n  8\n0\n" + "".join(
        f" 1{k}\n{v[i][0]:g}\n 2{k}\n{v[i][1]:g}\n 3{k}\n{v[i][2]:g}\n" for k, i in enumerate((a, b, c, c)))
        for a, b, c in t)
    return f"  0\nSECTION\n  2\nENTITIES\n{faces}  0\nENDSEC\n  0\nEOF\n".encode()


def leap(frames=12):
    """A right hand that sinks, its fingers straight."""
    rows = [["id", "timestamp", {"hands": [["id", "type", "direction", "palmNormal", "palmPosition"]]},
             {"pointables": [["id", "handId", "tool", "mcpPosition", "pipPosition", "dipPosition", "btipPosition"]]}]]
    for n in range(frames):
        height, bend = 200 - n, 0.05 * n
        fingers = []
        for f in range(5):
            x, z, joints = 20 * (f - 2), -40 if f else 0, []
            for length in (0, 40, 28, 20):
                x, z = x + (length * -0.5 if f == 0 else 0), z - length * (0.8 if f == 0 else 1)
                joints.append([x, height - bend * (-z), z])
            fingers.append([10 + f, 7, False] + joints)
        rows.append([n, 1000000 + 17500 * n, [[7, "right", [0, 0, -1], [0, -1, 0], [0, height, 0]]], fingers])
    return json.dumps({"metadata": {"formatVersion": 2}, "frames": rows}).encode()


def table(columns, rows):
    return (",".join(columns) + "\n" + "\n".join(",".join("%.6g" % x for x in row) for row in rows) + "\n").encode()


def angles(prefixes=("",)):
    names = ["palm_x", "palm_y", "palm_z", "palm_qw", "palm_qx", "palm_qy", "palm_qz"] + [
        f"thumb_{j}" for j in ("CMC_flexion", "CMC_abduction", "MCP", "IP")] + [
        f"{f}_{j}" for f in ("index", "middle", "ring", "little")
        for j in ("MCP_flexion", "MCP_abduction", "PIP", "DIP")]
    return table(["time"] + [p + name for p in prefixes for name in names],
                 [[0.01 * k] + len(prefixes) * ([0.01 * k, 0.2, 0.3, 0.8, 0, 0.6, 0] + 20 * [0.02 * k])
                  for k in range(12)])


def adroit():
    names = ["step", "ARRx", "ARRy", "ARRz", "palm_x", "palm_y", "palm_z", "WRJ1", "WRJ0", "LFJ4"] + [
        f"{f}FJ{k}" for f in "FMRL" for k in range(4)] + [f"THJ{k}" for k in range(5)]
    return table(names, [[k, 0, 0, 0, 0.01 * k, 0.1, 0.2, 0, 0, 0] + 16 * [0.1] + 5 * [0] for k in range(12)])


def make(program, folder, words):
    environment = {**os.environ, "XDG_CACHE_HOME": os.path.join(folder, "cache")}
    subprocess.run([program] + words, cwd=folder, env=environment, check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL)


def stopped_suite(program, folder):
    """Half of a suite's runs are still to be done."""
    make(program, folder, ["bench", "--scenes", "tower(boxes=2,3)", "--solvers", "nnls,pgs", "--tolerances", "1e-6",
                           "--repetitions", "1", "--trace", "--out", "suite"])
    run = os.path.join(folder, "suite")
    with open(os.path.join(run, "results.jsonl")) as file:
        lines = file.readlines()
    stopped = shutil.copytree(run, os.path.join(folder, "stopped_suite"))
    for name in (run, stopped):
        os.remove(os.path.join(name, "report.html"))
    with open(os.path.join(stopped, "results.jsonl"), "w") as file:
        file.writelines(lines[:2])
    edit_record(stopped, lambda record: record.update(finished=None))
    return run, stopped


def stopped_simulation(program, folder):
    """Three frames behind its checkpoint are there, two are still to be done."""
    make(program, folder, ["simulate", "box", "--motion", "press", "--frames", "503", "--verify", "0", "--out", "frames"])
    run = os.path.join(folder, "frames")
    for name in ("replay.html", "summary.json"):
        os.remove(os.path.join(run, name))
    edit_record(run, lambda record: record.update(finished=None, frames=505))
    return run


def answers(program, folder):
    """A pack, and answers to it as lines of JSON, as numpy.savez (and savez_compressed) and as HDF5."""
    make(program, folder, ["pack", "tower(boxes=2,3),incline(mu=0.5)", "--out", "pack"])
    make(program, folder, ["solve-pack", "pack", "--solver", "cone", "--out", "answers.jsonl"])
    lines, plain, packed, tree = (os.path.join(folder, "answers" + end) for end in (".jsonl", ".npz", "_packed.npz", ".h5"))
    with open(lines) as file:
        head, *records = map(json.loads, file)
    arrays = {**head, **{r["sha256"] + "/" + key: r[key] for r in records for key in r if key != "sha256"}}
    numpy.savez(plain, **arrays)
    numpy.savez_compressed(packed, **arrays)
    with h5py.File(tree, "w") as file:
        file.attrs.update(head)
        for key, value in arrays.items():
            if key in head:
                continue
            if key.endswith("/status"):
                file.require_group(key[:64]).attrs["status"] = value
            else:
                file[key] = value
    return lines, plain, packed, tree


def edit_record(run, change):
    name = os.path.join(run, "run.json")
    with open(name) as file:
        record = json.load(file)
    change(record)
    with open(name, "w") as file:
        json.dump(record, file, indent=2)


def formats(program, folder, data=""):
    """All of them. `data`: a folder of recorded files, used where they are there."""
    os.makedirs(folder)

    def put(name, contents):
        with open(os.path.join(folder, name), "wb") as file:
            file.write(contents)
        return os.path.join(folder, name)

    def recorded(*names):
        return [name for name in (os.path.join(data, n) for n in names) if data and os.path.exists(name)]

    v, t = sphere()
    plys = [put(f"{form}.ply", ply(v, t, form)) for form in ("ascii", "binary_little_endian", "binary_big_endian")]
    packed = [put(name + ".gz", gzip.compress(contents, 1)) for name, contents in (
        ("ball.stl", stl_binary(v, t)), ("ball.obj", obj(v, t)), ("ball.ply", ply(v, t, "binary_little_endian")),
        ("ball.glb", glb(v, t)), ("ball.dxf", dxf(v, t)))]
    make(program, folder, ["export", "tower", "--boxes=2", "--out", "own.h5"])
    make(program, folder, ["export", "tower", "--boxes=3", "--out", "own3.h5"])
    fclib = []
    for kind, storage in (("fclib_global", "triplets"), ("fclib_global", "columns"), ("fclib_local", "rows")):
        fclib.append(os.path.join(folder, f"{kind}_{storage}.hdf5"))
        fclib_files.write(fclib[-1], kind=kind, storage=storage)
    suite, stopped = stopped_suite(program, folder)
    simulation = stopped_simulation(program, folder)
    lines, plain, packed_arrays, tree = answers(program, folder)
    judge = ["judge", os.path.join(folder, "pack"), "FILE", "--out", "out"]

    mesh = ["mesh", "FILE"]
    solve = ["solve", "FILE", "--solver", "dual_active_set"]
    motion = ["simulate", "box", "--frames", "2", "--verify", "0", "--out", "out", "--motion", "FILE"]
    return [
        Format("own", [os.path.join(folder, name) for name in ("own.h5", "own3.h5")], solve),
        Format("fclib", fclib + recorded("contact_fclib/CubeH8.hdf5"), solve + ["--law", "pyramid"]),
        Format("stl", [put("binary.stl", stl_binary(v, t)), put("text.stl", stl_text(v, t))], mesh),
        Format("obj", [put("ball.obj", obj(v, t))] + recorded("hand_shadow_mjcf/f_middle.obj"), mesh),
        Format("ply", plys + recorded("mesh_cad_misc/fixed_top.ply"), mesh),
        Format("glb", [put("ball.glb", glb(v, t))] + recorded("hand_webxr_generic/left.glb"), mesh),
        Format("dxf", [put("ball.dxf", dxf(v, t))] + recorded("mesh_v6engine/rod.dxf"), mesh),
        Format("gz", packed, mesh, packed=True),
        Format("leap", [put("leap.json", leap())] + recorded("motion_leap_bones/finger-tap-54fps.json"), motion),
        Format("csv", [put("one.csv", angles()), put("two.csv", angles(("left_", "right_"))), put("dapg.csv", adroit())],
               motion),
        Format("packed motion", [put("leap.json.gz", gzip.compress(leap(), 1)),
                                 put("angles.csv.gz", gzip.compress(angles(), 1))], motion, packed=True),
        Format("results", [suite], ["report", "DIR"], victims=["results.jsonl", "traces.jsonl", "run.json"]),
        Format("stopped suite", [stopped], ["bench", "--resume", "DIR"],
               victims=["results.jsonl", "traces.jsonl", "run.json", ".h5"]),
        Format("answers", [lines], judge, fine=(0, 1)),
        Format("answers npz", [plain, packed_arrays], judge, fine=(0, 1)),
        Format("answers hdf5", [tree], judge, fine=(0, 1)),
        Format("stopped simulation", [simulation], ["simulate", "--resume", "DIR"], victims=[""]),
    ]
