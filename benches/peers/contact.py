"""Time and accuracy of a step of MuJoCo and Drake for the quadruped of `benches/src/bin/contact.rs`, and of MuJoCo for its humanoid.

    python contact.py URDF_FOLDER LINKWORK_PROGRAM

Runs the program, and prints a table of all results.
"""

import json
import subprocess
import sys
import time

from importlib.metadata import version

import contact_drake
import mujoco
import numpy as np

POSTURE = [0.0, 0.8, -1.6]
EXTENSION = '<mujoco><compiler fusestatic="false" discardvisual="true"/></mujoco>'


def model(folder, slope, step):
    with open(f"{folder}/solo12.urdf", encoding="utf-8") as file:
        spec = mujoco.MjSpec.from_string(file.read().replace("</robot>", EXTENSION + "</robot>"))
    spec.option.timestep = step
    spec.option.gravity = [-9.81 * np.sin(slope), 0, -9.81 * np.cos(slope)]
    spec.worldbody.first_body().add_freejoint()
    ground = dict(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1])
    ball = dict(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.016, 0, 0], mass=0)
    homes = [(spec.worldbody, ground)]
    homes += [(spec.body(f"{foot}_FOOT"), ball) for foot in ("FL", "FR", "HL", "HR")]
    for home, geometry in homes:
        home.add_geom(friction=[0.8, 0, 0], condim=3, **geometry)
    for joint in spec.joints:
        if joint.type != mujoco.mjtJoint.mjJNT_HINGE:
            continue
        joint.limited = 0
        actuator = spec.add_actuator(target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        actuator.set_to_position(kp=6.0, kv=0.15)
    return spec.compile()


def start(m, height, driven=True):
    d = mujoco.MjData(m)
    d.qpos[:7] = [0, 0, height, 1, 0, 0, 0]
    d.qpos[7:] = POSTURE * 4
    d.ctrl[:] = POSTURE * 4
    if not driven:
        m.actuator_gainprm[:] = 0
        m.actuator_biasprm[:] = 0
    return d


def run(m, d, duration):
    mujoco.mj_step(m, d, round(duration / m.opt.timestep))
    return d


def timed(m, prepare, duration):
    """Returns the processor time of a step, µs: the minimum of several runs."""
    times = []
    for _ in range(15):
        d = prepare()
        begin = time.process_time()
        run(m, d, duration)
        times.append(time.process_time() - begin)
    return min(times) * 1e6 * m.opt.timestep / duration


def measured(folder):
    level, inclined = (model(folder, np.radians(slope), 1e-3) for slope in (0, 10))
    standing = run(level, start(level, 0.26), 8.0)

    def stands():
        d = start(level, 0.26)
        d.qpos[:], d.qvel[:] = standing.qpos, standing.qvel
        return d

    def creep(m):
        d = run(m, start(m, 0.26), 8.0)
        before = d.qpos[:3].copy()
        return float(np.linalg.norm(run(m, d, 1.0).qpos[:3] - before))

    def difference(step):
        coarse, fine = (model(folder, 0.0, h) for h in (step, step / 10))
        ends = [run(m, start(m, 0.26), 0.2).qpos[:3].copy() for m in (coarse, fine)]
        return float(np.linalg.norm(ends[0] - ends[1]))

    loose = model(folder, 0.0, 1e-3)
    return {
        "standing": timed(level, stands, 0.5),
        "collapsing": timed(loose, lambda: start(loose, 0.26, driven=False), 0.5),
        "free": timed(level, lambda: start(level, 100.0), 0.5),
        "depth": -float(min(c.dist for c in stands_contacts(level, stands()))),
        "creep": creep(level),
        "inclined": creep(inclined),
        "one": difference(1e-3),
        "two": difference(2e-3),
    }


def humanoid(folder):
    """Returns the humanoid with contacts at the four corners of each sole, with the drives of the Rust program."""
    with open(f"{folder}/simple_humanoid.urdf", encoding="utf-8") as file:
        spec = mujoco.MjSpec.from_string(file.read().replace("</robot>", EXTENSION + "</robot>"))
    spec.option.timestep = 1e-3
    spec.worldbody.first_body().add_freejoint()
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], friction=[0.8, 0, 0], condim=3)
    radius = 0.005
    for side in ("l", "r"):
        for x in (0.16, -0.09):
            for y in (-0.06, 0.06):
                ball = dict(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[radius, 0, 0], mass=0, pos=[x, y, radius - 0.1])
                spec.body(f"{side}_ankle").add_geom(friction=[0.8, 0, 0], condim=3, **ball)
    for joint in spec.joints:
        if joint.type == mujoco.mjtJoint.mjJNT_HINGE:
            joint.limited = 0
            spec.add_actuator(target=joint.name, trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_position(kp=1e4, kv=500.0)
    return spec.compile()


def measured_humanoid(folder):
    driven, loose = humanoid(folder), humanoid(folder)
    loose.actuator_gainprm[:] = 0
    loose.actuator_biasprm[:] = 0

    def posed(m, height):
        d = mujoco.MjData(m)
        mujoco.mj_forward(m, d)
        lowest = min(d.geom_xpos[k][2] - m.geom_size[k][0] for k in range(m.ngeom) if m.geom_bodyid[k] > 0)
        d.qpos[2] += height - lowest
        return d

    standing = run(driven, posed(driven, 0.01), 8.0)

    def stands():
        d = posed(driven, 0.0)
        d.qpos[:], d.qvel[:] = standing.qpos, standing.qvel
        return d

    return {
        "humanoid_standing": timed(driven, stands, 0.5),
        "humanoid_collapsing": timed(loose, lambda: posed(loose, 0.01), 0.5),
        "humanoid_free": timed(driven, lambda: posed(driven, 100.0), 0.5),
        "humanoid_creep": float(np.linalg.norm(run(driven, stands(), 1.0).qpos[:3] - standing.qpos[:3])),
    }


def stands_contacts(m, d):
    mujoco.mj_forward(m, d)
    return d.contact


ROWS = [
    ("a step while it stands", "standing", "µs", 1),
    ("a step while it collapses", "collapsing", "µs", 1),
    ("a step in the air", "free", "µs", 1),
    ("how deep it stands in the ground", "depth", "µm", 1e6),
    ("creep on the level", "creep", "µm/s", 1e6),
    ("creep on 10°", "inclined", "µm/s", 1e6),
    ("difference to a tenth of a step of 1 ms", "one", "µm", 1e6),
    ("difference to a tenth of a step of 2 ms", "two", "µm", 1e6),
    ("a step while the humanoid stands", "humanoid_standing", "µs", 1),
    ("a step while it collapses", "humanoid_collapsing", "µs", 1),
    ("a step in the air", "humanoid_free", "µs", 1),
    ("its creep", "humanoid_creep", "µm/s", 1e6),
]


def main():
    folder, program = sys.argv[1:3]
    ours = json.loads(subprocess.run([program], check=True, capture_output=True, text=True).stdout)
    columns = [ours["midpoint"], ours["classical"], measured(folder) | measured_humanoid(folder), contact_drake.measured(folder)]
    others = f"MuJoCo {mujoco.__version__} | Drake {version('drake')}"
    print(f"| | Linkwork, midpoint | Linkwork | {others} |\n| --- | ---: | ---: | ---: | ---: |")
    for text, key, unit, factor in ROWS:
        figures = " | ".join(f"{column[key] * factor:.3g}" if key in column else "–" for column in columns)
        print(f"| {text}, {unit} | {figures} |")


if __name__ == "__main__":
    main()
