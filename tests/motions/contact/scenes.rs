//! Bodies that fall on each other: each step exists, and adds no energy.

use linkwork::contact::Contacts;
use linkwork::prelude::*;
use std::thread;

/// Five dominoes that stand in a row on the ground.
#[mechanism(gravity = -9.81 * z)]
struct Dominoes {
    friction: f64,
    #[body(mass = 0.02, inertia = cuboid(0.02, 0.008, 0.025, 0.05))]
    piece: [Body; 5],
    #[joint(ground -> piece[i])]
    pose: [Free; 5],
    #[contact(piece[i].cuboid(0.008, 0.025, 0.05), ground.plane(z), friction = friction)]
    floor: [Contact; 5],
    #[contact(
        piece[i].cuboid(0.008, 0.025, 0.05),
        piece[i + 1].cuboid(0.008, 0.025, 0.05),
        friction = friction
    )]
    next: [Contact; 4],
}

/// Two bricks on the ground with a third one on top of both, and a ball that hits this wall.
#[mechanism(gravity = -9.81 * z)]
struct Wall {
    #[body(mass = 0.5, inertia = cuboid(0.5, 0.1, 0.2, 0.08))]
    brick: [Body; 3],
    #[joint(ground -> brick[i])]
    pose: [Free; 3],
    #[body(mass = 0.3, inertia = sphere(0.3, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    place: Free,
    #[contact(brick[i].cuboid(0.1, 0.2, 0.08), ground.plane(z), friction = 0.5)]
    floor: [Contact; 3],
    #[contact(brick[i].cuboid(0.1, 0.2, 0.08), brick[i + 1].cuboid(0.1, 0.2, 0.08), friction = 0.5)]
    next: [Contact; 2],
    #[contact(brick[0].cuboid(0.1, 0.2, 0.08), brick[2].cuboid(0.1, 0.2, 0.08), friction = 0.5)]
    ends: Contact,
    #[contact(ball.sphere(0.05), ground.plane(z), friction = 0.5, restitution = 0.3)]
    bounce: Contact,
    #[contact(ball.sphere(0.05), brick[i].cuboid(0.1, 0.2, 0.08), friction = 0.5, restitution = 0.3)]
    hit: [Contact; 3],
}

/// Simulates a scene for `duration` seconds in steps of 2 ms. Checks that each step exists, that no step adds
/// energy beyond `gain`, J, and that penetration remains below `depth`, m. Returns the end and the largest
/// violation of the contact conditions.
fn check_scene_energy_and_penetration<M, const NQ: usize, const NV: usize, const NK: usize, const NR: usize>(
    m: &M,
    (q, v): (SVector<f64, NQ>, SVector<f64, NV>),
    method: TimeStepping<f64>,
    (duration, gain, depth): (f64, f64, f64),
) -> (SVector<f64, NQ>, f64)
where
    M: Contacts<NQ, NV, 0, NK, NR, Scalar = f64>,
{
    let (mut before, mut end, mut violation) = (f64::INFINITY, q, 0.0_f64);
    for sample in simulate(m).from(q, v).method(method).sample_every(2e-3).duration(duration) {
        let sample = sample.expect("each step exists");
        let energy = m.kinetic_energy(0.0, &sample.q, &sample.v) + m.potential_energy(0.0, &sample.q);
        assert!(energy <= before + gain, "{} J at {} s", energy - before, sample.t);
        let least = m.contact_gaps(0.0, &sample.q).min();
        assert!(least > -depth, "{least} m at {} s", sample.t);
        (before, end, violation) = (energy, sample.q, violation.max(sample.violation));
    }
    (end, violation)
}

/// Checks a row of dominoes: the first one knocks over the others. The last one lies on the ground, and the
/// others lean on it.
fn check_falling_dominoes() {
    let m = Dominoes { friction: 0.3 };
    let (mut q, mut v) = (m.neutral(), SVector::zeros());
    (0..5).for_each(|k| (q[7 * k], q[7 * k + 2]) = (0.025 * k as f64, 0.025));
    (v[0], v[4]) = (0.075, 3.0);
    for method in [TimeStepping::step(2e-3), TimeStepping::step(2e-3).leapfrog()] {
        let (end, violation) = check_scene_energy_and_penetration(&m, (q, v), method, (0.7, 1e-5, 1e-3));
        assert!((0..4).all(|k| end[7 * k + 2] < 0.022) && end[30] < 0.0041, "{end}");
        assert!(violation < 0.2, "{violation}");
    }
}

/// Bricks rest on each other until a ball hits them.
fn check_brick_wall() {
    let m = Wall {};
    let (mut q, mut v) = (m.neutral(), SVector::<f64, 24>::zeros());
    (q[2], q[7], q[9], q[14], q[16]) = (0.04, 0.101, 0.04, 0.0505, 0.12);
    (q[21], q[23]) = (-0.3, 0.15);
    v[18] = 4.0;
    let method = TimeStepping::step(2e-3).midpoint();
    let (before, _) = check_scene_energy_and_penetration(&m, (q, v), method, (0.04, 1e-9, 1e-9));
    assert!((before - q).rows(0, 21).amax() < 1e-12, "bricks rest before the ball arrives");
    let (end, violation) = check_scene_energy_and_penetration(&m, (q, v), method, (0.6, 1e-4, 1e-2));
    assert!(end[14] > q[14] + 0.01 && end[16] < 0.121, "the upper brick is pushed: {end}");
    assert!(violation < 1e-3, "{violation}");
}

/// The matrices of a step with many contacts need more stack than a test's thread has in unoptimised builds.
#[test]
fn falling_dominoes_and_wall_fit_the_stack() {
    for scene in [check_falling_dominoes, check_brick_wall] {
        thread::Builder::new().stack_size(128 << 20).spawn(scene).unwrap().join().unwrap();
    }
}
