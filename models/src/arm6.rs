use linkwork::mechanism;

/// The UR5 of Universal Robots: an arm with six joints.
///
/// Source: `ur_description` of ros-industrial (BSD) by way of `example-robot-data` 5.0.0; see the head of
/// `urdf/ur5.urdf`.
///
/// - Coordinates in the order of the chain: `shoulder_pan_joint`, `shoulder_lift_joint`, `elbow_joint`,
///   `wrist_1_joint`, `wrist_2_joint`, `wrist_3_joint`, rad. Inputs: a torque on each, N·m.
/// - Closed form: `base` to `tool0` by the manufacturer's Denavit–Hartenberg parameters,
///   d = (89.159, 0, 0, 109.15, 94.65, 82.3) mm, a = (0, −425, −392.25, 0, 0, 0) mm,
///   α = (90, 0, 0, 90, −90, 0)°.
#[mechanism(urdf = "urdf/ur5.urdf", derivatives, packed)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ur5;
