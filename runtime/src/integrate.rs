//! Integrators: [`DormandPrince`], [`DormandPrince8`], [`Rodas`], [`Rk4`], [`ImplicitMidpoint`],
//! [`Rosenbrock`], [`SemiImplicitEuler`], [`TimeStepping`], [`EventDriven`].
//!
//! | method | order | step | use |
//! | --- | --- | --- | --- |
//! | [`DormandPrince`] | 5 | adaptive | the default: error control, dense output |
//! | [`DormandPrince8`] | 8 | adaptive | tight tolerances: orbits, references |
//! | [`Rodas`] | 4 | adaptive | stiff mechanisms, error control |
//! | [`Rk4`] | 4 | fixed | real time, a known cost per step |
//! | [`ImplicitMidpoint`] | 2 | fixed | long runs: energy and momenta do not drift |
//! | [`Rosenbrock`] | 2 | fixed | stiff springs and dashpots: stable with any step |
//! | [`SemiImplicitEuler`] | 1 | fixed | games and learning: one evaluation per step |
//! | [`TimeStepping`] | 2, with impacts 1 | fixed | unilateral [contacts](crate::contact) |
//! | [`EventDriven`] | 8 | adaptive | few contacts, all events located |
//!
//! Pass a method to [`simulate`](crate::simulate()): `.method(Rk4::step(1e-3))`. User-defined methods
//! implement [`Method`]; the other types of this module are its arguments and results.
//!
//! The state is (t, q, v). Within a step a method works in the tangent space at the step's start: `φ` with `q
//! = q₀ ⊕ φ`, so `φ̇ = tangent_rate(φ, v)` and `v̇ = forward_dynamics(q, v, τ)`. Quaternions therefore remain
//! unit quaternions, and every method has its full order for ball and free joints (Runge–Kutta–Munthe-Kaas
//! methods: Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), IV.8).

mod adaptive;
mod constrained;
mod control;
mod dormand_prince;
mod eighth;
mod error;
mod event_driven;
mod hooks;
mod implicit_midpoint;
mod local;
mod path;
mod rk4;
mod rodas;
mod rosenbrock;
mod semi_implicit_euler;
mod stages;
mod system;
mod time_stepping;

pub use dormand_prince::DormandPrince;
pub use eighth::DormandPrince8;
pub use error::Error;
pub use event_driven::{EventDriven, EventMemory, Section};
#[doc(hidden)]
pub use hooks::{Features, Hooks};
pub use implicit_midpoint::ImplicitMidpoint;
pub use path::{Path, Step};
pub use rk4::Rk4;
pub use rodas::Rodas;
pub use rosenbrock::Rosenbrock;
pub use semi_implicit_euler::SemiImplicitEuler;
pub use system::{ContinuousInputs, Dynamics, Inputs, NoInputs, SampledInputs, System};
pub use time_stepping::TimeStepping;
pub(crate) use time_stepping::{acceleration_from_closed_contacts, rk4_step_with_contacts};

use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::SVector;

/// State of a mechanism: time, s, configuration and velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T, const NQ: usize, const NV: usize> {
    /// Time of the state, s.
    pub t: T,
    /// Configuration `q` of `NQ` numbers, in the order that the mechanism defines.
    pub q: SVector<T, NQ>,
    /// Velocity `v` of `NV` numbers, in the order that the mechanism defines.
    pub v: SVector<T, NV>,
}

impl<T: Real, const NQ: usize, const NV: usize> State<T, NQ, NV> {
    /// Returns the state, or [`Error::NotFinite`] if any of its numbers is infinite or NaN.
    pub(crate) fn finite_or_error(self) -> Result<Self, Error> {
        let finite = self.t.is_finite() && is_finite(&self.q) && is_finite(&self.v);
        if finite { Ok(self) } else { Err(Error::NotFinite { t: to_f64(self.t) }) }
    }
}

/// Projects the end of a step onto the constraints, which removes the drift of the step. [`Error::NotFinite`]
/// and [`Error::Constraint`] report the time `t` of the start.
pub(crate) fn project_end_of_step<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    end: State<T, NQ, NV>,
    t: T,
) -> Result<State<T, NQ, NV>, Error> {
    let t = to_f64(t);
    let end = end.finite_or_error().map_err(|_| Error::NotFinite { t })?;
    if !system.is_constrained() {
        return Ok(end);
    }
    let (q, v) = system.project(end.t, &end.q, &end.v).map_err(|reason| Error::Constraint { t, reason })?;
    Ok(State { q, v, ..end })
}

/// Discontinuity that invalidates the memory of a method from earlier steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jump {
    /// The inputs changed discontinuously, the state did not.
    Inputs,
    /// The state changed discontinuously, and possibly the inputs as well.
    State,
}

/// One-step integration method.
///
/// The method itself contains the user's settings (step, tolerance); `Memory` is its state between steps.
pub trait Method<T: Real> {
    /// Memory of the method: data that one step passes to the next.
    type Memory<const NV: usize>: Clone + core::fmt::Debug;

    /// Whether steps must end on sample times; otherwise samples are interpolated.
    const FIXED: bool;

    /// Whether steps treat impacts and friction of unilateral [contacts](crate::contact).
    const CONTACTS: bool = false;

    /// Whether contact events are located, which requires access to the mechanism itself
    /// ([`Dynamics::follow`]).
    const LOCATES: bool = false;

    /// Checks the settings of the method. Returns [`Error::InvalidStep`] for the first invalid setting.
    fn check(&self) -> Result<(), Error>;

    /// Returns the memory at the start of a run.
    fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV>;

    /// Returns the largest violation of the contact conditions since the last call, as a contact velocity,
    /// and forgets it; zero for methods that satisfy them or end with an error.
    fn take_violation<const NV: usize>(_memory: &mut Self::Memory<NV>) -> T {
        T::zero()
    }

    /// Discards the memory that a jump of the inputs or the state invalidates.
    fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump);

    /// Advances one step from `start`, not beyond `until`; a step that reaches `until` ends exactly there.
    /// With `dense` the [`Step`] interpolates to the method's order (or order 3), otherwise possibly only
    /// linearly.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] where the dynamics are not finite, and the method's own errors.
    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        memory: &mut Self::Memory<NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error>;
}

pub(crate) fn is_finite<T: Real, const N: usize>(x: &SVector<T, N>) -> bool {
    x.iter().all(|x| x.is_finite())
}

/// Returns the largest magnitude of the entries of a vector.
fn largest_magnitude<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    x.iter().fold(T::zero(), |largest, x| largest.max(x.abs()))
}

/// Checks that a setting is finite and not negative; otherwise returns [`Error::InvalidStep`] with the name
/// of the setting.
pub(crate) fn check_not_negative<T: Real>(name: &'static str, value: T) -> Result<(), Error> {
    if value == T::zero() { Ok(()) } else { check_positive(name, value) }
}

/// Checks that a setting is finite and positive; otherwise returns [`Error::InvalidStep`] with the name of
/// the setting.
pub(crate) fn check_positive<T: Real>(name: &'static str, value: T) -> Result<(), Error> {
    if value.is_finite() && value > T::zero() {
        Ok(())
    } else {
        Err(Error::InvalidStep { name, value: to_f64(value) })
    }
}

/// Returns the length and end of the first of equal steps that end exactly at `until`, each at most a
/// millionth longer than `longest`.
///
/// # Errors
///
/// [`Error::StepTooSmall`] if the step vanishes in the rounding of `t`.
fn equal_step_length_and_end<T: Real>(longest: T, t: T, until: Option<T>) -> Result<(T, T), Error> {
    let (h, end) = match until {
        None => (longest, t + longest),
        Some(until) => {
            let remaining = until - t;
            // Rounding of the times must not cause an additional step.
            let slack = constant::<T>(8.0) * epsilon::<T>() * (t.abs() + until.abs() + remaining) / longest;
            let slack = slack.max(constant(1e-6));
            let count = (remaining / longest - slack).ceil();
            if count > T::one() { (remaining / count, t + remaining / count) } else { (remaining, until) }
        }
    };
    if end > t { Ok((h, end)) } else { Err(Error::StepTooSmall { t: to_f64(t), h: to_f64(h) }) }
}

#[cfg(test)]
mod tests;
