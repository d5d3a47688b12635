//! The trait that generic code (integrators, controllers, plotters) is written against.

use crate::constraint::{ConstraintError, Projected};
use crate::contact::Touched;
use crate::forward::each_function;
use nalgebra::{RealField, SMatrix, SVector};

/// The numbers that generated code can run on: every `Copy` real field of nalgebra, so `f64`, `f32`, dual
/// numbers for automatic differentiation and SIMD lanes.
pub trait Real: RealField + Copy {}

impl<T: RealField + Copy> Real for T {}

/// What every mechanism offers, for generic code.
///
/// It has `NQ` configuration numbers, `NV` velocities and `NU` inputs, and its equations do not contain time
/// (scleronomic). `#[mechanism]` implements the trait. A mechanism that is driven in time implements [`Rheonomic`](crate::Rheonomic)
/// instead, and is a `Mechanism` at every instant: [`at(&hoop, t)`](crate::at).
///
/// The equation of motion is `M(q) v̇ + h(q, v) = τ`, in SI units. `q` lives on the configuration manifold (a ball
/// or a free joint holds a unit quaternion x y z w), `v` in its tangent space: body-frame velocities for ball and
/// free joints, rates of the coordinates for all others. Entries follow the order in which joints are declared.
///
/// A mechanism implements the trait for one triple of numbers only, so they need not be written:
/// `fn energy<M: Mechanism<NQ, NV, NU>, const NQ: usize, const NV: usize, const NU: usize>(m: &M, …)` is called
/// as `energy(&cart_pole, …)`.
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
    /// SI unit of every entry of `v`, as inferred: `rad/s`; `any` where nothing determines one, empty where none was said. A
    /// displacement along it has the same unit without the `/s`.
    const VELOCITY_UNITS: [&'static str; NV] = [""; NV];
    /// SI unit of every entry of `u`, in the same words.
    const INPUT_UNITS: [&'static str; NU] = [""; NU];

    /// The coordinates are restricted by constraints ([`Constrained`](crate::Constrained)).
    const CONSTRAINED: bool = false;

    /// Contacts slip with friction ([`Slipping`](crate::elements::Slipping)): forces depend on multipliers.
    const SLIPPING: bool = false;

    /// Constraints are kept by feedback, or forces depend on accelerations
    /// ([`Rheonomic::FEEDBACK`](crate::Rheonomic::FEEDBACK)).
    const FEEDBACK: bool = false;

    /// Contacts open and close ([`Contacts`](crate::Contacts)): methods of integration that know nothing of them do not compile.
    const CONTACTING: bool = false;

    /// Events at contacts can be located ([`EventDriven`](crate::integrate::EventDriven)): by
    /// [`visit_contacts`](Self::visit_contacts).
    const LOCATABLE: bool = false;

    /// How many of the last velocities are states of first order, which have no place in `q`
    /// ([`Extended`](crate::Extended)).
    const FIRST_ORDER: usize = 0;

    /// Some velocities are generalized speeds that were declared ([`Speed`](crate::elements::Speed)): how the entries of `v` move `q`
    /// depends on `q`.
    const SPEEDS: bool = false;

    /// The state nearest to a given one that fulfils the constraints, if there are any.
    ///
    /// # Errors
    ///
    /// Those of [`Constrained::project_state`](crate::Constrained::project_state).
    fn project(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Result<Projected<Self::Scalar, NQ, NV>, ConstraintError> {
        Ok((*q, *v))
    }

    /// The change of the velocity `v` by the generalized impulse `p`, N·s and N·m·s: `x` of `M x = p`. Where there are
    /// constraints, `M x = p + Jᵀ λ` with such impulses `λ` of theirs that they hold, to first order in `x`, when the new
    /// velocity has lasted for `h` seconds; with `h = 0` that their rates are zero. What implicit methods solve with.
    fn impulse(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        _h: Self::Scalar,
        p: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        self.forward_dynamics(q, v, &(self.bias_forces(q, v) + p))
    }

    /// Whether the constraints lose rank in the configuration `q`, or as good as: a step by `dv` changes them as much as they
    /// differ from dependent ones. Methods go on by accelerations there, which are continuous.
    fn is_nearly_singular(&self, _q: &SVector<Self::Scalar, NQ>, _dv: &SVector<Self::Scalar, NV>) -> bool {
        false
    }

    /// `(∂v̇/∂q, ∂v̇/∂v, ∂v̇/∂u)` under the inputs `u`, constraints included, as in [`LinearMotion`](crate::LinearMotion): what
    /// implicit methods solve with. `None` without `#[mechanism(…, derivatives)]`; methods take differences there.
    fn acceleration_derivatives(
        &self,
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

    /// The configuration with all coordinates zero; identity quaternions.
    fn neutral(&self) -> SVector<Self::Scalar, NQ>;

    /// `q ⊕ dv`: the configuration reached from `q` by moving with the constant velocity `dv` for one unit of time.
    /// A sum for plain coordinates, the exponential of SO(3) for a ball and of SE(3) for a free joint. Quaternions
    /// are normalised. With declared speeds the velocities of the joints are constant that `dv` stands for at `q`.
    fn integrate(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NQ>;

    /// `to ⊖ from`: the velocity that leads from one configuration to another in one unit of time, so that
    /// `integrate(from, difference(from, to))` is `to`. Rotations take the shorter way.
    fn difference(
        &self,
        from: &SVector<Self::Scalar, NQ>,
        to: &SVector<Self::Scalar, NQ>,
    ) -> SVector<Self::Scalar, NV>;

    /// Rate of `dv` such that `q ⊕ dv` moves with velocity `v`: the inverse of the exponential's derivative, the
    /// identity for plain coordinates. The series `v + ½ [dv, v] + …` is cut where it matters for steps of order
    /// above six (Hairer, Lubich and Wanner, *Geometric Numerical Integration*, ch. IV.7).
    fn tangent_rate(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Rate of `dv` such that `q ⊕ dv` moves with velocity `v`, from any `q`: what methods of integration call. It is
    /// [`tangent_rate`](Self::tangent_rate), which does not depend on `q`, unless speeds were declared ([`SPEEDS`](Self::SPEEDS)):
    /// `tangent_rate` is NaN then.
    fn displacement_rate(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        self.tangent_rate(dv, v)
    }

    /// Mass matrix `M(q)`, symmetric, both triangles: kg between translations, kg·m² between rotations, kg·m mixed.
    fn mass_matrix(&self, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, NV, NV>;

    /// Bias forces `h(q, v)`: Coriolis and centrifugal forces, gravity, springs, dashpots, friction. N for translations,
    /// N·m for rotations.
    fn bias_forces(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// `τ = M(q) a + h(q, v)`: the forces (N) and torques (N·m) that give the acceleration `a`.
    fn inverse_dynamics(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// `v̇ = M(q)⁻¹ (τ − h(q, v))`, m/s² and rad/s²: the acceleration that the forces `tau` give. Not finite where `M(q)`
    /// is singular.
    fn forward_dynamics(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// [`forward_dynamics`](Self::forward_dynamics), or why the forces determine no acceleration: what simulations call.
    ///
    /// # Errors
    ///
    /// [`ConstraintError::Jammed`] and [`ConstraintError::Singular`] of mechanisms with contacts that slip; others
    /// have none.
    fn try_forward_dynamics(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        Ok(self.forward_dynamics(q, v, tau))
    }

    /// Generalized forces `τ` of the inputs `u`, N and N·m, by virtual work. Few mechanisms need `v` here: those whose
    /// inputs act by way of the velocity, such as the control surfaces of an aircraft.
    fn generalized_forces(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NV>;

    /// Kinetic energy `T = ½ vᵀ M(q) v`, J.
    fn kinetic_energy(&self, q: &SVector<Self::Scalar, NQ>, v: &SVector<Self::Scalar, NV>) -> Self::Scalar;

    /// Potential energy `U(q)` of gravity (zero at the ground's origin) and springs, J.
    fn potential_energy(&self, q: &SVector<Self::Scalar, NQ>) -> Self::Scalar;

    /// Generalized momentum `p = M(q) v`, kg·m/s for translations, kg·m²/s for rotations.
    fn generalized_momentum(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Rate of the generalized momentum without inputs, N and N·m: `ṗ = momentum_rate(q, v) + τ` (Hamilton's second
    /// equation, in body components for ball and free joints: the Euler–Poincaré equation).
    fn momentum_rate(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;
}

/// A reference to a mechanism is one: a controller may borrow its plant.
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
