//! Errors of functions of constrained mechanisms.

use core::fmt;

/// Reason why no state, force or impulse satisfies the constraints.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ConstraintError {
    /// Error: no configuration near the initial one satisfies the constraints.
    Configuration {
        /// Name of the constraint with the largest residual.
        constraint: &'static str,
        /// Residual of the constraint with the largest residual, m or rad.
        residual: f64,
    },
    /// Error: no velocity satisfies the constraints. Prescribed motions contradict them, or the configuration
    /// is singular.
    Velocity {
        /// Name of the constraint with the largest violation.
        constraint: &'static str,
        /// Violation of the rate of this constraint, m/s or rad/s.
        rate: f64,
    },
    /// Error: no acceleration satisfies the constraints. Prescribed entries contradict them, or the
    /// configuration is singular.
    Acceleration {
        /// Name of the constraint with the largest violation.
        constraint: &'static str,
        /// Violation of the second rate of this constraint, m/s² or rad/s².
        acceleration: f64,
    },
    /// Error: no configuration of the requested assembly mode was found near the guess
    /// ([`assemble_in_mode`](crate::Constrained::assemble_in_mode)).
    Mode {
        /// Assembly mode that was requested but not found.
        mode: i8,
    },
    /// Error: forces at the driven velocities cannot cause the motion. Further velocities must be driven
    /// ([`constrained_inverse_dynamics`](crate::Constrained::constrained_inverse_dynamics)).
    Undriven {
        /// Name of the velocity whose equation has the largest residual.
        velocity: &'static str,
        /// Missing force at this velocity, N or N·m.
        force: f64,
    },
    /// Error: constraints that are usually independent are dependent in this configuration, and the motion is
    /// not determined to first order.
    Singular,
    /// Error: friction jams. A normal force on which friction depends does not follow from the motion
    /// (Painlevé's paradox), or contacts can share it in several ways.
    Jammed {
        /// Name of the contact whose friction jams.
        constraint: &'static str,
    },
    /// Error: no impulses satisfy the contact conditions, because constraints or prescribed motions force
    /// surfaces to penetrate.
    Contact {
        /// Name of the contact with the largest violation.
        constraint: &'static str,
    },
    /// Error: a step has no exact derivatives. Poisson's restitution acts in it, its impulses violate the
    /// contact conditions, or the mechanism has no derivatives of its contacts.
    NoDerivatives {
        /// Name of the contact whose step has no derivatives.
        constraint: &'static str,
    },
    /// Error: a coefficient of friction is negative or not finite, or a coefficient of restitution is not
    /// between 0 and 1.
    Coefficient {
        /// Name of the contact with the invalid coefficient.
        constraint: &'static str,
        /// Value of the coefficient for the parameters of the mechanism.
        value: f64,
    },
    /// Error: surfaces that must be separated overlap.
    Overlap {
        /// Name of the contact with the largest overlap.
        constraint: &'static str,
        /// Depth of the largest overlap, m or rad.
        depth: f64,
    },
    /// Error: an index in `held` is out of range. Velocities are counted from zero.
    Held {
        /// Index in `held` that is out of range.
        index: usize,
        /// Number of velocities of the mechanism.
        velocities: usize,
    },
    /// Error: constraint residuals or constraint velocities are infinite or NaN.
    NotFinite,
}

crate::debug_as_display!(ConstraintError);

impl fmt::Display for ConstraintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Configuration { constraint, residual } => {
                write!(f, "the constraint `{constraint}` has a residual of {residual}")
            }
            Self::Velocity { constraint, rate } => {
                write!(f, "the constraint `{constraint}` has a residual velocity of {rate}")
            }
            Self::Acceleration { constraint, acceleration } => {
                write!(f, "the constraint `{constraint}` has a residual acceleration of {acceleration}")
            }
            Self::Mode { mode } => {
                write!(
                    f,
                    "no configuration of the assembly mode {mode} was found: give a guess closer to one"
                )
            }
            Self::Undriven { velocity, force } => {
                write!(
                    f,
                    "the driven velocities require a force of {force} at `{velocity}`, which is not driven"
                )
            }
            Self::Singular => write!(f, "the constraints lose rank in this configuration"),
            Self::Jammed { constraint } => write!(f, "friction jams at the contact `{constraint}`"),
            Self::Contact { constraint } => {
                write!(f, "no impulses at the contact `{constraint}` prevent penetration")
            }
            Self::NoDerivatives { constraint } => write!(
                f,
                "the impulses of the contact `{constraint}` have no derivatives: they violate the contact \
                 conditions, its restitution is a ratio of impulses, or the mechanism is loaded at run time"
            ),
            Self::Coefficient { constraint, value } => write!(
                f,
                "a coefficient of the contact `{constraint}` is {value}: friction is zero or more, \
                 restitution between 0 and 1"
            ),
            Self::Overlap { constraint, depth } => {
                write!(f, "the surfaces of the contact `{constraint}` overlap by {depth}")
            }
            Self::Held { index, velocities } => {
                write!(f, "the velocity {index} cannot be held: expected an index below {velocities}")
            }
            Self::NotFinite => write!(f, "the constraints are not finite"),
        }
    }
}

impl core::error::Error for ConstraintError {}
