use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::ElasticPendulum;
use std::f64::consts::TAU;

const P: ElasticPendulum = ElasticPendulum { g: 9.81, mass: 0.5, stiffness: 40.0, free_length: 0.8 };

#[test]
fn elastic_pendulum_has_textbook_equations() {
    let (r, theta, dr, dtheta) = (0.9, 0.7_f64, -0.4, 1.3);
    let (q, v) = (SVector::from([r, theta]), SVector::from([dr, dtheta]));
    let ElasticPendulum { g, mass: m, stiffness: k, free_length: l } = P;
    assert_matrix_close(P.mass_matrix(&q), SMatrix::<f64, 2, 2>::new(m, 0.0, 0.0, m * r * r), 1e-15);
    let h1 = -m * r * dtheta * dtheta - m * g * theta.cos() + k * (r - l);
    let h2 = 2.0 * m * r * dr * dtheta + m * g * r * theta.sin();
    assert_matrix_close(P.bias_forces(&q, &v), SVector::from([h1, h2]), 1e-14);
}

#[test]
fn elastic_pendulum_bounces_harmonically() -> Result<(), Error> {
    let rest = P.free_length + P.mass * P.g / P.stiffness;
    let omega = (P.stiffness / P.mass).sqrt();
    let run = simulate(&P).from([rest + 0.1, 0.0], [0.0, 0.0]).method(precise_integrator());
    for sample in run.duration(2.0).sample_every(0.25) {
        let Sample { t, q, .. } = sample?;
        assert_matrix_close(q, SVector::from([rest + 0.1 * (omega * t).cos(), 0.0]), 1e-10);
    }
    Ok(())
}

#[test]
fn small_swings_of_elastic_pendulum_have_pendulum_period() -> Result<(), Error> {
    let rest = P.free_length + P.mass * P.g / P.stiffness;
    let end = simulate(&P)
        .from([rest, 1e-4], [0.0, 0.0])
        .method(precise_integrator())
        .until_crossing(Crossing::Falling, |_, _, v| v[1])
        .finish()?;
    assert_number_close(end.t, TAU * (rest / P.g).sqrt(), 1e-6);
    Ok(())
}
