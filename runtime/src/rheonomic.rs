//! Mechanisms whose equations contain time: driven cranks, rotating hoops, moving pivots. Integrators are written against
//! this trait, which every [`Mechanism`] has too.

use crate::constraint::{ConstraintError, Projected};
use crate::contact::Touched;
use crate::forward::each_function;
use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// What mechanisms offer whose functions may depend on time `t`, s: those with a driven crank or a moving pivot.
///
/// `#[mechanism]` implements it where something depends on time; every [`Mechanism`] is one too. Shapes, units and conventions are those of [`Mechanism`]; with
/// driven motion the kinetic energy is no longer `½ vᵀ M v`, nor the momentum `M v`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no mechanism",
    label = "expected a mechanism",
    note = "a mechanism is a struct with the attribute `#[mechanism(…)]`, or a reference to one"
)]
pub trait Rheonomic<const NQ: usize, const NV: usize, const NU: usize> {
    /// The scalar type.
    type Scalar: Real;

    /// Name of every entry of `q`.
    const CONFIGURATION: [&'static str; NQ];
    /// Name of every entry of `v`.
    const VELOCITIES: [&'static str; NV];
    /// Name of every entry of `u`.
    const INPUTS: [&'static str; NU];
    /// SI unit of every entry of `v` ([`Mechanism::VELOCITY_UNITS`]).
    const VELOCITY_UNITS: [&'static str; NV] = [""; NV];
    /// SI unit of every entry of `u` ([`Mechanism::INPUT_UNITS`]).
    const INPUT_UNITS: [&'static str; NU] = [""; NU];

    /// The coordinates are restricted by constraints ([`Mechanism::CONSTRAINED`]).
    const CONSTRAINED: bool = false;

    /// Contacts slip with friction ([`Mechanism::SLIPPING`]).
    const SLIPPING: bool = false;

    /// Constraints are kept by feedback ([`Stabilized`](crate::constraint::Stabilized)), or forces depend on accelerations:
    /// `forward_dynamics` holds these forces, so that neither mass matrix nor momentum tell the motion; states need not fulfil
    /// constraints.
    const FEEDBACK: bool = false;

    /// Contacts open and close ([`Contacts`](crate::Contacts)): methods of integration that know nothing of them do not compile.
    const CONTACTING: bool = false;

    /// Events at contacts can be located ([`EventDriven`](crate::integrate::EventDriven)): by
    /// [`visit_contacts`](Self::visit_contacts).
    const LOCATABLE: bool = false;

    /// How many of the last velocities are states of first order ([`Mechanism::FIRST_ORDER`]).
    const FIRST_ORDER: usize = 0;

    /// Some velocities are generalized speeds that were declared ([`Mechanism::SPEEDS`]).
    const SPEEDS: bool = false;

    /// The state nearest to a given one that fulfils the constraints, if there are any ([`Mechanism::project`]).
    ///
    /// # Errors
    ///
    /// Those of [`Constrained::project_state`](crate::Constrained::project_state).
    fn project(
        &self,
        _t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Result<Projected<Self::Scalar, NQ, NV>, ConstraintError> {
        Ok((*q, *v))
    }

    /// The change of the velocity `v` by the generalized impulse `p`, N·s and N·m·s, and by those of the constraints
    /// ([`Mechanism::impulse`]): these hold, to first order, when the new velocity has lasted for `h` seconds.
    fn impulse(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        _h: Self::Scalar,
        p: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        self.forward_dynamics(t, q, v, &(self.bias_forces(t, q, v) + p))
    }

    /// Whether constraints lose rank near `q` ([`Mechanism::is_nearly_singular`]).
    fn is_nearly_singular(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _dv: &SVector<Self::Scalar, NV>,
    ) -> bool {
        false
    }

    /// `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂u)` under the inputs `u` where they are generated ([`Mechanism::acceleration_derivatives`]).
    fn acceleration_derivatives(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
        _u: &SVector<Self::Scalar, NU>,
    ) -> Option<crate::ByMotion<Self::Scalar, NV, NU>> {
        None
    }

    /// The velocity `v` at the configuration `q` in the axes that ball and free joints have after the displacement `dv`, and in the
    /// speeds there if some were declared: its components change, and bodies move as before. Only of mechanisms with contacts, others
    /// leave it as it is.
    fn carry(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        *v
    }

    /// The configuration `q` where a motion is to begin with it: surfaces that overlap are refused ([`contact::check`](crate::contact::check)), or taken apart
    /// where `parts` ([`contact::project`](crate::contact::project)). Mechanisms without contacts leave it as it is.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Overlap`] with the contact whose surfaces overlap most.
    fn contact_start(
        &self,
        _t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        _parts: bool,
    ) -> Result<SVector<Self::Scalar, NQ>, ConstraintError> {
        Ok(*q)
    }

    /// What contacts make of a step of `h` seconds from the configuration and velocity `start`, which has led to a configuration and,
    /// without contacts, a velocity; on the way they have been taken to add `given` to the velocity
    /// ([`contact::solve`](crate::contact::solve)).
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Contact`] of mechanisms with contacts.
    fn contact_step(
        &self,
        _t: Self::Scalar,
        _start: (&SVector<Self::Scalar, NQ>, &SVector<Self::Scalar, NV>),
        (q, free): (&SVector<Self::Scalar, NQ>, &SVector<Self::Scalar, NV>),
        given: &SVector<Self::Scalar, NV>,
        _h: Self::Scalar,
    ) -> Result<Touched<Self::Scalar, NQ, NV>, ConstraintError> {
        Ok(Touched::free(*q, free + given))
    }

    /// Hands the mechanism to `visitor` with the numbers of its contacts, where it has any; `None` where it has none, or where it stands
    /// for many.
    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }

    /// The configuration with all coordinates zero; identity quaternions ([`Mechanism::neutral`]).
    fn neutral(&self) -> SVector<Self::Scalar, NQ>;

    /// `q ⊕ dv`: the configuration reached from `q` with the velocity `dv` in one unit of time ([`Mechanism::integrate`]).
    fn integrate(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NQ>;

    /// `to ⊖ from`: the velocity that leads from one configuration to another in one unit of time
    /// ([`Mechanism::difference`]).
    fn difference(
        &self,
        from: &SVector<Self::Scalar, NQ>,
        to: &SVector<Self::Scalar, NQ>,
    ) -> SVector<Self::Scalar, NV>;

    /// Rate of `dv` such that `q ⊕ dv` moves with velocity `v` ([`Mechanism::tangent_rate`]).
    fn tangent_rate(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Rate of `dv` such that `q ⊕ dv` moves with velocity `v`, from any `q` ([`Mechanism::displacement_rate`]).
    fn displacement_rate(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        self.tangent_rate(dv, v)
    }

    /// Mass matrix `M(t, q)`, symmetric, both triangles: kg between translations, kg·m² between rotations, kg·m mixed.
    fn mass_matrix(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, NV, NV>;

    /// Bias forces `h(t, q, v)`, N and N·m: those of [`Mechanism::bias_forces`], and the inertia of the driven motion.
    fn bias_forces(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// `τ = M(t, q) a + h(t, q, v)`, N and N·m.
    fn inverse_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// `v̇ = M(t, q)⁻¹ (τ − h(t, q, v))`, m/s² and rad/s². Not finite where `M` is singular.
    fn forward_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// [`forward_dynamics`](Self::forward_dynamics), or why the forces determine no acceleration
    /// ([`Mechanism::try_forward_dynamics`]).
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Jammed`] and [`ConstraintError::Singular`] of mechanisms with contacts that slip.
    fn try_forward_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        Ok(self.forward_dynamics(t, q, v, tau))
    }

    /// Generalized forces `τ` of the inputs `u`, N and N·m, by virtual work ([`Mechanism::generalized_forces`]).
    fn generalized_forces(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NV>;

    /// Kinetic energy `T(t, q, v)`, J: quadratic in `v`, and linear and constant terms where motion is driven (Goldstein,
    /// Poole and Safko, *Classical Mechanics*, 2002, § 1.6).
    fn kinetic_energy(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Self::Scalar;

    /// Potential energy `U(t, q)` of gravity (zero at the ground's origin) and springs, J.
    fn potential_energy(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> Self::Scalar;

    /// Generalized momentum `p = ∂T/∂v`, kg·m/s and kg·m²/s.
    fn generalized_momentum(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Rate of the generalized momentum without inputs, N and N·m: `ṗ = momentum_rate(t, q, v) + τ` (Hamilton's second
    /// equation).
    fn momentum_rate(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;
}

/// A mechanism at an instant.
#[derive(Clone, Copy, Debug)]
pub struct At<'m, M, T> {
    pub(crate) mechanism: &'m M,
    pub(crate) t: T,
}

/// The mechanism at time `t`, for code that is written against [`Mechanism`].
pub fn at<M, T>(mechanism: &M, t: T) -> At<'_, M, T> {
    At { mechanism, t }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> Rheonomic<NQ, NV, NU> for M
where
    M: Mechanism<NQ, NV, NU>,
{
    type Scalar = M::Scalar;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NU] = M::INPUTS;
    const VELOCITY_UNITS: [&'static str; NV] = M::VELOCITY_UNITS;
    const INPUT_UNITS: [&'static str; NU] = M::INPUT_UNITS;
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = M::LOCATABLE;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    each_function!(space, plain Mechanism, self => self);
    each_function!(dynamics, drop Mechanism, self => self);
    each_function!(accelerations, drop Mechanism, self => self);
    each_function!(methods, drop Mechanism, self => self);

    fn visit_contacts<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<Self::Scalar, NQ, NV, NU>,
    {
        Mechanism::visit_contacts(self, visitor)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize> Mechanism<NQ, NV, NU> for At<'_, M, T>
where
    T: Real,
    M: Rheonomic<NQ, NV, NU, Scalar = T>,
{
    type Scalar = T;
    const CONFIGURATION: [&'static str; NQ] = M::CONFIGURATION;
    const VELOCITIES: [&'static str; NV] = M::VELOCITIES;
    const INPUTS: [&'static str; NU] = M::INPUTS;
    const VELOCITY_UNITS: [&'static str; NV] = M::VELOCITY_UNITS;
    const INPUT_UNITS: [&'static str; NU] = M::INPUT_UNITS;
    const CONSTRAINED: bool = M::CONSTRAINED;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = M::FEEDBACK;
    const CONTACTING: bool = M::CONTACTING;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    each_function!(space, plain Rheonomic, self => self.mechanism);
    each_function!(dynamics, at Rheonomic, self => self.mechanism, self.t);
    each_function!(accelerations, at Rheonomic, self => self.mechanism, self.t);
    each_function!(methods, at Rheonomic, self => self.mechanism, self.t);

    // Contacts know their own time.
    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }
}
