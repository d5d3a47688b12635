use crate::testing::{assert_matrix_close, assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::BeadOnSpinningHoop;
use std::f64::consts::TAU;

const H: BeadOnSpinningHoop = BeadOnSpinningHoop { g: 9.81, mass: 0.3, radius: 0.4, spin: 8.0 };

#[test]
fn bead_on_hoop_has_textbook_equation() {
    let mr2 = H.mass * H.radius * H.radius;
    for (t, theta, rate) in [(0.0, 0.4_f64, 1.0), (3.7, -2.2, 0.6)] {
        let (q, v) = (SVector::from([theta]), SVector::from([rate]));
        let (s, c) = theta.sin_cos();
        let bias = H.mass * H.g * H.radius * s - mr2 * H.spin * H.spin * s * c;
        assert_matrix_close(H.mass_matrix(t, &q), SMatrix::<f64, 1, 1>::new(mr2), 1e-15);
        assert_matrix_close(H.bias_forces(t, &q, &v), SVector::from([bias]), 1e-14);
        let speed2 = rate * rate + H.spin * H.spin * s * s;
        assert_number_close(H.kinetic_energy(t, &q, &v), mr2 * speed2 / 2.0, 1e-14);
    }
}

#[test]
fn bead_oscillates_about_tilted_equilibrium() -> Result<(), Error> {
    let tilt = (H.g / (H.radius * H.spin * H.spin)).acos();
    let end = simulate(&H)
        .from([tilt + 1e-4], [0.0])
        .method(precise_integrator())
        .until_crossing(Crossing::Falling, |_, _, v| v[0])
        .finish()?;
    assert_number_close(end.t, TAU / (H.spin * tilt.sin()), 1e-7);
    Ok(())
}

#[test]
fn jacobis_integral_is_conserved() -> Result<(), Error> {
    let jacobi_integral = |q: &SVector<f64, 1>, v: &SVector<f64, 1>| {
        let speed2 = v[0] * v[0] - (H.spin * q[0].sin()).powi(2);
        H.mass * H.radius * (H.radius * speed2 / 2.0 - H.g * q[0].cos())
    };
    let start = jacobi_integral(&[0.2].into(), &[0.5].into());
    for sample in simulate(&H).from([0.2], [0.5]).method(precise_integrator()).duration(3.0).sample_every(0.5)
    {
        let Sample { q, v, .. } = sample?;
        assert_number_close(jacobi_integral(&q, &v), start, 1e-10);
    }
    Ok(())
}
