"""Derives equations of motion with SymPy, prints them as C, and times them in Python.

derive.py NAME FOLDER: writes FOLDER/sympy.c. derive.py --python NAME FOLDER: writes FOLDER/python, from FOLDER/states:
nanoseconds per call of the functions of lambdify and of PyDy (Cython), and milliseconds of a motion with the duration of a
thousand steps.

KanesMethod gives mass matrix and forces of the tree, the velocities of points give the constraints. Accelerations and
multipliers follow from the system `[[M, -Jᵀ], [J, 0]]`.
"""

import pathlib
import sys
import time

import numpy
import sympy
from sympy.physics import mechanics
from sympy.physics.mechanics import Point, ReferenceFrame, RigidBody, cross, dot, dynamicsymbols

import mechanisms


class Derivation:
    """A mechanism as objects of SymPy."""

    def __init__(self, mechanism):
        self.mechanism = mechanism
        self.n = ReferenceFrame("N")
        origin = Point("O")
        origin.set_vel(self.n, 0)
        self.frames, self.origins = {"ground": self.n}, {"ground": origin}
        self.kinds = {name: kind for body in mechanism.bodies for name, kind, _ in body.joints}
        self.number()
        self.kinematics, self.bodies, self.loads = [], [], []
        for body in mechanism.bodies:
            self.place(body)
        self.apply()

    def number(self):
        """Creates coordinates and generalized speeds in Linkwork's order."""
        self.q_of, self.u_of = {}, {}
        nq = nu = 0
        for name in self.mechanism.joints():
            free = self.kinds[name] == "free"
            self.q_of[name], self.u_of[name] = nq, nu
            nq, nu = nq + (7 if free else 1), nu + (6 if free else 1)
        self.q = [dynamicsymbols(f"q{k}") for k in range(nq)]
        self.u = [dynamicsymbols(f"u{k}") for k in range(nu)]
        self.rates = [None] * nq

    def place(self, body):
        frame, point = self.frames[body.parent], self.origins[body.parent]
        at = point.locatenew(body.name + "_at", vector(frame, body.at))
        at.v2pt_theory(point, self.n, frame)
        for k, (name, kind, axis) in enumerate(body.joints):
            q, u = self.q[self.q_of[name]], self.u[self.u_of[name]]
            if kind == "free":
                frame, at = self.free(body, name)
                continue
            self.rates[self.q_of[name]] = u
            along = vector(frame, axis)
            if kind == "turn":
                turned = frame.orientnew(f"{body.name}{k}", "Axis", (q, along))
                turned.set_ang_vel(frame, u * along)
                frame = turned
            else:
                end = at.locatenew(f"{body.name}_slid{k}", q * along)
                end.set_vel(frame, u * along)
                end.v1pt_theory(at, self.n, frame)
                at = end
        self.frames[body.name], self.origins[body.name] = frame, at
        centre = at.locatenew(body.name + "_centre", vector(frame, body.com))
        centre.v2pt_theory(at, self.n, frame)
        inertia = mechanics.inertia(frame, *body.inertia[:3], body.inertia[3], body.inertia[5], body.inertia[4])
        self.bodies.append(RigidBody(body.name, centre, frame, body.mass, (inertia, centre)))
        self.loads.append((centre, vector(self.n, (body.mass * g for g in self.mechanism.gravity))))

    def free(self, body, name):
        """Adds a free joint: position and unit quaternion; linear and angular velocity in the body's axes."""
        q, u = self.q[self.q_of[name] :][:7], self.u[self.u_of[name] :][:6]
        x, y, z, w = q[3:]
        frame = self.n.orientnew(body.name, "Quaternion", (w, x, y, z))
        frame.set_ang_vel(self.n, vector(frame, u[3:]))
        at = self.origins["ground"].locatenew(body.name + "_origin", vector(self.n, q[:3]))
        at.set_vel(self.n, vector(frame, u[:3]))
        a, b, c = u[3:]
        turning = [w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a, -x * a - y * b - z * c]
        moving = [dot(at.vel(self.n), axis) for axis in (self.n.x, self.n.y, self.n.z)]
        first = self.q_of[name]
        self.rates[first : first + 7] = moving + [t / 2 for t in turning]
        return frame, at

    def point(self, body, at):
        """Returns a point of a body, with its velocity."""
        frame, origin = self.frames[body], self.origins[body]
        point = origin.locatenew(f"{body}_point", vector(frame, at))
        point.v2pt_theory(origin, self.n, frame)
        return point

    def apply(self):
        """Adds the torques and the spring."""
        for name, torque in self.mechanism.torques.items():
            body, axis = next((b, j[2]) for b in self.mechanism.bodies for j in b.joints if j[0] == name)
            self.loads.append((self.frames[body.name], torque * vector(self.n, axis)))
        if self.mechanism.spring:
            ground, body, at, stiffness, free_length = self.mechanism.spring
            end = self.point(body, at)
            stretch = end.pos_from(self.origins["ground"]) - vector(self.n, ground)
            components = stretch.to_matrix(self.n)
            length = sympy.sqrt(sum(c**2 for c in components))
            force = -stiffness * (length - free_length) / length
            self.loads.append((end, vector(self.n, [force * c for c in components])))

    def constraint_rates(self):
        """Returns the constraint velocities, which are linear in the generalized speeds."""
        rates = []
        for loop in self.mechanism.loops:
            gap = self.point(loop.first, loop.first_at).vel(self.n) - self.point(loop.second, loop.second_at).vel(self.n)
            rates += [dot(gap, axis) for axis in (self.n.x, self.n.y, self.n.z)[: 2 if loop.planar else 3]]
            if loop.axis:
                first, second = self.frames[loop.first], self.frames[loop.second]
                axis, turning = vector(second, loop.axis), first.ang_vel_in(second)
                across = [e for e in (mechanisms.X, mechanisms.Y, mechanisms.Z) if e != loop.axis]
                # Bricard's last condition is redundant and would make the system singular.
                rates += [dot(cross(turning, vector(first, e)), axis) for e in across[:1]]
        if self.mechanism.rows:
            word, *arguments = self.mechanism.rows
            rates += getattr(self, word)(*arguments)
        return rates

    def at_rest(self, body, arm):
        """Returns the velocity of the point of a body with a given offset from its origin."""
        velocity = self.origins[body].vel(self.n) + cross(self.frames[body].ang_vel_in(self.n), arm)
        return [dot(velocity, axis) for axis in (self.n.x, self.n.y, self.n.z)]

    def rims(self, wheels, up):
        """Returns the constraint velocities of wheels with sharp rims about y, whose lowest points touch the ground."""
        rows = []
        for name, radius in wheels:
            axle, down = self.frames[name].y, -up * self.n.z
            across = dot(down, axle)
            # SymPy does not simplify the square of a vector with components in two frames.
            lowest = (down - across * axle) * (radius / sympy.sqrt(1 - across**2))
            rows += self.at_rest(name, lowest)
        return rows

    def bowl(self, ball, radius):
        """Returns the constraint velocities of a ball inside a bowl about the origin."""
        place = self.q[:3]
        return self.at_rest(ball, vector(self.n, [radius * x / sympy.sqrt(sum(x**2 for x in place)) for x in place]))

    def knife(self, sleigh):
        return [dot(self.origins[sleigh].vel(self.n), self.frames[sleigh].y)]

    def ellipsoid(self, stone, axes):
        """Returns the constraint velocities of an ellipsoid on the ground."""
        frame = self.frames[stone]
        normal = self.n.z.to_matrix(frame)
        size = sympy.sqrt(sum((a * n) ** 2 for a, n in zip(axes, normal)))
        return self.at_rest(stone, vector(frame, [-a * a * n / size for a, n in zip(axes, normal)]))

    def equations(self):
        """Returns M, forces, J, biases and rates of the coordinates, in plain symbols."""
        t = dynamicsymbols._t
        kinematics = [q.diff(t) - rate for q, rate in zip(self.q, self.rates)]
        kane = mechanics.KanesMethod(self.n, q_ind=self.q, u_ind=self.u, kd_eqs=kinematics)
        kane.kanes_equations(self.bodies, self.loads)
        plain = {x: sympy.Symbol(x.func.__name__) for x in self.q + self.u}
        as_plain = lambda m: m.subs({q.diff(t): rate for q, rate in zip(self.q, self.rates)}).xreplace(plain)
        q, u = [plain[x] for x in self.q], [plain[x] for x in self.u]
        rates = as_plain(sympy.Matrix(self.constraint_rates()))
        moving = as_plain(sympy.Matrix(self.rates))
        return {
            "step": self.mechanism.step,
            "q": q,
            "u": u,
            "mass": as_plain(kane.mass_matrix),
            "force": as_plain(kane.forcing),
            "jacobian": rates.jacobian(u),
            "bias": rates.jacobian(q) * moving,
            "moving": moving,
        }


def vector(frame, components):
    """Returns the vector with these components."""
    return sum((c * e for c, e in zip(components, (frame.x, frame.y, frame.z))), mechanics.Vector(0))


def as_c(equations):
    """Returns the C functions `equations` and `kinematics`, with their array sizes."""
    q, u = equations["q"], equations["u"]
    text = f"#include <math.h>\nenum {{ NQ = {len(q)}, NV = {len(u)}, NC = {equations['jacobian'].rows} }};\n"
    text += f"static const double STEP = {equations['step']};\n"
    for name, outs in (("equations", ["mass", "force", "jacobian", "bias"]), ("kinematics", ["moving"])):
        values = [equations[out] for out in outs]
        shared, reduced = sympy.cse([e for value in values for e in value])
        arguments = ", ".join(f"double *restrict {out}" for out in outs)
        text += f"static inline void {name}(const double *restrict q, const double *restrict u, {arguments}) {{\n"
        text += "".join(f"    const double {x} = q[{k}];\n" for k, x in enumerate(q))
        text += "".join(f"    const double {x} = u[{k}];\n" for k, x in enumerate(u))
        text += "".join(f"    const double {x} = {sympy.ccode(e)};\n" for x, e in shared)
        places = [f"{out}[{k}]" for out, value in zip(outs, values) for k in range(len(value))]
        text += "".join(f"    {place} = {sympy.ccode(e)};\n" for place, e in zip(places, reduced))
        text += "}\n"
    return text


def write(mechanism, folder):
    equations = Derivation(mechanism).equations()
    solver = pathlib.Path(__file__).with_name("sympy.c").read_text()
    (folder / "sympy.c").write_text(as_c(equations) + solver)


def least_time(call, seconds):
    """Returns the minimum processor time of a call."""
    least, end = float("inf"), time.process_time() + seconds
    while time.process_time() < end:
        start = time.perf_counter_ns()
        call()
        least = min(least, time.perf_counter_ns() - start)
    return least


def in_python(mechanism, folder):
    """Measures `lambdify` with `numpy.linalg.solve`, and PyDy."""
    from pydy.codegen.ode_function_generators import generate_ode_function
    from scipy.integrate import solve_ivp

    equations = Derivation(mechanism).equations()
    q, u = equations["q"], equations["u"]
    nq, nv, nc = len(q), len(u), equations["jacobian"].rows
    mass, jacobian = equations["mass"], equations["jacobian"]
    system = sympy.Matrix([[mass, -jacobian.T], [jacobian, sympy.zeros(nc, nc)]])
    right = sympy.Matrix([equations["force"], -equations["bias"]])
    function = sympy.lambdify((q, u), [system, right], cse=True)
    moving = sympy.lambdify((q, u), equations["moving"], cse=True)

    def accelerations(q, u):
        system, right = function(q, u)
        return numpy.linalg.solve(system, right)[:nv, 0]

    def by_lambdify(x, _t):
        return numpy.concatenate([moving(x[:nq], x[nq:])[:, 0], accelerations(x[:nq], x[nq:])])

    # Multipliers are additional speeds, whose rates in the solution are the multipliers.
    timed = {x: dynamicsymbols(x.name) for x in q + u}
    multipliers = list(dynamicsymbols(f"lambda:{nc}"))
    compiled = generate_ode_function(
        right.xreplace(timed),
        [timed[x] for x in q],
        [timed[x] for x in u] + multipliers,
        # PyDy's compiled functions need at least one parameter.
        [sympy.Symbol("unused")],
        mass_matrix=system.xreplace(timed),
        coordinate_derivatives=equations["moving"].xreplace(timed),
        generator="cython",
        constants_arg_type="array",
    )
    none, zeros = numpy.zeros(1), numpy.zeros(nc)
    rows = numpy.loadtxt(folder / "states")
    states = [row[: nq + nv] for row in rows]
    longer = [numpy.concatenate([x, zeros]) for x in states]
    for word, found in (
        ("lambdify", [by_lambdify(x, 0.0)[nq:] for x in states]),
        # The function returns the same array each time.
        ("PyDy", [compiled(x, 0.0, none)[nq : nq + nv].copy() for x in longer]),
    ):
        error = max(
            numpy.abs(a - row[-nv:]).max() / (1 + numpy.abs(row[-nv:]).max()) for a, row in zip(found, rows)
        )
        if not error < 1e-9:
            sys.exit(f"{mechanism.name}: SymPy by {word} is off by {error}")
    lambdified = least_time(lambda: [accelerations(x[:nq], x[nq:]) for x in states], 0.5) / len(states)
    cython = least_time(lambda: [compiled(x, 0.0, none) for x in longer], 0.5) / len(states)

    def rate(t, x):
        found = compiled(x, t, none)
        found[nq + nv :] = 0
        return found

    motion = least_time(lambda: solve_ivp(rate, (0, 100 * mechanism.step), longer[0]), 0.5)
    (folder / "python").write_text(f"{lambdified} {cython} {motion * 10 / 1e6}\n")


if __name__ == "__main__":
    words = sys.argv[1:]
    task = in_python if words[0] == "--python" else write
    name, folder = words[-2:]
    task(next(m for m in mechanisms.ALL if m.name == name), pathlib.Path(folder))
