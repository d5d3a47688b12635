//! Places, coordinates, states, and names for expressions.

/// Generalized coordinate that belongs to no joint.
///
/// A field `theta: Coordinate` without attribute. Frames, points, particles and
/// bodies may be placed by expressions of it; its rate is `rate(theta)`. Its unit follows from its use.
pub enum Coordinate {}

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
/// expressions of the parameters. What is not named is zero; orientations of [`Ball`](super::Ball) and [`Free`](super::Free) are those of the axes beside
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

/// Free-body diagram: all that acts on a body at once.
///
/// `#[output(body, resolved_in = frame)]`: a generated function of that name that gives a
/// [`Diagram`](crate::free_body::Diagram): gravity, force elements, inputs, joints and constraints, each with its name, the point
/// where it acts (from the centre of mass, m), its force (N) and its torque about that point (N·m), in the axes of a body or frame
/// (the ground's if not given). It takes `(&q, &v)`, and `(&q, &v, &u)` where the mechanism has inputs, and follows from the motion.
///
/// The body is freed of its joints, by virtual work. What a joint transmits is one action, at the origin of the joint's frame, with
/// the motors, springs and dashpots on its own coordinates in it; a [`Free`](super::Free) joint transmits nothing. A force of an
/// element that acts at one point stands there; other elements stand at the centre of mass, with their torque about it. Particles
/// and bodies that are fixed on the body by `at` belong to it; what a joint holds, a [`Weld`](super::Weld) too, is another body.
/// Mechanisms with contacts that open and close have no free-body diagrams, and neither have bodies that are placed by `at` or
/// `frame` instead of a joint.
pub enum FreeBody {}

derivable! { Coordinate Frame Point State Equilibrium Speed Scalar Vector Matrix FreeBody }
