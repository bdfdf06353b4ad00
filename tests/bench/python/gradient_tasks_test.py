"""The three tasks of Zhong, Han & Brikis (arXiv 2207.05060), whose gradients are known in closed form, with zwang's derivatives of each impact.

Balls fly freely and meet the ground, a wall or each other at the exact time of contact; each impact is a problem of least constraint:
v+ differs least from v-, n'v+ >= -e n'v-. Everything but the impact is chained by hand. Run by ctest.
"""
import math
import sys
import unittest

import numpy

import zwang


class Impact:
    """z = v+ of n'v+ >= -e n'v-, and how a gradient passes back through it."""

    def __init__(self, v, n, elasticity):
        self.v, self.n, self.e = v, n, elasticity
        self.problem = zwang.Problem(numpy.eye(len(v)), v, [n], [-elasticity * (n @ v)])
        answer = zwang.solve(self.problem)
        self.after, self.gradient = answer.z, zwang.gradient_of(self.problem, answer)

    def back(self, bar):
        """The gradients with respect to v- and n."""
        bars = self.gradient.vjp(bar)
        return bars["z_u"] - self.e * bars["c"][0] * self.n, bars["J"][0] - self.e * bars["c"][0] * self.v


class Flight:
    """Positions x and velocities v under accelerations u, each kept for dt. gap(x): (value, gradient, Hessian) of what may not become
    negative; after an impact its row is the normal."""

    def __init__(self, x, v, u, dt, gaps, elasticity):
        self.u, self.dt, self.tape = u, dt, []
        for k, push in enumerate(u):
            left = dt
            while True:
                hits = [(self.time(gap, x, v, push, left), gap) for gap in gaps]
                t, gap = min(hits, key=lambda hit: hit[0])
                step = min(t, left)
                start = x, v
                x, v = x + v * step + 0.5 * push * step**2, v + push * step
                if t >= left:
                    self.tape.append(("free", k, step, start, None))
                    break
                self.tape.append(("until", k, step, start, gap(x)))
                left -= step
                impact = Impact(v, gap(x)[1] / numpy.linalg.norm(gap(x)[1]), elasticity)
                self.tape.append(("impact", k, left, (x, v), (impact, gap(x))))
                v = impact.after
        self.x, self.v = x, v

    @staticmethod
    def time(gap, x, v, push, most):
        """When the gap closes; inf after `most`."""
        def value(t):
            return gap(x + v * t + 0.5 * push * t**2)
        if not (value(most)[0] < 0 and value(0)[1] @ v < 0):
            return math.inf
        low, high = 0.0, most
        for _ in range(200):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if value(middle)[0] > 0 else (low, middle)
        return high

    def back(self, x_bar):
        """Gradients with respect to the first x and v, and to all u, of a number with this gradient with respect to the last x."""
        x_bar, v_bar, u_bar = numpy.array(x_bar, dtype=float), numpy.zeros(len(x_bar)), [numpy.zeros(len(x_bar)) for _ in self.u]
        left_bar = 0.0  # of what is left of the step
        for kind, k, step, (x, v), more in reversed(self.tape):
            push = self.u[k]
            if kind == "impact":
                impact, (_, slope, bend) = more
                v_bar, n_bar = impact.back(v_bar)
                n, size = impact.n, numpy.linalg.norm(slope)
                x_bar = x_bar + bend @ ((n_bar - (n_bar @ n) * n) / size)
                continue
            step_bar = x_bar @ (v + push * step) + v_bar @ push
            if kind == "until":
                step_bar -= left_bar  # what is left is dt - step
                slope = more[1]
                # slope'(v + push step) d step = -slope'(dx + dv step + du step^2 / 2)
                part = -step_bar / (slope @ (v + push * step)) * slope
                u_bar[k] += 0.5 * step**2 * (x_bar + part) + step * v_bar
                x_bar, v_bar = x_bar + part, v_bar + step * (x_bar + part)
                left_bar = 0.0
            else:
                u_bar[k] += 0.5 * step**2 * x_bar + step * v_bar
                v_bar = v_bar + step * x_bar
                left_bar = step_bar
        return x_bar, v_bar, u_bar


def plane(normal, offset):
    normal = numpy.array(normal, dtype=float)
    return lambda x: (normal @ x - offset, normal, numpy.zeros((len(normal), len(normal))))


def balls(distance):
    """The gap of two balls in the plane."""
    def gap(x):
        d = x[:2] - x[2:]
        r = numpy.linalg.norm(d)
        n = d / r
        bend = (numpy.eye(2) - numpy.outer(n, n)) / r
        return r - distance, numpy.r_[n, -n], numpy.block([[bend, -bend], [-bend, bend]])
    return gap


class Tasks(unittest.TestCase):
    def test_1_a_ball_bounces_once(self):
        """The last height is 2 r - (y + T v_y + ...): its gradient is (0, -1) in position and (0, -T) in velocity."""
        steps, T, r = 480, 1.0, 0.1
        flight = Flight(numpy.array([-1.0, 1.0]), numpy.array([2.0, -2.0]), numpy.zeros((steps, 2)), T / steps, [plane([0, 1], r)], 1.0)
        numpy.testing.assert_allclose(flight.x, [1.0, 1.2], atol=1e-12)
        x_bar, v_bar, u_bar = flight.back([0, 1])
        numpy.testing.assert_allclose(x_bar, [0, -1], atol=1e-12)
        numpy.testing.assert_allclose(v_bar, [0, -T], atol=1e-12)
        numpy.testing.assert_allclose(u_bar[0], [0, -(T - 0.5 * T / steps) * T / steps], atol=1e-12)

    def test_2_a_ball_meets_the_ground_and_a_wall(self):
        """Each axis bounces once: x = w - r - e (x + T v_x - (w - r)); the loss is the square of the distance to a target."""
        steps, T, r, wall, e = 288, 0.6, 0.1, 1.75, 0.92
        x, v, target = numpy.array([-0.5, 1.0]), numpy.array([5.0, -5.0]), numpy.array([-2.0, 1.5])
        flight = Flight(x, v, numpy.zeros((steps, 2)), T / steps, [plane([0, 1], r), plane([-1, 0], r - wall)], e)
        last = numpy.array([wall - r - e * (x[0] + T * v[0] - wall + r), r - e * (x[1] + T * v[1] - r)])
        numpy.testing.assert_allclose(flight.x, last, atol=1e-12)
        x_bar, v_bar, _ = flight.back(2 * (flight.x - target))
        numpy.testing.assert_allclose(x_bar, -2 * e * (last - target), atol=1e-11)
        numpy.testing.assert_allclose(v_bar, -2 * e * T * (last - target), atol=1e-11)

    def test_two_balls_on_a_line(self):
        """The struck ball ends at x_1 + 2 r + T v_1, wherever it was: where contact's time is left out, gradients come out as mixtures."""
        flight = Flight(numpy.array([0.0, 0, 0.52, 0]), numpy.array([1.0, 0, 0, 0]), numpy.zeros((10, 4)), 0.1, [balls(0.2)], 1.0)
        numpy.testing.assert_allclose(flight.x, [0.32, 0, 1.2, 0], atol=1e-12)
        x_bar, v_bar, _ = flight.back([0, 0, 1, 0])
        numpy.testing.assert_allclose(x_bar, [1, 0, 0, 0], atol=1e-12)
        numpy.testing.assert_allclose(v_bar, [1, 0, 0, 0], atol=1e-12)

    def test_3_a_push_that_drives_one_ball_by_another(self):
        """A ball at (-2, -2) is pushed so that one at (-1, -1) ends at 0 after T = 1: loss |x_2|^2 + epsilon int |u|^2. Before the impact at s the
        best push per axis is the one of least square that covers d in s and ends with w: u = 6 d / s^2 - 2 w / s + (6 w / s^2 - 12 d / s^3) t."""
        steps, T, r, epsilon = 480, 1.0, 0.2, 0.1
        dt, d = T / steps, 1 - 2 * r / math.sqrt(2)

        def cost(s):
            a, b = 8 * epsilon / s + 2 * (1 - s) ** 2, -(4 * (1 - s) + 24 * epsilon * d / s**2)
            return 2 + 24 * epsilon * d**2 / s**3 - b * b / (4 * a), -b / (2 * a)
        s = min(numpy.linspace(0.01, 0.99, 9801), key=lambda s: cost(s)[0])
        least, w = cost(s)

        def push(middle):
            return 6 * d / s**2 - 2 * w / s + (6 * w / s**2 - 12 * d / s**3) * middle if middle < s else 0.0

        def gradient(scale):
            u = numpy.array([[scale * push((k + 0.5) * dt)] * 2 + [0.0, 0.0] for k in range(steps)])
            flight = Flight(numpy.array([-2.0, -2, -1, -1]), numpy.zeros(4), u, dt, [balls(2 * r)], 1.0)
            loss = flight.x[2:] @ flight.x[2:] + epsilon * dt * (u * u).sum()
            u_bar = numpy.array(flight.back(numpy.r_[0, 0, 2 * flight.x[2:]])[2]) + 2 * epsilon * dt * u
            return u, flight, loss, u_bar[:, :2]
        u, flight, loss, u_bar = gradient(1.0)
        self.assertAlmostEqual(loss, least, delta=1e-4)
        # The best push jumps to 0 where the balls meet, and its loss has a kink there: from the one side with the push before the impact
        # (that of the step in which they meet), from the other with the one after it, which is none.
        last = -1 + w * (T - s)
        after = 2 * last * T + 2 * epsilon * push(0)
        self.assertLess(after, -0.05)
        self.assertAlmostEqual(u_bar[0, 0] / dt, -after, delta=2e-3)
        for scale in (1.0, 0.9):
            self.closed_form(*gradient(scale), T, dt, epsilon)

    def closed_form(self, u, flight, loss, u_bar, T, dt, epsilon):
        """x_2 = -1 + w (T - t), w and t those of the impact, for any push."""
        (k, before, state), = [(k, step, state) for kind, k, step, state, _ in flight.tape if kind == "until"]
        t = k * dt + before
        speed = state[1][0] + u[k, 0] * before
        last = -1 + speed * (T - t)
        self.assertAlmostEqual(loss, 2 * last**2 + epsilon * dt * (u * u).sum(), delta=1e-12)
        for j in (0, k // 2, k - 1, k, k + 1):
            span, middle = (dt, (j + 0.5) * dt) if j < k else (before, k * dt + 0.5 * before) if j == k else (0.0, 0.0)
            earlier = span * (t - middle) / speed  # by which the impact comes sooner for a push of 1 in step j
            faster = span - u[k, 0] * earlier
            exact = 2 * last * (faster * (T - t) + speed * earlier) + 2 * epsilon * dt * u[j, 0]
            self.assertAlmostEqual(u_bar[j, 0], exact, delta=1e-12)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
