//! Time stepping: motion with impacts and friction in steps of fixed length.

use super::rk4::through;
use super::{Dynamics, Error, Jump, Method, State, Step, equal_step, positive, settled};
use crate::Real;
use crate::constraint::ConstraintError;
use crate::contact::Touched;
use crate::private::{constant, to_f64};
use nalgebra::SVector;

/// Time stepping after Moreau and Jean, for mechanisms with [contacts](crate::contact): impacts are not located, so that any
/// number of them costs nothing.
///
/// A step of [`Rk4`](super::Rk4) leads to the configuration `q_f` and the velocity `v_f`, under the impulses `Λ₀` that hold those
/// surfaces together which touch at its start. Then the impulses `Λ` of the whole step replace them:
///
/// ```text
/// v₁ = v_f + M⁻¹ Gᵀ Λ − w₀ + c,   q₁ = q_f ⊕ (h/2) (v₁ − v_f)
/// ```
///
/// `w₀` is the change of velocity by `Λ₀`, and `c` makes the sum a trapezoidal rule for contact forces that
/// rotate: half of the part of `w₀` that no impulses at the end of the step can give, and half of the part of
/// `Λ₀` that is not opposite to the slip there. Without it the directions of the end would hold for the whole
/// step, which is of order 1 and brakes what rolls.
///
/// Between impacts the order is 4, under lasting contact 2 and through impacts 1. The impulses satisfy
/// Coulomb's and Newton's laws to rounding ([`contact::solve`](crate::contact::solve)): at the end of a step
/// surfaces that stick have no slip, and bodies at rest do not creep under any load that friction holds. No
/// impulse of an impact gives energy. Under lasting contact the energy is exact to order 2: a bob of 1 kg in
/// a smooth bowl of 1 m is off by `3e-6` of its energy after 2 s in steps of 1 ms. The order is 1 where slip
/// turns at contacts that share forces in more than one way, such as the corners of a box.
///
/// Surfaces overlap by what
/// they approach in a step when they meet, at most. Where they stay together the overlap is taken away by
/// displacements of the bodies in proportion to how easily they move (Acary, *Projected event-capturing
/// time-stepping schemes*, Comput. Methods Appl. Mech. Eng. 256, 2013), as far as the energy allows that
/// impacts and friction take in the step: contacts do not lift what rests in each other. Restitution is
/// lowered where a step would end with more energy than without contacts. What the energy still gains is the
/// error of the order above: in drops of boxes of some kilograms that turn about their edges `25 h²` J in a
/// step of `h` seconds at most, and `35 h²` J without friction.
///
/// `Λ₀` are those of the step before if they have hardly changed, and are computed again otherwise.
///
/// A step takes four evaluations of the dynamics, or [two](Self::midpoint), and with contacts that are closed
/// one of gaps, Jacobian and mass matrix and two of rates, or twice as many if the contacts have changed. Its
/// matrices are on the stack, up to six of `R × R` numbers for the `R` rates of all contacts, open ones too,
/// and several times that in unoptimised builds: 5 KiB for two feet, 2.5 MiB for the 240 rates of ten boxes
/// on each other, where a thread needs [more
/// stack](https://doc.rust-lang.org/std/thread/struct.Builder.html#method.stack_size) than it has by default.
///
/// Constraints hold at the end of each step. Source: Jean, *The non-smooth contact dynamics method*, Comput. Methods Appl. Mech.
/// Eng. 177 (1999).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeStepping<T> {
    step: T,
    midpoint: bool,
}

impl<T: Real> TimeStepping<T> {
    /// Steps of `step` seconds; a little shorter where they have to end on a sample time.
    pub const fn step(step: T) -> Self {
        Self { step, midpoint: false }
    }

    /// Steps with two evaluations of the dynamics in place of four: as in Moreau's own scheme half a step along the velocity at its start
    /// to the midpoint, the accelerations `a` there, and half a step along the velocity at its end. Of a step of `h` seconds from the
    /// configuration `q` and the velocity `v` this makes
    ///
    /// ```text
    /// q_m = q ⊕ (h/2) v,   v_m = v + (h/2) a(q, v),   v_f = v + h a(q_m, v_m),   q_f = q_m ⊕ (h/2) v_f
    /// ```
    ///
    /// to which `Λ₀` adds as to the velocities of any step of [`TimeStepping`]; what follows, `v₁` and `q₁`, is the same. Between impacts
    /// the order is 2, with declared speeds 1; where forces and inertia do not depend on velocities, the method is the leapfrog, whose
    /// energy does not drift. `Λ₀` acts in its direction at the midpoint. Source: Moreau,
    /// *Numerical aspects of the sweeping process*, Comput. Methods Appl. Mech. Eng. 177 (1999), with `v_m` in place of `v` in the
    /// accelerations.
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
    /// // Dropped from 1 m, it has bounced to 0.25 m after 1.5 times the fall.
    /// let fall = (2.0 / 9.81_f64).sqrt();
    /// let run = simulate(&Ball {}).from([1.0], [0.0]).method(TimeStepping::step(1e-4).midpoint());
    /// let end = run.duration(1.5 * fall).finish().expect("it bounces");
    /// assert!((end.q[0] - 0.25).abs() < 1e-3);
    /// ```
    pub const fn midpoint(self) -> Self {
        Self { midpoint: true, ..self }
    }
}

/// What contacts have done to the velocity in the last step, per second.
#[derive(Clone, Copy, Debug)]
pub struct TouchMemory<T, const NV: usize> {
    rate: SVector<T, NV>,
    /// It is about what it was in the step before.
    steady: bool,
}

/// The part of what contacts do that may change from step to step where they are taken to go on.
const STEADY: f64 = 0.125;

impl<T: Real, const NV: usize> TouchMemory<T, NV> {
    const fn new(rate: SVector<T, NV>) -> Self {
        Self { rate, steady: false }
    }

    /// Takes note of what contacts have done in a step.
    fn note(&mut self, rate: SVector<T, NV>) {
        let least = |size: T, x: &T| size.max(x.abs());
        let size = rate.iter().fold(T::zero(), least);
        let change = (rate - self.rate).iter().fold(T::zero(), least);
        *self = Self { rate, steady: change <= size * constant(STEADY) };
    }
}

impl<T: Real> Method<T> for TimeStepping<T> {
    type Memory<const NV: usize> = TouchMemory<T, NV>;

    const FIXED: bool = true;
    const CONTACTS: bool = true;

    fn check(&self) -> Result<(), Error> {
        positive("the step", self.step)
    }

    fn memory<const NV: usize>(&self) -> Self::Memory<NV> {
        TouchMemory::new(SVector::zeros())
    }

    fn disturb<const NV: usize>(&self, memory: &mut Self::Memory<NV>, jump: Jump) {
        // Inputs change what contacts do by as much as they move.
        memory.steady &= matches!(jump, Jump::Inputs);
    }

    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        memory: &mut Self::Memory<NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        _dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error> {
        let (h, t) = equal_step(self.step, start.t, until)?;
        let reported = |reason| match reason {
            ConstraintError::NotFinite => Error::NotFinite { t: to_f64(start.t) },
            reason => Error::Constraint { t: to_f64(start.t), reason },
        };
        let before = system.acceleration(start.t, &start.q, &start.v);
        let rate = match memory.steady {
            true => memory.rate,
            false => holding(system, start, &before, h).map_err(reported)?,
        };
        let (free, given) = match self.midpoint {
            true => through_middle(system, start, (&before, &rate), h, t),
            false => guided(system, start, (&before, &rate), h, t),
        };
        let free = settled(system, free, start.t)?;
        let v = free.v - given;
        let Touched { q, v, held } =
            system.contact_step(t, (&start.q, &start.v), (&free.q, &v), &given, h).map_err(reported)?;
        memory.note(held / h);
        let end = State { q, v, ..free };
        let end = if end == free { end } else { settled(system, end, start.t)? };
        Ok(Step::linear(*start, end, (start.v + v) * (h * constant(0.5))))
    }
}

/// What the impulses that hold surfaces together at the start of a step of `h` seconds add to the velocity, per second; `before` are
/// the accelerations without them.
pub(crate) fn holding<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    before: &SVector<T, NV>,
    h: T,
) -> Result<SVector<T, NV>, ConstraintError> {
    let state = (&start.q, &start.v);
    let free = start.v + *before * h;
    // Without a duration nothing moves.
    let held = system.contact_step(start.t, state, (&start.q, &free), &SVector::zeros(), T::zero())?;
    Ok((held.v - free) / h)
}

/// Where a step of [`Rk4`](super::Rk4) leads from the accelerations `before`, under impulses that add `rate` to the velocity per
/// second, and what they add in all.
pub(crate) fn guided<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    (before, rate): (&SVector<T, NV>, &SVector<T, NV>),
    h: T,
    t: T,
) -> (State<T, NQ, NV>, SVector<T, NV>) {
    let still = SVector::zeros();
    let added = (*rate != still).then_some(rate);
    let ((displacement, change), at_end) = through(system, start, h, *before, added);
    let end = State { t, q: system.integrate(&start.q, &displacement), v: start.v + change };
    (end, at_end.map_or(still, |rate| rate * h))
}

/// Where a step through the [midpoint](TimeStepping::midpoint) leads from the accelerations `before`, under impulses that add `rate` to
/// the velocity per second, and what they add in all.
fn through_middle<T: Real, D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
    system: &mut D,
    start: &State<T, NQ, NV>,
    (before, rate): (&SVector<T, NV>, &SVector<T, NV>),
    h: T,
    t: T,
) -> (State<T, NQ, NV>, SVector<T, NV>) {
    let half = h * constant(0.5);
    let middle = system.integrate(&start.q, &(start.v * half));
    let at_middle = system.acceleration(start.t + half, &middle, &(start.v + (before + rate) * half));
    let still = SVector::zeros();
    if *rate == still {
        let v = start.v + at_middle * h;
        return (State { t, q: system.integrate(&middle, &(v * half)), v }, still);
    }
    // Impulses keep their directions in space, like forces that act in the middle.
    let carry = |h: T| system.carry(start.t, &start.q, &(start.v * h), rate);
    let v = start.v + (at_middle + carry(half)) * h;
    (State { t, q: system.integrate(&middle, &(v * half)), v }, carry(h) * h)
}
