//! Linear equations among the impulses.

use super::super::Touch;
use super::super::total::Total;
use super::banded::identify;
use super::basis::ContactBlock;
use super::{List, Problem, ROUNDINGS, Square, entry};
use crate::Real;
use crate::private::{constant, epsilon};
use core::ops::Range;
use nalgebra::{SMatrix, SVector};

/// Rows that are lighter than this part of the heaviest are told apart by a little of their own, so that it
/// stays little beside them.
const ALIKE: f64 = 256.0;

/// Length of rows that are subtracted as a whole.
const SHORT: usize = 36;

/// How often what is left of equations that were told apart by a little is made up for.
const PASSES: usize = 3;

/// Room for the equations of impulses, which keeps the factors of the whole of `W`.
#[derive(Clone, Copy)]
pub(in super::super) struct Equations<T, const NR: usize> {
    /// `None` before its first use.
    matrix: Option<Square<T, NR>>,
    content: Content,
}

#[derive(Clone, Copy, PartialEq)]
enum Content {
    /// Factors of `W`.
    Factors,
    /// Factors of `W` with a small addition to its diagonal, which makes dependent rows independent.
    Lifted,
    Other,
}

impl<T: Real, const NR: usize> Equations<T, NR> {
    /// Returns workspace without content.
    pub(in super::super) fn new() -> Self {
        Self { matrix: None, content: Content::Other }
    }

    /// Returns the matrix as workspace; its content is lost.
    pub(super) fn workspace(&mut self) -> &mut Square<T, NR> {
        self.content = Content::Other;
        self.matrix.get_or_insert_with(square)
    }
}

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// The impulses that keep some contacts together and stop their slip: of least norm, where they are
    /// shared.
    pub(in super::super) fn together(&self, kept: &Total<bool, NK>) -> List<T, NR> {
        self.together_with(kept, &mut Equations::new())
    }

    /// [`together`](Self::together) with given equations.
    pub(super) fn together_with(
        &self,
        kept: &Total<bool, NK>,
        equations: &mut Equations<T, NR>,
    ) -> List<T, NR> {
        let (held, size) = self.held_rows(kept);
        let mut wanted = List::repeat(T::zero());
        for k in (0..self.count).filter(|k| kept[*k] && self.is_gap(*k)) {
            wanted[self.of(k).0] = self.least[k];
        }
        self.reach((&held, size), (&self.free, &wanted), equations, PASSES).0
    }

    /// Returns impulses that change the contact velocities of all contacts by `changes`, and true if they are
    /// unique; otherwise they have the least norm and are less exact.
    pub(in super::super) fn impulses_for(
        &self,
        changes: &SVector<T, NR>,
        equations: &mut Equations<T, NR>,
    ) -> (List<T, NR>, bool) {
        let (held, size) = self.held_rows(&Total::repeat(true));
        let mut wanted = List::repeat(T::zero());
        for (wanted, place) in wanted.iter_mut().zip(self.places.iter()).take(self.size) {
            *wanted = entry(changes, *place);
        }
        self.reach((&held, size), (&List::repeat(T::zero()), &wanted), equations, 2)
    }

    /// Rows in which some contacts may have impulses, and their number: those of friction only where there is
    /// friction.
    fn held_rows(&self, kept: &Total<bool, NK>) -> (List<usize, NR>, usize) {
        let (mut held, mut size) = (List::repeat(0), 0);
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero() && kept[*k]) {
            let (n, _) = self.of(k);
            let holds = self.friction[k] > T::zero();
            for i in self.all_of(k).filter(|i| *i == n || holds) {
                held[size] = i;
                size += 1;
            }
        }
        (held, size)
    }

    /// Returns impulses in the first `size` rows `held` that change the contact velocities of these rows from
    /// `free` to `wanted`, and true if they are unique. Otherwise they are refined in `passes` passes.
    fn reach(
        &self,
        (held, size): (&List<usize, NR>, usize),
        (free, wanted): (&List<T, NR>, &List<T, NR>),
        equations: &mut Equations<T, NR>,
        passes: usize,
    ) -> (List<T, NR>, bool) {
        let Equations { matrix, content } = equations;
        let matrix = matrix.get_or_insert_with(square);
        let is_whole = size == self.size;
        let mut known = if is_whole { *content } else { Content::Other };
        if known == Content::Other {
            self.among(held, size, matrix);
            known = Content::Factors;
            // More rows than velocities depend on each other.
            if size > self.velocities || !factorise(matrix, size, false) {
                self.among(held, size, matrix);
                known = if factorise(matrix, size, true) { Content::Lifted } else { Content::Other };
            }
        }
        *content = if is_whole { known } else { Content::Other };
        let mut impulses = List::repeat(T::zero());
        // Impulses that move nothing stay small, and what they leave is made up for.
        let passes = match known {
            Content::Factors => 1,
            Content::Lifted => passes,
            _ => 0,
        };
        for pass in 0..passes {
            let rates = if pass == 0 { *free } else { self.added(*free, &impulses) };
            let mut right = List::repeat(T::zero());
            right.iter_mut().zip(held.iter()).take(size).for_each(|(r, i)| *r = wanted[*i] - rates[*i]);
            substitute(matrix, size, &mut right);
            held.iter().zip(*right).take(size).for_each(|(i, change)| impulses[*i] += change);
        }
        (impulses, known == Content::Factors)
    }

    /// Whether the motion cannot tell the impulses of these contacts apart; of those that slip it matters for
    /// the normal ones.
    pub(in super::super) fn is_redundant(&self, touches: &[Touch; NK]) -> bool {
        let touches = Total::new(*touches, Touch::Open);
        let (mut held, mut size) = (List::<_, NR>::repeat(0), 0);
        for k in (0..self.count).filter(|k| touches[self.contacts[*k].0] != Touch::Open) {
            if self.step[k] == T::zero() {
                return true;
            }
            let (n, _) = self.of(k);
            let slips = touches[self.contacts[k].0] == Touch::Slips || self.friction[k] == T::zero();
            for i in self.all_of(k).filter(|i| *i == n || !slips) {
                held[size] = i;
                size += 1;
            }
        }
        let mut system = square();
        self.among(&held, size, &mut system);
        !factorise(&mut system, size, false)
    }

    /// Makes `system` `W` among `size` rates.
    fn among(&self, held: &List<usize, NR>, size: usize, system: &mut Square<T, NR>) {
        if let Some(weights) = self.weights.as_ref().filter(|_| size == self.size) {
            // All of them.
            *system = *weights;
            return;
        }
        for (k, i) in held.iter().enumerate().take(size) {
            for (other, j) in held.iter().enumerate().take(k + 1) {
                let weight = self.weight(*i, *j);
                (system[k][other], system[other][k]) = (weight, weight);
            }
        }
    }

    /// Returns the forces that enforce the contact modes `touches`, where impulses are forces and contact
    /// velocities are contact accelerations. `rates` holds the contact velocities of all contacts, whose
    /// direction friction opposes. Sets `loses_digits` if nothing slips and `W` determines the forces badly.
    ///
    /// # Errors
    ///
    /// The contact of the mechanism that is held least, where more is left than half of the digits.
    pub(in super::super) fn hold(
        &self,
        touches: &[Touch; NK],
        rates: &SVector<T, NR>,
        loses_digits: &mut bool,
    ) -> Result<List<T, NR>, usize> {
        let slips = self.slipping(touches);
        let mut forces = List::repeat(T::zero());
        if !slips.contains(&true) {
            let mut equations = Equations::new();
            forces = self.together_with(&Total::repeat(true), &mut equations);
            *loses_digits = self.loses_digits(&equations, &forces);
            let (accelerations, most) = (self.rates(&forces), self.rounding(&forces));
            if accelerations.iter().take(self.size).all(|left| left.abs() <= most) {
                return Ok(forces);
            }
        }
        let system = self.held_system(&slips, rates);
        // What is left of the equations.
        let left = |forces: &List<T, NR>| {
            let accelerations = self.rates(forces);
            let mut left = List::repeat(T::zero());
            for k in 0..self.count {
                let (n, _) = self.of(k);
                for i in self.all_of(k) {
                    left[i] = match i != n && slips[k] {
                        true => -(forces[i] + system[i][n] * forces[n]),
                        false => -accelerations[i],
                    };
                }
            }
            left
        };
        let refine = |forces: &mut List<T, NR>, system: &Square<T, NR>| {
            for _ in 0..PASSES {
                let right = left(forces);
                let most = self.rounding(forces);
                if right.iter().take(self.size).all(|left| left.abs() <= most) {
                    break;
                }
                let mut right = right.each(|left| [left]);
                self.eliminate(&mut { *system }, &mut right);
                forces.iter_mut().zip(*right).for_each(|(force, [change])| *force += change);
            }
        };
        let lost = |forces: &List<T, NR>| {
            let left = left(forces);
            let most = self.rounding(forces).max(self.speed() * self.lift());
            (0..self.count).filter(|k| self.is_gap(*k)).find(|k| {
                // It is where it is no number, too.
                let is_held = left[self.rows[*k].first].abs() <= most;
                !is_held
            })
        };
        refine(&mut forces, &self.lifted(&system, &slips));
        if lost(&forces).is_some() && !self.is_redundant(touches) {
            // What tells rows apart is more than what the motion does, and is not needed.
            refine(&mut forces, &system);
        }
        match lost(&forces) {
            Some(k) => Err(self.contacts[k].0),
            None => Ok(forces),
        }
    }

    /// Whether factors of `W` have pivots that are little of what they were, or are no factors of `W` itself.
    fn loses_digits(&self, equations: &Equations<T, NR>, forces: &List<T, NR>) -> bool {
        let Equations { matrix, content } = equations;
        let least = epsilon::<T>().sqrt().sqrt();
        let pivot = |i: usize| matrix.as_ref().map_or(T::zero(), |matrix| matrix[i][i]);
        let is_small = |i: usize| pivot(i) * self.weight(i, i) * least > T::one();
        // Forces that move light bodies far cancel each other.
        let cancels = self.rounding(forces) * least > self.speed() * epsilon() * constant(ROUNDINGS);
        *content != Content::Factors || cancels || (0..self.size).any(is_small)
    }

    /// Which contacts slip, or have no friction that would hold them.
    fn slipping(&self, touches: &[Touch; NK]) -> Total<bool, NK> {
        let touches = Total::new(*touches, Touch::Open);
        let mut slips = Total::repeat(false);
        for k in 0..self.count {
            slips[k] = touches[self.contacts[k].0] == Touch::Slips || self.friction[k] == T::zero();
        }
        slips
    }

    /// The matrix of the equations that hold contacts: rates of those that are held, and friction against the
    /// slip `rates`.
    fn held_system(&self, slips: &Total<bool, NK>, rates: &SVector<T, NR>) -> Square<T, NR> {
        let places = self.places;
        let mut system = square();
        let _ = identify(&mut system, self.size);
        for k in 0..self.count {
            let (n, tangents) = self.of(k);
            let slip = |i: usize| entry(rates, places[i]);
            let speed = tangents.clone().fold(T::zero(), |sum, i| sum + slip(i) * slip(i)).sqrt();
            for i in self.all_of(k) {
                if i == n || !slips[k] {
                    (0..self.size).for_each(|j| system[i][j] = self.weight(i, j));
                } else if speed > T::zero() {
                    system[i][n] = self.friction[k] * slip(i) / speed;
                }
            }
        }
        system
    }

    /// The matrix of [`held_system`](Self::held_system) where rates that depend on each other are told apart
    /// by a little.
    fn lifted(&self, system: &Square<T, NR>, slips: &Total<bool, NK>) -> Square<T, NR> {
        let reach = (0..self.size).fold(T::zero(), |most, i| most.max(self.weight(i, i)));
        let mut system = *system;
        for k in 0..self.count {
            let (n, _) = self.of(k);
            for i in self.all_of(k).filter(|i| *i == n || !slips[k]) {
                system[i][i] += lift(self.weight(i, i), reach);
            }
        }
        system
    }

    /// By how much the forces that [`hold`](Self::hold) contacts change with each of the rates that they have
    /// without forces.
    pub(in super::super) fn answers(
        &self,
        touches: &[Touch; NK],
        rates: &SVector<T, NR>,
    ) -> SMatrix<T, NR, NR> {
        let (slips, places) = (self.slipping(touches), self.places);
        if let Some(found) = self.answers_of_independent(&slips) {
            return found;
        }
        let mut system = self.held_system(&slips, rates);
        let mut wanted = Total::repeat([T::zero(); NR]);
        for k in 0..self.count {
            let (n, _) = self.of(k);
            for i in self.all_of(k).filter(|i| *i == n || !slips[k]) {
                if let Some(wanted) = wanted[i].get_mut(places[i]) {
                    *wanted = -T::one();
                }
            }
        }
        let mut changes = wanted;
        if self.is_redundant(touches) {
            changes = Total::repeat([T::zero(); NR]);
            for _ in 0..PASSES {
                let mut right = wanted;
                for i in 0..self.size {
                    (0..self.size).for_each(|j| subtract(&mut right[i], system[i][j], &changes[j]));
                }
                self.eliminate(&mut self.lifted(&system, &slips), &mut right);
                for (change, more) in changes.iter_mut().zip(right.iter()) {
                    change.iter_mut().zip(more).for_each(|(change, more)| *change += *more);
                }
            }
        } else {
            self.eliminate(&mut system, &mut changes);
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

    /// [`answers`](Self::answers) where nothing slips and the motion tells all rates apart: `−W⁻¹`.
    fn answers_of_independent(&self, slips: &Total<bool, NK>) -> Option<SMatrix<T, NR, NR>> {
        let is_plain = |k: usize| !slips[k] && self.step[k] > T::zero();
        let mut system = square();
        self.among(&List::new(core::array::from_fn(|i| i), 0), self.size, &mut system);
        if !(0..self.count).all(is_plain) || !factorise(&mut system, self.size, false) {
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
                subtract(below, *factor, row);
            }
        }
        for (j, factors) in system.iter().enumerate().take(self.size).rev() {
            let Some((row, below)) = used.get_mut(j..).and_then(<[_]>::split_first_mut) else { continue };
            for (below, factor) in below.iter().zip(factors.iter().skip(j + 1)) {
                subtract(row, *factor * factors[j], below);
            }
        }
        for (place, change) in places.iter().zip(used.iter()) {
            if let Some(column) = all.data.0.get_mut(*place) {
                *column = *change;
            }
        }
        Some(all)
    }

    /// Makes `matrix` `1 + Bᵀ R⁻¹ B`, with the regularisation `R` of rows that may depend on each other.
    pub(super) fn fill_regularised(&self, matrix: &mut Square<T, NR>) {
        let mut ends = identify(matrix, self.basis.rank());
        let reach = (0..self.size).fold(T::zero(), |most, i| most.max(self.weight(i, i)));
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
            let (n, _) = self.of(k);
            let holds = self.friction[k] > T::zero();
            let mut rows = self.all_of(k).filter(|i| *i == n || holds);
            let Some(first) = rows.next() else { continue };
            let mut block = ContactBlock::new(first);
            rows.for_each(|i| _ = block.push(i..i + 1));
            for (j, i) in self.all_of(k).filter(|i| *i == n || holds).enumerate() {
                block.add(j, j, T::one() / lift(self.weight(i, i), reach));
            }
            self.basis.add_block(&block, matrix, &mut ends);
        }
    }

    pub(super) fn lift(&self) -> T {
        epsilon::<T>().sqrt()
    }

    /// Solves a system among all rows in place, as [`eliminate`] does.
    fn eliminate<const N: usize>(&self, system: &mut Square<T, NR>, right: &mut Total<[T; N], NR>) {
        eliminate(system, right, self.size);
    }
}

/// Solves a system of `size` equations in place by Gaussian elimination with pivots of the columns, for
/// several right-hand sides. Unknowns without a pivot are zero.
pub(super) fn eliminate<T: Real, const N: usize, const NR: usize>(
    system: &mut Square<T, NR>,
    right: &mut Total<[T; N], NR>,
    size: usize,
) {
    for column in 0..size {
        let mut best = column;
        for row in column + 1..size {
            if system[row][column].abs() > system[best][column].abs() {
                best = row;
            }
        }
        if best != column {
            system.exchange(best, column);
            right.exchange(best, column);
        }
        let (done, rows) = system.split_at_mut_checked(column + 1).unwrap_or_default();
        let (values, others) = right.split_at_mut_checked(column + 1).unwrap_or_default();
        let (Some(pivots), Some(value)) = (done.last(), values.last()) else { break };
        if pivots[column] == T::zero() {
            continue;
        }
        let inverse = T::one() / pivots[column];
        for (row, other) in rows.iter_mut().zip(others).take(size - column - 1) {
            let factor = row[column] * inverse;
            if factor == T::zero() {
                continue;
            }
            // Entries before the pivot are not read again.
            remove(row, factor, pivots, column + 1..size);
            subtract(other, factor, value);
        }
    }
    for row in (0..size).rev() {
        let mut sum = right[row];
        (row + 1..size).for_each(|c| subtract(&mut sum, system[row][c], &right[c]));
        let pivot = system[row][row];
        right[row] = sum.map(|sum| if pivot == T::zero() { T::zero() } else { sum / pivot });
    }
}

/// The least part of a diagonal entry that is left for its pivot where impulses are told apart by the motion:
/// where bodies of very different masses touch little is left, but more than rounding would leave of nothing.
/// `ε^(5/8)`.
fn independent<T: Real>() -> T {
    let half = epsilon::<T>().sqrt();
    half * half.sqrt().sqrt()
}

/// By how much a row is told apart from others on which it depends; `weight` is its entry on the diagonal,
/// `reach` the largest.
fn lift<T: Real>(weight: T, reach: T) -> T {
    let own = (weight * constant(ALIKE)).min(reach) * epsilon::<T>().sqrt();
    own.max(reach * epsilon::<T>() * constant(ROUNDINGS))
}

/// Makes `A` into rows of `U` of `A = Uᵀ D U` (Cholesky without roots), each times its entry of `D`, with the
/// reciprocals of `D` on the diagonal; false where rows depend on each other, unless they are told apart by a
/// little.
fn factorise<T: Real, const NR: usize>(u: &mut Square<T, NR>, size: usize, is_lifted: bool) -> bool {
    let mut given = List::<T, NR>::repeat(T::zero());
    given.iter_mut().zip(u.iter().enumerate()).for_each(|(given, (j, row))| *given = row[j]);
    let reach = given.iter().take(size).fold(T::zero(), |most, weight| most.max(*weight));
    let part = independent::<T>();
    for j in 0..size {
        // What others took is gone from it already.
        let (pivot, least) = match is_lifted {
            true => (u[j][j] + lift(given[j], reach), T::zero()),
            false => (u[j][j], given[j] * part),
        };
        let is_independent = pivot > least;
        if !is_independent {
            return false;
        }
        let reciprocal = T::one() / pivot;
        u[j][j] = reciprocal;
        let (done, rows) = u.split_at_mut_checked(j + 1).unwrap_or_default();
        let Some(row) = done.last() else { break };
        for (below, part) in rows.iter_mut().zip(row.iter().skip(j + 1)).take(size - j - 1) {
            if *part != T::zero() {
                remove(below, *part * reciprocal, row, j + 1..size);
            }
        }
    }
    true
}

/// `x` of `Uᵀ D U x = p`, with the rows that [`factorise`] makes.
fn substitute<T: Real, const NR: usize>(u: &Square<T, NR>, size: usize, x: &mut List<T, NR>) {
    for j in 0..size {
        let value = x[j] * u[j][j];
        take(x, value, &u[j], j + 1..size);
        x[j] = value;
    }
    for j in (0..size).rev() {
        let (row, rest) = (&u[j], j + 1..size);
        let terms = x.get(rest.clone()).unwrap_or_default().iter().zip(row.get(rest).unwrap_or_default());
        let sum = terms.fold(T::zero(), |sum, (other, part)| sum + *other * *part);
        x[j] -= sum * row[j];
    }
}

/// Takes a part of a multiple of a row from another.
fn take<T: Real, const N: usize>(from: &mut List<T, N>, factor: T, row: &List<T, N>, part: Range<usize>) {
    let entries = from.get_mut(part.clone()).unwrap_or_default();
    entries
        .iter_mut()
        .zip(row.get(part).unwrap_or_default())
        .for_each(|(from, entry)| *from -= factor * *entry);
}

/// Subtracts a part of a multiple of a row from another. Short rows are subtracted as a whole, since their
/// number of entries is known at compile time; the entries outside of the part must not matter.
fn remove<T: Real, const N: usize>(from: &mut List<T, N>, factor: T, row: &List<T, N>, part: Range<usize>) {
    if const { N <= SHORT } { subtract(from, factor, row) } else { take(from, factor, row, part) }
}

/// Takes a multiple of a row from another.
fn subtract<T: Real, const N: usize>(from: &mut [T; N], factor: T, row: &[T; N]) {
    from.iter_mut().zip(row).for_each(|(from, entry)| *from -= factor * *entry);
}

/// Zeros.
pub(super) fn square<T: Real, const NR: usize>() -> Square<T, NR> {
    Square::repeat(List::repeat(T::zero()))
}
