//! Jacobians of the exponentials of SO(3) and SE(3): first derivatives of `q ⊕ dv` and `tangent_rate(dv, v)`
//! of ball and free joints. Blocks are lists of columns; displacements are expressed in body axes.

use super::{
    ball_tangent_rate, bernoulli_series, choose_by_limit, cross, dot, free_integrate, free_tangent_rate,
    left_jacobian_factors, lie_bracket, plus_scaled, quaternion_exponential, rotated_vector, scaled_vector,
    se3_inverse_jacobian_factors, second_bracket_factor, vector_sum,
};
use crate::Real;
use crate::arithmetic::{Arithmetic, Compiled};
use crate::private::constant;

/// Square matrix as an array of columns.
type SquareBlock<T, const N: usize> = [[T; N]; N];

/// Returns the matrix of a linear function as columns. The standard library's `map` is not used, because it
/// is not always inlined.
#[inline(always)]
fn columns_of_function<T: Real, const N: usize>(f: impl Fn([T; N]) -> [T; N]) -> SquareBlock<T, N> {
    let mut all = [[T::zero(); N]; N];
    for (j, column) in all.iter_mut().enumerate() {
        let mut unit = [T::zero(); N];
        unit.iter_mut().skip(j).take(1).for_each(|x| *x = T::one());
        *column = f(unit);
    }
    all
}

/// Returns the matrix of a linear function of twists of SE(3), with linear components first. Its linear
/// columns follow from the angular ones, because motions of SE(3) are rotations with dual numbers (Selig,
/// *Geometric Fundamentals of Robotics*, § 7.5).
#[inline(always)]
fn matrix_of_twist_function<T: Real>(f: impl Fn([T; 6]) -> [T; 6]) -> SquareBlock<T, 6> {
    let mut all = [[T::zero(); 6]; 6];
    let (linear, angular) = all.split_at_mut(3);
    for (j, (linear, angular)) in linear.iter_mut().zip(angular).enumerate() {
        let mut unit = [T::zero(); 6];
        unit.iter_mut().skip(3 + j).take(1).for_each(|x| *x = T::one());
        *angular = f(unit);
        let [.., x, y, z] = *angular;
        *linear = [x, y, z, T::zero(), T::zero(), T::zero()];
    }
    all
}

/// Returns the derivatives of `q ⊕ dv` of a ball joint, in body axes, with respect to displacements of `q`
/// and to `dv`: `exp(−dv)` and the right Jacobian of SO(3) (Chirikjian, *Stochastic Models, Information
/// Theory, and Lie Groups*, vol. 2, 2012, § 10.6).
pub fn ball_integrate_derivatives<T: Real>(dv: [T; 3]) -> (SquareBlock<T, 3>, SquareBlock<T, 3>) {
    let back = quaternion_exponential(dv.map(|x| -x));
    let [a, b] = left_jacobian_factors(dot(dv, dv));
    let right_jacobian_column = |e: [T; 3]| {
        let first = cross(dv, e);
        vector_sum(vector_sum(e, scaled_vector(first, -a)), scaled_vector(cross(dv, first), b))
    };
    (columns_of_function(|e| rotated_vector(back, e)), columns_of_function(right_jacobian_column))
}

/// Returns the derivatives of `tangent_rate(dv, v)` of a ball joint with respect to `dv` and to `v`.
pub fn ball_tangent_rate_derivatives<T: Real>(
    dv: [T; 3],
    v: [T; 3],
) -> (SquareBlock<T, 3>, SquareBlock<T, 3>) {
    let square = dot(dv, dv);
    let second = second_bracket_factor(square);
    // The derivative of the second bracket's factor with respect to θ² is the negative factor of the fourth.
    let [_, slope] = se3_inverse_jacobian_factors(square);
    let first = cross(dv, v);
    let twice = cross(dv, first);
    let rate_derivative_column = |e: [T; 3]| {
        let changed = cross(e, v);
        let brackets = vector_sum(cross(e, first), cross(dv, changed));
        let factor = constant::<T>(-2.0) * slope * dot(dv, e);
        vector_sum(
            vector_sum(scaled_vector(changed, constant(0.5)), scaled_vector(brackets, second)),
            scaled_vector(twice, factor),
        )
    };
    (columns_of_function(rate_derivative_column), columns_of_function(|e| ball_tangent_rate(dv, e)))
}

/// Returns the factors of `ad`, `ad²`, `ad³` and `ad⁴` in the left Jacobian of SE(3), `Σ adᵏ / (k + 1)!`, as
/// functions of `θ²`: `ad` has the minimal polynomial `ad (ad² + θ²)²` (Selig, *Geometric Fundamentals of
/// Robotics*, § 4.6).
fn se3_left_jacobian_factors<T: Real>(square: T) -> [T; 4] {
    choose_by_limit(
        square,
        constant(1.0),
        |square| {
            // Because of the double root, adᵐ⁺²ⁿ is n (−θ²)ⁿ⁻¹ adᵐ⁺² − (n − 1) (−θ²)ⁿ adᵐ; its weights are 1
            // / (2 n + 2)! and 1 / (2 n + 3)!.
            let mut factors = [constant::<T>(0.5), constant(1.0 / 6.0), T::zero(), T::zero()];
            let (mut power, mut odd, mut even) = (T::one(), 0.5, 1.0 / 6.0);
            for n in 1_u8..=9 {
                let n = f64::from(n);
                odd /= (2.0 * n + 1.0) * (2.0 * n + 2.0);
                even /= (2.0 * n + 2.0) * (2.0 * n + 3.0);
                let next = power * -square;
                let [c1, c2, c3, c4] = factors;
                factors = [
                    c1 - constant::<T>((n - 1.0) * odd) * next,
                    c2 - constant::<T>((n - 1.0) * even) * next,
                    c3 + constant::<T>(n * odd) * power,
                    c4 + constant::<T>(n * even) * power,
                ];
                power = next;
            }
            factors
        },
        |square| {
            let angle = square.sqrt();
            let (sin, cos) = Compiled::sin_cos(angle);
            let two = constant::<T>(2.0);
            let (s, c) = (angle * sin, angle * cos);
            let fourth = square * square;
            [
                (constant::<T>(4.0) - s - constant::<T>(4.0) * cos) / (two * square),
                (constant::<T>(4.0) * angle - constant::<T>(5.0) * sin + c) / (two * square * angle),
                (two - s - two * cos) / (two * fourth),
                (two * angle - constant::<T>(3.0) * sin + c) / (two * fourth * angle),
            ]
        },
    )
}

/// Returns the derivatives of `q ⊕ dv` of a free joint, in body axes, with respect to displacements of `q`
/// and to `dv`: the adjoint of `exp(−dv)` and the right Jacobian of SE(3); linear parts first.
pub fn free_integrate_derivatives<T: Real>(dv: [T; 6]) -> (SquareBlock<T, 6>, SquareBlock<T, 6>) {
    let [_, _, _, rx, ry, rz] = dv;
    let turn = [rx, ry, rz];
    let (o, i) = (T::zero(), T::one());
    let [px, py, pz, ..] = free_integrate([o, o, o, o, o, o, i], dv);
    let back = quaternion_exponential(turn.map(|x| -x));
    let adjoint_column = |[x, y, z, a, b, c]: [T; 6]| {
        let [x, y, z] = rotated_vector(back, vector_sum([x, y, z], cross([a, b, c], [px, py, pz])));
        let [a, b, c] = rotated_vector(back, [a, b, c]);
        [x, y, z, a, b, c]
    };
    let [c1, c2, c3, c4] = se3_left_jacobian_factors(dot(turn, turn));
    let right_jacobian_column = |e: [T; 6]| {
        let first = lie_bracket(dv, e);
        let second = lie_bracket(dv, first);
        let third = lie_bracket(dv, second);
        plus_scaled(
            plus_scaled(plus_scaled(plus_scaled(e, -c1, first), c2, second), -c3, third),
            c4,
            lie_bracket(dv, third),
        )
    };
    (matrix_of_twist_function(adjoint_column), matrix_of_twist_function(right_jacobian_column))
}

/// Returns the derivatives with respect to `θ²` of the factors of `ad²` and `ad⁴` in the inverse Jacobian of
/// SE(3).
pub(super) fn even_factor_slopes<T: Real>(square: T) -> [T; 2] {
    choose_by_limit(
        square,
        constant(super::SERIES_ANGLE),
        |square| {
            [
                bernoulli_series(square, 2, |k| (2.0 - k) * (k - 1.0)),
                bernoulli_series(square, 3, |k| (1.0 - k) * (k - 2.0)),
            ]
        },
        |square| {
            let half = square.sqrt() * constant(0.5);
            let (sin, cos) = Compiled::sin_cos(half);
            let (two, along) = (constant::<T>(2.0), half * cos / sin);
            let over = half * half / (sin * sin);
            let value = T::one() - along;
            let slope = (along - over) * constant(0.5);
            // Derivatives with respect to θ², times θ²: of value and slope.
            let value_by = -slope;
            let slope_by = (along - constant::<T>(3.0) * over + two * over * along) * constant(0.25);
            let second = two * value_by + slope_by - (two * value + slope);
            let fourth = value_by + slope_by - two * (value + slope);
            [second / (square * square), fourth / (square * square * square)]
        },
    )
}

/// Returns the derivatives of `tangent_rate(dv, v)` of a free joint with respect to `dv` and to `v`; linear
/// parts first.
pub fn free_tangent_rate_derivatives<T: Real>(
    dv: [T; 6],
    v: [T; 6],
) -> (SquareBlock<T, 6>, SquareBlock<T, 6>) {
    let [_, _, _, rx, ry, rz] = dv;
    let turn = [rx, ry, rz];
    let square = dot(turn, turn);
    let [second, fourth] = se3_inverse_jacobian_factors(square);
    let [second_slope, fourth_slope] = even_factor_slopes(square);
    let b1 = lie_bracket(dv, v);
    let b2 = lie_bracket(dv, b1);
    let b3 = lie_bracket(dv, b2);
    let b4 = lie_bracket(dv, b3);
    let rate_derivative_column = |e: [T; 6]| {
        let [_, _, _, x, y, z] = e;
        // Derivative of θ² along `e`.
        let along = constant::<T>(2.0) * dot(turn, [x, y, z]);
        let c1 = lie_bracket(e, v);
        let c2 = plus_scaled(lie_bracket(e, b1), T::one(), lie_bracket(dv, c1));
        let c3 = plus_scaled(lie_bracket(e, b2), T::one(), lie_bracket(dv, c2));
        let c4 = plus_scaled(lie_bracket(e, b3), T::one(), lie_bracket(dv, c3));
        let zero = [T::zero(); 6];
        let changed = plus_scaled(plus_scaled(plus_scaled(zero, constant(0.5), c1), second, c2), fourth, c4);
        plus_scaled(plus_scaled(changed, second_slope * along, b2), fourth_slope * along, b4)
    };
    (matrix_of_twist_function(rate_derivative_column), matrix_of_twist_function(|e| free_tangent_rate(dv, e)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lie::{ball_difference, ball_integrate, free_difference};

    /// Returns reproducible pseudorandom numbers between `−size` and `size`.
    fn pseudorandom_numbers<const N: usize>(seed: usize, size: f64) -> [f64; N] {
        core::array::from_fn(|k| size * (12.9898 * (seed * N + k + 1) as f64).sin())
    }

    /// Returns derivatives by central differences of fourth order, column by column.
    fn difference_columns<const N: usize, const M: usize>(f: impl Fn([f64; N]) -> [f64; M]) -> [[f64; M]; N] {
        let h = 1e-3;
        core::array::from_fn(|j| {
            let value_at_displacement = |x: f64| f(core::array::from_fn(|i| if i == j { x } else { 0.0 }));
            let (a, b, c, d) = (
                value_at_displacement(-2.0 * h),
                value_at_displacement(-h),
                value_at_displacement(h),
                value_at_displacement(2.0 * h),
            );
            core::array::from_fn(|i| (a[i] - d[i] + 8.0 * (c[i] - b[i])) / (12.0 * h))
        })
    }

    fn sum_of_vectors<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
        core::array::from_fn(|k| a[k] + b[k])
    }

    fn assert_blocks_agree<const N: usize>(found: [[f64; N]; N], expected: [[f64; N]; N], what: &str) {
        for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((a - b).abs() < 1e-9, "{what}: {found:?} instead of {expected:?}");
        }
    }

    #[test]
    fn ball_derivatives_match_differences() {
        for (seed, size) in [0.0, 1e-9, 1e-3, 0.1, 0.49, 0.51, 1.0, 1.7].into_iter().enumerate() {
            let (dv, v): ([f64; 3], [f64; 3]) =
                (pseudorandom_numbers(seed, size), pseudorandom_numbers(seed + 50, 1.0));
            let q = [0.1, -0.5, 0.3, 0.8];
            let end = ball_integrate(q, dv);
            let (by_q, by_dv) = ball_integrate_derivatives(dv);
            assert_blocks_agree(
                by_q,
                difference_columns(|e| ball_difference(end, ball_integrate(ball_integrate(q, e), dv))),
                "by q",
            );
            assert_blocks_agree(
                by_dv,
                difference_columns(|e| ball_difference(end, ball_integrate(q, sum_of_vectors(dv, e)))),
                "by dv",
            );
            let (by_dv, by_v) = ball_tangent_rate_derivatives(dv, v);
            assert_blocks_agree(
                by_dv,
                difference_columns(|e| ball_tangent_rate(sum_of_vectors(dv, e), v)),
                "rate by dv",
            );
            assert_blocks_agree(
                by_v,
                difference_columns(|e| ball_tangent_rate(dv, sum_of_vectors(v, e))),
                "rate by v",
            );
        }
    }

    #[test]
    fn free_derivatives_match_differences() {
        for (seed, size) in [0.0, 1e-9, 1e-3, 0.1, 0.3, 0.57, 0.6, 1.0, 1.7].into_iter().enumerate() {
            let (dv, v): ([f64; 6], [f64; 6]) =
                (pseudorandom_numbers(seed, size), pseudorandom_numbers(seed + 50, 1.0));
            let q = [0.3, 0.2, -0.7, 0.1, -0.5, 0.5, 0.7];
            let end = free_integrate(q, dv);
            let (by_q, by_dv) = free_integrate_derivatives(dv);
            assert_blocks_agree(
                by_q,
                difference_columns(|e| free_difference(end, free_integrate(free_integrate(q, e), dv))),
                "by q",
            );
            assert_blocks_agree(
                by_dv,
                difference_columns(|e| free_difference(end, free_integrate(q, sum_of_vectors(dv, e)))),
                "by dv",
            );
            let (by_dv, by_v) = free_tangent_rate_derivatives(dv, v);
            assert_blocks_agree(
                by_dv,
                difference_columns(|e| free_tangent_rate(sum_of_vectors(dv, e), v)),
                "rate by dv",
            );
            assert_blocks_agree(
                by_v,
                difference_columns(|e| free_tangent_rate(dv, sum_of_vectors(v, e))),
                "rate by v",
            );
        }
    }

    /// Checks that series and closed forms agree at the angles at which the code switches between them.
    #[test]
    fn series_meet_closed_forms() {
        let assert_continuous = |f: fn(f64) -> [f64; 2], x: f64| {
            let (below, above) = (f(x * (1.0 - 1e-12)), f(x * (1.0 + 1e-12)));
            below
                .iter()
                .zip(&above)
                .for_each(|(a, b)| assert!((a - b).abs() < 1e-13 + 1e-11 * a.abs(), "{a} {b}"));
        };
        assert_continuous(even_factor_slopes, super::super::SERIES_ANGLE);
        assert_continuous(|x| [se3_left_jacobian_factors(x)[0], se3_left_jacobian_factors(x)[1]], 1.0);
        assert_continuous(|x| [se3_left_jacobian_factors(x)[2], se3_left_jacobian_factors(x)[3]], 1.0);
    }
}
