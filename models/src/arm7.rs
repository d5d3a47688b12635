use linkwork::mechanism;

/// Panda of Franka Emika: an arm with seven joints and a hand with two fingers that move together.
///
/// Source: `franka_ros` (Apache-2.0) by way of `example-robot-data` 5.0.0; see the head of `urdf/panda.urdf`.
///
/// - Coordinates: `panda_joint1` to `panda_joint7`, rad, then `panda_finger_joint1`, m, which the other
///   finger mimics. Inputs: a torque (N·m) or force (N) on each.
/// - Closed form: `panda_link0` to `panda_link8` by the manufacturer's Denavit–Hartenberg parameters in
///   Craig's convention, d = (333, 0, 316, 0, 384, 0, 0) mm, a = (0, 0, 0, 82.5, −82.5, 0, 88) mm, α = (0,
///   −90, 90, 90, −90, 90, 90)°, flange 107 mm.
///
/// [`PandaArm`] is the model for control.
#[mechanism(urdf = "urdf/panda.urdf")]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Panda;

/// The arm of a [`Panda`] alone, fingers locked: seven joints.
///
/// Coordinates: `panda_joint1` to `panda_joint7`, rad. Inputs: a torque on each, N·m.
#[mechanism(
    urdf = "urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"], derivatives, packed
)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PandaArm;

/// [`PandaArm`] with a load between its fingertips, which the model of a controller may not contain.
#[mechanism(urdf = "urdf/panda.urdf", lock = ["panda_finger_joint1", "panda_finger_joint2"])]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadedPanda {
    /// Mass of the load, kg.
    pub load: f64,

    #[particle(mass = load, at = panda_hand.at(0.1034 * z))]
    object: Particle,
}
