//! Exponents of dimensions as small fractions, since the square root of a length has the dimension of length
//! to the power one half.

/// A fraction in lowest terms with a positive denominator. Numerator and denominator stay small, so that
/// products of two never overflow; arithmetic that would leave this range has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ratio {
    n: i64,
    d: i64,
}

/// Largest numerator and denominator of an exponent in dimensions.
const LIMIT: i64 = 1_000_000;
/// Largest denominator of a power that is read from a number.
const READABLE: i64 = 120;

impl Ratio {
    /// The exponent zero as a fraction.
    pub const ZERO: Ratio = Ratio::from_integer(0);
    /// The exponent one as a fraction.
    pub const ONE: Ratio = Ratio::from_integer(1);

    /// Returns an integer as a fraction with the denominator one.
    pub const fn from_integer(n: i64) -> Ratio {
        Ratio { n, d: 1 }
    }

    /// Returns the fraction `n / d` in lowest terms.
    pub fn new(n: i64, d: i64) -> Option<Ratio> {
        if d == 0 {
            return None;
        }
        let common = greatest_common_divisor(n.abs(), d.abs()).max(1) * d.signum();
        let (n, d) = (n / common, d / common);
        (n.abs() <= LIMIT && d <= LIMIT).then_some(Ratio { n, d })
    }

    /// Returns the simple fraction that equals a number, if one exists.
    pub fn from_value(x: f64) -> Option<Ratio> {
        let numerator_for_denominator = |d: i64| {
            let n = x * d as f64;
            ((n - n.round()).abs() < 1e-9 && n.abs() < 1e6).then(|| n.round() as i64)
        };
        (1..=READABLE).find_map(|d| numerator_for_denominator(d).and_then(|n| Ratio::new(n, d)))
    }

    /// Returns whether the fraction is zero.
    pub fn is_zero(self) -> bool {
        self.n == 0
    }

    /// Returns numerator and denominator of the fraction.
    pub fn numerator_and_denominator(self) -> (i64, i64) {
        (self.n, self.d)
    }

    /// Returns the negative `−self` of the fraction.
    pub fn negative_ratio(self) -> Ratio {
        Ratio { n: -self.n, d: self.d }
    }

    /// Returns the sum `self + other` of two fractions; `None` on overflow.
    pub fn checked_sum(self, other: Ratio) -> Option<Ratio> {
        Ratio::new(self.n * other.d + other.n * self.d, self.d * other.d)
    }

    /// Returns the product `self × other` of two fractions; `None` on overflow.
    pub fn checked_product(self, other: Ratio) -> Option<Ratio> {
        Ratio::new(self.n * other.n, self.d * other.d)
    }

    /// Returns the reciprocal `1 / self` of the fraction; `None` for zero.
    pub fn inverse(self) -> Option<Ratio> {
        Ratio::new(self.d, self.n)
    }
}

/// Returns the greatest common divisor by Euclid's algorithm.
fn greatest_common_divisor(mut a: i64, mut b: i64) -> i64 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_in_lowest_terms_and_bounded() {
        assert_eq!(Ratio::new(-4, -6), Ratio::new(2, 3));
        assert_eq!(Ratio::new(3, -6), Ratio::new(-1, 2));
        assert_eq!(Ratio::new(1, 0), None);
        assert_eq!(Ratio::new(i64::MAX, 1), None);
        assert_eq!(Ratio::from_value(1.5), Ratio::new(3, 2));
        assert_eq!(Ratio::from_value(1.0 / 3.0), Ratio::new(1, 3));
        assert_eq!(Ratio::from_value(std::f64::consts::PI), None);
        assert_eq!(Ratio::from_value(f64::NAN), None);
        let half = Ratio::new(1, 2).unwrap();
        assert_eq!(half.checked_sum(half), Some(Ratio::ONE));
        assert_eq!(half.checked_product(half).unwrap().numerator_and_denominator(), (1, 4));
        let large = Ratio::from_integer(LIMIT);
        assert_eq!(large.checked_product(large), None);
    }
}
