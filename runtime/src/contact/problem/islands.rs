//! Groups of contacts that impulses do not couple, such as those of bodies that neither contacts nor joints
//! connect.

use super::super::Rows;
use super::super::stepping::{LARGE, SMALL};
use super::super::total::TotalArray;
use super::linear::ImpulseEquations;
use super::{ContactProblem, RowList};
use crate::Real;

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Returns the group of each contact, and the number of groups.
    pub(super) fn contact_groups(&self) -> (TotalArray<usize, NK>, usize) {
        if self.basis.is_exact() {
            return self.contact_groups_by_columns();
        }
        let (mut group, mut count) = (TotalArray::repeat_entry(usize::MAX), 0);
        let mut reached = TotalArray::<usize, NK>::repeat_entry(0);
        for first in 0..self.count {
            if group[first] != usize::MAX {
                continue;
            }
            (group[first], reached[0]) = (count, first);
            let (mut done, mut size) = (0, 1);
            while done < size {
                let k = reached[done];
                done += 1;
                for other in 0..self.count {
                    if group[other] == usize::MAX && self.are_coupled(k, other) {
                        (group[other], reached[size]) = (count, other);
                        size += 1;
                    }
                }
            }
            count += 1;
        }
        (group, count)
    }

    /// Returns the group of each contact, and the number of groups: contacts with entries in common columns
    /// of `B` are in one group.
    fn contact_groups_by_columns(&self) -> (TotalArray<usize, NK>, usize) {
        // Each column refers to an earlier one of its group, the first one to itself.
        let mut earlier = RowList::<usize, NR>::repeat_entry(0);
        earlier.iter_mut().enumerate().for_each(|(column, earlier)| *earlier = column);
        let root_column = |earlier: &RowList<usize, NR>, mut column: usize| {
            while earlier[column] != column {
                column = earlier[column];
            }
            column
        };
        let mut own = TotalArray::<usize, NK>::repeat_entry(0);
        for k in 0..self.count {
            let mut known = if self.has_gap_function(k) { None } else { Some(own[self.pressed_by[k]]) };
            for i in self.all_rows_of_contact(k) {
                let (start, row) = self.basis.nonzero_part_of_row(i);
                for (column, _) in (start..).zip(row).filter(|(_, entry)| **entry != T::zero()) {
                    let known = known.get_or_insert(column);
                    if earlier[column] == *known {
                        continue;
                    }
                    let (one, other) = (root_column(&earlier, column), root_column(&earlier, *known));
                    *known = one.min(other);
                    earlier[one.max(other)] = *known;
                    earlier[column] = *known;
                }
            }
            own[k] = known.unwrap_or_default();
        }
        let (mut group, mut count) = (TotalArray::repeat_entry(0), 0);
        let mut known = RowList::<usize, NR>::repeat_entry(usize::MAX);
        for k in 0..self.count {
            let column = root_column(&earlier, own[k]);
            if known[column] == usize::MAX {
                known[column] = count;
                count += 1;
            }
            group[k] = known[column];
        }
        (group, count)
    }

    /// Whether impulses at one contact change contact velocities of the other, or press its friction.
    fn are_coupled(&self, k: usize, other: usize) -> bool {
        self.pressed_by[k] == self.pressed_by[other]
            || self.all_rows_of_contact(k).any(|i| {
                self.all_rows_of_contact(other).any(|j| self.delassus_matrix_entry(i, j) != T::zero())
            })
    }

    /// Returns the impulses that are found for each group of contacts alone; the search begins at the
    /// impulses of `start`.
    pub(super) fn solve_groups(
        &self,
        (group, count): &(TotalArray<usize, NK>, usize),
        start: Option<&RowList<T, NR>>,
    ) -> RowList<T, NR> {
        let mut impulses = RowList::repeat_entry(T::zero());
        for g in 0..*count {
            let members = (0..self.count).filter(|k| group[*k] == g);
            let rows = members.fold(0, |rows, k| rows + self.rows[k].count);
            if rows <= SMALL {
                self.solve_island_impulses::<SMALL, SMALL>((group, g), start, &mut impulses);
            } else if const { NR > LARGE } && rows <= LARGE {
                self.solve_island_impulses::<LARGE, LARGE>((group, g), start, &mut impulses);
            } else {
                self.solve_island_impulses::<NK, NR>((group, g), start, &mut impulses);
            }
        }
        impulses
    }

    /// Finds the impulses of one group, in arrays for up to `GK` contacts with `GR` rows.
    #[inline(never)]
    fn solve_island_impulses<const GK: usize, const GR: usize>(
        &self,
        (group, g): (&TotalArray<usize, NK>, usize),
        start: Option<&RowList<T, NR>>,
        impulses: &mut RowList<T, NR>,
    ) {
        let mut own = ContactProblem::<T, GK, GR>::without_contacts(self.is_relaxed);
        for k in (0..self.count).filter(|k| group[*k] == g) {
            let (c, first, Rows { count, .. }) = (own.count, own.size, self.rows[k]);
            let by = (0..c).find(|c| own.contacts[*c].0 == self.pressed_by[k]).unwrap_or(c);
            // Its contacts are those of the whole problem.
            own.contacts[c] = (k, self.rows[k]);
            own.rows[c] = Rows { first, count };
            own.pressed_by[c] = by;
            (own.least[c], own.floor[c]) = (self.least[k], self.floor[k]);
            (own.friction[c], own.kinetic[c], own.step[c]) =
                (self.friction[k], self.kinetic[k], self.step[k]);
            for (i, row) in self.all_rows_of_contact(k).enumerate() {
                own.places[first + i] = row;
                own.free[first + i] = self.free[row];
                own.given[first + i] = self.given[row];
                own.base[first + i] = self.base[row];
            }
            own.count += 1;
            own.size += count;
        }
        let places = own.places;
        own.copy_selected_delassus_rows(self, places.get(..own.size).unwrap_or_default());
        // A part of the velocities, as an estimate.
        own.velocities = (self.velocities.saturating_mul(own.size) / self.size.max(1)).max(1);
        let start = start.map(|start| {
            let mut impulses = RowList::repeat_entry(T::zero());
            (0..own.size).for_each(|i| impulses[i] = start[places[i]]);
            impulses
        });
        let found = own.solve_impulses_from_start(start.as_ref(), &mut ImpulseEquations::new());
        let found = found.unwrap_or(own.closest);
        self.iterations.set(self.iterations.get().saturating_add(own.iterations.get()));
        (0..own.size).for_each(|i| impulses[places[i]] = found[i]);
    }
}
