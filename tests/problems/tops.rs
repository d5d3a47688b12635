//! Checks of tops and of rigid bodies in free flight.

use linkwork::mechanism;
use linkwork::nalgebra::{SVector, Vector3, Vector6};
use support::compare::assert_close;
use support::simulate::state_after_duration;
use support::table::Record;

/// Heavy top of the benchmark by Brüls, Cardona and Arnold.
#[mechanism(gravity = -9.81 * z)]
struct HeavyTop {
    #[body(mass = 15, com = y, inertia = diagonal(0.234375, 0.46875, 0.234375))]
    top: Body,
    #[joint(ground -> top)]
    tip: Ball,
}

/// Checks that two unit quaternions are the same rotation. `actual` has the components x y z w, the expected
/// one w x y z.
#[track_caller]
fn assert_same_rotation(what: &str, actual: &[f64], [w, x, y, z]: [f64; 4], tolerance: f64) {
    let expected = [x, y, z, w];
    let dot: f64 = actual.iter().zip(&expected).map(|(a, b)| a * b).sum();
    let actual: Vec<f64> = actual.iter().map(|a| a * dot.signum()).collect();
    assert_close(what, &actual, &expected, tolerance);
}

#[test]
fn heavy_top_agrees_with_the_reference() {
    let table = Record::load("problems/heavy_top.json");
    let rows = table.rows_with_key::<11>("trajectory");
    let start = rows[0];
    let (mut q, mut v) = (HeavyTop {}.neutral(), SVector::from([start[5], start[6], start[7]]));

    // Euler's equations about the fixed point.
    let about_tip = Vector3::new(0.234375 + 15.0, 0.46875, 0.234375 + 15.0);
    let weight = Vector3::y().cross(&Vector3::new(0.0, 0.0, -15.0 * 9.81));
    let expected = (weight - v.cross(&about_tip.component_mul(&v))).component_div(&about_tip);
    let acceleration = HeavyTop {}.forward_dynamics(&q, &v, &SVector::zeros());
    assert_close("initial acceleration", acceleration.as_slice(), expected.as_slice(), 1e-13);

    for pair in rows.windows(2) {
        let [t, qw, qx, qy, qz, wx, wy, wz, x, y, z] = pair[1];
        (q, v) = state_after_duration(&HeavyTop {}, &q, &v, t - pair[0][0]);
        assert_same_rotation(&format!("orientation at {t} s"), q.as_slice(), [qw, qx, qy, qz], 1e-7);
        assert_close(format!("angular velocity at {t} s"), v.as_slice(), &[wx, wy, wz], 1e-6);
        let center = HeavyTop {}.center_of_mass(&q);
        assert_close(format!("centre of mass at {t} s"), center.as_slice(), &[x, y, z], 1e-7);
        let energy = HeavyTop {}.kinetic_energy(&q, &v) + HeavyTop {}.potential_energy(&q);
        assert_close(format!("energy at {t} s"), &[energy], &[table.number_with_key("energy")], 1e-9);
    }
}

/// Top in gimbals with Euler angles: precession, nutation and spin.
#[mechanism(gravity = -10 * z)]
struct TopOnGimbals {
    #[body]
    outer: Body,
    #[body]
    inner: Body,
    #[body(mass = 2, com = z, inertia = diagonal(3, 3, 1))]
    rotor: Body,
    #[joint(ground -> outer, about = z)]
    precession: Pin,
    #[joint(outer -> inner, about = x)]
    nutation: Pin,
    #[joint(inner -> rotor, about = z)]
    spin: Pin,
}

#[mechanism(gravity = -10 * z)]
struct TopOnBall {
    #[body(mass = 2, com = z, inertia = diagonal(3, 3, 1))]
    rotor: Body,
    #[joint(ground -> rotor)]
    tip: Ball,
}

/// Steady precession satisfies `I1 Ω² cos θ − I3 ω3 Ω + m g l = 0` with I1 = 5 (about the tip), I3 = 1, m g l
/// = 20, θ = 0.3, ω3 = 50.
#[test]
fn steady_precession_satisfies_the_textbook_equation() {
    let (i1, i3, mgl, angle, w3) = (5.0, 1.0, 20.0, 0.3_f64, 50.0);
    let root = (i3 * i3 * w3 * w3 - 4.0 * i1 * angle.cos() * mgl).sqrt();
    let fast = (i3 * w3 + root) / (2.0 * i1 * angle.cos());
    let slow = mgl / (i1 * angle.cos() * fast);
    assert_close("roots", &[slow, fast], &[0.416_578_700_573_935, 10.050_937_314_806_921], 1e-15);

    for precession in [slow, fast] {
        let spin = w3 - precession * angle.cos();
        let (q, v) = (Vector3::new(0.7, angle, 0.2), Vector3::new(precession, 0.0, spin));
        let acceleration = TopOnGimbals {}.forward_dynamics(&q, &v, &SVector::zeros());
        // Terms of the order of I3 ω3 Ω cancel.
        let rounding = 1e-13 * i3 * w3 * precession.max(1.0) / (i1 * angle.sin());
        assert_close("Euler's angles", acceleration.as_slice(), &[0.0; 3], rounding);

        // The rotation of the body about its axis is faster than the component of its angular velocity, by
        // the spin.
        let axis = Vector3::x() * angle;
        let orientation = linkwork::nalgebra::UnitQuaternion::from_scaled_axis(axis);
        let q = SVector::from_column_slice(orientation.coords.as_slice());
        let v = Vector3::new(0.0, precession * angle.sin(), w3);
        let acceleration = TopOnBall {}.forward_dynamics(&q, &v, &SVector::zeros());
        let expected = [precession * angle.sin() * spin, 0.0, 0.0];
        assert_close("angular velocity", acceleration.as_slice(), &expected, 1e-13);
    }
}

/// Body on a ball joint at its centre of mass.
#[mechanism]
struct RigidBody {
    #[body(mass = 1, inertia = diagonal(1, 2, 3))]
    racket: Body,
    #[joint(ground -> racket)]
    center: Ball,
}

/// Checks the unstable rotation of a free rigid body about its intermediate axis (Dzhanibekov effect) against
/// a reference trajectory.
#[test]
fn rotation_about_the_intermediate_axis_is_unstable() {
    let table = Record::load("problems/dzhanibekov.json");
    let (mut time, mut q, mut v) = (0.0, RigidBody {}.neutral(), Vector3::new(0.01, 3.0, 0.01));
    for [t, qw, qx, qy, qz, wx, wy, wz] in table.rows_with_key("trajectory") {
        (q, v) = state_after_duration(&RigidBody {}, &q, &v, t - time);
        time = t;
        assert_same_rotation(&format!("orientation at {t} s"), q.as_slice(), [qw, qx, qy, qz], 1e-9);
        assert_close(format!("angular velocity at {t} s"), v.as_slice(), &[wx, wy, wz], 1e-9);
    }
    let start = Vector3::new(0.01, 3.0, 0.01);
    let (_, v) =
        state_after_duration(&RigidBody {}, &RigidBody {}.neutral(), &start, table.number_with_key("period"));
    assert_close("after one period", v.as_slice(), start.as_slice(), 1e-9);
}

/// Body thrown into the air: its centre of mass moves on a parabola, and its angular momentum is constant.
#[mechanism(gravity = -9.81 * z)]
struct ThrownBody {
    #[body(mass = 1.5, com = [0.1, -0.2, 0.3], inertia = diagonal(0.2, 0.3, 0.4))]
    hammer: Body,
    #[joint(ground -> hammer)]
    flight: Free,
}

#[test]
fn centre_of_mass_of_a_thrown_body_follows_a_parabola() {
    let q = ThrownBody {}.neutral();
    let v = Vector6::new(3.0, 1.0, 4.0, 1.0, 5.0, -2.0);
    let (center, momentum) = (ThrownBody {}.center_of_mass(&q), ThrownBody {}.momentum(&q, &v));
    let weight = Vector3::new(0.0, 0.0, -9.81);
    for t in [0.1, 0.7, 2.0] {
        let (q, v) = state_after_duration(&ThrownBody {}, &q, &v, t);
        let velocity = momentum.fixed_rows::<3>(0) / 1.5;
        let expected = center + velocity * t + weight * t * t / 2.0;
        assert_close(
            "centre of mass",
            ThrownBody {}.center_of_mass(&q).as_slice(),
            expected.as_slice(),
            1e-11,
        );
        let mut expected = momentum;
        expected[2] -= 1.5 * 9.81 * t;
        assert_close("momentum", ThrownBody {}.momentum(&q, &v).as_slice(), expected.as_slice(), 1e-11);
    }
}
