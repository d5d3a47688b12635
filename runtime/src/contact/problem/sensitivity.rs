//! Derivatives of impulses, from the conditions that hold with equality in the contact modes that were found.
//!
//! With the contact velocities `u = E + W Λ`, pressed and sticking contacts have `δE + W δΛ = 0` at their
//! rows, separated ones `δΛ = 0`, and sliding ones, with the slip direction `d = −uₜ/|uₜ|`,
//! `δΛₜ = μ d δΛₙ − μ Λₙ (1 − d dᵀ) δuₜ / |uₜ|`.

use super::super::total::TotalArray;
use super::super::{Law, Restitution};
use super::banded::set_unit_rows;
use super::elimination::{independence_threshold, subtract_multiple, zero_matrix};
use super::trial::ContactMode;
use super::{ContactProblem, ContactRowMatrix, RowList, entry_or_zero};
use crate::Real;
use crate::arithmetic::Arithmetic;
use crate::arithmetic::dispatch::{Evaluate, dispatch};
use crate::blocks::zeros;
use crate::private::{constant, epsilon, positive_part};
use nalgebra::{SMatrix, SVector};

/// Number of refinements of equations among dependent rows.
const PASSES: usize = 3;
/// Addition to the diagonal that makes dependent rows independent, relative to the largest entry.
const LIFT: f64 = 1e-6;
/// Violation of the contact conditions, relative to the largest contact velocity, above which impulses have
/// no derivatives.
const VIOLATED: f64 = 1e-6;
/// Largest change of friction by its rotation in a step, relative to its magnitude (`transport`).
const LARGEST: f64 = 0.125;

/// Rows of contact velocities.
pub(in super::super) type ContactRowMask<const NR: usize> = TotalArray<bool, NR>;

/// Friction impulses that a rotation of the slip direction adds, with their derivatives with respect to the
/// impulses at the start and to the slip velocities.
pub(in super::super) struct SlipRotationImpulses<T, const NR: usize> {
    /// Half of the difference of the friction impulses from those against the slip velocities, for contacts
    /// that slide throughout the step; zero in the other rows.
    pub(in super::super) impulses: SVector<T, NR>,
    /// Derivatives of `impulses` with respect to the impulses at the start of the step.
    pub(in super::super) by_impulses: SMatrix<T, NR, NR>,
    /// Derivatives of `impulses` with respect to the slip velocities.
    pub(in super::super) by_slip: SMatrix<T, NR, NR>,
    /// Derivative of each impulse with respect to the coefficient of friction of its contact.
    pub(in super::super) by_friction: SVector<T, NR>,
}

/// Linear equations `system δΛ = wanted δE` of the impulses, with the contact velocities `E` without them.
pub(in super::super) struct LinearisedImpulseEquations<T, const NR: usize> {
    system: ContactRowMatrix<T, NR>,
    wanted: ContactRowMatrix<T, NR>,
    /// Derivative of each friction impulse of a sliding contact with respect to the coefficient of friction,
    /// at constant normal impulses and slip directions.
    by_friction: RowList<T, NR>,
    /// Triangular factors of the system, with a small addition to the diagonal if rows depend on each other,
    /// and the row of each pivot.
    factors: ContactRowMatrix<T, NR>,
    pivots: RowList<usize, NR>,
    is_dependent: bool,
    places: RowList<usize, NR>,
    size: usize,
}

impl<T: Real, const NR: usize> LinearisedImpulseEquations<T, NR> {
    /// Returns equations of impulses that are constant.
    fn new(places: RowList<usize, NR>, size: usize) -> Self {
        let (mut system, pivots) = (zero_matrix(), TotalArray::repeat_entry(0));
        let _ = set_unit_rows(&mut system, size);
        Self {
            system,
            wanted: zero_matrix(),
            by_friction: RowList::repeat_entry(T::zero()),
            factors: zero_matrix(),
            pivots,
            is_dependent: false,
            places,
            size,
        }
    }

    /// Factorises the system by Gaussian elimination with pivots of the columns, and stores the inverses of
    /// the pivots. Impulses without a pivot stay constant. Returns false if rows depend on each other.
    fn factorise_with_pivots(&mut self) -> bool {
        let Self { system, factors, pivots: exchanges, size, .. } = self;
        let mut is_regular = true;
        for column in 0..*size {
            let mut best = column;
            for row in column + 1..*size {
                if factors[row][column].abs() > factors[best][column].abs() {
                    best = row;
                }
            }
            factors.exchange_entries(best, column);
            exchanges[column] = best;
            let mut pivots = factors[column];
            let is_small = pivots[column].abs() <= system[column][column].abs() * independence_threshold();
            is_regular &= !is_small;
            let inverse = if is_small { T::zero() } else { T::one() / pivots[column] };
            (factors[column][column], pivots[column]) = (inverse, inverse);
            for row in column + 1..*size {
                let row = &mut factors[row];
                let factor = row[column] * inverse;
                row[column] = factor;
                if factor != T::zero() {
                    let entries = row.get_mut(column + 1..*size).unwrap_or_default();
                    let others = pivots.get(column + 1..*size).unwrap_or_default();
                    entries.iter_mut().zip(others).for_each(|(entry, pivot)| *entry -= factor * *pivot);
                }
            }
        }
        is_regular
    }

    /// Solves for right-hand sides in place, with the factors.
    #[inline(always)]
    fn solve_with_stored_factors<const C: usize>(&self, right: &mut TotalArray<[T; C], NR>) {
        (0..self.size).for_each(|column| right.exchange_entries(self.pivots[column], column));
        for column in 0..self.size {
            let value = right[column];
            for row in column + 1..self.size {
                let factor = self.factors[row][column];
                if factor != T::zero() {
                    subtract_multiple(&mut right[row], factor, &value);
                }
            }
        }
        for row in (0..self.size).rev() {
            let mut sum = right[row];
            for (factor, other) in self.factors[row].iter().zip(right.iter()).take(self.size).skip(row + 1) {
                subtract_multiple(&mut sum, *factor, other);
            }
            let inverse = self.factors[row][row];
            right[row] = sum.map(|sum| sum * inverse);
        }
    }

    /// Returns the changes of the impulses with changes `rates` of the contact velocities without them, both
    /// at the rows of the mechanism. `friction` holds the changes of the coefficients of friction at the rows
    /// of friction, if they change.
    pub(in super::super) fn impulse_changes<const C: usize>(
        &self,
        rates: &SMatrix<T, NR, C>,
        friction: Option<&SMatrix<T, NR, C>>,
    ) -> SMatrix<T, NR, C> {
        let mut changes = zeros();
        dispatch::<0, T, _, _>(&ImpulseChangeEquations { equations: self, rates, friction }, &mut changes);
        changes
    }
}

/// Equations of impulses with their right-hand sides ([`LinearisedImpulseEquations::impulse_changes`]).
struct ImpulseChangeEquations<'a, T, const NR: usize, const C: usize> {
    equations: &'a LinearisedImpulseEquations<T, NR>,
    rates: &'a SMatrix<T, NR, C>,
    friction: Option<&'a SMatrix<T, NR, C>>,
}

impl<T: Real, const NR: usize, const C: usize> Evaluate<0, &mut SMatrix<T, NR, C>>
    for ImpulseChangeEquations<'_, T, NR, C>
{
    type Output = ();

    #[inline(always)]
    fn evaluate<A: Arithmetic>(&self, all: &mut SMatrix<T, NR, C>) {
        let Self { equations, rates, friction } = self;
        let mut right = TotalArray::<[T; C], NR>::repeat_entry([T::zero(); C]);
        for (right, wanted) in right.iter_mut().zip(equations.wanted.iter()).take(equations.size) {
            for (place, factor) in equations.places.iter().zip(wanted.iter()).take(equations.size) {
                if *factor != T::zero() {
                    let columns = right.iter_mut().zip(&rates.data.0);
                    columns.for_each(|(to, from)| {
                        *to += *factor * from.get(*place).copied().unwrap_or(T::zero())
                    });
                }
            }
        }
        if let Some(friction) = friction {
            let rows = right.iter_mut().zip(equations.places.iter()).zip(equations.by_friction.iter());
            for ((right, place), factor) in rows.take(equations.size) {
                let columns = right.iter_mut().zip(&friction.data.0);
                columns
                    .for_each(|(to, from)| *to += *factor * from.get(*place).copied().unwrap_or(T::zero()));
            }
        }
        let mut changes = right;
        equations.solve_with_stored_factors(&mut changes);
        for _ in 1..if equations.is_dependent { PASSES } else { 1 } {
            let mut left = right;
            for (left, row) in left.iter_mut().zip(equations.system.iter()).take(equations.size) {
                for (factor, change) in row.iter().zip(changes.iter()).take(equations.size) {
                    left.iter_mut().zip(change).for_each(|(left, change)| *left -= *factor * *change);
                }
            }
            equations.solve_with_stored_factors(&mut left);
            for (change, more) in changes.iter_mut().zip(left.iter()) {
                change.iter_mut().zip(more).for_each(|(change, more)| *change += *more);
            }
        }
        for (place, row) in equations.places.iter().zip(changes.iter()).take(equations.size) {
            for (to, change) in all.data.0.iter_mut().zip(row) {
                to.iter_mut().skip(*place).take(1).for_each(|entry| *entry = *change);
            }
        }
    }
}

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Checks that impulses have derivatives.
    ///
    /// # Errors
    ///
    /// The contact with Poisson's restitution, or the one that violates the contact conditions most if the
    /// violation is larger than the errors of the search.
    pub(in super::super) fn check_impulses_are_differentiable(
        &self,
        impulses: &RowList<T, NR>,
    ) -> Result<(), usize> {
        if self.is_compressed {
            let is_contact_compressed = |k: &usize| self.compression[self.rows[*k].first] > T::zero();
            return Err(self.contacts[(0..self.count).find(is_contact_compressed).unwrap_or_default()].0);
        }
        let is_solved = self.violation <= self.largest_free_contact_velocity() * constant(VIOLATED);
        if is_solved { Ok(()) } else { Err(self.contacts[self.evaluate_impulse_trial(*impulses).worst.1].0) }
    }

    /// Returns the linearised equations of impulses, and true if no contact slides or separates. A contact
    /// at the edge of two modes has that of sticking, or of separation.
    pub(in super::super) fn linearised_impulse_equations(
        &self,
        impulses: &RowList<T, NR>,
    ) -> (LinearisedImpulseEquations<T, NR>, bool) {
        let rates = self.contact_velocities_after(impulses);
        let modes = self.natural_map_modes(&self.friction, impulses, &rates);
        let still = self.contact_velocity_rounding_error(impulses);
        let mut equations = LinearisedImpulseEquations::new(self.places, self.size);
        let (mut held, mut is_whole) = (ContactRowMask::repeat_entry(false), true);
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
            let (n, tangents) = self.normal_and_friction_rows(k);
            if self.has_gap_function(k) {
                held[n] = modes[k].0 > T::zero();
                is_whole &= held[n];
            }
            if self.friction[k] == T::zero() {
                continue;
            }
            let speed = tangents.clone().fold(T::zero(), |sum, i| sum + rates[i] * rates[i]).sqrt();
            match modes[k].1 {
                ContactMode::Open => is_whole = false,
                ContactMode::Slip { direction, .. } if speed > still => {
                    let normal = self.friction_bounding_impulse(k, impulses[n]);
                    let ratio = self.friction[k] * normal / speed;
                    self.write_sliding_equations(k, (direction, ratio), &mut equations);
                    for (i, d) in tangents.zip(direction) {
                        equations.by_friction[i] = normal * d;
                    }
                    is_whole = false;
                }
                _ => tangents.for_each(|i| held[i] = true),
            }
        }
        self.factorise_held_row_equations(&held, &mut equations);
        (equations, is_whole)
    }

    /// Writes the equations of a contact that slides in a direction with the ratio of friction to slip
    /// velocity.
    fn write_sliding_equations(
        &self,
        k: usize,
        (direction, ratio): ([T; 2], T),
        LinearisedImpulseEquations { system, wanted, .. }: &mut LinearisedImpulseEquations<T, NR>,
    ) {
        let (n, tangents) = self.normal_and_friction_rows(k);
        for (i, d) in tangents.clone().zip(direction) {
            system[i][n] -= self.friction[k] * d;
            // Along a single tangent the direction does not rotate.
            let others = if tangents.len() == 2 { tangents.clone() } else { 0..0 };
            for (j, other) in others.zip(direction) {
                let across = (if i == j { T::one() } else { T::zero() } - d * other) * ratio;
                wanted[i][j] -= across;
                (0..self.size)
                    .for_each(|column| system[i][column] += across * self.delassus_matrix_entry(j, column));
            }
        }
    }

    /// Returns the equations of impulses that keep the contact velocities of chosen rows constant; of least
    /// norm if these rows depend on each other.
    pub(in super::super) fn velocity_preserving_equations(
        &self,
        held: &ContactRowMask<NR>,
    ) -> LinearisedImpulseEquations<T, NR> {
        let mut equations = LinearisedImpulseEquations::new(self.places, self.size);
        self.factorise_held_row_equations(held, &mut equations);
        equations
    }

    /// Returns all rows in which contacts can have impulses.
    pub(in super::super) fn possible_impulse_row_mask(&self) -> ContactRowMask<NR> {
        let mut rows = ContactRowMask::repeat_entry(false);
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
            let (n, _) = self.normal_and_friction_rows(k);
            self.all_rows_of_contact(k).for_each(|i| rows[i] = i == n || self.friction[k] > T::zero());
        }
        rows
    }

    /// Returns ones at chosen rows, and zeros elsewhere.
    pub(in super::super) fn indicator_of_rows(&self, held: &ContactRowMask<NR>) -> SVector<T, NR> {
        let mut chosen = SVector::<T, NR>::zeros();
        for i in (0..self.size).filter(|i| held[*i]) {
            super::set_entry(&mut chosen, self.places[i], T::one());
        }
        chosen
    }

    /// Returns impulses, without those of compression, at the rows of the mechanism.
    pub(in super::super) fn impulses_without_compression(&self, impulses: &RowList<T, NR>) -> SVector<T, NR> {
        self.values_at_mechanism_rows(impulses)
    }

    /// Adds the equations `W δΛ = −δE` at the rows `held`, and factorises the system.
    fn factorise_held_row_equations(
        &self,
        held: &ContactRowMask<NR>,
        equations: &mut LinearisedImpulseEquations<T, NR>,
    ) {
        let mut count = 0;
        for i in (0..self.size).filter(|i| held[*i]) {
            (0..self.size).for_each(|j| equations.system[i][j] = self.delassus_matrix_entry(i, j));
            equations.wanted[i][i] = -T::one();
            count += 1;
        }
        equations.factors = equations.system;
        equations.is_dependent = count > self.velocities || !equations.factorise_with_pivots();
        if equations.is_dependent {
            equations.factors = equations.system;
            let reach = (0..self.size).fold(T::zero(), |most, i| most.max(self.delassus_matrix_entry(i, i)));
            for i in (0..self.size).filter(|i| held[*i]) {
                equations.factors[i][i] += reach * constant(LIFT);
            }
            equations.factorise_with_pivots();
        }
    }

    /// Returns half of the difference of friction impulses from those against the slip velocities `slip`, for
    /// contacts that slide throughout a step, with its derivatives; as `transport` determines it.
    pub(in super::super) fn friction_correction_for_rotation(
        &self,
        impulses: &SVector<T, NR>,
        slip: &SVector<T, NR>,
    ) -> SlipRotationImpulses<T, NR> {
        let (impulses, slip) = (self.gather_closed_rows(impulses), self.gather_closed_rows(slip));
        let mut found = SlipRotationImpulses {
            impulses: SVector::zeros(),
            by_impulses: SMatrix::zeros(),
            by_slip: SMatrix::zeros(),
            by_friction: SVector::zeros(),
        };
        let half = constant::<T>(0.5);
        for k in (0..self.count).filter(|k| self.friction[*k] > T::zero()) {
            let (n, tangents) = self.normal_and_friction_rows(k);
            let largest = self.friction[k] * impulses[n];
            let speed = tangents.clone().fold(T::zero(), |sum, i| sum + slip[i] * slip[i]).sqrt();
            let deviation_from_sliding_friction = |i: usize| impulses[i] + largest * slip[i] / speed;
            let size = tangents
                .clone()
                .fold(T::zero(), |sum, i| {
                    sum + deviation_from_sliding_friction(i) * deviation_from_sliding_friction(i)
                })
                .sqrt();
            let slides = largest > T::zero() && speed * self.step[k] > largest;
            if !slides || size > largest * constant(LARGEST) {
                continue;
            }
            let mechanism_row_and_column = |i: usize, j: usize| (self.places[i], self.places[j]);
            for i in tangents.clone() {
                let along = slip[i] / speed;
                super::set_entry(&mut found.by_friction, self.places[i], half * impulses[n] * along);
                set_matrix_entry(&mut found.by_impulses, mechanism_row_and_column(i, i), half);
                set_matrix_entry(
                    &mut found.by_impulses,
                    mechanism_row_and_column(i, n),
                    half * self.friction[k] * along,
                );
                for j in tangents.clone() {
                    let delta = if i == j { T::one() } else { T::zero() };
                    let across = delta - along * slip[j] / speed;
                    set_matrix_entry(
                        &mut found.by_slip,
                        mechanism_row_and_column(i, j),
                        half * largest / speed * across,
                    );
                }
            }
            for i in tangents {
                super::set_entry(
                    &mut found.impulses,
                    self.places[i],
                    deviation_from_sliding_friction(i) * half,
                );
            }
        }
        found
    }

    /// Returns, for each contact whose restitution demands a normal velocity, the row of the mechanism and
    /// the derivative of that velocity with respect to the normal velocity before.
    pub(in super::super) fn demand_derivatives_by_velocity(&self, before: &SVector<T, NR>) -> SVector<T, NR> {
        let mut factors = SVector::zeros();
        for k in (0..self.count).filter(|k| self.has_gap_function(*k) && self.least[*k] > T::zero()) {
            let row = self.places[self.rows[k].first];
            super::set_entry(&mut factors, row, self.least[k] / entry_or_zero(before, row));
        }
        factors
    }

    /// Returns, for each contact with Newton's restitution, the derivative of the normal velocity that
    /// restitution demands with respect to the coefficient of restitution.
    pub(in super::super) fn demand_derivatives_by_restitution(
        &self,
        laws: &[Law<T>; NK],
        before: &SVector<T, NR>,
    ) -> SVector<T, NR> {
        let mut factors = SVector::zeros();
        for k in (0..self.count).filter(|k| self.has_gap_function(*k)) {
            let Some(law) = laws.get(self.contacts[k].0) else { continue };
            let row = self.places[self.rows[k].first];
            let approach = positive_part(-entry_or_zero(before, row));
            let is_elastic = law.restitution > T::zero();
            let factor = if is_elastic { self.least[k] / law.restitution } else { approach };
            if law.hypothesis == Restitution::Newton {
                super::set_entry(&mut factors, row, factor);
            }
        }
        factors
    }

    /// Returns the rows of normals whose gaps are zero after the displacement that closes gaps, and those
    /// that it only keeps from penetrating deeper. `pushes` is the displacement, if there is any.
    pub(in super::super) fn closed_and_limited_gap_rows(
        &self,
        impulses: &RowList<T, NR>,
        (gaps, near, reach): (&SVector<T, NK>, T, T),
        pushes: Option<&SVector<T, NR>>,
    ) -> (ContactRowMask<NR>, ContactRowMask<NR>) {
        let rates = self.contact_velocities_after(impulses);
        let rest =
            self.contact_velocity_rounding_error(impulses).max(self.violation) * constant(super::ROUNDINGS);
        let enough = (near * constant(1e-2)).max(epsilon::<T>() * constant(16.0));
        let pushes = pushes.map(|pushes| self.gather_closed_rows(pushes));
        let moved = pushes.map(|pushes| self.contact_velocity_changes(&pushes));
        let (mut closed, mut kept) =
            (ContactRowMask::repeat_entry(false), ContactRowMask::repeat_entry(false));
        for k in (0..self.count).filter(|k| self.has_gap_function(*k) && self.step[*k] > T::zero()) {
            let (n, gap) = (self.rows[k].first, entry_or_zero(gaps, self.contacts[k].0));
            let push = pushes.map_or(T::zero(), |pushes| pushes[n]);
            let left = gap + moved.map_or(T::zero(), |moved| moved[n]);
            let is_shut = left.abs() <= enough.max(gap.abs() * constant(0.5));
            let stays = rates[n] <= rest && gap.abs() <= enough && gap <= reach;
            closed[n] = if push == T::zero() { stays } else { is_shut };
            kept[n] = push != T::zero() && !is_shut;
        }
        (closed, kept)
    }
}

/// Sets an entry of a matrix; past the end it does nothing.
fn set_matrix_entry<T: Real, const N: usize>(matrix: &mut SMatrix<T, N, N>, place: (usize, usize), value: T) {
    if let Some(entry) = matrix.get_mut(place) {
        *entry = value;
    }
}
