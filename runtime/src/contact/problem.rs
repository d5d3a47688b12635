//! Impulses of all closed contacts: a complementarity problem with friction cones.

use super::layout::Layout;
use super::selection::FEW;
use super::total::Total;
use super::{Law, Rows, Touch};
use crate::Real;
use crate::private::{constant, epsilon, positive_part};
use core::cell::Cell;
use core::ops::Range;
use nalgebra::{SMatrix, SVector};

mod banded;
mod basis;
mod convex;
mod islands;
mod linear;
mod newton;
mod restitution;
mod search;
mod transport;
mod trial;

pub(super) use basis::{Basis, Columns, dot};
pub(super) use linear::Equations;
use trial::Mode;

/// A number for each rate.
type List<T, const NR: usize> = Total<T, NR>;
/// A row of numbers for each rate.
type Square<T, const NR: usize> = Total<Total<T, NR>, NR>;

/// Maximum length of a displacement that closes gaps, relative to the largest gap or penetration.
const FARTHEST: f64 = 8.0;
/// Number of rows above which the restitution that the energy allows is found less exactly.
const LARGE: usize = 18;
/// Number of iterations of Newton's method in a step of a simulation after which the restitution that the
/// energy allows is not refined further.
const MAX_ITERATIONS: usize = 128;
/// Rounding errors of contact velocities that a solution may leave in the equations.
const ROUNDINGS: f64 = 64.0;

/// Closed contacts, with contact velocities `u = u₀ + W Λ` after impulses `Λ`.
///
/// Closed contacts and their rows have their own numbers: the first `count` and `size` entries of lists are
/// used.
#[derive(Debug)]
pub(super) struct Problem<T, const NK: usize, const NR: usize> {
    /// Index of each contact in the mechanism, and its rows there.
    contacts: Total<(usize, Rows), NK>,
    count: usize,
    /// First row of each contact, and its number of rows.
    rows: Total<Rows, NK>,
    /// Contact whose normal impulse bounds the friction of each contact: the contact itself, except for
    /// friction moments.
    pressed_by: Total<usize, NK>,
    size: usize,
    /// Row of the mechanism for each row.
    places: List<usize, NR>,
    /// Contact velocities without any impulses.
    given: List<T, NR>,
    /// Impulses of compression for Poisson's restitution, and whether there are any.
    compression: List<T, NR>,
    is_compressed: bool,
    /// Impulses of compression, and the smallest impulses of restitution. They act in addition to those that
    /// are searched.
    base: List<T, NR>,
    /// `u₀`: contact velocities with the impulses `base`.
    free: List<T, NR>,
    /// `W`; `None` if it is the product of an exact `B`.
    weights: Option<Square<T, NR>>,
    /// `B` of `W = B Bᵀ`, where it is known.
    pub(super) basis: Basis<T, NR>,
    /// Smallest normal velocity.
    least: Total<T, NK>,
    /// Part of `base` that is an impulse of restitution; it bounds friction as well.
    floor: Total<T, NK>,
    friction: Total<T, NK>,
    /// Coefficients of friction while surfaces slide.
    kinetic: Total<T, NK>,
    /// Step for the contact velocities of a contact, shorter than the inverse of its block of `W`; zero if
    /// impulses move nothing.
    step: Total<T, NK>,
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
    closest: List<T, NR>,
}

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Returns a problem without contacts. The problem of a relaxed step accepts impulses that violate the
    /// contact conditions if it finds no others.
    pub(super) fn empty(is_relaxed: bool) -> Self {
        let none = Rows { first: 0, count: 0 };
        Self {
            contacts: Total::repeat((0, none)),
            count: 0,
            rows: Total::repeat(none),
            pressed_by: Total::repeat(0),
            size: 0,
            places: Total::repeat(0),
            given: Total::repeat(T::zero()),
            compression: Total::repeat(T::zero()),
            is_compressed: false,
            base: Total::repeat(T::zero()),
            free: Total::repeat(T::zero()),
            weights: None,
            basis: Basis::none(),
            least: Total::repeat(T::zero()),
            floor: Total::repeat(T::zero()),
            friction: Total::repeat(T::zero()),
            kinetic: Total::repeat(T::zero()),
            step: Total::repeat(T::zero()),
            velocities: usize::MAX,
            scale: T::one(),
            iterations: Cell::new(0),
            is_relaxed,
            violation: T::zero(),
            closest: Total::repeat(T::zero()),
        }
    }

    /// Returns the problem of closed contacts with contact velocities `free` without impulses.
    pub(super) fn new(
        layout: Layout<NK>,
        laws: &[Law<T>; NK],
        closed: &[bool; NK],
        free: &SVector<T, NR>,
    ) -> Self {
        let mut problem = Self::empty(false);
        problem.select(layout, laws, closed, free);
        problem
    }

    /// Adds the closed contacts to an empty problem. A friction moment is added only if its contact is
    /// closed.
    pub(super) fn select(
        &mut self,
        layout: Layout<NK>,
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
            let (by, _) = layout.pressing(k);
            let known = || (0..c).find(|known| problem.contacts[*known].0 == by);
            let Some(by) = (if by == k { Some(c) } else { known() }) else { continue };
            let of = layout.rows(k);
            problem.contacts[c] = (k, of);
            problem.rows[c] = Rows { first, count: of.count };
            problem.pressed_by[c] = by;
            problem.friction[c] = law.friction;
            problem.kinetic[c] = law.friction;
            for i in 0..of.count {
                problem.places[first + i] = of.first + i;
                problem.free[first + i] = entry(free, of.first + i);
                problem.given[first + i] = problem.free[first + i];
            }
            problem.count += 1;
            problem.size += of.count;
        }
    }

    /// Whether a contact has a gap function, unlike a friction moment.
    fn is_gap(&self, k: usize) -> bool {
        self.pressed_by[k] == k
    }

    /// Returns the row of the normal impulse that bounds friction, and the rows of friction.
    fn of(&self, k: usize) -> (usize, Range<usize>) {
        let Rows { first, count } = self.rows[k];
        (self.rows[self.pressed_by[k]].first, first + usize::from(self.is_gap(k))..first + count)
    }

    /// Returns all rows of a contact.
    fn all_of(&self, k: usize) -> Range<usize> {
        let Rows { first, count } = self.rows[k];
        first..first + count
    }

    /// Returns impulses at the rows of the mechanism, with the impulses `base`.
    pub(super) fn spread(&self, impulses: &List<T, NR>) -> SVector<T, NR> {
        self.scatter(&self.total(impulses))
    }

    /// Returns values of the rows of closed contacts at the rows of the mechanism; zeros elsewhere.
    fn scatter(&self, values: &List<T, NR>) -> SVector<T, NR> {
        let mut all = SVector::<T, NR>::zeros();
        for (place, value) in self.places.iter().zip(values.iter()).take(self.size) {
            put(&mut all, *place, *value);
        }
        all
    }

    /// Returns impulses that satisfy the contact conditions, or in a relaxed step those that violate them
    /// least.
    pub(super) fn relaxed(&self, found: Result<List<T, NR>, usize>) -> Result<List<T, NR>, usize> {
        found.or_else(|contact| if self.is_relaxed { Ok(self.closest) } else { Err(contact) })
    }

    /// Counts an iteration of Newton's method.
    fn count_iteration(&self) {
        self.iterations.set(self.iterations.get().saturating_add(1));
    }

    /// Whether another fraction of the restitution may be tried: in a step their number is bounded.
    pub(super) fn may_refine(&self) -> bool {
        !self.is_relaxed || self.iterations.get() < MAX_ITERATIONS
    }

    /// Returns impulses with those that act in addition.
    pub(super) fn total(&self, impulses: &List<T, NR>) -> List<T, NR> {
        let mut all = *impulses;
        all.iter_mut().zip(self.base.iter()).for_each(|(impulse, base)| *impulse += *base);
        all
    }

    /// Returns the largest violation of the contact conditions by the impulses found last, as a contact
    /// velocity.
    pub(super) fn violation(&self) -> T {
        self.violation
    }

    /// Returns the number of bisections for the restitution that the energy allows: fewer in large problems,
    /// which bounds the duration of a step.
    pub(super) fn halvings(&self) -> usize {
        if self.size > LARGE { 5 } else { 12 }
    }

    /// Whether surfaces approach each other without impulses.
    pub(super) fn is_loaded(&self) -> bool {
        (0..self.count).filter(|k| self.is_gap(*k)).any(|k| self.free[self.rows[k].first] < T::zero())
    }

    /// Whether surfaces approached each other.
    pub(super) fn was_loaded(&self, before: &SVector<T, NR>) -> bool {
        (0..self.count)
            .filter(|k| self.is_gap(*k))
            .any(|k| entry(before, self.contacts[k].1.first) < T::zero())
    }

    /// Sets the violation of the contact conditions to that of impulses found earlier.
    pub(super) fn set_violation(&mut self, violation: T) {
        self.violation = violation;
    }

    /// Sets the number of velocities that determine the contact velocities.
    pub(super) fn depends_on(&mut self, velocities: usize) {
        self.velocities = velocities;
    }

    /// Copies the rows of closed contacts from `W = G M⁻¹ Gᵀ` of all contacts.
    pub(super) fn weigh(&mut self, weights: &SMatrix<T, NR, NR>) {
        let (places, none) = (self.places, T::zero());
        let own = self.weights.insert(linear::square());
        for (j, place) in places.iter().enumerate().take(self.size) {
            let Some(column) = weights.data.0.get(*place) else { continue };
            for (row, i) in own.iter_mut().zip(places.iter()).take(self.size) {
                row[j] = column.get(*i).copied().unwrap_or(none);
            }
        }
        self.set_steps();
    }

    /// Sets the steps of the contact velocities, after `B` or `W`.
    pub(super) fn set_steps(&mut self) {
        let mut diagonal = List::<T, NR>::repeat(T::zero());
        (0..self.size).for_each(|i| diagonal[i] = self.weight(i, i));
        let reach = diagonal.iter().take(self.size).fold(T::zero(), |reach, weight| reach.max(*weight));
        for k in 0..self.count {
            let trace = self.all_of(k).fold(T::zero(), |sum, i| sum + diagonal[i]);
            // Bodies that constraints hold move by rounding errors alone.
            let moves = trace > reach * epsilon::<T>() * constant(ROUNDINGS);
            self.step[k] = if moves { T::one() / trace } else { T::zero() };
        }
    }

    /// Returns an entry of `W`.
    fn weight(&self, i: usize, j: usize) -> T {
        match &self.weights {
            Some(weights) => weights[i][j],
            None => self.basis.product(i, j),
        }
    }

    /// Returns changes of the contact velocities by impulses.
    fn changes(&self, impulses: &List<T, NR>) -> List<T, NR> {
        self.added(List::repeat(T::zero()), impulses)
    }

    /// Returns the contact velocities after impulses.
    fn rates(&self, impulses: &List<T, NR>) -> List<T, NR> {
        self.added(self.free, impulses)
    }

    /// Adds changes by impulses to contact velocities.
    fn added(&self, mut rates: List<T, NR>, impulses: &List<T, NR>) -> List<T, NR> {
        if self.basis.is_exact() {
            let changes = self.basis.rates(&self.basis.velocity(impulses));
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
    fn press(&self, k: usize) -> T {
        self.step[self.pressed_by[k]] * self.scale
    }

    /// Sets the static coefficient of friction at contacts `at_rest`.
    pub(super) fn stick(&mut self, laws: &[Law<T>; NK], at_rest: impl Fn(usize) -> bool) {
        for c in 0..self.count {
            let (k, _) = self.contacts[c];
            if let Some(law) = laws.get(k).filter(|law| law.stiction > law.friction && at_rest(k)) {
                self.friction[c] = law.stiction;
            }
        }
    }

    /// Sets the kinetic coefficient of friction at contacts that leave their static cone with these impulses,
    /// and returns true if there are any.
    pub(super) fn slide(&mut self, impulses: &List<T, NR>) -> bool {
        if (0..self.count).all(|c| self.friction[c] == self.kinetic[c]) {
            return false;
        }
        let (touches, _) = self.touches(impulses);
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

    /// Returns the impulses with the static coefficient of friction where [`stick`](Self::stick) has set it
    /// and surfaces do not slip, and with the kinetic one elsewhere.
    ///
    /// # Errors
    ///
    /// As [`solve`](Self::solve).
    pub(super) fn solve_sticking(&mut self) -> Result<List<T, NR>, usize> {
        loop {
            let impulses = self.solve()?;
            if !self.slide(&impulses) {
                return Ok(impulses);
            }
        }
    }

    /// Returns the mode of each contact under impulses that satisfy the contact conditions, and the unit slip
    /// direction of each sliding contact at its rows.
    pub(super) fn touches(&self, impulses: &List<T, NR>) -> ([Touch; NK], SVector<T, NR>) {
        let (mut touches, mut along) = (Total::<_, NK>::repeat(Touch::Open), SVector::<T, NR>::zeros());
        let rates = self.rates(impulses);
        let modes = self.modes(&self.friction, impulses, &rates);
        // At the edge of the static cone surfaces stick until they move.
        let still = self.rounding(impulses);
        let sticks = |k: usize| {
            let square = self.of(k).1.fold(T::zero(), |sum, i| sum + rates[i] * rates[i]);
            self.friction[k] != self.kinetic[k] && square <= still * still
        };
        for k in 0..self.count {
            let (contact, rows) = self.contacts[k];
            touches[contact] = match modes[k].1 {
                Mode::Open => Touch::Open,
                Mode::Slip { .. } if sticks(k) => Touch::Sticks,
                Mode::Slip { direction, .. } if self.friction[k] > T::zero() => {
                    let start = usize::from(self.is_gap(k));
                    for (place, component) in (rows.first + start..rows.first + rows.count).zip(direction) {
                        put(&mut along, place, -component);
                    }
                    Touch::Slips
                }
                _ => Touch::Sticks,
            };
        }
        (touches.entries(), along)
    }

    /// Returns the rounding error of contact velocities after impulses.
    fn rounding(&self, impulses: &List<T, NR>) -> T {
        let most = match &self.weights {
            Some(weights) => {
                self.free.iter().zip(weights.iter()).take(self.size).fold(T::zero(), |most, (free, row)| {
                    let terms = row.iter().zip(impulses.iter()).take(self.size);
                    let sum = |sum, (weight, impulse): (&T, &T)| sum + (*weight * *impulse).abs();
                    most.max(terms.fold(free.abs(), sum))
                })
            }
            None => self.basis.magnitude(&self.free, impulses),
        };
        (0..self.count).fold(most, |most, k| most.max(self.least[k])) * epsilon() * constant(ROUNDINGS)
    }

    /// Returns the largest contact velocity, without impulses or demanded by restitution.
    pub(super) fn speed(&self) -> T {
        let most = self.free.iter().take(self.size).fold(T::zero(), |most, rate| most.max(rate.abs()));
        (0..self.count).fold(most, |most, k| most.max(self.least[k]))
    }

    /// Returns the distance up to which gaps are not closed.
    fn enough(near: T) -> T {
        (near * constant(1e-2)).max(epsilon::<T>() * constant(16.0))
    }

    /// Whether all distances are so small that [`close`](Self::close) has nothing to do.
    pub(super) fn is_shut(&self, gaps: &SVector<T, NK>, near: T) -> bool {
        let enough = Self::enough(near);
        (0..self.count).filter(|k| self.is_gap(*k)).all(|k| entry(gaps, self.contacts[k].0).abs() <= enough)
    }

    /// Sets `B`, and `W` if `B` is not exact, to those of selected rows of another problem.
    fn weigh_selected<const OK: usize, const OR: usize>(
        &mut self,
        other: &Problem<T, OK, OR>,
        rows: &[usize],
    ) {
        self.basis.select(&other.basis, rows);
        if self.basis.is_exact() {
            return;
        }
        let own = self.weights.insert(linear::square());
        for (row, i) in own.iter_mut().zip(rows) {
            row.iter_mut().zip(rows).for_each(|(to, j)| *to = other.weight(*i, *j));
        }
    }

    /// Returns impulses without friction that close gaps and penetrations as displacements, or `None` if all
    /// are small compared with `near`. Contacts that stay closed and have a gap of at most `reach` are
    /// closed; separating ones penetrate no deeper than before.
    pub(super) fn close(
        &self,
        impulses: &List<T, NR>,
        gaps: &SVector<T, NK>,
        distances: (T, T),
    ) -> Option<SVector<T, NR>> {
        let normals = (0..self.count).filter(|k| self.is_gap(*k)).count();
        // Matrices of normal impulses are smaller.
        match const { NR > FEW && NK > FEW } && normals <= FEW {
            true => self.close_in::<FEW, FEW>(impulses, gaps, distances),
            false => self.close_in::<NK, NR>(impulses, gaps, distances),
        }
    }

    /// [`close`](Self::close) in arrays for up to `GK` contacts and `GR` normal impulses.
    fn close_in<const GK: usize, const GR: usize>(
        &self,
        impulses: &List<T, NR>,
        gaps: &SVector<T, NK>,
        (near, reach): (T, T),
    ) -> Option<SVector<T, NR>> {
        let rates = self.rates(impulses);
        let worst = self.tried_with(*impulses, rates).worst.0;
        // Contacts stay closed if their normal velocity is zero to rounding, whether or not they have an
        // impulse.
        let rest = self.rounding(impulses).max(worst) * constant(ROUNDINGS);
        let (mut kept, mut stay) = (Problem::<T, GK, GR>::empty(true), Total::<_, GK>::repeat(false));
        let (mut overlap, mut distance) = (T::zero(), T::zero());
        let enough = Self::enough(near);
        let mut normals = Total::<_, GR>::repeat(0);
        for k in (0..self.count).filter(|k| self.is_gap(*k)) {
            let n = self.rows[k].first;
            let (contact, _) = self.contacts[k];
            let gap = entry(gaps, contact);
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
        kept.weigh_selected(self, normals.get(..kept.count).unwrap_or_default());
        let spread = |pushes: &List<T, GR>| {
            let mut all = List::<T, NR>::repeat(T::zero());
            normals.iter().zip(pushes.iter()).take(kept.count).for_each(|(n, push)| all[*n] = *push);
            all
        };
        // Longest displacement at a contact.
        let farthest = |pushes: &List<T, GR>| {
            let displacements = self.changes(&spread(pushes));
            displacements.iter().take(self.size).fold(T::zero(), |most, x| most.max(x.abs()))
        };
        let most = overlap.max(distance) * constant(FARTHEST);
        // Equations can contradict each other: gaps of parallel faces differ if a contact has moved to
        // another edge, and one displacement cannot close them all. Open contacts then stay open. If overlaps
        // still differ, the conditions without friction alone decide.
        let is_consistent = |shut: &Total<bool, GK>, pushes: &List<T, GR>| {
            let left = kept.rates(pushes);
            (0..kept.count).all(|c| !shut[c] || left[c].abs() <= enough) && farthest(pushes) <= most
        };
        let mut overlapping = stay;
        (0..kept.count).for_each(|c| overlapping[c] &= kept.free[c] <= enough);
        let mut tried = [stay, overlapping].into_iter().map(|shut| (shut, kept.together(&shut)));
        let found = tried.find(|(shut, pushes)| is_consistent(shut, pushes));
        let mut pushes = found.map_or(List::repeat(T::zero()), |(_, pushes)| pushes);
        let left = kept.rates(&pushes);
        if left.iter().zip(kept.least.iter()).take(kept.size).any(|(gap, least)| *gap < *least - enough) {
            let mut rest = Problem { free: left, ..kept };
            let found = rest.solve();
            let more = rest.relaxed(found).ok()?;
            pushes.iter_mut().zip(more.iter()).for_each(|(push, more)| *push += *more);
            let way = farthest(&pushes);
            if way > most {
                pushes.iter_mut().for_each(|push| *push *= most / way);
            }
        }
        Some(self.scatter(&spread(&pushes)))
    }
}

/// Returns an entry of a vector; past the end zero.
pub(super) fn entry<T: Real, const N: usize>(vector: &SVector<T, N>, k: usize) -> T {
    vector.get(k).copied().unwrap_or(T::zero())
}

/// Sets an entry of a vector; past the end it does nothing.
pub(super) fn put<T: Real, const N: usize>(vector: &mut SVector<T, N>, k: usize, value: T) {
    if let Some(entry) = vector.get_mut(k) {
        *entry = value;
    }
}
