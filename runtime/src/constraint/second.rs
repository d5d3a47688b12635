//! Second derivatives of constrained motion, contracted with factors, for generic code.

use super::ConstrainedDerivatives;
use super::differentiable::{accelerations_with_derivatives, multipliers_from_constraint_forces};
use super::layout::ConstraintCurvature;
use crate::blocks::{add_multiple, add_product, product, transposed};
use crate::{At, Real, SecondDerivatives, SecondOrder};
use nalgebra::{ArrayStorage, SMatrix, SVector};

/// Second derivatives of a mechanism's constrained equations. `#[mechanism(…, second_derivatives)]`
/// implements it for mechanisms with constraints but without sliding contacts.
///
/// Displacements of the configuration are as in [`ConstrainedDerivatives`], whether or not the constraints
/// permit them: along `q ⊕ ε dq`, the second-order change of a function is `½ ε² dqᵀ H dq`. Time `t` is as in
/// [`Constrained`](super::Constrained).
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no second derivatives of constrained motion",
    note = "enable them with the option: `#[mechanism(…, second_derivatives)]`; mechanisms without \
            constraints and those with contacts that slip have none"
)]
pub trait ConstrainedSecondDerivatives<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NH: usize,
    const NC: usize,
>: ConstrainedDerivatives<NQ, NV, NU, NH, NC> + SecondDerivatives<NQ, NV, NU>
{
    /// Returns the second derivatives of `wᵀ (M a + h − Jᵀ λ) + zᵀ (J a + b) + yᵀ (J v + …)` for any `a` and
    /// `λ`: the equations of motion, the acceleration constraints and the constraint rates, contracted with
    /// the factors `w`, `z` and `y`.
    #[allow(clippy::too_many_arguments, reason = "three factors stand beside the state")]
    fn equation_second_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        lambda: &SVector<Self::Scalar, NC>,
        w: &SVector<Self::Scalar, NV>,
        z: &SVector<Self::Scalar, NC>,
        y: &SVector<Self::Scalar, NC>,
    ) -> EquationSecondDerivatives<Self::Scalar, NV, NC>;
}

/// Contracted second derivatives of the equations of constrained motion, see
/// [`equation_second_derivatives`](ConstrainedSecondDerivatives::equation_second_derivatives). Derivatives
/// with respect to velocity and acceleration, velocity and multipliers, and accelerations and multipliers are
/// zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquationSecondDerivatives<T, const NV: usize, const NC: usize> {
    /// Block of the contracted Hessian: second derivatives with respect to the configuration.
    pub qq: SMatrix<T, NV, NV>,
    /// Block of the contracted Hessian: derivatives with respect to configuration (rows) and velocity
    /// (columns).
    pub qv: SMatrix<T, NV, NV>,
    /// Block of the contracted Hessian: second derivatives with respect to the velocity.
    pub vv: SMatrix<T, NV, NV>,
    /// Block of the contracted Hessian: derivatives with respect to configuration (rows) and acceleration
    /// (columns).
    pub qa: SMatrix<T, NV, NV>,
    /// Block of the contracted Hessian: derivatives with respect to configuration (rows) and constraint
    /// multipliers (columns).
    pub q_lambda: SMatrix<T, NV, NC>,
}

/// Returns the sum of the second derivatives of inverse dynamics and of the constraint terms.
pub fn with_curvature<T: Real, const NV: usize, const NC: usize>(
    (qq, qv, vv, qa): SecondOrder<T, NV>,
    found: ConstraintCurvature<T, NV, NC>,
) -> EquationSecondDerivatives<T, NV, NC> {
    let matrix_from_columns = |columns| SMatrix::from_array_storage(ArrayStorage(columns));
    EquationSecondDerivatives {
        qq: qq + matrix_from_columns(found.qq),
        qv: qv + matrix_from_columns(found.qv),
        vv: vv + matrix_from_columns(found.vv),
        qa: qa + matrix_from_columns(found.qa),
        q_lambda: SMatrix::from_array_storage(ArrayStorage(found.q_lambda)),
    }
}

/// Returns the adjoint variables `w` and `z` for factors `f` of the accelerations: `M w + Jᵀ z = f`, `J w =
/// 0`.
pub(crate) fn adjoint_variables<
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
    f: &SVector<T, NV>,
) -> (SVector<T, NV>, SVector<T, NC>)
where
    T: Real,
    M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    let w = m.constraint_response(t, q, f, &SVector::zeros());
    (w, multipliers_from_constraint_forces(m, t, q, &(f - m.mass_matrix(t, q) * w)))
}

/// Returns the second derivatives of `fᵀ v̇` with constraints. The equations `M v̇ + h − Jᵀ λ = τ` and `J v̇
/// + b = 0`, which hold for all states, are differentiated twice and contracted with the adjoint of `f`.
pub fn constrained_second_derivatives<
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
    v: &SVector<T, NV>,
    tau: &SVector<T, NV>,
    factors: &SVector<T, NV>,
) -> SecondOrder<T, NV>
where
    T: Real,
    M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    let solved = accelerations_with_derivatives(m, t, q, v, tau);
    let (w, z) = adjoint_variables(m, t, q, factors);
    let none = SVector::zeros();
    let found = m.equation_second_derivatives(t, q, v, &solved.a, &solved.lambda, &-w, &-z, &none);
    let mixed_second_derivative_terms = |(a, lambda): &(SMatrix<T, NV, NV>, SMatrix<T, NC, NV>)| {
        let mut sum = product(&found.qa, a);
        add_product(&mut sum, &found.q_lambda, lambda);
        sum
    };
    let [by_q, by_v, by_tau] = solved.by.each_ref().map(mixed_second_derivative_terms);
    (plus_matrix_and_transpose(found.qq, &by_q), found.qv + by_v, found.vv, by_tau)
}

/// Returns the matrix `A + B + Bᵀ` of two square matrices.
pub(crate) fn plus_matrix_and_transpose<T: Real, const N: usize>(
    mut a: SMatrix<T, N, N>,
    b: &SMatrix<T, N, N>,
) -> SMatrix<T, N, N> {
    add_multiple(&mut a, T::one(), b);
    add_multiple(&mut a, T::one(), &transposed(b));
    a
}

/// Operation on a mechanism with second derivatives and any number of constraints, called by
/// [`visit_constraint_curvature`](crate::SecondDerivatives::visit_constraint_curvature).
pub trait CurvatureVisitor<T: Real, const NQ: usize, const NV: usize, const NU: usize> {
    /// Type of the value that the operation returns.
    type Output;

    /// Applies the operation to a constrained mechanism with second derivatives and returns the result.
    fn visit<M, const NH: usize, const NC: usize>(self, mechanism: &M) -> Self::Output
    where
        M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>;
}

/// Visitor that receives the mechanism at a fixed time.
pub(crate) struct FrozenTimeCurvatureVisitor<V, T> {
    pub(crate) visitor: V,
    pub(crate) t: T,
}

impl<V, T, const NQ: usize, const NV: usize, const NU: usize> CurvatureVisitor<T, NQ, NV, NU>
    for FrozenTimeCurvatureVisitor<V, T>
where
    T: Real,
    V: CurvatureVisitor<T, NQ, NV, NU>,
{
    type Output = V::Output;

    fn visit<M, const NH: usize, const NC: usize>(self, mechanism: &M) -> V::Output
    where
        M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        self.visitor.visit(&crate::at(mechanism, self.t))
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NH: usize, const NC: usize>
    ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC> for At<'_, M, T>
where
    T: Real,
    M: ConstrainedSecondDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
{
    fn equation_second_derivatives(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        a: &SVector<T, NV>,
        lambda: &SVector<T, NC>,
        w: &SVector<T, NV>,
        z: &SVector<T, NC>,
        y: &SVector<T, NC>,
    ) -> EquationSecondDerivatives<T, NV, NC> {
        self.mechanism.equation_second_derivatives(self.t, q, v, a, lambda, w, z, y)
    }
}
