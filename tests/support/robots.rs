//! The robots of `models/urdf`. Where they are from stands at the top of each file.

use linkwork::mechanism;

/// A cart on a rail with a slightly asymmetric pole.
#[mechanism(urdf = "../models/urdf/cartpole.urdf")]
pub struct CartPole;

/// Two pins, and bodies fixed to the ground and to the last link.
#[mechanism(urdf = "../models/urdf/double_pendulum.urdf")]
pub struct DoublePendulum;

/// A six-axis arm.
#[mechanism(urdf = "../models/urdf/ur5.urdf")]
pub struct Ur5;

/// A six-axis arm with joints that turn for ever.
#[mechanism(urdf = "../models/urdf/kinova.urdf")]
pub struct Kinova;

/// A seven-axis arm with a gripper, both fingers free.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent)]
pub struct Panda;

/// A seven-axis arm with a gripper, the second finger following the first.
#[mechanism(urdf = "../models/urdf/panda.urdf")]
pub struct PandaMimic;

/// A seven-axis arm with its gripper frozen.
#[mechanism(urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"])]
pub struct PandaArm;

/// A quadruped.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free)]
pub struct Solo12;

/// A humanoid with 29 joints.
#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free)]
pub struct Humanoid;
