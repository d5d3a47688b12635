//! Errors of pages, logs and live views of motions.

use std::fmt;
use std::path::PathBuf;

/// Reason why a page, log or live view cannot be created. Every variant names the cause.
#[non_exhaustive]
pub enum Error {
    /// Error: the motion has no samples.
    Empty {
        /// Title of the motion without samples.
        motion: String,
    },
    /// Error: the time of a sample is not finite, or is before the previous time.
    Time {
        /// Title of the motion with the invalid time.
        motion: String,
        /// Index of the sample with the invalid time.
        sample: usize,
    },
    /// Error: a placement of a frame, or a state, is not finite.
    NotFinite {
        /// Title of the motion that is not finite.
        motion: String,
        /// Index of the sample that is not finite.
        sample: usize,
        /// Name of the frame whose placement is not finite, or `state`.
        frame: String,
    },
    /// Error: the length of a list differs from the number of samples or frames.
    Count {
        /// Description of the list that has the wrong length.
        what: String,
        /// Expected number of entries of the list.
        expected: usize,
        /// Actual number of entries of the list.
        found: usize,
    },
    /// Error: the drawing has no frame of the requested name.
    Frame {
        /// Requested name of the unknown frame.
        name: String,
        /// Names of the frames that exist.
        known: Vec<String>,
    },
    /// Error: no live view can be opened at this port, because another program uses it or the operating
    /// system denies it.
    Port {
        /// Port number at which no live view can be opened.
        port: u16,
        /// Error of the operating system when the port was opened.
        cause: std::io::Error,
    },
    /// Error: the surface cannot be drawn over its region, because bounds do not increase or a position is
    /// not finite.
    Surface {
        /// Name of the surface that cannot be drawn.
        name: String,
        /// Description of the error of the surface.
        what: String,
    },
    /// Error: a file cannot be read or written.
    File {
        /// Path of the file that cannot be read or written.
        path: PathBuf,
        /// Error of the operating system for the file.
        cause: std::io::Error,
    },
    /// Error: the mesh file contains no readable triangles.
    Mesh {
        /// Path of the mesh file.
        path: PathBuf,
        /// Description of the error in the mesh file.
        what: String,
    },
}

linkwork::debug_as_display!(Error);

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
