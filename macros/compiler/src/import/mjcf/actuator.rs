//! `<actuator>` → inputs, with the springs and dampers that servos are.
//!
//! An actuator has a length: a gear ratio times a coordinate or the length of a tendon. Its force is `gain · u + b₀ + b₁ length +
//! b₂ rate` (MuJoCo, *Computation*, "Actuation model", with neither activation nor muscles).

use super::defaults::Element;
use super::law::{Force, OTHER_INPUTS, read_force};
use super::reader::Reader;
use super::tendon::Tendon;
use crate::import::context::Cx;
use crate::import::element::{Node, check_attributes, elements, name, place};
use crate::import::imported::Placed;
use crate::import::robot::unused;
use crate::syntax::{Drive, DriveLaw, InputOption, JointKind, Name};
use std::collections::BTreeSet;

/// The shortcuts that are understood, and `general`.
const KNOWN: [&str; 4] = ["motor", "position", "velocity", "general"];

/// All of MuJoCo's.
const ALL: [&str; 11] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "plugin",
    "dcmotor",
];

const ATTRIBUTES: [&str; 48] = [
    "name",
    "class",
    "group",
    "nsample",
    "interp",
    "delay",
    "ctrllimited",
    "forcelimited",
    "actlimited",
    "ctrlrange",
    "forcerange",
    "actrange",
    "lengthrange",
    "gear",
    "cranklength",
    "damping",
    "armature",
    "joint",
    "jointinparent",
    "tendon",
    "slidersite",
    "cranksite",
    "site",
    "refsite",
    "body",
    "actdim",
    "dyntype",
    "gaintype",
    "biastype",
    "dynprm",
    "gainprm",
    "biasprm",
    "actearly",
    "kp",
    "kv",
    "dampratio",
    "timeconst",
    "inheritrange",
    "user",
    "kd",
    "ki",
    "area",
    "diameter",
    "bias",
    "gain",
    "force",
    "scale",
    "plugin",
];

impl<'a> Reader<'a> {
    /// Reads all actuators.
    pub(super) fn actuators(&mut self, root: Node<'a>, tendons: &[Tendon], cx: &mut Cx<'_>) {
        let groups = elements(root).filter(|node| node.tag_name().name() == "actuator");
        let nodes: Vec<Node<'a>> = groups.flat_map(elements).collect();
        if self.options.inputs != InputOption::Actuators || !self.settings.actuation {
            if !nodes.is_empty() {
                self.left_out.push(format!("{} actuators", nodes.len()));
            }
            return;
        }
        let mut names: BTreeSet<String> =
            nodes.iter().filter_map(|node| node.attribute("name")).map(str::to_string).collect();
        for node in nodes {
            self.actuator(node, tendons, &mut names, cx);
        }
    }

    fn actuator(
        &mut self,
        node: Node<'a>,
        tendons: &[Tendon],
        names: &mut BTreeSet<String>,
        cx: &mut Cx<'_>,
    ) {
        let kind = node.tag_name().name();
        if !KNOWN.contains(&kind) {
            cx.error(&place(node, cx), format!("actuator `<{kind}>` is not supported"), |d| {
                match ALL.contains(&kind) {
                    true => d.help(OTHER_INPUTS),
                    false => d.suggest(kind, ALL),
                }
            });
            return;
        }
        check_attributes(node, &[], &ATTRIBUTES, cx);
        // What all actuators have may be said in the defaults of any.
        let any = self.defaults.element(node, &ALL, 0, cx);
        let (Some((terms, turns)), Some(force)) =
            (self.transmission(&any, tendons, cx), read_force(&any, cx))
        else {
            return;
        };
        let gear = any.some("gear", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], cx).map_or(1.0, |gear| gear.value[0]);
        let said = node.has_attribute("name").then(|| name(node, "name", cx)).flatten();
        let named = said.unwrap_or_else(|| {
            let target = terms.first().map_or("motor", |(joint, _)| joint.text.as_str());
            Name {
                text: unused(&format!("{target}_{kind}"), |name| names.contains(name)),
                place: place(node, cx),
            }
        });
        names.insert(named.text.clone());
        self.bound(&any, &terms, gear, &force, cx);
        self.refuse_losses(&any, cx);
        let weighted = |factor: f64| -> Vec<(Name, f64)> {
            terms.iter().map(|(joint, weight)| (joint.clone(), weight * factor)).collect()
        };
        let unit = unit(kind, turns, &force);
        let mut drive = |factor: f64, law: DriveLaw| {
            self.robot.drives.push(Drive { name: named.clone(), terms: weighted(factor), law });
        };
        drive(gear * force.gain, DriveLaw::Input(unit));
        let [constant, stiffness, damping] = force.bias;
        if stiffness != 0.0 {
            drive(gear, DriveLaw::Spring { stiffness: -stiffness, free: constant / -stiffness });
        } else if constant != 0.0 {
            drive(gear, DriveLaw::Push(constant));
        }
        if damping != 0.0 {
            drive(gear, DriveLaw::Damper(-damping));
        }
    }

    /// What an actuator acts on, and whether that turns.
    fn transmission(
        &self,
        element: &Element<'a>,
        tendons: &[Tendon],
        cx: &mut Cx<'_>,
    ) -> Option<(Vec<(Name, f64)>, bool)> {
        if let Some(joint) = element.name("joint", cx).or_else(|| element.name("jointinparent", cx)) {
            if !self.check_joint(&joint, "drive", cx) {
                return None;
            }
            let turns = |known: &crate::import::robot::FileJoint| {
                known.name.text == joint.text && known.kind == JointKind::Pin
            };
            let turns = self.robot.joints.iter().any(turns);
            return Some((vec![(joint, 1.0)], turns));
        }
        if let Some(tendon) = element.name("tendon", cx) {
            return Some((Tendon::terms_of(&tendon, tendons, ("driven", OTHER_INPUTS), cx)?, false));
        }
        let message = "an actuator on no joint and no tendon is not supported";
        cx.error(&place(element.node, cx), message, |d| d.help(OTHER_INPUTS));
        None
    }

    /// Newer versions give actuators losses and rotors of their own.
    fn refuse_losses(&self, element: &Element<'a>, cx: &mut Cx<'_>) {
        for (which, help) in [
            ("damping", "write it into the joint, times the gear ratio squared"),
            ("armature", "write it into the joint, times the gear ratio squared"),
            ("delay", OTHER_INPUTS),
        ] {
            if let Some(found) = element.nonzero(which, cx) {
                let message = format!("`{which}` of an actuator is not supported");
                cx.error(&found.place, message, |d| d.help(help));
            }
        }
    }

    /// The largest effort of a joint that an actuator drives alone, in effect.
    fn bound(
        &mut self,
        element: &Element<'a>,
        terms: &[(Name, f64)],
        gear: f64,
        force: &Force,
        cx: &mut Cx<'_>,
    ) {
        let of = |ends: [Placed<f64>; 2]| {
            let [low, high] = ends;
            Placed { value: low.value.abs().max(high.value.abs()) * gear.abs(), place: low.place }
        };
        let by_force = self.range(element, "forcelimited", "forcerange", cx).map(of);
        let by_input = self.range(element, "ctrllimited", "ctrlrange", cx).map(of);
        let servos = usize::from(by_input.is_some() && force.bias != [0.0; 3]);
        self.count("ranges of what servos are told", servos);
        let by_input = by_input
            .filter(|_| force.bias == [0.0; 3])
            .map(|found| Placed { value: found.value * force.gain.abs(), ..found });
        let [(joint, _)] = terms else {
            self.count(
                "limits of actuators on tendons",
                usize::from(by_force.is_some() || by_input.is_some()),
            );
            return;
        };
        let Some(joint) = self.robot.joints.iter_mut().find(|known| known.name.text == joint.text) else {
            return;
        };
        for found in [by_force, by_input].into_iter().flatten() {
            let effort = &mut joint.limits.effort;
            if effort.as_ref().is_none_or(|known| found.value < known.value)
                && self.options.limits != crate::syntax::LimitOption::Ignore
            {
                *effort = Some(found);
            }
        }
    }
}

/// The unit of an input.
fn unit(kind: &str, turns: bool, force: &Force) -> &'static str {
    match (kind, turns) {
        ("motor", true) => "N·m",
        ("motor", false) => "N",
        ("position", true) => "rad",
        ("position", false) => "m",
        ("velocity", true) => "rad/s",
        ("velocity", false) => "m/s",
        // A servo's input is what it goes to.
        (_, true) if force.gain == -force.bias[1] => "rad",
        (_, false) if force.gain == -force.bias[1] => "m",
        _ => "any",
    }
}
