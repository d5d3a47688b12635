use crate::testing::{
    assert_acceleration_derivatives, assert_matrix_close, assert_number_close, precise_integrator,
};
use linkwork::prelude::*;
use linkwork_models::GearedJoint;
use std::f64::consts::PI;

const S: GearedJoint = GearedJoint {
    rotor_inertia: 2e-5,
    inertia: 0.3,
    ratio: 80.0,
    stiffness: 4000.0,
    backlash: 2e-3,
    loss: 0.25,
    creep: 1e-3,
};

/// Returns the accelerations of rotor and link for a torque of the teeth, a direction of rotation and a motor
/// torque `drive`.
fn rotor_and_link_accelerations(torque: f64, direction: f64, drive: f64) -> SVector<f64, 2> {
    let twist = torque / 4000.0 + torque.signum() * 1e-3;
    let (q, v) = ([80.0 * (twist + 0.1), 0.1].into(), SVector::from([80.0, 1.0]) * direction);
    assert_number_close(S.torque(&q), torque, 1e-12);
    assert_acceleration_derivatives(&S, &q, &v, &[drive].into(), 1e-6);
    S.forward_dynamics(&q, &v, &S.generalized_forces(&q, &[drive].into()))
}

#[test]
fn gear_teeth_lose_a_fraction_of_load() {
    for (torque, direction) in [(50.0, 1.0), (50.0, -1.0), (-50.0, 1.0), (-50.0, -1.0)] {
        let rotor = (0.4 - torque / 80.0 - 0.25 * 50.0 / 80.0 * direction) / 2e-5;
        let expected = SVector::from([rotor, torque / 0.3]);
        assert_matrix_close(rotor_and_link_accelerations(torque, direction, 0.4), expected, 1e-11);
    }
    // Both inertias accelerate together.
    let (drive, reduced) = (0.4, 80.0 * 80.0 * 2e-5 + 1.25 * 0.3);
    let joint = 80.0 * drive / reduced;
    assert_matrix_close(
        rotor_and_link_accelerations(0.3 * joint, 1.0, drive),
        SVector::from([80.0 * joint, joint]),
        1e-11,
    );
}

#[test]
fn gear_efficiencies_hold_in_both_directions() {
    let input_and_output_power = |drive: f64, torque: f64, direction: f64| {
        let a = rotor_and_link_accelerations(torque, direction, drive);
        assert_number_close(a[0] * 2e-5, 0.0, 1e-12);
        (drive * 80.0 * direction, torque * direction)
    };
    let (motor, link) = input_and_output_power(50.0 * 1.25 / 80.0, 50.0, 1.0);
    assert_number_close(link / motor, 1.0 / 1.25, 1e-12);
    let (motor, link) = input_and_output_power(50.0 * 0.75 / 80.0, 50.0, -1.0);
    assert_number_close(motor / link, 0.75, 1e-12);
}

#[test]
fn gear_oscillates_through_backlash() -> Result<(), Error> {
    let lossless = GearedJoint { loss: 0.0, ..S };
    let reduced = 1.0 / (1.0 / (80.0 * 80.0 * 2e-5) + 1.0 / 0.3);
    let speed = 0.02;
    let period = 2.0 * PI * (reduced / 4000.0_f64).sqrt() + 2.0 * 2e-3 / speed;
    // The centre of mass is at rest: both speeds are inversely proportional to the inertias.
    let rotor = speed * reduced / (80.0 * 80.0 * 2e-5);
    let start = SVector::from([80.0 * rotor, rotor - speed]);
    let run = simulate(&lossless).from([0.0, 0.0], start).duration(period).method(precise_integrator());
    let end = run.finish()?;
    assert_matrix_close(end.v, start, 1e-5);
    assert_number_close(end.q[0] / 80.0 - end.q[1], 0.0, 1e-7);
    Ok(())
}

#[test]
fn high_friction_gear_is_self_locking() {
    let worm = GearedJoint { loss: 1.0, ..S };
    let q = [-80.0 * (1e-3 + 50.0 / 4000.0), 0.0].into();
    let a = worm.forward_dynamics(&q, &[80.0, 1.0].into(), &[0.0, 0.0].into());
    assert_number_close(a[0] * 2e-5, 0.0, 1e-12);
}
