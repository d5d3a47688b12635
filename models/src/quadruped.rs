use linkwork::mechanism;

/// Solo 12 of the Open Dynamic Robot Initiative: a quadruped with a floating base and three joints per leg.
///
/// Source: `robot_properties_solo` (BSD-3-Clause) by way of `example-robot-data` 5.0.0; see the head of
/// `urdf/solo12.urdf`. Grimminger et al., *An open torque-controlled modular robot architecture for legged
/// locomotion research*, IEEE RA-L 5 (2020).
///
/// - Configuration: position and quaternion of the base, then the legs FL, FR, HL, HR (front, hind; left,
///   right), each with HAA (hip abduction, about x), HFE (hip flexion, about y) and KFE (knee flexion, about
///   y), rad. Inputs: a torque on each joint of the legs, N·m.
/// - Closed forms: in free fall from rest, all bodies accelerate with g and no joint moves; a leg is two
///   segments of 160 mm, so its foot is at `−0.16 (sin α + sin(α + β))` ahead of and
///   `−0.16 (cos α + cos(α + β))` above its hip at HFE = α and KFE = β.
#[mechanism(urdf = "urdf/solo12.urdf", base = free, derivatives, packed)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Solo12;

/// ANYmal B of ANYbotics: a quadruped with a floating base and three joints per leg, whose legs are not
/// identical: hind and front, left and right are mirror images of each other.
///
/// Source: `anymal_b_simple_description` (BSD-3-Clause) by way of `example-robot-data` 5.0.0; see the head of
/// `urdf/anymal_b.urdf`. Hutter et al., *ANYmal – a highly mobile and dynamic quadrupedal robot*, IROS 2016.
/// (The file gives `base` hardly any mass, and a physically inconsistent inertia matrix; `inertia = trust`
/// accepts it.)
///
/// - Configuration: position and quaternion of the base, then the legs LF, LH, RF, RH (left, right; front,
///   hind), each with HAA (hip abduction, about x), HFE (hip flexion, about y) and KFE (knee flexion, about
///   y), rad. Inputs: a torque on each joint of the legs, N·m.
/// - Closed form: in free fall from rest, all bodies accelerate with g and no joint moves.
#[mechanism(urdf = "urdf/anymal_b.urdf", base = free, inertia = trust, derivatives, packed)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AnymalB;
