"""Exact answers in rational numbers, of continuous time and of an integrator's steps.

Of a body with a constant acceleration a an integrator makes v_n = v + n a h, which is exact, and moves it in each step with the new
velocity (order 1, semi-implicit), the old one (order -1, explicit) or their mean (order 0, which is continuous time's answer).
"""
from fractions import Fraction
import dataclasses


@dataclasses.dataclass(frozen=True)
class Clock:
    """What moves the bodies: a step of h seconds, and where its positions take their velocity from."""
    h: Fraction
    order: int = 1


def travel(v, a, t, clock):
    """The way in m after t seconds (a whole number of steps) of a body with velocity v and acceleration a."""
    return v * t + a * t * (t + clock.order * clock.h) / 2


def stop(v, a, clock):
    """The way in m until friction with the deceleration a has stopped a body of speed v."""
    if clock.order == 0:
        return v * v / (2 * a)
    whole = v // (a * clock.h)  # steps after which it still moves, or has just come to rest
    way = travel(v, -a, whole * clock.h, clock)
    # In the step that stops it, an explicit integrator still moves it by what is left.
    return way if clock.order == 1 else way + clock.h * (v - whole * a * clock.h)
