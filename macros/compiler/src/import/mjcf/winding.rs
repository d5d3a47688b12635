//! Conversion of `<dcmotor>` attributes to actuator parameters in MuJoCo's order.

use super::defaults::numbers_with_defaults;
use crate::import::context::Cx;
use crate::import::element::{Node, read_number_attribute};

/// Parameters of an actuator's dynamics, gain and bias in MuJoCo's order.
type ActuatorParameters = [[f64; 10]; 3];

/// Returns the parameters of a DC motor. `usual` are the parameters of its defaults.
pub(super) fn motor_parameters(
    usual: ActuatorParameters,
    node: Node<'_>,
    cx: &mut Cx<'_>,
) -> ActuatorParameters {
    let [mut dynprm, mut gain, mut bias] = usual;
    macro_rules! read {
        ($attribute:literal, $usual:expr) => {{
            let usual = $usual;
            numbers_with_defaults(node, $attribute, usual, cx).map_or(usual, |found| found.value)
        }};
    }
    let [torque, emf] = read!("motorconst", [gain[1], 0.0]);
    let resistance = read_number_attribute(node, "resistance", cx).map_or(gain[0], |found| found.value);
    let nominal = read!("nominal", [0.0; 3]);
    let friction = read!("damping", [0.0; 3])[0];
    [gain[0], gain[1]] = motor_resistance_and_constant([torque, emf], resistance, nominal, friction);
    let controller = read!("controller", [gain[4], gain[5], gain[6], dynprm[7], dynprm[8], gain[7]]);
    [gain[4], gain[5], gain[6], dynprm[7], dynprm[8], gain[7]] = controller;
    let [_, _, current_rate] = read!("saturation", [0.0, 0.0, dynprm[1]]);
    dynprm[1] = current_rate;
    [bias[0], bias[1], bias[2]] = read!("cogging", [bias[0], bias[1], bias[2]]);
    let [inductance, lag] = read!("inductance", [0.0, dynprm[0]]);
    dynprm[0] = if inductance > 0.0 && gain[0] > 0.0 { inductance / gain[0] } else { lag };
    let [path, mut capacity, time, coefficient, reference, ambient] =
        read!("thermal", [dynprm[2], dynprm[3], 0.0, gain[2], gain[3], dynprm[4]]);
    let path = if time > 0.0 && capacity > 0.0 && path == 0.0 { time / capacity } else { path };
    if time > 0.0 && path > 0.0 && capacity == 0.0 {
        capacity = time / path;
    }
    [dynprm[2], dynprm[3], gain[2], gain[3], dynprm[4]] = [path, capacity, coefficient, reference, ambient];
    let bristles = read!("lugre", [dynprm[5], dynprm[6], bias[3], bias[4], bias[5]]);
    [dynprm[5], dynprm[6], bias[3], bias[4], bias[5]] = bristles;
    [dynprm, gain, bias]
}

/// Returns resistance and motor constant from those of the file, nominal voltage, stall torque and
/// no-load speed.
fn motor_resistance_and_constant(
    [torque, mut emf]: [f64; 2],
    resistance: f64,
    nominal: [f64; 3],
    friction: f64,
) -> [f64; 2] {
    let [voltage, stall, speed] = nominal;
    if voltage > 0.0 && emf <= 0.0 && speed > 0.0 {
        let ideal = voltage / speed;
        let loss = voltage * voltage - 4.0 * resistance * friction * speed * speed;
        emf = if friction > 0.0 && resistance > 0.0 && loss > 0.0 {
            (voltage + loss.sqrt()) / (2.0 * speed)
        } else if friction > 0.0 && resistance <= 0.0 && stall > 0.0 {
            Some(ideal - voltage * friction / stall).filter(|emf| *emf > 0.0).unwrap_or(ideal)
        } else {
            ideal
        };
    }
    let constant = match (torque > 0.0, emf > 0.0) {
        (true, true) => (torque * emf).sqrt(),
        (true, false) => torque,
        _ => emf,
    };
    let known = resistance != 0.0 || voltage <= 0.0 || stall <= 0.0 || constant <= 0.0;
    [if known { resistance } else { constant * voltage / stall }, constant]
}
