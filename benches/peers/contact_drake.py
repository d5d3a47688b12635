"""Simulates the quadruped of `contact.py` in Drake, with its discrete contact solver (SAP), rigid ground, and the same drives."""

import time

import numpy as np
from pydrake.all import (
    AddMultibodyPlant,
    CoulombFriction,
    DiagramBuilder,
    HalfSpace,
    MultibodyPlantConfig,
    Parser,
    PdControllerGains,
    RigidTransform,
    Simulator,
    Sphere,
)

POSTURE = [0.0, 0.8, -1.6]
FEET = ("FL", "FR", "HL", "HR")
RADIUS = 0.016


class Solo:
    """The robot in a posture, simulated with fixed steps."""

    def __init__(self, folder, slope, step, stiffness=6.0):
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=step, discrete_contact_approximation="sap", contact_model="point")
        self.plant, _ = AddMultibodyPlant(config, builder)
        with open(f"{folder}/solo12.urdf", encoding="utf-8") as file:
            (robot,) = Parser(self.plant).AddModelsFromString(file.read(), "urdf")
        gravity = [-9.81 * np.sin(slope), 0, -9.81 * np.cos(slope)]
        self.plant.mutable_gravity_field().set_gravity_vector(gravity)
        self.touch(self.plant.world_body(), HalfSpace(), "ground")
        self.feet = [self.plant.GetBodyByName(f"{foot}_FOOT") for foot in FEET]
        for foot in self.feet:
            self.touch(foot, Sphere(RADIUS), foot.name())
        joints = [self.plant.get_joint(k) for k in self.plant.GetJointIndices()]
        for joint in joints:
            if joint.num_velocities() != 1:
                continue
            joint.set_position_limits([-np.inf], [np.inf])
            actuator = self.plant.AddJointActuator(joint.name(), joint)
            if stiffness > 0:
                actuator.set_controller_gains(PdControllerGains(p=stiffness, d=0.025 * stiffness))
        self.plant.Finalize()
        self.simulator = Simulator(builder.Build())
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.plant.get_actuation_input_port(robot).FixValue(self.context, np.zeros(12))
        if stiffness > 0:
            wanted = np.concatenate([POSTURE * 4, np.zeros(12)])
            self.plant.get_desired_state_input_port(robot).FixValue(self.context, wanted)
        self.step = step

    def touch(self, body, shape, name):
        rubs = CoulombFriction(0.8, 0.8)
        self.plant.RegisterCollisionGeometry(body, RigidTransform(), shape, name, rubs)

    def start(self, height):
        self.simulator.get_mutable_context().SetTime(0.0)
        self.plant.SetPositions(self.context, np.concatenate([[1, 0, 0, 0, 0, 0, height], POSTURE * 4]))
        self.plant.SetVelocities(self.context, np.zeros(18))
        self.simulator.Initialize()
        return self

    def run(self, duration):
        self.simulator.AdvanceTo(self.simulator.get_context().get_time() + duration)
        return self

    def place(self):
        return self.plant.GetPositions(self.context)[4:7].copy()

    def depth(self):
        heights = [self.plant.EvalBodyPoseInWorld(self.context, foot).translation()[2] for foot in self.feet]
        return RADIUS - min(heights)

    def timed(self, prepare, duration):
        """Returns the processor time of a step, µs: the minimum of several runs."""
        times = []
        for _ in range(15):
            prepare()
            begin = time.process_time()
            self.run(duration)
            times.append(time.process_time() - begin)
        return min(times) * 1e6 * self.step / duration


def measured(folder):
    level, inclined = (Solo(folder, np.radians(slope), 1e-3) for slope in (0, 10))
    stands = level.start(0.26).run(8.0).plant.GetPositionsAndVelocities(level.context).copy()

    def stand():
        level.start(0.26)
        level.plant.SetPositionsAndVelocities(level.context, stands)
        return level

    def creep(solo):
        before = solo.start(0.26).run(8.0).place()
        return float(np.linalg.norm(solo.run(1.0).place() - before))

    def difference(step):
        ends = [Solo(folder, 0.0, h).start(0.26).run(0.2).place() for h in (step, step / 10)]
        return float(np.linalg.norm(ends[0] - ends[1]))

    loose = Solo(folder, 0.0, 1e-3, stiffness=0.0)
    return {
        "standing": level.timed(stand, 0.5),
        "collapsing": loose.timed(lambda: loose.start(0.26), 0.5),
        "free": level.timed(lambda: level.start(100.0), 0.5),
        "depth": stand().depth(),
        "creep": creep(level),
        "inclined": creep(inclined),
        "one": difference(1e-3),
        "two": difference(2e-3),
    }
