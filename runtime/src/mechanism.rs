//! Trait for code that is generic over mechanisms: integrators, controllers, plotters.

use crate::constraint::{ConstraintError, Projected};
use crate::contact::Touched;
use crate::forward::each_function;
use nalgebra::{RealField, SMatrix, SVector};

/// Scalar types of generated code: every `Copy` real field of nalgebra, such as `f64`, `f32`, dual numbers
/// for automatic differentiation and SIMD lanes.
pub trait Real: RealField + Copy {}

impl<T: RealField + Copy> Real for T {}

/// Functions of every mechanism, for generic code.
///
/// The mechanism has `NQ` configuration numbers, `NV` velocities and `NU` inputs, and its equations do not
/// contain time (scleronomic). `#[mechanism]` implements the trait. A mechanism that is driven in time
/// implements [`Rheonomic`](crate::Rheonomic) instead, and is a `Mechanism` at every instant: [`at(&hoop,
/// t)`](crate::at).
///
/// The equation of motion is `M(q) v̇ + h(q, v) = τ`, in SI units. `q` is a point of the configuration
/// manifold (with a unit quaternion x y z w for a ball or a free joint), `v` a vector of its tangent space:
/// body-frame velocities for ball and free joints, rates of the coordinates for all others. Entries follow
/// the order in which joints are declared.
///
/// A mechanism implements the trait for one triple (`NQ`, `NV`, `NU`) only, so that callers need not write
/// it: `fn energy<M: Mechanism<NQ, NV, NU>, const NQ: usize, const NV: usize, const NU: usize>(m: &M, …)` is
/// called as `energy(&cart_pole, …)`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no mechanism without time",
    label = "expected a `Mechanism`",
    note = "a mechanism whose equations contain time is one at an instant: pass `&at(&mechanism, t)`",
    note = "any other is a struct with the attribute `#[mechanism(…)]`, without `inertia = none`"
)]
pub trait Mechanism<const NQ: usize, const NV: usize, const NU: usize> {
    /// The scalar type: `f64`, `f32` or the struct's own parameter.
    type Scalar: Real;

    /// Name of every entry of `q`.
    const CONFIGURATION: [&'static str; NQ];
    /// Name of every entry of `v`.
    const VELOCITIES: [&'static str; NV];
    /// Name of every entry of `u`.
    const INPUTS: [&'static str; NU];
    /// SI unit of every entry of `v`, as inferred, such as `rad/s`; `any` if it is undetermined, empty if
    /// unknown. The corresponding displacement has this unit without `/s`.
    const VELOCITY_UNITS: [&'static str; NV] = [""; NV];
    /// SI unit of every entry of `u`, in the format of [`VELOCITY_UNITS`](Self::VELOCITY_UNITS).
    const INPUT_UNITS: [&'static str; NU] = [""; NU];

    /// Whether constraints restrict the coordinates ([`Constrained`](crate::Constrained)).
    const CONSTRAINED: bool = false;

    /// Whether contacts slide with friction ([`Slipping`](crate::elements::Slipping)): forces then depend on
    /// multipliers.
    const SLIPPING: bool = false;

    /// Whether feedback enforces the constraints, or forces depend on accelerations
    /// ([`Rheonomic::FEEDBACK`](crate::Rheonomic::FEEDBACK)).
    const FEEDBACK: bool = false;

    /// Whether the mechanism has unilateral contacts ([`Contacts`](crate::Contacts)); integration methods
    /// that do not treat them do not compile.
    const CONTACTING: bool = false;

    /// Whether contact events can be located ([`EventDriven`](crate::integrate::EventDriven)), through
    /// [`visit_contacts`](Self::visit_contacts).
    const LOCATABLE: bool = false;

    /// Number of first-order states, which are the last velocities and have no entry in `q`
    /// ([`Extended`](crate::Extended)).
    const FIRST_ORDER: usize = 0;

    /// Whether some velocities are declared generalized speeds ([`Speed`](crate::elements::Speed)): the
    /// relation between `v` and the motion of `q` then depends on `q`.
    const SPEEDS: bool = false;

    /// Projects a state onto the constraints, if there are any: returns the nearest state that satisfies
    /// them.
    ///
    /// # Errors
    ///
    /// The errors of [`Constrained::project_state`](crate::Constrained::project_state).
    fn project(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Result<Projected<Self::Scalar, NQ, NV>, ConstraintError> {
        Ok((*q, *v))
    }

    /// Returns the change `x` of the velocity `v` due to the generalized impulse `p`, N·s and N·m·s: the
    /// solution of `M x = p`. With constraints it solves `M x = p + Jᵀ λ` with constraint impulses `λ` such
    /// that the constraints are satisfied, to first order in `x`, after the new velocity has lasted for `h`
    /// seconds; for `h = 0`, such that their rates are zero. Implicit methods solve their equations with this
    /// function.
    fn impulse(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        _h: Self::Scalar,
        p: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        self.forward_dynamics(q, v, &(self.bias_forces(q, v) + p))
    }

    /// Whether the constraints are singular or nearly singular in the configuration `q`: a step by `dv`
    /// changes them as much as they differ from dependent constraints. Integration methods then use
    /// accelerations, which are continuous there.
    fn is_nearly_singular(&self, _q: &SVector<Self::Scalar, NQ>, _dv: &SVector<Self::Scalar, NV>) -> bool {
        false
    }

    /// Returns `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂u)` under the inputs `u`, constraints included, as in
    /// [`LinearMotion`](crate::LinearMotion). Implicit methods use these derivatives. `None` without
    /// `#[mechanism(…, derivatives)]`; methods then use finite differences.
    fn acceleration_derivatives(
        &self,
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

    /// Returns the configuration with all coordinates zero and identity quaternions.
    fn neutral(&self) -> SVector<Self::Scalar, NQ>;

    /// Returns `q ⊕ dv`: the configuration reached from `q` by moving with the constant velocity `dv` for one
    /// unit of time. It is a sum for plain coordinates, the exponential of SO(3) for a ball joint and of
    /// SE(3) for a free joint. Quaternions are normalised. With declared generalized speeds, the constant
    /// velocities are the joint velocities that correspond to `dv` at `q`.
    fn integrate(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NQ>;

    /// Returns `to ⊖ from`: the velocity that leads from one configuration to another in one unit of time, so
    /// that `integrate(from, difference(from, to))` is `to`. Rotations are by the smaller angle.
    fn difference(
        &self,
        from: &SVector<Self::Scalar, NQ>,
        to: &SVector<Self::Scalar, NQ>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of `dv` such that `q ⊕ dv` moves with velocity `v`: the inverse of the exponential's
    /// derivative, the identity for plain coordinates. The series `v + ½ [dv, v] + …` is truncated after the
    /// terms that affect steps of order six (Hairer, Lubich and Wanner, *Geometric Numerical Integration*,
    /// ch. IV.7).
    fn tangent_rate(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of `dv` such that `q ⊕ dv` moves with velocity `v`, from any `q`; called by
    /// integration methods. It equals [`tangent_rate`](Self::tangent_rate), which does not depend on `q`,
    /// unless generalized speeds are declared ([`SPEEDS`](Self::SPEEDS)): `tangent_rate` is then NaN.
    fn displacement_rate(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        self.tangent_rate(dv, v)
    }

    /// Returns the mass matrix `M(q)`, symmetric, both triangles: kg between translations, kg·m² between
    /// rotations, kg·m mixed.
    fn mass_matrix(&self, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, NV, NV>;

    /// Returns the bias forces `h(q, v)`: Coriolis and centrifugal forces, gravity, springs, dashpots,
    /// friction. N for translations, N·m for rotations.
    fn bias_forces(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns `τ = M(q) a + h(q, v)`: the generalized forces, N and N·m, that cause the acceleration `a`.
    fn inverse_dynamics(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the acceleration `v̇ = M(q)⁻¹ (τ − h(q, v))`, m/s² and rad/s², due to the generalized forces
    /// `tau`. Not finite if `M(q)` is singular.
    fn forward_dynamics(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns [`forward_dynamics`](Self::forward_dynamics), or the reason why the forces determine no
    /// acceleration; called by simulations.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Jammed`] and [`ConstraintError::Singular`] for mechanisms with sliding contacts;
    /// none for others.
    fn try_forward_dynamics(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        Ok(self.forward_dynamics(q, v, tau))
    }

    /// Returns the generalized forces `τ` of the inputs `u`, N and N·m, by virtual work. They depend on `v`
    /// only if inputs act through the velocity, such as the control surfaces of an aircraft.
    fn generalized_forces(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the kinetic energy `T = ½ vᵀ M(q) v`, J.
    fn kinetic_energy(&self, q: &SVector<Self::Scalar, NQ>, v: &SVector<Self::Scalar, NV>) -> Self::Scalar;

    /// Returns the potential energy `U(q)` of gravity (zero at the ground's origin) and springs, J.
    fn potential_energy(&self, q: &SVector<Self::Scalar, NQ>) -> Self::Scalar;

    /// Returns the generalized momentum `p = M(q) v`, kg·m/s for translations, kg·m²/s for rotations.
    fn generalized_momentum(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of the generalized momentum without inputs, N and N·m: `ṗ = momentum_rate(q, v) + τ`
    /// (Hamilton's second equation, in body components for ball and free joints: the Euler–Poincaré
    /// equation).
    fn momentum_rate(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;
}

/// Implements the trait for references to mechanisms: a controller may borrow its plant.
#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> Mechanism<NQ, NV, NU> for &M
where
    M: Mechanism<NQ, NV, NU> + ?Sized,
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

    each_function!(space, plain Mechanism, self => *self);
    each_function!(dynamics, plain Mechanism, self => *self);
    each_function!(accelerations, plain Mechanism, self => *self);
    each_function!(methods, plain Mechanism, self => *self);

    fn visit_contacts<V>(&self, visitor: V) -> Option<V::Output>
    where
        V: crate::contact::Visitor<Self::Scalar, NQ, NV, NU>,
    {
        M::visit_contacts(self, visitor)
    }
}
