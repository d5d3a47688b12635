//! Motion with contacts in which every event is located.

use super::adaptive::{AdaptiveMemory, AdaptiveSettings, TrialStepArguments, adaptive};
use super::control::ErrorScale;
use super::eighth::{CONTROL, trial_step};
use super::local::TimeShiftedSystem;
use super::{
    ContinuousInputs, Dynamics, Error, Inputs, Jump, Method, State, Step, System, TimeStepping,
    project_end_of_step,
};
use crate::Real;
use crate::contact::{
    ContactPhase, Contacts, PhaseState, PhasedMechanism, Visitor, kept, velocity_after_impact,
};
use crate::private::{constant, epsilon, to_f64};
use nalgebra::SVector;

/// Integration by [`DormandPrince8`](super::DormandPrince8) between [contact](crate::contact) events, which
/// are located to rounding: impacts, lift-off, the transitions from sliding to sticking and back.
///
/// Between events, the contact modes follow from the complementarity of gaps and forces and from Coulomb's
/// law ([`contact::acting`](crate::contact::acting)). The mechanism moves under the forces that enforce these
/// modes ([`contact::forward_dynamics`](crate::contact::forward_dynamics)). A sequence of accumulating
/// impacts ends when the rebounds are below rounding error: a ball comes to rest after finitely many bounces,
/// and remains at rest. If forces do not determine the next contact mode (Painlevé's paradox, sliding that
/// ends and starts in the same instant), a short step of [`TimeStepping`] determines it.
///
/// The method suits few contacts and tight tolerances: each event costs about ten steps. Events are searched
/// at the quarters of each step, so that a contact that opens and closes within a quarter may be missed
/// unless steps are short: see [`max_step`](Self::max_step). Use [`TimeStepping`] for mechanisms with dozens
/// of contacts, for SIMD lanes, and for first-order states. For mechanisms without contacts the method is
/// [`DormandPrince8`](super::DormandPrince8).
///
/// If every step is a sample, an impact yields two samples at the same time: before and after it.
///
/// ```
/// use linkwork::integrate::EventDriven;
/// use linkwork::prelude::*;
///
/// #[mechanism(gravity = -9.81 * z)]
/// struct Ball {
///     #[particle(mass = 0.1)]
///     ball: Particle,
///     #[joint(ground -> ball, along = z)]
///     height: Sleeve,
///     #[contact(ball, ground.plane(z), restitution = 0.5)]
///     bounce: Contact,
/// }
///
/// # fn main() -> Result<(), Error> {
/// let run = simulate(&Ball {}).from([1.0], [0.0]).method(EventDriven::new());
/// // The ball falls for √(2 h / g), bounces for twice as long, and comes to rest.
/// let fall = (2.0 / 9.81_f64).sqrt();
/// let bouncing = run.clone().duration(2.0 * fall).finish()?;
/// // The first rebound has half the speed and lasts half the time.
/// let s = bouncing.t - fall;
/// assert!((bouncing.q[0] - s * (0.5 * 9.81 * fall - 0.5 * 9.81 * s)).abs() < 1e-12);
/// let resting = run.duration(4.0 * fall).finish()?;
/// assert!(resting.q[0].abs() < 1e-12 && resting.v[0].abs() < 1e-12);
/// # Ok(())
/// # }
/// ```
///
/// Source: Acary and Brogliato, *Numerical Methods for Nonsmooth Dynamical Systems* (2008), ch. 8.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EventDriven<T> {
    settings: AdaptiveSettings<T>,
}

adaptive!(EventDriven);

/// Memory of [`EventDriven`]: data that one step passes to the next.
#[derive(Clone, Copy, Debug)]
pub struct EventMemory<T, const NV: usize> {
    adaptive: AdaptiveMemory<T, NV>,
    /// Number of consecutive very short steps, weighted by [`FEWER`].
    short: u32,
    /// Number of consecutive time-stepping steps among the very short steps; each is twice as long as the
    /// previous one.
    stretch: u32,
    /// Number of further steps that count as steps in which contacts slide and the contact forces are not
    /// unique, such as forces shared by redundant contacts.
    shared: u32,
    /// Whether the previous step was an impact.
    has_struck: bool,
}

/// Number of very short steps after which steps of time stepping alternate with located steps. It is larger
/// than the number of last bounces of a ball, and smaller than the number of steps that sliding in space
/// needs to find its direction just after its onset, which is stiff.
const SHORT_STEPS: u32 = 100;
/// Length below which a step counts as very short, in multiples of the shortest time-stepping step.
const SHORT: f64 = 64.0;
/// Length below which a step counts as very short while the forces of sliding contacts are indeterminate, in
/// multiples of the shortest time-stepping step. A search for the correct distribution of these forces may
/// not end.
const SHORT_SHARED: f64 = 8192.0;
/// Weight of a very short step while sliding contacts have indeterminate forces.
const FEWER: u32 = 8;
/// Number of steps after the last indeterminate forces of sliding contacts for which such forces are still
/// assumed.
const LATELY: u32 = 16;
/// Maximum number of doublings of the shortest time-stepping step.
const LONGEST: u32 = 14;

impl<T: Real, const NV: usize> EventMemory<T, NV> {
    /// Counts a step of the given length, in multiples of the shortest time-stepping step.
    fn count_step_in_short_steps(&mut self, length: T, is_shared: bool) {
        self.shared = if is_shared { LATELY } else { self.shared.saturating_sub(1) };
        let (short, weight) = if self.shared > 0 { (SHORT_SHARED, FEWER) } else { (SHORT, 1) };
        if length < constant(short) {
            self.short += weight;
        } else {
            (self.short, self.stretch) = (0, 0);
        }
    }

    /// Returns whether very short steps accumulate, so that the next step uses time stepping; if so,
    /// decreases their count below the threshold.
    fn take_request_for_time_stepping(&mut self) -> bool {
        let is_slowed_by_short_steps = self.short > SHORT_STEPS;
        if is_slowed_by_short_steps {
            self.short = SHORT_STEPS - 1;
        }
        is_slowed_by_short_steps
    }
}

impl<T: Real> Method<T> for EventDriven<T> {
    type Memory<const NV: usize> = EventMemory<T, NV>;

    const FIXED: bool = false;
    const CONTACTS: bool = true;
    const LOCATES: bool = true;

    fn check(&self) -> Result<(), Error> {
        self.settings.check()
    }

    fn initial_memory<const NV: usize>(&self) -> Self::Memory<NV> {
        EventMemory {
            adaptive: AdaptiveMemory::new(self.settings.first),
            short: 0,
            stretch: 0,
            shared: 0,
            has_struck: false,
        }
    }

    fn discard_memory_after_jump<const NV: usize>(&self, memory: &mut Self::Memory<NV>, _jump: Jump) {
        memory.adaptive.acceleration = None;
    }

    fn advance<D: Dynamics<T, NQ, NV>, const NQ: usize, const NV: usize>(
        &self,
        memory: &mut Self::Memory<NV>,
        system: &mut D,
        start: &State<T, NQ, NV>,
        until: Option<T>,
        dense: bool,
    ) -> Result<Step<T, NQ, NV>, Error> {
        let section =
            Section { settings: self.settings, memory: &mut *memory, start, until, origin: T::zero() };
        if let Some(step) = system.follow(section) {
            return step;
        }
        self.settings.advance(&CONTROL, &mut memory.adaptive, system, start, until, |system, attempt| {
            Ok(trial_step(system, attempt, dense))
        })
    }
}

/// Arguments of a step: settings, memory, start and latest end.
#[derive(Debug)]
pub struct Section<'a, T, const NQ: usize, const NV: usize> {
    settings: AdaptiveSettings<T>,
    memory: &'a mut EventMemory<T, NV>,
    start: &'a State<T, NQ, NV>,
    until: Option<T>,
    /// Origin of the times of the step, s.
    origin: T,
}

impl<T: Real, const NQ: usize, const NV: usize> Section<'_, T, NQ, NV> {
    /// Returns the arguments of the step with the origin of its times increased by `origin`, s.
    pub(super) fn shift_time_origin(self, origin: T) -> Self {
        Self { origin: self.origin + origin, ..self }
    }
}

/// Event-located step of a mechanism with contacts: arguments of the step, and the inputs.
pub(super) struct EventLocatedStepVisitor<'a, T, I, const NQ: usize, const NV: usize> {
    pub(super) section: Section<'a, T, NQ, NV>,
    pub(super) inputs: &'a mut I,
}

impl<T, I, const NQ: usize, const NV: usize, const NU: usize> Visitor<T, NQ, NV, NU>
    for EventLocatedStepVisitor<'_, T, I, NQ, NV>
where
    T: Real,
    I: Inputs<T, NQ, NV, NU>,
{
    type Output = Result<Step<T, NQ, NV>, Error>;

    fn visit<M, const NK: usize, const NR: usize>(self, mechanism: &M) -> Self::Output
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let Self { section: Section { settings, memory, start, until, origin }, inputs } = self;
        let now = origin + start.t;
        let add_time_to_error = |reason| Error::Constraint { t: to_f64(start.t), reason };
        let v = velocity_after_impact(mechanism, now, &start.q, &start.v).map_err(add_time_to_error)?;
        let begin = State { v, ..*start };
        memory.has_struck = v != start.v && !memory.has_struck;
        if memory.has_struck {
            // An impact is a step of zero duration, so that there are samples before and after it.
            return Ok(Step::linear(*start, begin, SVector::zeros()));
        }
        let tau = mechanism.generalized_forces(now, &begin.q, &v, &inputs.evaluate(now, &begin.q, &v));
        let (mut located, mut shared) = (None, false);
        if memory.take_request_for_time_stepping() {
            // The next step locates events again.
        } else if let Ok((phase, acceleration)) =
            ContactPhase::contact_phase_of_state(mechanism, now, &begin.q, &v, &tau)
        {
            shared = phase.has_nonunique_sliding_forces();
            let phased = PhasedMechanism { mechanism, phase };
            let mut within =
                PhaseStepper { phased: &phased, inputs: &mut *inputs, origin, begin, acceleration };
            located = within.advance_in_phase(&settings, &mut memory.adaptive, until);
        }
        let resolution = epsilon::<T>().sqrt();
        if let Some(Ok(step)) = located {
            memory.count_step_in_short_steps((step.end.t - start.t) / resolution, shared);
            Ok(step)
        } else {
            let h = resolution * constant(f64::from(1_u32 << memory.stretch));
            memory.stretch = (memory.stretch + 1).min(LONGEST);
            memory.adaptive.count_trial_step(&settings, start.t)?;
            let until = until.map_or(start.t + h, |until| until.min(start.t + h));
            let mut system =
                System::new(mechanism, ContinuousInputs(|t, q: &_, v: &_| inputs.evaluate(t, q, v)));
            let mut local = TimeShiftedSystem { system: &mut system, origin };
            TimeStepping::step(h).advance(
                &mut TimeStepping::step(h).initial_memory(),
                &mut local,
                &begin,
                Some(until),
                true,
            )
        }
    }
}

/// Step within a phase of constant contact modes.
struct PhaseStepper<'a, M, T, I, const NQ: usize, const NV: usize, const NK: usize, const NR: usize> {
    phased: &'a PhasedMechanism<'a, M, T, NK, NR>,
    inputs: &'a mut I,
    origin: T,
    begin: State<T, NQ, NV>,
    acceleration: SVector<T, NV>,
}

impl<M, T, I, const NQ: usize, const NV: usize, const NK: usize, const NR: usize>
    PhaseStepper<'_, M, T, I, NQ, NV, NK, NR>
where
    T: Real,
{
    /// Returns the value of the event function of a phase with constant contact modes after a step: negative
    /// past the first event.
    fn event_value<const NU: usize>(&mut self, state: &State<T, NQ, NV>) -> T
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
        I: Inputs<T, NQ, NV, NU>,
    {
        let State { t, q, v } = state;
        let (s, t) = (*t - self.begin.t, self.origin + *t);
        let tau = self.phased.mechanism.generalized_forces(t, q, v, &self.inputs.evaluate(t, q, v));
        PhaseState { s, t, q, v, tau: &tau }.smallest_event_function_value(self.phased)
    }

    /// Advances a step that ends at or before the first event. Returns `None` if an event occurs at the start
    /// of the step.
    fn advance_in_phase<const NU: usize>(
        &mut self,
        settings: &AdaptiveSettings<T>,
        memory: &mut AdaptiveMemory<T, NV>,
        until: Option<T>,
    ) -> Option<Result<Step<T, NQ, NV>, Error>>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
        I: Inputs<T, NQ, NV, NU>,
    {
        let Self { phased, origin, begin, .. } = *self;
        let landing = phased.phase.time_to_first_touchdown();
        let near = landing.map(|s| begin.t + s * constant(1.5));
        let until = match (near, until) {
            (Some(near), Some(until)) => Some(near.min(until)),
            (near, until) => near.or(until),
        };
        let made = {
            let inputs = &mut *self.inputs;
            let mut system =
                System::new(phased, ContinuousInputs(|t, q: &_, v: &_| inputs.evaluate(t, q, v)));
            let mut local = TimeShiftedSystem { system: &mut system, origin };
            memory.acceleration = Some(self.acceleration);
            let made = settings.advance(&CONTROL, memory, &mut local, &begin, until, |system, attempt| {
                Ok(trial_step(system, attempt, true))
            });
            made.map(|step| {
                let states = [0.25, 0.5, 0.75].map(|part| step.at(&local, constant(part)));
                (step, states)
            })
        };
        let (step, quarters) = match made {
            Ok(made) => made,
            Err(error) => return Some(Err(error)),
        };
        let past = quarters.into_iter().chain([step.end]).find(|state| self.event_value(state) < T::zero());
        let Some(past) = past else { return Some(self.project_end_of_step(step)) };
        let least = landing.map_or(epsilon::<T>().powf(constant(0.75)), |s| s * constant(1e-3));
        self.step_to_event(settings, past.t - begin.t, least).map(|step| self.project_end_of_step(step))
    }

    /// Returns the step that ends at an event, which lies before `h` seconds; `None` if it lies before
    /// `least`.
    fn step_to_event<const NU: usize>(
        &mut self,
        settings: &AdaptiveSettings<T>,
        h: T,
        least: T,
    ) -> Option<Step<T, NQ, NV>>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
        I: Inputs<T, NQ, NV, NU>,
    {
        // At least every third trial bisects the interval, so that this number suffices for all digits.
        const TRIALS: usize = 120;
        let half = constant::<T>(0.5);
        let (mut before, mut after) = ((T::zero(), None), (h, None));
        for k in 0..TRIALS {
            let between = (before.0 + after.0) * half;
            let secant = match (before.1, after.1) {
                (Some(a), Some(b)) if k % 3 != 2 => before.0 + (after.0 - before.0) * a / (a - b),
                _ => between,
            };
            let middle = if secant > before.0 && secant < after.0 { secant } else { between };
            let is_done = after.0 - before.0 <= after.0 * epsilon::<T>() * constant(4.0);
            if is_done || middle <= before.0 || middle >= after.0 {
                break;
            }
            if after.0 < least {
                return None;
            }
            let state = self.step_without_event_search(settings, middle, false).end;
            let left = self.event_value(&state);
            // The function is steep where one event follows another, so the smallest negative value counts as
            // past the event.
            if left < T::zero() { after = (middle, Some(left)) } else { before = (middle, Some(left)) }
        }
        Some(self.step_without_event_search(settings, after.0, true))
    }

    /// Returns a trial step of `h` seconds with the current contact modes, without a search for events.
    fn step_without_event_search<const NU: usize>(
        &mut self,
        settings: &AdaptiveSettings<T>,
        h: T,
        dense: bool,
    ) -> Step<T, NQ, NV>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
        I: Inputs<T, NQ, NV, NU>,
    {
        let Self { phased, origin, begin, .. } = *self;
        let inputs = &mut *self.inputs;
        let mut system = System::new(phased, ContinuousInputs(|t, q: &_, v: &_| inputs.evaluate(t, q, v)));
        let mut local = TimeShiftedSystem { system: &mut system, origin };
        let dimensions = phased.mechanism.features().dimensions;
        let scale = ErrorScale { relative: settings.relative, absolute: settings.absolute, dimensions };
        let attempt = TrialStepArguments {
            start: &begin,
            acceleration: &self.acceleration,
            scale: &scale,
            h,
            t: begin.t + h,
        };
        trial_step(&mut local, &attempt, dense).step
    }

    /// Returns the step with its end projected onto active contacts and constraints.
    fn project_end_of_step<const NU: usize>(
        &mut self,
        step: Step<T, NQ, NV>,
    ) -> Result<Step<T, NQ, NV>, Error>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
        I: Inputs<T, NQ, NV, NU>,
    {
        let Self { phased, origin, begin, .. } = *self;
        let end = step.end.finite_or_error().map_err(|_| Error::NotFinite { t: to_f64(begin.t) })?;
        let (q, v) = kept(phased, origin + end.t, &end.q, &end.v);
        let inputs = &mut *self.inputs;
        let mut system = System::new(phased, ContinuousInputs(|t, q: &_, v: &_| inputs.evaluate(t, q, v)));
        let local = TimeShiftedSystem { system: &mut system, origin };
        Ok(Step { end: project_end_of_step(&local, State { q, v, ..end }, begin.t)?, ..step })
    }
}
