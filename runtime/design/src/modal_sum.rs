//! Sums of decaying modes over time. Their crossings and extremes are found by bounds over intervals, without
//! sampling.

use crate::Error;
use crate::margins::root_between;
use crate::matrices::{C, CMatrix, Schur, balance_matrix, to_complex_matrix};
use nalgebra::DMatrix;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Maximum entry of the transformation that separates two groups of modes; groups that exceed it are merged.
const MAX_COUPLING: f64 = 1e4;
/// Maximum number of terms in the series of a group of modes.
const MAX_TERMS: usize = 300;
/// Maximum number of intervals that one search for extrema or crossings visits.
const MAX_INTERVALS: usize = 2_000_000;
/// Magnitude of eigenvalues below which modes of sampled systems are below rounding error after
/// `FIRST_SAMPLES`.
const FAST: f64 = 0.3;
/// Number of samples of a sampled system that are computed individually.
pub(crate) const FIRST_SAMPLES: usize = 64;

const FAILED: Error = Error::NotConverged { what: "the separation of the modes" };

/// Mode, or group of modes whose eigenvalues nearly coincide: `e^{λ t} P(t)`.
struct ModalTerm {
    exponent: C,
    /// Coefficients of the polynomial `P` in the term `e^{λ t} P(t)`, lowest power first.
    coefficients: Vec<C>,
}

impl ModalTerm {
    /// Returns the term of `c e^{T t} x`, or of `c Tᵗ x` if `sampled`, for a triangular matrix `T` whose
    /// eigenvalues nearly coincide. Returns `None` for fast modes of sampled systems.
    fn modal_term_of_eigenvalue_group(
        c: &CMatrix,
        t: &CMatrix,
        x: &CMatrix,
        sampled: bool,
    ) -> Result<Option<Self>, Error> {
        let k = t.nrows();
        let center = t.diagonal().sum() / k as f64;
        if sampled && center.norm() < FAST {
            return Ok(None);
        }
        let mut nilpotent = t - CMatrix::identity(k, k) * center;
        if sampled {
            nilpotent = logarithm_of_one_plus_matrix(&(nilpotent / center))?;
        }
        let exponent = if sampled { center.ln() } else { center };
        if exponent.re >= 0.0 {
            return Err(FAILED);
        }
        let mut coefficients = Vec::new();
        let mut v = x.clone();
        let mut largest = f64::NEG_INFINITY;
        for j in 0..MAX_TERMS {
            coefficients.push((c * &v)[(0, 0)]);
            let size = (c.norm() * v.norm()).ln() + logarithm_of_modal_peak(j, exponent);
            largest = largest.max(size);
            if k == 1 || (j + 1 >= k && (size.is_nan() || size <= largest - 46.0)) {
                return Ok(Some(Self { exponent, coefficients }));
            }
            v = &nilpotent * v / C::new((j + 1) as f64, 0.0);
        }
        Err(FAILED)
    }

    /// Evaluates the polynomial factor of the term at an instant.
    fn evaluate_polynomial(&self, t: f64) -> C {
        self.coefficients.iter().rev().fold(C::new(0.0, 0.0), |sum, c| sum * t + c)
    }

    /// Returns an upper bound of the magnitude of the term from time `low` to time `high`.
    fn bound_on_interval(&self, low: f64, high: f64) -> f64 {
        let polynomial = self.coefficients.iter().rev().fold(0.0, |sum, c| sum * high + c.norm());
        if polynomial == 0.0 { 0.0 } else { (self.exponent.re * low).exp() * polynomial }
    }

    /// Returns an upper bound of the magnitude of the term at all instants.
    fn bound_at_all_instants(&self) -> f64 {
        let peak_bound_of_coefficient =
            |(k, c): (usize, &C)| (c.norm().ln() + logarithm_of_modal_peak(k, self.exponent)).exp();
        self.coefficients.iter().enumerate().map(peak_bound_of_coefficient).sum()
    }

    fn derivative_of_term(&self) -> Self {
        let next_coefficient =
            |k: usize| self.coefficients.get(k + 1).map_or(C::new(0.0, 0.0), |c| c * (k + 1) as f64);
        let own = self.coefficients.iter().enumerate();
        let coefficients = own.map(|(k, c)| self.exponent * c + next_coefficient(k)).collect();
        Self { exponent: self.exponent, coefficients }
    }
}

/// Returns the logarithm of the maximum of `tᵏ |e^{λ t}|` over time, which is at `t = k / −Re λ`.
fn logarithm_of_modal_peak(k: usize, exponent: C) -> f64 {
    let k = k as f64;
    if k == 0.0 { 0.0 } else { k * (k / -exponent.re).ln() - k }
}

/// Computes the matrix logarithm `ln(I + M)` for a small triangular matrix `M` by its power series.
fn logarithm_of_one_plus_matrix(m: &CMatrix) -> Result<CMatrix, Error> {
    let mut sum = m.clone();
    let mut power = m.clone();
    for j in 2..MAX_TERMS {
        power = -(&power * m);
        if power.norm() <= 1e-18 * sum.norm() {
            return Ok(sum);
        }
        sum += &power / C::new(j as f64, 0.0);
    }
    Err(FAILED)
}

/// Solves `T₁ X − X T₂ = −T₁₂` for `X`, where `T₁` has the leading `k` rows and columns of a triangular
/// matrix.
fn solve_block_sylvester(t: &CMatrix, k: usize) -> CMatrix {
    let m = t.nrows();
    let mut x = CMatrix::zeros(k, m - k);
    for j in 0..m - k {
        for i in (0..k).rev() {
            let known: C = (0..j).map(|l| x[(i, l)] * t[(k + l, k + j)]).sum();
            let below: C = (i + 1..k).map(|l| t[(i, l)] * x[(l, j)]).sum();
            x[(i, j)] = (known - below - t[(i, k + j)]) / (t[(i, i)] - t[(k + j, k + j)]);
        }
    }
    x
}

/// Real sum of modes as a function of time: `c e^{A t} x` for a stable matrix, or `c Aᵏ x`, where time counts
/// samples.
pub(crate) struct ModalSum {
    /// Terms of the modal sum, each with its first three derivatives.
    terms: Vec<[ModalTerm; 4]>,
    /// Whether time counts samples, so that only integer instants exist.
    sampled: bool,
    /// Rounding error of the sum; smaller differences are not significant.
    pub noise: f64,
    /// Instant after which the magnitude of the modal sum is below `noise`.
    end: f64,
}

/// Time interval of a search, with bounds of the modal sum on it.
struct BoundedInterval {
    from: f64,
    to: f64,
    low: f64,
    high: f64,
    middle: f64,
    /// Whether the sum or its derivative is monotone on the interval, so that at most one local extremum is
    /// inside.
    simple: bool,
}

/// Interval with the bound by which the search for an extremum ranks it.
struct IntervalRankedByBound(f64, BoundedInterval);

impl PartialEq for IntervalRankedByBound {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for IntervalRankedByBound {}

impl PartialOrd for IntervalRankedByBound {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for IntervalRankedByBound {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl ModalSum {
    /// Separates a system into modes (Bavely and Stewart, *An algorithm for computing reducing subspaces by
    /// block diagonalization*, 1979), and returns their sum. Fast modes of a sampled system are omitted.
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`] if modes cannot be separated.
    pub fn new(c: &DMatrix<f64>, a: &DMatrix<f64>, x: &DMatrix<f64>, sampled: bool) -> Result<Self, Error> {
        let (a, d) = balance_matrix(a);
        let mut rest = Schur::new(&to_complex_matrix(&a))?;
        let mut c = CMatrix::from_fn(1, d.len(), |_, j| C::new(c[(0, j)] * d[j], 0.0));
        let mut x = CMatrix::from_fn(d.len(), 1, |i, _| C::new(x[(i, 0)] / d[i], 0.0));
        let mut terms = Vec::new();
        while rest.t.nrows() > 0 {
            let m = rest.t.nrows();
            let mut k = 1;
            let separate = loop {
                let found = solve_block_sylvester(&rest.t, k);
                if found.iter().all(|x| x.norm() <= MAX_COUPLING) {
                    break found;
                }
                let center = rest.t.diagonal().rows(0, k).sum() / k as f64;
                let eigenvalue_distance_to_center = |j: &usize| (rest.t[(*j, *j)] - center).norm();
                let nearest = (k..m).min_by(|i, j| {
                    eigenvalue_distance_to_center(i).total_cmp(&eigenvalue_distance_to_center(j))
                });
                rest.raise_eigenvalue(nearest.unwrap_or(k), k);
                k += 1;
            };
            (c, x) = (c * &rest.q, rest.q.adjoint() * x);
            let (own_c, others_x) = (c.columns(0, k).into_owned(), x.rows(k, m - k).into_owned());
            let own_x = x.rows(0, k) - &separate * &others_x;
            let block = rest.t.view((0, 0), (k, k)).into_owned();
            terms.extend(ModalTerm::modal_term_of_eigenvalue_group(&own_c, &block, &own_x, sampled)?);
            (c, x) = (c.columns(k, m - k) + own_c * separate, others_x);
            let t = rest.t.view((k, k), (m - k, m - k)).into_owned();
            rest = Schur { q: CMatrix::identity(m - k, m - k), t };
        }
        Ok(Self::modal_sum_of_terms(terms, sampled))
    }

    fn modal_sum_of_terms(terms: Vec<ModalTerm>, sampled: bool) -> Self {
        let noise =
            64.0 * f64::EPSILON * terms.iter().map(ModalTerm::bound_at_all_instants).sum::<f64>().max(1.0);
        // A term decays beyond the last maximum of its powers.
        let decay_time_of_term = |term: &ModalTerm| term.coefficients.len() as f64 / -term.exponent.re;
        let mut end = terms.iter().map(decay_time_of_term).fold(0.0, f64::max);
        while terms.iter().map(|term| term.bound_on_interval(end, end)).sum::<f64>() > noise {
            end *= 1.5;
        }
        let term_with_derivatives = |term: ModalTerm| {
            let first = term.derivative_of_term();
            let second = first.derivative_of_term();
            let third = second.derivative_of_term();
            [term, first, second, third]
        };
        Self {
            terms: terms.into_iter().map(term_with_derivatives).collect(),
            sampled,
            noise,
            end: if sampled { end.ceil() } else { end },
        }
    }

    /// Returns the derivative of the modal sum, of this order, at an instant.
    fn derivative_at(&self, order: usize, t: f64) -> f64 {
        let real_part_of_term =
            |all: &[ModalTerm; 4]| ((all[0].exponent * t).exp() * all[order].evaluate_polynomial(t)).re;
        self.terms.iter().map(real_part_of_term).sum()
    }

    /// Returns the value of the modal sum at an instant.
    pub fn value(&self, t: f64) -> f64 {
        self.derivative_at(0, t)
    }

    fn bound_sum_on_interval(&self, from: f64, to: f64) -> BoundedInterval {
        let half = 0.5 * (to - from);
        let t = from + half;
        let (mut middle, mut near, mut slope, mut curvature, mut far) = (0.0, 0.0, 0.0, 0.0, 0.0);
        let (mut total_slope, mut total_curvature, mut bend, mut change) = (0.0, 0.0, 0.0, 0.0);
        for all in &self.terms {
            let oscillation = (all[0].exponent * t).exp();
            let [value, first, second] = [0, 1, 2].map(|k| (oscillation * all[k].evaluate_polynomial(t)).re);
            let (largest, largest_second) =
                (all[0].bound_on_interval(from, to), all[2].bound_on_interval(from, to));
            middle += value;
            total_slope += first;
            total_curvature += largest_second;
            bend += second;
            change += all[3].bound_on_interval(from, to);
            // The term is bounded by its expansion about the midpoint, or by its magnitude if it
            // oscillates many times.
            if first.abs() * half + 0.5 * largest_second * half * half < largest {
                near += value;
                slope += first;
                curvature += largest_second;
            } else {
                far += largest;
            }
        }
        let radius = slope.abs() * half + 0.5 * curvature * half * half + far;
        let simple = total_slope.abs() >= total_curvature * half || bend.abs() >= change * half;
        BoundedInterval { from, to, low: near - radius, high: near + radius, middle, simple }
    }

    /// Whether an interval is final, so that it is not divided further.
    fn is_indivisible_interval(&self, interval: &BoundedInterval) -> bool {
        let length = interval.to - interval.from;
        interval.simple
            || if self.sampled { length <= 1.0 } else { length <= 8.0 * f64::EPSILON * interval.to }
    }

    /// Divides a time interval into two halves, with bounds of the sum on each.
    fn split_bounded_interval(&self, interval: &BoundedInterval) -> [BoundedInterval; 2] {
        let middle = interval.from + 0.5 * (interval.to - interval.from);
        let middle = if self.sampled { middle.floor() } else { middle };
        [self.bound_sum_on_interval(interval.from, middle), self.bound_sum_on_interval(middle, interval.to)]
    }

    /// Divides a final interval at a local extremum of the sum, so that the sum is monotone on each piece.
    fn monotone_pieces(&self, interval: &BoundedInterval) -> Vec<(f64, f64)> {
        let (from, to) = (interval.from, interval.to);
        let first_derivative = |t: f64| self.derivative_at(1, t);
        let mut ends = vec![from];
        if first_derivative(from) * first_derivative(to) < 0.0 {
            let turn = root_between(first_derivative, from, to);
            if self.sampled {
                ends.extend([turn.floor(), turn.ceil()]);
            } else {
                ends.push(turn);
            }
        }
        ends.push(to);
        ends.windows(2).filter(|pair| pair[0] < pair[1]).map(|pair| (pair[0], pair[1])).collect()
    }

    /// Returns the time at which a function of the modal sum changes its sign on an interval where it is
    /// monotone. For a sampled sum this is the sample on the nonnegative side.
    fn time_of_sign_change(&self, f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
        if !self.sampled {
            return root_between(|t| f(self.value(t)), from, to);
        }
        let rises = f(self.value(to)) >= 0.0;
        let (mut low, mut high) = (from, to);
        while high - low > 1.0 {
            let middle = (0.5 * (low + high)).floor();
            if (f(self.value(middle)) >= 0.0) == rises { high = middle } else { low = middle }
        }
        if rises { high } else { low }
    }

    /// Returns the first instant, not before `from`, at which the modal sum reaches a negative level from
    /// below.
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`] after too many intervals.
    pub fn first_above(&self, level: f64, from: f64) -> Result<f64, Error> {
        let mut open = vec![self.bound_sum_on_interval(from, self.end.max(from))];
        let mut count = 0;
        while let Some(interval) = open.pop() {
            if interval.high + self.noise < level {
                continue;
            }
            if self.is_indivisible_interval(&interval) {
                for (low, high) in self.monotone_pieces(&interval) {
                    if self.value(low) >= level {
                        return Ok(low);
                    }
                    if self.value(high) >= level {
                        return Ok(self.time_of_sign_change(|e| e - level, low, high));
                    }
                }
            } else {
                let [left, right] = self.split_bounded_interval(&interval);
                open.extend([right, left]);
            }
            count_interval_or_error(&mut count)?;
        }
        Ok(self.end.max(from))
    }

    /// Returns the last instant, not before `from`, at which the magnitude of the modal sum exceeds `band`;
    /// `None` if it never does.
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`] after too many intervals.
    pub fn last_outside(&self, band: f64, from: f64) -> Result<Option<f64>, Error> {
        let mut open = vec![self.bound_sum_on_interval(from, self.end.max(from))];
        let mut count = 0;
        while let Some(interval) = open.pop() {
            if interval.high.max(-interval.low) + self.noise <= band {
                continue;
            }
            if self.is_indivisible_interval(&interval) {
                for (low, high) in self.monotone_pieces(&interval).into_iter().rev() {
                    if self.value(high).abs() > band {
                        return Ok(Some(high));
                    }
                    if self.value(low).abs() > band {
                        return Ok(Some(self.time_of_sign_change(|e| e.abs() - band, low, high)));
                    }
                }
            } else {
                open.extend(self.split_bounded_interval(&interval));
            }
            count_interval_or_error(&mut count)?;
        }
        Ok((self.value(from).abs() > band).then_some(from))
    }

    /// Returns the instant and the value of the maximum (`sign` one) or minimum (`sign` −1) of the modal sum
    /// from the time `from` on.
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`] after too many intervals.
    pub fn extreme(&self, sign: f64, from: f64) -> Result<(f64, f64), Error> {
        let mut best = (from, sign * self.value(from));
        let mut reached = best.1;
        let bound_of_interval =
            |interval: &BoundedInterval| self.noise + if sign > 0.0 { interval.high } else { -interval.low };
        let mut open = BinaryHeap::new();
        let whole = self.bound_sum_on_interval(from, self.end.max(from));
        open.push(IntervalRankedByBound(bound_of_interval(&whole), whole));
        let mut count = 0;
        while let Some(IntervalRankedByBound(most, interval)) = open.pop() {
            if most <= best.1 + 2.0 * self.noise || most < reached {
                break;
            }
            if self.is_indivisible_interval(&interval) {
                for t in self.monotone_pieces(&interval).into_iter().flat_map(|(low, high)| [low, high]) {
                    let value = sign * self.value(t);
                    if value > best.1 {
                        best = (t, value);
                    }
                }
            } else {
                for half in self.split_bounded_interval(&interval) {
                    if !self.sampled {
                        reached = reached.max(sign * half.middle);
                    }
                    open.push(IntervalRankedByBound(bound_of_interval(&half), half));
                }
            }
            count_interval_or_error(&mut count)?;
        }
        Ok((best.0, sign * best.1))
    }
}

fn count_interval_or_error(count: &mut usize) -> Result<(), Error> {
    *count += 1;
    if *count > MAX_INTERVALS { Err(Error::NotConverged { what: "the search over time" }) } else { Ok(()) }
}
