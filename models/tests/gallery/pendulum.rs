use crate::testing::{assert_matrix_close, assert_number_close, elliptic_integral, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::Pendulum;

#[test]
fn pendulum_has_textbook_equation_of_motion() {
    let p = Pendulum { g: 9.81, mass: 1.3, length: 0.7 };
    let (q, v, a) = (SVector::from([2.1]), SVector::from([-1.7]), SVector::from([0.4]));
    let ml2 = 1.3 * 0.7 * 0.7;
    let torque = ml2 * 0.4 + 1.3 * 9.81 * 0.7 * 2.1_f64.sin();
    assert_matrix_close(p.inverse_dynamics(&q, &v, &a), SVector::from([torque]), 1e-14);
    assert_number_close(p.kinetic_energy(&q, &v), ml2 * 1.7 * 1.7 / 2.0, 1e-14);
    assert_number_close(p.potential_energy(&q), -1.3 * 9.81 * 0.7 * 2.1_f64.cos(), 1e-14);
}

#[test]
fn pendulum_dynamics_hold_in_single_precision() {
    let p = Pendulum { g: 10.0_f32, mass: 2.0, length: 0.5 };
    let a = p.forward_dynamics(&SVector::from([0.3]), &SVector::from([0.0]), &SVector::from([0.0]));
    assert!((a[0] + 20.0 * 0.3_f32.sin()).abs() < 1e-5);
}

#[test]
fn pendulum_period_matches_elliptic_integral() {
    let p = Pendulum { g: 9.81, mass: 1.0, length: 0.8 };
    for start in [0.1_f64, 1.5, 3.0] {
        let period = 4.0 * (0.8_f64 / 9.81).sqrt() * elliptic_integral((start / 2.0).sin().powi(2));
        let run = simulate(&p).from([start], [0.0]).method(precise_integrator());
        let back = run.until_crossing(Crossing::Falling, |_, _, v| v[0]).finish();
        assert_number_close(back.map_or(f64::NAN, |s| s.t), period, 1e-9);
    }
}
