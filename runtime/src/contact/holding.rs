//! Mechanism whose contact modes are prescribed.

use super::derivatives::{
    ContactDerivatives, HeldDerivatives, contact_derivatives_with_gains, write_held_derivatives,
};
use super::held::{Held, accelerations_and_responses};
use super::{Assumed, Contacts, Touch, Touched};
use crate::constraint::{ConstraintError, Projected};
use crate::derivatives::{ByMotion, Derivatives, nan_matrix};
use crate::forward::{constants, each_function};
use crate::integrate::{Features, Hooks};
use crate::private::constant;
use crate::{Mechanism, Real};
use nalgebra::{SMatrix, SVector};

/// Mechanism in which given contacts stay closed and all others open, returned by [`hold`].
#[derive(Debug)]
pub struct Holding<'m, M, T, const NK: usize, const NR: usize> {
    mechanism: &'m M,
    touches: [Touch; NK],
    gains: [T; 2],
}

// A reference is copied, whether the mechanism can be or not.
impl<M, T: Copy, const NK: usize, const NR: usize> Copy for Holding<'_, M, T, NK, NR> {}

impl<M, T: Copy, const NK: usize, const NR: usize> Clone for Holding<'_, M, T, NK, NR> {
    fn clone(&self) -> Self {
        *self
    }
}

/// Returns the mechanism with prescribed contact modes: closed contacts are enforced even if their normal
/// force would have to pull, as in [`forward_dynamics`](super::forward_dynamics). It is meant for integration
/// methods, discrete steps with their Jacobians, and trajectory optimisers with a given contact sequence. It
/// has derivatives if the mechanism has the option `derivatives`.
///
/// Contacts, and constraints of the mechanism, are kept by accelerations alone: gaps and rates stay what they
/// are at the start but for errors of the method; [`Holding::stabilized`] lets them decay. Where a held leg
/// straightens, these errors are large unless steps are short: a quadruped that collapses on four held feet,
/// without torques, lifts them by 0.1 mm in 0.4 s with steps of `Rk4` of 1 ms, by 0.2 m with 10 ms, and by 2
/// µm with 0.1 ms. A velocity that fulfils the contacts is that after they [`land`](super::land). Second
/// derivatives there are none: optimisers model costs by Gauss and Newton
/// ([`Quadratic::add_squares`](crate::optimal::Quadratic::add_squares)), or have feet that stay in place as
/// joints or constraints.
///
/// ```
/// use linkwork::contact::{self, Touch};
/// use linkwork::discrete;
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * y, derivatives)]
/// struct Hopper {
///     #[body(mass = 5)]
///     trunk: Body,
///     #[joint(ground -> trunk, along = (x, y))]
///     air: Stage,
///     #[body(mass = 0.4, com = -0.2 * y, inertia = rod(0.4, 0.4, y))]
///     leg: Body,
///     #[joint(trunk -> leg, about = z)]
///     hip: Pin,
///     #[acts(on = hip)]
///     motor: Torque,
///     #[contact(leg.at(-0.4 * y), ground.plane(y), friction = 0.9)]
///     foot: Contact,
/// }
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let m = Hopper {};
/// let (q, v, u) = ([0.0, 0.4, 0.0].into(), [0.4, 0.0, -1.0].into(), [0.5].into());
/// // It stands on its foot, and falls forward like an inverted pendulum.
/// let stance = contact::hold(&m, [Touch::Sticks]);
/// let next = discrete::transition(&stance, &Rk4::step(0.01), 0.0, &q, &v, &u)?;
/// assert!(m.contact_rates(&next.q, &next.v).amax() < 1e-8);
/// // The motor at the hip pushes the trunk, against the ground.
/// assert!(next.b::<6>()[(3, 0)] < -1e-3);
/// # Ok(())
/// # }
/// ```
pub fn hold<M, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>(
    mechanism: &M,
    touches: [Touch; NK],
) -> Holding<'_, M, M::Scalar, NK, NR>
where
    M: Contacts<NQ, NV, NU, NK, NR>,
{
    Holding { mechanism, touches, gains: [constant(0.0); 2] }
}

impl<M, T: Real, const NK: usize, const NR: usize> Holding<'_, M, T, NK, NR> {
    /// Returns the mechanism with contact errors that decay at `rate`, 1/s, critically damped: gaps and
    /// contact velocities of enforced contacts (Baumgarte, *Stabilization of constraints and integrals of
    /// motion in dynamical systems*, 1972). A suitable rate is a few times the fastest rate of the motion.
    #[must_use]
    pub fn stabilized(self, rate: T) -> Self {
        self.with_gains(rate * rate, rate * constant(2.0))
    }

    /// Returns the mechanism with separate gains for gaps `g`, 1/s², and contact velocities `u`, 1/s, of
    /// enforced contacts: `G v̇ + b = −position g − velocity u`, where gaps act along normals only. With
    /// gains 0 and 50, a foot comes to rest at its point of touchdown, as in Crocoddyl's examples
    /// (`ContactModel3D` with gains `[0, 50]`).
    #[must_use]
    pub fn with_gains(self, position: T, velocity: T) -> Self {
        Self { gains: [position, velocity], ..self }
    }

    /// Returns the accelerations and contact forces under the generalized forces `tau`, as
    /// [`forward_dynamics`](super::forward_dynamics) does, with the gains of the enforced contacts.
    ///
    /// # Errors
    ///
    /// The errors of [`forward_dynamics`](super::forward_dynamics).
    pub fn held<const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> Result<Held<T, NV, NR>, ConstraintError>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let rates = self.mechanism.contact_rates(t, q, v);
        accelerations_and_responses(self.mechanism, t, (q, v), tau, &self.touches, (&rates, self.gains))
            .map(|(held, _)| held)
    }

    /// Returns accelerations and contact forces as [`held`](Self::held), with their first derivatives. Costs
    /// and limits of contact forces use them, in addition to the step that
    /// [`discrete::semi_implicit_into`](crate::discrete::semi_implicit_into) computes from the same
    /// accelerations.
    ///
    /// # Errors
    ///
    /// The errors of [`forward_dynamics`](super::forward_dynamics).
    pub fn held_derivatives<const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> Result<HeldDerivatives<T, NV, NR>, ConstraintError>
    where
        M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        contact_derivatives_with_gains(self.mechanism, t, (q, v), tau, &self.touches, self.gains)
    }

    /// Writes the results of [`held_derivatives`](Self::held_derivatives) into existing matrices, which
    /// avoids copies of large matrices.
    ///
    /// # Errors
    ///
    /// The errors of [`forward_dynamics`](super::forward_dynamics). The results are undefined then.
    pub fn held_derivatives_into<const NQ: usize, const NV: usize, const NU: usize>(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
        into: &mut HeldDerivatives<T, NV, NR>,
    ) -> Result<(), ConstraintError>
    where
        M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        write_held_derivatives(self.mechanism, t, (q, v), tau, &self.touches, self.gains, into)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>
    Mechanism<NQ, NV, NU> for Holding<'_, M, T, NK, NR>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    type Scalar = T;
    constants!(names, M);

    each_function!(space, plain Mechanism, self => self.mechanism);
    each_function!(dynamics, pass Mechanism, self => self.mechanism);

    fn forward_dynamics(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        self.try_forward_dynamics(t, q, v, tau).unwrap_or_else(|_| SVector::repeat(constant(f64::NAN)))
    }

    fn try_forward_dynamics(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> Result<SVector<T, NV>, ConstraintError> {
        let rates = self.mechanism.contact_rates(t, q, v);
        accelerations_and_responses(self.mechanism, t, (q, v), tau, &self.touches, (&rates, self.gains))
            .map(|(held, _)| held.a)
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>
    Hooks<T, NQ, NV, NU> for Holding<'_, M, T, NK, NR>
where
    T: Real,
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
{
    const CONSTRAINED: bool = false;
    const SLIPPING: bool = M::SLIPPING;
    const FEEDBACK: bool = true;
    const CONTACTING: bool = false;
    const LOCATABLE: bool = false;
    const FIRST_ORDER: usize = M::FIRST_ORDER;
    const SPEEDS: bool = M::SPEEDS;

    #[inline(always)]
    fn features(&self) -> Features {
        Features { constrained: false, feedback: true, ..self.mechanism.features() }
    }

    /// Returns the state unchanged. It is not projected onto contacts or constraints.
    fn project(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
    ) -> Result<Projected<T, NQ, NV>, ConstraintError> {
        Ok((*q, *v))
    }

    /// Returns the velocity change due to a generalized impulse. It does not change the velocities of
    /// enforced contacts, zero or not.
    fn velocity_change_by_impulse(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        _h: T,
        p: &SVector<T, NV>,
    ) -> SVector<T, NV> {
        let still = SVector::zeros();
        let tau = self.mechanism.bias_forces(t, q, &still) + p;
        let along = self.mechanism.contact_rates(t, q, v);
        let found = accelerations_and_responses(
            self.mechanism,
            t,
            (q, &still),
            &tau,
            &self.touches,
            (&along, [T::zero(); 2]),
        );
        found.map_or_else(|_| SVector::repeat(constant(f64::NAN)), |(held, _)| held.a)
    }

    fn is_nearly_singular(&self, t: T, q: &SVector<T, NQ>, dv: &SVector<T, NV>) -> bool {
        self.mechanism.is_nearly_singular(t, q, dv)
    }

    fn acceleration_derivatives(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        u: &SVector<T, NU>,
    ) -> Option<ByMotion<T, NV, NU>> {
        self.mechanism.held_derivatives(t, (q, v), u, &self.touches, self.gains)
    }

    fn carry(&self, t: T, q: &SVector<T, NQ>, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.mechanism.carry(t, q, dv, v)
    }

    fn carry_rate(&self, t: T, dv: &SVector<T, NV>, v: &SVector<T, NV>) -> SVector<T, NV> {
        self.mechanism.carry_rate(t, dv, v)
    }

    fn translation(&self, t: T, dv: &SVector<T, NV>) -> SVector<T, NV> {
        self.mechanism.translation(t, dv)
    }

    /// Returns the configuration unchanged: enforced contacts may overlap.
    fn contact_start(
        &self,
        _t: T,
        q: &SVector<T, NQ>,
        _parts: bool,
    ) -> Result<SVector<T, NQ>, ConstraintError> {
        Ok(*q)
    }

    /// Returns the end of the step unchanged: contacts neither open nor close.
    fn contact_step(
        &self,
        _t: T,
        _start: (&SVector<T, NQ>, &SVector<T, NV>),
        (q, free): (&SVector<T, NQ>, &SVector<T, NV>),
        (given, _): Assumed<'_, T, NV>,
        _h: T,
    ) -> Result<Touched<T, NQ, NV>, ConstraintError> {
        Ok(Touched::state_without_contacts(*q, free + given))
    }

    fn visit_contacts<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: super::Visitor<T, NQ, NV, NU>,
    {
        None
    }
}

#[warn(clippy::missing_trait_methods, reason = "a function that is not passed on would become its default")]
impl<M, T, const NQ: usize, const NV: usize, const NU: usize, const NK: usize, const NR: usize>
    Derivatives<NQ, NV, NU> for Holding<'_, M, T, NK, NR>
where
    T: Real,
    M: ContactDerivatives<NQ, NV, NU, NK, NR, Scalar = T>,
{
    crate::forward::linear_motion!(NQ, NV, NU);
    constants!(derivatives, M);

    each_function!(tangent, plain Derivatives, self => self.mechanism);
    each_function!(given_derivatives, pass Derivatives, self => self.mechanism);

    fn forward_dynamics_derivatives(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
    ) -> ByMotion<T, NV, NV> {
        match contact_derivatives_with_gains(self.mechanism, t, (q, v), tau, &self.touches, self.gains) {
            Ok(found) => (found.by_q, found.by_v, found.by_tau),
            Err(_) => (nan_matrix(), nan_matrix(), nan_matrix()),
        }
    }

    fn forward_dynamics_derivatives_into(
        &self,
        t: T,
        q: &SVector<T, NQ>,
        v: &SVector<T, NV>,
        tau: &SVector<T, NV>,
        by_q: &mut SMatrix<T, NV, NV>,
        by_v: &mut SMatrix<T, NV, NV>,
        by_tau: &mut SMatrix<T, NV, NV>,
    ) -> SVector<T, NV> {
        match contact_derivatives_with_gains(self.mechanism, t, (q, v), tau, &self.touches, self.gains) {
            Ok(found) => {
                (*by_q, *by_v, *by_tau) = (found.by_q, found.by_v, found.by_tau);
                found.a
            }
            Err(_) => {
                (*by_q, *by_v, *by_tau) = (nan_matrix(), nan_matrix(), nan_matrix());
                SVector::repeat(constant(f64::NAN))
            }
        }
    }

    /// Returns `None`, because the accelerations already include contacts and constraints.
    fn visit_constraints<V>(&self, _visitor: V) -> Option<V::Output>
    where
        V: crate::constraint::Visitor<T, NQ, NV, NU>,
    {
        None
    }
}
