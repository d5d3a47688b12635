//! Contacts that take part in a step, numbered among themselves.

use super::layout::ContactLayout;
use super::problem::{ContactProblem, DelassusFactor, UsedColumns, dot, entry_or_zero, set_entry};
use super::response::{CholeskyFactor, ImpulseEffects};
use super::total::TotalArray;
use super::velocities::ContactVelocities;
use super::{Contacts, Law, Responses, Restitution, Rows};
use crate::Real;
use nalgebra::{SMatrix, SVector};

/// Largest number of contact velocities of a mechanism with generated responses.
pub(super) const FEW: usize = 36;

/// Up to `CK` closed contacts of a mechanism, with up to `CR` contact velocities.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactSelection<const CK: usize, const CR: usize> {
    /// Contacts of the mechanism, and their number.
    contacts: TotalArray<usize, CK>,
    count: usize,
    /// Rows of the mechanism, and their number.
    rows: TotalArray<usize, CR>,
    size: usize,
    /// Rows among the selected ones.
    layout: ContactLayout<CK>,
}

impl<const CK: usize, const CR: usize> ContactSelection<CK, CR> {
    /// Selects the closed contacts. A friction moment is selected if its contact is closed.
    pub(super) fn select_closed_contacts<const NK: usize>(
        layout: ContactLayout<NK>,
        closed: &[bool; NK],
    ) -> Self {
        let (mut contacts, mut rows) = (TotalArray::repeat_entry(0), TotalArray::repeat_entry(0));
        let (mut own, mut pressed_by) = ([Rows { first: 0, count: 0 }; CK], [0; CK]);
        let (mut count, mut size) = (0, 0);
        for (k, _) in closed.iter().enumerate().filter(|(_, is_closed)| **is_closed) {
            let Rows { first, count: width } = layout.rows(k);
            let (by, _) = layout.bounding_contact(k);
            let pressing = if by == k { Some(count) } else { (0..count).find(|c| contacts[*c] == by) };
            let (Some(pressing), true) = (pressing, count < CK && size + width <= CR) else { continue };
            contacts[count] = k;
            (0..width).for_each(|i| rows[size + i] = first + i);
            if let (Some(own), Some(by)) = (own.get_mut(count), pressed_by.get_mut(count)) {
                (*own, *by) = (Rows { first: size, count: width }, pressing);
            }
            count += 1;
            size += width;
        }
        Self { contacts, count, rows, size, layout: ContactLayout::new(own, pressed_by) }
    }

    /// Returns the rows of the selected contacts.
    pub(super) fn contact_layout(&self) -> ContactLayout<CK> {
        self.layout
    }

    /// Returns the number of selected contacts.
    pub(super) fn contact_count(&self) -> usize {
        self.count
    }

    /// Returns the number of selected rows.
    pub(super) fn row_count(&self) -> usize {
        self.size
    }

    /// Returns a selected contact's index in the mechanism.
    pub(super) fn mechanism_index_of_contact(&self, k: usize) -> usize {
        self.contacts[k]
    }

    /// Returns a selected row's index in the mechanism.
    pub(super) fn mechanism_index_of_row(&self, i: usize) -> usize {
        self.rows[i]
    }

    /// Returns true for entries that are selected contacts.
    pub(super) fn selected_contact_mask(&self) -> [bool; CK] {
        let mut closed = [false; CK];
        closed.iter_mut().take(self.count).for_each(|closed| *closed = true);
        closed
    }

    /// Returns the contact velocities of the selected rows from those of all rows.
    pub(super) fn selected_contact_rates<T: Real, const NR: usize>(
        &self,
        all: &SVector<T, NR>,
    ) -> SVector<T, CR> {
        let mut rates = SVector::zeros();
        (0..self.size).for_each(|i| set_entry(&mut rates, i, entry_or_zero(all, self.rows[i])));
        rates
    }

    /// Returns the gaps of the selected contacts from those of all contacts.
    pub(super) fn selected_gaps<T: Real, const NK: usize>(&self, all: &SVector<T, NK>) -> SVector<T, CK> {
        let mut gaps = SVector::zeros();
        (0..self.count).for_each(|k| set_entry(&mut gaps, k, entry_or_zero(all, self.contacts[k])));
        gaps
    }

    /// Returns the coefficients of the selected contacts.
    pub(super) fn selected_laws<T: Real, const NK: usize>(&self, all: &[Law<T>; NK]) -> [Law<T>; CK] {
        let hypothesis = Restitution::Newton;
        let none = Law { friction: T::zero(), stiction: T::zero(), restitution: T::zero(), hypothesis };
        let mut laws = [none; CK];
        for (law, k) in laws.iter_mut().zip(self.contacts.iter()).take(self.count) {
            *law = all.get(*k).copied().unwrap_or(none);
        }
        laws
    }

    /// Returns values of the selected rows at the rows of the mechanism; zeros elsewhere.
    pub(super) fn impulses_at_mechanism_rows<T: Real, const NR: usize>(
        &self,
        rates: &SVector<T, CR>,
    ) -> SVector<T, NR> {
        let mut all = SVector::zeros();
        (0..self.size).for_each(|i| set_entry(&mut all, self.rows[i], entry_or_zero(rates, i)));
        all
    }

    /// Computes the effects of impulses at the selected contacts, and `B` or `W` of a problem.
    pub(super) fn compute_impulse_effects<
        M,
        T,
        const NQ: usize,
        const NV: usize,
        const NU: usize,
        const NK: usize,
        const NR: usize,
    >(
        &self,
        mechanism: &M,
        (t, q, velocities): (T, &SVector<T, NQ>, &ContactVelocities<'_, M, T, NQ, NV, NR>),
        closed: &[bool; NK],
        effects: &mut ImpulseEffects<T, NV, CR>,
        problem: &mut ContactProblem<T, CK, CR>,
    ) where
        T: Real,
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        if NR <= FEW {
            let all = mechanism.contact_responses(t, q, closed);
            let Responses { velocities, rates } = self.responses_at_selected_contacts(&all);
            problem.copy_closed_contact_weights(&rates);
            *effects = ImpulseEffects::Matrix(velocities);
            return;
        }
        let Some(jacobian) = velocities.contact_jacobian() else { return };
        let features = mechanism.features();
        let is_plain = !features.constrained && !features.feedback;
        if is_plain {
            *effects = ImpulseEffects::Factor(CholeskyFactor::zero_factor());
        }
        if let ImpulseEffects::Factor(factor) = effects
            && factor.factorise_matrix(&mechanism.mass_matrix(t, q))
        {
            if self.compute_impulse_basis(jacobian, mechanism.contact_columns(), factor, &mut problem.basis) {
                problem.compute_natural_map_steps();
                return;
            }
            let matrix =
                self.compute_responses_and_weights(jacobian, |row| factor.solve_with_factor(row), problem);
            *effects = ImpulseEffects::Matrix(matrix);
            return;
        }
        let still = SVector::zeros();
        let velocity_change = |p: &_| mechanism.velocity_change_by_impulse(t, q, &still, T::zero(), p);
        let none = velocity_change(&still);
        let velocity_change_of_row = |row: [T; NV]| (velocity_change(&SVector::from(row)) - none).data.0[0];
        *effects = ImpulseEffects::Matrix(self.compute_responses_and_weights(
            jacobian,
            velocity_change_of_row,
            problem,
        ));
    }

    /// Returns the effects of impulses at the selected contacts from those at all contacts.
    fn responses_at_selected_contacts<T: Real, const NV: usize, const NR: usize>(
        &self,
        all: &Responses<T, NV, NR>,
    ) -> Responses<T, NV, CR> {
        let mut chosen = Responses::zero_responses();
        let Responses { velocities, rates } = &mut chosen;
        let columns = velocities.data.0.iter_mut().zip(&mut rates.data.0);
        for ((velocities, rates), from) in columns.zip(self.rows.iter()).take(self.size) {
            if let (Some(all), Some(changes)) =
                (all.velocities.data.0.get(*from), all.rates.data.0.get(*from))
            {
                *velocities = *all;
                for (to, i) in rates.iter_mut().zip(self.rows.iter()).take(self.size) {
                    *to = changes.get(*i).copied().unwrap_or(T::zero());
                }
            }
        }
        chosen
    }

    /// Computes `B = G L⁻ᵀ` for the selected rows of the contact Jacobian `G`, with the Cholesky factor `L`
    /// of the mass matrix. Returns false if `B` has more columns than the arrays.
    fn compute_impulse_basis<T: Real, const NV: usize, const NK: usize, const NR: usize>(
        &self,
        jacobian: &SMatrix<T, NR, NV>,
        reach: [(usize, usize); NK],
        factor: &CholeskyFactor<T, NV>,
        basis: &mut DelassusFactor<T, CR>,
    ) -> bool {
        // Columns of each contact that are not zero, with the whole blocks of the bodies that move.
        let (mut is_used, mut own) = ([false; NV], TotalArray::<_, CK>::repeat_entry((NV, 0)));
        for k in 0..self.count {
            let Rows { first: top, count } = self.layout.rows(k);
            let (first, last) = reach.get(self.contacts[k]).copied().unwrap_or((0, NV));
            let mut column = first;
            while column < last {
                let entries = jacobian.data.0.get(column);
                let entry_of_selected_row = |i: usize| entries.and_then(|entries| entries.get(self.rows[i]));
                if (top..top + count)
                    .all(|i| entry_of_selected_row(i).is_none_or(|entry| *entry == T::zero()))
                {
                    column += 1;
                    continue;
                }
                let end = factor.block_end(column);
                own[k] = (own[k].0.min(column), end);
                is_used.iter_mut().take(end).skip(column).for_each(|is_used| *is_used = true);
                column = end;
            }
        }
        let columns = UsedColumns::columns_for_used_entries(is_used);
        if !basis.restart_with_columns(&columns) {
            return false;
        }
        for k in 0..self.count {
            let (Rows { first: top, count }, (first, last)) = (self.layout.rows(k), own[k]);
            for i in top..top + count {
                let mut row = [T::zero(); NV];
                let entries = row.iter_mut().zip(&jacobian.data.0).take(last).skip(first);
                entries.for_each(|(to, column)| {
                    *to = column.get(self.rows[i]).copied().unwrap_or(T::zero());
                });
                factor.solve_lower(&mut row, first, last);
                basis.push_row(&columns, first, row.get(first..last).unwrap_or_default());
            }
        }
        true
    }

    /// Returns `M⁻¹ Gᵀ` for selected rows, given a function that returns the velocity change by a generalized
    /// impulse, and sets the matrix `W` of a problem.
    fn compute_responses_and_weights<T: Real, const NV: usize, const NR: usize>(
        &self,
        jacobian: &SMatrix<T, NR, NV>,
        solve: impl Fn([T; NV]) -> [T; NV],
        problem: &mut ContactProblem<T, CK, CR>,
    ) -> SMatrix<T, NV, CR> {
        // Rows of the Jacobian.
        let mut own = [[T::zero(); NV]; CR];
        for (own, i) in own.iter_mut().zip(self.rows.iter()).take(self.size) {
            for (entry, column) in own.iter_mut().zip(&jacobian.data.0) {
                *entry = column.get(*i).copied().unwrap_or(T::zero());
            }
        }
        let Responses { mut velocities, mut rates } = Responses::zero_responses();
        for (velocity, own) in velocities.data.0.iter_mut().zip(&own).take(self.size) {
            *velocity = solve(*own);
        }
        self.fill_scalar_products(&own, &velocities.data.0, &mut rates);
        problem.copy_closed_contact_weights(&rates);
        velocities
    }

    /// Writes the symmetric matrix of the scalar products of rows on the left and on the right; entries of
    /// rows without common columns stay as they are.
    fn fill_scalar_products<T: Real, const NV: usize>(
        &self,
        left: &[[T; NV]; CR],
        right: &[[T; NV]; CR],
        products: &mut SMatrix<T, CR, CR>,
    ) {
        // Entries of each row that are not zero.
        let mut reach = [(0, 0); CR];
        for (reach, row) in reach.iter_mut().zip(left).take(self.size) {
            let is_nonzero = |entry: &T| *entry != T::zero();
            let from = row.iter().position(is_nonzero).unwrap_or(NV);
            *reach = (from, row.iter().rposition(is_nonzero).map_or(from, |last| last + 1));
        }
        for (j, other) in right.iter().enumerate().take(self.size) {
            for (i, (row, (from, to))) in left.iter().zip(&reach).enumerate().take(self.size).skip(j) {
                let (Some(row), Some(other)) = (row.get(*from..*to), other.get(*from..*to)) else { continue };
                let product = dot(row, other);
                for (row, column) in [(i, j), (j, i)] {
                    let column = products.data.0.get_mut(column);
                    if let Some(entry) = column.and_then(|column| column.get_mut(row)) {
                        *entry = product;
                    }
                }
            }
        }
    }
}
