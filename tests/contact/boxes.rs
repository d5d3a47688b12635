//! Contacts between boxes, and between capsules and boxes: faces, edges and corners.

use super::laws::{Random, check_impact_conditions};
use linkwork::contact;
use linkwork::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use linkwork::prelude::*;

const G: f64 = 9.81;

/// Half of the edge lengths of the lower and of the upper box, m.
const LOW: [f64; 3] = [0.1, 0.1, 0.05];
const HIGH: [f64; 3] = [0.15, 0.1, 0.025];

/// Two boxes, one resting on the other on the floor.
#[mechanism(gravity = -gravity * z)]
pub struct TwoBoxes {
    pub gravity: f64,
    pub friction: f64,
    pub restitution: f64,
    #[body(mass = 1, inertia = cuboid(1, 0.2, 0.2, 0.1))]
    low: Body,
    #[joint(ground -> low)]
    below: Free,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.05))]
    high: Body,
    #[joint(ground -> high)]
    above: Free,
    #[contact(
        high.cuboid(0.3, 0.2, 0.05), low.cuboid(0.2, 0.2, 0.1), friction = friction, restitution = restitution
    )]
    seat: Contact,
    #[contact(low.cuboid(0.2, 0.2, 0.1), ground.plane(z), friction = friction)]
    floor: Contact,
}

/// Two boxes, one on the other, with the lower box as the first surface of their contact.
#[mechanism(gravity = -gravity * z)]
pub struct BoxesInSwappedOrder {
    pub gravity: f64,
    pub friction: f64,
    pub restitution: f64,
    #[body(mass = 1, inertia = cuboid(1, 0.2, 0.2, 0.1))]
    low: Body,
    #[joint(ground -> low)]
    below: Free,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.05))]
    high: Body,
    #[joint(ground -> high)]
    above: Free,
    #[contact(
        low.cuboid(0.2, 0.2, 0.1), high.cuboid(0.3, 0.2, 0.05), friction = friction, restitution = restitution
    )]
    seat: Contact,
    #[contact(low.cuboid(0.2, 0.2, 0.1), ground.plane(z), friction = friction)]
    floor: Contact,
}

/// Log (capsule) across a fixed beam (box).
#[mechanism(gravity = -9.81 * z)]
struct LogAcrossBeam {
    friction: f64,
    #[body(mass = 3, inertia = capsule(3, 0.05, 0.6, x))]
    log: Body,
    #[joint(ground -> log)]
    pose: Free,
    #[contact(log.capsule(0.05, 0.6, x), ground.cuboid(0.2, 2, 0.2), friction = friction)]
    beam: Contact,
}

/// Returns the configuration of both boxes, in which the upper one has its centre at `place` and the
/// orientation `turn`.
pub fn configuration_of_boxes(m: &TwoBoxes, place: [f64; 3], turn: UnitQuaternion<f64>) -> SVector<f64, 14> {
    let mut q = m.neutral();
    q[2] = LOW[2];
    (q[7], q[8], q[9]) = (place[0], place[1], place[2]);
    (0..4).for_each(|k| q[10 + k] = turn.coords[k]);
    q
}

/// Returns the distance of two disjoint boxes. The columns of `a` and `b` are the boxes' axes times half of
/// their lengths; `c` is the offset of their centres. The distance is the minimum over all corners of each
/// box to the other box, and over all pairs of edges.
fn distance_of_boxes(a: &Matrix3<f64>, b: &Matrix3<f64>, c: Vector3<f64>) -> f64 {
    let signs_of_corner = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { -1.0 } else { 1.0 });
    let corner_of_block = |block: &Matrix3<f64>, k: usize| block * Vector3::from(signs_of_corner(k));
    // Distance of a point from a box, relative to its centre.
    let distance_to_box = |block: &Matrix3<f64>, point: Vector3<f64>| {
        let near = block.column_iter().fold(Vector3::zeros(), |sum, axis| {
            let square = axis.norm_squared();
            sum + if square > 0.0 { axis * (axis.dot(&point) / square).clamp(-1.0, 1.0) } else { axis * 0.0 }
        });
        (point - near).norm()
    };
    let mut least = f64::INFINITY;
    for k in 0..8 {
        least = least
            .min(distance_to_box(b, c + corner_of_block(a, k)))
            .min(distance_to_box(a, corner_of_block(b, k) - c));
    }
    // Half of each edge as a vector, and its midpoint.
    let edges_of_block = |block: &Matrix3<f64>| {
        let block_half_edge_and_midpoint = |axis: usize, k: usize| {
            let half: Vector3<f64> = block.column(axis).into();
            (half, corner_of_block(block, k) - half * signs_of_corner(k)[axis])
        };
        (0..24).map(|k| block_half_edge_and_midpoint(k % 3, k / 3)).collect::<Vec<_>>()
    };
    for (own, middle) in edges_of_block(a) {
        for (other, foot) in edges_of_block(b) {
            let (apart, x, y, z) =
                (c + middle - foot, own.norm_squared(), other.norm_squared(), own.dot(&other));
            let (by_own, by_other) = (own.dot(&apart), other.dot(&apart));
            let determinant = x * y - z * z;
            if determinant > 1e-18 {
                let s = (z * by_other - y * by_own) / determinant;
                let t = (x * by_other - z * by_own) / determinant;
                if s.abs() <= 1.0 && t.abs() <= 1.0 {
                    least = least.min((apart + own * s - other * t).norm());
                }
            }
        }
    }
    least
}

fn scaled_axes(turn: &UnitQuaternion<f64>, half: [f64; 3]) -> Matrix3<f64> {
    turn.to_rotation_matrix().into_inner() * Matrix3::from_diagonal(&half.into())
}

pub fn random_rotation(random: &mut Random) -> UnitQuaternion<f64> {
    let [x, y, z]: [f64; 3] = random.random_vector::<3>(3.0).into();
    UnitQuaternion::from_scaled_axis(Vector3::new(x, y, z))
}

/// Returns the position on the line from `far` to the origin at which the minimum of the gaps is `wanted`.
pub fn position_with_gap(gap: impl Fn(Vector3<f64>) -> f64, far: Vector3<f64>, wanted: f64) -> Vector3<f64> {
    let mut steps = (0..=200).map(|k| 1.0 - f64::from(k) / 200.0);
    let mut inside = steps.find(|part| gap(far * *part) <= wanted).expect("surfaces meet");
    let mut out = inside + 1.0 / 200.0;
    for _ in 0..70 {
        let part = (out + inside) / 2.0;
        if gap(far * part) > wanted { out = part } else { inside = part }
    }
    far * out
}

/// The gap of nearly touching boxes, or of a capsule and a box, is the minimum distance of their points; for
/// larger distances it is positive.
#[test]
fn box_gaps_are_distances_near_contact() {
    let (m, mut random) = (TwoBoxes { gravity: G, friction: 0.0, restitution: 0.0 }, Random(3));
    let (log, mut beside) = (LogAcrossBeam { friction: 0.0 }, 0);
    let (low, bar) = (Matrix3::from_diagonal(&LOW.into()), Matrix3::from_diagonal(&[0.1, 1.0, 0.1].into()));
    for _ in 0..60 {
        let (turn, far) =
            (random_rotation(&mut random), Vector3::from(random.random_vector::<3>(1.0)).normalize() * 2.0);
        let (high, line) = (scaled_axes(&turn, HIGH), scaled_axes(&turn, [0.3, 0.0, 0.0]));
        let least_gap_to_seat = |place: Vector3<f64>| {
            let q = configuration_of_boxes(&m, [place[0], place[1], place[2] + LOW[2]], turn);
            m.contact_gaps(&q).rows(0, 13).min()
        };
        let least_gap_to_beam = |place: Vector3<f64>| {
            let c = turn.coords;
            let q = [place[0], place[1], place[2], c[0], c[1], c[2], c[3]].into();
            log.contact_gaps(&q).min()
        };
        for wanted in [0.0, 1e-6] {
            let place = position_with_gap(least_gap_to_seat, far, wanted);
            let found = distance_of_boxes(&high, &low, place);
            beside += usize::from((found - wanted).abs() > 1e-9);
            assert!(
                found < 1e-7 + 100.0 * wanted && least_gap_to_seat(place * 1.3) > 0.0,
                "{wanted} {found} {turn} {place}"
            );
            let place = position_with_gap(least_gap_to_beam, far, wanted);
            let found = distance_of_boxes(&line, &bar, place) - 0.05;
            beside += usize::from((found - wanted).abs() > 1e-9);
            assert!(
                found < 1e-7 + 100.0 * wanted && least_gap_to_beam(place * 1.3) > 0.0,
                "{wanted} {found} {turn} {place}"
            );
        }
    }
    assert!(beside < 4, "{beside}");
}

/// Checks the columns of the Jacobian that steps read: those of the bodies of each contact. Nothing moves the
/// surfaces of bodies at rest.
#[test]
fn contact_jacobians_have_only_columns_of_their_bodies() {
    use linkwork::contact::Contacts;
    let m = TwoBoxes { gravity: G, friction: 0.4, restitution: 0.0 };
    let columns = m.contact_columns();
    for (name, columns) in TwoBoxes::CONTACTS.iter().zip(columns) {
        assert_eq!(columns, if name.starts_with("seat") { (0, 12) } else { (0, 6) }, "{name}");
    }
    assert!(!m.contacts_drift());
}

/// Checks boxes that lie face on face: flush, rotated, and crossed such that no corner of either is on the
/// other. They stay at rest, and their contact points carry the whole weight.
#[test]
fn stacked_boxes_stay_at_rest() {
    let m = TwoBoxes { gravity: G, friction: 0.4, restitution: 0.0 };
    for (yaw, x, y) in
        [(0.0, 0.0, 0.0), (0.0, 0.05, 0.0), (0.4, 0.03, -0.06), (core::f64::consts::FRAC_PI_2, 0.0, 0.0)]
    {
        let q = configuration_of_boxes(&m, [x, y, 0.125], UnitQuaternion::from_euler_angles(0.0, 0.0, yaw));
        let forces = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
        let rows = TwoBoxes::CONTACT_ROWS;
        let carried: f64 = rows.iter().take(13).map(|row| forces[row.first]).sum();
        assert!((carried - 2.0 * G).abs() < 1e-5, "{yaw}: {carried}");
        let run = simulate(&m).from(q, [0.0; 12]).method(TimeStepping::step(5e-3)).duration(0.2);
        let end = run.finish().unwrap();
        assert!((end.q - q).amax() < 1e-11, "{yaw}: {:e}", (end.q - q).amax());
    }
}

/// Checks a collision edge on edge: the impulse is along the common normal `n` of both edges, with magnitude
/// `(1 + e) v / Σ (1/m + (r × n)·I⁻¹(r × n))` summed over both boxes.
#[test]
fn edge_collision_has_the_closed_form_impulse() {
    let m = TwoBoxes { gravity: 0.0, friction: 0.0, restitution: 0.5 };
    let box_inertia = |mass: f64, [a, b, c]: [f64; 3]| {
        Matrix3::from_diagonal(&[b * b + c * c, a * a + c * c, a * a + b * b].into()) * (mass / 3.0)
    };
    for (d, lean) in [(0.0, 0.2), (0.03, 0.2), (-0.08, 0.3)] {
        // The edge of the upper box between its faces −y and −z is above the edge of the lower box at x = 0.1
        // along y.
        let lean = UnitQuaternion::from_euler_angles(0.0, lean, 0.0);
        let turn = lean * UnitQuaternion::from_euler_angles(core::f64::consts::FRAC_PI_4, 0.0, 0.0);
        let met = Vector3::new(LOW[0], 0.0, LOW[2]);
        let arm = turn * Vector3::new(d, -HIGH[1], -HIGH[2]);
        // Along the lower edge, the centre of the upper box is directly above its contact point.
        let center = met - arm + Vector3::new(0.0, arm[1], 0.0);
        let met = met + Vector3::new(0.0, arm[1] + center[1], 0.0);
        let mut q = configuration_of_boxes(&m, [center[0], center[1], center[2] + 1.0], turn);
        q[2] = 1.0;
        let gaps = m.contact_gaps(&q);
        assert!(gaps[12].abs() < 1e-15 && gaps.rows(0, 12).min() > 1e-3, "{gaps}");
        let fall = turn.inverse() * Vector3::new(0.0, 0.0, -2.0);
        let mut v = SVector::<f64, 12>::zeros();
        v.fixed_rows_mut::<3>(6).copy_from(&fall);
        let n = lean * Vector3::z();
        let inverse_mass_at_contact =
            |arm: Vector3<f64>, turn: &UnitQuaternion<f64>, mass: f64, half: [f64; 3]| {
                let about = turn.inverse() * arm.cross(&n);
                1.0 / mass + about.dot(&(box_inertia(mass, half).try_inverse().unwrap() * about))
            };
        let all = inverse_mass_at_contact(arm, &turn, 2.0, HIGH)
            + inverse_mass_at_contact(met, &UnitQuaternion::identity(), 1.0, LOW);
        let wanted = 1.5 * 2.0 * n[2] / all;
        let found = contact::impact(&m, 0.0, &q, &v).unwrap();
        let impulse = found.impulses[TwoBoxes::CONTACT_ROWS[12].first];
        assert!((impulse - wanted).abs() < 1e-12, "{impulse} {wanted}");
    }
}

/// Checks that impacts in random contact positions satisfy the contact conditions, and that two boxes without
/// other contacts preserve their momentum.
#[test]
fn random_box_impacts_satisfy_contact_conditions() {
    let mut random = Random(11);
    for k in 0..60 {
        let m = TwoBoxes {
            gravity: 0.0,
            friction: random.random_choice([0.0, 0.3, 2.0]),
            restitution: random.random_choice([0.0, 0.6, 1.0]),
        };
        let turn = if k % 3 == 0 { UnitQuaternion::identity() } else { random_rotation(&mut random) };
        let far = Vector3::from(random.random_vector::<3>(1.0)).normalize();
        // Both boxes are above the floor.
        let configuration_at_place = |place: Vector3<f64>| {
            let mut q = configuration_of_boxes(&m, [place[0], place[1], place[2] + 1.0], turn);
            q[2] = 1.0;
            q
        };
        let place = position_with_gap(
            |place| m.contact_gaps(&configuration_at_place(place)).rows(0, 13).min(),
            far,
            0.0,
        );
        let (q, v) = (configuration_at_place(place), random.random_vector(2.0));
        check_impact_conditions(&m, &q, &v);
        let found = contact::impact(&m, 0.0, &q, &v).unwrap();
        let linear_and_angular_momentum = |v: &SVector<f64, 12>| {
            let p = m.mass_matrix(&q) * v;
            let orientation_at =
                |k: usize| UnitQuaternion::from_quaternion([q[k], q[k + 1], q[k + 2], q[k + 3]].into());
            let momentum_of_body =
                |k: usize, turn: UnitQuaternion<f64>| turn * Vector3::new(p[k], p[k + 1], p[k + 2]);
            let (a, b) = (orientation_at(3), orientation_at(10));
            let (pa, pb) = (momentum_of_body(0, a), momentum_of_body(6, b));
            let spin = momentum_of_body(3, a) + momentum_of_body(9, b);
            let position_of_body = |k: usize| Vector3::new(q[k], q[k + 1], q[k + 2]);
            (pa + pb, spin + position_of_body(0).cross(&pa) + position_of_body(7).cross(&pb))
        };
        let (before, after) = (linear_and_angular_momentum(&v), linear_and_angular_momentum(&found.v));
        assert!((before.0 - after.0).norm() < 1e-12 && (before.1 - after.1).norm() < 1e-12);
    }
}

/// Checks a box that falls on an edge of another box, tips, and comes to rest or slides off. The energy never
/// grows, overlaps are at most those of one step, and the order of the two surfaces has no effect.
#[test]
fn box_falling_on_an_edge_gains_no_energy() {
    let m = TwoBoxes { gravity: G, friction: 0.5, restitution: 0.0 };
    let other = BoxesInSwappedOrder { gravity: G, friction: 0.5, restitution: 0.0 };
    let q = configuration_of_boxes(&m, [0.08, 0.02, 0.3], UnitQuaternion::from_euler_angles(0.3, 0.5, 0.2));
    let h = 1e-3;
    let total_energy = |q: &_, v: &_| m.kinetic_energy(q, v) + m.potential_energy(q);
    let mut before = total_energy(&q, &SVector::zeros());
    let run = simulate(&m).from(q, [0.0; 12]).method(TimeStepping::step(h)).sample_every(h).duration(0.3);
    let swapped =
        simulate(&other).from(q, [0.0; 12]).method(TimeStepping::step(h)).sample_every(h).duration(0.3);
    let (mut least, mut apart) = (0.0_f64, 0.0_f64);
    for (sample, same) in run.zip(swapped) {
        let (sample, same) = (sample.unwrap(), same.unwrap());
        let now = total_energy(&sample.q, &sample.v);
        assert!(now < before + 1e-6, "{} {now} {before}", sample.t);
        before = now;
        least = least.min(m.contact_gaps(&sample.q).min());
        if sample.t < 0.25 {
            apart = apart.max((sample.q - same.q).amax());
        }
    }
    assert!(least > -3e-3, "{least}");
    // The search for the impulses of many contact points ends at a relative violation of 1e-8.
    assert!(apart < 1e-8, "{apart}");
}

/// Checks that a log across a beam rests on both edges of the beam's face, which carry its weight.
#[test]
fn log_across_a_beam_rests_on_both_edges() {
    let m = LogAcrossBeam { friction: 0.5 };
    let q = [0.0, 0.0, 0.15, 0.0, 0.0, 0.0, 1.0].into();
    let forces = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
    let normal: Vec<f64> = LogAcrossBeam::CONTACT_ROWS.iter().map(|row| forces[row.first]).collect();
    assert!(
        (normal.iter().sum::<f64>() - 3.0 * G).abs() < 1e-5 && normal[2].min(normal[3]) > 0.5 * G,
        "{normal:?}"
    );
    let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(5e-3)).duration(0.2);
    assert!((run.finish().unwrap().q - q).amax() < 1e-12);
}
