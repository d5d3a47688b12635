use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::{AnymalB, Solo12};

#[test]
fn quadruped_falls_freely() {
    let robot = Solo12;
    let mut q = robot.neutral();
    for k in 7..19 {
        q[k] = 0.3 * (k as f64).sin();
    }
    let mut expected = SVector::<f64, 18>::zeros();
    expected[2] = -9.81;
    let a = robot.forward_dynamics(&q, &SVector::zeros(), &SVector::zeros());
    assert_matrix_close(a, expected, 1e-11);
    let links: f64 = 2.0 * 0.14853845 + 0.03070001 + 0.00693606;
    assert_number_close(robot.total_mass(), 1.16115091 + 4.0 * links, 1e-14);
}

#[test]
fn anymal_falls_freely() {
    let robot = AnymalB;
    let mut q = robot.neutral();
    for k in 7..19 {
        q[k] = 0.3 * (k as f64).sin();
    }
    let mut expected = SVector::<f64, 18>::zeros();
    expected[2] = -9.81;
    let a = robot.forward_dynamics(&q, &SVector::zeros(), &SVector::zeros());
    assert_matrix_close(a, expected, 1e-11);
    let leg = 1.42462064 + 1.634976467 + 0.207204302 + 0.140170767 + 0.001;
    assert_number_close(robot.total_mass(), 16.793507758 + 1e-6 + 0.05 + 4.0 * leg, 1e-14);
}

#[test]
fn quadruped_foot_is_at_hand_computed_position() {
    let robot = Solo12;
    let mut q = robot.neutral();
    let (alpha, beta) = (0.6_f64, -1.3_f64);
    (q[8], q[9]) = (alpha, beta);
    let foot = robot.frame_placement(frame!(Solo12, "FL_FOOT"), &q).translation.vector;
    let x = 0.1946 - 0.16 * (alpha.sin() + (alpha + beta).sin());
    let z = -0.16 * (alpha.cos() + (alpha + beta).cos());
    let y = 0.0875 + 0.014 + 0.03745 + 0.008;
    assert_matrix_close(foot, SVector::from([x, y, z]), 1e-15);
}
