//! Where the rates of contacts are, and whose normal force their friction answers to.

use super::{Contacts, Rows};
use crate::Real;
use core::ops::Range;

/// The tables of a mechanism's contacts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout<const NK: usize> {
    rows: [Rows; NK],
    pressed_by: [usize; NK],
}

impl<const NK: usize> Layout<NK> {
    /// Returns the tables of a mechanism.
    #[inline(always)]
    pub(super) fn of<M, T, const NQ: usize, const NV: usize, const NU: usize, const NR: usize>(
        mechanism: &M,
    ) -> Self
    where
        T: Real,
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let (rows, pressed_by) = mechanism.contact_tables();
        Self { rows, pressed_by }
    }

    /// Returns tables from the rows of each contact and the contact that presses it.
    pub(super) const fn new(rows: [Rows; NK], pressed_by: [usize; NK]) -> Self {
        Self { rows, pressed_by }
    }

    /// The contact that presses, and the place of its gap's rate.
    pub(super) fn pressing(&self, k: usize) -> (usize, usize) {
        let by = self.pressed_by.get(k).copied().unwrap_or(k);
        (by, self.rows(by).first)
    }

    /// Whether there is a gap of its own: moments of friction have none.
    pub(super) fn is_gap(&self, k: usize) -> bool {
        self.pressing(k).0 == k
    }

    /// The places of all rates of one.
    pub(super) fn rows(&self, k: usize) -> Rows {
        self.rows.get(k).copied().unwrap_or(Rows { first: 0, count: 0 })
    }

    /// The places of its rates of slip, or of turning.
    pub(super) fn tangents(&self, k: usize) -> Range<usize> {
        let Rows { first, count } = self.rows(k);
        first + usize::from(self.is_gap(k))..first + count
    }

    /// All with a gap of their own, and the places of its rate.
    pub(super) fn gaps(&self) -> impl Iterator<Item = (usize, usize)> {
        let own = self.pressed_by.into_iter().zip(self.rows).enumerate();
        own.filter(|(k, (by, _))| k == by).map(|(k, (_, rows))| (k, rows.first))
    }
}

/// Of each contact itself.
pub(super) const fn own<const NK: usize>() -> [usize; NK] {
    let mut all = [0; NK];
    let mut k = 0;
    while k < NK {
        all[k] = k;
        k += 1;
    }
    all
}
