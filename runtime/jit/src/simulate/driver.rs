//! Execution of simulations of padded robots by the integration methods of the runtime.

use super::kinds::{AdaptiveMethod, MethodWithoutContacts};
use super::{Controller, Method, Sample};
use crate::capacity::{ContactVisitor, Visitor};
use crate::error::Error;
use crate::padded::Padded;
use crate::robot::Robot;
use linkwork::integrate::{self, DormandPrince, EventDriven, Rodas, TimeStepping};
use linkwork::nalgebra::SVector;
use linkwork::simulate::Overlaps;
use linkwork::{Mechanism, simulate};
use std::cell::{Cell, RefCell};

/// Inputs of a simulation that do not depend on the state.
#[derive(Clone, Copy)]
pub(super) enum StateIndependentInputs<'a> {
    Zero,
    Constant(&'a [f64]),
    Samples(&'a [f64], &'a [f64]),
}

/// Checked settings of a simulation run.
#[derive(Clone, Copy)]
pub(super) struct Settings<'a> {
    pub(super) robot: &'a Robot,
    pub(super) method: Method,
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) every: Option<f64>,
    pub(super) overlaps: Overlaps,
    pub(super) inputs: StateIndependentInputs<'a>,
}

/// Driver of a simulation run: settings, controller, and receiver of the samples.
pub(super) struct Driver<'a, 'i, 's> {
    pub(super) settings: Settings<'a>,
    /// Controller that computes the inputs, with its sampling period, if any.
    pub(super) controller: Option<(Option<f64>, Controller<'i>)>,
    pub(super) sink: &'s mut (dyn FnMut(Sample) + Send),
    /// Whether the first sample of the run has been emitted.
    pub(super) has_begun: bool,
    pub(super) stiff_from: Option<f64>,
}

/// Simulation run with its initial state, to be started on a padded robot.
pub(super) struct SimulationVisitor<'d, 'a, 'i, 's> {
    pub(super) driver: &'d mut Driver<'a, 'i, 's>,
    pub(super) q: &'d [f64],
    pub(super) v: &'d [f64],
}

impl Visitor for SimulationVisitor<'_, '_, '_, '_> {
    type Output = Result<(), Error>;

    fn visit<const N: usize>(self, robot: &Padded<N, N, N, &Robot>) -> Self::Output {
        let driver = self.driver;
        let start = PaddedState::new(driver.settings.start, self.q, self.v);
        if let Method::Automatic(tolerance) = driver.settings.method {
            return driver.integrate_with_stiffness_switch(robot, start, tolerance);
        }
        match MethodWithoutContacts::new(driver.settings.method) {
            MethodWithoutContacts::Adaptive(method) => driver.integrate_with_method(robot, start, method),
            MethodWithoutContacts::FixedStep(method) => driver.integrate_with_method(robot, start, method),
        }
    }
}

impl ContactVisitor for SimulationVisitor<'_, '_, '_, '_> {
    type Output = Result<(), Error>;

    fn visit<M: Mechanism<N, N, N, Scalar = f64>, const N: usize>(self, robot: &M) -> Self::Output {
        let driver = self.driver;
        let start = PaddedState::new(driver.settings.start, self.q, self.v);
        match driver.settings.method {
            Method::TimeStepping(h) => driver.integrate_with_method(robot, start, TimeStepping::step(h)),
            Method::TimeSteppingMidpoint(h) => {
                driver.integrate_with_method(robot, start, TimeStepping::step(h).midpoint())
            }
            Method::TimeSteppingLeapfrog(h) => {
                driver.integrate_with_method(robot, start, TimeStepping::step(h).leapfrog())
            }
            Method::EventDriven(e) => {
                driver.integrate_with_method(robot, start, EventDriven::new().tolerance(e, e))
            }
            _ => Err(Error::Internal("a method without contacts".to_string())),
        }
    }
}

/// State whose vectors are padded with zeros to `N` entries.
#[derive(Clone, Copy)]
struct PaddedState<const N: usize> {
    t: f64,
    q: SVector<f64, N>,
    v: SVector<f64, N>,
}

impl<const N: usize> PaddedState<N> {
    fn new(t: f64, q: &[f64], v: &[f64]) -> Self {
        let padded_vector = |x: &[f64]| SVector::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
        PaddedState { t, q: padded_vector(q), v: padded_vector(v) }
    }
}

/// Section of a simulation between two times at which the inputs jump or have kinks.
#[derive(Clone)]
struct Section<const N: usize> {
    start: PaddedState<N>,
    end: f64,
    /// Times of the samples in the section, s, after its start.
    times: Vec<f64>,
    /// Inputs at the start of the section. The field below is their constant rate.
    u: SVector<f64, N>,
    rate: SVector<f64, N>,
    overlaps: Overlaps,
}

impl Settings<'_> {
    /// Returns the inputs of the section at a time; at a jump the limit before or after it.
    fn inputs_at_time<const N: usize>(&self, t: f64, is_before: bool) -> SVector<f64, N> {
        let n = self.robot.nu();
        let row =
            |values: &[f64], k: usize| SVector::from_fn(|i, _| if i < n { values[k * n + i] } else { 0.0 });
        match self.inputs {
            StateIndependentInputs::Zero => SVector::zeros(),
            StateIndependentInputs::Constant(u) => row(u, 0),
            StateIndependentInputs::Samples(times, values) => {
                let after = match is_before {
                    true => times.partition_point(|known| *known < t),
                    false => times.partition_point(|known| *known <= t),
                };
                match after {
                    0 => row(values, 0),
                    k if k == times.len() => row(values, k - 1),
                    k => {
                        let part = (t - times[k - 1]) / (times[k] - times[k - 1]);
                        row(values, k - 1) + (row(values, k) - row(values, k - 1)) * part
                    }
                }
            }
        }
    }

    /// Returns the ends of the sections: the times at which inputs jump or have kinks, and the end of the
    /// simulation.
    fn section_ends(&self) -> Vec<f64> {
        let mut stops = match self.inputs {
            StateIndependentInputs::Samples(times, _) => times.to_vec(),
            _ => Vec::new(),
        };
        stops.retain(|t| *t > self.start && *t < self.end);
        stops.dedup();
        stops.push(self.end);
        stops
    }

    /// Returns the time of the sample with an index, s.
    fn sample_time(&self, index: u64) -> Option<f64> {
        let every = self.every?;
        let t = self.start + index as f64 * every;
        // A last interval that results from rounding alone is not counted.
        Some(if t > self.end - every * 1e-9 { self.end } else { t })
    }

    fn sample_of_state<const N: usize>(&self, state: &PaddedState<N>, u: &SVector<f64, N>) -> Sample {
        let (robot, t) = (self.robot, state.t);
        let u = match self.inputs {
            StateIndependentInputs::Samples(..) => self.inputs_at_time(t, false),
            _ => *u,
        };
        let leading_entries = |x: &SVector<f64, N>, count: usize| x.as_slice()[..count].to_vec();
        let velocities = robot.nv() + robot.shared.states.len();
        Sample {
            t,
            q: leading_entries(&state.q, robot.nq()),
            v: leading_entries(&state.v, velocities),
            u: leading_entries(&u, robot.nu()),
        }
    }
}

/// Inputs of a section, in the form in which integration methods request them.
struct SectionInputs<'f, 'i, const N: usize> {
    settings: &'f Settings<'f>,
    section: &'f Section<N>,
    controller: Option<&'f mut (Option<f64>, Controller<'i>)>,
    /// Inputs of the current sampling period of the controller.
    u: SVector<f64, N>,
    evaluations: &'f Cell<u64>,
    failure: &'f RefCell<Option<String>>,
}

impl<const N: usize> SectionInputs<'_, '_, N> {
    /// Calls the controller. Inputs that are NaN end the simulation.
    fn call_control(&mut self, t: f64, q: &SVector<f64, N>, v: &SVector<f64, N>) -> SVector<f64, N> {
        let Some((_, function)) = &mut self.controller else { return SVector::zeros() };
        let robot = self.settings.robot;
        let mut u = SVector::<f64, N>::zeros();
        let mut failure = self.failure.borrow_mut();
        if failure.is_none() {
            let velocities = robot.nv() + robot.shared.states.len();
            let (q, v) = (&q.as_slice()[..robot.nq()], &v.as_slice()[..velocities]);
            *failure = function(t, q, v, &mut u.as_mut_slice()[..robot.nu()]).err();
        }
        if failure.is_some() { SVector::repeat(f64::NAN) } else { u }
    }
}

impl<const N: usize> integrate::Inputs<f64, N, N, N> for SectionInputs<'_, '_, N> {
    fn evaluate(&mut self, t: f64, q: &SVector<f64, N>, v: &SVector<f64, N>) -> SVector<f64, N> {
        self.evaluations.set(self.evaluations.get() + 1);
        match &self.controller {
            Some((Some(_), _)) => self.u,
            Some((None, _)) => self.call_control(t, q, v),
            None => self.section.u + self.section.rate * (t - self.section.start.t),
        }
    }

    fn period(&self) -> Option<f64> {
        self.controller.as_ref().and_then(|(period, _)| *period)
    }

    fn renew(&mut self, t: f64, q: &SVector<f64, N>, v: &SVector<f64, N>) {
        self.u = self.call_control(t, q, v);
    }
}

/// State at the end of an integration; after an error, the state of the last sample before it.
type IntegrationEnd<const N: usize> = (PaddedState<N>, Result<(), Error>);

/// Maximum number of steps of an explicit method before an implicit method is tried.
const MOST_STEPS: u64 = 200_000;
/// Maximum number of steps of an implicit method when its cost is compared with that of an explicit method.
const MOST_IMPLICIT_STEPS: u64 = 20_000;
/// Minimum step size of an explicit method, s.
const SHORTEST: f64 = 1e-10;
/// Number of evaluations of the dynamics after which an implicit method is tried for the first time.
const OBSERVED: u64 = 2000;

impl Driver<'_, '_, '_> {
    /// Integrates the motion section by section; sections end where the inputs jump or have kinks.
    fn integrate_sections<const N: usize>(
        &mut self,
        start: PaddedState<N>,
        mut integrate: impl FnMut(&mut Self, &Section<N>) -> IntegrationEnd<N>,
    ) -> Result<(), Error> {
        let settings = self.settings;
        let (mut start, mut overlaps, mut next) = (start, settings.overlaps, 1);
        for end in settings.section_ends() {
            let mut times = Vec::new();
            while let Some(t) =
                settings.sample_time(next).filter(|t| *t <= end && times.last() != Some(&settings.end))
            {
                times.push(t);
                next += 1;
            }
            let u = settings.inputs_at_time::<N>(start.t, false);
            let rate = match end > start.t {
                true => (settings.inputs_at_time::<N>(end, true) - u) / (end - start.t),
                false => SVector::zeros(),
            };
            let (reached, ended) = integrate(self, &Section { start, end, times, u, rate, overlaps });
            ended?;
            (start, overlaps) = (reached, Overlaps::Keep);
        }
        Ok(())
    }

    /// Integrates the whole motion with one method.
    fn integrate_with_method<M, S, const N: usize>(
        &mut self,
        m: &M,
        start: PaddedState<N>,
        method: S,
    ) -> Result<(), Error>
    where
        M: Mechanism<N, N, N, Scalar = f64>,
        S: integrate::Method<f64> + Copy,
    {
        self.integrate_sections(start, |driver, section| {
            driver.integrate_section(m, section, section.start, method, &mut |_, _| true)
        })
    }

    /// Integrates a section with one method, from a state in it. `goes_on` receives each sample and the
    /// number of evaluations of the dynamics since the previous sample. The integration ends if it returns
    /// false.
    fn integrate_section<M, S, const N: usize>(
        &mut self,
        m: &M,
        section: &Section<N>,
        from: PaddedState<N>,
        method: S,
        goes_on: &mut dyn FnMut(&PaddedState<N>, u64) -> bool,
    ) -> IntegrationEnd<N>
    where
        M: Mechanism<N, N, N, Scalar = f64>,
        S: integrate::Method<f64>,
    {
        let settings = self.settings;
        let mut times: Vec<f64> = section.times.iter().copied().filter(|t| *t > from.t).collect();
        if !self.has_begun {
            times.insert(0, from.t);
        }
        let (evaluations, failure) = (Cell::new(0_u64), RefCell::new(None));
        let feed = SectionInputs {
            settings: &settings,
            section,
            controller: self.controller.as_mut(),
            u: SVector::zeros(),
            evaluations: &evaluations,
            failure: &failure,
        };
        let mut run = simulate(m)
            .start_at(from.t)
            .from(from.q, from.v)
            .duration(section.end - from.t)
            .overlaps(section.overlaps)
            .method(method)
            .with_inputs(feed);
        if settings.every.is_some() {
            run = run.sample_at(&times);
        }
        let mut last = from;
        for sample in run {
            let sample = match sample {
                Ok(sample) => sample,
                Err(error) => {
                    let error = match failure.take() {
                        Some(message) => Error::Value(message),
                        None => settings.robot.error_from_integrator(error),
                    };
                    return (last, Err(error));
                }
            };
            last = PaddedState { t: sample.t, q: sample.q, v: sample.v };
            // Ends of sections between samples, and starts of sections, are no samples.
            let is_wanted = match settings.every {
                Some(_) => times.get(times.partition_point(|t| *t < sample.t)) == Some(&sample.t),
                None => sample.t > from.t || !self.has_begun,
            };
            if is_wanted {
                self.has_begun = true;
                (self.sink)(settings.sample_of_state(&last, &sample.u));
            }
            if !goes_on(&last, evaluations.replace(0)) {
                return (last, Ok(()));
            }
        }
        last.t = section.end;
        (last, Ok(()))
    }

    /// Integrates with an explicit method, and switches to an implicit method where that is cheaper.
    fn integrate_with_stiffness_switch<const N: usize>(
        &mut self,
        m: &Padded<N, N, N, &Robot>,
        start: PaddedState<N>,
        tolerance: f64,
    ) -> Result<(), Error> {
        let explicit = DormandPrince::new().tolerance(tolerance, tolerance);
        let explicit = AdaptiveMethod::DormandPrince(explicit.max_steps(MOST_STEPS).min_step(SHORTEST));
        let implicit = Rodas::new().tolerance(tolerance, tolerance);
        let mut budget = OBSERVED;
        self.integrate_sections(start, |driver, section| {
            let mut from = section.start;
            loop {
                if driver.stiff_from.is_some() {
                    let method = AdaptiveMethod::Rodas(implicit);
                    return driver.integrate_section(m, section, from, method, &mut |_, _| true);
                }
                // The implicit method is tried on what the explicit one has done with the budget.
                let (mut total, mut ended) = (0, true);
                let (reached, result) =
                    driver.integrate_section(m, section, from, explicit, &mut |_, count| {
                        total += count;
                        ended = total < budget;
                        ended
                    });
                let until = match &result {
                    Ok(()) if ended => return (reached, result),
                    Ok(()) => {
                        budget *= 2;
                        reached.t
                    }
                    Err(error) if error.is_step_limit_error() => {
                        from = reached;
                        total = u64::MAX;
                        section.times.iter().copied().find(|t| *t > reached.t).unwrap_or(section.end)
                    }
                    Err(_) => return (reached, result),
                };
                match driver.is_implicit_method_cheaper(m, section, from, until, implicit, total / 2) {
                    true => driver.stiff_from = Some(from.t),
                    false if result.is_err() => return (reached, result),
                    false => {}
                }
                from = reached;
            }
        })
    }

    /// Whether an implicit method reaches a time of a section with fewer evaluations of the dynamics than an
    /// explicit method.
    fn is_implicit_method_cheaper<const N: usize>(
        &mut self,
        m: &Padded<N, N, N, &Robot>,
        section: &Section<N>,
        from: PaddedState<N>,
        until: f64,
        method: Rodas<f64>,
        most: u64,
    ) -> bool {
        let (evaluations, failure) = (Cell::new(0_u64), RefCell::new(None));
        let feed = SectionInputs {
            settings: &self.settings,
            section,
            controller: self.controller.as_mut(),
            u: SVector::zeros(),
            evaluations: &evaluations,
            failure: &failure,
        };
        // Each step takes at least five evaluations.
        let run = simulate(m)
            .start_at(from.t)
            .from(from.q, from.v)
            .duration(until - from.t)
            .method(AdaptiveMethod::Rodas(method.max_steps((most / 5).min(MOST_IMPLICIT_STEPS))))
            .with_inputs(feed);
        run.finish().is_ok() && evaluations.get() <= most
    }
}
