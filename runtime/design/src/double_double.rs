//! Numbers with 32 digits, as unevaluated sums of two floating-point numbers (Dekker, *A floating-point
//! technique for extending the available precision*, 1971).

use std::ops::{Add, Mul, Neg, Sub};

/// Factor of the splitting of a number into two halves.
const SPLIT: f64 = 134_217_729.0;

/// Returns the rounding error of the product of two numbers, by Veltkamp's splitting: processors without a
/// fused product take hundreds of operations for `mul_add`.
fn product_rounding_error(a: f64, b: f64, product: f64) -> f64 {
    let split_into_halves = |x: f64| {
        let shifted = SPLIT * x;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let ((a_high, a_low), (b_high, b_low)) = (split_into_halves(a), split_into_halves(b));
    ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
}

/// Sum of a number and its much smaller correction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct DoubleDouble {
    high: f64,
    low: f64,
}

impl DoubleDouble {
    /// Returns the sum of a number and a smaller one as a double-double number.
    fn from_sum(high: f64, low: f64) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    /// Returns the reciprocal of a number.
    pub fn inverse_of(x: f64) -> Self {
        let near = x.recip();
        let product = near * x;
        Self::from_sum(near, near * ((1.0 - product) - product_rounding_error(near, x, product)))
    }

    /// Returns the double-precision number nearest to a double-double number.
    pub fn value(self) -> f64 {
        self.high
    }
}

impl From<f64> for DoubleDouble {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let sum = self.high + other.high;
        let part = sum - self.high;
        let error = (self.high - (sum - part)) + (other.high - part);
        Self::from_sum(sum, error + (self.low + other.low))
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let error = product_rounding_error(self.high, other.high, product);
        Self::from_sum(product, error + (self.high * other.low + self.low * other.high))
    }
}
