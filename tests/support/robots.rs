//! The robots of `models/urdf`: those of the gallery, and others. Where they are from stands at the top of
//! each file.

use linkwork::mechanism;

pub use linkwork_models::{AnymalB, Panda as PandaMimic, PandaArm, SimpleHumanoid as Humanoid, Solo12, Ur5};

/// A cart on a rail with a slightly asymmetric pole.
#[mechanism(urdf = "../models/urdf/cartpole.urdf")]
pub struct CartPole;

/// Two pins, and bodies fixed to the ground and to the last link.
#[mechanism(urdf = "../models/urdf/double_pendulum.urdf")]
pub struct DoublePendulum;

/// A six-axis arm with joints that turn for ever.
#[mechanism(urdf = "../models/urdf/kinova.urdf")]
pub struct Kinova;

/// A seven-axis arm with a gripper, both fingers free.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent)]
pub struct Panda;

/// A seven-axis arm, every other joint of which turns for ever.
#[mechanism(urdf = "../models/urdf/gen3.urdf")]
pub struct Gen3;

/// A humanoid whose hips and shoulders are inclined.
#[mechanism(urdf = "../models/urdf/g1.urdf", base = free)]
pub struct G1;
