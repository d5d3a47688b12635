//! Derivatives of the dynamics of `Extended` mechanisms, whose velocity vector also contains the first-order
//! states.

use super::FirstOrderDerivatives;
use super::extended::{Extended, split, with_diagonal};
use crate::derivatives::{ByMotion, nan_matrix};
use crate::{Derivatives, Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// Returns the block matrix of `block` (velocities), with the rows of the first-order states below it and
/// their columns next to it.
fn matrix_bordered_by_states<T: Real, const NV: usize, const NX: usize, const NE: usize>(
    block: &SMatrix<T, NV, NV>,
    below: &SMatrix<T, NX, NV>,
    beside: &SMatrix<T, NV, NX>,
    corner: &SMatrix<T, NX, NX>,
) -> SMatrix<T, NE, NE> {
    SMatrix::from_fn(|i, j| {
        let (row, column) = (i.wrapping_sub(NV), j.wrapping_sub(NV));
        let upper = block.get((i, j)).or(beside.get((i, column)));
        upper.or(below.get((row, j))).or(corner.get((row, column))).copied().unwrap_or(T::zero())
    })
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NX: usize, const NE: usize>
    Derivatives<NQ, NE, NU> for Extended<'_, M, NV, NX, NE>
where
    M: FirstOrderDerivatives<NQ, NV, NU, NX, NE>,
{
    crate::forward::linear_motion!(NQ, NE, NU);
    fn integrate_derivatives(
        &self,
        dv: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        let (by_q, by_dv) = self.mechanism.integrate_derivatives(&split::<_, NV, NX, NE>(dv).0);
        let (zero, one) = (nalgebra::zero(), nalgebra::one());
        (with_diagonal::<_, NV, NX, NE>(&by_q, one), with_diagonal::<_, NV, NX, NE>(&by_dv, zero))
    }

    fn tangent_rate_derivatives(
        &self,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        let (dv, v) = (split::<_, NV, NX, NE>(dv).0, split::<_, NV, NX, NE>(v).0);
        let (by_dv, by_v) = self.mechanism.tangent_rate_derivatives(&dv, &v);
        let (zero, one) = (nalgebra::zero(), nalgebra::one());
        (with_diagonal::<_, NV, NX, NE>(&by_dv, zero), with_diagonal::<_, NV, NX, NE>(&by_v, one))
    }

    fn integrate_derivatives_at(
        &self,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        let (by_q, by_dv) = self.mechanism.integrate_derivatives_at(q, &split::<_, NV, NX, NE>(dv).0);
        let (zero, one) = (nalgebra::zero(), nalgebra::one());
        (with_diagonal::<_, NV, NX, NE>(&by_q, one), with_diagonal::<_, NV, NX, NE>(&by_dv, zero))
    }

    fn displacement_rate_derivatives(
        &self,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> crate::ByMotion<M::Scalar, NE, NE> {
        let (dv, v) = (split::<_, NV, NX, NE>(dv).0, split::<_, NV, NX, NE>(v).0);
        let (by_q, by_dv, by_v) = self.mechanism.displacement_rate_derivatives(q, &dv, &v);
        let (zero, one) = (nalgebra::zero(), nalgebra::one());
        let extend_with_diagonal = |m, diagonal| with_diagonal::<_, NV, NX, NE>(&m, diagonal);
        (extend_with_diagonal(by_q, zero), extend_with_diagonal(by_dv, zero), extend_with_diagonal(by_v, one))
    }

    fn turning(&self, q: &SVector<M::Scalar, NQ>, v: &SVector<M::Scalar, NE>) -> SMatrix<M::Scalar, NE, NE> {
        let v = split::<_, NV, NX, NE>(v).0;
        with_diagonal::<_, NV, NX, NE>(&self.mechanism.turning(q, &v), nalgebra::zero())
    }

    fn coriolis_matrix(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> SMatrix<M::Scalar, NE, NE> {
        let (m, v) = self.mechanism_and_velocities(v);
        with_diagonal::<_, NV, NX, NE>(&m.coriolis_matrix(t, q, &v), nalgebra::zero())
    }

    fn inverse_dynamics_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        a: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        let ((m, v), a) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(a).0);
        let (by_q, by_v) = m.inverse_dynamics_derivatives(t, q, &v, &a);
        let rates = m.state_rate_derivatives(t, q, &v, &SVector::zeros());
        let by_x = m.inverse_dynamics_by_states(t, q, &v, &a);
        let (zero, none) = (SMatrix::zeros(), SMatrix::zeros());
        (
            matrix_bordered_by_states(&by_q, &-rates.by_q, &zero, &none),
            matrix_bordered_by_states(&by_v, &-rates.by_v, &by_x, &-rates.by_x),
        )
    }

    fn forward_dynamics_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        tau: &SVector<M::Scalar, NE>,
    ) -> ByMotion<M::Scalar, NE, NE> {
        let ((m, v), tau) = (self.mechanism_and_velocities(v), split::<_, NV, NX, NE>(tau).0);
        let (by_q, by_v, by_force) = m.forward_dynamics_derivatives(t, q, &v, &tau);
        let rates = m.state_rate_derivatives(t, q, &v, &SVector::zeros());
        let by_x = m.forward_dynamics_by_states(t, q, &v, &tau);
        let (zero, none) = (SMatrix::zeros(), SMatrix::zeros());
        (
            matrix_bordered_by_states(&by_q, &rates.by_q, &zero, &none),
            matrix_bordered_by_states(&by_v, &rates.by_v, &by_x, &rates.by_x),
            with_diagonal::<_, NV, NX, NE>(&by_force, nalgebra::one()),
        )
    }

    fn forward_dynamics_derivatives_into(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        tau: &SVector<M::Scalar, NE>,
        by_q: &mut SMatrix<M::Scalar, NE, NE>,
        by_v: &mut SMatrix<M::Scalar, NE, NE>,
        by_tau: &mut SMatrix<M::Scalar, NE, NE>,
    ) -> SVector<M::Scalar, NE> {
        (*by_q, *by_v, *by_tau) = self.forward_dynamics_derivatives(t, q, v, tau);
        self.forward_dynamics(t, q, v, tau)
    }

    fn generalized_forces_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        u: &SVector<M::Scalar, NU>,
    ) -> ByMotion<M::Scalar, NE, NU> {
        let (m, v) = self.mechanism_and_velocities(v);
        let (by_q, by_v, by_u) = m.generalized_forces_derivatives(t, q, &v, u);
        let rates = m.state_rate_derivatives(t, q, &v, u);
        let alone = m.state_rate_derivatives(t, q, &v, &SVector::zeros());
        let by_x = m.generalized_forces_by_states(t, q, &v, u);
        let (zero, none) = (SMatrix::zeros(), SMatrix::zeros());
        let by_inputs = SMatrix::from_fn(|i, j| {
            let entry = by_u.get((i, j)).or(rates.by_u.get((i.wrapping_sub(NV), j)));
            entry.copied().unwrap_or(nalgebra::zero())
        });
        (
            matrix_bordered_by_states(&by_q, &(rates.by_q - alone.by_q), &zero, &none),
            matrix_bordered_by_states(&by_v, &(rates.by_v - alone.by_v), &by_x, &(rates.by_x - alone.by_x)),
            by_inputs,
        )
    }

    /// Returns NaN, because derivatives of momenta with respect to first-order states are not available.
    fn generalized_momentum_derivatives(
        &self,
        _t: M::Scalar,
        _q: &SVector<M::Scalar, NQ>,
        _v: &SVector<M::Scalar, NE>,
    ) -> SMatrix<M::Scalar, NE, NE> {
        nan_matrix()
    }

    /// Returns NaN, because derivatives of momenta with respect to first-order states are not available.
    fn momentum_rate_derivatives(
        &self,
        _t: M::Scalar,
        _q: &SVector<M::Scalar, NQ>,
        _v: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        (nan_matrix(), nan_matrix())
    }

    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::constraint::Visitor<M::Scalar, NQ, NE, NU>,
    {
        None
    }
}
