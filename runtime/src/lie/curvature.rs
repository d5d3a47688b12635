//! Second derivatives of `tangent_rate(dv, v)` of ball and free joints, contracted with factors. Blocks are
//! lists of columns.

use super::jacobians::{ball_tangent_rate_derivatives, even_factor_slopes, free_tangent_rate_derivatives};
use super::{
    SERIES_ANGLE, bernoulli_series, choose_by_limit, cross, dot, lie_bracket, se3_inverse_jacobian_factors,
    second_bracket_factor,
};
use crate::Real;
use crate::arithmetic::{Arithmetic, Compiled};
use crate::private::constant;

/// Square matrix as an array of columns.
type SquareBlock<T, const N: usize> = [[T; N]; N];

/// Returns the second derivatives with respect to `θ²` of the factors of `ad²` and `ad⁴` in the inverse
/// Jacobian of SE(3).
fn even_factor_curvatures<T: Real>(square: T) -> [T; 2] {
    choose_by_limit(
        square,
        constant(SERIES_ANGLE),
        |square| {
            [
                bernoulli_series(square, 3, |k| (2.0 - k) * (k - 1.0) * (k - 2.0)),
                bernoulli_series(square, 4, |k| (1.0 - k) * (k - 2.0) * (k - 3.0)),
            ]
        },
        |square| {
            let half = square.sqrt() * constant(0.5);
            let (sin, cos) = Compiled::sin_cos(half);
            let number = constant::<T>;
            let along = half * cos / sin;
            let over = half * half / (sin * sin);
            // c = along, and x c', x (x c')', x (x (x c')')' with respect to x = θ².
            let value = T::one() - along;
            let first = (along - over) * number(0.5);
            let second = (along - number(3.0) * over + number(2.0) * over * along) * number(0.25);
            let bent = number(6.0) * over * along - number(3.5) * over;
            let third = (number(0.5) * along + bent - number(2.0) * over * along * along - over * over)
                * number(0.25);
            let of_twice = third - number(5.0) * second + number(8.0) * first + number(4.0) * value;
            let of_four = third - number(6.0) * second + number(11.0) * first + number(6.0) * value;
            let cube = square * square * square;
            [of_twice / cube, of_four / (cube * square)]
        },
    )
}

/// Value, first and second derivative of a factor that multiplies a power of `ad`, as functions of `θ²`.
type FactorDerivatives<T> = [T; 3];

/// Returns the second derivatives with respect to `dv` of `λᵀ (f ad² v + g ad⁴ v)`, with `ad` the bracket
/// with `dv`. The last three numbers of `dv` are the rotation vector.
fn bracket_curvature<T: Real, const N: usize>(
    dv: [T; N],
    v: [T; N],
    lambda: [T; N],
    bracket: impl Fn([T; N], [T; N]) -> [T; N],
    factors: [FactorDerivatives<T>; 2],
) -> SquareBlock<T, N> {
    let two = constant::<T>(2.0);
    let inner_product_with_lambda =
        |x: &[T; N]| lambda.iter().zip(x).fold(T::zero(), |sum, (l, x)| sum + *l * *x);
    let unit_vector = |j: usize| core::array::from_fn(|i| if i == j { T::one() } else { T::zero() });
    let sum_of_vectors = |a: [T; N], b: [T; N]| core::array::from_fn(|k| a[k] + b[k]);
    // adᵏ v, and its derivatives along each direction.
    let mut powers = [v; 5];
    let mut changes = [[[T::zero(); N]; N]; 5];
    for k in 1..5 {
        powers[k] = bracket(dv, powers[k - 1]);
        for j in 0..N {
            changes[k][j] =
                sum_of_vectors(bracket(unit_vector(j), powers[k - 1]), bracket(dv, changes[k - 1][j]));
        }
    }
    // The derivative of θ² along a direction of the rotation vector is 2 dvⱼ.
    let squared_angle_derivative = |j: usize| if j + 3 < N { T::zero() } else { two * dv[j] };
    let entry_of_curvature = |i: usize, j: usize| {
        let mut second = [T::zero(); N];
        let mut total = T::zero();
        for k in 1..5 {
            let crossed = sum_of_vectors(
                bracket(unit_vector(i), changes[k - 1][j]),
                bracket(unit_vector(j), changes[k - 1][i]),
            );
            second = sum_of_vectors(crossed, bracket(dv, second));
            if k % 2 == 1 {
                continue;
            }
            let [value, slope, curvature] = factors[k / 2 - 1];
            let bent = if i == j && i + 3 >= N { two * slope } else { T::zero() };
            total = total
                + value * inner_product_with_lambda(&second)
                + slope
                    * (squared_angle_derivative(i) * inner_product_with_lambda(&changes[k][j])
                        + squared_angle_derivative(j) * inner_product_with_lambda(&changes[k][i]))
                + (curvature * squared_angle_derivative(i) * squared_angle_derivative(j) + bent)
                    * inner_product_with_lambda(&powers[k]);
        }
        total
    };
    let mut block = [[T::zero(); N]; N];
    for j in 0..N {
        for i in 0..=j {
            block[j][i] = entry_of_curvature(i, j);
            block[i][j] = block[j][i];
        }
    }
    block
}

/// Returns `λᵀ` times the derivatives of a function with respect to `dv`, for each unit vector as the
/// velocity `v`.
fn contracted_derivatives<T: Real, const N: usize>(
    lambda: [T; N],
    by_dv: impl Fn([T; N]) -> SquareBlock<T, N>,
) -> SquareBlock<T, N> {
    core::array::from_fn(|j| {
        let columns = by_dv(core::array::from_fn(|i| if i == j { T::one() } else { T::zero() }));
        columns.map(|column| column.iter().zip(&lambda).fold(T::zero(), |sum, (x, l)| sum + *x * *l))
    })
}

/// Returns the second derivatives of `λᵀ tangent_rate(dv, v)` of a ball joint: with respect to `dv` twice,
/// and to `dv` (rows) and `v`.
pub fn ball_tangent_rate_second_derivatives<T: Real>(
    dv: [T; 3],
    v: [T; 3],
    lambda: [T; 3],
) -> (SquareBlock<T, 3>, SquareBlock<T, 3>) {
    let square = dot(dv, dv);
    // The derivative of the factor with respect to θ² is the negative factor of the fourth bracket of SE(3).
    let ([_, fall], [_, slope]) = (se3_inverse_jacobian_factors(square), even_factor_slopes(square));
    let factors = [[second_bracket_factor(square), -fall, -slope], [T::zero(); 3]];
    (
        bracket_curvature(dv, v, lambda, cross, factors),
        contracted_derivatives(lambda, |e| ball_tangent_rate_derivatives(dv, e).0),
    )
}

/// Returns the second derivatives of `λᵀ tangent_rate(dv, v)` of a free joint, linear parts first: with
/// respect to `dv` twice, and to `dv` (rows) and `v`.
pub fn free_tangent_rate_second_derivatives<T: Real>(
    dv: [T; 6],
    v: [T; 6],
    lambda: [T; 6],
) -> (SquareBlock<T, 6>, SquareBlock<T, 6>) {
    let [_, _, _, x, y, z] = dv;
    let square = dot([x, y, z], [x, y, z]);
    let ([f, g], [f1, g1], [f2, g2]) =
        (se3_inverse_jacobian_factors(square), even_factor_slopes(square), even_factor_curvatures(square));
    (
        bracket_curvature(dv, v, lambda, lie_bracket, [[f, f1, f2], [g, g1, g2]]),
        contracted_derivatives(lambda, |e| free_tangent_rate_derivatives(dv, e).0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns reproducible pseudorandom numbers between `−size` and `size`.
    fn pseudorandom_numbers<const N: usize>(seed: usize, size: f64) -> [f64; N] {
        core::array::from_fn(|k| size * (12.9898 * (seed * N + k + 1) as f64).sin())
    }

    /// Returns derivatives of `λᵀ` times a block of columns, by central differences of fourth order, column
    /// by column.
    fn contracted_difference_columns<const N: usize>(
        lambda: [f64; N],
        f: impl Fn([f64; N]) -> SquareBlock<f64, N>,
    ) -> SquareBlock<f64, N> {
        let h = 1e-3;
        core::array::from_fn(|j| {
            let contracted_columns_at_displacement = |x: f64| {
                f(core::array::from_fn(|i| if i == j { x } else { 0.0 }))
                    .map(|column| column.iter().zip(&lambda).map(|(x, l)| x * l).sum::<f64>())
            };
            let (a, b, c, d) = (
                contracted_columns_at_displacement(-2.0 * h),
                contracted_columns_at_displacement(-h),
                contracted_columns_at_displacement(h),
                contracted_columns_at_displacement(2.0 * h),
            );
            core::array::from_fn(|i| (a[i] - d[i] + 8.0 * (c[i] - b[i])) / (12.0 * h))
        })
    }

    fn sum_of_vectors<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
        core::array::from_fn(|k| a[k] + b[k])
    }

    fn assert_blocks_agree<const N: usize>(
        found: SquareBlock<f64, N>,
        expected: SquareBlock<f64, N>,
        what: &str,
    ) {
        for (a, b) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((a - b).abs() < 1e-9, "{what}: {found:?} instead of {expected:?}");
        }
    }

    const SIZES: [f64; 9] = [0.0, 1e-9, 1e-3, 0.1, 0.3, 0.57, 0.6, 1.0, 1.7];

    /// Columns of the derivatives of `tangent_rate(dv, v)` with respect to `dv` and `v`.
    type FirstDerivativeFunction<const N: usize> =
        fn([f64; N], [f64; N]) -> (SquareBlock<f64, N>, SquareBlock<f64, N>);

    /// Second derivatives of `λᵀ tangent_rate(dv, v)`.
    type SecondDerivativeFunction<const N: usize> =
        fn([f64; N], [f64; N], [f64; N]) -> (SquareBlock<f64, N>, SquareBlock<f64, N>);

    fn check_second_derivatives<const N: usize>(
        first: FirstDerivativeFunction<N>,
        second: SecondDerivativeFunction<N>,
    ) {
        for (seed, size) in SIZES.into_iter().enumerate() {
            let (dv, v, lambda) = (
                pseudorandom_numbers(seed, size),
                pseudorandom_numbers(seed + 50, 1.0),
                pseudorandom_numbers(seed + 90, 1.0),
            );
            let (twice, mixed) = second(dv, v, lambda);
            let by_dv = contracted_difference_columns(lambda, |e| first(sum_of_vectors(dv, e), v).0);
            assert_blocks_agree(twice, by_dv, "twice");
            let by_v = contracted_difference_columns(lambda, |e| first(dv, sum_of_vectors(v, e)).0);
            assert_blocks_agree(mixed, by_v, "mixed");
        }
    }

    #[test]
    fn ball_second_derivatives_match_differences() {
        check_second_derivatives(ball_tangent_rate_derivatives, ball_tangent_rate_second_derivatives);
    }

    #[test]
    fn free_second_derivatives_match_differences() {
        check_second_derivatives(free_tangent_rate_derivatives, free_tangent_rate_second_derivatives);
    }

    /// Checks that series and closed form agree at the angle at which the code switches between them.
    #[test]
    fn series_meets_closed_form() {
        let [below, above] = [1.0 - 1e-12, 1.0 + 1e-12].map(|x| even_factor_curvatures(SERIES_ANGLE * x));
        for (a, b) in below.iter().zip(&above) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
}
