//! Second derivatives of the dynamics for generic code: differential dynamic programming, Newton's method on
//! trajectories.

use crate::blocks::{add_multiple, add_product, is_zero, product, transposed};
use crate::constraint::{CurvatureVisitor, FrozenTimeCurvatureVisitor};
use crate::forward::each_function;
use crate::private::constant;
use crate::{At, Derivatives, Real, Scleronomic};
use nalgebra::{SMatrix, SVector};

/// Square matrix with one row and one column for each of the `NV` velocities of a mechanism.
type SquareMatrix<T, const NV: usize> = SMatrix<T, NV, NV>;

/// Second derivatives contracted with factors `λ`: with respect to configuration twice; configuration (rows)
/// and velocity; velocity twice; configuration (rows) and a third argument of the function (acceleration,
/// force or input).
pub type SecondOrder<T, const NV: usize> =
    (SquareMatrix<T, NV>, SquareMatrix<T, NV>, SquareMatrix<T, NV>, SquareMatrix<T, NV>);

/// Second derivatives contracted with factors `λ`: with respect to configuration twice; configuration (rows)
/// and velocity; velocity twice; configuration (rows) and input; velocity (rows) and input; input twice.
pub type InputSecondOrder<T, const NV: usize, const NU: usize> = (
    SquareMatrix<T, NV>,
    SquareMatrix<T, NV>,
    SquareMatrix<T, NV>,
    SMatrix<T, NV, NU>,
    SMatrix<T, NV, NU>,
    SMatrix<T, NU, NU>,
);

/// Second derivatives of a mechanism's functions, contracted with factors `λ`: Hessians of `λᵀ f`, in blocks
/// of `NV` by `NV` (and by `NU`). `#[mechanism(…, second_derivatives)]` implements the trait, with and
/// without constraints, unless contacts slide. Arguments are those of [`Mechanism`](crate::Mechanism).
///
/// Along `q ⊕ ε dq` a function changes by `½ ε² dqᵀ H dq` beyond first order, with `H` the second derivatives
/// with respect to the configuration; for ball and free joints `dq` is a motion in body axes.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no second derivatives",
    note = "enable them with the option: `#[mechanism(…, second_derivatives)]`; a mechanism with sliding \
            contacts has none"
)]
pub trait SecondDerivatives<const NQ: usize, const NV: usize, const NU: usize>:
    Derivatives<NQ, NV, NU>
{
    /// Returns `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂a)` of `λᵀ τ` with `τ` from
    /// [`inverse_dynamics`](crate::Mechanism::inverse_dynamics) (Singh, Russell and Wensing, *Second-order
    /// derivatives of rigid-body dynamics*, 2023). The second derivatives with respect to `v` and `a`, and to
    /// `a` twice, are zero.
    fn inverse_dynamics_second_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> SecondOrder<Self::Scalar, NV>;

    /// Returns `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂τ)` of `λᵀ v̇` with `v̇` from
    /// [`forward_dynamics`](crate::Mechanism::forward_dynamics), constraints included. The second derivatives
    /// with respect to `v` and `τ`, and to `τ` twice, are zero.
    fn forward_dynamics_second_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> SecondOrder<Self::Scalar, NV>;

    /// Returns all second derivatives of `λᵀ τ` with `τ` from
    /// [`generalized_forces`](crate::Mechanism::generalized_forces); zero if inputs act along joints.
    fn generalized_forces_second_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> InputSecondOrder<Self::Scalar, NV, NU>;

    /// Returns `(∂²/∂dv∂dv, ∂²/∂dv∂v)` of `λᵀ` [`tangent_rate`](crate::Mechanism::tangent_rate); the rows of
    /// the mixed derivatives belong to `dv`. Zero for coordinates whose rates are the velocities.
    fn tangent_rate_second_derivatives(
        &self,
        _dv: &SVector<Self::Scalar, NV>,
        _v: &SVector<Self::Scalar, NV>,
        _lambda: &SVector<Self::Scalar, NV>,
    ) -> (SquareMatrix<Self::Scalar, NV>, SquareMatrix<Self::Scalar, NV>) {
        (SMatrix::zeros(), SMatrix::zeros())
    }

    /// Passes the mechanism to `visitor`, with the numbers of its constraints as const parameters, if their
    /// second derivatives are available; otherwise returns `None`.
    fn visit_constraint_curvature<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: CurvatureVisitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }

    /// Returns the second derivatives of `λᵀ v̇` with respect to state and inputs, with `v̇` the acceleration
    /// under the inputs `u`.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// #[mechanism(gravity = -9.81 * y, second_derivatives)]
    /// struct Pendulum {
    ///     #[body(mass = 2, com = -0.5 * y)]
    ///     bob: Body,
    ///     #[joint(ground -> bob, about = z)]
    ///     hinge: Pin,
    ///     #[acts(on = hinge)]
    ///     motor: Torque,
    /// }
    ///
    /// let (q, v, u) = ([0.3].into(), [1.0].into(), [0.2].into());
    /// let (qq, ..) = Pendulum {}.second_order_motion(&q, &v, &u, &[1.0].into());
    /// // The second derivative of −g / l sin q.
    /// assert!((qq[0] - 9.81 / 0.5 * 0.3_f64.sin()).abs() < 1e-12);
    /// ```
    fn second_order_motion(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> InputSecondOrder<Self::Scalar, NV, NU>
    where
        Self: Scleronomic,
    {
        let t = constant(0.0);
        let tau = self.generalized_forces(t, q, v, u);
        let (_, _, inverse) = self.forward_dynamics_derivatives(t, q, v, &tau);
        let (tau_by_q, tau_by_v, tau_by_u) = self.generalized_forces_derivatives(t, q, v, u);
        let (qq, qv, vv, by_force) = self.forward_dynamics_second_derivatives(t, q, v, &tau, lambda);
        let more = self.generalized_forces_second_derivatives(t, q, v, u, &inverse.tr_mul(lambda));
        let (mut all_qq, mut all_qv) = (qq + more.0, qv + more.1);
        if !is_zero(&tau_by_q) {
            let turned = product(&by_force, &tau_by_q);
            add_multiple(&mut all_qq, constant(1.0), &turned);
            add_multiple(&mut all_qq, constant(1.0), &transposed(&turned));
        }
        if !is_zero(&tau_by_v) {
            add_product(&mut all_qv, &by_force, &tau_by_v);
        }
        let mut qu = more.3;
        add_product(&mut qu, &by_force, &tau_by_u);
        (all_qq, all_qv, vv + more.2, qu, more.4, more.5)
    }
}

/// Returns the second derivatives of `λᵀ v̇`, given the first derivatives of `v̇` and a function that returns
/// the second derivatives of `μᵀ τ` of inverse dynamics for factors `μ`.
///
/// They follow from differentiating the identity `τ(q, v, v̇(q, v, τ)) = τ` twice, with `μ = M⁻ᵀ λ`.
pub fn forward_second_derivatives<T: Real, const NV: usize>(
    (by_q, by_v, inverse): &(SquareMatrix<T, NV>, SquareMatrix<T, NV>, SquareMatrix<T, NV>),
    lambda: &SVector<T, NV>,
    inverse_dynamics: impl FnOnce(&SVector<T, NV>) -> SecondOrder<T, NV>,
) -> SecondOrder<T, NV> {
    let (mut qq, mut qv, vv, qa) = inverse_dynamics(&-inverse.tr_mul(lambda));
    let turned = product(&qa, by_q);
    add_multiple(&mut qq, T::one(), &turned);
    add_multiple(&mut qq, T::one(), &transposed(&turned));
    add_product(&mut qv, &qa, by_v);
    (qq, qv, vv, product(&qa, inverse))
}

impl<M, const NQ: usize, const NV: usize, const NU: usize> SecondDerivatives<NQ, NV, NU> for &M
where
    M: SecondDerivatives<NQ, NV, NU> + ?Sized,
{
    each_function!(second_tangent, plain SecondDerivatives, self => *self);
    each_function!(second, pass SecondDerivatives, self => *self);

    fn visit_constraint_curvature<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: CurvatureVisitor<Self::Scalar, NQ, NV, NU>,
    {
        M::visit_constraint_curvature(self, visitor)
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize> SecondDerivatives<NQ, NV, NU> for At<'_, M, T>
where
    T: Real,
    M: SecondDerivatives<NQ, NV, NU, Scalar = T>,
{
    each_function!(second_tangent, plain SecondDerivatives, self => self.mechanism);
    each_function!(second, at SecondDerivatives, self => self.mechanism);

    fn visit_constraint_curvature<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: CurvatureVisitor<T, NQ, NV, NU>,
    {
        self.mechanism.visit_constraint_curvature(FrozenTimeCurvatureVisitor { visitor, t: self.t })
    }
}
