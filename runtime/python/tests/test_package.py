"""Tests of the package: processes and threads, types, the guide, the gallery."""

import contextlib
import gc
import importlib.util
import io
import multiprocessing
import os
import pickle
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import linkwork

from mechanisms import BEAD, PENDULUM, SLIDER, compiled

ROOT = Path(__file__).resolve().parents[3]


def inertia_of(mechanism):
    return float(mechanism.mass_matrix([0.0])[0, 0])


class AtTheSameTime(unittest.TestCase):
    """Threads and processes."""

    def test_threads_load_and_call(self):
        def one(k):
            m = compiled(PENDULUM.replace("rod(mass, length, y)", f"sphere(mass, {k})"))(mass=2.0, length=1.5)
            return float(m.mass_matrix(np.zeros((300, 1)))[-1, 0, 0])

        with ThreadPoolExecutor(4) as pool:
            found = list(pool.map(one, range(1, 9)))
        np.testing.assert_allclose(found, [0.4 * 2.0 * k**2 + 2.0 * 0.75**2 for k in range(1, 9)], rtol=1e-14)

    def test_threads_call_new_functions(self):
        # All threads need the machine code of the same function at once.
        m = compiled(PENDULUM)(mass=2.0, length=1.5)
        barrier, found = threading.Barrier(4), []

        def one():
            barrier.wait()
            found.append(m.bias_forces(np.array([np.pi / 2]), np.zeros(1))[0])

        threads = [threading.Thread(target=one) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        np.testing.assert_allclose(found, [2.0 * 9.81 * 0.75] * 4, rtol=1e-14)

    def test_processes(self):
        m = compiled(PENDULUM)(mass=2.0, length=1.5)
        m.mass_matrix([0.0])
        methods = [method for method in ("fork", "spawn") if method in multiprocessing.get_all_start_methods()]
        for method in methods:
            with self.subTest(method), multiprocessing.get_context(method).Pool(2) as pool:
                self.assertEqual(pool.map(inertia_of, [m, m.replace(mass=4.0)]), [1.5, 3.0])

    def test_memory_is_returned(self):
        load = lambda: compiled(SLIDER, tables={"energy": ([[0.0, 1.0]], [0.0, 1.0])}, derivatives=False)(mass=1.0).mass_matrix([0.0])
        measured = []
        for count in (30, 60):
            for _ in range(count):
                load()
            gc.collect()
            measured.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
        # 60 classes with their code; each would take about 100 kB if it were kept.
        self.assertLess(measured[1] - measured[0], 3000)

    def test_pickling(self):
        robot = linkwork.compile(ROOT / "models" / "urdf" / "double_pendulum.urdf")()
        again = pickle.loads(pickle.dumps(robot))
        self.assertIs(type(pickle.loads(pickle.dumps(robot))), type(again))
        np.testing.assert_array_equal(again.mass_matrix(np.zeros(robot.nq)), robot.mass_matrix(np.zeros(robot.nq)))
        gallery = linkwork.gallery("Ur5")()
        self.assertEqual(pickle.loads(pickle.dumps(gallery)).velocities, gallery.velocities)


class Typed(unittest.TestCase):
    """The package and the stubs of classes, by type checkers."""

    USES = """
import linkwork
import numpy as np
from pendulum import Pendulum

m = Pendulum(mass=2.0, length=1.5)
inertia = m.mass_matrix([0.0])
by_name = m.mass_matrix({"hinge": 0.0})
run: linkwork.Run = m.simulate({"hinge": 1.0}, duration=1.0, control=lambda t, q, v: -q)
last: float = float(run.q[-1, 0]) + float(inertia[0, 0])
heavier: Pendulum = m.replace(mass=np.array([3.0, 4.0]))
q, v = m.roll_out(np.zeros((3, 1)), np.zeros((3, 1)), steps=3, h=0.1)
Arm = linkwork.compile("arm.urdf")
torques = Arm().inverse_dynamics(q, v, v)
equations: str = Arm.equations
"""

    def test_checkers(self):
        checkers = {"mypy": ["-m", "mypy", "--strict"], "pyright": ["-m", "pyright", "--pythonpath", sys.executable]}
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "pendulum.pyi").write_text(compiled(PENDULUM).stub(), encoding="utf-8")
            (Path(folder) / "bead.pyi").write_text(compiled(BEAD).stub(), encoding="utf-8")
            (Path(folder) / "uses.py").write_text(self.USES, encoding="utf-8")
            (Path(folder) / "wrong.py").write_text("from pendulum import Pendulum\nPendulum(mass=1.0).mass_matrx([0.0])\n")
            # A copy, because mypy refuses to check installed packages.
            package = Path(folder) / "linkwork"
            shutil.copytree(Path(linkwork.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
            # Modules whose optional dependencies are not installed are not checked.
            absent = [name for name in ("torch", "jax") if importlib.util.find_spec(name) is None]
            modules = [str(path) for path in sorted(package.glob("*.py*")) if path.suffix != ".pyc" and path.stem not in absent]
            environment = {**os.environ, "MYPYPATH": folder}
            for checker, words in checkers.items():
                if importlib.util.find_spec(checker) is None:
                    continue
                for files, expected in [(["bead.pyi", "uses.py", *modules], 0), (["wrong.py"], 1)]:
                    with self.subTest(checker, files=files):
                        done = subprocess.run(
                            [sys.executable, *words, *files], capture_output=True, text=True, cwd=folder, env=environment
                        )
                        self.assertEqual(done.returncode, expected, done.stdout + done.stderr)


class OfTheGuide(unittest.TestCase):
    """Examples of the guide's chapter, which contain assertions."""

    def test_examples(self):
        text = (ROOT / "runtime" / "guide" / "python.md").read_text(encoding="utf-8")
        blocks = re.findall(r"^```python\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
        self.assertGreater(len(blocks), 3)
        with tempfile.TemporaryDirectory() as folder:
            os.symlink(ROOT / "models", Path(folder) / "models")
            before, names = os.getcwd(), {}
            os.chdir(folder)
            try:
                with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
                    for block in blocks:
                        # Examples that need packages which are not installed are skipped.
                        needed = re.findall(r"^import ([\w.]+)", block, flags=re.MULTILINE)
                        if all(importlib.util.find_spec(name.split(".")[0]) for name in needed if name != "linkwork.torch"):
                            exec(compile(block, "python.md", "exec"), names)
                self.assertTrue(Path("motion.html").is_file())
            finally:
                os.chdir(before)


class OfTheGallery(unittest.TestCase):
    """Gallery."""

    def test_names(self):
        self.assertIn("CartPole", linkwork.gallery())
        with self.assertRaisesRegex(KeyError, "did you mean CartPole"):
            linkwork.gallery("CartPol")
        with self.assertRaisesRegex(TypeError, "quite: settings are of one mechanism"):
            linkwork.gallery(quite=True)

    def test_all_are_loaded(self):
        for name in linkwork.gallery():
            with self.subTest(name):
                try:
                    kind = linkwork.gallery(name, derivatives=False)
                except linkwork.Error as error:
                    # Mechanisms with tables need their values.
                    self.assertRegex(str(error), "tables without values")
                    continue
                self.assertEqual(kind.name, name)
                self.assertGreater(len(kind._functions), 5)


if __name__ == "__main__":
    unittest.main()
