//! Errors of loading a mechanism and of calling its functions.

use crate::robot::Robot;
use linkwork::integrate;
use std::fmt;
use std::path::PathBuf;

/// Error of loading a mechanism, or of calling one of its functions.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// Error: a file cannot be read.
    File {
        /// Path of the file that cannot be read.
        path: PathBuf,
        /// Reason why the file cannot be read.
        reason: String,
    },
    /// Error: the text is not a declaration of a mechanism in Rust's syntax, or the options are not those of
    /// the attribute.
    Syntax(String),
    /// Error: the mechanism has errors, which are listed as the compiler reports them.
    Mechanism(Vec<String>),
    /// Error: the mechanism has no function, parameter, frame or table of this name.
    Unknown {
        /// Kind of the name: `function`, `parameter`, `frame`, `table` or `mechanism`.
        kind: &'static str,
        /// Unknown name that was requested.
        name: String,
        /// Help for the unknown name: the nearest known name, or the list of all names.
        help: String,
    },
    /// Error: a slice has the wrong length.
    Length {
        /// Name of the function or quantity that the slice belongs to.
        of: String,
        /// Name of the argument or result that the slice contains.
        name: String,
        /// Correct length of the slice.
        expected: usize,
        /// Actual length of the slice.
        found: usize,
    },
    /// Error: the number of arguments of a call is wrong.
    Arguments {
        /// Name of the called function.
        of: String,
        /// Names of the arguments that the function takes.
        expected: Vec<&'static str>,
        /// Number of slices that were passed.
        found: usize,
    },
    /// Error: parameters or tables, listed by name, have no value yet.
    Missing(Vec<String>),
    /// Error: no physical mechanism can have this value, or it is not finite.
    Value(String),
    /// Error: the function belongs to another mechanism.
    OtherMechanism(String),
    /// Error: a motion cannot be simulated or continued, or no state satisfies the constraints.
    Motion {
        /// Reason why the motion cannot continue. Names in it are numbers, which the message replaces by
        /// names.
        reason: integrate::Error,
        /// Error message of the motion, with the names of the mechanism.
        message: String,
    },
    /// Error: Linkwork itself has a defect.
    Internal(String),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::File { path, reason } => write!(f, "{}: {reason}", path.display()),
            Error::Syntax(message) => f.write_str(message),
            Error::Mechanism(messages) => f.write_str(&messages.join("\n")),
            Error::Unknown { kind, name, help } => write!(f, "no {kind} `{name}`; {help}"),
            Error::Length { of, name, expected, found } => {
                write!(f, "`{name}` of `{of}` has {expected} entries, but the slice has {found}")
            }
            Error::Arguments { of, expected, found } => match expected.as_slice() {
                [] => write!(f, "`{of}` takes no arguments, but {found} were passed"),
                expected => write!(f, "`{of}` takes {}, but {found} slices were passed", expected.join(", ")),
            },
            Error::Missing(names) => {
                write!(f, "no value for {}: set it before the first call", names.join(", "))
            }
            Error::Value(message) | Error::Motion { message, .. } => f.write_str(message),
            Error::OtherMechanism(name) => write!(f, "`{name}` is a function of another mechanism"),
            Error::Internal(message) => {
                write!(f, "internal error of Linkwork, please report it with the file: {message}")
            }
        }
    }
}

impl std::error::Error for Error {}

impl Error {
    /// Returns the error for an unknown name, with the nearest known name as help.
    pub(crate) fn unknown_name_error<'a>(
        kind: &'static str,
        name: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Error {
        let known: Vec<&str> = known.into_iter().collect();
        let help = match linkwork_compiler::diag::nearest_candidate(name, &known) {
            Some(nearest) => format!("did you mean `{nearest}`?"),
            None if known.is_empty() => format!("the mechanism has no {kind}s"),
            None => format!("known are {}", known.join(", ")),
        };
        Error::Unknown { kind, name: name.to_string(), help }
    }
}

impl Error {
    /// Whether the limit on the number of steps was reached, which an implicit method may avoid.
    pub(crate) fn is_step_limit_error(&self) -> bool {
        matches!(self, Error::Motion { reason: integrate::Error::TooManySteps { .. }, .. })
    }
}

impl Robot {
    /// Converts an error of the integrator to an error with the names of the mechanism.
    pub(crate) fn error_from_integrator(&self, reason: integrate::Error) -> Error {
        Error::Motion { message: self.shared.replace_placeholders_by_names(&reason.to_string()), reason }
    }
}
