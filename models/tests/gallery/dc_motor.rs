use crate::testing::{
    assert_acceleration_derivatives, assert_matrix_close, assert_number_close, precise_integrator,
};
use linkwork::at;
use linkwork::prelude::*;
use linkwork_models::DcMotor;

const S: DcMotor = DcMotor {
    resistance: 1.3,
    inductance: 0.02,
    constant: 0.06,
    inertia: 4e-4,
    friction: 2e-3,
    current: 0.0,
};

#[test]
fn dc_motor_has_winding_and_rotor_poles() {
    let (q, v, u) = ([0.4].into(), [30.0, 2.5].into(), [9.0].into());
    assert_acceleration_derivatives(&S.extended(), &q, &v, &u, 1e-6);
    let linear = at(&S.extended(), 0.0).linear_motion(&q, &v, &u);
    let expected = SVector::from([(0.06 * 2.5 - 2e-3 * 30.0) / 4e-4, (9.0 - 0.06 * 30.0 - 1.3 * 2.5) / 0.02]);
    assert_matrix_close(linear.acceleration, expected, 1e-13);
    // The trace and the determinant of the block of speed and current.
    let block = linear.by_v;
    assert_number_close(block.trace(), -(1.3 / 0.02 + 2e-3 / 4e-4), 1e-13);
    assert_number_close(block.determinant(), (1.3 * 2e-3 + 0.06 * 0.06) / (0.02 * 4e-4), 1e-13);
}

#[test]
fn dc_motor_current_and_speed_rise() -> Result<(), Error> {
    // A heavy rotor stays at rest while the current rises.
    let heavy = DcMotor { inertia: 1e9, ..S };
    let whole = heavy.extended();
    let run = simulate(&whole).from([0.0], [0.0, 0.0]).inputs(|_, _, _| [12.0].into());
    let end = run.duration(0.02).method(precise_integrator()).finish()?;
    assert_number_close(end.v[1], 12.0 / 1.3 * (1.0 - (-1.3_f64).exp()), 1e-10);

    let whole = S.extended();
    let run = simulate(&whole).from([0.0], [0.0, 0.0]).inputs(|_, _, _| [12.0].into());
    let end = run.duration(5.0).finish()?;
    assert_number_close(end.v[0], 0.06 * 12.0 / (0.06 * 0.06 + 1.3 * 2e-3), 1e-6);
    Ok(())
}

/// Checks that the electrical power is the sum of the heat of winding and bearings and of the change of both
/// energies.
#[test]
fn dc_motor_power_is_balanced() {
    let (speed, current, voltage) = (40.0, 3.0, 11.0);
    let whole = S.extended();
    let rates = at(&whole, 0.0).linear_motion(&[0.0].into(), &[speed, current].into(), &[voltage].into());
    let stored = 4e-4 * speed * rates.acceleration[0] + 0.02 * current * rates.acceleration[1];
    assert_number_close(1.3 * current * current + 2e-3 * speed * speed + stored, voltage * current, 1e-12);
}
