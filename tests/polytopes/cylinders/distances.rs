//! Gaps are signed distances. Contact velocities are their rates, and biases the rates of contact velocities.

use crate::shapes::{Point, Random, WEDGE};
use linkwork::nalgebra::UnitQuaternion;
use linkwork::prelude::*;

/// A can, with contacts with a disk of an oblique axis, a prism and an unbounded cylinder that are fixed in
/// the ground at different places.
#[mechanism(gravity = -9.81 * z)]
struct Can {
    #[body(mass = 1, inertia = cylinder(1, 0.1, 0.3, z))]
    can: Body,
    #[joint(ground -> can)]
    pose: Free,
    #[contact(can.cylinder(0.1, 0.3, z), ground.cylinder(0.07, 0.04, 0.6 * x + 0.8 * z), friction = 0.5)]
    disk: Contact,
    #[contact(
        ground.at(2 * x).hull([
            [0.1, 0.08, -0.04], [0.1, -0.08, -0.04], [-0.1, 0.08, -0.04], [-0.1, -0.08, -0.04],
            [0, 0.08, 0.08], [0, -0.08, 0.08]
        ]),
        can.cylinder(0.1, 0.3, z),
        friction = 0.5
    )]
    wedge: Contact,
    #[contact(can.cylinder(0.1, 0.3, z), ground.at(4 * x).cylinder(0.04, y), friction = 0.5)]
    pipe: Contact,
}

/// Names of the contacts, in the order of the fixed bodies.
const NAMES: [&str; 3] = ["disk", "wedge", "pipe"];

/// Returns the farthest point of a cylinder with this radius and length along a direction.
fn farthest_of_cylinder(radius: f64, length: f64, axis: Point, along: Point) -> Point {
    let remove_axial = |v: Point| v - axis * axis.dot(&v);
    let across = remove_axial(remove_axial(along));
    let side = if axis.dot(&along) < 0.0 { -0.5 } else { 0.5 };
    let arm = if across.norm() > 0.0 { across * (radius / across.norm()) } else { across };
    axis * (length * side) + arm
}

/// Returns the separation of the can from a fixed body along a unit vector towards the can.
fn separation(body: usize, place: Point, rotation: &UnitQuaternion<f64>, normal: Point) -> f64 {
    let of_can = place + rotation * farthest_of_cylinder(0.1, 0.3, Point::z(), rotation.inverse() * -normal);
    let fixed = match body {
        0 => farthest_of_cylinder(0.07, 0.04, Point::new(0.6, 0.0, 0.8), normal),
        1 => {
            let vertices = WEDGE.map(Point::from).into_iter();
            vertices.max_by(|a, b| normal.dot(a).total_cmp(&normal.dot(b))).expect("a vertex")
        }
        _ => farthest_of_cylinder(0.04, 20.0, Point::y(), normal),
    };
    normal.dot(&(of_can - fixed))
}

/// Returns the largest separation over directions, and its direction: from samples on the sphere and on great
/// circles perpendicular to the axes, each improved by random steps of decreasing size. It is the signed
/// distance.
fn largest_separation(
    body: usize,
    place: Point,
    rotation: &UnitQuaternion<f64>,
    random: &mut Random,
) -> (f64, Point) {
    let mut samples: Vec<(f64, Point)> = Vec::new();
    let mut add_separation_sample =
        |normal: Point| samples.push((separation(body, place, rotation, normal), normal));
    for k in 0..400 {
        let (height, angle) =
            (1.0 - (2.0 * f64::from(k) + 1.0) / 400.0, 2.399_963_229_728_653 * f64::from(k));
        let radius = (1.0 - height * height).sqrt();
        add_separation_sample(Point::new(radius * angle.cos(), radius * angle.sin(), height));
    }
    let axis = rotation * Point::z();
    let own = [Point::new(0.6, 0.0, 0.8), Point::y(), Point::y()][body];
    for axis in [axis, own] {
        let first = axis.cross(&Point::ith(axis.iamin(), 1.0)).normalize();
        let second = axis.cross(&first);
        (0..90).for_each(|k| {
            let angle = 2.0 * core::f64::consts::PI * f64::from(k) / 90.0;
            add_separation_sample(first * angle.cos() + second * angle.sin());
        });
        [axis, -axis].into_iter().for_each(&mut add_separation_sample);
    }
    samples.sort_by(|a, b| b.0.total_cmp(&a.0));
    samples.truncate(3);
    let improved = samples.into_iter().map(|mut best| {
        let mut step = 0.1;
        while step > 1e-9 {
            let mut is_better = false;
            for _ in 0..12 {
                let normal = (best.1 + random.random_point() * step).normalize();
                let value = separation(body, place, rotation, normal);
                if value > best.0 {
                    (best, is_better) = ((value, normal), true);
                }
            }
            step *= if is_better { 1.3 } else { 0.6 };
        }
        best
    });
    improved.max_by(|a, b| a.0.total_cmp(&b.0)).expect("a sample")
}

fn configuration(body: usize, place: Point, rotation: &UnitQuaternion<f64>) -> SVector<f64, 7> {
    let c = rotation.coords;
    [place[0] + 2.0 * body as f64, place[1], place[2], c[0], c[1], c[2], c[3]].into()
}

/// Returns the contact of a fixed body with the least gap, and its gap.
fn contact_with_least_gap(body: usize, q: &SVector<f64, 7>) -> (usize, f64) {
    let gaps = Can {}.contact_gaps(q);
    let own = Can::CONTACTS.iter().enumerate();
    let own = own.filter(|(_, contact)| contact.split('.').next() == Some(NAMES[body]));
    own.map(|(k, _)| (k, gaps[k])).min_by(|a, b| a.1.total_cmp(&b.1)).expect("a contact")
}

/// Returns a pose of the can at a signed distance of a fixed body.
fn pose_at_distance(body: usize, distance: f64, random: &mut Random) -> (Point, UnitQuaternion<f64>) {
    let (rotation, place) = (random.random_rotation(), random.random_point() * 0.4);
    let (now, normal) = largest_separation(body, place, &rotation, random);
    (place + normal * (distance - now), rotation)
}

#[test]
fn pairs_have_eight_contact_points() {
    for name in NAMES {
        let count = Can::CONTACTS.iter().filter(|contact| contact.split('.').next() == Some(name)).count();
        assert_eq!(count, 8, "{name}");
    }
}

/// The least gap is the separation along the normal of its contact, which is a lower bound of the signed
/// distance. It is not below the separation along any direction, of which the largest is the signed distance.
#[test]
fn least_gap_is_the_signed_distance() {
    let mut random = Random(3);
    let (mut overlapping, mut apart) = (0, 0);
    for k in 0..42 {
        let (body, distance) = (k % 3, [0.0, 1e-5, 0.02, 0.2, -1e-6, -1e-4, -3e-3][k % 7]);
        let (place, rotation) = pose_at_distance(body, distance, &mut random);
        let q = configuration(body, place, &rotation);
        let (contact, gap) = contact_with_least_gap(body, &q);
        let row = Can {}.contact_jacobian(&q).row(Can::CONTACT_ROWS[contact].first).into_owned();
        // The row is the normal in the axes of the can, or its negative. Any direction gives a lower bound.
        let normal = rotation * Point::new(row[0], row[1], row[2]);
        assert!((normal.norm() - 1.0).abs() < 1e-12, "{normal}");
        let found = [normal, -normal].map(|normal| separation(body, place, &rotation, normal));
        assert!(found.iter().any(|found| (gap - found).abs() < 1e-10), "{k}: {gap} {found:?}");
        let (expected, _) = largest_separation(body, place, &rotation, &mut random);
        assert!(expected < gap + 2e-9, "{k}: {gap} {expected}");
        (overlapping, apart) = (overlapping + usize::from(gap < -1e-7), apart + usize::from(gap > 1e-3));
    }
    assert!(overlapping > 10 && apart > 10, "{overlapping} {apart}");
}

/// The least gap changes at the normal rate of its contact, and the contact velocities change at the rate of
/// the bias: contact points move on rims and sides as on smooth surfaces.
#[test]
fn rates_and_biases_are_derivatives() {
    let (m, mut random, h) = (Can {}, Random(5), 1e-5);
    let mut compared = [0; 3];
    for k in 0..90 {
        let body = k % 3;
        let (place, rotation) = pose_at_distance(body, [0.01, 1e-3, -1e-3][k / 3 % 3], &mut random);
        let q = configuration(body, place, &rotation);
        let mut v = SVector::<f64, 6>::zeros();
        v.iter_mut().for_each(|v| *v = random.next_random_number());
        let (contact, gap) = contact_with_least_gap(body, &q);
        let rows = Can::CONTACT_ROWS[contact];
        let [low, high] = [-h, h].map(|h| m.integrate(&q, &(v * h)));
        let [before, after] = [&low, &high].map(|q| contact_with_least_gap(body, q));
        let [slow, now, fast] = [&low, &q, &high].map(|q| m.contact_rates(q, &v));
        let bias = m.contact_bias(&q, &v);
        // The features, or the tangents, are others where the second difference is large.
        let second_difference_of_rate = |i: usize| (slow[i] + fast[i] - 2.0 * now[i]).abs();
        let rows = rows.first..rows.first + rows.count;
        let is_smooth = rows.clone().all(|i| second_difference_of_rate(i) < 1e-6)
            && before.0 == contact
            && after.0 == contact;
        if !is_smooth || ((after.1 - gap) - (gap - before.1)).abs() > 1e-3 * h {
            continue;
        }
        let rate = (after.1 - before.1) / (2.0 * h);
        assert!((now[rows.start] - rate).abs() < 1e-5, "{k}: {} {rate}", now[rows.start]);
        for i in rows {
            let difference = (fast[i] - slow[i]) / (2.0 * h);
            let tolerance = 2e-4 * (1.0 + difference.abs());
            assert!((bias[i] - difference).abs() < tolerance, "{k} {i}: {} {difference}", bias[i]);
        }
        compared[body] += 1;
    }
    assert!(compared.iter().all(|count| *count > 18), "{compared:?}");
}
