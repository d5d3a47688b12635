//! Elements of the language that declare points, frames, coordinates, first-order states and named
//! expressions.

/// Generalized coordinate without a joint.
///
/// A field `theta: Coordinate` without attribute. Frames, points, particles and bodies may be placed by
/// expressions of it; its rate is `rate(theta)`. Its unit follows from its use.
pub enum Coordinate {}

/// Frame axes without an origin, rotated by expressions.
///
/// `#[frame(start, z(psi), x(theta), eigenaxis(n, angle))]`: starts with the axes of a body, another frame or
/// `ground` and rotates successively about body-fixed axes, by expressions of coordinates, parameters and
/// time. `name.x` is one of its axes.
///
/// The first rotation may follow from a vector or a curve, in the axes of the start:
/// - `cylindrical(vector)`: x along the vector across the z axis of the start, z that axis;
/// - `spherical(vector)`: x along the vector, y across the z axis of the start, by the right hand about it, z
///   towards its pole;
/// - `frenet(curve, s)`: x along the tangent of a curve, a vector that depends on the coordinate `s`, y along
///   its normal, z along its binormal (Frenet and Serret).
///
/// On the axis, and where a curve is straight, these directions do not exist, and values are not finite.
///
/// A body rotated by three such coordinates is in gimbal lock if two of their axes are parallel: the mass
/// matrix is then singular, and accelerations are not finite.
pub enum Frame {}

/// Point on a body, or placed by an expression.
///
/// `#[point(on = body, at = vector)]`: fixed in a body, or at a vector from another point; without `on`, from
/// the ground's origin. The vector may contain coordinates and time. Joints and force elements may act there,
/// and the point's name identifies a frame with a placement, velocity and Jacobian. Its axes are those of the
/// body or point relative to which it is placed.
pub enum Point {}

/// First-order state: the lag of an engine or an actuator, a filter.
///
/// `#[state(rate = expression)] power: State`: a number that changes at this rate, an expression of states,
/// coordinates, velocities, inputs, parameters and time; not of accelerations. The state is a field of the
/// struct, of the mechanism's scalar type, and all functions of the mechanism use its value. Any expression
/// may contain it. Its unit is inferred from its use; the unit of the rate is that per second. The generated
/// function `power_rate` is the rate.
///
/// [`FirstOrder::extended`](crate::FirstOrder::extended) is the mechanism with its states among its
/// velocities, for integration and linearisation. If inertia depends on a state, methods that propagate
/// momenta (the implicit midpoint rule, semi-implicit Euler) treat it as constant within a step.
pub enum State {}

/// Equilibrium about which the linearised equations of motion are printed.
///
/// `#[equilibrium(hinge = pi, motor = 0)] upright: Equilibrium`: values of coordinates, inputs and
/// first-order states, as numbers or expressions of the parameters. Unnamed values are zero; the orientations
/// of [`Ball`](super::Ball) and [`Free`](super::Free) joints are the identity. Motion driven at constant
/// rates counts as rest, such as that of a bead at a constant angle on a spinning hoop. Several may be
/// declared.
///
/// The documentation of the struct, and `LINEAR_EQUATIONS` with one text for each of `EQUILIBRIA`, contain
/// the equations of motion to first order, `M ξ̈ + C ξ̇ + K ξ = B u + Jᵀ λ`, in the parameters of the
/// mechanism, together with the linearised constraints and first-order states. The deviations `ξ` are those
/// of coordinates, and for `Ball` and `Free` small rotations (rad) and displacements (m) in body axes. Up to
/// three velocities and degree seven, they come with the characteristic equation, the natural frequency
/// (rad/s) of a single degree of freedom and the stability conditions: the Routh–Hurwitz criterion with
/// damping, distinct imaginary roots without (Gantmacher, *The Theory of Matrices*, vol. 2, 1959, ch. XV).
///
/// A configuration that is not an equilibrium does not compile, and the message names the unbalanced force;
/// nor does an equilibrium at which a force is not differentiable.
pub enum Equilibrium {}

/// Generalized speed (Kane's `u`): a velocity defined by the user, which replaces a joint velocity.
///
/// `#[speed(expression)] p: Speed`: a combination of velocities that is linear in them, with coefficients of
/// coordinates and parameters: `rate(psi) * sin(theta) * sin(phi) + rate(theta) * cos(phi)`, `dot(omega(body
/// / ground), body.x)`. The number of declared speeds must equal the number of joint velocities that occur in
/// them. The speeds replace these velocities in `v`, in order, in all functions and in the printed equations;
/// other joint velocities are unchanged. Any expression may contain a speed. The matrix of the combinations
/// must be invertible except in isolated configurations: where it is singular (Euler angles at `sin(theta) =
/// 0`), the rates computed from the speeds are not finite.
///
/// The functions `rates_of_speeds` and `speeds_of_rates` convert between both. Derivatives with respect to
/// `q` are along `integrate(q, dv)`, which moves all joints with the joint velocities that correspond to the
/// speeds `dv` at `q`.
///
/// Declared speeds differ from the independent speeds of `formulation = speeds`, which are a subset of the
/// joint velocities of a constrained mechanism. Source: Kane and Levinson, *Dynamics: Theory and
/// Applications* (1985), § 2.12.
pub enum Speed {}

/// Named scalar expression.
///
/// `#[define(…)]`: for use in other expressions. `#[output(…)]`: a generated function of that name, with
/// `name_jacobian`, its derivatives with respect to the velocities (those of its rate if it contains no
/// velocities).
pub enum Scalar {}

/// Named vector expression.
///
/// `#[define(…)]`: for use in other expressions. `#[output(…, resolved_in = frame)]`: a generated function of
/// that name, its components in the axes of a body or frame (default the ground's), with `name_jacobian`.
pub enum Vector {}

/// Named matrix expression: a linear map of vectors.
///
/// `#[define(…)]`: for use in other expressions. `#[output(…, resolved_in = frame)]`: a generated function of
/// that name, a 3×3 matrix of its components in the axes of a body or frame (default the ground's). Matrices
/// are
/// - `projector(n)`, the projection onto the line along a vector, `n nᵀ / n·n`;
/// - `skew(a)`, the cross product: `skew(a) * b` is `cross(a, b)`;
/// - `outer(a, b)`, `a bᵀ`;
/// - `rotation(B / A)`, which rotates the axes of the frame A into those of B: `Σ bₖ aₖᵀ`;
/// - `inertia(body / point)`, kg·m², of several bodies `inertia((first, second) / point)`;
/// - `identity()`, rows in the current axes `[[a, b, c], …]`, sums, products, `transpose(M)`, and `rate(M /
///   frame)`, the rate as seen from a frame.
///
/// `M * v` is a vector, `trace(M)` a scalar. Outputs of matrices have no `_jacobian` and no derivatives, and
/// are not among [`Outputs`](crate::Outputs).
#[doc(alias = "tensor")]
#[doc(alias = "dyadic")]
pub enum Matrix {}

/// Free-body diagram: all forces and torques on a body.
///
/// `#[output(body, resolved_in = frame)]`: a generated function of that name that returns a
/// [`Diagram`](crate::free_body::Diagram): gravity, force elements, inputs, joints and constraints, each with
/// its name, its point of application (relative to the centre of mass, m), its force (N) and its torque about
/// that point (N·m), in the axes of a body or frame (default the ground's). The function takes `(&q, &v)`, or
/// `(&q, &v, &u)` for mechanisms with inputs, and computes the actions from the resulting motion.
///
/// The joint forces follow from virtual work. The total force and torque of a joint are one action, at the
/// origin of the joint's frame, including the motors, springs and dashpots on its coordinates; a
/// [`Free`](super::Free) joint transmits no force. An element that acts at one point is applied there; other
/// elements are applied at the centre of mass, with their torque about it. Particles and bodies fixed to the
/// body by `at` are part of it; a body attached by a joint, including a [`Weld`](super::Weld), is separate.
/// A body that is placed by `at` or `frame` instead of a joint has an action `NAME.place`: the force and
/// torque of what places it.
pub enum FreeBody {}

derivable! { Coordinate Frame Point State Equilibrium Speed Scalar Vector Matrix FreeBody }
