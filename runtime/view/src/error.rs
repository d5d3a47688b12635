//! Why there is no page, log or live view.

use std::fmt;
use std::path::PathBuf;

/// Why there is no page, log or live view. Every variant names what is to blame.
#[non_exhaustive]
pub enum Error {
    /// A motion without a sample.
    Empty {
        /// Title of the motion.
        motion: String,
    },
    /// A time that is not finite, or before the one that precedes it.
    Time {
        /// Title of the motion.
        motion: String,
        /// Number of the sample.
        sample: usize,
    },
    /// A frame whose placement is not finite.
    NotFinite {
        /// Title of the motion.
        motion: String,
        /// Number of the sample.
        sample: usize,
        /// The frame.
        frame: String,
    },
    /// A list that should have an entry for each sample, or for each frame.
    Count {
        /// What the list is.
        what: String,
        /// How many fit.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A frame of this name does not exist.
    Frame {
        /// What was asked for.
        name: String,
        /// The frames that there are.
        known: Vec<String>,
    },
    /// A port where no live view can be opened: another program has it, or the system does not give it.
    Port {
        /// The port.
        port: u16,
        /// What the system says.
        cause: std::io::Error,
    },
    /// A surface that cannot be drawn over its region.
    Surface {
        /// Name of the surface.
        name: String,
        /// What is wrong.
        what: String,
    },
    /// A file that cannot be read or written.
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// A file that holds no triangles that are understood.
    Mesh {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
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
