//! Why a simulation stopped before its end.

use crate::ConstraintError;
use core::fmt;

/// Why a simulation stopped before its end. Times in seconds.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A step, duration or tolerance that is not finite and positive. Raised before the first step.
    InvalidStep {
        /// Which setting.
        name: &'static str,
        /// What it was.
        value: f64,
    },
    /// Neither a duration nor an event would end the run. Raised before the first step.
    Endless,
    /// The state or its rate became infinite or NaN: a singular mass matrix, or a motion that escapes.
    NotFinite {
        /// Time at the start of the failed step.
        t: f64,
    },
    /// The tolerance needs a step below the least step allowed, or below the rounding of time: a discontinuity, a
    /// singularity, or a tolerance finer than the arithmetic.
    StepTooSmall {
        /// Time at the start of the failed step.
        t: f64,
        /// The step that would have been tried.
        h: f64,
    },
    /// The limit on the number of steps was reached: a stiff mechanism, or too long a run for the limit.
    TooManySteps {
        /// Time reached.
        t: f64,
    },
    /// The function of an event is not a number.
    Event {
        /// Time at the start of the step on which it is not, or of the run.
        t: f64,
        /// Which event, in the order of declaration.
        event: usize,
    },
    /// A quaternion at the start is not of unit length: divide it by its length, or start from `neutral()`.
    Quaternion {
        /// The entry of the configuration that is off most.
        coordinate: &'static str,
    },
    /// The state at the start does not fulfil the constraints: bring it there by `assemble` and `project_velocity`.
    OffConstraints {
        /// Time of the start.
        t: f64,
        /// The entry of the configuration, or else of the velocity, that the constraints move most.
        entry: &'static str,
        /// By how much, in the entry's unit.
        by: f64,
    },
    /// The constraints cannot be fulfilled: the mechanism is locked, its friction jams, or a step went too far.
    Constraint {
        /// Time.
        t: f64,
        /// What is violated, or why the motion is not determined.
        reason: ConstraintError,
    },
    /// An impact does not separate what has met, or impacts follow each other ever faster, as those of a ball that comes
    /// to rest: nothing would hold it on the surface. End the run there (`until`), and go on with the contact as a
    /// constraint.
    Impacts {
        /// Time reached.
        t: f64,
        /// Which event, in the order of declaration.
        event: usize,
    },
    /// The equations of an implicit step were not solved: take smaller steps.
    NotConverged {
        /// Time at the start of the failed step.
        t: f64,
        /// Iterations made; none where the matrix of the step is singular.
        iterations: usize,
    },
}

/// The text of `Display`, which `main` prints of an error that it returns.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

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
                "the state at t = {t} s is off the constraints, which move `{entry}` by {by:.3e}: `assemble` and `project_velocity` bring a state onto them"
            ),
            Self::Constraint { t, reason } => write!(f, "at t = {t} s {reason}"),
            Self::Event { t, event } => {
                write!(f, "the function of event {event} is not a number after t = {t} s")
            }
            Self::Quaternion { coordinate } => write!(
                f,
                "the quaternion of `{coordinate}` at the start must have unit length: divide it by its length"
            ),
            Self::Impacts { t, event } => write!(
                f,
                "at t = {t} s the impact of event {event} does not separate what has met: end the run there with \
                 `until`, and go on with the contact as a constraint"
            ),
            Self::NotConverged { t, iterations: 0 } => {
                write!(f, "the matrix of the implicit step at t = {t} s is singular: take smaller steps")
            }
            Self::NotConverged { t, iterations } => write!(
                f,
                "the implicit step at t = {t} s did not converge in {iterations} iterations: take smaller steps"
            ),
        }
    }
}

impl Error {
    /// The error with its time counted from `origin` seconds earlier.
    pub(super) fn later(mut self, origin: f64) -> Self {
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
