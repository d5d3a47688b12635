//! Hyper-dual numbers for exact second derivatives: a value, its derivatives along two directions, and the
//! mixed second derivative (Fike and Alonso, *The development of hyper-dual numbers for exact
//! second-derivative calculations*, 2011).

use std::ops::{Add, Div, Mul, Neg, Sub};

/// Hyper-dual number `x + a ε₁ + b ε₂ + c ε₁ ε₂`.
#[derive(Clone, Copy, Debug)]
pub struct HyperDual {
    pub value: f64,
    pub first: [f64; 2],
    pub second: f64,
}

impl HyperDual {
    /// Returns a constant as a hyper-dual number with zero derivatives.
    pub fn constant_hyper(value: f64) -> HyperDual {
        HyperDual { value, first: [0.0; 2], second: 0.0 }
    }

    /// Returns the composition with a function that has this value and these first two derivatives.
    fn compose_with_function(self, [value, first, second]: [f64; 3]) -> HyperDual {
        let [a, b] = self.first;
        HyperDual { value, first: [first * a, first * b], second: first * self.second + second * a * b }
    }

    pub fn sin_cos(self) -> (HyperDual, HyperDual) {
        let (s, c) = self.value.sin_cos();
        (self.compose_with_function([s, c, -s]), self.compose_with_function([c, -s, -c]))
    }
}

impl Add for HyperDual {
    type Output = HyperDual;
    fn add(self, other: HyperDual) -> HyperDual {
        let ([a, b], [c, d]) = (self.first, other.first);
        HyperDual {
            value: self.value + other.value,
            first: [a + c, b + d],
            second: self.second + other.second,
        }
    }
}

impl Neg for HyperDual {
    type Output = HyperDual;
    fn neg(self) -> HyperDual {
        HyperDual { value: -self.value, first: self.first.map(|x| -x), second: -self.second }
    }
}

impl Sub for HyperDual {
    type Output = HyperDual;
    fn sub(self, other: HyperDual) -> HyperDual {
        let ([a, b], [c, d]) = (self.first, other.first);
        HyperDual {
            value: self.value - other.value,
            first: [a - c, b - d],
            second: self.second - other.second,
        }
    }
}

impl Mul for HyperDual {
    type Output = HyperDual;
    fn mul(self, other: HyperDual) -> HyperDual {
        let ([a, b], [c, d], x, y) = (self.first, other.first, self.value, other.value);
        let second = x * other.second + y * self.second + a * d + b * c;
        HyperDual { value: x * y, first: [a * y + x * c, b * y + x * d], second }
    }
}

impl Div for HyperDual {
    type Output = HyperDual;
    fn div(self, other: HyperDual) -> HyperDual {
        let y = other.value;
        self * other.compose_with_function([1.0 / y, -1.0 / (y * y), 2.0 / (y * y * y)])
    }
}

/// Solves `A x = b` by Gaussian elimination with row interchanges.
pub fn solve_linear_system<const N: usize>(
    mut a: [[HyperDual; N]; N],
    mut b: [HyperDual; N],
) -> [HyperDual; N] {
    for k in 0..N {
        let best = (k..N).max_by(|i, j| a[*i][k].value.abs().total_cmp(&a[*j][k].value.abs()));
        let best = best.unwrap_or(k);
        a.swap(k, best);
        b.swap(k, best);
        let (pivot, side) = (a[k], b[k]);
        for i in (0..N).filter(|i| *i != k) {
            let factor = a[i][k] / pivot[k];
            for (entry, other) in a[i].iter_mut().zip(pivot) {
                *entry = *entry - factor * other;
            }
            b[i] = b[i] - factor * side;
        }
    }
    std::array::from_fn(|k| b[k] / a[k][k])
}
