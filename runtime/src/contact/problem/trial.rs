//! Impulses on trial: what they make of the rates, and what is left of the laws of contacts then.

use super::super::total::Total;
use super::{List, Problem};
use crate::Real;
use crate::private::{epsilon, positive_part};

/// What the natural map makes of a contact.
#[derive(Clone, Copy)]
pub(super) enum Mode<T> {
    /// No impulse.
    Open,
    /// No slip.
    Stick,
    /// Impulses along the tangents of this size, in this direction, before they were brought onto the cone.
    Slip { size: T, direction: [T; 2] },
}

/// Of each contact the impulse of its gap before it is made zero or more, and what follows.
pub(super) type Modes<T, const NK: usize> = Total<(T, Mode<T>), NK>;

/// Impulses, and what follows from them.
#[derive(Clone, Copy)]
pub(super) struct Trial<T, const NK: usize, const NR: usize> {
    pub(super) impulses: List<T, NR>,
    /// The rates with them.
    pub(super) rates: List<T, NR>,
    pub(super) modes: Modes<T, NK>,
    /// The square of what is left of the natural map, as rates.
    pub(super) left: T,
    /// The most that is left of the equations of a contact, as a rate, and of which.
    pub(super) worst: (T, usize),
}

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Returns impulses with the contact velocities after them, and their residuals.
    pub(super) fn tried(&self, impulses: List<T, NR>) -> Trial<T, NK, NR> {
        self.tried_with(impulses, self.rates(&impulses))
    }

    /// Returns impulses and given contact velocities after them, with their residuals.
    pub(super) fn tried_with(&self, impulses: List<T, NR>, rates: List<T, NR>) -> Trial<T, NK, NR> {
        let modes = self.modes(&self.friction, &impulses, &rates);
        let (mut all, mut worst) = (T::zero(), (T::zero(), 0));
        for k in 0..self.count {
            let step = self.step[k] * self.scale;
            let left = if step == T::zero() {
                // Nothing that impulses could do.
                if self.is_gap(k) {
                    positive_part(self.least[k] - rates[self.rows[k].first])
                } else {
                    T::zero()
                }
            } else {
                let [normal, x, y] = self.map(k, modes[k], &impulses, &rates);
                all += (normal * normal + x * x + y * y) / (step * step);
                normal.abs().max((x * x + y * y).sqrt()) / step
            };
            // What is not a number is worst of all.
            let less = left <= worst.0;
            if !less {
                worst = (left, k);
            }
        }
        Trial { impulses, rates, modes, left: all, worst }
    }

    /// Whether no more is left of the laws than rounding of the impulses makes; impulses without bounds solve
    /// nothing.
    pub(super) fn solves(&self, trial: &Trial<T, NK, NR>) -> bool {
        let left = trial.worst.0;
        left <= self.speed() * epsilon::<T>().sqrt() && left <= self.rounding(&trial.impulses)
    }

    /// What the natural map makes of contacts with this friction.
    pub(super) fn modes(
        &self,
        friction: &Total<T, NK>,
        impulses: &List<T, NR>,
        rates: &List<T, NR>,
    ) -> Modes<T, NK> {
        let mut modes = Modes::repeat((T::zero(), Mode::Open));
        for k in 0..self.count {
            modes[k] = self.mode(friction[k], k, impulses, rates);
        }
        modes
    }

    fn mode(&self, friction: T, k: usize, impulses: &List<T, NR>, rates: &List<T, NR>) -> (T, Mode<T>) {
        let (n, tangents) = self.of(k);
        let step = self.step[k] * self.scale;
        let normal = impulses[n] - self.press(k) * (rates[n] - self.least[self.pressed_by[k]]);
        let bearing = self.bearing(k, normal);
        if bearing <= T::zero() || step == T::zero() {
            return (normal, Mode::Open);
        }
        let mut direction = [T::zero(); 2];
        for (d, i) in direction.iter_mut().zip(tangents) {
            *d = impulses[i] - step * rates[i];
        }
        let [x, y] = direction;
        let size = (x * x + y * y).sqrt();
        if size <= friction * bearing {
            return (normal, Mode::Stick);
        }
        (normal, Mode::Slip { size, direction: [x / size, y / size] })
    }

    /// The natural map of a contact: its impulses without what they are by their law. Friction that is
    /// stronger than what presses counts by what would press it, so that rounding of the latter is not taken
    /// for more than it is.
    fn map(
        &self,
        k: usize,
        (normal, mode): (T, Mode<T>),
        impulses: &List<T, NR>,
        rates: &List<T, NR>,
    ) -> [T; 3] {
        let (n, tangents) = self.of(k);
        let pressed = if self.is_gap(k) { impulses[n] - positive_part(normal) } else { T::zero() };
        let mut map = [pressed, T::zero(), T::zero()];
        for ((c, entry), i) in map.iter_mut().skip(1).enumerate().zip(tangents) {
            *entry = match mode {
                Mode::Open => impulses[i],
                Mode::Stick => self.step[k] * self.scale * rates[i],
                Mode::Slip { direction, .. } => {
                    let friction = self.friction[k];
                    let most = friction * self.bearing(k, normal);
                    (impulses[i] - component(&direction, c) * most) / friction.max(T::one())
                }
            };
        }
        map
    }
}

/// A component of a direction of slip.
pub(super) fn component<T: Copy>([x, y]: &[T; 2], c: usize) -> T {
    if c == 0 { *x } else { *y }
}
