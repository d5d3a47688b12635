use super::*;
use crate::arithmetic::{Compiled as A, Elementary};
use crate::private::constant;
use core::cmp::Ordering;
use nalgebra::{ComplexField, Matrix3, RealField, SVector, Vector3};
use std::format;

/// Returns lanes with numbers in (0.05, 0.95), negated in odd lanes.
fn pseudorandom_lanes<const N: usize>(seed: u64) -> Lanes<f64, N> {
    let mut state = seed;
    Lanes::from_fn(|k| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let unit = 0.05 + 0.9 * (state >> 11) as f64 / (1_u64 << 53) as f64;
        if k % 2 == 0 { unit } else { -unit }
    })
}

/// Checks that every lane of a result equals the result of the function for the numbers in that lane, bit for
/// bit.
fn check_lanes_equal_scalar_function<const N: usize>(
    wide: impl Fn(Lanes<f64, N>, Lanes<f64, N>, Lanes<f64, N>) -> Lanes<f64, N>,
    narrow: impl Fn(f64, f64, f64) -> f64,
) {
    for seed in 0..100 {
        let (a, b, c) =
            (pseudorandom_lanes(seed), pseudorandom_lanes(seed + 100), pseudorandom_lanes(seed + 200));
        let found = wide(a, b, c);
        for k in 0..N {
            let expected = narrow(a[k], b[k], c[k]);
            assert_eq!(found[k].to_bits(), expected.to_bits(), "lane {k} of {a}, {b}, {c}");
        }
    }
}

fn check_lane_arithmetic<const N: usize>() {
    check_lanes_equal_scalar_function::<N>(|a, b, _| a + b, |a, b, _| a + b);
    check_lanes_equal_scalar_function::<N>(|a, b, _| a - b, |a, b, _| a - b);
    check_lanes_equal_scalar_function::<N>(|a, b, _| a * b, |a, b, _| a * b);
    check_lanes_equal_scalar_function::<N>(|a, b, _| a / b, |a, b, _| a / b);
    check_lanes_equal_scalar_function::<N>(|a, b, _| a % b, |a, b, _| a % b);
    check_lanes_equal_scalar_function::<N>(|a, _, _| -a, |a, _, _| -a);
    check_lanes_equal_scalar_function::<N>(|a, _, _| a * 0.7 + 0.3, |a, _, _| a * 0.7 + 0.3);
    check_lanes_equal_scalar_function::<N>(A::mul_add, A::mul_add);
    check_lanes_equal_scalar_function::<N>(A::mul_sub, A::mul_sub);
    check_lanes_equal_scalar_function::<N>(A::neg_mul_add, A::neg_mul_add);
    check_lanes_equal_scalar_function::<N>(|a, b, c| a.mul_add(b, c), A::mul_add);
    check_lanes_equal_scalar_function::<N>(|a, _, _| ComplexField::abs(a), |a, _, _| a.abs());
    check_lanes_equal_scalar_function::<N>(|a, b, _| RealField::max(a, b), |a, b, _| a.max(b));
    check_lanes_equal_scalar_function::<N>(|a, b, _| RealField::min(a, b), |a, b, _| a.min(b));
    check_lanes_equal_scalar_function::<N>(|a, b, _| a.copysign(b), |a, b, _| a.copysign(b));
    check_lanes_equal_scalar_function::<N>(|a, _, _| ComplexField::signum(a), |a, _, _| a.signum());
    let assign_all_operators = |mut a: Lanes<f64, N>, b: Lanes<f64, N>, c| {
        a += b;
        a -= c;
        a *= b;
        a /= c;
        a
    };
    check_lanes_equal_scalar_function::<N>(assign_all_operators, |a, b, c| (a + b - c) * b / c);
}

#[test]
fn lane_arithmetic_matches_scalars() {
    check_lane_arithmetic::<1>();
    check_lane_arithmetic::<2>();
    check_lane_arithmetic::<3>();
    check_lane_arithmetic::<4>();
    check_lane_arithmetic::<8>();
    check_lane_arithmetic::<16>();
}

#[test]
fn lane_functions_match_scalars() {
    type LaneAndScalarFunction = (fn(f64x8) -> f64x8, fn(f64) -> f64);
    let functions: [LaneAndScalarFunction; 16] = [
        (|a| ComplexField::sqrt(a * a), |a| ComplexField::sqrt(a * a)),
        (ComplexField::tan, ComplexField::tan),
        (ComplexField::sin, ComplexField::sin),
        (ComplexField::cos, ComplexField::cos),
        (ComplexField::asin, ComplexField::asin),
        (ComplexField::acos, ComplexField::acos),
        (ComplexField::atan, ComplexField::atan),
        (ComplexField::sinh, ComplexField::sinh),
        (ComplexField::cosh, ComplexField::cosh),
        (ComplexField::tanh, ComplexField::tanh),
        (ComplexField::exp, ComplexField::exp),
        (|a| ComplexField::ln(a * a), |a| ComplexField::ln(a * a)),
        (|a| a.powi(3), |a| ComplexField::powi(a, 3)),
        (ComplexField::floor, ComplexField::floor),
        (ComplexField::round, ComplexField::round),
        (ComplexField::recip, ComplexField::recip),
    ];
    for (wide, narrow) in functions {
        check_lanes_equal_scalar_function(|a, _, _| wide(a), |a, _, _| narrow(a));
    }
    check_lanes_equal_scalar_function::<8>(|a, b, _| A::atan2(a, b), |a, b, _| A::atan2(a, b));
    check_lanes_equal_scalar_function::<8>(|a, b, _| A::powf(a * a, b), |a, b, _| A::powf(a * a, b));
    check_lanes_equal_scalar_function::<8>(|a, _, _| a.sin_cos().0, |a, _, _| A::sin_cos(a).0);
    check_lanes_equal_scalar_function::<8>(|a, _, _| a.sin_cos().1, |a, _, _| A::sin_cos(a).1);
}

#[test]
fn large_angle_does_not_affect_other_lanes() {
    let x = Lanes([0.3, 1e9, -2.0, f64::INFINITY, 1e5, -1e6, f64::NAN, 0.0]);
    let (s, c) = x.sin_cos();
    for k in 0..8 {
        let (sine, cosine) = A::sin_cos(x[k]);
        assert_eq!((s[k].to_bits(), c[k].to_bits()), (sine.to_bits(), cosine.to_bits()), "lane {k}");
    }
}

#[test]
fn sums_have_a_fixed_order() {
    let tiny = f64::EPSILON / 4.0;
    // (1 + tiny) + (tiny + tiny) and so on: the order of the additions determines the result.
    assert_eq!(Lanes([1.0, 0.1, tiny, 0.2]).sum(), (1.0 + tiny) + (0.1 + 0.2));
    assert_eq!(Lanes([0.1, 0.2, 0.3]).sum(), (0.1 + 0.3) + 0.2);
    let x: f64x8 = pseudorandom_lanes(5);
    let halves: Lanes<f64, 4> = Lanes::from_fn(|k| x[k] + x[k + 4]);
    assert_eq!(x.sum(), (halves[0] + halves[2]) + (halves[1] + halves[3]));
    assert_eq!((Lanes([3.0_f64]).sum(), Lanes::<f64, 0>([]).sum()), (3.0, 0.0));
}

#[test]
fn comparisons_require_all_lanes() {
    let [low, high, mixed] = [Lanes([1.0, 2.0]), Lanes([3.0, 4.0]), Lanes([0.0, 9.0])];
    assert_eq!(low.partial_cmp(&high), Some(Ordering::Less));
    assert_eq!(high.partial_cmp(&low), Some(Ordering::Greater));
    assert_eq!(low.partial_cmp(&low), Some(Ordering::Equal));
    assert_eq!(low.partial_cmp(&mixed), None);
    assert_eq!(low.partial_cmp(&Lanes([1.0, 3.0])), None);
    assert_eq!(Lanes::select([true, false], low, high), Lanes([1.0, 4.0]));
    assert_eq!(RealField::clamp(mixed, low, high), Lanes([1.0, 4.0]));
    assert_eq!(format!("{low:.1}"), "[1.0, 2.0]");
}

#[test]
fn lanes_convert_from_numbers() {
    assert_eq!(constant::<f64x4>(0.5), Lanes([0.5; 4]));
    assert_eq!(constant::<f32x8>(0.1), Lanes([0.1_f32; 8]));
    assert_eq!(nalgebra::try_convert::<f64x4, f64>(Lanes([2.0; 4])), Some(2.0));
    assert_eq!(nalgebra::try_convert::<f64x4, f64>(Lanes([2.0, 2.0, 3.0, 2.0])), None);
}

#[test]
fn nalgebra_computes_with_lanes() {
    let matrices = [Matrix3::new(4.0, 1.0, 0.5, 1.0, 3.0, 0.2, 0.5, 0.2, 2.0), Matrix3::identity() * 2.0];
    let vectors = [Vector3::new(1.0, -2.0, 3.0), Vector3::new(0.5, 0.25, -1.0)];
    let matrix = Matrix3::from_fn(|i, j| Lanes([matrices[0][(i, j)], matrices[1][(i, j)]]));
    let vector = SVector::<_, 3>::from_fn(|i, _| Lanes([vectors[0][i], vectors[1][i]]));
    let (product, norm) = (matrix * vector, vector.norm());
    let solution = matrix.cholesky().map(|c| c.solve(&vector));
    for k in 0..2 {
        assert_eq!(product.map(|x| x[k]), matrices[k] * vectors[k]);
        assert_eq!(norm[k], vectors[k].norm());
        let expected = matrices[k].cholesky().map(|c| c.solve(&vectors[k]));
        assert_eq!(solution.map(|s| s.map(|x| x[k])), expected);
    }
}

#[test]
fn lanes_contain_lanes() {
    let x = Lanes([pseudorandom_lanes::<4>(1), pseudorandom_lanes::<4>(2)]);
    let y = A::mul_add(x, x, constant(1.0));
    assert_eq!(y[1][2], A::mul_add(x[1][2], x[1][2], 1.0));
    assert_eq!(x.sum(), x[0] + x[1]);
    assert_eq!(ComplexField::sin_cos(x).0[0][3], A::sin_cos(x[0][3]).0);
}

/// Checks that in the arithmetic of `R` every lane of a result equals the result of the numbers in that lane
/// alone, bit for bit.
fn check_vector_operations<R: Registers, const N: usize>() {
    fn several_operations<R: Registers, X: Elementary<R>>(a: X, b: X, c: X) -> X {
        let (s, c) = R::sin_cos(R::mul_add(a, X::constant(9.0), c));
        let (large, _) = R::sin_cos(b * X::constant(1e6));
        let sum = R::mul_sub(s, c, R::neg_mul_add(a, large, -b)) / (R::abs(b) + X::constant(0.1));
        R::sqrt(R::mul_add(sum, sum, a * a)) - R::atan2(a, b)
    }
    let several_operations_in_lanes = |a: Lanes<f64, N>, b: Lanes<f64, N>, c: Lanes<f64, N>| {
        several_operations::<R, _>(R::lanes(a.0), R::lanes(b.0), R::lanes(c.0)).lanes()
    };
    check_lanes_equal_scalar_function::<N>(several_operations_in_lanes, several_operations::<R, f64>);
    let several_operations_in_f32 = |a, b, c| several_operations::<R, f32>(a, b, c);
    let [a, b, c] = [3, 4, 5].map(|seed| pseudorandom_lanes::<N>(seed).map(|x| x as f32));
    let found = several_operations::<R, _>(R::lanes(a.0), R::lanes(b.0), R::lanes(c.0)).lanes();
    for k in 0..N {
        assert_eq!(
            found[k].to_bits(),
            several_operations_in_f32(a[k], b[k], c[k]).to_bits(),
            "lane {k} of {a}, {b}, {c}"
        );
    }
}

fn check_vectors_of_any_length<R: Registers>() {
    check_vector_operations::<R, 1>();
    check_vector_operations::<R, 2>();
    check_vector_operations::<R, 3>();
    check_vector_operations::<R, 4>();
    check_vector_operations::<R, 8>();
    check_vector_operations::<R, 16>();
}

#[test]
fn vectors_compute_lane_by_lane() {
    check_vectors_of_any_length::<A>();
    #[cfg(all(
        feature = "std",
        target_arch = "x86_64",
        not(all(target_feature = "avx2", target_feature = "fma"))
    ))]
    {
        use x86::{avx2, avx512};
        if avx2::is_available()
            && avx2::speeds_up_scalar_type::<f64>()
            && avx2::speeds_up_scalar_type::<f32>()
        {
            check_vectors_of_any_length::<avx2::Avx2>();
        }
        if avx512::is_available() {
            check_vectors_of_any_length::<avx512::Avx512>();
        }
    }
}

/// Checks that lanes `I` and `J` of two vectors are stored to rows 1 and 2, and that no other row changes.
fn check_lane_pair_stored_to_rows<
    T: crate::Real,
    const I: usize,
    const J: usize,
    const N: usize,
    const M: usize,
>(
    number: fn(usize) -> T,
) {
    let (a, b) = (Lanes::<T, N>::from_fn(number), Lanes::<T, M>::from_fn(|k| number(100 + k)));
    let mut column = [T::zero(); 4];
    A::store_two_lanes_in_column::<I, J, 1, T, N, M, 4>(&mut column, A::lanes(a.0), A::lanes(b.0));
    assert_eq!(column, [T::zero(), a[I], b[J], T::zero()], "lanes {I} of {N} and {J} of {M}");
}

#[test]
fn lanes_are_stored_in_rows() {
    let index_plus_half = |k| 0.5 + k as f64;
    check_lane_pair_stored_to_rows::<f64, 0, 0, 2, 2>(index_plus_half);
    check_lane_pair_stored_to_rows::<f64, 1, 1, 2, 2>(index_plus_half);
    check_lane_pair_stored_to_rows::<f64, 0, 1, 2, 2>(index_plus_half);
    check_lane_pair_stored_to_rows::<f64, 1, 3, 2, 4>(index_plus_half);
    check_lane_pair_stored_to_rows::<f64, 2, 0, 4, 4>(index_plus_half);
    check_lane_pair_stored_to_rows::<f64, 5, 3, 8, 4>(index_plus_half);
    check_lane_pair_stored_to_rows::<f64, 2, 1, 3, 3>(index_plus_half);
    check_lane_pair_stored_to_rows::<f32, 3, 1, 4, 2>(|k| 0.5 + k as f32);
}
