//! Simulation of loaded mechanisms by the methods of the runtime.

use crate::error::Error;
use crate::robot::Robot;
use linkwork::simulate::Overlaps;

mod driver;
mod kinds;
mod method;

use driver::{Driver, Settings, SimulationVisitor, StateIndependentInputs};
pub use method::Method;
use method::STEP;

/// Maximum number of samples of a run.
const MOST_SAMPLES: f64 = 5e7;

/// Function of time, configuration and velocity that writes the inputs. An error ends the run.
pub type Controller<'a> = &'a mut (dyn FnMut(f64, &[f64], &[f64], &mut [f64]) -> Result<(), String> + Send);

/// Inputs of the mechanism during a simulation.
#[derive(Default)]
pub enum Inputs<'a> {
    /// Inputs that are all zero.
    #[default]
    Zero,
    /// Inputs that are constant during the simulation.
    Constant(&'a [f64]),
    /// Inputs given at discrete times: interpolated linearly between the times, and constant before the first
    /// and after the last time. The inputs jump where a time occurs twice.
    Samples {
        /// Times of the input samples, s, in nondecreasing order.
        times: &'a [f64],
        /// Values of the inputs: one row for each time, row after row.
        values: &'a [f64],
    },
    /// Inputs from a function that is continuous in time and state. The velocities that it receives are
    /// followed by first-order states.
    Function(Controller<'a>),
    /// Inputs from a function that is called once in every period, s, and whose values are constant in
    /// between.
    Sampled(f64, Controller<'a>),
}

/// Sample of a motion: time, state and inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Time of the sample, s.
    pub t: f64,
    /// Configuration of the sample.
    pub q: Vec<f64>,
    /// Velocity of the sample, followed by the first-order states.
    pub v: Vec<f64>,
    /// Inputs of the mechanism at the time of the sample.
    pub u: Vec<f64>,
}

/// Result of a simulation: the samples of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Samples of the motion, in the order of time.
    pub samples: Vec<Sample>,
    /// Time from which an implicit method integrates the motion, because it is stiff; `None` for methods
    /// other than [`Method::Automatic`].
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
    /// Returns a simulation of the robot, from its [initial configuration](Robot::initial_configuration) at
    /// rest at t = 0 with zero inputs.
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
    /// Sets the initial configuration and velocity. First-order states may follow the velocity; otherwise
    /// their initial values are taken from the parameters.
    pub fn from(self, q: &'a [f64], v: &'a [f64]) -> Self {
        Self { q: Some(q), v: Some(v), ..self }
    }

    /// Sets the initial time of the simulation, s.
    pub fn start_at(self, t: f64) -> Self {
        Self { start: t, ..self }
    }

    /// Sets the integration method of the simulation.
    pub fn method(self, method: Method) -> Self {
        Self { method, ..self }
    }

    /// Sets the inputs of the mechanism during the simulation.
    pub fn inputs<'j>(self, inputs: Inputs<'j>) -> Simulation<'a, 'j> {
        let Self { robot, method, start, q, v, duration, every, contacts, overlaps, .. } = self;
        Simulation { robot, method, start, q, v, inputs, duration, every, contacts, overlaps }
    }

    /// Sets the duration of the simulation, s.
    pub fn duration(self, duration: f64) -> Self {
        Self { duration, ..self }
    }

    /// Sets the time between samples, s; the end is a sample as well. By default every step is a sample.
    pub fn sample_every(self, interval: f64) -> Self {
        Self { every: Some(interval), ..self }
    }

    /// Simulates the mechanism without its contacts, so that bodies pass through each other.
    pub fn without_contacts(self) -> Self {
        Self { contacts: false, ..self }
    }

    /// Sets the treatment of contact surfaces that overlap at the start.
    pub fn overlaps(self, overlaps: Overlaps) -> Self {
        Self { overlaps, ..self }
    }

    /// Runs the simulation and returns its samples.
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

    /// Checks the start, the duration and the interval between samples.
    fn check_times(&self) -> Result<(), Error> {
        let invalid_value_error = |name: &str, value: f64| {
            Error::Value(format!("{name} must be finite and not negative, but it is {value}"))
        };
        for (name, value) in [("the duration", self.duration), ("the interval", self.every.unwrap_or(1.0))] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(invalid_value_error(name, value));
            }
        }
        if !self.start.is_finite() {
            return Err(Error::Value(format!(
                "the time at the start must be finite, but it is {}",
                self.start
            )));
        }
        if self.every == Some(0.0) {
            return Err(Error::Value("the interval between samples must not be zero".to_string()));
        }
        if self.every.is_some_and(|every| self.duration / every > MOST_SAMPLES) {
            let message = format!(
                "{:.3e} samples are too many: the interval between samples is {} s, the duration {} s",
                self.duration / self.every.unwrap_or(1.0),
                self.every.unwrap_or(0.0),
                self.duration
            );
            return Err(Error::Value(message));
        }
        Ok(())
    }

    /// Checks the lengths and values of the inputs.
    fn check_inputs(&self) -> Result<(), Error> {
        let robot = self.robot;
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
        Ok(())
    }

    /// Runs the simulation and passes its samples to a function. Returns the time from which the motion is
    /// stiff, as [`Run`] has it.
    ///
    /// # Errors
    ///
    /// As [`run`](Self::run).
    pub fn each(self, sample: &mut (dyn FnMut(Sample) + Send)) -> Result<Option<f64>, Error> {
        self.check_times()?;
        let robot = self.robot;
        let (n, states) = (robot.nv(), &robot.shared.states);
        let q = self.q.map_or_else(
            || robot.initial_configuration().map(|q| q.as_slice().to_vec()),
            |q| Ok(q.to_vec()),
        )?;
        let mut v = self.v.map_or_else(|| vec![0.0; n], <[f64]>::to_vec);
        if v.len() == n {
            v.extend(states.iter().map(|one| robot.parameter_values()[one.parameter]));
        }
        robot.validate()?;
        robot.check_length("q", robot.nq(), q.len())?;
        robot.check_length("v", n + states.len(), v.len())?;
        self.check_inputs()?;
        let with_contacts = self.contacts && !robot.shared.contacts.is_empty();
        let method = match self.method {
            Method::Automatic(_) if with_contacts => Method::TimeStepping(STEP),
            method => method,
        };
        let is_contact_method = matches!(
            method,
            Method::TimeStepping(_)
                | Method::TimeSteppingMidpoint(_)
                | Method::TimeSteppingLeapfrog(_)
                | Method::EventDriven(_)
        );
        if with_contacts && !is_contact_method {
            return Err(Error::Value(format!(
                "`{}` has contacts: choose the method `time_stepping`, `time_stepping_midpoint`, \
                 `time_stepping_leapfrog` or `event_driven`, or leave the contacts out",
                robot.name()
            )));
        }
        if with_contacts && !robot.shared.separate.is_empty() && matches!(method, Method::EventDriven(_)) {
            return Err(Error::Value(format!(
                "`{}` has {} contacts; events are located for at most 128 contact points: choose the method \
                 `time_stepping`",
                robot.name(),
                robot.shared.contacts.len()
            )));
        }
        let (inputs, controller) = match self.inputs {
            Inputs::Zero => (StateIndependentInputs::Zero, None),
            Inputs::Constant(u) => (StateIndependentInputs::Constant(u), None),
            Inputs::Samples { times, values } => (StateIndependentInputs::Samples(times, values), None),
            Inputs::Function(function) => (StateIndependentInputs::Zero, Some((None, function))),
            Inputs::Sampled(period, function) => {
                (StateIndependentInputs::Zero, Some((Some(period), function)))
            }
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
        let simulate_padded_robot = || {
            let moving = SimulationVisitor { driver: &mut driver, q: &q, v: &v };
            match is_contact_method && with_contacts {
                true => robot.visit_padded_robot_with_contacts(moving)?,
                false => robot.visit_padded_robot(moving)?,
            }
        };
        robot.run_with_sufficient_stack(simulate_padded_robot)?;
        Ok(driver.stiff_from)
    }
}
