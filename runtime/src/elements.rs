//! Bodies, joints and forces: the types of the fields of a `#[mechanism]` struct.
//!
//! A field's type says what it is, its attribute how it is placed; [`mechanism`](macro@crate::mechanism) shows an example.
//! The compiler reads these types and removes the fields: there are no values of them.
//!
//! | what | types |
//! | --- | --- |
//! | bodies | [`Body`], [`Particle`] |
//! | joints with one degree of freedom | [`Pin`] (revolute), [`Sleeve`] (prismatic), [`Screw`] (helical) |
//! | joints with two | [`Collar`] (cylindrical), [`Slot`], [`Universal`], [`Stage`] |
//! | joints with three | [`Ball`] (spherical), [`Planar`], [`Stage`] |
//! | joints with six, with none | [`Free`] (floating), [`Weld`] (fixed) |
//! | force elements | [`Spring`], [`Dashpot`] (damper), [`Inerter`], [`Friction`], [`Gravity`], [`Attraction`] |
//! | inputs, and forces with a value | [`Force`], [`Torque`], [`Input`] |
//! | constraints | [`Holonomic`], [`Nonholonomic`], [`Rolling`], [`Slipping`] |
//! | contacts that open and close | [`Contact`] |
//! | bounds, stops | [`Limit`] |
//! | states of first order | [`State`] |
//! | configurations at rest | [`Equilibrium`] |
//! | places | [`Point`], [`Frame`], [`Coordinate`] |
//! | expressions | [`Scalar`], [`Vector`], [`Matrix`], [`Potential`], [`Rayleigh`], [`Speed`] |
//!
//! # Vectors and places
//!
//! In the attributes, vectors are written with the axes `x`, `y`, `z` of the frame that the attribute belongs to: the
//! body's own in `#[body(…)]` and `.at(…)`, the parent's for a joint's axis, the ground's for gravity. `cart.x` is an axis
//! of `cart`. Joints and force elements are attached to bodies, to the `ground`, or to places on them:
//! `body.at(l / 2 * y)`, or with axes of its own `body.at(l * x).rotated(z(angle), x(tilt))`; rotations are carried out in
//! order, each about an axis that the earlier ones have turned.
//!
//! # Joints
//!
//! A joint carries its child. A joint to a body that another one carries already closes a loop: it has no coordinate, and its
//! constraints are solved with multipliers, or with `#[mechanism(formulation = speeds)]` (or `independent = (joint, …)`) in
//! independent speeds. In a plane, a Pin that closes a loop between two bodies on Pins, or on a Pin and a Sleeve, may
//! say `branch = 1` or `branch = -1`: then its loop is solved in closed form, and the dependent coordinates drop out.
//! `reaction_force(joint)` and `reaction_torque(joint)` in an output are what the joint's parent exerts on its child.
//!
//! # Units
//!
//! Units are SI, angles in radians, or `degrees(90)`. Units of parameters are inferred: `mass = m` makes `m` a mass, `com = l / 2 * y` makes
//! `l` a length, and a parameter that would have to be two things at once is a compile error. A number has any unit:
//! `-9.81 * y` is an acceleration, `l + 0.1` a length. But ½, 2 or π beside a parameter are plain factors, and an expression
//! without parameters is held to nothing. `#[unit(N * m / rad)]` on a parameter says its unit where nothing else does. The
//! struct's documentation lists all.

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

/// Revolute joint (hinge) about one axis: one degree of freedom.
///
/// `#[joint(parent -> child, about = z)]`: the child turns about the axis, given in the parent's frame, through the
/// origins of both endpoints. The coordinate has the joint's name: the angle, rad; its velocity is the rate, rad/s,
/// positive by the right-hand rule. At zero both frames agree. Its generalized force is the torque about the axis, N·m. In URDF
/// files: `revolute` and `continuous`.
#[doc(alias = "revolute")]
#[doc(alias = "hinge")]
#[doc(alias = "continuous")]
pub enum Pin {}

/// Prismatic joint (slider) along one axis: one degree of freedom.
///
/// `#[joint(parent -> child, along = x)]`: the child moves along the axis, given in the parent's frame, without
/// turning. The coordinate has the joint's name: the displacement, m; its velocity, m/s. Its generalized force is the force
/// along the axis, N. In URDF files: `prismatic`; in MJCF: `slide`.
#[doc(alias = "prismatic")]
#[doc(alias = "slider")]
#[doc(alias = "sliding")]
pub enum Sleeve {}

/// Helical joint (screw): one degree of freedom.
///
/// `#[joint(parent -> child, about = z, lead = d)]`: the child turns about the axis and advances along it by `lead`
/// per turn, m, or by `pitch` per radian, m/rad; give one of the two, negative for a left-hand thread. The
/// coordinate has the joint's name: the angle, rad; its velocity, rad/s. Its generalized force is torque about the axis plus
/// pitch times force along it, N·m.
#[doc(alias = "helical")]
pub enum Screw {}

/// Cylindrical joint, along and about one axis: two degrees of freedom.
///
/// `#[joint(parent -> child, along = z)]`: the child slides along the axis and turns about it. Coordinates
/// `joint.slide`, m, and `joint.turn`, rad; velocities m/s and rad/s.
#[doc(alias = "cylindrical")]
pub enum Collar {}

/// Pin in a slot (half joint): two degrees of freedom.
///
/// `#[joint(parent -> child, along = x, about = z)]`: the child slides along one axis of the parent and turns about
/// another, perpendicular one that slides along. Coordinates `joint.slide`, m, and `joint.turn`, rad; velocities m/s
/// and rad/s.
#[doc(alias = "half joint")]
#[doc(alias = "pin in slot")]
pub enum Slot {}

/// Universal joint (Cardan, Hooke): two degrees of freedom.
///
/// `#[joint(parent -> child, about = (x, y))]`: the child turns about the first axis, fixed in the parent, then about
/// the second, carried by the first; the axes are perpendicular and intersect. Coordinates `joint.first` and
/// `joint.second`, rad; velocities are their rates, rad/s.
#[doc(alias = "Cardan")]
#[doc(alias = "Hooke")]
pub enum Universal {}

/// Spherical joint (ball and socket) about a point: three degrees of freedom.
///
/// `#[joint(parent -> child)]`: the origins of the endpoints coincide and the child turns freely. Configuration
/// `joint.qx`, `.qy`, `.qz`, `.qw`: the unit quaternion that turns child components into parent components. Velocity
/// `joint.wx`, `.wy`, `.wz`: the child's angular velocity relative to the parent, resolved in the child, rad/s, so
/// that NQ is one more than NV. Generalized forces are the torque on the child, resolved in the child, N·m.
#[doc(alias = "spherical")]
#[doc(alias = "ball and socket")]
#[doc(alias = "quaternion")]
pub enum Ball {}

/// Planar joint: two displacements and a turn in a plane, three degrees of freedom.
///
/// `#[joint(parent -> child, about = z)]`: the child slides in the plane perpendicular to the axis and turns about
/// it; or `along = (x, y)` names the two directions in the plane. Coordinates `joint.x` and `joint.y`, m, along the
/// parent's axes, and `joint.angle`, rad; velocities are their rates, m/s and rad/s.
#[doc(alias = "dual sleeve-pin")]
pub enum Planar {}

/// Cartesian joint (gantry), along two or three axes without turning: two or three degrees of freedom.
///
/// `#[joint(parent -> child, along = (x, y))]` or `along = (x, y, z)`. Coordinates `joint.x`, `joint.y` (and
/// `joint.z`), m, along the given axes of the parent; velocities are their rates, m/s.
#[doc(alias = "Cartesian")]
#[doc(alias = "gantry")]
#[doc(alias = "translational")]
pub enum Stage {}

/// Floating joint: no constraint between two bodies, six degrees of freedom.
///
/// `#[joint(ground -> body)]`. Configuration `joint.x`, `.y`, `.z`: the position in the parent's frame, m, then
/// `joint.qx`, `.qy`, `.qz`, `.qw`: the unit quaternion that turns child components into parent components. Velocity
/// `joint.vx`, `.vy`, `.vz`, m/s, then `joint.wx`, `.wy`, `.wz`, rad/s: linear velocity of the child's origin and
/// angular velocity relative to the parent, both resolved in the child. Generalized forces are force (N) and torque (N·m) on
/// the child at its origin, resolved in the child. In URDF files: `floating`, or the option `base = free`.
#[doc(alias = "floating")]
#[doc(alias = "free-flyer")]
#[doc(alias = "floating base")]
#[doc(alias = "quaternion")]
pub enum Free {}

/// Fixed joint, a rigid connection: no degree of freedom.
///
/// `#[joint(parent.at(vector).rotated(z(angle)) -> child)]`: the frames of both endpoints coincide, so the child's
/// mass and inertia add to the parent's.
#[doc(alias = "fixed")]
pub enum Weld {}

/// Spring, linear or by any law, on a coordinate, between two points, or on a length.
///
/// `#[acts(on = joint, stiffness = k, free_length = l0)]` on one coordinate of a joint: force `−k (q − l0)`. The
/// stiffness is in N/m along a [`Sleeve`], in N·m/rad about a [`Pin`], where the free length is `free_angle = a0`;
/// both are zero if not given. One coordinate of a larger joint is named: `on = collar.slide`.
/// `#[acts(between = (a, b), stiffness = k, free_length = l0)]` between two points of bodies: a pull `k (l − l0)` along
/// their distance `l`, m. Instead of a stiffness any law: `energy = …`, J, or a polynomial `force = …`, N, of `stretch`.
/// `on = expression` acts on any length or angle that an expression of coordinates gives, `q` in the formulas above: a rope
/// by way of a third point, `norm(r(a / b)) + norm(r(b / c))`, a `cable` around a drum.
/// Its energy adds to the potential energy. Where points meet that do not move along one line, the pull has no
/// direction and is zero. Conservative.
pub enum Spring {}

/// Damper (viscous friction) on a coordinate or between two points.
///
/// `#[acts(on = joint, damping = c)]` on one coordinate of a joint: force `−c v`, with `c` in N·s/m along a
/// [`Sleeve`], in N·m·s/rad about a [`Pin`]. One coordinate of a larger joint is named: `on = collar.turn`.
/// `#[acts(between = (a, b), damping = c)]` between two points of bodies: it resists the rate of their distance. Instead
/// of `damping` any law `force = …` of `speed`. Dissipative.
#[doc(alias = "damper")]
#[doc(alias = "viscous")]
#[doc(alias = "damping")]
pub enum Dashpot {}

/// Inerter: a force in proportion to the relative acceleration of its ends; also the rotor of a geared motor.
///
/// `inertance = b`, kg, on an angle kg·m²: the force `−b v̇` on a coordinate, or along the distance of two points.
/// `#[acts(on = joint, inertance = b)]` on a coordinate: `b` adds to its entry of the mass matrix. A motor's rotor behind
/// a gear is `inertance = rotor_inertia * ratio * ratio`. `#[acts(between = (a, b), inertance = b)]` between two points
/// of bodies. Stores the kinetic energy `½ b v²`. Source: Smith, *Synthesis of Mechanical Networks: The Inerter* (2002).
#[doc(alias = "rotor inertia")]
#[doc(alias = "reflected inertia")]
#[doc(alias = "armature")]
pub enum Inerter {}

/// Force (actuator, thruster) from outside: an input, one entry of `u`, N; or a force with a given value.
///
/// - `#[acts(on = sleeve)]`: along a joint's coordinate, on the child, and opposite on the parent.
/// - `#[acts(on = body.at(point), along = direction)]`: at a point of a body (its origin if none is named) along a
///   unit vector.
/// - `#[acts(between = (p, q))]`: along the line of two points, equal and opposite on both; positive, it pushes them apart
///   (a hydraulic cylinder), negative, it pulls (a cable, a muscle). It has no direction where they meet.
/// - `#[acts(on = expression)]`: on a length that an expression of coordinates gives, which it makes longer where it is positive:
///   `on = cable(arm.at(x) / ground, drum.cylinder(radius, z))`.
///
/// The input has the field's name; inputs are in the order of declaration. With `value = expression` it is no input: a
/// scalar on a coordinate or between two points, a vector on a body or point.
#[doc(alias = "actuator")]
#[doc(alias = "cylinder")]
#[doc(alias = "thruster")]
#[doc(alias = "input")]
pub enum Force {}

/// Torque (motor, couple) from outside: an input, one entry of `u`, N·m; or a torque with a given value.
///
/// - `#[acts(on = pin)]`: about a joint's axis, on the child, and opposite on the parent: a motor.
/// - `#[acts(on = body, about = direction)]`: on a body about a unit vector.
///
/// The input has the field's name; inputs are in the order of declaration. With `value = expression` it is no input: a
/// scalar on a coordinate, a vector on a body.
#[doc(alias = "motor")]
#[doc(alias = "couple")]
#[doc(alias = "input")]
pub enum Torque {}

/// Dry (Coulomb, Stribeck) and viscous friction on a coordinate.
///
/// `#[acts(on = joint, coulomb = fc, stiction = fs, stribeck_speed = vs, viscous = c, speed = v0)]`: the force
/// `(fc + (fs − fc) exp(−(v / vs)²)) tanh(v / v0) + c v` against the rate `v`; N, on an angle N·m. Only `coulomb` must be
/// given; `speed` is the regularisation, 0.01 m/s or rad/s if not given. Dissipative.
#[doc(alias = "Coulomb")]
#[doc(alias = "Stribeck")]
#[doc(alias = "stiction")]
pub enum Friction {}

/// Attraction of masses, as of planets.
///
/// Uniform gravity is an argument of the attribute instead: `#[mechanism(gravity = -9.81 * y)]`.
///
/// - `#[acts(between = (a, b), constant = G)]`: between two particles or bodies, with `G` in m³/(kg·s²).
/// - `#[acts(between = (center, body), mu = mu)]`: towards a point, with the gravitational parameter in m³/s².
///
/// A body with inertia also feels the gradient of gravity, to second order in its size over its distance (MacCullagh's
/// formula).
/// Bodies are attracted at their origins, which must be their centres of mass. Conservative. Infinite where they meet.
pub enum Gravity {}

/// Attraction between two points by the inverse square of their distance, such as of charges.
///
/// `#[acts(between = (a, b), strength = k)]`: a pull `k / r²`, with `k` in N·m²; negative for repulsion. Conservative.
/// Infinite where they meet.
pub enum Attraction {}

/// Generalized coordinate that belongs to no joint.
///
/// A field `theta: Coordinate` without attribute. Frames, points, particles and
/// bodies may be placed by expressions of it; its rate is `rate(theta)`. Its unit follows from its use.
pub enum Coordinate {}

/// Input for use in expressions: one entry of `u`.
///
/// A field `elevator: Input` without attribute, for use in the values of forces and torques. Its unit follows from its use.
pub enum Input {}

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

/// Axes without a place, turned by expressions.
///
/// `#[frame(start, z(psi), x(theta), eigenaxis(n, angle))]`: starts with the axes of a body, another frame or `ground`
/// and turns about carried axes, by expressions of coordinates, parameters and time. `name.x` is one of its axes.
///
/// The first rotation may follow from a vector or a curve, in the axes of the start:
/// - `cylindrical(vector)`: x along the vector across the z axis of the start, z that axis;
/// - `spherical(vector)`: x along the vector, y across the z axis of the start, by the right hand about it, z towards its pole;
/// - `frenet(curve, s)`: x along the tangent of a curve, a vector that depends on the coordinate `s`, y along its normal, z along
///   its binormal (Frenet and Serret).
///
/// On the axis, and where a curve is straight, these directions do not exist, and values are not finite.
///
/// A body that three such coordinates turn is in gimbal lock where two of their axes are in line: the mass matrix is
/// singular there, and accelerations are not finite.
pub enum Frame {}

/// Point on a body, or placed by an expression.
///
/// `#[point(on = body, at = vector)]`: fixed in a body, or at a vector from another point; without `on`, from the ground's
/// origin. The vector may contain coordinates and time. Joints and force elements may act there, and it has a
/// placement, velocity and Jacobian under its name. Its axes are those of what it is placed from.
pub enum Point {}

/// Potential energy given as an expression.
///
/// `#[energy(k / 2 * theta * theta)]`, J: an expression of coordinates and time. Its derivatives by the coordinates, with
/// opposite sign, are the forces.
pub enum Potential {}

/// Rayleigh dissipation function given as an expression.
///
/// `#[dissipation(c / 2 * rate(theta) * rate(theta))]`, W: an expression `R` of coordinates and rates, whose derivatives by
/// the velocities resist the motion. A quadratic one dissipates `2 R`.
#[doc(alias = "dissipation")]
pub enum Rayleigh {}

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
/// | `cylinder(radius, length, axis)`, with two ends: eight points, of each rim the lowest and those a quarter turn away | `plane(normal)` |
/// | `circle(radius, axis)`, `torus(radius, tube_radius, axis)`, `ellipsoid(a, b, c)` | `plane(normal)` |
/// | a point, `sphere(radius)`, the ends of a `capsule(…)`, the corners of a `cuboid(…)` | `terrain(height)` |
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
/// surfaces leave each other, are zero unless given, and may be expressions of parameters. Contacts are no constraints: the
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

/// State of first order: the lag of an engine or an actuator, a filter.
///
/// `#[state(rate = expression)] power: State`: a number that changes at this rate, an expression of states, coordinates, velocities,
/// inputs, parameters and time; not of accelerations. It stays a field of the struct, of the mechanism's type of numbers, and all
/// functions of the mechanism hold for the value there. Any expression may name it. Its unit follows from its use; the rate's is that
/// per second. The generated function `power_rate` is the rate.
///
/// [`FirstOrder::extended`](crate::FirstOrder::extended) is the mechanism with its states among its velocities, which is integrated
/// and linearised. Where inertia depends on a state, methods that carry momenta forward (the implicit midpoint rule, semi-implicit
/// Euler) hold it for constant within a step.
pub enum State {}

/// Configuration at rest about which the linear equations of motion are printed.
///
/// `#[equilibrium(hinge = pi, motor = 0)] upright: Equilibrium`: values of coordinates, inputs and states of first order, numbers or
/// expressions of the parameters. What is not named is zero; orientations of [`Ball`] and [`Free`] are those of the axes beside
/// them. Motion that is driven at constant rates counts as rest: a bead on a hoop that spins. Several may be declared.
///
/// The documentation of the struct, and `LINEAR_EQUATIONS` with one text for each of `EQUILIBRIA`, have the equations of motion to
/// first order, `M ξ̈ + C ξ̇ + K ξ = B u + Jᵀ λ`, in the parameters of the mechanism; those of constraints and of states of first
/// order stand beside them. The deviations `ξ` are those of coordinates, and for `Ball` and `Free` small rotations (rad) and
/// displacements (m) in body axes. Up to three velocities come with the characteristic equation, the natural frequency (rad/s) of
/// a single oscillation and the conditions of stability: those of Routh and Hurwitz where deviations are damped, distinct imaginary
/// roots where they are not (Gantmacher, *The Theory of Matrices*, vol. 2, 1959, ch. XV).
///
/// What is no equilibrium does not compile, and the message says which force is left; nor does one where a force has a corner.
pub enum Equilibrium {}

/// Generalized speed (Kane's `u`): a velocity of the user's choice in place of one that a joint has.
///
/// `#[speed(expression)] p: Speed`: a combination of velocities that is linear in them, with coefficients of coordinates and
/// parameters: `rate(psi) * sin(theta) * sin(phi) + rate(theta) * cos(phi)`, `dot(omega(body / ground), body.x)`. As many speeds are
/// declared as velocities occur in them all together: they take the places of these in `v`, in the order of both, in all functions
/// and in the printed equations, and other joints keep theirs. Any expression may name a speed. The matrix of the combinations must be
/// invertible, but for single configurations: where it is singular there (Euler angles at `sin(theta) = 0`), the rates that follow
/// from speeds are not finite.
///
/// The functions `rates_of_speeds` and `speeds_of_rates` lead from one to the other. Derivatives by `q` are along
/// `integrate(q, dv)`, which moves all joints by what the speeds `dv` stand for at `q`.
///
/// Speeds are not the independent speeds of `formulation = speeds`, which are velocities that are chosen among those
/// that there are where constraints bind them. Source: Kane and Levinson, *Dynamics: Theory and Applications* (1985), § 2.12.
pub enum Speed {}

/// Scalar expression with a name.
///
/// `#[define(…)]`: for use in other expressions. `#[output(…)]`: a generated function of
/// that name, with `name_jacobian`, its derivatives by the velocities (those of its rate if it contains none).
pub enum Scalar {}

/// Vector expression with a name.
///
/// `#[define(…)]`: for use in other expressions. `#[output(…, resolved_in = frame)]`: a
/// generated function of that name, its components in the axes of a body or frame (the ground's if not given), with
/// `name_jacobian`.
pub enum Vector {}

/// Matrix expression with a name: what takes vectors to vectors.
///
/// `#[define(…)]`: for use in other expressions. `#[output(…, resolved_in = frame)]`: a generated function of that name, a 3×3
/// matrix of its components in the axes of a body or frame (the ground's if not given). Matrices are
/// - `projector(n)`, the projection onto the line along a vector, `n nᵀ / n·n`;
/// - `skew(a)`, the cross product: `skew(a) * b` is `cross(a, b)`;
/// - `outer(a, b)`, `a bᵀ`;
/// - `rotation(B / A)`, which turns the axes of the frame A into those of B: `Σ bₖ aₖᵀ`;
/// - `inertia(body / point)`, kg·m², of several bodies `inertia((first, second) / point)`;
/// - `identity()`, rows in the axes at hand `[[a, b, c], …]`, sums, products, `transpose(M)`, and `rate(M / frame)`, the rate as seen
///   from a frame.
///
/// `M * v` is a vector, `trace(M)` a scalar. Outputs of matrices have no `_jacobian` and no derivatives, and are not among
/// [`Outputs`](crate::Outputs).
#[doc(alias = "tensor")]
#[doc(alias = "dyadic")]
pub enum Matrix {}

/// There are no values to clone, compare or show. A `#[derive(…)]` above `#[mechanism]` asks for that all the same: with
/// these it is told that it stands in the wrong place, and nothing else.
macro_rules! derivable {
    ($($element:ident)*) => { $(
        #[doc(hidden)]
        impl Clone for $element {
            fn clone(&self) -> Self {
                *self
            }
        }
        #[doc(hidden)]
        impl Copy for $element {}
        #[doc(hidden)]
        impl core::fmt::Debug for $element {
            fn fmt(&self, _: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                match *self {}
            }
        }
        #[doc(hidden)]
        impl PartialEq for $element {
            fn eq(&self, _: &Self) -> bool {
                match *self {}
            }
        }
        #[doc(hidden)]
        impl Eq for $element {}
    )* };
}

derivable! {
    Body Particle Pin Sleeve Screw Collar Slot Universal Ball Planar Stage Free Weld Spring Dashpot
    Inerter Force Torque Friction Gravity Attraction Coordinate Input Frame Point Potential Rayleigh
    State Equilibrium Limit Contact Holonomic Nonholonomic Rolling Slipping Scalar Speed Vector Matrix
}
