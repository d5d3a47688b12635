//! Constraints, contacts and limits.

/// What a coordinate, its velocity and the generalized force on it stay within, for controllers and planners.
///
/// `#[limit(on = joint, from = low, to = high, max_speed = s, max_effort = f)]`: on a joint with one degree of freedom, on
/// `joint.coordinate` or on a `Coordinate`; the least and the largest value, m or rad, the largest magnitude of the velocity, m/s
/// or rad/s, and of the generalized force, N or N·m, each optional, numbers or expressions of the parameters. The trait
/// [`Limits`](crate::Limits) gives them as vectors, with functions that clamp. Several limits of one coordinate hold together, those
/// of a file too. A limit exerts no force, but with `restitution`, the part of its speed that a coordinate keeps when it strikes, both
/// bounds are stops: contacts named `name.from` and `name.to` ([`contact`](crate::contact)).
///
/// A stop may be on an expression of coordinates and time as well, m: `on = norm(r(bob / peg)), to = length` is a rope, `on = left + right`
/// one over a wheel without mass, `on = r1 * input + r2 * output, from = -play, to = play` teeth with play. Where a bound is struck the
/// expression needs a slope, which a distance has not where it is zero.
///
/// Errors: numbers of which the lower is above the upper, and negative magnitudes, do not compile.
#[doc(alias = "joint limit")]
#[doc(alias = "range")]
pub enum Limit {}

/// Constraint on coordinates.
///
/// An expression of coordinates and time that stays zero, `#[constraint(expression)]`, or
/// two that stay equal, `#[constraint(norm(r(tip / base)) = length)]`. Scalars or vectors: rods, gears
/// (`#[constraint(small = -ratio * large)]`), points on curves and surfaces.
///
/// A joint whose child has its place already closes a loop and needs no constraint of this kind.
pub enum Holonomic {}

/// Constraint on velocities, such as of a skate or a knife edge.
///
/// An expression, linear in the velocities, that stays zero, or two that stay equal:
/// `#[constraint(dot(v(skate / ground / ground), sled.y) = 0)]`. Terms of coordinates and time alone may be added.
pub enum Nonholonomic {}

/// Rolling without slip of two surfaces that touch.
///
/// `#[constraint(rolls(disk.circle(radius, y), ground.plane(z)))]`.
///
/// A surface belongs to a body or to one of its points, `body.at(vector).plane(normal)`, which is its centre, its apex or a
/// point of it. Both bodies may move.
///
/// | what rolls | on | inside of |
/// | --- | --- | --- |
/// | `sphere(radius)` | `plane(normal)`, `sphere(radius)`, `cylinder(radius, axis)`, `cone(half_angle, axis)` | `bowl(radius)`, `tube(radius, axis)`, `funnel(half_angle, axis)` |
/// | `circle(radius, axis)`, the sharp rim of a disk | `plane(normal)` | |
/// | `torus(radius, tube_radius, axis)`, a tyre; `radius` is that of the tube's centre line | `plane(normal)` | |
/// | `ellipsoid(a, b, c)`, semi-axes along the body's axes | `plane(normal)` | |
/// | `cone(half_angle, axis)` | `plane(normal)`, `cone(half_angle, axis)` | `funnel(half_angle, axis)` |
/// | all of these but the cone | `surface(u, w, point)` | |
///
/// A plane's normal points to what rolls on it, a cone's axis from the apex into the cone, a funnel's from the apex to its
/// opening; a half angle is that between axis and surface, rad.
///
/// Contacts at a point have three constraints: `contact.normal` and two tangents; their multipliers are the normal
/// force and the friction, N. Cones touch along a line, and none of its points slips: the apexes stay together (on a
/// plane the apex stays where it is: `contact.normal` and two tangents; else `contact.x`, `.y`, `.z`), and the cones
/// turn relative to each other about the line alone. That adds `contact.tilt`, whose multiplier is the moment of the
/// pressure about the apex, and `contact.spin`, the moment of friction about the normal, N·m. The rim of a cone, or of
/// a disk, that rolls by itself is a `circle`.
///
/// A surface of any other form is given by its points: `surface(u, w, u * x + w * y + height * z)` with two coordinates
/// of the struct, `u: Coordinate` and `w: Coordinate`, and a vector that depends on them and on parameters. Its
/// derivatives by `u` and by `w`, crossed in this order, point to what rolls. Where the bodies touch is then part of
/// the configuration: `u` and `w` need no inertia, and `contact.foot_first` and `contact.foot_second`, which carry no
/// force, keep them there; bring a guess onto them by `assemble` or `project_configuration`. Each contact has
/// coordinates of its own. The surface must be smooth, bent inwards less than what rolls, and regular in its
/// coordinates (no poles); `mass_matrix` is singular, as `u` and `w` move nothing. A particle on a surface needs none
/// of this: a [`Holonomic`] condition on its coordinates says it.
///
/// The surfaces are held together, also where the normal force (`contact.normal`, positive where they press) would be
/// negative and bodies would part.
pub enum Rolling {}

/// Sliding with dry friction of two surfaces that touch.
///
/// `#[constraint(slips(ball.sphere(radius), lane.plane(z)), friction = mu, speed = v0)]`.
///
/// The surfaces are those of [`Rolling`] that touch at a point, and are held together in the same way: the one
/// constraint is `contact.normal`, and its multiplier is the normal force `N`, positive where they press. At the slip
/// `s`, the velocity of the first surface at the contact relative to the other one, friction is
/// `−μ |N| s / √(|s|² + v₀²)`: Coulomb's law, made smooth at speeds around `speed` (0.01 m/s unless given here or for
/// the mechanism by `friction_speed`). So at rest the bodies creep instead of sticking; the smaller the speed, the
/// stiffer the motion. It resists the slip also where the surfaces are held together by a pull. `friction` may depend
/// on coordinates and time; with `friction = 0` the surfaces are smooth.
///
/// The equations of motion are `M v̇ + h = τ + Jᵀ λ + Tᵀ |λ|`. Where they have no unique solution, friction jams
/// (Painlevé's paradox): `try_constrained_dynamics` and `try_forward_dynamics` return `ConstraintError::Jammed`, with
/// which a simulation ends; the functions without a `Result` return NaN. What friction takes out is not part of
/// `dissipated_power`, which does not know the multipliers; `power(contact)` in an output is it, negative.
pub enum Slipping {}

/// Two surfaces that may part, strike, slide, stick and roll.
///
/// `#[contact(ball.sphere(radius), ground.plane(z), friction = mu, restitution = e)]`.
///
/// A surface belongs to a body or to one of its points, as those of [`Rolling`]; a point of a body is one by itself,
/// `foot.at(vector)`. Both bodies may move.
///
/// | surface | on |
/// | --- | --- |
/// | a point, `sphere(radius)` | `plane(normal)`, `sphere(radius)`, `capsule(radius, length, axis)`, `cylinder(radius, axis)`, `cone(half_angle, axis)`; inside of `bowl(radius)`, `tube(radius, axis)`, `funnel(half_angle, axis)` |
/// | `capsule(radius, length, axis)`: two points, at its ends; `length` is between the centres of these | `plane(normal)` |
/// | `capsule(radius, length, axis)`: one point, where the axes are nearest | `capsule(radius, length, axis)` |
/// | `sphere(radius)` with its centre outside | `cuboid(a, b, c)`, `cylinder(radius, length, axis)` |
/// | `cuboid(a, b, c)`, a box with these lengths along the body's axes: eight points, its corners | `plane(normal)` |
/// | `cuboid(a, b, c)`: thirteen points, of faces that look at each other where edges begin and end or are cut off, and of two edges that cross | `cuboid(a, b, c)` |
/// | `capsule(radius, length, axis)`: five points, the ends, where the sides of a face cut it off, and where it crosses an edge | `cuboid(a, b, c)` |
/// | `cylinder(radius, length, axis)`, with two ends: eight points, of each rim the lowest and those a quarter turn away, which move as the points of the body that are there | `plane(normal)` |
/// | `circle(radius, axis)`, `torus(radius, tube_radius, axis)`, `ellipsoid(a, b, c)` | `plane(normal)` |
/// | a point, `sphere(radius)`, the ends of a `capsule(…)`, the corners of a `cuboid(…)` | `terrain(height)` |
///
/// What two boxes, or a box and a capsule, touch with is said by the direction along which they are farthest apart. Points with
/// other features are farther away than where they are, so that least gaps are distances where surfaces nearly touch.
/// Gaps and normals jump where other features come to face each other: move such bodies by
/// [`TimeStepping`](crate::integrate::TimeStepping), with steps of a millisecond or less.
///
/// The height of a terrain is an expression of `u` and `w`, the place along the body's x and y, and of parameters:
/// `ground.terrain(0.1 * sin(3 * u))`, or `ground.terrain(heights(u, w))` with a [`Table`](crate::Table). Where a sphere touches
/// is found by Newton's method from straight below, so hollows are to be wider than the sphere.
///
/// A plane is that of a half space, and a cylinder without a length, a tube and a cone go on without end. The rim of a circle or a
/// torus that lies flat on a plane touches it by its centre.
///
/// `foot.collision()` stands for all collision geometry that the URDF file has of the link `foot`: spheres, boxes, cylinders and
/// capsules. `collision()` alone is that of every link: `#[contact(collision(), ground.plane(z), friction = 0.8)]`. Meshes are
/// an error; name surfaces that stand for them.
///
/// `friction`, the coefficient of Coulomb's friction, and `restitution`, the part of the speed of approach with which
/// surfaces leave each other, are zero unless given, and may be expressions of parameters. `restitution = poisson(e)` is a ratio of
/// impulses instead, of restitution and of compression ([`Restitution`](crate::contact::Restitution)). Contacts are no constraints: the
/// functions of the dynamics are those of bodies that move freely, and the module [`contact`](crate::contact) says what contacts do
/// to them.
///
/// `torsional = a`, m, adds a moment of friction about the normal, of at most `a` times the normal force, against the relative angular
/// velocity there: a ball that spins on the spot comes to rest. `rolling = b`, m, adds one about the tangents, against rolling. Both
/// hold where less is needed, as friction does. Beside `name` stand the contacts `name.spin` and `name.roll` then, each with the gap of
/// `name` and rates of turning alone.
///
/// Surfaces may yield instead: with `stiffness = k`, N/m, they press with `k δ (1 + d δ̇)` where they overlap by `δ`, and with
/// `hertz = k`, N/m^1.5, with `k δ^1.5 (1 + d δ̇)` as round bodies do. `dissipation = d`, s/m, is zero unless given; surfaces never
/// pull (Hunt and Crossley, J. Appl. Mech. 42, 1975). Friction is `μ` times that against the slip, and falls off below
/// `speed = …`, 1e-3 m/s unless given; moments of friction fall off where `a` times the angular velocity is below it. Such a contact is a force element: it is part of forward and inverse dynamics, energies and all
/// derivatives, moves with every method of integration, and is not among `CONTACTS`.
///
/// The points of one declaration are named `name.0`, `name.1`, ….
pub enum Contact {}

derivable! { Limit Holonomic Nonholonomic Rolling Slipping Contact }
