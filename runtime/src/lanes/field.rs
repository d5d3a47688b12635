//! Lanes as a real field of nalgebra, with lane-by-lane functions.

use super::{Lanes, Registers};
use crate::Real;
use crate::arithmetic::Compiled;
use nalgebra::{ComplexField, RealField};
use num_traits::Zero;

macro_rules! lane_by_lane {
    ($($function:ident)+) => {$(
        #[inline(always)]
        fn $function(self) -> Self {
            self.map(T::$function)
        }
    )+};
    (with other: $($function:ident)+) => {$(
        #[inline(always)]
        fn $function(self, other: Self) -> Self {
            self.zip(other, T::$function)
        }
    )+};
    (constant: $($function:ident)+) => {$(
        #[inline(always)]
        fn $function() -> Self {
            Self::splat(T::$function())
        }
    )+};
}

impl<T: Real, const N: usize> ComplexField for Lanes<T, N> {
    type RealField = Self;

    #[inline(always)]
    fn from_real(re: Self) -> Self {
        re
    }

    #[inline(always)]
    fn real(self) -> Self {
        self
    }

    #[inline(always)]
    fn imaginary(self) -> Self {
        Self::zero()
    }

    #[inline(always)]
    fn conjugate(self) -> Self {
        self
    }

    #[inline(always)]
    fn modulus(self) -> Self {
        ComplexField::abs(self)
    }

    #[inline(always)]
    fn norm1(self) -> Self {
        ComplexField::abs(self)
    }

    #[inline(always)]
    fn modulus_squared(self) -> Self {
        self * self
    }

    #[inline(always)]
    fn argument(self) -> Self {
        self.map(|x| T::from_real(x.argument()))
    }

    #[inline(always)]
    fn scale(self, factor: Self) -> Self {
        self * factor
    }

    #[inline(always)]
    fn unscale(self, factor: Self) -> Self {
        self / factor
    }

    #[inline(always)]
    fn to_exp(self) -> (Self, Self) {
        let one = T::one();
        let sign = self.map(|x| if x >= T::zero() { one } else { -one });
        (ComplexField::abs(self), sign)
    }

    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Lanes::mul_add(self, a, b)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        Self(Compiled::magnitude(&self.0))
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(Compiled::root(&self.0))
    }

    #[inline(always)]
    fn signum(self) -> Self {
        self.map(ComplexField::signum)
    }

    #[inline(always)]
    fn sin(self) -> Self {
        self.map(T::sin)
    }

    #[inline(always)]
    fn cos(self) -> Self {
        self.map(T::cos)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        Lanes::sin_cos(self)
    }

    lane_by_lane! {
        floor ceil round trunc fract recip cbrt
        tan asin acos atan sinh cosh tanh asinh acosh atanh sinc sinhc cosc coshc
        exp exp2 exp_m1 ln ln_1p log2 log10
    }
    lane_by_lane!(with other: hypot log powf powc);

    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        self.map(|x| x.powi(n))
    }

    /// Whether any lane is finite. Computations continue while one lane is finite, so that a failed lane does
    /// not stop the others.
    #[inline(always)]
    fn is_finite(&self) -> bool {
        self.0.iter().any(T::is_finite)
    }

    /// Returns the square root of each lane; `None` if any lane is negative.
    #[inline(always)]
    fn try_sqrt(self) -> Option<Self> {
        self.0.iter().all(|x| *x >= T::zero()).then(|| self.sqrt())
    }
}

impl<T: Real, const N: usize> RealField for Lanes<T, N> {
    /// Whether the sign bit of every lane is clear.
    #[inline(always)]
    fn is_sign_positive(&self) -> bool {
        self.0.iter().all(T::is_sign_positive)
    }

    /// Whether the sign bit of every lane is set.
    #[inline(always)]
    fn is_sign_negative(&self) -> bool {
        self.0.iter().all(T::is_sign_negative)
    }

    lane_by_lane!(with other: copysign max min atan2);

    #[inline(always)]
    fn clamp(self, min: Self, max: Self) -> Self {
        Self::from_fn(|k| self.0[k].clamp(min.0[k], max.0[k]))
    }

    #[inline(always)]
    fn min_value() -> Option<Self> {
        T::min_value().map(Self::splat)
    }

    #[inline(always)]
    fn max_value() -> Option<Self> {
        T::max_value().map(Self::splat)
    }

    lane_by_lane! {
        constant:
        pi two_pi frac_pi_2 frac_pi_3 frac_pi_4 frac_pi_6 frac_pi_8 frac_1_pi frac_2_pi frac_2_sqrt_pi
        e log2_e log10_e ln_2 ln_10
    }
}
