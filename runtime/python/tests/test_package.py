"""Tests of saved packages, concurrent compilation, the guide, the gallery and the command."""

import contextlib
import importlib.util
import io
import os
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

from mechanisms import BEAD, PENDULUM, ROBOT, SLIDER, compiled


class AsAPackage(unittest.TestCase):
    """Saved class, used as on another machine."""

    def run_apart(self, folder, code):
        # An interpreter with NumPy and this folder, but without Linkwork and without a toolchain.
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
            # The package may overwrite itself, but no other folder.
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

    def test_saved_packages_are_typed(self):
        checkers = {
            "mypy": ["-m", "mypy", "--strict"],
            "pyright": ["-m", "pyright", "--pythonpath", sys.executable],
        }
        uses = """
import numpy as np
from pendulum import Pendulum, Run

m = Pendulum(mass=2.0, length=1.5)
inertia = m.mass_matrix([0.0])
by_name = m.mass_matrix({"hinge": 0.0})
run: Run = m.simulate({"hinge": 1.0}, duration=1.0, control=lambda t, q, v: -q)
last: float = float(run.q[-1, 0]) + float(inertia[0, 0])
heavier: Pendulum = m.replace(mass=3.0)
q, v = m.roll_out(np.zeros((3, 1)), np.zeros((3, 1)), steps=3, h=0.1)
"""
        kind, bead = compiled(PENDULUM), compiled(BEAD)
        with tempfile.TemporaryDirectory() as folder:
            kind.save(folder)
            bead.save(folder)
            (Path(folder) / "uses.py").write_text(uses, encoding="utf-8")
            (Path(folder) / "wrong.py").write_text("from pendulum import Pendulum\nPendulum(mass=1.0).mass_matrx([0.0])\n")
            for checker, words in checkers.items():
                if importlib.util.find_spec(checker) is None:
                    continue
                for files, expected in [(["pendulum", "bead", "uses.py"], 0), (["wrong.py"], 1)]:
                    with self.subTest(checker, files=files):
                        done = subprocess.run([sys.executable, *words, *files], capture_output=True, text=True, cwd=folder)
                        self.assertEqual(done.returncode, expected, done.stdout + done.stderr)

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
            # Errors in the mechanism, several mechanisms, and a missing file.
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


class AtTheSameTime(unittest.TestCase):
    """Mechanisms that are compiled at the same time are not confused with each other."""

    def test_threads_compile(self):
        # A random radius makes declarations that no other run has compiled.
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
    """Examples of the guide's chapter, which contain assertions."""

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
                        # Examples that need packages which are not installed are skipped.
                        needed = re.findall(r"^import (\w+)", block, flags=re.MULTILINE)
                        if all(importlib.util.find_spec(name) for name in needed):
                            exec(compile(block, "python.md", "exec"), names)
                self.assertTrue(Path("motion.html").is_file())
            finally:
                os.chdir(before)


class OfThePackage(unittest.TestCase):
    """Gallery and command."""

    def test_the_gallery_has_names(self):
        self.assertIn("CartPole", linkwork.gallery())
        with self.assertRaisesRegex(KeyError, "did you mean CartPole"):
            linkwork.gallery("CartPol")
        with self.assertRaisesRegex(TypeError, "quite: settings are of one mechanism"):
            linkwork.gallery(quite=True)

    def test_the_command(self):
        with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
            file.write(ROBOT)
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
