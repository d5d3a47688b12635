//! Elements of the language that declare springs, dashpots, other forces, inputs and energies.

/// Spring, linear or with any force law, on a coordinate, between two points, or on a length.
///
/// `#[acts(on = joint, stiffness = k, free_length = l0)]` on one coordinate of a joint: force `−k (q − l0)`.
/// The stiffness is in N/m along a [`Sleeve`](super::Sleeve), in N·m/rad about a [`Pin`](super::Pin), where
/// the free length is `free_angle = a0`; both are zero by default. One coordinate of a joint with several is
/// selected by name: `on = collar.slide`. `#[acts(between = (a, b), stiffness = k, free_length = l0)]`
/// between two points of bodies: a tensile force `k (l − l0)` along their distance `l`, m. Instead of a
/// stiffness, any law may be specified: `energy = …`, J, or a polynomial `force = …`, N, of `stretch`. `on =
/// expression` acts on any length or angle defined by an expression of coordinates, `q` in the formulas
/// above: a rope over a third point, `norm(r(a / b)) + norm(r(b / c))`, a `cable` around a drum. Its energy
/// adds to the potential energy. If points coincide that do not move along one line, the force has no
/// direction and is zero. Conservative.
pub enum Spring {}

/// Damper (viscous friction) on a coordinate or between two points.
///
/// `#[acts(on = joint, damping = c)]` on one coordinate of a joint: force `−c v`, with `c` in N·s/m along a
/// [`Sleeve`](super::Sleeve), in N·m·s/rad about a [`Pin`](super::Pin). One coordinate of a joint with
/// several is selected by name: `on = collar.turn`. `#[acts(between = (a, b), damping = c)]` between two
/// points of bodies: it resists the rate of their distance. Instead of `damping`, any law `force = …` of
/// `speed` may be specified. Dissipative.
#[doc(alias = "damper")]
#[doc(alias = "viscous")]
#[doc(alias = "damping")]
pub enum Dashpot {}

/// Inerter: a force proportional to the relative acceleration of its ends; also models the rotor of a geared
/// motor.
///
/// `inertance = b`, kg, or kg·m² on an angle: the force `−b v̇` on a coordinate, or along the distance of two
/// points. `#[acts(on = joint, inertance = b)]` on a coordinate: `b` adds to its entry of the mass matrix.
/// The rotor of a geared motor has `inertance = rotor_inertia * ratio * ratio`. `#[acts(between = (a, b),
/// inertance = b)]` between two points of bodies. Stores the kinetic energy `½ b v²`. Source: Smith,
/// *Synthesis of Mechanical Networks: The Inerter* (2002).
#[doc(alias = "rotor inertia")]
#[doc(alias = "reflected inertia")]
#[doc(alias = "armature")]
pub enum Inerter {}

/// External force (actuator, thruster): an input, one entry of `u`, N, or a force with the value of an
/// expression.
///
/// - `#[acts(on = sleeve)]`: along a joint's coordinate, on the child, and opposite on the parent.
/// - `#[acts(on = body.at(point), along = direction)]`: at a point of a body (its origin if none is named)
///   along a unit vector.
/// - `#[acts(between = (p, q))]`: along the line through two points, equal and opposite on both. A positive
///   force pushes them apart (a hydraulic cylinder), a negative one pulls (a cable, a muscle). The direction
///   is undefined if the points coincide.
/// - `#[acts(on = expression)]`: on a length defined by an expression of coordinates; a positive force
///   increases the length: `on = cable(arm.at(x) / ground, drum.cylinder(radius, z))`.
///
/// The input has the field's name; inputs are in the order of declaration. With `value = expression` it is
/// not an input; the expression is a scalar on a coordinate or between two points, and a vector on a body or
/// point.
#[doc(alias = "actuator")]
#[doc(alias = "cylinder")]
#[doc(alias = "thruster")]
#[doc(alias = "input")]
pub enum Force {}

/// External torque (motor, couple): an input, one entry of `u`, N·m, or a torque with the value of an
/// expression.
///
/// - `#[acts(on = pin)]`: about a joint's axis, on the child, and opposite on the parent: a motor.
/// - `#[acts(on = body, about = direction)]`: on a body about a unit vector.
///
/// The input has the field's name; inputs are in the order of declaration. With `value = expression` it is
/// not an input; the expression is a scalar on a coordinate, and a vector on a body.
#[doc(alias = "motor")]
#[doc(alias = "couple")]
#[doc(alias = "input")]
pub enum Torque {}

/// Dry (Coulomb, Stribeck) and viscous friction on a coordinate.
///
/// `#[acts(on = joint, coulomb = fc, stiction = fs, stribeck_speed = vs, viscous = c, speed = v0)]`: the
/// force `(fc + (fs − fc) exp(−(v / vs)²)) tanh(v / v0) + c v` against the velocity `v`; N, or N·m on an
/// angle. Only `coulomb` is required; `speed` is the regularisation, default 0.01 m/s or rad/s. Dissipative.
#[doc(alias = "Coulomb")]
#[doc(alias = "Stribeck")]
#[doc(alias = "stiction")]
pub enum Friction {}

/// Gravitational attraction of masses, such as planets.
///
/// Uniform gravity is an argument of the attribute instead: `#[mechanism(gravity = -9.81 * y)]`.
///
/// - `#[acts(between = (a, b), constant = G)]`: between two particles or bodies, with `G` in m³/(kg·s²).
/// - `#[acts(between = (center, body), mu = mu)]`: towards a point, with the gravitational parameter in
///   m³/s².
///
/// A body with inertia is also subject to the gravity-gradient torque, to second order in the ratio of its
/// size to the distance (MacCullagh's formula). The attraction acts at the origins of bodies, which must be
/// their centres of mass. Conservative. Infinite at zero distance.
pub enum Gravity {}

/// Attraction between two points by the inverse square of their distance, such as of charges.
///
/// `#[acts(between = (a, b), strength = k)]`: an attractive force `k / r²`, with `k` in N·m²; negative for
/// repulsion. Conservative. Infinite at zero distance.
pub enum Attraction {}

/// Input for use in expressions: one entry of `u`.
///
/// A field `elevator: Input` without attribute, for use in the values of forces and torques. Its unit follows
/// from its use.
pub enum Input {}

/// Potential energy defined by an expression.
///
/// `#[energy(k / 2 * theta * theta)]`, J: an expression of coordinates and time. The forces are its negative
/// derivatives with respect to the coordinates.
pub enum Potential {}

/// Rayleigh dissipation function defined by an expression.
///
/// `#[dissipation(c / 2 * rate(theta) * rate(theta))]`, W: an expression `R` of coordinates and rates. The
/// dissipative forces are its negative derivatives with respect to the velocities. A quadratic one dissipates
/// `2 R`.
#[doc(alias = "dissipation")]
pub enum Rayleigh {}

derivable! { Spring Dashpot Inerter Force Torque Friction Gravity Attraction Input Potential Rayleigh }
