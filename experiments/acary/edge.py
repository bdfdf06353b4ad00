"""Contact problems at and beyond the edge of strict feasibility, 2^-k on either side of it. All entries are exact doubles."""
import numpy as np

import files

DEPTHS = (2, 8, 16, 26, 34)  # k
SIDES = (("before", -1), ("at", 0), ("beyond", 1))


def walls(normals, tangents):
    return np.array([row for n, ts in zip(normals, tangents) for row in (n, *ts)], float)


def wedge():
    """A point between two walls that lean by 3 : 4; from mu = 3/4 on it cannot leave both cones. Edges: mu."""
    return walls([(4, 0, 3), (-4, 0, 3)], [((3, 0, -4), (0, 5, 0)), ((3, 0, 4), (0, 5, 0))]), 3 / 4


def corner():
    """The lower corner of a chute: two walls as of the wedge and a floor across them, on which the point lies."""
    J, edge = wedge()
    return np.vstack([J, walls([(0, 4, 3)], [((5, 0, 0), (0, 3, -4))])]), edge


def plates():
    """A point between two parallel plates, of which one is nearer than the other by 2^-k (beyond), or as far (at)."""
    return walls([(0, 0, 1), (0, 0, -1)], [((1, 0, 0), (0, 1, 0))] * 2), None


SCENES = {"wedge": wedge, "corner": corner, "plates": plates}
PUSHES = {"in": (0.25, 0.5, -1.0), "out": (0.25, 0.5, 1.0), "along": (1.0, 0.5, 0.0)}


def write(folder):
    """Each scene, side, depth and push as a file. Returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for scene, make in SCENES.items():
        J, edge = make()
        for side, sign in SIDES:
            for k in DEPTHS if sign else (0,):
                mu = np.full(len(J) // 3, 1 / 2 if edge is None else edge + sign * 2.0**-k)
                c = np.zeros(len(J))
                if edge is None:
                    c[3] = sign * 2.0**-k
                for push, z_u in PUSHES.items():
                    name = f"{scene} {side}" + (f" by 2^-{k}" if sign else "") + f", pushed {push}"
                    paths.append(folder / f"{len(paths):03}.h5")
                    files.write(paths[-1], name, f"{scene} {side}", np.array(z_u), J, c, mu)
    return paths
