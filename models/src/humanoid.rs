use linkwork::mechanism;

/// Simple humanoid: a floating base, two legs with six joints each, a waist with three, two arms with seven
/// each.
///
/// Source: `simple_humanoid_description` of LAAS-CNRS (BSD-2-Clause) by way of `example-robot-data` 5.0.0;
/// see the head of `urdf/simple_humanoid.urdf`.
///
/// - Configuration: position and quaternion of the base, then the angles of the joints, rad, depth first, the
///   joints of one link in alphabetical order of their names. Inputs: a torque on each joint, N·m.
/// - Closed form: in free fall from rest, all bodies accelerate with g and no joint moves.
#[mechanism(urdf = "urdf/simple_humanoid.urdf", base = free, derivatives, packed)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SimpleHumanoid;
