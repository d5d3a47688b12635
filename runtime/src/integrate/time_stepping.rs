//! Time stepping: motion with impacts and friction in steps of fixed length.

use super::rk4::rk4_change;
use super::{
    Dynamics, Error, Jump, Method, State, Step, check_positive, equal_step_length_and_end,
    project_end_of_step,
};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::contact::{Impulses, Touched};
use crate::private::{constant, to_f64};
use nalgebra::SVector;

/// Time stepping after Moreau and Jean, for mechanisms with [contacts](crate::contact). Impacts are not
/// located, so that their number does not increase the cost.
///
/// A step of [`Rk4`](super::Rk4) under the impulses `Λ₀`, which enforce the contacts closed at its start,
/// results in the configuration `q_f` and the velocity `v_f`. The impulses `Λ` of the whole step then replace
/// `Λ₀`:
///
/// ```text
/// v₁ = v_f + M⁻¹ Gᵀ Λ − w₀ + c,   q₁ = q_f ⊕ (h/2) (v₁ − v_f)
/// ```
///
/// `w₀` is the change of velocity by `Λ₀`, and `c` makes the sum a trapezoidal rule for contact forces that
/// rotate: half of the component of `w₀` that no impulses at the end of the step can produce, and half of the
/// component of `Λ₀` that is not opposite to the slip there. Without `c` the directions at the end would
/// apply to the whole step, which is of order 1 and brakes rolling bodies.
///
/// The order is 4 between impacts, 2 under sustained contact and 1 through impacts. The impulses satisfy
/// Coulomb's and Newton's laws to rounding ([`contact::solve`](crate::contact::solve)): at the end of a step
/// sticking contacts have no slip velocity, and bodies at rest do not creep under any load that friction
/// supports. Impact impulses add no energy. Under sustained contact the energy is accurate to order 2: for a
/// bob of 1 kg in a frictionless bowl of 1 m, its relative error is `3e-6` after 2 s in steps of 1 ms. The
/// order is 1 through steps in which the slip velocity reverses, since its zero is not located. If slip stops
/// within a step, the velocity is exact and the position is off by at most `a h² / 8`, where `a` is the
/// deceleration. A motion that depends on indeterminate forces, such as that of a table with four legs that
/// rotates while it slides, is one of several that satisfy the laws; it may change with the length of the
/// steps.
///
/// When surfaces collide, their penetration is at most their approach in one step. In sustained contact, the
/// penetration is removed by displacements of the bodies weighted with the inverse inertia (Acary, *Projected
/// event-capturing time-stepping schemes*, Comput. Methods Appl. Mech. Eng. 256, 2013), as far as the energy
/// dissipated by impacts and friction in the step allows: contacts do not lift bodies that penetrate each
/// other at rest. Restitution is reduced in steps that would otherwise end with more energy than without
/// contacts. The remaining energy gain is the integration error of the order above: in drops of boxes of a
/// few kilograms that tumble about their edges, at most `25 h²` J in a step of `h` seconds, and `35 h²` J
/// without friction.
///
/// `Λ₀` are the impulses of the previous step if these have hardly changed; otherwise they are computed
/// again. The search for impulses begins at those of the previous step.
///
/// If no impulses satisfy the contact conditions, or none are found in a bounded number of iterations, a step
/// takes those that violate the conditions least, and reports the violation, m/s
/// ([`Sample::violation`](crate::simulate::Sample::violation)).
///
/// A step takes four evaluations of the dynamics, [two](Self::midpoint) or [one](Self::leapfrog). With closed
/// contacts, it also takes one evaluation of gap functions, Jacobian and mass matrix and two of contact
/// velocities, or twice as many if the contact modes have changed. Its matrices are on the stack: up to ten
/// of `C × C` numbers, and several times that in unoptimised builds. `C` is the number of contact velocities
/// of all contacts or, for mechanisms that have more than 36, the smallest of 36, 72 and 144 that is enough
/// for the closed contacts. This is 11 KiB for two feet, and 1.6 MiB for a stack of ten boxes with 120
/// contact velocities, for which a thread may need [more
/// stack](https://doc.rust-lang.org/std/thread/struct.Builder.html#method.stack_size) than the default.
///
/// Constraints are satisfied at the end of each step. Source: Jean, *The non-smooth contact dynamics method*,
/// Comput. Methods Appl. Mech. Eng. 177 (1999).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeStepping<T> {
    step: T,
    stages: TimeStepVariant,
}

/// Variants of a time step: four or two evaluations of the dynamics, or leapfrog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TimeStepVariant {
    RungeKutta,
    Midpoint,
    Leapfrog,
}

impl<T: Real> TimeStepping<T> {
    /// Returns the time-stepping method with steps of `step` seconds. Steps are slightly shorter where they
    /// must end on a sample time.
    pub const fn step(step: T) -> Self {
        Self { step, stages: TimeStepVariant::RungeKutta }
    }

    /// Selects steps with two evaluations of the dynamics instead of four. As in Moreau's own scheme, half a
    /// step along the velocity at the start leads to the midpoint, where the accelerations `a` are evaluated,
    /// and half a step along the velocity at the end follows. A step of `h` seconds from the configuration
    /// `q` and the velocity `v` is
    ///
    /// ```text
    /// q_m = q ⊕ (h/2) v,   v_m = v + (h/2) a(q, v),   v_f = v + h a(q_m, v_m),   q_f = q_m ⊕ (h/2) v_f
    /// ```
    ///
    /// Velocities of ball and free joints keep their directions in space while the axes of their bodies
    /// rotate, and `a` is the acceleration without that rotation: a ball that spins in flight keeps its
    /// velocity, however fast it spins. With declared generalized speeds their rates are added instead.
    ///
    /// `Λ₀` is added to the velocities as in any step of [`TimeStepping`], in its direction at the midpoint,
    /// and `v₁` and `q₁` follow in the same way. The order is 2 between impacts, and 1 with declared
    /// generalized speeds. If forces and inertia do not depend on velocities, the method is the leapfrog
    /// method, whose energy does not drift. Source: Moreau, *Numerical aspects of the sweeping process*,
    /// Comput. Methods Appl. Mech. Eng. 177 (1999), with `v_m` in place of `v` in the accelerations.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// #[mechanism(gravity = -9.81 * z)]
    /// pub struct Ball {
    ///     #[particle(mass = 0.1)]
    ///     ball: Particle,
    ///     #[joint(ground -> ball, along = z)]
    ///     height: Sleeve,
    ///     #[contact(ball, ground.plane(z), restitution = 0.5)]
    ///     bounce: Contact,
    /// }
    ///
    /// // Dropped from 1 m, the ball has bounced to 0.25 m after 1.5 times the duration of the fall.
    /// let fall = (2.0 / 9.81_f64).sqrt();
    /// let run = simulate(&Ball {}).from([1.0], [0.0]).method(TimeStepping::step(1e-4).midpoint());
    /// let end = run.duration(1.5 * fall).finish().expect("it bounces");
    /// assert!((end.q[0] - 0.25).abs() < 1e-3);
    /// ```
    pub const fn midpoint(self) -> Self {
        Self { stages: TimeStepVariant::Midpoint, ..self }
    }

    /// Selects steps with one evaluation of the dynamics, and a second one where contact modes have changed.
    /// A step is that of [`midpoint`](Self::midpoint), with the acceleration at the middle of the previous
    /// step in place of `a(q, v)`. The order is the same. If accelerations do not depend on velocities, it is
    /// the same step; otherwise the error of a step is about three times as large, since the acceleration
    /// that leads to `v_m` is that of a time one step earlier.
    ///
    /// ```
    /// use linkwork::prelude::*;
    ///
    /// #[mechanism(gravity = -9.81 * z)]
    /// pub struct Ball {
    ///     #[particle(mass = 0.1)]
    ///     ball: Particle,
    ///     #[joint(ground -> ball, along = z)]
    ///     height: Sleeve,
    ///     #[contact(ball, ground.plane(z))]
    ///     floor: Contact,
    /// }
    ///
    /// // A free fall is exact.
    /// let run = simulate(&Ball {}).from([1.0], [0.0]).method(TimeStepping::step(0.01).leapfrog());
    /// let end = run.clone().duration(0.4).finish().expect("it falls");
    /// assert!((1.0 - end.q[0] - 9.81 * 0.08).abs() < 1e-12);
    /// // It lies on the floor where it has landed.
    /// let end = run.duration(1.0).finish().expect("it lands");
    /// assert!(end.q[0].abs() < 1e-9 && end.v[0].abs() < 1e-12);
    /// ```
    pub const fn leapfrog(self) -> Self {
        Self { stages: TimeStepVariant::Leapfrog, ..self }
    }

    /// Returns the length of a step, s.
    pub(crate) fn nominal_step_length(&self) -> T {
        self.step
    }

    /// Whether steps have the four stages of [`Rk4`](super::Rk4), instead of a midpoint.
    pub(crate) fn has_four_stages(&self) -> bool {
        self.stages == TimeStepVariant::RungeKutta
    }
}

/// Contribution of the contacts to the velocity in the last step, per second, with the data that the next
/// step uses.
#[derive(Clone, Copy, Debug)]
pub struct ContactStepMemory<T, const NV: usize> {
    rate: SVector<T, NV>,
    /// Impulses of the contacts in the last step.
    impulses: Impulses<T, NV>,
    /// Whether the contribution of the contacts is about that of the previous step.
    steady: bool,
    /// Largest violation of the contact conditions that is not reported yet.
    violation: T,
    /// Acceleration in space, without contacts, at the middle of the last step, in the axes at its end, for
    /// [`TimeStepping::leapfrog`].
    acceleration: Option<SVector<T, NV>>,
}

/// Maximum relative change of the contacts' contribution between two steps for which it counts as steady.
const STEADY: f64 = 0.125;

impl<T: Real, const NV: usize> ContactStepMemory<T, NV> {
    fn new(rate: SVector<T, NV>) -> Self {
        let impulses = Impulses::none();
        Self { rate, impulses, steady: false, violation: T::zero(), acceleration: None }
    }

    /// Records the contribution of the contacts in a step, their impulses, and the violation of the contact
    /// conditions.
    fn record_contact_step(&mut self, rate: SVector<T, NV>, impulses: Impulses<T, NV>, violation: T) {
        let larger_of_size_and_magnitude = |size: T, x: &T| size.max(x.abs());
        let size = rate.iter().fold(T::zero(), larger_of_size_and_magnitude);
        let change = (rate - self.rate).iter().fold(T::zero(), larger_of_size_and_magnitude);
        *self = Self {
            rate,
            impulses,
            steady: change <= size * constant(STEADY),
            violation: self.violation.max(violation),
            acceleration: self.acceleration,
        };
    }
}

impl<T: Real> Method<T> for TimeStepping<T> {
    type Memory<const NV: usize> = ContactStepMemory<T, NV>;

    const FIXED: bool = true;
    const CONTACTS: bool = true;

    fn check(&self) -> Result<(), Error> {
        check_positive("the step", self.step)
    }

    fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
        ContactStepMemory::new(SVector::zeros())
    }

    fn take_violation<const NV: usize>(memory: &mut Self::Memory<NV>) -> T {
        core::mem::replace(&mut memory.violation, T::zero())
    }

    fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump) {
        // A jump of the inputs changes the contribution of the contacts only by the motion it causes.
        memory.steady &= matches!(jump, Jump::Inputs);
        memory.acceleration = None;
    }

    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        memory: &mut Self::Memory<NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        _dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error> {
        let (h, t) = equal_step_length_and_end(self.step, start.t, until)?;
        let add_time_to_error = |reason| match reason {
            ConstraintError::NotFinite => Error::NotFinite { t: to_f64(start.t) },
            reason => Error::Constraint { t: to_f64(start.t), reason },
        };
        let earlier = memory.acceleration.take().filter(|_| memory.steady);
        let before = earlier.unwrap_or_else(|| {
            let acceleration = system.acceleration(start.t, &start.q, &start.v);
            match self.stages {
                TimeStepVariant::RungeKutta => acceleration,
                TimeStepVariant::Midpoint | TimeStepVariant::Leapfrog => {
                    rate_without_axis_rotation(system, (start.t, &start.v), acceleration)
                }
            }
        });
        let (rate, impulses) = match memory.steady {
            true => (memory.rate, memory.impulses),
            false => acceleration_from_closed_contacts(system, start, &before, &memory.impulses, h)
                .map_err(add_time_to_error)?,
        };
        let (free, given) = match self.stages {
            TimeStepVariant::RungeKutta => rk4_step_with_contacts(system, start, (&before, &rate), h, t),
            TimeStepVariant::Midpoint | TimeStepVariant::Leapfrog => {
                let (free, given, at_middle) =
                    midpoint_step_with_contacts(system, start, (&before, &rate), h, t);
                memory.acceleration = matches!(self.stages, TimeStepVariant::Leapfrog).then_some(at_middle);
                (free, given)
            }
        };
        let free = project_end_of_step(system, free, start.t)?;
        let v = free.v - given;
        let Touched { q, v, held, impulses, violation } = system
            .contact_step(t, (&start.q, &start.v), (&free.q, &v), (&given, &impulses), h)
            .map_err(add_time_to_error)?;
        memory.record_contact_step(held / h, impulses, violation);
        let end = State { q, v, ..free };
        let end = if end == free { end } else { project_end_of_step(system, end, start.t)? };
        Ok(Step::linear(*start, end, (start.v + v) * (h * constant(0.5))))
    }
}

/// Returns the contribution to the velocity, per second, of the impulses that enforce the contacts closed at
/// the start of a step of `h` seconds; `before` are the accelerations without these impulses, and the search
/// begins at the impulses of the previous step.
pub(crate) fn acceleration_from_closed_contacts<
    T: Real,
    D: Dynamics<T, NQ, NV>,
    const NQ: usize,
    const NV: usize,
>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    before: &SVector<T, NV>,
    impulses: &Impulses<T, NV>,
    h: T,
) -> Result<(SVector<T, NV>, Impulses<T, NV>), ConstraintError> {
    let state = (&start.q, &start.v);
    let free = start.v + *before * h;
    // With zero duration the configuration does not change.
    let held =
        system.contact_step(start.t, state, (&start.q, &free), (&SVector::zeros(), impulses), T::zero())?;
    Ok(((held.v - free) / h, held.impulses))
}

/// Returns the end of a step of [`Rk4`](super::Rk4) with the accelerations `before` at its start, under
/// impulses that add `rate` to the velocity per second, and their total contribution to the velocity.
pub(crate) fn rk4_step_with_contacts<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    (before, rate): (&SVector<T, NV>, &SVector<T, NV>),
    h: T,
    t: T,
) -> (State<T, NQ, NV>, SVector<T, NV>) {
    let still = SVector::zeros();
    let added = (*rate != still).then_some(rate);
    let ((displacement, change), transported_to_step_end) = rk4_change(system, start, h, *before, added);
    let end = State { t, q: system.integrate(&start.q, &displacement), v: start.v + change };
    (end, transported_to_step_end.map_or(still, |rate| rate * h))
}

/// Returns the end of a step through the [midpoint](TimeStepping::midpoint) with the accelerations `before`
/// at its start, under impulses that add `rate` to the velocity per second, their total contribution to the
/// velocity, and the acceleration without them at the midpoint, in the axes at the end of the step. Both
/// accelerations are [in space](acceleration_in_space).
fn midpoint_step_with_contacts<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    (before, rate): (&SVector<T, NV>, &SVector<T, NV>),
    h: T,
    t: T,
) -> (State<T, NQ, NV>, SVector<T, NV>, SVector<T, NV>) {
    let (half, still) = (h * constant(0.5), SVector::zeros());
    let to_middle = start.v * half;
    let middle = displaced_along_straight_lines(system, (start.t, &start.q), &to_middle);
    let velocity_in_midpoint_axes = |system: &D, x: &SVector<T, NV>| {
        velocity_in_displaced_axes(system, (start.t, &start.q), &to_middle, x)
    };
    let is_free = *rate == still;
    // Impulses keep their directions in space, like forces that act in the middle.
    let rate = if is_free { still } else { system.carry(start.t, &start.q, &to_middle, rate) };
    let v = velocity_in_midpoint_axes(system, &(start.v + before * half)) + rate * half;
    let acceleration = system.acceleration(start.t + half, &middle, &v);
    let acceleration = rate_without_axis_rotation(system, (start.t + half, &v), acceleration);
    let v = velocity_in_midpoint_axes(system, &start.v) + (acceleration + rate) * h;
    let to_end = v * half;
    let velocity_in_step_end_axes = |system: &D, x: &SVector<T, NV>| {
        velocity_in_displaced_axes(system, (start.t + half, &middle), &to_end, x)
    };
    let given = if is_free { still } else { system.carry(start.t + half, &middle, &to_end, &rate) * h };
    let end = State {
        t,
        q: displaced_along_straight_lines(system, (start.t + half, &middle), &to_end),
        v: velocity_in_step_end_axes(system, &v),
    };
    (end, given, velocity_in_step_end_axes(system, &acceleration))
}

/// Returns the configuration after a displacement during which the origins of free bodies move along straight
/// lines.
fn displaced_along_straight_lines<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    (t, q): (T, &SVector<T, NQ>),
    by: &SVector<T, NV>,
) -> SVector<T, NQ> {
    let translation = system.translation(t, by);
    match translation.iter().all(|x| *x == T::zero()) {
        true => system.integrate(q, by),
        false => system.integrate(&system.integrate(q, &translation), &(by - translation)),
    }
}

/// Returns a velocity in the axes after a displacement; with declared generalized speeds, the same speeds.
fn velocity_in_displaced_axes<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    (t, q): (T, &SVector<T, NQ>),
    displacement: &SVector<T, NV>,
    v: &SVector<T, NV>,
) -> SVector<T, NV> {
    if system.has_speeds() { *v } else { system.carry(t, q, displacement, v) }
}

/// Returns the rate of a velocity without the rotation of the axes of ball and free joints.
fn rate_without_axis_rotation<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &D,
    (t, v): (T, &SVector<T, NV>),
    acceleration: SVector<T, NV>,
) -> SVector<T, NV> {
    acceleration - system.carry_rate(t, v, v)
}
