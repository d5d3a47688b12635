//! Errors of batches.

use crate::integrate;
use core::fmt;

/// Error for a batch that was not evaluated, or only partly.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The length of a slice does not match the number of states. Nothing was written.
    Length {
        /// Name of the argument.
        name: &'static str,
        /// Expected length.
        expected: usize,
        /// Length of the slice.
        found: usize,
    },
    /// A setting of the method is invalid. Nothing was written.
    Method(integrate::Error),
    /// The motion of some states failed before the end. These states are unchanged; all others are done.
    Motion {
        /// Index of the first failed state.
        state: usize,
        /// Number of failed states.
        count: usize,
        /// Error of the first failed state.
        source: integrate::Error,
    },
    /// The caller cancelled the rollout. Every state is either done or unchanged.
    Cancelled {
        /// Number of states that are done.
        done: usize,
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
            Self::Length { name, expected, found } => {
                write!(f, "`{name}` must hold {expected} numbers, found {found}")
            }
            Self::Method(error) => error.fmt(f),
            Self::Motion { state, count, source } => {
                write!(f, "state {state}: {source} ({count} in all did not reach the end)")
            }
            Self::Cancelled { done } => write!(f, "cancelled when {done} states were done"),
        }
    }
}

// The text of an error includes that of its source, so `source()` returns none.
impl core::error::Error for Error {}
