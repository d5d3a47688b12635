//! Impulses by a sequence of convex problems, each of which has exactly one solution.
//!
//! With the impulses `Λ` in their friction cones `K`, and normal rates raised by `s`, a problem is
//!
//! ```text
//! min ½ |w|² + max over Λ in K of { −Λ·(u₀ + B w + s) − ½ (Λ − Λ̄)·R (Λ − Λ̄) },   W = B Bᵀ
//! ```
//!
//! It is strictly convex in `w`, the change of the velocity in the metric of the kinetic energy, for any rank
//! of `W`, and Newton's method with a line search finds its minimum from any start. Without `s` and with
//! `Λ̄ = 0` it is Anitescu's relaxation, regularised (Castro, Permenter and Han, *An unconstrained convex
//! formulation of compliant contact*, IEEE Trans. Robot. 39, 2023). `Λ̄`, the impulses of the problem before,
//! removes the effect of the regularisation `R` (method of multipliers), and `s = μ |uₜ|`, from the slip
//! before, that of the relaxation (Acary, Cadoux, Lemaréchal and Malick, *A formulation of the linear
//! discrete Coulomb friction problem via convex optimization*, ZAMM 91, 2011): where both stay the same,
//! Coulomb's law is satisfied. For every `s ≥ 0` the impulses take energy, so that a sequence that is cut off
//! adds none. If the violation of Coulomb's law is small, problems contain `s = μ |uₜ|` itself: Newton's
//! equations are then not symmetric, and convergence is quadratic.

use super::super::total::Total;
use super::trial::Trial;
use super::{List, Problem};
use crate::Real;
use crate::private::{constant, epsilon};

/// Problems in a sequence.
const PROBLEMS: usize = 16;
/// Steps of Newton's method in all problems of a sequence.
const STEPS: usize = 48;
/// Steps of Newton's method in one problem.
const STEPS_OF_ONE: usize = 12;
/// Halvings of a step where a problem is not convex.
const HALVINGS: usize = 4;
/// Evaluations of a line search.
const SEARCHES: usize = 10;
/// Regularisation of an impulse relative to its own diagonal entry of `W`: in the first problem, its factor
/// from problem to problem, its smallest value if these converge, and if they do not.
const REGULARISATIONS: [f64; 4] = [1e-2, 0.3, 1e-4, 1e-8];
/// Violation of Coulomb's law, relative to the largest contact velocity, below which problems contain
/// `s = μ |uₜ|` itself instead of its value from the previous problem.
const SMOOTH: f64 = 1e-2;
/// Violation that counts as zero, likewise, and violation at which a slow sequence ends.
const ENOUGH: f64 = 1e-12;
const GOOD: f64 = 1e-10;
/// Kinds of friction of a contact: slip, spin and rolling.
const PARTS: usize = 3;

/// Friction of a contact, or one of its moments.
#[derive(Clone, Copy)]
struct TangentRows<T> {
    first: usize,
    count: usize,
    friction: T,
}

/// Friction cone of a contact: the normal impulse and those that it bounds.
#[derive(Clone, Copy)]
struct Cone<T> {
    normal: usize,
    parts: [TangentRows<T>; PARTS],
    /// Normal impulse that acts in addition and bounds friction as well.
    floor: T,
    /// Smallest normal rate.
    least: T,
    /// Increase `s` of the normal rate.
    raised: T,
}

/// Projection onto a friction cone.
#[derive(Clone, Copy)]
struct Projection<T> {
    normal: T,
    is_pressed: bool,
    /// Regularisation of the impulse along the cone.
    along: T,
    /// Magnitudes before the projection, and whether they are bounded by friction.
    sizes: [T; PARTS],
    bounded: [bool; PARTS],
}

impl<T: Real> Cone<T> {
    /// Returns the kinds of friction that exist, with their indices.
    fn parts(&self) -> impl Iterator<Item = (usize, TangentRows<T>)> {
        self.parts.into_iter().enumerate().filter(|(_, part)| part.count > 0)
    }

    /// Returns the sum of the slip speeds times their coefficients of friction.
    fn slip<const NR: usize>(&self, rates: &List<T, NR>) -> T {
        self.parts().fold(T::zero(), |sum, (_, part)| {
            let rows = part.first..part.first + part.count;
            sum + part.friction * rows.fold(T::zero(), |sum, i| sum + rates[i] * rates[i]).sqrt()
        })
    }

    /// Returns the projection of `wanted` onto the cone in the metric of the regularisation.
    fn project<const NR: usize>(&self, wanted: &List<T, NR>, weights: &List<T, NR>) -> Projection<T> {
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
            for (k, part) in self.parts() {
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
        let is_pressed = normal > none;
        if !is_pressed {
            normal = none;
            for (k, part) in self.parts() {
                if let (Some(bounded), Some(size)) = (bounded.get_mut(k), sizes.get(k)) {
                    *bounded = *size > part.friction * self.floor;
                }
            }
        }
        Projection { normal, is_pressed, along, sizes, bounded }
    }

    /// Writes the impulses of a projection.
    fn place<const NR: usize>(
        &self,
        found: &Projection<T>,
        wanted: &List<T, NR>,
        impulses: &mut List<T, NR>,
    ) {
        impulses[self.normal] = found.normal;
        for (k, part) in self.parts() {
            let (Some(size), Some(bounded)) = (found.sizes.get(k), found.bounded.get(k)) else { continue };
            let bound = part.friction * (found.normal + self.floor);
            let factor = if *bounded { bound / *size } else { T::one() };
            (part.first..part.first + part.count).for_each(|i| impulses[i] = wanted[i] * factor);
        }
    }
}

/// Returns a row of a matrix that is stored row by row.
fn row<T>(matrix: &[T], width: usize, i: usize) -> &[T] {
    matrix.get(i * width..(i + 1) * width).unwrap_or_default()
}

/// Returns a mutable row.
fn row_mut<T>(matrix: &mut [T], width: usize, i: usize) -> &mut [T] {
    matrix.get_mut(i * width..(i + 1) * width).unwrap_or_default()
}

fn dot<T: Real>(a: &[T], b: &[T]) -> T {
    a.iter().zip(b).fold(T::zero(), |sum, (a, b)| sum + *a * *b)
}

fn add<T: Real>(to: &mut [T], factor: T, from: &[T]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * *from);
}

/// Factorises a symmetric positive definite matrix in place, of which the lower half is read: `L` with the
/// reciprocals of its diagonal.
fn cholesky<T: Real>(matrix: &mut [T], size: usize) {
    for i in 0..size {
        let (done, rest) = matrix.split_at_mut_checked(i * size).unwrap_or_default();
        let Some(own) = rest.get_mut(..size) else { return };
        for j in 0..i {
            let above = row(done, size, j);
            let sum = dot(own.get(..j).unwrap_or_default(), above.get(..j).unwrap_or_default());
            let reciprocal = above.get(j).copied().unwrap_or(T::zero());
            if let Some(entry) = own.get_mut(j) {
                *entry = (*entry - sum) * reciprocal;
            }
        }
        let square = own.iter().take(i).fold(T::zero(), |sum, entry| sum + *entry * *entry);
        if let Some(entry) = own.get_mut(i) {
            *entry = T::one() / (*entry - square).max(epsilon()).sqrt();
        }
    }
}

/// Solves for `x` with the factor of [`cholesky`].
fn substitute<T: Real>(factor: &[T], size: usize, x: &mut [T]) {
    for i in 0..size {
        let own = row(factor, size, i);
        let sum = dot(own.get(..i).unwrap_or_default(), x);
        if let (Some(x), Some(reciprocal)) = (x.get_mut(i), own.get(i)) {
            *x = (*x - sum) * *reciprocal;
        }
    }
    for i in (0..size).rev() {
        let own = row(factor, size, i);
        let Some(reciprocal) = own.get(i) else { continue };
        let Some((last, rest)) = x.get_mut(..=i).and_then(<[T]>::split_last_mut) else { continue };
        *last *= *reciprocal;
        add(rest, -*last, own.get(..i).unwrap_or_default());
    }
}

/// A convex problem, and the state of its solution.
struct Convex<'a, T, const NK: usize, const NR: usize> {
    problem: &'a Problem<T, NK, NR>,
    /// Rows of `B`.
    basis: &'a [T],
    rank: usize,
    cones: Total<Cone<T>, NK>,
    count: usize,
    /// `R` and `Λ̄`.
    weights: List<T, NR>,
    center: List<T, NR>,
    /// Whether `s` is the present slip, and not that of the problem before.
    is_smooth: bool,
    /// `w`, in as many entries as the rank.
    w: List<T, NR>,
    rates: List<T, NR>,
    impulses: List<T, NR>,
}

impl<T: Real, const NK: usize, const NR: usize> Convex<'_, T, NK, NR> {
    fn cones(&self) -> impl Iterator<Item = &Cone<T>> {
        self.cones.iter().take(self.count)
    }

    /// Writes the impulses before their projection for contact velocities `rates`.
    fn predict(&self, cone: &Cone<T>, rates: &List<T, NR>, wanted: &mut List<T, NR>) {
        let prediction = |i: usize, rate: T| self.center[i] - rate / self.weights[i];
        let (n, raised) = (cone.normal, if self.is_smooth { cone.slip(rates) } else { cone.raised });
        wanted[n] = prediction(n, rates[n] + raised - cone.least);
        for (_, part) in cone.parts() {
            (part.first..part.first + part.count).for_each(|i| wanted[i] = prediction(i, rates[i]));
        }
    }

    /// Returns the impulses for contact velocities `rates`.
    fn impulses_at(&self, rates: &List<T, NR>) -> List<T, NR> {
        let (mut wanted, mut impulses) = (List::repeat(T::zero()), List::repeat(T::zero()));
        for cone in self.cones() {
            self.predict(cone, rates, &mut wanted);
            cone.place(&cone.project(&wanted, &self.weights), &wanted, &mut impulses);
        }
        impulses
    }

    /// Begins at given impulses `Λ`: `Λ̄ = Λ` and `w = Bᵀ Λ`.
    fn begin(&mut self, impulses: &List<T, NR>) {
        (self.center, self.w) = (*impulses, List::repeat(T::zero()));
        for i in (0..self.problem.size).filter(|i| impulses[*i] != T::zero()) {
            let w = self.w.get_mut(..self.rank).unwrap_or_default();
            add(w, impulses[i], row(self.basis, self.rank, i));
        }
    }

    /// Returns `B w`.
    fn spread_basis(&self, w: &List<T, NR>) -> List<T, NR> {
        let mut rates = List::repeat(T::zero());
        for i in 0..self.problem.size {
            rates[i] = dot(row(self.basis, self.rank, i), w.get(..self.rank).unwrap_or_default());
        }
        rates
    }

    /// Evaluates contact velocities and impulses at `w`.
    fn evaluate(&mut self) {
        self.rates = self.spread_basis(&self.w);
        for i in 0..self.problem.size {
            self.rates[i] += self.problem.free[i];
        }
        self.impulses = self.impulses_at(&self.rates);
    }

    /// Writes the derivative of the gradient by `w`: `1 + Bᵀ H B`.
    fn curvature(&self, matrix: &mut [T]) {
        let (rank, none) = (self.rank, T::zero());
        matrix.iter_mut().take(rank * rank).for_each(|entry| *entry = none);
        (0..rank).for_each(|i| {
            if let Some(entry) = matrix.get_mut(i * rank + i) {
                *entry = T::one();
            }
        });
        let (mut wanted, zeros) = (List::repeat(none), List::<T, NR>::repeat(none));
        let is_smooth = self.is_smooth;
        let mut add_product = |left: &[T], right: &[T], factor: T| {
            for (i, value) in left.iter().enumerate().filter(|(_, value)| **value != none) {
                let width = if is_smooth { rank } else { i + 1 };
                let own = matrix.get_mut(i * rank..i * rank + width).unwrap_or_default();
                add(own, factor * *value, right);
            }
        };
        for cone in self.cones() {
            self.predict(cone, &self.rates, &mut wanted);
            let found = cone.project(&wanted, &self.weights);
            // Along the cone: the normal rate, and the rates of friction at its bound.
            let mut along = zeros;
            along.iter_mut().zip(row(self.basis, rank, cone.normal)).for_each(|(to, from)| *to = *from);
            let mut slip = zeros;
            for (k, part) in cone.parts() {
                let (Some(size), Some(bounded)) = (found.sizes.get(k), found.bounded.get(k)) else {
                    continue;
                };
                let rows = part.first..part.first + part.count;
                let weight = self.weights[part.first];
                if is_smooth && found.is_pressed {
                    let speed = rows.clone().fold(none, |sum, i| sum + self.rates[i] * self.rates[i]).sqrt();
                    let slip = slip.get_mut(..rank).unwrap_or_default();
                    for i in rows.clone().filter(|_| speed > none) {
                        add(slip, part.friction * self.rates[i] / speed, row(self.basis, rank, i));
                    }
                }
                if !bounded {
                    if found.is_pressed || cone.floor > none {
                        rows.for_each(|i| {
                            let own = row(self.basis, rank, i);
                            add_product(own, own, T::one() / weight);
                        });
                    }
                    continue;
                }
                if found.is_pressed {
                    let along = along.get_mut(..rank).unwrap_or_default();
                    for i in rows.clone() {
                        add(along, part.friction * wanted[i] / *size, row(self.basis, rank, i));
                    }
                }
                // Across the direction of friction.
                let bound = part.friction * (found.normal + cone.floor);
                if part.count == 2 && bound > none {
                    let (x, y) = (wanted[part.first] / *size, wanted[part.first + 1] / *size);
                    let mut across = zeros;
                    let across = across.get_mut(..rank).unwrap_or_default();
                    add(across, -y, row(self.basis, rank, part.first));
                    add(across, x, row(self.basis, rank, part.first + 1));
                    add_product(across, across, bound / (*size * weight));
                }
            }
            if found.is_pressed {
                let (along, slip) =
                    (along.get(..rank).unwrap_or_default(), slip.get_mut(..rank).unwrap_or_default());
                add(slip, T::one(), along);
                add_product(along, slip, T::one() / found.along);
            }
        }
    }

    /// Returns the negative gradient, `Bᵀ Λ − w`.
    fn descent(&self) -> List<T, NR> {
        let mut descent = List::repeat(T::zero());
        (0..self.rank).for_each(|i| descent[i] = -self.w[i]);
        for i in (0..self.problem.size).filter(|i| self.impulses[*i] != T::zero()) {
            let descent = descent.get_mut(..self.rank).unwrap_or_default();
            add(descent, self.impulses[i], row(self.basis, self.rank, i));
        }
        descent
    }

    fn largest(&self, x: &List<T, NR>) -> T {
        x.iter().take(self.rank).fold(T::zero(), |most, x| most.max(x.abs()))
    }

    /// Newton's method with at most this number of steps, until the gradient is below a part of `w`; returns
    /// how many there were.
    fn minimise(&mut self, matrix: &mut [T], most: usize, enough: T) -> usize {
        let rank = self.rank;
        let little = epsilon::<T>().powf(constant(0.72));
        for step in 0..most {
            let gradient = self.descent();
            let (left, size) = (self.largest(&gradient), self.largest(&self.w));
            if left <= size * little || (step > 0 && left <= size * enough) {
                return step;
            }
            let mut change = gradient;
            self.curvature(matrix);
            if self.is_smooth {
                eliminate(matrix, rank, change.get_mut(..rank).unwrap_or_default());
                let from = self.w;
                let mut part = T::one();
                for _ in 0..HALVINGS {
                    self.w = from;
                    (0..rank).for_each(|i| self.w[i] += change[i] * part);
                    self.evaluate();
                    if self.largest(&self.descent()) < left {
                        break;
                    }
                    part *= constant(0.5);
                }
                continue;
            }
            cholesky(matrix, rank);
            substitute(matrix, rank, change.get_mut(..rank).unwrap_or_default());
            let rates = self.spread_basis(&change);
            let slope = |part: T| {
                let mut at = self.rates;
                (0..self.problem.size).for_each(|i| at[i] += rates[i] * part);
                let impulses = self.impulses_at(&at);
                let kinetic =
                    (0..rank).fold(T::zero(), |sum, i| sum + (self.w[i] + change[i] * part) * change[i]);
                (0..self.problem.size).fold(kinetic, |sum, i| sum - impulses[i] * rates[i])
            };
            let start = -(0..rank).fold(T::zero(), |sum, i| sum + gradient[i] * change[i]);
            let part = root(start, slope);
            (0..rank).for_each(|i| self.w[i] += change[i] * part);
            self.evaluate();
        }
        most
    }
}

/// Solves a system of equations in place by Gaussian elimination with pivots of the columns.
fn eliminate<T: Real>(matrix: &mut [T], size: usize, x: &mut [T]) {
    for column in 0..size {
        let entry = |matrix: &[T], i: usize| row(matrix, size, i).get(column).copied().unwrap_or(T::zero());
        let mut best = column;
        for i in column + 1..size {
            if entry(matrix, i).abs() > entry(matrix, best).abs() {
                best = i;
            }
        }
        if best != column {
            let (above, below) = matrix.split_at_mut_checked(best * size).unwrap_or_default();
            let other = below.get_mut(..size).unwrap_or_default();
            row_mut(above, size, column).iter_mut().zip(other).for_each(|(a, b)| core::mem::swap(a, b));
            if let Some((above, below)) = x.split_at_mut_checked(best)
                && let (Some(a), Some(b)) = (above.get_mut(column), below.first_mut())
            {
                core::mem::swap(a, b);
            }
        }
        let (done, rest) = matrix.split_at_mut_checked((column + 1) * size).unwrap_or_default();
        let own = row(done, size, column).get(column..).unwrap_or_default();
        let (Some(pivot), Some(value)) = (own.first(), x.get(column).copied()) else { return };
        if *pivot == T::zero() {
            continue;
        }
        for k in 0..size - column - 1 {
            let below = row_mut(rest, size, k).get_mut(column..).unwrap_or_default();
            let factor = below.first().map_or(T::zero(), |entry| *entry / *pivot);
            if factor != T::zero() {
                add(below, -factor, own);
                if let Some(x) = x.get_mut(column + 1 + k) {
                    *x -= factor * value;
                }
            }
        }
    }
    for i in (0..size).rev() {
        let own = row(matrix, size, i);
        let (known, rest) = (x.get(i + 1..).unwrap_or_default(), own.get(i + 1..).unwrap_or_default());
        let sum = dot(rest, known);
        if let (Some(x), Some(pivot)) = (x.get_mut(i), own.get(i)) {
            *x = if *pivot == T::zero() { T::zero() } else { (*x - sum) / *pivot };
        }
    }
}

/// Returns a step length, at most one, at which the slope along a convex function is small.
fn root<T: Real>(start: T, slope: impl Fn(T) -> T) -> T {
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

impl<T: Real, const NK: usize, const NR: usize> Problem<T, NK, NR> {
    /// Writes `B` with `W = B Bᵀ` column by column (Cholesky with pivots), and returns its rank.
    fn basis(&self, basis: &mut [T]) -> usize {
        let size = self.size;
        // Columns first, one after another.
        let mut left = List::<T, NR>::repeat(T::zero());
        (0..size).for_each(|i| left[i] = self.weights[i][i]);
        let reach = left.iter().take(size).fold(T::zero(), |most, x| most.max(*x));
        let mut rank = 0;
        while rank < size {
            let mut best = 0;
            (0..size).for_each(|i| {
                if left[i] > left[best] {
                    best = i
                }
            });
            let pivot = left[best];
            let is_done = pivot <= reach * epsilon::<T>() * constant(64.0);
            if is_done {
                break;
            }
            let reciprocal = T::one() / pivot.sqrt();
            let (done, rest) = basis.split_at_mut_checked(rank * size).unwrap_or_default();
            let column = rest.get_mut(..size).unwrap_or_default();
            column.iter_mut().zip(self.weights[best].iter()).for_each(|(to, from)| *to = *from);
            for k in 0..rank {
                let before = row(done, size, k);
                let factor = before.get(best).copied().unwrap_or(T::zero());
                if factor != T::zero() {
                    add(column, -factor, before);
                }
            }
            for (i, entry) in column.iter_mut().enumerate() {
                *entry *= reciprocal;
                left[i] -= *entry * *entry;
            }
            left[best] = -T::one();
            rank += 1;
        }
        rank
    }

    /// Returns the best impulses of a sequence of convex problems that begins at given impulses.
    #[inline(never)]
    pub(super) fn by_convex_problems(&self, start: &List<T, NR>) -> Trial<T, NK, NR> {
        let mut columns = [[T::zero(); NR]; NR];
        let rank = self.basis(columns.as_flattened_mut());
        let mut rows = [[T::zero(); NR]; NR];
        let basis = rows.as_flattened_mut();
        for i in 0..self.size {
            for (j, entry) in row_mut(basis, rank, i).iter_mut().enumerate() {
                *entry = columns.as_flattened().get(j * self.size + i).copied().unwrap_or(T::zero());
            }
        }
        // Not needed any more.
        let matrix = columns.as_flattened_mut();
        let none = TangentRows { first: 0, count: 0, friction: T::zero() };
        let cone =
            Cone { normal: 0, parts: [none; PARTS], floor: T::zero(), least: T::zero(), raised: T::zero() };
        let (mut cones, mut count) = (Total::<_, NK>::repeat(cone), 0);
        for k in (0..self.count).filter(|k| self.is_gap(*k)) {
            let mut parts = [none; PARTS];
            let others = (k..self.count).filter(|other| self.pressed_by[*other] == k);
            for (part, other) in parts.iter_mut().zip(others) {
                let tangents = self.of(other).1;
                *part = TangentRows {
                    first: tangents.start,
                    count: tangents.len(),
                    friction: self.friction[other],
                };
            }
            cones[count] = Cone {
                normal: self.rows[k].first,
                parts,
                floor: self.floor[k],
                least: self.least[k],
                ..cone
            };
            count += 1;
        }
        let reach = (0..self.size).fold(T::zero(), |most, i| most.max(self.weights[i][i]));
        let mut weights = List::repeat(T::one());
        let least = reach * epsilon::<T>().sqrt() + epsilon();
        for cone in cones.iter().take(count) {
            weights[cone.normal] = self.weights[cone.normal][cone.normal].max(least);
            for (_, part) in cone.parts() {
                let rows = part.first..part.first + part.count;
                let most = rows.clone().fold(least, |most, i| most.max(self.weights[i][i]));
                rows.for_each(|i| weights[i] = most);
            }
        }
        let zeros = List::repeat(T::zero());
        let mut convex = Convex {
            problem: self,
            basis,
            rank,
            cones,
            count,
            weights,
            center: zeros,
            is_smooth: false,
            w: zeros,
            rates: zeros,
            impulses: zeros,
        };
        convex.begin(start);
        let raise = |convex: &mut Convex<'_, T, NK, NR>, rates: &List<T, NR>| {
            (0..count).for_each(|k| convex.cones[k].raised = convex.cones[k].slip(rates));
        };
        let mut best = self.tried(*start);
        if (0..self.size).any(|i| start[i] != T::zero()) {
            raise(&mut convex, &best.rates);
        }
        let speed = self.speed();
        let (mut steps, mut left, mut may_be_smooth) = (0, speed, true);
        let [first, factor, last, smallest] = REGULARISATIONS.map(constant::<T>);
        let mut regularisation = first;
        for _ in 0..PROBLEMS {
            convex.weights = weights.each(|weight| weight * regularisation);
            convex.is_smooth = may_be_smooth && left < speed * constant(SMOOTH);
            convex.evaluate();
            let enough = (left / speed).min(T::one()) * constant(1e-2);
            steps += 1 + convex.minimise(matrix, STEPS_OF_ONE, enough);
            let found = self.tried(convex.impulses);
            let is_slow = found.worst.0 > left * constant(0.5);
            left = found.worst.0;
            // It is no worse where it is no number, either.
            let is_better = left < best.worst.0;
            if is_better {
                best = found;
            }
            let is_stalled = is_slow && best.worst.0 <= speed * constant(GOOD);
            if steps >= STEPS || is_stalled || left <= speed * constant(ENOUGH) || self.solves(&best) {
                break;
            }
            if convex.is_smooth && !is_better {
                // Newton's equations that are not symmetric can lead away.
                may_be_smooth = left <= best.worst.0 * constant(2.0);
                left = best.worst.0;
                raise(&mut convex, &best.rates);
                convex.begin(&best.impulses);
            } else {
                raise(&mut convex, &found.rates);
                convex.center = convex.impulses;
            }
            // Impulses that the motion can hardly tell apart converge slowly with a large regularisation.
            regularisation = match is_slow && regularisation <= last {
                true => (regularisation * constant(0.1)).max(smallest),
                false => (regularisation * factor).max(last.min(regularisation)),
            };
        }
        best
    }
}
