//! Linear equations for contact impulses that produce given contact velocities.

use super::super::Touch;
use super::super::total::TotalArray;
use super::banded::set_unit_rows;
use super::basis::ImpulseDerivativeBlock;
use super::elimination::{
    eliminate_with_pivots, factorise_symmetric, row_regularisation, solve_with_stored_factors,
    subtract_multiple, zero_matrix,
};
use super::{ContactProblem, ContactRowMatrix, ROUNDINGS, RowList, entry_or_zero};
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::{SMatrix, SVector};

/// Number of iterative refinements of solutions of regularised equations.
const PASSES: usize = 3;

/// Workspace for the equations of impulses, which keeps the factors of the full matrix `W` for reuse.
#[derive(Clone, Copy)]
pub(in super::super) struct ImpulseEquations<T, const NR: usize> {
    /// Matrix or its factors; `None` before the first use.
    matrix: Option<ContactRowMatrix<T, NR>>,
    content: MatrixContent,
}

#[derive(Clone, Copy, PartialEq)]
enum MatrixContent {
    /// Factors of `W`.
    Factors,
    /// Factors of `W` with a small addition to its diagonal, which makes dependent rows independent.
    Lifted,
    Other,
}

impl<T: Real, const NR: usize> ImpulseEquations<T, NR> {
    /// Returns a workspace that contains no matrix yet.
    pub(in super::super) fn new() -> Self {
        Self { matrix: None, content: MatrixContent::Other }
    }

    /// Returns the matrix as workspace; its content is lost.
    pub(super) fn take_workspace(&mut self) -> &mut ContactRowMatrix<T, NR> {
        self.content = MatrixContent::Other;
        self.matrix.get_or_insert_with(zero_matrix)
    }
}

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Returns the impulses after which the chosen contacts have their demanded normal velocities and no
    /// slip; of least norm if they are not unique.
    pub(in super::super) fn impulses_enforcing_contacts(
        &self,
        kept: &TotalArray<bool, NK>,
    ) -> RowList<T, NR> {
        self.enforcing_impulses_with_workspace(kept, &mut ImpulseEquations::new())
    }

    /// Computes the impulses of [`impulses_enforcing_contacts`](Self::impulses_enforcing_contacts) with a
    /// given workspace.
    pub(super) fn enforcing_impulses_with_workspace(
        &self,
        kept: &TotalArray<bool, NK>,
        equations: &mut ImpulseEquations<T, NR>,
    ) -> RowList<T, NR> {
        let (held, size) = self.rows_with_possible_impulses(kept);
        let mut wanted = RowList::repeat_entry(T::zero());
        for k in (0..self.count).filter(|k| kept[*k] && self.has_gap_function(*k)) {
            wanted[self.normal_and_friction_rows(k).0] = self.least[k];
        }
        self.impulses_for_contact_velocities((&held, size), (&self.free, &wanted), equations, PASSES).0
    }

    /// Returns impulses that change the contact velocities of all contacts by `changes`, and true if they are
    /// unique; otherwise they have the least norm and are less exact.
    pub(in super::super) fn impulses_for_contact_changes(
        &self,
        changes: &SVector<T, NR>,
        equations: &mut ImpulseEquations<T, NR>,
    ) -> (RowList<T, NR>, bool) {
        let (held, size) = self.rows_with_possible_impulses(&TotalArray::repeat_entry(true));
        let mut wanted = RowList::repeat_entry(T::zero());
        for (wanted, place) in wanted.iter_mut().zip(self.places.iter()).take(self.size) {
            *wanted = entry_or_zero(changes, *place);
        }
        self.impulses_for_contact_velocities(
            (&held, size),
            (&RowList::repeat_entry(T::zero()), &wanted),
            equations,
            2,
        )
    }

    /// Returns the rows in which the chosen contacts may have impulses, and their number. Rows of friction
    /// are included only if the contact has friction.
    fn rows_with_possible_impulses(&self, kept: &TotalArray<bool, NK>) -> (RowList<usize, NR>, usize) {
        let (mut held, mut size) = (RowList::repeat_entry(0), 0);
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero() && kept[*k]) {
            let (n, _) = self.normal_and_friction_rows(k);
            let holds = self.friction[k] > T::zero();
            for i in self.all_rows_of_contact(k).filter(|i| *i == n || holds) {
                held[size] = i;
                size += 1;
            }
        }
        (held, size)
    }

    /// Returns impulses in the first `size` rows `held` that change the contact velocities of these rows from
    /// `free` to `wanted`, and true if they are unique. Otherwise they are refined in `passes` passes.
    fn impulses_for_contact_velocities(
        &self,
        (held, size): (&RowList<usize, NR>, usize),
        (free, wanted): (&RowList<T, NR>, &RowList<T, NR>),
        equations: &mut ImpulseEquations<T, NR>,
        passes: usize,
    ) -> (RowList<T, NR>, bool) {
        let ImpulseEquations { matrix, content } = equations;
        let matrix = matrix.get_or_insert_with(zero_matrix);
        let is_whole = size == self.size;
        let mut known = if is_whole { *content } else { MatrixContent::Other };
        if known == MatrixContent::Other {
            self.copy_submatrix(held, size, matrix);
            known = MatrixContent::Factors;
            // More rows than velocities depend on each other.
            if size > self.velocities || !factorise_symmetric(matrix, size, false) {
                self.copy_submatrix(held, size, matrix);
                known = if factorise_symmetric(matrix, size, true) {
                    MatrixContent::Lifted
                } else {
                    MatrixContent::Other
                };
            }
        }
        *content = if is_whole { known } else { MatrixContent::Other };
        let mut impulses = RowList::repeat_entry(T::zero());
        // Impulses that move nothing stay small, and what they leave is made up for.
        let passes = match known {
            MatrixContent::Factors => 1,
            MatrixContent::Lifted => passes,
            _ => 0,
        };
        for pass in 0..passes {
            let rates = if pass == 0 { *free } else { self.add_contact_velocity_changes(*free, &impulses) };
            let mut right = RowList::repeat_entry(T::zero());
            right.iter_mut().zip(held.iter()).take(size).for_each(|(r, i)| *r = wanted[*i] - rates[*i]);
            solve_with_stored_factors(matrix, size, &mut right);
            held.iter().zip(*right).take(size).for_each(|(i, change)| impulses[*i] += change);
        }
        (impulses, known == MatrixContent::Factors)
    }

    /// Whether the contact forces in these modes are not unique. For sliding contacts only normal forces
    /// count.
    pub(in super::super) fn has_nonunique_contact_forces(&self, touches: &[Touch; NK]) -> bool {
        let touches = TotalArray::new(*touches, Touch::Open);
        let (mut held, mut size) = (RowList::<_, NR>::repeat_entry(0), 0);
        for k in (0..self.count).filter(|k| touches[self.contacts[*k].0] != Touch::Open) {
            if self.step[k] == T::zero() {
                return true;
            }
            let (n, _) = self.normal_and_friction_rows(k);
            let slips = touches[self.contacts[k].0] == Touch::Slips || self.friction[k] == T::zero();
            for i in self.all_rows_of_contact(k).filter(|i| *i == n || !slips) {
                held[size] = i;
                size += 1;
            }
        }
        let mut system = zero_matrix();
        self.copy_submatrix(&held, size, &mut system);
        !factorise_symmetric(&mut system, size, false)
    }

    /// Writes the rows and columns of `W` that belong to the first `size` rows `held` into `system`.
    fn copy_submatrix(&self, held: &RowList<usize, NR>, size: usize, system: &mut ContactRowMatrix<T, NR>) {
        if let Some(weights) = self.weights.as_ref().filter(|_| size == self.size) {
            // All of them.
            *system = *weights;
            return;
        }
        for (k, i) in held.iter().enumerate().take(size) {
            for (other, j) in held.iter().enumerate().take(k + 1) {
                let weight = self.delassus_matrix_entry(*i, *j);
                (system[k][other], system[other][k]) = (weight, weight);
            }
        }
    }

    /// Returns the forces that enforce the contact modes `touches`, where impulses are forces and contact
    /// velocities are contact accelerations. `rates` holds the contact velocities of all contacts, whose
    /// direction friction opposes. Sets `has_ill_conditioned_factors` if nothing slips and `W` determines the
    /// forces badly.
    ///
    /// # Errors
    ///
    /// The contact of the mechanism that is held least, where more is left than half of the digits.
    pub(in super::super) fn forces_in_modes(
        &self,
        touches: &[Touch; NK],
        rates: &SVector<T, NR>,
        has_ill_conditioned_factors: &mut bool,
    ) -> Result<RowList<T, NR>, usize> {
        let slips = self.slip_flags_of_contacts(touches);
        let mut forces = RowList::repeat_entry(T::zero());
        if !slips.contains(&true) {
            let mut equations = ImpulseEquations::new();
            forces = self.enforcing_impulses_with_workspace(&TotalArray::repeat_entry(true), &mut equations);
            *has_ill_conditioned_factors = self.has_ill_conditioned_factors(&equations, &forces);
            let (accelerations, most) =
                (self.contact_velocities_after(&forces), self.contact_velocity_rounding_error(&forces));
            if accelerations.iter().take(self.size).all(|left| left.abs() <= most) {
                return Ok(forces);
            }
        }
        let system = self.contact_mode_system_matrix(&slips, rates);
        // What is left of the equations.
        let residual_accelerations = |forces: &RowList<T, NR>| {
            let accelerations = self.contact_velocities_after(forces);
            let mut left = RowList::repeat_entry(T::zero());
            for k in 0..self.count {
                let (n, _) = self.normal_and_friction_rows(k);
                for i in self.all_rows_of_contact(k) {
                    left[i] = match i != n && slips[k] {
                        true => -(forces[i] + system[i][n] * forces[n]),
                        false => -accelerations[i],
                    };
                }
            }
            left
        };
        let refine_forces = |forces: &mut RowList<T, NR>, system: &ContactRowMatrix<T, NR>| {
            for _ in 0..PASSES {
                let right = residual_accelerations(forces);
                let most = self.contact_velocity_rounding_error(forces);
                if right.iter().take(self.size).all(|left| left.abs() <= most) {
                    break;
                }
                let mut right = right.map_entries(|left| [left]);
                self.eliminate_all_rows(&mut { *system }, &mut right);
                forces.iter_mut().zip(*right).for_each(|(force, [change])| *force += change);
            }
        };
        let contact_with_lost_accuracy = |forces: &RowList<T, NR>| {
            let left = residual_accelerations(forces);
            let most = self
                .contact_velocity_rounding_error(forces)
                .max(self.largest_free_contact_velocity() * self.relative_regularisation());
            (0..self.count).filter(|k| self.has_gap_function(*k)).find(|k| {
                // It is where it is no number, too.
                let is_held = left[self.rows[*k].first].abs() <= most;
                !is_held
            })
        };
        refine_forces(&mut forces, &self.regularised_system(&system, &slips));
        if contact_with_lost_accuracy(&forces).is_some() && !self.has_nonunique_contact_forces(touches) {
            // What tells rows apart is more than what the motion does, and is not needed.
            refine_forces(&mut forces, &system);
        }
        match contact_with_lost_accuracy(&forces) {
            Some(k) => Err(self.contacts[k].0),
            None => Ok(forces),
        }
    }

    /// Whether a pivot of the factors of `W` is small compared with its diagonal entry, or the factors are
    /// those of a regularised matrix.
    fn has_ill_conditioned_factors(
        &self,
        equations: &ImpulseEquations<T, NR>,
        forces: &RowList<T, NR>,
    ) -> bool {
        let ImpulseEquations { matrix, content } = equations;
        let least = epsilon::<T>().sqrt().sqrt();
        let reciprocal_pivot_at = |i: usize| matrix.as_ref().map_or(T::zero(), |matrix| matrix[i][i]);
        let is_small_pivot =
            |i: usize| reciprocal_pivot_at(i) * self.delassus_matrix_entry(i, i) * least > T::one();
        // Forces that move light bodies far cancel each other.
        let cancels = self.contact_velocity_rounding_error(forces) * least
            > self.largest_free_contact_velocity() * epsilon() * constant(ROUNDINGS);
        *content != MatrixContent::Factors || cancels || (0..self.size).any(is_small_pivot)
    }

    /// Returns true for contacts that slide or have no friction.
    fn slip_flags_of_contacts(&self, touches: &[Touch; NK]) -> TotalArray<bool, NK> {
        let touches = TotalArray::new(*touches, Touch::Open);
        let mut slips = TotalArray::repeat_entry(false);
        for k in 0..self.count {
            slips[k] = touches[self.contacts[k].0] == Touch::Slips || self.friction[k] == T::zero();
        }
        slips
    }

    /// Returns the matrix of the equations that enforce the contact modes: zero accelerations of sticking
    /// rows, and friction opposite to the slip velocities `rates`.
    fn contact_mode_system_matrix(
        &self,
        slips: &TotalArray<bool, NK>,
        rates: &SVector<T, NR>,
    ) -> ContactRowMatrix<T, NR> {
        let places = self.places;
        let mut system = zero_matrix();
        let _ = set_unit_rows(&mut system, self.size);
        for k in 0..self.count {
            let (n, tangents) = self.normal_and_friction_rows(k);
            let slip_component_at_row = |i: usize| entry_or_zero(rates, places[i]);
            let speed = tangents
                .clone()
                .fold(T::zero(), |sum, i| sum + slip_component_at_row(i) * slip_component_at_row(i))
                .sqrt();
            for i in self.all_rows_of_contact(k) {
                if i == n || !slips[k] {
                    (0..self.size).for_each(|j| system[i][j] = self.delassus_matrix_entry(i, j));
                } else if speed > T::zero() {
                    system[i][n] = self.friction[k] * slip_component_at_row(i) / speed;
                }
            }
        }
        system
    }

    /// Returns the matrix of [`contact_mode_system_matrix`](Self::contact_mode_system_matrix) with a small
    /// regularisation of nearly dependent rows.
    fn regularised_system(
        &self,
        system: &ContactRowMatrix<T, NR>,
        slips: &TotalArray<bool, NK>,
    ) -> ContactRowMatrix<T, NR> {
        let reach = (0..self.size).fold(T::zero(), |most, i| most.max(self.delassus_matrix_entry(i, i)));
        let mut system = *system;
        for k in 0..self.count {
            let (n, _) = self.normal_and_friction_rows(k);
            for i in self.all_rows_of_contact(k).filter(|i| *i == n || !slips[k]) {
                system[i][i] += row_regularisation(self.delassus_matrix_entry(i, i), reach);
            }
        }
        system
    }

    /// Returns the derivatives of the contact forces of [`forces_in_modes`](Self::forces_in_modes) with
    /// respect to the contact accelerations without forces.
    pub(in super::super) fn force_derivatives(
        &self,
        touches: &[Touch; NK],
        rates: &SVector<T, NR>,
    ) -> SMatrix<T, NR, NR> {
        let (slips, places) = (self.slip_flags_of_contacts(touches), self.places);
        if let Some(found) = self.sticking_force_derivatives(&slips) {
            return found;
        }
        let mut system = self.contact_mode_system_matrix(&slips, rates);
        let mut wanted = TotalArray::repeat_entry([T::zero(); NR]);
        for k in 0..self.count {
            let (n, _) = self.normal_and_friction_rows(k);
            for i in self.all_rows_of_contact(k).filter(|i| *i == n || !slips[k]) {
                if let Some(wanted) = wanted[i].get_mut(places[i]) {
                    *wanted = -T::one();
                }
            }
        }
        let mut changes = wanted;
        if self.has_nonunique_contact_forces(touches) {
            changes = TotalArray::repeat_entry([T::zero(); NR]);
            for _ in 0..PASSES {
                let mut right = wanted;
                for i in 0..self.size {
                    (0..self.size).for_each(|j| subtract_multiple(&mut right[i], system[i][j], &changes[j]));
                }
                self.eliminate_all_rows(&mut self.regularised_system(&system, &slips), &mut right);
                for (change, more) in changes.iter_mut().zip(right.iter()) {
                    change.iter_mut().zip(more).for_each(|(change, more)| *change += *more);
                }
            }
        } else {
            self.eliminate_all_rows(&mut system, &mut changes);
        }
        let mut all = SMatrix::<T, NR, NR>::zeros();
        for (column, entries) in all.data.0.iter_mut().enumerate() {
            for (place, change) in places.iter().zip(changes.iter()).take(self.size) {
                if let (Some(entry), Some(change)) = (entries.get_mut(*place), change.get(column)) {
                    *entry = *change;
                }
            }
        }
        all
    }

    /// Returns the derivatives of [`force_derivatives`](Self::force_derivatives) if no contact slides and the
    /// rows are independent: `−W⁻¹`; otherwise `None`.
    fn sticking_force_derivatives(&self, slips: &TotalArray<bool, NK>) -> Option<SMatrix<T, NR, NR>> {
        let sticks_and_responds = |k: usize| !slips[k] && self.step[k] > T::zero();
        let mut system = zero_matrix();
        self.copy_submatrix(&RowList::new(core::array::from_fn(|i| i), 0), self.size, &mut system);
        if !(0..self.count).all(sticks_and_responds) || !factorise_symmetric(&mut system, self.size, false) {
            return None;
        }
        let places = self.places;
        let mut all = SMatrix::<T, NR, NR>::zeros();
        // Rows of all columns at once, which are columns as well.
        let mut changes = [[T::zero(); NR]; NR];
        for (row, place) in changes.iter_mut().zip(places.iter()).take(self.size) {
            if let Some(entry) = row.get_mut(*place) {
                *entry = -T::one();
            }
        }
        let (used, _) = changes.split_at_mut_checked(self.size)?;
        for (j, factors) in system.iter().enumerate().take(self.size) {
            let Some((row, below)) = used.get_mut(j..).and_then(<[_]>::split_first_mut) else { continue };
            row.iter_mut().for_each(|x| *x *= factors[j]);
            for (below, factor) in below.iter_mut().zip(factors.iter().skip(j + 1)) {
                subtract_multiple(below, *factor, row);
            }
        }
        for (j, factors) in system.iter().enumerate().take(self.size).rev() {
            let Some((row, below)) = used.get_mut(j..).and_then(<[_]>::split_first_mut) else { continue };
            for (below, factor) in below.iter().zip(factors.iter().skip(j + 1)) {
                subtract_multiple(row, *factor * factors[j], below);
            }
        }
        for (place, change) in places.iter().zip(used.iter()) {
            if let Some(column) = all.data.0.get_mut(*place) {
                *column = *change;
            }
        }
        Some(all)
    }

    /// Writes `1 + Bᵀ R⁻¹ B` into `matrix`, with the regularisation `R` of nearly dependent rows.
    pub(super) fn fill_regularised_matrix(&self, matrix: &mut ContactRowMatrix<T, NR>) {
        let mut ends = set_unit_rows(matrix, self.basis.column_count());
        let reach = (0..self.size).fold(T::zero(), |most, i| most.max(self.delassus_matrix_entry(i, i)));
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
            let (n, _) = self.normal_and_friction_rows(k);
            let holds = self.friction[k] > T::zero();
            let mut rows = self.all_rows_of_contact(k).filter(|i| *i == n || holds);
            let Some(first) = rows.next() else { continue };
            let mut block = ImpulseDerivativeBlock::new(first);
            rows.for_each(|i| _ = block.push_friction_rows(i..i + 1));
            for (j, i) in self.all_rows_of_contact(k).filter(|i| *i == n || holds).enumerate() {
                block.add_to_entry(
                    j,
                    j,
                    T::one() / row_regularisation(self.delassus_matrix_entry(i, i), reach),
                );
            }
            self.basis.add_projected_block(&block, matrix, &mut ends);
        }
    }

    pub(super) fn relative_regularisation(&self) -> T {
        epsilon::<T>().sqrt()
    }

    /// Solves equations among all rows in place, as [`eliminate_with_pivots`] does.
    fn eliminate_all_rows<const N: usize>(
        &self,
        system: &mut ContactRowMatrix<T, NR>,
        right: &mut TotalArray<[T; N], NR>,
    ) {
        eliminate_with_pivots(system, right, self.size);
    }
}
