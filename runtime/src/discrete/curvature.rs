//! Second derivatives along the parts of a step: how those of a function of two vectors become those by the start of the step, and
//! those of displacements.

use super::explicit::Sensitive;
use crate::blocks::{add_multiple, add_product, product, transposed};
use crate::private::constant;
use crate::{InputSecondOrder, Real, RheonomicSecondDerivatives};
use nalgebra::{SMatrix, SVector};

type Square<T, const NV: usize> = SMatrix<T, NV, NV>;

/// Second derivatives of a function of two vectors: by the first twice, by the first (rows) and the second, by the second twice.
/// Those that are zero are not there.
pub(super) struct Curvature<T, const NV: usize> {
    pub(super) first: Option<Square<T, NV>>,
    pub(super) mixed: Square<T, NV>,
    pub(super) second: Option<Square<T, NV>>,
}

impl<T: Real, const NV: usize> Curvature<T, NV> {
    /// What both vectors make of columns by which they change.
    fn rows<const C: usize>(
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

    /// Adds them along the changes of both vectors with the start of the step.
    pub(super) fn add_to<const NU: usize>(
        &self,
        sum: &mut InputSecondOrder<T, NV, NU>,
        first: &Sensitive<T, NV, NU>,
        second: &Sensitive<T, NV, NU>,
    ) {
        let turned = [&first.by_q, &second.by_q, &first.by_v, &second.by_v].map(transposed);
        let [first_q, second_q, first_v, second_v] = &turned;
        let (a, b) = self.rows(&first.by_q, &second.by_q);
        add_both(&mut sum.0, (first_q, &a), (second_q, &b));
        let (a, b) = self.rows(&first.by_v, &second.by_v);
        add_both(&mut sum.1, (first_q, &a), (second_q, &b));
        add_both(&mut sum.2, (first_v, &a), (second_v, &b));
        let (a, b) = self.rows(&first.by_u, &second.by_u);
        add_both(&mut sum.3, (first_q, &a), (second_q, &b));
        add_both(&mut sum.4, (first_v, &a), (second_v, &b));
        add_both(&mut sum.5, (&transposed(&first.by_u), &a), (&transposed(&second.by_u), &b));
    }
}

/// Adds two products.
fn add_both<T: Real, const R: usize, const K: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    (a, b): (&SMatrix<T, R, K>, &SMatrix<T, K, C>),
    (c, d): (&SMatrix<T, R, K>, &SMatrix<T, K, C>),
) {
    add_product(sum, a, b);
    add_product(sum, c, d);
}

/// A displacement of a configuration to second order: where `q ⊕ dv` is moved by `δq` at its start and by a change of `dv`, it moves
/// by `ξ` at its end, `q ⊕ dv ⊕ ξ`.
pub(super) struct Displacement<T, const NV: usize> {
    /// How `ξ` changes with `δq`.
    pub(super) by_q: Square<T, NV>,
    /// How it changes with `dv`.
    pub(super) by_dv: Square<T, NV>,
    dv: SVector<T, NV>,
}

impl<T: Real, const NV: usize> Displacement<T, NV> {
    pub(super) fn of<M, const NQ: usize, const NU: usize>(m: &M, dv: &SVector<T, NV>) -> Self
    where
        M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let (by_q, by_dv) = m.integrate_derivatives(dv);
        Self { by_q, by_dv, dv: *dv }
    }

    /// The second derivatives of `λᵀ ξ` by `δq` and `dv`, those by `δq` twice being zero.
    ///
    /// `exp ξ = exp(E δq) exp ζ` with `E` the adjoint of `exp(−dv)` and `exp ζ = exp(−dv) exp(dv + δ)`, so that `ξ` is
    /// `E δq + ζ + ½ [E δq, ζ]` to second order, and `ζ` is `D δ` with half the change of `D`, the right Jacobian, along `δ`. What changes
    /// is known of its inverse, by which rates of displacements follow from velocities.
    pub(super) fn curvature<M, const NQ: usize, const NU: usize>(
        &self,
        m: &M,
        lambda: &SVector<T, NV>,
    ) -> Curvature<T, NV>
    where
        M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>,
    {
        let still = SVector::zeros();
        // Of v + ½ [dv, v] + …, at dv = 0.
        let bracket = m.tangent_rate_second_derivatives(&still, &still, lambda).1;
        let turned = product(&transposed(&self.by_dv), lambda);
        let inverse = m.tangent_rate_second_derivatives(&self.dv, &still, &turned).1;
        let bent = product(&inverse, &self.by_dv);
        let mut second = transposed(&bent);
        add_multiple(&mut second, T::one(), &bent);
        Curvature {
            first: None,
            mixed: product(&transposed(&self.by_q), &product(&bracket, &self.by_dv)),
            second: Some(second * constant::<T>(-0.5)),
        }
    }
}
