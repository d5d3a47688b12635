//! Second derivatives within a step: the chain rule for functions of two vectors, and second derivatives of
//! displacements.

use super::explicit::VectorWithDerivatives;
use crate::blocks::{add_multiple, add_product, product, transposed};
use crate::private::constant;
use crate::{InputSecondOrder, Real, SecondDerivatives};
use nalgebra::{SMatrix, SVector};

type SquareMatrix<T, const NV: usize> = SMatrix<T, NV, NV>;

/// Second derivatives of a function of two vectors: with respect to the first twice, to the first (rows) and
/// the second (columns), and to the second twice. `None` is zero.
pub(super) struct TwoVectorSecondDerivatives<T, const NV: usize> {
    pub(super) first: Option<SquareMatrix<T, NV>>,
    pub(super) mixed: SquareMatrix<T, NV>,
    pub(super) second: Option<SquareMatrix<T, NV>>,
}

impl<T: Real, const NV: usize> TwoVectorSecondDerivatives<T, NV> {
    /// Returns the products of the Hessian with columns of changes of both vectors: the rows of the first
    /// vector and of the second.
    fn hessian_products<const C: usize>(
        &self,
        first: &SMatrix<T, NV, C>,
        second: &SMatrix<T, NV, C>,
    ) -> (SMatrix<T, NV, C>, SMatrix<T, NV, C>) {
        let mut of_first = product(&self.mixed, second);
        let mut of_second = product(&transposed(&self.mixed), first);
        if let Some(own) = &self.first {
            add_product(&mut of_first, own, first);
        }
        if let Some(own) = &self.second {
            add_product(&mut of_second, own, second);
        }
        (of_first, of_second)
    }

    /// Adds the second derivatives with respect to the start of the step, given the derivatives of both
    /// vectors with respect to it.
    pub(super) fn add_second_derivatives_to<const NU: usize>(
        &self,
        sum: &mut InputSecondOrder<T, NV, NU>,
        first: &VectorWithDerivatives<T, NV, NU>,
        second: &VectorWithDerivatives<T, NV, NU>,
    ) {
        let turned = [&first.by_q, &second.by_q, &first.by_v, &second.by_v].map(transposed);
        let [first_q, second_q, first_v, second_v] = &turned;
        let (a, b) = self.hessian_products(&first.by_q, &second.by_q);
        add_two_products(&mut sum.0, (first_q, &a), (second_q, &b));
        let (a, b) = self.hessian_products(&first.by_v, &second.by_v);
        add_two_products(&mut sum.1, (first_q, &a), (second_q, &b));
        add_two_products(&mut sum.2, (first_v, &a), (second_v, &b));
        let (a, b) = self.hessian_products(&first.by_u, &second.by_u);
        add_two_products(&mut sum.3, (first_q, &a), (second_q, &b));
        add_two_products(&mut sum.4, (first_v, &a), (second_v, &b));
        add_two_products(&mut sum.5, (&transposed(&first.by_u), &a), (&transposed(&second.by_u), &b));
    }
}

/// Adds two products, `a b + c d`, to `sum`.
fn add_two_products<T: Real, const R: usize, const K: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    (a, b): (&SMatrix<T, R, K>, &SMatrix<T, K, C>),
    (c, d): (&SMatrix<T, R, K>, &SMatrix<T, K, C>),
) {
    add_product(sum, a, b);
    add_product(sum, c, d);
}

/// Displacement of a configuration to second order. A change `δq` of the start and a change of `dv` move the
/// end of `q ⊕ dv` by `ξ`: it becomes `q ⊕ dv ⊕ ξ`.
pub(super) struct SecondOrderDisplacement<T, const NV: usize> {
    /// Derivative of the displacement `ξ` of the end with respect to the displacement `δq` of the start.
    pub(super) by_q: SquareMatrix<T, NV>,
    /// Derivative of the displacement `ξ` of the end with respect to `dv`.
    pub(super) by_dv: SquareMatrix<T, NV>,
    dv: SVector<T, NV>,
}

impl<T: Real, const NV: usize> SecondOrderDisplacement<T, NV> {
    pub(super) fn new<M, const NQ: usize, const NU: usize>(m: &M, dv: &SVector<T, NV>) -> Self
    where
        M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let (by_q, by_dv) = m.integrate_derivatives(dv);
        Self { by_q, by_dv, dv: *dv }
    }

    /// Returns the second derivatives of `λᵀ ξ` with respect to `δq` and `dv`; those with respect to `δq`
    /// twice are zero.
    ///
    /// `exp ξ = exp(E δq) exp ζ` with `E` the adjoint of `exp(−dv)` and `exp ζ = exp(−dv) exp(dv + δ)`, so
    /// that `ξ` is `E δq + ζ + ½ [E δq, ζ]` to second order. `ζ` is `D δ` plus half the change of the right
    /// Jacobian `D` along `δ`. The derivative of `D` is computed from that of its inverse, which maps
    /// velocities to rates of displacements.
    pub(super) fn curvature_of_displacement<M, const NQ: usize, const NU: usize>(
        &self,
        m: &M,
        lambda: &SVector<T, NV>,
    ) -> TwoVectorSecondDerivatives<T, NV>
    where
        M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let still = SVector::zeros();
        // Derivatives of v + ½ [dv, v] + … at dv = 0.
        let bracket = m.tangent_rate_second_derivatives(&still, &still, lambda).1;
        let turned = product(&transposed(&self.by_dv), lambda);
        let inverse = m.tangent_rate_second_derivatives(&self.dv, &still, &turned).1;
        let bent = product(&inverse, &self.by_dv);
        let mut second = transposed(&bent);
        add_multiple(&mut second, T::one(), &bent);
        TwoVectorSecondDerivatives {
            first: None,
            mixed: product(&transposed(&self.by_q), &product(&bracket, &self.by_dv)),
            second: Some(second * constant::<T>(-0.5)),
        }
    }
}
