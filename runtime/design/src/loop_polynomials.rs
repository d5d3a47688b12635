//! Stability margins of an open loop that is a ratio of polynomials. All crossings are roots of polynomials
//! in `x = ω²` with 32 digits, which the roots of their derivatives separate.

use crate::double_double::DoubleDouble;
use crate::margins::{CERTAIN, root_between};
use crate::matrices::C;
use crate::{
    Error, GainMargin, Margins, PhaseMargin, Polynomial, StabilityMargin, TransferFunction, ZerosPolesGain,
};
use std::f64::consts::PI;

/// Relative rounding error of the coefficients of a loop's polynomials.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Coefficient of a polynomial, with a bound of its error by rounding of the loop's coefficients.
#[derive(Clone, Copy, Default)]
struct ErrorBoundedCoefficient {
    value: DoubleDouble,
    error: f64,
}

impl ErrorBoundedCoefficient {
    fn coefficient_with_rounding_error(value: f64) -> Self {
        Self { value: value.into(), error: ROUNDING * value.abs() }
    }

    fn exact_coefficient(value: f64) -> Self {
        Self { value: value.into(), error: 0.0 }
    }

    fn plus_coefficient(self, other: Self) -> Self {
        Self { value: self.value + other.value, error: self.error + other.error }
    }

    fn minus_coefficient(self, other: Self) -> Self {
        Self { value: self.value - other.value, error: self.error + other.error }
    }

    fn product_with_error_bound(self, other: Self) -> Self {
        let [one, two] = [self, other].map(|c| c.value.value().abs());
        let error = one * other.error + self.error * (two + other.error);
        Self { value: self.value * other.value, error }
    }

    fn is_zero(self) -> bool {
        self.value.value() == 0.0
    }
}

/// Coefficients of a polynomial, lowest power first.
#[derive(Clone)]
struct PolynomialTerms(Vec<ErrorBoundedCoefficient>);

impl PolynomialTerms {
    /// Sets coefficients that are rounding errors to zero, and removes zeros of the highest powers.
    fn without_negligible_coefficients(mut self) -> Self {
        for c in &mut self.0 {
            if c.value.value().abs() <= c.error {
                c.value = DoubleDouble::default();
            }
        }
        while self.0.last().is_some_and(|c| c.is_zero()) {
            self.0.pop();
        }
        self
    }

    /// Combines the coefficients of each power of two polynomials by a function; missing coefficients are
    /// zero.
    fn combine_coefficients_with(
        &self,
        other: &Self,
        f: impl Fn(ErrorBoundedCoefficient, ErrorBoundedCoefficient) -> ErrorBoundedCoefficient,
    ) -> Self {
        let term_or_zero = |terms: &Self, k: usize| terms.0.get(k).copied().unwrap_or_default();
        Self(
            (0..self.0.len().max(other.0.len()))
                .map(|k| f(term_or_zero(self, k), term_or_zero(other, k)))
                .collect(),
        )
    }

    fn plus_polynomial(&self, other: &Self) -> Self {
        self.combine_coefficients_with(other, ErrorBoundedCoefficient::plus_coefficient)
    }

    fn minus_polynomial(&self, other: &Self) -> Self {
        self.combine_coefficients_with(other, ErrorBoundedCoefficient::minus_coefficient)
    }

    fn times_polynomial(&self, other: &Self) -> Self {
        let mut product =
            vec![ErrorBoundedCoefficient::default(); (self.0.len() + other.0.len()).saturating_sub(1)];
        for (i, a) in self.0.iter().enumerate() {
            for (j, b) in other.0.iter().enumerate() {
                product[i + j] = product[i + j].plus_coefficient(a.product_with_error_bound(*b));
            }
        }
        Self(product)
    }

    fn times_x(&self) -> Self {
        Self(std::iter::once(ErrorBoundedCoefficient::default()).chain(self.0.iter().copied()).collect())
    }

    fn derivative_of_polynomial(&self) -> Self {
        let terms = self.0.iter().enumerate().skip(1);
        Self(
            terms
                .map(|(k, c)| {
                    c.product_with_error_bound(ErrorBoundedCoefficient::exact_coefficient(k as f64))
                })
                .collect(),
        )
    }

    /// Returns the value of the polynomial at `x`. If `x` is above one, the value is divided by `x` to the
    /// power `degree`, to avoid overflow.
    fn evaluate_without_overflow(&self, x: f64, degree: usize) -> ErrorBoundedCoefficient {
        let start = ErrorBoundedCoefficient::default();
        let horner_step = |sum: ErrorBoundedCoefficient, (c, by): (ErrorBoundedCoefficient, DoubleDouble)| {
            ErrorBoundedCoefficient {
                value: sum.value * by + c.value,
                error: sum.error * by.value() + c.error,
            }
        };
        if x <= 1.0 {
            return self.0.iter().rev().map(|c| (*c, x.into())).fold(start, horner_step);
        }
        let inverse = DoubleDouble::inverse_of(x);
        let missing = std::iter::repeat_n(
            ErrorBoundedCoefficient::default(),
            (degree + 1).saturating_sub(self.0.len()),
        );
        self.0.iter().copied().chain(missing).map(|c| (c, inverse)).fold(start, horner_step)
    }

    /// Returns the value of the polynomial at `x` up to a positive factor, to determine its sign.
    fn scaled_value_at(&self, x: f64) -> f64 {
        self.evaluate_without_overflow(x, self.0.len().saturating_sub(1)).value.value()
    }

    /// Returns points between which the polynomial is monotonic, ascending: bounds of all positive roots, and
    /// the positive roots of the derivative between them. The list is empty if there are no positive roots,
    /// by Descartes' rule of signs.
    fn monotonic_separators(&self) -> Vec<f64> {
        let signs: Vec<f64> = self.0.iter().filter(|c| !c.is_zero()).map(|c| c.value.value()).collect();
        if signs.windows(2).all(|pair| pair[0] * pair[1].signum() > 0.0) {
            return Vec::new();
        }
        let logarithm_of_coefficient = |k: usize| self.0[k].value.value().abs().ln();
        let is_nonzero = |k: &usize| !self.0[*k].is_zero();
        let all: Vec<usize> = (0..self.0.len()).filter(is_nonzero).collect();
        let (first, last) = (all[0], all[all.len() - 1]);
        // Fujiwara's bound, and that of the polynomial with reversed coefficients.
        let logarithmic_slope_between = |low: usize, high: usize| {
            (logarithm_of_coefficient(low) - logarithm_of_coefficient(high)) / (high - low) as f64
        };
        let high = all
            .iter()
            .filter(|k| **k < last)
            .map(|k| logarithmic_slope_between(*k, last))
            .fold(f64::MIN, f64::max);
        let low = all
            .iter()
            .filter(|k| **k > first)
            .map(|k| logarithmic_slope_between(first, *k))
            .fold(f64::MAX, f64::min);
        let (low, high) = (0.4 * low.exp(), 2.5 * high.exp());
        // One change of sign is one root.
        let changes = signs.windows(2).filter(|pair| pair[0] * pair[1].signum() < 0.0).count();
        let inner = if changes == 1 { Vec::new() } else { self.derivative_of_polynomial().positive_roots() };
        let inner = inner.into_iter().filter(|x| *x > low && *x < high);
        std::iter::once(low).chain(inner).chain([high]).collect()
    }

    /// Returns the positive roots at which the polynomial changes its sign, ascending.
    fn positive_roots(&self) -> Vec<f64> {
        self.roots_between(&self.monotonic_separators())
    }

    /// Returns the positive roots of the polynomial at which its sign changes by more than rounding errors of
    /// the coefficients.
    fn roots_with_certain_sign_change(&self) -> Vec<f64> {
        let has_certain_sign = |x: &f64| {
            let ErrorBoundedCoefficient { value, error } =
                self.evaluate_without_overflow(*x, self.0.len().saturating_sub(1));
            value.value().abs() > error
        };
        let points: Vec<f64> = self.monotonic_separators().into_iter().filter(has_certain_sign).collect();
        self.roots_between(&points)
    }

    /// Returns a root of the polynomial between each two neighbouring points at which its signs differ.
    fn roots_between(&self, points: &[f64]) -> Vec<f64> {
        let mut found = Vec::new();
        for pair in points.windows(2) {
            let (mut low, mut high) = (pair[0], pair[1]);
            let is_negative_at = |x: f64| self.scaled_value_at(x) < 0.0;
            let start = is_negative_at(low);
            if start == is_negative_at(high) {
                continue;
            }
            while high > 2.0 * low {
                let middle = low.sqrt() * high.sqrt();
                *if is_negative_at(middle) == start { &mut low } else { &mut high } = middle;
            }
            found.push(root_between(|x| self.scaled_value_at(x), low, high));
        }
        found
    }
}

/// Real and imaginary part of a polynomial at `s = iω`: its value is `even(x) + i ω odd(x)` with `x = ω²`.
struct EvenAndOddParts {
    even: PolynomialTerms,
    odd: PolynomialTerms,
}

impl EvenAndOddParts {
    fn new(coefficients: &[ErrorBoundedCoefficient]) -> Self {
        let negated_coefficient =
            |c: &ErrorBoundedCoefficient| ErrorBoundedCoefficient { value: -c.value, ..*c };
        let terms_with_alternating_signs = |first: usize| {
            let terms = coefficients.iter().skip(first).step_by(2).enumerate();
            PolynomialTerms(
                terms.map(|(k, c)| if k % 2 == 0 { *c } else { negated_coefficient(c) }).collect(),
            )
        };
        Self { even: terms_with_alternating_signs(0), odd: terms_with_alternating_signs(1) }
    }

    /// Returns the squared magnitude of the polynomial at `s = iω`, as a polynomial in `ω²`.
    fn squared_magnitude(&self) -> PolynomialTerms {
        self.even
            .times_polynomial(&self.even)
            .plus_polynomial(&self.odd.times_polynomial(&self.odd).times_x())
    }

    fn plus_even_and_odd_parts(&self, other: &Self) -> Self {
        Self { even: self.even.plus_polynomial(&other.even), odd: self.odd.plus_polynomial(&other.odd) }
    }
}

/// Values of numerator `N` and denominator `D` of the loop at one frequency, up to a common positive factor.
struct LoopValue {
    /// Product of the numerator `N` and the complex conjugate of the denominator `D`.
    product: C,
    /// Squared magnitudes of the numerator `N` and the denominator `D`.
    squares: [f64; 2],
    /// Whether rounding errors of the coefficients change the numerator `N` and the denominator `D` little.
    certain: [bool; 2],
}

/// Loop `N / D` along the stability boundary. Discrete loops are functions of `w = (z − 1) / (z + 1)`, which
/// is imaginary there.
pub(crate) struct LoopPolynomials {
    /// Coefficients of the numerator `N` and the denominator `D`, lowest power first.
    coefficients: [Vec<ErrorBoundedCoefficient>; 2],
    numerator: EvenAndOddParts,
    denominator: EvenAndOddParts,
    /// Unit of the frequency of a continuous loop, rad/s.
    unit: f64,
    period: Option<f64>,
}

impl LoopPolynomials {
    /// Creates the polynomials of a transfer function.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] if coefficients of a discrete loop overflow.
    pub fn new(g: &TransferFunction) -> Result<Self, Error> {
        let coefficient_list =
            |p: &Polynomial| (0..=p.degree()).map(|k| p.coefficient(k)).collect::<Vec<f64>>();
        let both = [coefficient_list(g.numerator()), coefficient_list(g.denominator())];
        if g.period().is_none() {
            let both = both.map(|all| {
                all.into_iter().map(ErrorBoundedCoefficient::coefficient_with_rounding_error).collect()
            });
            return Self::from_coefficients(both, None);
        }
        // z = (1 + w) / (1 − w).
        let n = g.denominator().degree().max(g.numerator().degree());
        let bilinear_transformed_coefficients = |all: &Vec<f64>| {
            let mut sum = PolynomialTerms(vec![ErrorBoundedCoefficient::default(); n + 1]);
            for (k, a) in all.iter().enumerate() {
                let mut term =
                    PolynomialTerms(vec![ErrorBoundedCoefficient::coefficient_with_rounding_error(*a)]);
                for i in 0..n {
                    let sign = if i < k { 1.0 } else { -1.0 };
                    term = term.times_polynomial(&PolynomialTerms(vec![
                        ErrorBoundedCoefficient::exact_coefficient(1.0),
                        ErrorBoundedCoefficient::exact_coefficient(sign),
                    ]));
                }
                // The binomial coefficients are exact.
                term.0.iter_mut().for_each(|c| c.error = ROUNDING * c.value.value().abs());
                sum = sum.plus_polynomial(&term);
            }
            sum.0
        };
        Self::from_coefficients(
            [bilinear_transformed_coefficients(&both[0]), bilinear_transformed_coefficients(&both[1])],
            g.period(),
        )
    }

    /// Creates the polynomials of a loop with these zeros, poles and gain.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] if coefficients overflow.
    pub fn from_factors(g: &ZerosPolesGain) -> Result<Self, Error> {
        let is_discrete = g.period.is_some();
        let expanded_polynomial = |roots: &[C], gain: f64| {
            let mut product = vec![C::new(gain, 0.0)];
            let factor =
                |root: &C| if is_discrete { [1.0 - root, 1.0 + root] } else { [-root, C::new(1.0, 0.0)] };
            let excess = if is_discrete { g.poles.len().saturating_sub(roots.len()) } else { 0 };
            let infinite = std::iter::repeat_n([C::new(1.0, 0.0), C::new(-1.0, 0.0)], excess);
            for [constant, linear] in roots.iter().map(factor).chain(infinite) {
                product.push(C::new(0.0, 0.0));
                for k in (0..product.len()).rev() {
                    let below = if k > 0 { product[k - 1] } else { C::new(0.0, 0.0) };
                    product[k] = product[k] * constant + below * linear;
                }
            }
            product
                .into_iter()
                .map(|c| ErrorBoundedCoefficient::coefficient_with_rounding_error(c.re))
                .collect()
        };
        Self::from_coefficients(
            [expanded_polynomial(&g.zeros, g.gain), expanded_polynomial(&g.poles, 1.0)],
            g.period,
        )
    }

    /// Scales frequency and magnitudes of a loop by powers of two, and removes factors `s` that numerator and
    /// denominator share.
    fn from_coefficients(
        both: [Vec<ErrorBoundedCoefficient>; 2],
        period: Option<f64>,
    ) -> Result<Self, Error> {
        let mut both = both.map(|all| PolynomialTerms(all).without_negligible_coefficients().0);
        let common = both[0].iter().zip(&both[1]).take_while(|(n, d)| n.is_zero() && d.is_zero()).count();
        both.iter_mut().for_each(|all| drop(all.drain(..common.min(all.len()))));
        let logarithm_of_coefficient = |c: &ErrorBoundedCoefficient| c.value.value().abs().log2();
        let nonzero: Vec<(usize, f64)> = both[1]
            .iter()
            .enumerate()
            .filter(|(_, c)| !c.is_zero())
            .map(|(k, c)| (k, logarithm_of_coefficient(c)))
            .collect();
        let (Some((low, first)), Some((high, last))) = (nonzero.first().copied(), nonzero.last().copied())
        else {
            return Err(Error::Range { what: "a denominator", value: 0.0 });
        };
        let unit =
            if period.is_none() && high > low { ((first - last) / (high - low) as f64).round() } else { 0.0 };
        let largest =
            nonzero.iter().map(|(k, size)| size + unit * *k as f64).fold(f64::MIN, f64::max).round();
        for all in &mut both {
            for (k, c) in all.iter_mut().enumerate() {
                *c = c.product_with_error_bound(ErrorBoundedCoefficient::exact_coefficient(
                    (unit * k as f64 - largest).exp2(),
                ));
            }
            if all.iter().any(|c| !(c.value.value() * c.value.value()).is_finite()) {
                return Err(Error::NotFinite { what: "the squared magnitude of the loop" });
            }
        }
        let [numerator, denominator] = [&both[0], &both[1]].map(|all| EvenAndOddParts::new(all));
        Ok(Self { coefficients: both, numerator, denominator, unit: unit.exp2(), period })
    }

    /// Returns the frequency, rad/s, whose scaled square is `x`.
    fn frequency_of_square(&self, x: f64) -> f64 {
        self.period.map_or(self.unit * x.sqrt(), |h| 2.0 / h * x.sqrt().atan())
    }

    /// Evaluates numerator and denominator of the loop at the frequency whose scaled
    /// square is `x`.
    fn loop_value_at(&self, x: f64) -> LoopValue {
        let degree = self.coefficients.iter().map(|all| all.len() / 2).max().unwrap_or(0);
        let root = x.sqrt();
        let parts = [&self.numerator, &self.denominator].map(|p| {
            [p.even.evaluate_without_overflow(x, degree), p.odd.evaluate_without_overflow(x, degree)]
        });
        let [[ne, no], [de, d_o]] = parts;
        let x = ErrorBoundedCoefficient::exact_coefficient(x);
        let squared_magnitude_of_parts = |[even, odd]: [ErrorBoundedCoefficient; 2]| {
            even.product_with_error_bound(even)
                .plus_coefficient(odd.product_with_error_bound(odd).product_with_error_bound(x))
                .value
                .value()
        };
        let squares = parts.map(squared_magnitude_of_parts);
        let is_certain_value = |k: usize| {
            let [even, odd] = parts[k];
            even.error + root * odd.error <= CERTAIN * squares[k].sqrt()
        };
        let real = ne
            .product_with_error_bound(de)
            .plus_coefficient(no.product_with_error_bound(d_o).product_with_error_bound(x))
            .value
            .value();
        let imaginary =
            no.product_with_error_bound(de).minus_coefficient(ne.product_with_error_bound(d_o)).value.value();
        LoopValue {
            product: C::new(real, root * imaginary),
            squares,
            certain: [is_certain_value(0), is_certain_value(1)],
        }
    }

    /// Returns the imaginary part of `N D̄`, divided by ω, as a polynomial in `ω²`. Its roots are the
    /// frequencies at which the loop is real.
    fn imaginary_part_terms(&self) -> PolynomialTerms {
        let (n, d) = (&self.numerator, &self.denominator);
        n.odd
            .times_polynomial(&d.even)
            .minus_polynomial(&n.even.times_polynomial(&d.odd))
            .without_negligible_coefficients()
    }

    /// Returns the difference of the squared magnitudes of numerator `N` and denominator `D`. Its roots are
    /// the frequencies at which the loop has magnitude one.
    fn magnitude_difference_terms(&self) -> PolynomialTerms {
        self.numerator
            .squared_magnitude()
            .minus_polynomial(&self.denominator.squared_magnitude())
            .without_negligible_coefficients()
    }

    /// Returns the derivative of the loop's squared distance from −1 with respect to `ω²`, times the fourth
    /// power of `|D|`.
    fn distance_slope_terms(&self) -> PolynomialTerms {
        let (p, r) = (
            self.numerator.plus_even_and_odd_parts(&self.denominator).squared_magnitude(),
            self.denominator.squared_magnitude(),
        );
        p.derivative_of_polynomial()
            .times_polynomial(&r)
            .minus_polynomial(&p.times_polynomial(&r.derivative_of_polynomial()))
            .without_negligible_coefficients()
    }

    /// Returns the value of the loop at zero frequency, or at infinite `s` or `w`.
    fn value_at_zero_or_infinity(&self, at_zero: bool) -> f64 {
        let [n, d] = &self.coefficients;
        let coefficient_value =
            |all: &[ErrorBoundedCoefficient], k: usize| all.get(k).map_or(0.0, |c| c.value.value());
        if at_zero {
            return coefficient_value(n, 0) / coefficient_value(d, 0);
        }
        let top = n.len().max(d.len()).saturating_sub(1);
        coefficient_value(n, top) / coefficient_value(d, top)
    }

    /// Returns all stability margins of the loop.
    pub fn margins(&self) -> Margins {
        let gain_margin_at_limit_frequency = |value: f64, frequency: f64| {
            let is_negative = value < 0.0 && value.is_finite();
            is_negative.then_some(GainMargin { factor: -1.0 / value, frequency })
        };
        let between =
            self.imaginary_part_terms().roots_with_certain_sign_change().into_iter().filter_map(|x| {
                let at = self.loop_value_at(x);
                let is_negative = at.product.re < 0.0 && at.certain == [true; 2];
                is_negative.then(|| GainMargin {
                    factor: -at.squares[1] / at.product.re,
                    frequency: self.frequency_of_square(x),
                })
            });
        let top = self
            .period
            .and_then(|h| gain_margin_at_limit_frequency(self.value_at_zero_or_infinity(false), PI / h));
        let phase = self.magnitude_difference_terms().roots_with_certain_sign_change().into_iter().map(|x| {
            PhaseMargin {
                degrees: (-self.loop_value_at(x).product).arg().to_degrees(),
                frequency: self.frequency_of_square(x),
            }
        });
        Margins {
            gain: gain_margin_at_limit_frequency(self.value_at_zero_or_infinity(true), 0.0)
                .into_iter()
                .chain(between)
                .chain(top)
                .collect(),
            phase: phase.collect(),
            stability: self.stability_margin(),
        }
    }

    fn stability_margin(&self) -> StabilityMargin {
        let top = self.period.map_or(f64::INFINITY, |h| PI / h);
        let distance_at_limit =
            |value: f64| if value.is_finite() { (1.0 + value).abs() } else { f64::INFINITY };
        let ends = [
            (distance_at_limit(self.value_at_zero_or_infinity(false)), top),
            (distance_at_limit(self.value_at_zero_or_infinity(true)), 0.0),
        ];
        let inner = self.distance_slope_terms().positive_roots().into_iter().filter_map(|x| {
            let LoopValue { product, squares, certain } = self.loop_value_at(x);
            let value = product / squares[1];
            certain[1].then(|| ((1.0 + value).norm(), self.frequency_of_square(x)))
        });
        let all = ends.into_iter().chain(inner);
        let (distance, frequency) = all.fold((f64::INFINITY, top), |best, other| {
            // Smaller differences are rounding errors.
            if other.0 < best.0 * (1.0 - 1e-14) { other } else { best }
        });
        StabilityMargin { distance, frequency }
    }

    /// Returns the frequencies of all crossings of the loop, rad/s: where it is real or has magnitude one.
    pub fn crossing_frequencies(&self) -> Vec<f64> {
        let all = [self.imaginary_part_terms(), self.magnitude_difference_terms()];
        all.iter().flat_map(PolynomialTerms::positive_roots).map(|x| self.frequency_of_square(x)).collect()
    }
}
