//! A linkage that is mobile in spite of Grübler's count: its constraints are dependent in every
//! configuration.

use linkwork::nalgebra::Vector3;
use linkwork::prelude::*;

/// Bennett's linkage: a ring of four rods with skew pins. Opposite rods are identical, with lengths `a` and
/// `b` and twists `α` and `β` that satisfy `a sin β = b sin α` (Bennett, *A new mechanism*, Engineering 76,
/// 1903).
#[mechanism(gravity = -9.81 * z, batch)]
struct Bennett {
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    one: Body,
    #[body(mass = 0.6, com = 0.35 * x, inertia = rod(0.6, 0.7, x))]
    two: Body,
    #[body(mass = 1, com = 0.5 * x, inertia = rod(1, 1, x))]
    three: Body,
    #[joint(ground -> one, about = z)]
    p1: Pin,
    #[joint(one.at(x).rotated(x(0.8)) -> two, about = z)]
    p2: Pin,
    #[joint(two.at(0.7 * x).rotated(x(asin(0.7 * sin(0.8)))) -> three, about = z)]
    p3: Pin,
    #[joint(three.at(x).rotated(x(0.8)) -> ground.at(-0.7 * x).rotated(x(-asin(0.7 * sin(0.8)))), about = z)]
    p4: Pin,
}

/// Returns a configuration with the given angle of the first pin, and a velocity. A closed form gives the
/// guess for the second pin.
fn state_with_first_pin_angle(angle: f64, rate: f64) -> (SVector<f64, 3>, SVector<f64, 3>) {
    let linkage = Bennett {};
    let guess = 2.0 * (-4.0 / (angle / 2.0).tan()).atan();
    let q = linkage.assemble(&SVector::from([angle, guess, -angle]), &[0]).expect("it closes");
    let v = linkage.project_velocity(&q, &SVector::from([rate, 0.0, 0.0])).expect("it moves");
    (q, v)
}

/// Returns the product of the tangents of the half angles of two neighbouring pins over its constant ratio:
/// −1 on the closed form.
fn normalised_half_angle_tangent_product(q: &SVector<f64, 3>) -> f64 {
    let (alpha, beta) = (0.8_f64, (0.7 * 0.8_f64.sin()).asin());
    let ratio = ((alpha + beta) / 2.0).sin() / ((alpha - beta) / 2.0).sin();
    (q[0] / 2.0).tan() * (q[1] / 2.0).tan() / ratio
}

#[test]
fn bennetts_linkage_follows_its_closed_form() {
    assert_eq!((Bennett::NV, Bennett::NC, Bennett::NP), (3, 3, 1));
    let linkage = Bennett {};
    let (q, v) = state_with_first_pin_angle(0.7, 1.0);
    assert!(
        (normalised_half_angle_tangent_product(&q) + 1.0).abs() < 1e-12,
        "{}",
        normalised_half_angle_tangent_product(&q)
    );
    let total_energy =
        |q: &SVector<f64, 3>, v: &SVector<f64, 3>| linkage.kinetic_energy(q, v) + linkage.potential_energy(q);
    let method = DormandPrince::new().tolerance(1e-11, 1e-11);
    let mut farthest = 0.0_f64;
    for sample in simulate(&linkage).from(q, v).method(method).duration(5.0).sample_every(0.1) {
        let sample = sample.expect("the linkage turns on");
        assert!((normalised_half_angle_tangent_product(&sample.q) + 1.0).abs() < 1e-9, "{}", sample.q);
        assert!((sample.q[2] + sample.q[0]).abs() < 1e-12, "opposite pins turn alike");
        assert!((total_energy(&sample.q, &sample.v) - total_energy(&q, &v)).abs() < 1e-8);
        farthest = farthest.max((sample.q[0] - q[0]).abs());
    }
    assert!(farthest > 1.0, "{farthest}");
}

#[test]
fn redundant_multipliers_have_minimum_norm() {
    let linkage = Bennett {};
    for (angle, rate) in [(0.7, 1.0), (1.9, -2.0), (-1.2, 0.4)] {
        let (q, v) = state_with_first_pin_angle(angle, rate);
        let tau = SVector::from([0.3, -0.2, 0.7]);
        let (a, lambda) = linkage.constrained_dynamics(&q, &v, &tau);
        let jacobian = linkage.constraint_jacobian(&q);
        let held = linkage.inverse_dynamics(&q, &v, &a) - jacobian.transpose() * lambda;
        assert!((held - tau).norm() < 1e-9 * (1.0 + lambda.norm()), "{held}");
        assert!((jacobian * a + linkage.constraint_bias(&q, &v)).norm() < 1e-9 * (1.0 + a.norm()));
        // The multipliers of minimum norm have no component along forces that do no work in any motion of the
        // tree.
        let jacobian_column = |k: usize| Vector3::from(jacobian.column(k));
        let idle = jacobian_column(0).cross(&jacobian_column(1)).normalize();
        assert!((jacobian.transpose() * idle).norm() < 1e-9);
        assert!(lambda.dot(&idle).abs() < 1e-8 * (1.0 + lambda.norm()), "{lambda}");
    }
}

#[test]
fn overconstrained_lanes_equal_single_states() {
    let linkage = Bennett {};
    let each = [(0.7, 1.0), (1.9, -2.0), (-1.2, 0.4), (2.5, 0.0)]
        .map(|(angle, rate)| state_with_first_pin_angle(angle, rate));
    let q: SVector<Lanes<f64, 4>, 3> = SVector::from_fn(|i, _| Lanes(each.map(|(q, _)| q[i])));
    let v: SVector<Lanes<f64, 4>, 3> = SVector::from_fn(|i, _| Lanes(each.map(|(_, v)| v[i])));
    let a = linkage.forward_dynamics_lanes(&q, &v, &SVector::zeros());
    for (k, (q, v)) in each.iter().enumerate() {
        let one = linkage.forward_dynamics(q, v, &SVector::zeros());
        assert!((0..3).all(|i| a[i].0[k] == one[i]), "{one}");
    }
}
