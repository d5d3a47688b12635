//! The hull of the corners of a box behaves like the box.

use crate::shapes::{Random, box_corners, points_in_pose, signed_distance};
use linkwork::nalgebra::UnitQuaternion;
use linkwork::prelude::*;

/// Declares two blocks, of which the lower one is on a slope.
macro_rules! two_blocks {
    ($name:ident, $($upper:tt)*) => {
        #[mechanism(gravity = -9.81 * (cos(tilt) * z - sin(tilt) * x))]
        struct $name {
            tilt: f64,
            #[body(mass = 1, inertia = cuboid(1, 0.2, 0.2, 0.1))]
            low: Body,
            #[joint(ground -> low)]
            below: Free,
            #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.05))]
            high: Body,
            #[joint(ground -> high)]
            above: Free,
            #[contact($($upper)*, friction = 0.4)]
            seat: Contact,
            #[contact(low.cuboid(0.2, 0.2, 0.1), ground.plane(z), friction = 0.8)]
            floor: Contact,
        }
    };
}
two_blocks!(Boxes, high.cuboid(0.3, 0.2, 0.05), low.cuboid(0.2, 0.2, 0.1));
two_blocks!(
    Hulls,
    high.at([0.15, 0, 0]).hull([
        [0, 0.1, 0.025],
        [0, 0.1, -0.025],
        [0, -0.1, 0.025],
        [0, -0.1, -0.025],
        [-0.1, 0.02, 0.01],
        [-0.3, 0.1, 0.025],
        [-0.3, 0.1, -0.025],
        [-0.3, -0.1, 0.025],
        [-0.3, -0.1, -0.025]
    ]),
    low.hull([
        [0.1, 0.1, 0.05],
        [0.1, 0.1, -0.05],
        [0.1, -0.1, 0.05],
        [0.1, -0.1, -0.05],
        [-0.1, 0.1, 0.05],
        [-0.1, 0.1, -0.05],
        [-0.1, -0.1, 0.05],
        [-0.1, -0.1, -0.05]
    ])
);
two_blocks!(
    BoxUnderHull,
    low.cuboid(0.2, 0.2, 0.1),
    high.hull([
        [0.15, 0.1, 0.025],
        [0.15, 0.1, -0.025],
        [0.15, -0.1, 0.025],
        [0.15, -0.1, -0.025],
        [-0.15, 0.1, 0.025],
        [-0.15, 0.1, -0.025],
        [-0.15, -0.1, 0.025],
        [-0.15, -0.1, -0.025]
    ])
);

/// Returns the configuration with the lower block on the floor.
fn configuration(place: [f64; 3], turn: UnitQuaternion<f64>) -> SVector<f64, 14> {
    let (mut q, c) = (Boxes { tilt: 0.0 }.neutral(), turn.coords);
    q[2] = 0.05;
    q.fixed_rows_mut::<3>(7).copy_from_slice(&place);
    q.fixed_rows_mut::<4>(10).copy_from(&c);
    q
}

/// Returns the largest differences of configuration and velocity after a motion.
fn largest_state_differences(tilt: f64, q: SVector<f64, 14>, duration: f64) -> [f64; 2] {
    let v = SVector::<f64, 12>::zeros();
    let step = TimeStepping::step(1e-3);
    let boxes = simulate(&Boxes { tilt }).from(q, v).method(step).duration(duration).finish().unwrap();
    let hulls = simulate(&Hulls { tilt }).from(q, v).method(step).duration(duration).finish().unwrap();
    let mixed = simulate(&BoxUnderHull { tilt }).from(q, v).method(step).duration(duration).finish().unwrap();
    let of_q = (hulls.q - boxes.q).amax().max((mixed.q - boxes.q).amax());
    [of_q, (hulls.v - boxes.v).amax().max((mixed.v - boxes.v).amax())]
}

/// Four points of a face carry the load, instead of the corners of a box twice.
#[test]
fn hull_of_a_box_has_nine_contact_points() {
    let count = |names: &[&str]| names.iter().filter(|name| name.starts_with("seat")).count();
    assert_eq!((count(&Hulls::CONTACTS), count(&Boxes::CONTACTS)), (9, 13));
}

#[test]
fn hulls_of_boxes_have_the_gaps_of_boxes() {
    let (m, mixed, mut random) = (Hulls { tilt: 0.0 }, BoxUnderHull { tilt: 0.0 }, Random(3));
    for k in 0..200 {
        let turn = if k % 4 == 0 { UnitQuaternion::identity() } else { random.random_rotation() };
        let place = random.random_point() * 0.3;
        let q = configuration([place[0], place[1], place[2] + 0.05], turn);
        let wanted = signed_distance(
            &points_in_pose(&box_corners([0.3, 0.2, 0.05]), &turn, place),
            &points_in_pose(&box_corners([0.2, 0.2, 0.1]), &UnitQuaternion::identity(), place * 0.0),
        );
        let found = [m.contact_gaps(&q).rows(0, 9).min(), mixed.contact_gaps(&q).rows(0, 9).min()];
        assert!(found.iter().all(|found| (found - wanted).abs() < 1e-9), "{found:?} {wanted}");
    }
}

/// Stacked, rotated by an angle about the vertical axis, and shifted over an edge.
#[test]
fn stacks_of_hulls_rest_like_boxes() {
    for (yaw, x, y) in [(0.0, 0.0, 0.0), (0.0, 0.05, 0.0), (0.4, 0.03, -0.06), (0.0, 0.1, 0.1)] {
        let q = configuration([x, y, 0.125], UnitQuaternion::from_euler_angles(0.0, 0.0, yaw));
        let difference = largest_state_differences(0.0, q, 0.2);
        assert!(difference.iter().all(|x| *x < 1e-9), "{yaw} {x} {y}: {difference:?}");
    }
}

/// A block slides on a sloped block with acceleration `g (sin α − μ cos α)`, also beyond its edge.
#[test]
fn hulls_slide_like_boxes() {
    let q = configuration([0.0, 0.02, 0.125], UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3));
    let difference = largest_state_differences(0.5, q, 0.15);
    assert!(difference.iter().all(|x| *x < 1e-9), "{difference:?}");
    let run = simulate(&Hulls { tilt: 0.5 }).from(q, [0.0; 12]).method(TimeStepping::step(1e-3));
    let speed = run.duration(0.25).finish().unwrap().v.fixed_rows::<3>(6).norm();
    let wanted = 9.81 * (0.5_f64.sin() - 0.4 * 0.5_f64.cos()) * 0.25;
    assert!((speed - wanted).abs() < 1e-4, "{speed} {wanted}");
}

/// Blocks that fall flat, or on a corner, and tip. Where several contacts close in one step, their impulses
/// are not unique; positions then differ by up to a micrometre.
#[test]
fn hulls_fall_like_boxes() {
    for (place, angles, tolerance) in [
        ([0.02, 0.01, 0.15], [0.0, 0.0, 0.3], 1e-9),
        ([0.08, 0.02, 0.3], [0.5, 0.15, 0.0], 1e-9),
        ([0.02, 0.01, 0.2], [0.1, 0.03, 0.3], 2e-6),
    ] {
        let turn = UnitQuaternion::from_euler_angles(angles[0], angles[1], angles[2]);
        let difference = largest_state_differences(0.0, configuration(place, turn), 0.2);
        assert!(difference.iter().all(|x| *x < tolerance), "{place:?}: {difference:?}");
    }
}
