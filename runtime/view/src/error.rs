//! Errors of pages, logs and live views.

use std::fmt;
use std::path::PathBuf;

/// Reason why a page, log or live view cannot be created. Every variant names the cause.
#[non_exhaustive]
pub enum Error {
    /// A motion without samples.
    Empty {
        /// Title of the motion.
        motion: String,
    },
    /// A time that is not finite, or before the previous one.
    Time {
        /// Title of the motion.
        motion: String,
        /// Index of the sample.
        sample: usize,
    },
    /// A frame whose placement is not finite, or a state that is not finite.
    NotFinite {
        /// Title of the motion.
        motion: String,
        /// Index of the sample.
        sample: usize,
        /// Name of the frame, or `state`.
        frame: String,
    },
    /// A list whose length differs from the number of samples or frames.
    Count {
        /// Description of the list.
        what: String,
        /// Expected number of entries.
        expected: usize,
        /// Actual number of entries.
        found: usize,
    },
    /// An unknown frame name.
    Frame {
        /// Requested name.
        name: String,
        /// Existing frames.
        known: Vec<String>,
    },
    /// A port at which no live view can be opened, because another program uses it or the operating system
    /// denies it.
    Port {
        /// Port number.
        port: u16,
        /// Error of the operating system.
        cause: std::io::Error,
    },
    /// A surface that cannot be drawn over its region.
    Surface {
        /// Name of the surface.
        name: String,
        /// Description of the error.
        what: String,
    },
    /// A file that cannot be read or written.
    File {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        cause: std::io::Error,
    },
    /// A file without readable triangles.
    Mesh {
        /// Path of the file.
        path: PathBuf,
        /// Description of the error.
        what: String,
    },
}

/// Prints the text of `Display`, since `main` prints a returned error with `Debug`.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Empty { motion } => write!(f, "the motion `{motion}` has no samples"),
            Error::Time { motion, sample } => {
                write!(f, "sample {sample} of `{motion}`: times are finite and do not decrease")
            }
            Error::NotFinite { motion, sample, frame } => {
                write!(f, "sample {sample} of `{motion}`: the placement of `{frame}` is not finite")
            }
            Error::Count { what, expected, found } => {
                write!(f, "{what}: expected {expected} entries, found {found}")
            }
            Error::Frame { name, known } => write!(f, "no frame `{name}`; there are {}", known.join(", ")),
            Error::Port { port, cause } => write!(f, "port {port} on this machine: {cause}"),
            Error::Surface { name, what } => write!(f, "the surface `{name}`: {what}"),
            Error::File { path, cause } => write!(f, "{}: {cause}", path.display()),
            Error::Mesh { path, what } => write!(f, "{}: {what}", path.display()),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Error::File { cause, .. } | Error::Port { cause, .. } => Some(cause),
            _ => None,
        }
    }
}
