use crate::testing::{assert_matrix_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::PlanarRotorcraft;

const R: PlanarRotorcraft = PlanarRotorcraft { g: 9.81, mass: 0.5, inertia: 0.003, arm: 0.17 };

#[test]
fn planar_rotorcraft_accelerations_match_closed_form() {
    let theta = 0.4_f64;
    let (q, v) = (SVector::from([1.0, 2.0, theta]), SVector::from([0.5, -0.3, 1.2]));
    let tau = R.generalized_forces(&q, &SVector::from([2.0, 3.1]));
    let x = -5.1 * theta.sin() / R.mass;
    let y = 5.1 * theta.cos() / R.mass - R.g;
    let turn = R.arm * 1.1 / R.inertia;
    assert_matrix_close(R.forward_dynamics(&q, &v, &tau), SVector::from([x, y, turn]), 1e-13);
}

#[test]
fn planar_rotorcraft_hovers_or_falls() -> Result<(), Error> {
    let hover = SVector::from([R.mass * R.g / 2.0; 2]);
    let q = SVector::from([0.3, 1.0, 0.0]);
    let held = simulate(&R).from(q, [0.0; 3]).inputs(|_, _, _| hover).duration(1.0).finish()?;
    assert_matrix_close(held.q, q, 1e-12);
    let thrown =
        simulate(&R).from(q, [2.0, 5.0, -3.0]).method(precise_integrator()).duration(0.8).finish()?;
    let expected = [0.3 + 1.6, 1.0 + 4.0 - R.g * 0.32, -2.4];
    assert_matrix_close(thrown.q, SVector::from(expected), 1e-12);
    Ok(())
}
