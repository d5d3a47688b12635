use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::RateGyroscope;

const G: RateGyroscope =
    RateGyroscope { rate: 0.4, axial: 2e-4, transverse: 1.2e-4, stiffness: 0.5, damping: 0.01 };

#[test]
fn rate_gyroscope_has_textbook_equations() {
    let (theta, dtheta, spin) = (0.3_f64, -0.7, 900.0);
    let (q, v) = (SVector::from([theta, 1.1]), SVector::from([dtheta, spin]));
    let (s, c) = theta.sin_cos();
    let (a, n, rate) = (G.transverse, spin + G.rate * s, G.rate);
    let h1 = a * rate * rate * s * c - G.axial * n * rate * c + 0.5 * theta + 0.01 * dtheta;
    let h2 = G.axial * rate * c * dtheta;
    assert_matrix_close(G.bias_forces(2.5, &q, &v), SVector::from([h1, h2]), 1e-14);
    let mass = SMatrix::<f64, 2, 2>::new(a, 0.0, 0.0, G.axial);
    assert_matrix_close(G.mass_matrix(2.5, &q), mass, 1e-18);
}

#[test]
fn gyroscope_deflection_measures_the_rate() -> Result<(), Error> {
    let whole = 900.0;
    let settled = simulate(&G).from([0.0, 0.0], [0.0, whole]).duration(3.0).finish()?;
    let (s, c) = settled.q[0].sin_cos();
    let expected = (G.axial * whole - G.transverse * G.rate * s) * G.rate * c / G.stiffness;
    assert_number_close(settled.q[0] / expected, 1.0, 1e-6);
    assert_number_close(settled.v[1] + G.rate * s, whole, 1e-8);
    Ok(())
}
