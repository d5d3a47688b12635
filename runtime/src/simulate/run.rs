//! Execution of a run: steps of the integrator, samples, control instants and events in the order of time.

use super::clock::{RunTimes, time_after_start};
use super::event::coincidence_threshold;
use super::{
    EventHit, EventOutcome, EventSearchError, Events, Overlaps, Sample, SampleTimes, Simulation,
    check_not_negative, check_positive,
};
use crate::integrate::{Error, Inputs, Jump, Method, State, Step, project_end_of_step};
use crate::private::{constant, epsilon, to_f64};
use crate::{Mechanism, Real};
use nalgebra::SVector;

/// Number of parts into which each step is divided in the search for events.
const SEARCHES: u8 = 4;

/// Fraction of a step within which a repetition of the same impact indicates an accumulation of impacts.
const SOON: f64 = 1e-6;

/// Returns whether two numbers differ by more than printing with six digits explains. NaN differs from every
/// number.
fn has_significant_difference<T: Real>(a: T, b: T) -> bool {
    let tolerance = constant::<T>(1e-6).max(epsilon::<T>().sqrt());
    let near = (a - b).abs() <= tolerance * (T::one() + a.abs());
    !near
}

/// Checks that the quaternions of a configuration have unit norm; `unit` is the configuration with normalised
/// quaternions.
pub(super) fn check_unit_quaternions<M, T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    q: &SVector<T, NQ>,
    unit: &SVector<T, NQ>,
) -> Result<(), Error>
where
    M: Mechanism<NQ, NV, NU, Scalar = T>,
{
    let differs_from_unit =
        |i: &usize| unit.get(*i).zip(q.get(*i)).is_some_and(|(a, b)| has_significant_difference(*a, *b));
    // From the end: NaN in a quaternion may spread to the position before it.
    match (0..NQ).rev().find(differs_from_unit).and_then(|i| M::CONFIGURATION.get(i)) {
        Some(coordinate) => Err(Error::Quaternion { coordinate }),
        None => Ok(()),
    }
}

/// Returns the name and the change of the entry that differs most between two vectors, if any difference is
/// significant (see [`has_significant_difference`]).
fn largest_significant_change<T: Real, const N: usize>(
    to: &SVector<T, N>,
    from: &SVector<T, N>,
    names: [&'static str; N],
) -> Option<(&'static str, f64)> {
    let moves =
        to.iter().zip(from).zip(names).filter(|((to, from), _)| has_significant_difference(**to, **from));
    let moves = moves.map(|((to, from), name)| (name, to_f64(*to - *from)));
    moves.reduce(|most, other| if other.1.abs() > most.1.abs() { other } else { most })
}

/// Simultaneous events, whose effects are applied one after another.
#[derive(Clone, Debug)]
struct SimultaneousEvents<T, const NQ: usize, const NV: usize> {
    state: State<T, NQ, NV>,
    /// Time of the simultaneous events after the start of the run, s.
    elapsed: f64,
    /// Position on the step up to which events belong to the same instant.
    limit: T,
    /// Index of the event that has just changed the velocity, while the sample after the change is still to
    /// be emitted.
    jump: Option<usize>,
    /// Index of the first event whose effect has not been applied yet.
    next: usize,
    /// Whether one of the simultaneous events has changed the velocity; the field `stopped` is true if one
    /// has ended the run.
    jumped: bool,
    stopped: bool,
}

/// Progress of a simulation between two samples.
#[derive(Clone, Debug)]
pub(super) struct RunProgress<T, Memory, const NQ: usize, const NV: usize> {
    clock: RunTimes,
    /// State at the start of the current step, or of the next one if no step is current. The field `elapsed`
    /// is its time after the start of the run, s.
    node: State<T, NQ, NV>,
    elapsed: f64,
    /// End of the current step: time after the start, s, and time of the run.
    ahead: (f64, T),
    /// Simultaneous events whose effects are being applied, if any.
    firing: Option<SimultaneousEvents<T, NQ, NV>>,
    memory: Memory,
    /// Step whose samples and events are being emitted, with times relative to its start; `None` if the next
    /// step has not been computed yet.
    step: Option<Step<T, NQ, NV>>,
    /// Position on the current step up to which events have been searched and handled.
    cursor: T,
    /// Next event that was found on the current step, if any.
    hit: Option<EventHit<T>>,
    /// Index of the next sample. The field `control` is the index of the next control instant.
    sample: u64,
    control: u64,
    /// Whether the sample at the start of the step has been emitted.
    shown: bool,
    /// Whether the caller needs only the last sample of the run.
    pub(super) quiet: bool,
    /// Whether an event has ended the run.
    stopped: bool,
    /// Last event that changed the velocity, and its time after the start, s.
    jump: Option<(usize, f64)>,
}

/// Returns the error for a failed search for events.
fn event_search_error(reason: EventSearchError, t: f64) -> Error {
    match reason {
        EventSearchError::Value(event) => Error::Event { t, event },
        EventSearchError::Through(event) => Error::Impacts { t, event },
    }
}

type MethodMemory<T, S, const NV: usize> = <S as Method<T>>::Memory<NV>;

/// Result of advancing a simulation: a sample if one is due, or an error.
type DueSampleResult<T, const NQ: usize, const NV: usize, const NU: usize> =
    Result<Option<Sample<T, NQ, NV, NU>>, Error>;

impl<M, T, I, S, E, const NQ: usize, const NV: usize, const NU: usize>
    Simulation<'_, M, T, I, S, E, NQ, NV, NU>
where
    M: Mechanism<NQ, NV, NU, Scalar = T>,
    T: Real,
    I: Inputs<T, NQ, NV, NU>,
    S: Method<T>,
    E: Events<T, NQ, NV>,
{
    /// Returns the progress with which a simulation continues: that of an interrupted run, otherwise the
    /// initial progress, after checks of all settings.
    pub(super) fn initial_or_resumed_progress(
        &mut self,
    ) -> Result<RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>, Error> {
        if let Some(run) = self.progress.take() {
            return Ok(run);
        }
        self.method.check()?;
        self.duration.map_or(Ok(()), |duration| check_not_negative("the duration", duration))?;
        self.check_sample_times()?;
        self.system.inputs.period().map_or(Ok(()), |period| check_positive("the control period", period))?;
        let start = self.start.finite_or_error()?;
        // A zero displacement normalises quaternions.
        let unit = self.system.mechanism.integrate(&start.q, &SVector::zeros());
        // If declared generalized speeds determine no rates, the displacement is not finite.
        if self.system.mechanism.features().speeds && unit.iter().any(|x| !x.is_finite()) {
            return Err(Error::NotFinite { t: to_f64(start.t) });
        }
        check_unit_quaternions::<M, T, NQ, NV, NU>(&start.q, &unit)?;
        let start = self.initial_state_with_separated_surfaces(start)?;
        let node = self.project_on_constraints(start)?;
        let t = to_f64(node.t);
        if let Some((entry, by)) = largest_significant_change(&node.q, &start.q, M::CONFIGURATION)
            .or_else(|| largest_significant_change(&node.v, &start.v, M::VELOCITIES))
        {
            return Err(Error::OffConstraints { t, entry, by });
        }
        self.events.begin(&node).map_err(|reason| event_search_error(reason, t))?;
        Ok(RunProgress {
            clock: self.sample_and_control_instants(),
            node,
            elapsed: 0.0,
            ahead: (0.0, node.t),
            firing: None,
            memory: self.method.initial_memory(),
            step: None,
            cursor: T::zero(),
            hit: None,
            sample: 0,
            control: 0,
            shown: false,
            quiet: false,
            stopped: false,
            jump: None,
        })
    }

    /// Returns the initial state with separated contact surfaces, unless overlaps are permitted.
    fn initial_state_with_separated_surfaces(
        &self,
        start: State<T, NQ, NV>,
    ) -> Result<State<T, NQ, NV>, Error> {
        if !M::CONTACTING || self.overlaps == Overlaps::Keep {
            return Ok(start);
        }
        let (mechanism, State { t, q, v }) = (self.system.mechanism, start);
        let constraint_error_at_time = |reason| Error::Constraint { t: to_f64(t), reason };
        let parted = mechanism
            .contact_start(t, &q, self.overlaps == Overlaps::Part)
            .map_err(constraint_error_at_time)?;
        if parted == q {
            return Ok(start);
        }
        let v = mechanism.carry(t, &q, &mechanism.difference(&q, &parted), &v);
        self.project_on_constraints(State { t, q: parted, v })
    }

    /// Returns the next sample; `None` at the end of the run.
    pub(super) fn next_sample(
        &mut self,
        run: &mut RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>,
    ) -> DueSampleResult<T, NQ, NV, NU> {
        loop {
            let sample = match (run.step, run.firing.is_some()) {
                (Some(step), true) => self.fire_next_event(run, &step)?,
                (Some(step), false) => self.advance_within_step(run, &step)?,
                _ if self.has_reached_end(run) && run.shown => return Ok(None),
                _ => self.sample_node_or_take_step(run)?,
            };
            if sample.is_some() {
                return Ok(sample);
            }
        }
    }

    fn has_reached_end(&self, run: &RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>) -> bool {
        run.stopped || run.clock.run_duration().is_some_and(|end| run.elapsed >= end)
    }

    fn check_sample_times(&self) -> Result<(), Error> {
        match self.samples {
            SampleTimes::Steps => Ok(()),
            SampleTimes::Every(interval) => check_positive("the sampling interval", interval),
            SampleTimes::At(times) => {
                let Some(first) = times.first() else {
                    return self.duration.map_or(Err(Error::Endless), |_| Ok(()));
                };
                check_not_negative("the time from the start to the first sample", *first - self.start.t)?;
                let mut pairs = times.iter().zip(times.iter().skip(1));
                pairs.try_for_each(|(a, b)| check_positive("the time between samples", *b - *a))
            }
        }
    }

    fn sample_and_control_instants(&self) -> RunTimes {
        let (every, last) = match self.samples {
            SampleTimes::Steps => (None, None),
            SampleTimes::Every(interval) => (Some(interval), None),
            SampleTimes::At(times) => (None, times.last().map(|last| *last - self.start.t)),
        };
        RunTimes::new(self.duration.or(last), every, self.system.inputs.period())
    }

    /// Returns the time between the start of the run and a requested sample time, s.
    fn time_since_start(&self, t: &T) -> f64 {
        to_f64(*t) - to_f64(self.start.t)
    }

    /// Returns the instant of the next sample; `None` if every step is a sample. After the last requested
    /// time, the instant is the end of the run.
    fn next_sample_instant(&self, run: &RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>) -> Option<f64> {
        let SampleTimes::At(times) = self.samples else { return run.clock.sample_instant(run.sample) };
        let end = run.clock.run_duration().unwrap_or(f64::INFINITY);
        let due = usize::try_from(run.sample).ok().and_then(|k| times.get(k));
        Some(due.map_or(end, |t| self.time_since_start(t).min(end)))
    }

    /// Returns the time of the run at an instant.
    fn run_time_at_instant(&self, run: &RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>, elapsed: f64) -> T {
        if let SampleTimes::At(times) = self.samples
            && let Some(asked) = usize::try_from(run.sample).ok().and_then(|k| times.get(k))
            && self.time_since_start(asked) == elapsed
        {
            return *asked;
        }
        let end = self.duration.filter(|_| run.clock.run_duration() == Some(elapsed));
        end.map_or_else(|| time_after_start(self.start.t, elapsed), |duration| self.start.t + duration)
    }

    /// Returns the latest instant at which the next step must end.
    fn next_step_limit(&self, run: &RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>) -> Option<f64> {
        let sample = self.next_sample_instant(run).filter(|_| S::FIXED);
        let stops = [run.clock.run_duration(), run.clock.control_instant(run.control), sample];
        stops.into_iter().flatten().reduce(f64::min)
    }

    /// Continues at a node between two steps: updates the inputs, emits the node if it is a sample, otherwise
    /// takes a step.
    fn sample_node_or_take_step(
        &mut self,
        run: &mut RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>,
    ) -> DueSampleResult<T, NQ, NV, NU> {
        self.renew_control_period(run);
        let due = self.next_sample_instant(run).map_or(!run.shown, |sample| run.elapsed >= sample);
        if due {
            run.sample += 1;
            run.shown = true;
            if !run.quiet || self.has_reached_end(run) {
                return Ok(Some(self.make_sample(run, run.node, None)));
            }
        }
        let stop = self.next_step_limit(run);
        let until = stop.map(|stop| constant(stop - run.elapsed));
        // Samples between the ends of steps are interpolated.
        let sample = self.next_sample_instant(run).filter(|_| !S::FIXED);
        let within = sample.is_some_and(|sample| stop.is_none_or(|stop| sample < stop));
        let dense = E::COUNT > 0;
        let (origin, start) = (run.node.t, run.node.with_time_replaced(T::zero()));
        let step = self.system.advance_step(
            &self.method,
            &mut run.memory,
            origin,
            &start,
            until,
            dense || within,
        )?;
        let arrived = stop.filter(|_| until == Some(step.end.t));
        let elapsed = arrived.unwrap_or_else(|| run.elapsed + to_f64(step.end.t));
        run.ahead = (elapsed, self.run_time_at_instant(run, elapsed));
        if dense || self.next_sample_instant(run).is_some_and(|sample| sample < elapsed) {
            (run.step, run.cursor, run.hit) = (Some(step), T::zero(), None);
        } else {
            self.move_to_step_end(run, &step);
        }
        Ok(None)
    }

    /// Moves the progress of the run to the end of the step.
    fn move_to_step_end(
        &self,
        run: &mut RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>,
        step: &Step<T, NQ, NV>,
    ) {
        let (elapsed, t) = run.ahead;
        (run.node, run.elapsed, run.step, run.shown) = (step.end.with_time_replaced(t), elapsed, None, false);
    }

    /// Returns the state at position `theta` on a step, with the time of the run.
    fn state_on_step(&self, origin: T, step: &Step<T, NQ, NV>, theta: T) -> State<T, NQ, NV> {
        let state = step.at(&self.system, theta);
        state.with_time_replaced(origin + state.t)
    }

    /// Continues within a step: emits the next sample or event, otherwise advances to the end of the step.
    fn advance_within_step(
        &mut self,
        run: &mut RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>,
        step: &Step<T, NQ, NV>,
    ) -> DueSampleResult<T, NQ, NV, NU> {
        if run.hit.is_none() {
            self.search_next_event(run, step)?;
        }
        let length = run.ahead.0 - run.elapsed;
        let event = run.hit.map(|hit| (hit, run.elapsed + to_f64(hit.theta * step.end.t)));
        let limit = event.map_or(run.ahead.0, |(_, elapsed)| elapsed);
        if let Some(due) = self.next_sample_instant(run).filter(|due| *due < limit) {
            let t = self.run_time_at_instant(run, due);
            run.sample += 1;
            if run.quiet {
                return Ok(None);
            }
            let theta = constant((due - run.elapsed) / length);
            let state = self.state_on_step(run.node.t, step, theta).with_time_replaced(t);
            let state = self.project_on_constraints(state)?;
            return Ok(Some(self.make_sample(run, state, None)));
        }
        match event {
            Some((hit, elapsed)) => {
                let state = self.project_on_constraints(self.state_on_step(run.node.t, step, hit.theta))?;
                let limit = hit.theta + coincidence_threshold();
                let (jump, next, jumped, stopped) = (None, 0, false, false);
                run.firing = Some(SimultaneousEvents { state, elapsed, limit, jump, next, jumped, stopped });
            }
            None => self.move_to_step_end(run, step),
        }
        Ok(None)
    }

    /// Projects a state onto the constraints, if there are any.
    fn project_on_constraints(&self, state: State<T, NQ, NV>) -> Result<State<T, NQ, NV>, Error> {
        project_end_of_step(&self.system, state, state.t)
    }

    /// Searches for the first event after the current position on the step.
    fn search_next_event(
        &mut self,
        run: &mut RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>,
        step: &Step<T, NQ, NV>,
    ) -> Result<(), Error> {
        if E::COUNT == 0 {
            return Ok(());
        }
        let (system, origin, end) = (&self.system, run.node.t, step.end.with_time_replaced(run.ahead.1));
        let interpolated_state_or_step_end = |theta: T| {
            let state = step.at(system, theta);
            if theta < T::one() { state.with_time_replaced(origin + state.t) } else { end }
        };
        for part in 1..=SEARCHES {
            let to = constant::<T>(f64::from(part) / f64::from(SEARCHES));
            if to <= run.cursor {
                continue;
            }
            run.hit = self
                .events
                .locate(&interpolated_state_or_step_end, run.cursor, to)
                .map_err(|reason| event_search_error(reason, to_f64(origin)))?;
            if let Some(hit) = run.hit {
                run.cursor = hit.theta;
                return Ok(());
            }
            self.events.pass();
            run.cursor = to;
        }
        Ok(())
    }

    /// Applies the effect of the next event of an instant; after the last event, continues the run.
    fn fire_next_event(
        &mut self,
        run: &mut RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>,
        step: &Step<T, NQ, NV>,
    ) -> DueSampleResult<T, NQ, NV, NU> {
        let Some(mut firing) = run.firing.take() else { return Ok(None) };
        run.hit = None;
        if let Some(index) = firing.jump.take() {
            let sample = self.make_sample(run, firing.state, Some(index));
            run.firing = Some(firing);
            return Ok(Some(sample));
        }
        let Some(index) = self.events.due(firing.next, firing.limit) else {
            if firing.jumped {
                self.events.rebound(firing.limit);
            }
            if firing.jumped || firing.stopped {
                (run.node, run.elapsed, run.step) = (firing.state, firing.elapsed, None);
                (run.shown, run.stopped) = (true, firing.stopped);
                self.method.discard_memory_after_jump(&mut run.memory, Jump::State);
            }
            return Ok(None);
        };
        let moment = step.end.t * constant(SOON);
        let mechanism = self.system.mechanism;
        let state_a_moment_later = |state: &State<T, NQ, NV>| {
            let q = mechanism.integrate(&state.q, &(state.v * moment));
            State { t: state.t + moment, q, ..*state }
        };
        let before = firing.state;
        match self.events.act(index, &mut firing.state, &state_a_moment_later) {
            EventOutcome::Go => {}
            EventOutcome::Stop => firing.stopped = true,
            EventOutcome::Jump => {
                let soon = (run.ahead.0 - run.elapsed) * SOON;
                let is_repeated_event = |(last, elapsed)| last == index && firing.elapsed - elapsed < soon;
                if run.jump.is_some_and(is_repeated_event) {
                    return Err(Error::Impacts { t: to_f64(firing.state.t), event: index });
                }
                run.jump = Some((index, firing.elapsed));
                firing.jumped = true;
                firing.state = self.project_on_constraints(firing.state)?;
            }
        }
        let sample = match firing.state.v == before.v {
            true => self.make_sample(run, firing.state, Some(index)),
            false => {
                firing.jump = Some(index);
                self.make_sample(run, before, None)
            }
        };
        firing.next = index + 1;
        run.firing = Some(firing);
        Ok(Some(sample))
    }

    /// Starts a new control period of the inputs if one is due.
    fn renew_control_period(&mut self, run: &mut RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>) {
        let State { t, q, v } = run.node;
        if run.clock.control_instant(run.control).is_some_and(|control| run.elapsed >= control) {
            run.control += 1;
            self.system.inputs.renew(t, &q, &v);
            self.method.discard_memory_after_jump(&mut run.memory, Jump::Inputs);
        }
    }

    fn make_sample(
        &mut self,
        run: &mut RunProgress<T, MethodMemory<T, S, NV>, NQ, NV>,
        State { t, q, v }: State<T, NQ, NV>,
        event: Option<usize>,
    ) -> Sample<T, NQ, NV, NU> {
        let violation = S::take_violation(&mut run.memory);
        Sample { t, q, v, u: self.system.inputs.evaluate(t, &q, &v), event, violation }
    }
}
