//! Polynomials in one variable.

use crate::Error;
use crate::matrices::{C, eigenvalues};
use nalgebra::DMatrix;
use std::fmt::{self, Write};
use std::ops::{Add, Mul, Neg, Sub};

/// Polynomial with real coefficients, highest power first: `[1, 2, 3]` is `s² + 2 s + 3`.
#[derive(Clone, Debug, PartialEq)]
pub struct Polynomial {
    /// Coefficients of the polynomial, highest power first. The first is nonzero; the zero polynomial has no
    /// coefficients.
    coefficients: Vec<f64>,
}

impl Polynomial {
    /// Creates a polynomial from its coefficients, highest power first; leading zeros are removed.
    pub fn new(coefficients: impl IntoIterator<Item = f64>) -> Self {
        let all: Vec<f64> = coefficients.into_iter().collect();
        Self { coefficients: all.into_iter().skip_while(|c| *c == 0.0).collect() }
    }

    /// Creates the constant polynomial with this value.
    pub fn constant(value: f64) -> Self {
        Self::new([value])
    }

    /// Creates the monic polynomial with these roots, which contain complex roots in conjugate pairs.
    pub fn from_roots(roots: &[C]) -> Self {
        let mut sorted = roots.to_vec();
        // The order from small to large magnitudes minimises rounding errors.
        sorted.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        let mut product = vec![C::new(1.0, 0.0)];
        for root in sorted {
            product.push(C::new(0.0, 0.0));
            for k in (1..product.len()).rev() {
                let before = product[k - 1];
                product[k] -= root * before;
            }
        }
        Self::new(product.into_iter().map(|c| c.re))
    }

    /// Returns the coefficients of the polynomial, highest power first.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// Returns the degree of the polynomial; zero for constants.
    pub fn degree(&self) -> usize {
        self.coefficients.len().saturating_sub(1)
    }

    /// Returns whether all coefficients of the polynomial are zero.
    pub fn is_zero(&self) -> bool {
        self.coefficients.is_empty()
    }

    /// Returns the coefficient of the highest power; zero for the zero polynomial.
    pub fn leading(&self) -> f64 {
        self.coefficients.first().copied().unwrap_or(0.0)
    }

    /// Returns the coefficient of the polynomial for the power `k` of its variable.
    pub fn coefficient(&self, k: usize) -> f64 {
        let at = self.coefficients.len().checked_sub(k + 1);
        at.and_then(|at| self.coefficients.get(at)).copied().unwrap_or(0.0)
    }

    /// Returns the value of the polynomial at `s`, by Horner's rule.
    pub fn at(&self, s: C) -> C {
        self.coefficients.iter().fold(C::new(0.0, 0.0), |sum, c| sum * s + c)
    }

    /// Returns a bound of the rounding error of the polynomial's value at a point of this magnitude, which
    /// may be a rounded root.
    pub(crate) fn rounding_bound_at(&self, magnitude: f64) -> f64 {
        let sum = self.coefficients.iter().fold(0.0, |sum, c| sum * magnitude + c.abs());
        64.0 * f64::EPSILON * self.coefficients.len() as f64 * sum
    }

    /// Multiplies the polynomial by a number.
    pub fn scaled(&self, factor: f64) -> Self {
        Self::new(self.coefficients.iter().map(|c| c * factor))
    }

    /// Returns the derivative of the polynomial.
    pub fn derivative(&self) -> Self {
        let n = self.degree();
        let terms = self.coefficients.iter().take(n).enumerate();
        Self::new(terms.map(|(k, c)| c * (n - k) as f64))
    }

    /// Computes the roots of the polynomial as eigenvalues of the balanced companion matrix.
    ///
    /// # Errors
    ///
    /// [`Error::NotFinite`] for coefficients that are infinite or NaN.
    pub fn roots(&self) -> Result<Vec<C>, Error> {
        if !self.coefficients.iter().all(|c| c.is_finite()) {
            return Err(Error::NotFinite { what: "the polynomial" });
        }
        let zeros = self.coefficients.iter().rev().take_while(|c| **c == 0.0).count();
        let n = self.degree() - zeros.min(self.degree());
        let companion = DMatrix::from_fn(n, n, |i, j| match i {
            0 => -self.coefficients[j + 1] / self.coefficients[0],
            _ => f64::from(i == j + 1),
        });
        let mut roots = eigenvalues(&companion)?;
        roots.extend(std::iter::repeat_n(C::new(0.0, 0.0), self.degree() - n));
        roots.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        Ok(roots)
    }

    /// Formats the polynomial with the name of its variable, such as `s² + 2 s + 3`.
    pub fn written_in(&self, variable: &str) -> String {
        if self.is_zero() {
            return "0".into();
        }
        let n = self.degree();
        let mut out = String::new();
        for (k, c) in self.coefficients.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            let sign = match (out.is_empty(), *c < 0.0) {
                (true, false) => "",
                (true, true) => "-",
                (false, false) => " + ",
                (false, true) => " - ",
            };
            out.push_str(sign);
            let power = n - k;
            if power == 0 || c.abs() != 1.0 {
                out.push_str(&format_number(c.abs()));
                out.push_str(if power > 0 { " " } else { "" });
            }
            if power > 0 {
                out.push_str(variable);
            }
            if power > 1 {
                let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
                let raised = power.to_string();
                out.extend(raised.bytes().filter_map(|b| digits.get(usize::from(b - b'0'))));
            }
        }
        out
    }
}

/// Formats a number with at most six significant digits.
pub(crate) fn format_number(x: f64) -> String {
    let size = x.abs();
    if size != 0.0 && !(1e-4..1e7).contains(&size) {
        let text = format!("{x:.5e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'));
    }
    let before =
        if size >= 1.0 { size.log10().floor() as i32 + 1 } else { 1 + size.max(1e-9).log10().floor() as i32 };
    let text = format!("{x:.*}", (6 - before).max(0) as usize);
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

impl fmt::Display for Polynomial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.written_in("s"))
    }
}

impl Add for &Polynomial {
    type Output = Polynomial;
    fn add(self, other: &Polynomial) -> Polynomial {
        let n = self.coefficients.len().max(other.coefficients.len());
        Polynomial::new((0..n).rev().map(|k| self.coefficient(k) + other.coefficient(k)))
    }
}

impl Neg for &Polynomial {
    type Output = Polynomial;
    fn neg(self) -> Polynomial {
        self.scaled(-1.0)
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;
    fn sub(self, other: &Polynomial) -> Polynomial {
        self + &-other
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    fn mul(self, other: &Polynomial) -> Polynomial {
        if self.is_zero() || other.is_zero() {
            return Polynomial::new([]);
        }
        let mut product = vec![0.0; self.degree() + other.degree() + 1];
        for (i, a) in self.coefficients.iter().enumerate() {
            for (j, b) in other.coefficients.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        Polynomial::new(product)
    }
}

/// Formats a polynomial with these roots as a product of factors: `(s + 1) (s² + s + 2)`.
pub(crate) fn format_factors(roots: &[C], variable: &str) -> String {
    let mut out = String::new();
    for root in roots.iter().filter(|r| r.im >= 0.0) {
        let factor = match (root.im == 0.0, root.re == 0.0) {
            (true, true) => variable.to_owned(),
            (true, false) => format!("({})", Polynomial::new([1.0, -root.re]).written_in(variable)),
            (false, _) => {
                format!("({})", Polynomial::new([1.0, -2.0 * root.re, root.norm_sqr()]).written_in(variable))
            }
        };
        let space = if out.is_empty() { "" } else { " " };
        let _ = write!(out, "{space}{factor}");
    }
    out
}
