//! Meshes of files collide with each other as their hulls.

use crate::shapes::{Point, Random, points_in_pose, signed_distance};
use linkwork::nalgebra::UnitQuaternion;
use linkwork::prelude::*;

/// Vertices of the mesh.
const STONE: [[f64; 3]; 8] = [
    [-6.0, -4.0, 0.0],
    [5.0, -5.0, 1.0],
    [7.0, 3.0, -1.0],
    [0.0, 6.0, 0.0],
    [-5.0, 3.0, 2.0],
    [-4.0, -3.0, 7.0],
    [4.0, -2.0, 6.0],
    [1.0, 4.0, 8.0],
];

/// A stone whose collision geometry is a mesh of a URDF file, scaled by 0.01, on the mesh itself.
#[mechanism(urdf = "data/urdf/stone.urdf", base = free, gravity = -9.81 * z)]
struct Stone {
    #[contact(collision(), ground.hull("data/urdf/../mjcf/meshes/stone.obj"), friction = 0.5)]
    rock: Contact,
}

#[test]
fn meshes_have_the_distance_of_their_hulls() {
    let mut random = Random(23);
    let collision = UnitQuaternion::from_euler_angles(0.0, 0.0, core::f64::consts::FRAC_PI_6);
    let small: Vec<[f64; 3]> = STONE
        .iter()
        .map(|p| (collision * (Point::from(*p) * 0.01) + Point::new(0.01, 0.0, 0.0)).into())
        .collect();
    let rock: Vec<Point> = STONE.map(Point::from).into();
    for _ in 0..50 {
        let (turn, direction) = (random.random_rotation(), random.random_point().normalize());
        let place = Point::new(0.5, 0.0, 3.0) + direction * (6.0 + random.next_random_number());
        let wanted = signed_distance(&points_in_pose(&small, &turn, place), &rock);
        let c = turn.coords;
        let q = [place[0], place[1], place[2], c[0], c[1], c[2], c[3]].into();
        let found = Stone {}.contact_gaps(&q).min();
        assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
    }
}
