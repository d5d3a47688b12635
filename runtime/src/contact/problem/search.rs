//! How impulses are found that fulfil the laws of all contacts.

use super::{List, Problem};
use crate::Real;
use crate::private::{constant, epsilon};

/// Rounds of sweeps, each followed by Newton's method.
const ROUNDS: usize = 12;
/// Sweeps of the first round; of each later one there are one more.
const SWEEPS: usize = 21;
/// Factors of the steps of the natural map, round by round.
const SCALES: [f64; 5] = [1.0, 8.0, 0.125, 64.0, 1.0 / 64.0];
/// Parts of the angle of friction where nothing else helps.
const DEGREES: u32 = 12;
/// Contacts of which all selections are tried where nothing else helps.
const GUESSED: usize = 6;

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// The impulses.
    ///
    /// # Errors
    ///
    /// The contact of the mechanism whose law is fulfilled least, where more is left than half of the digits.
    pub(in super::super) fn solve(&mut self) -> Result<List<T, NR>, usize> {
        let mut impulses = self.search().map_err(|k| self.contacts[k].0)?;
        // Rounding may have left them beside their cones.
        for k in 0..self.count {
            let (n, tangents) = self.of(k);
            impulses[n] = impulses[n].max(T::zero());
            let most = self.friction[k] * impulses[n];
            let size = tangents.clone().fold(T::zero(), |sum, i| sum + impulses[i] * impulses[i]).sqrt();
            if size > most {
                tangents.for_each(|i| impulses[i] *= most / size);
            }
        }
        Ok(impulses)
    }

    fn search(&mut self) -> Result<List<T, NR>, usize> {
        // Where all stick that approach, there is nothing to search for.
        let mut impulses = self.together(|k| self.free[self.of(k).0] < self.least[self.pressed_by[k]]);
        if self.is_solved(&impulses) {
            return Ok(impulses);
        }
        for round in 0..ROUNDS {
            for _ in 0..SWEEPS + round {
                self.sweep(&mut impulses);
            }
            if self.is_solved(&impulses) {
                return Ok(impulses);
            }
            // Which steps of the map lead to the solution differs.
            let found = self.newton_scaled(impulses, SCALES[round % SCALES.len()]);
            if self.is_solved(&found) {
                return Ok(found);
            }
            if self.residual(&found).0 < self.residual(&impulses).0 {
                impulses = found;
            }
        }
        if self.rebounds() {
            // With less restitution there is an answer.
            return Err(self.residual(&impulses).1);
        }
        if let Some(found) = self.by_degrees() {
            return Ok(found);
        }
        // Where friction is strong, which contacts stay closed is all there is to find.
        for kept in 0_u32..1 << self.count.min(GUESSED) {
            let guess = self.newton(self.together(|k| k >= GUESSED || kept >> k & 1 == 1));
            if self.is_solved(&guess) {
                return Ok(guess);
            }
        }
        let (left, worst) = self.residual(&impulses);
        let size = self.speed() * epsilon::<T>().sqrt();
        if left <= size { Ok(impulses) } else { Err(worst) }
    }

    /// Newton's method with steps of the map by this factor.
    fn newton_scaled(&mut self, impulses: List<T, NR>, scale: f64) -> List<T, NR> {
        self.scale = constant(scale);
        let found = self.newton(impulses);
        self.scale = T::one();
        found
    }

    /// The impulses by way of those with less friction, whose angle grows from none in equal parts.
    fn by_degrees(&mut self) -> Option<List<T, NR>> {
        let friction = self.friction;
        let mut impulses = List::repeat(T::zero());
        for part in 1..=DEGREES {
            let share = constant::<T>(f64::from(part) / f64::from(DEGREES));
            self.friction = if part < DEGREES {
                friction.each(|friction| (friction.atan() * share).tan())
            } else {
                friction
            };
            for _ in 0..SWEEPS {
                self.sweep(&mut impulses);
            }
            for scale in SCALES {
                let found = self.newton_scaled(impulses, scale);
                if self.residual(&found).0 < self.residual(&impulses).0 {
                    impulses = found;
                }
                if self.is_solved(&impulses) {
                    break;
                }
            }
        }
        self.is_solved(&impulses).then_some(impulses)
    }

    /// One sweep of projected Gauss–Seidel: contact after contact is brought onto its law, the others as they are.
    fn sweep(&self, impulses: &mut List<T, NR>) {
        let rate = |impulses: &List<T, NR>, i: usize| {
            let terms = self.weights[i].iter().zip(impulses.iter()).take(self.size);
            terms.fold(self.free[i], |sum, (weight, impulse)| sum + *weight * *impulse)
        };
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
            let (n, tangents) = self.of(k);
            let weight = self.weights[n][n];
            if self.is_gap(k) {
                let normal = impulses[n] - (rate(impulses, n) - self.least[k]) / weight;
                // A gap that its impulse does not move stays as it is.
                impulses[n] = if weight > T::zero() { normal.max(T::zero()) } else { T::zero() };
            }
            let most = self.friction[k] * impulses[n];
            let trace = tangents.clone().fold(T::zero(), |sum, i| sum + self.weights[i][i]);
            if trace <= T::zero() {
                continue;
            }
            let mut wanted = [T::zero(); 2];
            for (w, i) in wanted.iter_mut().zip(tangents.clone()) {
                *w = impulses[i] - rate(impulses, i) / trace;
            }
            let [x, y] = wanted;
            let size = (x * x + y * y).sqrt();
            let part = if size > most { most / size } else { T::one() };
            for (w, i) in wanted.iter().zip(tangents) {
                impulses[i] = *w * part;
            }
        }
    }
}
