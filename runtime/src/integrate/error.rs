//! Why a simulation stopped before its end.

use crate::ConstraintError;
use core::fmt;

/// Why a simulation stopped before its end. Times in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// The state or its rate became infinite or NaN (a singular mass matrix, or a motion that escapes), or the function of an
    /// event NaN.
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
    /// The state at the start does not fulfil the constraints: bring it there by `assemble` and `project_velocity`.
    OffConstraints {
        /// Time of the start.
        t: f64,
    },
    /// The constraints cannot be fulfilled: the mechanism is locked, its friction jams, or a step went too far.
    Constraint {
        /// Time.
        t: f64,
        /// What is violated, or why the motion is not determined.
        reason: ConstraintError,
    },
    /// Impacts follow each other ever faster, as those of a ball that comes to rest: end the run before, and go on with
    /// the contact as a constraint.
    Impacts {
        /// Time reached.
        t: f64,
    },
    /// The equations of an implicit step were not solved: take smaller steps.
    NotConverged {
        /// Time at the start of the failed step.
        t: f64,
        /// Iterations made.
        iterations: usize,
    },
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
            Self::OffConstraints { t } => write!(f, "the state at t = {t} s is off the constraints"),
            Self::Constraint { t, reason } => write!(f, "at t = {t} s {reason}"),
            Self::Impacts { t } => write!(f, "at t = {t} s impacts follow each other without end"),
            Self::NotConverged { t, iterations } => {
                write!(f, "the implicit step at t = {t} s did not converge in {iterations} iterations")
            }
        }
    }
}

impl core::error::Error for Error {}
