//! The course of a run: steps of the integrator, samples, control instants and events in the order of time.

use super::clock::{Clock, after};
use super::event::together;
use super::{Events, Flow, Hit, Overlaps, Sample, Samples, Simulation, Undefined, not_negative, positive};
use crate::integrate::{Error, Inputs, Jump, Method, State, Step, settled};
use crate::private::{constant, epsilon, to_f64};
use crate::{Real, Rheonomic};
use nalgebra::SVector;

/// Parts into which every step is divided in the search for events.
const SEARCHES: u8 = 4;

/// Part of a step within which the same impact again is one of infinitely many.
const SOON: f64 = 1e-6;

/// Whether numbers differ by more than a rounded figure does, or one of them is none.
fn far<T: Real>(a: T, b: T) -> bool {
    let tolerance = constant::<T>(1e-6).max(epsilon::<T>().sqrt());
    let near = (a - b).abs() <= tolerance * (T::one() + a.abs());
    !near
}

/// Checks that a configuration is equal to the one with unit quaternions.
pub(super) fn check_quaternions<M, T: Real, const NQ: usize, const NV: usize, const NU: usize>(
    q: &SVector<T, NQ>,
    unit: &SVector<T, NQ>,
) -> Result<(), Error>
where
    M: Rheonomic<NQ, NV, NU, Scalar = T>,
{
    let off = |i: &usize| unit.get(*i).zip(q.get(*i)).is_some_and(|(a, b)| far(*a, *b));
    // From the back: NaN may have spread to the position in front of the quaternion.
    match (0..NQ).rev().find(off).and_then(|i| M::CONFIGURATION.get(i)) {
        Some(coordinate) => Err(Error::Quaternion { coordinate }),
        None => Ok(()),
    }
}

/// The name of the entry that moves most from one vector to another, and by how much, if any is [`far`].
fn farthest<T: Real, const N: usize>(
    to: &SVector<T, N>,
    from: &SVector<T, N>,
    names: [&'static str; N],
) -> Option<(&'static str, f64)> {
    let moves = to.iter().zip(from).zip(names).filter(|((to, from), _)| far(**to, **from));
    let moves = moves.map(|((to, from), name)| (name, to_f64(*to - *from)));
    moves.reduce(|most, other| if other.1.abs() > most.1.abs() { other } else { most })
}

/// Events of one instant, as they act one after another.
#[derive(Clone, Debug)]
struct Firing<T, const NQ: usize, const NV: usize> {
    state: State<T, NQ, NV>,
    /// Seconds after the start.
    elapsed: f64,
    /// How far on the step events belong to the instant.
    limit: T,
    /// The event whose sample after the jump of the velocity is still to be emitted.
    jump: Option<usize>,
    /// The index from which on events have still to act.
    next: usize,
    /// What they have done together.
    jumped: bool,
    stopped: bool,
}

/// How far a run has come.
#[derive(Clone, Debug)]
pub(super) struct Progress<T, Memory, const NQ: usize, const NV: usize> {
    clock: Clock,
    /// The last node: start of the current step, or where the next begins; and its seconds after the start.
    node: State<T, NQ, NV>,
    elapsed: f64,
    /// The end of the current step in seconds after the start, and its time.
    ahead: (f64, T),
    /// Events that are acting.
    firing: Option<Firing<T, NQ, NV>>,
    memory: Memory,
    /// The current step, whose samples and events are being emitted. It counts time from its start.
    step: Option<Step<T, NQ, NV>>,
    /// How far on the current step events have been searched and handled.
    cursor: T,
    /// The next event on the current step, if any.
    hit: Option<Hit<T>>,
    /// Number of the next sample and the next control instant.
    sample: u64,
    control: u64,
    /// Whether the node has been emitted.
    shown: bool,
    /// Whether only the last sample is of interest.
    pub(super) quiet: bool,
    /// Whether an event has ended the run.
    stopped: bool,
    /// The last event that changed the velocity, and its seconds after the start.
    jump: Option<(usize, f64)>,
}

/// Why a run ends where the search for events has failed.
fn failure(reason: Undefined, t: f64) -> Error {
    match reason {
        Undefined::Value(event) => Error::Event { t, event },
        Undefined::Through(event) => Error::Impacts { t, event },
    }
}

type Memory<T, S, const NV: usize> = <S as Method<T>>::Memory<NV>;

/// A sample, if one is due.
type Due<T, const NQ: usize, const NV: usize, const NU: usize> = Result<Option<Sample<T, NQ, NV, NU>>, Error>;

impl<M, T, I, S, E, const NQ: usize, const NV: usize, const NU: usize>
    Simulation<'_, M, T, I, S, E, NQ, NV, NU>
where
    M: Rheonomic<NQ, NV, NU, Scalar = T>,
    T: Real,
    I: Inputs<T, NQ, NV, NU>,
    S: Method<T>,
    E: Events<T, NQ, NV>,
{
    /// Checks all settings and goes to the start, or to where an interrupted run has come.
    pub(super) fn begin(&mut self) -> Result<Progress<T, Memory<T, S, NV>, NQ, NV>, Error> {
        if let Some(run) = self.progress.take() {
            return Ok(run);
        }
        self.method.check()?;
        self.duration.map_or(Ok(()), |duration| not_negative("the duration", duration))?;
        self.check_samples()?;
        self.system.inputs.period().map_or(Ok(()), |period| positive("the control period", period))?;
        let start = self.start.finite()?;
        // Going nowhere makes quaternions unit.
        let unit = self.system.mechanism.integrate(&start.q, &SVector::zeros());
        // Where declared speeds determine no rates, nothing leads anywhere.
        if M::SPEEDS && unit.iter().any(|x| !x.is_finite()) {
            return Err(Error::NotFinite { t: to_f64(start.t) });
        }
        check_quaternions::<M, T, NQ, NV, NU>(&start.q, &unit)?;
        let start = self.parted(start)?;
        let node = self.on_constraints(start)?;
        let t = to_f64(node.t);
        if let Some((entry, by)) = farthest(&node.q, &start.q, M::CONFIGURATION)
            .or_else(|| farthest(&node.v, &start.v, M::VELOCITIES))
        {
            return Err(Error::OffConstraints { t, entry, by });
        }
        self.events.begin(&node).map_err(|reason| failure(reason, t))?;
        Ok(Progress {
            clock: self.clock(),
            node,
            elapsed: 0.0,
            ahead: (0.0, node.t),
            firing: None,
            memory: self.method.memory(),
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

    /// The start where surfaces of contacts do not overlap, unless they may.
    fn parted(&self, start: State<T, NQ, NV>) -> Result<State<T, NQ, NV>, Error> {
        if !M::CONTACTING || self.overlaps == Overlaps::Keep {
            return Ok(start);
        }
        let (mechanism, State { t, q, v }) = (self.system.mechanism, start);
        let reported = |reason| Error::Constraint { t: to_f64(t), reason };
        let parted = mechanism.contact_start(t, &q, self.overlaps == Overlaps::Part).map_err(reported)?;
        if parted == q {
            return Ok(start);
        }
        let v = mechanism.carry(t, &q, &mechanism.difference(&q, &parted), &v);
        self.on_constraints(State { t, q: parted, v })
    }

    /// The next sample; `None` at the end of the run.
    pub(super) fn next_sample(
        &mut self,
        run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>,
    ) -> Due<T, NQ, NV, NU> {
        loop {
            let sample = match (run.step, run.firing.is_some()) {
                (Some(step), true) => self.fire(run, &step)?,
                (Some(step), false) => self.along(run, &step)?,
                _ if self.at_end(run) && run.shown => return Ok(None),
                _ => self.at_node(run)?,
            };
            if sample.is_some() {
                return Ok(sample);
            }
        }
    }

    fn at_end(&self, run: &Progress<T, Memory<T, S, NV>, NQ, NV>) -> bool {
        run.stopped || run.clock.end().is_some_and(|end| run.elapsed >= end)
    }

    fn check_samples(&self) -> Result<(), Error> {
        match self.samples {
            Samples::Steps => Ok(()),
            Samples::Every(interval) => positive("the sampling interval", interval),
            Samples::At(times) => {
                let Some(first) = times.first() else {
                    return self.duration.map_or(Err(Error::Endless), |_| Ok(()));
                };
                not_negative("the time from the start to the first sample", *first - self.start.t)?;
                let mut pairs = times.iter().zip(times.iter().skip(1));
                pairs.try_for_each(|(a, b)| positive("the time between samples", *b - *a))
            }
        }
    }

    fn clock(&self) -> Clock {
        let (every, last) = match self.samples {
            Samples::Steps => (None, None),
            Samples::Every(interval) => (Some(interval), None),
            Samples::At(times) => (None, times.last().map(|last| *last - self.start.t)),
        };
        Clock::new(self.duration.or(last), every, self.system.inputs.period())
    }

    /// Seconds from the start to a time that was asked for.
    fn since_start(&self, t: &T) -> f64 {
        to_f64(*t) - to_f64(self.start.t)
    }

    /// When the next sample is due; `None` if every step is one. Behind the last one that was asked for, at
    /// the end.
    fn next_due(&self, run: &Progress<T, Memory<T, S, NV>, NQ, NV>) -> Option<f64> {
        let Samples::At(times) = self.samples else { return run.clock.sample(run.sample) };
        let end = run.clock.end().unwrap_or(f64::INFINITY);
        let due = usize::try_from(run.sample).ok().and_then(|k| times.get(k));
        Some(due.map_or(end, |t| self.since_start(t).min(end)))
    }

    /// The time at an instant of the run.
    fn time(&self, run: &Progress<T, Memory<T, S, NV>, NQ, NV>, elapsed: f64) -> T {
        if let Samples::At(times) = self.samples
            && let Some(asked) = usize::try_from(run.sample).ok().and_then(|k| times.get(k))
            && self.since_start(asked) == elapsed
        {
            return *asked;
        }
        let end = self.duration.filter(|_| run.clock.end() == Some(elapsed));
        end.map_or_else(|| after(self.start.t, elapsed), |duration| self.start.t + duration)
    }

    /// Where the next step must end at the latest.
    fn next_stop(&self, run: &Progress<T, Memory<T, S, NV>, NQ, NV>) -> Option<f64> {
        let sample = self.next_due(run).filter(|_| S::FIXED);
        let stops = [run.clock.end(), run.clock.control(run.control), sample];
        stops.into_iter().flatten().reduce(f64::min)
    }

    /// Between two steps: renews the inputs, emits the node if it is a sample, otherwise takes a step.
    fn at_node(&mut self, run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>) -> Due<T, NQ, NV, NU> {
        self.renew(run);
        let due = self.next_due(run).map_or(!run.shown, |sample| run.elapsed >= sample);
        if due {
            run.sample += 1;
            run.shown = true;
            if !run.quiet || self.at_end(run) {
                return Ok(Some(self.sample(run.node, None)));
            }
        }
        let stop = self.next_stop(run);
        let until = stop.map(|stop| constant(stop - run.elapsed));
        // Samples that no step ends on are interpolated.
        let sample = self.next_due(run).filter(|_| !S::FIXED);
        let within = sample.is_some_and(|sample| stop.is_none_or(|stop| sample < stop));
        let dense = E::COUNT > 0;
        let (origin, start) = (run.node.t, run.node.timed(T::zero()));
        let step =
            self.system.advance(&self.method, &mut run.memory, origin, &start, until, dense || within)?;
        let arrived = stop.filter(|_| until == Some(step.end.t));
        let elapsed = arrived.unwrap_or_else(|| run.elapsed + to_f64(step.end.t));
        run.ahead = (elapsed, self.time(run, elapsed));
        if dense || self.next_due(run).is_some_and(|sample| sample < elapsed) {
            (run.step, run.cursor, run.hit) = (Some(step), T::zero(), None);
        } else {
            self.go_ahead(run, &step);
        }
        Ok(None)
    }

    /// To the end of a step.
    fn go_ahead(&self, run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>, step: &Step<T, NQ, NV>) {
        let (elapsed, t) = run.ahead;
        (run.node, run.elapsed, run.step, run.shown) = (step.end.timed(t), elapsed, None, false);
    }

    /// A state on a step, with the time of the run.
    fn state(&self, origin: T, step: &Step<T, NQ, NV>, theta: T) -> State<T, NQ, NV> {
        let state = step.at(&self.system, theta);
        state.timed(origin + state.t)
    }

    /// Along a step: emits the next sample inside or the next event, otherwise goes to its end.
    fn along(
        &mut self,
        run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>,
        step: &Step<T, NQ, NV>,
    ) -> Due<T, NQ, NV, NU> {
        if run.hit.is_none() {
            self.search(run, step)?;
        }
        let length = run.ahead.0 - run.elapsed;
        let event = run.hit.map(|hit| (hit, run.elapsed + to_f64(hit.theta * step.end.t)));
        let limit = event.map_or(run.ahead.0, |(_, elapsed)| elapsed);
        if let Some(due) = self.next_due(run).filter(|due| *due < limit) {
            let t = self.time(run, due);
            run.sample += 1;
            if run.quiet {
                return Ok(None);
            }
            let theta = constant((due - run.elapsed) / length);
            let state = self.state(run.node.t, step, theta).timed(t);
            let state = self.on_constraints(state)?;
            return Ok(Some(self.sample(state, None)));
        }
        match event {
            Some((hit, elapsed)) => {
                let state = self.on_constraints(self.state(run.node.t, step, hit.theta))?;
                let limit = hit.theta + together();
                let (jump, next, jumped, stopped) = (None, 0, false, false);
                run.firing = Some(Firing { state, elapsed, limit, jump, next, jumped, stopped });
            }
            None => self.go_ahead(run, step),
        }
        Ok(None)
    }

    /// A state brought onto the constraints, if there are any.
    fn on_constraints(&self, state: State<T, NQ, NV>) -> Result<State<T, NQ, NV>, Error> {
        settled(&self.system, state, state.t)
    }

    /// Looks for the first event behind the cursor.
    fn search(
        &mut self,
        run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>,
        step: &Step<T, NQ, NV>,
    ) -> Result<(), Error> {
        if E::COUNT == 0 {
            return Ok(());
        }
        let (system, origin, end) = (&self.system, run.node.t, step.end.timed(run.ahead.1));
        let path = |theta: T| {
            let state = step.at(system, theta);
            if theta < T::one() { state.timed(origin + state.t) } else { end }
        };
        for part in 1..=SEARCHES {
            let to = constant::<T>(f64::from(part) / f64::from(SEARCHES));
            if to <= run.cursor {
                continue;
            }
            run.hit = self
                .events
                .locate(&path, run.cursor, to)
                .map_err(|reason| failure(reason, to_f64(origin)))?;
            if let Some(hit) = run.hit {
                run.cursor = hit.theta;
                return Ok(());
            }
            self.events.pass();
            run.cursor = to;
        }
        Ok(())
    }

    /// Lets the next event of an instant act; behind the last goes on.
    fn fire(
        &mut self,
        run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>,
        step: &Step<T, NQ, NV>,
    ) -> Due<T, NQ, NV, NU> {
        let Some(mut firing) = run.firing.take() else { return Ok(None) };
        run.hit = None;
        if let Some(index) = firing.jump.take() {
            let sample = self.sample(firing.state, Some(index));
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
                self.method.disturb(&mut run.memory, Jump::State);
            }
            return Ok(None);
        };
        let moment = step.end.t * constant(SOON);
        let mechanism = self.system.mechanism;
        let later = |state: &State<T, NQ, NV>| {
            let q = mechanism.integrate(&state.q, &(state.v * moment));
            State { t: state.t + moment, q, ..*state }
        };
        let before = firing.state;
        match self.events.act(index, &mut firing.state, &later) {
            Flow::Go => {}
            Flow::Stop => firing.stopped = true,
            Flow::Jump => {
                let soon = (run.ahead.0 - run.elapsed) * SOON;
                let again = |(last, elapsed)| last == index && firing.elapsed - elapsed < soon;
                if run.jump.is_some_and(again) {
                    return Err(Error::Impacts { t: to_f64(firing.state.t), event: index });
                }
                run.jump = Some((index, firing.elapsed));
                firing.jumped = true;
                firing.state = self.on_constraints(firing.state)?;
            }
        }
        let sample = match firing.state.v == before.v {
            true => self.sample(firing.state, Some(index)),
            false => {
                firing.jump = Some(index);
                self.sample(before, None)
            }
        };
        firing.next = index + 1;
        run.firing = Some(firing);
        Ok(Some(sample))
    }

    /// Begins a control period if one is due.
    fn renew(&mut self, run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>) {
        let State { t, q, v } = run.node;
        if run.clock.control(run.control).is_some_and(|control| run.elapsed >= control) {
            run.control += 1;
            self.system.inputs.renew(t, &q, &v);
            self.method.disturb(&mut run.memory, Jump::Inputs);
        }
    }

    fn sample(&mut self, State { t, q, v }: State<T, NQ, NV>, event: Option<usize>) -> Sample<T, NQ, NV, NU> {
        Sample { t, q, v, u: self.system.inputs.at(t, &q, &v), event }
    }
}
