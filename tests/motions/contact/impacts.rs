//! Random impacts satisfy complementarity, friction cones, energy and momentum conditions.

use super::laws::{DoublePendulumAboveFloor, Pile, Random, check_impact_conditions};
use linkwork::prelude::*;

#[mechanism(gravity = -9.81 * z)]
struct BlockAtFloorAndWall {
    friction: f64,
    restitution: f64,
    #[body(mass = 2, com = 0.02 * x, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(z), friction = friction, restitution = restitution)]
    floor: Contact,
    #[contact(
        block.cuboid(0.3, 0.2, 0.1), ground.at(-0.15 * x).plane(x), friction = friction,
        restitution = restitution
    )]
    wall: Contact,
}

/// Checks impacts of a block on its face and against a wall, with up to eight corners in contact, some in two
/// contacts. Impulses are not unique; friction ranges from zero to unphysically large values.
#[test]
fn corner_impacts_of_a_block_satisfy_contact_conditions() {
    let mut random = Random(1);
    for _ in 0..400 {
        let friction = random.random_choice([0.0, 0.05, 0.3, 0.8, 2.0]);
        let m = BlockAtFloorAndWall { friction, restitution: random.random_choice([0.0, 0.0, 0.4, 1.0]) };
        let mut q = m.neutral();
        q[2] = 0.05;
        if random.next() > 0.3 {
            q[0] = 1.0;
        }
        let v = random.random_vector(3.0);
        check_impact_conditions(&m, &q, &v);
    }
}

/// Checks impacts of a heavy ball on a light one and another: all pairs, and two of the contacts with the
/// floor, are closed.
#[test]
fn pile_impacts_of_balls_satisfy_contact_conditions() {
    let mut random = Random(2);
    for _ in 0..400 {
        let friction = random.random_choice([0.0, 0.05, 0.3, 0.8, 2.0]);
        let m = Pile { friction, restitution: random.random_choice([0.0, 0.0, 0.4, 1.0]) };
        let mut q = m.neutral();
        (q[0], q[2], q[7], q[9], q[16]) = (-0.1, 0.1, 0.1, 0.1, 0.1 + 0.03_f64.sqrt());
        let v = random.random_vector(2.0);
        check_impact_conditions(&m, &q, &v);
    }
}

/// Checks that an impact of a double pendulum's tip on the floor adds no energy. Newton's restitution with
/// friction alone could (Kane and Levinson, *Dynamics: Theory and Applications*, 1985, § 5.8).
#[test]
fn double_pendulum_impact_gains_no_energy() {
    let mut random = Random(3);
    let mut tempered = 0;
    for _ in 0..4000 {
        let (a, b) = (random.next() * 3.0, random.next() * 3.0);
        let q = SVector::from([a, b]);
        let height = -(0.5 * a.sin() + 0.5 * (a + b).sin());
        let m = DoublePendulumAboveFloor {
            friction: random.random_choice([0.0, 0.3, 0.7]),
            restitution: random.random_choice([0.5, 0.9, 1.0]),
            height,
        };
        let v = random.random_vector(3.0);
        tempered += usize::from(check_impact_conditions(&m, &q, &v));
    }
    // The paradox occurs in some of the cases.
    assert!(tempered > 5, "{tempered}");
}
