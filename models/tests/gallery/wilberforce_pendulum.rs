use crate::testing::{assert_matrix_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::WilberforcePendulum;

/// Test pendulum with the dimensions of Berg and Marshall's.
const P: WilberforcePendulum = WilberforcePendulum {
    mass: 0.4905,
    inertia: 1.39e-4,
    stiffness: 2.63,
    torsion: 7.44e-4,
    coupling: 9.27e-3,
};

#[test]
fn wilberforce_accelerations_have_closed_form() {
    let q = SVector::from([0.04, -1.3]);
    let bias = [2.63 * q[0] + 4.635e-3 * q[1], 7.44e-4 * q[1] + 4.635e-3 * q[0]];
    assert_matrix_close(P.bias_forces(&q, &SVector::from([0.1, 2.0])), SVector::from(bias), 1e-15);
    let mass = SMatrix::<f64, 2, 2>::new(P.mass, 0.0, 0.0, P.inertia);
    assert_matrix_close(P.mass_matrix(&q), mass, 1e-16);
}

#[test]
fn wilberforce_energy_alternates() -> Result<(), Error> {
    let omega2 = P.stiffness / P.mass;
    let tuned = WilberforcePendulum { torsion: omega2 * P.inertia, ..P };
    let split = P.coupling / (2.0 * (P.mass * P.inertia).sqrt());
    let (first, second) = ((omega2 + split).sqrt(), (omega2 - split).sqrt());
    let lever = (P.mass / P.inertia).sqrt();
    for sample in simulate(&tuned)
        .from([0.1, 0.0], [0.0; 2])
        .method(precise_integrator())
        .duration(40.0)
        .sample_every(2.0)
    {
        let Sample { t, q, .. } = sample?;
        let (a, b) = ((first * t).cos(), (second * t).cos());
        assert_matrix_close(q, SVector::from([0.05 * (a + b), 0.05 * lever * (a - b)]), 1e-8);
    }
    Ok(())
}
