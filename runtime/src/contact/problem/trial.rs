//! Trial impulses, with the contact velocities after them and the residuals of the contact conditions.

use super::super::total::TotalArray;
use super::{ContactProblem, RowList};
use crate::Real;
use crate::private::{epsilon, positive_part};

/// Contact mode in the natural map of a contact.
#[derive(Clone, Copy)]
pub(super) enum ContactMode<T> {
    /// Separated: the contact has no impulse.
    Open,
    /// Sticking: the contact has no slip.
    Stick,
    /// Sliding: magnitude and direction of the tangential impulse before its projection onto the friction
    /// cone.
    Slip { size: T, direction: [T; 2] },
}

/// Normal impulse of each contact before its projection onto zero or more, and the contact mode.
pub(super) type ContactModes<T, const NK: usize> = TotalArray<(T, ContactMode<T>), NK>;

/// Trial impulses, with contact velocities, modes and residuals.
#[derive(Clone, Copy)]
pub(super) struct ImpulseTrial<T, const NK: usize, const NR: usize> {
    pub(super) impulses: RowList<T, NR>,
    /// Contact velocities after the impulses.
    pub(super) rates: RowList<T, NR>,
    pub(super) modes: ContactModes<T, NK>,
    /// Squared norm of the residual of the natural map, in units of contact velocity.
    pub(super) left: T,
    /// Largest residual of a contact, as a contact velocity, and the index of that contact.
    pub(super) worst: (T, usize),
}

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Returns impulses with the contact velocities after them, and their residuals.
    pub(super) fn evaluate_impulse_trial(&self, impulses: RowList<T, NR>) -> ImpulseTrial<T, NK, NR> {
        self.trial_with_residuals(impulses, self.contact_velocities_after(&impulses))
    }

    /// Returns impulses and given contact velocities after them, with their residuals.
    pub(super) fn trial_with_residuals(
        &self,
        impulses: RowList<T, NR>,
        rates: RowList<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        let modes = self.natural_map_modes(&self.friction, &impulses, &rates);
        let (mut all, mut worst) = (T::zero(), (T::zero(), 0));
        for k in 0..self.count {
            let step = self.step[k] * self.scale;
            let left = if step == T::zero() {
                // Nothing that impulses could do.
                if self.has_gap_function(k) {
                    positive_part(self.least[k] - rates[self.rows[k].first])
                } else {
                    T::zero()
                }
            } else {
                let [normal, x, y] = self.natural_map_residual(k, modes[k], &impulses, &rates);
                all += (normal * normal + x * x + y * y) / (step * step);
                normal.abs().max((x * x + y * y).sqrt()) / step
            };
            // What is not a number is worst of all.
            let less = left <= worst.0;
            if !less {
                worst = (left, k);
            }
        }
        ImpulseTrial { impulses, rates, modes, left: all, worst }
    }

    /// Whether the residuals of the contact conditions are within rounding errors of the impulses. Very large
    /// impulses never count as a solution.
    pub(super) fn is_solved_by(&self, trial: &ImpulseTrial<T, NK, NR>) -> bool {
        let left = trial.worst.0;
        left <= self.largest_free_contact_velocity() * epsilon::<T>().sqrt()
            && left <= self.contact_velocity_rounding_error(&trial.impulses)
    }

    /// Returns the contact modes in the natural map with these coefficients of friction.
    pub(super) fn natural_map_modes(
        &self,
        friction: &TotalArray<T, NK>,
        impulses: &RowList<T, NR>,
        rates: &RowList<T, NR>,
    ) -> ContactModes<T, NK> {
        let mut modes = ContactModes::repeat_entry((T::zero(), ContactMode::Open));
        for k in 0..self.count {
            modes[k] = self.natural_map_mode(friction[k], k, impulses, rates);
        }
        modes
    }

    fn natural_map_mode(
        &self,
        friction: T,
        k: usize,
        impulses: &RowList<T, NR>,
        rates: &RowList<T, NR>,
    ) -> (T, ContactMode<T>) {
        let (n, tangents) = self.normal_and_friction_rows(k);
        let step = self.step[k] * self.scale;
        let normal = impulses[n] - self.normal_impulse_step(k) * (rates[n] - self.least[self.pressed_by[k]]);
        let bearing = self.friction_bounding_impulse(k, normal);
        if bearing <= T::zero() || step == T::zero() {
            return (normal, ContactMode::Open);
        }
        let mut direction = [T::zero(); 2];
        for (d, i) in direction.iter_mut().zip(tangents) {
            *d = impulses[i] - step * rates[i];
        }
        let [x, y] = direction;
        let size = (x * x + y * y).sqrt();
        if size <= friction * bearing {
            return (normal, ContactMode::Stick);
        }
        (normal, ContactMode::Slip { size, direction: [x / size, y / size] })
    }

    /// Returns the residual of the natural map of a contact: its impulses minus their projection onto the
    /// contact conditions. With a coefficient of friction above one, the tangential residual is divided by
    /// that coefficient, so that rounding errors of the normal impulse are not amplified.
    fn natural_map_residual(
        &self,
        k: usize,
        (normal, mode): (T, ContactMode<T>),
        impulses: &RowList<T, NR>,
        rates: &RowList<T, NR>,
    ) -> [T; 3] {
        let (n, tangents) = self.normal_and_friction_rows(k);
        let pressed = if self.has_gap_function(k) { impulses[n] - positive_part(normal) } else { T::zero() };
        let mut map = [pressed, T::zero(), T::zero()];
        for ((c, entry), i) in map.iter_mut().skip(1).enumerate().zip(tangents) {
            *entry = match mode {
                ContactMode::Open => impulses[i],
                ContactMode::Stick => self.step[k] * self.scale * rates[i],
                ContactMode::Slip { direction, .. } => {
                    let friction = self.friction[k];
                    let most = friction * self.friction_bounding_impulse(k, normal);
                    (impulses[i] - direction_component(&direction, c) * most) / friction.max(T::one())
                }
            };
        }
        map
    }
}

/// Returns component `c` of a slip direction in the tangent plane.
pub(super) fn direction_component<T: Copy>([x, y]: &[T; 2], c: usize) -> T {
    if c == 0 { *x } else { *y }
}
