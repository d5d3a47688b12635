//! Integrators: [`DormandPrince`], [`DormandPrince8`], [`Rodas`], [`Rk4`], [`ImplicitMidpoint`], [`Rosenbrock`], [`SemiImplicitEuler`], [`TimeStepping`], [`EventDriven`].
//!
//! | method | order | step | for |
//! | --- | --- | --- | --- |
//! | [`DormandPrince`] | 5 | adaptive | the default: accuracy on request, dense output |
//! | [`DormandPrince8`] | 8 | adaptive | tight tolerances: orbits, references |
//! | [`Rodas`] | 4 | adaptive | stiff mechanisms, accuracy on request |
//! | [`Rk4`] | 4 | fixed | real time, a known cost per step |
//! | [`ImplicitMidpoint`] | 2 | fixed | long runs: energy and momenta do not drift |
//! | [`Rosenbrock`] | 2 | fixed | stiff springs and dashpots: stable with any step |
//! | [`SemiImplicitEuler`] | 1 | fixed | games and learning: one evaluation per step |
//! | [`TimeStepping`] | 2, with impacts 1 | fixed | [contacts](crate::contact) that open and close |
//! | [`EventDriven`] | 8 | adaptive | few contacts, every event located |
//!
//! [`simulate`](crate::simulate()) runs them: `.method(Rk4::step(1e-3))`. A method of your own implements [`Method`]; the other
//! types here are what it works with.
//!
//! The state is (t, q, v). Within a step a method works in the tangent space at the step's start: `φ` with
//! `q = q₀ ⊕ φ`, so `φ̇ = tangent_rate(φ, v)` and `v̇ = forward_dynamics(q, v, τ)`. Quaternions therefore stay unit
//! and every method keeps its order for ball and free joints (Runge–Kutta–Munthe-Kaas methods: Hairer, Lubich and
//! Wanner, *Geometric Numerical Integration* (2006), IV.8).

mod adaptive;
mod constrained;
mod control;
mod dormand_prince;
mod eighth;
mod error;
mod event_driven;
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
pub use implicit_midpoint::ImplicitMidpoint;
pub use path::{Path, Step};
pub use rk4::Rk4;
pub use rodas::Rodas;
pub use rosenbrock::Rosenbrock;
pub use semi_implicit_euler::SemiImplicitEuler;
pub use system::{ContinuousInputs, Dynamics, Inputs, NoInputs, SampledInputs, System};
pub use time_stepping::TimeStepping;
pub(crate) use time_stepping::{guided, holding};

use crate::Real;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::SVector;

/// Where a mechanism is: time, s, configuration and velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T, const NQ: usize, const NV: usize> {
    /// Time, s.
    pub t: T,
    /// Configuration, `NQ` numbers in the mechanism's order.
    pub q: SVector<T, NQ>,
    /// Velocity, `NV` numbers in the mechanism's order.
    pub v: SVector<T, NV>,
}

impl<T: Real, const NQ: usize, const NV: usize> State<T, NQ, NV> {
    /// The state, or [`Error::NotFinite`] if any of its numbers is infinite or NaN.
    pub(crate) fn finite(self) -> Result<Self, Error> {
        let finite = self.t.is_finite() && is_finite(&self.q) && is_finite(&self.v);
        if finite { Ok(self) } else { Err(Error::NotFinite { t: to_f64(self.t) }) }
    }
}

/// The end of a step, brought onto the constraints that it has drifted off; [`Error::NotFinite`] and
/// [`Error::Constraint`] name the start `t`.
pub(crate) fn settled<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    end: State<T, NQ, NV>,
    t: T,
) -> Result<State<T, NQ, NV>, Error> {
    let t = to_f64(t);
    let end = end.finite().map_err(|_| Error::NotFinite { t })?;
    if !system.is_constrained() {
        return Ok(end);
    }
    let (q, v) = system.project(end.t, &end.q, &end.v).map_err(|reason| Error::Constraint { t, reason })?;
    Ok(State { q, v, ..end })
}

/// What invalidates things that a method remembers from the step before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jump {
    /// The inputs changed at once; the state did not.
    Inputs,
    /// The state (and perhaps the inputs) changed at once.
    State,
}

/// A one-step method.
///
/// The method itself holds what the user sets (step, tolerance); what it carries from step to step is `Memory`.
pub trait Method<T: Real> {
    /// What one step hands to the next.
    type Memory<const NV: usize>: Clone + core::fmt::Debug;

    /// Whether steps must end on sample times; otherwise samples are interpolated.
    const FIXED: bool;

    /// Whether steps take part in impacts and friction of [contacts](crate::contact) that open and close.
    const CONTACTS: bool = false;

    /// Whether events at contacts are located, which needs the mechanism itself ([`Dynamics::follow`]).
    const LOCATES: bool = false;

    /// Whether the settings make sense: [`Error::InvalidStep`] names the first that does not.
    fn check(&self) -> Result<(), Error>;

    /// Memory at the start of a run.
    fn memory<const NV: usize>(&self) -> Self::Memory<NV>;

    /// Forgets what no longer holds after a jump of the inputs or the state.
    fn disturb<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump);

    /// One step from `start`, ending at `until` at the latest and exactly there if at all. With `dense` the
    /// [`Step`] interpolates to the method's order (or order 3), without it perhaps only linearly.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] where the dynamics are, and the method's own.
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

/// The largest magnitude of the entries.
fn largest<T: Real, const N: usize>(x: &SVector<T, N>) -> T {
    x.iter().fold(T::zero(), |largest, x| largest.max(x.abs()))
}

/// `Ok` for finite numbers that are not negative, otherwise [`Error::InvalidStep`] with the name of the setting.
pub(crate) fn not_negative<T: Real>(name: &'static str, value: T) -> Result<(), Error> {
    if value == T::zero() { Ok(()) } else { positive(name, value) }
}

/// `Ok` for finite positive numbers, otherwise [`Error::InvalidStep`] with the name of the setting.
pub(crate) fn positive<T: Real>(name: &'static str, value: T) -> Result<(), Error> {
    if value.is_finite() && value > T::zero() {
        Ok(())
    } else {
        Err(Error::InvalidStep { name, value: to_f64(value) })
    }
}

/// The first of equal steps, none longer than `longest` by more than a millionth, that end exactly on `until`: its length
/// and its end.
///
/// # Errors
///
/// [`Error::StepTooSmall`] if the step is lost in the rounding of `t`.
fn equal_step<T: Real>(longest: T, t: T, until: Option<T>) -> Result<(T, T), Error> {
    let (h, end) = match until {
        None => (longest, t + longest),
        Some(until) => {
            let remaining = until - t;
            // Rounding of the times must not cost one more step.
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
