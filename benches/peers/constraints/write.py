"""Writes the mechanisms for MuJoCo and Pinocchio: write.py FOLDER creates a folder for each.

Files: mujoco.xml; model.txt, Pinocchio's own archive; order, the joints in Linkwork's order; torques, a constant for each
joint; step, s; loops and springs, a line each: `point JOINT x y z JOINT x y z`,
`spring JOINT x y z x y z stiffness free_length` (point of the ground, point of the body; its joint has the ground's axes
at zero).
"""

import pathlib
import sys

import numpy
import pinocchio

import mechanisms

# MuJoCo rejects bodies without inertia about an axis, even if they cannot rotate about it.
LEAST_INERTIA = 1e-12


def numbers(values):
    return " ".join(repr(float(v)) for v in values)


def points(loop):
    """Returns pairs of coincident points: two along the axis of a pin."""
    pairs = [(loop.first_at, loop.second_at)]
    if loop.axis:
        shifted = lambda at: tuple(a + b for a, b in zip(at, loop.axis))
        pairs.append((shifted(loop.first_at), shifted(loop.second_at)))
    return pairs


def mujoco_xml(m):
    sites = {"ground": []}
    loops = []
    for loop in m.loops:
        for first, second in points(loop):
            k = len(loops)
            sites.setdefault(loop.first, []).append((f"a{k}", first))
            sites.setdefault(loop.second, []).append((f"b{k}", second))
            loops.append(f'<connect site1="a{k}" site2="b{k}"/>')
    tendon = ""
    if m.spring:
        ground, body, at, stiffness, free_length = m.spring
        sites["ground"].append(("spring0", ground))
        sites.setdefault(body, []).append(("spring1", at))
        tendon = (
            f'<tendon><spatial stiffness="{stiffness}" springlength="{free_length}">'
            '<site site="spring0"/><site site="spring1"/></spatial></tendon>'
        )
    marks = lambda name: "".join(f'<site name="{s}" pos="{numbers(at)}"/>' for s, at in sites.get(name, []))

    def body_xml(body):
        kinds = {"turn": "hinge", "slide": "slide"}
        joints = "".join(
            f'<freejoint name="{name}"/>'
            if kind == "free"
            else f'<joint name="{name}" type="{kinds[kind]}" axis="{numbers(axis)}"/>'
            for name, kind, axis in body.joints
        )
        inertia = tuple(max(i, LEAST_INERTIA) for i in body.inertia[:3]) + body.inertia[3:]
        below = "".join(body_xml(child) for child in m.bodies if child.parent == body.name)
        return (
            f'<body name="{body.name}" pos="{numbers(body.at)}">{joints}<inertial pos="{numbers(body.com)}" '
            f'mass="{body.mass}" fullinertia="{numbers(inertia)}"/>{marks(body.name)}{below}</body>'
        )

    tree = "".join(body_xml(body) for body in m.bodies if body.parent == "ground")
    return (
        f'<mujoco><compiler angle="radian" autolimits="false"/><option gravity="{numbers(m.gravity)}" timestep="{m.step}">'
        f'<flag contact="disable"/></option><worldbody>{marks("ground")}{tree}</worldbody>'
        f"<equality>{''.join(loops)}</equality>{tendon}</mujoco>\n"
    )


def write_pinocchio(m, folder):
    model = pinocchio.Model()
    model.gravity.linear = numpy.array(m.gravity, dtype=float)
    aligned = {
        ("turn", mechanisms.X): pinocchio.JointModelRX,
        ("turn", mechanisms.Y): pinocchio.JointModelRY,
        ("turn", mechanisms.Z): pinocchio.JointModelRZ,
        ("slide", mechanisms.X): pinocchio.JointModelPX,
        ("slide", mechanisms.Y): pinocchio.JointModelPY,
        ("slide", mechanisms.Z): pinocchio.JointModelPZ,
    }
    last = {"ground": 0}
    for body in m.bodies:
        parent, at = last[body.parent], pinocchio.SE3(numpy.eye(3), numpy.array(body.at, dtype=float))
        for name, kind, axis in body.joints:
            joint = pinocchio.JointModelFreeFlyer() if kind == "free" else aligned[kind, axis]()
            parent, at = model.addJoint(parent, joint, at, name), pinocchio.SE3.Identity()
        xx, yy, zz, xy, xz, yz = body.inertia
        inertia = numpy.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        model.appendBodyToJoint(parent, pinocchio.Inertia(body.mass, numpy.array(body.com, dtype=float), inertia), at)
        last[body.name] = parent
    model.saveToText(str(folder / "model.txt"))
    lines = [
        f"point {last[loop.first]} {numbers(first)} {last[loop.second]} {numbers(second)}"
        for loop in m.loops
        for first, second in points(loop)
    ]
    if m.spring:
        ground, body, at, *law = m.spring
        lines.append(f"spring {last[body]} {numbers(ground)} {numbers(at)} {numbers(law)}")
    (folder / "loops").write_text("\n".join(lines) + "\n")


for m in mechanisms.ALL:
    folder = pathlib.Path(sys.argv[1]) / m.name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "order").write_text("\n".join(m.joints()) + "\n")
    (folder / "step").write_text(f"{m.step}\n")
    (folder / "torques").write_text("".join(f"{name} {value}\n" for name, value in m.torques.items()))
    if m.loops:
        (folder / "mujoco.xml").write_text(mujoco_xml(m))
        write_pinocchio(m, folder)
