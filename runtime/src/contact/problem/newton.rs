//! Newton's method for the natural map.
//!
//! The natural map has as many equations as there are impulses. Its derivative relates the changes of the
//! impulses to those of the contact velocities, `ΔΛ = c − H B Δw`, contact by contact. With `Δw = Bᵀ ΔΛ`, the
//! system `(1 + Bᵀ H B) Δw = Bᵀ c` remains. It is no larger than the velocity, and regular for dependent rows
//! as well. Sticking and pressed contacts have the regularised equation `u + ε ΔΛ = 0`; impulses that no
//! motion depends on then stay the same.

use super::super::total::Total;
use super::basis::{Combination, add_product};
use super::linear::{eliminate, identify, square};
use super::trial::{Mode, Trial};
use super::{List, Problem, Square};
use crate::Real;
use crate::private::{constant, epsilon};

/// Maximum number of iterations.
const STEPS: usize = 16;
/// Maximum number of iterations that increase the residual.
const RISES: usize = 3;
/// Part of the residual that a step leaves if it hardly makes progress.
const STALLED: f64 = 0.25;
/// Smallest part of a step that is tried.
const SHORTEST: f64 = 1e-2;

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Returns the best impulses that Newton's method finds. A step is halved until the residual falls; if it
    /// does not, the whole step is taken, a limited number of times.
    pub(super) fn newton(&self, start: Trial<T, NK, NR>) -> Trial<T, NK, NR> {
        let (mut trial, mut best, mut rises) = (start, start, 0);
        let mut matrix = square();
        for _ in 0..STEPS {
            if self.solves(&trial) {
                // Sums of changes accumulate rounding errors.
                trial = self.tried(trial.impulses);
                if self.solves(&trial) {
                    return trial;
                }
            }
            let change = self.newton_step(&trial, &mut matrix);
            let rates = self.changes(&change);
            let after = |part: T| {
                let impulses = moved(&trial.impulses, &change, part);
                self.tried_with(impulses, moved(&trial.rates, &rates, part))
            };
            let whole = after(T::one());
            let (mut next, mut part) = (whole, T::one());
            while next.left >= trial.left && part > constant(SHORTEST) {
                part *= constant(0.5);
                next = after(part);
            }
            let falls = next.left < trial.left;
            if !falls {
                rises += 1;
                next = whole;
            }
            if rises > RISES {
                break;
            }
            let is_stalled = next.left > trial.left * constant(STALLED);
            trial = next;
            if trial.left < best.left {
                best = trial;
            }
            if is_stalled && self.is_enough(&trial) {
                break;
            }
        }
        self.tried(best.impulses)
    }

    /// Returns the result of [`newton`](Self::newton) from impulses that satisfy the contact conditions with
    /// the friction `before`: the first step assumes their contact modes.
    pub(super) fn follow(&self, start: List<T, NR>, before: &Total<T, NK>) -> Trial<T, NK, NR> {
        let mut trial = self.tried(start);
        trial.modes = self.modes(before, &start, &trial.rates);
        let change = self.newton_step(&trial, &mut square());
        self.newton(self.tried(moved(&start, &change, T::one())))
    }

    /// Returns the impulses after one more step, if the smallest normal velocities of pressed contacts are
    /// not yet exact to their own rounding errors.
    pub(super) fn refined(&self, trial: Trial<T, NK, NR>) -> Trial<T, NK, NR> {
        let Trial { impulses, left, worst, .. } = &trial;
        let half = epsilon::<T>().sqrt();
        let little = half * half.sqrt();
        let pressed = (0..self.count).filter(|k| self.is_gap(*k) && impulses[self.of(*k).0] > T::zero());
        if pressed.map(|k| self.free[self.of(k).0].abs() * little).all(|most| worst.0 <= most) {
            return trial;
        }
        let change = self.newton_step(&trial, &mut square());
        let next = self.tried(moved(impulses, &change, T::one()));
        if next.left < *left { next } else { trial }
    }

    /// Returns the change of the impulses in a step; `matrix` is workspace.
    fn newton_step(&self, trial: &Trial<T, NK, NR>, matrix: &mut Square<T, NR>) -> List<T, NR> {
        let constant_part = self.impulse_changes(trial, &List::repeat(T::zero()));
        let mut change = self.basis.velocity(&constant_part).each(|x| [x]);
        self.fill_derivative(trial, matrix);
        eliminate(matrix, &mut change, self.basis.rank());
        self.impulse_changes(trial, &self.basis.rates(&change.each(|[x]| x)))
    }

    /// Makes `matrix` `1 + Bᵀ H B`.
    fn fill_derivative(&self, trial: &Trial<T, NK, NR>, matrix: &mut Square<T, NR>) {
        let (one, none) = (T::one(), T::zero());
        identify(matrix, self.basis.rank());
        let row = |i: usize| self.basis.row(i);
        for k in (0..self.count).filter(|k| self.is_gap(*k)) {
            let (n, _) = self.of(k);
            let presses = self.presses(trial, k);
            // Direction of the normal impulse, and of the friction at its bound.
            let mut along = Combination::<T, NR>::zero();
            if presses {
                along.add(one, row(n));
            }
            for part in (k..self.count).filter(|part| self.pressed_by[*part] == k) {
                let tangents = self.of(part).1;
                match trial.modes[part].1 {
                    Mode::Open => {}
                    Mode::Stick => {
                        let factor = self.stiffness(part);
                        tangents.for_each(|i| add_product(matrix, factor, row(i), row(i)));
                    }
                    Mode::Slip { size, direction } => {
                        if presses {
                            for (i, d) in tangents.clone().zip(direction) {
                                along.add(self.friction[part] * d, row(i));
                            }
                        }
                        let (bound, factor) = self.across(trial, part, size);
                        if tangents.len() == 2 && bound > none {
                            let ([x, y], mut across) = (direction, Combination::<T, NR>::zero());
                            across.add(-y, row(tangents.start));
                            across.add(x, row(tangents.start + 1));
                            add_product(matrix, bound / size * factor, across.row(), across.row());
                        }
                    }
                }
            }
            if presses {
                add_product(matrix, self.stiffness(k), along.row(), row(n));
            }
        }
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
