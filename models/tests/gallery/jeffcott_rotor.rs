use crate::testing::{assert_matrix_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::JeffcottRotor;

const R: JeffcottRotor =
    JeffcottRotor { spin: 90.0, mass: 2.0, eccentricity: 1e-3, stiffness: 8000.0, damping: 20.0 };

#[test]
fn jeffcott_rotor_has_closed_form_equations() {
    let (t, q, v) = (0.4, SVector::from([0.002, -0.001]), SVector::from([0.1, 0.3]));
    assert_matrix_close(R.mass_matrix(t, &q), SMatrix::<f64, 2, 2>::identity() * 2.0, 1e-15);
    let turned = R.spin * t;
    let pull = R.mass * R.eccentricity * R.spin * R.spin;
    let bias = 20.0 * v + 8000.0 * q - pull * SVector::from([turned.cos(), turned.sin()]);
    assert_matrix_close(R.bias_forces(t, &q, &v), bias, 1e-13);
}

#[test]
fn jeffcott_rotor_has_closed_form_whirl() -> Result<(), Error> {
    for spin in [30.0, 63.0, 200.0, 2000.0] {
        let rotor = JeffcottRotor { spin, ..R };
        let ratio = spin * (R.mass / R.stiffness).sqrt();
        let zeta = R.damping / (2.0 * (R.stiffness * R.mass).sqrt());
        let (real, imaginary) = (1.0 - ratio * ratio, 2.0 * zeta * ratio);
        let radius = R.eccentricity * ratio * ratio / real.hypot(imaginary);
        let lag = imaginary.atan2(real);
        let whirl_position = |t: f64| {
            let angle = spin * t - lag;
            radius * SVector::from([angle.cos(), angle.sin()])
        };
        let rate = spin * radius * SVector::from([lag.sin(), lag.cos()]);
        let run = simulate(&rotor).from(whirl_position(0.0), rate).method(precise_integrator());
        for sample in run.duration(0.3).sample_every(0.05) {
            let Sample { t, q, .. } = sample?;
            assert_matrix_close(q / radius, whirl_position(t) / radius, 1e-7);
            // Far above the critical speed the centre of mass is nearly at rest.
            let unbalance = R.eccentricity * SVector::from([(spin * t).cos(), (spin * t).sin()]);
            let moves = (q + unbalance).norm() > 0.01 * R.eccentricity;
            assert_eq!(moves, spin < 1000.0, "at {spin} rad/s");
        }
    }
    Ok(())
}
