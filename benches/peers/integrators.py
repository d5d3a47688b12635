"""Compares Linkwork's integration methods with those of SciPy and SUNDIALS: final errors, evaluations and times.

    integrators.py PROGRAM LIBRARY     the program `integrators` and the example `right_hand_sides` of linkwork-benches

All integrate the same generated accelerations. Linkwork calls them in Rust, the others through Python, which costs some
microseconds per call: compare the evaluations, not the times. SUNDIALS is omitted if `sksundae` is not installed.
"""
import ctypes
import subprocess
import sys
import time

import numpy as np
import scipy
from scipy.integrate import solve_ivp

try:
    import sksundae
except ImportError:
    sksundae = None

NAMES = ["pleiades", "car axis", "Andrews' squeezer", "stiff governor"]
STIFF = [3]
library = ctypes.CDLL(sys.argv[2])
library.dimension.restype = ctypes.c_size_t
library.begin.restype = ctypes.c_double
numbers = ctypes.POINTER(ctypes.c_double)
library.begin.argtypes = [ctypes.c_size_t, numbers]
library.rate.argtypes = [ctypes.c_size_t, ctypes.c_double, numbers, numbers, ctypes.c_size_t]
library.rate.restype = None


class Problem:
    def __init__(self, number):
        self.number, self.n = number, library.dimension(number)
        self.y = np.zeros(self.n)
        self.end = library.begin(number, self.y.ctypes.data_as(numbers))
        self.state, self.out = np.zeros(self.n), np.zeros(self.n)
        self.places = [x.ctypes.data_as(numbers) for x in (self.state, self.out)]
        self.count = 0

    def rate(self, t, y):
        self.count += 1
        self.state[:] = y
        library.rate(self.number, t, *self.places, self.n)
        return self.out.copy()

    def rate_into(self, t, y, out):
        out[:] = self.rate(t, y)

    def scipy(self, method, tolerance):
        found = solve_ivp(self.rate, (0, self.end), self.y, method=method, rtol=tolerance, atol=tolerance)
        if not found.success:
            raise RuntimeError(found.message)
        return found.y[:, -1]

    def sundials(self, method, tolerance):
        solver = sksundae.cvode.CVODE(
            self.rate_into, method=method, rtol=tolerance, atol=tolerance, max_num_steps=1000000
        )
        found = solver.solve(np.array([0, self.end]), self.y)
        if not found.success:
            raise RuntimeError(found.message)
        return found.y[-1]


def peers(problem):
    explicit = ["RK45", "DOP853"] if problem.number not in STIFF else ["RK45"]
    for name in explicit + ["Radau", "BDF"]:
        yield f"SciPy {name}", lambda tolerance, name=name: problem.scipy(name, tolerance)
    if sksundae:
        for name in ["BDF"] if problem.number in STIFF else ["Adams", "BDF"]:
            yield f"CVODE {name}", lambda tolerance, name=name: problem.sundials(name, tolerance)


def main():
    lines = subprocess.run([sys.argv[1]], capture_output=True, text=True, check=True).stdout.splitlines()
    rows = [line.split() for line in lines]
    versions = f"SciPy {scipy.__version__}" + (f", scikit-SUNDAE {sksundae.__version__}" if sksundae else "")
    print(f"{versions}; error of the configuration at the end beside its largest entry")
    for number, name in enumerate(NAMES):
        problem = Problem(number)
        # The reference is an independent implementation.
        method, tolerance = ("Radau", 1e-12) if number in STIFF else ("DOP853", 3e-14)
        reference = problem.scipy(method, tolerance)[: problem.n // 2]
        error = lambda q: float(np.max(np.abs(np.asarray(q) - reference)) / np.max(np.abs(reference)))
        print(f"\n{name}\n| method | tolerance | error | evaluations | Jacobians | ms |\n| --- | ---: | ---: | ---: | ---: | ---: |")
        for row in rows:
            if int(row[0]) != number:
                continue
            if row[3] == "failed":
                print(f"| {row[1]} | {float(row[2]):.0e} | {' '.join(row[3:])} | | | |")
                continue
            q = [float(x) for x in row[6:]]
            jacobians = row[4] if int(row[4]) else ""
            print(f"| {row[1]} | {float(row[2]):.0e} | {error(q):.1e} | {row[3]} | {jacobians} | {1e3 * float(row[5]):.2f} |")
        for method, run in peers(problem):
            for tolerance in [1e-3, 1e-5, 1e-7, 1e-9, 1e-11]:
                if tolerance < 1e-9 and "DOP853" not in method and "Adams" not in method:
                    continue
                problem.count, begin = 0, time.perf_counter()
                try:
                    q = run(tolerance)[: problem.n // 2]
                except Exception as reason:
                    print(f"| {method} | {tolerance:.0e} | failed: {reason} | | | |")
                    continue
                spent = 1e3 * (time.perf_counter() - begin)
                print(f"| {method} | {tolerance:.0e} | {error(q):.1e} | {problem.count} | | {spent:.1f} |")


main()
