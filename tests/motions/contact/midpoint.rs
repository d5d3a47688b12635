//! Time stepping with the midpoint rule: order, energy, and the contact conditions.

use super::laws::DoublePendulumAboveFloor;
use linkwork::contact;
use linkwork::prelude::*;

/// Tumbling block with unequal moments of inertia, and a floor.
#[mechanism(gravity = -9.81 * z)]
struct Block {
    #[body(mass = 2, com = 0.02 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = 0.4)]
    floor: Contact,
}

/// Cart on a spring, with a stop that it does not reach.
#[mechanism]
struct CartWithUnreachedStop {
    #[body(mass = 2)]
    cart: Body,
    #[joint(ground -> cart, along = x)]
    rail: Sleeve,
    #[acts(on = rail, stiffness = 32)]
    spring: Spring,
    #[limit(on = rail, from = -2, to = 2)]
    stops: Limit,
}

/// Evaluates the error of `duration` seconds in steps of `h` against a motion without contacts with tight
/// tolerances.
macro_rules! error {
    ($m:expr, $start:expr, $duration:expr, $h:expr) => {{
        let (m, (q, v)) = (&$m, $start);
        let free = contact::apart(m);
        let exact = simulate(&free).from(q, v).method(DormandPrince8::new().tolerance(1e-13, 1e-13));
        let exact = exact.duration($duration).finish().unwrap();
        let run = simulate(m).from(q, v).method(TimeStepping::step($h).midpoint());
        let end = run.duration($duration).finish().unwrap();
        m.difference(&exact.q, &end.q).norm() + (exact.v - end.v).norm()
    }};
}

#[test]
fn midpoint_steps_between_impacts_have_order_two() {
    let chain = DoublePendulumAboveFloor { friction: 0.5, restitution: 0.5, height: 5.0 };
    let swing = (SVector::from([0.3, -0.8]), SVector::from([1.0, 2.0]));
    let block = Block {};
    let mut q = block.neutral();
    q[2] = 10.0;
    let throw = (q, SVector::from([1.0, -0.5, 2.0, 5.0, -3.0, 8.0]));
    let errors = [1e-2, 5e-3, 2.5e-3].map(|h| [error!(chain, swing, 0.5, h), error!(block, throw, 0.5, h)]);
    for k in 0..2 {
        for (coarse, fine) in [(errors[0][k], errors[1][k]), (errors[1][k], errors[2][k])] {
            assert!((3.6..4.4).contains(&(coarse / fine)), "{k}: {errors:?}");
        }
    }
    assert!(errors[2][0].max(errors[2][1]) < 1e-3, "{errors:?}");
}

/// Checks that energy does not drift. For a cart on a spring with `ω = 4 rad/s`, the leapfrog method
/// conserves `(1 − ω² h²/4) v² + ω² x²`, so that the relative energy error is at most `ω² h²/4` for any
/// number of oscillations.
#[test]
fn midpoint_energy_of_oscillations_does_not_drift() {
    let (m, h) = (CartWithUnreachedStop {}, 0.01);
    let run = simulate(&m).from([1.0], [0.0]).method(TimeStepping::step(h).midpoint());
    let part = 4.0 * h * h;
    let samples: Vec<_> = run.sample_every(50.0).duration(2000.0).map(|sample| sample.unwrap()).collect();
    for Sample { q, v, .. } in &samples {
        let kept = (1.0 - part) * v[0] * v[0] + 16.0 * q[0] * q[0];
        assert!((kept / 16.0 - 1.0).abs() < 1e-9, "{kept}");
        let energy = (v[0] * v[0] + 16.0 * q[0] * q[0]) / 16.0;
        assert!((1.0 - 1e-9..1.0 + 1.01 * part).contains(&energy), "{energy}");
    }
    assert_eq!(samples.len(), 41);
}

/// A block that falls on its face slides, comes to rest at the distance of Coulomb's law, and stays at rest
/// to rounding.
#[test]
fn fallen_block_slides_and_rests() {
    let m = Block {};
    let mut q = m.neutral();
    q[2] = 0.05;
    let start = simulate(&m).from(q, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let method = TimeStepping::step(1e-3).midpoint();
    let rests = start.method(method).duration(1.0).finish().unwrap();
    let far = 1.0 / (2.0 * 0.4 * 9.81);
    assert!((rests.q[0] - far).abs() < 1e-5, "{} {far}", rests.q[0]);
    assert!(rests.v.amax() < 1e-12);
    let later = simulate(&m).from(rests.q, rests.v).overlaps(linkwork::simulate::Overlaps::Keep);
    let later = later.method(method).duration(60.0).finish().unwrap();
    assert!((later.q - rests.q).amax() < 1e-10, "{}", (later.q - rests.q).amax());
}

/// Ball above a floor that it does not reach.
#[mechanism(gravity = -9.81 * z)]
struct ThrownBall {
    #[body(mass = 0.1, inertia = sphere(0.1, 0.03))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.03), ground.plane(z), friction = 0.4)]
    floor: Contact,
}

/// A ball that spins by almost a radian in each step flies along the parabola of a point, keeps its spin, and
/// rotates at the rate of the spin: midpoint and leapfrog steps are exact for it.
#[test]
fn a_ball_that_spins_fast_flies_along_a_parabola() {
    let (h, duration) = (4.6e-3, 0.46);
    let (velocity, spin) = ([1.0, -2.0, 3.0], [120.0, -90.0, 130.0]);
    let mut q = ThrownBall {}.neutral();
    q[2] = 5.0;
    let v = SVector::from([velocity[0], velocity[1], velocity[2], spin[0], spin[1], spin[2]]);
    for method in [TimeStepping::step(h).midpoint(), TimeStepping::step(h).leapfrog()] {
        let end = simulate(&ThrownBall {}).from(q, v).method(method).duration(duration).finish().unwrap();
        let fall = 0.5 * 9.81 * duration * duration;
        let place = [velocity[0] * duration, velocity[1] * duration, 5.0 + velocity[2] * duration - fall];
        for k in 0..3 {
            assert!((end.q[k] - place[k]).abs() < 1e-12, "{k}: {} {}", end.q[k], place[k]);
            assert!((end.v[3 + k] - spin[k]).abs() < 1e-11);
        }
        let energy = |q: &SVector<f64, 7>, v: &SVector<f64, 6>| {
            ThrownBall {}.kinetic_energy(q, v) + ThrownBall {}.potential_energy(q)
        };
        assert!((energy(&end.q, &end.v) / energy(&q, &v) - 1.0).abs() < 1e-12);
        let speed = spin.iter().map(|x| x * x).sum::<f64>().sqrt();
        let half = 0.5 * speed * duration;
        assert!((end.q[6].abs() - half.cos().abs()).abs() < 1e-11);
    }
}
