"""The constrained mechanisms of the comparison as data: parameters, bodies with their joints, and loop closures.

Coordinates have the names and the order of linkwork_models; `benches/src/bin/constraints/mechanisms.rs` has the same numbers.
"""

from dataclasses import dataclass, field
from math import cos, pi, radians, sin

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)
ZERO = (0, 0, 0)


@dataclass
class Body:
    """A body with the joints that connect it to a point of another body, in that body's axes."""

    name: str
    parent: str
    at: tuple
    # Name of the coordinate, "turn" or "slide", axis; or the name of a free joint, "free", None.
    joints: list
    mass: float
    com: tuple = ZERO
    # Components xx, yy, zz, xy, xz, yz about the centre of mass.
    inertia: tuple = (0, 0, 0, 0, 0, 0)


@dataclass
class Loop:
    """Coincident points of two bodies; with an axis, a pin about it. The axis is common to both bodies if all coordinates are zero."""

    first: str
    first_at: tuple
    second: str
    second_at: tuple
    planar: bool = True
    axis: tuple = None


@dataclass
class Mechanism:
    """A mechanism of the comparison."""

    name: str
    gravity: tuple
    bodies: list
    loops: list = field(default_factory=list)
    # Order of the joints in q, if it differs from that of the bodies.
    order: list = None
    # Constant torque of each joint.
    torques: dict = field(default_factory=dict)
    # Point of the ground, body, point of the body, stiffness, free length.
    spring: tuple = None
    # Constraints for SymPy only: a name of derive.py with its arguments.
    rows: tuple = None
    # Step in seconds: 30 µs for Andrews' squeezer, whose motion lasts 30 ms.
    step: float = 1e-3

    def joints(self):
        """Returns the names of the joints in the order of q."""
        return self.order or [name for body in self.bodies for name, *_ in body.joints]


def rod(mass, length, axis):
    """Returns the inertia of a thin rod."""
    value = mass * length**2 / 12
    return tuple(0 if along else value for along in axis) + (0, 0, 0)


def along(axis, distance):
    return tuple(distance * a for a in axis)


def link(name, parent, at, joint, mass, length, axis=X, about=Z):
    """Returns a rod on a pin at its start."""
    turn = [(joint, "turn", about)]
    direction = tuple(abs(a) for a in axis)
    return Body(name, parent, at, turn, mass, along(axis, length / 2), rod(mass, length, direction))


DOWN_Y, DOWN_Z = (0, -9.81, 0), (0, 0, -9.81)


def four_bar():
    density, a, b, c, d = 0.8, 0.3, 0.9, 0.7, 0.8
    bodies = [
        link("crank", "ground", ZERO, "input", density * a, a),
        link("coupler", "crank", (a, 0, 0), "joint", density * b, b),
        link("rocker", "ground", (d, 0, 0), "output", density * c, c),
    ]
    return Mechanism("four_bar", DOWN_Y, bodies, [Loop("coupler", (b, 0, 0), "rocker", (c, 0, 0))])


def slider_crank():
    r, l = 0.04, 0.13
    bodies = [
        link("crank", "ground", ZERO, "main", 0.9, r),
        link("rod", "crank", (r, 0, 0), "big_end", 0.5, l),
        Body("piston", "ground", ZERO, [("cylinder", "slide", X)], 0.35),
    ]
    return Mechanism("slider_crank", DOWN_Y, bodies, [Loop("rod", (l, 0, 0), "piston", ZERO)])


def andrews_squeezer():
    def body(name, parent, at, joint, mass, com, izz):
        return Body(name, parent, at, [(joint, "turn", Z)], mass, com, (izz / 2, izz / 2, izz, 0, 0, 0))

    a, b = (-0.06934, -0.00227, 0), (-0.03635, 0.03273, 0)
    bodies = [
        body("k1", "ground", ZERO, "beta", 0.04325, (92e-5, 0, 0), 2.194e-6),
        body("k2", "k1", (7e-3, 0, 0), "theta", 0.00365, (-115e-4, 0, 0), 4.410e-7),
        body("k3", "ground", b, "gamma", 0.02373, (1043e-5, -1874e-5, 0), 5.255e-6),
        body("k5", "ground", a, "delta", 0.07050, (2308e-5, 916e-5, 0), 1.169e-5),
        body("k4", "k5", (4e-2, 0, 0), "phi", 0.00706, (0, -(2e-2 - 1421e-5), 0), 5.667e-7),
        body("k7", "ground", a, "epsilon", 0.05498, (-449e-5, -1228e-5, 0), 1.912e-5),
        body("k6", "k7", (0, -4e-2, 0), "omega_", 0.00706, (2e-2 - 1421e-5, 0, 0), 5.667e-7),
    ]
    end = (-28e-3, 0, 0)
    loops = [
        Loop("k2", end, "k3", (0, -35e-3, 0)),
        Loop("k2", end, "k4", (0, -2e-2, 0)),
        Loop("k2", end, "k6", (2e-2, 0, 0)),
    ]
    order = ["beta", "theta", "gamma", "phi", "delta", "omega_", "epsilon"]
    spring = ((0.014, 0.072, 0), "k3", (2e-2, -18e-3, 0), 4530.0, 7785e-5)
    return Mechanism("andrews_squeezer", ZERO, bodies, loops, order, {"beta": 0.033}, spring, step=3e-5)


def two_windows():
    bodies = [
        link("left", "ground", ZERO, "b0", 1.0, 1.0, Y),
        link("first", "left", Y, "t0", 1.0, 1.0),
        link("middle", "ground", X, "b1", 1.0, 1.0, Y),
        link("second", "middle", Y, "t1", 1.0, 1.0),
        link("right", "ground", (2, 0, 0), "b2", 1.0, 1.0, Y),
    ]
    loops = [Loop("first", X, "middle", Y), Loop("second", X, "right", Y)]
    return Mechanism("two_windows", DOWN_Y, bodies, loops)


def bricard_linkage():
    down, left = (0, -1, 0), (-1, 0, 0)
    bodies = [
        link("rod1", "ground", ZERO, "p1", 1.0, 1.0, X, Y),
        link("rod2", "rod1", X, "p2", 1.0, 1.0, down, Z),
        link("rod3", "rod2", down, "p3", 1.0, 1.0, Z, X),
        link("rod4", "rod3", Z, "p4", 1.0, 1.0, left, Y),
        link("rod5", "rod4", left, "p5", 1.0, 1.0, Y, Z),
    ]
    return Mechanism("bricard_linkage", DOWN_Y, bodies, [Loop("rod5", Y, "ground", Z, False, X)])


def five_bar():
    base, crank, forearm, m_crank, m_forearm, tool = 0.25, 0.3, 0.4, 0.4, 0.3, 0.9
    # The left forearm includes the tool at its end.
    mass = m_forearm + tool
    com = (m_forearm * forearm / 2 + tool * forearm) / mass
    about = m_forearm * forearm**2 / 3 + tool * forearm**2 - mass * com**2
    bodies = [
        link("left_crank", "ground", ZERO, "left", m_crank, crank),
        Body(
            "left_forearm",
            "left_crank",
            (crank, 0, 0),
            [("left_elbow", "turn", Z)],
            mass,
            (com, 0, 0),
            (0, about, about, 0, 0, 0),
        ),
        link("right_crank", "ground", (base, 0, 0), "right", m_crank, crank),
        link("right_forearm", "right_crank", (crank, 0, 0), "right_elbow", m_forearm, forearm),
    ]
    end = (forearm, 0, 0)
    return Mechanism("five_bar", DOWN_Y, bodies, [Loop("left_forearm", end, "right_forearm", end)])


def stewart_platform():
    def on_circle(radius, degrees):
        return (radius * cos(radians(degrees)), radius * sin(radians(degrees)), 0)

    bodies = [Body("platform", "ground", ZERO, [("pose", "free", None)], 30.0, ZERO, (1.5, 1.5, 2.5, 0, 0, 0))]
    loops = []
    legs = [(10, 50), (110, 70), (130, 170), (230, 190), (250, 290), (350, 310)]
    for k, (foot, head) in enumerate(legs, 1):
        feet = [(f"foot{k}.first", "turn", X), (f"foot{k}.second", "turn", Y)]
        slide, half = [(f"slide{k}", "slide", Z)], rod(2.0, 0.6, Z)
        bodies += [
            Body(f"lower{k}", "ground", on_circle(0.8, foot), feet, 2.0, (0, 0, 0.3), half),
            Body(f"upper{k}", f"lower{k}", ZERO, slide, 2.0, (0, 0, -0.3), half),
        ]
        loops.append(Loop(f"upper{k}", ZERO, "platform", on_circle(0.5, head), False))
    return Mechanism("stewart_platform", DOWN_Z, bodies, loops)


def rolling_disk():
    m, r = 2.0, 0.4
    joints = [("place.x", "slide", X), ("place.y", "slide", Y), ("place.z", "slide", Z)]
    joints += [("heading", "turn", Z), ("lean", "turn", X), ("roll", "turn", Y)]
    inertia = (m * r**2 / 4, m * r**2 / 2, m * r**2 / 4, 0, 0, 0)
    disk = Body("disk", "ground", ZERO, joints, m, ZERO, inertia)
    return Mechanism("rolling_disk", DOWN_Z, [disk], rows=("rims", [("disk", r)], 1))


def ball_in_bowl():
    m, r = 0.3, 0.05
    i = 0.4 * m * r**2
    ball = Body("ball", "ground", ZERO, [("pose", "free", None)], m, ZERO, (i, i, i, 0, 0, 0))
    return Mechanism("ball_in_bowl", DOWN_Z, [ball], rows=("bowl", "ball", r))


def chaplygin_sleigh():
    joints = [("ice.x", "slide", X), ("ice.y", "slide", Y), ("ice.angle", "turn", Z)]
    sleigh = Body("sleigh", "ground", ZERO, joints, 1.0, (0.3, 0, 0), (0.5, 0.5, 0.5, 0, 0, 0))
    return Mechanism("chaplygin_sleigh", ZERO, [sleigh], rows=("knife", "sleigh"))


def bicycle():
    wheelbase, trail, tilt = 1.02, 0.08, pi / 10
    steering = (sin(tilt), 0, cos(tilt))
    bodies = [
        Body("frame", "ground", ZERO, [("pose", "free", None)], 85.0, (0.3, 0, -0.9), (9.2, 11.0, 2.8, 0, 2.4, 0)),
        Body("rear", "frame", (0, 0, -0.3), [("hub", "turn", Y)], 2.0, ZERO, (0.0603, 0.12, 0.0603, 0, 0, 0)),
        Body(
            "fork",
            "frame",
            (wheelbase + trail, 0, 0),
            [("steer", "turn", steering)],
            4.0,
            (0.9 - wheelbase - trail, 0, -0.7),
            (0.05892, 0.06, 0.00708, 0, -0.00756, 0),
        ),
        Body("front", "fork", (-trail, 0, -0.35), [("front_hub", "turn", Y)], 3.0, ZERO, (0.1405, 0.28, 0.1405, 0, 0, 0)),
    ]
    return Mechanism("bicycle", (0, 0, 9.81), bodies, rows=("rims", [("rear", 0.3), ("front", 0.35)], -1))


def rattleback():
    inertia = (2e-4, 1.6e-3, 1.7e-3, -2e-5, 0, 0)
    stone = Body("stone", "ground", ZERO, [("pose", "free", None)], 1.0, (0, 0, -0.01), inertia)
    return Mechanism("rattleback", DOWN_Z, [stone], rows=("ellipsoid", "stone", (0.2, 0.03, 0.02)))


ALL = [
    make()
    for make in (
        four_bar,
        slider_crank,
        andrews_squeezer,
        two_windows,
        bricard_linkage,
        five_bar,
        stewart_platform,
        rolling_disk,
        ball_in_bowl,
        chaplygin_sleigh,
        bicycle,
        rattleback,
    )
]
