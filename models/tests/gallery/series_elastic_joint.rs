use crate::testing::{assert_acceleration_derivatives, assert_matrix_close, assert_number_close};
use linkwork::nalgebra::{Complex, Matrix2};
use linkwork::prelude::*;
use linkwork_models::SeriesElasticJoint;

const S: SeriesElasticJoint = SeriesElasticJoint {
    g: 9.81,
    mass: 2.0,
    length: 0.6,
    rotor_inertia: 0.05,
    stiffness: 120.0,
    damping: 0.4,
};

#[test]
fn series_elastic_accelerations_have_closed_form() {
    let (q, v, drive) = ([0.7, 0.5].into(), [1.0, -0.5].into(), 3.0);
    let torque = 120.0 * 0.2 + 0.4 * 1.5;
    assert_number_close(S.torque(&q, &v), torque, 1e-13);
    let a = S.forward_dynamics(&q, &v, &S.generalized_forces(&q, &[drive].into()));
    let link = (torque - 9.81 * 0.6 * 0.5_f64.sin()) / (2.0 * 0.6 * 0.6 / 3.0);
    assert_matrix_close(a, SVector::from([(drive - torque) / 0.05, link]), 1e-13);
    assert_acceleration_derivatives(&S, &q, &v, &[drive].into(), 1e-6);
}

/// Checks the transfer function from motor torque to spring torque, for a heavy link that is at rest.
#[test]
fn spring_torque_transfer_function_matches_closed_form() {
    let fixed = SeriesElasticJoint { mass: 1e12, g: 0.0, ..S };
    let linear = fixed.linear_motion(&[0.0; 2].into(), &[0.0; 2].into(), &[0.0].into());
    for omega in [3.0, 49.0, 300.0] {
        let s = Complex::new(0.0, omega);
        let to_complex_matrix = |m: Matrix2<f64>| m.map(|x| Complex::new(x, 0.0));
        let matrix = Matrix2::identity() * (s * s)
            - to_complex_matrix(linear.by_v) * s
            - to_complex_matrix(linear.by_q);
        let motion = matrix.try_inverse().unwrap() * linear.by_u.map(|x| Complex::new(x, 0.0));
        let spring = s * 0.4 + 120.0;
        let expected = spring / (s * s * 0.05 + spring);
        assert!((spring * (motion[0] - motion[1]) - expected).norm() < 1e-9 * expected.norm());
    }
}
