//! The words of the language: the types of the fields of a `#[mechanism]` struct.
//!
//! A field's type says what it is, its attribute how it is placed; see [`mechanism`](macro@crate::mechanism) for the whole.
//! The compiler reads these types and removes the fields, so values of them do not exist.
//!
//! In the attributes, vectors are written with the axes `x`, `y`, `z` of the frame at hand (the body's own in
//! `#[body(…)]` and `.at(…)`, the parent's for a joint's axis, the ground's for gravity), or of another one:
//! `cart.x`. Endpoints of joints and force elements are bodies, `ground`, or points and orientations fixed in them:
//! `body.at(l / 2 * y)`, `body.at(l * x).rotated(z(angle), x(tilt))`, the rotations in order about carried axes.
//! Units are SI, angles in radians.

/// A rigid body.
///
/// `#[body(mass = m, com = vector, inertia = …)]`: mass, kg; centre of mass in the body's frame, m, its origin if
/// not given; inertia about the centre of mass in the body's axes, kg·m², none if not given. The inertia is
/// - a solid with its mass, sizes and axis: `rod(m, length, axis)`, `disk(m, radius, axis)`, `ring(m, radius, axis)`,
///   `cylinder(m, radius, height, axis)`, `tube(m, inner, outer, height, axis)`, `cone(m, radius, height, axis)`,
///   `capsule(m, radius, height, axis)`, `sphere(m, radius)`, `shell(m, radius)`, `cuboid(m, a, b, c)`,
///   `ellipsoid(m, a, b, c)`;
/// - `diagonal(a, b, c)`, or a symmetric matrix `[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]`;
/// - any of these `.rotated(z(angle), …)`.
///
/// The body's frame is placed by the joint that carries it. Also called link.
pub enum Body {}

/// A particle: a mass at a point, without extent.
///
/// `#[particle(mass = m, at = body.at(vector))]`: mass, kg, and the point that carries it, m. It adds its mass and
/// inertia to the body and brings no degree of freedom. Also called point mass.
pub enum Particle {}

/// A joint about one axis: one degree of freedom.
///
/// `#[joint(parent -> child, about = z)]`: the child turns about the axis, given in the parent's frame, through the
/// origins of both endpoints. The coordinate has the joint's name: the angle, rad; its velocity is the rate, rad/s,
/// positive by the right-hand rule. At zero both frames agree. Also called revolute, hinge or continuous joint.
pub enum Pin {}

/// A joint along one axis: one degree of freedom.
///
/// `#[joint(parent -> child, along = x)]`: the child moves along the axis, given in the parent's frame, without
/// turning. The coordinate has the joint's name: the displacement, m; its velocity, m/s. Also called prismatic or
/// sliding joint, or slider.
pub enum Sleeve {}

/// A screw joint: one degree of freedom.
///
/// `#[joint(parent -> child, about = z, lead = d)]`: the child turns about the axis and advances along it by `lead`
/// per turn, m, or by `pitch` per radian, m/rad; give one of the two, negative for a left-hand thread. The
/// coordinate has the joint's name: the angle, rad; its velocity, rad/s. Also called helical joint.
pub enum Screw {}

/// A joint along and about the same axis: two degrees of freedom.
///
/// `#[joint(parent -> child, along = z)]`: the child slides along the axis and turns about it. Coordinates
/// `joint.slide`, m, and `joint.turn`, rad; velocities m/s and rad/s. Also called cylindrical joint.
pub enum Collar {}

/// A pin in a slot: two degrees of freedom.
///
/// `#[joint(parent -> child, along = x, about = z)]`: the child slides along one axis of the parent and turns about
/// another, perpendicular one that slides along. Coordinates `joint.slide`, m, and `joint.turn`, rad; velocities m/s
/// and rad/s. Also called pin-in-slot joint; in the plane, a half joint.
pub enum Slot {}

/// A universal joint: two degrees of freedom.
///
/// `#[joint(parent -> child, about = (x, y))]`: the child turns about the first axis, fixed in the parent, then about
/// the second, carried by the first; the axes are perpendicular and intersect. Coordinates `joint.first` and
/// `joint.second`, rad; velocities are their rates, rad/s. Also called Cardan or Hooke's joint.
pub enum Universal {}

/// A joint about a point: three degrees of freedom.
///
/// `#[joint(parent -> child)]`: the origins of the endpoints coincide and the child turns freely. Configuration
/// `joint.qx`, `.qy`, `.qz`, `.qw`: the unit quaternion that turns child components into parent components. Velocity
/// `joint.wx`, `.wy`, `.wz`: the child's angular velocity relative to the parent, resolved in the child, rad/s, so
/// that NQ is one more than NV. Also called spherical joint or ball-and-socket.
pub enum Ball {}

/// A joint in a plane: three degrees of freedom.
///
/// `#[joint(parent -> child, about = z)]`: the child slides in the plane perpendicular to the axis and turns about
/// it; or `along = (x, y)` names the two directions in the plane. Coordinates `joint.x` and `joint.y`, m, along the
/// parent's axes, and `joint.angle`, rad; velocities are their rates, m/s and rad/s.
pub enum Planar {}

/// Displacement along two or three axes, without turning: two or three degrees of freedom.
///
/// `#[joint(parent -> child, along = (x, y))]` or `along = (x, y, z)`. Coordinates `joint.x`, `joint.y` (and
/// `joint.z`), m, along the given axes of the parent; velocities are their rates, m/s. Also called Cartesian or
/// gantry joint, or translational joint.
pub enum Stage {}

/// No constraint between two bodies: six degrees of freedom.
///
/// `#[joint(ground -> body)]`. Configuration `joint.x`, `.y`, `.z`: the position in the parent's frame, m, then
/// `joint.qx`, `.qy`, `.qz`, `.qw`: the unit quaternion that turns child components into parent components. Velocity
/// `joint.vx`, `.vy`, `.vz`, m/s, then `joint.wx`, `.wy`, `.wz`, rad/s: linear velocity of the child's origin and
/// angular velocity relative to the parent, both resolved in the child. Also called free-flyer or floating joint.
pub enum Free {}

/// A rigid connection: no degree of freedom.
///
/// `#[joint(parent.at(vector).rotated(z(angle)) -> child)]`: the frames of both endpoints coincide, so the child's
/// mass and inertia add to the parent's. Also called fixed joint.
pub enum Weld {}

/// A linear spring.
///
/// `#[acts(on = joint, stiffness = k, free_length = l0)]` on one coordinate of a joint: force `−k (q − l0)`. The
/// stiffness is in N/m along a [`Sleeve`], in N·m/rad about a [`Pin`], where the free length is `free_angle = a0`;
/// both are zero if not given. One coordinate of a larger joint is named: `on = collar.slide`.
/// `#[acts(between = (a, b), stiffness = k, free_length = l0)]` between two bodies or points: a pull `k (l − l0)` along
/// their distance `l`, m. Energy `½ k (…)²`, J, adds to the potential energy.
pub enum Spring {}

/// A linear damper.
///
/// `#[acts(on = joint, damping = c)]` on one coordinate of a joint: force `−c v`, with `c` in N·s/m along a
/// [`Sleeve`], in N·m·s/rad about a [`Pin`]. One coordinate of a larger joint is named: `on = collar.turn`.
/// `#[acts(between = (a, b), damping = c)]` between two bodies or points: it resists the rate of their distance.
/// Dissipates `c v²`, W. Also called dashpot or viscous friction.
pub enum Dashpot {}

/// An inerter: a force in proportion to the relative acceleration of its ends, `inertance = b`, kg. Not yet supported.
pub enum Inerter {}

/// A force from outside: an input, one entry of `u`, N.
///
/// - `#[acts(on = sleeve)]`: along a joint's coordinate, on the child, and opposite on the parent.
/// - `#[acts(on = body.at(point), along = direction)]`: at a point of a body (its origin if none is named) along a
///   unit vector.
///
/// The input has the field's name; inputs are in the order of declaration. Also called actuator or thruster.
pub enum Force {}

/// A torque from outside: an input, one entry of `u`, N·m.
///
/// - `#[acts(on = pin)]`: about a joint's axis, on the child, and opposite on the parent: a motor.
/// - `#[acts(on = body, about = direction)]`: on a body about a unit vector.
///
/// The input has the field's name; inputs are in the order of declaration. Also called motor or couple.
pub enum Torque {}

/// Dry friction on a joint. Not yet supported; for viscous friction see [`Dashpot`].
pub enum Friction {}

/// Attraction of all masses by a point or a body. Not yet supported; uniform gravity is `#[mechanism(gravity = …)]`.
pub enum Gravity {}

/// Attraction between two bodies or points by the inverse square of their distance. Not yet supported.
pub enum Attraction {}

/// A generalized coordinate of its own, by which frames, points and particles are placed. Not yet supported.
pub enum Coordinate {}

/// An entry of `u` of its own, for use in expressions. Not yet supported; see [`Force`] and [`Torque`].
pub enum Input {}

/// A frame placed by rotations and points, `#[frame(start, z(psi), x(theta))]`. Not yet supported.
pub enum Frame {}

/// A point with a name, `#[point(on = body, at = vector)]`. Not yet supported.
pub enum Point {}

/// A potential energy given as an expression, `#[energy(…)]`, J. Not yet supported.
pub enum Potential {}

/// A Rayleigh dissipation function given as an expression, `#[dissipation(…)]`, W. Not yet supported.
pub enum Rayleigh {}

/// An expression of the configuration that stays zero, `#[constraint(…)]`. Not yet supported.
pub enum Holonomic {}

/// An expression, linear in the velocities, that stays zero, `#[constraint(…)]`. Not yet supported.
pub enum Nonholonomic {}

/// A pair of surfaces that roll on each other without slip, `#[constraint(rolls(…, …))]`. Not yet supported.
pub enum Rolling {}

/// A scalar expression with a name, `#[define(…)]` or `#[output(…)]`. Not yet supported.
pub enum Scalar {}

/// A vector expression with a name, `#[define(…)]` or `#[output(…)]`. Not yet supported.
pub enum Vector {}
