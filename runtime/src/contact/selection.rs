//! Contacts that take part in a step, numbered among themselves.

use super::layout::Layout;
use super::problem::{Basis, dot, entry, put};
use super::response::Factor;
use super::total::Total;
use super::{Contacts, Law, Responses, Restitution, Rows};
use crate::Real;
use nalgebra::{SMatrix, SVector};

/// Largest number of contact velocities of a mechanism with generated responses.
pub(super) const FEW: usize = 36;

/// Up to `CK` closed contacts of a mechanism, with up to `CR` contact velocities.
#[derive(Clone, Copy, Debug)]
pub(super) struct Selection<const CK: usize, const CR: usize> {
    /// Contacts of the mechanism, and their number.
    contacts: Total<usize, CK>,
    count: usize,
    /// Rows of the mechanism, and their number.
    rows: Total<usize, CR>,
    size: usize,
    /// Rows among the selected ones.
    layout: Layout<CK>,
}

impl<const CK: usize, const CR: usize> Selection<CK, CR> {
    /// Selects the contacts that are closed; a moment of friction if its contact is.
    pub(super) fn select<const NK: usize>(layout: Layout<NK>, closed: &[bool; NK]) -> Self {
        let (mut contacts, mut rows) = (Total::repeat(0), Total::repeat(0));
        let (mut own, mut pressed_by) = ([Rows { first: 0, count: 0 }; CK], [0; CK]);
        let (mut count, mut size) = (0, 0);
        for (k, _) in closed.iter().enumerate().filter(|(_, is_closed)| **is_closed) {
            let Rows { first, count: width } = layout.rows(k);
            let (by, _) = layout.pressing(k);
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
        Self { contacts, count, rows, size, layout: Layout::new(own, pressed_by) }
    }

    /// Returns the rows of the selected contacts.
    pub(super) fn layout(&self) -> Layout<CK> {
        self.layout
    }

    /// Returns the number of selected contacts.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Returns a selected contact's index in the mechanism.
    pub(super) fn contact(&self, k: usize) -> usize {
        self.contacts[k]
    }

    /// Returns true for entries that are selected contacts.
    pub(super) fn closed(&self) -> [bool; CK] {
        let mut closed = [false; CK];
        closed.iter_mut().take(self.count).for_each(|closed| *closed = true);
        closed
    }

    /// Returns values of the selected rows.
    pub(super) fn rates<T: Real, const NR: usize>(&self, all: &SVector<T, NR>) -> SVector<T, CR> {
        let mut rates = SVector::zeros();
        (0..self.size).for_each(|i| put(&mut rates, i, entry(all, self.rows[i])));
        rates
    }

    /// Returns values of the selected contacts.
    pub(super) fn gaps<T: Real, const NK: usize>(&self, all: &SVector<T, NK>) -> SVector<T, CK> {
        let mut gaps = SVector::zeros();
        (0..self.count).for_each(|k| put(&mut gaps, k, entry(all, self.contacts[k])));
        gaps
    }

    /// Returns the coefficients of the selected contacts.
    pub(super) fn laws<T: Real, const NK: usize>(&self, all: &[Law<T>; NK]) -> [Law<T>; CK] {
        let hypothesis = Restitution::Newton;
        let none = Law { friction: T::zero(), stiction: T::zero(), restitution: T::zero(), hypothesis };
        let mut laws = [none; CK];
        for (law, k) in laws.iter_mut().zip(self.contacts.iter()).take(self.count) {
            *law = all.get(*k).copied().unwrap_or(none);
        }
        laws
    }

    /// Returns values of the selected rows at the rows of the mechanism; zeros elsewhere.
    pub(super) fn spread<T: Real, const NR: usize>(&self, rates: &SVector<T, CR>) -> SVector<T, NR> {
        let mut all = SVector::zeros();
        (0..self.size).for_each(|i| put(&mut all, self.rows[i], entry(rates, i)));
        all
    }

    /// Computes the effects of impulses at the selected contacts, and `B` of `W = B Bᵀ` if it is a
    /// by-product.
    pub(super) fn fill_responses<
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
        (t, q): (T, &SVector<T, NQ>),
        closed: &[bool; NK],
        responses: &mut Responses<T, NV, CR>,
        basis: &mut Basis<T, CR>,
    ) where
        T: Real,
        M: Contacts<NQ, NV, NU, NK, NR, Scalar = T>,
    {
        let Responses { velocities, rates } = responses;
        if NR <= FEW {
            let all = mechanism.contact_responses(t, q, closed);
            for (j, (velocities, rates)) in
                velocities.data.0.iter_mut().zip(&mut rates.data.0).enumerate().take(self.size)
            {
                let from = self.rows[j];
                if let (Some(all), Some(changes)) =
                    (all.velocities.data.0.get(from), all.rates.data.0.get(from))
                {
                    *velocities = *all;
                    (0..self.size).for_each(|i| {
                        if let (Some(to), Some(change)) = (rates.get_mut(i), changes.get(self.rows[i])) {
                            *to = *change;
                        }
                    });
                }
            }
            return;
        }
        let jacobian = mechanism.contact_jacobian(t, q);
        let features = mechanism.features();
        let is_plain = !features.constrained && !features.feedback;
        let factor = if is_plain { Factor::factorise(mechanism.mass_matrix(t, q)) } else { None };
        // Rows of the Jacobian.
        let mut own = [[T::zero(); NV]; CR];
        for (own, i) in own.iter_mut().zip(self.rows.iter()).take(self.size) {
            for (entry, column) in own.iter_mut().zip(&jacobian.data.0) {
                *entry = column.get(*i).copied().unwrap_or(T::zero());
            }
        }
        if let Some(factor) = factor {
            // Rows of `B = G L⁻ᵀ`.
            own.iter_mut().take(self.size).for_each(|row| *row = factor.solve_lower(*row));
            for (velocity, row) in velocities.data.0.iter_mut().zip(&own).take(self.size) {
                *velocity = factor.solve_upper(*row);
            }
            self.fill_products(&own, &own, rates);
            basis.set(own.iter().take(self.size));
        } else {
            let still = SVector::zeros();
            let none = mechanism.impulse(t, q, &still, T::zero(), &still);
            for (velocity, own) in velocities.data.0.iter_mut().zip(&own).take(self.size) {
                *velocity =
                    (mechanism.impulse(t, q, &still, T::zero(), &SVector::from(*own)) - none).data.0[0];
            }
            self.fill_products(&own, &velocities.data.0, rates);
        }
    }

    /// Writes the symmetric matrix of the scalar products of rows on the left and on the right; entries of
    /// rows without common columns stay as they are.
    fn fill_products<T: Real, const NV: usize>(
        &self,
        left: &[[T; NV]; CR],
        right: &[[T; NV]; CR],
        products: &mut SMatrix<T, CR, CR>,
    ) {
        let is_same = core::ptr::eq(left, right);
        // Entries of each row that are not zero.
        let mut reach = [(0, 0); CR];
        for (reach, row) in reach.iter_mut().zip(left).take(self.size) {
            let is_any = |entry: &T| *entry != T::zero();
            let from = row.iter().position(is_any).unwrap_or(NV);
            *reach = (from, row.iter().rposition(is_any).map_or(from, |last| last + 1));
        }
        for (j, (other, own)) in right.iter().zip(&reach).enumerate().take(self.size) {
            let (first, last) = if is_same { *own } else { (0, NV) };
            for (i, (row, (from, to))) in left.iter().zip(&reach).enumerate().take(self.size).skip(j) {
                let (from, to) = (first.max(*from), last.min(*to));
                // Contacts of different bodies have no common entries.
                let (Some(row), Some(other)) = (row.get(from..to), other.get(from..to)) else { continue };
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
