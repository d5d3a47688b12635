//! Why a batch was not evaluated.

use crate::integrate;
use core::fmt;

/// Why a batch was not evaluated, or not to its end.
#[derive(Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A slice that does not hold so many numbers for every state. Nothing was written.
    Length {
        /// Which argument.
        name: &'static str,
        /// How many numbers it must hold.
        expected: usize,
        /// How many it holds.
        found: usize,
    },
    /// A setting of the method that makes no sense. Nothing was written.
    Method(integrate::Error),
    /// States whose motion did not go on to the end; these were left as they were, and all others are done.
    Motion {
        /// The first of them.
        state: usize,
        /// How many there are.
        count: usize,
        /// Why the first one stopped.
        source: integrate::Error,
    },
    /// The caller asked to stop. Every state is either done or as it was.
    Cancelled {
        /// How many states are done.
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

// What an error has as its source is part of its text.
impl core::error::Error for Error {}
