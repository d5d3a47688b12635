use crate::testing::{assert_number_close, precise_integrator};
use linkwork::prelude::*;
use linkwork_models::BrakedFlywheel;

const W: BrakedFlywheel = BrakedFlywheel { inertia: 0.3, brake_torque: 0.9, creep: 0.5 };

#[test]
fn braked_flywheel_runs_down() -> Result<(), Error> {
    let start = 12.0_f64;
    for sample in
        simulate(&W).from([0.0], [start]).method(precise_integrator()).duration(5.0).sample_every(0.5)
    {
        let Sample { t, v, .. } = sample?;
        let left = (start / W.creep).sinh() * (-W.brake_torque * t / (W.inertia * W.creep)).exp();
        assert_number_close(v[0], W.creep * left.asinh(), 1e-9);
    }
    Ok(())
}

#[test]
fn motor_drives_against_the_brake() {
    let tau = W.generalized_forces(&[0.0].into(), &[2.4].into());
    let a = W.forward_dynamics(&[0.0].into(), &[100.0].into(), &tau);
    assert_number_close(a[0], (2.4 - 0.9) / 0.3, 1e-14);
}
