"""Writes `data/mujoco/drives.json`: rates of velocities and activations by MuJoCo 4.0.0 at random states.

    python peers/drives.py     (in the folder `tests`, with the package mujoco)
"""
import json
import mujoco
import numpy as np

model = mujoco.MjModel.from_xml_path("data/mjcf/drives.xml")
random, cases = np.random.default_rng(1), []
for k in range(8):
    data = mujoco.MjData(model)
    data.qpos = random.uniform(-1, 1, model.nq)
    data.qvel = random.uniform(-2, 2, model.nv)
    data.act = random.uniform(0.05, 0.95, model.na)
    data.ctrl = random.uniform(0, 1, model.nu)
    mujoco.mj_forward(model, data)
    cases.append({"q": data.qpos.tolist(), "v": data.qvel.tolist(), "x": data.act.tolist(), "u": data.ctrl.tolist(),
                  "a": data.qacc.tolist(), "rates": data.act_dot.tolist()})
with open("data/mujoco/drives.json", "w") as file:
    file.write('{"cases": [\n' + ",\n".join(json.dumps(case) for case in cases) + "\n]}\n")
