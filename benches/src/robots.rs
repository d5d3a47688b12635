//! Robots of the benchmarks that the crate `linkwork-models` does not contain.

use linkwork::mechanism;

/// Panda arm with seven axes and two independent fingers.
#[mechanism(urdf = "../models/urdf/panda.urdf", mimic = independent, derivatives, packed)]
#[derive(Clone, Copy)]
pub struct Panda;

/// Kinova arm with six axes, whose joints are continuous.
#[mechanism(urdf = "../models/urdf/kinova.urdf", derivatives, packed)]
#[derive(Clone, Copy)]
pub struct Kinova;

/// Gen3 of Kinova: an arm with seven axes, every other joint of which is continuous.
#[mechanism(urdf = "../models/urdf/gen3.urdf", derivatives, packed)]
#[derive(Clone, Copy)]
pub struct Gen3;

/// G1 of Unitree: a humanoid with legs of six joints, a waist of three and arms of seven, with inclined hips
/// and shoulders.
#[mechanism(urdf = "../models/urdf/g1.urdf", base = free, derivatives, packed)]
#[derive(Clone, Copy)]
pub struct G1;
