use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::SimpleHumanoid;

#[test]
fn humanoid_falls_freely() {
    let robot = SimpleHumanoid;
    let mut q = robot.neutral();
    for k in 7..SimpleHumanoid::NQ {
        q[k] = 0.3 * (k as f64).sin();
    }
    let mut expected = SVector::zeros();
    expected[2] = -9.81;
    let a = robot.forward_dynamics(&q, &SVector::zeros(), &SVector::zeros());
    assert_matrix_close(a, expected, 1e-10);
    let trunk = 27.0 + 6.0 + 30.0 + 13.0;
    let arm = 3.0 + 0.6 + 1.0 + 0.6 + 0.4 + 0.4 + 0.4;
    let leg = 2.5 + 2.0 + 5.1 + 7.0 + 2.5 + 1.9;
    assert_number_close(robot.total_mass(), trunk + 2.0 * (arm + leg), 1e-14);
}
