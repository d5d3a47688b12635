use crate::testing::{assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::FourBar;

/// Parameters of a four-bar linkage that is a crank-rocker by Grashof's criterion.
const L: FourBar = FourBar { g: 9.81, density: 0.8, a: 0.3, b: 0.9, c: 0.7, d: 0.8 };

/// Returns the configuration in the open assembly mode with a given crank angle.
fn configuration_at_crank_angle(input: f64) -> SVector<f64, 3> {
    L.assemble(&[input, 0.9 - input, 1.8].into(), &[0]).expect("the crank goes all the way round")
}

/// Checks that positions satisfy Freudenstein's equation, and rates its derivative, over a full rotation.
#[test]
fn four_bar_satisfies_freudensteins_equation() {
    assert_eq!((FourBar::NC, FourBar::NP, FourBar::NS), (2, 1, 1));
    let FourBar { a, b, c, d, .. } = L;
    for k in 0..24 {
        let q = configuration_at_crank_angle(f64::from(k) * std::f64::consts::PI / 12.0);
        let (crank, coupler, rocker) = (q[0], q[0] + q[1], q[2]);
        let constant = (a * a - b * b + c * c + d * d) / (2.0 * a * c);
        let cosine = d / a * rocker.cos() - d / c * crank.cos() + constant;
        assert_number_close(cosine, (crank - rocker).cos(), 1e-13);

        let v = L.project_velocity(&q, &[2.0, 0.0, 0.0].into()).expect("no dead centre");
        let sine = (coupler - rocker).sin();
        assert_number_close(v[2] / v[0], a * (coupler - crank).sin() / (c * sine), 1e-12);
        assert_number_close((v[0] + v[1]) / v[0], a * (rocker - crank).sin() / (b * sine), 1e-12);
    }
}

/// Checks that at rest the motor torque equals the derivative of the potential energy, by virtual work.
#[test]
fn four_bar_holding_torque_equals_energy_derivative() {
    let FourBar { g, density, a, b, c, .. } = L;
    let q = configuration_at_crank_angle(0.7);
    let v = L.project_velocity(&q, &[1.0, 0.0, 0.0].into()).expect("no dead centre");
    let rates = [q[0].cos(), (q[0] + q[1]).cos() * (v[0] + v[1]) / v[0], q[2].cos() * v[2] / v[0]];
    let lift = density * a * a / 2.0 * rates[0]
        + density * b * (a * rates[0] + b / 2.0 * rates[1])
        + density * c * c / 2.0 * rates[2];
    let tau = L.generalized_forces(&q, &[g * lift].into());
    let acceleration = L.forward_dynamics(&q, &SVector::zeros(), &tau);
    assert!(acceleration.amax() < 1e-12, "{acceleration}");
}

fn total_energy(q: &SVector<f64, 3>, v: &SVector<f64, 3>) -> f64 {
    L.kinetic_energy(q, v) + L.potential_energy(q)
}

fn four_bar_start_state() -> (SVector<f64, 3>, SVector<f64, 3>) {
    let q = configuration_at_crank_angle(0.7);
    (q, L.project_velocity(&q, &[12.0, 0.0, 0.0].into()).expect("no dead centre"))
}

/// Checks that the error of a fourth-order method decreases by 2⁴ when its step is halved, including the
/// constraints.
#[test]
fn four_bar_integration_has_order_four() -> Result<(), Error> {
    let (q, v) = four_bar_start_state();
    let exact = simulate(&L).from(q, v).method(precise_integrator()).duration(1.0).finish()?;
    assert_number_close(total_energy(&exact.q, &exact.v), total_energy(&q, &v), 1e-10);
    let errors_with_step = |h: f64| -> Result<[f64; 2], Error> {
        let end = simulate(&L).from(q, v).method(Rk4::step(h)).duration(1.0).finish()?;
        Ok([(end.q - exact.q).norm(), total_energy(&end.q, &end.v) - total_energy(&q, &v)])
    };
    let (coarse, fine) = (errors_with_step(4e-4)?, errors_with_step(2e-4)?);
    for (coarse, fine) in coarse.into_iter().zip(fine) {
        let ratio = coarse / fine;
        assert!((14.0..18.0).contains(&ratio), "{coarse:e} / {fine:e} = {ratio}");
    }
    Ok(())
}
