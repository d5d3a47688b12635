//! Elements of the language that declare constraints, contacts and limits.

/// Limits of a coordinate, its velocity and the generalized force on it, for controllers and planners;
/// optionally stops.
///
/// `#[limit(on = joint, from = low, to = high, max_speed = s, max_effort = f)]`: on a joint with one degree
/// of freedom, on `joint.coordinate` or on a `Coordinate`; the minimum and the maximum value, m or rad, the
/// maximum magnitude of the velocity, m/s or rad/s, and of the generalized force, N or N·m; each is optional,
/// a number or an expression of the parameters. The trait [`Limits`](crate::Limits) returns the limits as
/// vectors, and has functions that clamp. Several limits of one coordinate, including those of a file, apply
/// together. A limit exerts no force. With `restitution`, the ratio of the velocities after and before an
/// impact, both bounds are stops: contacts named `name.from` and `name.to` ([`contact`](crate::contact)).
///
/// A stop may be on an expression of coordinates and time as well, m: `on = norm(r(bob / peg)), to = length`
/// is a rope, `on = left + right` a rope over a massless pulley, `on = r1 * input + r2 * output, from =
/// -play, to = play` gear teeth with backlash. At a bound, the expression must have a nonzero gradient; a
/// distance has no gradient where it is zero.
///
/// Errors: numbers of which the lower is above the upper, and negative magnitudes, do not compile.
#[doc(alias = "joint limit")]
#[doc(alias = "range")]
pub enum Limit {}

/// Constraint on coordinates.
///
/// An expression of coordinates and time that must be zero, `#[constraint(expression)]`, or two that must be
/// equal, `#[constraint(norm(r(tip / base)) = length)]`. Scalars or vectors: rods, gears (`#[constraint(small
/// = -ratio * large)]`), points on curves and surfaces.
///
/// A joint whose child is already placed by another joint closes a loop and needs no constraint of this kind.
pub enum Holonomic {}

/// Constraint on velocities, such as of a skate or a knife edge.
///
/// An expression, linear in the velocities, that must be zero, or two that must be equal:
/// `#[constraint(dot(v(skate / ground / ground), sled.y) = 0)]`. Terms of coordinates and time alone may be
/// added.
pub enum Nonholonomic {}

/// Rolling without slip of two surfaces in contact.
///
/// `#[constraint(rolls(disk.circle(radius, y), ground.plane(z)))]`.
///
/// A surface belongs to a body or to one of its points, `body.at(vector).plane(normal)`, which is the
/// surface's centre, its apex or a point on it. Both bodies may move.
///
/// | rolling surface | on | inside |
/// | --- | --- | --- |
/// | `sphere(radius)` | `plane(normal)`, `sphere(radius)`, `cylinder(radius, axis)`, `cone(half_angle, axis)` | `bowl(radius)`, `tube(radius, axis)`, `funnel(half_angle, axis)` |
/// | `circle(radius, axis)`, the sharp rim of a disk | `plane(normal)` | |
/// | `torus(radius, tube_radius, axis)`, a tyre; `radius` is that of the tube's centre line | `plane(normal)` | |
/// | `ellipsoid(a, b, c)`, semi-axes along the body's axes | `plane(normal)` | |
/// | `cone(half_angle, axis)` | `plane(normal)`, `cone(half_angle, axis)` | `funnel(half_angle, axis)` |
/// | all of these but the cone | `surface(u, w, point)` | |
///
/// A plane's normal points towards the rolling body, a cone's axis from the apex into the cone, a funnel's
/// from the apex to its opening; a half angle is that between axis and surface, rad.
///
/// Contacts at a point have three constraints: `contact.normal` and two tangents; their multipliers are the
/// normal force and the friction, N. Cones touch along a line, and none of its points slips: the apexes
/// remain coincident (on a plane the apex is fixed: `contact.normal` and two tangents; else `contact.x`,
/// `.y`, `.z`), and the relative rotation of the cones is about the line alone. That adds `contact.tilt`,
/// whose multiplier is the moment of the pressure about the apex, and `contact.spin`, the moment of friction
/// about the normal, N·m. To roll only the rim of a cone or of a disk, use `circle`.
///
/// A surface of any other shape is defined by its points: `surface(u, w, u * x + w * y + height * z)` with
/// two coordinates of the struct, `u: Coordinate` and `w: Coordinate`, and a vector that depends on them and
/// on parameters. The cross product of its derivatives with respect to `u` and `w`, in this order, points
/// towards the rolling body. The contact point is then part of the configuration: `u` and `w` need no
/// inertia, and the constraints `contact.foot_first` and `contact.foot_second`, which transmit no force,
/// determine them; compute them from a guess with `assemble` or `project_configuration`. Each contact needs
/// its own coordinates. The surface must be smooth, less concave than the rolling body is convex, and regular
/// in its coordinates (no poles); `mass_matrix` is singular, as `u` and `w` move nothing. For a particle on a
/// surface, a [`Holonomic`] constraint on its coordinates suffices.
///
/// The constraint is bilateral: the surfaces remain in contact even if the normal force (`contact.normal`,
/// positive in compression) is negative and real bodies would separate.
pub enum Rolling {}

/// Sliding with dry friction of two surfaces in contact.
///
/// `#[constraint(slips(ball.sphere(radius), lane.plane(z)), friction = mu, speed = v0)]`.
///
/// The surfaces are those of [`Rolling`] with point contact, and the constraint is bilateral as well: the
/// single constraint is `contact.normal`, and its multiplier is the normal force `N`, positive in
/// compression. At the slip `s`, the velocity of the first surface at the contact relative to the other one,
/// friction is `−μ |N| s / √(|s|² + v₀²)`: Coulomb's law, regularised at slip velocities around `speed`
/// (default 0.01 m/s, or the mechanism's option `friction_speed`). Bodies therefore creep instead of
/// sticking; the equations are the stiffer, the smaller `speed`. Friction also resists the slip under a
/// tensile normal force. `friction` may depend on coordinates and time; `friction = 0` means frictionless
/// surfaces.
///
/// The equations of motion are `M v̇ + h = τ + Jᵀ λ + Tᵀ |λ|`. If they have no unique solution, friction jams
/// (Painlevé's paradox): `try_constrained_dynamics` and `try_forward_dynamics` return
/// `ConstraintError::Jammed`, with which a simulation ends; the functions without a `Result` return NaN. The
/// power dissipated by this friction is not included in `dissipated_power`, which does not depend on
/// multipliers; `power(contact)` in an output is its negative.
pub enum Slipping {}

/// Unilateral contact of two surfaces, which may separate, collide, slide, stick and roll.
///
/// `#[contact(ball.sphere(radius), ground.plane(z), friction = mu, restitution = e)]`.
///
/// A surface belongs to a body or to one of its points, as those of [`Rolling`]; a point of a body,
/// `foot.at(vector)`, is a surface, too. Both bodies may move.
///
/// | surface | on |
/// | --- | --- |
/// | a point, `sphere(radius)` | `plane(normal)`, `sphere(radius)`, `capsule(radius, length, axis)`, `cylinder(radius, axis)`, `cone(half_angle, axis)`; inside of `bowl(radius)`, `tube(radius, axis)`, `funnel(half_angle, axis)` |
/// | `capsule(radius, length, axis)`: two points, at its ends; `length` is between the centres of these | `plane(normal)` |
/// | `capsule(radius, length, axis)`: one point, where the axes are nearest | `capsule(radius, length, axis)` |
/// | `sphere(radius)` with its centre outside | `cuboid(a, b, c)` |
/// | `sphere(radius)` | `cylinder(radius, length, axis)`, `hull(points)` whose points are numbers |
/// | `cuboid(a, b, c)`, a box with these lengths along the body's axes: eight points, its corners | `plane(normal)` |
/// | `cuboid(a, b, c)`: thirteen points, of faces that look at each other where edges begin and end or are cut off, and of two edges that cross | `cuboid(a, b, c)` |
/// | `capsule(radius, length, axis)`: five points, the ends, where the sides of a face cut it off, and where it crosses an edge | `cuboid(a, b, c)` |
/// | `capsule(…)`: the ends, and the point nearest to the other axis | `cylinder(radius, axis)` |
/// | `capsule(…)`: five points of its axis | `cylinder(radius, length, axis)` |
/// | `cuboid(a, b, c)`: three points of a face and an edge | `cylinder(radius, axis)` |
/// | `cuboid(a, b, c)`: sixteen points of the rim and of edges | `cylinder(radius, length, axis)` |
/// | `hull(points)` or `hull("foot.stl")`, a convex hull: its vertices | `plane(normal)`, `terrain(height)` |
/// | `hull(points)`, `cuboid(a, b, c)`: at most twelve points of faces, and one of edges | `hull(points)` |
/// | `capsule(…)`, `cylinder(radius, axis)`: two points of a face, and one of edges | `hull(points)` |
/// | `cylinder(radius, length, axis)`: eight points | `cylinder(radius, length, axis)`, `hull(points)` |
/// | `cylinder(radius, axis)`: eight points | `cylinder(radius, length, axis)` |
/// | `cylinder(radius, length, axis)`, with two ends: eight points, of each rim the lowest and those a quarter turn away, which move as the points of the body that are there | `plane(normal)` |
/// | `circle(radius, axis)`, `torus(radius, tube_radius, axis)`, `ellipsoid(a, b, c)` | `plane(normal)` |
/// | a point, `sphere(radius)`, the ends of a `capsule(…)`, the corners of a `cuboid(…)` | `terrain(height)` |
///
/// The direction of largest separation determines the contact features of two boxes, or of a box and a
/// capsule. Contact points for other features have larger gaps than their distance, so that the smallest gap
/// is the distance of surfaces that nearly touch. Gaps and normals are discontinuous where the contact
/// features change: simulate such bodies with [`TimeStepping`](crate::integrate::TimeStepping), with steps of
/// a millisecond or less.
///
/// A hull in contact with hulls, boxes, capsules and unbounded cylinders has points that are numbers, and so
/// are the lengths of the box or the capsule. The smallest gap of their contact points is the distance of the
/// surfaces, or the negative of the depth of their penetration. Contact points that are not used have larger
/// gaps than any distance of the surfaces. These contacts are rigid. The same applies to cylinders with two
/// ends in contact with each other, with unbounded cylinders and with hulls: radii, lengths and axes are
/// numbers. Their depth of penetration is the smallest one for shallow overlaps, and may be that along
/// another direction for overlaps of a tenth of the size of the bodies. Contact points move along rims and
/// sides: rolling cylinders have the acceleration of smooth bodies.
///
/// The height of a terrain is an expression of `u` and `w`, the position along the body's x and y axes, and
/// of parameters: `ground.terrain(0.1 * sin(3 * u))`, or `ground.terrain(heights(u, w))` with a
/// [`Table`](crate::Table). The contact point of a sphere is computed by Newton's method from the point
/// vertically below its centre, so hollows must be wider than the sphere.
///
/// A plane bounds a half space; a cylinder without a length, a tube and a cone are unbounded. The contact
/// point of a circle or a torus that lies flat on a plane is at its centre.
///
/// The points of a hull are in the axes of the body, and not in one plane. A hull has from 4 to 32 vertices.
/// That of a mesh, an STL, OBJ or MSH file, has at most 32 vertices of the mesh. If the mesh has more, the
/// points farthest outside are used; the documentation of the mechanism states the largest distance of the
/// mesh from the hull. It is an error if this distance is larger than a tenth of the size. Points that depend
/// on parameters are all used.
///
/// `foot.collision()` is all collision geometry of the link `foot` in the file: spheres, boxes, cylinders,
/// capsules, and meshes as their hulls. `collision()` is that of every link: `#[contact(collision(),
/// ground.plane(z), friction = 0.8)]`.
///
/// `friction`, the coefficient of Coulomb friction, and `restitution`, the ratio of the separation velocity
/// to the approach velocity, are zero by default, and may be expressions of parameters. `restitution =
/// poisson(e)` is a ratio of impulses instead, of restitution and of compression
/// ([`Restitution`](crate::contact::Restitution)). Contacts are not constraints: the functions of the
/// dynamics are those of the mechanism without contacts, and the module [`contact`](crate::contact) adds
/// their effects.
///
/// `stiction = mu_s`, at least `friction`, is the coefficient of surfaces that do not slip: they stick up to
/// that part of the normal force, and slide with `friction`. Impacts take it where there is no slip before
/// them.
///
/// `torsional = a`, m, adds a moment of friction about the normal, of at most `a` times the normal force,
/// against the relative angular velocity about it: a ball that spins in place comes to rest. `rolling = b`,
/// m, adds a moment about the tangents, against rolling. Both moments stick below their maximum, as friction
/// does. The contact `name` is then followed by the contacts `name.spin` and `name.roll`, each with the gap
/// of `name` and with angular velocities as its contact velocities.
///
/// Surfaces may be compliant instead. With `stiffness = k`, N/m, the normal force is `k δ (1 + d δ̇)` at a
/// penetration `δ`, and with `hertz = k`, N/m^1.5, it is `k δ^1.5 (1 + d δ̇)`, as for round bodies.
/// `dissipation = d`, s/m, is zero by default; the normal force is never tensile (Hunt and Crossley, J. Appl.
/// Mech. 42, 1975). Friction is `μ` times the normal force, against the slip, regularised below the slip
/// velocity `speed = …`, default 1e-3 m/s; moments of friction are regularised where `a` times the angular
/// velocity is below it. Such a contact is a force element: it is included in forward and inverse dynamics,
/// energies and all derivatives, works with every integration method, and is not among `CONTACTS`.
///
/// The points of one declaration are named `name.0`, `name.1`, ….
pub enum Contact {}

derivable! { Limit Holonomic Nonholonomic Rolling Slipping Contact }
