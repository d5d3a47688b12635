//! Newton's method for the natural map.
//!
//! The natural map has as many equations as there are impulses. Its derivative relates the changes of the
//! impulses to those of the contact velocities, `ΔΛ = c − H B Δw`, contact by contact. With `Δw = Bᵀ ΔΛ`, the
//! system `(1 + Bᵀ H B) Δw = Bᵀ c` remains. It is no larger than the velocity, and regular for dependent rows
//! as well. Sticking and pressed contacts have the regularised equation `u + ε ΔΛ = 0`; impulses that no
//! motion depends on then stay the same.

use super::super::total::TotalArray;
use super::banded::{set_unit_rows, solve_banded_system};
use super::basis::ImpulseDerivativeBlock;
use super::convex::PARTS;
use super::elimination::zero_matrix;
use super::search::PATIENCE;
use super::trial::{ContactMode, ImpulseTrial};
use super::{ContactProblem, ContactRowMatrix, RowList};
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

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Returns the best impulses that Newton's method finds. A step is halved until the residual falls; if it
    /// does not, the whole step is taken, a limited number of times; `matrix` is workspace.
    pub(super) fn newton_impulses(
        &self,
        start: ImpulseTrial<T, NK, NR>,
        matrix: &mut ContactRowMatrix<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        self.limited_newton_impulses(STEPS, start, matrix)
    }

    /// Returns the result of [`newton_impulses`](Self::newton_impulses) after a given number of iterations at
    /// most.
    pub(super) fn limited_newton_impulses(
        &self,
        steps: usize,
        start: ImpulseTrial<T, NK, NR>,
        matrix: &mut ContactRowMatrix<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        let (mut best, mut rises) = ((start.left, start.impulses), 0);
        let mut trial = start;
        for _ in 0..steps {
            if self.is_solved_by(&trial) {
                // Sums of changes accumulate rounding errors.
                trial = self.evaluate_impulse_trial(trial.impulses);
                if self.is_solved_by(&trial) {
                    return trial;
                }
            }
            self.count_iteration();
            let change = self.newton_step(&trial, matrix);
            let rates = self.contact_velocity_changes(&change);
            let trial_after_partial_change = |part: T| {
                let impulses = values_after_partial_change(&trial.impulses, &change, part);
                self.trial_with_residuals(impulses, values_after_partial_change(&trial.rates, &rates, part))
            };
            let mut next = trial_after_partial_change(T::one());
            let is_smaller_residual = |next: &ImpulseTrial<T, NK, NR>| next.left < trial.left;
            if !is_smaller_residual(&next) {
                let (whole, mut part) = (next, T::one());
                while next.left >= trial.left && part > constant(SHORTEST) {
                    part *= constant(0.5);
                    next = trial_after_partial_change(part);
                }
                if !is_smaller_residual(&next) {
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
            if (is_stalled || self.iterations.get() > PATIENCE) && self.is_small_violation(&trial) {
                break;
            }
        }
        self.evaluate_impulse_trial(best.1)
    }

    /// Returns the result of [`newton_impulses`](Self::newton_impulses) from impulses that satisfy the
    /// contact conditions for the coefficients of friction `before`: the first step assumes the contact modes
    /// of these impulses.
    pub(super) fn newton_from_previous_modes(
        &self,
        start: RowList<T, NR>,
        before: &TotalArray<T, NK>,
    ) -> ImpulseTrial<T, NK, NR> {
        let mut trial = self.evaluate_impulse_trial(start);
        trial.modes = self.natural_map_modes(before, &start, &trial.rates);
        let mut matrix = zero_matrix();
        let change = self.newton_step(&trial, &mut matrix);
        self.newton_impulses(
            self.evaluate_impulse_trial(values_after_partial_change(&start, &change, T::one())),
            &mut matrix,
        )
    }

    /// Returns the impulses after one more step, if the smallest normal velocities of pressed contacts are
    /// not yet exact to their own rounding errors.
    pub(super) fn refined_trial(
        &self,
        trial: ImpulseTrial<T, NK, NR>,
        matrix: &mut ContactRowMatrix<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        let ImpulseTrial { impulses, left, worst, .. } = &trial;
        let half = epsilon::<T>().sqrt();
        let little = half * half.sqrt();
        let pressed = (0..self.count).filter(|k| {
            self.has_gap_function(*k) && impulses[self.normal_and_friction_rows(*k).0] > T::zero()
        });
        if pressed
            .map(|k| self.free[self.normal_and_friction_rows(k).0].abs() * little)
            .all(|most| worst.0 <= most)
        {
            return trial;
        }
        let change = self.newton_step(&trial, matrix);
        let next = self.evaluate_impulse_trial(values_after_partial_change(impulses, &change, T::one()));
        if next.left < *left { next } else { trial }
    }

    /// Returns the change of the impulses in a step; `matrix` is workspace.
    fn newton_step(
        &self,
        trial: &ImpulseTrial<T, NK, NR>,
        matrix: &mut ContactRowMatrix<T, NR>,
    ) -> RowList<T, NR> {
        let constant_part = self.impulse_changes(trial, &RowList::repeat_entry(T::zero()));
        let mut change = self.basis.velocity_of_impulses(&constant_part);
        let mut ends = self.fill_newton_matrix(trial, matrix);
        solve_banded_system(matrix, (&mut change, &mut ends), self.basis.column_count());
        self.impulse_changes(trial, &self.basis.rates_of_velocity(&change))
    }

    /// Writes `1 + Bᵀ H B` to `matrix`, and returns the index behind the last entry of each row.
    fn fill_newton_matrix(
        &self,
        trial: &ImpulseTrial<T, NK, NR>,
        matrix: &mut ContactRowMatrix<T, NR>,
    ) -> RowList<usize, NR> {
        let mut ends = set_unit_rows(matrix, self.basis.column_count());
        for k in (0..self.count).filter(|k| self.has_gap_function(*k)) {
            self.basis.add_projected_block(&self.derivative_block(trial, k), matrix, &mut ends);
        }
        ends
    }

    /// Returns one contact's block of the matrix `H` in `ΔΛ = c − H B Δw`: changes of its impulses by changes
    /// of its contact velocities.
    fn derivative_block(&self, trial: &ImpulseTrial<T, NK, NR>, k: usize) -> ImpulseDerivativeBlock<T> {
        let presses = self.has_positive_normal_impulse(trial, k);
        let pressed = if presses { self.impulse_stiffness(k) } else { T::zero() };
        let mut block = ImpulseDerivativeBlock::new(self.normal_and_friction_rows(k).0);
        block.add_to_entry(0, 0, pressed);
        // Friction moments follow their contact.
        for part in (k..self.count.min(k + PARTS)).filter(|part| self.pressed_by[*part] == k) {
            let tangents = self.normal_and_friction_rows(part).1;
            match trial.modes[part].1 {
                ContactMode::Open => {}
                ContactMode::Stick => {
                    let (factor, first) =
                        (self.impulse_stiffness(part), block.push_friction_rows(tangents.clone()));
                    (first..first + tangents.len()).for_each(|i| block.add_to_entry(i, i, factor));
                }
                ContactMode::Slip { size, direction } => {
                    let first = block.push_friction_rows(tangents.clone());
                    // The friction at its bound follows the normal impulse.
                    for (i, d) in (first..first + tangents.len()).zip(direction) {
                        block.add_to_entry(i, 0, pressed * self.friction[part] * d);
                    }
                    let (bound, factor) = self.sliding_bound_and_factor(trial, part, size);
                    if tangents.len() == 2 && bound > T::zero() {
                        let [x, y] = direction;
                        block.add_scaled_outer_product(first, bound / size * factor, [-y, x]);
                    }
                }
            }
        }
        block
    }

    /// Returns the changes of the impulses in a step that changes the contact velocities by `rates`.
    fn impulse_changes(&self, trial: &ImpulseTrial<T, NK, NR>, rates: &RowList<T, NR>) -> RowList<T, NR> {
        let ImpulseTrial { impulses, rates: now, modes, .. } = trial;
        let mut changes = RowList::repeat_entry(T::zero());
        for k in 0..self.count {
            let (n, tangents) = self.normal_and_friction_rows(k);
            if self.has_gap_function(k) {
                changes[n] = match self.has_positive_normal_impulse(trial, k) {
                    true => -(now[n] - self.least[k] + rates[n]) * self.impulse_stiffness(k),
                    false => -impulses[n],
                };
            }
            match modes[k].1 {
                ContactMode::Open => tangents.for_each(|i| changes[i] = -impulses[i]),
                ContactMode::Stick => {
                    tangents.for_each(|i| changes[i] = -(now[i] + rates[i]) * self.impulse_stiffness(k));
                }
                ContactMode::Slip { size, direction: [x, y] } => {
                    let normal = impulses[n] + changes[n] + self.floor[self.pressed_by[k]];
                    let along = normal * self.friction[k];
                    let i = tangents.start;
                    if tangents.len() == 2 {
                        let (bound, factor) = self.sliding_bound_and_factor(trial, k, size);
                        let cross_component = |list: &RowList<T, NR>| x * list[i + 1] - y * list[i];
                        let across = cross_component(impulses)
                            - (cross_component(now) + bound / size * cross_component(rates)) * factor;
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

    /// Whether the normal impulse of the natural map is positive.
    fn has_positive_normal_impulse(&self, trial: &ImpulseTrial<T, NK, NR>, k: usize) -> bool {
        trial.modes[k].0 > T::zero() && self.step[k] > T::zero()
    }

    /// Returns `1/ε` of a contact: the impulse per contact velocity in the regularised equation
    /// `u + ε ΔΛ = 0`.
    fn impulse_stiffness(&self, k: usize) -> T {
        self.step[k] * self.scale / self.impulse_regularisation()
    }

    /// Returns the friction bound of a sliding contact, whose tangential impulse before the projection has
    /// the magnitude `size`, and the factor of the slip velocity across its direction.
    fn sliding_bound_and_factor(&self, trial: &ImpulseTrial<T, NK, NR>, k: usize, size: T) -> (T, T) {
        let bound = self.friction[k] * self.friction_bounding_impulse(k, trial.modes[k].0);
        (bound, self.step[k] * self.scale / (T::one() - bound / size + self.impulse_regularisation()))
    }

    /// Returns the regularisation `ε` of an impulse, relative to the trace of its contact's block of `W`: a
    /// step leaves this part of a contact velocity. Smaller values amplify the rounding errors of the
    /// redundant contact velocities of many bodies more.
    fn impulse_regularisation(&self) -> T {
        let factor = if self.is_relaxed { constant(64.0) } else { T::one() };
        epsilon::<T>().sqrt() * factor
    }
}

/// Returns values after a part of a change.
fn values_after_partial_change<T: Real, const NR: usize>(
    from: &RowList<T, NR>,
    change: &RowList<T, NR>,
    part: T,
) -> RowList<T, NR> {
    let mut to = *from;
    to.iter_mut().zip(change.iter()).for_each(|(to, change)| *to += *change * part);
    to
}
