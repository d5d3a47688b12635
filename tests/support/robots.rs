//! Robots of the files in `models/urdf` for tests: those of the gallery, and others. The top of each file
//! states its source.

use linkwork::mechanism;

pub use linkwork_models::{AnymalB, Panda as PandaMimic, PandaArm, SimpleHumanoid as Humanoid, Solo12, Ur5};

/// Cart on a rail with a slightly asymmetric pole, from a URDF file.
#[mechanism(urdf = "../models/urdf/cartpole.urdf")]
pub struct CartPole;

/// Two pins, and bodies fixed to the ground and to the last link.
#[mechanism(urdf = "../models/urdf/double_pendulum.urdf")]
pub struct DoublePendulum;

/// Kinova robot arm with six axes, whose joints are continuous.
#[mechanism(urdf = "../models/urdf/kinova.urdf")]
pub struct Kinova;

/// Arm with seven axes and a gripper, with two independent fingers.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent)]
pub struct Panda;

/// Arm with seven axes, every other joint of which is continuous.
#[mechanism(urdf = "../models/urdf/gen3.urdf")]
pub struct Gen3;

/// Humanoid G1 with inclined hips and shoulders.
#[mechanism(urdf = "../models/urdf/g1.urdf", base = free)]
pub struct G1;
