//! Attributes of an actuator and of its defaults → parameters of the actuator.
//!
//! Each class of defaults stores one record of actuator parameters, which its elements modify in the order of
//! the file (MuJoCo 4.0, *Modeling*, "Shortcuts"). A shortcut starts with its own default values or with
//! those of the nearest class whose record it can interpret: a record last written by the same shortcut, or
//! by `<general>` with a constant gain. `<general>` modifies the record of its class.

use super::defaults::{ElementWithDefaults, numbers_with_defaults};
use super::winding;
use crate::import::context::Cx;
use crate::import::element::{Node, read_number_attribute};
use crate::import::imported::Located;
use std::f64::consts::PI;

/// Parameters of an actuator as MuJoCo stores them.
#[derive(Clone, Copy)]
pub(super) struct ActuatorRecord<'a> {
    /// Type of the element whose attributes were read last.
    written: &'a str,
    pub(super) dynamics: &'a str,
    pub(super) gain_kind: &'a str,
    pub(super) bias_kind: &'a str,
    pub(super) dynprm: [f64; 10],
    pub(super) gain: [f64; 10],
    pub(super) bias: [f64; 10],
}

/// Actuator parameters of MuJoCo without any attribute.
const PLAIN: ActuatorRecord<'static> = ActuatorRecord {
    written: "general",
    dynamics: "none",
    gain_kind: "fixed",
    bias_kind: "none",
    dynprm: padded_parameters(&[1.0]),
    gain: padded_parameters(&[1.0]),
    bias: [0.0; 10],
};

/// Gain parameters of a MuJoCo muscle without any attribute.
const MUSCLE: [f64; 10] = padded_parameters(&[0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2]);

/// Returns ten actuator parameters: the given first ones, followed by zeros.
pub(super) const fn padded_parameters(first: &[f64]) -> [f64; 10] {
    let (mut all, mut k) = ([0.0; 10], 0);
    while k < first.len() && k < 10 {
        all[k] = first[k];
        k += 1;
    }
    all
}

/// Returns the record of an actuator with its defaults. `classes` contains the defaults from the outermost
/// class to the actuator's own.
pub(super) fn read_actuator_record<'a>(
    actuator: &ElementWithDefaults<'a>,
    classes: &[Vec<Node<'a>>],
    cx: &mut Cx<'_>,
) -> ActuatorRecord<'a> {
    let mut records = vec![PLAIN];
    for class in classes {
        records.extend(records.last().copied());
        for node in class {
            write_attributes_to_last_record(&mut records, *node, cx);
        }
    }
    records.extend(records.last().copied());
    write_attributes_to_last_record(&mut records, actuator.node, cx);
    records.last().copied().unwrap_or(PLAIN)
}

/// Writes the attributes of an actuator or of its defaults to the last record. The preceding records belong
/// to the parent classes.
fn write_attributes_to_last_record<'a>(records: &mut [ActuatorRecord<'a>], node: Node<'a>, cx: &mut Cx<'_>) {
    let kind = node.tag_name().name();
    let is_record_of_kind = |record: &&ActuatorRecord<'a>| {
        record.written == kind || (record.written == "general" && record.gain_kind == "fixed")
    };
    let usual = records.iter().rev().find(is_record_of_kind).copied().unwrap_or(PLAIN);
    // The parameters of these are not those of `<general>`.
    let own = if usual.written == kind { usual } else { PLAIN };
    let Some(record) = records.last_mut() else { return };
    let mut attribute_number =
        |attribute: &str| read_number_attribute(node, attribute, cx).map(|found| found.value);
    let actuator_shortcut_record = |dynamics, gain_kind, gain, bias_kind, bias: [f64; 3]| ActuatorRecord {
        written: kind,
        dynamics,
        gain_kind,
        bias_kind,
        dynprm: PLAIN.dynprm,
        gain: padded_parameters(&[gain]),
        bias: padded_parameters(&bias),
    };
    *record = match kind {
        "general" => {
            record.record_general_actuator(node, cx);
            return;
        }
        "motor" => actuator_shortcut_record("none", "fixed", 1.0, "none", [0.0; 3]),
        "position" | "intvelocity" => {
            let stiffness = attribute_number("kp").unwrap_or(usual.gain[0]);
            let damping = attribute_number("kv")
                .map(|kv| -kv)
                .or_else(|| attribute_number("dampratio"))
                .unwrap_or(usual.bias[2]);
            let lag = attribute_number("timeconst").unwrap_or(usual.dynprm[0]);
            let filtered = match node.has_attribute("timeconst") {
                true => lag != 0.0,
                false => usual.dynamics == "filterexact",
            };
            let dynamics = match (kind, filtered) {
                ("intvelocity", _) => "integrator",
                (_, true) => "filterexact",
                _ => "none",
            };
            let written =
                actuator_shortcut_record(dynamics, "fixed", stiffness, "affine", [0.0, -stiffness, damping]);
            ActuatorRecord { dynprm: padded_parameters(&[lag]), ..written }
        }
        "velocity" => {
            let gain = attribute_number("kv").unwrap_or(usual.gain[0]);
            actuator_shortcut_record("none", "fixed", gain, "affine", [0.0, 0.0, -gain])
        }
        "damper" => {
            let mut record = actuator_shortcut_record("none", "affine", 0.0, "none", [0.0; 3]);
            record.gain[2] = attribute_number("kv").map_or(usual.gain[2], |kv| -kv);
            record
        }
        "cylinder" => {
            let lag = attribute_number("timeconst").unwrap_or(usual.dynprm[0]);
            let area = attribute_number("area").unwrap_or(usual.gain[0]);
            let area = attribute_number("diameter").map_or(area, |diameter| PI / 4.0 * diameter * diameter);
            let bias = numbers_with_defaults(node, "bias", [0.0; 3], cx).map(|found| found.value);
            let [b0, b1, b2, ..] = usual.bias;
            let written =
                actuator_shortcut_record("filter", "fixed", area, "affine", bias.unwrap_or([b0, b1, b2]));
            ActuatorRecord { dynprm: padded_parameters(&[lag]), ..written }
        }
        "muscle" => record_of_muscle(own, node, cx),
        "adhesion" => actuator_shortcut_record(
            "none",
            "fixed",
            attribute_number("gain").unwrap_or(usual.gain[0]),
            "none",
            [0.0; 3],
        ),
        "orientation" => actuator_shortcut_record("none", "so3", 1.0, "affine", [0.0; 3]),
        "dcmotor" => {
            let known = own.gain_kind == "dcmotor";
            let [dynprm, gain, bias] = if known { [own.dynprm, own.gain, own.bias] } else { [[0.0; 10]; 3] };
            let [dynprm, gain, bias] = winding::motor_parameters([dynprm, gain, bias], node, cx);
            ActuatorRecord {
                dynprm,
                gain,
                bias,
                ..actuator_shortcut_record("dcmotor", "dcmotor", 1.0, "dcmotor", [0.0; 3])
            }
        }
        "pid" => {
            let known = own.gain_kind == "pid";
            let stiffness = attribute_number("kp").unwrap_or(if known { -own.bias[1] } else { 1.0 });
            let damping = attribute_number("kv")
                .map(|kv| -kv)
                .or_else(|| attribute_number("dampratio"))
                .unwrap_or(own.bias[2]);
            let integral = attribute_number("ki").unwrap_or(if known { own.gain[0] } else { 0.0 });
            let limits = if known { own.dynprm } else { [0.0; 10] };
            let limits = [("imax", limits[0]), ("slewmax", limits[1])];
            let [imax, slew] = limits.map(|(attribute, usual)| attribute_number(attribute).unwrap_or(usual));
            let dynamics = if integral != 0.0 || slew != 0.0 { "pid" } else { "none" };
            let written =
                actuator_shortcut_record(dynamics, "pid", integral, "affine", [0.0, -stiffness, damping]);
            ActuatorRecord { dynprm: padded_parameters(&[imax, slew]), ..written }
        }
        _ => actuator_shortcut_record("none", kind, 1.0, "affine", [0.0; 3]),
    };
}

/// Returns the parameters of a muscle. `own` are those of its defaults.
fn record_of_muscle<'a>(own: ActuatorRecord<'a>, node: Node<'a>, cx: &mut Cx<'_>) -> ActuatorRecord<'a> {
    let known = own.gain_kind == "muscle";
    let (times, mut gain) =
        if known { (own.dynprm, own.gain) } else { (padded_parameters(&[0.01, 0.04]), MUSCLE) };
    let [rise, fall, width, ..] = times;
    // Negative values leave those of the defaults.
    let nonnegative_or_default = |found: f64, usual: f64| if found >= 0.0 { found } else { usual };
    let times =
        numbers_with_defaults(node, "timeconst", [rise, fall], cx).map_or([rise, fall], |found| found.value);
    let range = numbers_with_defaults(node, "range", [gain[0], gain[1]], cx)
        .map_or([gain[0], gain[1]], |found| found.value);
    gain[0] = nonnegative_or_default(range[0], gain[0]);
    gain[1] = nonnegative_or_default(range[1], gain[1]);
    let mut attribute_number =
        |attribute: &str| read_number_attribute(node, attribute, cx).map(|found| found.value);
    for (k, attribute) in ["force", "scale", "lmin", "lmax", "vmax", "fpmax", "fvmax"].into_iter().enumerate()
    {
        gain[k + 2] = nonnegative_or_default(attribute_number(attribute).unwrap_or(-1.0), gain[k + 2]);
    }
    let width = attribute_number("tausmooth").unwrap_or(width);
    let dynprm = padded_parameters(&[
        nonnegative_or_default(times[0], rise),
        nonnegative_or_default(times[1], fall),
        width,
    ]);
    ActuatorRecord {
        written: "muscle",
        dynamics: "muscle",
        gain_kind: "muscle",
        bias_kind: "muscle",
        dynprm,
        gain,
        bias: gain,
    }
}

impl<'a> ActuatorRecord<'a> {
    fn record_general_actuator(&mut self, node: Node<'a>, cx: &mut Cx<'_>) {
        let trimmed_or_default =
            |attribute: &str, usual: &'a str| node.attribute(attribute).map_or(usual, str::trim);
        (self.written, self.dynamics) = ("general", trimmed_or_default("dyntype", self.dynamics));
        (self.gain_kind, self.bias_kind) =
            (trimmed_or_default("gaintype", self.gain_kind), trimmed_or_default("biastype", self.bias_kind));
        let value_or_default =
            |found: Option<Located<[f64; 10]>>, usual| found.map_or(usual, |found| found.value);
        self.dynprm = value_or_default(numbers_with_defaults(node, "dynprm", self.dynprm, cx), self.dynprm);
        self.gain = value_or_default(numbers_with_defaults(node, "gainprm", self.gain, cx), self.gain);
        self.bias = value_or_default(numbers_with_defaults(node, "biasprm", self.bias, cx), self.bias);
    }
}
