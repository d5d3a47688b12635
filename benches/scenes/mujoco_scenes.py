"""MuJoCo on the fixed scenes of `benches/scenes`: microseconds of a step, in time of the thread.

    python mujoco_scenes.py
"""

import time

import mujoco
import numpy as np


def boxes(size, mass, friction, places, rotations=None, step=1e-3):
    spec = mujoco.MjSpec()
    spec.option.timestep = step
    contact = dict(friction=[friction, 0, 0], condim=3)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1], **contact)
    for k, place in enumerate(places):
        body = spec.worldbody.add_body(pos=place, quat=rotations[k] if rotations else [1, 0, 0, 0])
        body.add_freejoint()
        half = [length / 2 for length in size]
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=half, mass=mass, **contact)
    return spec.compile()


def measure(name, model, velocities, steps):
    best = None
    for _ in range(5):
        data = mujoco.MjData(model)
        for entry, value in velocities.items():
            data.qvel[entry] = value
        times = []
        for _ in range(steps):
            start = time.thread_time_ns()
            mujoco.mj_step(model, data)
            times.append((time.thread_time_ns() - start) * 1e-3)
        if best is None or np.mean(times) < np.mean(best):
            best = times
    print(f"{name:10} mean {np.mean(best):.1f} median {np.median(best):.1f} p99.9 {np.percentile(best, 99.9):.1f}")


def main():
    row = [[0.025 * k, 0, 0.025] for k in range(5)]
    push = {4: 3.0, 0: 0.075}
    for name, count in (("bricks", 2), ("dominoes", 5)):
        measure(name, boxes((0.008, 0.025, 0.05), 0.02, 0.3, row[:count]), push, 1000)
    rotations = [np.array([1, 0.3 + 0.1 * k, 0.2, 0.1]) for k in range(3)]
    rotations = [rotation / np.linalg.norm(rotation) for rotation in rotations]
    places = [[0.05 * k, 0.03 * k, 0.3 + 0.35 * k] for k in range(3)]
    measure("tumbling", boxes((0.3, 0.2, 0.1), 1.0, 0.5, places, rotations), {3: 1, 9: 2, 15: 3}, 1500)
    places = [[0.02 * ((k % 3) - 1), 0, 0.05 + 0.1 * k] for k in range(10)]
    measure("tower", boxes((0.2, 0.2, 0.1), 1.0, 0.6, places), {}, 200)


if __name__ == "__main__":
    main()
