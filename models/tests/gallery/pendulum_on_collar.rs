use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::PendulumOnCollar;

const P: PendulumOnCollar = PendulumOnCollar {
    g: 9.81,
    sleeve_mass: 0.8,
    sleeve_inertia: 0.002,
    stiffness: 300.0,
    mass: 0.5,
    length: 0.3,
};

#[test]
fn pendulum_on_collar_has_textbook_mass_and_energy() {
    let (s, theta) = (0.04, 0.7_f64);
    let q = SVector::from([s, 1.9, theta]);
    let ml = P.mass * P.length;
    let m13 = ml * theta.sin();
    let mut expected = SMatrix::<f64, 3, 3>::zeros();
    expected[(0, 0)] = 1.3;
    (expected[(0, 2)], expected[(2, 0)]) = (m13, m13);
    expected[(1, 1)] = P.sleeve_inertia + m13 * m13 / P.mass;
    expected[(2, 2)] = ml * P.length;
    assert_matrix_close(P.mass_matrix(&q), expected, 1e-15);
    let energy = 1.3 * 9.81 * s + 150.0 * s * s - ml * 9.81 * theta.cos();
    assert_number_close(P.potential_energy(&q), energy, 1e-14);
}

#[test]
fn pendulum_on_collar_rotates_steadily() {
    let rate = 9.0;
    let theta = (P.g / (P.length * rate * rate)).acos();
    let sag = -1.3 * P.g / P.stiffness;
    let (q, v) = (SVector::from([sag, 0.4, theta]), SVector::from([0.0, rate, 0.0]));
    assert_matrix_close(P.forward_dynamics(&q, &v, &SVector::zeros()), SVector::zeros(), 1e-12);
}

#[test]
fn pendulum_on_collar_conserves_energy_and_momentum() -> Result<(), Error> {
    let total_energy = |s: &Sample<f64, 3, 3, 0>| P.kinetic_energy(&s.q, &s.v) + P.potential_energy(&s.q);
    let angular_momentum = |s: &Sample<f64, 3, 3, 0>| P.generalized_momentum(&s.q, &s.v)[1];
    let mut start = None;
    let run = simulate(&P).from([0.0, 0.0, 0.9], [0.1, 8.0, -1.0]).method(precise_integrator());
    for sample in run.duration(2.0).sample_every(0.2) {
        let sample = sample?;
        let (e, l) = *start.get_or_insert((total_energy(&sample), angular_momentum(&sample)));
        assert_number_close(total_energy(&sample), e, 1e-9);
        assert_number_close(angular_momentum(&sample), l, 1e-9);
    }
    Ok(())
}
