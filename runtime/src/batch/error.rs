//! Errors of batch functions and rollouts.

use crate::integrate;
use core::fmt;

/// Error for a batch that was not evaluated, or only partly.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// Error: the length of a slice does not match the number of states. Nothing was written.
    Length {
        /// Name of the argument with the wrong length.
        name: &'static str,
        /// Expected length of the argument.
        expected: usize,
        /// Actual length of the argument.
        found: usize,
    },
    /// Error: a setting of the method is invalid. Nothing was written.
    Method(integrate::Error),
    /// Error: the motion of some states failed before the end. These states are unchanged; all others are
    /// done.
    Motion {
        /// Index of the first state that failed.
        state: usize,
        /// Number of states that failed.
        count: usize,
        /// Error of the first state that failed.
        source: integrate::Error,
    },
    /// Error: the caller cancelled the rollout. Every state is either done or unchanged.
    Cancelled {
        /// Number of states that were done before the cancellation.
        done: usize,
    },
}

crate::debug_as_display!(Error);

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
