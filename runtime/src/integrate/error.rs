//! Errors that end a simulation.

use crate::ConstraintError;
use core::fmt;

/// Error that ends a simulation early. Times are in seconds.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A step, duration or tolerance is not finite and positive. Reported before the first step.
    InvalidStep {
        /// Name of the invalid setting.
        name: &'static str,
        /// Value of the invalid setting.
        value: f64,
    },
    /// The run has no end: it has no duration and no event that stops it. Reported before the first step.
    Endless,
    /// The state or its rate became infinite or NaN: a singular mass matrix, or a motion that diverges.
    NotFinite {
        /// Time at the start of the failed step.
        t: f64,
    },
    /// The tolerance requires a step below the minimum allowed, or below the rounding of time: a
    /// discontinuity, a singularity, or a tolerance finer than the arithmetic.
    StepTooSmall {
        /// Time at the start of the failed step.
        t: f64,
        /// Length of the step that would have been tried, s.
        h: f64,
    },
    /// The limit on the number of steps was reached: a stiff mechanism, or too long a run for the limit.
    TooManySteps {
        /// Time that the run reached, s.
        t: f64,
    },
    /// The function that defines an event is NaN.
    Event {
        /// Time at the start of the step on which the function is NaN, or of the run.
        t: f64,
        /// Index of the event, in the order of declaration.
        event: usize,
    },
    /// A quaternion at the start does not have unit norm: divide it by its norm, or start from `neutral()`.
    Quaternion {
        /// Name of the entry of the configuration with the largest error.
        coordinate: &'static str,
    },
    /// The state at the start violates the constraints: correct it with `assemble` and `project_velocity`.
    OffConstraints {
        /// Time at the start of the run, s.
        t: f64,
        /// Name of the entry of the configuration, or otherwise of the velocity, that the constraints correct
        /// most.
        entry: &'static str,
        /// Magnitude of the correction, in the entry's unit.
        by: f64,
    },
    /// The constraints cannot be satisfied: the mechanism is locked, its friction jams, or a step was too
    /// long.
    Constraint {
        /// Time at which the constraints could not be satisfied, s.
        t: f64,
        /// Violated constraint, or the reason why the motion is undetermined.
        reason: ConstraintError,
    },
    /// An impact does not separate the colliding bodies, or impacts accumulate, as for a ball that comes to
    /// rest. End the run there (`until`), and continue with the contact as a constraint.
    Impacts {
        /// Time that the run reached, s.
        t: f64,
        /// Index of the event, in the order of declaration.
        event: usize,
    },
    /// The equations of an implicit step were not solved: use smaller steps.
    NotConverged {
        /// Time at the start of the failed step.
        t: f64,
        /// Number of iterations; zero if the matrix of the step is singular.
        iterations: usize,
    },
}

crate::debug_as_display!(Error);

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InvalidStep { name, value } => {
                write!(f, "{name} must be finite and positive, found {value}")
            }
            Self::Endless => write!(f, "the run has no end: it needs a duration or an event that stops it"),
            Self::NotFinite { t } => write!(f, "the motion is not finite after t = {t} s"),
            Self::StepTooSmall { t, h } => {
                write!(f, "the tolerance asks for a step of {h} s at t = {t} s, which is too small")
            }
            Self::TooManySteps { t } => write!(f, "the limit on steps was reached at t = {t} s"),
            Self::OffConstraints { t, entry, by } => write!(
                f,
                "the state at t = {t} s violates the constraints, which change `{entry}` by {by:.3e}: \
                 `assemble` and `project_velocity` bring a state onto them"
            ),
            Self::Constraint { t, reason } => write!(f, "at t = {t} s {reason}"),
            Self::Event { t, event } => {
                write!(f, "the function of event {event} is not a number after t = {t} s")
            }
            Self::Quaternion { coordinate } => write!(
                f,
                "the quaternion of `{coordinate}` at the start must have unit length: divide it by its \
                 length"
            ),
            Self::Impacts { t, event } => write!(
                f,
                "at t = {t} s the impact of event {event} does not separate the surfaces: end the run there \
                 with `until`, and continue with the contact as a constraint"
            ),
            Self::NotConverged { t, iterations: 0 } => {
                write!(f, "the matrix of the implicit step at t = {t} s is singular: take smaller steps")
            }
            Self::NotConverged { t, iterations } => write!(
                f,
                "the implicit step at t = {t} s did not converge in {iterations} iterations: take smaller \
                 steps"
            ),
        }
    }
}

impl Error {
    /// Returns the error with its time increased by `origin`, s.
    pub(super) fn shift_time_origin(mut self, origin: f64) -> Self {
        match &mut self {
            Self::NotFinite { t }
            | Self::StepTooSmall { t, .. }
            | Self::TooManySteps { t }
            | Self::Event { t, .. }
            | Self::OffConstraints { t, .. }
            | Self::Constraint { t, .. }
            | Self::Impacts { t, .. }
            | Self::NotConverged { t, .. } => *t += origin,
            Self::InvalidStep { .. } | Self::Endless | Self::Quaternion { .. } => {}
        }
        self
    }
}

impl core::error::Error for Error {}
