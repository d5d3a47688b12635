//! Trait for code that is generic over mechanisms: integrators, controllers, plotters.

use crate::constraint::ConstraintError;
use crate::forward::{constants, each_function};
use crate::integrate::Hooks;
use nalgebra::{RealField, SMatrix, SVector};

/// Scalar type of generated code: any `Copy` real field of nalgebra, such as `f64`, `f32`, dual numbers for
/// automatic differentiation and SIMD lanes.
pub trait Real: RealField + Copy {}

impl<T: RealField + Copy> Real for T {}

/// Functions of every mechanism, for generic code.
///
/// The mechanism has `NQ` configuration numbers, `NV` velocities and `NU` inputs; `#[mechanism]` implements
/// the trait. The time `t`, s, affects mechanisms with a driven crank, a rotating hoop or a moving pivot;
/// all others ([`Scleronomic`]) ignore it, and their inherent functions do not have the argument.
///
/// The equation of motion is `M(t, q) v̇ + h(t, q, v) = τ`, in SI units. `q` is a point of the configuration
/// manifold (with a unit quaternion x y z w for a ball or a free joint), `v` a vector of its tangent space:
/// body-frame velocities for ball and free joints, rates of the coordinates for all others. Entries follow
/// the order in which joints are declared.
///
/// A mechanism implements the trait for one triple (`NQ`, `NV`, `NU`) only, so that callers need not write
/// it: `fn energy<M: Mechanism<NQ, NV, NU>, const NQ: usize, const NV: usize, const NU: usize>(m: &M, …)` is
/// called as `energy(&cart_pole, …)`.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a mechanism",
    label = "expected a mechanism",
    note = "a mechanism is a struct with the attribute `#[mechanism(…)]`, without `inertia = none`, or a \
            reference to one"
)]
pub trait Mechanism<const NQ: usize, const NV: usize, const NU: usize>:
    Hooks<<Self as Mechanism<NQ, NV, NU>>::Scalar, NQ, NV, NU>
{
    /// Scalar type of the mechanism: `f64`, `f32` or the struct's own type parameter.
    type Scalar: Real;

    /// Names of the entries of the configuration `q`.
    const CONFIGURATION: [&'static str; NQ];
    /// Names of the entries of the velocity `v`.
    const VELOCITIES: [&'static str; NV];
    /// Names of the inputs, the entries of `u`.
    const INPUTS: [&'static str; NU];
    /// SI units of the entries of `v`, inferred from the declaration, such as `rad/s`. A unit is `any` if
    /// undetermined, and empty if unknown. The corresponding displacement has this unit times s.
    const VELOCITY_UNITS: [&'static str; NV] = [""; NV];
    /// SI unit of every entry of `u`, in the format of [`VELOCITY_UNITS`](Self::VELOCITY_UNITS).
    const INPUT_UNITS: [&'static str; NU] = [""; NU];

    /// Returns the mass matrix `M(t, q)`, symmetric, both triangles: kg between translations, kg·m² between
    /// rotations, kg·m mixed.
    fn mass_matrix(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> SMatrix<Self::Scalar, NV, NV>;

    /// Returns the bias forces `h(t, q, v)`: Coriolis and centrifugal forces, gravity, springs, dashpots,
    /// friction, and the inertial forces of driven motion. N for translations, N·m for rotations.
    fn bias_forces(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the acceleration `v̇ = M(t, q)⁻¹ (τ − h(t, q, v))`, m/s² and rad/s², due to the generalized
    /// forces `tau`. Not finite if `M` is singular.
    fn forward_dynamics(
        &self,
        t: Self::Scalar,
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
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        tau: &SVector<Self::Scalar, NV>,
    ) -> Result<SVector<Self::Scalar, NV>, ConstraintError> {
        Ok(self.forward_dynamics(t, q, v, tau))
    }

    /// Returns the generalized forces `τ = M(t, q) a + h(t, q, v)`, N and N·m, that cause the acceleration
    /// `a`.
    fn inverse_dynamics(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        a: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the generalized forces `τ` of the inputs `u`, N and N·m, by the principle of virtual work.
    /// They depend on `v` only if the effect of inputs does, as for the control surfaces of an aircraft.
    fn generalized_forces(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
        u: &SVector<Self::Scalar, NU>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the kinetic energy, J: `T = ½ vᵀ M v`, with additional terms that are linear and constant in
    /// `v` for driven motion (Goldstein, Poole and Safko, *Classical Mechanics*, 2002, § 1.6).
    fn kinetic_energy(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> Self::Scalar;

    /// Returns the potential energy `U(t, q)` of gravity (zero at the ground's origin) and springs, J.
    fn potential_energy(&self, t: Self::Scalar, q: &SVector<Self::Scalar, NQ>) -> Self::Scalar;

    /// Returns the generalized momentum `p = ∂T/∂v`, kg·m/s for translations, kg·m²/s for rotations: `M v`
    /// without driven motion.
    fn generalized_momentum(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of the generalized momentum without inputs, N and N·m: `ṗ = momentum_rate(t, q, v) +
    /// τ` (Hamilton's second equation, in body components for ball and free joints: the Euler–Poincaré
    /// equation).
    fn momentum_rate(
        &self,
        t: Self::Scalar,
        q: &SVector<Self::Scalar, NQ>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the configuration with all coordinates zero and identity quaternions.
    fn neutral(&self) -> SVector<Self::Scalar, NQ>;

    /// Returns the displaced configuration `q ⊕ dv`: the configuration reached from `q` by moving with the
    /// constant velocity `dv` for one unit of time. It is a sum for ordinary coordinates, the exponential of
    /// SO(3) for a ball joint and of SE(3) for a free joint. Quaternions are normalised. With declared
    /// generalized speeds, the constant velocities are the joint velocities that correspond to `dv` at `q`.
    fn integrate(
        &self,
        q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NQ>;

    /// Returns the tangent vector `to ⊖ from` that leads from one configuration to another, so that
    /// `integrate(from, difference(from, to))` is `to`. Rotations take the smaller angle.
    fn difference(
        &self,
        from: &SVector<Self::Scalar, NQ>,
        to: &SVector<Self::Scalar, NQ>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of `dv` such that `q ⊕ dv` moves with velocity `v`: the inverse of the exponential's
    /// derivative, the identity for ordinary coordinates. The series `v + ½ [dv, v] + …` is truncated after
    /// the terms that affect steps of order six (Hairer, Lubich and Wanner, *Geometric Numerical
    /// Integration*, ch. IV.7).
    fn tangent_rate(
        &self,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV>;

    /// Returns the rate of `dv` such that `q ⊕ dv` moves with velocity `v`, from any `q`; called by
    /// integration methods. It equals [`tangent_rate`](Self::tangent_rate), which does not depend on `q`,
    /// unless generalized speeds are declared ([`Speed`](crate::elements::Speed)): `tangent_rate` is then
    /// NaN.
    fn displacement_rate(
        &self,
        _q: &SVector<Self::Scalar, NQ>,
        dv: &SVector<Self::Scalar, NV>,
        v: &SVector<Self::Scalar, NV>,
    ) -> SVector<Self::Scalar, NV> {
        self.tangent_rate(dv, v)
    }
}

/// Mechanisms whose equations do not contain time: all without driven joints, inputs of time and moving
/// pivots, and [`at(&mechanism, t)`](crate::at). `#[mechanism]` implements the trait.
#[diagnostic::on_unimplemented(
    message = "the equations of `{Self}` contain time",
    label = "expected a mechanism without time",
    note = "pass `&at(&mechanism, t)`, the mechanism at an instant"
)]
pub trait Scleronomic {}

impl<M: Scleronomic + ?Sized> Scleronomic for &M {}

/// Implements the trait for references to mechanisms, so that a controller can borrow the mechanism that it
/// controls.
#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, const NQ: usize, const NV: usize, const NU: usize> Mechanism<NQ, NV, NU> for &M
where
    M: Mechanism<NQ, NV, NU> + ?Sized,
{
    type Scalar = M::Scalar;
    constants!(names, M);

    each_function!(space, plain Mechanism, self => *self);
    each_function!(dynamics, pass Mechanism, self => *self);
    each_function!(accelerations, pass Mechanism, self => *self);
}
