//! Parameters of an actuator → its force, with the states of its activation.

use super::activation::{
    ActuatorNames, CONTROLS, OTHER_INPUTS, SymbolicActuatorLaw, TINY, report_unsupported_controller_limit,
    requested_controller_inputs,
};
use super::dc_motor;
use super::defaults::ElementWithDefaults;
use super::muscle;
use super::record::{ActuatorRecord, read_actuator_record};
use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, element_source_position};

/// Force law of an MJCF actuator.
pub(super) enum ActuatorForceLaw {
    /// Force `gain · u + bias · (1, length, rate)`.
    Affine {
        /// Factor of the input in the actuator's force.
        gain: f64,
        /// Constant term of the force, and factors of actuator length and rate.
        bias: [f64; 3],
    },
    /// Any other force law, as expressions.
    Law(Box<SymbolicActuatorLaw>),
}

/// Reads the force of an actuator with its defaults. `classes` contains the defaults from the outermost class
/// to the actuator's own. Reports actuators that are not supported, and returns `None` for them.
pub(super) fn read_actuator_force<'a>(
    actuator: &ElementWithDefaults<'a>,
    classes: &[Vec<Node<'a>>],
    named: &ActuatorNames<'_>,
    cx: &mut Cx<'_>,
) -> Option<ActuatorForceLaw> {
    let record = read_actuator_record(actuator, classes, cx);
    if !check_actuator_type(actuator, &record, cx) {
        return None;
    }
    let [g0, g1, g2, ..] = record.gain;
    let [b0, b1, b2, ..] = record.bias;
    let plain = record.gain_kind == "fixed" || (record.gain_kind == "affine" && g1 == 0.0 && g2 == 0.0);
    if record.dynamics == "none" && plain && ["none", "affine"].contains(&record.bias_kind) {
        let bias = if record.bias_kind == "affine" { [b0, b1, b2] } else { [0.0; 3] };
        return Some(ActuatorForceLaw::Affine { gain: g0, bias });
    }
    let mut law = SymbolicActuatorLaw::new(named, &element_source_position(actuator.node, cx));
    match record.gain_kind {
        "dcmotor" => dc_motor::write_motor_law(&mut law, actuator, &record, named, cx)?,
        "pid" => write_pid_law(&mut law, actuator, &record, named, cx)?,
        _ => write_general_law(&mut law, actuator, &record, named, cx)?,
    }
    Some(ActuatorForceLaw::Law(Box::new(law)))
}

/// Reports types that are not supported, and damping that depends on the inertia.
fn check_actuator_type(
    actuator: &ElementWithDefaults<'_>,
    record: &ActuatorRecord<'_>,
    cx: &mut Cx<'_>,
) -> bool {
    let mut good = true;
    let mut refuse_attribute = |attribute: &str, message: String, help: &'static str| {
        cx.report_error(&actuator.place_of_attribute_value(attribute, cx), message, |d| d.add_help(help));
        good = false;
    };
    let unsupported_message =
        |attribute: &str, word: &str| format!("`{attribute}` {} is not supported", quote_word(word));
    for (attribute, word, known) in [
        (
            "dyntype",
            record.dynamics,
            &["none", "integrator", "filter", "filterexact", "muscle", "pid", "dcmotor"][..],
        ),
        ("gaintype", record.gain_kind, &["fixed", "affine", "muscle", "pid", "dcmotor"][..]),
        ("biastype", record.bias_kind, &["none", "affine", "muscle", "dcmotor"][..]),
    ] {
        if !known.contains(&word) {
            refuse_attribute(attribute, unsupported_message(attribute, word), OTHER_INPUTS);
        }
    }
    for (word, three) in [("dcmotor", true), ("pid", false)] {
        let kinds = [record.gain_kind, record.dynamics, record.bias_kind];
        let matching = kinds[0] == word
            && if three {
                kinds == [word; 3]
            } else {
                [word, "none"].contains(&kinds[1]) && kinds[2] == "affine"
            };
        if kinds.contains(&word) && !matching {
            refuse_attribute(
                "gaintype",
                format!("`{word}` with other types"),
                "write the element `<dcmotor>` or `<pid>`",
            );
        }
    }
    let [g0, ..] = record.gain;
    let [_, b1, b2, ..] = record.bias;
    let servo = record.gain_kind == "fixed" && g0 == -b1;
    if record.bias_kind == "affine" && (servo || record.gain_kind == "pid") && b2 > 0.0 {
        refuse_attribute("dampratio", "`dampratio` is not supported".to_string(), "write `kv`");
    }
    good
}

/// Writes the force `gain · w + bias` with an optional state `w` in the place of the input.
fn write_general_law(
    law: &mut SymbolicActuatorLaw,
    actuator: &ElementWithDefaults<'_>,
    record: &ActuatorRecord<'_>,
    named: &ActuatorNames<'_>,
    cx: &mut Cx<'_>,
) -> Option<()> {
    let muscle = match [record.dynamics, record.gain_kind, record.bias_kind].contains(&"muscle") {
        true => Some(muscle::Muscle::read_muscle(actuator, record, cx)?),
        false => None,
    };
    let servo = record.gain[0] == -record.bias[1];
    let unit = match record.dynamics {
        _ if muscle.is_some() => "1",
        "integrator" if servo && named.length == "rad" => "rad/s",
        "integrator" if servo => "m/s",
        _ if servo => named.length,
        _ => "any",
    };
    let input = law.add_input("", unit, named);
    let state = law.actuator_state_formula("activation", named);
    let lag = record.dynprm[0].max(TINY);
    let rate = match record.dynamics {
        "integrator" => Some(input.clone()),
        "filter" | "filterexact" => Some((input.clone() - state.clone()) / law.constant_formula(lag)),
        "muscle" => Some(muscle::activation_rate(law, input.clone(), state.clone(), record)),
        _ => None,
    };
    let value = if rate.is_some() { state } else { input };
    if let Some(rate) = rate {
        let unit = match unit {
            "rad/s" => "rad",
            "m/s" => "m",
            other => other,
        };
        law.add_actuator_state("activation", "Activation", unit, rate, named);
    }
    let gain = match (record.gain_kind, &muscle) {
        ("muscle", Some(muscle)) => muscle.active_force(law),
        ("affine", _) => law.affine_formula(&record.gain),
        _ => law.constant_formula(record.gain[0]),
    };
    law.force = gain * value;
    match (record.bias_kind, &muscle) {
        ("muscle", Some(muscle)) => law.force = law.force.clone() + muscle.passive_force(law),
        ("affine", _) => law.force = law.force.clone() + law.affine_formula(&record.bias),
        _ => {}
    }
    Some(())
}

/// Writes the force of a PID controller: `kp (pos − length) + kv (vel − rate) + ff + ki z` with
/// `ż = pos − length`.
fn write_pid_law(
    law: &mut SymbolicActuatorLaw,
    actuator: &ElementWithDefaults<'_>,
    record: &ActuatorRecord<'_>,
    named: &ActuatorNames<'_>,
    cx: &mut Cx<'_>,
) -> Option<()> {
    let has_integral_state = record.dynamics == "pid";
    let integral = if has_integral_state { record.gain[0] } else { 0.0 };
    if has_integral_state {
        report_unsupported_controller_limit(actuator, "slewmax", "`slewmax`", record.dynprm[1], cx)?;
    }
    if integral > 0.0 {
        report_unsupported_controller_limit(actuator, "imax", "`imax`", record.dynprm[0], cx)?;
    }
    let controls = requested_controller_inputs(actuator, "pos vel", &CONTROLS[..3], cx)?;
    let [_, proportional, damping, ..] = record.bias;
    let mut force = law.affine_formula(&record.bias);
    let mut error = -law.actuator_length_formula();
    let single = controls.len() == 1;
    for word in &controls {
        let rad = named.length == "rad";
        let unit = match *word {
            "pos" => named.length,
            "vel" if rad => "rad/s",
            "vel" => "m/s",
            _ if rad => "N·m",
            _ => "N",
        };
        let input = law.add_input(if single { "" } else { word }, unit, named);
        match *word {
            "pos" => {
                error = input.clone() - law.actuator_length_formula();
                force = force - input * proportional;
            }
            "vel" => force = force - input * damping,
            _ => force = force + input,
        }
    }
    if integral > 0.0 {
        if !controls.contains(&"pos") {
            let message = "`ki` without the input `pos`";
            cx.report_error(&actuator.place_of_attribute_value("ki", cx), message, |d| {
                d.add_help("write `input=\"pos vel\"`")
            });
            return None;
        }
        force = force + law.actuator_state_formula("integral", named) * integral;
        let unit = if named.length == "rad" { "rad·s" } else { "m·s" };
        law.add_actuator_state("integral", "Integral of the error", unit, error, named);
    }
    law.force = force;
    Some(())
}
