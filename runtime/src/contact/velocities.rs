//! Contact velocities in one configuration.

use super::problem::entry_or_zero;
use super::selection::{ContactSelection, FEW};
use super::{Contacts, Rows};
use crate::Real;
use core::cell::OnceCell;
use nalgebra::{SMatrix, SVector};

/// Contact velocities of a mechanism in one configuration, as linear functions of its velocity. Mechanisms
/// with many contacts evaluate the Jacobian once, and with it only the contact velocities that are needed.
pub(super) struct ContactVelocities<'a, M, T, const NQ: usize, const NV: usize, const NR: usize> {
    mechanism: &'a M,
    t: T,
    q: &'a SVector<T, NQ>,
    jacobian: OnceCell<SMatrix<T, NR, NV>>,
    /// Contact velocities of the mechanism at rest, which prescribed motions cause.
    drift: OnceCell<SVector<T, NR>>,
}

/// Returns the value of a cell, which is computed first if the cell is empty.
fn get_or_compute<T>(cell: &OnceCell<T>, value: impl FnOnce() -> T) -> Option<&T> {
    if cell.get().is_none() {
        // The cell is empty, so that this cannot fail.
        let _ = cell.set(value());
    }
    cell.get()
}

impl<'a, M, T: Real, const NQ: usize, const NV: usize, const NR: usize>
    ContactVelocities<'a, M, T, NQ, NV, NR>
{
    /// Returns the contact velocities in a configuration, as functions of the velocity that are not yet
    /// evaluated.
    pub(super) fn unevaluated_in_configuration(mechanism: &'a M, t: T, q: &'a SVector<T, NQ>) -> Self {
        Self { mechanism, t, q, jacobian: OnceCell::new(), drift: OnceCell::new() }
    }

    /// Returns the Jacobian of all contacts, which always exists; an `Option` needs no code that panics.
    pub(super) fn contact_jacobian<const NU: usize, const NK: usize>(&self) -> Option<&SMatrix<T, NR, NV>>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        get_or_compute(&self.jacobian, || self.mechanism.contact_jacobian(self.t, self.q))
    }

    /// Returns the contact velocities at rest; `None` if no prescribed motion may cause any.
    fn contact_velocities_at_rest<const NU: usize, const NK: usize>(&self) -> Option<&SVector<T, NR>>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let compute_contact_velocities_at_rest =
            || self.mechanism.contact_rates(self.t, self.q, &SVector::zeros());
        if self.mechanism.contacts_drift() {
            get_or_compute(&self.drift, compute_contact_velocities_at_rest)
        } else {
            None
        }
    }

    /// Whether prescribed motions cause contact velocities.
    pub(super) fn has_prescribed_contact_velocities<const NU: usize, const NK: usize>(&self) -> bool
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        self.contact_velocities_at_rest().is_some_and(|drift| drift.iter().any(|rate| *rate != T::zero()))
    }

    /// Returns a function of the contact velocities for a velocity, which takes a contact and one of its
    /// rows.
    pub(super) fn rate_function_of_velocity<const NU: usize, const NK: usize>(
        &self,
        v: &SVector<T, NV>,
    ) -> impl Fn(usize, usize) -> T
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let all = (NR <= FEW).then(|| self.mechanism.contact_rates(self.t, self.q, v));
        let drift = if NR <= FEW { None } else { self.contact_velocities_at_rest() };
        let change = self.rate_change_function_from_jacobian(v);
        move |k, row| match (&all, drift) {
            (Some(all), _) => entry_or_zero(all, row),
            (None, Some(drift)) => change(k, row) + entry_or_zero(drift, row),
            (None, None) => change(k, row),
        }
    }

    /// Returns a function of the changes of the contact velocities for a change of the velocity, which takes
    /// a contact and one of its rows.
    pub(super) fn rate_change_function<const NU: usize, const NK: usize>(
        &self,
        change: &SVector<T, NV>,
    ) -> impl Fn(usize, usize) -> T
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let all = (NR <= FEW).then(|| self.all_rate_changes(change));
        let change = self.rate_change_function_from_jacobian(change);
        move |k, row| all.as_ref().map_or_else(|| change(k, row), |all| entry_or_zero(all, row))
    }

    /// Returns the changes of all contact velocities for a change of the velocity.
    fn all_rate_changes<const NU: usize, const NK: usize>(&self, change: &SVector<T, NV>) -> SVector<T, NR>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let changed = self.mechanism.contact_rates(self.t, self.q, change);
        match self.contact_velocities_at_rest() {
            Some(drift) => changed - drift,
            None => changed,
        }
    }

    /// Computes [`rate_change_function`](Self::rate_change_function) from the contact Jacobian, which the
    /// first call of the returned function evaluates.
    fn rate_change_function_from_jacobian<const NU: usize, const NK: usize>(
        &self,
        change: &SVector<T, NV>,
    ) -> impl Fn(usize, usize) -> T
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let columns = self.mechanism.contact_columns();
        move |k, row| {
            let (first, last) = columns.get(k).copied().unwrap_or((0, NV));
            let Some(jacobian) = self.contact_jacobian() else { return T::zero() };
            let terms = jacobian.data.0.iter().zip(&change.data.0[0]).take(last).skip(first);
            terms.fold(T::zero(), |sum, (column, v)| sum + column.get(row).copied().unwrap_or(T::zero()) * *v)
        }
    }

    /// Returns the contact velocities of selected contacts for a velocity.
    pub(super) fn selected_rates<const NU: usize, const NK: usize, const CK: usize, const CR: usize>(
        &self,
        selection: &ContactSelection<CK, CR>,
        v: &SVector<T, NV>,
    ) -> SVector<T, CR>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        if NR <= FEW {
            return selection.selected_contact_rates(&self.mechanism.contact_rates(self.t, self.q, v));
        }
        let changes = self.selected_rate_changes(selection, v);
        match self.contact_velocities_at_rest() {
            Some(drift) => changes + selection.selected_contact_rates(drift),
            None => changes,
        }
    }

    /// Returns the changes of the contact velocities of selected contacts for a change of the velocity.
    pub(super) fn selected_rate_changes<const NU: usize, const NK: usize, const CK: usize, const CR: usize>(
        &self,
        selection: &ContactSelection<CK, CR>,
        change: &SVector<T, NV>,
    ) -> SVector<T, CR>
    where
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        if NR <= FEW {
            return selection.selected_contact_rates(&self.all_rate_changes(change));
        }
        let mut rates = SVector::zeros();
        let Some(jacobian) = self.contact_jacobian() else { return rates };
        let columns = self.mechanism.contact_columns();
        let jacobian_column_range = |k: usize| columns.get(selection.mechanism_index_of_contact(k)).copied();
        let layout = selection.contact_layout();
        let mut k = 0;
        while k < selection.contact_count() {
            let (reach, Rows { first, mut count }) = (jacobian_column_range(k), layout.rows(k));
            let top = selection.mechanism_index_of_row(first);
            k += 1;
            // Contacts of the same bodies have adjacent rows, which are multiplied at once.
            while k < selection.contact_count()
                && jacobian_column_range(k) == reach
                && selection.mechanism_index_of_row(first + count) == top + count
            {
                count += layout.rows(k).count;
                k += 1;
            }
            let (from, to) = reach.unwrap_or((0, NV));
            let rates = rates.as_mut_slice().get_mut(first..first + count).unwrap_or_default();
            for (column, v) in jacobian.data.0.iter().zip(&change.data.0[0]).take(to).skip(from) {
                let entries = column.get(top..top + count).unwrap_or_default();
                rates.iter_mut().zip(entries).for_each(|(rate, entry)| *rate += *entry * *v);
            }
        }
        rates
    }
}
