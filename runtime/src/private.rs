//! What generated code calls: constants, elementary functions and nalgebra's types under stable names.
//!
//! Thin wrappers over nalgebra's `RealField`, so that generated code need not import any trait. No mechanics here;
//! the exponentials of ball and free joints are in `lie`.

use crate::Real;

/// The nearest number of type `T` to `x`.
#[inline(always)]
pub fn constant<T: Real>(x: f64) -> T {
    nalgebra::convert(x)
}

macro_rules! elementary {
    ($($(#[$doc:meta])* $name:ident($($argument:ident),+);)+) => {
        $(
            $(#[$doc])*
            #[inline(always)]
            pub fn $name<T: Real>($($argument: T),+) -> T {
                elementary!(@call $name $($argument),+)
            }
        )+
    };
    (@call $name:ident $x:ident) => { $x.$name() };
    (@call $name:ident $x:ident, $y:ident) => { $x.$name($y) };
}

elementary! {
    /// The square root; NaN for `x < 0`.
    sqrt(x);
    /// The sine of `x`, rad.
    sin(x);
    /// The cosine of `x`, rad.
    cos(x);
    /// The tangent of `x`, rad.
    tan(x);
    /// The arc sine, rad; NaN outside [−1, 1].
    asin(x);
    /// The arc cosine, rad; NaN outside [−1, 1].
    acos(x);
    /// The arc tangent, rad.
    atan(x);
    /// The angle of the point (`x`, `y`), rad: `atan2(y, x)` as in the standard library.
    atan2(y, x);
    /// The hyperbolic sine.
    sinh(x);
    /// The hyperbolic cosine.
    cosh(x);
    /// The hyperbolic tangent.
    tanh(x);
    /// The exponential.
    exp(x);
    /// The natural logarithm; NaN for `x < 0`.
    ln(x);
    /// The power `x` to `y`; NaN for `x < 0` and a `y` that is no integer.
    powf(x, y);
    /// The magnitude.
    abs(x);
    /// 1 or −1 with the sign of `x`, also for zeros.
    signum(x);
}

/// True where one instruction multiplies and adds; elsewhere `mul_add` would be a slow library call.
pub(crate) const FUSED: bool =
    cfg!(all(feature = "std", any(target_feature = "fma", target_arch = "aarch64")));

/// `a b + c`, fused where the hardware can.
#[inline(always)]
pub fn mul_add<T: Real>(a: T, b: T, c: T) -> T {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// `a b - c`, fused where the hardware can.
#[inline(always)]
pub fn mul_sub<T: Real>(a: T, b: T, c: T) -> T {
    if FUSED { a.mul_add(b, -c) } else { a * b - c }
}

/// `c - a b`, fused where the hardware can.
#[inline(always)]
pub fn neg_mul_add<T: Real>(a: T, b: T, c: T) -> T {
    if FUSED { (-a).mul_add(b, c) } else { c - a * b }
}

/// `x` as `f64`, for error messages.
pub(crate) fn to_f64<T: Real>(x: T) -> f64 {
    nalgebra::try_convert(x).unwrap_or(f64::NAN)
}

/// The distance from 1 to the next larger number of type `T`.
pub(crate) fn epsilon<T: Real>() -> T {
    T::default_epsilon()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_agree_with_the_standard_library() {
        assert_eq!(atan2(1.0_f64, -2.0), 1.0_f64.atan2(-2.0));
        assert_eq!(powf(2.0_f64, 0.5), 2.0_f64.powf(0.5));
        assert_eq!(mul_add(2.0_f64, 3.0, 4.0), 10.0);
        assert_eq!(mul_sub(2.0_f64, 3.0, 4.0), 2.0);
        assert_eq!(neg_mul_add(2.0_f64, 3.0, 4.0), -2.0);
        assert_eq!(signum(-3.0_f64), -1.0);
        assert_eq!(constant::<f32>(0.1), 0.1_f32);
        assert_eq!(to_f64(0.5_f32), 0.5);
    }
}
