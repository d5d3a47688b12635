use crate::testing::{assert_matrix_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::ChargedParticle;

const P: ChargedParticle = ChargedParticle { mass: 0.2, charge: 0.8, electric: 1.5, magnetic: 3.0 };

#[test]
fn charged_particle_has_lorentz_force() {
    let v = SVector::from([0.4, -0.7, 2.0]);
    let force = 0.8 * SVector::from([3.0 * v[1], 1.5 - 3.0 * v[0], 0.0]);
    assert_matrix_close(P.bias_forces(&SVector::zeros(), &v), -force, 1e-15);
}

#[test]
fn charged_particle_circles_and_drifts() -> Result<(), Error> {
    let (omega, drift) = (P.charge * P.magnetic / P.mass, P.electric / P.magnetic);
    // Start at the origin with the drift velocity and 2 m/s more along x.
    let run = simulate(&P).from([0.0; 3], [drift + 2.0, 0.0, 0.3]).method(precise_integrator());
    for sample in run.duration(2.0).sample_every(0.1) {
        let Sample { t, q, .. } = sample?;
        let (s, c) = (omega * t).sin_cos();
        let expected = [drift * t + 2.0 / omega * s, 2.0 / omega * (c - 1.0), 0.3 * t];
        assert_matrix_close(q, SVector::from(expected), 1e-9);
    }
    Ok(())
}
