use crate::testing::assert_matrix_close;
use linkwork::prelude::*;
use linkwork_models::{QuintuplePendulum, TriplePendulum};

/// Returns the closed form of mass matrix and bias forces of a pendulum chain in relative angles.
fn closed_form_dynamics<const N: usize>(
    g: f64,
    (m, l): ([f64; N], [f64; N]),
    q: &SVector<f64, N>,
    v: &SVector<f64, N>,
) -> (SMatrix<f64, N, N>, SVector<f64, N>) {
    let sums = SMatrix::<f64, N, N>::from_fn(|i, j| if i >= j { 1.0 } else { 0.0 });
    let (phi, rate) = (sums * q, sums * v);
    let mass_coupling = |i: usize, j: usize| m[i.max(j)..].iter().sum::<f64>() * l[i] * l[j];
    let mass = SMatrix::<f64, N, N>::from_fn(|i, j| mass_coupling(i, j) * (phi[i] - phi[j]).cos());
    let bias = SVector::<f64, N>::from_fn(|i, _| {
        let turning: f64 =
            (0..N).map(|j| mass_coupling(i, j) * (phi[i] - phi[j]).sin() * rate[j] * rate[j]).sum();
        turning + mass_coupling(i, i) / l[i] * g * phi[i].sin()
    });
    (sums.transpose() * mass * sums, sums.transpose() * bias)
}

#[test]
fn three_link_pendulum_matches_closed_form() {
    let p = TriplePendulum { g: 9.81, m1: 1.0, l1: 0.5, m2: 0.7, l2: 0.4, m3: 1.4, l3: 0.8 };
    let (q, v) = (SVector::from([0.4, -1.2, 2.5]), SVector::from([1.0, -2.0, 0.7]));
    let (mass, bias) = closed_form_dynamics(9.81, ([1.0, 0.7, 1.4], [0.5, 0.4, 0.8]), &q, &v);
    assert_matrix_close(p.mass_matrix(&q), mass, 1e-13);
    assert_matrix_close(p.bias_forces(&q, &v), bias, 1e-13);
}

#[test]
fn five_link_pendulum_matches_closed_form() {
    let (m, l) = ([1.0, 0.7, 1.4, 0.3, 2.0], [0.5, 0.4, 0.8, 1.1, 0.6]);
    let [m1, m2, m3, m4, m5] = m;
    let [l1, l2, l3, l4, l5] = l;
    let p = QuintuplePendulum { g: 9.81, m1, m2, m3, m4, m5, l1, l2, l3, l4, l5 };
    let (q, v) = (SVector::from([0.4, -1.2, 2.5, 0.3, -0.9]), SVector::from([1.0, -2.0, 0.7, 1.9, -3.0]));
    let (mass, bias) = closed_form_dynamics(9.81, (m, l), &q, &v);
    assert_matrix_close(p.mass_matrix(&q), mass, 1e-13);
    assert_matrix_close(p.bias_forces(&q, &v), bias, 1e-13);
}
