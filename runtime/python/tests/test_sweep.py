"""Test of the sweep on Ray, on a local cluster of one worker, and of two workers of which one is lost."""

import importlib.util
import tempfile
import unittest
import warnings
from pathlib import Path

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "sweep.py"


@unittest.skipUnless(importlib.util.find_spec("ray"), "Ray is not installed")
class OnACluster(unittest.TestCase):
    """Results that do not depend on the workers."""

    def test_workers_may_be_lost(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            import ray

            spec = importlib.util.spec_from_file_location("sweep", EXAMPLE)
            sweep = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(sweep)
            found, told = [], []
            for workers in (1, 2):
                ray.init(num_cpus=workers, log_to_driver=False, include_dashboard=False)
                with tempfile.TemporaryDirectory() as folder:
                    lose = str(Path(folder) / "lost") if workers == 2 else None
                    found.append(sweep.sweep(700, 100, lambda done, of: told.append((done, of)), lose))
                    self.assertTrue(lose is None or Path(lose).exists())
                ray.shutdown()
        self.assertEqual(found[0], found[1])
        over, error = found[0]
        self.assertTrue(0 < over < 700)
        self.assertLess(error, 0.1)
        self.assertEqual(told, [(k + 1, 7) for k in range(7)] * 2)


if __name__ == "__main__":
    unittest.main()
