//! The course of a run: steps of the integrator, samples, control instants and events in the order of time.

use super::{Events, Flow, Hit, Sample, Simulation, Undefined, positive};
use crate::integrate::{Error, Inputs, Jump, Method, State, Step, settled};
use crate::private::{constant, epsilon, to_f64};
use crate::{Real, Rheonomic};

/// Parts into which every step is divided in the search for events.
const SEARCHES: u8 = 4;

/// Part of a step within which the same impact again is one of infinitely many.
const SOON: f64 = 1e-6;

/// How far a run has come.
#[derive(Clone, Debug)]
pub(super) struct Progress<T, Memory, const NQ: usize, const NV: usize> {
    /// The last node: start of the current step, or where the next begins.
    node: State<T, NQ, NV>,
    memory: Memory,
    /// The current step, whose samples and events are being emitted.
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
    /// Number and time of the last event that changed the velocity.
    jump: Option<(usize, T)>,
}

/// `t`, or `onto` if it is that up to rounding.
fn snapped<T: Real>(t: T, onto: Option<T>) -> T {
    let near = constant::<T>(8.0) * epsilon::<T>();
    onto.filter(|onto| (t - *onto).abs() <= near * (t.abs() + onto.abs())).unwrap_or(t)
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
        self.duration.map_or(Ok(()), |duration| positive("the duration", duration))?;
        self.every.map_or(Ok(()), |interval| positive("the sampling interval", interval))?;
        self.system.inputs.period().map_or(Ok(()), |period| positive("the control period", period))?;
        let node = self.on_constraints(self.start.finite()?)?;
        let tolerance = constant::<T>(1e-6).max(epsilon::<T>().sqrt());
        let far = |a: T, b: T| (a - b).abs() > tolerance * (T::one() + a.abs());
        let moved = node.q.iter().zip(&self.start.q).any(|(a, b)| far(*a, *b));
        let changed = node.v.iter().zip(&self.start.v).any(|(a, b)| far(*a, *b));
        if moved || changed {
            return Err(Error::OffConstraints { t: to_f64(node.t) });
        }
        self.events.begin(&node);
        Ok(Progress {
            node,
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

    /// The next sample; `None` at the end of the run.
    pub(super) fn next_sample(
        &mut self,
        run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>,
    ) -> Due<T, NQ, NV, NU> {
        loop {
            let sample = match run.step {
                Some(step) => self.along(run, &step)?,
                None if self.at_end(run) && run.shown => return Ok(None),
                None => self.at_node(run)?,
            };
            if sample.is_some() {
                return Ok(sample);
            }
        }
    }

    fn end(&self) -> Option<T> {
        self.duration.map(|duration| self.start.t + duration)
    }

    fn at_end(&self, run: &Progress<T, Memory<T, S, NV>, NQ, NV>) -> bool {
        run.stopped || self.end().is_some_and(|end| run.node.t >= end)
    }

    /// Time of a sample, not later than the end; `None` if every node is one.
    fn sample_time(&self, count: u64) -> Option<T> {
        let end = self.end();
        // Counts are exact up to 2⁵³.
        let t = snapped(self.start.t + self.every? * constant(count as f64), end);
        Some(end.map_or(t, |end| t.min(end)))
    }

    /// Time of a control instant. Up to rounding on a sample or the end is on it.
    fn control_time(&self, count: u64) -> Option<T> {
        let (start, period) = (self.start.t, self.system.inputs.period()?);
        let t = start + period * constant(count as f64);
        let nearest = self.every.map(|every| start + every * ((t - start) / every).round());
        Some(snapped(snapped(t, nearest), self.end()))
    }

    /// Where the next step must end at the latest.
    fn next_stop(&self, run: &Progress<T, Memory<T, S, NV>, NQ, NV>) -> Option<T> {
        let sample = self.sample_time(run.sample).filter(|_| S::FIXED);
        let stops = [self.end(), self.control_time(run.control), sample];
        stops.into_iter().flatten().reduce(|a, b| a.min(b))
    }

    /// Between two steps: renews the inputs, emits the node if it is a sample, otherwise takes a step.
    fn at_node(&mut self, run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>) -> Due<T, NQ, NV, NU> {
        self.renew(run);
        let due = self.sample_time(run.sample).map_or(!run.shown, |t| run.node.t >= t);
        if due {
            run.sample += 1;
            run.shown = true;
            if !run.quiet || self.at_end(run) {
                return Ok(Some(self.sample(run.node, None)));
            }
        }
        let until = self.next_stop(run);
        let dense = E::COUNT > 0;
        let step = self.system.advance(&self.method, &mut run.memory, &run.node, until, dense)?;
        if dense || self.sample_time(run.sample).is_some_and(|t| t < step.end.t) {
            (run.step, run.cursor, run.hit) = (Some(step), T::zero(), None);
        } else {
            (run.node, run.shown) = (step.end, false);
        }
        Ok(None)
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
        let event = run.hit.map(|hit| (hit, step.at(&self.system, hit.theta)));
        let limit = event.map_or(step.end.t, |(_, state)| state.t);
        if let Some(t) = self.sample_time(run.sample).filter(|t| *t < limit) {
            run.sample += 1;
            if run.quiet {
                return Ok(None);
            }
            let theta = (t - step.start.t) / (step.end.t - step.start.t);
            let state = self.on_constraints(State { t, ..step.at(&self.system, theta) })?;
            return Ok(Some(self.sample(state, None)));
        }
        match event {
            Some((hit, state)) => {
                let state = self.on_constraints(state)?;
                self.fire(run, hit, state, step).map(Some)
            }
            None => {
                (run.node, run.step, run.shown) = (step.end, None, false);
                Ok(None)
            }
        }
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
        let system = &self.system;
        let path = |theta: T| {
            if theta < T::one() { step.at(system, theta) } else { step.end }
        };
        for part in 1..=SEARCHES {
            let to = constant::<T>(f64::from(part) / f64::from(SEARCHES));
            if to <= run.cursor {
                continue;
            }
            run.hit = self
                .events
                .locate(&path, run.cursor, to)
                .map_err(|Undefined| Error::NotFinite { t: to_f64(step.start.t) })?;
            if let Some(hit) = run.hit {
                run.cursor = hit.theta;
                return Ok(());
            }
            self.events.pass();
            run.cursor = to;
        }
        Ok(())
    }

    fn fire(
        &mut self,
        run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>,
        hit: Hit<T>,
        mut state: State<T, NQ, NV>,
        step: &Step<T, NQ, NV>,
    ) -> Result<Sample<T, NQ, NV, NU>, Error> {
        run.hit = None;
        let flow = self.events.act(hit.index, &mut state);
        if flow == Flow::Jump {
            let soon = (step.end.t - step.start.t) * constant(SOON);
            if run.jump.is_some_and(|(index, t)| index == hit.index && state.t - t < soon) {
                return Err(Error::Impacts { t: to_f64(state.t) });
            }
            run.jump = Some((hit.index, state.t));
        }
        if flow != Flow::Go {
            (run.node, run.step, run.shown) = (state, None, true);
            run.stopped = flow == Flow::Stop;
            self.method.disturb(&mut run.memory, Jump::State);
        }
        Ok(self.sample(state, Some(hit.index)))
    }

    /// Begins a control period if one is due.
    fn renew(&mut self, run: &mut Progress<T, Memory<T, S, NV>, NQ, NV>) {
        let State { t, q, v } = run.node;
        if self.control_time(run.control).is_some_and(|control| t >= control) {
            run.control += 1;
            self.system.inputs.renew(t, &q, &v);
            self.method.disturb(&mut run.memory, Jump::Inputs);
        }
    }

    fn sample(&mut self, State { t, q, v }: State<T, NQ, NV>, event: Option<usize>) -> Sample<T, NQ, NV, NU> {
        Sample { t, q, v, u: self.system.inputs.at(t, &q, &v), event }
    }
}
