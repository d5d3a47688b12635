//! Registers of eight double-precision numbers, for loops. Straight-line bodies of many operations hardly
//! benefit, and would have to be compiled once more.
#![expect(unsafe_code, reason = "instructions that the target does not promise")]

use super::avx2::Avx2;
use crate::Real;
use crate::lanes::registers::{Registers, VectorLoop};
use crate::trigonometry::reference_if_same_type;
use core::arch::x86_64::*;
use core::mem::transmute;

/// Arithmetic with AVX-512. Loops with this arithmetic run within a function that has the target features, if
/// the processor supports them. The type is private to this crate, so that no other code can use it without
/// that check.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512;

/// Whether the processor has AVX-512 instructions and does not reduce its clock frequency when they are used:
/// Intel since Ice Lake, AMD since Zen 4.
#[inline(always)]
pub(crate) fn is_available() -> bool {
    use std::is_x86_feature_detected as has;
    has!("avx2") && has!("fma") && has!("avx512f") && has!("avx512vl") && has!("avx512vbmi2")
}

/// Functions with the target feature AVX-512. Vectors of other than eight numbers use AVX2.
mod with_features {
    use super::*;

    macro_rules! functions {
        ($($name:ident($($a:ident)+) = $f:expr;)+) => {$(
            #[inline]
            #[target_feature(enable = "avx2,fma,avx512f,avx512vl")]
            pub(super) fn $name<T: Real, const N: usize>($($a: &[T; N]),+) -> [T; N] {
                if let ($(Some($a),)+) = ($(reference_if_same_type::<_, [f64; 8]>($a),)+) {
                    // SAFETY: numbers and registers have the same bits.
                    let result: [f64; 8] = unsafe {
                        $(let $a: __m512d = transmute(*$a);)+
                        transmute($f)
                    };
                    if let Some(result) = reference_if_same_type(&result) {
                        return *result;
                    }
                }
                Avx2::$name($($a),+)
            }
        )+};
    }

    functions! {
        add(a b) = _mm512_add_pd(a, b);
        sub(a b) = _mm512_sub_pd(a, b);
        mul(a b) = _mm512_mul_pd(a, b);
        neg(a) = _mm512_sub_pd(_mm512_set1_pd(-0.0), a);
        fused(a b c) = _mm512_fmadd_pd(a, b, c);
    }

    #[target_feature(enable = "avx2,fma,avx512f,avx512vl")]
    pub(super) fn run_loop<L: VectorLoop>(body: L) {
        body.run::<Avx512>();
    }
}

impl Registers for Avx512 {
    const FUSED: bool = !cfg!(feature = "reproducible");
    const WIDE: bool = true;

    #[inline(always)]
    fn run_loop<L: VectorLoop>(body: L) {
        // SAFETY: the processor has the instructions.
        unsafe { with_features::run_loop(body) }
    }

    methods! {
        add(a b);
        sub(a b);
        mul(a b);
        neg(a);
        fused(a b c);
    }

    #[inline(always)]
    fn div<T: Real, const N: usize>(a: &[T; N], b: &[T; N]) -> [T; N] {
        Avx2::div(a, b)
    }

    #[inline(always)]
    fn root<T: Real, const N: usize>(a: &[T; N]) -> [T; N] {
        Avx2::root(a)
    }

    #[inline(always)]
    fn magnitude<T: Real, const N: usize>(a: &[T; N]) -> [T; N] {
        Avx2::magnitude(a)
    }

    #[inline(always)]
    fn rotate_quadrants<const L: usize>(s: &[f64; L], c: &[f64; L], shifted: &[f64; L]) -> [[f64; L]; 2] {
        Avx2::rotate_quadrants(s, c, shifted)
    }

    #[inline(always)]
    fn sin_cos_of_small<const L: usize>(x: &[f64; L]) -> [[f64; L]; 2] {
        Avx2::sin_cos_of_small(x)
    }

    #[inline(always)]
    fn are_angles_in_fast_range<const L: usize, const N: usize>(x: &[[f64; L]; N]) -> bool {
        Avx2::are_angles_in_fast_range(x)
    }

    #[inline(always)]
    fn sin_cos_of_large<const N: usize>(x: &[f64; N]) -> ([f64; N], [f64; N]) {
        Avx2::sin_cos_of_large(x)
    }
}
