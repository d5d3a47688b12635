//! Search for impulses that satisfy the conditions of all contacts.

use super::super::total::Total;
use super::linear::{Equations, square};
use super::newton::STEPS;
use super::trial::Trial;
use super::{List, Problem, Square};
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
/// The friction up to which it grows by its angle, in the first half; what is stronger grows by equal factors
/// in the second.
const STEEP: f64 = 4.0;
/// Maximum number of contacts whose subsets are all tried if all else fails.
const GUESSED: usize = 6;
/// Number of rows above which groups of contacts are solved apart.
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
/// Number of rows up to which impulses of the least norm come first, and the violation of impulses of the
/// previous step, relative to the largest contact velocity, below which they come first otherwise.
const FEW: usize = 12;
const NEAR: f64 = 0.1;
/// Maximum number of contacts whose pairs are all tried then.
const PAIRED: usize = 24;

/// Returns reduced friction, which grows with `share` from zero.
fn part_of<T: Real>(friction: T, share: T) -> T {
    let (steep, twice) = (constant::<T>(STEEP), share + share);
    if friction <= steep {
        return (friction.atan() * share).tan();
    }
    match twice <= T::one() {
        true => (steep.atan() * twice).tan(),
        false => steep * (friction / steep).powf(twice - T::one()),
    }
}

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Returns impulses that satisfy the contact conditions.
    ///
    /// # Errors
    ///
    /// The contact of the mechanism whose conditions are violated most, if by more than half of the digits;
    /// [`closest`](Self::closest) then has the impulses that violate them least of all that were found.
    pub(in super::super) fn solve(&mut self) -> Result<List<T, NR>, usize> {
        self.solve_from(None, &mut Equations::new())
    }

    /// Solves with given equations; the search begins at the impulses of `start`.
    ///
    /// # Errors
    ///
    /// As [`solve`](Self::solve).
    pub(in super::super) fn solve_from(
        &mut self,
        start: Option<&List<T, NR>>,
        equations: &mut Equations<T, NR>,
    ) -> Result<List<T, NR>, usize> {
        if const { NR > DENSE } && self.size > DENSE {
            let groups = self.groups();
            if groups.1 > 1 {
                let found = self.tried(self.solve_groups(&groups, start));
                self.violation = found.worst.0;
                if found.worst.0 <= self.speed() * epsilon::<T>().sqrt() || self.solves(&found) {
                    return Ok(found.impulses);
                }
                self.closest = found.impulses;
                return Err(self.contacts[found.worst.1].0);
            }
        }
        let mut found = self.search(start, equations);
        let is_found = |problem: &Self, found: &Trial<T, NK, NR>| {
            found.worst.0 <= problem.speed() * epsilon::<T>().sqrt() || problem.solves(found)
        };
        if self.is_exhaustive() && !(self.is_relaxed && is_found(self, &found)) && !self.solves(&found) {
            let other = self.exhaustive(found.impulses);
            let other = self.tried(other);
            // The rates of the map are dominated by rounding errors if masses differ by many powers of ten.
            let is_better = self.is_smooth() && is_found(self, &other);
            if is_better || other.worst.0 < found.worst.0 {
                found = other;
            }
        }
        let (left, worst) = found.worst;
        let impulses = self.in_cones(found.impulses);
        self.violation = left;
        if is_found(self, &found) {
            return Ok(impulses);
        }
        self.closest = impulses;
        Err(self.contacts[worst].0)
    }

    /// Projects impulses onto their friction cones, from which rounding may have moved them.
    fn in_cones(&self, mut impulses: List<T, NR>) -> List<T, NR> {
        for k in 0..self.count {
            let (n, tangents) = self.of(k);
            impulses[n] = positive_part(impulses[n]);
            let most = self.friction[k] * self.bearing(k, impulses[n]);
            let size = tangents.clone().fold(T::zero(), |sum, i| sum + impulses[i] * impulses[i]).sqrt();
            if size > most {
                tangents.for_each(|i| impulses[i] *= most / size);
            }
        }
        impulses
    }

    /// Returns the impulses that violate the contact conditions least.
    fn search(&mut self, start: Option<&List<T, NR>>, equations: &mut Equations<T, NR>) -> Trial<T, NK, NR> {
        let start = start.map(|start| {
            let mut impulses = *start;
            impulses.iter_mut().zip(self.base.iter()).for_each(|(impulse, base)| *impulse -= *base);
            self.tried(impulses)
        });
        let near = start.filter(|start| self.size > FEW && start.worst.0 <= self.speed() * constant(NEAR));
        // In most steps few contacts slip or separate, or all keep their modes.
        let start = match near {
            Some(near) => near,
            None => self.sticking_impulses(start, equations),
        };
        if self.solves(&start) {
            return start;
        }
        self.prepare_basis();
        let matrix = equations.workspace();
        let found = self.newton_with_all_scales(start, matrix);
        if self.solves(&found) || self.is_enough(&found) {
            // Compared with fast slip, residuals of slow normal velocities are small.
            return self.refined(found, matrix);
        }
        let convex = self.by_convex_problems(&start.impulses, matrix);
        if self.solves(&convex) || self.is_enough(&convex) {
            return convex;
        }
        let best = if found.worst.0 < convex.worst.0 { found } else { convex };
        let found = self.newton(best, matrix);
        match found.worst.0 < best.worst.0 {
            true => self.refined(found, matrix),
            false => best,
        }
    }

    /// Returns the best impulses that Newton's method finds with one factor of the steps of the natural map
    /// after the other, each time from the best impulses so far: where the method alternates between two
    /// sets of contact modes with one factor, it often converges with another.
    fn newton_with_all_scales(
        &mut self,
        start: Trial<T, NK, NR>,
        matrix: &mut Square<T, NR>,
    ) -> Trial<T, NK, NR> {
        let mut best = self.newton_within(STEPS_OF_SCALE, start, matrix);
        if self.size <= FEW && self.is_smooth() && !self.solves(&best) {
            let pressed = self.tried(self.press_in_turn());
            if pressed.worst.0 < best.worst.0 {
                best = pressed;
            }
        }
        for scale in SCALES.into_iter().skip(1) {
            if self.solves(&best) || self.is_enough(&best) {
                break;
            }
            let next = self.newton_scaled(STEPS_OF_SCALE, best.impulses, scale, matrix);
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
        start: Option<Trial<T, NK, NR>>,
        equations: &mut Equations<T, NR>,
    ) -> Trial<T, NK, NR> {
        let approach = self.those(|k| self.free[self.of(k).0] < self.least[self.pressed_by[k]]);
        let stuck = self.tried(self.together_with(&approach, equations));
        // Nearly dependent rows may have impulses that are worse than none.
        let stuck = match stuck.worst.0 <= self.speed() {
            true => stuck,
            false => self.tried(List::repeat(T::zero())),
        };
        match start.filter(|start| !self.solves(&stuck) && start.worst.0 < stuck.worst.0) {
            Some(start) => start,
            None => stuck,
        }
    }

    /// Whether the violation of the contact conditions is small enough for a step of a simulation with
    /// several bodies. Velocities of redundant contacts contradict each other by rounding errors of the
    /// geometry, so that no impulses may satisfy all conditions. The accepted violation grows with the number
    /// of iterations, which bounds the duration of a step.
    pub(super) fn is_enough(&self, trial: &Trial<T, NK, NR>) -> bool {
        let iterations = self.iterations.get().saturating_sub(PATIENCE);
        let decades = iterations.div_ceil(PER_DECADE).min(MAX_DECADES);
        let enough = (0..decades).fold(constant::<T>(ENOUGH), |enough, _| enough * constant(10.0));
        self.is_relaxed && self.size > FEW && trial.worst.0 <= self.speed() * enough
    }

    /// Returns the contacts that satisfy a condition.
    fn those(&self, is_so: impl Fn(usize) -> bool) -> Total<bool, NK> {
        let mut those = Total::repeat(false);
        for k in 0..self.count {
            those[k] = is_so(k);
        }
        those
    }

    /// Whether the search goes on after convex problems have failed. For many contacts, and in most steps of
    /// a simulation, it would take too long. In a step it goes on for few contacts and for strong friction.
    fn is_exhaustive(&self) -> bool {
        self.count <= PAIRED && (!self.is_relaxed || self.count <= GUESSED || self.is_steep())
    }

    /// Whether a coefficient of friction is so large that convex problems seldom find impulses.
    fn is_steep(&self) -> bool {
        self.friction.iter().take(self.count).any(|friction| *friction > constant(STEEP))
    }

    /// Searches impulses by all further methods.
    fn exhaustive(&mut self, start: List<T, NR>) -> List<T, NR> {
        let mut impulses = start;
        if self.is_smooth() {
            impulses = self.press_in_turn();
            if self.is_solved(&impulses) {
                return impulses;
            }
        }
        let is_short = self.is_relaxed && self.size > FEW && !self.is_steep();
        let rounds = if is_short { ROUNDS_OF_STEP } else { ROUNDS };
        for round in 0..rounds {
            self.relax(&mut impulses, SWEEPS + round);
            let relaxed = self.tried(impulses);
            if self.solves(&relaxed) {
                return impulses;
            }
            // The step of the map that leads to the solution differs between problems.
            let scale = SCALES[round % SCALES.len()];
            let found = self.newton_scaled(STEPS, impulses, scale, &mut square());
            if self.solves(&found) {
                return found.impulses;
            }
            if found.worst.0 < relaxed.worst.0 {
                impulses = found.impulses;
            }
        }
        if is_short || self.rebounds() {
            // With less restitution impulses exist.
            return impulses;
        }
        if let Some(found) = self.by_degrees() {
            return found;
        }
        // With strong friction, only the set of closed contacts is unknown.
        for kept in 0_u32..1 << self.count.min(GUESSED) {
            let start = self.together(&self.those(|k| k >= GUESSED || kept >> k & 1 == 1));
            let guess = self.newton(self.tried(start), &mut square());
            if self.solves(&guess) {
                return guess.impulses;
            }
        }
        self.in_pairs().unwrap_or(impulses)
    }

    /// Whether no contact has friction.
    fn is_smooth(&self) -> bool {
        self.friction.iter().take(self.count).all(|friction| *friction == T::zero())
    }

    /// The impulses without friction, by an active set (Lawson and Hanson, *Solving Least Squares Problems*,
    /// 1974, ch. 23): the contact whose surfaces approach each other most is taken in, and those that would
    /// pull are let go on the way.
    fn press_in_turn(&self) -> List<T, NR> {
        let mut impulses = List::repeat(T::zero());
        let mut is_in = Total::<bool, NK>::repeat(false);
        for _ in 0..3 * self.count {
            let rates = self.rates(&impulses);
            let mut entering = (-self.rounding(&impulses), None);
            for k in (0..self.count).filter(|k| self.is_gap(*k) && self.step[*k] > T::zero() && !is_in[*k]) {
                let short = rates[self.of(k).0] - self.least[k];
                if short < entering.0 {
                    entering = (short, Some(k));
                }
            }
            let Some(entering) = entering.1 else { break };
            is_in[entering] = true;
            for _ in 0..self.count {
                let wanted = self.together(&is_in);
                // How far the way there leads until the first would pull.
                let mut part = T::one();
                for k in (0..self.count).filter(|k| is_in[*k]) {
                    let (now, then) = (impulses[self.of(k).0], wanted[self.of(k).0]);
                    if then <= T::zero() {
                        part = part.min(if now > T::zero() { now / (now - then) } else { T::zero() });
                    }
                }
                let mut is_done = true;
                for k in 0..self.count {
                    let n = self.of(k).0;
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

    fn is_solved(&self, impulses: &List<T, NR>) -> bool {
        self.solves(&self.tried(*impulses))
    }

    /// Returns the result of Newton's method after a given number of iterations at most, with a factor of the
    /// steps of the natural map; `matrix` is workspace.
    fn newton_scaled(
        &mut self,
        steps: usize,
        impulses: List<T, NR>,
        scale: f64,
        matrix: &mut Square<T, NR>,
    ) -> Trial<T, NK, NR> {
        self.scale = constant(scale);
        let found = self.newton_within(steps, self.tried(impulses), matrix).impulses;
        self.scale = T::one();
        self.tried(found)
    }

    /// The impulses by way of those with less friction.
    fn by_degrees(&mut self) -> Option<List<T, NR>> {
        let friction = self.friction;
        let mut impulses = List::repeat(T::zero());
        for part in 1..=DEGREES {
            let share = constant::<T>(f64::from(part) / f64::from(DEGREES));
            let before = self.friction;
            self.friction =
                if part < DEGREES { friction.each(|friction| part_of(friction, share)) } else { friction };
            // What is near already is not left for gradients of strong friction.
            let near = self.follow(impulses, if part > 1 { &before } else { &self.friction });
            if self.solves(&near) {
                impulses = near.impulses;
                continue;
            }
            self.relax(&mut impulses, SWEEPS);
            let mut best = self.tried(impulses);
            for scale in SCALES {
                let found = self.newton_scaled(STEPS, best.impulses, scale, &mut square());
                if found.worst.0 < best.worst.0 {
                    best = found;
                }
                if self.solves(&best) {
                    break;
                }
            }
            impulses = best.impulses;
        }
        self.is_solved(&impulses).then_some(impulses)
    }

    /// Impulses that Newton's method finds from those with which two contacts stick, or one: a body that
    /// touches at many points with strong friction turns about few of them. Of all that it finds those that
    /// leave the least energy, so that the order of contacts decides nothing.
    fn in_pairs(&self) -> Option<List<T, NR>> {
        if self.count > PAIRED {
            return None;
        }
        let mut best: Option<(T, List<T, NR>)> = None;
        for one in 0..self.count {
            for other in one..self.count {
                let start = self.together(&self.those(|k| k == one || k == other));
                let found = self.newton(self.tried(start), &mut square());
                if !self.solves(&found) {
                    continue;
                }
                let Trial { impulses, rates, .. } = found;
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

    /// Steps for the impulses that are short enough for all to be taken at once, whatever the directions of
    /// the tangents: the inverse of what the sizes of the parts of `W` between contacts add up to.
    fn short_steps(&self) -> List<T, NR> {
        let mut steps = List::<T, NR>::repeat(T::zero());
        for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
            let (n, tangents) = self.of(k);
            let size = |rows: Range<usize>| {
                (0..self.count).fold(T::zero(), |sum, other| {
                    let part = |columns: Range<usize>| {
                        let square = rows.clone().fold(T::zero(), |sum, i| {
                            columns.clone().fold(sum, |sum, j| sum + self.weight(i, j) * self.weight(i, j))
                        });
                        square.sqrt()
                    };
                    let (normal, along) = self.of(other);
                    let pressed = if self.is_gap(other) { part(normal..normal + 1) } else { T::zero() };
                    sum + pressed + part(along)
                })
            };
            let inverse = |sum: T| if sum > T::zero() { T::one() / sum } else { T::zero() };
            if self.is_gap(k) {
                steps[n] = inverse(size(n..n + 1));
            }
            let along = inverse(size(tangents.clone()));
            tangents.for_each(|i| steps[i] = along);
        }
        steps
    }

    /// Sweeps of projected gradient steps with momentum (Nesterov): all contacts at once are brought towards
    /// their laws, so that the order in which they stand decides nothing.
    fn relax(&self, impulses: &mut List<T, NR>, sweeps: usize) {
        let steps = self.short_steps();
        let (mut ahead, mut pace) = (*impulses, T::one());
        for _ in 0..sweeps {
            let rates = self.rates(&ahead);
            let mut next = List::repeat(T::zero());
            for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
                let (n, _) = self.of(k);
                if self.is_gap(k) {
                    next[n] = positive_part(ahead[n] - steps[n] * (rates[n] - self.least[k]));
                }
            }
            for k in (0..self.count).filter(|k| self.step[*k] > T::zero()) {
                let (n, tangents) = self.of(k);
                let most = self.friction[k] * self.bearing(k, next[n]);
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
