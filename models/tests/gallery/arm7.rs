use crate::testing::{assert_matrix_close, pose_along_and_about_x, pose_along_and_about_z};
use linkwork::nalgebra::Isometry3;
use linkwork::prelude::*;
use linkwork_models::{LoadedPanda, Panda, PandaArm};
use std::f64::consts::FRAC_PI_2;

const Q: [f64; 7] = [0.4, -0.7, 0.3, -2.1, 1.2, 1.9, -0.8];

#[test]
fn panda_flange_matches_denavit_hartenberg() {
    let d = [0.333, 0.0, 0.316, 0.0, 0.384, 0.0, 0.0];
    let a = [0.0, 0.0, 0.0, 0.0825, -0.0825, 0.0, 0.088];
    let alpha = [0.0, -1.0, 1.0, 1.0, -1.0, 1.0, 1.0].map(|sign| sign * FRAC_PI_2);
    let mut flange = Isometry3::identity();
    for k in 0..7 {
        flange = flange * pose_along_and_about_x(alpha[k], a[k]) * pose_along_and_about_z(Q[k], d[k]);
    }
    flange *= pose_along_and_about_z(0.0, 0.107);
    let found = PandaArm.frame_placement(frame!(PandaArm, "panda_link8"), &Q.into());
    assert_matrix_close(found.to_homogeneous(), flange.to_homogeneous(), 1e-14);
    let tip = PandaArm.frame_placement(frame!(PandaArm, "panda_hand_tcp"), &Q.into());
    let expected = flange * pose_along_and_about_z(-FRAC_PI_2 / 2.0, 0.1034);
    assert_matrix_close(tip.to_homogeneous(), expected.to_homogeneous(), 1e-14);
}

/// Checks that locked fingers do not move: the mass matrix is the upper left part of the full robot's.
#[test]
fn locked_fingers_do_not_move() {
    let mut full = Panda.neutral();
    full.fixed_rows_mut::<7>(0).copy_from(&SVector::from(Q));
    let part = Panda.mass_matrix(&full).fixed_view::<7, 7>(0, 0).into_owned();
    assert_matrix_close(PandaArm.mass_matrix(&Q.into()), part, 1e-14);
}

/// Checks that the load adds `Jᵀ m J` to the mass matrix and `−Jᵀ m g` to the bias forces.
#[test]
fn load_adds_its_jacobian_terms() {
    let (arm, loaded) = (PandaArm, LoadedPanda { load: 2.5 });
    let q = SVector::from(Q);
    let jacobian = arm.frame_jacobian(frame!(PandaArm, "panda_hand_tcp"), &q);
    let linear = jacobian.fixed_rows::<3>(0).into_owned();
    let added = loaded.mass_matrix(&q) - arm.mass_matrix(&q);
    assert_matrix_close(added, 2.5 * linear.transpose() * linear, 1e-13);
    let rest = SVector::zeros();
    let weight = loaded.bias_forces(&q, &rest) - arm.bias_forces(&q, &rest);
    assert_matrix_close(weight, 2.5 * 9.81 * linear.row(2).transpose(), 1e-13);
}
