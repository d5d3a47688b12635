//! Attributes of an actuator and of its defaults → gain and bias.
//!
//! Each class of defaults stores one record of actuator parameters, which its elements modify in the order of
//! the file (MuJoCo 4.0, *Modeling*, "Shortcuts"). A shortcut starts with its own default values or with
//! those of the nearest class whose record it can interpret: a record last written by the same shortcut, or
//! by `<general>` with a constant gain. `<general>` modifies the record of its class.

use super::defaults::{Element, some};
use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, read_number_attribute};
use crate::import::imported::Placed;

/// Force of an actuator: `gain · u + bias · (1, length, rate)`.
pub(super) struct Force {
    pub(super) gain: f64,
    pub(super) bias: [f64; 3],
}

pub(super) const OTHER_INPUTS: &str =
    "to ignore the actuators of the file, write `#[mechanism(…, inputs = joints)]`, or `none`";

/// Parameters of an actuator without attributes.
const PLAIN: Record<'static> = Record {
    written: "general",
    dynamics: "none",
    gain_kind: "fixed",
    bias_kind: "none",
    gain: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    bias: [0.0; 10],
};

/// Parameters of an actuator as MuJoCo stores them.
#[derive(Clone, Copy)]
struct Record<'a> {
    /// Name of the element that wrote the record last.
    written: &'a str,
    dynamics: &'a str,
    gain_kind: &'a str,
    bias_kind: &'a str,
    gain: [f64; 10],
    bias: [f64; 10],
}

/// Returns gain and bias of an actuator with its defaults. `classes` contains the defaults from the outermost
/// class to the actuator's own. Reports actuators that are not affine in input, length and rate, and returns
/// `None` for them.
pub(super) fn read_force<'a>(
    actuator: &Element<'a>,
    classes: &[Vec<Node<'a>>],
    cx: &mut Cx<'_>,
) -> Option<Force> {
    let mut records = vec![PLAIN];
    for class in classes {
        records.extend(records.last().copied());
        for node in class {
            write(&mut records, *node, cx);
        }
    }
    records.extend(records.last().copied());
    write(&mut records, actuator.node, cx);
    let record = records.last().copied().unwrap_or(PLAIN);
    let node = actuator.node;
    let mut refuse = |attribute: &str, message: String, help: &'static str| {
        cx.report_error(&actuator.place(attribute, cx), message, |d| d.add_help(help));
    };
    let [g0, g1, g2, ..] = record.gain;
    let [b0, b1, b2, ..] = record.bias;
    let mut good = true;
    if record.dynamics != "none" {
        let (attribute, message) = match node.has_attribute("timeconst") {
            true => ("timeconst", "`timeconst` is not supported".to_string()),
            false => ("dyntype", format!("`dyntype` {} is not supported", quote_word(record.dynamics))),
        };
        refuse(attribute, message, OTHER_INPUTS);
        good = false;
    }
    for (attribute, word, known) in [
        ("gaintype", record.gain_kind, ["fixed", "affine"]),
        ("biastype", record.bias_kind, ["none", "affine"]),
    ] {
        if !known.contains(&word) {
            refuse(attribute, format!("`{attribute}` {} is not supported", quote_word(word)), OTHER_INPUTS);
            good = false;
        }
    }
    if record.gain_kind == "affine" && (g1 != 0.0 || g2 != 0.0) {
        refuse("gainprm", "a gain that depends on the motion is not supported".to_string(), OTHER_INPUTS);
        good = false;
    }
    let affine = record.bias_kind == "affine";
    if affine && record.gain_kind == "fixed" && g0 == -b1 && b2 > 0.0 {
        refuse("dampratio", "`dampratio` is not supported".to_string(), "write `kv`");
        good = false;
    }
    good.then_some(Force { gain: g0, bias: if affine { [b0, b1, b2] } else { [0.0; 3] } })
}

/// Writes the attributes of an actuator or of its defaults to the last record. The preceding records belong
/// to the parent classes.
fn write<'a>(records: &mut [Record<'a>], node: Node<'a>, cx: &mut Cx<'_>) {
    let kind = node.tag_name().name();
    let readable = |record: &&Record<'a>| {
        record.written == kind || (record.written == "general" && record.gain_kind == "fixed")
    };
    let usual = records.iter().rev().find(readable).copied().unwrap_or(PLAIN);
    let Some(record) = records.last_mut() else { return };
    let mut said = |attribute: &str| read_number_attribute(node, attribute, cx).map(|found| found.value);
    let law = |dynamics, gain_kind, gain, bias_kind, bias: [f64; 3]| Record {
        written: kind,
        dynamics,
        gain_kind,
        bias_kind,
        gain: std::array::from_fn(|k| if k == 0 { gain } else { 0.0 }),
        bias: std::array::from_fn(|k| bias.get(k).copied().unwrap_or(0.0)),
    };
    *record = match kind {
        "general" => {
            record.write_general(node, cx);
            return;
        }
        "motor" => law("none", "fixed", 1.0, "none", [0.0; 3]),
        "position" | "intvelocity" => {
            let stiffness = said("kp").unwrap_or(usual.gain[0]);
            let damping = said("kv").map(|kv| -kv).or_else(|| said("dampratio")).unwrap_or(usual.bias[2]);
            let filtered = said("timeconst").map_or(usual.dynamics == "filterexact", |lag| lag != 0.0);
            let dynamics = match (kind, filtered) {
                ("intvelocity", _) => "integrator",
                (_, true) => "filterexact",
                _ => "none",
            };
            law(dynamics, "fixed", stiffness, "affine", [0.0, -stiffness, damping])
        }
        "velocity" => {
            let gain = said("kv").unwrap_or(usual.gain[0]);
            law("none", "fixed", gain, "affine", [0.0, 0.0, -gain])
        }
        "damper" => {
            let mut record = law("none", "affine", 0.0, "none", [0.0; 3]);
            record.gain[2] = said("kv").map_or(usual.gain[2], |kv| -kv);
            record
        }
        "cylinder" => law("filter", "fixed", 1.0, "affine", [0.0; 3]),
        "muscle" => law("muscle", "muscle", 1.0, "muscle", [0.0; 3]),
        "adhesion" => law("none", "fixed", said("gain").unwrap_or(usual.gain[0]), "none", [0.0; 3]),
        "orientation" => law("none", "so3", 1.0, "affine", [0.0; 3]),
        "dcmotor" => law("dcmotor", "dcmotor", 1.0, "dcmotor", [0.0; 3]),
        _ => law("none", kind, 1.0, "affine", [0.0; 3]),
    };
}

impl<'a> Record<'a> {
    fn write_general(&mut self, node: Node<'a>, cx: &mut Cx<'_>) {
        let word = |attribute: &str, usual: &'a str| node.attribute(attribute).map_or(usual, str::trim);
        (self.written, self.dynamics) = ("general", word("dyntype", self.dynamics));
        (self.gain_kind, self.bias_kind) =
            (word("gaintype", self.gain_kind), word("biastype", self.bias_kind));
        let value = |found: Option<Placed<[f64; 10]>>, usual| found.map_or(usual, |found| found.value);
        self.gain = value(some(node, "gainprm", self.gain, cx), self.gain);
        self.bias = value(some(node, "biasprm", self.bias, cx), self.bias);
    }
}
