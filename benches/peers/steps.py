"""Saves Pinocchio's models of the arms of `benches/src/bin/steps.rs`: steps.py URDF_FOLDER FOLDER."""

import pathlib
import sys

import pinocchio as pin

ROBOTS = {"ur5": ("ur5.urdf", []), "panda_arm": ("panda.urdf", ["panda_finger_joint1", "panda_finger_joint2"])}

urdf, folder = map(pathlib.Path, sys.argv[1:3])
for name, (file, locked) in ROBOTS.items():
    whole = pin.buildModelFromUrdf(str(urdf / file))
    model = pin.buildReducedModel(whole, [whole.getJointId(joint) for joint in locked], pin.neutral(whole))
    (folder / name).mkdir(parents=True, exist_ok=True)
    model.saveToText(str(folder / name / "model.txt"))
