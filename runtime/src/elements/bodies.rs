//! Elements of the language that declare bodies and particles.

/// Rigid body (link).
///
/// `#[body(mass = m, com = vector, inertia = …)]`: mass, kg; centre of mass in the body's frame, m, default
/// the origin; inertia about the centre of mass in the body's axes, kg·m², default zero. The inertia is
/// - a solid with its mass, dimensions and axis: `rod(m, length, axis)`, `disk(m, radius, axis)`, `ring(m,
///   radius, axis)`, `cylinder(m, radius, height, axis)`, `tube(m, inner, outer, height, axis)`, `cone(m,
///   radius, height, axis)`, `capsule(m, radius, height, axis)`, `sphere(m, radius)`, `shell(m, radius)`,
///   `cuboid(m, a, b, c)`, `plate(m, a, b)` (in the plane of x and y), `ellipsoid(m, a, b, c)`;
/// - `diagonal(a, b, c)`, or a symmetric matrix `[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]`;
/// - any of these `.rotated(z(angle), …)`.
///
/// With `about = vector`, a matrix or `diagonal(…)` is the inertia about that point of the body, m, instead
/// of the centre of mass; `about = 0` is the origin. With the vector `d` from that point to the centre of
/// mass, `m (|d|² 1 − d dᵀ)` is subtracted.
///
/// The body's frame is placed by its inboard joint, or without a joint by `at = vector` and `frame = f`,
/// expressions of coordinates and time. The additional option `massive` prescribes this motion regardless of
/// the body's mass, which may then be omitted.
///
/// Errors: an inertia that no body can have (a principal moment that is negative or larger than the sum of
/// the others) does not compile if it is given by numbers; nor does a body without placement.
#[doc(alias = "link")]
#[doc(alias = "inertia")]
pub enum Body {}

/// Point mass: a mass at a point, without extent.
///
/// `#[particle(mass = m, at = body.at(vector))]`: mass, kg, and the point of a body to which it is fixed, m.
/// It adds its mass and inertia to the body and has no degree of freedom. A joint, `#[joint(ground -> bob,
/// …)]`, replaces `at`.
#[doc(alias = "point mass")]
pub enum Particle {}

derivable! { Body Particle }
