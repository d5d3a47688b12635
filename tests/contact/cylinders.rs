//! Tests of boxes and capsules in contact with cylinders.

use super::boxes::{position_with_gap, random_rotation};
use super::laws::Random;
use linkwork::contact;
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;

const G: f64 = 9.81;

/// Box and capsule, each on an unbounded cylinder and on one with two ends, all horizontal.
#[mechanism(gravity = -9.81 * z)]
struct BodiesOnCylinders {
    #[body(mass = 2, inertia = cuboid(2, 0.6, 0.2, 0.1))]
    plank: Body,
    #[joint(ground -> plank)]
    pose: Free,
    #[contact(plank.cuboid(0.6, 0.2, 0.1), ground.at(-0.2 * x).cylinder(0.05, y), friction = 0.5)]
    left: Contact,
    #[contact(ground.at(0.2 * x).cylinder(0.05, 1, -y), plank.cuboid(0.6, 0.2, 0.1), friction = 0.5)]
    right: Contact,
    #[body(mass = 3, inertia = capsule(3, 0.04, 0.8, x))]
    bar: Body,
    #[joint(ground -> bar)]
    place: Free,
    #[contact(bar.capsule(0.04, 0.8, x), ground.at([-0.2, 1, 0]).cylinder(0.05, y), friction = 0.5)]
    front: Contact,
    #[contact(bar.capsule(0.04, 0.8, x), ground.at([0.2, 1, 0]).cylinder(0.05, 0.3, y), friction = 0.5)]
    back: Contact,
}

/// A box and a capsule that lie across two cylinders stay at rest; the normal forces follow from the lever
/// arms.
#[test]
fn bodies_rest_across_two_cylinders() {
    let m = BodiesOnCylinders {};
    let q = SVector::from([0.05, 0.0, 0.1, 0.0, 0.0, 0.0, 1.0, -0.1, 1.0, 0.09, 0.0, 0.0, 0.0, 1.0]);
    let found = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
    let total_normal_force_of_contact = |name: &str| -> f64 {
        let rows = BodiesOnCylinders::CONTACTS.iter().zip(BodiesOnCylinders::CONTACT_ROWS);
        rows.filter(|(known, _)| known.split('.').next() == Some(name)).map(|(_, row)| found[row.first]).sum()
    };
    let shares = [
        total_normal_force_of_contact("left"),
        total_normal_force_of_contact("right"),
        total_normal_force_of_contact("front"),
        total_normal_force_of_contact("back"),
    ];
    let expected = [2.0 * G * 0.375, 2.0 * G * 0.625, 3.0 * G * 0.75, 3.0 * G * 0.25];
    assert!(shares.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{shares:?} {expected:?}");
    let run = simulate(&m).from(q, [0.0; 12]).method(TimeStepping::step(5e-3)).duration(0.3);
    let end = run.finish().unwrap();
    assert!((end.q - q).amax() < 1e-9, "{}", end.q - q);
}

/// Bodies on a table and on a barrel. Gravity is along the slope `(sin, 0, −cos)`.
#[mechanism(gravity = 9.81 * (sin(slope) * x - cos(slope) * z))]
struct BodiesOnBarrel {
    slope: f64,
    #[body(mass = 2, inertia = cylinder(2, 0.1, 0.3, z))]
    drum: Body,
    #[joint(ground -> drum)]
    pose: Free,
    #[contact(drum.cylinder(0.1, 0.3, z), ground.cuboid(2, 1, 0.2), friction = 0.7)]
    table: Contact,
    #[body(mass = 1, inertia = cuboid(1, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    place: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.at(3 * y).cylinder(0.2, 0.4, z), friction = 0.7)]
    barrel: Contact,
    #[body(mass = 1, inertia = capsule(1, 0.05, 0.3, x))]
    bar: Body,
    #[joint(ground -> bar)]
    above: Free,
    #[contact(bar.capsule(0.05, 0.3, x), ground.at(6 * y).cylinder(0.2, 0.4, z), friction = 0.7)]
    end: Contact,
}

const LYING: f64 = core::f64::consts::FRAC_1_SQRT_2;

/// Drums stand and lie on a box, and a box and a capsule lie on the end of a drum, also beyond its edge.
#[test]
fn cylinder_ends_and_sides_carry_bodies() {
    let m = BodiesOnBarrel { slope: 0.0 };
    for (drum, turn, block, bar) in [
        ([0.0, 0.0, 0.25], [0.0, 0.0, 0.0, 1.0], [0.0, 3.0, 0.25], [0.02, 6.0, 0.25]),
        ([0.95, 0.1, 0.25], [0.0, 0.0, 0.6, 0.8], [0.1, 3.05, 0.25], [0.1, 6.1, 0.25]),
        ([0.3, 0.45, 0.2], [LYING, 0.0, 0.0, LYING], [0.0, 3.15, 0.25], [0.0, 6.0, 0.25]),
    ] {
        let mut q = m.neutral();
        q.fixed_rows_mut::<3>(0).copy_from_slice(&drum);
        q.fixed_rows_mut::<4>(3).copy_from_slice(&turn);
        q.fixed_rows_mut::<3>(7).copy_from_slice(&block);
        q.fixed_rows_mut::<3>(14).copy_from_slice(&bar);
        let found = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
        let total_normal_force_of_contact = |name: &str| -> f64 {
            let rows = BodiesOnBarrel::CONTACTS.iter().zip(BodiesOnBarrel::CONTACT_ROWS);
            let of_name = rows.filter(|(known, _)| known.split('.').next() == Some(name));
            of_name.map(|(_, row)| found[row.first]).sum()
        };
        let loads = [
            total_normal_force_of_contact("table") / 2.0,
            total_normal_force_of_contact("barrel"),
            total_normal_force_of_contact("end"),
        ];
        assert!(loads.iter().all(|load| (load - G).abs() < 1e-5), "{drum:?} {loads:?}");
        let run = simulate(&m).from(q, [0.0; 18]).method(TimeStepping::step(5e-3)).duration(0.2);
        let end = run.finish().unwrap();
        assert!((end.q - q).amax() < 1e-8, "{drum:?} {}", end.q - q);
    }
}

/// A drum rolls on a table with two thirds of the acceleration of frictionless sliding, and falls off.
#[test]
fn drum_rolls_on_a_table_by_closed_form() {
    let m = BodiesOnBarrel { slope: 0.2 };
    let mut q = m.neutral();
    q.fixed_rows_mut::<7>(0).copy_from_slice(&[0.0, 0.0, 0.2, LYING, 0.0, 0.0, LYING]);
    q.fixed_rows_mut::<3>(7).copy_from_slice(&[0.0, 3.0, 0.25]);
    q.fixed_rows_mut::<3>(14).copy_from_slice(&[0.0, 6.0, 0.25]);
    let configuration_after = |t: f64| {
        simulate(&m).from(q, [0.0; 18]).method(TimeStepping::step(1e-3)).duration(t).finish().unwrap().q
    };
    let path = 0.5 * 2.0 / 3.0 * G * 0.2_f64.sin() * 0.25;
    let rolled = configuration_after(0.5);
    assert!((rolled[0] - path).abs() < 2e-3 * path && (rolled[2] - 0.2).abs() < 1e-6, "{rolled} {path}");
    let fallen = configuration_after(1.6);
    assert!(fallen[0] > 1.1 && fallen[2] < 0.0, "{fallen}");
}

/// Returns the signed distance of a point from a cylinder along z.
fn distance_from_drum(p: Vector3<f64>, radius: f64, half: f64) -> f64 {
    let (side, end) = (p.xy().norm() - radius, p[2].abs() - half);
    if side.max(end) < 0.0 { side.max(end) } else { side.max(0.0).hypot(end.max(0.0)) }
}

/// Returns the distance of a box from a cylinder along z, by alternating projections on both.
fn distance_box_to_drum(
    center: Vector3<f64>,
    turn: &UnitQuaternion<f64>,
    half: [f64; 3],
    radius: f64,
    length: f64,
) -> f64 {
    let mut p = center;
    for _ in 0..2000 {
        let (height, side) = (p[2].clamp(-length / 2.0, length / 2.0), p.xy().norm().max(radius));
        let on_drum = Vector3::new(p[0] * radius / side, p[1] * radius / side, height);
        let inner = turn.inverse() * (on_drum - center);
        let on_box = center + turn * Vector3::from_fn(|k, _| inner[k].clamp(-half[k], half[k]));
        let is_converged = (on_box - p).norm() < 1e-12;
        p = on_box;
        if is_converged {
            break;
        }
    }
    distance_from_drum(p, radius, length / 2.0)
}

/// The smallest gap of a capsule or a box on a cylinder is the distance of the surfaces when they touch.
#[test]
fn cylinder_gaps_are_distances_at_contact() {
    let (m, mut random) = (BodiesOnBarrel { slope: 0.0 }, Random(11));
    let mut missed = 0;
    for _ in 0..60 {
        let (turn, far) =
            (random_rotation(&mut random), Vector3::from(random.random_vector::<3>(1.0)).normalize() * 1.5);
        let c = turn.coords;
        let smallest_gap = |first: usize, place: Vector3<f64>| {
            let mut q = m.neutral();
            q.fixed_rows_mut::<3>(first).copy_from_slice(&[place[0], place[1], place[2]]);
            q.fixed_rows_mut::<4>(first + 3).copy_from(&c);
            let gaps = m.contact_gaps(&q);
            let range = if first == 7 { 16..32 } else { 32..37 };
            gaps.as_slice()[range].iter().copied().fold(f64::INFINITY, f64::min)
        };
        // The axis of the capsule is along x.
        let bar = position_with_gap(|p| smallest_gap(14, p + Vector3::y() * 6.0), far, 0.0);
        let along = turn * Vector3::x() * 0.15;
        let (mut low, mut high) = (-1.0, 1.0);
        let distance_from_drum_along_bar = |t: f64| distance_from_drum(bar + along * t, 0.2, 0.2);
        for _ in 0..120 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if distance_from_drum_along_bar(a) < distance_from_drum_along_bar(b) { high = b } else { low = a }
        }
        assert!(
            (distance_from_drum_along_bar(low) - 0.05).abs() < 1e-8,
            "{} {turn} {bar}",
            distance_from_drum_along_bar(low)
        );

        let block = position_with_gap(|p| smallest_gap(7, p + Vector3::y() * 3.0), far, 0.0);
        // Slightly farther outside they do not overlap, and are close to each other.
        let outside = distance_box_to_drum(block * 1.002, &turn, [0.15, 0.1, 0.05], 0.2, 0.4);
        missed += usize::from(!(1e-7..0.01 * block.norm()).contains(&outside));
    }
    assert!(missed < 2, "{missed}");
}
