//! Newton's method for the natural map.
//!
//! The natural map has as many equations as there are impulses. Its derivative relates the changes of the
//! impulses to those of the contact velocities, `ΔΛ = c − H B Δw`, contact by contact. With `Δw = Bᵀ ΔΛ`, the
//! system `(1 + Bᵀ H B) Δw = Bᵀ c` remains. It is no larger than the velocity, and regular for dependent rows
//! as well. Sticking and pressed contacts have the regularised equation `u + ε ΔΛ = 0`; impulses that no
//! motion depends on then stay the same.

use super::super::total::Total;
use super::banded::{eliminate_banded, identify};
use super::basis::ContactBlock;
use super::convex::PARTS;
use super::linear::square;
use super::search::PATIENCE;
use super::trial::{Mode, Trial};
use super::{List, Problem, Square};
use crate::Real;
use crate::private::{constant, epsilon};

/// Maximum number of iterations.
pub(super) const STEPS: usize = 16;
/// Maximum number of iterations that increase the residual.
const RISES: usize = 3;
/// Part of the residual that a step leaves if it hardly makes progress.
const STALLED: f64 = 0.25;
/// Smallest part of a step that is tried.
const SHORTEST: f64 = 1e-2;

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Returns the best impulses that Newton's method finds. A step is halved until the residual falls; if it
    /// does not, the whole step is taken, a limited number of times; `matrix` is workspace.
    pub(super) fn newton(&self, start: Trial<T, NK, NR>, matrix: &mut Square<T, NR>) -> Trial<T, NK, NR> {
        self.newton_within(STEPS, start, matrix)
    }

    /// Returns the result of [`newton`](Self::newton) after a given number of iterations at most.
    pub(super) fn newton_within(
        &self,
        steps: usize,
        start: Trial<T, NK, NR>,
        matrix: &mut Square<T, NR>,
    ) -> Trial<T, NK, NR> {
        let (mut best, mut rises) = ((start.left, start.impulses), 0);
        let mut trial = start;
        for _ in 0..steps {
            if self.solves(&trial) {
                // Sums of changes accumulate rounding errors.
                trial = self.tried(trial.impulses);
                if self.solves(&trial) {
                    return trial;
                }
            }
            self.count_iteration();
            let change = self.newton_step(&trial, matrix);
            let rates = self.changes(&change);
            let after = |part: T| {
                let impulses = moved(&trial.impulses, &change, part);
                self.tried_with(impulses, moved(&trial.rates, &rates, part))
            };
            let mut next = after(T::one());
            let falls = |next: &Trial<T, NK, NR>| next.left < trial.left;
            if !falls(&next) {
                let (whole, mut part) = (next, T::one());
                while next.left >= trial.left && part > constant(SHORTEST) {
                    part *= constant(0.5);
                    next = after(part);
                }
                if !falls(&next) {
                    rises += 1;
                    next = whole;
                }
            }
            if rises > RISES {
                break;
            }
            let is_stalled = next.left > trial.left * constant(STALLED);
            trial = next;
            if trial.left < best.0 {
                best = (trial.left, trial.impulses);
            }
            if (is_stalled || self.iterations.get() > PATIENCE) && self.is_enough(&trial) {
                break;
            }
        }
        self.tried(best.1)
    }

    /// Returns the result of [`newton`](Self::newton) from impulses that satisfy the contact conditions with
    /// the friction `before`: the first step assumes their contact modes.
    pub(super) fn follow(&self, start: List<T, NR>, before: &Total<T, NK>) -> Trial<T, NK, NR> {
        let mut trial = self.tried(start);
        trial.modes = self.modes(before, &start, &trial.rates);
        let mut matrix = square();
        let change = self.newton_step(&trial, &mut matrix);
        self.newton(self.tried(moved(&start, &change, T::one())), &mut matrix)
    }

    /// Returns the impulses after one more step, if the smallest normal velocities of pressed contacts are
    /// not yet exact to their own rounding errors.
    pub(super) fn refined(&self, trial: Trial<T, NK, NR>, matrix: &mut Square<T, NR>) -> Trial<T, NK, NR> {
        let Trial { impulses, left, worst, .. } = &trial;
        let half = epsilon::<T>().sqrt();
        let little = half * half.sqrt();
        let pressed = (0..self.count).filter(|k| self.is_gap(*k) && impulses[self.of(*k).0] > T::zero());
        if pressed.map(|k| self.free[self.of(k).0].abs() * little).all(|most| worst.0 <= most) {
            return trial;
        }
        let change = self.newton_step(&trial, matrix);
        let next = self.tried(moved(impulses, &change, T::one()));
        if next.left < *left { next } else { trial }
    }

    /// Returns the change of the impulses in a step; `matrix` is workspace.
    fn newton_step(&self, trial: &Trial<T, NK, NR>, matrix: &mut Square<T, NR>) -> List<T, NR> {
        let constant_part = self.impulse_changes(trial, &List::repeat(T::zero()));
        let mut change = self.basis.velocity(&constant_part);
        let mut ends = self.fill_derivative(trial, matrix);
        eliminate_banded(matrix, (&mut change, &mut ends), self.basis.rank());
        self.impulse_changes(trial, &self.basis.rates(&change))
    }

    /// Makes `matrix` `1 + Bᵀ H B`, and returns the index behind the last entry of each row.
    fn fill_derivative(&self, trial: &Trial<T, NK, NR>, matrix: &mut Square<T, NR>) -> List<usize, NR> {
        let mut ends = identify(matrix, self.basis.rank());
        for k in (0..self.count).filter(|k| self.is_gap(*k)) {
            self.basis.add_block(&self.derivative(trial, k), matrix, &mut ends);
        }
        ends
    }

    /// Returns the block of `H` of a contact.
    fn derivative(&self, trial: &Trial<T, NK, NR>, k: usize) -> ContactBlock<T> {
        let presses = self.presses(trial, k);
        let pressed = if presses { self.stiffness(k) } else { T::zero() };
        let mut block = ContactBlock::new(self.of(k).0);
        block.add(0, 0, pressed);
        // Friction moments follow their contact.
        for part in (k..self.count.min(k + PARTS)).filter(|part| self.pressed_by[*part] == k) {
            let tangents = self.of(part).1;
            match trial.modes[part].1 {
                Mode::Open => {}
                Mode::Stick => {
                    let (factor, first) = (self.stiffness(part), block.push(tangents.clone()));
                    (first..first + tangents.len()).for_each(|i| block.add(i, i, factor));
                }
                Mode::Slip { size, direction } => {
                    let first = block.push(tangents.clone());
                    // The friction at its bound follows the normal impulse.
                    for (i, d) in (first..first + tangents.len()).zip(direction) {
                        block.add(i, 0, pressed * self.friction[part] * d);
                    }
                    let (bound, factor) = self.across(trial, part, size);
                    if tangents.len() == 2 && bound > T::zero() {
                        let [x, y] = direction;
                        block.add_product(first, bound / size * factor, [-y, x]);
                    }
                }
            }
        }
        block
    }

    /// Returns the changes of the impulses in a step that changes the contact velocities by `rates`.
    fn impulse_changes(&self, trial: &Trial<T, NK, NR>, rates: &List<T, NR>) -> List<T, NR> {
        let Trial { impulses, rates: now, modes, .. } = trial;
        let mut changes = List::repeat(T::zero());
        for k in 0..self.count {
            let (n, tangents) = self.of(k);
            if self.is_gap(k) {
                changes[n] = match self.presses(trial, k) {
                    true => -(now[n] - self.least[k] + rates[n]) * self.stiffness(k),
                    false => -impulses[n],
                };
            }
            match modes[k].1 {
                Mode::Open => tangents.for_each(|i| changes[i] = -impulses[i]),
                Mode::Stick => {
                    tangents.for_each(|i| changes[i] = -(now[i] + rates[i]) * self.stiffness(k));
                }
                Mode::Slip { size, direction: [x, y] } => {
                    let normal = impulses[n] + changes[n] + self.floor[self.pressed_by[k]];
                    let along = normal * self.friction[k];
                    let i = tangents.start;
                    if tangents.len() == 2 {
                        let (bound, factor) = self.across(trial, k, size);
                        let component = |list: &List<T, NR>| x * list[i + 1] - y * list[i];
                        let across =
                            component(impulses) - (component(now) + bound / size * component(rates)) * factor;
                        changes[i] = x * along - y * across - impulses[i];
                        changes[i + 1] = y * along + x * across - impulses[i + 1];
                    } else {
                        changes[i] = x * along - impulses[i];
                    }
                }
            }
        }
        changes
    }

    /// Whether the natural map has a normal impulse.
    fn presses(&self, trial: &Trial<T, NK, NR>, k: usize) -> bool {
        trial.modes[k].0 > T::zero() && self.step[k] > T::zero()
    }

    /// Returns `1/ε` of a contact.
    fn stiffness(&self, k: usize) -> T {
        self.step[k] * self.scale / self.regularisation()
    }

    /// Returns the largest friction of a slipping contact, whose impulse before the projection has the
    /// magnitude `size`, and the factor of the slip across its direction.
    fn across(&self, trial: &Trial<T, NK, NR>, k: usize, size: T) -> (T, T) {
        let bound = self.friction[k] * self.bearing(k, trial.modes[k].0);
        (bound, self.step[k] * self.scale / (T::one() - bound / size + self.regularisation()))
    }

    /// Returns the regularisation `ε` of an impulse, relative to the trace of its contact's block of `W`: a
    /// step leaves this part of a contact velocity. Smaller values amplify the rounding errors of the
    /// redundant contact velocities of many bodies more.
    fn regularisation(&self) -> T {
        let factor = if self.is_relaxed { constant(64.0) } else { T::one() };
        epsilon::<T>().sqrt() * factor
    }
}

/// Returns values after a part of a change.
fn moved<T: Real, const NR: usize>(from: &List<T, NR>, change: &List<T, NR>, part: T) -> List<T, NR> {
    let mut to = *from;
    to.iter_mut().zip(change.iter()).for_each(|(to, change)| *to += *change * part);
    to
}
