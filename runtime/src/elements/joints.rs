//! Elements of the language that declare joints.

/// Revolute joint (hinge) about one axis: one degree of freedom.
///
/// `#[joint(parent -> child, about = z)]`: the child rotates about the axis, given in the parent's frame,
/// through the origins of both endpoints. The coordinate has the joint's name: the angle, rad; its velocity
/// is the rate, rad/s, positive by the right-hand rule. At zero both frames coincide. Its generalized force
/// is the torque about the axis, N·m. In URDF files: `revolute` and `continuous`.
#[doc(alias = "revolute")]
#[doc(alias = "hinge")]
#[doc(alias = "continuous")]
pub enum Pin {}

/// Prismatic joint (slider) along one axis: one degree of freedom.
///
/// `#[joint(parent -> child, along = x)]`: the child moves along the axis, given in the parent's frame,
/// without rotating. The coordinate has the joint's name: the displacement, m; its velocity, m/s. Its
/// generalized force is the force along the axis, N. In URDF files: `prismatic`; in MJCF: `slide`.
#[doc(alias = "prismatic")]
#[doc(alias = "slider")]
#[doc(alias = "sliding")]
pub enum Sleeve {}

/// Helical joint (screw): one degree of freedom.
///
/// `#[joint(parent -> child, about = z, lead = d)]`: the child rotates about the axis and advances along it
/// by `lead` per revolution, m, or by `pitch` per radian, m/rad. Specify one of the two, negative for a
/// left-hand thread. The coordinate has the joint's name: the angle, rad; its velocity, rad/s. Its
/// generalized force is torque about the axis plus pitch times force along it, N·m.
#[doc(alias = "helical")]
pub enum Screw {}

/// Cylindrical joint, along and about one axis: two degrees of freedom.
///
/// `#[joint(parent -> child, along = z)]`: the child slides along the axis and rotates about it. Coordinates
/// `joint.slide`, m, and `joint.turn`, rad; velocities m/s and rad/s.
#[doc(alias = "cylindrical")]
pub enum Collar {}

/// Pin in a slot (half joint): two degrees of freedom.
///
/// `#[joint(parent -> child, along = x, about = z)]`: the child slides along one axis of the parent and
/// rotates about another, perpendicular axis that slides with it. Coordinates `joint.slide`, m, and
/// `joint.turn`, rad; velocities m/s and rad/s.
#[doc(alias = "half joint")]
#[doc(alias = "pin in slot")]
pub enum Slot {}

/// Universal joint (Cardan, Hooke): two degrees of freedom.
///
/// `#[joint(parent -> child, about = (x, y))]`: the child rotates about the first axis, fixed in the parent,
/// then about the second, which the first rotation moves; the axes are perpendicular and intersect.
/// Coordinates `joint.first` and `joint.second`, rad; velocities are their rates, rad/s.
#[doc(alias = "Cardan")]
#[doc(alias = "Hooke")]
pub enum Universal {}

/// Spherical joint (ball and socket) about a point: three degrees of freedom.
///
/// `#[joint(parent -> child)]`: the origins of the endpoints coincide and the child rotates freely.
/// Configuration `joint.qx`, `.qy`, `.qz`, `.qw`: the unit quaternion that maps child components to parent
/// components. Velocity `joint.wx`, `.wy`, `.wz`: the child's angular velocity relative to the parent,
/// resolved in the child, rad/s, so that NQ is one more than NV. Generalized forces are the torque on the
/// child, resolved in the child, N·m.
#[doc(alias = "spherical")]
#[doc(alias = "ball and socket")]
#[doc(alias = "quaternion")]
pub enum Ball {}

/// Planar joint: two displacements and a rotation in a plane, three degrees of freedom.
///
/// `#[joint(parent -> child, about = z)]`: the child slides in the plane perpendicular to the axis and
/// rotates about it; or `along = (x, y)` names the two directions in the plane. Coordinates `joint.x` and
/// `joint.y`, m, along the parent's axes, and `joint.angle`, rad; velocities are their rates, m/s and rad/s.
#[doc(alias = "dual sleeve-pin")]
pub enum Planar {}

/// Cartesian joint (gantry), along two or three axes without rotation: two or three degrees of freedom.
///
/// `#[joint(parent -> child, along = (x, y))]` or `along = (x, y, z)`. Coordinates `joint.x`, `joint.y` (and
/// `joint.z`), m, along the given axes of the parent; velocities are their rates, m/s.
#[doc(alias = "Cartesian")]
#[doc(alias = "gantry")]
#[doc(alias = "translational")]
pub enum Stage {}

/// Floating joint: no constraint between two bodies, six degrees of freedom.
///
/// `#[joint(ground -> body)]`. Configuration `joint.x`, `.y`, `.z`: the position in the parent's frame, m,
/// then `joint.qx`, `.qy`, `.qz`, `.qw`: the unit quaternion that maps child components to parent components.
/// Velocity `joint.vx`, `.vy`, `.vz`, m/s, then `joint.wx`, `.wy`, `.wz`, rad/s: linear velocity of the
/// child's origin and angular velocity relative to the parent, both resolved in the child. Generalized forces
/// are force (N) and torque (N·m) on the child at its origin, resolved in the child. In URDF files:
/// `floating`, or the option `base = free`.
#[doc(alias = "floating")]
#[doc(alias = "free-flyer")]
#[doc(alias = "floating base")]
#[doc(alias = "quaternion")]
pub enum Free {}

/// Fixed joint, a rigid connection: no degree of freedom.
///
/// `#[joint(parent.at(vector).rotated(z(angle)) -> child)]`: the frames of both endpoints coincide, so the
/// child's mass and inertia add to the parent's.
#[doc(alias = "fixed")]
pub enum Weld {}

derivable! { Pin Sleeve Screw Collar Slot Universal Ball Planar Stage Free Weld }
