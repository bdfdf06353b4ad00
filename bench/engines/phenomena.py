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


R = F(1, 10)  # of balls, and half the side of cubes
SLANT = (F(12, 13), F(5, 13))
NEAR_DIAGONAL = (F(20, 29), F(21, 29))
HALF = math.sqrt(0.5)
C8, S8 = math.cos(math.pi / 8), math.sin(math.pi / 8)  # turns by 45 degrees
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


def gyroscope():
    """A wheel whose axle precesses steadily: 1 rad/s times m g l over its angular momentum, which is 1."""
    arm, rate = F(1, 10), G / 10
    wheel = body([sphere(F(1, 50))], (arm, 0, 0), 1, (F(1, 30), F(1, 50), F(1, 50)), velocity=(0, rate * arm, 0), spin=(30, 0, rate))
    return scene([wheel], joints=[(0, -1, (0, 0, 0))])


def pinch(ratio):
    """A cube between two pads of 1 kg that press with `ratio` times the force that carries it, and are carried with half its weight."""
    half, press = (R, R, R), ratio * G
    pads = [box(half, (side * 2 * R, 0, 0), force=(-side * press, 0, G * F(3, 2))) for side in (-1, 1)]
    return scene([pads[0], box(half, STILL), pads[1]], F(1, 2))


def table(ratio):
    """A table of 4 kg on four feet, pushed with `ratio` times what friction holds."""
    x, y = F(2, 5), F(3, 10)
    push = ratio * F(1, 2) * 4 * G
    return scene([floor(), four_feet([(x, y), (-x, y), (-x, -y), (x, -y)], mass=4, inertia=(F(1, 5), F(3, 10), F(2, 5)),
                                     force=(push * SLANT[0], push * SLANT[1], 0))], F(1, 2))


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
    return max((length(state[VELOCITY]) for sample in run[1 + len(run) // 10:] for state in sample), default=0)


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


def rows():
    p = Phenomenon
    # Free motion
    yield p("free_fall", "Free fall", "A ball falls for 1 s. Measured: its height.", "m",
            scene([ball(R, (0, 0, 0))]), F(1), at(0, 2), lambda c: travel(0, -G, F(1), c), 0.1)
    yield p("projectile", "Projectile", "A ball is thrown at 3 m/s forward and 4 m/s up. Measured: its height after 1 s.", "m",
            scene([ball(R, (0, 0, 0), velocity=(3, 0, 4))]), F(1), at(0, 2), lambda c: travel(4, -G, F(1), c), 0.1)
    yield p("torque", "A torque for a second", "A box that floats is turned with 1/10 N m about an axis of 1/5 kg m². Measured: how fast it turns after 1 s.", "rad/s",
            scene([body([dict(kind="box", half=(R, R, R), at=STILL)], STILL, 1, (F(1, 5),) * 3, torque=(0, 0, F(1, 10)))], 0, STILL), F(1),
            part(0, SPIN, 2), answer(F(1, 2)), 0.01)
    yield p("tumbling", "Angular momentum of a tumbling body", "A body with inertias 1 : 2 : 3 turns about the middle axis, which is not stable, for 5 s. "
            "Measured: the angular momentum lost, of 1/10 N m s.", "N m s", racket(), F(5), momentum_lost(1), answer(0), 0.01)
    yield p("tumbling_energy", "Energy of a tumbling body", "The same body. Measured: the change of its energy, of 1/4 J.", "J",
            racket(), F(5), energy_gained, answer(0), 0.025)
    yield p("gyroscope", "Gyroscope", "A wheel of 30 rad/s on a horizontal axle, held at one end, that has its steady precession, for 2 s. Measured: how high the axle comes.", "m",
            gyroscope(), F(2), at(0, 2), answer(0), 0.01)
    # Impacts
    yield p("wall", "Elastic against a wall", "A ball flies against a wall at 1 m/s, restitution 1. Measured: its speed after it, which is -1.", "m/s",
            scene([floor(turn=FACING_LEFT), ball(R, (F(-73, 100), 0, 0), velocity=(1, 0, 0))], 0, STILL, 1), F(1), part(1, VELOCITY, 0), answer(-1), 0.1)
    yield p("equal_balls", "Elastic, equal balls", "A ball at 1 m/s hits another like it, which rests, restitution 1. Measured: the speed of that.", "m/s",
            two_balls(1, 1), F(1), part(1, VELOCITY, 0), answer(1), 0.1)
    yield p("unequal_balls", "Elastic, 1 : 1000", "A ball at 1 m/s hits one of 1,000 times its mass, which rests, restitution 1. Measured: its own speed after it.", "m/s",
            two_balls(1000, 1), F(1), part(0, VELOCITY, 0), answer(F(-999, 1001)), 0.1)
    yield p("sticky_balls", "Inelastic, equal balls", "A ball at 1 m/s hits another like it, which rests, restitution 0. Measured: the speed of that.", "m/s",
            two_balls(1, 0), F(1), part(1, VELOCITY, 0), answer(F(1, 2)), 0.05)
    yield p("momentum", "Momentum in impacts", "Three rough balls of 1, 2 and 3 kg fly into each other, restitution 1/2. Measured: the momentum lost, of 2 N s.", "N s",
            three_balls(), F(1), momentum_lost(0), answer(0), 0.02)
    yield p("angular_momentum", "Angular momentum in impacts", "The same balls. Measured: the angular momentum lost.", "N m s",
            three_balls(), F(1), momentum_lost(1), answer(0), 0.01)
    yield p("landing", "Landing without rebound", "A box falls 1/10 m on the floor, restitution 0. Measured: the largest speed upward after 1/5 s.", "m/s",
            scene([floor(), box((R, R, R), (0, 0, 2 * R))], F(1, 2)), F(1), lambda run, scene: max([0, *(s[1][9] for s in run[len(run) // 5 + 1:])]),
            answer(0), 0.05, F(0))
    yield p("bounce", "Height of a bounce", "A ball falls 1 m, restitution 1. Measured: how high it comes after it; in continuous time as high as it was.", "m",
            scene([floor(), ball(R, (0, 0, 1 + R))], 0, DOWN, 1), F(1), lambda run, scene: max(s[1][2] for s in run[len(run) // 2 + 1:]) - 0.1 if len(run) > 2 else 1.0,
            answer(1), 0.1, F(0))
    # Rest
    yield p("sinking", "Sinking at rest", "A box of 2 dm lies on the floor for 2 s. Measured: how deep it sinks.", "m",
            stack([1]), F(2), lambda run, scene: run[0][1][2] - run[-1][1][2], answer(0), 0.01)
    yield p("unrest", "Speed at rest", "The same box. Measured: its largest speed in the last 9/10 of the time.", "m/s",
            stack([1]), F(2), fastest, answer(0), 0.01)
    yield p("domino", "A domino stands", "A domino of 2 cm by 10 cm, 20 cm high, stands for 5 s. Measured: how far it leans, in quarter turns.", "turn/4",
            scene([floor(), box((F(1, 100), F(1, 20), R), (0, 0, R), F(1, 2))], F(1, 2)), F(5), tilt(1), answer(0), 0.01)
    for name, text, masses in (("stack_1", "1", [1, 1]), ("stack_1e3", "1,000", [1, 1000]), ("stack_1e6", "1,000,000", [1, 10 ** 6])):
        yield p(name, f"Stack, mass ratio {text}", f"A box of 1 kg carries one of {text} kg for 2 s. Measured: how far either comes.", "m",
                stack(masses), F(2), moved, answer(0), 0.01)
    yield p("tower", "Tower of ten", "Ten equal boxes on each other for 2 s. Measured: how far any comes.", "m", stack([1] * 10), F(2), moved, answer(0), 0.01)
    yield p("groove", "A ball in a groove", "A ball lies in a groove of 90 degrees for 2 s. Measured: how far it comes.", "m",
            scene([floor(turn=(C8, 0, S8, 0)), floor(turn=(C8, 0, -S8, 0)), ball(R, (0, 0, R * F(math.sqrt(2))))], F(1, 2)), F(2), moved, answer(0), 0.01)
    yield p("jam", "Jam", "A cube of 2 dm between two walls that leave it 2 mm too little, without gravity, for 1 s. Measured: its largest speed.", "m/s",
            scene([box((R, 1, 1), (side * F(199, 1000), 0, 0), motion="fixed") for side in (-1, 1)] + [box((R, R, R), STILL)], F(1, 2), STILL),
            F(1), lambda run, scene: max(length(s[2][VELOCITY]) for s in run), answer(0), 0.01, F(0))
    # Friction
    yield p("frictionless", "Sliding on ice", "A block slides at 1 m/s without friction for 2 s. Measured: its speed.", "m/s",
            scene([floor(), block(velocity=(1, 0, 0))]), F(2), part(1, VELOCITY, 0), answer(1), 0.01)
    yield p("slide", "Stopping distance", "A block slides at 2 m/s on a floor, mu = 1/2, and stops. Measured: the way.", "m",
            scene([floor(), block(velocity=(V, 0, 0))], MU), F(1), at(1, 0), lambda c: stop(V, MU * G, c), 0.04)
    yield p("slowing", "Sliding speed", "The same block after 1/5 s, while it slides. Measured: its speed.", "m/s",
            scene([floor(), block(velocity=(V, 0, 0))], MU), F(1, 5), part(1, VELOCITY, 0), answer(V - MU * G / 5), 0.1)
    yield p("stick", "Sticking below the cone", "A block on a slope of 99/100 of the steepest that friction holds, for 2 s. Measured: how far it comes.", "m",
            incline(F(99, 100)), F(2), moved, answer(0), 0.01)
    yield p("slip", "Slipping above the cone", "A block on a slope of 11/10 of the steepest that friction holds, for 1 s. Measured: the way.", "m",
            incline(F(11, 10)), F(1), at(1, 0), lambda c: travel(0, MU * G / 10, F(1), c), 0.025)
    yield p("diagonal", "Slipping across the axes", "The same with 6/5 of the steepest, down a slope that runs 20 : 21 between two axes. Measured: the way.", "m",
            incline(F(6, 5), direction=NEAR_DIAGONAL), F(1), lambda run, scene: run[-1][1][0] * 20 / 29 + run[-1][1][1] * 21 / 29,
            lambda c: travel(0, MU * G / 5, F(1), c), 0.05, view="xy")
    yield p("aside", "Pulled aside", "A block slides at 13/5 m/s on a floor, 12 : 5 between two axes, and stops. Measured: how far it leaves its line.", "m",
            scene([floor(), block(velocity=(F(12, 5), 1, 0))], MU), F(1),
            lambda run, scene: abs(run[-1][1][0] * 5 / 13 - run[-1][1][1] * 12 / 13), answer(0), 0.01, view="xy")
    yield p("creep", "Creep over a minute", "A block on a slope of half the steepest that friction holds, for 60 s. Measured: how far it comes.", "m",
            incline(F(1, 2)), F(60), moved, answer(0), 0.01, F(1))
    yield p("belt", "Belt", "A block is put on a belt that runs at 1 m/s, mu = 1/2. Measured: where it is after 1 s.", "m",
            scene([box((5, 1, F(1, 2)), (0, 0, F(-1, 2)), velocity=(1, 0, 0), motion="driven"), block()], MU), F(1), at(1, 0),
            lambda c: 1 - stop(F(1), MU * G, c), 0.01)
    yield p("wall_holds", "Held against a wall", "A cube is pressed against a wall with 21/20 of the force that holds it up, for 2 s. Measured: how far it comes.", "m",
            against_wall(F(21, 20)), F(2), moved, answer(0), 0.01)
    yield p("wall_slips", "Slipping down a wall", "The same with 19/20 of that force for 1 s. Measured: the height.", "m",
            against_wall(F(19, 20)), F(1), at(1, 2), lambda c: travel(0, -G / 20, F(1), c), 0.025)
    yield p("pinch", "Pinch", "Two pads press a cube between them with 6/5 of the force that holds it, and carry half its weight each, for 1 s. Measured: how far any comes.", "m",
            pinch(F(6, 5)), F(1), moved, answer(0), 0.01)
    # Turning and rolling
    yield p("rolling", "From sliding to rolling", "A ball slides at 2 m/s without spin, mu = 1/2, for 1 s. Measured: its speed, which is 5/7 of that.", "m/s",
            scene([floor(), ball(R, (0, 0, R), velocity=(V, 0, 0))], MU), F(1), part(1, VELOCITY, 0), answer(V * 5 / 7), 0.1)
    yield p("roll_down", "Rolling down", "A ball rolls from rest down a slope of half the steepest that friction holds a block on, for 1 s. Measured: the way.", "m",
            scene([floor(), ball(R, (0, 0, R))], MU, (MU * G / 2, 0, -G)), F(1), at(1, 0), lambda c: travel(0, MU * G / 2 * F(5, 7), F(1), c), 0.1)
    yield p("rolls_on", "Rolling on", "A ball rolls at 1 m/s for 5 s. Measured: its speed.", "m/s",
            scene([floor(), ball(R, (0, 0, R), velocity=(1, 0, 0), spin=(0, 1 / R, 0))], MU), F(5), part(1, VELOCITY, 0), answer(1), 0.01)
    yield p("spins_on", "Spinning on a point", "A ball turns on the floor about the vertical at 10 rad/s for 2 s: friction at a point does not brake it. Measured: how fast it turns.",
            "rad/s", scene([floor(), ball(R, (0, 0, R), spin=(0, 0, 10))], MU), F(2), part(1, SPIN, 2), answer(10), 0.1)
    yield p("turning", "Turning on four feet", "A table on four feet in a cross of 2/5 m turns at 10 rad/s, mu = 1/4, for 1/2 s. Measured: how fast it turns.", "rad/s",
            scene([floor(), four_feet([(F(2, 5), 0), (0, F(2, 5)), (F(-2, 5), 0), (0, F(-2, 5))], inertia=(F(1, 10),) * 3, spin=(0, 0, 10))], F(1, 4)),
            F(1, 2), part(1, SPIN, 2), answer(10 - F(1, 2) * F(1, 4) * G * F(2, 5) * 10), 0.1, view="xy")
    yield p("table_holds", "A table is pushed", "A table on four feet is pushed, 12 : 5, with 9/10 of what friction holds, for 2 s: which foot carries how much is open, that it stands is not. "
            "Measured: how far it comes.", "m", table(F(9, 10)), F(2), moved, answer(0), 0.01, view="xy")
    yield p("table_slides", "A table is pushed harder", "The same with 3/2 of that force for 1 s. Measured: the way.", "m",
            table(F(3, 2)), F(1), lambda run, scene: run[-1][1][0] * 12 / 13 + run[-1][1][1] * 5 / 13, lambda c: travel(0, MU * G / 2, F(1), c), 0.1, view="xy")
    yield p("leans", "Not toppling", "A box twice as high as wide on a slope of 19/20 of that on which it topples, mu = 1, for 2 s. Measured: how far it tilts, in quarter turns.",
            "turn/4", leaning(F(19, 20)), F(2), tilt(1), answer(0), 0.01)
    yield p("topples", "Toppling", "The same on 21/20 of that slope for 3 s: it lies on its side then. Measured: how far it has tilted, in quarter turns.", "turn/4",
            leaning(F(21, 20)), F(3), tilt(1), answer(1), 0.05)
    yield p("ladder_stays", "A ladder stays", "A ladder of 1 m leans 3 : 4 between a floor and a wall with mu = 3/8, for 2 s. Measured: how far its middle comes.", "m",
            ladder(F(3, 8)), F(2), lambda run, scene: length(plus(run[-1][2][AT], run[0][2][AT], -1)), answer(0), 0.01)
    yield p("ladder_slips", "A ladder slips", "The same with mu = 3/10 for 3 s: it lies on the floor then. Measured: the height of its middle.", "m",
            ladder(F(3, 10)), F(3), at(2, 2), answer(F(1, 50)), 0.02)
    # Joints
    yield p("pendulum", "A joint's drift", "A pendulum of 1 m swings from the horizontal for 10 s. Measured: how far the joint opens.", "m",
            pendulum(), F(10), joints_open, answer(0), 0.01)
    yield p("pendulum_energy", "A pendulum's energy", "The same pendulum. Measured: the change of its energy; in continuous time none.", "J",
            pendulum(), F(10), energy_gained, answer(0), 1.0)
    yield p("chain", "A chain hangs", "Ten links of 1 kg, the last of 1,000 kg, hang for 2 s. Measured: how far any joint opens.", "m",
            chain(1000), F(2), joints_open, answer(0), 0.01)


ALL = {p.name: p for p in rows()}
