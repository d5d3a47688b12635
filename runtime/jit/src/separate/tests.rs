//! Comparison of separate contacts with contacts of one mechanism.

use super::evaluated::BodyPlacement;
use crate::load::{Loader, declare};
use crate::padded::PaddedContacts;
use linkwork::contact::Rows;
use linkwork::nalgebra::{SMatrix, SVector};
use linkwork::{Contacts, Mechanism};

/// The rotation matrix of the quaternion of a rotation matrix is that matrix, for rotations by large
/// angles about all axes as well.
#[test]
fn quaternion_of_a_rotation_has_its_matrix() {
    for k in 0..200 {
        let angle = 0.1 * f64::from(k);
        let axis = [(0.7 * angle).sin(), (1.3 * angle).cos(), (0.4 * angle).sin() + 0.1];
        let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        let [x, y, z] = axis.map(|x| x / norm * (angle / 2.0).sin());
        let w = (angle / 2.0).cos();
        // Column by column.
        let rotation = [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y + w * z),
            2.0 * (x * z - w * y),
            2.0 * (x * y - w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z + w * x),
            2.0 * (x * z + w * y),
            2.0 * (y * z - w * x),
            1.0 - 2.0 * (x * x + y * y),
        ];
        let placement = BodyPlacement { rotation, position: [1.0, 2.0, 3.0] };
        let q = placement.floating_configuration();
        let dot = q[3] * x + q[4] * y + q[5] * z + q[6] * w;
        assert!((dot.abs() - 1.0).abs() < 1e-14 && q[..3] == [1.0, 2.0, 3.0], "{k}: {q:?}");
    }
}

/// Arm that carries surfaces, floating bodies of all convex forms, a body that moves as prescribed, and the
/// ground, with parameters for sizes and coefficients.
const SCENE: &str = "#[mechanism(gravity = -9.81 * z)]
struct Scene {
    radius: f64,
    grip: f64,
    #[body(mass = 1, inertia = cuboid(1, 0.1, 0.2, 0.3))]
    upper: Body,
    #[joint(ground.at([0, 0, 1]) -> upper, about = y)]
    shoulder: Pin,
    #[body(mass = 1, inertia = cuboid(1, 0.1, 0.2, 0.3))]
    lower: Body,
    #[joint(upper.at([0.2, 0.1, -0.4]).rotated(z(0.3)) -> lower, about = x)]
    elbow: Pin,
    #[body(mass = 1, inertia = sphere(1, 0.1))]
    ball: Body,
    #[joint(ground -> ball)]
    ball_pose: Free,
    #[body(mass = 2, inertia = cuboid(2, 0.2, 0.3, 0.4))]
    brick: Body,
    #[joint(ground -> brick)]
    brick_pose: Free,
    #[body(mass = 2, inertia = sphere(2, 0.1))]
    stone: Body,
    #[joint(ground -> stone)]
    stone_pose: Free,
    #[contact(ball.sphere(radius), ground.plane(z), friction = grip)]
    ball_on_floor: Contact,
    #[contact(
        brick.at([0.01, 0, 0.02]).cuboid(0.2, 0.3, 0.4),
        ground.plane(z),
        friction = 0.3,
        restitution = 0.2
    )]
    brick_on_floor: Contact,
    #[contact(lower.at([0, 0, -0.3]).capsule(0.05, 0.4, z), brick.cuboid(0.2, 0.3, 0.4), friction = 0.4)]
    arm_on_brick: Contact,
    #[contact(
        upper.cuboid(0.1, 0.2, 0.3),
        brick.cuboid(0.2, 0.3, 0.4),
        friction = 0.4,
        restitution = poisson(0.1)
    )]
    brick_on_arm: Contact,
    #[contact(
        ball.sphere(radius),
        lower.capsule(0.05, 0.4, z),
        friction = grip,
        torsional = 0.01,
        rolling = 0.002
    )]
    ball_on_arm: Contact,
    #[contact(
        stone.hull([[0.2, 0, 0], [-0.1, 0.2, 0], [-0.1, -0.2, 0], [0, 0, 0.3]]),
        brick.cuboid(0.2, 0.3, 0.4),
        friction = 0.6
    )]
    stone_on_brick: Contact,
    #[contact(stone.cylinder(0.1, 0.3, z), ground.plane(z))]
    stone_on_floor: Contact,
    #[contact(upper.sphere(0.1), lower.sphere(0.1))]
    links: Contact,
}";

/// Gaps, contact velocities, Jacobians and coefficients of separate contacts are those of the same contacts
/// in one mechanism: the first are computed from the placements and velocities of the bodies, the others from
/// the coordinates.
#[test]
fn separate_contacts_are_those_of_one_mechanism() {
    let values = [("radius", 0.15), ("grip", 0.7)];
    let together = declare(SCENE).unwrap().with_parameters(&values).unwrap();
    let apart = Loader::text(SCENE).separate_contacts().load().unwrap().with_parameters(&values).unwrap();
    let contacts = &together.shared.contacts;
    assert!(together.shared.separate.is_empty() && !apart.shared.separate.is_empty());
    assert_eq!(contacts.len(), apart.shared.contacts.len());
    for (one, other) in contacts.iter().zip(&apart.shared.contacts) {
        assert_eq!((&one.name, one.rows[1], one.pressed_by), (&other.name, other.rows[1], other.pressed_by));
    }
    let together = PaddedContacts::<24, 24, 24, 128, 384, _>::new(&together).unwrap();
    let apart = PaddedContacts::<24, 24, 24, 128, 384, _>::new(&apart).unwrap();
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    };
    for _ in 0..20 {
        let dv = SVector::<f64, 24>::from_fn(|k, _| if k < 20 { 0.4 * random() } else { 0.0 });
        let q = together.integrate(&together.neutral(), &dv);
        let v = SVector::<f64, 24>::from_fn(|k, _| if k < 20 { random() } else { 0.0 });
        // All contacts are near.
        let near = apart.with_all_contacts(&q).unwrap();
        assert_eq!(near.contact_tables(), together.contact_tables());
        assert_eq!(near.contact_laws(), together.contact_laws());
        let difference = (near.contact_gaps(0.0, &q) - together.contact_gaps(0.0, &q)).amax();
        assert!(difference < 1e-12, "gaps: {difference:e}");
        let (rates, other_rates) = (near.contact_rates(0.0, &q, &v), together.contact_rates(0.0, &q, &v));
        let (jacobian, other) = (near.contact_jacobian(0.0, &q), together.contact_jacobian(0.0, &q));
        for (k, Rows { first: top, count }) in near.contact_tables().0.into_iter().enumerate() {
            // Tangents are chosen in axes of the nearest common link: they may differ by a rotation, which
            // leaves sums of squares and products.
            // An axis inside of a box has no normal: the gap is then minus the radius.
            if near.contact_gaps(0.0, &q)[k] < -0.04 {
                continue;
            }
            let is_point = near.contact_tables().1[k] == k && count > 0;
            let parts = [top..top + usize::from(is_point), top + usize::from(is_point)..top + count];
            let difference = (rates[top.min(383)] - other_rates[top.min(383)]).abs();
            assert!(!is_point || difference < 1e-12, "gap velocity of {k}: {difference:e}");
            for part in parts {
                let square = |rates: &SVector<f64, 384>| part.clone().map(|i| rates[i].powi(2)).sum::<f64>();
                let difference = square(&rates) - square(&other_rates);
                assert!(difference.abs() < 1e-11, "velocities of {k}: {difference:e}");
                for (a, b) in (0..20).flat_map(|a| (0..=a).map(move |b| (a, b))) {
                    let product =
                        |j: &SMatrix<f64, 384, 24>| part.clone().map(|i| j[(i, a)] * j[(i, b)]).sum::<f64>();
                    let difference = product(&jacobian) - product(&other);
                    assert!(difference.abs() < 1e-11, "Jacobian of {k}: {difference:e}");
                }
            }
        }
        let difference = (jacobian * v - rates).amax();
        assert!(difference < 1e-11, "Jacobian and velocities: {difference:e}");
        for (k, (first, last)) in near.contact_columns().into_iter().enumerate() {
            let Rows { first: top, count } = near.contact_tables().0[k];
            for row in top..top + count {
                assert!((0..24).all(|j| (first..last).contains(&j) || other[(row, j)] == 0.0));
            }
        }
    }
}

/// Functions of separate contacts by name have the gaps, velocities and Jacobian of the contacts.
#[test]
fn functions_of_separate_contacts_have_names() {
    let values = [("radius", 0.15), ("grip", 0.7)];
    let apart = Loader::text(SCENE).separate_contacts().load().unwrap().with_parameters(&values).unwrap();
    let q = apart.initial_configuration().unwrap().as_slice().to_vec();
    let v: Vec<f64> = (0..apart.nv()).map(|k| 0.1 * k as f64 - 0.5).collect();
    let result =
        |name: &str, arguments: &[&[f64]]| apart.evaluate(&apart.function(name).unwrap(), arguments).unwrap();
    let gaps = result("contact_gaps", &[&q]);
    let ball = apart.configuration().iter().position(|one| one.name == "ball_pose.z").unwrap();
    assert!((gaps[0] - (q[ball] - 0.15)).abs() < 1e-15, "{gaps:?}");
    let (rates, jacobian) = (result("contact_rates", &[&q, &v]), result("contact_jacobian", &[&q]));
    let product = |i: usize| (0..v.len()).map(|j| jacobian[j * rates.len() + i] * v[j]).sum::<f64>();
    assert!((0..rates.len()).all(|i| (product(i) - rates[i]).abs() < 1e-12));
}
