"""Saves Pinocchio's model of every robot: models.py FOLDER... (each with a robot.urdf)."""

import pathlib
import sys

import pinocchio

for folder in map(pathlib.Path, sys.argv[1:]):
    file = str(folder / "robot.urdf")
    names = (folder / "joints").read_text().split()
    if (folder / "free").exists():
        model = pinocchio.buildModelFromUrdf(file, pinocchio.JointModelFreeFlyer())
        names.insert(0, "root_joint")
    else:
        model = pinocchio.buildModelFromUrdf(file)
    found = list(model.names)[1:]
    if found != names:
        sys.exit(f"{folder.name}: the joints are {found} instead of {names}")
    model.saveToText(str(folder / "model.txt"))
