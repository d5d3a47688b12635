//! Cans, a stone and a box that fall on each other and on the ground.

use crate::shapes::Random;
use linkwork::prelude::*;
use linkwork::simulate::Overlaps;

#[mechanism(gravity = -9.81 * z)]
struct Heap {
    friction: f64,
    restitution: f64,
    #[body(mass = 1, inertia = cylinder(1, 0.05, 0.15, z))]
    can: Body,
    #[joint(ground -> can)]
    can_pose: Free,
    #[body(mass = 0.3, inertia = cylinder(0.3, 0.08, 0.03, x))]
    lid: Body,
    #[joint(ground -> lid)]
    lid_pose: Free,
    #[body(mass = 2, inertia = sphere(2, 0.08))]
    stone: Body,
    #[joint(ground -> stone)]
    stone_pose: Free,
    #[contact(
        can.cylinder(0.05, 0.15, z),
        lid.cylinder(0.08, 0.03, x),
        friction = friction,
        restitution = restitution
    )]
    cans: Contact,
    #[contact(
        can.cylinder(0.05, 0.15, z),
        stone.hull([
            [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
            [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
        ]),
        friction = friction,
        restitution = restitution
    )]
    rock: Contact,
    #[contact(
        lid.cylinder(0.08, 0.03, x),
        stone.hull([
            [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
            [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
        ]),
        friction = friction,
        restitution = restitution
    )]
    cap: Contact,
    #[contact(can.cylinder(0.05, 0.15, z), ground.plane(z), friction = friction)]
    can_floor: Contact,
    #[contact(lid.cylinder(0.08, 0.03, x), ground.plane(z), friction = friction)]
    lid_floor: Contact,
    #[contact(
        stone.hull([
            [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
            [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
        ]),
        ground.plane(z),
        friction = friction
    )]
    stone_floor: Contact,
}

/// Checks random scenes: each step exists, the energy does not grow beyond the error of a step, and bodies
/// overlap by at most the path of one step. The environment variable `LINKWORK_SCENES` is the
/// number of scenes.
#[test]
fn random_heaps_gain_no_energy() {
    let count = std::env::var("LINKWORK_SCENES").ok().and_then(|count| count.parse().ok()).unwrap_or(1);
    for seed in 0..count {
        let mut random = Random(seed);
        (0..3).for_each(|_| _ = random.next_random_number());
        let m = Heap {
            friction: [0.0, 0.2, 0.5, 1.0][seed as usize % 4],
            restitution: [0.0, 0.0, 0.4][seed as usize % 3],
        };
        let mut q = m.neutral();
        for k in 0..3 {
            let (place, rotation) = (random.random_point() * 0.04, random.random_rotation().coords);
            q.fixed_rows_mut::<3>(7 * k).copy_from_slice(&[place[0], place[1], 0.2 + 0.25 * k as f64]);
            q.fixed_rows_mut::<4>(7 * k + 3).copy_from(&rotation);
        }
        let mut v = SVector::<f64, 18>::zeros();
        v.iter_mut().for_each(|v| *v = random.next_random_number());
        let h = 1e-3;
        let total_energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
        let (mut before, mut least, mut end) = (f64::INFINITY, 0.0_f64, q);
        let run = simulate(&m).from(q, v).overlaps(Overlaps::Part).method(TimeStepping::step(h));
        for sample in run.duration(0.5) {
            let sample = sample.expect("a step exists");
            let now = total_energy(&sample.q, &sample.v);
            assert!(now <= before + 100.0 * 3.3 * h * h, "{seed}: {} at {} s", now - before, sample.t);
            let gap = m.contact_gaps(&sample.q).min();
            if gap < least {
                least = gap;
            }
            (before, end) = (now, sample.q);
        }
        assert!(least > -3e-3 && end.iter().all(|x| x.is_finite()), "{seed}: {least:e}");
    }
}
