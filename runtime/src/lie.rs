//! Exponential, logarithm and their derivatives on SO(3) and SE(3), for ball and free joints.
//!
//! Quaternions are stored x y z w and map child components to parent components; velocities are resolved in
//! the child (body) frame; SE(3) vectors hold the linear part first (m), then the angular part (rad).
//! Conventions of Pinocchio's `JointModelSpherical` and `JointModelFreeFlyer`.

pub mod curvature;
pub mod jacobians;

use crate::Real;
use crate::arithmetic::{Arithmetic, Compiled};
use crate::private::constant;
use core::cmp::Ordering;

/// Coefficients `cₖ = |B₂ₖ| / (2k)!` for k = 1, 2, …, with the Bernoulli numbers `B₂ₖ`:
/// `1 − (θ/2) cot(θ/2) = Σ cₖ θ²ᵏ`.
const BERNOULLI: [f64; 8] = [
    1.0 / 12.0,
    1.0 / 720.0,
    1.0 / 30240.0,
    1.0 / 1209600.0,
    1.0 / 47900160.0,
    691.0 / 1307674368000.0,
    1.0 / 74724249600.0,
    3617.0 / 10670622842880000.0,
];

fn cross<T: Real>([a, b, c]: [T; 3], [x, y, z]: [T; 3]) -> [T; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn dot<T: Real>([a, b, c]: [T; 3], [x, y, z]: [T; 3]) -> T {
    a * x + b * y + c * z
}

fn vector_sum<T: Real>([a, b, c]: [T; 3], [x, y, z]: [T; 3]) -> [T; 3] {
    [a + x, b + y, c + z]
}

fn scaled_vector<T: Real>([a, b, c]: [T; 3], s: T) -> [T; 3] {
    [a * s, b * s, c * s]
}

/// Returns the Hamilton product of two quaternions x y z w.
fn quaternion_product<T: Real>([ax, ay, az, aw]: [T; 4], [bx, by, bz, bw]: [T; 4]) -> [T; 4] {
    let [x, y, z] = cross([ax, ay, az], [bx, by, bz]);
    [
        x + aw * bx + bw * ax,
        y + aw * by + bw * ay,
        z + aw * bz + bw * az,
        aw * bw - dot([ax, ay, az], [bx, by, bz]),
    ]
}

fn conjugate<T: Real>([x, y, z, w]: [T; 4]) -> [T; 4] {
    [-x, -y, -z, w]
}

fn normalised_quaternion<T: Real>([x, y, z, w]: [T; 4]) -> [T; 4] {
    let norm = (x * x + y * y + z * z + w * w).sqrt();
    [x / norm, y / norm, z / norm, w / norm]
}

/// Returns the vector `a` rotated by a unit quaternion with vector part `u`: `a + 2 u × (u × a + w a)`.
fn rotated_vector<T: Real>([x, y, z, w]: [T; 4], a: [T; 3]) -> [T; 3] {
    let u = [x, y, z];
    let inner = vector_sum(cross(u, a), scaled_vector(a, w));
    vector_sum(a, scaled_vector(cross(u, inner), constant(2.0)))
}

/// Returns `small(x)` if `x` is below the limit and `large(x)` otherwise. If SIMD lanes of `x` differ in
/// this, both functions are evaluated within their own ranges, and every lane has the result of a single
/// number.
fn choose_by_limit<T: Real, const K: usize>(
    x: T,
    limit: T,
    small: impl Fn(T) -> [T; K],
    large: impl Fn(T) -> [T; K],
) -> [T; K] {
    match x.partial_cmp(&limit) {
        Some(Ordering::Less) => return small(x),
        Some(_) => return large(x),
        None => {}
    }
    let is_large = (T::one() + T::one().copysign(x - limit)) * constant(0.5);
    let is_small = T::one() - is_large;
    let mut values = small(x * is_small + limit * is_large);
    for (value, other) in values.iter_mut().zip(large(limit * is_small + x * is_large)) {
        *value = *value * is_small + other * is_large;
    }
    values
}

/// Limit of `θ²` below which six terms of the series of sine and cosine are exact to rounding; it exceeds
/// that of most integration steps.
const SMALL_TURN: f64 = 0.05;
/// Limit of `tan²(θ/2)` below which seven terms of the series of the arc tangent are exact to rounding.
const SMALL_TANGENT: f64 = 0.0025;

/// Returns the alternating polynomial `1/d₀ − x/d₁ + x²/d₂ − …` with the divisors `d₀, d₁, d₂, …`.
fn alternating_polynomial<T: Real, const N: usize>(x: T, divisors: [f64; N]) -> T {
    divisors.iter().rev().fold(T::zero(), |sum, d| constant::<T>(1.0 / d) - x * sum)
}

/// Returns the unit quaternion of the rotation vector `dv`: `(dv sin(θ/2)/θ, cos(θ/2))`.
pub(crate) fn quaternion_exponential<T: Real>(dv: [T; 3]) -> [T; 4] {
    let square = dot(dv, dv);
    let [factor, w] = choose_by_limit(
        square,
        constant(SMALL_TURN),
        // The first neglected terms are of order (θ/2)¹².
        |square| {
            let half = square * constant(0.25);
            [
                alternating_polynomial(half, [1.0, 6.0, 120.0, 5040.0, 362880.0, 39916800.0]) * constant(0.5),
                alternating_polynomial(half, [1.0, 2.0, 24.0, 720.0, 40320.0, 3628800.0]),
            ]
        },
        |square| {
            let angle = square.sqrt();
            let (sin, cos) = Compiled::sin_cos(angle * constant(0.5));
            [sin / angle, cos]
        },
    );
    let [x, y, z] = scaled_vector(dv, factor);
    [x, y, z, w]
}

/// Returns the shortest rotation vector of a quaternion of any nonzero norm.
pub(crate) fn quaternion_logarithm<T: Real>([x, y, z, w]: [T; 4]) -> [T; 3] {
    let sign = T::one().copysign(w);
    let u = scaled_vector([x, y, z], sign);
    let w = w * sign;
    let [factor] = choose_by_limit(
        dot(u, u),
        w * w * constant(SMALL_TANGENT),
        // The first neglected term is of order tan¹⁴.
        |square| {
            let inverse = T::one() / w;
            let tangent = square * inverse * inverse;
            [alternating_polynomial(tangent, [1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0]) * inverse * constant(2.0)]
        },
        |square| {
            let sin = square.sqrt();
            [constant::<T>(2.0) * sin.atan2(w) / sin]
        },
    );
    scaled_vector(u, factor)
}

/// Returns `Σ weight(k) cₖ x^(k − from)` over k ≥ `from`, with the Bernoulli coefficients `cₖ`.
fn bernoulli_series<T: Real>(x: T, from: usize, weight: impl Fn(f64) -> f64) -> T {
    let terms = (1_u8..).zip(BERNOULLI).skip(from - 1);
    let (sum, _) = terms.fold((T::zero(), T::one()), |(sum, power), (k, c)| {
        (sum + power * constant(weight(f64::from(k)) * c), power * x)
    });
    sum
}

/// Limit of `θ²`: below it the eight terms of the series are exact to rounding, above it the closed forms
/// are.
const SERIES_ANGLE: f64 = 0.25;

/// Returns `(1 − (θ/2) cot(θ/2)) / θ²` as a function of `θ²`: the factor of `[φ, [φ, ·]]` in the inverse
/// Jacobians of SO(3). Not finite at full rotations, where the exponential cannot be inverted.
fn second_bracket_factor<T: Real>(square: T) -> T {
    let [factor] = choose_by_limit(
        square,
        constant(SERIES_ANGLE),
        |square| [bernoulli_series(square, 1, |_| 1.0)],
        |square| {
            let half = square.sqrt() * constant(0.5);
            [(T::one() - half / half.tan()) / square]
        },
    );
    factor
}

/// Returns the factors of `ad²` and `ad⁴` in the inverse Jacobian of SE(3), as functions of `θ²`.
///
/// `ad` has the minimal polynomial `ad (ad² + θ²)²`, so `(ad/2) coth(ad/2)` is the even polynomial of degree
/// four that agrees with it at `iθ` in value and slope (Selig, *Geometric Fundamentals of Robotics*, §4.6).
fn se3_inverse_jacobian_factors<T: Real>(square: T) -> [T; 2] {
    choose_by_limit(
        square,
        constant(SERIES_ANGLE),
        |square| [bernoulli_series(square, 1, |k| 2.0 - k), bernoulli_series(square, 2, |k| 1.0 - k)],
        |square| {
            let half = square.sqrt() * constant(0.5);
            let (sin, cos) = Compiled::sin_cos(half);
            let value = T::one() - half * cos / sin;
            let slope = (half * cos / sin - half * half / (sin * sin)) * constant(0.5);
            [(constant::<T>(2.0) * value + slope) / square, (value + slope) / (square * square)]
        },
    )
}

/// Returns the bracket `[a, b]` of SE(3) for body velocities, linear part first.
fn lie_bracket<T: Real>(a: [T; 6], b: [T; 6]) -> [T; 6] {
    let [ax, ay, az, arx, ary, arz] = a;
    let [bx, by, bz, brx, bry, brz] = b;
    let (a_turn, b_turn) = ([arx, ary, arz], [brx, bry, brz]);
    let [x, y, z] = vector_sum(cross(a_turn, [bx, by, bz]), cross([ax, ay, az], b_turn));
    let [rx, ry, rz] = cross(a_turn, b_turn);
    [x, y, z, rx, ry, rz]
}

/// Returns the sum `a + s b` of two vectors of six numbers.
fn plus_scaled<T: Real>([a0, a1, a2, a3, a4, a5]: [T; 6], s: T, [b0, b1, b2, b3, b4, b5]: [T; 6]) -> [T; 6] {
    [a0 + s * b0, a1 + s * b1, a2 + s * b2, a3 + s * b3, a4 + s * b4, a5 + s * b5]
}

/// Returns `(1 − cos θ)/θ²` and `(θ − sin θ)/θ³` as functions of `θ²`: the left Jacobian of SO(3) is `1 + a
/// [φ]ₓ + b [φ]ₓ²`.
pub(crate) fn left_jacobian_factors<T: Real>(square: T) -> [T; 2] {
    choose_by_limit(
        square,
        constant(SMALL_TURN),
        |square| {
            [
                alternating_polynomial(square, [2.0, 24.0, 720.0, 40320.0, 3628800.0, 479001600.0]),
                alternating_polynomial(square, [6.0, 120.0, 5040.0, 362880.0, 39916800.0, 6227020800.0]),
            ]
        },
        |square| {
            let angle = square.sqrt();
            let ([half_sin, sin], _) = Compiled::sin_cos_all([angle * constant(0.5), angle]);
            [constant::<T>(2.0) * half_sin * half_sin / square, (angle - sin) / (angle * square)]
        },
    )
}

/// Returns the orientation of a ball joint after the displacement `dv`, `q ⊕ dv`: the quaternion `q exp(dv)`,
/// normalised.
///
/// - `q`: x y z w, of any nonzero norm; `dv`: rotation vector in the child frame, rad, of any magnitude.
pub fn ball_integrate<T: Real>(q: [T; 4], dv: [T; 3]) -> [T; 4] {
    normalised_quaternion(quaternion_product(q, quaternion_exponential(dv)))
}

/// Returns the displacement of a ball joint between two orientations: the rotation vector `dv`, in the child
/// frame of `q0`, rad, with `q0 ⊕ dv = ±q1` and `|dv| ≤ π`.
///
/// For a rotation by π, either of the two shortest solutions is returned. Quaternions need not be normalised.
pub fn ball_difference<T: Real>(q0: [T; 4], q1: [T; 4]) -> [T; 3] {
    quaternion_logarithm(quaternion_product(conjugate(normalised_quaternion(q0)), normalised_quaternion(q1)))
}

/// Returns the rate of the displacement `dv` of a ball joint such that `q ⊕ dv` rotates with the body-frame
/// angular velocity `v`, rad/s: the inverse right Jacobian of SO(3), `v + ½ dv × v + c dv × (dv × v)`. Not
/// finite at `|dv|` = 2π.
///
/// Source: Iserles et al., *Lie-group methods*, Acta Numerica 9 (2000), appendix B.
pub fn ball_tangent_rate<T: Real>(dv: [T; 3], v: [T; 3]) -> [T; 3] {
    let first = cross(dv, v);
    let second = scaled_vector(cross(dv, first), second_bracket_factor(dot(dv, dv)));
    vector_sum(vector_sum(v, scaled_vector(first, constant(0.5))), second)
}

/// Returns the pose of a free joint after the displacement `dv`, `q ⊕ dv`, by the exponential of SE(3).
///
/// - `q`: position in the parent frame, m, then quaternion x y z w; the quaternion of the result is
///   normalised.
/// - `dv`: displacement, m, then rotation vector, rad, both in the child frame, of any magnitude.
pub fn free_integrate<T: Real>(q: [T; 7], dv: [T; 6]) -> [T; 7] {
    let [px, py, pz, qx, qy, qz, qw] = q;
    let [x, y, z, rx, ry, rz] = dv;
    let (linear, turn) = ([x, y, z], [rx, ry, rz]);
    let quaternion = normalised_quaternion([qx, qy, qz, qw]);
    let [a, b] = left_jacobian_factors(dot(turn, turn));
    let first = cross(turn, linear);
    let moved = vector_sum(vector_sum(linear, scaled_vector(first, a)), scaled_vector(cross(turn, first), b));
    let [px, py, pz] = vector_sum([px, py, pz], rotated_vector(quaternion, moved));
    let [qx, qy, qz, qw] = ball_integrate(quaternion, turn);
    [px, py, pz, qx, qy, qz, qw]
}

/// Returns the displacement of a free joint between two poses: `dv`, in the child frame of `q0`, m and rad,
/// with `q0 ⊕ dv = q1`. It is the logarithm of SE(3) with the smallest rotation angle.
pub fn free_difference<T: Real>(q0: [T; 7], q1: [T; 7]) -> [T; 6] {
    let [x0, y0, z0, qx0, qy0, qz0, qw0] = q0;
    let [x1, y1, z1, qx1, qy1, qz1, qw1] = q1;
    let start = normalised_quaternion([qx0, qy0, qz0, qw0]);
    let turn = ball_difference(start, [qx1, qy1, qz1, qw1]);
    let moved = rotated_vector(conjugate(start), [x1 - x0, y1 - y0, z1 - z0]);
    let first = cross(turn, moved);
    let second = scaled_vector(cross(turn, first), second_bracket_factor(dot(turn, turn)));
    let [x, y, z] = vector_sum(vector_sum(moved, scaled_vector(first, constant(-0.5))), second);
    let [rx, ry, rz] = turn;
    [x, y, z, rx, ry, rz]
}

/// Returns the rate of the displacement `dv` of a free joint such that `q ⊕ dv` moves with the body-frame
/// velocity `v` (linear, m/s, then angular, rad/s): `v + ½ [dv, v] + 1/12 [dv, [dv, v]] − …`, summed in
/// closed form. Not finite at an angular part of 2π.
///
/// Source: Hairer, Lubich and Wanner, *Geometric Numerical Integration* (2006), III.4.
pub fn free_tangent_rate<T: Real>(dv: [T; 6], v: [T; 6]) -> [T; 6] {
    let [_, _, _, rx, ry, rz] = dv;
    let turn = [rx, ry, rz];
    let [second, fourth] = se3_inverse_jacobian_factors(dot(turn, turn));
    let first = lie_bracket(dv, v);
    let twice = lie_bracket(dv, first);
    let four_times = lie_bracket(dv, lie_bracket(dv, twice));
    plus_scaled(plus_scaled(plus_scaled(v, constant(0.5), first), second, twice), fourth, four_times)
}

/// Returns the angular velocity `v` of a ball joint, given in the child frame of `q`, in the child frame of
/// `q ⊕ dv`.
pub fn ball_carry<T: Real>(dv: [T; 3], v: [T; 3]) -> [T; 3] {
    rotated_vector(conjugate(quaternion_exponential(dv)), v)
}

/// Returns the velocity `v` (linear, then angular) of a free joint, given in the child frame of `q`, in the
/// child frame of `q ⊕ dv`.
pub fn free_carry<T: Real>(dv: [T; 6], v: [T; 6]) -> [T; 6] {
    let [_, _, _, rx, ry, rz] = dv;
    let [x, y, z, wx, wy, wz] = v;
    let back = conjugate(quaternion_exponential([rx, ry, rz]));
    let ([x, y, z], [wx, wy, wz]) = (rotated_vector(back, [x, y, z]), rotated_vector(back, [wx, wy, wz]));
    [x, y, z, wx, wy, wz]
}

/// Returns the rate of [`ball_carry`] for a displacement that begins at zero and grows at the rate `dv`:
/// `v × dv`.
pub fn ball_carry_rate<T: Real>(dv: [T; 3], v: [T; 3]) -> [T; 3] {
    cross(v, dv)
}

/// Returns the rate of [`free_carry`] for a displacement that begins at zero and grows at the rate `dv`: the
/// cross products of both parts of `v` with the angular part of `dv`.
pub fn free_carry_rate<T: Real>(dv: [T; 6], v: [T; 6]) -> [T; 6] {
    let [_, _, _, rx, ry, rz] = dv;
    let [x, y, z, wx, wy, wz] = v;
    let rotation = [rx, ry, rz];
    let ([x, y, z], [wx, wy, wz]) = (cross([x, y, z], rotation), cross([wx, wy, wz], rotation));
    [x, y, z, wx, wy, wz]
}

#[cfg(test)]
#[path = "lie_tests.rs"]
mod tests;
