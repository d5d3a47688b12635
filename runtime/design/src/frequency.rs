//! Frequency response: data of Bode and Nyquist diagrams.

use crate::matrices::{C, CMatrix, balance_system, to_complex_matrix};
use crate::{Error, StateSpace};
use nalgebra::{DMatrix, Hessenberg};

/// System in Hessenberg form, in which each frequency takes `n²` operations (Laub, *Efficient multivariable
/// frequency response computations*, 1981).
#[derive(Clone, Debug)]
pub struct FrequencyMap {
    h: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
    period: Option<f64>,
    /// Whether the Hessenberg form results from rounded rotations of the states.
    is_transformed: bool,
}

impl FrequencyMap {
    /// Returns the response `C (s I − A)⁻¹ B + D` at a complex frequency; `s` is `z` for a discrete system.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] at a pole, [`Error::Range`] if `s` is not finite.
    pub fn at(&self, s: C) -> Result<CMatrix, Error> {
        if let Some(value) = [s.re, s.im].into_iter().find(|part| !part.is_finite()) {
            return Err(Error::Range { what: "a frequency", value });
        }
        let mut x = to_complex_matrix(&self.b);
        self.factorise_at_frequency(s)?.solve_in_place(&mut x);
        Ok(to_complex_matrix(&self.c) * x + to_complex_matrix(&self.d))
    }

    /// Factorises `s I − A` into row operations and a triangular matrix, by Gaussian elimination of a
    /// Hessenberg matrix.
    fn factorise_at_frequency(&self, s: C) -> Result<TriangularFactors, Error> {
        let n = self.h.nrows();
        let mut u = CMatrix::from_fn(n, n, |i, j| {
            let entry = C::new(-self.h[(i, j)], 0.0);
            if i == j { entry + s } else { entry }
        });
        let mut steps = Vec::with_capacity(n);
        for k in 0..n.saturating_sub(1) {
            let swapped = u[(k + 1, k)].norm() > u[(k, k)].norm();
            if swapped {
                u.swap_rows(k, k + 1);
            }
            let factor = u[(k + 1, k)] / u[(k, k)];
            for j in k..n {
                let above = u[(k, j)];
                u[(k + 1, j)] -= factor * above;
            }
            steps.push((swapped, factor));
        }
        if (0..n).all(|k| u[(k, k)].norm() > 0.0) {
            Ok(TriangularFactors { u, steps })
        } else {
            Err(Error::Singular { what: "s I − A, at a pole," })
        }
    }

    /// Evaluates a single channel at a complex frequency, with its derivative and a bound of its rounding
    /// error.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] at a pole.
    pub(crate) fn sample_channel(&self, s: C) -> Result<ResponseSample, Error> {
        let factors = self.factorise_at_frequency(s)?;
        let (mut x, mut y) = (to_complex_matrix(&self.b), to_complex_matrix(&self.c));
        factors.solve_in_place(&mut x);
        factors.solve_row_vector_system(&mut y);
        let value = (to_complex_matrix(&self.c) * &x)[(0, 0)] + self.d[(0, 0)];
        // The entries of the matrices have rounding errors; this sums the effect of each on the value. The
        // transformation to Hessenberg form has errors in proportion to the norm.
        let through = if self.is_transformed {
            let (size_x, size_y) = (x.norm(), y.norm());
            size_y * ((self.h.norm() + s.norm()) * size_x + self.b.norm()) + self.c.norm() * size_x
        } else {
            let (size_x, size_y) = (x.map(|x| x.norm()), y.map(|y| y.norm()));
            let sizes = factors.rounding_error_magnitudes(&size_x)
                + self.h.abs() * &size_x
                + &size_x * s.norm()
                + self.b.abs();
            (size_y * sizes)[(0, 0)] + (self.c.abs() * size_x)[(0, 0)]
        };
        let rounding = 4.0 * f64::EPSILON * (self.h.nrows() + 1) as f64;
        let error = rounding * (through + self.d[(0, 0)].abs());
        Ok(ResponseSample { value, slope: -(y * x)[(0, 0)], error })
    }

    /// Returns the response of the system at a frequency, rad/s: at `s = iω`, or `z = e^{iωh}` for a discrete
    /// system.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] at a pole, [`Error::Range`] for a frequency that is not finite.
    pub fn response(&self, frequency: f64) -> Result<CMatrix, Error> {
        if !frequency.is_finite() {
            return Err(Error::Range { what: "a frequency", value: frequency });
        }
        self.at(stability_boundary_point(self.period, frequency))
    }
}

/// Triangular factorisation of a Hessenberg matrix `M`, by Gaussian elimination.
struct TriangularFactors {
    u: CMatrix,
    /// Elimination step for each `k`: whether rows `k` and `k + 1` are swapped, and the multiple of row `k`
    /// that is then subtracted from row `k + 1`.
    steps: Vec<(bool, C)>,
}

impl TriangularFactors {
    /// Solves `M X = R` with the factorised matrix `M`; `X` replaces `R`.
    fn solve_in_place(&self, x: &mut CMatrix) {
        let n = self.u.nrows();
        for (k, (swapped, factor)) in self.steps.iter().enumerate() {
            if *swapped {
                x.swap_rows(k, k + 1);
            }
            for j in 0..x.ncols() {
                let above = x[(k, j)];
                x[(k + 1, j)] -= factor * above;
            }
        }
        for i in (0..n).rev() {
            for j in 0..x.ncols() {
                let sum: C = (i + 1..n).map(|k| self.u[(i, k)] * x[(k, j)]).sum();
                x[(i, j)] = (x[(i, j)] - sum) / self.u[(i, i)];
            }
        }
    }

    /// Returns `|L| |U| x` for a vector of magnitudes, with the magnitudes of the entries of the factors of
    /// `M = L U`: the rounding errors of a solution `x` are in proportion to it.
    fn rounding_error_magnitudes(&self, x: &DMatrix<f64>) -> DMatrix<f64> {
        let mut sizes = self.u.map(|u| u.norm()).upper_triangle() * x;
        for (k, (swapped, factor)) in self.steps.iter().enumerate().rev() {
            sizes[k + 1] += factor.norm() * sizes[k];
            if *swapped {
                sizes.swap_rows(k, k + 1);
            }
        }
        sizes
    }

    /// Solves `y M = r` with the factorised matrix `M`; the row vector `y` replaces `r`.
    fn solve_row_vector_system(&self, y: &mut CMatrix) {
        for j in 0..self.u.ncols() {
            let sum: C = (0..j).map(|k| y[k] * self.u[(k, j)]).sum();
            y[j] = (y[j] - sum) / self.u[(j, j)];
        }
        for (k, (swapped, factor)) in self.steps.iter().enumerate().rev() {
            let below = y[k + 1];
            y[k] -= factor * below;
            if *swapped {
                y.swap_columns(k, k + 1);
            }
        }
    }
}

/// Frequency response at one complex frequency.
#[derive(Clone, Copy)]
pub(crate) struct ResponseSample {
    pub value: C,
    /// Derivative of the response with respect to the complex frequency.
    pub slope: C,
    /// Bound of the change of the response by rounding errors of the matrices.
    pub error: f64,
}

/// Returns the point of the stability boundary for a frequency in rad/s: `iω`, or `e^{iωh}`.
pub(crate) fn stability_boundary_point(period: Option<f64>, frequency: f64) -> C {
    match period {
        Some(h) => C::new(0.0, frequency * h).exp(),
        None => C::new(0.0, frequency),
    }
}

/// Frequency response of one channel, from an input to an output.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencyResponse {
    /// Frequencies of the response, rad/s.
    pub frequencies: Vec<f64>,
    /// Complex response at each frequency.
    pub values: Vec<C>,
    /// Name and unit of the input signal.
    pub input: crate::Signal,
    /// Name and unit of the output signal.
    pub output: crate::Signal,
}

impl FrequencyResponse {
    /// Returns the magnitude of the response at each frequency.
    pub fn magnitudes(&self) -> Vec<f64> {
        self.values.iter().map(|x| x.norm()).collect()
    }

    /// Returns the magnitudes of the response in decibels, `20 log₁₀ |G|`.
    pub fn decibels(&self) -> Vec<f64> {
        self.values.iter().map(|x| 20.0 * x.norm().log10()).collect()
    }

    /// Returns the phase of the response at each frequency, degrees. Phases are unwrapped from one frequency
    /// to the next; the first is within ±180.
    pub fn degrees(&self) -> Vec<f64> {
        let mut turns = 0.0;
        let mut last: Option<f64> = None;
        let unwrapped_phase = |x: &C| {
            let phase = x.arg().to_degrees();
            if let Some(last) = last {
                turns -= ((phase - last) / 360.0).round();
            }
            last = Some(phase);
            phase + 360.0 * turns
        };
        self.values.iter().map(unwrapped_phase).collect()
    }

    /// Returns the largest of the computed magnitudes of the response and its frequency, rad/s.
    pub fn peak(&self) -> Option<(f64, f64)> {
        let all = self.values.iter().zip(&self.frequencies).map(|(x, w)| (x.norm(), *w));
        all.max_by(|a, b| a.0.total_cmp(&b.0))
    }
}

/// Returns `count` logarithmically spaced frequencies from `low` to `high`, rad/s.
///
/// # Errors
///
/// [`Error::Range`] unless both are positive and finite.
pub fn logarithmic(low: f64, high: f64, count: usize) -> Result<Vec<f64>, Error> {
    for value in [low, high] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(Error::Range { what: "a frequency", value });
        }
    }
    let step = (high / low).ln() / count.saturating_sub(1).max(1) as f64;
    Ok((0..count).map(|k| low * (step * k as f64).exp()).collect())
}

impl StateSpace {
    /// Transforms the system to Hessenberg form for evaluation at many frequencies.
    ///
    /// # Errors
    ///
    /// Currently none; reserved for matrices that later versions may reject.
    pub fn frequency_map(&self) -> Result<FrequencyMap, Error> {
        let (a, b, c, _) = balance_system(&self.a, &self.b, &self.c);
        let (d, period) = (self.d.clone(), self.period);
        let is_hessenberg = (0..a.ncols()).all(|j| a.column(j).iter().skip(j + 2).all(|x| *x == 0.0));
        if is_hessenberg {
            return Ok(FrequencyMap { h: a, b, c, d, period, is_transformed: false });
        }
        let (q, h) = Hessenberg::new(a).unpack();
        Ok(FrequencyMap { b: q.transpose() * b, c: c * q, h, d, period, is_transformed: true })
    }

    /// Returns the response `C (s I − A)⁻¹ B + D` of the system at a complex frequency.
    ///
    /// # Errors
    ///
    /// [`Error::Singular`] at a pole.
    pub fn at(&self, s: C) -> Result<CMatrix, Error> {
        self.frequency_map()?.at(s)
    }

    /// Computes the response of one channel of the system at these frequencies, rad/s.
    ///
    /// ```
    /// use linkwork_design::TransferFunction;
    ///
    /// let lag = TransferFunction::new([1.0], [1.0, 1.0])?.state_space()?;
    /// let bode = lag.frequency_response(0, 0, &[1.0])?;
    /// assert!((bode.decibels()[0] + 10.0 * 2.0_f64.log10()).abs() < 1e-13 && (bode.degrees()[0] + 45.0).abs() < 1e-13);
    /// # Ok::<(), linkwork_design::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::Unknown`], [`Error::Singular`] at a pole on the stability boundary, [`Error::Range`] for a
    /// frequency that is not finite.
    pub fn frequency_response<'a>(
        &self,
        output: impl Into<crate::Port<'a>>,
        input: impl Into<crate::Port<'a>>,
        frequencies: &[f64],
    ) -> Result<FrequencyResponse, Error> {
        let channel = self.channel(output, input)?;
        let map = channel.frequency_map()?;
        let response_at_frequency = |w: &f64| Ok(map.response(*w)?[(0, 0)]);
        let values = frequencies.iter().map(response_at_frequency).collect::<Result<Vec<_>, Error>>()?;
        let (input, output) = (channel.inputs[0].clone(), channel.outputs[0].clone());
        Ok(FrequencyResponse { frequencies: frequencies.to_vec(), values, input, output })
    }

    /// Returns frequencies, rad/s, that resolve the response: from a decade below the slowest pole or zero to
    /// a decade above the fastest, and denser near oscillatory poles and zeros. For a discrete system they
    /// end at the Nyquist frequency.
    ///
    /// # Errors
    ///
    /// [`Error::NotConverged`].
    pub fn natural_frequencies(&self, count: usize) -> Result<Vec<f64>, Error> {
        let mut points = Vec::new();
        for root in self.poles()?.into_iter().chain(self.zeros()?) {
            let s = self.period.map_or(root, |h| root.ln() / h);
            if s.norm() > 1e-12 && s.norm().is_finite() {
                points.push(s);
            }
        }
        let low = points.iter().map(|s| s.norm()).fold(f64::INFINITY, f64::min);
        let high = points.iter().map(|s| s.norm()).fold(0.0, f64::max);
        let (low, high) = if high > 0.0 { (0.1 * low, 10.0 * high) } else { (0.01, 100.0) };
        let nyquist = self.period.map_or(f64::INFINITY, |h| std::f64::consts::PI / h);
        let mut all = logarithmic(low.min(0.01 * nyquist), high.min(nyquist), count.max(2))?;
        for s in points.iter().filter(|s| s.im != 0.0) {
            // The width of a resonance is its real part.
            let width = s.re.abs().max(1e-9 * s.im.abs());
            for k in -24..=24 {
                let x = f64::from(k) / 6.0;
                all.push(s.im.abs() + width * x * x.abs());
            }
        }
        all.retain(|w| *w > 0.0 && *w <= nyquist);
        all.sort_by(f64::total_cmp);
        all.dedup();
        Ok(all)
    }
}
