//! The words of an actuator and of its defaults → gain and bias.
//!
//! A class of defaults has one record of an actuator's law. Every shortcut in it writes its part, in the order of the file, and an
//! actuator begins with what they leave: a `<position>` keeps the constant force that a `<muscle>` among the defaults has written.

use super::defaults::{Element, some};
use crate::import::context::{Cx, quote};
use crate::import::element::{Node, number};
use crate::import::imported::Placed;
use std::f64::consts::PI;

/// What an actuator does: `gain · u + bias · (1, length, rate)`.
pub(super) struct Force {
    pub(super) gain: f64,
    pub(super) bias: [f64; 3],
}

pub(super) const OTHER_INPUTS: &str =
    "to leave the actuators of the file out, write `#[mechanism(…, inputs = joints)]`, or `none`";

/// What an actuator that says nothing does.
const PLAIN: Record<'static> = Record {
    dynamics: "none",
    gain_kind: "fixed",
    bias_kind: "none",
    gain: [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    bias: [0.0; 10],
};

/// `range`, `force`, `scale`, `lmin`, `lmax`, `vmax`, `fpmax`, `fvmax` of muscles.
const MUSCLE: [f64; 9] = [0.75, 1.05, -1.0, 200.0, 0.5, 1.6, 1.5, 1.3, 1.2];

/// The law of an actuator, as far as it is said.
struct Record<'a> {
    dynamics: &'a str,
    gain_kind: &'a str,
    bias_kind: &'a str,
    gain: [f64; 10],
    bias: [f64; 10],
}

/// Gain and bias of an actuator with its defaults; nothing if they are more than that.
pub(super) fn read_force(actuator: &Element<'_>, cx: &mut Cx<'_>) -> Option<Force> {
    let mut record = PLAIN;
    for node in actuator.outermost_first() {
        record.write(node, cx);
    }
    let node = actuator.node;
    let mut refuse = |attribute: &str, message: String, help: &'static str| {
        cx.error(&actuator.place(attribute, cx), message, |d| d.help(help));
    };
    let [g0, g1, g2, ..] = record.gain;
    let [b0, b1, b2, ..] = record.bias;
    let mut good = true;
    if record.dynamics != "none" {
        let (attribute, message) = match node.has_attribute("timeconst") {
            true => ("timeconst", "`timeconst` is not supported".to_string()),
            false => ("dyntype", format!("`dyntype` {} is not supported", quote(record.dynamics))),
        };
        refuse(attribute, message, OTHER_INPUTS);
        good = false;
    }
    for (attribute, word, known) in [
        ("gaintype", record.gain_kind, ["fixed", "affine"]),
        ("biastype", record.bias_kind, ["none", "affine"]),
    ] {
        if !known.contains(&word) {
            refuse(attribute, format!("`{attribute}` {} is not supported", quote(word)), OTHER_INPUTS);
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

impl<'a> Record<'a> {
    /// Writes what an actuator or a default says.
    fn write(&mut self, node: Node<'a>, cx: &mut Cx<'_>) {
        let mut said = |attribute: &str| number(node, attribute, cx).map(|found| found.value);
        match node.tag_name().name() {
            "general" => self.write_general(node, cx),
            "motor" => {
                self.gain[0] = 1.0;
                self.kinds("none", "fixed", "none");
            }
            kind @ ("position" | "intvelocity") => {
                let stiffness = said("kp").unwrap_or(self.gain[0]);
                (self.gain[0], self.bias[1]) = (stiffness, -stiffness);
                if let Some(damping) = said("kv") {
                    self.bias[2] = -damping;
                }
                if let Some(ratio) = said("dampratio") {
                    self.bias[2] = ratio;
                }
                let lag = said("timeconst").map(|lag| if lag == 0.0 { "none" } else { "filterexact" });
                let integrator = (kind == "intvelocity").then_some("integrator");
                self.kinds(integrator.or(lag).unwrap_or(self.dynamics), "fixed", "affine");
            }
            "velocity" => {
                let gain = said("kv").unwrap_or(self.gain[0]);
                (self.gain[0], self.bias) = (gain, [0.0; 10]);
                self.bias[2] = -gain;
                self.kinds("none", "fixed", "affine");
            }
            "damper" => {
                self.gain = [0.0; 10];
                self.gain[2] = -said("kv").unwrap_or(0.0);
                self.kinds("none", "affine", "none");
            }
            "cylinder" => {
                let area = said("diameter").map(|diameter| PI / 4.0 * diameter * diameter);
                self.gain[0] = area.or_else(|| said("area")).unwrap_or(self.gain[0]);
                let bias = [self.bias[0], self.bias[1], self.bias[2]];
                let [b0, b1, b2] = some(node, "bias", bias, cx).map_or(bias, |found| found.value);
                (self.bias[0], self.bias[1], self.bias[2]) = (b0, b1, b2);
                self.kinds("filter", "fixed", "affine");
            }
            "muscle" => self.write_muscle(node, cx),
            "adhesion" => {
                self.gain[0] = said("gain").unwrap_or(self.gain[0]);
                self.kinds(self.dynamics, "fixed", "none");
            }
            _ => {}
        }
    }

    fn kinds(&mut self, dynamics: &'a str, gain: &'a str, bias: &'a str) {
        (self.dynamics, self.gain_kind, self.bias_kind) = (dynamics, gain, bias);
    }

    fn write_general(&mut self, node: Node<'a>, cx: &mut Cx<'_>) {
        let word = |attribute: &str, usual: &'a str| node.attribute(attribute).map_or(usual, str::trim);
        let kinds = (
            word("dyntype", self.dynamics),
            word("gaintype", self.gain_kind),
            word("biastype", self.bias_kind),
        );
        self.kinds(kinds.0, kinds.1, kinds.2);
        let value = |found: Option<Placed<[f64; 10]>>, usual| found.map_or(usual, |found| found.value);
        self.gain = value(some(node, "gainprm", self.gain, cx), self.gain);
        self.bias = value(some(node, "biasprm", self.bias, cx), self.bias);
    }

    /// A muscle's figures are those of the gain and those of the bias.
    fn write_muscle(&mut self, node: Node<'a>, cx: &mut Cx<'_>) {
        let untouched = PLAIN.gain;
        for ((gain, plain), usual) in self.gain.iter_mut().zip(untouched).zip(MUSCLE) {
            if *gain == plain {
                *gain = usual;
            }
        }
        let ends = [self.gain[0], self.gain[1]];
        let range = some(node, "range", ends, cx).map_or(ends, |found| found.value);
        // Less than zero stands for what was there.
        for (gain, said) in self.gain.iter_mut().zip(range).filter(|(_, said)| *said >= 0.0) {
            *gain = said;
        }
        for (k, attribute) in
            ["force", "scale", "lmin", "lmax", "vmax", "fpmax", "fvmax"].into_iter().enumerate()
        {
            let said = number(node, attribute, cx).filter(|found| found.value >= 0.0);
            if let (Some(gain), Some(found)) = (self.gain.get_mut(k + 2), said) {
                *gain = found.value;
            }
        }
        self.bias = self.gain;
        self.bias[9] = 0.0;
        self.kinds("muscle", "muscle", "muscle");
    }
}
