//! Simulation of loaded mechanisms by the methods of the runtime.

use crate::capacity::{ContactVisitor, Visitor};
use crate::error::Error;
use crate::padded::Padded;
use crate::robot::Robot;
use linkwork::integrate::{
    self, DormandPrince, DormandPrince8, EventDriven, ImplicitMidpoint, Rk4, Rodas, Rosenbrock,
    SemiImplicitEuler, TimeStepping,
};
use linkwork::nalgebra::SVector;
use linkwork::simulate::Overlaps;
use linkwork::{Mechanism, simulate};
use std::cell::{Cell, RefCell};

/// Integration method, with its tolerance (relative and absolute) or its step, s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Method {
    /// [`DormandPrince`] with a tolerance, and [`Rodas`] from where the motion is stiff. Mechanisms with
    /// contacts have [`TimeStepping`] with steps of 1 ms.
    Automatic(f64),
    /// [`DormandPrince`] with a tolerance.
    DormandPrince(f64),
    /// [`DormandPrince8`] with a tolerance.
    DormandPrince8(f64),
    /// [`Rodas`] with a tolerance.
    Rodas(f64),
    /// [`Rk4`] with a step.
    Rk4(f64),
    /// [`ImplicitMidpoint`] with a step.
    ImplicitMidpoint(f64),
    /// [`Rosenbrock`] with a step.
    Rosenbrock(f64),
    /// [`SemiImplicitEuler`] with a step.
    SemiImplicitEuler(f64),
    /// [`TimeStepping`] with a step.
    TimeStepping(f64),
    /// [`TimeStepping::midpoint`] with a step.
    TimeSteppingMidpoint(f64),
    /// [`EventDriven`] with a tolerance.
    EventDriven(f64),
}

/// Tolerance of adaptive methods, unless another one is set.
const TOLERANCE: f64 = 1e-9;
/// Step of methods with fixed steps, s, unless another one is set.
const STEP: f64 = 1e-3;

impl Method {
    /// Names of the methods, whether their setting is a step, and whether they treat contacts.
    pub const NAMES: [(&'static str, bool, bool); 11] = [
        ("automatic", false, true),
        ("dormand_prince", false, false),
        ("dormand_prince8", false, false),
        ("rodas", false, false),
        ("rk4", true, false),
        ("implicit_midpoint", true, false),
        ("rosenbrock", true, false),
        ("semi_implicit_euler", true, false),
        ("time_stepping", true, true),
        ("time_stepping_midpoint", true, true),
        ("event_driven", false, true),
    ];

    /// Returns the method of a name of [`NAMES`](Self::NAMES) with its tolerance or step; without one the
    /// tolerance is `1e-9`, and the step 1 ms.
    ///
    /// # Errors
    ///
    /// There is no such method.
    pub fn named(name: &str, setting: Option<f64>) -> Result<Method, Error> {
        let names = || Self::NAMES.iter().map(|(name, ..)| *name);
        let Some((_, has_step, _)) = Self::NAMES.iter().find(|(known, ..)| *known == name) else {
            return Err(Error::unknown("method", name, names()));
        };
        let setting = setting.unwrap_or(if *has_step { STEP } else { TOLERANCE });
        Ok(match name {
            "dormand_prince" => Method::DormandPrince(setting),
            "dormand_prince8" => Method::DormandPrince8(setting),
            "rodas" => Method::Rodas(setting),
            "rk4" => Method::Rk4(setting),
            "implicit_midpoint" => Method::ImplicitMidpoint(setting),
            "rosenbrock" => Method::Rosenbrock(setting),
            "semi_implicit_euler" => Method::SemiImplicitEuler(setting),
            "time_stepping" => Method::TimeStepping(setting),
            "time_stepping_midpoint" => Method::TimeSteppingMidpoint(setting),
            "event_driven" => Method::EventDriven(setting),
            _ => Method::Automatic(setting),
        })
    }
}

impl Default for Method {
    fn default() -> Self {
        Method::Automatic(TOLERANCE)
    }
}

/// Function of time, configuration and velocity that writes the inputs. An error ends the run.
pub type Controller<'a> = &'a mut (dyn FnMut(f64, &[f64], &[f64], &mut [f64]) -> Result<(), String> + Send);

/// Inputs of a simulation.
#[derive(Default)]
pub enum Inputs<'a> {
    /// All inputs are zero.
    #[default]
    Zero,
    /// Constant inputs.
    Constant(&'a [f64]),
    /// Inputs at times: linear between the times, and constant before the first and after the last one.
    /// Inputs jump where a time occurs twice.
    Samples {
        /// Times, s, which do not decrease.
        times: &'a [f64],
        /// The inputs at each time, one row after the other.
        values: &'a [f64],
    },
    /// A function that is continuous in time and state; velocities are followed by states of first order.
    Function(Controller<'a>),
    /// A function that is called once in every period, s, and whose values are constant in between.
    Sampled(f64, Controller<'a>),
}

/// State and inputs at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Time, s.
    pub t: f64,
    /// Configuration.
    pub q: Vec<f64>,
    /// Velocity, followed by the states of first order.
    pub v: Vec<f64>,
    /// Inputs.
    pub u: Vec<f64>,
}

/// Samples of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The samples.
    pub samples: Vec<Sample>,
    /// Time from which the motion is integrated by an implicit method, because it is stiff; `None` for
    /// methods other than [`Method::Automatic`].
    pub stiff_from: Option<f64>,
}

/// Simulation of a robot: its settings. [`Robot::simulate`] creates it.
///
/// ```
/// use linkwork_jit::{Method, declare};
///
/// # fn main() -> Result<(), linkwork_jit::Error> {
/// let ball = declare(
///     "#[mechanism(gravity = -9.81 * z)]
///     struct Ball {
///         #[particle(mass = 0.1)]
///         ball: Particle,
///         #[joint(ground -> ball, along = z)]
///         height: Sleeve,
///         #[contact(ball, ground.plane(z), restitution = 0.5)]
///         bounce: Contact,
///     }",
/// )?;
/// // Dropped from 1 m, the ball has bounced to 0.25 m after 1.5 times the duration of the fall.
/// let fall = (2.0 / 9.81_f64).sqrt();
/// let run = ball.simulate().from(&[1.0], &[0.0]).duration(1.5 * fall);
/// let end = run.method(Method::EventDriven(1e-9)).finish()?;
/// assert!((end.q[0] - 0.25).abs() < 1e-9);
/// # Ok(())
/// # }
/// ```
#[must_use = "a simulation does nothing until its samples are asked for"]
pub struct Simulation<'a, 'i> {
    robot: &'a Robot,
    method: Method,
    start: f64,
    q: Option<&'a [f64]>,
    v: Option<&'a [f64]>,
    inputs: Inputs<'i>,
    duration: f64,
    every: Option<f64>,
    contacts: bool,
    overlaps: Overlaps,
}

impl Robot {
    /// Returns a simulation, from the neutral configuration at rest at t = 0 with zero inputs.
    pub fn simulate(&self) -> Simulation<'_, 'static> {
        Simulation {
            robot: self,
            method: Method::default(),
            start: 0.0,
            q: None,
            v: None,
            inputs: Inputs::Zero,
            duration: 0.0,
            every: None,
            contacts: true,
            overlaps: Overlaps::default(),
        }
    }
}

impl<'a, 'i> Simulation<'a, 'i> {
    /// Sets the initial configuration and velocity. The velocity may be followed by the states of first
    /// order; without them these have the values that they have among the parameters.
    pub fn from(self, q: &'a [f64], v: &'a [f64]) -> Self {
        Self { q: Some(q), v: Some(v), ..self }
    }

    /// Sets the initial time, s.
    pub fn start_at(self, t: f64) -> Self {
        Self { start: t, ..self }
    }

    /// Sets the method.
    pub fn method(self, method: Method) -> Self {
        Self { method, ..self }
    }

    /// Sets the inputs.
    pub fn inputs<'j>(self, inputs: Inputs<'j>) -> Simulation<'a, 'j> {
        let Self { robot, method, start, q, v, duration, every, contacts, overlaps, .. } = self;
        Simulation { robot, method, start, q, v, inputs, duration, every, contacts, overlaps }
    }

    /// Sets the duration, s.
    pub fn duration(self, duration: f64) -> Self {
        Self { duration, ..self }
    }

    /// Sets the time between samples, s; the end is a sample as well. By default every step is a sample.
    pub fn sample_every(self, interval: f64) -> Self {
        Self { every: Some(interval), ..self }
    }

    /// Leaves the contacts out: bodies pass through each other.
    pub fn without_contacts(self) -> Self {
        Self { contacts: false, ..self }
    }

    /// Sets the treatment of contact surfaces that overlap at the start.
    pub fn overlaps(self, overlaps: Overlaps) -> Self {
        Self { overlaps, ..self }
    }

    /// Runs the simulation.
    ///
    /// # Errors
    ///
    /// A setting is wrong, the method does not treat contacts, or the motion cannot be continued
    /// ([`Error::Motion`]).
    pub fn run(self) -> Result<Run, Error> {
        let mut samples = Vec::new();
        let stiff_from = self.each(&mut |sample| samples.push(sample))?;
        Ok(Run { samples, stiff_from })
    }

    /// Runs the simulation and returns its last sample.
    ///
    /// # Errors
    ///
    /// As [`run`](Self::run).
    pub fn finish(self) -> Result<Sample, Error> {
        let mut last = None;
        let every = self.every.or(Some(self.duration).filter(|duration| *duration > 0.0));
        Self { every, ..self }.each(&mut |sample| last = Some(sample))?;
        last.ok_or_else(|| Error::Internal("a run without samples".to_string()))
    }

    /// Runs the simulation and passes its samples to a function. Returns the time from which the motion is
    /// stiff, as [`Run`] has it.
    ///
    /// # Errors
    ///
    /// As [`run`](Self::run).
    pub fn each(self, sample: &mut (dyn FnMut(Sample) + Send)) -> Result<Option<f64>, Error> {
        let robot = self.robot;
        let (n, states) = (robot.nv(), &robot.shared.states);
        let invalid = |name: &str, value: f64| {
            Error::Value(format!("{name} must be finite and not negative, but it is {value}"))
        };
        for (name, value) in [("the duration", self.duration), ("the interval", self.every.unwrap_or(1.0))] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(invalid(name, value));
            }
        }
        if self.every == Some(0.0) {
            return Err(Error::Value("the interval between samples must not be zero".to_string()));
        }
        let q = self.q.map_or_else(|| robot.neutral().map(|q| q.as_slice().to_vec()), |q| Ok(q.to_vec()))?;
        let mut v = self.v.map_or_else(|| vec![0.0; n], <[f64]>::to_vec);
        if v.len() == n {
            v.extend(states.iter().map(|one| robot.parameter_values()[one.parameter]));
        }
        robot.validate()?;
        robot.check_length("q", robot.nq(), q.len())?;
        robot.check_length("v", n + states.len(), v.len())?;
        match &self.inputs {
            Inputs::Constant(u) => robot.check_length("u", robot.nu(), u.len())?,
            Inputs::Samples { times, values } => {
                robot.check_length("u", robot.nu() * times.len(), values.len())?;
                let ordered = times.windows(2).all(|pair| pair[0] <= pair[1]);
                if times.is_empty() || !ordered || !times.iter().chain(*values).all(|x| x.is_finite()) {
                    let message =
                        "times of inputs must be finite, and must not decrease; inputs must be finite";
                    return Err(Error::Value(message.to_string()));
                }
            }
            _ => {}
        }
        let with_contacts = self.contacts && !robot.shared.contacts.is_empty();
        let method = match self.method {
            Method::Automatic(_) if with_contacts => Method::TimeStepping(STEP),
            method => method,
        };
        let is_contact_method = matches!(
            method,
            Method::TimeStepping(_) | Method::TimeSteppingMidpoint(_) | Method::EventDriven(_)
        );
        if with_contacts && !is_contact_method {
            return Err(Error::Value(format!(
                "`{}` has contacts: choose the method `time_stepping`, `time_stepping_midpoint` or `event_driven`, or leave the contacts out",
                robot.name()
            )));
        }
        let (inputs, controller) = match self.inputs {
            Inputs::Zero => (Given::Zero, None),
            Inputs::Constant(u) => (Given::Constant(u), None),
            Inputs::Samples { times, values } => (Given::Samples(times, values), None),
            Inputs::Function(function) => (Given::Zero, Some((None, function))),
            Inputs::Sampled(period, function) => (Given::Zero, Some((Some(period), function))),
        };
        let settings = Settings {
            robot,
            method,
            start: self.start,
            end: self.start + self.duration,
            every: self.every,
            overlaps: self.overlaps,
            inputs,
        };
        let mut driver = Driver { settings, controller, sink: sample, has_begun: false, stiff_from: None };
        let mut go = || {
            let moving = Moving { driver: &mut driver, q: &q, v: &v };
            match is_contact_method && with_contacts {
                true => robot.visit_contacts(moving)?,
                false => robot.visit(moving)?,
            }
        };
        match robot.needs_stack() {
            true => on_large_stack(go)?,
            false => go()?,
        }
        Ok(driver.stiff_from)
    }
}

/// Size of the stack of the thread on which large mechanisms move.
const STACK: usize = 64 << 20;

/// Calls a function on a thread of its own.
fn on_large_stack(run: impl FnOnce() -> Result<(), Error> + Send) -> Result<(), Error> {
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().name("linkwork".to_string()).stack_size(STACK);
        let thread = thread.spawn_scoped(scope, run).map_err(|error| Error::Internal(error.to_string()))?;
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Inputs that do not depend on the state.
#[derive(Clone, Copy)]
enum Given<'a> {
    Zero,
    Constant(&'a [f64]),
    Samples(&'a [f64], &'a [f64]),
}

/// Checked settings of a run.
#[derive(Clone, Copy)]
struct Settings<'a> {
    robot: &'a Robot,
    method: Method,
    start: f64,
    end: f64,
    every: Option<f64>,
    overlaps: Overlaps,
    inputs: Given<'a>,
}

/// A run.
struct Driver<'a, 'i, 's> {
    settings: Settings<'a>,
    /// Function of the inputs, with its period.
    controller: Option<(Option<f64>, Controller<'i>)>,
    sink: &'s mut (dyn FnMut(Sample) + Send),
    /// Whether the first sample has been emitted.
    has_begun: bool,
    stiff_from: Option<f64>,
}

/// A run from its initial state.
struct Moving<'d, 'a, 'i, 's> {
    driver: &'d mut Driver<'a, 'i, 's>,
    q: &'d [f64],
    v: &'d [f64],
}

impl Visitor for Moving<'_, '_, '_, '_> {
    type Output = Result<(), Error>;

    fn visit<const N: usize>(self, robot: &Padded<N, N, N, &Robot>) -> Self::Output {
        let driver = self.driver;
        let start = PaddedState::new(driver.settings.start, self.q, self.v);
        match driver.settings.method {
            Method::Automatic(e) => driver.automatic(robot, start, e),
            Method::DormandPrince(e) => driver.go(robot, start, DormandPrince::new().tolerance(e, e)),
            Method::DormandPrince8(e) => driver.go(robot, start, DormandPrince8::new().tolerance(e, e)),
            Method::Rodas(e) => driver.go(robot, start, Rodas::new().tolerance(e, e)),
            Method::Rk4(h) => driver.go(robot, start, Rk4::step(h)),
            Method::ImplicitMidpoint(h) => driver.go(robot, start, ImplicitMidpoint::step(h)),
            Method::Rosenbrock(h) => driver.go(robot, start, Rosenbrock::step(h)),
            Method::SemiImplicitEuler(h) => driver.go(robot, start, SemiImplicitEuler::step(h)),
            // Without contacts these methods are those between contacts.
            Method::TimeStepping(h) | Method::TimeSteppingMidpoint(h) => {
                driver.go(robot, start, Rk4::step(h))
            }
            Method::EventDriven(e) => driver.go(robot, start, DormandPrince8::new().tolerance(e, e)),
        }
    }
}

impl ContactVisitor for Moving<'_, '_, '_, '_> {
    type Output = Result<(), Error>;

    fn visit<M: Mechanism<N, N, N, Scalar = f64>, const N: usize>(self, robot: &M) -> Self::Output {
        let driver = self.driver;
        let start = PaddedState::new(driver.settings.start, self.q, self.v);
        match driver.settings.method {
            Method::TimeStepping(h) => driver.go(robot, start, TimeStepping::step(h)),
            Method::TimeSteppingMidpoint(h) => driver.go(robot, start, TimeStepping::step(h).midpoint()),
            Method::EventDriven(e) => driver.go(robot, start, EventDriven::new().tolerance(e, e)),
            _ => Err(Error::Internal("a method without contacts".to_string())),
        }
    }
}

/// A state with padding.
#[derive(Clone, Copy)]
struct PaddedState<const N: usize> {
    t: f64,
    q: SVector<f64, N>,
    v: SVector<f64, N>,
}

impl<const N: usize> PaddedState<N> {
    fn new(t: f64, q: &[f64], v: &[f64]) -> Self {
        let padded = |x: &[f64]| SVector::from_fn(|k, _| x.get(k).copied().unwrap_or(0.0));
        PaddedState { t, q: padded(q), v: padded(v) }
    }
}

/// A section of a run between kinks of the inputs.
#[derive(Clone)]
struct Section<const N: usize> {
    start: PaddedState<N>,
    end: f64,
    /// Times of samples after the start.
    times: Vec<f64>,
    /// Inputs at the start, and their constant rate.
    u: SVector<f64, N>,
    rate: SVector<f64, N>,
    overlaps: Overlaps,
}

impl Settings<'_> {
    /// Returns the inputs at a time; at a jump the limit before or after it.
    fn inputs<const N: usize>(&self, t: f64, is_before: bool) -> SVector<f64, N> {
        let n = self.robot.nu();
        let row =
            |values: &[f64], k: usize| SVector::from_fn(|i, _| if i < n { values[k * n + i] } else { 0.0 });
        match self.inputs {
            Given::Zero => SVector::zeros(),
            Given::Constant(u) => row(u, 0),
            Given::Samples(times, values) => {
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

    /// Returns the ends of the sections: the times at which inputs jump or have kinks, and the end.
    fn stops(&self) -> Vec<f64> {
        let mut stops = match self.inputs {
            Given::Samples(times, _) => times.to_vec(),
            _ => Vec::new(),
        };
        stops.retain(|t| *t > self.start && *t < self.end);
        stops.dedup();
        stops.push(self.end);
        stops
    }

    /// Returns the time of a sample.
    fn time(&self, index: u64) -> Option<f64> {
        let every = self.every?;
        let t = self.start + index as f64 * every;
        // A last interval that results from rounding alone is not counted.
        Some(if t > self.end - every * 1e-9 { self.end } else { t })
    }

    fn sample<const N: usize>(&self, state: &PaddedState<N>, u: &SVector<f64, N>) -> Sample {
        let (robot, t) = (self.robot, state.t);
        let u = match self.inputs {
            Given::Samples(..) => self.inputs(t, false),
            _ => *u,
        };
        let part = |x: &SVector<f64, N>, count: usize| x.as_slice()[..count].to_vec();
        let velocities = robot.nv() + robot.shared.states.len();
        Sample { t, q: part(&state.q, robot.nq()), v: part(&state.v, velocities), u: part(&u, robot.nu()) }
    }
}

/// Inputs as integration methods ask for them.
struct Feed<'f, 'i, const N: usize> {
    settings: &'f Settings<'f>,
    section: &'f Section<N>,
    controller: Option<&'f mut (Option<f64>, Controller<'i>)>,
    /// Inputs in the current period.
    u: SVector<f64, N>,
    evaluations: &'f Cell<u64>,
    failure: &'f RefCell<Option<String>>,
}

impl<const N: usize> Feed<'_, '_, N> {
    /// Calls the function of the inputs. Inputs that are NaN end the run.
    fn controlled(&mut self, t: f64, q: &SVector<f64, N>, v: &SVector<f64, N>) -> SVector<f64, N> {
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

impl<const N: usize> integrate::Inputs<f64, N, N, N> for Feed<'_, '_, N> {
    fn at(&mut self, t: f64, q: &SVector<f64, N>, v: &SVector<f64, N>) -> SVector<f64, N> {
        self.evaluations.set(self.evaluations.get() + 1);
        match &self.controller {
            Some((Some(_), _)) => self.u,
            Some((None, _)) => self.controlled(t, q, v),
            None => self.section.u + self.section.rate * (t - self.section.start.t),
        }
    }

    fn period(&self) -> Option<f64> {
        self.controller.as_ref().and_then(|(period, _)| *period)
    }

    fn renew(&mut self, t: f64, q: &SVector<f64, N>, v: &SVector<f64, N>) {
        self.u = self.controlled(t, q, v);
    }
}

/// State at the end of an integration; after an error that of the last sample before it.
type Reached<const N: usize> = (PaddedState<N>, Result<(), Error>);

/// Maximum number of steps of an explicit method before an implicit one is tried.
const MOST_STEPS: u64 = 200_000;
/// Maximum number of steps of an implicit method in the comparison.
const MOST_IMPLICIT_STEPS: u64 = 20_000;
/// Shortest step of an explicit method, s.
const SHORTEST: f64 = 1e-10;
/// Number of evaluations of the dynamics after which an implicit method is tried for the first time.
const OBSERVED: u64 = 2000;

impl Driver<'_, '_, '_> {
    /// Integrates section by section.
    fn sections<const N: usize>(
        &mut self,
        start: PaddedState<N>,
        mut integrate: impl FnMut(&mut Self, &Section<N>) -> Reached<N>,
    ) -> Result<(), Error> {
        let settings = self.settings;
        let (mut start, mut overlaps, mut next) = (start, settings.overlaps, 1);
        for end in settings.stops() {
            let mut times = Vec::new();
            while let Some(t) =
                settings.time(next).filter(|t| *t <= end && times.last() != Some(&settings.end))
            {
                times.push(t);
                next += 1;
            }
            let u = settings.inputs::<N>(start.t, false);
            let rate = match end > start.t {
                true => (settings.inputs::<N>(end, true) - u) / (end - start.t),
                false => SVector::zeros(),
            };
            let (reached, ended) = integrate(self, &Section { start, end, times, u, rate, overlaps });
            ended?;
            (start, overlaps) = (reached, Overlaps::Keep);
        }
        Ok(())
    }

    /// Integrates with one method.
    fn go<M, S, const N: usize>(&mut self, m: &M, start: PaddedState<N>, method: S) -> Result<(), Error>
    where
        M: Mechanism<N, N, N, Scalar = f64>,
        S: integrate::Method<f64> + Copy,
    {
        self.sections(start, |driver, section| {
            driver.along(m, section, section.start, method, &mut |_, _| true)
        })
    }

    /// Integrates a section with one method, from a state of it. `goes_on` receives each sample, and the
    /// number of evaluations of the dynamics since the sample before; where it returns false the integration
    /// ends.
    fn along<M, S, const N: usize>(
        &mut self,
        m: &M,
        section: &Section<N>,
        from: PaddedState<N>,
        method: S,
        goes_on: &mut dyn FnMut(&PaddedState<N>, u64) -> bool,
    ) -> Reached<N>
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
        let feed = Feed {
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
                        None => settings.robot.motion_error(error),
                    };
                    return (last, Err(error));
                }
            };
            last = PaddedState { t: sample.t, q: sample.q, v: sample.v };
            // Ends of sections between samples, and starts of sections, are no samples.
            let is_wanted = match settings.every {
                Some(_) => times.contains(&sample.t),
                None => sample.t > from.t || !self.has_begun,
            };
            if is_wanted {
                self.has_begun = true;
                (self.sink)(settings.sample(&last, &sample.u));
            }
            if !goes_on(&last, evaluations.replace(0)) {
                return (last, Ok(()));
            }
        }
        last.t = section.end;
        (last, Ok(()))
    }

    /// Integrates with an explicit method, and with an implicit one from where this is cheaper.
    fn automatic<const N: usize>(
        &mut self,
        m: &Padded<N, N, N, &Robot>,
        start: PaddedState<N>,
        tolerance: f64,
    ) -> Result<(), Error> {
        let explicit = DormandPrince::new().tolerance(tolerance, tolerance);
        let explicit = explicit.max_steps(MOST_STEPS).min_step(SHORTEST);
        let implicit = Rodas::new().tolerance(tolerance, tolerance);
        let mut budget = OBSERVED;
        self.sections(start, |driver, section| {
            let mut from = section.start;
            loop {
                if driver.stiff_from.is_some() {
                    return driver.along(m, section, from, implicit, &mut |_, _| true);
                }
                // The implicit method is tried on what the explicit one has done with the budget.
                let (mut total, mut ended) = (0, true);
                let (reached, result) = driver.along(m, section, from, explicit, &mut |_, count| {
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
                    Err(error) if error.is_too_long() => {
                        from = reached;
                        total = u64::MAX;
                        section.times.iter().copied().find(|t| *t > reached.t).unwrap_or(section.end)
                    }
                    Err(_) => return (reached, result),
                };
                match driver.is_cheaper(m, section, from, until, implicit, total / 2) {
                    true => driver.stiff_from = Some(from.t),
                    false if result.is_err() => return (reached, result),
                    false => {}
                }
                from = reached;
            }
        })
    }

    /// Whether the implicit method reaches a time of a section with fewer evaluations.
    fn is_cheaper<const N: usize>(
        &mut self,
        m: &Padded<N, N, N, &Robot>,
        section: &Section<N>,
        from: PaddedState<N>,
        until: f64,
        method: Rodas<f64>,
        most: u64,
    ) -> bool {
        let (evaluations, failure) = (Cell::new(0_u64), RefCell::new(None));
        let feed = Feed {
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
            .method(method.max_steps((most / 5).min(MOST_IMPLICIT_STEPS)))
            .with_inputs(feed);
        run.finish().is_ok() && evaluations.get() <= most
    }
}
