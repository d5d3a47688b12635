//! First derivatives of the dynamics for generic code: controllers, estimators and optimisers.

use crate::blocks::{add_product, is_zero, product_with_mostly_zero_matrix, zeros};
use crate::constraint::{FrozenTimeVisitor, Visitor};
use crate::forward::{constants, each_function};
use crate::private::constant;
use crate::{At, Mechanism, Real, Scleronomic};
use nalgebra::{SMatrix, SVector};

/// Square matrix with one row and one column for each of the `NV` velocities.
type SquareMatrix<T, const NV: usize> = SMatrix<T, NV, NV>;

/// Derivatives with respect to configuration, velocity, and `N` forces or inputs.
pub type ByMotion<T, const NV: usize, const N: usize> =
    (SMatrix<T, NV, NV>, SMatrix<T, NV, NV>, SMatrix<T, NV, N>);

/// First derivatives of a mechanism's functions, in blocks of `NV` by `NV` (and by `NU`). `#[mechanism(…,
/// derivatives)]` implements the trait, with and without constraints. Arguments are those of [`Mechanism`].
///
/// Derivatives with respect to `q` are along displacements of the configuration: column `i` is the derivative
/// along `q ⊕ ε eᵢ` (see [`integrate`](Mechanism::integrate)), in body axes for ball and free joints. Changes
/// of a configuration are expressed in the same way.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no derivatives",
    note = "enable them with the option: `#[mechanism(…, derivatives)]`"
)]
pub trait Derivatives<const NQ: usize, const NV: usize, const NU: usize>: Mechanism<NQ, NV, NU> {
    /// Whether [`generalized_momentum_derivatives`](Self::generalized_momentum_derivatives) and
    /// [`momentum_rate_derivatives`](Self::momentum_rate_derivatives) are available, through the option
    /// `momentum_derivatives`.
    const MOMENTUM_DERIVATIVES: bool = false;
    /// Index of the velocity on which each input acts, if every input is exactly one generalized force, such
    /// as a joint motor. Derivatives with respect to inputs are then columns of those with respect to forces.
    const DIRECT_INPUTS: Option<[usize; NU]> = None;
    /// Half-open range of the velocities of ball and free joints. Outside this range the derivatives of
    /// `q ⊕ dv` are those of a vector space (identity); `None` if unknown.
    const TURNED: Option<(usize, usize)> = None;

    /// Returns the derivatives `(∂/∂q, ∂/∂dv)` of the displaced configuration `q ⊕ dv`, which depend on `dv`
    /// alone. They are identities for coordinates whose rates are the velocities.
    fn integrate_derivatives(
        &self,
        dv: &SVector<Self::Scalar, NV>,
    ) -> (SquareMatrix<Self::Scalar, NV>, SquareMatrix<Self::Scalar, NV>);

    /// Returns the derivatives `(∂/∂dv, ∂/∂v)` of [`tangent_rate`](Mechanism::tangent_rate): zero and the
    /// identity for coordinates whose rates are the velocities.
    fn tangent_rate_derivatives(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> (SquareMatrix<Self::Scalar, NV>, SquareMatrix<Self::Scalar, NV>);

    /// Returns the derivatives `(∂/∂q, ∂/∂dv)` of the displaced configuration `q ⊕ dv` at `q`. They depend on
    /// `q` only if generalized speeds are declared ([`SPEEDS`](crate::integrate::Hooks::SPEEDS));
    /// [`integrate_derivatives`](Self::integrate_derivatives) is then NaN.
    fn integrate_derivatives_at(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> (SquareMatrix<Self::Scalar, NV>, SquareMatrix<Self::Scalar, NV>) {
        self.integrate_derivatives(dv)
    }

    /// Returns the derivatives `(∂/∂q, ∂/∂dv, ∂/∂v)` of [`displacement_rate`](Mechanism::displacement_rate).
    /// The first is zero unless generalized speeds are declared.
    fn displacement_rate_derivatives(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> ByMotion<Self::Scalar, NV, NV> {
        let (by_dv, by_v) = self.tangent_rate_derivatives(dv, v);
        (SMatrix::zeros(), by_dv, by_v)
    }

    /// Returns the matrix `T` in the rate of the displacement between two neighbouring motions, `δq̇ = T δq +
    /// δv`. It results from measuring the displacement in rotating axes or in configuration-dependent
    /// generalized speeds.
    fn turning(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SquareMatrix<Self::Scalar, NV> {
        let (turning, _) = self.tangent_rate_derivatives(&SVector::zeros(), v);
        // The tangent space moves with the configuration, so that the Lie bracket counts twice.
        turning * constant::<Self::Scalar>(2.0)
    }

    /// Returns a matrix `C(q, v)` with `C v` the Coriolis and centrifugal forces, N and N·m, and `Ṁ − 2 C`
    /// skew-symmetric (Echeandia and Wensing, *Numerical methods to compute the Coriolis matrix and
    /// Christoffel symbols*, 2021).
    fn coriolis_matrix(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SquareMatrix<Self::Scalar, NV>;

    /// Returns `(∂τ/∂q, ∂τ/∂v)` of [`inverse_dynamics`](Mechanism::inverse_dynamics), N and N·m per m, rad,
    /// m/s and rad/s; `∂τ/∂a` is the mass matrix unless forces depend on accelerations (Carpentier and
    /// Mansard, *Analytical derivatives of rigid body dynamics algorithms*, 2018).
    fn inverse_dynamics_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> (SquareMatrix<Self::Scalar, NV>, SquareMatrix<Self::Scalar, NV>);

    /// Returns `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂τ)` of [`forward_dynamics`](Mechanism::forward_dynamics), constraints
    /// included. Without constraints `∂v̇/∂τ` is the inverse of the mass matrix.
    fn forward_dynamics_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> ByMotion<Self::Scalar, NV, NV>;

    /// Writes [`forward_dynamics_derivatives`](Self::forward_dynamics_derivatives) to matrices and returns
    /// the accelerations, which are computed once together with them. On entry, the matrices must be zero or
    /// contain the results of an earlier call for the same mechanism: entries that are always zero are not
    /// written.
    #[allow(clippy::too_many_arguments, reason = "one each")]
    fn forward_dynamics_derivatives_into(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
        by_q: &mut SquareMatrix<Self::Scalar, NV>,
        by_v: &mut SquareMatrix<Self::Scalar, NV>,
        by_tau: &mut SquareMatrix<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        (*by_q, *by_v, *by_tau) = self.forward_dynamics_derivatives(t, q, v, tau);
        self.forward_dynamics(t, q, v, tau)
    }

    /// Returns `(∂τ/∂q, ∂τ/∂v, ∂τ/∂u)` of the generalized forces `τ` of the inputs
    /// ([`generalized_forces`](Mechanism::generalized_forces)).
    fn generalized_forces_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> ByMotion<Self::Scalar, NV, NU>;

    /// Returns `∂p/∂q` of [`generalized_momentum`](Mechanism::generalized_momentum); `∂p/∂v` is the mass
    /// matrix. NaN without [`MOMENTUM_DERIVATIVES`](Self::MOMENTUM_DERIVATIVES).
    fn generalized_momentum_derivatives(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
    ) -> SquareMatrix<Self::Scalar, NV> {
        nan_matrix()
    }

    /// Returns `(∂ṗ/∂q, ∂ṗ/∂v)` of [`momentum_rate`](Mechanism::momentum_rate). NaN without
    /// [`MOMENTUM_DERIVATIVES`](Self::MOMENTUM_DERIVATIVES).
    fn momentum_rate_derivatives(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
    ) -> (SquareMatrix<Self::Scalar, NV>, SquareMatrix<Self::Scalar, NV>) {
        (nan_matrix(), nan_matrix())
    }

    /// Passes the mechanism to `visitor`, with the numbers of its constraints as const parameters, if their
    /// derivatives are available; otherwise returns `None`.
    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }

    /// Returns the acceleration under the inputs `u`, linearised about a state. If the equations of the
    /// mechanism contain time, call it on the mechanism at a fixed time, [`at`](crate::at).
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
    /// /// Frequency of small oscillations of any mechanism of one coordinate, from the eigenvalue.
    /// fn frequency<M: Derivatives<1, 1, 1, Scalar = f64> + linkwork::Scleronomic>(m: &M) -> f64 {
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
    ) -> LinearMotion<Self::Scalar, NV, NU>
    where
        Self: Scleronomic,
    {
        linear_motion(self, q, v, u)
    }
}

/// Computes the linearised motion as the default implementation of [`Derivatives::linear_motion`].
pub(crate) fn linear_motion<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    q: &SVector<M::Scalar, NQ>,
    v: &SVector<M::Scalar, NV>,
    u: &SVector<M::Scalar, NU>,
) -> LinearMotion<M::Scalar, NV, NU>
where
    M: Derivatives<NQ, NV, NU> + ?Sized,
{
    let (mut by_q, mut by_v, mut by_u) = (zeros(), zeros(), zeros());
    let acceleration =
        write_acceleration_derivatives(&m, constant(0.0), (q, v), u, (&mut by_q, &mut by_v, &mut by_u));
    LinearMotion { acceleration, by_q, by_v, by_u, turning: Derivatives::turning(m, q, v) }
}

/// Converts acceleration derivatives with respect to state and forces to derivatives with respect to state
/// and inputs, given the derivatives of the forces of the inputs.
pub(crate) fn convert_to_input_derivatives<T: Real, const NV: usize, const NU: usize>(
    (mut by_q, mut by_v, by_force): ByMotion<T, NV, NV>,
    (force_by_q, force_by_v, force_by_u): &ByMotion<T, NV, NU>,
) -> ByMotion<T, NV, NU> {
    // Skips zero derivatives: most inputs act directly along joints.
    for (by_state, of_force) in [(&mut by_q, force_by_q), (&mut by_v, force_by_v)] {
        if !is_zero(of_force) {
            add_product(by_state, &by_force, of_force);
        }
    }
    (by_q, by_v, product_with_mostly_zero_matrix(&by_force, force_by_u))
}

/// Returns the acceleration under the inputs `u`, and writes its derivatives with respect to configuration,
/// velocity and inputs to zero matrices.
pub(crate) fn write_acceleration_derivatives<M, T, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: T,
    (q, v): (&SVector<T, NQ>, &SVector<T, NV>),
    u: &SVector<T, NU>,
    (by_q, by_v, by_u): (&mut SquareMatrix<T, NV>, &mut SquareMatrix<T, NV>, &mut SMatrix<T, NV, NU>),
) -> SVector<T, NV>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
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
    (*by_q, *by_v, *by_u) = convert_to_input_derivatives((*by_q, *by_v, by_force), &of_force);
    acceleration
}

/// Computes [`acceleration_derivatives`](crate::integrate::Hooks::acceleration_derivatives) for mechanisms
/// with derivatives.
pub fn acceleration_derivatives<M, const NQ: usize, const NV: usize, const NU: usize>(
    m: &M,
    t: M::Scalar,
    q: &SVector<M::Scalar, NQ>,
    v: &SVector<M::Scalar, NV>,
    u: &SVector<M::Scalar, NU>,
) -> Option<ByMotion<M::Scalar, NV, NU>>
where
    M: Derivatives<NQ, NV, NU>,
{
    let (mut by_q, mut by_v, mut by_u) = (zeros(), zeros(), zeros());
    write_acceleration_derivatives(m, t, (q, v), u, (&mut by_q, &mut by_v, &mut by_u));
    Some((by_q, by_v, by_u))
}

/// Returns a matrix of NaN, for derivatives that are not available.
pub(crate) fn nan_matrix<T: Real, const R: usize, const C: usize>() -> SMatrix<T, R, C> {
    SMatrix::repeat(constant(f64::NAN))
}

/// Linearised motion under inputs: the rates of displacements `δq` (in body axes for ball and free joints)
/// and of changes of velocity, `δq̇ = turning δq + δv`, `δv̇ = by_q δq + by_v δv + by_u δu`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearMotion<T, const NV: usize, const NU: usize> {
    /// Acceleration `v̇` at the state of linearisation, m/s² and rad/s².
    pub acceleration: SVector<T, NV>,
    /// Derivative `∂v̇/∂q` of the acceleration with respect to the configuration.
    pub by_q: SMatrix<T, NV, NV>,
    /// Derivative `∂v̇/∂v` of the acceleration with respect to the velocity.
    pub by_v: SMatrix<T, NV, NV>,
    /// Derivative `∂v̇/∂u` of the acceleration with respect to the inputs.
    pub by_u: SMatrix<T, NV, NU>,
    /// Contribution of rotating axes to the rates of displacements, `δq × v`; zero for plain coordinates.
    pub turning: SMatrix<T, NV, NV>,
}

/// Returns entry `(i, j)` of the matrix composed of two by two blocks.
pub(crate) fn entry_of_two_by_two_blocks<T: Real, const NV: usize>(
    blocks: [[&SquareMatrix<T, NV>; 2]; 2],
    i: usize,
    j: usize,
) -> T {
    let block_and_entry_index = |k: usize| if k < NV { (0, k) } else { (1, k - NV) };
    let ((row, i), (column, j)) = (block_and_entry_index(i), block_and_entry_index(j));
    let block = blocks.get(row).and_then(|blocks| blocks.get(column)).and_then(|block| block.get((i, j)));
    block.copied().unwrap_or(T::zero())
}

/// Returns the matrix that stacks the block `above` on the block `below`.
pub(crate) fn stack_blocks_vertically<T: Real, const NV: usize, const NU: usize, const NX: usize>(
    above: &SMatrix<T, NV, NU>,
    below: &SMatrix<T, NV, NU>,
) -> SMatrix<T, NX, NU> {
    SMatrix::from_fn(|i, j| {
        let entry = if i < NV { above.get((i, j)) } else { below.get((i - NV, j)) };
        entry.copied().unwrap_or(T::zero())
    })
}

impl<T: Real, const NV: usize, const NU: usize> LinearMotion<T, NV, NU> {
    /// Returns the matrix `A` of the linearised motion `ẋ = A x + B δu`, where `x` contains the
    /// displacements, then the changes of velocity. `NX` is `2 NV`, inferred from the requested type; any
    /// other value does not compile.
    pub fn a<const NX: usize>(&self) -> SMatrix<T, NX, NX> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many rows as there are velocities") };
        let identity = SquareMatrix::identity();
        SMatrix::from_fn(|i, j| {
            entry_of_two_by_two_blocks([[&self.turning, &identity], [&self.by_q, &self.by_v]], i, j)
        })
    }

    /// Returns the matrix `B` of the linearised motion `ẋ = A x + B δu`. `NX` is `2 NV`.
    pub fn b<const NX: usize>(&self) -> SMatrix<T, NX, NU> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many rows as there are velocities") };
        stack_blocks_vertically(&SMatrix::zeros(), &self.by_u)
    }
}

impl<M, const NQ: usize, const NV: usize, const NU: usize> Derivatives<NQ, NV, NU> for &M
where
    M: Derivatives<NQ, NV, NU> + ?Sized,
{
    constants!(derivatives, M);

    each_function!(tangent, plain Derivatives, self => *self);
    each_function!(derivatives, pass Derivatives, self => *self);

    fn visit_constraints<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: Visitor<Self::Scalar, NQ, NV, NU>,
    {
        M::visit_constraints(self, visitor)
    }
}

impl<M, T, const NQ: usize, const NV: usize, const NU: usize> Derivatives<NQ, NV, NU> for At<'_, M, T>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
{
    constants!(derivatives, M);

    each_function!(tangent, plain Derivatives, self => self.mechanism);
    each_function!(derivatives, at Derivatives, self => self.mechanism);

    fn visit_constraints<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: Visitor<Self::Scalar, NQ, NV, NU>,
    {
        self.mechanism.visit_constraints(FrozenTimeVisitor { visitor, t: self.t })
    }
}
