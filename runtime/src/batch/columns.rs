//! Structures of arrays for batches: for every entry of a vector, the values in all states are contiguous.

use super::Error;
use crate::{Lanes, Real};
use nalgebra::SMatrix;

/// Values in SIMD lanes, aligned to cache lines.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct AlignedLanes<T>(pub(super) T);

/// Read access to the values of many states: entry `i` (column by column of a matrix) of state `k` is
/// `numbers[i * count + k]`.
#[derive(Clone, Copy)]
pub(super) struct InputColumns<'a, T, const R: usize> {
    entries: [&'a [T]; R],
}

/// Write access to the values of many states, in the layout of [`Input`].
pub(super) struct OutputColumns<'a, T, const R: usize, const C: usize> {
    entries: [[&'a mut [T]; R]; C],
}

/// Checks that a slice has `entries` values for each of `count` states, and otherwise returns an error with
/// the name of the argument.
///
/// # Errors
///
/// [`Error::Length`] unless it is `entries * count`.
fn check_slice_length(name: &'static str, found: usize, entries: usize, count: usize) -> Result<(), Error> {
    match entries.checked_mul(count) {
        Some(expected) if expected == found => Ok(()),
        expected => Err(Error::Length { name, expected: expected.unwrap_or(usize::MAX), found }),
    }
}

/// Returns the number of states according to the first argument, rounded down.
pub(super) fn count_states_in_first_argument(numbers: usize, entries: usize) -> usize {
    numbers.checked_div(entries).unwrap_or(0)
}

impl<'a, T: Real, const R: usize> InputColumns<'a, T, R> {
    pub(super) fn new(name: &'static str, numbers: &'a [T], count: usize) -> Result<Self, Error> {
        check_slice_length(name, numbers.len(), R, count)?;
        let mut rest = numbers;
        let entries = core::array::from_fn(|_| {
            let (entry, others) = rest.split_at_checked(count).unwrap_or((rest, &[]));
            rest = others;
            entry
        });
        Ok(Self { entries })
    }

    /// Loads the states from index `first` on into lanes; lanes beyond the last state contain the last state.
    #[inline(always)]
    pub(super) fn load_states<const L: usize>(
        &self,
        first: usize,
    ) -> AlignedLanes<SMatrix<Lanes<T, L>, R, 1>> {
        AlignedLanes(SMatrix::from_fn(|i, _| load_entry_into_lanes(self.entries[i], first)))
    }
}

#[inline(always)]
fn load_entry_into_lanes<T: Real, const L: usize>(entry: &[T], first: usize) -> Lanes<T, L> {
    if let Some(full) = entry.get(first..first + L)
        && let Ok(full) = full.try_into()
    {
        return Lanes(full);
    }
    Lanes::from_fn(|k| entry.get(first + k).or(entry.last()).copied().unwrap_or(T::zero()))
}

impl<'a, T: Real, const R: usize, const C: usize> OutputColumns<'a, T, R, C> {
    pub(super) fn new(name: &'static str, numbers: &'a mut [T], count: usize) -> Result<Self, Error> {
        check_slice_length(name, numbers.len(), R * C, count)?;
        let mut rest = numbers;
        let entries = core::array::from_fn(|_| {
            core::array::from_fn(|_| {
                let all = core::mem::take(&mut rest);
                let (entry, others) = all.split_at_mut_checked(count).unwrap_or_default();
                rest = others;
                entry
            })
        });
        Ok(Self { entries })
    }

    /// Splits the values into those of the states before index `at` and those of the states from `at` on.
    #[cfg(feature = "rayon")]
    pub(super) fn split_at_state(self, at: usize) -> (Self, Self) {
        let empty_columns = || core::array::from_fn(|_| core::array::from_fn(|_| <&'a mut [T]>::default()));
        let (mut before, mut after): ([[_; R]; C], [[_; R]; C]) = (empty_columns(), empty_columns());
        let halves = before.iter_mut().flatten().zip(after.iter_mut().flatten());
        for (all, (before, after)) in self.entries.into_iter().flatten().zip(halves) {
            (*before, *after) = all.split_at_mut_checked(at).unwrap_or_default();
        }
        (Self { entries: before }, Self { entries: after })
    }

    /// Stores the lanes of existing states, from state `first` on; lanes beyond the last state are ignored.
    #[inline(always)]
    pub(super) fn store_lanes<const L: usize>(&mut self, first: usize, values: &SMatrix<Lanes<T, L>, R, C>) {
        for (entries, values) in self.entries.iter_mut().zip(&values.data.0) {
            for (entry, value) in entries.iter_mut().zip(values) {
                if let Some(full) = entry.get_mut(first..first + L) {
                    full.copy_from_slice(&value.0);
                } else if let Some(rest) = entry.get_mut(first..) {
                    for (to, from) in rest.iter_mut().zip(value.0) {
                        *to = from;
                    }
                }
            }
        }
    }
}

impl<T: Real, const R: usize> OutputColumns<'_, T, R, 1> {
    /// Loads the states from index `first` on into lanes; lanes beyond the last state contain the last state.
    #[inline(always)]
    pub(super) fn load_states<const L: usize>(
        &self,
        first: usize,
    ) -> AlignedLanes<SMatrix<Lanes<T, L>, R, 1>> {
        AlignedLanes(SMatrix::from_fn(|i, _| load_entry_into_lanes(self.entries[0][i], first)))
    }

    /// Stores the values of one state, which are in one lane.
    pub(super) fn store_state_of_lane<const L: usize>(
        &mut self,
        state: usize,
        values: &SMatrix<Lanes<T, L>, R, 1>,
        lane: usize,
    ) {
        for (entry, value) in self.entries[0].iter_mut().zip(&values.data.0[0]) {
            if let (Some(to), Some(from)) = (entry.get_mut(state), value.0.get(lane)) {
                *to = *from;
            }
        }
    }
}
