//! Contacts that refer to the collision geometry of a file's links.

use linkwork::prelude::*;

#[mechanism(urdf = "data/urdf/shapes.urdf", base = free, inputs = none)]
struct RobotWithFileContacts {
    #[contact(hull.collision(), ground.plane(z), friction = 0.5)]
    below: Contact,
    #[contact(ground.plane(-x), wheel.collision())]
    beside: Contact,
    #[contact(arm.collision(), ground.plane(z))]
    reach: Contact,
}

#[mechanism(urdf = "data/urdf/shapes.urdf", base = free, inputs = none)]
struct HandWrittenContacts {
    #[body]
    tilted: Body,
    #[joint(hull.at([0.1, 0, 0.02]).rotated(y(0.3)) -> tilted)]
    glue: Weld,
    #[contact(tilted.cuboid(0.4, 0.2, 0.1), ground.plane(z), friction = 0.5)]
    corners: Contact,
    #[contact(hull.at([-0.2, 0, 0]).sphere(0.08), ground.plane(z), friction = 0.5)]
    ball: Contact,
    #[contact(ground.plane(-x), wheel.cylinder(0.1, 0.04, -y))]
    beside: Contact,
    #[contact(arm.at([0, 0, 0.15]).capsule(0.03, 0.3, z), ground.plane(z))]
    reach: Contact,
}

/// Contacts with the geometry of the file equal the same contacts written by hand, in every configuration of
/// the robot.
#[test]
fn collision_geometry_of_files_equals_declared_contacts() {
    assert_eq!((RobotWithFileContacts::CONTACTS.len(), RobotWithFileContacts::CONTACTS[8]), (19, "below.8"));
    let (file, hand) = (RobotWithFileContacts {}, HandWrittenContacts {});
    let mut q = file.neutral();
    for (k, shift) in [0.3, -0.2, 0.5, 0.4, -0.3, 0.6, 0.2, 1.1, -0.7].into_iter().enumerate() {
        let mut v = SVector::<f64, 8>::zeros();
        v[k % 8] = shift;
        q = file.integrate(&q, &v);
        let rates = SVector::<f64, 8>::from_fn(|i, _| 0.3 * (i as f64) - 0.8);
        assert!((file.contact_gaps(&q) - hand.contact_gaps(&q)).amax() < 1e-12);
        assert!((file.contact_rates(&q, &rates) - hand.contact_rates(&q, &rates)).amax() < 1e-12);
    }
}

#[mechanism(gravity = -9.81 * cos(slope) * z + 9.81 * sin(slope) * x)]
struct Drum {
    slope: f64,
    #[body(mass = 2, inertia = cylinder(2, 0.1, 0.3, z))]
    drum: Body,
    #[joint(ground -> drum)]
    pose: Free,
    #[contact(drum.cylinder(0.1, 0.3, z), ground.plane(z), friction = 0.7)]
    floor: Contact,
}

fn last_sample_of_drum(m: &Drum, q: [f64; 7], h: f64, t: f64) -> Sample<f64, 7, 6, 0> {
    let run = simulate(m).from(q, [0.0; 6]).method(TimeStepping::step(h)).duration(t);
    run.finish().unwrap()
}

/// A drum stands on its face on slopes below the limits of friction and tipping: tan 30° is less than 2/3,
/// the ratio of the diameter to the height, and less than 0.7.
#[test]
fn drum_stands_on_its_face_on_a_slope() {
    for slope in [0.0, 20.0_f64.to_radians(), 30.0_f64.to_radians()] {
        let m = Drum { slope };
        let end = last_sample_of_drum(&m, [0.0, 0.0, 0.15, 0.0, 0.0, 0.0, 1.0], 1e-3, 2.0);
        assert!(
            (end.q - SVector::from([0.0, 0.0, 0.15, 0.0, 0.0, 0.0, 1.0])).amax() < 1e-6,
            "{slope} {end:?}"
        );
    }
    // Beyond 2/3 the drum tips over.
    let end = last_sample_of_drum(
        &Drum { slope: 34.5_f64.to_radians() },
        [0.0, 0.0, 0.15, 0.0, 0.0, 0.0, 1.0],
        1e-3,
        2.0,
    );
    assert!(end.q[2] < 0.12, "{end:?}");
}

/// Checks that a drum rolls on its side with two thirds of the acceleration of frictionless sliding.
#[test]
fn drum_rolls_on_its_side() {
    let m = Drum { slope: 0.2 };
    let turn = core::f64::consts::FRAC_1_SQRT_2;
    let end = last_sample_of_drum(&m, [0.0, 0.0, 0.1, turn, 0.0, 0.0, turn], 1e-3, 1.0);
    let fallen = 9.81 * 0.2_f64.sin() / 3.0;
    assert!((end.q[0] - fallen).abs() < 2e-3 * fallen, "{} {fallen}", end.q[0]);
    let speed = end.v.fixed_rows::<3>(0).norm();
    assert!((speed - 2.0 * fallen).abs() < 1e-3 * fallen && (end.q[2] - 0.1).abs() < 1e-6, "{end:?}");
}

#[mechanism(gravity = -9.81 * z)]
struct BallOnDrum {
    #[body(mass = 1, inertia = sphere(1, 0.05))]
    ball: Body,
    #[joint(ground -> ball)]
    pose: Free,
    #[contact(ball.sphere(0.05), ground.cylinder(0.2, 0.4, z))]
    top: Contact,
}

/// Checks that the distance of a ball from a cylinder with end faces is that from the face, the side or the
/// rim, whichever is nearest.
#[test]
fn ball_to_cylinder_distance_covers_face_side_and_rim() {
    let gap_to_drum =
        |x: f64, y: f64, z: f64| BallOnDrum {}.contact_gaps(&[x, y, z, 0.0, 0.0, 0.0, 1.0].into())[0];
    let rim = (0.1_f64.hypot(0.3) - 0.05, 0.02_f64.hypot(0.01) - 0.05);
    assert!((gap_to_drum(0.1, -0.05, 0.3) - 0.05).abs() < 1e-15);
    assert!((gap_to_drum(0.3, 0.4, -0.1) - 0.25).abs() < 1e-15);
    assert!((gap_to_drum(0.0, -0.3, 0.5) - rim.0).abs() < 1e-15);
    assert!((gap_to_drum(0.22, 0.0, -0.21) - rim.1).abs() < 1e-15);
}
