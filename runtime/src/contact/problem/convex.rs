//! Impulses by a sequence of convex problems, each of which has exactly one solution.
//!
//! With the impulses `Λ` in their friction cones `K`, and normal rates raised by `s`, a problem is
//!
//! ```text
//! min ½ |w|² + max over Λ in K of { −Λ·(u₀ + B w + s) − ½ (Λ − Λ̄)·R (Λ − Λ̄) },   W = B Bᵀ
//! ```
//!
//! The problem is strictly convex in `w`, the change of the velocity in the metric of the kinetic energy, for
//! any rank of `W`, and Newton's method with a line search finds its minimum from any start. Without `s` and
//! with `Λ̄ = 0` it is Anitescu's relaxation, regularised (Castro, Permenter and Han, *An unconstrained
//! convex formulation of compliant contact*, IEEE Trans. Robot. 39, 2023). `Λ̄`, the impulses of the problem
//! before, removes the effect of the regularisation `R` (method of multipliers), and `s = μ |uₜ|`, from the
//! slip before, that of the relaxation (Acary, Cadoux, Lemaréchal and Malick, *A formulation of the linear
//! discrete Coulomb friction problem via convex optimization*, ZAMM 91, 2011): where both stay the same,
//! Coulomb's law is satisfied. For every `s ≥ 0` the impulses take energy, so that a sequence that is cut off
//! adds none. If the violation of Coulomb's law is small, Newton's method for the natural map continues from
//! the impulses of a problem.

use super::super::total::TotalArray;
use super::banded::set_unit_rows;
use super::basis::{ImpulseDerivativeBlock, ROWS, add_multiple, dot};
use super::trial::ImpulseTrial;
use super::{ContactProblem, ContactRowMatrix, RowList};
use crate::Real;
use crate::private::{constant, epsilon};

/// Problems in a sequence.
const PROBLEMS: usize = 16;
/// Iterations of Newton's method in all problems of a sequence.
const STEPS: usize = 48;
/// Iterations of Newton's method in one problem.
const STEPS_OF_ONE: usize = 12;
/// Evaluations of a line search.
const SEARCHES: usize = 10;
/// Regularisation of an impulse relative to its own diagonal entry of `W`: in the first problem, its factor
/// from problem to problem, its smallest value if these converge, and if they do not.
const REGULARISATIONS: [f64; 4] = [1e-2, 0.3, 1e-4, 1e-8];
/// Violations of Coulomb's law, relative to the largest contact velocity, below which Newton's method for the
/// natural map is tried, once for each.
const NEAR: [f64; 2] = [2e-2, 1e-4];
/// Violation of Coulomb's law, relative to the largest contact velocity, that counts as zero.
const ENOUGH: f64 = 1e-12;
/// Violation of Coulomb's law, relative to the largest contact velocity, at which a slow sequence ends.
const GOOD: f64 = 1e-10;
/// Kinds of friction of a contact: slip, spin and rolling.
pub(super) const PARTS: usize = 3;

/// Friction of a contact, or one of its moments.
#[derive(Clone, Copy)]
struct FrictionRows<T> {
    first: usize,
    count: usize,
    friction: T,
}

/// Friction cone of a contact: the normal impulse, and the tangential impulses that it bounds.
#[derive(Clone, Copy)]
struct FrictionCone<T> {
    normal: usize,
    parts: [FrictionRows<T>; PARTS],
    /// Normal impulse that acts in addition and bounds friction as well.
    floor: T,
    /// Smallest permitted normal velocity of the contact after the impulses.
    least: T,
    /// Increase `s` of the normal velocity that makes the contact problem convex.
    raised: T,
}

/// Result of the projection of a contact impulse onto its friction cone.
#[derive(Clone, Copy)]
struct ConeProjection<T> {
    normal: T,
    has_positive_normal_impulse: bool,
    /// Regularisation of the impulse along the cone.
    along: T,
    /// Magnitudes before the projection, and whether they are bounded by friction.
    sizes: [T; PARTS],
    bounded: [bool; PARTS],
}

impl<T: Real> FrictionCone<T> {
    /// Returns the kinds of friction that exist, with their indices.
    fn existing_friction_kinds(&self) -> impl Iterator<Item = (usize, FrictionRows<T>)> {
        self.parts.into_iter().enumerate().filter(|(_, part)| part.count > 0)
    }

    /// Returns the sum of the slip speeds times their coefficients of friction.
    fn friction_weighted_slip_speed<const NR: usize>(&self, rates: &RowList<T, NR>) -> T {
        self.existing_friction_kinds().fold(T::zero(), |sum, (_, part)| {
            let rows = part.first..part.first + part.count;
            sum + part.friction * rows.fold(T::zero(), |sum, i| sum + rates[i] * rates[i]).sqrt()
        })
    }

    /// Returns the projection of `wanted` onto the cone in the metric of the regularisation.
    fn project_impulse<const NR: usize>(
        &self,
        wanted: &RowList<T, NR>,
        weights: &RowList<T, NR>,
    ) -> ConeProjection<T> {
        let none = T::zero();
        let mut sizes = [none; PARTS];
        for ((_, part), size) in self.parts.into_iter().enumerate().zip(sizes.iter_mut()) {
            let square =
                (part.first..part.first + part.count).fold(none, |sum, i| sum + wanted[i] * wanted[i]);
            *size = square.sqrt();
        }
        let own = weights[self.normal];
        let (mut along, mut pull) = (own, own * wanted[self.normal]);
        let mut normal = wanted[self.normal];
        let mut bounded = [false; PARTS];
        // Each bounded part raises the normal impulse. The part that needs the largest one is bounded first.
        for _ in 0..PARTS {
            let mut most: Option<(T, usize)> = None;
            for (k, part) in self.existing_friction_kinds() {
                let (Some(size), Some(false)) = (sizes.get(k), bounded.get(k)) else { continue };
                let needed = *size / part.friction - self.floor;
                let exceeds = *size > part.friction * (normal + self.floor);
                if exceeds && most.is_none_or(|(other, _)| needed > other) {
                    most = Some((needed, k));
                }
            }
            let Some((_, k)) = most else { break };
            let (Some(part), Some(size), Some(bounded)) =
                (self.parts.get(k), sizes.get(k), bounded.get_mut(k))
            else {
                break;
            };
            let weight = weights[part.first] * part.friction;
            along += weight * part.friction;
            pull += weight * (*size - part.friction * self.floor);
            normal = pull / along;
            *bounded = true;
        }
        let has_positive_normal_impulse = normal > none;
        if !has_positive_normal_impulse {
            normal = none;
            for (k, part) in self.existing_friction_kinds() {
                if let (Some(bounded), Some(size)) = (bounded.get_mut(k), sizes.get(k)) {
                    *bounded = *size > part.friction * self.floor;
                }
            }
        }
        ConeProjection { normal, has_positive_normal_impulse, along, sizes, bounded }
    }

    /// Writes the impulses of a projection.
    fn write_projected_impulses<const NR: usize>(
        &self,
        found: &ConeProjection<T>,
        wanted: &RowList<T, NR>,
        impulses: &mut RowList<T, NR>,
    ) {
        impulses[self.normal] = found.normal;
        for (k, part) in self.existing_friction_kinds() {
            let (Some(size), Some(bounded)) = (found.sizes.get(k), found.bounded.get(k)) else { continue };
            let bound = part.friction * (found.normal + self.floor);
            let factor = if *bounded { bound / *size } else { T::one() };
            (part.first..part.first + part.count).for_each(|i| impulses[i] = wanted[i] * factor);
        }
    }
}

/// Factorises a symmetric positive definite matrix of `size` rows in place, of which the lower half is read:
/// `L` with the reciprocals of its diagonal.
pub(super) fn cholesky_in_place<T: Real, const NR: usize>(matrix: &mut ContactRowMatrix<T, NR>, size: usize) {
    for i in 0..size {
        let (done, rest) = matrix.split_at_mut_checked(i).unwrap_or_default();
        let Some(own) = rest.first_mut() else { return };
        // Rows begin at their first entry that is not zero.
        let first = own.iter().position(|entry| *entry != T::zero()).unwrap_or(i).min(i);
        for (j, above) in done.iter().enumerate().skip(first) {
            let sum = dot(own.get(first..j).unwrap_or_default(), above.get(first..j).unwrap_or_default());
            own[j] = (own[j] - sum) * above[j];
        }
        let square = own.iter().take(i).skip(first).fold(T::zero(), |sum, entry| sum + *entry * *entry);
        own[i] = T::one() / (own[i] - square).max(epsilon()).sqrt();
    }
}

/// Solves for `x` with the factor of [`cholesky`].
pub(super) fn solve_by_cholesky_factor<T: Real, const NR: usize>(
    factor: &ContactRowMatrix<T, NR>,
    size: usize,
    x: &mut RowList<T, NR>,
) {
    for (i, own) in factor.iter().enumerate().take(size) {
        let sum = dot(own.get(..i).unwrap_or_default(), x.get(..i).unwrap_or_default());
        x[i] = (x[i] - sum) * own[i];
    }
    for (i, own) in factor.iter().enumerate().take(size).rev() {
        x[i] *= own[i];
        let value = x[i];
        add_multiple(x.get_mut(..i).unwrap_or_default(), -value, own.get(..i).unwrap_or_default());
    }
}

/// A convex problem, and the state of its solution.
struct ConvexProblem<'a, T, const NK: usize, const NR: usize> {
    problem: &'a ContactProblem<T, NK, NR>,
    cones: TotalArray<FrictionCone<T>, NK>,
    count: usize,
    /// `R` and `Λ̄`.
    weights: RowList<T, NR>,
    center: RowList<T, NR>,
    w: RowList<T, NR>,
    rates: RowList<T, NR>,
    impulses: RowList<T, NR>,
}

impl<'a, T: Real, const NK: usize, const NR: usize> ConvexProblem<'a, T, NK, NR> {
    /// Returns the first problem of a sequence, which begins without impulses.
    fn new(problem: &'a ContactProblem<T, NK, NR>) -> Self {
        let zeros = RowList::repeat_entry(T::zero());
        let (cones, count) = problem.list_friction_cones();
        let weights = problem.diagonal_weights_of_impulses(&cones, count);
        Self { problem, cones, count, weights, center: zeros, w: zeros, rates: zeros, impulses: zeros }
    }

    fn friction_cones(&self) -> impl Iterator<Item = &FrictionCone<T>> {
        self.cones.iter().take(self.count)
    }

    /// Writes the impulses before their projection for contact velocities `rates`.
    fn write_unprojected_impulses(
        &self,
        cone: &FrictionCone<T>,
        rates: &RowList<T, NR>,
        wanted: &mut RowList<T, NR>,
    ) {
        let unprojected_impulse = |i: usize, rate: T| self.center[i] - rate / self.weights[i];
        let n = cone.normal;
        wanted[n] = unprojected_impulse(n, rates[n] + cone.raised - cone.least);
        for (_, part) in cone.existing_friction_kinds() {
            (part.first..part.first + part.count).for_each(|i| wanted[i] = unprojected_impulse(i, rates[i]));
        }
    }

    /// Returns the impulses for contact velocities `rates`.
    fn impulses_for_velocities(&self, rates: &RowList<T, NR>) -> RowList<T, NR> {
        let (mut wanted, mut impulses) = (RowList::repeat_entry(T::zero()), RowList::repeat_entry(T::zero()));
        for cone in self.friction_cones() {
            self.write_unprojected_impulses(cone, rates, &mut wanted);
            cone.write_projected_impulses(
                &cone.project_impulse(&wanted, &self.weights),
                &wanted,
                &mut impulses,
            );
        }
        impulses
    }

    /// Begins at given impulses `Λ`: `Λ̄ = Λ` and `w = Bᵀ Λ`.
    fn begin_at_impulses(&mut self, impulses: &RowList<T, NR>) {
        (self.center, self.w) = (*impulses, self.problem.basis.velocity_of_impulses(impulses));
    }

    /// Sets the increases of the normal rates to those for contact velocities `rates`.
    fn set_normal_velocity_increases(&mut self, rates: &RowList<T, NR>) {
        (0..self.count)
            .for_each(|k| self.cones[k].raised = self.cones[k].friction_weighted_slip_speed(rates));
    }

    /// Evaluates contact velocities and impulses at `w`.
    fn evaluate_rates_and_impulses(&mut self) {
        self.rates = self.problem.basis.rates_of_velocity(&self.w);
        for i in 0..self.problem.size {
            self.rates[i] += self.problem.free[i];
        }
        self.impulses = self.impulses_for_velocities(&self.rates);
    }

    /// Writes `1 + Bᵀ H B` to `matrix`, the derivative of the gradient with respect to `w`.
    fn write_objective_hessian(&self, matrix: &mut ContactRowMatrix<T, NR>) {
        let mut ends = set_unit_rows(matrix, self.problem.basis.column_count());
        let mut wanted = RowList::repeat_entry(T::zero());
        for cone in self.friction_cones() {
            self.write_unprojected_impulses(cone, &self.rates, &mut wanted);
            let block = self.hessian_block_of_cone(cone, &wanted);
            self.problem.basis.add_projected_block(&block, matrix, &mut ends);
        }
    }

    /// Returns the block of the matrix `H` that belongs to one friction cone. `wanted` are the impulses
    /// before their projection onto the cone.
    fn hessian_block_of_cone(
        &self,
        cone: &FrictionCone<T>,
        wanted: &RowList<T, NR>,
    ) -> ImpulseDerivativeBlock<T> {
        let (found, one, none) = (cone.project_impulse(wanted, &self.weights), T::one(), T::zero());
        let mut block = ImpulseDerivativeBlock::new(cone.normal);
        // Along the cone: the normal rate, and the rates of friction at its bound.
        let mut along = [none; ROWS];
        along[0] = one;
        for (k, part) in cone.existing_friction_kinds() {
            let (Some(size), Some(bounded)) = (found.sizes.get(k), found.bounded.get(k)) else { continue };
            let weight = self.weights[part.first];
            let first = block.push_friction_rows(part.first..part.first + part.count);
            if !bounded {
                if found.has_positive_normal_impulse || cone.floor > none {
                    (first..first + part.count).for_each(|i| block.add_to_entry(i, i, one / weight));
                }
                continue;
            }
            for (along, i) in along.iter_mut().skip(first).zip(part.first..part.first + part.count) {
                *along = part.friction * wanted[i] / *size;
            }
            // Across the direction of friction.
            let bound = part.friction * (found.normal + cone.floor);
            if part.count == 2 && bound > none {
                let (x, y) = (wanted[part.first] / *size, wanted[part.first + 1] / *size);
                block.add_scaled_outer_product(first, bound / (*size * weight), [-y, x]);
            }
        }
        if found.has_positive_normal_impulse {
            for (i, row) in along.iter().enumerate() {
                along
                    .iter()
                    .enumerate()
                    .for_each(|(j, column)| block.add_to_entry(i, j, *row * *column / found.along));
            }
        }
        block
    }

    /// Returns the negative gradient, `Bᵀ Λ − w`.
    fn negative_gradient(&self) -> RowList<T, NR> {
        let mut descent = self.problem.basis.velocity_of_impulses(&self.impulses);
        descent.iter_mut().zip(self.w.iter()).for_each(|(x, w)| *x -= *w);
        descent
    }

    /// Takes steps of Newton's method, at most this number, until the gradient is below a part of `w`;
    /// returns their number.
    fn minimise_by_newton(&mut self, matrix: &mut ContactRowMatrix<T, NR>, most: usize, enough: T) -> usize {
        let (rank, size) = (self.problem.basis.column_count(), self.problem.size);
        let little = epsilon::<T>().powf(constant(0.72));
        let largest_magnitude = |x: &RowList<T, NR>| x.iter().fold(T::zero(), |most, x| most.max(x.abs()));
        for step in 0..most {
            let gradient = self.negative_gradient();
            let (left, reach) = (largest_magnitude(&gradient), largest_magnitude(&self.w));
            if left <= reach * little || (step > 0 && left <= reach * enough) {
                return step;
            }
            self.problem.count_iteration();
            let mut change = gradient;
            self.write_objective_hessian(matrix);
            cholesky_in_place(matrix, rank);
            solve_by_cholesky_factor(matrix, rank, &mut change);
            let rates = self.problem.basis.rates_of_velocity(&change);
            let slope_at = |part: T| {
                let mut at = self.rates;
                (0..size).for_each(|i| at[i] += rates[i] * part);
                let impulses = self.impulses_for_velocities(&at);
                let kinetic =
                    (0..rank).fold(T::zero(), |sum, i| sum + (self.w[i] + change[i] * part) * change[i]);
                (0..size).fold(kinetic, |sum, i| sum - impulses[i] * rates[i])
            };
            let start = -(0..rank).fold(T::zero(), |sum, i| sum + gradient[i] * change[i]);
            let part = line_search_step_length(start, slope_at);
            (0..rank).for_each(|i| self.w[i] += change[i] * part);
            self.evaluate_rates_and_impulses();
        }
        most
    }
}

/// Returns a step length, at most one, at which the slope along a convex function is small.
fn line_search_step_length<T: Real>(start: T, slope: impl Fn(T) -> T) -> T {
    let (mut low, mut high) = ((T::zero(), start), (T::one(), slope(T::one())));
    let little = start.abs() * constant(0.25);
    if high.1 <= little {
        return T::one();
    }
    let mut part = T::one();
    for _ in 0..SEARCHES {
        // Illinois' variant of the secant method.
        part = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let now = slope(part);
        if now.abs() <= little {
            break;
        }
        if now < T::zero() {
            low = (part, now);
            high.1 *= constant(0.5);
        } else {
            high = (part, now);
            low.1 *= constant(0.5);
        }
    }
    part
}

impl<T: Real, const NK: usize, const NR: usize> ContactProblem<T, NK, NR> {
    /// Returns the friction cones, and their number.
    fn list_friction_cones(&self) -> (TotalArray<FrictionCone<T>, NK>, usize) {
        let none = FrictionRows { first: 0, count: 0, friction: T::zero() };
        let cone = FrictionCone {
            normal: 0,
            parts: [none; PARTS],
            floor: T::zero(),
            least: T::zero(),
            raised: T::zero(),
        };
        let (mut cones, mut count) = (TotalArray::<_, NK>::repeat_entry(cone), 0);
        for k in (0..self.count).filter(|k| self.has_gap_function(*k)) {
            let mut parts = [none; PARTS];
            let others = (k..self.count).filter(|other| self.pressed_by[*other] == k);
            for (part, other) in parts.iter_mut().zip(others) {
                let tangents = self.normal_and_friction_rows(other).1;
                *part = FrictionRows {
                    first: tangents.start,
                    count: tangents.len(),
                    friction: self.friction[other],
                };
            }
            let (normal, floor, least) = (self.rows[k].first, self.floor[k], self.least[k]);
            cones[count] = FrictionCone { normal, parts, floor, least, ..cone };
            count += 1;
        }
        (cones, count)
    }

    /// Returns the diagonal entry of `W` for each impulse, the largest one for all of a contact's friction.
    fn diagonal_weights_of_impulses(
        &self,
        cones: &TotalArray<FrictionCone<T>, NK>,
        count: usize,
    ) -> RowList<T, NR> {
        let reach = (0..self.size).fold(T::zero(), |most, i| most.max(self.delassus_matrix_entry(i, i)));
        let least = reach * epsilon::<T>().sqrt() + epsilon();
        let mut weights = RowList::repeat_entry(T::one());
        for cone in cones.iter().take(count) {
            weights[cone.normal] = self.delassus_matrix_entry(cone.normal, cone.normal).max(least);
            for (_, part) in cone.existing_friction_kinds() {
                let rows = part.first..part.first + part.count;
                let most = rows.clone().fold(least, |most, i| most.max(self.delassus_matrix_entry(i, i)));
                rows.for_each(|i| weights[i] = most);
            }
        }
        weights
    }

    /// Returns the best impulses of a sequence of convex problems that begins at given impulses; `matrix` is
    /// workspace.
    #[inline(never)]
    pub(super) fn solve_convex_sequence(
        &self,
        start: &RowList<T, NR>,
        matrix: &mut ContactRowMatrix<T, NR>,
    ) -> ImpulseTrial<T, NK, NR> {
        let mut convex = ConvexProblem::new(self);
        let weights = convex.weights;
        let mut best = self.evaluate_impulse_trial(*start);
        convex.begin_at_impulses(start);
        if (0..self.size).any(|i| start[i] != T::zero()) {
            convex.set_normal_velocity_increases(&best.rates);
        }
        let speed = self.largest_free_contact_velocity();
        let mut near = NEAR.into_iter().map(|part| speed * constant(part)).peekable();
        let (mut steps, mut left) = (0, speed);
        let [first, factor, last, smallest] = REGULARISATIONS.map(constant::<T>);
        let mut regularisation = first;
        for _ in 0..PROBLEMS {
            convex.weights = weights.map_entries(|weight| weight * regularisation);
            convex.evaluate_rates_and_impulses();
            let enough = (left / speed).min(T::one()) * constant(1e-2);
            steps += 1 + convex.minimise_by_newton(matrix, STEPS_OF_ONE, enough);
            let found = self.evaluate_impulse_trial(convex.impulses);
            let is_slow = found.worst.0 > left * constant(0.5);
            left = found.worst.0;
            // Comparisons with a violation that is not a number are false.
            if left < best.worst.0 {
                best = found;
            }
            if near.next_if(|near| left <= *near).is_some() {
                let exact = self.newton_impulses(found, matrix);
                if exact.worst.0 < best.worst.0 {
                    best = exact;
                }
            }
            let is_stalled = is_slow && best.worst.0 <= speed * constant(GOOD);
            if steps >= STEPS
                || is_stalled
                || best.worst.0 <= speed * constant(ENOUGH)
                || self.is_solved_by(&best)
                || self.is_small_violation(&best)
            {
                break;
            }
            convex.set_normal_velocity_increases(&found.rates);
            convex.center = convex.impulses;
            // Impulses that hardly affect the motion converge slowly with a large regularisation.
            regularisation = match is_slow && regularisation <= last {
                true => (regularisation * constant(0.1)).max(smallest),
                false => (regularisation * factor).max(last.min(regularisation)),
            };
        }
        best
    }
}
