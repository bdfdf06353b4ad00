"""Phenomena with exact answers: each a scene, what is measured in it, what it has to be.

Scenes are made of whole numbers and fractions, so that answers are exact; engines get them as floating-point numbers.
Lengths in m, masses in kg, times in s, forces in N; z is up.
"""
from fractions import Fraction as F
import dataclasses
import math
import typing

from exact import stop, travel

G = F(981, 100)
DOWN = (0, 0, -G)
STILL = (0, 0, 0)
AT, TURN, VELOCITY, SPIN = slice(0, 3), slice(3, 7), slice(7, 10), slice(10, 13)  # of a state


# ---- Scenes -------------------------------------------------------------------------------------------------------------------------------------

def body(shapes, at, mass=1, inertia=(1, 1, 1), turn=(1, 0, 0, 0), velocity=STILL, spin=STILL, force=STILL, torque=STILL, motion="free"):
    return dict(shapes=shapes, at=at, mass=mass, inertia=inertia, turn=turn, velocity=velocity, spin=spin, force=force, torque=torque, motion=motion)


def sphere(radius, at=STILL):
    return dict(kind="sphere", radius=radius, at=at)


def ball(radius, at, mass=1, **more):
    return body([sphere(radius)], at, mass, (F(2, 5) * mass * radius ** 2,) * 3, **more)


def box(half, at, mass=1, **more):
    x, y, z = (F(h) ** 2 for h in half)
    return body([dict(kind="box", half=half, at=STILL)], at, mass, tuple(mass * s / 3 for s in (y + z, z + x, x + y)), **more)


def fixed(shape, at=STILL, **more):
    return body([shape], at, motion="fixed", **more)


def floor(**more):
    return fixed(dict(kind="plane", at=STILL), **more)


HALF = math.sqrt(0.5)
FACING_LEFT = (HALF, 0, -HALF, 0)  # a floor turned so becomes a wall whose free side is at smaller x
FACING_RIGHT = (HALF, 0, HALF, 0)


def scene(bodies, mu=0, gravity=DOWN, restitution=0, joints=()):
    return dict(gravity=gravity, mu=mu, restitution=restitution, bodies=bodies, joints=[dict(a=a, b=b, at=at) for a, b, at in joints])


def block(**more):
    """A flat box that lies on the floor."""
    return box((F(1, 10), F(1, 10), F(1, 20)), (0, 0, F(1, 20)), **more)


def incline(ratio, mu=F(1, 2), direction=(1, 0)):
    """A block on a slope of `ratio` times the steepest that friction holds: the floor stays level, gravity leans."""
    return scene([floor(), block()], mu, (ratio * mu * G * direction[0], ratio * mu * G * direction[1], -G))


def stack(masses):
    side = F(1, 5)
    return scene([floor()] + [box((side / 2,) * 3, (0, 0, side * (k + F(1, 2))), m) for k, m in enumerate(masses)], F(1, 2))


def four_feet(feet, **more):
    """A table that stands on four small spheres."""
    r = F(1, 50)
    return body([sphere(r, (x, y, F(-3, 10))) for x, y in feet], (0, 0, F(3, 10) + r), **more)


def ladder(mu):
    """A ladder that leans 3 : 4 between a floor and a wall, both rough: at 1/3 it slips, but for its thickness."""
    r = F(1, 50)
    rod = body([sphere(r, (F(-3, 10), 0, F(-4, 10))), sphere(r, (F(3, 10), 0, F(4, 10)))], (F(-3, 10) - r, 0, F(4, 10) + r), 1, (F(1, 12),) * 3)
    return scene([floor(), floor(turn=FACING_LEFT), rod], mu)


def leaning(ratio):
    """A box twice as high as wide on a slope that is `ratio` times the one on which it topples."""
    return scene([floor(), box((F(1, 20), F(1, 10), F(1, 10)), (0, 0, F(1, 10)))], 1, (ratio * G / 2, 0, -G))


def against_wall(ratio):
    """A block pressed against a wall with `ratio` times the force that holds it up."""
    return scene([floor(turn=FACING_LEFT), box((F(1, 10),) * 3, (F(-1, 10), 0, 0), force=(ratio * 2 * G, 0, 0))], F(1, 2))


def three_balls(restitution=F(1, 2)):
    r = F(1, 10)
    return scene([ball(r, (0, 0, 0), 1, velocity=(2, 0, 0), spin=(0, 0, 20)), ball(r, (F(1, 2), F(1, 10), 0), 2), ball(r, (1, F(1, 8), F(1, 10)), 3)],
                 F(1, 2), STILL, restitution)


def two_balls(mass, restitution):
    return scene([ball(F(1, 10), (0, 0, 0), velocity=(1, 0, 0)), ball(F(1, 10), (F(53, 100), 0, 0), mass)], 0, STILL, restitution)


def racket():
    """A body that turns about its middle axis, which is not stable."""
    return scene([body([dict(kind="box", half=(F(1, 10), F(1, 10), F(1, 10)), at=STILL)], STILL, 1, (F(1, 100), F(2, 100), F(3, 100)),
                       spin=(F(1, 10), 5, 0))], 0, STILL)


def pendulum():
    return scene([ball(F(1, 10), (1, 0, 0))], joints=[(0, -1, (0, 0, 0))])


def chain(load):
    links, gap = 10, F(1, 10)
    return scene([ball(F(1, 25), (0, 0, -gap * (k + F(1, 2))), load if k == links - 1 else 1) for k in range(links)],
                 joints=[(k, k - 1, (0, 0, -gap * k)) for k in range(links)])


# ---- Measures: of the samples of a run, each a list of states -----------------------------------------------------------------------------------

def plus(a, b, factor=1):
    return [x + factor * y for x, y in zip(a, b)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def length(a):
    return math.sqrt(dot(a, a))


def turned(turn, v, back=False):
    """v, of the frame of a body, as the world sees it; back: the other way round."""
    w, u = turn[0], turn[1:] if not back else [-x for x in turn[1:]]
    t = [2 * x for x in cross(u, v)]
    return plus(plus(v, t, w), cross(u, t))


def part(b, where, axis):
    """One number of the last state of body b."""
    return lambda run, scene: run[-1][b][where][axis]


def at(b, axis):
    return part(b, AT, axis)


def moved(run, scene):
    """The farthest way that any body is at the end from where it was."""
    return max(length(plus(end[AT], start[AT], -1)) for start, end in zip(run[0], run[-1]))


def fastest(run, scene):
    """The largest speed after the first tenth of the samples."""
    return max(length(state[VELOCITY]) for sample in run[1 + len(run) // 10:] for state in sample)


def tilt(b):
    """Between the body's upright axis at the end and the vertical, in quarter turns."""
    return lambda run, scene: math.acos(max(-1, min(1, turned(run[-1][b][TURN], [0, 0, 1])[2]))) / (math.pi / 2)


def momenta(sample, scene):
    linear, angular = [0, 0, 0], [0, 0, 0]
    for state, b in zip(sample, scene["bodies"]):
        mv = [float(b["mass"]) * v for v in state[VELOCITY]]
        local = turned(state[TURN], state[SPIN], back=True)
        own = turned(state[TURN], [float(i) * w for i, w in zip(b["inertia"], local)])
        linear, angular = plus(linear, mv), plus(plus(angular, cross(state[AT], mv)), own)
    return linear, angular


def momentum_lost(which):
    return lambda run, scene: length(plus(momenta(run[-1], scene)[which], momenta(run[0], scene)[which], -1))


def energy(sample, scene):
    total = 0
    for state, b in zip(sample, scene["bodies"]):
        local, m = turned(state[TURN], state[SPIN], back=True), float(b["mass"])
        total += m * dot(state[VELOCITY], state[VELOCITY]) / 2 + sum(float(i) * w * w for i, w in zip(b["inertia"], local)) / 2
        total -= m * dot([float(g) for g in scene["gravity"]], state[AT])
    return total


def energy_gained(run, scene):
    """The change of energy that is largest in size."""
    return max((energy(sample, scene) - energy(run[0], scene) for sample in run), key=abs)


def joints_open(run, scene):
    """The largest distance between the two points that a joint holds together."""
    def point(sample, b, joint):
        if b < 0:
            return [float(x) for x in joint["at"]]
        arm = [float(x - y) for x, y in zip(joint["at"], scene["bodies"][b]["at"])]
        return plus(sample[b][AT], turned(sample[b][TURN], arm))
    return max(length(plus(point(sample, j["a"], j), point(sample, j["b"], j), -1)) for sample in run for j in scene["joints"])


# ---- The phenomena ------------------------------------------------------------------------------------------------------------------------------

@dataclasses.dataclass(frozen=True)
class Phenomenon:
    name: str
    title: str
    what: str                  # the scene, and what is measured
    unit: str
    scene: dict
    seconds: F                 # a multiple of 1/20
    measure: typing.Callable   # (run, scene) -> float
    exact: typing.Callable     # Clock -> Fraction
    mark: float                # off by this, in the unit, nobody would call it right
    every: F = F(1, 20)        # seconds between samples; 0: each step
    view: str = "xz"           # of the page's picture


def answer(value):
    return lambda clock: F(value)


MU, V = F(1, 2), F(2)
SLANT = (F(12, 13), F(5, 13))
NEAR_DIAGONAL = (F(20, 29), F(21, 29))
R = F(1, 10)


def rows():
    p = Phenomenon
    yield p("free_fall", "Free fall", "A ball falls for 1 s. Measured: its height.", "m",
            scene([ball(R, (0, 0, 0))]), F(1), at(0, 2), lambda c: travel(0, -G, F(1), c), 0.1)
    yield p("projectile", "Projectile", "A ball is thrown at 3 m/s forward and 4 m/s up. Measured: its height after 1 s.", "m",
            scene([ball(R, (0, 0, 0), velocity=(3, 0, 4))]), F(1), at(0, 2), lambda c: travel(4, -G, F(1), c), 0.1)
    yield p("slide", "Stopping distance", "A block slides at 2 m/s on a floor, mu = 1/2, and stops. Measured: the way.", "m",
            scene([floor(), block(velocity=(V, 0, 0))], MU), F(1), at(1, 0), lambda c: stop(V, MU * G, c), 0.04)
    yield p("slowing", "Sliding speed", "The same block after 1/5 s, while it slides. Measured: its speed.", "m/s",
            scene([floor(), block(velocity=(V, 0, 0))], MU), F(1, 5), part(1, VELOCITY, 0), answer(V - MU * G / 5), 0.1)
    yield p("stick", "Sticking below the cone", "A block on a slope of 99/100 of the steepest that friction holds, for 2 s. Measured: how far it comes.", "m",
            incline(F(99, 100)), F(2), moved, answer(0), 0.01)
    yield p("slip", "Slipping above the cone", "A block on a slope of 11/10 of the steepest that friction holds, for 1 s. Measured: the way.", "m",
            incline(F(11, 10)), F(1), at(1, 0), lambda c: travel(0, MU * G / 10, F(1), c), 0.025)
    yield p("creep", "Creep over a minute", "A block on a slope of half the steepest that friction holds, for 60 s. Measured: how far it comes.", "m",
            incline(F(1, 2)), F(60), moved, answer(0), 0.01, F(1))
    yield p("aside", "Pulled aside", "A block slides at 13/5 m/s on a floor, 12 : 5 between two axes, and stops. Measured: how far it leaves its line.", "m",
            scene([floor(), block(velocity=(F(12, 5), 1, 0))], MU), F(1),
            lambda run, scene: abs(run[-1][1][0] * 5 / 13 - run[-1][1][1] * 12 / 13), answer(0), 0.01, view="xy")
    yield p("rolling", "From sliding to rolling", "A ball slides at 2 m/s without spin, mu = 1/2, for 1 s. Measured: its speed, which is 5/7 of that.", "m/s",
            scene([floor(), ball(R, (0, 0, R), velocity=(V, 0, 0))], MU), F(1), part(1, VELOCITY, 0), answer(V * 5 / 7), 0.1)
    yield p("stack_1e6", "Stack, mass ratio 1e6", "A box of 1 kg carries one of 1,000,000 kg for 2 s. Measured: how far either comes.", "m",
            stack([1, 10 ** 6]), F(2), moved, answer(0), 0.01)
    yield p("sinking", "Sinking at rest", "A box of 2 dm lies on the floor for 2 s. Measured: how deep it sinks.", "m",
            stack([1]), F(2), lambda run, scene: run[0][1][2] - run[-1][1][2], answer(0), 0.01)
    yield p("pendulum", "A joint's drift", "A pendulum of 1 m swings from the horizontal for 10 s. Measured: how far the joint opens.", "m",
            pendulum(), F(10), joints_open, answer(0), 0.01)


ALL = {p.name: p for p in rows()}
