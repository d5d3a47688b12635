use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::FurutaPendulum;
use std::f64::consts::TAU;

const P: FurutaPendulum =
    FurutaPendulum { g: 9.81, arm_mass: 0.3, arm_length: 0.25, mass: 0.12, length: 0.4 };

fn closed_form_mass_matrix(theta: f64) -> SMatrix<f64, 2, 2> {
    let FurutaPendulum { arm_mass, arm_length: r, mass: m, length: l, .. } = P;
    let m22 = m * l * l / 3.0;
    let m12 = m * r * l * theta.cos() / 2.0;
    SMatrix::<f64, 2, 2>::new((arm_mass / 3.0 + m) * r * r + m22 * theta.sin().powi(2), m12, m12, m22)
}

#[test]
fn furuta_mass_matrix_and_bias_forces_match_closed_form() {
    let FurutaPendulum { g, arm_length: r, mass: m, length: l, .. } = P;
    let (theta, dphi, dtheta) = (0.8_f64, 2.1, -1.4);
    let (q, v) = (SVector::from([0.5, theta]), SVector::from([dphi, dtheta]));
    assert_matrix_close(P.mass_matrix(&q), closed_form_mass_matrix(theta), 1e-15);
    let (s, c) = theta.sin_cos();
    let h1 = m * l * l * s * c * dtheta * dphi / 1.5 - m * r * l * s * dtheta * dtheta / 2.0;
    let h2 = -m * l * l * s * c * dphi * dphi / 3.0 + m * g * l * s / 2.0;
    assert_matrix_close(P.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-14);
}

#[test]
fn furuta_pendulum_has_small_swing_frequency_with_free_arm() -> Result<(), Error> {
    let m = closed_form_mass_matrix(0.0);
    let frequency = (P.mass * P.g * P.length / 2.0 * m[(0, 0)] / m.determinant()).sqrt();
    let end = simulate(&P)
        .from([0.0, 1e-4], [0.0, 0.0])
        .method(precise_integrator())
        .until_crossing(Crossing::Falling, |_, _, v| v[1])
        .finish()?;
    assert_number_close(end.t, TAU / frequency, 1e-6);
    Ok(())
}
