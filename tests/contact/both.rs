//! Time stepping and event location, the two methods of simulating contacts, satisfy the contact conditions
//! and converge to the same motion.

use linkwork::contact::Contacts;
use linkwork::integrate::EventDriven;
use linkwork::prelude::*;

use crate::laws::{DoublePendulumAboveFloor, Pile, Random};

/// Follows a motion and checks that its energy does not grow and that surfaces do not penetrate. Returns the
/// number of samples and the last configuration.
fn check_energy_and_gaps_of_motion<
    M,
    const NQ: usize,
    const NV: usize,
    const NU: usize,
    const NK: usize,
    const NR: usize,
>(
    m: &M,
    q: &SVector<f64, NQ>,
    v: &SVector<f64, NV>,
    duration: f64,
) -> (usize, SVector<f64, NQ>)
where
    M: Contacts<NQ, NV, NU, NK, NR, Scalar = f64>,
{
    let total_energy = |q: &_, v: &_| m.kinetic_energy(0.0, q, v) + m.potential_energy(0.0, q);
    let mut last = total_energy(q, v);
    let lowest = m.contact_gaps(0.0, q).min().min(0.0);
    let method = EventDriven::new().tolerance(1e-10, 1e-10).max_steps(20_000);
    let (mut count, mut end) = (0, *q);
    for sample in simulate(m).from(*q, *v).method(method).duration(duration) {
        let sample = sample.unwrap_or_else(|error| panic!("{error} from {q} {v}"));
        let now = total_energy(&sample.q, &sample.v);
        assert!(now <= last + 1e-6 * (1.0 + last.abs()), "{now} after {last} at {} from {q} {v}", sample.t);
        let gaps = m.contact_gaps(0.0, &sample.q);
        assert!(gaps.min() > lowest - 1e-9, "{gaps} at {} from {q} {v}", sample.t);
        (last, end, count) = (now, sample.q, count + 1);
    }
    (count, end)
}

#[mechanism(gravity = -9.81 * y)]
struct Tile {
    friction: f64,
    restitution: f64,
    #[body(mass = 2, com = 0.02 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    tile: Body,
    #[joint(ground -> tile, about = z)]
    pose: Planar,
    #[contact(tile.at(-0.15 * x - 0.1 * y), ground.plane(y), friction = friction, restitution = restitution)]
    a: Contact,
    #[contact(tile.at(0.15 * x - 0.1 * y), ground.plane(y), friction = friction, restitution = restitution)]
    b: Contact,
    #[contact(tile.at(0.15 * x + 0.1 * y), ground.plane(y), friction = friction, restitution = restitution)]
    c: Contact,
    #[contact(tile.at(-0.15 * x + 0.1 * y), ground.plane(y), friction = friction, restitution = restitution)]
    d: Contact,
    #[contact(tile.at(-0.15 * x - 0.1 * y), ground.plane(x), friction = friction, restitution = restitution)]
    e: Contact,
    #[contact(tile.at(-0.15 * x + 0.1 * y), ground.plane(x), friction = friction, restitution = restitution)]
    f: Contact,
}

/// Rotating tiles fall into a corner: their corners collide, tip, slide and come to rest.
#[test]
fn tiles_falling_into_a_corner_agree_with_located_events() {
    let mut random = Random(7);
    for _ in 0..10 {
        let m = Tile {
            friction: random.random_choice([0.0, 0.3, 0.8]),
            restitution: random.random_choice([0.0, 0.3]),
        };
        let q = SVector::from([0.3, 0.3, random.next() * 3.0]);
        let (_, end) = check_energy_and_gaps_of_motion(&m, &q, &random.random_vector(1.0), 2.0);
        assert!(end.iter().all(|x| x.is_finite()));
    }
}

/// Balls of very different masses that fall on each other move as with located events.
#[test]
fn colliding_balls_agree_with_located_events() {
    let mut random = Random(8);
    for _ in 0..3 {
        let m = Pile {
            friction: random.random_choice([0.0, 0.3, 0.8]),
            restitution: random.random_choice([0.0, 0.4]),
        };
        let mut q = m.neutral();
        (q[0], q[2], q[7], q[9], q[16]) = (-0.11, 0.12, 0.11, 0.15, 0.4);
        check_energy_and_gaps_of_motion(&m, &q, &random.random_vector(0.3), 0.4);
    }
}

/// The tip of a double pendulum collides with the floor, slides and sticks.
#[test]
fn double_pendulum_on_the_floor_agrees_with_located_events() {
    let mut random = Random(9);
    for _ in 0..30 {
        let q = SVector::from([random.next() * 1.5, random.next() * 1.5]);
        let m = DoublePendulumAboveFloor {
            friction: random.random_choice([0.0, 0.3, 0.7]),
            restitution: random.random_choice([0.0, 0.5]),
            height: 0.1 - (0.5 * q[0].sin() + 0.5 * (q[0] + q[1]).sin()).min(0.0),
        };
        check_energy_and_gaps_of_motion(&m, &q, &random.random_vector(2.0), 2.0);
    }
}

/// Time stepping converges to the motion with located events, to first order in the step for motions with
/// impacts.
#[test]
fn time_stepping_converges_to_located_events() {
    let m = Tile { friction: 0.4, restitution: 0.0 };
    let (q, v) = ([0.5, 0.15, 0.1].into(), [0.5, 0.0, 0.0].into());
    let (_, end) = check_energy_and_gaps_of_motion(&m, &q, &v, 0.3);
    let distance_from_exact_end = |h: f64| {
        let run = simulate(&m).from(q, v).method(TimeStepping::step(h)).duration(0.3);
        (run.finish().unwrap().q - end).norm()
    };
    let [coarse, fine, finest] = [1e-3, 1e-4, 1e-5].map(distance_from_exact_end);
    assert!(coarse < 1e-2 && fine < 1e-3 && finest < 1e-4, "{coarse} {fine} {finest}");
}
