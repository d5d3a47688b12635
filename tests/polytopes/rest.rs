//! Bodies that rest on each other, fall, or overlap at the start.

use crate::shapes::Random;
use linkwork::contact;
use linkwork::nalgebra::UnitQuaternion;
use linkwork::prelude::*;
use linkwork::simulate::Overlaps;

const G: f64 = 9.81;

/// Three prisms with hexagonal faces on each other; the lowest is on the floor.
#[mechanism(gravity = -9.81 * z)]
struct Nuts {
    #[body(mass = 1, inertia = cylinder(1, 0.1, 0.06, z))]
    nut: [Body; 3],
    #[joint(ground -> nut[i])]
    pose: [Free; 3],
    #[contact(
        nut[i + 1].hull([
            [0.1, 0, 0.03], [0.05, 0.08, 0.03], [-0.05, 0.08, 0.03],
            [-0.1, 0, 0.03], [-0.05, -0.08, 0.03], [0.05, -0.08, 0.03],
            [0.1, 0, -0.03], [0.05, 0.08, -0.03], [-0.05, 0.08, -0.03],
            [-0.1, 0, -0.03], [-0.05, -0.08, -0.03], [0.05, -0.08, -0.03]
        ]),
        nut[i].hull([
            [0.1, 0, 0.03], [0.05, 0.08, 0.03], [-0.05, 0.08, 0.03],
            [-0.1, 0, 0.03], [-0.05, -0.08, 0.03], [0.05, -0.08, 0.03],
            [0.1, 0, -0.03], [0.05, 0.08, -0.03], [-0.05, 0.08, -0.03],
            [-0.1, 0, -0.03], [-0.05, -0.08, -0.03], [0.05, -0.08, -0.03]
        ]),
        friction = 0.6
    )]
    seat: [Contact; 2],
    #[contact(nut[0].cylinder(0.1, 0.06, z), ground.plane(z), friction = 0.6)]
    floor: Contact,
}

/// A stack of prisms stays at rest, and the contact forces of each pair carry the bodies above it.
#[test]
fn stacked_prisms_stay_at_rest() {
    let m = Nuts {};
    let mut q = m.neutral();
    for k in 0..3 {
        q[7 * k] = 0.01 * k as f64;
        q[7 * k + 2] = 0.03 + 0.06 * k as f64;
        let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3 * k as f64).coords;
        q.fixed_rows_mut::<4>(7 * k + 3).copy_from(&turn);
    }
    let forces = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
    for (name, bodies) in [("seat_0", 2.0), ("seat_1", 1.0)] {
        let rows = Nuts::CONTACTS.iter().zip(Nuts::CONTACT_ROWS);
        let own = rows.filter(|(contact, _)| contact.split('.').next() == Some(name));
        let carried: f64 = own.map(|(_, rows)| forces[rows.first]).sum();
        assert!((carried - bodies * G).abs() < 1e-5, "{name}: {carried}");
    }
    let run = simulate(&m).from(q, [0.0; 18]).method(TimeStepping::step(5e-3)).duration(0.5);
    let moved = (run.finish().unwrap().q - q).amax();
    assert!(moved < 1e-10, "{moved:e}");
}

/// A tetrahedron on a prism with triangular ends, which stands on the floor.
#[mechanism(gravity = -9.81 * z)]
struct Shards {
    #[body(mass = 1, inertia = cylinder(1, 0.1, 0.08, z))]
    prism: Body,
    #[joint(ground -> prism)]
    below: Free,
    #[body(mass = 0.5, com = [0.02, 0.02, 0.03], inertia = sphere(0.5, 0.03))]
    spike: Body,
    #[joint(ground -> spike)]
    above: Free,
    #[contact(
        spike.hull([[0, 0, 0], [0.08, 0, 0], [0, 0.08, 0], [0, 0, 0.12]]),
        prism.hull([
            [0.12, 0, 0.04], [-0.06, 0.1, 0.04], [-0.06, -0.1, 0.04],
            [0.12, 0, -0.04], [-0.06, 0.1, -0.04], [-0.06, -0.1, -0.04]
        ]),
        friction = 0.6
    )]
    seat: Contact,
    #[contact(
        prism.hull([
            [0.12, 0, 0.04], [-0.06, 0.1, 0.04], [-0.06, -0.1, 0.04],
            [0.12, 0, -0.04], [-0.06, 0.1, -0.04], [-0.06, -0.1, -0.04]
        ]),
        ground.at([0, 0, -0.1]).cuboid(2, 2, 0.2),
        friction = 0.6
    )]
    floor: Contact,
}

fn total_energy(m: &Shards, q: &SVector<f64, 14>, v: &SVector<f64, 12>) -> f64 {
    m.kinetic_energy(q, v) + m.potential_energy(q)
}

/// Returns the configuration with the prism on the floor, and the tetrahedron at a height above it.
fn configuration(place: [f64; 3], turn: UnitQuaternion<f64>) -> SVector<f64, 14> {
    let mut q = Shards {}.neutral();
    q[2] = 0.04;
    q.fixed_rows_mut::<3>(7).copy_from_slice(&[place[0], place[1], 0.08 + place[2]]);
    q.fixed_rows_mut::<4>(10).copy_from(&turn.coords);
    q
}

/// The normal forces of a tetrahedron at rest are proportional to the barycentric coordinates of its centre
/// of mass in its base.
#[test]
fn tetrahedron_rests_on_a_prism() {
    let m = Shards {};
    let q = configuration([-0.02, -0.01, 0.0], UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4));
    let found = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
    let rows = Shards::CONTACTS.iter().zip(Shards::CONTACT_ROWS).filter(|(name, _)| name.starts_with("seat"));
    let mut shares: Vec<f64> = rows.map(|(_, rows)| found[rows.first] / (0.5 * G)).collect();
    shares.sort_by(f64::total_cmp);
    let largest = &shares[shares.len() - 3..];
    assert!(largest.iter().zip([0.25, 0.25, 0.5]).all(|(a, b)| (a - b).abs() < 1e-6), "{shares:?}");
    let run = simulate(&m).from(q, [0.0; 12]).method(TimeStepping::step(5e-3)).duration(0.5);
    let moved = (run.finish().unwrap().q - q).amax();
    assert!(moved < 1e-10, "{moved:e}");
}

/// A tetrahedron falls on its tip, tips over, and comes to rest or falls to the floor. The energy does not
/// grow, and overlaps are at most those of one step.
#[test]
fn falling_tetrahedron_gains_no_energy() {
    let m = Shards {};
    for (place, angles) in [([0.0, 0.0, 0.2], [2.5, 0.2, 0.1]), ([0.1, 0.02, 0.1], [0.3, 0.5, 0.2])] {
        let turn = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
        let q = configuration(place, turn);
        let (mut energy, mut least) = (total_energy(&m, &q, &SVector::zeros()), 0.0_f64);
        let run = simulate(&m).from(q, [0.0; 12]).method(TimeStepping::step(1e-3));
        for sample in run.sample_every(1e-3).duration(0.5) {
            let sample = sample.unwrap();
            let now = total_energy(&m, &sample.q, &sample.v);
            assert!(now < energy + 3e-6, "{} {now} {energy}", sample.t);
            energy = now;
            least = least.min(m.contact_gaps(&sample.q).min());
        }
        assert!(least > -3e-3, "{least}");
    }
}

/// Bodies that overlap deeply at the start are separated, and the run ends without gain of energy.
#[test]
fn deep_overlaps_are_separated() {
    let (m, mut random) = (Shards {}, Random(5));
    for _ in 0..6 {
        let place = random.random_point() * 0.03;
        let q = configuration([place[0], place[1], place[2] - 0.06], random.random_rotation());
        assert!(m.contact_gaps(&q).min() < -0.01);
        let run = simulate(&m)
            .from(q, [0.0; 12])
            .overlaps(Overlaps::Part)
            .method(TimeStepping::step(1e-3))
            .sample_every(1e-3)
            .duration(0.1);
        let mut samples = run.map(|sample| sample.unwrap());
        let start = samples.next().unwrap();
        assert!(m.contact_gaps(&start.q).min() > -1e-8, "{}", m.contact_gaps(&start.q).min());
        let before = total_energy(&m, &start.q, &start.v);
        let end = samples.last().unwrap();
        assert!(total_energy(&m, &end.q, &end.v) < before + 1e-5 && end.q.iter().all(|x| x.is_finite()));
    }
}
