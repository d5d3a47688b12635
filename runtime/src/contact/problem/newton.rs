//! Newton's method for the natural map.

use super::super::total::Total;
use super::linear::{identify, square};
use super::trial::{Mode, Trial, component};
use super::{List, Problem, Square};
use crate::Real;
use crate::private::{constant, epsilon};

/// Steps of Newton's method in a round.
const NEWTON: usize = 12;
/// Rows from which on Newton's method ends where a step leaves more than a part of the map, since steps are
/// expensive, and this part.
pub(super) const LARGE: usize = 18;
const SLOW: f64 = 0.25;
/// The shortest part of such a step.
const SHORTEST: f64 = 1e-3;
/// What tells rows apart at first, and then, as a part of them.
const APART: [f64; 2] = [1e-4, 1e-6];

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Newton's method on the natural map, from given impulses: the best that it finds. Steps are halved
    /// until less is left of the map.
    ///
    /// Where several contacts share what one alone could bear, small changes of the equations are large ones
    /// of who bears it, so that rows are told apart by much first.
    pub(super) fn newton_twice(&self, start: Trial<T, NK, NR>) -> Trial<T, NK, NR> {
        let mut best = start;
        for lift in APART {
            best = self.newton(best, constant(lift));
            if self.solves(&best) {
                return best;
            }
        }
        let other = self.newton(start, self.lift());
        if other.worst.0 < best.worst.0 { other } else { best }
    }

    /// [`newton_twice`](Self::newton_twice) from impulses that fulfil the laws with other friction, `before`:
    /// what contacts do then they are taken to do still at first.
    pub(super) fn follow(&self, start: List<T, NR>, before: &Total<T, NK>) -> Trial<T, NK, NR> {
        let mut trial = self.tried(start);
        trial.modes = self.modes(before, &start, &trial.rates);
        self.newton_twice(self.tried(self.stepped(&trial, constant(APART[1]), &mut square())))
    }

    /// Impulses after one more step, if the slowest of those that press are not yet exact to rounding of
    /// their own rate.
    pub(super) fn refined(&self, trial: Trial<T, NK, NR>, lift: T) -> Trial<T, NK, NR> {
        let Trial { impulses, left, worst, .. } = &trial;
        let half = epsilon::<T>().sqrt();
        let little = half * half.sqrt();
        let pressed = (0..self.count).filter(|k| self.is_gap(*k) && impulses[self.of(*k).0] > T::zero());
        if pressed.map(|k| self.free[self.of(k).0].abs() * little).all(|most| worst.0 <= most) {
            return trial;
        }
        let next = self.tried(self.stepped(&trial, lift, &mut square()));
        if next.left < *left { next } else { trial }
    }

    /// Newton's method on the natural map, with steps that are halved until less is left of the map.
    pub(super) fn newton(&self, start: Trial<T, NK, NR>, lift: T) -> Trial<T, NK, NR> {
        let mut trial = start;
        let mut system = square();
        // With more left of the map they are no solution.
        let (speed, parts) = (self.speed(), (0..self.count).fold(T::zero(), |sum, _| sum + constant(3.0)));
        let most = speed * speed * epsilon() * parts;
        for step in 0..NEWTON {
            let before = trial.left;
            let change = self.change(&trial, lift, &mut system);
            let mut part = T::one();
            let next = loop {
                let next = self.tried(moved(&trial.impulses, &change, part));
                if next.left < trial.left {
                    break Some(next);
                }
                part *= constant(0.5);
                if part < constant(SHORTEST) {
                    break None;
                }
            };
            let Some(next) = next else { break };
            trial = next;
            let is_slow = self.size > LARGE && step > 0 && trial.left > before * constant(SLOW);
            if is_slow || (trial.left <= most && self.solves(&trial)) {
                break;
            }
        }
        trial
    }

    /// A whole step of Newton's method, with room for its equations.
    fn stepped(&self, trial: &Trial<T, NK, NR>, lift: T, system: &mut Square<T, NR>) -> List<T, NR> {
        moved(&trial.impulses, &self.change(trial, lift, system), T::one())
    }

    /// What such a step adds to the impulses.
    fn change(&self, trial: &Trial<T, NK, NR>, lift: T, system: &mut Square<T, NR>) -> List<T, NR> {
        let mut right = self.linearise(trial, lift, system).each(|change| [change]);
        self.eliminate(system, &mut right);
        right.each(|[change]| change)
    }

    /// Makes `system` the natural map's derivative; what takes its value away.
    fn linearise(&self, trial: &Trial<T, NK, NR>, lift: T, system: &mut Square<T, NR>) -> List<T, NR> {
        let Trial { impulses, rates, modes, .. } = trial;
        identify(system);
        let mut right = List::repeat(T::zero());
        for k in 0..self.count {
            let (step, press) = (self.step[k] * self.scale, self.press(k));
            let friction = self.friction[k];
            let (n, tangents) = self.of(k);
            let (normal, mode) = modes[k];
            if let Mode::Open = mode {
                self.all_of(k).for_each(|i| right[i] = -impulses[i]);
                continue;
            }
            let presses = normal > T::zero();
            if self.is_gap(k) && !presses {
                right[n] = -impulses[n];
            } else if self.is_gap(k) {
                right[n] = -(step * (rates[n] - self.least[k]));
                system[n] = self.weights[n].each(|weight| step * weight);
                system[n][n] += lift;
            }
            for (c, i) in tangents.clone().enumerate() {
                let Mode::Slip { size, direction } = mode else {
                    right[i] = -(step * rates[i]);
                    system[i] = self.weights[i].each(|weight| step * weight);
                    system[i][i] += lift;
                    continue;
                };
                let radius = friction * self.bearing(k, normal);
                right[i] = -(impulses[i] - radius * component(&direction, c));
                // The row of `Λ − μ d (Λₙ − r uₙ) − (μ Λₙ / |·|) (1 − d dᵀ) (Λₜ − r uₜ)`.
                let along = if presses { friction * component(&direction, c) } else { T::zero() };
                let turn = radius / size;
                let mut row = self.weights[n].each(|weight| along * press * weight);
                row[i] += T::one();
                row[n] -= along;
                for (d, other) in tangents.clone().enumerate() {
                    let unit = if c == d { T::one() } else { T::zero() };
                    let across = turn * (unit - component(&direction, c) * component(&direction, d));
                    let part = across * step;
                    row.iter_mut()
                        .zip(self.weights[other].iter())
                        .for_each(|(x, weight)| *x += part * *weight);
                    row[other] -= across;
                }
                system[i] = row;
            }
        }
        right
    }
}

/// Impulses after a part of a change.
fn moved<T: Real, const NR: usize>(from: &List<T, NR>, change: &List<T, NR>, part: T) -> List<T, NR> {
    let mut to = *from;
    to.iter_mut().zip(change.iter()).for_each(|(to, change)| *to += *change * part);
    to
}
