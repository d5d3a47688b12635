use crate::testing::{assert_matrix_close, pose_along_and_about_x, pose_along_and_about_z};
use linkwork::nalgebra::Isometry3;
use linkwork::prelude::*;
use linkwork_models::Ur5;
use std::f64::consts::FRAC_PI_2;

#[test]
fn ur5_tool_matches_denavit_hartenberg() {
    let robot = Ur5;
    let q = SVector::from([0.4, -1.1, 1.7, -0.6, 2.2, 0.9]);
    let d = [0.089159, 0.0, 0.0, 0.10915, 0.09465, 0.0823];
    let a = [0.0, -0.425, -0.39225, 0.0, 0.0, 0.0];
    let alpha = [FRAC_PI_2, 0.0, 0.0, FRAC_PI_2, -FRAC_PI_2, 0.0];
    let mut tool = Isometry3::identity();
    for k in 0..6 {
        tool = tool * pose_along_and_about_z(q[k], d[k]) * pose_along_and_about_x(alpha[k], a[k]);
    }
    let base = robot.frame_placement(frame!(Ur5, "base"), &q);
    let found = base.inverse() * robot.frame_placement(frame!(Ur5, "tool0"), &q);
    assert_matrix_close(found.to_homogeneous(), tool.to_homogeneous(), 1e-10);
}

#[test]
fn stretched_arm_torques_equal_weight_moments() {
    // At zero the arm is stretched out horizontally along x: the lift joint carries m₂, m₃ and the three
    // wrist bodies.
    let robot = Ur5;
    let h = robot.bias_forces(&robot.neutral(), &SVector::zeros());
    let moment = 8.393 * 0.28 + 2.275 * (0.425 + 0.25) + (1.219 + 1.219 + 0.1879) * (0.425 + 0.39225);
    assert_matrix_close(h.fixed_rows::<2>(0).into_owned(), SVector::from([0.0, -9.81 * moment]), 1e-10);
}
