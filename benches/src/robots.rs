//! Robots that are measured beside those of `linkwork-models`.

use linkwork::mechanism;

/// A seven-axis arm with two independent fingers.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent, derivatives, packed)]
#[derive(Clone, Copy)]
pub struct Panda;

/// A six-axis arm with joints that turn for ever.
#[mechanism(urdf = "../models/urdf/kinova.urdf", derivatives, packed)]
#[derive(Clone, Copy)]
pub struct Kinova;

/// The Gen3 of Kinova: a seven-axis arm, every other joint of which turns for ever.
#[mechanism(urdf = "../models/urdf/gen3.urdf", derivatives, packed)]
#[derive(Clone, Copy)]
pub struct Gen3;

/// The G1 of Unitree: a humanoid with legs of six joints, a waist of three and arms of seven, hips and
/// shoulders inclined.
#[mechanism(urdf = "../models/urdf/g1.urdf", base = free, derivatives, packed)]
#[derive(Clone, Copy)]
pub struct G1;
