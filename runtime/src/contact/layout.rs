//! Layout of contact velocities: the rows of each contact, and the contact whose normal force bounds the
//! friction of each.

use super::{Contacts, Rows};
use crate::Real;
use core::ops::Range;

/// Tables of a mechanism's contacts: the rows of each, and the contact that bounds the friction of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactLayout<const NK: usize> {
    rows: [Rows; NK],
    pressed_by: [usize; NK],
}

impl<const NK: usize> ContactLayout<NK> {
    /// Returns the tables of a mechanism.
    #[inline(always)]
    pub(super) fn of_mechanism<M, T, const NQ: usize, const NV: usize, const NU: usize, const NR: usize>(
        mechanism: &M,
    ) -> Self
    where
        T: Real,
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let (rows, pressed_by) = mechanism.contact_tables();
        Self { rows, pressed_by }
    }

    /// Returns the tables for given rows of each contact, and the index of the contact whose normal force
    /// bounds its friction.
    pub(super) const fn new(rows: [Rows; NK], pressed_by: [usize; NK]) -> Self {
        Self { rows, pressed_by }
    }

    /// Returns the index of the contact whose normal force bounds the friction of contact `k`, and the row of
    /// its gap velocity.
    pub(super) fn bounding_contact(&self, k: usize) -> (usize, usize) {
        let by = self.pressed_by.get(k).copied().unwrap_or(k);
        (by, self.rows(by).first)
    }

    /// Whether contact `k` has a gap function; friction moments have none.
    pub(super) fn has_gap_function(&self, k: usize) -> bool {
        self.bounding_contact(k).0 == k
    }

    /// Returns the rows of all contact velocities of contact `k`.
    pub(super) fn rows(&self, k: usize) -> Rows {
        self.rows.get(k).copied().unwrap_or(Rows { first: 0, count: 0 })
    }

    /// Returns the rows of the slip velocities of contact `k`, or of the angular velocities of a friction
    /// moment.
    pub(super) fn tangent_rows(&self, k: usize) -> Range<usize> {
        let Rows { first, count } = self.rows(k);
        first + usize::from(self.has_gap_function(k))..first + count
    }

    /// Returns all contacts that have a gap function, with the rows of their gap velocities.
    pub(super) fn gap_contacts(&self) -> impl Iterator<Item = (usize, usize)> {
        let own = self.pressed_by.into_iter().zip(self.rows).enumerate();
        own.filter(|(k, (by, _))| k == by).map(|(k, (_, rows))| (k, rows.first))
    }
}

/// Returns the table in which each contact bounds its own friction.
pub(super) const fn self_bounding_contact_table<const NK: usize>() -> [usize; NK] {
    let mut all = [0; NK];
    let mut k = 0;
    while k < NK {
        all[k] = k;
        k += 1;
    }
    all
}
