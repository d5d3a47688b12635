//! Linear equations among the impulses.

use super::super::Touch;
use super::super::total::Total;
use super::{List, Problem, Square, entry};
use crate::Real;
use crate::private::{constant, epsilon};
use nalgebra::SVector;

/// The least part of a diagonal entry that is left for its pivot where impulses are told apart by the motion.
const INDEPENDENT: f64 = 1e-6;

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// The impulses that keep some contacts together and stop their slip: of least norm, where they are shared.
    pub(in super::super) fn together(&self, is_kept: impl Fn(usize) -> bool) -> List<T, NR> {
        // Which rates are held, and at what.
        let (mut held, mut wanted, mut size) =
            (List::<_, NR>::repeat(0), List::<_, NR>::repeat(T::zero()), 0);
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero() && is_kept(*k)) {
            let (n, tangents) = self.of(k);
            let most = if self.friction[k] > T::zero() { tangents.end } else { n + 1 };
            for i in n..most {
                held[size] = i;
                wanted[size] = if i == n { self.least[k] } else { T::zero() };
                size += 1;
            }
        }
        let mut system = square();
        self.among(&held, size, &mut system);
        let reach = held.iter().take(size).fold(T::zero(), |most, i| most.max(self.weights[*i][*i]));
        let mut impulses = List::repeat(T::zero());
        if factorise(&mut system, size, T::zero()) {
            let mut right = List::repeat(T::zero());
            for (r, (i, wanted)) in right.iter_mut().zip(held.iter().zip(*wanted)).take(size) {
                *r = wanted - self.free[*i];
            }
            substitute(&system, size, &mut right);
            held.iter().zip(*right).take(size).for_each(|(i, impulse)| impulses[*i] = impulse);
            return impulses;
        }
        self.among(&held, size, &mut system);
        if !factorise(&mut system, size, reach * self.lift()) {
            return impulses;
        }
        // Impulses that move nothing stay small, and what they leave is made up for.
        for _ in 0..3 {
            let rates = self.rates(&impulses);
            let mut right = List::repeat(T::zero());
            for (r, (i, wanted)) in right.iter_mut().zip(held.iter().zip(*wanted)).take(size) {
                *r = wanted - rates[*i];
            }
            substitute(&system, size, &mut right);
            held.iter().zip(*right).take(size).for_each(|(i, change)| impulses[*i] += change);
        }
        impulses
    }

    /// Whether the motion cannot tell the impulses of these contacts apart; of those that slip it matters for the normal ones.
    pub(in super::super) fn is_redundant(&self, touches: &[Touch; NK]) -> bool {
        let touches = Total::new(*touches, Touch::Open);
        let (mut held, mut size) = (List::<_, NR>::repeat(0), 0);
        for k in (0..self.count).filter(|k| touches[self.contacts[*k].0] != Touch::Open) {
            let (n, tangents) = self.of(k);
            let slips = touches[self.contacts[k].0] == Touch::Slips || self.friction[k] == T::zero();
            for i in n..if slips { n + 1 } else { tangents.end } {
                held[size] = i;
                size += 1;
            }
        }
        let mut system = square();
        self.among(&held, size, &mut system);
        !factorise(&mut system, size, T::zero())
    }

    /// Makes `system` `W` among `size` rates.
    fn among(&self, held: &List<usize, NR>, size: usize, system: &mut Square<T, NR>) {
        for (row, i) in system.iter_mut().zip(held.iter()).take(size) {
            for (entry, j) in row.iter_mut().zip(held.iter()).take(size) {
                *entry = self.weights[*i][*j];
            }
        }
    }

    /// The forces that hold contacts as they are said to be, where impulses are forces and rates accelerations; `rates` are those
    /// of all contacts, along which slip is braked.
    ///
    /// # Errors
    ///
    /// The contact of the mechanism that is held least, where more is left than half of the digits.
    pub(in super::super) fn hold(
        &self,
        touches: &[Touch; NK],
        rates: &SVector<T, NR>,
    ) -> Result<List<T, NR>, usize> {
        let touches = Total::new(*touches, Touch::Open);
        let slips = |k: usize| touches[self.contacts[k].0] == Touch::Slips || self.friction[k] == T::zero();
        let mut forces =
            if (0..self.count).any(slips) { List::repeat(T::zero()) } else { self.together(|_| true) };
        let (places, reach) =
            (self.places(), (0..self.size).fold(T::zero(), |most, i| most.max(self.weights[i][i])));
        // What is left of the equations, and their matrix.
        let equations = |forces: &List<T, NR>, system: &mut Square<T, NR>| {
            identify(system);
            let mut right = List::repeat(T::zero());
            let accelerations = self.rates(forces);
            for k in 0..self.count {
                let (n, tangents) = self.of(k);
                let speed = tangents
                    .clone()
                    .fold(T::zero(), |sum, i| sum + entry(rates, places[i]) * entry(rates, places[i]))
                    .sqrt();
                for i in core::iter::once(n).chain(tangents) {
                    if i == n || !slips(k) {
                        system[i] = self.weights[i];
                        right[i] = -accelerations[i];
                    } else if speed > T::zero() {
                        let share = self.friction[k] * entry(rates, places[i]) / speed;
                        system[i][n] = share;
                        right[i] = -(forces[i] + share * forces[n]);
                    } else {
                        right[i] = -forces[i];
                    }
                }
            }
            right
        };
        let mut system = square();
        for _ in 0..3 {
            let mut right = equations(&forces, &mut system);
            for k in 0..self.count {
                let (n, tangents) = self.of(k);
                for i in core::iter::once(n).chain(tangents).filter(|i| *i == n || !slips(k)) {
                    system[i][i] += reach * self.lift();
                }
            }
            self.eliminate(&mut system, &mut right);
            forces.iter_mut().zip(*right).for_each(|(force, change)| *force += change);
        }
        let left = equations(&forces, &mut system);
        let most = self.rounding(&forces).max(self.speed() * self.lift());
        let is_lost = |k: &usize| {
            // It is where it is no number, too.
            let is_held = left[self.rows[*k].first].abs() <= most;
            !is_held
        };
        match (0..self.count).find(is_lost) {
            Some(k) => Err(self.contacts[k].0),
            None => Ok(forces),
        }
    }

    pub(super) fn lift(&self) -> T {
        epsilon::<T>().sqrt()
    }

    /// Gaussian elimination with pivots of the columns; where there is none, nothing is to be done.
    pub(super) fn eliminate(&self, system: &mut Square<T, NR>, right: &mut List<T, NR>) {
        let size = self.size;
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
            let (pivots, value) = (system[column], right[column]);
            if pivots[column] == T::zero() {
                continue;
            }
            let inverse = T::one() / pivots[column];
            for row in column + 1..size {
                let factor = system[row][column] * inverse;
                if factor == T::zero() {
                    continue;
                }
                for (entry, pivot) in system[row].iter_mut().zip(pivots.iter()).take(size).skip(column + 1) {
                    *entry -= factor * *pivot;
                }
                right[row] -= factor * value;
            }
        }
        for row in (0..size).rev() {
            let sum = (row + 1..size).fold(right[row], |sum, c| sum - system[row][c] * right[c]);
            let pivot = system[row][row];
            right[row] = if pivot == T::zero() { T::zero() } else { sum / pivot };
        }
    }
}

/// Makes `A` into columns of the factor `L` of `A + lift = L Lᵀ` (Cholesky), with the reciprocals of its diagonal; false where rows
/// depend on each other.
fn factorise<T: Real, const NR: usize>(l: &mut Square<T, NR>, size: usize, lift: T) -> bool {
    let mut given = List::<T, NR>::repeat(T::zero());
    given.iter_mut().zip(l.iter().enumerate()).for_each(|(given, (j, row))| *given = row[j]);
    for j in 0..size {
        // What others took is gone from it already.
        let pivot = l[j][j] + lift;
        let is_independent =
            pivot > if lift > T::zero() { T::zero() } else { given[j] * constant(INDEPENDENT) };
        if !is_independent {
            return false;
        }
        let reciprocal = T::one() / pivot.sqrt();
        l[j][j] = reciprocal;
        for entry in l[j].iter_mut().take(size).skip(j + 1) {
            *entry *= reciprocal;
        }
        let column = l[j];
        for i in j + 1..size {
            let part = column[i];
            if part != T::zero() {
                for (entry, other) in l[i].iter_mut().zip(column.iter()).take(size).skip(i) {
                    *entry -= part * *other;
                }
            }
        }
    }
    true
}

/// `x` of `L Lᵀ x = p`, with columns of `L`.
fn substitute<T: Real, const NR: usize>(l: &Square<T, NR>, size: usize, x: &mut List<T, NR>) {
    for j in 0..size {
        let value = x[j] * l[j][j];
        x[j] = value;
        for (entry, part) in x.iter_mut().zip(l[j].iter()).take(size).skip(j + 1) {
            *entry -= value * *part;
        }
    }
    for j in (0..size).rev() {
        let terms = x.iter().zip(l[j].iter()).take(size).skip(j + 1);
        let sum = terms.fold(x[j], |sum, (other, part)| sum - *other * *part);
        x[j] = sum * l[j][j];
    }
}

/// Zeros.
pub(super) fn square<T: Real, const NR: usize>() -> Square<T, NR> {
    Square::repeat(List::repeat(T::zero()))
}

/// Ones on the diagonal, else zeros.
pub(super) fn identify<T: Real, const NR: usize>(system: &mut Square<T, NR>) {
    for (i, row) in system.iter_mut().enumerate() {
        row.fill(T::zero());
        row[i] = T::one();
    }
}
