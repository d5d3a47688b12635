//! Traits that nalgebra's fields require of a number in addition to arithmetic: ordering, zero and one,
//! conversions, approximate equality.

use super::Lanes;
use crate::Real;
use approx::{AbsDiffEq, RelativeEq, UlpsEq};
use core::cmp::Ordering;
use nalgebra::{Field, SimdValue};
use num_traits::{FromPrimitive, Num, One, Signed, Zero};
use simba::scalar::SubsetOf;

/// Compares lanes: the result is less, equal or greater if that holds in every lane, otherwise `None`.
impl<T: PartialOrd, const N: usize> PartialOrd for Lanes<T, N> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let [mut less, mut equal, mut greater] = [true; 3];
        for (a, b) in self.0.iter().zip(&other.0) {
            less &= a < b;
            equal &= a == b;
            greater &= a > b;
        }
        match (equal, less, greater) {
            (true, ..) => Some(Ordering::Equal),
            (_, true, _) => Some(Ordering::Less),
            (.., true) => Some(Ordering::Greater),
            _ => None,
        }
    }
}

impl<T: Real, const N: usize> Zero for Lanes<T, N> {
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(T::zero())
    }

    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.0.iter().all(T::is_zero)
    }
}

impl<T: Real, const N: usize> One for Lanes<T, N> {
    #[inline(always)]
    fn one() -> Self {
        Self::splat(T::one())
    }
}

impl<T: Real, const N: usize> Num for Lanes<T, N> {
    type FromStrRadixErr = T::FromStrRadixErr;

    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        T::from_str_radix(text, radix).map(Self::splat)
    }
}

impl<T: Real, const N: usize> Signed for Lanes<T, N> {
    #[inline(always)]
    fn abs(&self) -> Self {
        self.map(|x| Signed::abs(&x))
    }

    #[inline(always)]
    fn abs_sub(&self, other: &Self) -> Self {
        self.zip(*other, |a, b| a.abs_sub(&b))
    }

    #[inline(always)]
    fn signum(&self) -> Self {
        self.map(|x| Signed::signum(&x))
    }

    #[inline(always)]
    fn is_positive(&self) -> bool {
        self.0.iter().all(T::is_positive)
    }

    #[inline(always)]
    fn is_negative(&self) -> bool {
        self.0.iter().all(T::is_negative)
    }
}

impl<T: Real, const N: usize> FromPrimitive for Lanes<T, N> {
    #[inline(always)]
    fn from_i64(n: i64) -> Option<Self> {
        T::from_i64(n).map(Self::splat)
    }

    #[inline(always)]
    fn from_u64(n: u64) -> Option<Self> {
        T::from_u64(n).map(Self::splat)
    }

    #[inline(always)]
    fn from_f64(x: f64) -> Option<Self> {
        T::from_f64(x).map(Self::splat)
    }
}

impl<T: Real, const N: usize> AbsDiffEq for Lanes<T, N> {
    type Epsilon = Self;

    #[inline(always)]
    fn default_epsilon() -> Self {
        Self::splat(T::default_epsilon())
    }

    fn abs_diff_eq(&self, other: &Self, epsilon: Self) -> bool {
        (0..N).all(|k| self.0[k].abs_diff_eq(&other.0[k], epsilon.0[k]))
    }
}

impl<T: Real, const N: usize> RelativeEq for Lanes<T, N> {
    #[inline(always)]
    fn default_max_relative() -> Self {
        Self::splat(T::default_max_relative())
    }

    fn relative_eq(&self, other: &Self, epsilon: Self, largest: Self) -> bool {
        (0..N).all(|k| self.0[k].relative_eq(&other.0[k], epsilon.0[k], largest.0[k]))
    }
}

impl<T: Real, const N: usize> UlpsEq for Lanes<T, N> {
    fn default_max_ulps() -> u32 {
        T::default_max_ulps()
    }

    fn ulps_eq(&self, other: &Self, epsilon: Self, ulps: u32) -> bool {
        (0..N).all(|k| self.0[k].ulps_eq(&other.0[k], epsilon.0[k], ulps))
    }
}

impl<T: Real, const N: usize> Field for Lanes<T, N> {}

/// Presents lanes to nalgebra as a single number, so that nalgebra does not split them.
impl<T: Real, const N: usize> SimdValue for Lanes<T, N> {
    const LANES: usize = 1;
    type Element = Self;
    type SimdBool = bool;

    #[inline(always)]
    fn splat(x: Self) -> Self {
        x
    }

    #[inline(always)]
    fn extract(&self, _: usize) -> Self {
        *self
    }

    #[expect(unsafe_code, reason = "declared so by nalgebra; nothing unsafe is done")]
    #[inline(always)]
    unsafe fn extract_unchecked(&self, _: usize) -> Self {
        *self
    }

    #[inline(always)]
    fn replace(&mut self, _: usize, x: Self) {
        *self = x;
    }

    #[expect(unsafe_code, reason = "declared so by nalgebra; nothing unsafe is done")]
    #[inline(always)]
    unsafe fn replace_unchecked(&mut self, _: usize, x: Self) {
        *self = x;
    }

    #[inline(always)]
    fn select(self, condition: bool, other: Self) -> Self {
        if condition { self } else { other }
    }
}

/// Implements conversions from numbers to lanes, and back from lanes that all contain the same number.
macro_rules! numbers_in_lanes {
    ($($number:ty)+) => {$(
        impl<T: Real, const N: usize> SubsetOf<Lanes<T, N>> for $number {
            #[inline(always)]
            fn to_superset(&self) -> Lanes<T, N> {
                Lanes::splat(nalgebra::convert(*self))
            }

            #[inline(always)]
            fn from_superset_unchecked(lanes: &Lanes<T, N>) -> $number {
                lanes.0.first().map_or(0.0, |x| nalgebra::convert_unchecked(*x))
            }

            #[inline(always)]
            fn is_in_subset(lanes: &Lanes<T, N>) -> bool {
                lanes.0.first().is_some_and(|x| {
                    nalgebra::is_convertible::<T, $number>(x) && lanes.0.iter().all(|y| x == y)
                })
            }
        }
    )+};
}

numbers_in_lanes!(f32 f64);

impl<T: Real, const N: usize> SubsetOf<Lanes<T, N>> for Lanes<T, N> {
    #[inline(always)]
    fn to_superset(&self) -> Self {
        *self
    }

    #[inline(always)]
    fn from_superset_unchecked(lanes: &Self) -> Self {
        *lanes
    }

    #[inline(always)]
    fn is_in_subset(_: &Self) -> bool {
        true
    }
}
