//! Second derivatives of the projection onto constraints at the end of a step.

use super::curvature::{SecondOrderDisplacement, TwoVectorSecondDerivatives};
use super::projected::{
    ConfigurationCorrectionDerivatives, MOST_CORRECTIONS, StepCorrections, VelocityCorrectionDerivatives,
};
use crate::Real;
use crate::blocks::product;
use crate::constraint::{
    ConstrainedSecondDerivatives, EquationSecondDerivatives, adjoint_variables, column_or_zeros,
    multipliers_from_constraint_forces, plus_matrix_and_transpose, set_column,
};
use crate::integrate::Error;
use crate::private::{constant, to_f64};
use nalgebra::{SMatrix, SVector};

/// Derivatives of a projection contracted with factors of the projected configuration and velocity, with
/// respect to the state before the projection.
pub(super) struct ProjectionContraction<T, const NV: usize> {
    /// Gradient of the contracted projection with respect to the configuration and the velocity before it.
    pub(super) gradient: (SVector<T, NV>, SVector<T, NV>),
    /// Second derivatives of the contracted projection; the block of second derivatives with respect to the
    /// velocity is zero.
    pub(super) second: TwoVectorSecondDerivatives<T, NV>,
}

/// Equations of a correction `x` with multipliers `λ`, contracted with `w`, `z` and `y`: `wᵀ (M x − Jᵀ λ) +
/// zᵀ J x + yᵀ (J v + …)`.
struct ContractedCorrectionEquations<'a, T, const NV: usize, const NC: usize> {
    x: &'a SVector<T, NV>,
    lambda: &'a SVector<T, NC>,
    w: &'a SVector<T, NV>,
    z: &'a SVector<T, NC>,
    y: &'a SVector<T, NC>,
}

impl<T: Real, const NV: usize, const NC: usize> ContractedCorrectionEquations<'_, T, NV, NC> {
    /// Returns the second derivatives of the contracted correction equations: those of the equations of
    /// motion with acceleration `x`, minus those at zero acceleration.
    fn curvature_of_equations<M, const NQ: usize, const NU: usize, const NH: usize>(
        &self,
        m: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> EquationSecondDerivatives<T, NV, NC>
    where
        M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        let Self { x, lambda, w, z, y } = self;
        let (still, none) = (SVector::zeros(), SVector::zeros());
        let with = m.equation_second_derivatives(t, q, v, x, lambda, w, z, y);
        let without = m.equation_second_derivatives(t, q, v, &still, &none, w, z, &none);
        let (qq, qv, vv) = (with.qq - without.qq, with.qv - without.qv, with.vv - without.vv);
        EquationSecondDerivatives { qq, qv, vv, ..with }
    }
}

/// Returns the derivatives of the multipliers `λ` of a correction, given the derivatives of the correction
/// `x` and the additional derivatives `forces` of `M x − Jᵀ λ`.
fn correction_multiplier_derivatives<
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
    q: &SVector<T, NQ>,
    change: &SMatrix<T, NV, NV>,
    forces: &SMatrix<T, NV, NV>,
) -> SMatrix<T, NC, NV>
where
    T: Real,
    M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    let all = product(&m.mass_matrix(t, q), change) + forces;
    let mut changes = SMatrix::zeros();
    for j in 0..NV {
        set_column(&mut changes, j, &multipliers_from_constraint_forces(m, t, q, &column_or_zeros(&all, j)));
    }
    changes
}

/// Returns the second derivatives of `factorsᵀ x` for a correction `x` of the configuration.
fn correction_curvature<
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
    q: &SVector<T, NQ>,
    found: &ConfigurationCorrectionDerivatives<T, NV, NC>,
    factors: &SVector<T, NV>,
) -> SMatrix<T, NV, NV>
where
    T: Real,
    M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    let (w, z) = adjoint_variables(m, t, q, factors);
    let ConfigurationCorrectionDerivatives { x, own, forces, change, .. } = found;
    let (still, none) = (SVector::zeros(), SVector::zeros());
    let equations = ContractedCorrectionEquations { x, lambda: own, w: &-w, z: &-z, y: &none }
        .curvature_of_equations(m, t, q, &still);
    // The second derivatives of the residuals are derivatives of the Jacobian's rows.
    let multiplier_or_zero = |k: usize| z.get(k).copied().filter(|_| k < NH).unwrap_or(T::zero());
    let holonomic = SVector::from_fn(|k, _| multiplier_or_zero(k));
    let residuals = m.correction_equation_derivatives(t, q, &still, &holonomic).0;
    // Derivatives along body axes are not symmetric, but derivatives along `q ⊕ ε dq` are.
    let residuals = plus_matrix_and_transpose(SMatrix::zeros(), &(residuals * constant::<T>(0.5)));
    let multipliers = correction_multiplier_derivatives(m, t, q, change, forces);
    let mixed = product(&equations.qa, change) + product(&equations.q_lambda, &multipliers);
    plus_matrix_and_transpose(equations.qq + residuals, &mixed)
}

/// Returns the derivatives of the projection of a state, contracted with factors of the projected state.
pub(super) fn curvature_of_projection<
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
    (q_free, v_free): (&SVector<T, NQ>, &SVector<T, NV>),
    (of_q, of_v): (&SVector<T, NV>, &SVector<T, NV>),
) -> Result<ProjectionContraction<T, NV>, Error>
where
    T: Real,
    M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    let add_time_to_error = |reason| Error::Constraint { t: to_f64(t), reason };
    let (q, v) = m.project(t, q_free, v_free).map_err(add_time_to_error)?;
    m.check_full_rank(t, &q)?;
    // Intermediate configurations of the projection, with their derivatives with respect to the first. In
    // coordinates that are a vector space, the derivative of a displacement is the identity.
    let displacement_if_on_manifold =
        |x: &SVector<T, NV>| (NQ != NV).then(|| SecondOrderDisplacement::new(m, x));
    let mut way = [(*q_free, SMatrix::zeros()); MOST_CORRECTIONS];
    let (mut near, mut moved, mut count) = (*q_free, SMatrix::<T, NV, NV>::identity(), 0);
    for stage in &mut way {
        *stage = (near, moved);
        count += 1;
        let found = m.configuration_correction_derivatives(t, &near);
        moved = match displacement_if_on_manifold(&found.x) {
            Some(along) => product(&(along.by_q + product(&along.by_dv, &found.change)), &moved),
            None => moved + product(&found.change, &moved),
        };
        near = m.integrate(&near, &found.x);
        if found.done {
            break;
        }
    }

    let x = v - v_free;
    let VelocityCorrectionDerivatives { own, forces, turned, kept } =
        m.velocity_correction_derivatives(t, (&q, &v), &x);
    let (w, z) = adjoint_variables(m, t, &q, of_v);
    let none = SVector::zeros();
    let equations = ContractedCorrectionEquations { x: &x, lambda: &own, w: &-w, z: &none, y: &-z }
        .curvature_of_equations(m, t, &q, &v);
    let by_x = equations.qa + equations.qv;
    let identity = SMatrix::<T, NV, NV>::identity();
    let mixed = product(&by_x, &turned)
        + product(&equations.q_lambda, &correction_multiplier_derivatives(m, t, &q, &turned, &forces));
    let change = kept - identity;
    let by_v = equations.qv
        + product(&by_x, &change)
        + product(
            &equations.q_lambda,
            &correction_multiplier_derivatives(m, t, &q, &change, &SMatrix::zeros()),
        );
    let mut qq = moved.tr_mul(&product(&plus_matrix_and_transpose(equations.qq, &mixed), &moved));
    let qv = moved.tr_mul(&by_v);

    let mut gradient = of_q + turned.tr_mul(of_v);
    for (near, moved) in way.iter().take(count).rev() {
        let found = m.configuration_correction_derivatives(t, near);
        let mut of_x = gradient;
        let mut own = SMatrix::zeros();
        if let Some(along) = displacement_if_on_manifold(&found.x) {
            of_x = along.by_dv.tr_mul(&gradient);
            let TwoVectorSecondDerivatives { mixed, second, .. } =
                along.curvature_of_displacement(m, &gradient);
            let twice =
                second.map_or_else(SMatrix::zeros, |b| found.change.tr_mul(&product(&b, &found.change)));
            own = plus_matrix_and_transpose(twice, &product(&mixed, &found.change));
            gradient = along.by_q.tr_mul(&gradient);
        }
        own += correction_curvature(m, t, near, &found, &of_x);
        qq += moved.tr_mul(&product(&own, moved));
        gradient += found.change.tr_mul(&of_x);
    }
    let second = TwoVectorSecondDerivatives { first: Some(qq), mixed: qv, second: None };
    Ok(ProjectionContraction { gradient: (gradient, kept.tr_mul(of_v)), second })
}
