//! Margins of a loop.

use crate::frequency::{FrequencyMap, boundary};
use crate::matrices::C;
use crate::{Error, StateSpace, TransferFunction};
use nalgebra::DMatrix;

/// Where a loop's response is real and negative: the factor that would bring it to the border of stability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainMargin {
    /// The factor; below one it is a reduction.
    pub factor: f64,
    /// rad/s.
    pub frequency: f64,
}

impl GainMargin {
    /// In decibels.
    pub fn decibels(&self) -> f64 {
        20.0 * self.factor.log10()
    }
}

/// Where a loop's magnitude is one: the lag that would bring it to the border of stability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseMargin {
    /// Degrees, within ±180; negative ones are leads.
    pub degrees: f64,
    /// rad/s.
    pub frequency: f64,
}

impl PhaseMargin {
    /// The delay that takes the margin up, s; negative margins count the way round.
    pub fn delay(&self) -> f64 {
        self.degrees.rem_euclid(360.0).to_radians() / self.frequency
    }
}

/// The least distance of a loop's response from −1, its modulus or stability margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityMargin {
    /// The distance: one over the peak of the sensitivity.
    pub distance: f64,
    /// rad/s; infinite where high frequencies come near it.
    pub frequency: f64,
}

/// All crossings of a loop under negative feedback.
#[derive(Clone, Debug, PartialEq)]
pub struct Margins {
    /// At every frequency where the phase becomes 180°, from low to high; at rest too. A response that is real at all frequencies, as
    /// that of `1 / s²`, has none but at rest.
    pub gain: Vec<GainMargin>,
    /// At every frequency where the magnitude is one, from low to high.
    pub phase: Vec<PhaseMargin>,
    /// The least distance from −1.
    pub stability: StabilityMargin,
}

impl Margins {
    /// The gain margin nearest to one.
    pub fn nearest_gain(&self) -> Option<GainMargin> {
        self.gain.iter().copied().min_by(|a, b| a.factor.ln().abs().total_cmp(&b.factor.ln().abs()))
    }

    /// The least factor above one that leads to the border of stability.
    pub fn gain_increase(&self) -> Option<GainMargin> {
        self.gain.iter().copied().filter(|m| m.factor > 1.0).min_by(|a, b| a.factor.total_cmp(&b.factor))
    }

    /// The largest factor below one that leads to the border of stability.
    pub fn gain_reduction(&self) -> Option<GainMargin> {
        self.gain.iter().copied().filter(|m| m.factor < 1.0).max_by(|a, b| a.factor.total_cmp(&b.factor))
    }

    /// The phase margin nearest to zero.
    pub fn nearest_phase(&self) -> Option<PhaseMargin> {
        self.phase.iter().copied().min_by(|a, b| a.degrees.abs().total_cmp(&b.degrees.abs()))
    }

    /// The least delay that leads to the border of stability, s.
    pub fn delay(&self) -> Option<f64> {
        self.phase.iter().map(PhaseMargin::delay).min_by(f64::total_cmp)
    }
}

/// A sign change of `f` between `low` and `high`: bisection, with the secant where it helps (Dekker, 1969).
pub(crate) fn root_between(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let (mut at_low, mut at_high) = (f(low), f(high));
    for k in 0..200 {
        let secant = high - at_high * (high - low) / (at_high - at_low);
        let middle = 0.5 * (low + high);
        let inside = secant > low.min(high) && secant < low.max(high);
        let next = if inside && k % 3 != 2 { secant } else { middle };
        if !(next > low.min(high) && next < low.max(high)) {
            break;
        }
        let at_next = f(next);
        if at_next == 0.0 {
            return next;
        }
        if (at_next > 0.0) == (at_low > 0.0) {
            (low, at_low) = (next, at_next);
        } else {
            (high, at_high) = (next, at_next);
        }
    }
    if at_low.abs() < at_high.abs() { low } else { high }
}

/// The least value of `f` between neighbours of a point that is lower than both, by golden sections.
fn least_between(f: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    const RATIO: f64 = 0.6180339887498949;
    let (mut left, mut right) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut at_left, mut at_right) = (f(left), f(right));
    for _ in 0..120 {
        if at_left < at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - RATIO * (high - low);
            at_left = f(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + RATIO * (high - low);
            at_right = f(right);
        }
    }
    0.5 * (low + high)
}

/// A loop's response, infinite at poles on the border.
struct Loop {
    map: FrequencyMap,
    period: Option<f64>,
}

impl Loop {
    fn at(&self, frequency: f64) -> C {
        let infinite = C::new(f64::INFINITY, 0.0);
        self.map.at(boundary(self.period, frequency)).map_or(infinite, |m| m[(0, 0)])
    }

    /// Frequencies where `f` changes its sign from one of the grid to the next; `response` is that on the grid.
    fn crossings(&self, grid: &[f64], response: &[C], f: impl Fn(C) -> f64) -> Vec<f64> {
        let of = |w: f64| f(self.at(w));
        let values: Vec<f64> = response.iter().map(|value| f(*value)).collect();
        let mut found = Vec::new();
        for k in 1..grid.len() {
            let (before, after) = (values[k - 1], values[k]);
            if before.is_finite() && after.is_finite() && before * after < 0.0 {
                found.push(root_between(of, grid[k - 1], grid[k]));
            } else if after == 0.0 {
                found.push(grid[k]);
            }
        }
        found
    }
}

impl StateSpace {
    /// The margins of this system as the open loop of a negative feedback: all crossings, and the least distance from −1.
    ///
    /// ```
    /// use linkwork_design::TransferFunction;
    ///
    /// let open = TransferFunction::new([1.0], [1.0, 2.0, 3.0, 4.0])?.state_space()?;
    /// let margins = open.margins()?;
    /// let gain = margins.nearest_gain().unwrap();
    /// assert!((gain.factor - 2.0).abs() < 1e-12 && (gain.frequency - 3.0_f64.sqrt()).abs() < 1e-12);
    /// assert!(margins.phase.is_empty());
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Count`] unless it has one input and one output, [`Error::NotConverged`].
    pub fn margins(&self) -> Result<Margins, Error> {
        self.check_single()?;
        let open = Loop { map: self.frequency_map()?, period: self.period };
        let known = if self.period.is_none() { self.margin_frequencies() } else { None };
        let grid = match &known {
            Some((grid, _)) => grid.clone(),
            None => self.margin_grid()?,
        };
        let response: Vec<C> = grid.iter().map(|w| open.at(*w)).collect();
        let mut gain = Vec::new();
        let mut take = |frequency: f64, value: C| {
            if value.re < 0.0 && value.re.is_finite() {
                gain.push(GainMargin { factor: -1.0 / value.re, frequency });
            }
        };
        let at_rest = open.at(0.0);
        take(0.0, at_rest);
        // Where the response is real at all frequencies, as that of 1 / s², none of them is a crossing.
        let is_real =
            response.iter().filter(|x| x.norm().is_finite()).all(|x| x.im.abs() <= 1e-12 * x.norm());
        let crossings = if is_real { Vec::new() } else { open.crossings(&grid, &response, |x| x.im) };
        for w in crossings {
            let value = open.at(w);
            // A pole on the border changes the sign, too.
            if value.im.abs() <= 1e-6 * value.norm() {
                take(w, value);
            }
        }
        if let Some(h) = self.period {
            let w = std::f64::consts::PI / h;
            take(w, C::new(open.at(w).re, 0.0));
        }
        let phase = open.crossings(&grid, &response, |x| x.norm().ln());
        let phase = phase
            .into_iter()
            .map(|w| PhaseMargin { degrees: (-open.at(w)).arg().to_degrees(), frequency: w });
        gain.dedup_by(|a, b| (a.frequency - b.frequency).abs() <= 1e-9 * b.frequency);
        let stability = match known {
            Some((_, nearest)) => open.stability_at(nearest),
            None => open.stability(&grid, &response),
        };
        Ok(Margins { gain, phase: phase.collect(), stability })
    }

    /// Frequencies close together, over all that the system does and eight decades beyond, where a small or a large gain alone
    /// crosses one.
    fn margin_grid(&self) -> Result<Vec<f64>, Error> {
        let grid = self.natural_frequencies(1500)?;
        let (Some(first), Some(last)) = (grid.first().copied(), grid.last().copied()) else {
            return Ok(grid);
        };
        let below = (1..=200).rev().map(|k| first * 10f64.powf(-f64::from(k) / 25.0));
        let above = (1..=200).map(|k| last * 10f64.powf(f64::from(k) / 25.0));
        let above = above.filter(|_| self.period.is_none());
        Ok(below.chain(grid.iter().copied()).chain(above).collect())
    }

    /// Frequencies between all crossings of a continuous system, and where the sensitivity `1 / (1 + G)` is largest. The magnitude
    /// is one at imaginary eigenvalues of a Hamiltonian matrix, and the response is real at the imaginary zeros of
    /// `G(s) − G(−s)`. `None` where these are not to be had: of direct ways of magnitude one, or a sensitivity with poles on the
    /// border.
    fn margin_frequencies(&self) -> Option<(Vec<f64>, f64)> {
        const NEAR: f64 = 1e-3;
        let n = self.order();
        let mut found = self.level_crossings(1.0, NEAR).ok()?;
        let mut a = DMatrix::zeros(2 * n, 2 * n);
        a.view_mut((0, 0), (n, n)).copy_from(&self.a);
        a.view_mut((n, n), (n, n)).copy_from(&-&self.a);
        let (mut b, mut c) = (DMatrix::zeros(2 * n, 1), DMatrix::zeros(1, 2 * n));
        for k in [0, n] {
            b.view_mut((k, 0), (n, 1)).copy_from(&self.b);
            c.view_mut((0, k), (1, n)).copy_from(&self.c);
        }
        let odd = StateSpace::new(a, b, c, DMatrix::zeros(1, 1)).ok()?;
        found.extend(odd.zeros().ok()?.iter().filter(|s| s.re.abs() <= NEAR * s.norm()).map(|s| s.im.abs()));
        found.extend(self.poles().ok()?.iter().chain(&self.zeros().ok()?).map(|s| s.norm()));
        found.retain(|w| *w > 0.0 && w.is_finite());
        found.sort_by(f64::total_cmp);
        found.dedup_by(|a, b| *a - *b <= 1e-10 * *a);
        let between = found.windows(2).map(|pair| (pair[0] * pair[1]).sqrt());
        let ends = found.first().map(|w| 0.1 * w).into_iter().chain(found.last().map(|w| 10.0 * w));
        let mut grid: Vec<f64> = between.chain(ends).collect();
        grid.sort_by(f64::total_cmp);
        // `S = 1 / (1 + G)`, in the states of `G`.
        let factor = 1.0 / (1.0 + self.d[(0, 0)]);
        let closed = &self.a - &self.b * &self.c * factor;
        let (b, c) = (&self.b * factor, &self.c * -factor);
        let sensitivity = StateSpace::new(closed, b, c, DMatrix::from_element(1, 1, factor)).ok()?;
        Some((grid, sensitivity.largest_gain().ok()?.frequency))
    }
}

impl Loop {
    /// The least distance from −1, which is taken near a frequency.
    fn stability_at(&self, near: f64) -> StabilityMargin {
        let distance = |w: f64| {
            let at = if w.is_finite() { self.at(w) } else { self.map.direct() };
            (at + 1.0).norm()
        };
        let polished = if near > 0.0 && near.is_finite() { self.polish(near) } else { near };
        let frequency = if distance(polished) <= distance(near) { polished } else { near };
        StabilityMargin { distance: distance(frequency), frequency }
    }

    fn stability(&self, grid: &[f64], response: &[C]) -> StabilityMargin {
        let distance = |w: f64| (self.at(w) + 1.0).norm();
        let values: Vec<f64> = response.iter().map(|value| (value + 1.0).norm()).collect();
        let mut best = StabilityMargin { distance: distance(0.0), frequency: 0.0 };
        if !best.distance.is_finite() {
            best.distance = f64::INFINITY;
        }
        for k in 0..grid.len() {
            if values[k] >= best.distance * 1.1 {
                continue;
            }
            let (before, after) = (k.saturating_sub(1), (k + 1).min(grid.len() - 1));
            let frequency = if values[k] <= values[before] && values[k] <= values[after] {
                let near = least_between(&|w| distance(w), grid[before], grid[after]);
                self.polish(near)
            } else {
                grid[k]
            };
            if distance(frequency) < best.distance {
                best = StabilityMargin { distance: distance(frequency), frequency };
            }
        }
        best
    }

    /// Sections find the place of the least value to half of the digits; where its slope changes the sign is sharper.
    fn polish(&self, near: f64) -> f64 {
        let (reach, h) = (1e-5 * near, 1e-5 * near);
        let slope = |w: f64| ((self.at(w + h) - self.at(w - h)) * (self.at(w) + 1.0).conj()).re;
        if slope(near - reach) < 0.0 && slope(near + reach) > 0.0 {
            return root_between(slope, near - reach, near + reach);
        }
        near
    }
}

impl TransferFunction {
    /// The margins as the open loop of a negative feedback.
    ///
    /// # Errors
    ///
    /// [`Error::Improper`], [`Error::NotConverged`].
    pub fn margins(&self) -> Result<Margins, Error> {
        self.state_space()?.margins()
    }
}
