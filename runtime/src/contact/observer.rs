//! Observers of the impulses of a step, such as its derivatives.

use super::solution::ContactsWithImpulses;
use crate::Real;
use nalgebra::SVector;

/// Displacement at the end of a step that closes gaps and penetrations of contacts.
pub(super) struct GapClosingDisplacement<T, const CK: usize, const CR: usize> {
    /// Gaps of the selected contacts before the displacement.
    pub(super) gaps: SVector<T, CK>,
    /// Largest gap that the displacement closes, m; larger gaps stay open.
    pub(super) reach: T,
    /// Impulses without friction whose effect on velocities is the displacement; `None` if all gaps are zero
    /// to rounding or are not closed.
    pub(super) pushes: Option<SVector<T, CR>>,
    /// Fraction of the displacement, at most one, for which it adds no energy.
    pub(super) part: T,
}

/// Receiver of the impulses of a step.
pub(super) trait ImpulseObserver<T: Real, const NV: usize> {
    /// Receives the closed contacts with their impulses, and the displacement that closes gaps at the end of
    /// a step; `None` for impulses of zero duration. It is not called if no contact is loaded.
    fn observe<const CK: usize, const CR: usize>(
        &mut self,
        acted: &ContactsWithImpulses<T, NV, CK, CR>,
        closing: Option<&GapClosingDisplacement<T, CK, CR>>,
    );
}

/// Observer of steps without derivatives.
pub(super) struct NoImpulseObserver;

impl<T: Real, const NV: usize> ImpulseObserver<T, NV> for NoImpulseObserver {
    #[inline(always)]
    fn observe<const CK: usize, const CR: usize>(
        &mut self,
        _acted: &ContactsWithImpulses<T, NV, CK, CR>,
        _closing: Option<&GapClosingDisplacement<T, CK, CR>>,
    ) {
    }
}
