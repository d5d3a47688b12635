//! Checks of frames that are declared by angles, and of functions of vectors.

use super::{EXACT, MOTION};
use linkwork::mechanism;
use linkwork::nalgebra::{Matrix3, SMatrix, SVector, Vector1, Vector3};
use std::f64::consts::FRAC_PI_2;
use support::compare::assert_close;
use support::simulate::state_after_duration;
use support::table::Record;

/// Declares a body in a frame with three successive rotations about the named axes, and checks it against the
/// table of sequences.
macro_rules! sequences {
    ($($name:ident $label:literal $one:ident $two:ident $three:ident,)*) => {
        $(
            #[mechanism]
            struct $name {
                first: Coordinate,
                second: Coordinate,
                third: Coordinate,
                #[frame(ground, $one(first), $two(second), $three(third))]
                turned: Frame,
                #[body(mass = 1, inertia = diagonal(1, 2, 2.5), frame = turned)]
                body: Body,
                #[output(omega(turned / ground), resolved_in = turned)]
                rate: Vector,
                #[output(alpha(body / ground / ground), resolved_in = turned)]
                acceleration: Vector,
                #[output(turned.x)]
                x_axis: Vector,
                #[output(turned.y)]
                y_axis: Vector,
                #[output(turned.z)]
                z_axis: Vector,
            }
        )*

        #[test]
        fn euler_angle_sequences_agree_with_their_reference() {
            let table = Record::load("problems/euler_sequences.json");
            let q: Vector3<f64> = table.vector_with_key("angles");
            let v: Vector3<f64> = table.vector_with_key("rates");
            let records = table.records_with_key("sequences");
            $(
                let body = $name {};
                let record = records.iter().find(|r| r.string_with_key("name") == $label).unwrap();
                let matrix: SMatrix<f64, 3, 3> = record.matrix_with_key("matrix");
                let omega: Vector3<f64> = record.vector_with_key("omega");
                let axes = Matrix3::from_columns(&[body.x_axis(&q), body.y_axis(&q), body.z_axis(&q)]);
                assert_close(concat!("axes ", $label), axes.as_slice(), matrix.as_slice(), 1e-14);
                assert_close(concat!("rate ", $label), body.rate(&q, &v).as_slice(), omega.as_slice(), 1e-14);
                let inertia = Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.5));
                let energy = omega.dot(&(inertia * omega)) / 2.0;
                assert_close(concat!("energy ", $label), &[body.kinetic_energy(&q, &v)], &[energy], EXACT);
                // Euler's equations hold for the generalized forces: p = Jᵀ (I α + ω × I ω).
                let a = Vector3::new(0.7, -0.4, 0.2);
                let alpha = body.acceleration(&q, &v, &a);
                let moment = inertia * alpha + omega.cross(&(inertia * omega));
                let forces = body.rate_jacobian(&q, &v).transpose() * moment;
                let actual = body.inverse_dynamics(&q, &v, &a);
                assert_close(concat!("forces ", $label), actual.as_slice(), forces.as_slice(), EXACT);
            )*
            assert_eq!(records.len(), [$($label),*].len());
        }
    };
}
sequences! {
    FrameXyx "xyx" x y x,
    FrameXyz "xyz" x y z,
    FrameXzx "xzx" x z x,
    FrameXzy "xzy" x z y,
    FrameYxy "yxy" y x y,
    FrameYxz "yxz" y x z,
    FrameYzx "yzx" y z x,
    FrameYzy "yzy" y z y,
    FrameZxy "zxy" z x y,
    FrameZxz "zxz" z x z,
    FrameZyx "zyx" z y x,
    FrameZyz "zyz" z y z,
}

/// Heavy top with a fixed tip in Euler angles of a frame, against the same top on a ball joint.
#[mechanism(gravity = -9.81 * z)]
struct TopOnEulerAngleFrame {
    psi: Coordinate,
    theta: Coordinate,
    phi: Coordinate,
    #[frame(ground, z(psi), x(theta), z(phi))]
    turned: Frame,
    #[body(mass = 0.6, com = 0.2 * z, inertia = diagonal(0.02, 0.02, 0.01), frame = turned)]
    top: Body,
    #[output(r(top.at(0.2 * z) / ground))]
    center: Vector,
    #[output(omega(top / ground), resolved_in = top)]
    rate: Vector,
}

#[mechanism(gravity = -9.81 * z)]
struct TopByBall {
    #[body(mass = 0.6, com = 0.2 * z, inertia = diagonal(0.02, 0.02, 0.01))]
    top: Body,
    #[joint(ground -> top)]
    tip: Ball,
    #[output(r(top.at(0.2 * z) / ground))]
    center: Vector,
}

#[test]
fn heavy_top_agrees_in_two_coordinate_charts() {
    let (one, other) = (TopOnEulerAngleFrame {}, TopByBall {});
    let (q, v) = (Vector3::new(0.2, 0.7, -0.1), Vector3::new(0.5, -0.3, 40.0));
    let quaternion_about_axis =
        |axis, angle| linkwork::nalgebra::UnitQuaternion::from_axis_angle(&axis, angle);
    let pose = quaternion_about_axis(Vector3::z_axis(), q[0])
        * quaternion_about_axis(Vector3::x_axis(), q[1])
        * quaternion_about_axis(Vector3::z_axis(), q[2]);
    let rate = one.rate(&q, &v);
    let energies = [one.kinetic_energy(&q, &v), one.potential_energy(&q)];
    let quaternion = SVector::from(pose.into_inner().coords);
    let expected = [other.kinetic_energy(&quaternion, &rate), other.potential_energy(&quaternion)];
    assert_close("energies", &energies, &expected, EXACT);
    let (end, _) = state_after_duration(&one, &q, &v, 1.0);
    let (end_of_other, _) = state_after_duration(&other, &quaternion, &rate, 1.0);
    assert_close("centre", one.center(&end).as_slice(), other.center(&end_of_other).as_slice(), MOTION);
}

#[mechanism]
struct ArmWithVectorFunctions {
    #[body(mass = 1, inertia = diagonal(1, 1, 1))]
    arm: Body,
    #[joint(ground -> arm, about = z)]
    pin: Pin,
    #[define(2 * arm.x + 3 * z)]
    arrow: Vector,
    #[output(angle(x, arm.x))]
    apart: Scalar,
    #[output(angle(x, arm.x, z))]
    directed: Scalar,
    #[output(project(arrow, x + z))]
    shadow: Vector,
    #[output(norm(arrow))]
    size: Scalar,
    #[output(unit(arrow), resolved_in = arm)]
    direction: Vector,
    #[output(rate(pin) * pin + 1 * dot(cross(arm.x, arm.y), z))]
    mixed: Scalar,
    #[output(min(pin, 1) + max(pin, 1))]
    sum: Scalar,
}

#[test]
fn vector_functions_have_their_documented_values() {
    let words = ArmWithVectorFunctions {};
    for angle in [-1.2, 0.4, FRAC_PI_2, 2.0_f64] {
        let (q, v) = (Vector1::new(angle), Vector1::new(0.7));
        assert_close("angle", &[words.apart(&q), words.directed(&q)], &[angle.abs(), angle], EXACT);
        let along = (2.0 * angle.cos() + 3.0) / 2.0;
        assert_close("project", words.shadow(&q).as_slice(), &[along, 0.0, along], EXACT);
        let size = 13.0_f64.sqrt();
        assert_close("norm", &[words.size(&q)], &[size], EXACT);
        assert_close("unit", words.direction(&q).as_slice(), &[2.0 / size, 0.0, 3.0 / size], EXACT);
        assert_close(
            "mixed",
            &[words.mixed(&q, &v), words.sum(&q)],
            &[0.7 * angle + 1.0, angle + 1.0],
            EXACT,
        );
        let slope = words.shadow_jacobian(&q);
        assert_close("Jacobian", slope.as_slice(), &[-angle.sin(), 0.0, -angle.sin()], EXACT);
    }
}
