"""Physics, shapes and mistakes, as a user meets them. Run with `python -m unittest discover -s runtime/python/tests`."""

import contextlib
import importlib.util
import io
import os
import pickle
import re
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import linkwork
from linkwork import _build

PENDULUM = """
/// A rod on a hinge, with a motor.
#[mechanism(gravity = -9.81 * y)]
pub struct Pendulum {
    pub mass: f64,
    pub length: f64,
    #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
}
"""
# A point on a circle of radius 1 in the plane: a pendulum by a constraint.
BEAD = """
#[mechanism(gravity = -9.81 * y)]
pub struct Bead {
    pub mass: f64,
    #[particle(mass = mass)]
    bead: Particle,
    #[joint(ground -> bead, along = (x, y))]
    plane: Stage,
    #[constraint(plane.x * plane.x + plane.y * plane.y = 1)]
    wire: Holonomic,
}
"""
# A mass on a spring whose energy is a table.
SLIDER = """
#[mechanism]
pub struct Slider {
    pub mass: f64,
    pub energy: Table<1>,
    #[particle(mass = mass)]
    block: Particle,
    #[joint(ground -> block, along = x)]
    rail: Sleeve,
    #[energy(energy(rail))]
    spring: Potential,
}
"""
BALL = """
#[mechanism(gravity = -9.81 * z)]
pub struct Bouncing {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[contact(ball, ground.plane(z), restitution = 0.5)]
    floor: Contact,
}
"""


def compiled(declaration, **settings):
    return linkwork.compile(declaration, quiet=True, **settings)


class OfAPendulum(unittest.TestCase):
    """A rod on a hinge against its closed forms."""

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
        self.assertEqual(self.kind.__doc__, "A rod on a hinge, with a motor.")
        self.assertIn("hinge''", self.kind.equations)
        self.assertIn("shape (1,)", self.kind.forward_dynamics.__doc__)
        self.assertEqual(self.m.index_q("hinge"), 0)

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
        # Results may go where earlier ones are.
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
        # One argument for all states.
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

        # θ̈ = a θ + b u about the upper position: the equation of Riccati has a closed form.
        q, (q1, q2), r = 2.0 * 1.5**2 / 3, (10.0, 1.0), 0.1
        a, b = 2.0 * 9.81 * 0.75 / q, 1 / q
        first = (a + np.sqrt(a**2 + b**2 * q1 / r)) / b
        second = np.sqrt((q2 + 2 * first * r / b) / r)
        system = self.m.linear_system([np.pi])
        gain, _, poles = control.lqr(system.control(), np.diag([q1, q2]), [[r]])
        np.testing.assert_allclose(gain, [[first, second]], rtol=1e-9)
        np.testing.assert_allclose(np.sort(np.linalg.eigvals(system.a - system.b @ gain)), np.sort(poles), rtol=1e-9)

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
        for value in ("2", None, [1.0, 2.0], 1j):
            with self.assertRaisesRegex(TypeError, "the parameter 'mass' is a number, found"):
                self.kind(mass=value, length=1.5)
        with self.assertRaisesRegex(linkwork.Error, "mass of `rod` cannot be negative"):
            self.kind(mass=-1.0, length=2.0)
        copy = pickle.loads(pickle.dumps(self.m))
        np.testing.assert_array_equal(copy.mass_matrix([0.1]), self.m.mass_matrix([0.1]))

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
        with self.assertRaises((ValueError, TypeError)):
            self.m.mass_matrix(["a"])
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
            ({"duration": 1.0, "method": "time_stepping", "step": 0.1}, linkwork.Error, "no contacts"),
            ({"duration": 1.0, "step": -0.1}, ValueError, "step"),
            ({"duration": 1.0, "step": 0}, ValueError, "`step` is a positive number"),
            ({"duration": "1"}, TypeError, "`duration` is a number, found '1'"),
            # What would be without effect.
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
        # A unit, axes of its own.
        axes = run.plot("hinge", "v.hinge", "u.motor")
        self.assertEqual([legend(own) for own in axes], [["hinge"], ["v.hinge"], ["u.motor"]])
        units = ["coordinates [rad]", "velocities [rad/s]", "inputs [N·m]"]
        self.assertEqual([own.get_ylabel() for own in axes], units)
        self.assertEqual([own.get_xlabel() for own in axes], ["", "", "t [s]"])
        np.testing.assert_array_equal(axes[2].get_lines()[0].get_ydata(), np.ones(21))
        one = run.plot()
        self.assertEqual((legend(one), one.get_xlabel(), one.get_ylabel()), (["hinge"], "t [s]", "coordinates [rad]"))
        # In axes that are given, units stand with the names.
        own = run.plot("hinge", "v.hinge", ax=pyplot.subplots()[1])
        self.assertEqual(legend(own), ["hinge [rad]", "v.hinge [rad/s]"])
        with self.assertRaisesRegex(KeyError, "did you mean 'hinge'"):
            run.plot("hing")
        pyplot.close("all")

    def test_stubs_are_python(self):
        text = self.kind.stub()
        compile(text, "pendulum.pyi", "exec")
        self.assertIn("def mass_matrix(self, q: ArrayLike, /", text)


class AsAPackage(unittest.TestCase):
    """A class that is saved: what another machine has of it."""

    def run_apart(self, folder, code):
        # An interpreter that knows NumPy and this folder, but not Linkwork, and no toolchain.
        paths = os.pathsep.join([str(folder), str(Path(np.__file__).parents[1])])
        environment = {"PATH": "/nonexistent", "PYTHONPATH": paths, "PYTHONSAFEPATH": "1"}
        barrier = "import sys; sys.modules['linkwork'] = None\n"
        done = subprocess.run([sys.executable, "-c", barrier + code], capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.strip()

    def test_it_needs_neither_linkwork_nor_rust(self):
        kind = compiled(PENDULUM)
        with tempfile.TemporaryDirectory() as folder:
            package = kind.save(folder)
            self.assertEqual(package, Path(folder) / "pendulum")
            # Again over itself, but not over anything else.
            self.assertEqual(kind.save(folder), package)
            (Path(folder) / "else" / "pendulum" / "own").mkdir(parents=True)
            with self.assertRaisesRegex(FileExistsError, "no package of a mechanism"):
                kind.save(Path(folder) / "else")
            code = """
import copy, pickle
from pendulum import Error, Pendulum
m = pickle.loads(pickle.dumps(Pendulum(mass=2.0, length=1.5)))
run = m.simulate([2.0], duration=1.0, every=0.5)
try:
    run.view("page.html")
except Error as error:
    assert "package `linkwork`" in str(error)
print(Pendulum.__module__, m.mass_matrix([0.0])[0, 0], run.q[-1, 0])
"""
            expected = kind(mass=2.0, length=1.5).simulate([2.0], duration=1.0, every=0.5).q[-1, 0]
            name, inertia, q = self.run_apart(folder, code).split()
            self.assertEqual((name, float(inertia), float(q)), ("pendulum", 1.5, expected))
            stub = (package / "__init__.pyi").read_text(encoding="utf-8")
            compile(stub, "pendulum.pyi", "exec")
            self.assertNotIn("import linkwork", stub)

    def test_the_command_writes_it(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "slider.rs"
            file.write_text(SLIDER, encoding="utf-8")
            figures = Path(folder) / "energy.csv"
            figures.write_text("x,energy\n-2,16\n0,0\n2,16\n", encoding="utf-8")
            arguments = [str(file), "--table", f"energy={figures},smooth", "--native", "--out", folder]
            words = [sys.executable, "-m", "linkwork", "export", "python", *arguments]
            done = subprocess.run(words, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("__init__.pyi", done.stdout)
            code = "from slider import Slider; print(float(Slider(mass=2.0).potential_energy([0.5])))"
            self.assertAlmostEqual(float(self.run_apart(folder, code)), 1.0, places=13)
            # Mistakes of the mechanism, and what cannot be read.
            file.write_text(SLIDER.replace("along = x", "along = w"), encoding="utf-8")
            done = subprocess.run(words, capture_output=True, text=True)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertIn("slider.rs:", done.stderr)
            file.write_text(SLIDER + BEAD, encoding="utf-8")
            done = subprocess.run(words, capture_output=True, text=True)
            self.assertEqual((done.returncode, "several mechanisms" in done.stderr), (2, True))
            file.unlink()
            done = subprocess.run(words, capture_output=True, text=True)
            self.assertEqual((done.returncode, "there is no file" in done.stderr), (2, True))


class WithTables(unittest.TestCase):
    """A parabola as a smooth table: the spring of that energy."""

    def test_figures_are_those_that_are_given(self):
        figures = ([[-2.0, 0.0, 2.0]], [16.0, 0.0, 16.0], "smooth")
        m = compiled(SLIDER, tables={"energy": figures})(mass=2.0)
        x = np.linspace(-2, 2, 7)[:, None]
        np.testing.assert_allclose(m.potential_energy(x), 4 * x[:, 0] ** 2, atol=1e-13)
        run = m.simulate([1.0], duration=3.0, tolerance=1e-11)
        np.testing.assert_allclose(run.q[:, 0], np.cos(2 * run.t), atol=1e-8)
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "energy.csv"
            file.write_text("x,energy\n2,16\n-2,16\n0,0\n")
            again = compiled(SLIDER, tables={"energy": (file, "smooth")})(mass=2.0)
            self.assertEqual(again.potential_energy([0.5]), m.potential_energy([0.5]))
            page = run.view(Path(folder) / "slider.html")
            self.assertGreater(page.path.stat().st_size, 1000)

    def test_what_is_no_table_is_told(self):
        for tables, kind, words in [
            ({}, linkwork.Error, "tables without figures"),
            ({"enrgy": ([[0, 1]], [0, 1])}, linkwork.Error, "there is no table `enrgy`, but energy"),
            ({"energy": ([[0, 1]], [0, 1, 2])}, ValueError, "the axes have"),
            ({"energy": ([[0, 0]], [0, 1])}, linkwork.Error, "stands there twice"),
            ({"energy": 3.0}, TypeError, "expected a path"),
            ({"energy": "nowhere.csv"}, FileNotFoundError, "nowhere.csv"),
        ]:
            with self.subTest(tables), self.assertRaisesRegex(kind, words):
                compiled(SLIDER, tables=tables)


class UnderConstraints(unittest.TestCase):
    """A bead on a wire: forces of constraints, assembling, and where it cannot go."""

    @classmethod
    def setUpClass(cls):
        cls.m = compiled(BEAD)(mass=3.0)

    def test_it_hangs_and_is_held(self):
        acceleration, multipliers = self.m.constrained_dynamics([0.0, -1.0], [0.0, 0.0], [0.0, 0.0])
        np.testing.assert_allclose(acceleration, [0.0, 0.0], atol=1e-12)
        jacobian = self.m.constraint_jacobian([0.0, -1.0])
        np.testing.assert_allclose(jacobian.T @ multipliers, [0.0, 3.0 * 9.81], rtol=1e-12, atol=1e-12)

    def test_assembling(self):
        q = self.m.assemble([0.6, -0.7], ["plane.x"])
        np.testing.assert_allclose(q, [0.6, -0.8], rtol=1e-12)
        with self.assertRaises(linkwork.Error):
            self.m.assemble([1.5, 0.0], ["plane.x"])
        named = self.m.assemble({"plane.x": 0.6, "plane.y": -0.7}, "plane.x")
        np.testing.assert_array_equal(named, q)
        for held, kind in [("plane.z", KeyError), ([2], IndexError), ([-1], IndexError), ([0.5], IndexError)]:
            with self.assertRaises(kind):
                self.m.assemble(q, held)

    def test_documentation_is_for_python(self):
        text = self.m.assemble.__doc__
        self.assertIn("\nRaises:\n    Error: where none is found, for an index that is none.\n", text)
        self.assertIn("    q: shape (2,), or values by name\n    held: names of velocities, or their indices\n", text)
        for name in self.m._functions:
            text = getattr(self.m, name).__doc__
            self.assertNotRegex(text, r"\]\(|\[`|::|# Errors|None\b", name)

    def test_what_has_no_inputs_has_no_controller(self):
        with self.assertRaisesRegex(TypeError, "Bead has no inputs that `control` could give"):
            self.m.simulate([1.0, 0.0], duration=1.0, control=lambda t, q, v: [])

    def test_a_failure_in_a_batch_names_its_state(self):
        q = np.array([[0.6, -0.7], [1.5, 0.0], [0.0, -0.9]])
        with self.assertRaisesRegex(linkwork.Error, "state 1"):
            self.m.assemble(q, [0])

    def test_it_swings_on_the_wire(self):
        run = self.m.simulate([1.0, 0.0], duration=5.0, every=0.05, tolerance=1e-11)
        np.testing.assert_allclose(np.hypot(*run.q.T), 1.0, rtol=1e-12)
        energy = self.m.kinetic_energy(run.q, run.v) + self.m.potential_energy(run.q)
        self.assertLess(np.ptp(energy), 1e-7)

    def test_its_equilibria(self):
        np.testing.assert_allclose(self.m.equilibrium([0.3, -0.8]), [0.0, -1.0], atol=1e-9)
        # At the side, where nothing holds it up, there is none.
        with self.assertRaisesRegex(linkwork.Error, "no equilibrium"):
            self.m.equilibrium([1.0, 0.0], held=["plane.x"])
        # Held in x it hangs from its holder and the wire.
        np.testing.assert_allclose(self.m.equilibrium([0.6, -0.7], held=["plane.x"]), [0.6, -0.8], atol=1e-9)

    def test_its_linear_system(self):
        system = self.m.linear_system([0.0, -1.0])
        np.testing.assert_allclose(np.linalg.eigvals(system.a).imag, [np.sqrt(9.81), -np.sqrt(9.81)], rtol=1e-10)
        self.assertEqual(system.states, ["plane.x", "plane.x.rate"])
        with self.assertRaisesRegex(linkwork.Error, "off the constraints by 0.1"):
            self.m.linear_system([0.0, -0.9])


class WithContacts(unittest.TestCase):
    """A ball that bounces."""

    def test_it_comes_to_rest_and_rises_half_as_fast(self):
        m = compiled(BALL)()
        run = m.simulate([1.0], duration=1.2, every=0.001)
        landing = np.sqrt(2 / 9.81)
        self.assertGreaterEqual(run.q.min(), -1e-12)
        top = run.q[run.t > landing].max()
        self.assertAlmostEqual(top, 0.25, places=5)
        rest = m.simulate([1.0], duration=4.0)
        np.testing.assert_allclose([rest.q[-1, 0], rest.v[-1, 0]], [0.0, 0.0], atol=1e-9)
        stepped = m.simulate([1.0], duration=4.0, method="time_stepping", step=1e-3)
        self.assertAlmostEqual(stepped.q[-1, 0], 0.0, places=6)
        with self.assertRaisesRegex(linkwork.Error, "has contacts"):
            m.simulate([1.0], duration=1.0, method="rk4", step=1e-3)


class OfRobots(unittest.TestCase):
    """A file."""

    ROBOT = """<robot name="two links">
      <link name="base"/>
      <link name="upper"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
        <inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <link name="tool"/>
      <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
        <limit lower="-2" upper="2" effort="50" velocity="3"/></joint>
      <joint name="flange" type="fixed"><parent link="upper"/><child link="tool"/><origin xyz="0 0 -1"/></joint>
    </robot>"""

    def test_a_file_and_its_frames(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "two-links.urdf"
            path.write_text(self.ROBOT)
            arm = linkwork.compile(path, quiet=True)()
            heavy = linkwork.compile(str(path), options="parameters = inertial(\"upper\")", quiet=True)
            broken = Path(folder) / "broken.urdf"
            broken.write_text(self.ROBOT.replace('link="upper"/><axis', 'link="uper"/><axis'))
            with self.assertRaisesRegex(linkwork.Error, r"broken\.urdf:6.*uper"):
                linkwork.compile(broken, quiet=True)
        self.assertEqual(arm.frames, ["base", "upper", "tool"])
        placement = arm.frame_placement("tool", [np.pi / 2])
        np.testing.assert_allclose(placement @ [0, 0, 0, 1], [-1, 0, 0, 1], atol=1e-15)
        np.testing.assert_allclose(arm.frame_jacobian("tool", [0.0])[:, 0], [-1, 0, 0, 0, 1, 0], atol=1e-15)
        np.testing.assert_allclose(arm.mass_matrix([0.0]), [[0.1 + 2 * 0.25]])
        with self.assertRaisesRegex(KeyError, "did you mean 'tool'"):
            arm.frame_jacobian("tol", [0.0])
        np.testing.assert_array_equal(arm.lower_limits(), [-2.0])
        np.testing.assert_array_equal(arm.clamp_effort([[60.0], [-70.0], [3.0]]), [[50.0], [-50.0], [3.0]])
        m = heavy()
        self.assertEqual(m.parameters["upper.mass"], 2.0)
        np.testing.assert_allclose(m.replace({"upper.mass": 4.0}).mass_matrix([0.0]), [[0.1 + 4 * 0.25]])

    def test_mistakes_have_their_places(self):
        with self.assertRaisesRegex(linkwork.Error, r"mechanism\.rs:\d+:\d+: error: .*massa"):
            compiled(PENDULUM.replace("mass = mass, com", "massa = mass, com"))
        with self.assertRaisesRegex(linkwork.Error, "choose one with `name=`: Pendulum, Bead"):
            compiled(PENDULUM + BEAD)
        with self.assertRaisesRegex(linkwork.Error, "expected a path, or a declaration"):
            linkwork.compile("#[nothing]")
        for empty in ("", " \n"):
            with self.assertRaisesRegex(linkwork.Error, "a declaration: a struct .* found an empty text"):
                linkwork.compile(empty)
        with self.assertRaisesRegex(FileNotFoundError, "no file nowhere.urdf$"):
            linkwork.compile("nowhere.urdf")
        with self.assertRaisesRegex(FileNotFoundError, r"`linkwork\.gallery\('CartPole'\)`"):
            linkwork.compile("CartPole")
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "robot.urdf").write_text(self.ROBOT)
            with self.assertRaisesRegex(FileNotFoundError, "did you mean robot.urdf"):
                linkwork.compile(Path(folder) / "robbot.urdf")
            with self.assertRaisesRegex(FileNotFoundError, "is a folder"):
                linkwork.compile(folder)
        with self.assertRaisesRegex(TypeError, r"compile\(\) has no argument 'optoins': did you mean 'options'"):
            linkwork.compile(PENDULUM, optoins="batch")
        with self.assertRaises(TypeError):
            linkwork.compile(3)


class InSinglePrecision(unittest.TestCase):
    """Numbers of the mechanism's own type."""

    def test_f32(self):
        m = compiled(PENDULUM.replace("#[mechanism(", "#[mechanism(scalar = f32, ").replace("f64", "f32"))(
            mass=2.0, length=1.5
        )
        found = m.mass_matrix([0.3])
        self.assertEqual(found.dtype, np.float32)
        np.testing.assert_allclose(found, [[1.5]], rtol=1e-6)
        run = m.simulate([1.0], duration=1.0, tolerance=1e-5)
        self.assertEqual(run.q.dtype, np.float32)


class AtTheSameTime(unittest.TestCase):
    """Several are compiled at once: none is taken for another."""

    def test_threads_compile(self):
        # A size of their own makes declarations that no other run has compiled.
        size = 1 + np.random.default_rng().uniform()
        kinds = [PENDULUM.replace("inertia = rod(mass, length, y)", f"inertia = sphere(mass, {k * size})") for k in (1, 2, 3)]
        with ThreadPoolExecutor(3) as pool:
            found = list(pool.map(lambda text: compiled(text, batch=False, derivatives=False), kinds))
        for k, kind in enumerate(found, 1):
            m = kind(mass=2.0, length=1.5)
            inertia = 0.4 * 2.0 * (k * size) ** 2 + 2.0 * 0.75**2
            np.testing.assert_allclose(m.mass_matrix([0.0]), [[inertia]], rtol=1e-14)
            self.assertFalse(hasattr(m, "linearize"))
            with self.assertRaisesRegex(linkwork.Error, "derivatives=True"):
                m.linear_system([0.0])


class OfTheGuide(unittest.TestCase):
    """The chapter of the guide: its examples assert what they say."""

    def test_examples(self):
        home = _build._sources()
        text = (home / "runtime" / "guide" / "python.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^```python\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
        self.assertGreater(len(blocks), 3)
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(home / "models", Path(folder) / "models")
            before, names = os.getcwd(), {}
            os.chdir(folder)
            try:
                with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                    for block in blocks:
                        # Other packages need not be there.
                        needed = re.findall(r"^import (\w+)", block, flags=re.MULTILINE)
                        if all(importlib.util.find_spec(name) for name in needed):
                            exec(compile(block, "python.md", "exec"), names)
                self.assertTrue(Path("motion.html").is_file())
            finally:
                os.chdir(before)


class OfThePackage(unittest.TestCase):
    """The gallery, and the command."""

    def test_the_gallery_has_names(self):
        self.assertIn("CartPole", linkwork.gallery())
        with self.assertRaisesRegex(KeyError, "did you mean CartPole"):
            linkwork.gallery("CartPol")
        with self.assertRaisesRegex(TypeError, "quite: settings are of one mechanism"):
            linkwork.gallery(quite=True)

    def test_the_command(self):
        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(OfRobots.ROBOT)
            file.flush()
            done = subprocess.run([sys.executable, "-m", "linkwork", "show", file.name], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("shoulder", done.stdout)

    def test_a_command_of_ones_own_is_of_the_same_version(self):
        with tempfile.TemporaryDirectory() as folder:
            other = Path(folder) / "linkwork"
            other.write_text("#!/bin/sh\necho linkwork 0.0.1\n")
            other.chmod(0o755)
            environment = {**os.environ, "LINKWORK_COMMAND": str(other)}
            words = [sys.executable, "-m", "linkwork", "--version"]
            done = subprocess.run(words, capture_output=True, text=True, env=environment)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("names 'linkwork 0.0.1', and this package needs 'linkwork 0.1.0'", done.stderr)

    def test_a_missing_toolchain_is_told(self):
        code = "import linkwork; linkwork.compile('#[mechanism] struct A {}')"
        environment = {"PATH": "/nonexistent", "HOME": "/nonexistent", "PYTHONPATH": str(Path(linkwork.__file__).parents[1])}
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
        self.assertIn("ToolchainError: compiling a mechanism needs Rust", done.stderr)


if __name__ == "__main__":
    unittest.main()
