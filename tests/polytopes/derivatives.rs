//! Derivatives of contacts of hulls, and of steps with them.

use crate::distances::{Stone, configuration, contact_with_least_gap};
use crate::shapes::Random;
use linkwork::discrete;
use linkwork::nalgebra::UnitQuaternion;
use linkwork::prelude::*;

/// The bias is the time derivative of the contact velocities at zero acceleration, unless features change.
#[test]
fn contact_bias_is_the_rate_of_contact_velocities() {
    let (m, mut random) = (Stone {}, Random(17));
    let (h, mut compared) = (1e-5, 0);
    for k in 0..100 {
        let body = k % 5;
        let q = configuration(body, random.random_point() * 0.2, &random.random_rotation());
        let mut v = SVector::<f64, 6>::zeros();
        v.iter_mut().for_each(|v| *v = random.next_random_number());
        let (contact, _) = contact_with_least_gap(&m, body, &q);
        let [low, high] = [-h, h].map(|h| m.integrate(&q, &(v * h)));
        if [&low, &high].iter().any(|q| contact_with_least_gap(&m, body, q).0 != contact) {
            continue;
        }
        let rows = Stone::CONTACT_ROWS[contact];
        let (before, after, bias) =
            (m.contact_rates(&low, &v), m.contact_rates(&high, &v), m.contact_bias(&q, &v));
        let (slow, fast) = (m.contact_rates(&q, &v), rows.first..rows.first + rows.count);
        for i in fast {
            let is_smooth = (after[i] + before[i] - 2.0 * slow[i]).abs() < 1e-7;
            let difference = (after[i] - before[i]) / (2.0 * h);
            if is_smooth {
                assert!(
                    (bias[i] - difference).abs() < 1e-4 * (1.0 + difference.abs()),
                    "{body} {i}: {} {difference}",
                    bias[i]
                );
                compared += 1;
            }
        }
    }
    assert!(compared > 150, "{compared}");
}

/// Two wedges, one on the other on the floor.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct Pile {
    #[body(mass = 1, inertia = cuboid(1, 0.2, 0.16, 0.08))]
    low: Body,
    #[joint(ground -> low)]
    below: Free,
    #[body(mass = 0.5, inertia = cuboid(0.5, 0.2, 0.16, 0.08))]
    high: Body,
    #[joint(ground -> high)]
    above: Free,
    #[acts(on = high, along = x)]
    push: Force,
    #[contact(
        high.hull([
            [0.05, 0.04, -0.03], [0.05, -0.04, -0.03], [-0.05, 0.04, -0.03], [-0.05, -0.04, -0.03],
            [0, 0.04, 0.05], [0, -0.04, 0.05]
        ]),
        low.hull([
            [0.1, 0.08, 0.04], [0.1, -0.08, 0.04], [-0.1, 0.08, 0.04], [-0.1, -0.08, 0.04],
            [0, 0.08, -0.06], [0, -0.08, -0.06]
        ]),
        friction = 0.3
    )]
    seat: Contact,
    #[contact(low.at(-0.06 * z).cuboid(0.1, 0.1, 0.001), ground.plane(z), friction = 1)]
    floor: Contact,
}

/// The Jacobians of a step are central differences, while the upper body sticks and while it slides.
#[test]
fn jacobians_of_steps_are_central_differences() {
    let m = Pile {};
    let mut q = m.neutral();
    q[2] = 0.0605;
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.2).coords;
    q.fixed_rows_mut::<3>(7).copy_from_slice(&[0.01, 0.005, 0.1305]);
    q.fixed_rows_mut::<4>(10).copy_from(&turn);
    let method = TimeStepping::step(1e-3);
    for (push, speed) in [(0.2, 0.0), (4.0, 0.3)] {
        let mut v = SVector::<f64, 12>::zeros();
        v[6] = speed;
        let u = SVector::from([push]);
        let found = discrete::transition(&m, &method, 0.0, &q, &v, &u).unwrap();
        let step_transition = |q: &SVector<f64, 14>, v: &SVector<f64, 12>, u: &SVector<f64, 1>| {
            discrete::transition(&m, &method, 0.0, q, v, u).unwrap()
        };
        let h = 1e-5;
        for k in 6..12 {
            let mut step = SVector::<f64, 12>::zeros();
            step[k] = h;
            let (low, high) = (step_transition(&q, &(v - step), &u), step_transition(&q, &(v + step), &u));
            let difference = (high.v - low.v) / (2.0 * h);
            let column = found.v_by_v.column(k);
            assert!((column - difference).amax() < 1e-4, "{push} {k}: {column} {difference}");
        }
        let step = SVector::from([h]);
        let (low, high) = (step_transition(&q, &v, &(u - step)), step_transition(&q, &v, &(u + step)));
        assert!((found.v_by_u.column(0) - (high.v - low.v) / (2.0 * h)).amax() < 1e-6);
    }
}
