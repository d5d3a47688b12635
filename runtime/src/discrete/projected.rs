//! Derivatives of the projection onto constraints at the end of a step.

use super::Transition;
use crate::Real;
use crate::blocks::product;
use crate::constraint::{
    ConstrainedDerivatives, ConstraintError, EquationDerivatives, column_or_zeros,
    matrix_from_column_function, multipliers_from_constraint_forces,
};
use crate::integrate::Error;
use crate::private::{constant, epsilon, to_f64};
use nalgebra::{SMatrix, SVector};

/// Maximum number of differentiated corrections of a configuration. After an integration step the second
/// correction is usually at rounding level.
pub(super) const MOST_CORRECTIONS: usize = 8;

/// First derivatives of a Newton correction `x` of a configuration: `M x = Jᵀ λ`, `J x = −φ`.
pub(super) struct ConfigurationCorrectionDerivatives<T, const NV: usize, const NC: usize> {
    pub(super) x: SVector<T, NV>,
    /// Multipliers `λ` of the Newton correction of the configuration.
    pub(super) own: SVector<T, NC>,
    /// Derivatives of `M x − Jᵀ λ` with respect to the configuration.
    pub(super) forces: SMatrix<T, NV, NV>,
    /// Derivatives of the Newton correction with respect to the configuration.
    pub(super) change: SMatrix<T, NV, NV>,
    /// Whether the Newton correction is at rounding level, so that the iteration ends.
    pub(super) done: bool,
}

/// First derivatives of the correction `x` of a velocity: `M x = Jᵀ λ`, `J (v + x) + … = 0`.
pub(super) struct VelocityCorrectionDerivatives<T, const NV: usize, const NC: usize> {
    /// Multipliers `λ` of the correction of the velocity.
    pub(super) own: SVector<T, NC>,
    /// Derivatives of `M x − Jᵀ λ` with respect to the configuration.
    pub(super) forces: SMatrix<T, NV, NV>,
    /// Derivatives of the corrected velocity with respect to the configuration.
    pub(super) turned: SMatrix<T, NV, NV>,
    /// Derivatives of the corrected velocity with respect to the velocity before the correction.
    pub(super) kept: SMatrix<T, NV, NV>,
}

/// Newton corrections that project the end of a step onto the constraints, with their derivatives.
pub(super) trait StepCorrections<
    T: Real,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T> + Sized
{
    /// Returns the derivatives of the correction equations `M x − Jᵀ λ` and `J x` with respect to the
    /// configuration.
    fn correction_equation_derivatives(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        x: &SVector<T, NV>,
        lambda: &SVector<T, NC>,
    ) -> (SMatrix<T, NV, NV>, SMatrix<T, NC, NV>) {
        let still = SVector::zeros();
        let with: EquationDerivatives<T, NV, NC> = self.equation_derivatives(t, q, &still, x, lambda);
        let without = self.equation_derivatives(t, q, &still, &still, &SVector::zeros());
        (with.forces_by_q - without.forces_by_q, with.accelerations_by_q - without.accelerations_by_q)
    }

    /// Checks that the constraints have full rank; `t` is the time to report.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Singular`] where constraints lose rank.
    fn check_full_rank(&self, t: T, q: &SVector<T, NQ>) -> Result<(), Error> {
        if self.is_nearly_singular(t, q, &SVector::zeros()) {
            return Err(Error::Constraint { t: to_f64(t), reason: ConstraintError::Singular });
        }
        Ok(())
    }

    /// Returns the Newton correction of a configuration at time `t`, with its derivatives.
    fn configuration_correction_derivatives(
        &self,
        t: T,
        near: &SVector<T, NQ>,
    ) -> ConfigurationCorrectionDerivatives<T, NV, NC> {
        let residuals = self.constraint_residuals(t, near);
        let gap = SVector::from_fn(|k, _| residuals.get(k).copied().unwrap_or(T::zero()));
        let x = self.constraint_correction(t, near, &gap);
        let done = x.amax() <= constant::<T>(64.0) * epsilon::<T>() * near.amax().max(T::one());
        let own = multipliers_from_constraint_forces(self, t, near, &(self.mass_matrix(t, near) * x));
        let (forces, mut gaps) = self.correction_equation_derivatives(t, near, &x, &own);
        let jacobian = self.constraint_jacobian(t, near);
        for k in 0..NH {
            gaps.set_row(k, &(gaps.row(k) + jacobian.row(k)));
        }
        let change = matrix_from_column_function(|j| {
            self.constraint_response(t, near, &-column_or_zeros(&forces, j), &column_or_zeros(&gaps, j))
        });
        ConfigurationCorrectionDerivatives { x, own, forces, change, done }
    }

    /// Returns the derivatives of the velocity correction `x` that results in the velocity `v`.
    fn velocity_correction_derivatives(
        &self,
        t: T,
        (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
        x: &SVector<T, NV>,
    ) -> VelocityCorrectionDerivatives<T, NV, NC> {
        let own = multipliers_from_constraint_forces(self, t, q, &(self.mass_matrix(t, q) * x));
        let forces = self.correction_equation_derivatives(t, q, x, &own).0;
        let (still, none) = (SVector::zeros(), SVector::zeros());
        let rates = self.equation_derivatives(t, q, v, &still, &SVector::zeros()).rates_by_q;
        let jacobian = self.constraint_jacobian(t, q);
        let turned = matrix_from_column_function(|j| {
            self.constraint_response(t, q, &-column_or_zeros(&forces, j), &column_or_zeros(&rates, j))
        });
        let kept: SMatrix<T, NV, NV> = SMatrix::identity()
            + matrix_from_column_function::<T, NV, NV>(|j| {
                self.constraint_response(t, q, &none, &column_or_zeros(&jacobian, j))
            });
        VelocityCorrectionDerivatives { own, forces, turned, kept }
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    StepCorrections<T, NQ, NV, NU, NH, NC> for M
where
    T: Real,
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
}

/// Returns the step `free` with its end, at time `t`, projected onto the constraints, including the
/// derivatives of the projection.
///
/// Newton corrections project the configuration, and one linear correction projects the velocity. Each
/// correction is differentiated as computed.
pub(super) fn project_step<
    M,
    T,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>(
    m: &M,
    t: T,
    free: Transition<T, NQ, NV, NU>,
) -> Result<Transition<T, NQ, NV, NU>, Error>
where
    T: Real,
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    let add_time_to_error = |reason| Error::Constraint { t: to_f64(t), reason };
    let (q, v) = m.project(t, &free.q, &free.v).map_err(add_time_to_error)?;
    m.check_full_rank(t, &q)?;
    let mut near = free.q;
    let mut moved = SMatrix::<T, NV, NV>::identity();
    for _ in 0..MOST_CORRECTIONS {
        let ConfigurationCorrectionDerivatives { x, change, done, .. } =
            m.configuration_correction_derivatives(t, &near);
        let (by_q, by_x) = m.integrate_derivatives_at(&near, &x);
        moved = product(&(by_q + product(&by_x, &change)), &moved);
        near = m.integrate(&near, &x);
        if done {
            break;
        }
    }
    let VelocityCorrectionDerivatives { turned, kept, .. } =
        m.velocity_correction_derivatives(t, (&q, &v), &(v - free.v));
    let turned = product(&turned, &moved);
    Ok(Transition {
        q,
        v,
        q_by_q: product(&moved, &free.q_by_q),
        q_by_v: product(&moved, &free.q_by_v),
        q_by_u: product(&moved, &free.q_by_u),
        v_by_q: product(&turned, &free.q_by_q) + product(&kept, &free.v_by_q),
        v_by_v: product(&turned, &free.q_by_v) + product(&kept, &free.v_by_v),
        v_by_u: product(&turned, &free.q_by_u) + product(&kept, &free.v_by_u),
        chained: None,
    })
}
