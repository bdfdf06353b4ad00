"""Derivatives of a scene's step: by files whose numbers are changed, by closed forms, backwards against forwards. Run by ctest."""
import copy
import json
import pathlib
import sys
import tempfile
import unittest

import numpy

import zwang

SLEDGE = {  # slides over the ground, a rod swings on it, a ball hangs on a rope
    "format": "zwang scene 1", "dt": 0.0078125,
    "bodies": [{"name": "ground", "motion": "fixed", "shape": {"box": [4, 4, 0.5]}, "position": [0, 0, -0.25]},
               {"name": "sledge", "mass": 2.0, "shape": {"box": [1, 0.5, 0.5]}, "position": [0, 0, 0.25], "velocity": [1, 0.25, 0, 0, 0, 0.125],
                "force": [3, 1, 0, 0, 0, 0.5]},
               {"name": "rod", "mass": 0.5, "shape": {"box": [0.125, 0.125, 1]}, "position": [0, 0, 1], "rotation": [0.25, 0, 0.125],
                "velocity": [1, 0, 0, 0.5, 2, 0.25]},
               {"name": "ball", "mass": 1.5, "shape": {"sphere": 0.125}, "position": [0.5, 0, 0.75], "velocity": [1, 0, -3, 0, 0, 0]}],
    "joints": [{"name": "foot", "type": "ball", "a": "sledge", "b": "rod", "at": [0, 0, 0.5]},
               {"name": "rope", "type": "rope", "a": "rod", "b": "ball", "at": [0, 0, 1.5], "at_b": [0.5, 0, 0.75], "length": 0.9}],
    "contacts": [{"a": "sledge", "b": "ground", "point": [x, y, 0], "normal": [0, 0, 1], "friction": 0.25} for x, y in
                 ((-0.5, -0.25), (0.5, -0.25), (0, 0.25))]}
SLEDGE_BODY, ROD, BALL = 1, 2, 3


def step(written):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "sledge.json"
        file.write_text(json.dumps(written))
        return zwang.scene(str(file))


def answer(problem):
    return zwang.solve(problem, "cone", tolerance=1e-13)


def by_differences(set_knob, h=1e-5):
    z = []
    for t in (h, -h):
        written = copy.deepcopy(SLEDGE)
        set_knob(written, t)
        z.append(answer(step(written)).z)
    return (z[0] - z[1]) / (2 * h)


class SceneChanges(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.problem = step(SLEDGE)
        cls.gradient = zwang.gradient_of(cls.problem, answer(cls.problem))

    def expect(self, set_knob, **change):
        along = self.gradient.jvp(**zwang.scene_change(self.problem, **change))
        self.assertEqual(along.kink, [])
        expected = by_differences(set_knob)
        self.assertGreater(numpy.abs(expected).max(), 1e-2)
        numpy.testing.assert_allclose(along.dz, expected, rtol=0, atol=1e-5 * numpy.abs(expected).max())

    def test_knobs_of_the_file(self):
        self.assertEqual(self.problem.bodies, [-1, 0, 6, 12])

        def velocity(body, k):
            def set_knob(written, t):
                written["bodies"][body]["velocity"][k] += t
            return set_knob

        def mass(body):
            def set_knob(written, t):
                written["bodies"][body]["mass"] += t
            return set_knob

        def friction(written, t):
            for contact in written["contacts"]:
                contact["friction"] += t
        for body, k in ((SLEDGE_BODY, 0), (SLEDGE_BODY, 5), (ROD, 3), (ROD, 4), (BALL, 2)):
            self.expect(velocity(body, k), body=body, velocity=numpy.eye(6)[k])
        for body in (SLEDGE_BODY, ROD, BALL):
            self.expect(mass(body), body=body, mass=1.0)
        self.expect(friction, mu=1.0)

    def test_a_pendulum_by_its_closed_form(self):
        """A point on a rope of length 1, an angle t from below: the pull leaves it g sin t along the arc and w^2 towards the middle, and
        the rope's rows ask for a length of 1 at the end of the step."""
        t, w, dt, g = 0.5, 0.75, 2.0**-10, 9.8125
        reach = numpy.array([numpy.sin(t), 0, -numpy.cos(t)])
        along = numpy.array([numpy.cos(t), 0, numpy.sin(t)])
        pendulum = step({"format": "zwang scene 1", "dt": dt, "gravity": [0, 0, -g], "bodies": [
            {"name": "hook", "motion": "fixed", "position": [0, 0, 0]},
            {"name": "bob", "mass": 1, "shape": {"sphere": 0.125}, "position": reach.tolist(), "velocity": (w * along).tolist() + [0, 0, 0]}],
            "joints": [{"name": "rope", "type": "rope", "a": "hook", "b": "bob", "at": [0, 0, 0], "at_b": reach.tolist(), "length": 1}]})
        turned = zwang.scene_change(pendulum, 1, pose=[*along, 0, 0, 0], velocity=[*(-w * reach), 0, 0, 0])
        dz = zwang.gradient_of(pendulum, zwang.solve(pendulum)).jvp(**turned).dz
        # z = -g sin t along, by d/dt: -g cos t along + g sin t reach.
        numpy.testing.assert_allclose(dz[:3], -g * numpy.cos(t) * along + g * numpy.sin(t) * reach, atol=1e-11)

    def test_backwards_is_forwards(self):
        rng = numpy.random.default_rng(1)
        z_bar = rng.normal(size=self.problem.size)
        back = zwang.scene_gradient(self.problem, self.gradient.vjp(z_bar))
        count = len(self.problem.bodies)
        self.assertEqual([back[name].shape for name in ("pose", "velocity", "mass")], [(count, 6), (count, 6), (count,)])
        for body in range(1, count):
            pose, velocity, mass, mu = rng.normal(size=6), rng.normal(size=6), rng.normal(), rng.normal()
            forward = z_bar @ self.gradient.jvp(**zwang.scene_change(self.problem, body, pose=pose, velocity=velocity, mass=mass, mu=mu)).dz
            expected = back["pose"][body] @ pose + back["velocity"][body] @ velocity + back["mass"][body] * mass + back["mu"] * mu
            size = sum(numpy.abs(back[name][body]).max() for name in ("pose", "velocity", "mass")) + abs(back["mu"])
            self.assertLess(abs(forward - expected), 1e-11 * size)

    def test_what_cannot_be_is_said_in_one_line(self):
        box = zwang.scene("tower(boxes=1)")
        for word, call in [("not made of bodies", lambda: zwang.scene_change(zwang.scene("random"), mu=1)),
                           ("not made of bodies", lambda: zwang.scene_change(self.problem.under("pyramid"), mu=1)),
                           ("missing", lambda: zwang.scene_change(box, mass=1)), ("0 to 1", lambda: zwang.scene_change(box, 2, mass=1)),
                           ("6 finite", lambda: zwang.scene_change(box, 1, pose=[1, 2])),
                           ("finite", lambda: zwang.scene_change(box, 1, mass=numpy.nan)),
                           ("six numbers", lambda: zwang.scene_change(box, 1, pose="x")),
                           ("0 to 1: 1.5", lambda: zwang.scene_change(box, 1.5, mass=1)), ("mass", lambda: zwang.scene_change(box, 1, mass="a")),
                           (r"bars.'M'. should have the shape \(6, 6\), as the problem, and has \(12, 12\)",
                            lambda: zwang.scene_gradient(box, {"M": numpy.eye(12), "z_u": 0, "J": 0, "c": 0, "mu": 0})),
                           ("bars has no .M.", lambda: zwang.scene_gradient(box, {"z_u": numpy.zeros(6), "c": numpy.zeros(4)})),
                           ("not unique", lambda: zwang.scene_gradient(box, zwang.gradient_of(box, zwang.solve(box)).vjp(numpy.ones(6))))]:
            with self.subTest(word):
                with self.assertRaisesRegex(ValueError, word) as caught:
                    call()
                self.assertNotIn("\n", str(caught.exception))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
