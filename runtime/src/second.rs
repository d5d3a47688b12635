//! Second derivatives of the dynamics for generic code: differential dynamic programming, Newton's method on trajectories.

use crate::blocks::{add_multiple, add_product, is_zero, product, transposed};
use crate::constraint::{CurvatureVisitor, FrozenCurvature};
use crate::forward::each_function;
use crate::private::constant;
use crate::{At, Derivatives, Real, RheonomicDerivatives};
use nalgebra::{SMatrix, SVector};

/// `NV` by `NV`.
type Square<T, const NV: usize> = SMatrix<T, NV, NV>;

/// Second derivatives by configuration twice, by configuration (rows) and velocity, by velocity twice, and by configuration (rows)
/// and a third argument of the function: acceleration, force or input. All are contracted with factors `λ`.
pub type SecondOrder<T, const NV: usize> = (Square<T, NV>, Square<T, NV>, Square<T, NV>, Square<T, NV>);

/// Second derivatives by configuration twice, by configuration (rows) and velocity, by velocity twice, by configuration (rows) and
/// input, by velocity (rows) and input, and by inputs twice. All are contracted with factors `λ`.
pub type InputSecondOrder<T, const NV: usize, const NU: usize> =
    (Square<T, NV>, Square<T, NV>, Square<T, NV>, SMatrix<T, NV, NU>, SMatrix<T, NV, NU>, SMatrix<T, NU, NU>);

/// Second derivatives of a mechanism's functions, contracted with factors `λ`: Hessians of `λᵀ f`, in blocks of `NV` by `NV` (and by
/// `NU`). `#[mechanism(…, second_derivatives)]` implements it, with and without constraints, unless contacts slip; one that is driven
/// in time has [`RheonomicSecondDerivatives`], and this at an instant ([`at`](crate::at)).
///
/// Along `q ⊕ ε dq` a function changes by `½ ε² dqᵀ H dq` beyond the first order, with `H` the derivatives by configuration twice;
/// for ball and free joints `dq` is a motion in body axes.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no second derivatives",
    note = "the word asks for them: `#[mechanism(…, second_derivatives)]`",
    note = "of a mechanism whose equations contain time pass `&at(&mechanism, t)`; with contacts that slip there are none"
)]
pub trait SecondDerivatives<const NQ: usize, const NV: usize, const NU: usize>:
    Derivatives<NQ, NV, NU>
{
    /// `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂a)` of `λᵀ τ` by [`inverse_dynamics`](crate::Mechanism::inverse_dynamics) (Singh, Russell
    /// and Wensing, *Second-order derivatives of rigid-body dynamics*, 2023). Those by `v` and `a`, and by `a` twice, are zero.
    fn inverse_dynamics_second_derivatives(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> SecondOrder<Self::Scalar, NV>;

    /// `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂τ)` of `λᵀ v̇` by [`forward_dynamics`](crate::Mechanism::forward_dynamics), constraints
    /// included. Those by `v` and `τ`, and by `τ` twice, are zero.
    fn forward_dynamics_second_derivatives(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> SecondOrder<Self::Scalar, NV>;

    /// All of `λᵀ τ` by [`generalized_forces`](crate::Mechanism::generalized_forces); zero where inputs act along joints.
    fn generalized_forces_second_derivatives(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> InputSecondOrder<Self::Scalar, NV, NU>;

    /// `(∂²/∂dv∂dv, ∂²/∂dv∂v)` of `λᵀ` [`tangent_rate`](crate::Mechanism::tangent_rate), of mixed ones with `dv` as rows; zero for plain coordinates.
    fn tangent_rate_second_derivatives(
        &self,
        _dv: &SVector<Self::Scalar, NV>,
        _v: &SVector<Self::Scalar, NV>,
        _lambda: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>) {
        (SMatrix::zeros(), SMatrix::zeros())
    }

    /// Hands the mechanism to `visitor` with the numbers of its constraints, where those have second derivatives; `None` elsewhere.
    fn visit_constraint_curvature<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: CurvatureVisitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }

    /// The second derivatives of `λᵀ v̇`, with `v̇` the acceleration under the inputs `u`: by state and inputs.
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
    ) -> InputSecondOrder<Self::Scalar, NV, NU> {
        let tau = crate::Mechanism::generalized_forces(self, q, v, u);
        let (_, _, inverse) = Derivatives::forward_dynamics_derivatives(self, q, v, &tau);
        let (tau_by_q, tau_by_v, tau_by_u) = Derivatives::generalized_forces_derivatives(self, q, v, u);
        let (qq, qv, vv, by_force) =
            SecondDerivatives::forward_dynamics_second_derivatives(self, q, v, &tau, lambda);
        let more =
            SecondDerivatives::generalized_forces_second_derivatives(self, q, v, u, &inverse.tr_mul(lambda));
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

/// What [`SecondDerivatives`] are for a mechanism whose functions depend on time `t`, s. Every mechanism with [`SecondDerivatives`]
/// has these, too.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no second derivatives",
    note = "the word asks for them: `#[mechanism(…, second_derivatives)]`; with contacts that slip there are none"
)]
pub trait RheonomicSecondDerivatives<const NQ: usize, const NV: usize, const NU: usize>:
    RheonomicDerivatives<NQ, NV, NU>
{
    /// `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂a)` of `λᵀ τ` ([`SecondDerivatives::inverse_dynamics_second_derivatives`]).
    fn inverse_dynamics_second_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> SecondOrder<Self::Scalar, NV>;

    /// `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂τ)` of `λᵀ v̇` ([`SecondDerivatives::forward_dynamics_second_derivatives`]).
    fn forward_dynamics_second_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> SecondOrder<Self::Scalar, NV>;

    /// Those of the inputs' `λᵀ τ` ([`SecondDerivatives::generalized_forces_second_derivatives`]).
    fn generalized_forces_second_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
        lambda: &SVector<Self::Scalar, NV>,
    ) -> InputSecondOrder<Self::Scalar, NV, NU>;

    /// `(∂²/∂dv∂dv, ∂²/∂dv∂v)` of `λᵀ` [`tangent_rate`](crate::Rheonomic::tangent_rate), of mixed ones with `dv` as rows; zero for plain coordinates.
    fn tangent_rate_second_derivatives(
        &self,
        _dv: &SVector<Self::Scalar, NV>,
        _v: &SVector<Self::Scalar, NV>,
        _lambda: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>) {
        (SMatrix::zeros(), SMatrix::zeros())
    }

    /// Hands the mechanism to `visitor` with the numbers of its constraints ([`SecondDerivatives::visit_constraint_curvature`]).
    fn visit_constraint_curvature<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: CurvatureVisitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }
}

/// Second derivatives of `λᵀ v̇` from first ones of `v̇` and from those of `μᵀ τ` of inverse dynamics for given factors `μ`.
///
/// `τ(q, v, v̇(q, v, τ))` is `τ`; differentiated twice, with `μ = M⁻ᵀ λ`.
pub fn forward_second_derivatives<T: Real, const NV: usize>(
    (by_q, by_v, inverse): &(Square<T, NV>, Square<T, NV>, Square<T, NV>),
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
    each_function!(second, plain SecondDerivatives, self => *self);

    fn visit_constraint_curvature<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: CurvatureVisitor<Self::Scalar, NQ, NV, NU>,
    {
        M::visit_constraint_curvature(self, visitor)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> RheonomicSecondDerivatives<NQ, NV, NU> for M
where
    M: SecondDerivatives<NQ, NV, NU>,
{
    each_function!(second_tangent, plain SecondDerivatives, self => self);
    each_function!(second, drop SecondDerivatives, self => self);

    fn visit_constraint_curvature<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: CurvatureVisitor<Self::Scalar, NQ, NV, NU>,
    {
        SecondDerivatives::visit_constraint_curvature(self, visitor)
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize> SecondDerivatives<NQ, NV, NU> for At<'_, M, T>
where
    T: Real,
    M: RheonomicSecondDerivatives<NQ, NV, NU, Scalar = T>,
{
    each_function!(second_tangent, plain RheonomicSecondDerivatives, self => self.mechanism);
    each_function!(second, at RheonomicSecondDerivatives, self => self.mechanism, self.t);

    fn visit_constraint_curvature<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: CurvatureVisitor<T, NQ, NV, NU>,
    {
        self.mechanism.visit_constraint_curvature(FrozenCurvature { visitor, t: self.t })
    }
}
