"""Derivatives of assembly: how M, z_u, J, c and mu of a scene's problem follow its bodies (core/model/scene_change.h)."""
import math

import numpy

from . import _number, _real, _whole


def twist(value, name):
    try:
        v = numpy.zeros(6) if value is None else numpy.array(_real(value), dtype=float)
    except (TypeError, ValueError, OverflowError) as bad:
        raise ValueError(f"{name} should be six numbers: {str(bad).splitlines()[0]}") from None
    if v.shape != (6,) or not numpy.isfinite(v).all():
        raise ValueError(f"{name} should have 6 finite entries")
    return v


def number(value, name):
    v = _number(value, name)
    if not math.isfinite(v):
        raise ValueError(f"{name} should be finite")
    return v


def change(problem, body, pose, velocity, mass, mu):
    count = len(problem.bodies)
    if count == 0:
        raise ValueError(f"{problem.name!r} is not made of bodies by a scene")
    if body is None and not (pose is None and velocity is None and mass == 0):
        raise ValueError("body is missing: its number in problem.bodies")
    which = -1 if body is None else _whole(body, "body", count - 1)
    M, z_u, J, c, dmu = problem._scene_change(which, twist(pose, "pose"), twist(velocity, "velocity"), number(mass, "mass"),
                                              number(mu, "mu"))
    return {"dM": M, "dz_u": z_u, "dJ": J, "dc": c, "dmu": dmu}


def gradient(problem, bars):
    if missing := [name for name in ("M", "z_u", "J", "c", "mu") if name not in bars]:
        raise ValueError(f"bars has no {missing[0]!r}: expected the whole of what vjp(z_bar) returns, without wrt=")
    if any(bars[name] is None for name in ("M", "z_u", "J", "c", "mu")):
        raise ValueError("no gradient: forces are not unique, and J and c have none")
    for name in ("M", "z_u", "J", "c", "mu"):
        wanted = problem.mu.shape if name == "mu" else getattr(problem, name).shape
        if numpy.shape(bars[name]) != wanted:
            raise ValueError(f"bars[{name!r}] should have the shape {wanted}, as the problem, and has {numpy.shape(bars[name])}")

    def along(**one):
        d = change(problem, one.pop("body", None), one.pop("pose", None), one.pop("velocity", None), one.pop("mass", 0.0),
                   one.pop("mu", 0.0))
        return sum(float(d["d" + name].multiply(bars[name]).sum()) for name in ("M", "J")) + sum(
            float(d["d" + name] @ bars[name]) for name in ("z_u", "c", "mu"))
    count, unit = len(problem.bodies), numpy.eye(6)
    return {"pose": numpy.array([[along(body=b, pose=e) for e in unit] for b in range(count)]),
            "velocity": numpy.array([[along(body=b, velocity=e) for e in unit] for b in range(count)]),
            "mass": numpy.array([along(body=b, mass=1.0) for b in range(count)]), "mu": along(mu=1.0)}
