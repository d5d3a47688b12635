"""Compares C99 by `linkwork export c` with the same mechanism in Rust and with CasADi's C: times and sizes of functions, in turns.

    python c99.py LINKWORK SOURCES FOLDER ROBOT.urdf …

LINKWORK: path of the command; SOURCES: the repository; FOLDER: the output folder. Needs the packages pin and casadi, gcc, clang and
cargo. C is compiled with `-O3 -march=native`. CasADi's C is compiled by gcc, with and without `-ffast-math`, plain and with common
subexpressions shared; the fastest of the four is reported. Rust is compiled for the same processor. Results must agree to 1e-9 before the measurement.
"""

import ctypes
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import casadi
import numpy as np
import pinocchio

FUNCTIONS = ["inverse_dynamics", "mass_matrix", "forward_dynamics"]
COMPILERS = ["gcc", "clang"]
FLAGS = ["-std=c99", "-O3", "-march=native", "-shared", "-fPIC"]
MANIFEST = """[package]
name = "%s"
version = "0.0.0"
edition = "2024"

[lib]
crate-type = ["cdylib"]

[dependencies]
linkwork = { path = "%s" }

[workspace]
"""
# The generated functions, on vectors with the memory layout of the arrays.
RUST = """
use linkwork::nalgebra::SMatrix;
use linkwork::prelude::*;
#[mechanism(urdf = "URDF", WORDS)]
pub struct Robot;
type V = SVector<f64, { Robot::NV }>;
type M = SMatrix<f64, { Robot::NV }, { Robot::NV }>;
#[unsafe(no_mangle)]
pub unsafe extern "C" fn NAME_inverse_dynamics(q: &V, v: &V, x: &V, result: &mut V) {
    *result = Robot.inverse_dynamics(q, v, x);
}
#[unsafe(no_mangle)]
pub unsafe extern "C" fn NAME_forward_dynamics(q: &V, v: &V, x: &V, result: &mut V) {
    *result = Robot.forward_dynamics(q, v, x);
}
#[unsafe(no_mangle)]
pub unsafe extern "C" fn NAME_mass_matrix(q: &V, result: &mut M) {
    *result = Robot.mass_matrix(q);
}
"""
HARNESS = r"""
#define _POSIX_C_SOURCE 199309L
#include <time.h>
#include <stddef.h>
enum { STATES = 256, N = %(n)d, MOST = N * N };
extern void gcc_%(function)s(), clang_%(function)s(), %(rust)s();
%(casadi_declared)s
static double now(void) { struct timespec t; clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t); return 1e9 * t.tv_sec + t.tv_nsec; }
static double kept[MOST];
static void call_gcc(const double *q, const double *v, const double *x) { gcc_%(function)s(%(arguments)s, kept); }
static void call_clang(const double *q, const double *v, const double *x) { clang_%(function)s(%(arguments)s, kept); }
static void call_rust(const double *q, const double *v, const double *x) { %(rust)s(%(arguments)s, kept); }
%(casadi_called)s
typedef void (*Call)(const double *, const double *, const double *);
static const Call calls[] = { call_gcc, call_clang, call_rust, %(casadi_names)s };
void once(int which, const double *x, double *result) {
    for (int k = 0; k < MOST; ++k) kept[k] = 0;
    calls[which](x, x + N, x + 2 * N);
    for (int k = 0; k < MOST; ++k) result[k] = kept[k];
}
void measure(const double *x, int rounds, double *least) {
    for (int round = 0; round < rounds; ++round)
        for (int which = 0; which < %(count)d; ++which) {
            double begin = now();
            for (int again = 0; again < 8; ++again)
                for (int s = 0; s < STATES; ++s) calls[which](x + 3 * N * s, x + 3 * N * s + N, x + 3 * N * s + 2 * N);
            double each = (now() - begin) / (8 * STATES);
            if (round == 0 || each < least[which]) least[which] = each;
        }
}
"""


def run(words, **more):
    subprocess.run([str(word) for word in words], check=True, stdout=subprocess.DEVNULL, **more)


def code_size(library, name):
    """Returns the bytes of a function in a library, with the parts into which the compiler has split it."""
    text = subprocess.run(["nm", "-S", library], capture_output=True, text=True, check=True).stdout
    rows = [line.split() for line in text.splitlines()]
    return sum(int(row[1], 16) for row in rows if len(row) == 4 and row[2] in "tT" and re.fullmatch(name, row[3]))


class Chain:
    """Recursions of Featherstone's Rigid Body Dynamics Algorithms (2008) on CasADi's symbols, for robots of pins, with the parameters
    of Pinocchio's model. Spatial vectors have the linear part first."""

    def __init__(self, model, q):
        self.model, self.q, self.n = model, q, model.nv
        data = model.createData()
        pinocchio.computeJointJacobians(model, data, np.zeros(self.n))
        self.parents = [model.parents[k + 1] - 1 for k in range(self.n)]
        self.axes, self.turns, self.places, self.inertias = [], [], [], []
        for k in range(self.n):
            motion = np.asarray(pinocchio.getJointJacobian(model, data, k + 1, pinocchio.ReferenceFrame.LOCAL))[:, k]
            assert np.allclose(motion[:3], 0), "a joint that is no pin"
            axis = self.number(motion[3:])
            cross = casadi.skew(axis)
            turn = casadi.SX.eye(3) + casadi.sin(q[k]) * cross + (1 - casadi.cos(q[k])) * casadi.sparsify(cross @ cross)
            placement = model.jointPlacements[k + 1]
            self.axes.append(axis)
            self.turns.append(self.number(placement.rotation) @ casadi.sparsify(turn))
            self.places.append(self.number(placement.translation))
            self.inertias.append(model.inertias[k + 1])

    @staticmethod
    def number(array):
        array = np.where(np.abs(array) < 1e-14, 0, np.asarray(array, float))
        return casadi.sparsify(casadi.SX(array))

    def gravity(self):
        return -self.number(self.model.gravity.linear)

    def inverse(self, v, a):
        """Returns inverse dynamics by the recursive Newton-Euler algorithm."""
        cross, of_link, forces = casadi.cross, [], []
        for k, (turn, place, axis, parent) in enumerate(zip(self.turns, self.places, self.axes, self.parents)):
            zero = casadi.SX(3, 1)
            w, dw, acceleration = of_link[parent] if parent >= 0 else (zero, zero, self.gravity())
            at = acceleration + cross(dw, place) + cross(w, cross(w, place))
            w = turn.T @ w
            dw = turn.T @ dw + cross(w, axis * v[k]) + axis * a[k]
            w, at = w + axis * v[k], turn.T @ at
            of_link.append((w, dw, at))
            inertia = self.inertias[k]
            c, about = self.number(inertia.lever), self.number(inertia.inertia)
            force = inertia.mass * (at + cross(dw, c) + cross(w, cross(w, c)))
            forces.append([force, about @ dw + cross(w, about @ w) + cross(c, force)])
        torques = [None] * self.n
        for k in reversed(range(self.n)):
            force, moment = forces[k]
            torques[k] = casadi.dot(self.axes[k], moment)
            if self.parents[k] >= 0:
                force, moment = self.turns[k] @ force, self.turns[k] @ moment
                above = forces[self.parents[k]]
                above[0], above[1] = above[0] + force, above[1] + moment + cross(self.places[k], force)
        return casadi.vertcat(*torques)

    def transform(self, k):
        """Returns the transformation of motion vectors from the parent to a link."""
        turn = self.turns[k].T
        return casadi.blockcat([[turn, -turn @ casadi.skew(self.places[k])], [casadi.SX(3, 3), turn]])

    def motion(self, k):
        return casadi.vertcat(casadi.SX(3, 1), self.axes[k])

    def mass(self):
        """Returns the mass matrix by the composite-rigid-body algorithm."""
        composite = [self.number(inertia.matrix()) for inertia in self.inertias]
        matrix = casadi.SX(self.n, self.n)
        for k in reversed(range(self.n)):
            force = composite[k] @ self.motion(k)
            matrix[k, k] = self.motion(k).T @ force
            j = k
            while self.parents[j] >= 0:
                force, j = self.transform(j).T @ force, self.parents[j]
                matrix[j, k] = matrix[k, j] = self.motion(j).T @ force
            if self.parents[k] >= 0:
                x = self.transform(k)
                composite[self.parents[k]] += x.T @ composite[k] @ x
        return casadi.densify(matrix)

    def forward(self, v, torques):
        """Returns forward dynamics by the articulated-body algorithm."""
        def crossed(w, m):
            return casadi.vertcat(casadi.cross(w[3:], m[:3]) + casadi.cross(w[:3], m[3:]), casadi.cross(w[3:], m[3:]))

        def crossed_force(w, f):
            return casadi.vertcat(casadi.cross(w[3:], f[:3]), casadi.cross(w[:3], f[:3]) + casadi.cross(w[3:], f[3:]))

        speeds, biases, forces = [], [], []
        articulated = [self.number(inertia.matrix()) for inertia in self.inertias]
        for k in range(self.n):
            own = self.motion(k) * v[k]
            above = self.transform(k) @ speeds[self.parents[k]] if self.parents[k] >= 0 else casadi.SX(6, 1)
            speeds.append(above + own)
            biases.append(crossed(speeds[k], own))
            forces.append(crossed_force(speeds[k], articulated[k] @ speeds[k]))
        pivots = [None] * self.n
        for k in reversed(range(self.n)):
            column = articulated[k] @ self.motion(k)
            pivot, rest = self.motion(k).T @ column, torques[k] - self.motion(k).T @ forces[k]
            pivots[k] = (column, pivot, rest)
            if self.parents[k] >= 0:
                x = self.transform(k)
                left = articulated[k] - column @ column.T / pivot
                force = forces[k] + left @ biases[k] + column * (rest / pivot)
                articulated[self.parents[k]] += x.T @ left @ x
                forces[self.parents[k]] += x.T @ force
        accelerations, found = [], []
        for k, (column, pivot, rest) in enumerate(pivots):
            base = casadi.vertcat(self.gravity(), casadi.SX(3, 1))
            above = accelerations[self.parents[k]] if self.parents[k] >= 0 else base
            above = self.transform(k) @ above + biases[k]
            found.append((rest - column.T @ above) / pivot)
            accelerations.append(above + self.motion(k) * found[k])
        return casadi.vertcat(*found)


def generated(model, folder):
    """Compiles CasADi's C. Returns the libraries and the names of their functions, by function."""
    q, v, x = (casadi.SX.sym(name, model.nv) for name in "qvx")
    chain = Chain(model, q)
    of = {"inverse_dynamics": chain.inverse(v, x), "mass_matrix": chain.mass(), "forward_dynamics": chain.forward(v, x)}
    found = {}
    before = os.getcwd()
    os.chdir(folder)
    for name, value in of.items():
        found[name] = []
        for way, shared in [("plain", value), ("shared", casadi.cse(value))]:
            function = casadi.Function(f"casadi_{name}_{way}", [q, v, x], [casadi.densify(shared)])
            function.generate(f"{function.name()}.c", {"with_header": False})
            for flags in (["-lm"], ["-ffast-math", "-lm"]):
                library = folder / f"lib{function.name()}{'_fast' if len(flags) > 1 else ''}.so"
                run(["gcc", *FLAGS, f"{function.name()}.c", "-o", library, *flags])
                found[name].append((library, function.name()))
    os.chdir(before)
    return found


def main():
    command, sources, folder = (Path(word).resolve() for word in sys.argv[1:4])
    folder.mkdir(parents=True, exist_ok=True)
    print("| robot | function | C99 by gcc, ns | by clang | Rust | CasADi's C | gcc : Rust | clang : Rust | CasADi : gcc | bytes | CasADi | agree to |")
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for urdf in map(Path, sys.argv[4:]):
        here = folder / urdf.stem
        here.mkdir(exist_ok=True)
        # The recursions support only pins: other joints are locked at zero.
        model = pinocchio.buildModelFromUrdf(str(urdf))
        others = [name for name, joint in zip(model.names, model.joints) if joint.shortname().startswith("JointModelP")]
        model = pinocchio.buildReducedModel(model, [model.getJointId(name) for name in others], pinocchio.neutral(model))
        n = model.nv
        # Pinocchio has no joint friction.
        words = ", ".join(["passive = ignore", *(["lock = [" + ", ".join(f'"{name}"' for name in others) + "]"] if others else [])])
        for compiler in COMPILERS:
            about = ["--out", here, "--prefix", compiler, "--no-derivatives", "--with", words]
            run([command, "export", "c", urdf.resolve(), *about])
            run([compiler, *FLAGS, here / f"{compiler}.c", "-o", here / f"lib{compiler}.so", "-lm"])
        crate, name = here / "crate", f"rust_{urdf.stem}"
        (crate / "src").mkdir(parents=True, exist_ok=True)
        (crate / "Cargo.toml").write_text(MANIFEST % (name, sources / "runtime"), encoding="utf-8")
        (crate / "src" / "lib.rs").write_text(RUST.replace("NAME", name).replace("URDF", str(urdf.resolve())).replace("WORDS", words))
        shutil.copy(sources / "Cargo.lock", crate)
        environment = {**os.environ, "CARGO_TARGET_DIR": str(folder / "target"), "RUSTFLAGS": "-C target-cpu=native"}
        run(["cargo", "build", "--release", "--quiet", "--manifest-path", crate / "Cargo.toml"], env=environment)
        rust = folder / "target" / "release" / f"lib{name}.so"
        casadis = generated(model, here)
        rng = np.random.default_rng(1)
        states = np.ascontiguousarray(rng.uniform(-1, 1, (256, 3, n)))
        for function in FUNCTIONS:
            arguments = "q" if function == "mass_matrix" else "q, v, x"
            peers = casadis[function]
            # Each library is loaded separately, since the variants have the same names.
            declared = "".join(f"int (*peer{k})(const double **, double **, long long *, double *, int);\n" for k in range(4))
            called = "".join(
                f"static void call_{k}(const double *q, const double *v, const double *x) {{ const double *in[3] = {{q, v, x}}; "
                f"double *out[1] = {{kept}}; peer{k}(in, out, NULL, NULL, 0); }}\n"
                for k in range(4)
            )
            text = HARNESS % {
                "n": n,
                "function": function,
                "rust": f"{name}_{function}",
                "arguments": arguments,
                "casadi_declared": declared,
                "casadi_called": called,
                "casadi_names": ", ".join(f"call_{k}" for k in range(4)),
                "count": 7,
            }
            (here / "harness.c").write_text(text, encoding="utf-8")
            harness = here / f"harness_{function}.so"
            ways = [f"-Wl,-rpath,{here}", f"-Wl,-rpath,{rust.parent}", *(here / f"lib{compiler}.so" for compiler in COMPILERS), rust]
            run(["gcc", "-std=gnu99", "-O2", "-w", "-shared", "-fPIC", here / "harness.c", "-o", harness, *ways])
            timed = ctypes.CDLL(str(harness))
            loaded = [ctypes.CDLL(str(library)) for library, _ in peers]
            for k, (library, (_, peer)) in enumerate(zip(loaded, peers)):
                ctypes.c_void_p.in_dll(timed, f"peer{k}").value = ctypes.cast(getattr(library, peer), ctypes.c_void_p).value
            pointer = lambda array: array.ctypes.data_as(ctypes.c_void_p)
            results = np.zeros((7, n * n))
            off = 0.0
            for state in states[:20]:
                for which in range(7):
                    timed.once(which, pointer(state), pointer(results[which]))
                scale = 1 + np.abs(results[0]).max()
                off = max(off, np.abs(results - results[0]).max() / scale)
            assert off < 1e-9, (urdf.stem, function, off)
            least = np.zeros(7)
            timed.measure(pointer(states), 200, pointer(least))
            best = 3 + int(np.argmin(least[3:]))
            library, peer = peers[best - 3]
            sizes = [code_size(here / "libgcc.so", rf"gcc_{function}(\..*)?"), code_size(library, rf"(casadi_f\d+|{peer})(\..*)?")]
            row = [*(f"{time:.1f}" for time in least[:3]), f"{least[best]:.1f}"]
            row += [*(f"{time / least[2]:.2f}" for time in least[:2]), f"{least[best] / least[0]:.2f}"]
            row += [*map(str, sizes), f"{off:.0e}"]
            print(f"| {urdf.stem} | {function} | {' | '.join(row)} |", flush=True)


main()
