//! First derivatives of the dynamics for generic code: controllers, estimators and optimisers.

use crate::blocks::{add_product, is_zero, product_with_few, zeros};
use crate::constraint::{Frozen, Visitor};
use crate::forward::each_function;
use crate::private::constant;
use crate::{At, Mechanism, Real, Rheonomic};
use nalgebra::{SMatrix, SVector};

/// `NV` by `NV`.
type Square<T, const NV: usize> = SMatrix<T, NV, NV>;

/// Derivatives by configuration, by velocity, and by `N` forces or inputs.
pub type ByMotion<T, const NV: usize, const N: usize> =
    (SMatrix<T, NV, NV>, SMatrix<T, NV, NV>, SMatrix<T, NV, N>);

/// First derivatives of a mechanism's functions, in blocks of `NV` by `NV` (and by `NU`). `#[mechanism(…, derivatives)]` implements
/// it, with and without constraints; one that is driven in time has [`RheonomicDerivatives`], and this at an instant
/// ([`at`](crate::at)).
///
/// A derivative by `q` is along motions of the configuration: column `i` is along `q ⊕ ε eᵢ` (see
/// [`integrate`](Mechanism::integrate)), for ball and free joints in body axes. So is the change of a configuration.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no derivatives",
    note = "the word asks for them: `#[mechanism(…, derivatives)]`",
    note = "of a mechanism whose equations contain time pass `&at(&mechanism, t)`"
)]
pub trait Derivatives<const NQ: usize, const NV: usize, const NU: usize>: Mechanism<NQ, NV, NU> {
    /// There are [`generalized_momentum_derivatives`](Self::generalized_momentum_derivatives) and
    /// [`momentum_rate_derivatives`](Self::momentum_rate_derivatives): the word `momentum_derivatives` asks for them.
    const MOMENTUM_DERIVATIVES: bool = false;
    /// The velocity along which each input pushes, where every input is one entry of the generalized forces, as motors at joints are:
    /// derivatives by inputs are then columns of those by forces.
    const DIRECT_INPUTS: Option<[usize; NU]> = None;
    /// The velocities of ball and free joints, from the first up to another: derivatives of `q ⊕ dv` are those of the identity elsewhere;
    /// `None` where it is not known which these are.
    const TURNED: Option<(usize, usize)> = None;

    /// `(∂/∂q, ∂/∂dv)` of `q ⊕ dv`, which depend on `dv` alone; identities for plain coordinates.
    fn integrate_derivatives(
        &self,
        dv: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>);

    /// `(∂/∂dv, ∂/∂v)` of [`tangent_rate`](Mechanism::tangent_rate); zero and the identity for plain coordinates.
    fn tangent_rate_derivatives(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>);

    /// `(∂/∂q, ∂/∂dv)` of `q ⊕ dv` at `q`, which does not depend on `q` unless speeds were declared ([`SPEEDS`](Mechanism::SPEEDS)):
    /// [`integrate_derivatives`](Self::integrate_derivatives) is NaN then.
    fn integrate_derivatives_at(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>) {
        self.integrate_derivatives(dv)
    }

    /// `(∂/∂q, ∂/∂dv, ∂/∂v)` of [`displacement_rate`](Mechanism::displacement_rate), whose first is zero unless speeds were declared.
    fn displacement_rate_derivatives(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> ByMotion<Self::Scalar, NV, NV> {
        let (by_dv, by_v) = self.tangent_rate_derivatives(dv, v);
        (SMatrix::zeros(), by_dv, by_v)
    }

    /// The matrix `T` by which displacements between two neighbouring motions change, `δq̇ = T δq + δv`, since it is measured in axes or speeds
    /// that turn along.
    fn turning(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Square<Self::Scalar, NV> {
        let (turning, _) = self.tangent_rate_derivatives(&SVector::zeros(), v);
        // The tangent space moves along, so that the bracket counts twice.
        turning * constant::<Self::Scalar>(2.0)
    }

    /// A matrix `C(q, v)` with `C v` the Coriolis and centrifugal forces, N and N·m, and `Ṁ − 2 C` skew (Echeandia and Wensing,
    /// *Numerical methods to compute the Coriolis matrix and Christoffel symbols*, 2021).
    fn coriolis_matrix(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Square<Self::Scalar, NV>;

    /// `(∂τ/∂q, ∂τ/∂v)` of [`inverse_dynamics`](Mechanism::inverse_dynamics), N and N·m per m, rad, m/s and rad/s; `∂τ/∂a` is
    /// the mass matrix unless forces depend on accelerations (Carpentier and Mansard, *Analytical derivatives of rigid body dynamics algorithms*, 2018).
    fn inverse_dynamics_derivatives(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>);

    /// `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂τ)` of [`forward_dynamics`](Mechanism::forward_dynamics), constraints included. Without constraints
    /// the last is the inverse of the mass matrix.
    fn forward_dynamics_derivatives(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> ByMotion<Self::Scalar, NV, NV>;

    /// Puts the derivatives of forward dynamics, [`forward_dynamics_derivatives`](Self::forward_dynamics_derivatives), into matrices
    /// and returns the accelerations, which are calculated with them once. The matrices are zero, or hold what this function of the same
    /// mechanism put there before: entries that are always zero are not written.
    fn forward_dynamics_derivatives_into(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
        by_q: &mut Square<Self::Scalar, NV>,
        by_v: &mut Square<Self::Scalar, NV>,
        by_tau: &mut Square<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        (*by_q, *by_v, *by_tau) = Derivatives::forward_dynamics_derivatives(self, q, v, tau);
        Mechanism::forward_dynamics(self, q, v, tau)
    }

    /// `(∂τ/∂q, ∂τ/∂v, ∂τ/∂u)` of [`generalized_forces`](Mechanism::generalized_forces).
    fn generalized_forces_derivatives(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> ByMotion<Self::Scalar, NV, NU>;

    /// `∂p/∂q` of [`generalized_momentum`](Mechanism::generalized_momentum); `∂p/∂v` is the mass matrix. NaN without
    /// [`MOMENTUM_DERIVATIVES`](Self::MOMENTUM_DERIVATIVES).
    fn generalized_momentum_derivatives(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
    ) -> Square<Self::Scalar, NV> {
        unknown()
    }

    /// `(∂ṗ/∂q, ∂ṗ/∂v)` of [`momentum_rate`](Mechanism::momentum_rate). NaN without
    /// [`MOMENTUM_DERIVATIVES`](Self::MOMENTUM_DERIVATIVES).
    fn momentum_rate_derivatives(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>) {
        (unknown(), unknown())
    }

    /// Hands the mechanism to `visitor` with the numbers of its constraints, where it has derivatives of them; `None` elsewhere.
    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }

    /// The motion under the inputs `u` to first order.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// #[mechanism(gravity = -9.81 * y, derivatives)]
    /// struct Pendulum {
    ///     #[body(mass = 2, com = -0.5 * y)]
    ///     bob: Body,
    ///     #[joint(ground -> bob, about = z)]
    ///     hinge: Pin,
    ///     #[acts(on = hinge)]
    ///     motor: Torque,
    /// }
    ///
    /// /// How fast it swings when it is let go: by the eigenvalue of the linear system, for any mechanism of one coordinate.
    /// fn frequency<M: Derivatives<1, 1, 1, Scalar = f64>>(m: &M) -> f64 {
    ///     let linear = m.linear_motion(&m.neutral(), &[0.0].into(), &[0.0].into());
    ///     (-linear.by_q[0]).sqrt()
    /// }
    /// assert!((frequency(&Pendulum {}) - (9.81_f64 / 0.5).sqrt()).abs() < 1e-12);
    /// ```
    fn linear_motion(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> LinearMotion<Self::Scalar, NV, NU> {
        let (mut by_q, mut by_v, mut by_u) = (zeros(), zeros(), zeros());
        let t = crate::private::constant(0.0);
        let acceleration = accelerated_into(&self, t, (q, v), u, (&mut by_q, &mut by_v, &mut by_u));
        LinearMotion { acceleration, by_q, by_v, by_u, turning: Derivatives::turning(self, q, v) }
    }
}

/// Derivatives of the accelerations by state and inputs, of those by state and forces and of the forces'.
pub(crate) fn under_inputs<T: Real, const NV: usize, const NU: usize>(
    (mut by_q, mut by_v, by_force): ByMotion<T, NV, NV>,
    (force_by_q, force_by_v, force_by_u): &ByMotion<T, NV, NU>,
) -> ByMotion<T, NV, NU> {
    // Most inputs push along joints.
    for (by_state, of_force) in [(&mut by_q, force_by_q), (&mut by_v, force_by_v)] {
        if !is_zero(of_force) {
            add_product(by_state, &by_force, of_force);
        }
    }
    (by_q, by_v, product_with_few(&by_force, force_by_u))
}

/// The acceleration under the inputs `u`, whose derivatives by configuration, velocity and inputs go into matrices of zeros.
pub(crate) fn accelerated_into<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    u: &SVector<T, NU>,
    (by_q, by_v, by_u): (&mut Square<T, NV>, &mut Square<T, NV>, &mut SMatrix<T, NV, NU>),
) -> SVector<T, NV>
where
    T: Real,
    M: RheonomicDerivatives<NQ, NV, NU, Scalar = T>,
{
    let tau = m.generalized_forces(t, q, v, u);
    let mut by_force = zeros();
    let acceleration = m.forward_dynamics_derivatives_into(t, q, v, &tau, by_q, by_v, &mut by_force);
    if let Some(places) = M::DIRECT_INPUTS {
        let columns = places.iter().filter_map(|k| by_force.data.0.get(*k));
        by_u.data.0.iter_mut().zip(columns).for_each(|(to, from)| *to = *from);
        return acceleration;
    }
    let of_force = m.generalized_forces_derivatives(t, q, v, u);
    (*by_q, *by_v, *by_u) = under_inputs((*by_q, *by_v, by_force), &of_force);
    acceleration
}

/// [`Mechanism::acceleration_derivatives`] of mechanisms with derivatives.
pub fn acceleration_derivatives<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: M::Scalar,
    q: &SVector<M::Scalar, NQ>,
    v: &SVector<M::Scalar, NV>,
    u: &SVector<M::Scalar, NU>,
) -> Option<ByMotion<M::Scalar, NV, NU>>
where
    M: RheonomicDerivatives<NQ, NV, NU>,
{
    let (mut by_q, mut by_v, mut by_u) = (zeros(), zeros(), zeros());
    accelerated_into(m, t, (q, v), u, (&mut by_q, &mut by_v, &mut by_u));
    Some((by_q, by_v, by_u))
}

/// What [`Derivatives`] are for a mechanism whose functions depend on time `t`, s. Every mechanism with [`Derivatives`] has
/// these, too.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no derivatives",
    note = "the word asks for them: `#[mechanism(…, derivatives)]`"
)]
pub trait RheonomicDerivatives<const NQ: usize, const NV: usize, const NU: usize>:
    Rheonomic<NQ, NV, NU>
{
    /// There are derivatives of momenta ([`Derivatives::MOMENTUM_DERIVATIVES`]).
    const MOMENTUM_DERIVATIVES: bool = false;
    /// Where inputs are entries of the generalized forces ([`Derivatives::DIRECT_INPUTS`]).
    const DIRECT_INPUTS: Option<[usize; NU]> = None;
    /// The velocities of ball and free joints ([`Derivatives::TURNED`]).
    const TURNED: Option<(usize, usize)> = None;

    /// `(∂/∂q, ∂/∂dv)` of `q ⊕ dv` ([`Derivatives::integrate_derivatives`]).
    fn integrate_derivatives(
        &self,
        dv: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>);

    /// `(∂/∂dv, ∂/∂v)` of the rate of `dv` ([`Derivatives::tangent_rate_derivatives`]).
    fn tangent_rate_derivatives(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>);

    /// `(∂/∂q, ∂/∂dv)` of `q ⊕ dv` at `q` ([`Derivatives::integrate_derivatives_at`]).
    fn integrate_derivatives_at(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>) {
        self.integrate_derivatives(dv)
    }

    /// `(∂/∂q, ∂/∂dv, ∂/∂v)` of [`displacement_rate`](Rheonomic::displacement_rate) ([`Derivatives::displacement_rate_derivatives`]).
    fn displacement_rate_derivatives(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> ByMotion<Self::Scalar, NV, NV> {
        let (by_dv, by_v) = self.tangent_rate_derivatives(dv, v);
        (SMatrix::zeros(), by_dv, by_v)
    }

    /// The matrix `T` by which displacements between two neighbouring motions change, `δq̇ = T δq + δv` ([`Derivatives::turning`]).
    fn turning(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Square<Self::Scalar, NV> {
        let (turning, _) = self.tangent_rate_derivatives(&SVector::zeros(), v);
        // The tangent space moves along, so that the bracket counts twice.
        turning * constant::<Self::Scalar>(2.0)
    }

    /// A matrix `C(t, q, v)` of Coriolis and centrifugal forces ([`Derivatives::coriolis_matrix`]).
    fn coriolis_matrix(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Square<Self::Scalar, NV>;

    /// `(∂τ/∂q, ∂τ/∂v)` ([`Derivatives::inverse_dynamics_derivatives`]).
    fn inverse_dynamics_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>);

    /// `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂τ)` ([`Derivatives::forward_dynamics_derivatives`]).
    fn forward_dynamics_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> ByMotion<Self::Scalar, NV, NV>;

    /// Puts `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂τ)` into matrices and returns `v̇` ([`Derivatives::forward_dynamics_derivatives_into`]).
    #[allow(clippy::too_many_arguments, reason = "one each")]
    fn forward_dynamics_derivatives_into(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
        by_q: &mut Square<Self::Scalar, NV>,
        by_v: &mut Square<Self::Scalar, NV>,
        by_tau: &mut Square<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        (*by_q, *by_v, *by_tau) = self.forward_dynamics_derivatives(t, q, v, tau);
        self.forward_dynamics(t, q, v, tau)
    }

    /// `(∂τ/∂q, ∂τ/∂v, ∂τ/∂u)` of the inputs' forces ([`Derivatives::generalized_forces_derivatives`]).
    fn generalized_forces_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> ByMotion<Self::Scalar, NV, NU>;

    /// `∂p/∂q` of the generalized momentum ([`Derivatives::generalized_momentum_derivatives`]).
    fn generalized_momentum_derivatives(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
    ) -> Square<Self::Scalar, NV> {
        unknown()
    }

    /// `(∂ṗ/∂q, ∂ṗ/∂v)` of its rate ([`Derivatives::momentum_rate_derivatives`]).
    fn momentum_rate_derivatives(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
    ) -> (Square<Self::Scalar, NV>, Square<Self::Scalar, NV>) {
        (unknown(), unknown())
    }

    /// Hands the mechanism to `visitor` with the numbers of its constraints ([`Derivatives::visit_constraints`]).
    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }
}

/// What is not there.
pub(crate) fn unknown<T: Real, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    SMatrix::repeat(constant(f64::NAN))
}

/// A motion under inputs to first order: how displacements `δq` (in body axes for ball and free joints) and changes of velocity
/// grow, `δq̇ = turning δq + δv`, `δv̇ = by_q δq + by_v δv + by_u δu`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearMotion<T, const NV: usize, const NU: usize> {
    /// `v̇`, m/s² and rad/s².
    pub acceleration: SVector<T, NV>,
    /// `∂v̇/∂q`.
    pub by_q: SMatrix<T, NV, NV>,
    /// `∂v̇/∂v`.
    pub by_v: SMatrix<T, NV, NV>,
    /// `∂v̇/∂u`.
    pub by_u: SMatrix<T, NV, NU>,
    /// What displacements in turning axes add to their own rates, `δq × v`; zero for plain coordinates.
    pub turning: SMatrix<T, NV, NV>,
}

/// An entry of one of four blocks.
pub(crate) fn entry<T: Real, const NV: usize>(blocks: [[&Square<T, NV>; 2]; 2], i: usize, j: usize) -> T {
    let of = |k: usize| if k < NV { (0, k) } else { (1, k - NV) };
    let ((row, i), (column, j)) = (of(i), of(j));
    let block = blocks.get(row).and_then(|blocks| blocks.get(column)).and_then(|block| block.get((i, j)));
    block.copied().unwrap_or(T::zero())
}

/// A matrix of one column of blocks.
pub(crate) fn column<T: Real, const NV: usize, const NU: usize, const NX: usize>(
    above: &SMatrix<T, NV, NU>,
    below: &SMatrix<T, NV, NU>,
) -> SMatrix<T, NX, NU> {
    SMatrix::from_fn(|i, j| {
        let entry = if i < NV { above.get((i, j)) } else { below.get((i - NV, j)) };
        entry.copied().unwrap_or(T::zero())
    })
}

impl<T: Real, const NV: usize, const NU: usize> LinearMotion<T, NV, NU> {
    /// `A` of `ẋ = A x + B δu`, with `x` the displacements, then the changes of velocity. `NX` is `2 NV`, which the type that
    /// is asked for says; any other does not compile.
    pub fn a<const NX: usize>(&self) -> SMatrix<T, NX, NX> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many rows as there are velocities") };
        let identity = Square::identity();
        SMatrix::from_fn(|i, j| entry([[&self.turning, &identity], [&self.by_q, &self.by_v]], i, j))
    }

    /// `B` of `ẋ = A x + B δu`; `NX` is `2 NV`.
    pub fn b<const NX: usize>(&self) -> SMatrix<T, NX, NU> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many rows as there are velocities") };
        column(&SMatrix::zeros(), &self.by_u)
    }
}

impl<M, const NQ: usize, const NV: usize, const NU: usize> Derivatives<NQ, NV, NU> for &M
where
    M: Derivatives<NQ, NV, NU> + ?Sized,
{
    const MOMENTUM_DERIVATIVES: bool = M::MOMENTUM_DERIVATIVES;
    const DIRECT_INPUTS: Option<[usize; NU]> = M::DIRECT_INPUTS;
    const TURNED: Option<(usize, usize)> = M::TURNED;

    each_function!(tangent, plain Derivatives, self => *self);
    each_function!(derivatives, plain Derivatives, self => *self);

    fn visit_constraints<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: Visitor<Self::Scalar, NQ, NV, NU>,
    {
        M::visit_constraints(self, visitor)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> RheonomicDerivatives<NQ, NV, NU> for M
where
    M: Derivatives<NQ, NV, NU>,
{
    const MOMENTUM_DERIVATIVES: bool = M::MOMENTUM_DERIVATIVES;
    const DIRECT_INPUTS: Option<[usize; NU]> = M::DIRECT_INPUTS;
    const TURNED: Option<(usize, usize)> = M::TURNED;

    each_function!(tangent, plain Derivatives, self => self);
    each_function!(derivatives, drop Derivatives, self => self);

    fn visit_constraints<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: Visitor<Self::Scalar, NQ, NV, NU>,
    {
        Derivatives::visit_constraints(self, visitor)
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize> Derivatives<NQ, NV, NU> for At<'_, M, T>
where
    T: Real,
    M: RheonomicDerivatives<NQ, NV, NU, Scalar = T>,
{
    const MOMENTUM_DERIVATIVES: bool = M::MOMENTUM_DERIVATIVES;
    const DIRECT_INPUTS: Option<[usize; NU]> = M::DIRECT_INPUTS;
    const TURNED: Option<(usize, usize)> = M::TURNED;

    each_function!(tangent, plain RheonomicDerivatives, self => self.mechanism);
    each_function!(derivatives, at RheonomicDerivatives, self => self.mechanism, self.t);

    fn visit_constraints<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: Visitor<Self::Scalar, NQ, NV, NU>,
    {
        self.mechanism.visit_constraints(Frozen { visitor, t: self.t })
    }
}
