"""Tests of physics, array shapes and errors.

Run with `python -m unittest discover -s runtime/python/tests`.
"""

import importlib.util
import pickle
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from copy import deepcopy
from pathlib import Path

import numpy as np

import linkwork

from mechanisms import PENDULUM, compiled


class OfAPendulum(unittest.TestCase):
    """Rod on a hinge, compared with closed forms."""

    @classmethod
    def setUpClass(cls):
        cls.kind = compiled(PENDULUM)
        cls.m = cls.kind(mass=2.0, length=1.5)

    def test_inertia_and_weight(self):
        np.testing.assert_allclose(self.m.mass_matrix([0.3]), [[2.0 * 1.5**2 / 3]], rtol=1e-14)
        torque = self.m.inverse_dynamics([np.pi / 2], [0.0], [0.0])
        np.testing.assert_allclose(torque, [2.0 * 9.81 * 0.75], rtol=1e-14)

    def test_names_and_units(self):
        self.assertEqual(self.kind.configuration, ["hinge"])
        self.assertEqual(self.kind.inputs, ["motor"])
        self.assertEqual(self.kind.units.parameters, ["kg", "m"])
        self.assertEqual(
            self.kind.__doc__.splitlines(),
            [
                "A rod on a hinge, with a motor.",
                "",
                "Configuration `q`:",
                "    name   unit",
                "    hinge  rad",
                "",
                "Velocities `v`, with the limits of the joints in SI units:",
                "    name   unit",
                "    hinge  rad/s",
                "",
                "Inputs `u`:",
                "    name   unit",
                "    motor  N·m",
                "",
                "Parameters:",
                "    name    unit",
                "    mass    kg",
                "    length  m",
                "",
                "Frames: rod.",
            ],
        )
        self.assertIn("hinge''", self.kind.equations)
        self.assertIn("shape (1,)", self.kind.forward_dynamics.__doc__)
        self.assertEqual(self.m.index_q("hinge"), 0)

    def test_a_run_is_shown_on_one_line(self):
        run = self.m.simulate([2.0], duration=1.0, every=0.25)
        self.assertEqual(repr(run), "Run(Pendulum: 5 samples, t = 0 … 1 s; t, q[1], v[1], u[1])")
        self.assertFalse(run == self.m.simulate([2.0], duration=1.0, every=0.25))
        self.assertEqual(hash(run), hash(run))

    def test_energy_stays(self):
        run = self.m.simulate([2.0], duration=10.0, every=0.1, tolerance=1e-12)
        energy = self.m.kinetic_energy(run.q, run.v) + self.m.potential_energy(run.q)
        self.assertEqual(len(run), 101)
        np.testing.assert_allclose(run.t, np.arange(101) * 0.1, rtol=1e-14, atol=1e-14)
        self.assertLess(np.ptp(energy), 1e-9)

    def test_batches_are_single_states_side_by_side(self):
        rng = np.random.default_rng(1)
        q, v, tau = rng.normal(size=(3, 1003, 1))
        for name in ("inverse_dynamics", "forward_dynamics", "forward_dynamics_derivatives"):
            function = getattr(self.m, name)
            single = [np.atleast_1d(np.asarray(function(*x))) for x in zip(q, v, tau)]
            for threads in (1, 3, 0):
                many = np.asarray(function(q, v, tau, threads=threads))
                many = np.moveaxis(many, 1, 0) if many.ndim > 3 else many
                np.testing.assert_allclose(many, single, rtol=1e-13, atol=1e-13)
        # Results may overwrite earlier results.
        kept = self.m.forward_dynamics_derivatives(q, v, tau)
        expected = [array.copy() for array in kept]
        kept[0][:] = 7.0
        again = self.m.forward_dynamics_derivatives(q, v, tau, out=kept)
        for array, right, before in zip(again, expected, kept):
            np.testing.assert_array_equal(array, right)
            self.assertTrue(np.shares_memory(array, before))
        for wrong in (kept[0], kept[:2], tuple(array[:5] for array in kept), (1, 2, 3)):
            with self.assertRaisesRegex(ValueError, "`out`"):
                self.m.forward_dynamics_derivatives(q, v, tau, out=wrong)
        # An argument may be common to all states.
        np.testing.assert_array_equal(self.m.kinetic_energy(q, [1.0]), self.m.kinetic_energy(q, np.ones((1003, 1))))
        self.assertEqual(self.m.mass_matrix(np.empty((0, 1))).shape, (0, 1, 1))

    def test_derivatives_are_those_of_complex_steps_of_the_closed_form(self):
        # θ̈ = (τ − m g l/2 sin θ) / (m l²/3)
        by_q, by_v, by_tau = self.m.forward_dynamics_derivatives([0.4], [2.0], [1.0])
        inertia = 2.0 * 1.5**2 / 3
        acceleration = lambda q: (1.0 - 2.0 * 9.81 * 0.75 * np.sin(q)) / inertia
        np.testing.assert_allclose(by_q, [[acceleration(0.4 + 1e-30j).imag / 1e-30]], rtol=1e-14)
        np.testing.assert_allclose(by_v, [[0.0]], atol=1e-14)
        np.testing.assert_allclose(by_tau, [[1 / inertia]], rtol=1e-14)

    def test_equilibria_and_linear_systems(self):
        q = self.m.equilibrium({"hinge": 0.2}, {"motor": 5.0})
        np.testing.assert_allclose(np.sin(q), [5.0 / (2.0 * 9.81 * 0.75)], rtol=1e-12)
        with self.assertRaisesRegex(linkwork.Error, "no equilibrium"):
            self.m.equilibrium(inputs=[50.0])
        with self.assertRaisesRegex(linkwork.Error, "not finite"):
            self.m.equilibrium([np.nan])
        np.testing.assert_array_equal(self.m.equilibrium([0.3], held=["hinge"]), [0.3])
        system = self.m.linear_system([np.pi])
        poles = np.sort(np.linalg.eigvals(system.a).real)
        np.testing.assert_allclose(poles, np.sqrt(1.5 * 9.81 / 1.5) * np.array([-1, 1]), rtol=1e-12)
        self.assertEqual(system.states, ["hinge", "hinge.rate"])

    @unittest.skipUnless(importlib.util.find_spec("control"), "python-control is not installed")
    def test_a_regulator_of_python_control(self):
        import control

        # θ̈ = a θ + b u about the upright position: the Riccati equation has a closed-form solution.
        q, (q1, q2), r = 2.0 * 1.5**2 / 3, (10.0, 1.0), 0.1
        a, b = 2.0 * 9.81 * 0.75 / q, 1 / q
        first = (a + np.sqrt(a**2 + b**2 * q1 / r)) / b
        second = np.sqrt((q2 + 2 * first * r / b) / r)
        system = self.m.linear_system([np.pi])
        gain, _, poles = control.lqr(system.control(), np.diag([q1, q2]), [[r]])
        np.testing.assert_allclose(gain, [[first, second]], rtol=1e-9)
        np.testing.assert_allclose(np.sort(np.linalg.eigvals(system.a - system.b @ gain)), np.sort(poles), rtol=1e-9)

    def test_arrays_that_share_memory_or_lie_at_odd_addresses(self):
        q, v, a = np.random.default_rng(5).normal(size=(3, 7, 1))
        expected = self.m.inverse_dynamics(q, v, a)
        odd = np.frombuffer(b"\0" + q.tobytes(), dtype=np.uint8)[1:].view(np.float64).reshape(7, 1)
        np.testing.assert_array_equal(self.m.inverse_dynamics(odd, v, a), expected)
        reused = q.copy()
        self.assertIs(self.m.inverse_dynamics(reused, v, a, out=reused), reused)
        np.testing.assert_array_equal(reused, expected)
        shifted = np.concatenate([q, [[0.0]]])
        self.m.inverse_dynamics(shifted[:7], v, a, out=shifted[1:])
        np.testing.assert_array_equal(shifted[1:], expected)
        both = np.zeros((7, 1, 1))
        with self.assertRaisesRegex(ValueError, "share memory"):
            self.m.inverse_dynamics_derivatives(q, v, a, out=(both, both))
        with self.assertRaisesRegex(linkwork.Error, "samples are too many"):
            self.m.simulate([0.1], duration=1e9, every=1e-9)
        with self.assertRaisesRegex(linkwork.Error, "time at the start"):
            self.m.simulate([0.1], duration=0.1, start=np.nan)

    def test_rollouts_are_steps_one_after_another(self):
        rng = np.random.default_rng(2)
        q, v = rng.normal(size=(2, 21, 1))
        u = rng.normal(size=(21, 30, 1))
        all_q, all_v = self.m.roll_out(q, v, u, h=0.01)
        self.assertEqual(all_q.shape, (21, 31, 1))
        one_q, one_v = q, v
        for k in range(30):
            one_q, one_v = self.m.step(one_q, one_v, u[:, k], 0.01)
            np.testing.assert_allclose(all_q[:, k + 1], one_q, rtol=1e-12, atol=1e-12)
            np.testing.assert_allclose(all_v[:, k + 1], one_v, rtol=1e-12, atol=1e-12)
        again = self.m.roll_out(q, v, u, h=0.01, threads=1)
        np.testing.assert_array_equal(again[0], all_q)
        same = self.m.roll_out(q, v, u[0], h=0.01)
        np.testing.assert_array_equal(same[0][0], all_q[0])

    def test_transitions_are_differences_of_steps(self):
        q, v, u, h, e = np.array([0.7]), np.array([-1.2]), np.array([0.4]), 0.05, 1e-6
        found = self.m.transition(q, v, u, h)
        moved = lambda dq, dv, du: np.array(self.m.step(q + dq, v + dv, u + du, h)).ravel()
        for k, change in enumerate(np.eye(3) * e):
            slope = (moved(*change) - moved(*-change)) / (2 * e)
            np.testing.assert_allclose([found[2 + k][0, 0], found[5 + k][0, 0]], slope, rtol=1e-8, atol=1e-9)

    def test_controllers_act(self):
        hold = lambda t, q, v: [2.0 * 9.81 * 0.75 * np.sin(q[0]) - 40 * (q[0] - 1.0) - 10 * v[0]]
        run = self.m.simulate([0.2], duration=5.0, control=hold, period=0.005)
        self.assertAlmostEqual(run.q[-1, 0], 1.0, places=3)
        self.assertAlmostEqual(run.u[-1, 0], 2.0 * 9.81 * 0.75 * np.sin(1.0), places=1)
        kept = []
        self.m.simulate([0.2], duration=1.0, control=lambda t, q, v: kept.append(q) or [0.0], period=0.1)
        self.assertEqual(len({float(q[0]) for q in kept}), len(kept))
        with self.assertRaises(ZeroDivisionError):
            self.m.simulate([0.2], duration=1.0, control=lambda t, q, v: [1 / 0])
        with self.assertRaisesRegex(ValueError, "u has 1 entries"):
            self.m.simulate([0.2], duration=1.0, control=lambda t, q, v: [1.0, 2.0])

    def test_threads_of_python_go_on(self):
        q = np.linspace(-1, 1, 5000)[:, None]
        with ThreadPoolExecutor(4) as pool:
            found = list(pool.map(lambda _: self.m.mass_matrix(q).sum(), range(20)))
        self.assertEqual(len(set(found)), 1)

    def test_parameters(self):
        heavy = self.m.replace(mass=4.0)
        self.assertEqual(heavy.parameters, {"mass": 4.0, "length": 1.5})
        np.testing.assert_allclose(heavy.mass_matrix([0.0]), 2 * self.m.mass_matrix([0.0]))
        with self.assertRaisesRegex(TypeError, "needs the parameters length"):
            self.kind(mass=1.0)
        with self.assertRaisesRegex(linkwork.UnknownName, "^there is no parameter 'lenght': did you mean 'length'"):
            self.kind(mass=1.0, lenght=2.0)
        named = r"Pendulum takes its parameters by name: Pendulum\(mass=…, length=…\); found "
        for make, found in [
            (lambda: self.kind(2), "2"),
            (lambda: self.kind(2, 1.5), "2, 1.5"),
            (lambda: self.kind([("mass", 2)]), r"\[\("),
            (lambda: self.m.replace(3.0), "3.0"),
        ]:
            with self.assertRaisesRegex(TypeError, named + found):
                make()
        for value in ("2", None, [[1.0], [2.0]], 1j):
            with self.assertRaisesRegex(TypeError, "the parameter 'mass' is a number, found"):
                self.kind(mass=value, length=1.5)
        with self.assertRaisesRegex(linkwork.Error, "mass of `rod` cannot be negative"):
            self.kind(mass=-1.0, length=2.0)
        copies = [pickle.loads(pickle.dumps(self.m)), pickle.loads(pickle.dumps(self.kind))(mass=2.0, length=1.5)]
        for copy in [*copies, deepcopy(self.m)]:
            np.testing.assert_array_equal(copy.mass_matrix([0.1]), self.m.mass_matrix([0.1]))
        self.assertIs(pickle.loads(pickle.dumps(linkwork.Mechanism)), linkwork.Mechanism)

    def test_arrays_of_other_shapes_and_types(self):
        expected = self.m.inverse_dynamics([1.0], [2.0], [3.0])
        np.testing.assert_array_equal(self.m.inverse_dynamics(np.float32([1]), (2,), np.array([3])), expected)
        wide = np.arange(12.0).reshape(6, 2)
        np.testing.assert_array_equal(self.m.mass_matrix(wide[::2, :1]).shape, (3, 1, 1))
        frozen = np.array([1.0])
        frozen.flags.writeable = False
        np.testing.assert_array_equal(self.m.inverse_dynamics(frozen, [2.0], [3.0]), expected)
        for wrong in ([1.0, 2.0], 1.0, np.zeros((2, 3, 1)), np.zeros((1, 2))):
            with self.assertRaisesRegex(ValueError, "has the shape"):
                self.m.mass_matrix(wrong)
        # NumPy would convert all of these to numbers.
        for wrong in (["a"], ["1"], np.array(["2020-01-01"], "datetime64[D]"), np.array([b"1"])):
            with self.assertRaisesRegex(ValueError, "q is an array of numbers"):
                self.m.mass_matrix(wrong)
            with self.assertRaisesRegex(ValueError, "q is an array of numbers"):
                self.m.roll_out([wrong], [[0.0]], steps=1, h=0.1)
        for wrong in ({"steps": 1.5}, {"steps": "1"}, {"steps": 1, "threads": 0.5}):
            with self.assertRaisesRegex(TypeError, "is a whole number, found"):
                self.m.roll_out([[0.0]], [[0.0]], h=0.1, **wrong)
        with self.assertRaisesRegex(ValueError, "`steps` is a whole number that is not negative, found -1"):
            self.m.roll_out([[0.0]], [[0.0]], h=0.1, steps=-1)
        for wrong in ({"held": 1.5}, {"held": None}, {"tolerance": "a"}, {"iterations": 1.5}):
            with self.assertRaisesRegex(TypeError, "found"):
                self.m.equilibrium([0.1], **wrong)
        with self.assertRaisesRegex(TypeError, "complex"):
            self.m.mass_matrix([1j])
        with self.assertRaisesRegex(TypeError, "masked"):
            self.m.mass_matrix(np.ma.array([1.0], mask=[True]))
        with self.assertRaisesRegex(ValueError, "threads"):
            self.m.mass_matrix(np.zeros((3, 1)), threads=-1)
        with self.assertRaisesRegex(ValueError, "arrays of 2 and of 3 states"):
            self.m.kinetic_energy(np.zeros((2, 1)), np.zeros((3, 1)))
        with self.assertRaisesRegex(TypeError, "of a mechanism, not of its class"):
            type(self.m).mass_matrix(np.zeros(1))
        with self.assertRaisesRegex(TypeError, "takes 1 arguments"):
            self.m.mass_matrix([0.0], [0.0])
        with self.assertRaisesRegex(TypeError, r"mass_matrix\(q\): arguments are given without their names"):
            self.m.mass_matrix(q=[0.0])
        with self.assertRaisesRegex(TypeError, "no argument 'thread': did you mean 'threads'"):
            self.m.mass_matrix([0.0], thread=1)
        with self.assertRaisesRegex(ValueError, "q is an array of numbers, found 'a'"):
            self.m.mass_matrix("a")

    def test_entries_are_given_by_name(self):
        given = {"hinge": 1.0}
        expected = self.m.inverse_dynamics([1.0], [1.0], [1.0])
        np.testing.assert_array_equal(self.m.inverse_dynamics(given, given, given), expected)
        np.testing.assert_array_equal(self.m.step(given, {}, {"motor": 2.0}, 0.1), self.m.step([1.0], [0.0], [2.0], 0.1))
        with self.assertRaisesRegex(linkwork.UnknownName, "there is no input 'motr': did you mean 'motor'"):
            self.m.step(given, {}, {"motr": 2.0}, 0.1)
        with self.assertRaisesRegex(TypeError, "the coordinate 'hinge' is a number, found 'up'"):
            self.m.mass_matrix({"hinge": "up"})

    def test_bad_simulations(self):
        for settings, kind, words in [
            ({"duration": -1.0}, ValueError, "duration"),
            ({"duration": 1.0, "every": 0.0}, ValueError, "every"),
            ({"duration": 1.0, "method": "rk4"}, TypeError, "needs a step"),
            ({"duration": 1.0, "method": "rodass"}, linkwork.Error, "no method 'rodass': did you mean 'rodas'"),
            ({"duration": 1.0, "step": -0.1}, ValueError, "step"),
            ({"duration": 1.0, "step": 0}, ValueError, "`step` is a positive number"),
            ({"duration": "1"}, TypeError, "`duration` is a number, found '1'"),
            # Arguments that would have no effect.
            ({"duration": 1.0, "method": "rodas", "step": 0.1}, TypeError, "takes a `tolerance`, not a `step`"),
            ({"duration": 1.0, "step": 0.1, "tolerance": 1e-6}, TypeError, "rk4 takes a `step`, not a `tolerance`"),
            ({"duration": 1.0, "period": 0.1}, TypeError, "`period` is the time between calls of `control`"),
            ({"duration": 1.0, "period": 0.1, "inputs": [1.0]}, TypeError, "`period` is the time between"),
            ({"duration": 1.0, "control": [1.0]}, TypeError, "`control` is a function of t, q, v"),
            ({"duration": 1.0, "tolerence": 1e-6}, TypeError, "no argument 'tolerence': did you mean 'tolerance'"),
        ]:
            with self.subTest(settings), self.assertRaisesRegex(kind, words):
                self.m.simulate([0.1], **settings)
        with self.assertRaisesRegex(ValueError, "q has 1 entries"):
            self.m.simulate([0.1, 0.2], duration=1.0)

    def test_a_page_and_a_table_of_the_motion(self):
        run = self.m.simulate([1.0], duration=1.0, every=0.05)
        with tempfile.TemporaryDirectory() as folder:
            page = run.view(Path(folder) / "swing.html")
            self.assertIn("<html", page.path.read_text(encoding="utf-8")[:200].lower())
            self.assertIn("<iframe", page._repr_html_()[:20])
            run.csv(Path(folder) / "swing.csv")
            head = (Path(folder) / "swing.csv").read_text().splitlines()[0]
            self.assertEqual(head, "t,q.hinge,v.hinge,u.motor")

    @unittest.skipUnless(importlib.util.find_spec("matplotlib"), "matplotlib is not installed")
    def test_plots(self):
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        run = self.m.simulate([1.0], duration=1.0, every=0.05, inputs={"motor": 1.0})
        legend = lambda axes: [text.get_text() for text in axes.get_legend().get_texts()]
        # One plot per unit.
        axes = run.plot("hinge", "v.hinge", "u.motor")
        self.assertEqual([legend(own) for own in axes], [["hinge"], ["v.hinge"], ["u.motor"]])
        units = ["coordinates [rad]", "velocities [rad/s]", "inputs [N·m]"]
        self.assertEqual([own.get_ylabel() for own in axes], units)
        self.assertEqual([own.get_xlabel() for own in axes], ["", "", "t [s]"])
        np.testing.assert_array_equal(axes[2].get_lines()[0].get_ydata(), np.ones(21))
        one = run.plot()
        self.assertEqual((legend(one), one.get_xlabel(), one.get_ylabel()), (["hinge"], "t [s]", "coordinates [rad]"))
        # In given axes, units are appended to the names.
        own = run.plot("hinge", "v.hinge", ax=pyplot.subplots()[1])
        self.assertEqual(legend(own), ["hinge [rad]", "v.hinge [rad/s]"])
        with self.assertRaisesRegex(KeyError, "did you mean 'hinge'"):
            run.plot("hing")
        pyplot.close("all")

    def test_stubs_are_python(self):
        text = self.kind.stub()
        compile(text, "pendulum.pyi", "exec")
        self.assertIn("def mass_matrix(self, q: ArrayLike | Mapping[str, float], /", text)


class WithParametersOfEachState(unittest.TestCase):
    """Arrays of parameters with one value for each state."""

    @classmethod
    def setUpClass(cls):
        cls.kind = compiled(PENDULUM)

    def test_functions_and_rollouts(self):
        mass = np.array([1.0, 2.0, 4.0])
        m = self.kind(mass=mass, length=1.5)
        np.testing.assert_allclose(m.mass_matrix([0.3])[:, 0, 0], mass * 1.5**2 / 3, rtol=1e-14)
        np.testing.assert_allclose(m.inverse_dynamics(np.full((3, 1), np.pi / 2), [0.0], [0.0])[:, 0], mass * 9.81 * 0.75)
        q, _ = m.roll_out(np.ones((3, 1)), np.zeros((3, 1)), np.full((20, 1), 0.5), h=0.01)
        for k in range(3):
            own = self.kind(mass=mass[k], length=1.5)
            np.testing.assert_array_equal(q[k], own.roll_out([[1.0]], [[0.0]], np.full((20, 1), 0.5), h=0.01)[0][0])
        self.assertEqual(repr(m), "Pendulum(mass=<3 values>, length=1.5)")
        np.testing.assert_array_equal(m.parameters["mass"], mass)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(m)).mass_matrix([0.1]), m.mass_matrix([0.1]))
        np.testing.assert_allclose(m.replace(mass=3.0).mass_matrix([0.0]), [[3.0 * 0.75]])

    def test_errors(self):
        for make, kind, words in [
            (lambda: self.kind(mass=np.ones(2), length=np.ones(3)), ValueError, "parameters of 2 and of 3 states"),
            (lambda: self.kind(mass=[1.0, -1.0], length=1.0), linkwork.Error, "state 1: the mass of `rod` cannot be negative"),
            (lambda: self.kind(mass=[1.0, np.nan], length=1.0), linkwork.Error, "`mass` must be finite"),
            (lambda: self.kind(mass=np.ones(2), length=1.0).mass_matrix(np.zeros((3, 1))), ValueError, "arrays of 2 and of 3"),
            (lambda: self.kind(mass=np.ones(2), length=1.0).simulate(duration=1.0), TypeError, "one value of each parameter"),
            (
                lambda: self.kind(mass=np.ones(2), length=1.0).roll_out(np.zeros((3, 1)), np.zeros((3, 1)), steps=1, h=0.1),
                ValueError,
                "parameters of 2 states, but 3 states",
            ),
        ]:
            with self.assertRaisesRegex(kind, words):
                make()


class InSinglePrecision(unittest.TestCase):
    """Mechanism in single precision, which is evaluated in double precision."""

    def test_f32(self):
        m = compiled(PENDULUM.replace("#[mechanism(", "#[mechanism(scalar = f32, ").replace("f64", "f32"))(
            mass=2.0, length=1.5
        )
        found = m.mass_matrix(np.float32([0.3]))
        self.assertEqual(found.dtype, np.float64)
        np.testing.assert_allclose(found, [[1.5]], rtol=1e-14)


if __name__ == "__main__":
    unittest.main()
