//! Convex hulls on planes and terrains, and spheres on hulls.

use super::boxes::random_rotation;
use super::laws::Random;
use linkwork::contact;
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;

const G: f64 = 9.81;

#[mechanism(gravity = -9.81 * z)]
struct Block {
    tilt: f64,
    friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.plane(sin(tilt) * x + cos(tilt) * z), friction = friction)]
    slope: Contact,
}

/// Block whose surface is the hull of its corners; two more points are inside and on an edge of the hull.
#[mechanism(gravity = -9.81 * z)]
struct BlockHull {
    tilt: f64,
    friction: f64,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    pose: Free,
    #[contact(
        block.at([0.1, 0, 0]).hull([
            [0.05, 0.1, 0.05], [0.05, 0.1, -0.05], [0.05, -0.1, 0.05], [0.05, -0.1, -0.05], [0, 0, 0.01],
            [-0.25, 0.1, 0.05], [-0.25, 0.1, -0.05], [-0.25, -0.1, 0.05], [-0.25, -0.1, -0.05],
            [-0.1, 0.1, 0.05]
        ]),
        ground.plane(sin(tilt) * x + cos(tilt) * z),
        friction = friction
    )]
    slope: Contact,
}

/// Returns the configuration of a block with a face on the slope.
fn configuration_of_block_on_slope(tilt: f64) -> [f64; 7] {
    let (sine, cosine) = (tilt / 2.0).sin_cos();
    [0.05 * tilt.sin(), 0.0, 0.05 * tilt.cos(), 0.0, sine, 0.0, cosine]
}

/// A block tumbles down a slope in the same way as the hull of its corners.
#[test]
fn hull_of_a_box_tumbles_like_the_box() {
    assert_eq!(BlockHull::CONTACTS.len(), 8);
    let (tilt, friction) = (0.3, 0.4);
    let turn = UnitQuaternion::from_euler_angles(0.5, -0.3, 0.2).coords;
    let (q, v) = ([0.0, 0.0, 0.3, turn[0], turn[1], turn[2], turn[3]], [0.5, 0.1, 0.0, 1.0, -2.0, 0.5]);
    let (hull, block) = (BlockHull { tilt, friction }, Block { tilt, friction });
    let hull = simulate(&hull).from(q, v).method(TimeStepping::step(1e-3)).duration(0.5).finish().unwrap();
    let block = simulate(&block).from(q, v).method(TimeStepping::step(1e-3)).duration(0.5).finish().unwrap();
    assert!((hull.q - block.q).amax() < 1e-8 && (hull.v - block.v).amax() < 1e-6, "{hull:?} {block:?}");
    assert!((block.q - SVector::from(q)).amax() > 0.1);
}

/// A hull slides down a slope with `g (sin α − μ cos α)`.
#[test]
fn hull_slides_down_a_slope() {
    let (tilt, friction, t) = (0.5_f64, 0.3, 0.4);
    let m = BlockHull { tilt, friction };
    let run = simulate(&m).from(configuration_of_block_on_slope(tilt), [0.0; 6]);
    let end = run.method(TimeStepping::step(1e-3)).duration(t).finish().unwrap();
    let path = 0.5 * G * (tilt.sin() - friction * tilt.cos()) * t * t;
    assert!((end.q[0] - 0.05 * tilt.sin() - path * tilt.cos()).abs() < 1e-6, "{}", end.q[0]);
    assert!((end.v.fixed_rows::<3>(0).norm() - 2.0 * path / t).abs() < 1e-8);
}

/// Hexagonal prism with its centre of mass away from its axis.
#[mechanism(gravity = -9.81 * z)]
struct Nut {
    radius: f64,
    height: f64,
    #[body(mass = 2, com = [radius / 8, radius / 5, height / 2], inertia = cylinder(2, radius, height, z))]
    nut: Body,
    #[joint(ground -> nut)]
    pose: Free,
    #[contact(
        nut.hull([
            [radius, 0, 0], [radius / 2, sqrt(3) / 2 * radius, 0], [-radius / 2, sqrt(3) / 2 * radius, 0],
            [-radius, 0, 0], [-radius / 2, -sqrt(3) / 2 * radius, 0], [radius / 2, -sqrt(3) / 2 * radius, 0],
            [radius, 0, height], [radius / 2, sqrt(3) / 2 * radius, height],
            [-radius / 2, sqrt(3) / 2 * radius, height], [-radius, 0, height],
            [-radius / 2, -sqrt(3) / 2 * radius, height], [radius / 2, -sqrt(3) / 2 * radius, height]
        ]),
        ground.plane(z),
        friction = 0.5
    )]
    floor: Contact,
}

#[mechanism(gravity = -9.81 * z)]
struct Tripod {
    #[body(mass = 3, com = [0.06, 0.06, 0.08], inertia = sphere(3, 0.1))]
    tripod: Body,
    #[joint(ground -> tripod)]
    pose: Free,
    #[contact(
        tripod.hull([[0, 0, 0], [0.3, 0, 0], [0, 0.2, 0], [0.05, 0.05, 0.25]]),
        ground.plane(z),
        friction = 0.5
    )]
    floor: Contact,
}

/// At rest the normal forces of a prism equal its weight and balance its moment. Those of a tetrahedron are
/// determined: they are proportional to the barycentric coordinates of the centre of mass.
#[test]
fn hull_contact_forces_balance_its_weight() {
    let m = Nut { radius: 0.1, height: 0.08 };
    let q = SVector::from([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let found = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
    let normal_force = |k: usize| found[Nut::CONTACT_ROWS[k].first];
    let weight = 2.0 * G;
    let total: f64 = (0..6).map(normal_force).sum();
    let moment = (0..6).fold([0.0; 2], |sum, k| {
        let angle = k as f64 * core::f64::consts::FRAC_PI_3;
        [sum[0] + 0.1 * angle.cos() * normal_force(k), sum[1] + 0.1 * angle.sin() * normal_force(k)]
    });
    assert!((total - weight).abs() < 1e-6 && (6..12).all(|k| normal_force(k) == 0.0), "{found}");
    assert!(
        (moment[0] - 0.0125 * weight).abs() < 1e-6 && (moment[1] - 0.02 * weight).abs() < 1e-6,
        "{moment:?}"
    );
    let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(5e-3)).duration(0.5);
    assert!((run.finish().unwrap().q - q).amax() < 1e-10);

    let found = contact::acting(&Tripod {}, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
    let mut shares: Vec<f64> = Tripod::CONTACT_ROWS.iter().map(|row| found[row.first] / (3.0 * G)).collect();
    shares.sort_by(f64::total_cmp);
    let expected = [0.0, 0.2, 0.3, 0.5];
    assert!(shares.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-7), "{shares:?}");
}

#[mechanism(gravity = -9.81 * z)]
struct BallAndBlock {
    #[body(mass = 1, inertia = sphere(1, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    above: Free,
    #[body(mass = 2, inertia = cuboid(2, 0.3, 0.2, 0.1))]
    block: Body,
    #[joint(ground -> block)]
    below: Free,
    #[contact(ball.sphere(0.05), block.cuboid(0.3, 0.2, 0.1))]
    cuboid: Contact,
    #[contact(
        block.hull([
            [0.15, 0.1, 0.05], [0.15, 0.1, -0.05], [0.15, -0.1, 0.05], [0.15, -0.1, -0.05],
            [-0.15, 0.1, 0.05], [-0.15, 0.1, -0.05], [-0.15, -0.1, 0.05], [-0.15, -0.1, -0.05]
        ]),
        ball.sphere(0.05)
    )]
    hull: Contact,
    #[contact(block.cuboid(0.3, 0.2, 0.1), ground.terrain(0.1 * sin(3 * u) * cos(2 * w)))]
    hills: Contact,
    #[contact(
        block.hull([
            [0.15, 0.1, 0.05], [0.15, 0.1, -0.05], [0.15, -0.1, 0.05], [0.15, -0.1, -0.05],
            [-0.15, 0.1, 0.05], [-0.15, 0.1, -0.05], [-0.15, -0.1, 0.05], [-0.15, -0.1, -0.05]
        ]),
        ground.terrain(0.1 * sin(3 * u) * cos(2 * w))
    )]
    hull_on_hills: Contact,
}

/// The distances of a ball and of a terrain from a hull are those from the box with the same corners. If the
/// centre of the ball is inside of the hull, the distance is the depth below the nearest face.
#[test]
fn hull_distances_equal_box_distances() {
    let (m, mut random) = (BallAndBlock {}, Random(5));
    let sorted_gaps = |gaps: &[f64]| {
        let mut gaps = gaps.to_vec();
        gaps.sort_by(f64::total_cmp);
        gaps
    };
    for _ in 0..50 {
        let (ball, block, turn) = (
            random.random_vector::<3>(1.0).normalize() * 0.5,
            random.random_vector::<3>(0.2),
            random_rotation(&mut random).coords,
        );
        let ball = ball * (1.0 + random.next() * 0.5);
        let q: SVector<f64, 14> = [
            block[0] + ball[0],
            block[1] + ball[1],
            block[2] + ball[2],
            0.0,
            0.0,
            0.0,
            1.0,
            block[0],
            block[1],
            block[2],
            turn[0],
            turn[1],
            turn[2],
            turn[3],
        ]
        .into();
        let v = random.random_vector::<12>(1.0);
        let (gaps, rates) = (m.contact_gaps(&q), m.contact_rates(&q, &v));
        assert!((gaps[0] - gaps[1]).abs() < 1e-12, "{gaps}");
        assert!((rates[0] - rates[1]).abs() < 1e-10, "{rates}");
        let (boxes, hulls) = (sorted_gaps(&gaps.as_slice()[2..10]), sorted_gaps(&gaps.as_slice()[10..18]));
        assert!(boxes.iter().zip(&hulls).all(|(a, b)| (a - b).abs() < 1e-12), "{gaps}");
    }
    let inside =
        m.contact_gaps(&[0.0, 0.08, 0.01, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0].into());
    assert!((inside[1] + 0.02 + 0.05).abs() < 1e-12, "{}", inside[1]);
}

#[mechanism(gravity = -9.81 * z)]
struct BallOnOctahedron {
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(
        ball.sphere(0.1), ground.hull([x, -x, y, -y, z, -z]), friction = 0.6
    )]
    rock: Contact,
}

/// The distance of a ball from an octahedron is its distance from a face, an edge or a vertex. On a face it
/// rolls with `5/7 g sin α`.
#[test]
fn ball_rolls_on_a_face_of_an_octahedron() {
    let m = BallOnOctahedron {};
    let gap_at_position = |p: [f64; 3]| m.contact_gaps(&[p[0], p[1], p[2], 0.0, 0.0, 0.0, 1.0].into())[0];
    assert!((gap_at_position([1.0; 3]) - (2.0 / 3_f64.sqrt() - 0.1)).abs() < 1e-12);
    assert!((gap_at_position([0.0, 1.0, -1.0]) - (0.5 * 2_f64.sqrt() - 0.1)).abs() < 1e-12);
    assert!(
        (gap_at_position([0.1, -0.2, 3.0]) - (Vector3::<f64>::new(0.1, -0.2, 2.0).norm() - 0.1)).abs()
            < 1e-12
    );
    let (normal, down) = (Vector3::repeat(1.0).normalize(), Vector3::new(1.0, 1.0, -2.0).normalize());
    let start = Vector3::repeat(1.0 / 3.0) + normal * 0.1;
    let q = [start[0], start[1], start[2], 0.0, 0.0, 0.0, 1.0];
    let end =
        simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(1e-3)).duration(0.25).finish().unwrap();
    let moved = end.q.fixed_rows::<3>(0) - start;
    let path = 0.5 * 5.0 / 7.0 * G * (2_f64 / 3.0).sqrt() * 0.25 * 0.25;
    assert!((moved - down * path).norm() < 1e-6, "{moved} {path}");
}

#[mechanism(mjcf = "data/mjcf/stone.xml", contacts = file)]
struct Stones;

#[mechanism(urdf = "data/urdf/stone.urdf", base = free, gravity = -9.81 * z)]
struct Stone {
    #[contact(collision(), ground.plane(z), friction = 0.8)]
    floor: Contact,
    #[contact(stone.at([0.01, 0, 0]).hull("data/urdf/../mjcf/meshes/stone.obj"), ground.plane(z))]
    large: Contact,
}

/// Meshes of files collide as their hulls. Bodies come to rest as in MuJoCo 4.0.0, whose soft contacts sink
/// in by 0.2 mm: the vertical axis relative to the body, and the height of its origin.
#[test]
fn meshes_come_to_rest_as_in_mujoco() {
    // Eight and six vertices on the plane; seven points of a triangle and a rectangle, and one of edges.
    assert_eq!((Stones::CONTACTS.len(), Stones::CONTACTS[0]), (8 + 6 + 8, "stone_geom0_contact.0"));
    for (axis, angle, up, height) in [
        ([1.0, 0.0, 0.0], 0.2, [0.13106, -0.00145, 0.99137], 0.00259),
        ([1.0, 1.0, 0.0], 2.0, [-0.56129, 0.63420, -0.53174], 0.06077),
        ([0.0, 1.0, 0.0], -1.6, [0.78939, -0.00502, -0.61387], 0.05023),
    ] {
        let turn = UnitQuaternion::from_scaled_axis(Vector3::from(axis).normalize() * angle).coords;
        let wedge = UnitQuaternion::from_scaled_axis(Vector3::new(1.0, 2.0, 0.0).normalize() * 0.25).coords;
        let mut q = Stones.neutral();
        q.fixed_rows_mut::<3>(0).copy_from_slice(&[0.0, 0.0, 0.09]);
        q.fixed_rows_mut::<4>(3).copy_from(&turn);
        q.fixed_rows_mut::<3>(7).copy_from_slice(&[1.0, 0.0, 0.09]);
        q.fixed_rows_mut::<4>(10).copy_from(&wedge);
        let run = simulate(&Stones).from(q, [0.0; 12]).method(TimeStepping::step(2e-3)).duration(2.5);
        let end = run.finish().unwrap();
        let upright_direction = |k: usize| {
            let turn = UnitQuaternion::new_normalize(linkwork::nalgebra::Quaternion::from(
                end.q.fixed_rows::<4>(k).into_owned(),
            ));
            turn.inverse() * Vector3::z()
        };
        assert!(end.v.amax() < 1e-6, "{}", end.v);
        assert!((upright_direction(3) - Vector3::from(up)).amax() < 3e-3, "{} {up:?}", upright_direction(3));
        assert!((end.q[2] - height).abs() < 4e-4, "{} {height}", end.q[2]);
        assert!((upright_direction(10) - Vector3::z()).amax() < 1e-6 && end.q[9].abs() < 1e-6, "{}", end.q);
    }
}

/// The vertices of a mesh are those of its file, scaled and placed by the URDF file.
#[test]
fn mesh_vertices_are_scaled_and_placed_by_the_urdf() {
    const VERTICES: [[f64; 3]; 8] = [
        [-6.0, -4.0, 0.0],
        [5.0, -5.0, 1.0],
        [7.0, 3.0, -1.0],
        [0.0, 6.0, 0.0],
        [-5.0, 3.0, 2.0],
        [-4.0, -3.0, 7.0],
        [4.0, -2.0, 6.0],
        [1.0, 4.0, 8.0],
    ];
    assert_eq!(Stone::CONTACTS.len(), 16);
    let turn = UnitQuaternion::from_euler_angles(0.4, 0.8, -1.1);
    let c = turn.coords;
    let gaps = Stone {}.contact_gaps(&[0.0, 0.0, 0.5, c[0], c[1], c[2], c[3]].into());
    let placed = UnitQuaternion::from_euler_angles(0.0, 0.0, core::f64::consts::FRAC_PI_6);
    let height_of_vertex = |p: Vector3<f64>| 0.5 + (turn * (Vector3::new(0.01, 0.0, 0.0) + p))[2];
    let check_gaps_of_vertices =
        |range: core::ops::Range<usize>, vertex: &dyn Fn([f64; 3]) -> Vector3<f64>| {
            let mut expected = VERTICES.map(|p| height_of_vertex(vertex(p)));
            let mut found = gaps.as_slice()[range].to_vec();
            expected.sort_by(f64::total_cmp);
            found.sort_by(f64::total_cmp);
            assert!(expected.iter().zip(&found).all(|(a, b)| (a - b).abs() < 1e-9), "{expected:?} {found:?}");
        };
    check_gaps_of_vertices(0..8, &|p| placed * (Vector3::from(p) * 0.01));
    check_gaps_of_vertices(8..16, &|p| Vector3::from(p));
}
