use crate::testing::{assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::NutOnScrew;
use std::f64::consts::TAU;

const N: NutOnScrew = NutOnScrew { g: 9.81, mass: 0.6, radius: 0.03, pitch: 0.008 };

#[test]
fn nut_on_screw_acceleration_has_closed_form() {
    let p = N.pitch;
    let inertia = N.mass * N.radius * N.radius / 2.0 + N.mass * p * p;
    let tau = N.inverse_dynamics(&[1.2].into(), &[3.0].into(), &[0.7].into());
    assert_number_close(tau[0], inertia * 0.7 + N.mass * N.g * p, 1e-15);
    assert_number_close(N.height(&[TAU].into()), TAU * p, 1e-15);
    let held = N.generalized_forces(&[1.2].into(), &[N.mass * N.g * p].into());
    assert_number_close(N.forward_dynamics(&[1.2].into(), &[0.0].into(), &held)[0], 0.0, 1e-12);
}

#[test]
fn nut_descends_with_constant_acceleration() -> Result<(), Error> {
    let p = N.pitch;
    let fall = N.g / (1.0 + N.radius * N.radius / (2.0 * p * p));
    let end = simulate(&N).method(precise_integrator()).duration(1.5).finish()?;
    assert_number_close(N.height(&end.q), -fall * 1.5 * 1.5 / 2.0, 1e-11);
    Ok(())
}
