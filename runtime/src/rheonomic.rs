//! Mechanisms whose equations contain time: driven cranks, rotating hoops, moving pivots. Integrators use
//! this trait, which every [`Mechanism`] implements too.

use crate::constraint::{ConstraintError, Projected};
use crate::contact::Touched;
use crate::forward::each_function;
use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// Functions of mechanisms that may depend on time `t`, s: mechanisms with a driven crank or a moving pivot.
///
/// `#[mechanism]` implements the trait for mechanisms that depend on time, and every [`Mechanism`] implements
/// it. Shapes, units and conventions are those of [`Mechanism`]. With driven motion, the kinetic energy
/// differs from `½ vᵀ M v` and the momentum from `M v`.
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

    /// Whether constraints restrict the coordinates ([`Mechanism::CONSTRAINED`]).
    const CONSTRAINED: bool = false;

    /// Whether contacts slide with friction ([`Mechanism::SLIPPING`]).
    const SLIPPING: bool = false;

    /// Whether feedback enforces the constraints ([`Stabilized`](crate::constraint::Stabilized)), or forces
    /// depend on accelerations. `forward_dynamics` includes these forces, so that mass matrix and momentum do
    /// not determine the motion; states need not satisfy the constraints.
    const FEEDBACK: bool = false;

    /// Whether the mechanism has unilateral contacts ([`Contacts`](crate::Contacts)); integration methods
    /// that do not treat them do not compile.
    const CONTACTING: bool = false;

    /// Whether contact events can be located ([`EventDriven`](crate::integrate::EventDriven)), through
    /// [`visit_contacts`](Self::visit_contacts).
    const LOCATABLE: bool = false;

    /// Number of first-order states, which are the last velocities ([`Mechanism::FIRST_ORDER`]).
    const FIRST_ORDER: usize = 0;

    /// Whether some velocities are declared generalized speeds ([`Mechanism::SPEEDS`]).
    const SPEEDS: bool = false;

    /// Projects a state onto the constraints, if there are any ([`Mechanism::project`]).
    ///
    /// # Errors
    ///
    /// The errors of [`Constrained::project_state`](crate::Constrained::project_state).
    fn project(
        &self,
        _t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Result<Projected<Self::Scalar, NQ, NV>, ConstraintError> {
        Ok((*q, *v))
    }

    /// Returns the change of the velocity `v` due to the generalized impulse `p`, N·s and N·m·s, and the
    /// constraint impulses ([`Mechanism::impulse`]). The constraints are satisfied, to first order, after the
    /// new velocity has lasted for `h` seconds.
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

    /// Whether constraints nearly lose rank at `q` ([`Mechanism::is_nearly_singular`]).
    fn is_nearly_singular(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _dv: &SVector<Self::Scalar, NV>,
    ) -> bool {
        false
    }

    /// Returns `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂u)` under the inputs `u`, if they are generated
    /// ([`Mechanism::acceleration_derivatives`]).
    fn acceleration_derivatives(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _v: &SVector<Self::Scalar, NV>,
        _u: &SVector<Self::Scalar, NU>,
    ) -> Option<crate::ByMotion<Self::Scalar, NV, NU>> {
        None
    }

    /// Returns the velocity `v` at the configuration `q` expressed in the axes of ball and free joints after
    /// the displacement `dv`, and in the generalized speeds there if some are declared: the components
    /// change, the motion of the bodies does not. Mechanisms without contacts return `v` unchanged.
    fn carry(
        &self,
        _t: Self::Scalar,
        _q: &SVector<Self::Scalar, NQ>,
        _dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        *v
    }

    /// Checks or corrects the configuration `q` at the start of a motion. Penetrating contact surfaces are an
    /// error ([`contact::check`](crate::contact::check)), or are separated if `parts` is true
    /// ([`contact::project`](crate::contact::project)). Mechanisms without contacts return `q` unchanged.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Overlap`] with the contact of the deepest penetration.
    fn contact_start(
        &self,
        _t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        _parts: bool,
    ) -> Result<SVector<Self::Scalar, NQ>, ConstraintError> {
        Ok(*q)
    }

    /// Applies the contact impulses of a step of `h` seconds ([`contact::solve`](crate::contact::solve)). The
    /// step starts at the configuration and velocity `start`; without contacts it ends at the configuration
    /// `q` with the velocity `free`, and during it contacts were assumed to add `given` to the velocity.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Contact`] for mechanisms with contacts.
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

    /// Passes the mechanism to `visitor`, with the numbers of its contacts as const parameters. `None` for
    /// mechanisms without contacts and for wrappers of several states.
    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }

    /// Returns the configuration with all coordinates zero and identity quaternions
    /// ([`Mechanism::neutral`]).
    fn neutral(&self) -> SVector<Self::Scalar, NQ>;

    /// Returns `q ⊕ dv`: the configuration reached from `q` with the velocity `dv` in one unit of time
    /// ([`Mechanism::integrate`]).
    fn integrate(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NQ>;

    /// Returns `to ⊖ from`: the velocity that leads from one configuration to another in one unit of time
    /// ([`Mechanism::difference`]).
    fn difference(
        &self,
        from: &SVector<Self::Scalar, NQ>,
        to: &SVector<Self::Scalar, NQ>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of `dv` such that `q ⊕ dv` moves with velocity `v`
    /// ([`Mechanism::tangent_rate`]).
    fn tangent_rate(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of `dv` such that `q ⊕ dv` moves with velocity `v`, from any `q`
    /// ([`Mechanism::displacement_rate`]).
    fn displacement_rate(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        self.tangent_rate(dv, v)
    }

    /// Returns the mass matrix `M(t, q)`, symmetric, both triangles: kg between translations, kg·m² between
    /// rotations, kg·m mixed.
    fn mass_matrix(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, NV, NV>;

    /// Returns the bias forces `h(t, q, v)`, N and N·m: those of [`Mechanism::bias_forces`], plus the
    /// inertial forces of the driven motion.
    fn bias_forces(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns `τ = M(t, q) a + h(t, q, v)`, N and N·m.
    fn inverse_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns `v̇ = M(t, q)⁻¹ (τ − h(t, q, v))`, m/s² and rad/s². Not finite if `M` is singular.
    fn forward_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns [`forward_dynamics`](Self::forward_dynamics), or the reason why the forces determine no
    /// acceleration ([`Mechanism::try_forward_dynamics`]).
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Jammed`] and [`ConstraintError::Singular`] for mechanisms with sliding contacts.
    fn try_forward_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        Ok(self.forward_dynamics(t, q, v, tau))
    }

    /// Returns the generalized forces `τ` of the inputs `u`, N and N·m, by virtual work
    /// ([`Mechanism::generalized_forces`]).
    fn generalized_forces(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the kinetic energy `T(t, q, v)`, J: quadratic in `v`, with additional linear and constant
    /// terms for driven motion (Goldstein, Poole and Safko, *Classical Mechanics*, 2002, § 1.6).
    fn kinetic_energy(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Self::Scalar;

    /// Returns the potential energy `U(t, q)` of gravity (zero at the ground's origin) and springs, J.
    fn potential_energy(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> Self::Scalar;

    /// Returns the generalized momentum `p = ∂T/∂v`, kg·m/s and kg·m²/s.
    fn generalized_momentum(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of the generalized momentum without inputs, N and N·m: `ṗ = momentum_rate(t, q, v) +
    /// τ` (Hamilton's second equation).
    fn momentum_rate(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;
}

/// Mechanism at a fixed time.
#[derive(Clone, Copy, Debug)]
pub struct At<'m, M, T> {
    pub(crate) mechanism: &'m M,
    pub(crate) t: T,
}

/// Returns the mechanism at time `t`, for generic code over [`Mechanism`].
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

    // Contacts take the time as an argument of their own.
    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<Self::Scalar, NQ, NV, NU>,
    {
        None
    }
}
