use crate::testing::{assert_matrix_close, assert_number_close};
use linkwork::prelude::*;
use linkwork_models::KapitzaPendulum;
use std::f64::consts::{PI, TAU};

const P: KapitzaPendulum =
    KapitzaPendulum { g: 9.81, mass: 0.2, length: 0.5, amplitude: 0.01, frequency: 1000.0 };

#[test]
fn kapitza_pendulum_has_textbook_equation() {
    let (t, theta, rate) = (0.0023, 0.9_f64, -1.7);
    let shaken = P.g - P.amplitude * P.frequency * P.frequency * (P.frequency * t).cos();
    let ml = P.mass * P.length;
    let (q, v) = (SVector::from([theta]), SVector::from([rate]));
    assert_matrix_close(P.mass_matrix(t, &q), SMatrix::<f64, 1, 1>::new(ml * P.length), 1e-15);
    assert_matrix_close(P.bias_forces(t, &q, &v), SVector::from([ml * shaken * theta.sin()]), 1e-12);
}

#[test]
fn kapitza_pendulum_stands_upright() -> Result<(), Error> {
    let (a, l) = (P.amplitude * P.frequency, P.length);
    let slow = (a * a / (2.0 * l * l) - P.g / l).sqrt();
    let method = DormandPrince::new().tolerance(1e-9, 1e-9);
    let run = simulate(&P).from([PI + 0.05], [0.0]).method(method);
    // The ripple on the averaged motion is relative a / l = 0.02, and so is the initial contribution to the
    // amplitude.
    for sample in run.duration(TAU / slow).sample_every(TAU / slow / 16.0) {
        let Sample { t, q, .. } = sample?;
        assert_number_close((q[0] - PI) / 0.05, (slow * t).cos(), 0.06);
    }
    Ok(())
}

#[test]
fn kapitza_pendulum_falls_if_shaken_slowly() -> Result<(), Error> {
    let weak = KapitzaPendulum { frequency: 0.9 * (2.0 * P.g * P.length).sqrt() / P.amplitude, ..P };
    let end = simulate(&weak).from([PI + 0.05], [0.0]).until(|_, q, _| q[0] - 1.5 * PI);
    assert!(end.duration(5.0).finish()?.t < 5.0);
    Ok(())
}
