//! First-order states: lags of engines and actuators, filters.

use crate::derivatives::ByMotion;
use crate::{Derivatives, Mechanism, Real};
use nalgebra::{SMatrix, SVector};

mod derivatives;
mod extended;
mod outputs;

pub use extended::Extended;
pub use outputs::OutputsByStates;

/// Mechanism with `NX` first-order states, [`State`](crate::elements::State), in addition to its
/// configuration and velocity.
///
/// `#[mechanism]` implements the trait. States are fields of the struct: the functions of the mechanism use
/// the values of these fields, and have the same signatures as for any mechanism.
/// [`extended`](Self::extended) returns the mechanism with its states among the velocities, for integration
/// and linearisation; `NE` is `NV + NX`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no states of first order",
    note = "`#[state(rate = expression)] level: State` declares one"
)]
pub trait FirstOrder<const NQ: usize, const NV: usize, const NU: usize, const NX: usize, const NE: usize>:
    Mechanism<NQ, NV, NU> + Sized
{
    /// Names of the first-order states.
    const STATES: [&'static str; NX];
    /// Unit of every state, in the format of [`Mechanism::VELOCITY_UNITS`](crate::Mechanism::VELOCITY_UNITS).
    const STATE_UNITS: [&'static str; NX] = [""; NX];

    /// Returns the current states, each in its own unit.
    fn states(&self) -> SVector<Self::Scalar, NX>;

    /// Returns the mechanism with the values `x` of its first-order states.
    fn with_states(&self, x: &SVector<Self::Scalar, NX>) -> Self;

    /// Returns the rates of the states, in their units per second, at time `t` (which matters only if a
    /// function of the mechanism depends on it).
    fn state_rates(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NX>;

    /// Returns [`acceleration_derivatives`](crate::integrate::Hooks::acceleration_derivatives) of the
    /// mechanism with its states as the last velocities; the states stored in the struct have no effect.
    /// `None` without [`FirstOrderDerivatives`].
    fn extended_derivatives(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NE>,
        _u: &SVector<Self::Scalar, NU>,
    ) -> Option<ByMotion<Self::Scalar, NE, NU>> {
        None
    }

    /// Returns the mechanism with its states as the last velocities, for integration methods, controllers and
    /// linear systems: `v` is `[v, x]`, and `v̇` consists of the accelerations, then the rates of the states.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// /// A rocket sled whose thrust lags behind the throttle.
    /// #[mechanism]
    /// struct Sled {
    ///     mass: f64,
    ///     lag: f64,
    ///     throttle: Input,
    ///     #[state(rate = (throttle - thrust) / lag)]
    ///     thrust: State,
    ///     #[body(mass = mass)]
    ///     sled: Body,
    ///     #[joint(ground -> sled, along = x)]
    ///     rail: Sleeve,
    ///     #[acts(on = rail, value = thrust)]
    ///     engine: Force,
    /// }
    ///
    /// let sled = Sled { mass: 2.0, lag: 0.5, thrust: 0.0 };
    /// let whole = sled.extended();
    /// let run = simulate(&whole).from([0.0], [0.0, sled.thrust]).inputs(|_, _, _| [6.0].into());
    /// let end = run.duration(1.0).finish()?;
    /// let late = (-1.0_f64 / 0.5).exp();
    /// assert!((end.v[1] - 6.0 * (1.0 - late)).abs() < 1e-6);
    /// assert!((end.v[0] - 3.0 * (1.0 - 0.5 * (1.0 - late))).abs() < 1e-6);
    /// # Ok::<(), Error>(())
    /// ```
    fn extended(&self) -> Extended<'_, Self, NV, NX, NE> {
        const { assert!(NE == NV + NX, "velocities and states are as many as the type says") };
        Extended::new(self)
    }
}

/// Derivatives of the dynamics with respect to first-order states, and derivatives of the rates of these
/// states. `#[mechanism(…, derivatives)]` implements the trait for mechanisms with first-order states and
/// without constraints.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no derivatives by states of first order",
    note = "enable them with the option: `#[mechanism(…, derivatives)]`; mechanisms with constraints have \
            none"
)]
pub trait FirstOrderDerivatives<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NX: usize,
    const NE: usize,
>: FirstOrder<NQ, NV, NU, NX, NE> + Derivatives<NQ, NV, NU>
{
    /// Returns the derivatives of the rates of the first-order states
    /// ([`state_rates`](FirstOrder::state_rates)).
    fn state_rate_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> RateDerivatives<Self::Scalar, NV, NU, NX>;

    /// Returns `∂τ/∂x`, the derivative of [`inverse_dynamics`](Mechanism::inverse_dynamics) with respect to
    /// the first-order states `x`.
    fn inverse_dynamics_by_states(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SMatrix<Self::Scalar, NV, NX>;

    /// Returns `∂v̇/∂x`, the derivative of [`forward_dynamics`](Mechanism::forward_dynamics) with respect to
    /// the first-order states `x`.
    fn forward_dynamics_by_states(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> SMatrix<Self::Scalar, NV, NX>;

    /// Returns `∂τ/∂x`, the derivative of the [`generalized_forces`](Mechanism::generalized_forces) of the
    /// inputs with respect to the first-order states `x`.
    fn generalized_forces_by_states(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SMatrix<Self::Scalar, NV, NX>;
}

/// Derivatives of the rates of `NX` first-order states. Column `i` of `by_q` is the derivative along `q ⊕ ε
/// eᵢ`, in body axes for ball and free joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateDerivatives<T, const NV: usize, const NU: usize, const NX: usize> {
    /// Derivative of the rates of the first-order states with respect to the configuration, per m and rad.
    pub by_q: SMatrix<T, NX, NV>,
    /// Derivative of the rates of the first-order states with respect to the velocity, per m/s and rad/s.
    pub by_v: SMatrix<T, NX, NV>,
    /// Derivative of the rates of the first-order states with respect to these states, 1/s between states of
    /// the same unit.
    pub by_x: SMatrix<T, NX, NX>,
    /// Derivative of the rates of the first-order states with respect to the inputs.
    pub by_u: SMatrix<T, NX, NU>,
}

impl<T: Real, const NV: usize, const NU: usize, const NX: usize> RateDerivatives<T, NV, NU, NX> {
    /// Returns the derivatives of state rates that are all zero.
    pub fn zeros() -> Self {
        Self {
            by_q: SMatrix::zeros(),
            by_v: SMatrix::zeros(),
            by_x: SMatrix::zeros(),
            by_u: SMatrix::zeros(),
        }
    }
}

/// Returns the columns of a matrix with the given indices; columns that do not exist are zero.
pub fn columns<T: Real, const R: usize, const C: usize, const N: usize>(
    all: &SMatrix<T, R, C>,
    which: [usize; N],
) -> SMatrix<T, R, N> {
    SMatrix::from_fn(|i, j| {
        let column = which.get(j).copied().unwrap_or(C);
        all.get((i, column)).copied().unwrap_or(T::zero())
    })
}
