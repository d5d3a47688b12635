//! Contact impulses of a step, as the start of the iteration for the next step.

use super::problem::entry_or_zero;
use super::selection::ContactSelection;
use crate::Real;
use crate::private::constant;
use nalgebra::SVector;

/// Number of stored contacts for each velocity of the mechanism.
const CONTACTS: usize = 2;
/// Number of stored entries for each contact: its index, and up to three impulses.
const ENTRIES: usize = 4;

/// Contact impulses of a step, N·s and N·m·s, from which the iteration of the next step starts. They are
/// stored for up to two contacts for each velocity of the mechanism, zero for other contacts. They affect the
/// duration of the iteration, not its result beyond rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulses<T, const NV: usize>(
    /// For each stored contact its index plus one, and its impulses. An index of zero marks an empty entry.
    [[SVector<T, NV>; ENTRIES]; CONTACTS],
);

/// Change of the velocity that contact forces are assumed to cause in a step, and the impulses from which the
/// iteration for the impulses of the step starts.
pub type Assumed<'a, T, const NV: usize> = (&'a SVector<T, NV>, &'a Impulses<T, NV>);

impl<T: Real, const NV: usize> Impulses<T, NV> {
    /// Returns an empty store of impulses.
    #[must_use]
    pub fn none() -> Self {
        Self([[SVector::zeros(); ENTRIES]; CONTACTS])
    }

    /// Returns the impulses with each list of entries changed by a function. There are two sets of contacts
    /// with four lists each, and a list has an entry for each velocity.
    #[must_use]
    pub fn map<U, const N: usize>(&self, f: impl Fn(&SVector<T, NV>) -> SVector<U, N>) -> Impulses<U, N> {
        Impulses(self.0.each_ref().map(|lists| lists.each_ref().map(&f)))
    }

    /// Returns the impulses with lists of entries that a function returns.
    #[must_use]
    pub fn from_lists(f: impl Fn([usize; 2]) -> SVector<T, NV>) -> Self {
        Self(core::array::from_fn(|i| core::array::from_fn(|j| f([i, j]))))
    }

    /// Returns the list `j` of the contacts `i` (see [`map`](Self::map)): indices for `j = 0`, then impulses.
    #[must_use]
    pub fn list(&self, [i, j]: [usize; 2]) -> SVector<T, NV> {
        self.0.get(i).and_then(|lists| lists.get(j)).copied().unwrap_or_else(SVector::zeros)
    }

    /// Returns the impulses `all` of selected contacts.
    pub(super) fn impulses_of_selected_contacts<const CK: usize, const CR: usize>(
        selection: &ContactSelection<CK, CR>,
        all: &SVector<T, CR>,
    ) -> Self {
        let (layout, mut recorded) = (selection.contact_layout(), Self::none());
        let contact_impulse_or_zero = |k: usize, i: usize| {
            let rows = layout.rows(k);
            if i < rows.count { entry_or_zero(all, rows.first + i) } else { T::zero() }
        };
        let pressed = (0..selection.contact_count())
            .filter(|k| (0..3).any(|i| contact_impulse_or_zero(*k, i) != T::zero()));
        let places = (0..CONTACTS).flat_map(|list| (0..NV).map(move |place| (list, place)));
        for (k, (list, place)) in pressed.zip(places) {
            let number: u32 = selection.mechanism_index_of_contact(k).try_into().unwrap_or(u32::MAX);
            let values = [
                constant(f64::from(number) + 1.0),
                contact_impulse_or_zero(k, 0),
                contact_impulse_or_zero(k, 1),
                contact_impulse_or_zero(k, 2),
            ];
            let lists = recorded.0.get_mut(list).into_iter().flatten();
            for (list, value) in lists.zip(values) {
                if let Some(entry) = list.get_mut(place) {
                    *entry = value;
                }
            }
        }
        recorded
    }

    /// Returns the impulses at the rows of selected contacts; `None` if no impulse of these contacts is
    /// stored.
    pub(super) fn recall_impulses<const CK: usize, const CR: usize>(
        &self,
        selection: &ContactSelection<CK, CR>,
    ) -> Option<SVector<T, CR>> {
        let (layout, mut all) = (selection.contact_layout(), SVector::<T, CR>::zeros());
        let mut is_any = false;
        for [numbers, impulses @ ..] in &self.0 {
            for (place, number) in numbers.iter().enumerate().take_while(|(_, number)| **number > T::zero()) {
                let is_same_contact = |k: &usize| {
                    let own: u32 = selection.mechanism_index_of_contact(*k).try_into().unwrap_or(u32::MAX);
                    constant::<T>(f64::from(own) + 1.0) == *number
                };
                let Some(k) = (0..selection.contact_count()).find(is_same_contact) else { continue };
                let rows = layout.rows(k);
                for (i, list) in (rows.first..rows.first + rows.count).zip(impulses) {
                    if let Some(impulse) = all.get_mut(i) {
                        *impulse = entry_or_zero(list, place);
                        is_any = true;
                    }
                }
            }
        }
        is_any.then_some(all)
    }
}
