//! Observers of the impulses of a step, such as its derivatives.

use super::solution::Acted;
use crate::Real;
use nalgebra::SVector;

/// Displacement at the end of a step that closes gaps and penetrations of contacts.
pub(super) struct Closing<T, const CK: usize, const CR: usize> {
    /// Gaps of the selected contacts before the displacement.
    pub(super) gaps: SVector<T, CK>,
    /// Largest gap that is closed.
    pub(super) reach: T,
    /// Impulses without friction whose effect on velocities is the displacement; `None` if all gaps are zero
    /// to rounding or are not closed.
    pub(super) pushes: Option<SVector<T, CR>>,
    /// Fraction of the displacement that the energy allows.
    pub(super) part: T,
}

/// Receiver of the impulses of a step.
pub(super) trait Observer<T: Real, const NV: usize> {
    /// Receives the closed contacts with their impulses, and the displacement that closes gaps at the end of
    /// a step; `None` for impulses of zero duration. It is not called if no contact is loaded.
    fn observe<const CK: usize, const CR: usize>(
        &mut self,
        acted: &Acted<T, NV, CK, CR>,
        closing: Option<&Closing<T, CK, CR>>,
    );
}

/// Observer of steps without derivatives.
pub(super) struct Unobserved;

impl<T: Real, const NV: usize> Observer<T, NV> for Unobserved {
    #[inline(always)]
    fn observe<const CK: usize, const CR: usize>(
        &mut self,
        _acted: &Acted<T, NV, CK, CR>,
        _closing: Option<&Closing<T, CK, CR>>,
    ) {
    }
}
