//! Linearisation of mechanisms: their motion to first order as a [`StateSpace`].
//!
//! ```
//! use linkwork::prelude::*;
//! use linkwork_design::mechanism::linear_system;
//!
//! #[mechanism(gravity = -9.81 * y, derivatives)]
//! struct Pendulum {
//!     #[body(mass = 2, com = -0.5 * y)]
//!     bob: Body,
//!     #[joint(ground -> bob, about = z)]
//!     hinge: Pin,
//!     #[acts(on = hinge)]
//!     motor: Torque,
//! }
//!
//! let system = linear_system(&Pendulum {}, &[0.0].into(), &[0.0].into(), &[0.0].into())?;
//! assert_eq!(system.states()[1].name, "hinge'");
//! assert!((system.modes()?[0].frequency() - (9.81_f64 / 0.5).sqrt()).abs() < 1e-12);
//! # Ok::<(), linkwork_design::Error>(())
//! ```
//!
//! A mechanism with prescribed motions is linearised at one instant: pass `&at(&mechanism, t)`. Mechanisms
//! without constraints are linearised by [`linear_system`]. For mechanisms with constraints,
//! [`constrained_system`] converts the result of their `linearize` method, in independent coordinates.
//! [`measured_system`] adds outputs; about a steady state of a constrained mechanism, use
//! [`Trim::measured_system`](crate::steady::Trim::measured_system).

use crate::{Error, SecondOrderForm, Signal, StateSpace};
use linkwork::constraint::Linearization;
use linkwork::{Derivatives, LinearMotion, Mechanism, OutputDerivatives, OutputJacobians, Scleronomic};
use nalgebra::{DMatrix, SMatrix, SVector};

/// Converts a statically sized matrix to a dynamically sized one.
fn dynamically_sized_matrix<const R: usize, const C: usize>(m: &SMatrix<f64, R, C>) -> DMatrix<f64> {
    DMatrix::from_fn(R, C, |i, j| m[(i, j)])
}

/// Returns the block matrix `[[a, b], [c, d]]`.
fn block_matrix(rows: [[&DMatrix<f64>; 2]; 2]) -> DMatrix<f64> {
    let [[a, b], [c, d]] = rows;
    let mut m = DMatrix::zeros(a.nrows() + c.nrows(), a.ncols() + b.ncols());
    m.view_mut((0, 0), a.shape()).copy_from(a);
    m.view_mut((0, a.ncols()), b.shape()).copy_from(b);
    m.view_mut((a.nrows(), 0), c.shape()).copy_from(c);
    m.view_mut((a.nrows(), a.ncols()), d.shape()).copy_from(d);
    m
}

/// Returns signals with names and units. The unit is empty for dimensionless and undetermined quantities.
pub(crate) fn signals_with_units(names: &[&'static str], units: &[&'static str]) -> Vec<Signal> {
    let printed_unit = |unit: &'static str| if matches!(unit, "any" | "1") { "" } else { unit };
    let unit_of_signal = |k: usize| units.get(k).copied().map_or("", printed_unit);
    names.iter().enumerate().map(|(k, name)| Signal::new(*name, unit_of_signal(k))).collect()
}

/// Returns the displacement signal of a velocity signal, with the unit integrated over time.
fn displacement_signal(speed: Signal) -> Signal {
    let unit = match speed.unit.strip_suffix("/s") {
        Some(unit) => unit.to_owned(),
        None if speed.unit.is_empty() => String::new(),
        None => format!("{}·s", speed.unit),
    };
    Signal { unit, ..speed }
}

/// Returns the displacement signals of some of a mechanism's velocities.
pub(crate) fn displacement_signals<M, const NQ: usize, const NV: usize, const NU: usize>(
    which: impl IntoIterator<Item = usize>,
) -> Vec<Signal>
where
    M: Mechanism<NQ, NV, NU>,
{
    let speeds = signals_with_units(&M::VELOCITIES, &M::VELOCITY_UNITS);
    which.into_iter().filter_map(|k| speeds.get(k).cloned().map(displacement_signal)).collect()
}

/// Returns the names and units of the states: displacements with the names of the velocities, then changes of
/// velocity with a prime, then states of first order with their own names.
pub(crate) fn signals_of_states<M, const NQ: usize, const NV: usize, const NU: usize>(
    coordinates: impl IntoIterator<Item = usize>,
    speeds: impl IntoIterator<Item = usize>,
) -> Vec<Signal>
where
    M: Mechanism<NQ, NV, NU>,
{
    let all = signals_with_units(&M::VELOCITIES, &M::VELOCITY_UNITS);
    let changes = speeds.into_iter().filter_map(|k| {
        let speed = all.get(k)?.clone();
        let is_state = k + M::FIRST_ORDER >= NV;
        Some(if is_state { speed } else { Signal { name: format!("{}'", speed.name), ..speed } })
    });
    displacement_signals::<M, NQ, NV, NU>(coordinates).into_iter().chain(changes).collect()
}

/// Returns the names of the accelerations: the names of the velocities with two primes, or with one prime for
/// first-order states.
pub(crate) fn acceleration_names<M, const NQ: usize, const NV: usize, const NU: usize>() -> Vec<String>
where
    M: Mechanism<NQ, NV, NU>,
{
    let derivative_marks = |k: usize| if k + M::FIRST_ORDER >= NV { "'" } else { "''" };
    M::VELOCITIES.iter().enumerate().map(|(k, name)| format!("{name}{}", derivative_marks(k))).collect()
}

/// Returns the names and units of the inputs of a mechanism.
pub(crate) fn input_signals<M, const NQ: usize, const NV: usize, const NU: usize>() -> Vec<Signal>
where
    M: Mechanism<NQ, NV, NU>,
{
    signals_with_units(&M::INPUTS, &M::INPUT_UNITS)
}

/// Returns the indices of the states in the list of all displacements and velocities. First-order states have
/// no displacement.
fn state_indices(nv: usize, first_order: usize) -> Vec<usize> {
    (0..nv.saturating_sub(first_order)).chain(nv..2 * nv).collect()
}

/// Linearises the motion of a mechanism without constraints about a state under the inputs `u`, as
/// `ẋ = A x + B δu`. The first states are the displacements (in body axes for ball and free joints), with the
/// names of the velocities. The changes of velocity follow, named with a prime, then states of first order
/// with their own names. The outputs are the states; units are those that the compiler infers. For a
/// mechanism with states of first order, pass `&at(&m.extended(), t)`.
///
/// In a mechanism with constraints, displacements are not independent. The system then has two additional
/// zero eigenvalues for each holonomic constraint; the system of
/// [`Trim::linear_system`](crate::steady::Trim::linear_system) does not have them.
///
/// ```
/// use linkwork::prelude::*;
/// use linkwork_design::mechanism::linear_system;
///
/// /// A cart whose motor follows the command with a lag.
/// #[mechanism(derivatives)]
/// struct Cart {
///     lag: f64,
///     command: Input,
///     #[state(rate = (command - push) / lag)]
///     push: State,
///     #[body(mass = 2)]
///     cart: Body,
///     #[joint(ground -> cart, along = x)]
///     rail: Sleeve,
///     #[acts(on = rail, value = push)]
///     motor: Force,
/// }
///
/// let cart = Cart { lag: 0.5, push: 0.0 };
/// let system = linear_system(&at(&cart.extended(), 0.0), &[0.0].into(), &[0.0, 0.0].into(), &[0.0].into())?;
/// assert_eq!(system.states()[2].name, "push");
/// assert_eq!(system.transfer_function("rail", "command")?.to_string(), "1 / (s³ + 2 s²)");
/// # Ok::<(), linkwork_design::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::NotFinite`] if the mass matrix is singular.
pub fn linear_system<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    u: &SVector<f64, NU>,
) -> Result<StateSpace, Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + Scleronomic,
{
    let motion = m.linear_motion(q, v, u);
    let n = M::FIRST_ORDER;
    let system = state_space_of_linear_motion(&motion, n)?;
    let system = system.with_states(signals_of_states::<M, NQ, NV, NU>(0..NV.saturating_sub(n), 0..NV))?;
    Ok(system.with_inputs(input_signals::<M, NQ, NV, NU>())?.with_states_as_outputs())
}

fn state_space_of_linear_motion<const NV: usize, const NU: usize>(
    motion: &LinearMotion<f64, NV, NU>,
    first_order: usize,
) -> Result<StateSpace, Error> {
    let identity = DMatrix::identity(NV, NV);
    let a = block_matrix([
        [&dynamically_sized_matrix(&motion.turning), &identity],
        [&dynamically_sized_matrix(&motion.by_q), &dynamically_sized_matrix(&motion.by_v)],
    ]);
    let mut b = DMatrix::zeros(2 * NV, NU);
    b.view_mut((NV, 0), (NV, NU)).copy_from(&dynamically_sized_matrix(&motion.by_u));
    let kept = state_indices(NV, first_order);
    let (a, b, n) = (a.select_rows(&kept).select_columns(&kept), b.select_rows(&kept), kept.len());
    StateSpace::new(a, b, DMatrix::identity(n, n), DMatrix::zeros(n, NU))
}

/// Linearises the motion with the declared outputs of the mechanism, as `y = C x + D δu`. The outputs are
/// evaluated at the time `t`.
///
/// ```
/// use linkwork::prelude::*;
/// use linkwork_design::mechanism::measured_system;
///
/// /// A cart with an accelerometer.
/// #[mechanism(derivatives)]
/// struct Cart {
///     #[body(mass = 2)]
///     cart: Body,
///     #[joint(ground -> cart, along = x)]
///     rail: Sleeve,
///     #[acts(on = rail, stiffness = 8)]
///     spring: Spring,
///     #[acts(on = rail)]
///     push: Force,
///     #[output(dot(a(cart / ground / ground), x))]
///     accelerometer: Scalar,
/// }
///
/// let system = measured_system(&Cart {}, 0.0, &[0.0].into(), &[0.0].into(), &[0.0].into())?;
/// // (s²) / (2 s² + 8): the force acts directly on the accelerometer.
/// assert!((system.d()[(0, 0)] - 0.5).abs() < 1e-15);
/// assert_eq!(system.transfer_function("accelerometer", "push")?.to_string(), "0.5 s² / (s² + 4)");
/// # Ok::<(), linkwork_design::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::NotFinite`] if the mass matrix is singular.
pub fn measured_system<M, const NQ: usize, const NV: usize, const NU: usize, const NY: usize>(
    m: &M,
    t: f64,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    u: &SVector<f64, NU>,
) -> Result<StateSpace, Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + OutputDerivatives<NQ, NV, NU, NY, Scalar = f64> + Scleronomic,
{
    let motion = m.linear_motion(q, v, u);
    let seen = m.output_derivatives(t, q, v, &motion.acceleration, u).in_motion(&motion);
    let n = M::FIRST_ORDER;
    let system = state_space_of_linear_motion(&motion, n)?;
    let (c, d) = output_matrices(&seen);
    let system = StateSpace::new(system.a, system.b, c.select_columns(&state_indices(NV, n)), d)?;
    let system = system.with_states(signals_of_states::<M, NQ, NV, NU>(0..NV.saturating_sub(n), 0..NV))?;
    system
        .with_inputs(input_signals::<M, NQ, NV, NU>())?
        .with_outputs(signals_with_units(&M::OUTPUTS, &M::OUTPUT_UNITS))
}

fn output_matrices<const NY: usize, const NV: usize, const NU: usize>(
    seen: &OutputJacobians<f64, NY, NV, NU>,
) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut c = DMatrix::zeros(NY, 2 * NV);
    c.view_mut((0, 0), (NY, NV)).copy_from(&dynamically_sized_matrix(&seen.by_q));
    c.view_mut((0, NV), (NY, NV)).copy_from(&dynamically_sized_matrix(&seen.by_v));
    (c, dynamically_sized_matrix(&seen.by_u))
}

/// Converts the result of `linearize` of a mechanism with constraints to a system in independent coordinates
/// and velocities. The outputs are the states. Only the type of the mechanism is used, for the names.
///
/// ```
/// use linkwork::prelude::*;
/// use linkwork_design::mechanism::constrained_system;
///
/// /// A bead on a parabola.
/// #[mechanism(gravity = -9.81 * y, derivatives)]
/// struct Bead {
///     #[body(mass = 1)]
///     bead: Body,
///     #[joint(ground -> bead, along = (x, y))]
///     place: Stage,
///     #[constraint(place.y == place.x * place.x)]
///     wire: Holonomic,
/// }
///
/// let linear = Bead {}.linearize(&[0.0, 0.0].into(), &[0.0, 0.0].into(), &[].into(), &[0])?;
/// let system = constrained_system(&Bead {}, &linear)?;
/// assert_eq!(system.states()[0].name, "place.x");
/// assert!((system.modes()?[0].frequency() - (2.0_f64 * 9.81).sqrt()).abs() < 1e-12);
/// # Ok::<(), linkwork_design::Error>(())
/// ```
///
/// # Errors
///
/// [`Error::NotFinite`].
pub fn constrained_system<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NX: usize,
    const NP: usize,
    const NS: usize,
>(
    _mechanism: &M,
    linear: &Linearization<f64, NX, NU, NP, NS>,
) -> Result<StateSpace, Error>
where
    M: linkwork::Mechanism<NQ, NV, NU, Scalar = f64>,
{
    let (a, b) = (dynamically_sized_matrix(&linear.a), dynamically_sized_matrix(&linear.b));
    let system = StateSpace::new(a, b, DMatrix::identity(NX, NX), DMatrix::zeros(NX, NU))?;
    let states =
        signals_of_states::<M, NQ, NV, NU>(linear.coordinates.iter().copied(), linear.speeds.iter().copied());
    Ok(system.with_states(states)?.with_inputs(input_signals::<M, NQ, NV, NU>())?.with_states_as_outputs())
}

/// Returns the effective mass matrix, which multiplies the accelerations: the mass matrix, or the derivative
/// of inverse dynamics with respect to accelerations if forces depend on accelerations.
pub(crate) fn effective_mass_at_state<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: f64,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
) -> DMatrix<f64>
where
    M: Mechanism<NQ, NV, NU, Scalar = f64>,
{
    if !M::FEEDBACK || M::CONSTRAINED {
        return dynamically_sized_matrix(&Mechanism::mass_matrix(m, t, q));
    }
    let at_rest = Mechanism::inverse_dynamics(m, t, q, v, &SVector::zeros());
    let mut mass = DMatrix::zeros(NV, NV);
    for k in 0..NV {
        let unit = SVector::from_fn(|i, _| if i == k { 1.0 } else { 0.0 });
        let column = Mechanism::inverse_dynamics(m, t, q, v, &unit) - at_rest;
        mass.column_mut(k).copy_from(&column);
    }
    mass
}

/// Returns the second-order form of the linearised motion about a state:
/// `M δq̈ + (D + G) δq̇ + (K + N) δq = B δu`.
///
/// `M` is the effective mass matrix: the mass matrix minus the derivative of the forces with respect to the
/// accelerations. With acceleration-dependent forces it need not be symmetric. For a mechanism with
/// constraints about a steady state, use [`Trim::second_order_form`](crate::steady::Trim::second_order_form).
///
/// # Errors
///
/// [`Error::NotFinite`]; [`Error::Count`] for a mechanism with states of first order, which have no
/// second-order form.
pub fn second_order_form<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    u: &SVector<f64, NU>,
) -> Result<SecondOrderForm, Error>
where
    M: Derivatives<NQ, NV, NU, Scalar = f64> + Scleronomic,
{
    const { assert!(!M::CONSTRAINED, "a mechanism with constraints: call `second_order_form` of its trim") };
    if M::FIRST_ORDER > 0 {
        let what = "states of first order";
        return Err(Error::Count { what, expected: 0, found: M::FIRST_ORDER });
    }
    let motion = m.linear_motion(q, v, u);
    let mass = effective_mass_at_state(m, 0.0, q, v);
    let (by_q, by_v) = (dynamically_sized_matrix(&motion.by_q), dynamically_sized_matrix(&motion.by_v));
    let turning = dynamically_sized_matrix(&motion.turning);
    // δv = δq̇ − T δq; hence δv̇ = δq̈ − T δq̇ about a steady motion.
    let velocity = -(&mass * (&by_v + &turning));
    let position = -(&mass * (&by_q - &by_v * &turning));
    let input = &mass * dynamically_sized_matrix(&motion.by_u);
    let form = SecondOrderForm::new(mass, velocity, position, input)?;
    form.with_names(displacement_signals::<M, NQ, NV, NU>(0..NV), input_signals::<M, NQ, NV, NU>())
}
