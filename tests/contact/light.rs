//! Light feet against closed-form solutions, for feet of any mass.

use super::laws::Random;
use linkwork::contact::{self, Touch};
use linkwork::prelude::*;

/// Hip of 1 kg on a massless leg of 1 m with a foot: the simplest walker in stance (Garcia, Chatterjee, Ruina
/// and Coleman, 1998).
#[mechanism(gravity = -9.81 * y)]
struct Walker {
    foot: f64,
    #[particle(mass = 1)]
    hip: Particle,
    #[joint(ground -> hip, along = (x, y))]
    air: Stage,
    #[body(mass = foot, com = -y)]
    leg: Body,
    #[joint(hip -> leg, about = z)]
    joint: Pin,
    #[contact(leg.at(-y), ground.plane(y), friction = 10)]
    toe: Contact,
}

/// The leg is an inverted pendulum, whose foot also supports its own weight. A touchdown preserves the
/// velocity of the hip normal to the leg.
#[test]
fn light_feet_lose_no_accuracy_in_touchdown() {
    let mut random = Random(8);
    for k in 0..1000 {
        let m = Walker { foot: 10.0_f64.powi(-(k % 15)) };
        let (angle, rate) = (0.5 * random.next(), 2.0 * random.next());
        let (sine, cosine) = angle.sin_cos();
        let q = [0.3 - sine, cosine, angle].into();
        let v = [-rate * cosine, -rate * sine, rate].into();
        let along = 9.81 * cosine - rate * rate;
        let expected = [-9.81 * sine * cosine + rate * rate * sine, 0.0, 9.81 * sine];
        let press = along * cosine + m.foot * 9.81;
        let held = contact::forward_dynamics(&m, 0.0, &q, &v, &SVector::zeros(), &[Touch::Sticks]).unwrap();
        assert!((held.a[2] - expected[2]).abs() < 1e-9, "{}: {}", m.foot, held.a[2] - expected[2]);
        assert!((held.a[0] - expected[0]).abs() < 1e-9, "{}: {}", m.foot, held.a[0] - expected[0]);
        assert!((held.forces[0] - press).abs() < 1e-9, "{}: {}", m.foot, held.forces[0] - press);
        assert!((held.forces[1].abs() - (along * sine).abs()).abs() < 1e-9);
        if along > 0.1 {
            let forces = contact::acting(&m, 0.0, &q, &v, &SVector::zeros()).unwrap();
            assert!((forces[0] - press).abs() < 1e-6, "{}: {}", m.foot, forces[0] - press);
        }
        let v: SVector<f64, 3> = random.random_vector(3.0);
        let found = contact::land(&m, 0.0, &q, &v, &[Touch::Sticks]).unwrap();
        let spin = -(v[0] * cosine + v[1] * sine);
        assert!((found.v[2] - spin).abs() < 1e-9, "{}: {}", m.foot, found.v[2] - spin);
        let sinks = v[1] + v[2] * sine;
        let impulse = -spin * sine - v[1] - m.foot * sinks;
        assert!((found.impulses[0] - impulse).abs() < 1e-9, "{}", found.impulses[0] - impulse);
    }
}
