//! `<dcmotor>`: winding with resistance and inductance, back-EMF, temperature, cogging, friction of bristles,
//! and the controller of the motor (MuJoCo 4.0, "DC motor technical note").

use super::activation::{
    ActuatorNames, CONTROLS, OTHER_INPUTS, SymbolicActuatorLaw, TINY, report_unsupported_controller_limit,
    requested_controller_inputs,
};
use super::defaults::ElementWithDefaults;
use super::formula::ActuatorLawExpression;
use super::record::ActuatorRecord;
use crate::import::context::Cx;
use crate::import::imported::Located;

/// Writes the force of a motor with its states: temperature, deflection of the bristles, current.
pub(super) fn write_motor_law(
    law: &mut SymbolicActuatorLaw,
    actuator: &ElementWithDefaults<'_>,
    record: &ActuatorRecord<'_>,
    named: &ActuatorNames<'_>,
    cx: &mut Cx<'_>,
) -> Option<()> {
    let (dynprm, gain, bias) = (&record.dynprm, &record.gain, &record.bias);
    let none = actuator.trimmed_attribute_text("input") == Some("none");
    check_winding_constants(actuator, [gain[0], gain[1]], none, cx)?;
    report_unsupported_controller_limit(
        actuator,
        "controller",
        "the `slewmax` of a controller",
        dynprm[7],
        cx,
    )?;
    if gain[5] > 0.0 {
        report_unsupported_controller_limit(
            actuator,
            "controller",
            "the `Imax` of a controller",
            dynprm[8],
            cx,
        )?;
    }
    let [constant, lag] = [gain[1], dynprm[0]];
    let voltage = motor_voltage_from_inputs(law, actuator, gain, none, named, cx)?;
    let heats = dynprm[2] > 0.0;
    let resistance = match heats {
        // Temperature relative to the ambient temperature.
        true => {
            (law.actuator_state_formula("temperature", named) * gain[2]
                + (1.0 + gain[2] * (dynprm[4] - gain[3])))
                * gain[0]
        }
        false => law.constant_formula(gain[0]),
    };
    let driving = voltage - law.actuator_length_rate_formula() * constant;
    let current = match lag > 0.0 {
        true => law.actuator_state_formula("current", named),
        false => driving.clone() / resistance.clone(),
    };
    if heats {
        if dynprm[3] <= 0.0 {
            return report_unsupported_attribute(
                actuator,
                "thermal",
                "`thermal` without a capacitance or a time constant",
                cx,
            );
        }
        let cooling = law.actuator_state_formula("temperature", named) * (1.0 / dynprm[2]);
        let rate = (resistance.clone() * current.clone().square() - cooling) * (1.0 / dynprm[3]);
        law.add_actuator_state("temperature", "Temperature above ambient", "K", rate, named);
    }
    law.force = current.clone() * constant;
    if bias[0] != 0.0 {
        law.force = law.force.clone()
            + (law.actuator_length_formula() * bias[1] + bias[2]).apply_function("sin") * bias[0];
    }
    if dynprm[5] > 0.0 {
        add_bristle_friction(law, [dynprm[5], dynprm[6]], [bias[3], bias[4], bias[5]], named);
    }
    if lag > 0.0 {
        let rate = (driving / resistance - current) * (1.0 / lag);
        let rate = if dynprm[1] > 0.0 { rate.clamp_between(-dynprm[1], dynprm[1]) } else { rate };
        law.add_actuator_state("current", "Current", "A", rate, named);
    }
    let saturation = actuator.numbers_with_defaults("saturation", [0.0; 3], cx);
    law.limit = saturation.and_then(|found| {
        let [torque, current, _] = found.value;
        let value = if torque > 0.0 { torque } else { constant * current };
        (value > 0.0).then_some(Located { value, place: found.place })
    });
    Some(())
}

fn check_winding_constants(
    actuator: &ElementWithDefaults<'_>,
    [resistance, constant]: [f64; 2],
    none: bool,
    cx: &mut Cx<'_>,
) -> Option<()> {
    if resistance <= 0.0 {
        let message = "a motor needs a positive `resistance`, or `nominal` values from which it follows";
        return report_unsupported_attribute(actuator, "resistance", message, cx);
    }
    if constant < 0.0 || (constant == 0.0 && !none) {
        let message = "a motor needs a positive `motorconst`, or `nominal` values from which it follows";
        return report_unsupported_attribute(actuator, "motorconst", message, cx);
    }
    Some(())
}

fn report_unsupported_attribute<T>(
    actuator: &ElementWithDefaults<'_>,
    attribute: &str,
    message: &str,
    cx: &mut Cx<'_>,
) -> Option<T> {
    cx.report_error(&actuator.place_of_attribute_value(attribute, cx), message, |d| d.add_help(OTHER_INPUTS));
    None
}

/// Adds the inputs, and returns the voltage. The controller commands a torque and compensates the back-EMF.
fn motor_voltage_from_inputs(
    law: &mut SymbolicActuatorLaw,
    actuator: &ElementWithDefaults<'_>,
    gain: &[f64; 10],
    none: bool,
    named: &ActuatorNames<'_>,
    cx: &mut Cx<'_>,
) -> Option<ActuatorLawExpression> {
    let [resistance, constant, _, _, kp, ki, kd, maximum, ..] = *gain;
    let controls =
        if none { Vec::new() } else { requested_controller_inputs(actuator, "voltage", &CONTROLS, cx)? };
    let has_controller = controls.iter().any(|word| *word != "voltage");
    if !has_controller && [kp, ki, kd].into_iter().any(|gain| gain != 0.0) {
        let message = "the gains of `controller` have no effect without an input that it controls";
        return report_unsupported_attribute(actuator, "controller", message, cx);
    }
    if ki > 0.0 && !controls.contains(&"pos") {
        return report_unsupported_attribute(
            actuator,
            "controller",
            "the integral gain needs the input `pos`",
            cx,
        );
    }
    let mut torque = law.actuator_length_formula() * -kp - law.actuator_length_rate_formula() * kd;
    let mut raw = law.constant_formula(0.0);
    let mut error = law.constant_formula(0.0);
    for word in &controls {
        let unit = match *word {
            "pos" => "rad",
            "vel" => "rad/s",
            "ff" => "N·m",
            _ => "V",
        };
        let input = law.add_input(if controls.len() == 1 { "" } else { word }, unit, named);
        match *word {
            "pos" => {
                error = input.clone() - law.actuator_length_formula();
                torque = torque + input * kp;
            }
            "vel" => torque = torque + input * kd,
            "ff" => torque = torque + input,
            _ => raw = input,
        }
    }
    if !has_controller {
        return Some(raw);
    }
    if ki > 0.0 {
        torque = torque + law.actuator_state_formula("integral", named) * ki;
        law.add_actuator_state("integral", "Integral of the error", "rad·s", error, named);
    }
    let driven = torque * (resistance / constant) + law.actuator_length_rate_formula() * constant;
    let driven = if maximum > 0.0 { driven.clamp_between(-maximum, maximum) } else { driven };
    Some(driven + raw)
}

/// Adds the friction of LuGre's model: stiffness and damping of the bristles, and Coulomb torque, static
/// torque and Stribeck speed.
fn add_bristle_friction(
    law: &mut SymbolicActuatorLaw,
    [stiffness, damping]: [f64; 2],
    [coulomb, held, stribeck]: [f64; 3],
    named: &ActuatorNames<'_>,
) {
    let (rate, state) = (law.actuator_length_rate_formula(), law.actuator_state_formula("bristles", named));
    let decay = (-(rate.clone() * (1.0 / stribeck.max(TINY))).square()).apply_function("exp");
    let level = decay * (held - coulomb) + coulomb;
    let change = rate.clone() - rate.apply_function("abs") * stiffness / level * state.clone();
    law.force = law.force.clone() - state * stiffness - change.clone() * damping;
    law.add_actuator_state("bristles", "Deflection of the bristles", "rad", change, named);
}
