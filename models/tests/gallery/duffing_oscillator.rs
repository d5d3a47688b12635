use crate::testing::{assert_matrix_close, assert_number_close, elliptic_integral, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::DuffingOscillator;
use std::f64::consts::TAU;

const D: DuffingOscillator =
    DuffingOscillator { mass: 0.7, damping: 0.2, alpha: 3.0, beta: 5.0, drive: 1.5, frequency: 2.1 };

#[test]
fn duffing_oscillator_has_duffings_equation() {
    let (t, x, dx) = (0.8, 0.6, -1.1);
    let (q, v) = (SVector::from([x]), SVector::from([dx]));
    let h = 0.2 * dx + 3.0 * x + 5.0 * x * x * x - 1.5 * f64::cos(2.1 * t);
    let found = D.inverse_dynamics(t, &q, &v, &SVector::from([0.4]));
    assert_matrix_close(found, SVector::from([0.7 * 0.4 + h]), 1e-14);
    assert_number_close(D.potential_energy(t, &q), 1.5 * x * x + 1.25 * x.powi(4), 1e-14);
}

fn period_of_oscillation(d: DuffingOscillator, start: f64) -> Result<f64, Error> {
    let run = simulate(&d).from([start], [0.0]).method(precise_integrator());
    Ok(run.until_crossing(Crossing::Falling, |_, _, v| v[0]).finish()?.t)
}

#[test]
fn duffing_period_is_elliptic_integral() -> Result<(), Error> {
    let free = DuffingOscillator { damping: 0.0, drive: 0.0, ..D };
    for amplitude in [0.1, 1.0, 4.0] {
        let stiff = free.beta * amplitude * amplitude;
        let sum = free.alpha + stiff;
        let expected = 4.0 * elliptic_integral(stiff / sum / 2.0) * (free.mass / sum).sqrt();
        assert_number_close(period_of_oscillation(free, amplitude)?, expected, 1e-9);
    }
    Ok(())
}

#[test]
fn duffing_oscillator_has_two_wells() -> Result<(), Error> {
    let double = DuffingOscillator { damping: 0.0, drive: 0.0, alpha: -3.0, ..D };
    let well = (3.0_f64 / 5.0).sqrt();
    assert_number_close(double.bias_forces(0.0, &[well].into(), &[0.0].into())[0], 0.0, 1e-15);
    assert_number_close(period_of_oscillation(double, well + 1e-4)?, TAU / (6.0_f64 / 0.7).sqrt(), 1e-6);
    Ok(())
}
