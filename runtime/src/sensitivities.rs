//! Derivatives of the dynamics with respect to the parameters of the struct, for generic code:
//! identification, design, robust control.

use crate::integrate::{Error, TimeStepping};
use crate::{At, Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// Derivatives of the functions of a mechanism with respect to its `NP` parameters, one column per parameter.
/// `#[mechanism(…, sensitivities)]` implements the trait for mechanisms with parameters and without
/// constraints. Time `t`, s, matters only if a function depends on it.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no derivatives by parameters",
    note = "enable them with the option: `#[mechanism(…, sensitivities)]`; mechanisms without parameters and \
            those with constraints have none"
)]
pub trait Sensitivities<const NQ: usize, const NV: usize, const NU: usize, const NP: usize>:
    Mechanism<NQ, NV, NU>
{
    /// Names of the parameters of the mechanism, in the order of the columns of the derivatives.
    const PARAMETERS: [&'static str; NP];

    /// Returns `∂τ/∂p` of [`inverse_dynamics`](Mechanism::inverse_dynamics), N and N·m per unit of the
    /// parameter.
    fn inverse_dynamics_by_parameters(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SMatrix<Self::Scalar, NV, NP>;

    /// Returns `∂v̇/∂p` of [`forward_dynamics`](Mechanism::forward_dynamics), m/s² and rad/s² per unit of the
    /// parameter.
    fn forward_dynamics_by_parameters(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> SMatrix<Self::Scalar, NV, NP>;

    /// Returns `∂τ/∂p` of the inputs' [`generalized_forces`](Mechanism::generalized_forces), N and N·m per
    /// unit of the parameter.
    fn generalized_forces_by_parameters(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SMatrix<Self::Scalar, NV, NP>;

    /// Returns the derivatives of configuration and velocity after a step of time stepping with contacts with
    /// respect to the parameters, for [`discrete::by_parameters`](crate::discrete::by_parameters). Returns
    /// `None` for mechanisms without contacts, or without the option `derivatives`.
    #[doc(hidden)]
    #[allow(clippy::type_complexity, reason = "two matrices")]
    fn differentiate_contact_step_by_parameters(
        &self,
        _method: &TimeStepping<Self::Scalar>,
        _t: Self::Scalar,
        _state: (&SVector<Self::Scalar, NQ>, &SVector<Self::Scalar, NV>),
        _u: &SVector<Self::Scalar, NU>,
    ) -> Option<Result<(SMatrix<Self::Scalar, NV, NP>, SMatrix<Self::Scalar, NV, NP>), Error>> {
        None
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NP: usize> Sensitivities<NQ, NV, NU, NP>
    for At<'_, M, T>
where
    T: Real,
    M: Sensitivities<NQ, NV, NU, NP, Scalar = T>,
{
    const PARAMETERS: [&'static str; NP] = M::PARAMETERS;

    fn inverse_dynamics_by_parameters(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        a: &SVector<T, NV>,
    ) -> SMatrix<T, NV, NP> {
        self.mechanism.inverse_dynamics_by_parameters(self.t, q, v, a)
    }

    fn forward_dynamics_by_parameters(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> SMatrix<T, NV, NP> {
        self.mechanism.forward_dynamics_by_parameters(self.t, q, v, tau)
    }

    fn generalized_forces_by_parameters(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> SMatrix<T, NV, NP> {
        self.mechanism.generalized_forces_by_parameters(self.t, q, v, u)
    }
}
