//! Single integration steps of a mechanism as maps of state and input, with their Jacobians. Kalman
//! filters, iLQR, DDP and multiple shooting are built from them.
//!
//! A step maps the state `(q, v)` at time `t` to the state one period of the method later, under constant
//! inputs `u`. Derivatives are with respect to displacements of the configuration, in body axes for ball and
//! free joints, both before and after the step: with `x = (δq, δv)`, `x⁺ = A x + B δu`.
//!
//! ```
//! use linkwork::discrete;
//! use linkwork::prelude::*;
//!
//! #[mechanism(gravity = -9.81 * y, derivatives)]
//! struct Pendulum {
//!     #[body(mass = 2, com = -0.5 * y)]
//!     bob: Body,
//!     #[joint(ground -> bob, about = z)]
//!     hinge: Pin,
//!     #[acts(on = hinge)]
//!     motor: Torque,
//! }
//!
//! # fn main() -> Result<(), Error> {
//! let (m, method) = (Pendulum {}, Rk4::step(0.01));
//! let (q, v, u) = ([0.3].into(), [0.0].into(), [0.1].into());
//! let next = discrete::transition(&m, &method, 0.0, &q, &v, &u)?;
//! let (a, b) = (next.a::<2>(), next.b::<2>());
//!
//! // A small increase of the torque moves the next state by B.
//! let moved = discrete::step(&m, &method, 0.0, &q, &v, &[0.1 + 1e-6].into())?;
//! assert!((moved.1[0] - next.v[0] - b[(1, 0)] * 1e-6).abs() < 1e-12);
//! // Without friction the step preserves areas in state space, to the order of the method.
//! assert!((a.determinant() - 1.0).abs() < 1e-9);
//! # Ok(())
//! # }
//! ```

use crate::blocks::{NearlyIdentity, zeros};
use crate::constraint::{ConstrainedDerivatives, ConstraintError, Projected, Visitor};
use crate::derivatives::{Derivatives, entry_of_two_by_two_blocks, stack_blocks_vertically};
use crate::integrate::{
    ContinuousInputs, Error, Method, NoInputs, Rk4, SemiImplicitEuler, State, Step, System, TimeStepping,
};
use crate::private::to_f64;
use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

mod curvature;
mod explicit;
mod implicit;
mod parameters;
mod plain;
mod projected;
mod projection;
mod second;
mod time_stepping;

pub use explicit::semi_implicit_into;
pub(crate) use explicit::{DifferentiatedStepStart, VectorWithDerivatives};
pub(crate) use implicit::eliminate_with_pivoting;
pub use parameters::{StepByParameters, by_parameters};
pub use second::{TwiceDifferentiableStep, second_order};
pub(crate) use time_stepping::{
    ConfigurationManifold, motion_under_contact_forces, smooth_acceleration_at_start,
};

/// Returns configuration and velocity after one step of a method under constant inputs `u`.
///
/// With constraints, the state is projected onto them as in a simulation. Steps are independent: the method's
/// memory of previous steps is empty.
///
/// # Errors
///
/// [`Error::InvalidStep`] for a period that is zero, negative or not finite; and the errors of the method:
/// [`Error::NotFinite`], [`Error::NotConverged`], [`Error::Constraint`].
pub fn step<M, T, S, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    method: &S,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
) -> Result<(SVector<T, NQ>, SVector<T, NV>), Error>
where
    T: Real,
    M: Mechanism<NQ, NV, NU, Scalar = T>,
    S: FixedStep<T>,
{
    method.check()?;
    let step = step_with_constant_inputs(mechanism, method, t, q, v, u)?;
    Ok((step.end.q, step.end.v))
}

/// Computes one step of an integration method with constant inputs and returns it with its start, end and
/// displacement.
fn step_with_constant_inputs<M, T, S, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    method: &S,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
) -> Result<Step<T, NQ, NV>, Error>
where
    T: Real,
    M: Mechanism<NQ, NV, NU, Scalar = T>,
    S: FixedStep<T>,
{
    // Time is counted from the start of the step, so that the length of the step is not rounded.
    let start = State { t: T::zero(), q: *q, v: *v };
    let mut memory = method.initial_memory();
    if NU == 0 {
        return System::new(mechanism, NoInputs).advance_step(method, &mut memory, t, &start, None, false);
    }
    let held = ContinuousInputs(|_: T, _: &SVector<T, NQ>, _: &SVector<T, NV>| *u);
    System::new(mechanism, held).advance_step(method, &mut memory, t, &start, None, false)
}

/// Returns the state after a step of `h` seconds, and the mean rate of the displacement over the step.
fn state_after_step<M, T, S, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    method: &S,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
    h: T,
) -> Result<(Projected<T, NQ, NV>, SVector<T, NV>), Error>
where
    T: Real,
    M: Mechanism<NQ, NV, NU, Scalar = T>,
    S: FixedStep<T>,
{
    let step = step_with_constant_inputs(mechanism, method, t, q, v, u)?;
    Ok(((step.end.q, step.end.v), step.displacement.at(T::one()) / h))
}

/// Returns one step of a method under constant inputs, and its Jacobians ([`Transition`]). The Jacobians are
/// exact to rounding, except in the states with contacts that are named below.
///
/// Under constraints the Jacobians are those of the whole step, including the final projection onto the
/// constraints. Columns are along all displacements, including those that violate the constraints, which the
/// projection removes. The mechanism needs these options:
///
/// - `derivatives` for [`Rk4`] and [`TimeStepping`], and for [`SemiImplicitEuler`] without constraints;
/// - `momentum_derivatives` for [`ImplicitMidpoint`](crate::integrate::ImplicitMidpoint), and for
///   [`SemiImplicitEuler`] under constraints. A mechanism without this option does not compile here:
///
/// ```compile_fail
/// # use linkwork::{discrete, prelude::*};
/// # #[mechanism(derivatives)]
/// # struct Bead {
/// #     #[particle(mass = 1)]
/// #     bead: Particle,
/// #     #[joint(ground -> bead, along = (x, y))]
/// #     table: Stage,
/// #     #[constraint(table.x * table.x + table.y * table.y = 1)]
/// #     wire: Holonomic,
/// # }
/// let (q, v, u) = ([1.0, 0.0].into(), [0.0, 1.0].into(), [].into());
/// let step = discrete::transition(&Bead {}, &ImplicitMidpoint::step(0.01), 0.0, &q, &v, &u);
/// ```
///
/// Implicit steps are differentiated by the implicit function theorem.
///
/// # Contacts
///
/// Steps of [`TimeStepping`] of a mechanism with [contacts](crate::contact) are differentiated in the contact
/// modes that the step has found: the conditions of separated, sticking and sliding contacts and of impacts
/// that hold with equality are linearised. No modes are declared. A step changes its derivatives where the
/// modes change, and there they are one-sided:
///
/// - A contact that stays closed and whose gap is zero to rounding has the derivative with respect to
///   displacements that open the gap. The step closes this gap, so that the derivative of the gap is zero.
/// - A contact at the edge of sticking and sliding sticks. A contact without impulse at the edge of
///   separation is separated.
///
/// The fractions of restitution and of the displacement at the end of the step that the energy allows count
/// as constant, and the correction of creep of bodies at rest as zero. If normal impulses are not determined
/// and contacts slide in different directions, as for a box that rotates on its face, the derivatives assume
/// the smallest change of the impulses; those of the search for impulses may differ from them. Poisson's
/// restitution, constraints and declared speeds are not supported.
///
/// ```
/// use linkwork::discrete;
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * z, derivatives)]
/// struct Ball {
///     #[particle(mass = 0.1)]
///     ball: Particle,
///     #[joint(ground -> ball, along = z)]
///     height: Sleeve,
///     #[contact(ball, ground.plane(z), restitution = 0.7)]
///     bounce: Contact,
/// }
///
/// # fn main() -> Result<(), Error> {
/// let (method, u) = (TimeStepping::step(1e-3).midpoint(), [].into());
/// // A step into the ground reverses the velocity, and −0.7 times its change remains.
/// let next = discrete::transition(&Ball {}, &method, 0.0, &[1e-4].into(), &[-3.0].into(), &u)?;
/// assert!((next.v[0] - 2.1).abs() < 1e-12 && (next.v_by_v[0] + 0.7).abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
///
/// The errors of [`step`]; [`Error::Constraint`] with [`Singular`](crate::ConstraintError::Singular) where
/// constraints lose rank, and with [`NoDerivatives`](crate::ConstraintError::NoDerivatives) where Poisson's
/// restitution acts or impulses violate the contact conditions by more than `1e-6` of the largest contact
/// velocity.
pub fn transition<M, T, S, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    method: &S,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
) -> Result<Transition<T, NQ, NV, NU>, Error>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
    S: DifferentiableStep<T>,
{
    let mut found = Transition::zeros();
    transition_into(mechanism, method, t, q, v, u, &mut found)?;
    Ok(found)
}

/// Computes [`transition`] in place and overwrites `into`. This avoids copies of the matrices of large
/// mechanisms; solvers store one transition for each instant.
///
/// # Errors
///
/// The errors of [`transition`]; the contents of `into` are then unspecified.
pub fn transition_into<M, T, S, const NQ: usize, const NV: usize, const NU: usize>(
    mechanism: &M,
    method: &S,
    t: T,
    q: &SVector<T, NQ>,
    v: &SVector<T, NV>,
    u: &SVector<T, NU>,
    into: &mut Transition<T, NQ, NV, NU>,
) -> Result<(), Error>
where
    T: Real,
    M: Derivatives<NQ, NV, NU, Scalar = T>,
    S: DifferentiableStep<T>,
{
    const {
        assert!(
            !M::CONTACTING || S::CONTACTS,
            "a step with derivatives of a mechanism with contacts that open and close needs the method \
             `TimeStepping`; with other methods, enforce chosen contacts by `contact::hold`"
        );
        assert!(
            !M::CONTACTING || M::LOCATABLE && !M::CONSTRAINED && !M::SPEEDS,
            "a step with derivatives of a mechanism with contacts that open and close needs a mechanism \
             without constraints, declared speeds and states of first order: enforce chosen contacts by \
             `contact::hold`"
        )
    };
    const {
        assert!(
            !(M::CONSTRAINED && M::SLIPPING),
            "a step with derivatives needs a mechanism without slipping contacts"
        );
        let [free, held] = S::IN_MOMENTA;
        let in_momenta = if M::CONSTRAINED { held } else { free && !M::FEEDBACK };
        assert!(
            !in_momenta || M::MOMENTUM_DERIVATIVES,
            "a step of this method needs derivatives of momenta: `#[mechanism(…, momentum_derivatives)]`"
        );
    }
    method.check()?;
    if mechanism.features().constrained {
        let undetermined = Error::Constraint { t: to_f64(t), reason: ConstraintError::Singular };
        *into = mechanism
            .visit_constraints(ConstrainedStepVisitor { method, t, q, v, u })
            .unwrap_or(Err(undetermined))?;
    } else {
        method.differentiate_into(mechanism, t, q, v, u, into)?;
    }
    let is_finite = into.q.iter().chain(&into.v).all(|x| x.is_finite());
    if is_finite { Ok(()) } else { Err(Error::NotFinite { t: to_f64(t) }) }
}

/// Methods with fixed steps: all methods that are not adaptive.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no steps of fixed length",
    note = "single steps are those of `Rk4`, `SemiImplicitEuler`, `ImplicitMidpoint`, `Rosenbrock` and \
            `TimeStepping`"
)]
pub trait FixedStep<T: Real>: Method<T> {}

impl<T: Real> FixedStep<T> for Rk4<T> {}
impl<T: Real> FixedStep<T> for SemiImplicitEuler<T> {}
impl<T: Real> FixedStep<T> for TimeStepping<T> {}
impl<T: Real> FixedStep<T> for crate::integrate::ImplicitMidpoint<T> {}
impl<T: Real> FixedStep<T> for crate::integrate::Rosenbrock<T> {}

/// Arguments of a step of a mechanism with contacts: method, time, state and inputs.
struct ConstrainedStepVisitor<'a, S, T, const NQ: usize, const NV: usize, const NU: usize> {
    method: &'a S,
    t: T,
    q: &'a SVector<T, NQ>,
    v: &'a SVector<T, NV>,
    u: &'a SVector<T, NU>,
}

impl<S, T, const NQ: usize, const NV: usize, const NU: usize> Visitor<T, NQ, NV, NU>
    for ConstrainedStepVisitor<'_, S, T, NQ, NV, NU>
where
    T: Real,
    S: DifferentiableStep<T>,
{
    type Output = Result<Transition<T, NQ, NV, NU>, Error>;

    fn visit<M, const NH: usize, const NC: usize>(self, mechanism: &M) -> Self::Output
    where
        M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        self.method.differentiate_held(mechanism, self.t, self.q, self.v, self.u)
    }
}

/// Methods with differentiable steps: [`SemiImplicitEuler`], [`Rk4`],
/// [`ImplicitMidpoint`](crate::integrate::ImplicitMidpoint) and [`TimeStepping`].
#[diagnostic::on_unimplemented(
    message = "steps of `{Self}` have no derivatives",
    note = "those of `Rk4`, `SemiImplicitEuler`, `ImplicitMidpoint` and `TimeStepping` have"
)]
pub trait DifferentiableStep<T: Real>: FixedStep<T> {
    /// Whether steps need derivatives of generalized momenta: the first entry for mechanisms without
    /// constraints, the second with constraints.
    const IN_MOMENTA: [bool; 2];

    /// Returns the length of a step of the method, s.
    fn step_length(&self) -> T;

    /// Computes a step of a mechanism without constraints and its Jacobians in place; called by
    /// [`transition_into`].
    ///
    /// # Errors
    ///
    /// The errors of [`step`].
    fn differentiate_into<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
        into: &mut Transition<T, NQ, NV, NU>,
    ) -> Result<(), Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>;

    /// Returns the step of [`differentiate_into`](Self::differentiate_into).
    ///
    /// # Errors
    ///
    /// The errors of [`step`].
    fn differentiate_step<M, const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> Result<Transition<T, NQ, NV, NU>, Error>
    where
        M: Derivatives<NQ, NV, NU, Scalar = T>,
    {
        let mut step = Transition::zeros();
        self.differentiate_into(mechanism, t, q, v, u, &mut step)?;
        Ok(step)
    }

    /// Returns a step of a mechanism with constraints and its Jacobians; called by [`transition`]. The
    /// default is a step without constraints whose end is projected onto them.
    ///
    /// # Errors
    ///
    /// The errors of [`transition`].
    fn differentiate_held<
        M,
        const NQ: usize,
        const NV: usize,
        const NU: usize,
        const NH: usize,
        const NC: usize,
    >(
        &self,
        mechanism: &M,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> Result<Transition<T, NQ, NV, NU>, Error>
    where
        M: ConstrainedDerivatives<NQ, NV, NU, NH, NC, Scalar = T>,
    {
        projected::project_step(
            mechanism,
            t + self.step_length(),
            self.differentiate_step(mechanism, t, q, v, u)?,
        )
    }
}

/// State after a step, and its derivatives with respect to the state before the step and the inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<T, const NQ: usize, const NV: usize, const NU: usize> {
    /// Configuration after the step.
    pub q: SVector<T, NQ>,
    /// Velocity after the step.
    pub v: SVector<T, NV>,
    /// Derivative of the configuration after the step with respect to the configuration before it.
    pub q_by_q: SMatrix<T, NV, NV>,
    /// Derivative of the configuration after the step with respect to the velocity before it, s.
    pub q_by_v: SMatrix<T, NV, NV>,
    /// Derivative of the configuration after the step with respect to the inputs.
    pub q_by_u: SMatrix<T, NV, NU>,
    /// Derivative of the velocity after the step with respect to the configuration before it, 1/s.
    pub v_by_q: SMatrix<T, NV, NV>,
    /// Derivative of the velocity after the step with respect to the velocity before it.
    pub v_by_v: SMatrix<T, NV, NV>,
    /// Derivative of the velocity after the step with respect to the inputs.
    pub v_by_u: SMatrix<T, NV, NU>,
    /// Relation between the changes of configuration and velocity for steps `q⁺ = q ⊕ h v⁺`
    /// ([`SemiImplicitEuler`] without constraints). It halves the work of
    /// [`backward`](crate::optimal::backward), because configuration derivatives follow from velocity
    /// derivatives.
    pub chained: Option<ConfigurationVelocityRelation<T, NV>>,
}

/// Linear relation between the configuration and the velocity after a step: `δq⁺ = by_q δq + h
/// by_displacement δv⁺`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfigurationVelocityRelation<T, const NV: usize> {
    period: T,
    by_q: SMatrix<T, NV, NV>,
    by_displacement: SMatrix<T, NV, NV>,
    /// Half-open column ranges in which `by_q` and `by_displacement` differ from the identity.
    others: [(usize, usize); 2],
}

impl<T: Real, const NV: usize> ConfigurationVelocityRelation<T, NV> {
    /// Returns the relation with the period `h`, s, and the derivatives of `q ⊕ h v⁺` with respect to `q` and
    /// to the displacement `h v⁺`.
    pub fn new(period: T, by_q: SMatrix<T, NV, NV>, by_displacement: SMatrix<T, NV, NV>) -> Self {
        let others = [&by_q, &by_displacement].map(|matrix| NearlyIdentity::new(matrix).others());
        Self { period, by_q, by_displacement, others }
    }

    /// Returns the length `h` of the step, s.
    pub fn period(&self) -> T {
        self.period
    }

    /// Returns the derivative of `q ⊕ h v⁺` with respect to `q`: the identity except for ball and free
    /// joints.
    pub fn by_q(&self) -> &SMatrix<T, NV, NV> {
        &self.by_q
    }

    /// Returns the derivative of `q ⊕ h v⁺` with respect to the displacement `h v⁺`: the identity except for
    /// ball and free joints.
    pub fn by_displacement(&self) -> &SMatrix<T, NV, NV> {
        &self.by_displacement
    }

    /// Returns both derivatives as matrices that are the identity outside the stored column ranges.
    pub(crate) fn nearly_identity_matrices(&self) -> [NearlyIdentity<'_, T, NV>; 2] {
        let [of_q, of_displacement] = self.others;
        [
            NearlyIdentity::with_range(&self.by_q, of_q),
            NearlyIdentity::with_range(&self.by_displacement, of_displacement),
        ]
    }
}

impl<T: Real, const NQ: usize, const NV: usize, const NU: usize> Transition<T, NQ, NV, NU> {
    /// Returns a transition whose entries are all zero, as a buffer for [`transition_into`].
    pub fn zeros() -> Self {
        Self {
            q: zeros(),
            v: zeros(),
            q_by_q: zeros(),
            q_by_v: zeros(),
            q_by_u: zeros(),
            v_by_q: zeros(),
            v_by_v: zeros(),
            v_by_u: zeros(),
            chained: None,
        }
    }

    /// Returns the transition to a configuration and a velocity, given their derivatives.
    pub(crate) fn from_differentiated_state(
        (q, motion): &(SVector<T, NQ>, VectorWithDerivatives<T, NV, NU>),
        v: &VectorWithDerivatives<T, NV, NU>,
    ) -> Self {
        Self {
            q: *q,
            v: v.value,
            q_by_q: motion.by_q,
            q_by_v: motion.by_v,
            q_by_u: motion.by_u,
            v_by_q: v.by_q,
            v_by_v: v.by_v,
            v_by_u: v.by_u,
            chained: None,
        }
    }

    /// Returns the matrix `A` of the linearised step `x⁺ = A x + B δu`, for states `x` of displacements
    /// followed by changes of velocity. `NX` is `2 NV`; any other value does not compile.
    pub fn a<const NX: usize>(&self) -> SMatrix<T, NX, NX> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many rows as there are velocities") };
        let blocks = [[&self.q_by_q, &self.q_by_v], [&self.v_by_q, &self.v_by_v]];
        SMatrix::from_fn(|i, j| entry_of_two_by_two_blocks(blocks, i, j))
    }

    /// Returns the matrix `B` of the linearised step `x⁺ = A x + B δu`. `NX` is `2 NV`.
    pub fn b<const NX: usize>(&self) -> SMatrix<T, NX, NU> {
        const { assert!(NX == 2 * NV, "the matrix has twice as many rows as there are velocities") };
        stack_blocks_vertically(&self.q_by_u, &self.v_by_u)
    }

    /// Returns the gradient of a function with respect to configuration, velocity and inputs before the step,
    /// given its gradient (`by_q`, `by_v`) after the step: `Aᵀ λ` and `Bᵀ λ`. Adjoint methods propagate this
    /// gradient backwards in time.
    pub fn adjoint(
        &self,
        by_q: &SVector<T, NV>,
        by_v: &SVector<T, NV>,
    ) -> (SVector<T, NV>, SVector<T, NV>, SVector<T, NU>) {
        (
            self.q_by_q.tr_mul(by_q) + self.v_by_q.tr_mul(by_v),
            self.q_by_v.tr_mul(by_q) + self.v_by_v.tr_mul(by_v),
            self.q_by_u.tr_mul(by_q) + self.v_by_u.tr_mul(by_v),
        )
    }
}

/// Returns the state `x` of the linearised step `x⁺ = A x + B δu` as one vector: displacements `dq`, then
/// changes of velocity `dv`. `NX` is `2 NV`; any other value does not compile.
///
/// ```
/// use linkwork::discrete;
/// use linkwork::prelude::*;
///
/// let x: SVector<f64, 4> = discrete::stacked(&[0.1, 0.2].into(), &[3.0, 4.0].into());
/// assert_eq!(x.as_slice(), [0.1, 0.2, 3.0, 4.0]);
/// let (dq, dv): (SVector<f64, 2>, _) = discrete::split(&x);
/// assert_eq!((dq.as_slice(), dv.as_slice()), (&x.as_slice()[..2], &x.as_slice()[2..]));
/// ```
pub fn stacked<T: Real, const NV: usize, const NX: usize>(
    dq: &SVector<T, NV>,
    dv: &SVector<T, NV>,
) -> SVector<T, NX> {
    const { assert!(NX == 2 * NV, "the vector has twice as many numbers as there are velocities") };
    stack_blocks_vertically(dq, dv)
}

/// Splits a vector made by [`stacked`] into displacements and changes of velocity.
pub fn split<T: Real, const NV: usize, const NX: usize>(
    x: &SVector<T, NX>,
) -> (SVector<T, NV>, SVector<T, NV>) {
    const { assert!(NX == 2 * NV, "the vector has twice as many numbers as there are velocities") };
    let vector_from_entry =
        |first: usize| SVector::from_fn(|k, _| x.get(first + k).copied().unwrap_or(T::zero()));
    (vector_from_entry(0), vector_from_entry(NV))
}
