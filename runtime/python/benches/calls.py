"""Measures the time of calls from Python, for one state and for many.

Run with `python runtime/python/benches/calls.py`. It prints microseconds per call for one state, and
nanoseconds per state for a batch on one thread. The example `measure` of `linkwork-jit` prints the times of the
same functions without Python.
"""

import time
from pathlib import Path

import numpy as np

import linkwork


def least(function, count, turns=7):
    """Returns the minimum time of a call, in seconds."""
    function()
    best = float("inf")
    for _ in range(turns):
        start = time.perf_counter()
        for _ in range(count):
            function()
        best = min(best, (time.perf_counter() - start) / count)
    return best


def main():
    """Prints a table of the times of several functions."""
    robot = Path(__file__).resolve().parents[3] / "models" / "urdf" / "ur5.urdf"
    arm = linkwork.compile(robot)()
    rng = np.random.default_rng(1)
    one = rng.normal(size=(3, 6))
    many = rng.normal(size=(3, 4096, 6))
    print("function                       one state, us   of a batch, ns   with out, ns")
    for name, count in [
        ("mass_matrix", 1),
        ("inverse_dynamics", 3),
        ("forward_dynamics", 3),
        ("inverse_dynamics_derivatives", 3),
        ("forward_dynamics_derivatives", 3),
    ]:
        function = getattr(arm, name)
        single = least(lambda: function(*one[:count]), 2000)
        batch = least(lambda: function(*many[:count], threads=1), 5) / many.shape[1]
        out = function(*many[:count])
        again = least(lambda: function(*many[:count], threads=1, out=out), 5) / many.shape[1]
        print(f"{name:30} {single * 1e6:13.2f} {batch * 1e9:17.1f} {again * 1e9:12.1f}")


if __name__ == "__main__":
    main()
