use crate::testing::{assert_acceleration_derivatives, assert_number_close, precise_integrator};
use linkwork::at;
use linkwork::prelude::*;
use linkwork_models::MuscleForearm;

const S: MuscleForearm = MuscleForearm {
    strength: 700.0,
    optimal: 0.11,
    slack: 0.18,
    tendon_stiffness: 600.0,
    passive_stiffness: 2.5,
    width: 0.55,
    fastest: 10.0,
    hill: 0.25,
    eccentric: 1.4,
    rise: 0.015,
    fall: 0.05,
    activation: 0.5,
    fibre: 1.0,
};

/// Angle of the elbow at which the muscle is level, with the muscle's length and the sine of its direction to
/// the forearm.
const LEVEL: (f64, f64, f64) = (0.0, 0.304_138_126_514_910_95, 0.986_393_923_832_143_8);

/// Returns the rates of angular velocity, activation and fibre length, in the level position at rest.
fn muscle_state_rates(muscle: &MuscleForearm, excitation: f64) -> SVector<f64, 3> {
    let whole = muscle.extended();
    let (q, v) = ([LEVEL.0].into(), [0.0, muscle.activation, muscle.fibre].into());
    assert_acceleration_derivatives(&whole, &q, &v, &[excitation].into(), 1e-6);
    at(&whole, 0.0).linear_motion(&q, &v, &[excitation].into()).acceleration
}

/// Returns the fibre length at which the tendon has the force `tendon`, both divided by their reference
/// values.
fn fibre_length_at_tendon_force(tendon: f64) -> f64 {
    (LEVEL.1 - 0.18 * (1.0 + (tendon / 600.0).sqrt())) / 0.11
}

#[test]
fn muscle_force_follows_hill_hyperbolas() {
    for ratio in [0.0, 0.3, 0.9, 1.1, 1.3] {
        // The activation determines the ratio of the forces.
        let tendon: f64 = if ratio == 0.0 { 0.0 } else { 0.35 };
        // Without force the tendon is slack.
        let length = fibre_length_at_tendon_force(tendon) + if ratio == 0.0 { 0.01 } else { 0.0 };
        let shape = (-((length - 1.0) / 0.55).powi(2)).exp();
        let passive = 2.5 * (length - 1.0).max(0.0).powi(2);
        let activation = if ratio == 0.0 { 0.5 } else { (tendon - passive) / (shape * ratio) };
        let muscle = MuscleForearm { fibre: length, activation, ..S };
        let part = (1.4 - ratio) / 0.4;
        let speed = if ratio < 1.0 {
            -10.0 * (1.0 - ratio) / (1.0 + ratio / 0.25)
        } else {
            10.0 * (1.0 - part) / (1.0 + (5.0 / 0.4 - 1.0) * part)
        };
        let found = muscle_state_rates(&muscle, 0.4);
        assert_number_close(found[2], speed, 1e-10);
        // Lever arm: 5 cm times the sine.
        let torque = 700.0 * tendon * 0.05 * LEVEL.2 - 1.5 * 9.81 * 0.15;
        assert_number_close(found[0], torque / (1.5 * (0.3 * 0.3 / 12.0 + 0.15 * 0.15)), 1e-11);
    }
}

#[test]
fn muscle_activation_times_match_closed_form() -> Result<(), Error> {
    let whole = S.extended();
    let final_activation = |from: f64, to: f64, time: f64| {
        let run = simulate(&whole).from([0.0], [0.0, from, 1.0]).inputs(move |_, _, _| [to].into());
        run.duration(time).method(precise_integrator()).finish().map(|end| end.v[1])
    };
    // Time of the rise from 0.1 to 0.9 at full excitation, by separation of the variables.
    let time = 0.015 * (-1.5 * (0.9 - 0.1) - 2.0 * (0.1_f64 / 0.9).ln());
    assert_number_close(final_activation(0.1, 1.0, time)?, 0.9, 1e-8);
    // Time of the fall from 0.9 to 0.2 at the excitation 0.1.
    let deactivation_time_integral = |a: f64| ((0.5 + 1.5 * a) / (a - 0.1)).ln() / (0.5 + 1.5 * 0.1);
    assert_number_close(
        final_activation(
            0.9,
            0.1,
            0.05 * (deactivation_time_integral(0.2) - deactivation_time_integral(0.9)),
        )?,
        0.2,
        1e-8,
    );
    Ok(())
}
