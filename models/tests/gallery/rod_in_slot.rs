use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::RodInSlot;
use std::f64::consts::TAU;

const R: RodInSlot = RodInSlot { g: 9.81, mass: 0.9, length: 0.7 };

#[test]
fn rod_in_slot_has_textbook_dynamics() {
    let RodInSlot { g, mass: m, length: l } = R;
    let (theta, rate) = (0.6_f64, 1.9);
    let (q, v) = (SVector::from([0.4, theta]), SVector::from([-0.3, rate]));
    let m12 = m * l * theta.cos() / 2.0;
    assert_matrix_close(R.mass_matrix(&q), SMatrix::<f64, 2, 2>::new(m, m12, m12, m * l * l / 3.0), 1e-15);
    let bias = [-m * l * theta.sin() * rate * rate / 2.0, m * g * l * theta.sin() / 2.0];
    assert_matrix_close(R.bias_forces(&q, &v), SVector::from(bias), 1e-14);
}

#[test]
fn rod_in_slot_falls_straight_down() -> Result<(), Error> {
    let RodInSlot { g, mass: m, length: l } = R;
    let run = simulate(&R).from([0.0, 2.0], [0.0, 0.0]).method(precise_integrator());
    for sample in run.duration(2.0).sample_every(0.2) {
        let Sample { q, v, .. } = sample?;
        assert_number_close(R.center_of_mass(&q)[0], l / 2.0 * 2.0_f64.sin(), 1e-10);
        let (s, c) = q[1].sin_cos();
        let kinetic = (1.0 / 12.0 + s * s / 4.0) * m * l * l * v[1] * v[1] / 2.0;
        assert_number_close(kinetic - m * g * l * c / 2.0, -m * g * l * 2.0_f64.cos() / 2.0, 1e-10);
    }
    Ok(())
}

#[test]
fn small_swings_of_rod_have_linear_period() -> Result<(), Error> {
    let end = simulate(&R)
        .from([0.0, 1e-4], [0.0, 0.0])
        .method(precise_integrator())
        .until_crossing(Crossing::Falling, |_, _, v| v[1])
        .finish()?;
    assert_number_close(end.t, TAU / (6.0 * R.g / R.length).sqrt(), 1e-6);
    Ok(())
}
