"""Tests of the cache: concurrent processes, killed processes, damaged files, read-only folders."""

import os
import pickle
import random
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

import linkwork
from linkwork import _build, _cache
from linkwork._functions import digest_file, is_intact

from mechanisms import PENDULUM, compiled

PACKAGE = Path(linkwork.__file__).resolve().parents[1]
# Program that builds a file slowly, in two steps, and logs that it did.
BUILD = """
import os, sys, time
from pathlib import Path
from linkwork import _cache

def build(target):
    target.mkdir(exist_ok=True)
    made = target / "made"
    made.write_text("half")
    time.sleep(float(sys.argv[2]))
    made.write_text("whole" * 1000)
    with open(sys.argv[3], "a") as log:
        log.write("built\\n")
    return made

print(len(_cache.build_once(_cache.cache_folder() / "libraries" / sys.argv[1], build, quiet=True).read_text()))
"""


def environment(cache):
    return {**os.environ, "LINKWORK_CACHE": str(cache), "PYTHONPATH": str(PACKAGE)}


class WithSeveralProcesses(unittest.TestCase):
    """Processes that need the same file at the same time, in an empty cache."""

    def race(self, rng, processes, killed, seconds):
        with tempfile.TemporaryDirectory() as folder:
            cache, log = Path(folder) / "cache", Path(folder) / "log"
            words = [sys.executable, "-c", BUILD, "file", str(seconds), str(log)]
            run = lambda: subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment(cache))
            started = [run() for _ in range(processes + killed)]
            rng.shuffle(started)
            for process in started[:killed]:
                time.sleep(rng.uniform(0, 0.6))
                process.kill()
            ended = [(process, *process.communicate(timeout=60)) for process in started]
            for process, out, err in ended[killed:]:
                self.assertEqual((process.returncode, out.strip()), (0, "5000"), err)
            # A process that was killed after logging its build may have caused another build.
            built = len(log.read_text().splitlines())
            self.assertTrue(1 <= built <= 1 + killed, built)
            left = sorted(path.name for path in (cache / "libraries").iterdir() if path.suffix != ".unfinished")
            self.assertEqual(left, ["file", "file.sha256"])

    def test_one_builds_and_all_find_it(self):
        self.race(random.Random(1), processes=6, killed=0, seconds=0.2)

    def test_killed_processes_block_nobody(self):
        rng = random.Random(2)
        for _ in range(3):
            self.race(rng, processes=3, killed=3, seconds=rng.uniform(0.05, 0.3))

    def test_threads_build_one_at_a_time(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, {"LINKWORK_CACHE": folder}):
            inside, most, built = [], [], []

            def build(target):
                inside.append(1)
                most.append(len(inside))
                time.sleep(0.02)
                inside.pop()
                made = Path(folder) / f"made-{threading.get_ident()}"
                made.write_text("made")
                built.append(made)
                return made

            names = [Path(folder) / "libraries" / f"file-{k % 3}" for k in range(9)]
            threads = [threading.Thread(target=_cache.build_once, args=(name, build, True)) for name in names]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual((max(most), len(built)), (1, 3))

    @unittest.skipUnless(hasattr(os, "fork"), "this system has no fork")
    def test_a_forked_process_does_not_hold_the_lock(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, {"LINKWORK_CACHE": folder}):
            code = (
                "import os, time\n"
                "from linkwork import _cache\n"
                "with _cache.hold_lock(True):\n"
                "    if os.fork() == 0:\n"
                "        time.sleep(30)\n"
                "        os._exit(0)\n"
                "    print(1, flush=True)\n"
                "    os.kill(os.getpid(), 9)\n"
            )
            parent = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, env=environment(folder), start_new_session=True)
            try:
                self.assertEqual(parent.stdout.readline().strip(), b"1")
                parent.wait()
                done = subprocess.run(
                    [sys.executable, "-c", "from linkwork import _cache\nwith _cache.hold_lock(True): print(2)"],
                    capture_output=True, text=True, env=environment(folder), timeout=20,
                )
                self.assertEqual(done.stdout.strip(), "2", done.stderr)
            finally:
                os.killpg(parent.pid, signal.SIGKILL)
                parent.stdout.close()

    def test_processes_compile_a_mechanism_once(self):
        # A random mass makes a declaration that no other run has compiled.
        mass = 1 + np.random.default_rng().uniform()
        text = PENDULUM.replace("rod(mass, length, y)", f"sphere({mass}, 1)")
        code = (
            "import sys, linkwork\n"
            "m = linkwork.compile(sys.argv[1], batch=False, derivatives=False)(mass=2.0, length=2.0)\n"
            "print(m.mass_matrix([0.0])[0, 0])\n"
        )
        run = lambda: subprocess.Popen(
            [sys.executable, "-c", code, text], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env={**os.environ, "PYTHONPATH": str(PACKAGE)},
        )
        compiled(PENDULUM)  # builds the command
        # The first process is killed while it compiles; its cargo continues.
        first = run()
        # The process may have to wait for other tests.
        self.assertTrue(any("compiling Pendulum" in line for line in iter(first.stderr.readline, "")))
        first.kill()
        first.communicate()
        ended = [(process, *process.communicate()) for process in [run() for _ in range(4)]]
        for process, out, err in ended:
            self.assertEqual(process.returncode, 0, err)
            self.assertAlmostEqual(float(out), 0.4 * mass + 2.0, places=12)
        self.assertEqual(sum("compiling Pendulum" in err for _, _, err in ended), 1)


class WithDamage(unittest.TestCase):
    """Damaged files of the cache, and folders that cannot be used."""

    def test_a_damaged_library_is_built_again(self):
        mass = 1 + np.random.default_rng().uniform()
        text = PENDULUM.replace("rod(mass, length, y)", f"sphere({mass}, 1)")
        settings = {"batch": False, "derivatives": False}
        kind = compiled(text, **settings)
        path = Path(kind._path)
        content = path.read_bytes()
        for damaged in (b"", b"not a library", content[: len(content) // 2], bytes(len(content))):
            # As by another process: a new file, since this process has loaded the old one.
            path.unlink()
            path.write_bytes(damaged)
            code = f"import pickle; pickle.loads({pickle.dumps(kind)!r})"
            done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(PACKAGE)})
            self.assertIn("linkwork._names.Error: cannot load the library", done.stderr)
            self.assertFalse(is_intact(path))
        m = compiled(text, **settings)(mass=2.0, length=2.0)
        self.assertTrue(is_intact(path))
        np.testing.assert_allclose(m.mass_matrix([0.0]), [[0.4 * mass + 2.0]], rtol=1e-14)

    def test_folders_that_cannot_be_written_to(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "file"
            file.write_text("")
            for cache in (file, file / "within"):
                with mock.patch.dict(os.environ, {"LINKWORK_CACHE": str(cache)}):
                    with self.assertRaisesRegex(linkwork.ToolchainError, "cannot write to the cache folder .*LINKWORK_CACHE"):
                        linkwork.compile(PENDULUM, quiet=True)

    def test_a_cache_that_is_only_read_has_its_libraries(self):
        kind = compiled(PENDULUM)
        denied = mock.Mock(side_effect=PermissionError("read-only"))
        with mock.patch.object(_cache, "write", denied), mock.patch.object(_build, "write", denied):
            with mock.patch.object(_cache, "hold_lock", denied):
                again = compiled(PENDULUM)
                self.assertEqual(again._path, kind._path)
                with self.assertRaisesRegex(linkwork.ToolchainError, "cannot write to the cache folder .*read-only"):
                    compiled(PENDULUM.replace("9.81", repr(np.random.default_rng().uniform())))

    def test_file_systems_without_locks(self):
        if sys.platform == "win32":
            self.skipTest("locks of Windows are not optional")
        import errno

        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, {"LINKWORK_CACHE": folder}):
            with mock.patch("fcntl.flock", side_effect=OSError(errno.ENOLCK, "no locks")):
                targets = []

                def build(target):
                    targets.append(target)
                    (target / "made").write_text("made")
                    return target / "made"

                path = _cache.build_once(Path(folder) / "libraries" / "file", build, True)
            self.assertEqual(path.read_text(), "made")
            self.assertNotEqual(targets[0].parent, Path(folder))
            self.assertTrue(digest_file(path).is_file())


if __name__ == "__main__":
    unittest.main()
