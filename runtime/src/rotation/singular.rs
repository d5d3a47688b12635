//! Errors for rotation parameters at a singularity, such as gimbal lock.

use core::fmt;

/// Reason why rotation parameters or their rates do not exist.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Singular {
    /// The first and the third axis of a sequence of Euler angles are parallel ("gimbal lock"): the middle
    /// angle is an odd multiple of π/2 (three different axes) or a multiple of π (first axis repeated), to
    /// rounding.
    ParallelAxes,
    /// A rotation by π, or an odd multiple, to rounding: the Gibbs vector is infinite.
    HalfTurn,
    /// A rotation by a nonzero multiple of 2π, to rounding: for most angular velocities the rotation vector
    /// has no rate, and the modified Rodrigues vector is infinite.
    FullTurn,
}

crate::debug_as_display!(Singular);

impl fmt::Display for Singular {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::ParallelAxes => "the first and the third axis of the Euler angles are parallel",
            Self::HalfTurn => "a Gibbs vector is infinite at half a turn",
            Self::FullTurn => "the parameters are singular at a full turn",
        })
    }
}

impl core::error::Error for Singular {}
