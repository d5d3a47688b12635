//! Arithmetic of SIMD lanes in vector registers.
//!
//! The compiler's automatic vectorisation covers isolated loops, but not the vectors of a long straight-line
//! program. The crate `wide`, on which nalgebra depends with the standard library, provides the registers of
//! the compilation target; without it every operation is a loop.

use crate::Real;
use crate::arithmetic::{Arithmetic, Compiled};
use crate::trigonometry;
#[cfg(feature = "std")]
use crate::trigonometry::{LARGEST, reference_if_same_type};

/// Loop that a generated body delegates to the runtime.
pub trait VectorLoop {
    /// Whether the loop fills several registers of eight numbers at a time.
    const IS_LONG: bool;

    /// Runs the loop with the instruction set `A`. The function and all its callees are inlined into a
    /// function with the target features of `A`.
    fn run<A: Arithmetic>(self);
}

/// Instruction set for arithmetic on single numbers and on several lanes at once.
pub trait Registers: Copy + 'static {
    /// Whether the processor has a fused multiply-add instruction; otherwise `mul_add` would be a slow
    /// library call. False with the feature `reproducible`, because other processors lack the instruction.
    const FUSED: bool;
    /// Whether there are 32 registers of eight double-precision numbers; otherwise there are 16 of four.
    const WIDE: bool;

    /// Runs a loop inside a function that enables the target features of the instruction set.
    fn run_loop<L: VectorLoop>(body: L);

    /// Returns the sums `a + b` of corresponding lanes.
    fn add<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N];
    /// Returns the differences `a − b` of corresponding lanes.
    fn sub<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N];
    /// Returns the products `a b` of corresponding lanes.
    fn mul<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N];
    /// Returns the quotients `a / b` of corresponding lanes.
    fn div<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N];
    /// Returns the negative `−a` of each lane.
    fn neg<T: Real, const N: usize>(a: &[T; N]) -> [T; N];
    /// Returns the absolute value of each lane.
    fn magnitude<T: Real, const N: usize>(a: &[T; N]) -> [T; N];
    /// Returns the square root of each lane.
    fn root<T: Real, const N: usize>(a: &[T; N]) -> [T; N];
    /// Returns `a b + c`, rounded once, lane by lane.
    fn fused<T: Real, const N: usize>(a: &[T; N], b: &[T; N], c: &[T; N]) -> [T; N];

    /// Returns sines and cosines of angles from those of the angles reduced modulo π/2. The last bits of
    /// `shifted` are the quadrants of the angles.
    #[cfg(feature = "std")]
    fn rotate_quadrants<const L: usize>(s: &[f64; L], c: &[f64; L], shifted: &[f64; L]) -> [[f64; L]; 2];
    /// Returns sines and cosines of angles, rad, within the range of the fast argument reduction.
    #[cfg(feature = "std")]
    fn sin_cos_of_small<const L: usize>(x: &[f64; L]) -> [[f64; L]; 2];
    /// Whether all angles are within the range of the fast argument reduction.
    #[cfg(feature = "std")]
    fn are_angles_in_fast_range<const L: usize, const N: usize>(x: &[[f64; L]; N]) -> bool;
    /// Returns the sines and cosines of the angles `x`, rad. This is the slow path, called if at least one
    /// angle is outside the range of the fast argument reduction.
    fn sin_cos_of_large<const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]);
}

/// Returns from the enclosing function with the result of an operation, if the lanes fill a register of this
/// type.
#[cfg(not(feature = "std"))]
macro_rules! register {
    ($($anything:tt)*) => {};
}
#[cfg(feature = "std")]
macro_rules! register {
    ($number:ident $lanes:literal $register:ident: ($($a:ident)+) => $f:expr) => {
        if N == $lanes
            && size_of::<T>() == size_of::<$number>()
            && let ($(Some($a),)+) = ($(reference_if_same_type::<_, [$number; $lanes]>($a),)+)
        {
            $(let $a = wide::$register::new(*$a);)+
            let result = $f.to_array();
            if let Some(result) = reference_if_same_type(&result) {
                return *result;
            }
        }
    };
}

macro_rules! operations {
    ($($name:ident($($a:ident)+) = $f:expr;)+) => {$(
        #[inline]
        fn $name<T: Real, const N: usize>($($a: &[T; N]),+) -> [T; N] {
            register!(f64 2 f64x2: ($($a)+) => $f);
            register!(f64 4 f64x4: ($($a)+) => $f);
            register!(f64 8 f64x8: ($($a)+) => $f);
            register!(f32 4 f32x4: ($($a)+) => $f);
            register!(f32 8 f32x8: ($($a)+) => $f);
            register!(f32 16 f32x16: ($($a)+) => $f);
            // Plain loops are unrolled, whereas array functions are not always inlined.
            let mut result = [T::zero(); N];
            for (k, result) in result.iter_mut().enumerate() {
                $(let $a = $a[k];)+
                *result = $f;
            }
            result
        }
    )+};
}

impl Registers for Compiled {
    const FUSED: bool = cfg!(all(
        feature = "std",
        not(feature = "reproducible"),
        any(target_feature = "fma", target_arch = "aarch64")
    ));
    const WIDE: bool = cfg!(target_feature = "avx512f");

    #[inline(always)]
    fn run_loop<L: VectorLoop>(body: L) {
        body.run::<Self>();
    }

    operations! {
        add(a b) = a + b;
        sub(a b) = a - b;
        mul(a b) = a * b;
        div(a b) = a / b;
        neg(a) = -a;
        root(a) = a.sqrt();
        fused(a b c) = a.mul_add(b, c);
    }

    #[inline]
    fn magnitude<T: Real, const N: usize>(a: &[T; N]) -> [T; N] {
        register!(f64 2 f64x2: (a) => a.abs());
        register!(f64 4 f64x4: (a) => a.abs());
        register!(f64 8 f64x8: (a) => a.abs());
        a.map(nalgebra::ComplexField::abs)
    }

    #[cfg(feature = "std")]
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn rotate_quadrants<const L: usize>(s: &[f64; L], c: &[f64; L], shifted: &[f64; L]) -> [[f64; L]; 2] {
        macro_rules! case {
            ($lanes:literal $register:ident $bits:ident) => {
                if L == $lanes
                    && let (Some(s), Some(c), Some(shifted)) = (
                        reference_if_same_type(s),
                        reference_if_same_type(c),
                        reference_if_same_type(shifted),
                    )
                {
                    use wide::{$bits, $register};
                    let [s, c, quadrant] = [s, c, shifted].map(|x| $register::new(*x).to_bits());
                    let (one, sign) = ($bits::splat(1), $bits::splat(1 << 63));
                    let exchange = (s ^ c) & ($bits::splat(0) - (quadrant & one));
                    let s = s ^ exchange ^ ((quadrant << 62_u32) & sign);
                    let c = c ^ exchange ^ (((quadrant + one) << 62_u32) & sign);
                    let result: [[f64; $lanes]; 2] = [s, c].map(|x| $register::from_bits(x).to_array());
                    if let Some(result) = reference_if_same_type(&result) {
                        return *result;
                    }
                }
            };
        }
        case!(2 f64x2 u64x2);
        case!(4 f64x4 u64x4);
        case!(8 f64x8 u64x8);
        let turned =
            core::array::from_fn::<_, L, _>(|k| trigonometry::rotate_quadrant(s[k], c[k], shifted[k]));
        [turned.map(|(s, _)| s), turned.map(|(_, c)| c)]
    }

    #[cfg(feature = "std")]
    #[inline]
    fn sin_cos_of_small<const L: usize>(x: &[f64; L]) -> [[f64; L]; 2] {
        super::angles::sin_cos_of_small::<Self, L>(x)
    }

    #[cfg(feature = "std")]
    #[cfg_attr(debug_assertions, inline)]
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn are_angles_in_fast_range<const L: usize, const N: usize>(x: &[[f64; L]; N]) -> bool {
        macro_rules! case {
            ($lanes:literal $register:ident) => {
                if L == $lanes
                    && let Some(x) = reference_if_same_type::<_, [[f64; $lanes]; N]>(x)
                {
                    use wide::$register;
                    // An ordered comparison: NaN is not large.
                    let mut large = $register::new([0.0; $lanes]);
                    for x in x {
                        large |= $register::new(*x).abs().simd_gt($register::splat(LARGEST));
                    }
                    return large.none();
                }
            };
        }
        case!(2 f64x2);
        case!(4 f64x4);
        case!(8 f64x8);
        !x.iter().flatten().any(|x| x.abs() > LARGEST)
    }

    #[cold]
    #[inline(never)]
    fn sin_cos_of_large<const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]) {
        trigonometry::sin_cos_with_library_fallback::<Self, N>(x)
    }
}

/// Returns the remainders of divisions lane by lane, for which processors have no instruction.
#[inline]
pub(super) fn rem<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
    core::array::from_fn(|k| a[k] % b[k])
}
