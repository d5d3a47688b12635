//! Cans that rest on cans and hulls, and roll on them.

use linkwork::contact;
use linkwork::discrete;
use linkwork::nalgebra::UnitQuaternion;
use linkwork::prelude::*;

const G: f64 = 9.81;

/// A can on a can and on a slab with eight corners, which are fixed in the ground at different places.
#[mechanism(gravity = -9.81 * z, derivatives)]
struct Cans {
    friction: f64,
    #[body(mass = 1, inertia = cylinder(1, 0.1, 0.3, y))]
    can: Body,
    #[joint(ground -> can)]
    pose: Free,
    #[contact(can.cylinder(0.1, 0.3, y), ground.cylinder(0.2, 0.4, y), friction = friction)]
    drum: Contact,
    #[contact(
        can.cylinder(0.1, 0.3, y),
        ground.at(3 * x).hull([
            [0.3, 0.3, 0], [0.3, -0.3, 0], [-0.3, 0.3, 0], [-0.3, -0.3, 0],
            [0.2, 0.2, -0.2], [0.2, -0.2, -0.2], [-0.2, 0.2, -0.2], [-0.2, -0.2, -0.2]
        ]),
        friction = friction
    )]
    slab: Contact,
}

fn configuration(place: [f64; 3], rotation: UnitQuaternion<f64>) -> SVector<f64, 7> {
    let c = rotation.coords;
    [place[0], place[1], place[2], c[0], c[1], c[2], c[3]].into()
}

/// Returns the rotation that turns the axis of the can into the z axis.
fn upright_rotation() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(core::f64::consts::FRAC_PI_2, 0.0, 0.0)
}

/// Returns the number of gaps of a contact that are zero, up to rounding errors.
fn zero_gap_count(name: &str, q: &SVector<f64, 7>) -> usize {
    let gaps = Cans { friction: 0.5 }.contact_gaps(q);
    let own = Cans::CONTACTS.iter().zip(gaps.iter());
    own.filter(|(contact, gap)| contact.split('.').next() == Some(name) && gap.abs() < 1e-9).count()
}

/// A can lies along a can and across it, on a slab and beyond its edge.
#[test]
fn numbers_of_contact_points_follow_from_the_geometry() {
    let level = UnitQuaternion::identity();
    let across = UnitQuaternion::from_euler_angles(0.0, 0.0, 1.2);
    let lower = [0.3 * 0.6, 0.0, 0.3 * 0.8];
    assert_eq!(zero_gap_count("drum", &configuration([0.0, 0.0, 0.3], level)), 2);
    assert_eq!(zero_gap_count("drum", &configuration([0.0, 0.1, 0.3], level)), 2);
    assert_eq!(zero_gap_count("drum", &configuration(lower, level)), 2);
    assert_eq!(zero_gap_count("drum", &configuration([0.0, 0.0, 0.3], across)), 1);
    assert_eq!(zero_gap_count("slab", &configuration([3.0, 0.0, 0.1], level)), 2);
    assert_eq!(zero_gap_count("slab", &configuration([3.05, 0.2, 0.1], across)), 2);
    assert!(zero_gap_count("slab", &configuration([3.0, 0.0, 0.15], upright_rotation())) >= 4);
    assert!(zero_gap_count("slab", &configuration([3.25, 0.1, 0.15], upright_rotation())) >= 4);
}

/// Cans stand and lie on the slab without motion, also beyond its edges, and the slab carries their weight.
#[test]
fn cans_rest_on_a_slab() {
    let m = Cans { friction: 0.5 };
    let rotated = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4);
    for q in [
        configuration([3.0, 0.0, 0.15], upright_rotation()),
        configuration([3.27, 0.1, 0.15], upright_rotation()),
        configuration([3.27, 0.27, 0.15], rotated * upright_rotation()),
        configuration([3.0, 0.0, 0.1], UnitQuaternion::identity()),
        configuration([3.0, 0.25, 0.1], UnitQuaternion::identity()),
        configuration([3.1, -0.2, 0.1], rotated),
    ] {
        let forces = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
        let carried: f64 = Cans::CONTACT_ROWS.iter().map(|rows| forces[rows.first]).sum();
        assert!((carried - G).abs() < 1e-6, "{carried}");
        let run = simulate(&m).from(q, [0.0; 6]).method(TimeStepping::step(5e-3)).duration(0.5);
        let moved = (run.finish().unwrap().q - q).amax();
        assert!(moved < 1e-8, "{moved:e} {q}");
    }
}

/// Three cans that stand on each other, shifted.
#[mechanism(gravity = -9.81 * z)]
struct Tower {
    #[body(mass = 1, inertia = cylinder(1, 0.1, 0.2, z))]
    can: [Body; 3],
    #[joint(ground -> can[i])]
    pose: [Free; 3],
    #[contact(can[i + 1].cylinder(0.1, 0.2, z), can[i].cylinder(0.1, 0.2, z), friction = 0.6)]
    seat: [Contact; 2],
    #[contact(can[0].cylinder(0.1, 0.2, z), ground.plane(z), friction = 0.6)]
    floor: Contact,
}

/// A tower of cans stays at rest, and each contact carries the cans above it.
#[test]
fn towers_of_cans_stay_at_rest() {
    let m = Tower {};
    for shift in [0.0, 0.03, 0.05] {
        let mut q = m.neutral();
        for k in 0..3 {
            q[7 * k] = shift * [0.0, 1.0, 0.5][k];
            q[7 * k + 2] = 0.1 + 0.2 * k as f64;
            let rotation = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.3 * k as f64).coords;
            q.fixed_rows_mut::<4>(7 * k + 3).copy_from(&rotation);
        }
        let forces = contact::acting(&m, 0.0, &q, &SVector::zeros(), &SVector::zeros()).unwrap();
        for (name, bodies) in [("seat_0", 2.0), ("seat_1", 1.0)] {
            let rows = Tower::CONTACTS.iter().zip(Tower::CONTACT_ROWS);
            let own = rows.filter(|(contact, _)| contact.split('.').next() == Some(name));
            let carried: f64 = own.map(|(_, rows)| forces[rows.first]).sum();
            assert!((carried - bodies * G).abs() < 1e-5, "{name}: {carried}");
        }
        let run = simulate(&m).from(q, [0.0; 18]).method(TimeStepping::step(5e-3)).duration(0.5);
        let moved = (run.finish().unwrap().q - q).amax();
        assert!(moved < 1e-8, "{shift}: {moved:e}");
    }
}

/// At the top of a fixed can, the normal force on a rolling can is `m (g − v² / L)`: the acceleration of its
/// centre follows from the curvatures of both sides.
#[test]
fn normal_force_of_a_rolling_can_includes_the_curvature() {
    let m = Cans { friction: 1.0 };
    let q = configuration([0.0, 0.0, 0.3], UnitQuaternion::identity());
    let speed = 0.6;
    let v = SVector::from([speed, 0.0, 0.0, 0.0, speed / 0.1, 0.0]);
    let forces = contact::acting(&m, 0.0, &q, &v, &SVector::zeros()).unwrap();
    let normal_force: f64 = Cans::CONTACT_ROWS.iter().map(|rows| forces[rows.first]).sum();
    let expected = G - speed * speed / 0.3;
    assert!((normal_force - expected).abs() < 1e-6, "{normal_force} {expected}");
}

/// The Jacobians of a step are central differences while a can rolls on a can.
#[test]
fn jacobians_of_steps_are_central_differences() {
    let m = Cans { friction: 0.8 };
    let (sine, cosine) = 0.2_f64.sin_cos();
    let q = configuration([0.3 * sine, 0.0, 0.3 * cosine], UnitQuaternion::identity());
    let speed = 0.4;
    let v = SVector::from([speed * cosine, 0.0, -speed * sine, 0.0, speed / 0.1, 0.0]);
    let method = TimeStepping::step(1e-3);
    let found = discrete::transition(&m, &method, 0.0, &q, &v, &SVector::zeros()).unwrap();
    let h = 1e-5;
    for k in 0..6 {
        let mut step = SVector::<f64, 6>::zeros();
        step[k] = h;
        let next =
            |v: SVector<f64, 6>| discrete::transition(&m, &method, 0.0, &q, &v, &SVector::zeros()).unwrap();
        let difference = (next(v + step).v - next(v - step).v) / (2.0 * h);
        let column = found.v_by_v.column(k);
        assert!((column - difference).amax() < 1e-3, "{k}: {column} {difference}");
    }
}
