//! Random four-bar linkages with random velocities and accelerations of the crank, against d'Alembert's
//! principle with corners from intersections of circles.

use super::assembly::{FourBar, four_bar, linkage_corners, random_linkage};
use super::time_derivative;
use linkwork::prelude::*;
use support::compare::assert_close;
use support::random::Random;

four_bar!(
    /// Four-bar linkage whose crank is driven as a function of time.
    Driven,
    {
        start: f64,
        speed: f64,
        growth: f64,
        #[constraint(shaft = start + speed * t + growth * t * t / 2)]
        motor: Holonomic,
    }
);

/// Returns the first and second derivatives at zero, by central differences of order six.
fn first_and_second_derivatives(f: impl Fn(f64) -> f64) -> [f64; 2] {
    let h = 2e-3;
    let symmetric_sum = |k: f64| f(k * h) + f(-k * h);
    let second = (2.0 * symmetric_sum(3.0) - 27.0 * symmetric_sum(2.0) + 270.0 * symmetric_sum(1.0)
        - 490.0 * f(0.0))
        / (180.0 * h * h);
    [time_derivative(f, 0.0), second]
}

/// Returns the reference torque on the crank of a four-bar linkage, from formulas independent of the library.
fn reference_crank_torque(bars: [f64; 4], side: f64, angle: f64, speed: f64, growth: f64) -> f64 {
    let [base, first, second, third] = bars;
    let pose_of_bar = |k: usize, angle: f64| -> [f64; 3] {
        let [pin, end] = linkage_corners(bars, side, angle);
        let (a, b, com) = match k {
            0 => ([0.0, 0.0], pin, [first / 3.0, 0.0]),
            1 => (pin, end, [second / 2.0, 0.1]),
            _ => ([base, 0.0], end, [third / 2.0, 0.0]),
        };
        let (s, c) = (b[1] - a[1]).atan2(b[0] - a[0]).sin_cos();
        [a[0] + c * com[0] - s * com[1], a[1] + s * com[0] + c * com[1], s.atan2(c)]
    };
    let inertias = [first * first / 12.0, 1.5 * second * second / 12.0, 0.8 * third * third / 12.0];
    let mut sum = 0.0;
    for (k, (mass, inertia)) in [1.0, 1.5, 0.8].into_iter().zip(inertias).enumerate() {
        let here = pose_of_bar(k, angle)[2];
        for i in 0..3 {
            let [by, bend] = first_and_second_derivatives(|more| match i {
                2 => {
                    let turned = pose_of_bar(k, angle + more)[2] - here;
                    turned.sin().atan2(turned.cos())
                }
                _ => pose_of_bar(k, angle + more)[i],
            });
            let acceleration = by * growth + bend * speed * speed;
            sum += by
                * match i {
                    0 => mass * acceleration,
                    1 => mass * (acceleration + 9.81),
                    _ => inertia * acceleration,
                };
        }
    }
    sum
}

#[test]
fn random_four_bar_drives_obey_dalemberts_principle() {
    let (mut source, mut checked) = (Random::new(31), 0);
    for _ in 0..300 {
        let (bars, side, angle) = random_linkage(&mut source, 0.4);
        let [base, first, second, third] = bars;
        let (speed, growth) = (source.uniform_number(5.0), source.uniform_number(20.0));
        let expected = reference_crank_torque(bars, side, angle, speed, growth);
        // The differences may use angles beyond the position with coupler and rocker in line.
        if !expected.is_finite() {
            continue;
        }
        checked += 1;
        let m = FourBar { base, first, second, third };
        let at = m.joint_angles(side, angle);
        let q = m.assemble(&at, &[0]).unwrap();
        let v = m.complete_velocity(&q, &[speed, 0.0, 0.0].into(), &[0]).unwrap();
        let a = m.complete_acceleration(&q, &v, &[growth, 0.0, 0.0].into(), &[0]).unwrap();
        let (tau, lambda) = m.constrained_inverse_dynamics(&q, &v, &a, &[0]).unwrap();
        assert_close(format!("{bars:?}"), &tau.data.0[0], &[expected, 0.0, 0.0], 1e-5);
        let driven = Driven { base, first, second, third, start: angle, speed, growth };
        let now = driven.complete_velocity(0.0, &q, &SVector::zeros(), &[]).unwrap();
        assert_close("v", &now.data.0[0], &v.data.0[0], 1e-9);
        let (again, multipliers) = driven.constrained_dynamics(0.0, &q, &v, &SVector::zeros());
        assert_close("a", &again.data.0[0], &a.data.0[0], 1e-8);
        assert_close("λ", &multipliers.data.0[0], &[lambda[0], lambda[1], tau[0]], 1e-7);
    }
    assert!(checked > 250, "{checked}");
}
