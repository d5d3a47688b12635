//! Gaps are signed distances, continuous, and their rates are consistent with them.

use crate::shapes::{GEM, Point, Random, STONE, WEDGE, box_corners, points_in_pose, signed_distance};
use linkwork::nalgebra::UnitQuaternion;
use linkwork::prelude::*;

/// An irregular hull, with contacts with a hull, a prism, a box, a capsule and an unbounded cylinder that are
/// fixed in the ground at different places.
#[mechanism(gravity = -9.81 * z)]
pub struct Stone {
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    stone: Body,
    #[joint(ground -> stone)]
    pose: Free,
    #[contact(
        stone.hull([
            [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
            [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
        ]),
        ground.hull([
            [0, 0.05, 0.08], [0, 0.05, -0.08], [0, -0.05, 0.08], [0, -0.05, -0.08],
            [0.05, 0.08, 0], [0.05, -0.08, 0], [-0.05, 0.08, 0], [-0.05, -0.08, 0],
            [0.08, 0, 0.05], [0.08, 0, -0.05], [-0.08, 0, 0.05], [-0.08, 0, -0.05]
        ]),
        friction = 0.5
    )]
    gem: Contact,
    #[contact(
        ground.at(x).hull([
            [0.1, 0.08, -0.04], [0.1, -0.08, -0.04], [-0.1, 0.08, -0.04], [-0.1, -0.08, -0.04],
            [0, 0.08, 0.08], [0, -0.08, 0.08]
        ]),
        stone.hull([
            [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
            [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
        ]),
        friction = 0.5
    )]
    wedge: Contact,
    #[contact(
        stone.hull([
            [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
            [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
        ]),
        ground.at(2 * x).cuboid(0.2, 0.3, 0.1)
    )]
    brick: Contact,
    #[contact(
        stone.hull([
            [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
            [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
        ]),
        ground.at(3 * x).capsule(0.04, 0.2, y)
    )]
    log: Contact,
    #[contact(
        stone.hull([
            [0.11, 0.02, -0.03], [-0.07, 0.09, 0.01], [-0.08, -0.06, -0.05], [0.03, -0.1, 0.02],
            [0.01, 0.03, 0.12], [0.02, 0.07, -0.09], [0.06, -0.03, 0.08]
        ]),
        ground.at(4 * x).cylinder(0.04, y)
    )]
    pipe: Contact,
}

/// Returns the configuration with the stone at a position relative to one of the fixed bodies.
pub fn configuration(body: usize, place: Point, turn: &UnitQuaternion<f64>) -> SVector<f64, 7> {
    let c = turn.coords;
    [place[0] + body as f64, place[1], place[2], c[0], c[1], c[2], c[3]].into()
}

/// Returns the contact of a fixed body with the least gap, and its gap.
pub fn contact_with_least_gap(m: &Stone, body: usize, q: &SVector<f64, 7>) -> (usize, f64) {
    let name = ["gem", "wedge", "brick", "log", "pipe"][body];
    let gaps = m.contact_gaps(q);
    let own =
        Stone::CONTACTS.iter().enumerate().filter(|(_, contact)| contact.split('.').next() == Some(name));
    own.map(|(k, _)| (k, gaps[k])).min_by(|a, b| a.1.total_cmp(&b.1)).expect("a contact")
}

/// Returns the points of a fixed body, relative to its centre, and the radius around them.
fn fixed_body_points_and_radius(body: usize) -> (Vec<[f64; 3]>, f64) {
    match body {
        0 => (GEM.to_vec(), 0.0),
        1 => (WEDGE.to_vec(), 0.0),
        2 => (box_corners([0.2, 0.3, 0.1]), 0.0),
        3 => (vec![[0.0, -0.1, 0.0], [0.0, 0.1, 0.0]], 0.04),
        _ => (vec![[0.0, -3.0, 0.0], [0.0, 3.0, 0.0]], 0.04),
    }
}

/// The least gap of the contact points of a pair is the distance of the surfaces, or the negative of their
/// depth of penetration.
#[test]
fn least_gap_is_the_signed_distance() {
    let (m, mut random) = (Stone {}, Random(7));
    let mut overlapping = 0;
    for k in 0..400 {
        let body = k % 5;
        let (turn, reach) = (random.random_rotation(), if k % 3 == 0 { 0.12 } else { 0.3 });
        let place = random.random_point() * reach;
        let (points, radius) = fixed_body_points_and_radius(body);
        let fixed = points_in_pose(&points, &UnitQuaternion::identity(), Point::zeros());
        let wanted = signed_distance(&points_in_pose(&STONE, &turn, place), &fixed) - radius;
        let (_, found) = contact_with_least_gap(&m, body, &configuration(body, place, &turn));
        assert!((found - wanted).abs() < 1e-9, "{body}: {found} {wanted}");
        overlapping += usize::from(wanted < 0.0);
    }
    assert!(overlapping > 40, "{overlapping}");
}

/// Along straight paths that rotate the stone, the least gap changes at most as far as its points move, and
/// grows at the normal rate of its contact point.
#[test]
fn gaps_are_continuous_and_change_at_their_rates() {
    let (m, mut random) = (Stone {}, Random(11));
    let mut compared = 0;
    for k in 0..30 {
        let body = k % 5;
        let (turn, place) = (random.random_rotation(), random.random_point() * 0.2);
        let mut v = SVector::<f64, 6>::zeros();
        v.iter_mut().for_each(|v| *v = random.next_random_number());
        let (q, h) = (configuration(body, place, &turn), 1e-5);
        let speed = v.fixed_rows::<3>(0).norm() + 0.13 * v.fixed_rows::<3>(3).norm();
        let mut before = contact_with_least_gap(&m, body, &q).1;
        for step in 1..40 {
            let configuration_at_time = |t: f64| m.integrate(&q, &(v * t));
            let t = f64::from(step) * 5e-3;
            let (contact, gap) = contact_with_least_gap(&m, body, &configuration_at_time(t));
            assert!((gap - before).abs() <= 1.2 * speed * 5e-3, "{body}: {gap} {before}");
            before = gap;
            let [low, high] = [-h, h]
                .map(|h| contact_with_least_gap(&m, body, &m.integrate(&configuration_at_time(t), &(v * h))));
            // Where the nearest features change, the rate has a corner.
            let difference = (high.1 - low.1) / (2.0 * h);
            let is_smooth = ((high.1 - gap) - (gap - low.1)).abs() < 1e-3 * h;
            if is_smooth && low.0 == contact && high.0 == contact {
                let rate = m.contact_rates(&configuration_at_time(t), &v)[Stone::CONTACT_ROWS[contact].first];
                assert!((rate - difference).abs() < 1e-5, "{body}: {rate} {difference}");
                compared += 1;
            }
        }
    }
    assert!(compared > 700, "{compared}");
}

/// Normals are unit vectors, and tangents are perpendicular to them: a translation of the stone has contact
/// velocities of the same magnitude.
#[test]
fn normals_and_tangents_are_orthonormal() {
    let (m, mut random) = (Stone {}, Random(13));
    for k in 0..100 {
        let q = configuration(k % 5, random.random_point() * 0.25, &random.random_rotation());
        let g = m.contact_jacobian(&q);
        for rows in Stone::CONTACT_ROWS {
            for i in 0..rows.count {
                for j in 0..=i {
                    let contact_jacobian_row =
                        |k: usize| g.row(rows.first + k).fixed_columns::<3>(0).into_owned();
                    let wanted = if i == j { 1.0 } else { 0.0 };
                    assert!(
                        (contact_jacobian_row(i).dot(&contact_jacobian_row(j)) - wanted).abs() < 1e-12,
                        "{i} {j}"
                    );
                }
            }
        }
    }
}
