use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::nalgebra::{UnitQuaternion, Vector3};
use linkwork::prelude::*;
use linkwork_models::Aircraft;

/// Parameters of the tested aircraft: a light aircraft with linear aerodynamics.
const A: Aircraft = Aircraft {
    g: 9.81,
    mass: 1050.0,
    ixx: 1290.0,
    iyy: 1830.0,
    izz: 2670.0,
    ixz: -40.0,
    density: 1.225,
    area: 16.2,
    chord: 1.5,
    cl_0: 0.3,
    cl_alpha: 4.6,
    cd_0: 0.03,
    cd_induced: 0.05,
    cm_0: 0.02,
    cm_alpha: -0.9,
    cm_rate: -12.0,
    cm_elevator: -1.3,
};

fn aircraft_state(
    turn: UnitQuaternion<f64>,
    v: Vector3<f64>,
    w: Vector3<f64>,
) -> (SVector<f64, 7>, SVector<f64, 6>) {
    let v = turn.inverse() * v;
    let w = turn.inverse() * w;
    ([0.0, 0.0, 0.0, turn.i, turn.j, turn.k, turn.w].into(), [v.x, v.y, v.z, w.x, w.y, w.z].into())
}

/// Checks that the accelerations are zero in level flight at a given angle of attack, with speed, thrust and
/// elevator calculated by hand, and that a small pitch-up causes a restoring moment.
#[test]
fn trimmed_level_flight_has_zero_acceleration() {
    let (alpha, weight) = (0.06_f64, A.mass * A.g);
    let cl = A.cl_0 + A.cl_alpha * alpha;
    let cd = A.cd_0 + A.cd_induced * cl * cl;
    // L + D tan α = m g determines the speed.
    let load = weight / (cl + cd * alpha.tan());
    let speed = (2.0 * load / (A.density * A.area)).sqrt();
    let thrust = load * cd / alpha.cos();
    let elevator = -(A.cm_0 + A.cm_alpha * alpha) / A.cm_elevator;
    let attitude = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), alpha);
    let (q, v) = aircraft_state(attitude, Vector3::new(speed, 0.0, 0.0), Vector3::zeros());
    assert_number_close(A.angle_of_attack(&q, &v), alpha, 1e-14);
    assert_number_close(A.airspeed(&q, &v), speed, 1e-14);
    let tau = A.generalized_forces(&q, &v, &[elevator, thrust].into());
    assert_matrix_close(A.forward_dynamics(&q, &v, &tau), SVector::zeros(), 1e-12);

    // After a small pitch-up the moment lowers the nose.
    let nose_up = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), alpha + 0.01);
    let (q, v) = aircraft_state(nose_up, Vector3::new(speed, 0.0, 0.0), Vector3::zeros());
    let tau = A.generalized_forces(&q, &v, &[elevator, thrust].into());
    let back = A.forward_dynamics(&q, &v, &tau)[4];
    assert_number_close(back, load * A.chord * A.cm_alpha * 0.01 / A.iyy, 1e-12);
}

/// Checks that a glider without drag has a constant velocity in body axes in a level turn.
#[test]
fn glider_keeps_velocity_in_level_turn() {
    let smooth = Aircraft { cd_0: 0.0, cd_induced: 0.0, ..A };
    let (alpha, bank) = (0.06_f64, 0.7_f64);
    let load = A.mass * A.g / bank.cos() / (A.cl_0 + A.cl_alpha * alpha);
    let speed = (2.0 * load / (A.density * A.area)).sqrt();
    let rate = A.g * bank.tan() / speed;
    let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), bank)
        * UnitQuaternion::from_axis_angle(&Vector3::y_axis(), alpha);
    let (q, v) = aircraft_state(attitude, Vector3::new(speed, 0.0, 0.0), Vector3::new(0.0, 0.0, rate));
    let a = smooth.forward_dynamics(&q, &v, &SVector::zeros());
    assert_matrix_close(a.fixed_rows::<3>(0).into_owned(), SVector::zeros(), 1e-12);
}
