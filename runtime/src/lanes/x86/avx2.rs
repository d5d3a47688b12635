//! Registers and fused operations of processors with AVX2 and FMA, independent of the compilation target.
#![expect(unsafe_code, reason = "instructions that the target does not promise")]

use super::avx512::{self, Avx512};
use crate::Real;
use crate::arithmetic::Compiled;
use crate::lanes::registers::{Registers, VectorLoop};
use crate::trigonometry::{self, LARGEST, reference_if_same_type};
use core::any::TypeId;
use core::arch::x86_64::*;
use core::mem::transmute;

/// Arithmetic with AVX2 and FMA. Bodies with this arithmetic run within a function that has the target
/// features, if the processor supports them. The type is private to this crate, so that no other code can use
/// it without that check.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx2;

/// Whether the processor has the instructions AVX2 and FMA.
#[inline(always)]
pub(crate) fn is_available() -> bool {
    std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
}

/// Whether AVX2 and FMA speed up arithmetic with numbers of type `T`: `f64` or `f32`.
#[inline(always)]
pub(crate) fn speeds_up_scalar_type<T: Real>() -> bool {
    TypeId::of::<T>() == TypeId::of::<f64>() || TypeId::of::<T>() == TypeId::of::<f32>()
}

/// Returns from the enclosing function with the result of an operation, if the lanes fill this number of
/// registers.
macro_rules! registers {
    ([$number:ident; $lanes:literal] as [$register:ident; $count:literal]: ($($a:ident)+) => $f:expr) => {
        if N == $lanes
            && let ($(Some($a),)+) = ($(reference_if_same_type::<_, [$number; $lanes]>($a),)+)
        {
            // SAFETY: numbers and registers have the same bits; the processor has the instructions.
            let result: [$number; $lanes] = unsafe {
                $(let $a: [$register; $count] = transmute(*$a);)+
                let mut result: [$register; $count] = transmute([0.0 as $number; $lanes]);
                for k in 0..$count {
                    $(let $a = $a[k];)+
                    result[k] = $f;
                }
                transmute(result)
            };
            if let Some(result) = reference_if_same_type(&result) {
                return *result;
            }
        }
    };
}

/// Passes the list of vector operations with their intrinsics to another macro.
macro_rules! list {
    ($then:ident) => {
        $then! {
            add(a b) = _mm256_add_pd(a, b), _mm256_add_ps(a, b);
            sub(a b) = _mm256_sub_pd(a, b), _mm256_sub_ps(a, b);
            mul(a b) = _mm256_mul_pd(a, b), _mm256_mul_ps(a, b);
            div(a b) = _mm256_div_pd(a, b), _mm256_div_ps(a, b);
            root(a) = _mm256_sqrt_pd(a), _mm256_sqrt_ps(a);
            neg(a) = _mm256_xor_pd(a, _mm256_set1_pd(-0.0)), _mm256_xor_ps(a, _mm256_set1_ps(-0.0));
            magnitude(a) =
                _mm256_andnot_pd(_mm256_set1_pd(-0.0), a), _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        }
    };
}

/// Functions with the target features AVX2 and FMA. Each is optimised separately before it is inlined into a
/// body of many operations.
mod with_features {
    use super::*;

    macro_rules! functions {
        ($($name:ident($($a:ident)+) = $doubles:expr, $singles:expr;)+) => {$(
            #[inline]
            #[target_feature(enable = "avx2,fma")]
            pub(super) fn $name<T: Real, const N: usize>($($a: &[T; N]),+) -> [T; N] {
                registers!([f64; 4] as [__m256d; 1]: ($($a)+) => $doubles);
                registers!([f64; 8] as [__m256d; 2]: ($($a)+) => $doubles);
                registers!([f32; 8] as [__m256; 1]: ($($a)+) => $singles);
                registers!([f32; 16] as [__m256; 2]: ($($a)+) => $singles);
                Compiled::$name($($a),+)
            }
        )+};
    }
    list!(functions);

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn fused_multiply_add<T: Real, const N: usize>(a: &[T; N], b: &[T; N], c: &[T; N]) -> [T; N] {
        registers!([f64; 2] as [__m128d; 1]: (a b c) => _mm_fmadd_pd(a, b, c));
        registers!([f64; 4] as [__m256d; 1]: (a b c) => _mm256_fmadd_pd(a, b, c));
        registers!([f64; 8] as [__m256d; 2]: (a b c) => _mm256_fmadd_pd(a, b, c));
        registers!([f32; 4] as [__m128; 1]: (a b c) => _mm_fmadd_ps(a, b, c));
        registers!([f32; 8] as [__m256; 1]: (a b c) => _mm256_fmadd_ps(a, b, c));
        registers!([f32; 16] as [__m256; 2]: (a b c) => _mm256_fmadd_ps(a, b, c));
        let mut result = *c;
        for (k, result) in result.iter_mut().enumerate() {
            *result = a[k].mul_add(b[k], *result);
        }
        result
    }

    #[target_feature(enable = "avx2,fma")]
    pub(super) fn run_loop<L: VectorLoop>(body: L) {
        if L::IS_LONG && avx512::is_available() {
            return Avx512::run_loop(body);
        }
        body.run::<Avx2>();
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn rotate_quadrants<const L: usize>(
        s: &[f64; L],
        c: &[f64; L],
        shifted: &[f64; L],
    ) -> [[f64; L]; 2] {
        macro_rules! case {
            ($lanes:literal in $count:literal) => {
                if L == $lanes
                    && let (Some(s), Some(c), Some(shifted)) = (
                        reference_if_same_type::<_, [f64; $lanes]>(s),
                        reference_if_same_type::<_, [f64; $lanes]>(c),
                        reference_if_same_type::<_, [f64; $lanes]>(shifted),
                    )
                {
                    // SAFETY: numbers and registers have the same bits; the processor has the instructions.
                    let result: [[f64; $lanes]; 2] = unsafe {
                        let s: [__m256d; $count] = transmute(*s);
                        let c: [__m256d; $count] = transmute(*c);
                        let shifted: [__m256i; $count] = transmute(*shifted);
                        let (mut sines, mut cosines) = (s, c);
                        for k in 0..$count {
                            [sines[k], cosines[k]] = rotate_quadrant_in_register(s[k], c[k], shifted[k]);
                        }
                        let sines: [f64; $lanes] = transmute(sines);
                        let cosines: [f64; $lanes] = transmute(cosines);
                        [sines, cosines]
                    };
                    if let Some(result) = reference_if_same_type(&result) {
                        return *result;
                    }
                }
            };
        }
        case!(4 in 1);
        case!(8 in 2);
        Compiled::rotate_quadrants(s, c, shifted)
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn sin_cos_of_small<const L: usize>(x: &[f64; L]) -> [[f64; L]; 2] {
        crate::lanes::angles::sin_cos_of_small::<Avx2, L>(x)
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn are_angles_in_fast_range<const L: usize, const N: usize>(x: &[[f64; L]; N]) -> bool {
        macro_rules! case {
            ($lanes:literal in $count:literal) => {
                if L == $lanes
                    && let Some(x) = reference_if_same_type::<_, [[f64; $lanes]; N]>(x)
                {
                    // SAFETY: numbers and registers have the same bits; the processor has the instructions.
                    return unsafe {
                        // An ordered comparison: NaN is not large.
                        let mut large = _mm256_setzero_pd();
                        for x in x {
                            let x: [__m256d; $count] = transmute(*x);
                            for x in x {
                                let magnitude = _mm256_andnot_pd(_mm256_set1_pd(-0.0), x);
                                let more = _mm256_cmp_pd::<_CMP_GT_OQ>(magnitude, _mm256_set1_pd(LARGEST));
                                large = _mm256_or_pd(large, more);
                            }
                        }
                        _mm256_movemask_pd(large) == 0
                    };
                }
            };
        }
        case!(4 in 1);
        case!(8 in 2);
        Compiled::are_angles_in_fast_range(x)
    }
}

impl Registers for Avx2 {
    const FUSED: bool = !cfg!(feature = "reproducible");
    const WIDE: bool = false;

    #[inline(always)]
    fn run_loop<L: VectorLoop>(body: L) {
        // SAFETY: the processor has the instructions.
        unsafe { with_features::run_loop(body) }
    }

    list!(methods);

    #[inline(always)]
    fn fused<T: Real, const N: usize>(a: &[T; N], b: &[T; N], c: &[T; N]) -> [T; N] {
        // SAFETY: the processor has the instructions.
        unsafe { with_features::fused_multiply_add(a, b, c) }
    }

    #[inline(always)]
    fn rotate_quadrants<const L: usize>(s: &[f64; L], c: &[f64; L], shifted: &[f64; L]) -> [[f64; L]; 2] {
        // SAFETY: the processor has the instructions.
        unsafe { with_features::rotate_quadrants(s, c, shifted) }
    }

    #[inline(always)]
    fn sin_cos_of_small<const L: usize>(x: &[f64; L]) -> [[f64; L]; 2] {
        // SAFETY: the processor has the instructions.
        unsafe { with_features::sin_cos_of_small(x) }
    }

    #[inline(always)]
    fn are_angles_in_fast_range<const L: usize, const N: usize>(x: &[[f64; L]; N]) -> bool {
        // SAFETY: the processor has the instructions.
        unsafe { with_features::are_angles_in_fast_range(x) }
    }

    #[inline(always)]
    fn sin_cos_of_large<const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]) {
        // SAFETY: the processor has the instructions.
        unsafe { sin_cos_of_large(x) }
    }
}

#[cold]
#[inline(never)]
#[target_feature(enable = "avx2,fma")]
fn sin_cos_of_large<const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]) {
    trigonometry::sin_cos_with_library_fallback::<Avx2, N>(x)
}

/// Converts sine and cosine of the reduced angle to those of the angle by its quadrant. An odd quadrant
/// exchanges sine and cosine, and bits of the quadrant determine their signs.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn rotate_quadrant_in_register(s: __m256d, c: __m256d, quadrant: __m256i) -> [__m256d; 2] {
    let sign = _mm256_set1_pd(-0.0);
    // Only the first bit of each number is used.
    let odd = _mm256_castsi256_pd(_mm256_slli_epi64::<63>(quadrant));
    let sine = _mm256_blendv_pd(s, c, odd);
    let cosine = _mm256_blendv_pd(c, _mm256_xor_pd(s, sign), odd);
    let half = _mm256_and_pd(_mm256_castsi256_pd(_mm256_slli_epi64::<62>(quadrant)), sign);
    [_mm256_xor_pd(sine, half), _mm256_xor_pd(cosine, half)]
}
