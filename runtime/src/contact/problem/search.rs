//! Search for impulses that satisfy the conditions of all contacts.

use super::super::total::TotalArray;
use super::elimination::zero_matrix;
use super::linear::ImpulseEquations;
use super::newton::STEPS;
use super::trial::ImpulseTrial;
use super::{ContactProblem, ContactRowMatrix, RowList};
use crate::Real;
use crate::private::{constant, epsilon, positive_part};
use core::ops::Range;

/// Maximum number of rounds of gradient steps, each followed by Newton's method.
const ROUNDS: usize = 12;
/// Maximum number of rounds in a step of a simulation.
const ROUNDS_OF_STEP: usize = 3;
/// Gradient steps in the first round; each later round has one more.
const SWEEPS: usize = 21;
/// Factor of the steps of the natural map in each round.
const SCALES: [f64; 5] = [1.0, 8.0, 0.125, 64.0, 1.0 / 64.0];
/// Maximum number of iterations of Newton's method with each of these factors, before convex problems are
/// solved.
const STEPS_OF_SCALE: usize = 10;
/// Increments in which friction grows if all else fails.
const DEGREES: u32 = 24;
/// Coefficient of friction up to which the angle of the friction cone grows in equal increments. Beyond it,
/// the coefficient grows by equal factors.
const STEEP: f64 = 4.0;
/// Maximum number of contacts whose subsets are all tried if all else fails.
const GUESSED: usize = 6;
/// Number of rows above which groups of contacts are solved separately.
const DENSE: usize = 36;
/// Violation of the contact conditions that ends the search in a step of a simulation, relative to the
/// largest contact velocity.
const ENOUGH: f64 = 1e-8;
/// Number of iterations of Newton's method in a step after which this violation grows, number of further
/// iterations in which it grows tenfold, and maximum number of times. With these numbers, the 99 % quantile
/// of the durations of steps of five falling dominoes is half of that with a constant violation.
pub(super) const PATIENCE: usize = 16;
const PER_DECADE: usize = 8;
const MAX_DECADES: usize = 3;
/// Violation, relative to the largest contact velocity, of impulses that are worse than none.
const NONSENSE: f64 = 1e3;
/// Number of rows up to which impulses of the least norm come first, and the violation of impulses of the
/// previous step, relative to the largest contact velocity, below which they come first otherwise.
const FEW: usize = 12;
const NEAR: f64 = 0.1;
/// Maximum number of contacts whose pairs are all tried then.
const PAIRED: usize = 24;

/// Returns reduced friction, which grows with `share` from zero.
fn reduced_friction<T: Real>(friction: T, share: T) -> T {
    let (steep, twice) = (constant::<T>(STEEP), share + share);
    if friction <= steep {
        return (friction.atan() * share).tan();
    }
    match twice <= T::one() {
        true => (steep.atan() * twice).tan(),
        false => steep * (friction / steep).powf(twice - T::one()),
    }
}

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Returns impulses that satisfy the contact conditions.
    ///
    /// # Errors
    ///
    /// The contact of the mechanism whose conditions are violated most, if by more than half of the digits;
    /// [`closest`](Self::closest) then has the impulses that violate them least of all that were found.
    pub(in super::super) fn solve_impulses(&mut self) -> Result<RowList<T, NR>, usize> {
        self.solve_impulses_from_start(None, &mut ImpulseEquations::new())
    }

    /// Solves with given equations; the search begins at the impulses of `start`.
    ///
    /// # Errors
    ///
    /// As [`solve`](Self::solve).
    pub(in super::super) fn solve_impulses_from_start(
        &mut self,
        start: Option<&RowList<T, NR>>,
        equations: &mut ImpulseEquations<T, NR>,
    ) -> Result<RowList<T, NR>, usize> {
        if const { NR > DENSE } && self.size > DENSE {
            let groups = self.contact_groups();
            if groups.1 > 1 {
                let found = self.evaluate_impulse_trial(self.solve_groups(&groups, start));
                self.violation = found.worst.0;
                if found.worst.0 <= self.largest_free_contact_velocity() * epsilon::<T>().sqrt()
                    || self.is_solved_by(&found)
                {
                    return Ok(found.impulses);
                }
                self.closest = found.impulses;
                return Err(self.contacts[found.worst.1].0);
            }
        }
        let mut found = self.least_violating_impulses(start, equations);
        let is_solution = |problem: &Self, found: &ImpulseTrial<T, NK, NR>| {
            found.worst.0 <= problem.largest_free_contact_velocity() * epsilon::<T>().sqrt()
                || problem.is_solved_by(found)
        };
        if self.is_exhaustive_search()
            && !(self.is_relaxed && is_solution(self, &found))
            && !self.is_solved_by(&found)
        {
            let other = self.search_with_all_methods(found.impulses);
            let other = self.evaluate_impulse_trial(other);
            // The rates of the map are dominated by rounding errors if masses differ by many powers of ten.
            let is_better = self.is_frictionless() && is_solution(self, &other);
            if is_better || other.worst.0 < found.worst.0 {
                found = other;
            }
        }
        let (left, worst) = found.worst;
        let impulses = self.project_onto_cones(found.impulses);
        self.violation = left;
        if is_solution(self, &found) {
            return Ok(impulses);
        }
        self.closest = impulses;
        Err(self.contacts[worst].0)
    }

    /// Projects impulses onto their friction cones, from which rounding may have moved them.
    fn project_onto_cones(&self, mut impulses: RowList<T, NR>) -> RowList<T, NR> {
        for k in 0..self.count {
            let (n, tangents) = self.normal_and_friction_rows(k);
            impulses[n] = positive_part(impulses[n]);
            let most = self.friction[k] * self.friction_bounding_impulse(k, impulses[n]);
            let size = tangents.clone().fold(T::zero(), |sum, i| sum + impulses[i] * impulses[i]).sqrt();
            if size > most {
                tangents.for_each(|i| impulses[i] *= most / size);
            }
        }
        impulses
    }

    /// Returns the impulses that violate the contact conditions least.
    fn least_violating_impulses(
        &mut self,
        start: Option<&RowList<T, NR>>,
        equations: &mut ImpulseEquations<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        let start = start.map(|start| {
            let mut impulses = *start;
            impulses.iter_mut().zip(self.base.iter()).for_each(|(impulse, base)| *impulse -= *base);
            self.evaluate_impulse_trial(impulses)
        });
        let near = start.filter(|start| {
            self.size > FEW && start.worst.0 <= self.largest_free_contact_velocity() * constant(NEAR)
        });
        // In most steps few contacts slip or separate, or all keep their modes.
        let start = match near {
            Some(near) => near,
            None => self.sticking_impulses(start, equations),
        };
        if self.is_solved_by(&start) {
            return start;
        }
        self.compute_basis_if_needed();
        let matrix = equations.take_workspace();
        let found = self.newton_with_all_scales(start, matrix);
        if self.is_solved_by(&found) || self.is_small_violation(&found) {
            // Compared with fast slip, residuals of slow normal velocities are small.
            return self.refined_trial(found, matrix);
        }
        let convex = self.solve_convex_sequence(&start.impulses, matrix);
        if self.is_solved_by(&convex) || self.is_small_violation(&convex) {
            return convex;
        }
        let best = if found.worst.0 < convex.worst.0 { found } else { convex };
        let found = self.newton_impulses(best, matrix);
        match found.worst.0 < best.worst.0 {
            true => self.refined_trial(found, matrix),
            false => best,
        }
    }

    /// Returns the best impulses that Newton's method finds with one factor of the steps of the natural map
    /// after the other, each time from the best impulses so far: where the method alternates between two
    /// sets of contact modes with one factor, it often converges with another.
    fn newton_with_all_scales(
        &mut self,
        start: ImpulseTrial<T, NK, NR>,
        matrix: &mut ContactRowMatrix<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        let mut best = self.limited_newton_impulses(STEPS_OF_SCALE, start, matrix);
        if self.size <= FEW && self.is_frictionless() && !self.is_solved_by(&best) {
            let pressed = self.evaluate_impulse_trial(self.active_set_impulses());
            if pressed.worst.0 < best.worst.0 {
                best = pressed;
            }
        }
        for scale in SCALES.into_iter().skip(1) {
            if self.is_solved_by(&best) || self.is_small_violation(&best) {
                break;
            }
            let next = self.newton_with_step_scale(STEPS_OF_SCALE, best.impulses, scale, matrix);
            if next.worst.0 < best.worst.0 {
                best = next;
            }
        }
        best
    }

    /// Returns the impulses with which all approaching contacts stick, for which the equations are linear, or
    /// those of `start` if they violate the conditions less.
    fn sticking_impulses(
        &self,
        start: Option<ImpulseTrial<T, NK, NR>>,
        equations: &mut ImpulseEquations<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        let approach = self.contact_mask_of_condition(|k| {
            self.free[self.normal_and_friction_rows(k).0] < self.least[self.pressed_by[k]]
        });
        let stuck = self.evaluate_impulse_trial(self.enforcing_impulses_with_workspace(&approach, equations));
        // Nearly dependent rows may have impulses that are worse than none.
        let stuck = match stuck.worst.0 <= self.largest_free_contact_velocity() * constant(NONSENSE) {
            true => stuck,
            false => self.evaluate_impulse_trial(RowList::repeat_entry(T::zero())),
        };
        match start.filter(|start| !self.is_solved_by(&stuck) && start.worst.0 < stuck.worst.0) {
            Some(start) => start,
            None => stuck,
        }
    }

    /// Whether the violation of the contact conditions is small enough for a step of a simulation with
    /// several bodies. Velocities of redundant contacts contradict each other by rounding errors of the
    /// geometry, so that no impulses may satisfy all conditions. The accepted violation grows with the number
    /// of iterations, which bounds the duration of a step.
    pub(super) fn is_small_violation(&self, trial: &ImpulseTrial<T, NK, NR>) -> bool {
        let iterations = self.iterations.get().saturating_sub(PATIENCE);
        let decades = iterations.div_ceil(PER_DECADE).min(MAX_DECADES);
        let enough = (0..decades).fold(constant::<T>(ENOUGH), |enough, _| enough * constant(10.0));
        self.is_relaxed && self.size > FEW && trial.worst.0 <= self.largest_free_contact_velocity() * enough
    }

    /// Returns the contacts that satisfy a condition.
    fn contact_mask_of_condition(&self, is_so: impl Fn(usize) -> bool) -> TotalArray<bool, NK> {
        let mut those = TotalArray::repeat_entry(false);
        for k in 0..self.count {
            those[k] = is_so(k);
        }
        those
    }

    /// Whether the search goes on after convex problems have failed. For many contacts, and in most steps of
    /// a simulation, it would take too long. In a step it goes on for few contacts and for strong friction.
    fn is_exhaustive_search(&self) -> bool {
        self.count <= PAIRED && (!self.is_relaxed || self.count <= GUESSED || self.has_steep_friction())
    }

    /// Whether a coefficient of friction is so large that convex problems seldom find impulses.
    fn has_steep_friction(&self) -> bool {
        self.friction.iter().take(self.count).any(|friction| *friction > constant(STEEP))
    }

    /// Searches impulses by all further methods.
    fn search_with_all_methods(&mut self, start: RowList<T, NR>) -> RowList<T, NR> {
        let mut impulses = start;
        if self.is_frictionless() {
            impulses = self.active_set_impulses();
            if self.is_solved_by_impulses(&impulses) {
                return impulses;
            }
        }
        let is_short = self.is_relaxed && self.size > FEW && !self.has_steep_friction();
        let rounds = if is_short { ROUNDS_OF_STEP } else { ROUNDS };
        for round in 0..rounds {
            self.relax_by_gradient(&mut impulses, SWEEPS + round);
            let relaxed = self.evaluate_impulse_trial(impulses);
            if self.is_solved_by(&relaxed) {
                return impulses;
            }
            // The step of the map that leads to the solution differs between problems.
            let scale = SCALES[round % SCALES.len()];
            let found = self.newton_with_step_scale(STEPS, impulses, scale, &mut zero_matrix());
            if self.is_solved_by(&found) {
                return found.impulses;
            }
            if found.worst.0 < relaxed.worst.0 {
                impulses = found.impulses;
            }
        }
        if is_short || self.demands_restitution() {
            // With less restitution impulses exist.
            return impulses;
        }
        if let Some(found) = self.continuation_in_friction() {
            return found;
        }
        // With strong friction, only the set of closed contacts is unknown.
        for kept in 0_u32..1 << self.count.min(GUESSED) {
            let start = self.impulses_enforcing_contacts(
                &self.contact_mask_of_condition(|k| k >= GUESSED || kept >> k & 1 == 1),
            );
            let guess = self.newton_impulses(self.evaluate_impulse_trial(start), &mut zero_matrix());
            if self.is_solved_by(&guess) {
                return guess.impulses;
            }
        }
        self.impulses_from_sticking_guesses().unwrap_or(impulses)
    }

    /// Whether no contact has friction.
    fn is_frictionless(&self) -> bool {
        self.friction.iter().take(self.count).all(|friction| *friction == T::zero())
    }

    /// Returns the impulses without friction by an active-set method (Lawson and Hanson, *Solving Least
    /// Squares Problems*, 1974, ch. 23): adds the contact with the largest approach velocity, and removes
    /// contacts whose impulse would become negative.
    fn active_set_impulses(&self) -> RowList<T, NR> {
        let mut impulses = RowList::repeat_entry(T::zero());
        let mut is_in = TotalArray::<bool, NK>::repeat_entry(false);
        for _ in 0..3 * self.count {
            let rates = self.contact_velocities_after(&impulses);
            let mut entering = (-self.contact_velocity_rounding_error(&impulses), None);
            for k in (0..self.count)
                .filter(|k| self.has_gap_function(*k) && self.step[*k] > T::zero() && !is_in[*k])
            {
                let short = rates[self.normal_and_friction_rows(k).0] - self.least[k];
                if short < entering.0 {
                    entering = (short, Some(k));
                }
            }
            let Some(entering) = entering.1 else { break };
            is_in[entering] = true;
            for _ in 0..self.count {
                let wanted = self.impulses_enforcing_contacts(&is_in);
                // How far the way there leads until the first would pull.
                let mut part = T::one();
                for k in (0..self.count).filter(|k| is_in[*k]) {
                    let (now, then) = (
                        impulses[self.normal_and_friction_rows(k).0],
                        wanted[self.normal_and_friction_rows(k).0],
                    );
                    if then <= T::zero() {
                        part = part.min(if now > T::zero() { now / (now - then) } else { T::zero() });
                    }
                }
                let mut is_done = true;
                for k in 0..self.count {
                    let n = self.normal_and_friction_rows(k).0;
                    if !is_in[k] {
                        continue;
                    }
                    let (now, then) = (impulses[n], wanted[n]);
                    let reached = now + (then - now) * part;
                    let pulls = then <= T::zero() && reached <= (then.abs() + now) * epsilon();
                    is_done &= then > T::zero();
                    is_in[k] = !pulls;
                    impulses[n] = if pulls { T::zero() } else { reached };
                }
                if is_done {
                    break;
                }
            }
        }
        impulses
    }

    fn is_solved_by_impulses(&self, impulses: &RowList<T, NR>) -> bool {
        self.is_solved_by(&self.evaluate_impulse_trial(*impulses))
    }

    /// Returns the result of Newton's method after a given number of iterations at most, with a factor of the
    /// steps of the natural map; `matrix` is workspace.
    fn newton_with_step_scale(
        &mut self,
        steps: usize,
        impulses: RowList<T, NR>,
        scale: f64,
        matrix: &mut ContactRowMatrix<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        self.scale = constant(scale);
        let found =
            self.limited_newton_impulses(steps, self.evaluate_impulse_trial(impulses), matrix).impulses;
        self.scale = T::one();
        self.evaluate_impulse_trial(found)
    }

    /// Returns impulses by continuation in the coefficients of friction: from zero in increments to their
    /// full values.
    fn continuation_in_friction(&mut self) -> Option<RowList<T, NR>> {
        let friction = self.friction;
        let mut impulses = RowList::repeat_entry(T::zero());
        for part in 1..=DEGREES {
            let share = constant::<T>(f64::from(part) / f64::from(DEGREES));
            let before = self.friction;
            self.friction = if part < DEGREES {
                friction.map_entries(|friction| reduced_friction(friction, share))
            } else {
                friction
            };
            // What is near already is not left for gradients of strong friction.
            let near =
                self.newton_from_previous_modes(impulses, if part > 1 { &before } else { &self.friction });
            if self.is_solved_by(&near) {
                impulses = near.impulses;
                continue;
            }
            self.relax_by_gradient(&mut impulses, SWEEPS);
            let mut best = self.evaluate_impulse_trial(impulses);
            for scale in SCALES {
                let found = self.newton_with_step_scale(STEPS, best.impulses, scale, &mut zero_matrix());
                if found.worst.0 < best.worst.0 {
                    best = found;
                }
                if self.is_solved_by(&best) {
                    break;
                }
            }
            impulses = best.impulses;
        }
        self.is_solved_by_impulses(&impulses).then_some(impulses)
    }

    /// Returns impulses by Newton's method from each guess in which one or two contacts stick, as a body with
    /// many contact points and strong friction rotates about few of them. Of the solutions, the one with the
    /// least energy is returned, so that the result does not depend on the order of the contacts.
    fn impulses_from_sticking_guesses(&self) -> Option<RowList<T, NR>> {
        if self.count > PAIRED {
            return None;
        }
        let mut best: Option<(T, RowList<T, NR>)> = None;
        for one in 0..self.count {
            for other in one..self.count {
                let start = self
                    .impulses_enforcing_contacts(&self.contact_mask_of_condition(|k| k == one || k == other));
                let found = self.newton_impulses(self.evaluate_impulse_trial(start), &mut zero_matrix());
                if !self.is_solved_by(&found) {
                    continue;
                }
                let ImpulseTrial { impulses, rates, .. } = found;
                let all = impulses.iter().zip(rates.iter().zip(self.free.iter())).take(self.size);
                let work = all
                    .fold(T::zero(), |sum, (impulse, (after, before))| sum + *impulse * (*after + *before));
                if best.is_none_or(|(least, _)| work < least) {
                    best = Some((work, impulses));
                }
            }
        }
        best.map(|(_, found)| found)
    }

    /// Returns steps for the impulses that are short enough for all contacts to be updated simultaneously:
    /// inverses of sums of block norms of `W`, which do not depend on the directions of the tangents.
    fn steps_for_simultaneous_updates(&self) -> RowList<T, NR> {
        let mut steps = RowList::<T, NR>::repeat_entry(T::zero());
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
            let (n, tangents) = self.normal_and_friction_rows(k);
            let block_row_norm = |rows: Range<usize>| {
                (0..self.count).fold(T::zero(), |sum, other| {
                    let block_norm = |columns: Range<usize>| {
                        let square = rows.clone().fold(T::zero(), |sum, i| {
                            columns.clone().fold(sum, |sum, j| {
                                sum + self.delassus_matrix_entry(i, j) * self.delassus_matrix_entry(i, j)
                            })
                        });
                        square.sqrt()
                    };
                    let (normal, along) = self.normal_and_friction_rows(other);
                    let pressed =
                        if self.has_gap_function(other) { block_norm(normal..normal + 1) } else { T::zero() };
                    sum + pressed + block_norm(along)
                })
            };
            let inverse_or_zero = |sum: T| if sum > T::zero() { T::one() / sum } else { T::zero() };
            if self.has_gap_function(k) {
                steps[n] = inverse_or_zero(block_row_norm(n..n + 1));
            }
            let along = inverse_or_zero(block_row_norm(tangents.clone()));
            tangents.for_each(|i| steps[i] = along);
        }
        steps
    }

    /// Improves impulses by sweeps of projected gradient steps with momentum (Nesterov). All contacts are
    /// updated simultaneously, so that their order has no effect.
    fn relax_by_gradient(&self, impulses: &mut RowList<T, NR>, sweeps: usize) {
        let steps = self.steps_for_simultaneous_updates();
        let (mut ahead, mut pace) = (*impulses, T::one());
        for _ in 0..sweeps {
            let rates = self.contact_velocities_after(&ahead);
            let mut next = RowList::repeat_entry(T::zero());
            for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
                let (n, _) = self.normal_and_friction_rows(k);
                if self.has_gap_function(k) {
                    next[n] = positive_part(ahead[n] - steps[n] * (rates[n] - self.least[k]));
                }
            }
            for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
                let (n, tangents) = self.normal_and_friction_rows(k);
                let most = self.friction[k] * self.friction_bounding_impulse(k, next[n]);
                let mut wanted = [T::zero(); 2];
                for (w, i) in wanted.iter_mut().zip(tangents.clone()) {
                    *w = ahead[i] - steps[i] * rates[i];
                }
                let [x, y] = wanted;
                let size = (x * x + y * y).sqrt();
                let part = if size > most { most / size } else { T::one() };
                for (w, i) in wanted.iter().zip(tangents) {
                    next[i] = *w * part;
                }
            }
            let faster = (T::one() + (T::one() + pace * pace * constant(4.0)).sqrt()) * constant(0.5);
            let carry = (pace - T::one()) / faster;
            pace = faster;
            for i in 0..self.size {
                ahead[i] = next[i] + (next[i] - impulses[i]) * carry;
            }
            *impulses = next;
        }
    }
}
