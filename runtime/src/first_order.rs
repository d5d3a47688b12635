//! States of first order: lags of engines and actuators, filters.

use crate::constraint::{ConstraintError, Projected};
use crate::contact::Touched;
use crate::derivatives::{ByMotion, unknown};
use crate::private::put_block;
use crate::{Real, Rheonomic, RheonomicDerivatives};
use nalgebra::{SMatrix, SVector};

mod outputs;

pub use outputs::OutputsByStates;

/// A mechanism with `NX` states of first order, [`State`](crate::elements::State), beside its configuration and velocity.
///
/// `#[mechanism]` implements it. States are fields of the struct: the functions of the mechanism hold for the values there, and their
/// signatures are those of any mechanism. [`extended`](Self::extended) is the mechanism with its states among the velocities, which
/// is what is integrated and linearised; `NE` is `NV + NX`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no states of first order",
    note = "`#[state(rate = expression)] level: State` declares one"
)]
pub trait FirstOrder<const NQ: usize, const NV: usize, const NU: usize, const NX: usize, const NE: usize>:
    Rheonomic<NQ, NV, NU> + Sized
{
    /// Name of every state.
    const STATES: [&'static str; NX];
    /// Unit of every state, as [`Mechanism::VELOCITY_UNITS`](crate::Mechanism::VELOCITY_UNITS) says.
    const STATE_UNITS: [&'static str; NX] = [""; NX];

    /// The states as they are, each in its own unit.
    fn states(&self) -> SVector<Self::Scalar, NX>;

    /// The mechanism in other states.
    fn with_states(&self, x: &SVector<Self::Scalar, NX>) -> Self;

    /// The rates of the states, in their units per second, at the time `t` (which matters where a function of the mechanism
    /// depends on it).
    fn state_rates(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NX>;

    /// [`Mechanism::acceleration_derivatives`](crate::Mechanism::acceleration_derivatives) of the mechanism with its states as the
    /// last of its velocities, whatever the states of the struct are; `None` without [`FirstOrderDerivatives`].
    fn extended_derivatives(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NE>,
        _u: &SVector<Self::Scalar, NU>,
    ) -> Option<ByMotion<Self::Scalar, NE, NU>> {
        None
    }

    /// The mechanism with its states as the last of its velocities, for methods of integration, controllers and linear systems:
    /// `v` is `[v, x]`, and `v̇` has the rates of the states behind the accelerations.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// /// A rocket sled whose thrust follows the throttle late.
    /// #[mechanism]
    /// struct Sled {
    ///     mass: f64,
    ///     lag: f64,
    ///     throttle: Input,
    ///     #[state(rate = (throttle - thrust) / lag)]
    ///     thrust: State,
    ///     #[body(mass = mass)]
    ///     sled: Body,
    ///     #[joint(ground -> sled, along = x)]
    ///     rail: Sleeve,
    ///     #[acts(on = rail, value = thrust)]
    ///     engine: Force,
    /// }
    ///
    /// let sled = Sled { mass: 2.0, lag: 0.5, thrust: 0.0 };
    /// let whole = sled.extended();
    /// let run = simulate(&whole).from([0.0], [0.0, sled.thrust]).inputs(|_, _, _| [6.0].into());
    /// let end = run.duration(1.0).finish()?;
    /// let late = (-1.0_f64 / 0.5).exp();
    /// assert!((end.v[1] - 6.0 * (1.0 - late)).abs() < 1e-6);
    /// assert!((end.v[0] - 3.0 * (1.0 - 0.5 * (1.0 - late))).abs() < 1e-6);
    /// # Ok::<(), Error>(())
    /// ```
    fn extended(&self) -> Extended<'_, Self, NV, NX, NE> {
        const { assert!(NE == NV + NX, "velocities and states are as many as the type says") };
        Extended { mechanism: self }
    }
}

/// Derivatives by states of first order, and of their rates. `#[mechanism(…, derivatives)]` implements it for mechanisms with such
/// states and without constraints.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no derivatives by states of first order",
    note = "the word asks for them: `#[mechanism(…, derivatives)]`; mechanisms with constraints have none"
)]
pub trait FirstOrderDerivatives<
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NX: usize,
    const NE: usize,
>: FirstOrder<NQ, NV, NU, NX, NE> + RheonomicDerivatives<NQ, NV, NU>
{
    /// The derivatives of [`state_rates`](FirstOrder::state_rates).
    fn state_rate_derivatives(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> RateDerivatives<Self::Scalar, NV, NU, NX>;

    /// `∂τ/∂x` of [`inverse_dynamics`](Rheonomic::inverse_dynamics).
    fn inverse_dynamics_by_states(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SMatrix<Self::Scalar, NV, NX>;

    /// `∂v̇/∂x` of [`forward_dynamics`](Rheonomic::forward_dynamics).
    fn forward_dynamics_by_states(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> SMatrix<Self::Scalar, NV, NX>;

    /// `∂τ/∂x` of the inputs' [`generalized_forces`](Rheonomic::generalized_forces).
    fn generalized_forces_by_states(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SMatrix<Self::Scalar, NV, NX>;
}

/// Derivatives of the rates of `NX` states of first order. Column `i` of the one by `q` is along `q ⊕ ε eᵢ`, for ball and free joints
/// in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateDerivatives<T, const NV: usize, const NU: usize, const NX: usize> {
    /// By configuration, per m and rad.
    pub by_q: SMatrix<T, NX, NV>,
    /// By velocity, per m/s and rad/s.
    pub by_v: SMatrix<T, NX, NV>,
    /// By the states, 1/s where both have one unit.
    pub by_x: SMatrix<T, NX, NX>,
    /// By inputs.
    pub by_u: SMatrix<T, NX, NU>,
}

impl<T: Real, const NV: usize, const NU: usize, const NX: usize> RateDerivatives<T, NV, NU, NX> {
    /// All zero.
    pub fn zeros() -> Self {
        Self {
            by_q: SMatrix::zeros(),
            by_v: SMatrix::zeros(),
            by_x: SMatrix::zeros(),
            by_u: SMatrix::zeros(),
        }
    }
}

/// A mechanism with its states of first order among its velocities ([`FirstOrder::extended`]): `v` is `[v, x]`.
///
/// A state is a velocity without a place: it has no entry of `q`, `q ⊕ dv` does not depend on its displacement, the mass matrix has
/// a one on its diagonal, and its bias force is its rate without inputs with the sign turned. `M v̇ + h = τ`, its inverse and their
/// derivatives hold as for any mechanism; energies are those of the mechanism alone. Its number of states is
/// [`Rheonomic::FIRST_ORDER`].
#[derive(Clone, Copy, Debug)]
pub struct Extended<'m, M, const NV: usize, const NX: usize, const NE: usize> {
    mechanism: &'m M,
}

/// Velocities and states apart.
fn apart<T: Real, const NV: usize, const NX: usize, const NE: usize>(
    all: &SVector<T, NE>,
) -> (SVector<T, NV>, SVector<T, NX>) {
    let at = |k: usize| all.get(k).copied().unwrap_or(T::zero());
    (SVector::from_fn(|k, _| at(k)), SVector::from_fn(|k, _| at(NV + k)))
}

/// Velocities and states in one vector.
fn together<T: Real, const NV: usize, const NX: usize, const NE: usize>(
    v: &SVector<T, NV>,
    x: &SVector<T, NX>,
) -> SVector<T, NE> {
    SVector::from_fn(|k, _| v.get(k).or(x.get(k.wrapping_sub(NV))).copied().unwrap_or(T::zero()))
}

/// A matrix of velocities with something for the states below and beside it.
fn bordered<T: Real, const NV: usize, const NX: usize, const NE: usize>(
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

/// A square matrix of velocities, and `diagonal` times the identity for the states.
fn with_diagonal<T: Real, const NV: usize, const NX: usize, const NE: usize>(
    block: &SMatrix<T, NV, NV>,
    diagonal: T,
) -> SMatrix<T, NE, NE> {
    let mut all = SMatrix::<T, NE, NE>::from_diagonal_element(diagonal);
    put_block(&mut all, 0, &block.data.0);
    all
}

/// The names, or the units, of all velocities.
const fn names<const NV: usize, const NX: usize, const NE: usize>(
    velocities: [&'static str; NV],
    states: [&'static str; NX],
) -> [&'static str; NE] {
    let mut all = [""; NE];
    let mut k = 0;
    while k < NE {
        if k < NV {
            all[k] = velocities[k];
        } else if k - NV < NX {
            all[k] = states[k - NV];
        }
        k += 1;
    }
    all
}

impl<M, const NV: usize, const NX: usize, const NE: usize> Extended<'_, M, NV, NX, NE> {
    /// The mechanism in the states among these velocities, and the others.
    fn at<T: Real, const NQ: usize, const NU: usize>(&self, all: &SVector<T, NE>) -> (M, SVector<T, NV>)
    where
        M: FirstOrder<NQ, NV, NU, NX, NE, Scalar = T>,
    {
        let (v, x) = apart(all);
        (self.mechanism.with_states(&x), v)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NX: usize, const NE: usize>
    Rheonomic<NQ, NE, NU> for Extended<'_, M, NV, NX, NE>
where
    M: FirstOrder<NQ, NV, NU, NX, NE>,
{
    type Scalar = M::Scalar;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NE] = names(M::VELOCITIES, M::STATES);
    const INPUTS: [&'static str; NU] = M::INPUTS;
    const VELOCITY_UNITS: [&'static str; NE] = names(M::VELOCITY_UNITS, M::STATE_UNITS);
    const INPUT_UNITS: [&'static str; NU] = M::INPUT_UNITS;
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = NX;
    const SPEEDS: bool = M::SPEEDS;

    fn neutral(&self) -> SVector<M::Scalar, NQ> {
        self.mechanism.neutral()
    }

    fn integrate(&self, q: &SVector<M::Scalar, NQ>, dv: &SVector<M::Scalar, NE>) -> SVector<M::Scalar, NQ> {
        self.mechanism.integrate(q, &apart::<_, NV, NX, NE>(dv).0)
    }

    fn difference(
        &self,
        from: &SVector<M::Scalar, NQ>,
        to: &SVector<M::Scalar, NQ>,
    ) -> SVector<M::Scalar, NE> {
        together(&self.mechanism.difference(from, to), &SVector::<M::Scalar, NX>::zeros())
    }

    fn tangent_rate(
        &self,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (dv, (v, x)) = (apart::<_, NV, NX, NE>(dv).0, apart::<_, NV, NX, NE>(v));
        together(&self.mechanism.tangent_rate(&dv, &v), &x)
    }

    fn displacement_rate(
        &self,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (dv, (v, x)) = (apart::<_, NV, NX, NE>(dv).0, apart::<_, NV, NX, NE>(v));
        together(&self.mechanism.displacement_rate(q, &dv, &v), &x)
    }

    /// Of the states that the struct holds, should masses depend on them.
    fn mass_matrix(&self, t: M::Scalar, q: &SVector<M::Scalar, NQ>) -> SMatrix<M::Scalar, NE, NE> {
        with_diagonal::<_, NV, NX, NE>(&self.mechanism.mass_matrix(t, q), nalgebra::one())
    }

    fn bias_forces(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (m, v) = self.at(v);
        together(&m.bias_forces(t, q, &v), &-m.state_rates(t, q, &v, &SVector::zeros()))
    }

    fn inverse_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        a: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let ((m, v), (a, rates)) = (self.at(v), apart::<_, NV, NX, NE>(a));
        let own = rates - m.state_rates(t, q, &v, &SVector::zeros());
        together(&m.inverse_dynamics(t, q, &v, &a), &own)
    }

    fn forward_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        tau: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let ((m, v), (tau, given)) = (self.at(v), apart::<_, NV, NX, NE>(tau));
        let rates = given + m.state_rates(t, q, &v, &SVector::zeros());
        together(&m.forward_dynamics(t, q, &v, &tau), &rates)
    }

    fn try_forward_dynamics(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        tau: &SVector<M::Scalar, NE>,
    ) -> Result<SVector<M::Scalar, NE>, ConstraintError> {
        let ((m, v), (tau, given)) = (self.at(v), apart::<_, NV, NX, NE>(tau));
        let rates = given + m.state_rates(t, q, &v, &SVector::zeros());
        Ok(together(&m.try_forward_dynamics(t, q, &v, &tau)?, &rates))
    }

    fn generalized_forces(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        u: &SVector<M::Scalar, NU>,
    ) -> SVector<M::Scalar, NE> {
        let (m, v) = self.at(v);
        let by_inputs = m.state_rates(t, q, &v, u) - m.state_rates(t, q, &v, &SVector::zeros());
        together(&m.generalized_forces(t, q, &v, u), &by_inputs)
    }

    fn kinetic_energy(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> M::Scalar {
        let (m, v) = self.at(v);
        m.kinetic_energy(t, q, &v)
    }

    /// Of the states that the struct holds, should it depend on them.
    fn potential_energy(&self, t: M::Scalar, q: &SVector<M::Scalar, NQ>) -> M::Scalar {
        self.mechanism.potential_energy(t, q)
    }

    fn generalized_momentum(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let x = apart::<_, NV, NX, NE>(v).1;
        let (m, v) = self.at(v);
        together(&m.generalized_momentum(t, q, &v), &x)
    }

    fn momentum_rate(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (m, v) = self.at(v);
        together(&m.momentum_rate(t, q, &v), &m.state_rates(t, q, &v, &SVector::zeros()))
    }

    fn project(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> Result<Projected<M::Scalar, NQ, NE>, ConstraintError> {
        let x = apart::<_, NV, NX, NE>(v).1;
        let (m, v) = self.at(v);
        let (q, v) = m.project(t, q, &v)?;
        Ok((q, together(&v, &x)))
    }

    fn impulse(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        h: M::Scalar,
        p: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let ((m, v), (p, given)) = (self.at(v), apart::<_, NV, NX, NE>(p));
        together(&m.impulse(t, q, &v, h, &p), &given)
    }

    fn is_nearly_singular(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
    ) -> bool {
        self.mechanism.is_nearly_singular(t, q, &apart::<_, NV, NX, NE>(dv).0)
    }

    fn acceleration_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        u: &SVector<M::Scalar, NU>,
    ) -> Option<ByMotion<M::Scalar, NE, NU>> {
        self.mechanism.extended_derivatives(t, q, v, u)
    }

    fn carry(
        &self,
        t: M::Scalar,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> SVector<M::Scalar, NE> {
        let (dv, (v, x)) = (apart::<_, NV, NX, NE>(dv).0, apart::<_, NV, NX, NE>(v));
        together(&self.mechanism.carry(t, &dv, &v), &x)
    }

    fn contact_step(
        &self,
        t: M::Scalar,
        (q, v): (&SVector<M::Scalar, NQ>, &SVector<M::Scalar, NE>),
        (end, free): (&SVector<M::Scalar, NQ>, &SVector<M::Scalar, NE>),
        given: &SVector<M::Scalar, NE>,
        h: M::Scalar,
    ) -> Result<Touched<M::Scalar, NQ, NE>, ConstraintError> {
        let ((m, v), (free, x)) = (self.at(v), apart::<_, NV, NX, NE>(free));
        let (given, added) = apart::<_, NV, NX, NE>(given);
        let touched = m.contact_step(t, (q, &v), (end, &free), &given, h)?;
        Ok(Touched { q: touched.q, v: together(&touched.v, &(x + added)) })
    }

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<M::Scalar, NQ, NE, NU>,
    {
        None
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize, const NX: usize, const NE: usize>
    RheonomicDerivatives<NQ, NE, NU> for Extended<'_, M, NV, NX, NE>
where
    M: FirstOrderDerivatives<NQ, NV, NU, NX, NE>,
{
    fn integrate_derivatives(
        &self,
        dv: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        let (by_q, by_dv) = self.mechanism.integrate_derivatives(&apart::<_, NV, NX, NE>(dv).0);
        let (zero, one) = (nalgebra::zero(), nalgebra::one());
        (with_diagonal::<_, NV, NX, NE>(&by_q, one), with_diagonal::<_, NV, NX, NE>(&by_dv, zero))
    }

    fn tangent_rate_derivatives(
        &self,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        let (dv, v) = (apart::<_, NV, NX, NE>(dv).0, apart::<_, NV, NX, NE>(v).0);
        let (by_dv, by_v) = self.mechanism.tangent_rate_derivatives(&dv, &v);
        let (zero, one) = (nalgebra::zero(), nalgebra::one());
        (with_diagonal::<_, NV, NX, NE>(&by_dv, zero), with_diagonal::<_, NV, NX, NE>(&by_v, one))
    }

    fn integrate_derivatives_at(
        &self,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        let (by_q, by_dv) = self.mechanism.integrate_derivatives_at(q, &apart::<_, NV, NX, NE>(dv).0);
        let (zero, one) = (nalgebra::zero(), nalgebra::one());
        (with_diagonal::<_, NV, NX, NE>(&by_q, one), with_diagonal::<_, NV, NX, NE>(&by_dv, zero))
    }

    fn displacement_rate_derivatives(
        &self,
        q: &SVector<M::Scalar, NQ>,
        dv: &SVector<M::Scalar, NE>,
        v: &SVector<M::Scalar, NE>,
    ) -> crate::ByMotion<M::Scalar, NE, NE> {
        let (dv, v) = (apart::<_, NV, NX, NE>(dv).0, apart::<_, NV, NX, NE>(v).0);
        let (by_q, by_dv, by_v) = self.mechanism.displacement_rate_derivatives(q, &dv, &v);
        let (zero, one) = (nalgebra::zero(), nalgebra::one());
        let square = |m, diagonal| with_diagonal::<_, NV, NX, NE>(&m, diagonal);
        (square(by_q, zero), square(by_dv, zero), square(by_v, one))
    }

    fn turning(&self, q: &SVector<M::Scalar, NQ>, v: &SVector<M::Scalar, NE>) -> SMatrix<M::Scalar, NE, NE> {
        let v = apart::<_, NV, NX, NE>(v).0;
        with_diagonal::<_, NV, NX, NE>(&self.mechanism.turning(q, &v), nalgebra::zero())
    }

    fn coriolis_matrix(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
    ) -> SMatrix<M::Scalar, NE, NE> {
        let (m, v) = self.at(v);
        with_diagonal::<_, NV, NX, NE>(&m.coriolis_matrix(t, q, &v), nalgebra::zero())
    }

    fn inverse_dynamics_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        a: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        let ((m, v), a) = (self.at(v), apart::<_, NV, NX, NE>(a).0);
        let (by_q, by_v) = m.inverse_dynamics_derivatives(t, q, &v, &a);
        let rates = m.state_rate_derivatives(t, q, &v, &SVector::zeros());
        let by_x = m.inverse_dynamics_by_states(t, q, &v, &a);
        let (zero, none) = (SMatrix::zeros(), SMatrix::zeros());
        (bordered(&by_q, &-rates.by_q, &zero, &none), bordered(&by_v, &-rates.by_v, &by_x, &-rates.by_x))
    }

    fn forward_dynamics_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        tau: &SVector<M::Scalar, NE>,
    ) -> ByMotion<M::Scalar, NE, NE> {
        let ((m, v), tau) = (self.at(v), apart::<_, NV, NX, NE>(tau).0);
        let (by_q, by_v, by_force) = m.forward_dynamics_derivatives(t, q, &v, &tau);
        let rates = m.state_rate_derivatives(t, q, &v, &SVector::zeros());
        let by_x = m.forward_dynamics_by_states(t, q, &v, &tau);
        let (zero, none) = (SMatrix::zeros(), SMatrix::zeros());
        (
            bordered(&by_q, &rates.by_q, &zero, &none),
            bordered(&by_v, &rates.by_v, &by_x, &rates.by_x),
            with_diagonal::<_, NV, NX, NE>(&by_force, nalgebra::one()),
        )
    }

    fn generalized_forces_derivatives(
        &self,
        t: M::Scalar,
        q: &SVector<M::Scalar, NQ>,
        v: &SVector<M::Scalar, NE>,
        u: &SVector<M::Scalar, NU>,
    ) -> ByMotion<M::Scalar, NE, NU> {
        let (m, v) = self.at(v);
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
            bordered(&by_q, &(rates.by_q - alone.by_q), &zero, &none),
            bordered(&by_v, &(rates.by_v - alone.by_v), &by_x, &(rates.by_x - alone.by_x)),
            by_inputs,
        )
    }

    /// Not known: nothing tells how momenta change with the states.
    fn generalized_momentum_derivatives(
        &self,
        _t: M::Scalar,
        _q: &SVector<M::Scalar, NQ>,
        _v: &SVector<M::Scalar, NE>,
    ) -> SMatrix<M::Scalar, NE, NE> {
        unknown()
    }

    /// Nor is this.
    fn momentum_rate_derivatives(
        &self,
        _t: M::Scalar,
        _q: &SVector<M::Scalar, NQ>,
        _v: &SVector<M::Scalar, NE>,
    ) -> (SMatrix<M::Scalar, NE, NE>, SMatrix<M::Scalar, NE, NE>) {
        (unknown(), unknown())
    }

    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::constraint::Visitor<M::Scalar, NQ, NE, NU>,
    {
        None
    }
}

/// Some columns of a matrix; those that are not there are zero.
pub fn columns<T: Real, const R: usize, const C: usize, const N: usize>(
    all: &SMatrix<T, R, C>,
    which: [usize; N],
) -> SMatrix<T, R, N> {
    SMatrix::from_fn(|i, j| {
        let column = which.get(j).copied().unwrap_or(C);
        all.get((i, column)).copied().unwrap_or(T::zero())
    })
}
