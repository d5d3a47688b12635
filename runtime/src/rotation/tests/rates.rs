use super::*;
use crate::rotation::*;
use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// Lengths of rotation vectors at which rates are tested, rad: tiny, small, on both sides of the limits of
/// the series, near and beyond π and 2π.
const LENGTHS: [f64; 15] =
    [0.0, 1e-200, 1e-9, 1e-4, 0.2, 0.23, 0.49, 0.51, 2.0, 3.1, PI, 3.2, 6.0, 6.6, 11.0];

#[test]
fn euler_angle_rates_give_angular_velocity() {
    let mut random = RandomNumbers(11);
    for sequence in EulerSequence::ALL {
        for _ in 0..20 {
            let (angles, rates) = (random.random_vector() * 3.0, random.random_vector());
            let rotation = sequence.rotation(angles.into());
            let rate = derivative_at_zero(|t| *sequence.rotation((angles + rates * t).into()).matrix());
            let body = sequence.omega_body(angles.into(), rates.into());
            let space = sequence.omega_space(angles.into(), rates.into());
            assert_error_below_bound(
                largest_entry_difference(&rotation_omega_body(&rotation, &rate), &body),
                1e-12,
                sequence,
            );
            assert_error_below_bound(
                largest_entry_difference(&rotation_omega_space(&rotation, &rate), &space),
                1e-12,
                sequence,
            );
            assert_error_below_bound(largest_entry_difference(&(rotation * body), &space), 2e-15, sequence);
        }
    }
}

#[test]
fn euler_rates_invert_angular_velocity() {
    let mut random = RandomNumbers(12);
    for sequence in EulerSequence::ALL {
        for offset in [1e-14, 1e-10, 1e-6, 1e-3, 0.3, 1.0] {
            for _ in 0..20 {
                let singular = if sequence.is_symmetric() { PI } else { -FRAC_PI_2 };
                let [a, c] = random.random_numbers().map(|x: f64| PI * x);
                let angles = [a, singular + offset, c];
                let rates: [f64; 3] = random.random_numbers();
                let (body, space) = (sequence.omega_body(angles, rates), sequence.omega_space(angles, rates));
                for found in
                    [sequence.rates_from_body(angles, &body), sequence.rates_from_space(angles, &space)]
                {
                    assert_error_below_bound(
                        largest_euler_angle_difference(found.unwrap(), rates) * offset,
                        1.5e-15,
                        (sequence, offset),
                    );
                }
                let omega = random.random_vector();
                let rates = sequence.rates_from_body(angles, &omega).unwrap();
                assert_error_below_bound(
                    largest_entry_difference(&sequence.omega_body(angles, rates), &omega) * offset,
                    1.5e-15,
                    (sequence, offset),
                );
            }
        }
    }
}

#[test]
fn gimbal_lock_is_reported() {
    let omega = Vector3::new(0.3, -0.2, 0.5);
    for sequence in EulerSequence::ALL {
        let singular = if sequence.is_symmetric() { 0.0 } else { FRAC_PI_2 };
        for turns in [-1000.0, -3.0, -1.0, 0.0, 1.0, 2.0, 5.0, 1e6] {
            let angles = [0.4, singular + turns * PI, -1.1];
            assert_eq!(
                sequence.rates_from_body(angles, &omega),
                Err(Singular::ParallelAxes),
                "{sequence} {turns}"
            );
            assert_eq!(sequence.rates_from_space(angles, &omega), Err(Singular::ParallelAxes));
            // The forward matrices are correct: their third column is the first one or its opposite.
            for matrix in [sequence.body_rate_matrix(angles), sequence.space_rate_matrix(angles)] {
                assert_error_below_bound(matrix.determinant().abs(), 1e-9, sequence);
                let parallel = matrix.column(0).dot(&matrix.column(2)).abs();
                assert_error_below_bound((parallel - 1.0).abs(), 1e-12, sequence);
            }
        }
        let nan = sequence.rates_from_body([0.0, f64::NAN, 0.0], &omega).unwrap();
        assert!(nan.iter().any(|x| x.is_nan()), "the caller's NaN is no singularity");
    }
}

#[test]
fn matrix_and_quaternion_rates_match_motion() {
    let mut random = RandomNumbers(13);
    for _ in 0..200 {
        let (q, omega) = (random.random_quaternion(), random.random_vector());
        let rotation = q.to_rotation_matrix();
        let space = rotation * omega;
        let attitude_at_time = |t: f64| q * RotationVector(omega * t).quaternion();

        let rate = quaternion_rate_from_body(&q, &omega);
        assert_error_below_bound(
            largest_entry_difference(&rate.coords, &derivative_at_zero(|t| attitude_at_time(t).coords)),
            1e-12,
            omega,
        );
        assert_error_below_bound(
            largest_entry_difference(&rate.coords, &quaternion_rate_from_space(&q, &space).coords),
            5e-16,
            omega,
        );
        assert_error_below_bound(
            largest_entry_difference(&quaternion_omega_body(&q, &rate), &omega),
            1e-15,
            omega,
        );
        assert_error_below_bound(
            largest_entry_difference(&quaternion_omega_space(&q, &rate), &space),
            1e-15,
            omega,
        );
        assert_error_below_bound(rate.coords.dot(&q.coords).abs(), 3e-16, omega);
        let other = quaternion_rate_from_body(&antipode(&q), &omega);
        assert_error_below_bound(largest_entry_difference(&other.coords, &-rate.coords), 0.0, omega);

        let rate = rotation_rate_from_body(&rotation, &omega);
        assert_error_below_bound(
            largest_entry_difference(
                &rate,
                &derivative_at_zero(|t| *attitude_at_time(t).to_rotation_matrix().matrix()),
            ),
            2e-12,
            omega,
        );
        assert_error_below_bound(
            largest_entry_difference(&rate, &rotation_rate_from_space(&rotation, &space)),
            1e-15,
            omega,
        );
        assert_error_below_bound(
            largest_entry_difference(&rotation_omega_body(&rotation, &rate), &omega),
            1e-15,
            omega,
        );
        assert_error_below_bound(
            largest_entry_difference(&rotation_omega_space(&rotation, &rate), &space),
            2e-15,
            omega,
        );
    }
}

/// Returns the angular velocity, in body axes, of the motion with the quaternion `f(t)` at `t = 0`, by finite
/// differences.
fn angular_velocity_of_motion(f: impl Fn(f64) -> UnitQuaternion<f64>) -> Vector3<f64> {
    quaternion_omega_body(&f(0.0), &Quaternion::from(derivative_at_zero(|t| f(t).coords)))
}

#[test]
fn rotation_vector_rates_match_motion() {
    let mut random = RandomNumbers(14);
    for length in LENGTHS {
        for _ in 0..20 {
            let vector = RotationVector(random.random_axis() * length);
            let (rate, rotation) = (random.random_vector(), vector.rotation());
            let body = vector.omega_body(&rate);
            assert_error_below_bound(
                largest_entry_difference(
                    &body,
                    &angular_velocity_of_motion(|t| RotationVector(vector.0 + rate * t).quaternion()),
                ),
                2e-12,
                length,
            );
            assert_error_below_bound(
                largest_entry_difference(&(rotation * body), &vector.omega_space(&rate)),
                2e-15,
                length,
            );
            // The inverse grows towards 2π.
            let bound = 2e-15 * (1.0 + length) / if length > 1.0 { (length / 2.0).sin().abs() } else { 1.0 };
            assert_error_below_bound(
                largest_entry_difference(&vector.rate_from_body(&body).unwrap(), &rate),
                bound,
                length,
            );
            assert_error_below_bound(
                largest_entry_difference(&vector.rate_from_space(&vector.omega_space(&rate)).unwrap(), &rate),
                bound,
                length,
            );
        }
    }
    for turns in [1.0, 2.0, 7.0] {
        let vector = RotationVector(random.random_axis() * (turns * TAU));
        assert_eq!(vector.rate_from_body(&Vector3::x()), Err(Singular::FullTurn));
        assert_eq!(vector.rate_from_space(&Vector3::x()), Err(Singular::FullTurn));
        assert!(vector.omega_body(&Vector3::x()).iter().all(|x| x.is_finite()));
    }
}

#[test]
fn gibbs_vector_rates_match_motion() {
    let mut random = RandomNumbers(15);
    for size in [0.0, 1e-200, 1e-9, 0.1, 1.0, 3.0, 1e3, 1e8] {
        for _ in 0..20 {
            let g = Gibbs(random.random_axis() * size);
            let (omega, rotation) = (random.random_vector(), g.rotation());
            let rate = g.rate_from_body(&omega);
            let relative = 1.0 + size * size;
            assert_error_below_bound(
                largest_entry_difference(&rate, &g.rate_from_space(&(rotation * omega))) / relative,
                2e-15,
                size,
            );
            assert_error_below_bound(
                largest_entry_difference(&g.omega_space(&rate), &(rotation * omega)),
                2e-15 * (1.0 + size),
                size,
            );
            assert_error_below_bound(
                largest_entry_difference(&g.omega_body(&rate), &omega),
                2e-15 * (1.0 + size),
                size,
            );
            // Differences are accurate only where the vector is of order one.
            if size <= 1.0 {
                let rate = random.random_vector();
                let found = angular_velocity_of_motion(|t| Gibbs(g.0 + rate * t).quaternion());
                assert_error_below_bound(largest_entry_difference(&g.omega_body(&rate), &found), 1e-11, size);
            }
        }
    }
}

#[test]
fn modified_rodrigues_rates_match_motion() {
    let mut random = RandomNumbers(16);
    for size in [0.0, 1e-200, 1e-9, 0.1, 0.9, 1.0, 1.1, 3.0, 1e3, 1e6] {
        for _ in 0..20 {
            let sigma = Mrp(random.random_axis() * size);
            let (omega, rotation) = (random.random_vector(), sigma.rotation());
            let rate = sigma.rate_from_body(&omega);
            let relative = 1.0 + size * size;
            assert_error_below_bound(
                largest_entry_difference(&rate, &sigma.rate_from_space(&(rotation * omega))) / relative,
                2e-15,
                size,
            );
            assert_error_below_bound(largest_entry_difference(&sigma.omega_body(&rate), &omega), 2e-15, size);
            assert_error_below_bound(
                largest_entry_difference(&sigma.omega_space(&rate), &(rotation * omega)),
                2e-15,
                size,
            );
            if size <= 3.0 {
                let rate = random.random_vector();
                let found = angular_velocity_of_motion(|t| Mrp(sigma.0 + rate * t).quaternion());
                assert_error_below_bound(
                    largest_entry_difference(&sigma.omega_body(&rate), &found),
                    1e-9,
                    size,
                );
            }
            // The shadow has the same angular velocity as the vector itself.
            if let (Ok(shadow), Ok(shadow_rate)) = (sigma.shadow(), sigma.shadow_rate(&rate)) {
                let relative = 1.0 + shadow.0.norm_squared();
                assert_error_below_bound(
                    largest_entry_difference(&shadow_rate, &shadow.rate_from_body(&omega)) / relative,
                    2e-15,
                    size,
                );
            }
        }
    }
}

#[test]
fn switched_mrp_stays_in_unit_ball() {
    // Steady rotation about a body axis, classical Runge–Kutta: many revolutions.
    let omega = Vector3::new(1.0, -2.0, 0.5);
    let (h, steps) = (0.002, 10_000);
    let mut sigma = Mrp(Vector3::zeros());
    for _ in 0..steps {
        let mrp_rate = |s: Vector3<f64>| Mrp(s).rate_from_body(&omega);
        let a = mrp_rate(sigma.0);
        let b = mrp_rate(sigma.0 + a * (h / 2.0));
        let c = mrp_rate(sigma.0 + b * (h / 2.0));
        let d = mrp_rate(sigma.0 + c * h);
        sigma = Mrp(sigma.0 + (a + (b + c) * 2.0 + d) * (h / 6.0)).switched();
        assert!(sigma.0.norm() <= 1.0);
    }
    let exact = RotationVector(omega * (h * f64::from(steps))).rotation();
    assert_error_below_bound(
        largest_entry_difference(sigma.rotation().matrix(), exact.matrix()),
        1e-10,
        sigma,
    );
}
