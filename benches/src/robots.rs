//! The robots that are measured, from `models/urdf`.

use linkwork::mechanism;

/// A six-axis arm.
#[mechanism(urdf = "../models/urdf/ur5.urdf")]
pub struct Ur5;

/// A seven-axis arm with its fingers locked.
#[mechanism(urdf = "../models/urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"])]
pub struct PandaArm;

/// A seven-axis arm with two independent fingers.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent)]
pub struct Panda;

/// A quadruped with twelve joints.
#[mechanism(urdf = "../models/urdf/solo12.urdf", base = free)]
pub struct Solo12;

/// A humanoid with 29 joints.
#[mechanism(urdf = "../models/urdf/simple_humanoid.urdf", base = free)]
pub struct Humanoid;
