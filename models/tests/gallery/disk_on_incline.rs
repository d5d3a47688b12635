use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::DiskOnIncline;

#[test]
fn rolling_bodies_have_predicted_accelerations() {
    for (shape, part) in [(1.0, 1.0 / 2.0), (0.5, 2.0 / 3.0), (2.0 / 3.0, 3.0 / 5.0), (0.4, 5.0 / 7.0)] {
        let body = DiskOnIncline { g: 9.81, mass: 0.8, radius: 0.15, shape, slope: 0.35 };
        let a = body.forward_dynamics(&[0.7].into(), &[1.3].into(), &[0.0].into());
        assert_number_close(a[0], part * 9.81 * 0.35_f64.sin(), 1e-14);
    }
}

/// Checks that the disk rolls without slip: the point of the rim that touches the incline is at rest.
#[test]
fn disk_rolls_without_slip() {
    let disk = DiskOnIncline { g: 9.81, mass: 0.8, radius: 0.15, shape: 0.5, slope: 0.35 };
    assert_matrix_close(disk.rim(&[0.0].into(), &[2.0].into()), SVector::zeros(), 1e-15);
    let turn = 0.15 * std::f64::consts::TAU;
    assert_matrix_close(disk.rim(&[turn].into(), &[2.0].into()), SVector::zeros(), 1e-14);
    // Half a turn later this point is at the top and moves at twice the speed of the centre.
    let top = disk.rim(&[turn / 2.0].into(), &[2.0].into());
    assert_matrix_close(top, 4.0 * SVector::from([0.35_f64.cos(), -0.35_f64.sin(), 0.0]), 1e-14);
}
