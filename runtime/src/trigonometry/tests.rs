mod exact;
mod large;

use super::*;
use crate::arithmetic::Compiled as A;

/// Checks sine and cosine of an angle with every instruction set that the processor has.
fn check_angle(x: f64) {
    check_angle_with_instruction_set::<A>(x);
    #[cfg(all(
        feature = "std",
        target_arch = "x86_64",
        not(all(target_feature = "avx2", target_feature = "fma")),
    ))]
    {
        use crate::lanes::x86::avx2;
        if avx2::is_available() {
            check_angle_with_instruction_set::<avx2::Avx2>(x);
        }
    }
}

fn check_angle_with_instruction_set<A: Arithmetic>(x: f64) {
    let (s, c) = A::sin_cos(x);
    // The sine of a small angle is the angle itself; large angles use the library.
    if !(1e-8..=LARGEST).contains(&x.abs()) {
        assert_eq!((s, c), ComplexField::sin_cos(x), "of {x:e}");
        return;
    }
    let [sine, cosine] = exact::sin_cos(x);
    assert!(exact::error_in_ulps(s, sine) <= 1.0, "sin {x:e}: {s:e}, by {}", exact::error_in_ulps(s, sine));
    assert!(
        exact::error_in_ulps(c, cosine) <= 1.0,
        "cos {x:e}: {c:e}, by {}",
        exact::error_in_ulps(c, cosine)
    );
}

#[test]
fn sines_are_accurate_to_one_ulp() {
    let mut state = 1_u64;
    for _ in 0..200_000 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let unit = (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5;
        check_angle(unit * 8.0);
        check_angle(unit * 2e4);
        check_angle(unit * 2e5);
    }
}

#[test]
fn sines_near_quarter_turns_are_accurate() {
    for k in -60_000_i32..60_000 {
        let x = f64::from(k) * core::f64::consts::FRAC_PI_2;
        check_angle(x);
        check_angle(f64::from_bits(x.to_bits() + 1));
    }
    for x in [1e-300, 5e-324, 1e5, 1.1e5, 1e22, f64::MAX] {
        check_angle(x);
        check_angle(-x);
    }
    assert_eq!((A::sin_cos(0.0), A::sin_cos(-0.0)), ((0.0, 1.0), (0.0, 1.0)));
    assert!(A::sin_cos(f64::INFINITY).0.is_nan() && A::sin_cos(f64::NAN).1.is_nan());
}

#[test]
fn sines_of_arrays_equal_sines_of_scalars() {
    let x = [0.1, -2.0, 7.0, 3e5];
    let (s, c) = A::sin_cos_all(x);
    for k in 0..4 {
        assert_eq!((s[k], c[k]), A::sin_cos(x[k]));
        check_angle(x[k]);
        let single = A::sin_cos(x[k] as f32);
        let exact = ComplexField::sin_cos(f64::from(x[k] as f32));
        assert_eq!(single, (exact.0 as f32, exact.1 as f32));
    }
}
