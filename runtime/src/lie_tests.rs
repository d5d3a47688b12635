use super::*;

const ANGLES: [f64; 12] = [0.0, 1e-200, 1e-12, 1e-8, 3e-8, 1e-4, 0.1, 0.2236, 0.49999, 0.50001, 2.0, 3.1];
const AXIS: [f64; 3] = [0.36, -0.48, 0.8];
const QUATERNION: [f64; 4] = [0.1, -0.5, 0.7, 0.5];
const POSE: [f64; 7] = [1.0, -2.0, 0.5, 0.1, -0.5, 0.7, 0.5];

fn largest_difference<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).abs()))
}

fn twist_from_parts(linear: [f64; 3], turn: [f64; 3]) -> [f64; 6] {
    let ([x, y, z], [rx, ry, rz]) = (linear, turn);
    [x, y, z, rx, ry, rz]
}

#[test]
fn ball_exponential_rotates_about_axis() {
    for angle in ANGLES.into_iter().chain([10.0, 1e3]) {
        let q = ball_integrate([0.0, 0.0, 0.0, 1.0], scaled_vector(AXIS, angle));
        let [x, y, z] = scaled_vector(AXIS, (angle / 2.0).sin());
        assert!(largest_difference(q, [x, y, z, (angle / 2.0).cos()]) < 4e-16 * (1.0 + angle), "{angle}");
    }
}

#[test]
fn ball_difference_inverts_integrate() {
    for angle in ANGLES {
        let dv = scaled_vector(AXIS, angle);
        let q = normalised_quaternion(QUATERNION);
        let found = ball_difference(q, ball_integrate(q, dv));
        assert!(largest_difference(found, dv) <= 4e-15 * (angle + 1e-1), "{angle}: {found:?}");
        let [x, y, z, w] = ball_integrate(q, dv);
        let found = ball_difference(q, [-x, -y, -z, -w]);
        assert!(largest_difference(found, dv) <= 4e-15 * (angle + 1e-1), "antipode of {angle}: {found:?}");
    }
}

#[test]
fn ball_difference_is_shortest_near_half_turn() {
    for excess in [-1e-9, -1e-15, 0.0, 1e-15, 1e-9] {
        let angle = core::f64::consts::PI + excess;
        let q1 = ball_integrate(QUATERNION, scaled_vector(AXIS, angle));
        let found = ball_difference(QUATERNION, q1);
        assert!(dot(found, found).sqrt() <= core::f64::consts::PI + 1e-15);
        let reached = ball_integrate(QUATERNION, found);
        assert!(
            largest_difference(reached, q1).min(largest_difference(reached, negated_quaternion(q1))) < 1e-15
        );
    }
}

fn negated_quaternion([x, y, z, w]: [f64; 4]) -> [f64; 4] {
    [-x, -y, -z, -w]
}

#[test]
fn free_difference_inverts_integrate() {
    for angle in ANGLES {
        let dv = twist_from_parts([0.3, 2.0, -1.0], scaled_vector(AXIS, angle));
        let found = free_difference(POSE, free_integrate(POSE, dv));
        assert!(largest_difference(found, dv) < 2e-14, "{angle}: {found:?}");
    }
}

#[test]
fn free_exponential_moves_along_screw() {
    // A screw motion along and about z by a quarter rotation: the end point of a circular arc of radius v /
    // ω.
    let quarter = core::f64::consts::FRAC_PI_2;
    let q = free_integrate([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 3.0, 0.0, 0.0, quarter]);
    let half = core::f64::consts::FRAC_1_SQRT_2;
    assert!(largest_difference(q, [1.0 / quarter, 1.0 / quarter, 3.0, 0.0, 0.0, half, half]) < 1e-15);
}

#[test]
fn free_exponential_is_additive_in_time() {
    for angle in ANGLES.into_iter().chain([20.0]) {
        let dv = twist_from_parts([0.3, 2.0, -1.0], scaled_vector(AXIS, angle));
        let half = dv.map(|x| 0.5 * x);
        let twice = free_integrate(free_integrate(POSE, half), half);
        assert!(largest_difference(free_integrate(POSE, dv), twice) < 4e-15, "{angle}");
    }
}

/// Checks that along the path φ(t) = dv + t rate the configuration `q ⊕ φ(t)` has the velocity `v` at t = 0.
#[test]
fn tangent_rates_produce_the_velocity() {
    let v = [0.7, -0.2, 1.1, 0.4, 0.9, -1.3];
    for angle in ANGLES.into_iter().chain([5.5, 7.0]) {
        let dv = twist_from_parts([0.3, 2.0, -1.0], scaled_vector(AXIS, angle));
        let rate = free_tangent_rate(dv, v);
        let step = 1e-3;
        let pose_at_time = |t: f64| free_integrate(POSE, plus_scaled(dv, t, rate));
        let tangent_velocity =
            |h: f64| plus_scaled([0.0; 6], 0.5 / h, free_difference(pose_at_time(-h), pose_at_time(h)));
        // Central differences, extrapolated: the error is of order step⁴.
        let (coarse, fine) = (tangent_velocity(step), tangent_velocity(step / 2.0));
        let body = plus_scaled(plus_scaled([0.0; 6], 4.0 / 3.0, fine), -1.0 / 3.0, coarse);
        assert!(largest_difference(body, v) < 1e-9, "{angle}: {body:?}");
        let [.., rx, ry, rz] = rate;
        let ball = ball_tangent_rate(scaled_vector(AXIS, angle), [0.4, 0.9, -1.3]);
        assert!(largest_difference(ball, [rx, ry, rz]) < 1e-13, "{angle}");
    }
}

#[test]
fn closed_forms_continue_the_series() {
    let (below, above) = (SERIES_ANGLE - 1e-15, SERIES_ANGLE);
    assert!((second_bracket_factor(below) - second_bracket_factor(above)).abs() < 1e-14);
    let (a, b) = (se3_inverse_jacobian_factors(below), se3_inverse_jacobian_factors(above));
    assert!((a[0] - b[0]).abs() < 1e-14 && (a[1] - b[1]).abs() < 1e-13);
    let (a, b) = (left_jacobian_factors(0.05_f64 - 1e-16), left_jacobian_factors(0.05_f64));
    assert!((a[0] - b[0]).abs() < 1e-15 && (a[1] - b[1]).abs() < 3e-14);
}

#[test]
fn single_precision_has_rounding_accuracy() {
    for angle in ANGLES {
        let to_single_precision = |x: f64| x as f32;
        let dv = twist_from_parts([0.3, 2.0, -1.0], scaled_vector(AXIS, angle));
        let v = [0.7, -0.2, 1.1, 0.4, 0.9, -1.3];
        let exact = free_integrate(POSE, dv);
        let found = free_integrate(POSE.map(to_single_precision), dv.map(to_single_precision)).map(f64::from);
        assert!(largest_difference(found, exact) < 2e-6, "{angle}");
        let exact = free_tangent_rate(dv, v);
        let found = free_tangent_rate(dv.map(to_single_precision), v.map(to_single_precision)).map(f64::from);
        assert!(largest_difference(found, exact) < 2e-5, "{angle}");
    }
}

#[test]
fn quaternions_remain_unit() {
    let mut q = QUATERNION;
    for _ in 0..100_000 {
        q = ball_integrate(q, [0.01, -0.02, 0.03]);
    }
    let [x, y, z, w] = q;
    assert!((x * x + y * y + z * z + w * w - 1.0).abs() < 4e-16);
}
