//! Sines and cosines of all angles of a mechanism at once. The code is branch-free over arrays, so that the
//! compiler vectorises it. Results are within one unit in the last place for |x| ≤ 10⁵. Larger angles and
//! infinities use the functions of the standard library (or of `libm`), one by one, so that a result never
//! depends on the other angles. The functions of `libm` are equally accurate; those of glibc have up to 2e-28
//! of additional error, which matters if the result is nearly zero. NaN counts as small and passes through
//! all operations.
//!
//! Without optimisation no function is forced inline, because every inlined call would occupy its own stack.

use crate::Real;
use crate::arithmetic::{Arithmetic, Number};
use crate::lanes::Registers;
use core::any::Any;
use core::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use nalgebra::ComplexField;

/// Largest angle for which the three-part reduction is exact.
pub const LARGEST: f64 = 1e5;

/// Returns sines and cosines of several angles, rad. Multiples of eight angles are fastest.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
pub fn sin_cos_all<A: Registers, T: Real, const N: usize>(x: [T; N]) -> ([T; N], [T; N]) {
    if let Some(x) = reference_if_same_type::<_, [f64; N]>(&x)
        && let (s, c) = sin_cos_of_doubles::<A, N>(x)
        && let (Some(s), Some(c)) = (reference_if_same_type(&s), reference_if_same_type(&c))
    {
        return (*s, *c);
    }
    if let Some(x) = reference_if_same_type::<_, [f32; N]>(&x)
        && let (s, c) = sin_cos_of_doubles::<A, N>(&x.map(f64::from))
        && let (Some(s), Some(c)) =
            (reference_if_same_type(&s.map(|s| s as f32)), reference_if_same_type(&c.map(|c| c as f32)))
    {
        return (*s, *c);
    }
    #[cfg(feature = "std")]
    if let Some(done) = crate::lanes::angles::sin_cos_of_lanes::<A, T, N>(&x) {
        return done;
    }
    sin_cos_one_by_one(&x)
}

/// Value that is aligned to cache lines. A function with such a value on its stack aligns the whole stack
/// frame, so that registers saved there never cross a cache line.
#[repr(align(64))]
pub(crate) struct CacheAligned<T>(pub(crate) T);

/// Returns a reference as another type if both types are the same, otherwise `None`. The decision is made at
/// compile time.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn reference_if_same_type<A: 'static, B: 'static>(a: &A) -> Option<&B> {
    (a as &dyn Any).downcast_ref()
}

fn sin_cos_one_by_one<T: Real, const N: usize>(x: &[T; N]) -> ([T; N], [T; N]) {
    let (mut s, mut c) = ([T::zero(); N], [T::zero(); N]);
    for ((x, s), c) in x.iter().zip(&mut s).zip(&mut c) {
        (*s, *c) = x.sin_cos();
    }
    (s, c)
}

#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
fn sin_cos_of_doubles<A: Registers, const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]) {
    let (mut s, mut c) = ([0.0; N], [0.0; N]);
    let mut large = false;
    for ((x, s), c) in x.iter().zip(&mut s).zip(&mut c) {
        large |= x.abs() > LARGEST;
        (*s, *c) = sin_cos_of_small_angle::<A>(*x);
    }
    if large {
        // A copy: passing the angles themselves would force them through memory even if none is large.
        let copy = CacheAligned(*x);
        (s, c) = A::sin_cos_of_large(&copy.0);
    }
    (s, c)
}

/// Returns sines and cosines of angles, rad, with the library's values for large angles, so that each result
/// depends on its own angle alone.
#[inline(always)]
pub(crate) fn sin_cos_with_library_fallback<A: Registers, const N: usize>(
    x: &[f64; N],
) -> ([f64; N], [f64; N]) {
    let (mut s, mut c) = ([0.0; N], [0.0; N]);
    for ((x, s), c) in x.iter().zip(&mut s).zip(&mut c) {
        (*s, *c) =
            if x.abs() > LARGEST { ComplexField::sin_cos(*x) } else { sin_cos_of_small_angle::<A>(*x) };
    }
    (s, c)
}

/// Returns sine and cosine of an angle, rad, within the range of the fast argument reduction.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
fn sin_cos_of_small_angle<A: Registers>(x: f64) -> (f64, f64) {
    let (s, c, shifted) = reduced_sine_and_cosine::<A, _>(x);
    rotate_quadrant(s, c, shifted)
}

/// Coefficients of the polynomial for `(sin r - r) / r³` in `r²`, from fdlibm's `__kernel_sin` (Sun
/// Microsystems 1993).
#[expect(clippy::excessive_precision, reason = "the constants of the source, digit for digit")]
pub const SINE: [f64; 6] = [
    -1.666_666_666_666_663_243_48e-1,
    8.333_333_333_322_489_461_24e-3,
    -1.984_126_982_985_794_931_34e-4,
    2.755_731_370_707_006_767_89e-6,
    -2.505_076_025_340_686_341_95e-8,
    1.589_690_995_211_550_102_21e-10,
];

/// Coefficients of the polynomial for `(cos r - 1 + r² / 2) / r⁴` in `r²`, from fdlibm's `__kernel_cos`.
#[expect(clippy::excessive_precision, reason = "the constants of the source, digit for digit")]
pub const COSINE: [f64; 6] = [
    4.166_666_666_666_660_190_37e-2,
    -1.388_888_888_887_410_957_49e-3,
    2.480_158_728_947_672_941_78e-5,
    -2.755_731_435_139_066_330_35e-7,
    2.087_572_321_298_174_827_90e-9,
    -1.135_964_755_778_819_482_65e-11,
];

/// Number whose addition rounds to an integer with the quadrant of an angle in its last bits: 1.5 · 2⁵².
pub const ROUND: f64 = 6_755_399_441_055_744.0;

/// Parts of π/2 for reductions with fused multiply-add. The first is the nearest number, a multiple of which
/// is subtracted without error because the difference has fewer digits. The second has 36 bits, whose
/// products with integers are exact. The third is the remainder.
pub const QUARTER_TURN: [f64; 3] = [FRAC_PI_2, 6.123_233_995_707_727e-17, 2.903_855_973_979_360_5e-28];

/// Returns sine and cosine of the reduced angle, and the number whose last bits are the quadrant of the
/// angle.
///
/// Cody and Waite's reduction by multiples of π/2, with the rounding error of the reduced angle as a
/// correction term; Taylor-like polynomials in double precision. With fused multiply-add, fewer operations
/// suffice for the same accuracy.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn reduced_sine_and_cosine<A: Registers, X: Number<A>>(x: X) -> (X, X, X) {
    let shifted = A::mul_add(x, X::constant(FRAC_2_PI), X::constant(ROUND));
    let (r, low) = reduce_angle::<A, _>(x, shifted - X::constant(ROUND));
    let z = r * r;
    let square = z * z;
    let fourth = square * square;
    let [s0, s1, s2, s3, s4, s5] = SINE;
    let [c0, c1, c2, c3, c4, c5] = COSINE;
    // Neighbouring terms are added first, to shorten the chain of dependent operations.
    let sine = A::mul_add(fourth, X::constant(s5), cubic_polynomial::<A, _>(z, square, [s1, s2, s3, s4]));
    let sine = A::mul_add(z, sine, X::constant(s0));
    let cosine = A::mul_add(
        fourth,
        linear_polynomial::<A, _>(z, c4, c5),
        cubic_polynomial::<A, _>(z, square, [c0, c1, c2, c3]),
    );
    let one = X::constant(1.0);
    if A::FUSED {
        let s = r + A::mul_add(r * z, sine, low);
        let fallen = A::mul_sub(r, A::mul_add(z, cosine, X::constant(-0.5)), low);
        return (s, A::mul_add(r, fallen, one), shifted);
    }
    let half = X::constant(0.5) * z;
    let s = r + A::mul_add(r * z, sine, A::neg_mul_add(low, half, low));
    let most = one - half;
    let lost = (one - most) - half;
    let c = most + A::mul_add(square, cosine, A::neg_mul_add(r, low, lost));
    (s, c, shifted)
}

/// Returns the reduced angle `x − quarters · π/2`, for fewer than 2¹⁶ quarters, as an unevaluated sum of two
/// numbers. If both are tiny, the sine of the angle is their sum, and the cosine is one.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
fn reduce_angle<A: Registers, X: Number<A>>(x: X, quarters: X) -> (X, X) {
    if A::FUSED {
        let [nearest, next, rest] = QUARTER_TURN.map(X::constant);
        let first = A::neg_mul_add(quarters, nearest, x);
        let r = A::neg_mul_add(quarters, next, first);
        let low = A::neg_mul_add(quarters, next, first - r);
        return (r, A::neg_mul_add(quarters, rest, low));
    }
    // π / 2 in two parts of 33 bits, whose products are exact, and the remainder.
    const PARTS: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];
    let [most, next, rest] = [X::constant(PARTS[0]), X::constant(PARTS[1]), X::constant(PARTS[2])];
    let first = A::neg_mul_add(quarters, most, x);
    let second = quarters * next;
    let r = first - second;
    (r, A::neg_mul_add(quarters, rest, (first - r) - second))
}

/// Converts sine and cosine of the reduced angle to those of the angle by its quadrant. An odd quadrant
/// exchanges sine and cosine, and bits of the quadrant determine their signs.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn rotate_quadrant(s: f64, c: f64, shifted: f64) -> (f64, f64) {
    let quadrant = shifted.to_bits();
    let odd = (quadrant & 1).wrapping_neg();
    let (s, c) = (s.to_bits(), c.to_bits());
    let exchange = (s ^ c) & odd;
    let (s, c) = (s ^ exchange, c ^ exchange);
    let (s_sign, c_sign) = ((quadrant >> 1) << 63, (quadrant.wrapping_add(1) >> 1) << 63);
    (f64::from_bits(s ^ s_sign), f64::from_bits(c ^ c_sign))
}

/// Returns the linear polynomial `a + b z`.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
fn linear_polynomial<A: Registers, X: Number<A>>(z: X, a: f64, b: f64) -> X {
    A::mul_add(X::constant(b), z, X::constant(a))
}

/// Returns the cubic polynomial `a + b z + c z² + d z³`; `square` is `z²`.
#[cfg_attr(debug_assertions, inline)]
#[cfg_attr(not(debug_assertions), inline(always))]
fn cubic_polynomial<A: Registers, X: Number<A>>(z: X, square: X, [a, b, c, d]: [f64; 4]) -> X {
    A::mul_add(linear_polynomial::<A, _>(z, c, d), square, linear_polynomial::<A, _>(z, a, b))
}

#[cfg(test)]
mod tests;
