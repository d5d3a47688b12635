use crate::testing::assert_matrix_close;
use linkwork::prelude::*;
use linkwork_models::SpringChain;
use std::f64::consts::PI;

const C: SpringChain<f64> = SpringChain { mass: 0.8, stiffness: 50.0, damping: 0.6 };

/// Returns the natural frequency, damping ratio and shape of mode j.
fn vibration_mode(j: usize) -> (f64, f64, SVector<f64, 3>) {
    let beta = (2 * j - 1) as f64 * PI / 7.0;
    let omega = 2.0 * (C.stiffness / C.mass).sqrt() * (beta / 2.0).sin();
    let shape = SVector::from_fn(|i, _| ((i + 1) as f64 * beta).sin());
    (omega, C.damping * omega / (2.0 * C.stiffness), shape)
}

#[test]
fn spring_chain_has_linear_equations_of_motion() {
    let k = SMatrix::<f64, 3, 3>::new(2.0, -1.0, 0.0, -1.0, 2.0, -1.0, 0.0, -1.0, 1.0);
    let (q, v) = (SVector::from([0.1, -0.3, 0.2]), SVector::from([1.0, 0.4, -2.0]));
    assert_matrix_close(C.mass_matrix(&q), SMatrix::identity() * C.mass, 1e-15);
    assert_matrix_close(C.bias_forces(&q, &v), k * (C.stiffness * q + C.damping * v), 1e-14);
}

#[test]
fn spring_chain_modes_are_decoupled() {
    for j in 1..=3 {
        let (omega, zeta, shape) = vibration_mode(j);
        let (q, v) = (0.05 * shape, 0.2 * shape);
        let a = C.forward_dynamics(&q, &v, &SVector::zeros());
        assert_matrix_close(a, -omega * omega * q - 2.0 * zeta * omega * v, 1e-13);
    }
}

#[test]
fn spring_chain_modes_decay_independently() -> Result<(), Error> {
    for j in 1..=3 {
        let (omega, zeta, shape) = vibration_mode(j);
        let damped = omega * (1.0 - zeta * zeta).sqrt();
        let start = simulate(&C).from(0.05 * shape, SVector::zeros());
        for sample in start.duration(1.0).sample_every(0.25) {
            let Sample { t, q, .. } = sample?;
            let swing = (damped * t).cos() + zeta * omega / damped * (damped * t).sin();
            assert_matrix_close(q, 0.05 * shape * swing * (-zeta * omega * t).exp(), 1e-8);
        }
    }
    Ok(())
}
