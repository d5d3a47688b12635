//! `<actuator>` → inputs, with the springs and dampers that servos are.
//!
//! An actuator has a length: a gear ratio times a coordinate or the length of a tendon, or zero on a site. Its force is `gain · u + b₀ + b₁ length +
//! b₂ rate` (MuJoCo, *Computation*, "Actuation model", with neither activation nor muscles).

use super::defaults::Element;
use super::law::{Force, OTHER_INPUTS, read_force};
use super::reader::Reader;
use super::tendon::Tendon;
use crate::import::context::Cx;
use crate::import::element::{Node, check_attributes, elements, name, place};
use crate::import::imported::Placed;
use crate::import::robot::unused;
use crate::syntax::{Drive, DriveLaw, DriveOn, InputOption, JointKind, Name};
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
        let Some(force) = read_force(&any, cx) else { return };
        let Some((on, turns)) = self.transmission(&any, tendons, force.bias[1] != 0.0, cx) else { return };
        let said = node.has_attribute("name").then(|| name(node, "name", cx)).flatten();
        let named = said.unwrap_or_else(|| {
            let joint = on.terms().first().map(|(joint, _)| joint.text.as_str());
            let target = joint.or(any.text("site")).unwrap_or("motor");
            Name {
                text: unused(&format!("{target}_{kind}"), |name| names.contains(name)),
                place: place(node, cx),
            }
        });
        names.insert(named.text.clone());
        self.bound(&any, on.terms(), &force, cx);
        self.refuse_losses(&any, cx);
        let unit = unit(kind, turns, &force);
        let mut drive = |on: DriveOn, law: DriveLaw| {
            self.robot.drives.push(Drive { name: named.clone(), on, law });
        };
        drive(on.scaled(force.gain), DriveLaw::Input(unit));
        let [constant, stiffness, damping] = force.bias;
        // What is at a point has the length zero.
        let stiffness = if matches!(on, DriveOn::Wrench(_)) { 0.0 } else { stiffness };
        if stiffness != 0.0 {
            drive(on.clone(), DriveLaw::Spring { stiffness: -stiffness, free: constant / -stiffness });
        } else if constant != 0.0 {
            drive(on.clone(), DriveLaw::Push(constant));
        }
        if damping != 0.0 {
            drive(on, DriveLaw::Damper(-damping));
        }
    }

    /// What an actuator acts on, with its gear ratio, and whether that turns.
    fn transmission(
        &self,
        element: &Element<'a>,
        tendons: &[Tendon],
        servo: bool,
        cx: &mut Cx<'_>,
    ) -> Option<(DriveOn, bool)> {
        if let Some(site) = element.name("site", cx) {
            return self.site_transmission(&site, element, servo, cx);
        }
        let gear = element.some("gear", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], cx).map_or(1.0, |gear| gear.value[0]);
        if let Some(joint) = element.name("joint", cx).or_else(|| element.name("jointinparent", cx)) {
            if !self.check_joint(&joint, "drive", cx) {
                return None;
            }
            let turns = |known: &crate::import::robot::FileJoint| {
                known.name.text == joint.text && known.kind == JointKind::Pin
            };
            let turns = self.robot.joints.iter().any(turns);
            return Some((DriveOn::Sum(vec![(joint, gear)]), turns));
        }
        if let Some(tendon) = element.name("tendon", cx) {
            return Some((Tendon::on(&tendon, tendons, OTHER_INPUTS, cx)?.scaled(gear), false));
        }
        let message = "an actuator on no joint, tendon or site is not supported";
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
    fn bound(&mut self, element: &Element<'a>, terms: &[(Name, f64)], force: &Force, cx: &mut Cx<'_>) {
        let gear = terms.first().map_or(1.0, |(_, gear)| gear.abs());
        let of = |ends: [Placed<f64>; 2]| {
            let [low, high] = ends;
            Placed { value: low.value.abs().max(high.value.abs()) * gear, place: low.place }
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
                "limits of actuators on tendons and sites",
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
