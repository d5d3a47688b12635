use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::TunedSuspension;

const S: TunedSuspension =
    TunedSuspension { m1: 10.0, m2: 0.8, k1: 900.0, k2: 120.0, damping: 3.0, inertance: 0.5 };

#[test]
fn tuned_suspension_accelerations_have_closed_form() {
    let symmetric_matrix = |a, b, c| SMatrix::<f64, 2, 2>::new(a, b, b, c);
    assert_matrix_close(S.mass_matrix(&SVector::zeros()), symmetric_matrix(10.5, -0.5, 1.3), 1e-14);
    let (q, v) = (SVector::from([0.02, -0.05]), SVector::from([0.7, 0.3]));
    let bias = symmetric_matrix(1020.0, -120.0, 120.0) * q + symmetric_matrix(3.0, -3.0, 3.0) * v;
    assert_matrix_close(S.bias_forces(&q, &v), bias, 1e-13);
    let energy = 450.0 * q[0] * q[0] + 60.0 * (q[0] - q[1]).powi(2);
    assert_number_close(S.potential_energy(&q), energy, 1e-14);
}

#[test]
fn tuned_absorber_stops_the_shaken_cart() -> Result<(), Error> {
    let tuned = TunedSuspension { damping: 0.0, ..S };
    let omega = (tuned.k2 / (tuned.m2 + tuned.inertance)).sqrt();
    let swing = 2.0 / (omega * omega * tuned.inertance - tuned.k2);
    let run = simulate(&tuned)
        .from([0.0, swing], [0.0, 0.0])
        .inputs(|t, _, _| SVector::from([2.0 * (omega * t).cos()]))
        .method(precise_integrator());
    for sample in run.duration(3.0).sample_every(0.3) {
        let Sample { t, q, .. } = sample?;
        assert_matrix_close(q, SVector::from([0.0, swing * (omega * t).cos()]), 1e-9);
    }
    Ok(())
}
