//! Bodies and particles.

/// Rigid body (link).
///
/// `#[body(mass = m, com = vector, inertia = …)]`: mass, kg; centre of mass in the body's frame, m, its origin if
/// not given; inertia about the centre of mass in the body's axes, kg·m², none if not given. The inertia is
/// - a solid with its mass, sizes and axis: `rod(m, length, axis)`, `disk(m, radius, axis)`, `ring(m, radius, axis)`,
///   `cylinder(m, radius, height, axis)`, `tube(m, inner, outer, height, axis)`, `cone(m, radius, height, axis)`,
///   `capsule(m, radius, height, axis)`, `sphere(m, radius)`, `shell(m, radius)`, `cuboid(m, a, b, c)`,
///   `plate(m, a, b)` (in the plane of x and y), `ellipsoid(m, a, b, c)`;
/// - `diagonal(a, b, c)`, or a symmetric matrix `[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]`;
/// - any of these `.rotated(z(angle), …)`.
///
/// `about = vector` beside a matrix or `diagonal(…)` says that the inertia is about another point of the body than the centre of
/// mass, m, `about = 0` its origin: from it `m (|d|² 1 − d dᵀ)` is subtracted, of the vector `d` from there to the centre of mass.
///
/// The body's frame is placed by the joint that carries it; without one by `at = vector` and `frame = f`, expressions of
/// coordinates and time; `massive` beside them says that it moves so whatever its mass, which is not asked for.
///
/// Errors: an inertia that no body can have (a principal moment that is negative or larger than the sum of the others) does
/// not compile if it is given by numbers; a body that nothing carries does not either.
#[doc(alias = "link")]
#[doc(alias = "inertia")]
pub enum Body {}

/// Point mass: a mass at a point, without extent.
///
/// `#[particle(mass = m, at = body.at(vector))]`: mass, kg, and the point that carries it, m. It adds its mass and
/// inertia to the body and brings no degree of freedom. With a joint, `#[joint(ground -> bob, …)]`, it is carried by that
/// instead of `at`.
#[doc(alias = "point mass")]
pub enum Particle {}

derivable! { Body Particle }
