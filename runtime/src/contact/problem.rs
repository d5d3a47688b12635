//! Impulses of all closed contacts: a complementarity problem with friction cones.

use super::layout::ContactLayout;
use super::selection::FEW;
use super::stepping::LARGE;
use super::total::TotalArray;
use super::{Law, Rows, Touch};
use crate::Real;
use crate::private::{constant, epsilon, positive_part};
use core::cell::Cell;
use core::ops::Range;
use nalgebra::{SMatrix, SVector};

mod banded;
mod basis;
mod convex;
mod elimination;
mod islands;
mod linear;
mod newton;
mod restitution;
mod search;
mod sensitivity;
mod transport;
mod trial;

pub(super) use basis::{DelassusFactor, UsedColumns, dot};
pub(super) use elimination::subtract_multiple;
pub(super) use linear::ImpulseEquations;
pub(super) use sensitivity::LinearisedImpulseEquations;
use trial::ContactMode;

/// List with an entry for each contact velocity.
type RowList<T, const NR: usize> = TotalArray<T, NR>;
/// Square matrix with a row for each contact velocity.
type ContactRowMatrix<T, const NR: usize> = TotalArray<TotalArray<T, NR>, NR>;

/// Maximum length of a displacement that closes gaps, relative to the largest gap or penetration.
const FARTHEST: f64 = 8.0;
/// Number of rows above which the restitution that the energy allows is found less exactly.
const COARSE: usize = 18;
/// Number of iterations of Newton's method in a step of a simulation after which the restitution that the
/// energy allows is not refined further.
const MAX_ITERATIONS: usize = 128;
/// Maximum residual of solved equations, in units of the rounding error of the contact velocities.
const ROUNDINGS: f64 = 64.0;

/// Closed contacts, with contact velocities `u = u₀ + W Λ` after impulses `Λ`.
///
/// Closed contacts and their rows have their own numbers: the first `count` and `size` entries of lists are
/// used.
#[derive(Debug)]
pub(super) struct ContactProblem<T, const NK: usize, const NR: usize> {
    /// Index of each contact in the mechanism, and its rows there.
    contacts: TotalArray<(usize, Rows), NK>,
    count: usize,
    /// First row of each contact, and its number of rows.
    rows: TotalArray<Rows, NK>,
    /// Contact whose normal impulse bounds the friction of each contact: the contact itself, except for
    /// friction moments.
    pressed_by: TotalArray<usize, NK>,
    size: usize,
    /// Row of the mechanism for each row.
    places: RowList<usize, NR>,
    /// Contact velocities without any impulses.
    given: RowList<T, NR>,
    /// Impulses of compression for Poisson's restitution, and whether there are any.
    compression: RowList<T, NR>,
    is_compressed: bool,
    /// Impulses of compression, and the smallest impulses of restitution. They act in addition to those that
    /// are searched.
    base: RowList<T, NR>,
    /// Contact velocities `u₀` after the impulses of the field `base`.
    free: RowList<T, NR>,
    /// Matrix `W` of the velocity changes by unit impulses; `None` if it equals `B Bᵀ` with an exact `B`.
    weights: Option<ContactRowMatrix<T, NR>>,
    /// Factor `B` of `W = B Bᵀ`, if it is known.
    pub(super) basis: DelassusFactor<T, NR>,
    /// Smallest permitted normal velocity after the impulses, of each contact.
    least: TotalArray<T, NK>,
    /// Part of `base` that is an impulse of restitution; it bounds friction as well.
    floor: TotalArray<T, NK>,
    friction: TotalArray<T, NK>,
    /// Coefficients of friction while surfaces slide.
    kinetic: TotalArray<T, NK>,
    /// Step for the contact velocities of a contact, shorter than the inverse of its block of `W`; zero if
    /// impulses move nothing.
    step: TotalArray<T, NK>,
    /// Number of velocities that determine the contact velocities.
    velocities: usize,
    /// Factor of all steps, which affects the convergence of Newton's method.
    scale: T,
    /// Number of iterations of Newton's method so far.
    iterations: Cell<usize>,
    /// Whether impulses that violate the contact conditions are better than none.
    is_relaxed: bool,
    /// Largest violation of the contact conditions by the impulses found last, as a contact velocity.
    violation: T,
    /// Impulses that violate the conditions least, after a search that has found none that satisfy them.
    closest: RowList<T, NR>,
}

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Returns a problem without contacts. The problem of a relaxed step accepts impulses that violate the
    /// contact conditions if it finds no others.
    pub(super) fn without_contacts(is_relaxed: bool) -> Self {
        let none = Rows { first: 0, count: 0 };
        Self {
            contacts: TotalArray::repeat_entry((0, none)),
            count: 0,
            rows: TotalArray::repeat_entry(none),
            pressed_by: TotalArray::repeat_entry(0),
            size: 0,
            places: TotalArray::repeat_entry(0),
            given: TotalArray::repeat_entry(T::zero()),
            compression: TotalArray::repeat_entry(T::zero()),
            is_compressed: false,
            base: TotalArray::repeat_entry(T::zero()),
            free: TotalArray::repeat_entry(T::zero()),
            weights: None,
            basis: DelassusFactor::uncomputed_basis(),
            least: TotalArray::repeat_entry(T::zero()),
            floor: TotalArray::repeat_entry(T::zero()),
            friction: TotalArray::repeat_entry(T::zero()),
            kinetic: TotalArray::repeat_entry(T::zero()),
            step: TotalArray::repeat_entry(T::zero()),
            velocities: usize::MAX,
            scale: T::one(),
            iterations: Cell::new(0),
            is_relaxed,
            violation: T::zero(),
            closest: TotalArray::repeat_entry(T::zero()),
        }
    }

    /// Returns the problem of closed contacts with contact velocities `free` without impulses.
    pub(super) fn new(
        layout: ContactLayout<NK>,
        laws: &[Law<T>; NK],
        closed: &[bool; NK],
        free: &SVector<T, NR>,
    ) -> Self {
        let mut problem = Self::without_contacts(false);
        problem.add_closed_contacts(layout, laws, closed, free);
        problem
    }

    /// Adds the closed contacts to an empty problem. A friction moment is added only if its contact is
    /// closed.
    pub(super) fn add_closed_contacts(
        &mut self,
        layout: ContactLayout<NK>,
        laws: &[Law<T>; NK],
        closed: &[bool; NK],
        free: &SVector<T, NR>,
    ) {
        let problem = self;
        for (k, (law, is_closed)) in laws.iter().zip(closed).enumerate() {
            if !is_closed {
                continue;
            }
            let (c, first) = (problem.count, problem.size);
            let (by, _) = layout.bounding_contact(k);
            let index_of_bounding_contact = || (0..c).find(|known| problem.contacts[*known].0 == by);
            let Some(by) = (if by == k { Some(c) } else { index_of_bounding_contact() }) else { continue };
            let of = layout.rows(k);
            problem.contacts[c] = (k, of);
            problem.rows[c] = Rows { first, count: of.count };
            problem.pressed_by[c] = by;
            problem.friction[c] = law.friction;
            problem.kinetic[c] = law.friction;
            for i in 0..of.count {
                problem.places[first + i] = of.first + i;
                problem.free[first + i] = entry_or_zero(free, of.first + i);
                problem.given[first + i] = problem.free[first + i];
            }
            problem.count += 1;
            problem.size += of.count;
        }
    }

    /// Whether a contact has a gap function, unlike a friction moment.
    fn has_gap_function(&self, k: usize) -> bool {
        self.pressed_by[k] == k
    }

    /// Returns the row of the normal impulse that bounds friction, and the rows of friction.
    fn normal_and_friction_rows(&self, k: usize) -> (usize, Range<usize>) {
        let Rows { first, count } = self.rows[k];
        (self.rows[self.pressed_by[k]].first, first + usize::from(self.has_gap_function(k))..first + count)
    }

    /// Returns all rows of a contact.
    fn all_rows_of_contact(&self, k: usize) -> Range<usize> {
        let Rows { first, count } = self.rows[k];
        first..first + count
    }

    /// Returns the sums of given impulses and the impulses of the field `base`, at the rows of the mechanism.
    pub(super) fn impulses_at_mechanism_rows(&self, impulses: &RowList<T, NR>) -> SVector<T, NR> {
        self.values_at_mechanism_rows(&self.impulses_plus_base(impulses))
    }

    /// Returns values of the rows of closed contacts at the rows of the mechanism; zeros elsewhere.
    fn values_at_mechanism_rows(&self, values: &RowList<T, NR>) -> SVector<T, NR> {
        let mut all = SVector::<T, NR>::zeros();
        for (place, value) in self.places.iter().zip(values.iter()).take(self.size) {
            set_entry(&mut all, *place, *value);
        }
        all
    }

    /// Returns impulses that satisfy the contact conditions, or in a relaxed step those that violate them
    /// least.
    pub(super) fn accept_best_if_relaxed(
        &self,
        found: Result<RowList<T, NR>, usize>,
    ) -> Result<RowList<T, NR>, usize> {
        found.or_else(|contact| if self.is_relaxed { Ok(self.closest) } else { Err(contact) })
    }

    /// Counts an iteration of Newton's method.
    fn count_iteration(&self) {
        self.iterations.set(self.iterations.get().saturating_add(1));
    }

    /// Whether another fraction of the restitution may be tried: in a step their number is bounded.
    pub(super) fn may_refine_restitution(&self) -> bool {
        !self.is_relaxed || self.iterations.get() < MAX_ITERATIONS
    }

    /// Returns impulses with those that act in addition.
    pub(super) fn impulses_plus_base(&self, impulses: &RowList<T, NR>) -> RowList<T, NR> {
        let mut all = *impulses;
        all.iter_mut().zip(self.base.iter()).for_each(|(impulse, base)| *impulse += *base);
        all
    }

    /// Returns the largest violation of the contact conditions by the impulses found last, as a contact
    /// velocity.
    pub(super) fn largest_violation(&self) -> T {
        self.violation
    }

    /// Returns the number of bisections for the restitution that the energy allows: fewer in large problems,
    /// which bounds the duration of a step.
    pub(super) fn max_restitution_bisections(&self) -> usize {
        if self.size > COARSE { 5 } else { 12 }
    }

    /// Whether surfaces approach each other without impulses.
    pub(super) fn do_surfaces_approach(&self) -> bool {
        (0..self.count)
            .filter(|k| self.has_gap_function(*k))
            .any(|k| self.free[self.rows[k].first] < T::zero())
    }

    /// Whether surfaces approached each other.
    pub(super) fn were_surfaces_approaching(&self, before: &SVector<T, NR>) -> bool {
        (0..self.count)
            .filter(|k| self.has_gap_function(*k))
            .any(|k| entry_or_zero(before, self.contacts[k].1.first) < T::zero())
    }

    /// Sets the violation of the contact conditions to that of impulses found earlier.
    pub(super) fn set_violation(&mut self, violation: T) {
        self.violation = violation;
    }

    /// Sets the number of velocities that determine the contact velocities.
    pub(super) fn set_velocity_count(&mut self, velocities: usize) {
        self.velocities = velocities;
    }

    /// Copies the rows of closed contacts from `W = G M⁻¹ Gᵀ` of all contacts.
    pub(super) fn copy_closed_contact_weights(&mut self, weights: &SMatrix<T, NR, NR>) {
        let (places, none) = (self.places, T::zero());
        let own = self.weights.insert(elimination::zero_matrix());
        for (j, place) in places.iter().enumerate().take(self.size) {
            let Some(column) = weights.data.0.get(*place) else { continue };
            for (row, i) in own.iter_mut().zip(places.iter()).take(self.size) {
                row[j] = column.get(*i).copied().unwrap_or(none);
            }
        }
        self.compute_natural_map_steps();
    }

    /// Computes the step size of the natural map for each contact from the diagonal of `W`, which must be
    /// known.
    pub(super) fn compute_natural_map_steps(&mut self) {
        let mut diagonal = RowList::<T, NR>::repeat_entry(T::zero());
        (0..self.size).for_each(|i| diagonal[i] = self.delassus_matrix_entry(i, i));
        let reach = diagonal.iter().take(self.size).fold(T::zero(), |reach, weight| reach.max(*weight));
        for k in 0..self.count {
            let trace = self.all_rows_of_contact(k).fold(T::zero(), |sum, i| sum + diagonal[i]);
            // Bodies that constraints hold move by rounding errors alone.
            let moves = trace > reach * epsilon::<T>() * constant(ROUNDINGS);
            self.step[k] = if moves { T::one() / trace } else { T::zero() };
        }
    }

    /// Returns an entry of `W`.
    fn delassus_matrix_entry(&self, i: usize, j: usize) -> T {
        match &self.weights {
            Some(weights) => weights[i][j],
            None => self.basis.row_product(i, j),
        }
    }

    /// Returns changes of the contact velocities by impulses.
    fn contact_velocity_changes(&self, impulses: &RowList<T, NR>) -> RowList<T, NR> {
        self.add_contact_velocity_changes(RowList::repeat_entry(T::zero()), impulses)
    }

    /// Returns the contact velocities after impulses.
    fn contact_velocities_after(&self, impulses: &RowList<T, NR>) -> RowList<T, NR> {
        self.add_contact_velocity_changes(self.free, impulses)
    }

    /// Adds changes by impulses to contact velocities.
    fn add_contact_velocity_changes(
        &self,
        mut rates: RowList<T, NR>,
        impulses: &RowList<T, NR>,
    ) -> RowList<T, NR> {
        if self.basis.is_exact() {
            let changes = self.basis.rates_of_velocity(&self.basis.velocity_of_impulses(impulses));
            rates.iter_mut().zip(changes.iter()).for_each(|(rate, change)| *rate += *change);
            return rates;
        }
        let Some(weights) = &self.weights else { return rates };
        for (rate, row) in rates.iter_mut().zip(weights.iter()).take(self.size) {
            for (weight, impulse) in row.iter().zip(impulses.iter()).take(self.size) {
                *rate += *weight * *impulse;
            }
        }
        rates
    }

    /// Returns the step of the normal impulse that bounds friction.
    fn normal_impulse_step(&self, k: usize) -> T {
        self.step[self.pressed_by[k]] * self.scale
    }

    /// Sets the static coefficient of friction at contacts `at_rest`.
    pub(super) fn set_static_friction(&mut self, laws: &[Law<T>; NK], at_rest: impl Fn(usize) -> bool) {
        for c in 0..self.count {
            let (k, _) = self.contacts[c];
            if let Some(law) = laws.get(k).filter(|law| law.stiction > law.friction && at_rest(k)) {
                self.friction[c] = law.stiction;
            }
        }
    }

    /// Sets the kinetic coefficient of friction at contacts that leave their static cone with these impulses,
    /// and returns true if there are any.
    pub(super) fn switch_to_kinetic_friction(&mut self, impulses: &RowList<T, NR>) -> bool {
        if (0..self.count).all(|c| self.friction[c] == self.kinetic[c]) {
            return false;
        }
        let (touches, _) = self.contact_modes(impulses);
        let mut slides = false;
        for c in 0..self.count {
            let is_sliding = touches.get(self.contacts[c].0) == Some(&Touch::Slips);
            if is_sliding && self.friction[c] != self.kinetic[c] {
                self.friction[c] = self.kinetic[c];
                slides = true;
            }
        }
        slides
    }

    /// Returns the impulses with the static coefficient of friction where
    /// [`set_static_friction`](Self::set_static_friction) has set it and surfaces do not slip, and with the
    /// kinetic one elsewhere.
    ///
    /// # Errors
    ///
    /// As [`solve`](Self::solve).
    pub(super) fn solve_with_static_friction(&mut self) -> Result<RowList<T, NR>, usize> {
        loop {
            let impulses = self.solve_impulses()?;
            if !self.switch_to_kinetic_friction(&impulses) {
                return Ok(impulses);
            }
        }
    }

    /// Returns the mode of each contact under impulses that satisfy the contact conditions, and the unit slip
    /// direction of each sliding contact at its rows.
    pub(super) fn contact_modes(&self, impulses: &RowList<T, NR>) -> ([Touch; NK], SVector<T, NR>) {
        let (mut touches, mut along) =
            (TotalArray::<_, NK>::repeat_entry(Touch::Open), SVector::<T, NR>::zeros());
        let rates = self.contact_velocities_after(impulses);
        let modes = self.natural_map_modes(&self.friction, impulses, &rates);
        // At the edge of the static cone surfaces stick until they move.
        let still = self.contact_velocity_rounding_error(impulses);
        let is_sticking = |k: usize| {
            let square =
                self.normal_and_friction_rows(k).1.fold(T::zero(), |sum, i| sum + rates[i] * rates[i]);
            self.friction[k] != self.kinetic[k] && square <= still * still
        };
        for k in 0..self.count {
            let (contact, rows) = self.contacts[k];
            touches[contact] = match modes[k].1 {
                ContactMode::Open => Touch::Open,
                ContactMode::Slip { .. } if is_sticking(k) => Touch::Sticks,
                ContactMode::Slip { direction, .. } if self.friction[k] > T::zero() => {
                    let start = usize::from(self.has_gap_function(k));
                    for (place, component) in (rows.first + start..rows.first + rows.count).zip(direction) {
                        set_entry(&mut along, place, -component);
                    }
                    Touch::Slips
                }
                _ => Touch::Sticks,
            };
        }
        (touches.into_entries(), along)
    }

    /// Returns the rounding error of contact velocities after impulses.
    fn contact_velocity_rounding_error(&self, impulses: &RowList<T, NR>) -> T {
        let most = match &self.weights {
            Some(weights) => {
                self.free.iter().zip(weights.iter()).take(self.size).fold(T::zero(), |most, (free, row)| {
                    let terms = row.iter().zip(impulses.iter()).take(self.size);
                    let add_product_magnitude =
                        |sum, (weight, impulse): (&T, &T)| sum + (*weight * *impulse).abs();
                    most.max(terms.fold(free.abs(), add_product_magnitude))
                })
            }
            None => self.basis.largest_term_magnitude_sum(&self.free, impulses),
        };
        (0..self.count).fold(most, |most, k| most.max(self.least[k])) * epsilon() * constant(ROUNDINGS)
    }

    /// Returns the largest contact velocity, without impulses or demanded by restitution.
    pub(super) fn largest_free_contact_velocity(&self) -> T {
        let most = self.free.iter().take(self.size).fold(T::zero(), |most, rate| most.max(rate.abs()));
        (0..self.count).fold(most, |most, k| most.max(self.least[k]))
    }

    /// Returns the distance up to which gaps are not closed.
    fn ignored_distance(near: T) -> T {
        (near * constant(1e-2)).max(epsilon::<T>() * constant(16.0))
    }

    /// Whether all distances are so small that [`gap_closing_impulses`](Self::gap_closing_impulses) has
    /// nothing to do.
    pub(super) fn are_gaps_closed(&self, gaps: &SVector<T, NK>, near: T) -> bool {
        let enough = Self::ignored_distance(near);
        (0..self.count)
            .filter(|k| self.has_gap_function(*k))
            .all(|k| entry_or_zero(gaps, self.contacts[k].0).abs() <= enough)
    }

    /// Sets `B`, and `W` if `B` is not exact, to those of selected rows of another problem.
    fn copy_selected_delassus_rows<const OK: usize, const OR: usize>(
        &mut self,
        other: &ContactProblem<T, OK, OR>,
        rows: &[usize],
    ) {
        self.basis.copy_selected_rows(&other.basis, rows);
        if self.basis.is_exact() {
            return;
        }
        let own = self.weights.insert(elimination::zero_matrix());
        for (row, i) in own.iter_mut().zip(rows) {
            row.iter_mut().zip(rows).for_each(|(to, j)| *to = other.delassus_matrix_entry(*i, *j));
        }
    }

    /// Returns impulses without friction that close gaps and penetrations as displacements, or `None` if all
    /// are small compared with `near`. Contacts that stay closed and have a gap of at most `reach` are
    /// closed; separating ones penetrate no deeper than before.
    pub(super) fn gap_closing_impulses(
        &self,
        impulses: &RowList<T, NR>,
        gaps: &SVector<T, NK>,
        distances: (T, T),
    ) -> Option<SVector<T, NR>> {
        let normals = (0..self.count).filter(|k| self.has_gap_function(*k)).count();
        // Matrices of normal impulses are smaller.
        if const { NR > FEW && NK > FEW } && normals <= FEW {
            self.gap_closing_impulses_with_capacity::<FEW, FEW>(impulses, gaps, distances)
        } else if const { NR > LARGE && NK > LARGE } && normals <= LARGE {
            self.gap_closing_impulses_with_capacity::<LARGE, LARGE>(impulses, gaps, distances)
        } else {
            self.gap_closing_impulses_with_capacity::<NK, NR>(impulses, gaps, distances)
        }
    }

    /// [`gap_closing_impulses`](Self::gap_closing_impulses) in arrays for up to `GK` contacts and `GR` normal
    /// impulses.
    fn gap_closing_impulses_with_capacity<const GK: usize, const GR: usize>(
        &self,
        impulses: &RowList<T, NR>,
        gaps: &SVector<T, NK>,
        (near, reach): (T, T),
    ) -> Option<SVector<T, NR>> {
        let rates = self.contact_velocities_after(impulses);
        let worst = self.trial_with_residuals(*impulses, rates).worst.0;
        // Contacts stay closed if their normal velocity is zero to rounding, whether or not they have an
        // impulse.
        let rest = self.contact_velocity_rounding_error(impulses).max(worst) * constant(ROUNDINGS);
        let (mut kept, mut stay) =
            (ContactProblem::<T, GK, GR>::without_contacts(true), TotalArray::<_, GK>::repeat_entry(false));
        let (mut overlap, mut distance) = (T::zero(), T::zero());
        let enough = Self::ignored_distance(near);
        let mut normals = TotalArray::<_, GR>::repeat_entry(0);
        for k in (0..self.count).filter(|k| self.has_gap_function(*k)) {
            let n = self.rows[k].first;
            let (contact, _) = self.contacts[k];
            let gap = entry_or_zero(gaps, contact);
            // A contact with a larger gap has moved to another place of its surfaces.
            if gap <= reach {
                let c = kept.count;
                stay[c] = rates[n] <= rest;
                if stay[c] {
                    (overlap, distance) = (overlap.max(-gap), distance.max(gap));
                }
                normals[c] = n;
                kept.contacts[c] = (contact, Rows { first: c, count: 1 });
                kept.places[c] = c;
                kept.rows[c] = Rows { first: c, count: 1 };
                kept.pressed_by[c] = c;
                kept.free[c] = gap;
                // Separating surfaces are not displaced, but must not penetrate deeper.
                kept.least[c] = if stay[c] { T::zero() } else { -positive_part(-gap) };
                kept.step[c] = self.step[k];
                kept.count += 1;
            }
        }
        if overlap <= enough && distance <= enough {
            return None;
        }
        kept.size = kept.count;
        kept.copy_selected_delassus_rows(self, normals.get(..kept.count).unwrap_or_default());
        let spread_pushes_to_normal_rows = |pushes: &RowList<T, GR>| {
            let mut all = RowList::<T, NR>::repeat_entry(T::zero());
            normals.iter().zip(pushes.iter()).take(kept.count).for_each(|(n, push)| all[*n] = *push);
            all
        };
        // Longest displacement at a contact.
        let largest_displacement = |pushes: &RowList<T, GR>| {
            let displacements = self.contact_velocity_changes(&spread_pushes_to_normal_rows(pushes));
            displacements.iter().take(self.size).fold(T::zero(), |most, x| most.max(x.abs()))
        };
        let most = overlap.max(distance) * constant(FARTHEST);
        // Equations can contradict each other: gaps of parallel faces differ if a contact has moved to
        // another edge, and one displacement cannot close them all. Open contacts then stay open. If overlaps
        // still differ, the conditions without friction alone decide.
        let closes_chosen_gaps = |shut: &TotalArray<bool, GK>, pushes: &RowList<T, GR>| {
            let left = kept.contact_velocities_after(pushes);
            (0..kept.count).all(|c| !shut[c] || left[c].abs() <= enough)
                && largest_displacement(pushes) <= most
        };
        let mut overlapping = stay;
        (0..kept.count).for_each(|c| overlapping[c] &= kept.free[c] <= enough);
        let mut tried =
            [stay, overlapping].into_iter().map(|shut| (shut, kept.impulses_enforcing_contacts(&shut)));
        let found = tried.find(|(shut, pushes)| closes_chosen_gaps(shut, pushes));
        let mut pushes = found.map_or(RowList::repeat_entry(T::zero()), |(_, pushes)| pushes);
        let left = kept.contact_velocities_after(&pushes);
        if left.iter().zip(kept.least.iter()).take(kept.size).any(|(gap, least)| *gap < *least - enough) {
            let mut rest = ContactProblem { free: left, ..kept };
            let found = rest.solve_impulses();
            let more = rest.accept_best_if_relaxed(found).ok()?;
            pushes.iter_mut().zip(more.iter()).for_each(|(push, more)| *push += *more);
            let way = largest_displacement(&pushes);
            if way > most {
                pushes.iter_mut().for_each(|push| *push *= most / way);
            }
        }
        Some(self.values_at_mechanism_rows(&spread_pushes_to_normal_rows(&pushes)))
    }
}

/// Returns an entry of a vector; past the end zero.
pub(super) fn entry_or_zero<T: Real, const N: usize>(vector: &SVector<T, N>, k: usize) -> T {
    vector.get(k).copied().unwrap_or(T::zero())
}

/// Sets an entry of a vector; past the end it does nothing.
pub(super) fn set_entry<T: Real, const N: usize>(vector: &mut SVector<T, N>, k: usize, value: T) {
    if let Some(entry) = vector.get_mut(k) {
        *entry = value;
    }
}
