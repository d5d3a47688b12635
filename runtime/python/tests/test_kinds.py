"""Tests of mechanisms with tables, constraints and contacts, and of robot files."""

import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np

import linkwork

from mechanisms import BALL, BEAD, PENDULUM, ROBOT, SLIDER, compiled


class WithTables(unittest.TestCase):
    """Spring whose energy is a parabola, declared as a spline table."""

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
            ({}, linkwork.Error, "tables without values"),
            ({"enrgy": ([[0, 1]], [0, 1])}, KeyError, "there is no table 'enrgy': did you mean 'energy'"),
            ({"energy": ([[0, 1]], [0, 1, 2])}, ValueError, "the axes have"),
            ({"energy": ([[0, 0]], [0, 1])}, linkwork.Error, "does not increase strictly"),
            ({"energy": 3.0}, TypeError, "expected a path"),
            ({"energy": "nowhere.csv"}, FileNotFoundError, "nowhere.csv"),
        ]:
            with self.subTest(tables), self.assertRaisesRegex(kind, words):
                compiled(SLIDER, tables=tables)


class UnderConstraints(unittest.TestCase):
    """Bead on a wire: constraint forces, assembly, and configurations that cannot be reached."""

    @classmethod
    def setUpClass(cls):
        cls.m = compiled(BEAD)(mass=3.0)

    def test_it_hangs_and_is_held(self):
        acceleration, multipliers = self.m.constrained_dynamics([0.0, -1.0], [0.0, 0.0], [0.0, 0.0])
        np.testing.assert_allclose(acceleration, [0.0, 0.0], atol=1e-12)
        jacobian = self.m.constraint_jacobian([0.0, -1.0])
        np.testing.assert_allclose(jacobian.T @ multipliers, [0.0, 3.0 * 9.81], rtol=1e-12, atol=1e-12)

    def test_rollouts_stay_on_the_wire(self):
        # A bead on a circle of radius one is a pendulum: its energy is constant.
        angle = np.array([0.3, 1.2, 2.5])
        q = np.stack([np.sin(angle), -np.cos(angle)], axis=1)
        all_q, all_v = self.m.roll_out(q, np.zeros((3, 2)), steps=400, h=5e-3)
        np.testing.assert_allclose(np.hypot(all_q[..., 0], all_q[..., 1]), 1.0, atol=1e-9)
        np.testing.assert_allclose(np.sum(all_q * all_v, axis=-1), 0.0, atol=1e-9)
        energy = 0.5 * np.sum(all_v**2, axis=-1) + 9.81 * all_q[..., 1]
        np.testing.assert_allclose(energy, np.broadcast_to(energy[:, :1], energy.shape), atol=1e-5)
        self.assertGreater(np.abs(all_q[:, :, 0]).max(), 0.5)
        alone, _ = self.m.roll_out(q[1:2], np.zeros((1, 2)), steps=400, h=5e-3, threads=1)
        np.testing.assert_array_equal(alone[0], all_q[1])
        with self.assertRaisesRegex(linkwork.Error, "step"):
            self.m.roll_out(q, np.zeros((3, 2)), steps=4, h=-1.0)

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
        # At the side, nothing balances the weight, and no equilibrium exists.
        with self.assertRaisesRegex(linkwork.Error, "no equilibrium"):
            self.m.equilibrium([1.0, 0.0], held=["plane.x"])
        # Held in x, the bead is supported by the holding force and the wire.
        np.testing.assert_allclose(self.m.equilibrium([0.6, -0.7], held=["plane.x"]), [0.6, -0.8], atol=1e-9)

    def test_its_linear_system(self):
        system = self.m.linear_system([0.0, -1.0])
        np.testing.assert_allclose(np.linalg.eigvals(system.a).imag, [np.sqrt(9.81), -np.sqrt(9.81)], rtol=1e-10)
        self.assertEqual(system.states, ["plane.x", "plane.x.rate"])
        with self.assertRaisesRegex(linkwork.Error, "about states at rest"):
            self.m.linear_system([0.0, -1.0], [1.0, 0.0])
        with self.assertRaisesRegex(linkwork.Error, "violates the constraints by 0.1"):
            self.m.linear_system([0.0, -0.9])


class WithContacts(unittest.TestCase):
    """Bouncing ball."""

    def test_it_comes_to_rest_and_rises_half_as_fast(self):
        m = compiled(BALL)()
        run = m.simulate([1.0], duration=1.2, every=0.001)
        landing = np.sqrt(2 / 9.81)
        self.assertGreaterEqual(run.q.min(), -1e-12)
        top = run.q[run.t > landing].max()
        self.assertAlmostEqual(top, 0.25, places=5)
        rest = m.simulate([1.0], duration=4.0)
        np.testing.assert_allclose([rest.q[-1, 0], rest.v[-1, 0]], [0.0, 0.0], atol=1e-9)
        for method in ["time_stepping", "time_stepping_midpoint", "time_stepping_leapfrog"]:
            stepped = m.simulate([1.0], duration=4.0, method=method, step=1e-3)
            self.assertAlmostEqual(stepped.q[-1, 0], 0.0, places=6)
        with self.assertRaisesRegex(linkwork.Error, "has contacts"):
            m.simulate([1.0], duration=1.0, method="rk4", step=1e-3)

    def test_rollouts_bounce(self):
        # The heights of the bounces are a quarter of the heights before; all balls rest in the end.
        m, start = compiled(BALL)(), np.array([[0.25], [1.0]])
        q, v = m.roll_out(start, np.zeros((2, 1)), steps=4000, h=1e-3)
        for k, height in enumerate(start[:, 0]):
            landing = int(1000 * np.sqrt(2 * height / 9.81))
            self.assertAlmostEqual(q[k, landing + 5 :].max(), height / 4, delta=0.01)
        np.testing.assert_allclose([q[:, -1], v[:, -1]], 0.0, atol=1e-8)
        self.assertGreater(q.min(), -1e-3)


class OfRobots(unittest.TestCase):
    """Robot files."""

    def test_a_file_and_its_frames(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "two-links.urdf"
            path.write_text(ROBOT)
            arm = linkwork.compile(path)()
            heavy = linkwork.compile(str(path), options="parameters = inertial(\"upper\")")
            broken = Path(folder) / "broken.urdf"
            broken.write_text(ROBOT.replace('link="upper"/><axis', 'link="uper"/><axis'))
            with self.assertRaisesRegex(linkwork.Error, r"broken\.urdf:6.*uper"):
                linkwork.compile(broken)
        self.assertEqual(arm.frames, ["base", "upper", "tool"])
        placement = arm.frame_placement("tool", [np.pi / 2])
        np.testing.assert_allclose(placement @ [0, 0, 0, 1], [-1, 0, 0, 1], atol=1e-15)
        np.testing.assert_allclose(arm.frame_jacobian("tool", [0.0])[:, 0], [-1, 0, 0, 0, 1, 0], atol=1e-15)
        np.testing.assert_allclose(arm.mass_matrix([0.0]), [[0.1 + 2 * 0.25]])
        with self.assertRaisesRegex(KeyError, "did you mean 'tool'"):
            arm.frame_jacobian("tol", [0.0])
        np.testing.assert_array_equal(arm.lower_limits(), [-2.0])
        rows = [line.split("  ") for line in type(arm).__doc__.splitlines() if line.startswith("    shoulder  rad/s")]
        self.assertEqual([[cell.strip() for cell in row if cell.strip()] for row in rows], [["shoulder", "rad/s", "-2", "2", "3", "50"]])
        np.testing.assert_array_equal(arm.clamp_effort([[60.0], [-70.0], [3.0]]), [[50.0], [-50.0], [3.0]])
        m = heavy()
        self.assertEqual(m.parameters["upper.mass"], 2.0)
        np.testing.assert_allclose(m.replace({"upper.mass": 4.0}).mass_matrix([0.0]), [[0.1 + 4 * 0.25]])

    def test_files_that_change_are_compiled_again(self):
        part = """<mujoco><worldbody><body name="block"><joint name="rail" type="slide" axis="1 0 0"/>
          <geom type="sphere" size="0.1" mass="{mass}"/></body></worldbody></mujoco>"""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "whole.xml"
            path.write_text('<mujoco><include file="part.xml"/></mujoco>')
            for mass in (2.0, 3.0, 2.0):
                (Path(folder) / "part.xml").write_text(part.format(mass=mass))
                for _ in range(2):
                    slider = linkwork.compile(path, derivatives=False)()
                    np.testing.assert_allclose(slider.mass_matrix([0.0]), [[mass]])

    def test_names_and_folders_of_all_scripts(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "gelenk-größe 手 'x' \"y\"" / "zwei räder.urdf"
            path.parent.mkdir()
            path.write_text(ROBOT.replace("shoulder", "Schulter größe 手").replace('"upper"', '"Oberarm ß"'), encoding="utf-8")
            arm = linkwork.compile(path, derivatives=False)()
            self.assertEqual(arm.configuration, ["Schulter größe 手"])
            np.testing.assert_allclose(arm.mass_matrix({"Schulter größe 手": 0.3}), [[0.1 + 2 * 0.25]])
            self.assertIn("Schulter größe 手", type(arm).__doc__)
            self.assertEqual(pickle.loads(pickle.dumps(arm)).configuration, arm.configuration)
            compile(type(arm).stub(), "stub.pyi", "exec")
            run = arm.simulate(duration=0.1)
            self.assertTrue(run.view(Path(folder) / "bewegung ß.html").path.is_file())

    def test_errors_name_arguments_of_python(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "heavy.urdf"
            # Moments of inertia that violate the triangle inequality: 1 + 0.1 < 2.
            path.write_text(ROBOT.replace('ixx="0.1"', 'ixx="2"').replace('iyy="0.1"', 'iyy="1"').replace('izz="0.01"', 'izz="0.1"'))
            with self.assertRaisesRegex(linkwork.Error, "`options='inertia = trust'`") as caught:
                linkwork.compile(path)
            self.assertNotRegex(str(caught.exception), r"#\[mechanism|--with")
            # The option in the message makes the file acceptable.
            arm = linkwork.compile(path, options="inertia = trust")()
            np.testing.assert_allclose(arm.mass_matrix([0.0]), [[1 + 2 * 0.25]])
            for options, words in [("base = fre", "base"), ("inertia =", "inertia"), ("(", r"`options=`")]:
                with self.assertRaisesRegex(linkwork.Error, words) as caught:
                    linkwork.compile(path, options=options)
                self.assertNotIn("--with", str(caught.exception))
        with self.assertRaisesRegex(linkwork.Error, r"tables=\{'energy': …\}") as caught:
            compiled(SLIDER)
        self.assertNotIn("--table", str(caught.exception))

    def test_mistakes_have_their_places(self):
        with self.assertRaisesRegex(linkwork.Error, r"^declaration:\d+:\d+: error: .*massa"):
            compiled(PENDULUM.replace("mass = mass, com", "massa = mass, com"))
        with self.assertRaisesRegex(linkwork.Error, "choose one of Pendulum, Bead with `name=`"):
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
            (Path(folder) / "robot.urdf").write_text(ROBOT)
            with self.assertRaisesRegex(FileNotFoundError, "did you mean robot.urdf"):
                linkwork.compile(Path(folder) / "robbot.urdf")
            with self.assertRaisesRegex(FileNotFoundError, "is a folder"):
                linkwork.compile(folder)
        with self.assertRaisesRegex(TypeError, r"compile\(\) has no argument 'optoins': did you mean 'options'"):
            linkwork.compile(PENDULUM, optoins="batch")
        with self.assertRaises(TypeError):
            linkwork.compile(3)


if __name__ == "__main__":
    unittest.main()
