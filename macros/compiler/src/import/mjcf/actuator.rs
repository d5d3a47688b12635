//! `<actuator>` → inputs, and the springs and dampers of servos.
//!
//! The length of an actuator is a gear ratio times a coordinate or the length of a tendon; on a site it is
//! zero. The force is `gain · u + b₀ + b₁ length + b₂ rate`, or an expression of states and inputs (MuJoCo,
//! *Computation*, "Actuation model").

use super::activation::{ActuatorNames, OTHER_INPUTS, SymbolicActuatorLaw};
use super::defaults::ElementWithDefaults;
use super::formula::ActuatorLawExpression;
use super::law::{ActuatorForceLaw, read_actuator_force};
use super::reader::MjcfReader;
use super::tendon::Tendon;
use crate::import::context::Cx;
use crate::import::element::{Node, child_elements, element_source_position, read_name_attribute};
use crate::import::imported::Located;
use crate::import::robot::{identifier_of_names, unused_name};
use crate::syntax::file_parameters::{FileField, FileFieldKind};
use crate::syntax::{
    Expr, FileForceElement, FileForceLaw, FileForceTarget, FileInputSource, JointKind, LimitOption, Name,
};
use std::collections::{BTreeMap, BTreeSet};

/// Actuator types of MuJoCo that are not supported, with the reasons.
const REFUSED: [(&str, &str); 3] = [
    ("adhesion", "it acts at contacts, whose forces MuJoCo divides among them"),
    (
        "orientation",
        "its force is that of three angles together: write three `<motor>`s, and the law in your program",
    ),
    ("plugin", "its force is computed by a program"),
];

/// Names of all actuator types of MuJoCo.
pub(super) const ALL: [&str; 13] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "plugin",
    "dcmotor",
];

/// Attributes that select the joint, tendon or site on which an actuator acts.
const TARGETS: [&str; 7] = ["joint", "jointinparent", "tendon", "site", "slidersite", "cranksite", "body"];

/// Maximum effort of each joint: the sum over its actuators, or `None` if one of them is unlimited.
type JointEffortLimits = BTreeMap<String, Option<Located<f64>>>;

impl<'a> MjcfReader<'a> {
    /// Reads all actuators of an MJCF file.
    pub(super) fn read_actuators(&mut self, root: Node<'a>, tendons: &[Tendon], cx: &mut Cx<'_>) {
        let groups = child_elements(root).filter(|node| node.tag_name().name() == "actuator");
        let nodes: Vec<Node<'a>> = groups.flat_map(child_elements).collect();
        let off = self.options.inputs != FileInputSource::Actuators || !self.settings.actuation;
        if off && !nodes.is_empty() {
            self.left_out.push(format!("{} actuators", nodes.len()));
        }
        let mut names: BTreeSet<String> =
            nodes.iter().filter_map(|node| node.attribute("name")).map(str::to_string).collect();
        let mut efforts = JointEffortLimits::new();
        for node in nodes {
            // Attributes common to all actuators may come from the defaults of any actuator type.
            let any = self.defaults.element_with_defaults(node, &ALL, 0, cx);
            self.add_rotor_inertia_and_damping(&any, tendons, cx);
            let group = any.read_finite_attribute("group", cx).map_or(0.0, |group| group.value);
            let disabled = self.settings.disabled_groups.contains(&group);
            if disabled && !off {
                self.count_skipped_contents("actuators of disabled groups", 1);
            }
            if !off && !disabled {
                self.read_actuator(&any, tendons, (&mut names, &mut efforts), cx);
            }
        }
        self.limit_joint_efforts_to_actuators(efforts);
    }

    fn read_actuator(
        &mut self,
        any: &ElementWithDefaults<'a>,
        tendons: &[Tendon],
        (names, efforts): (&mut BTreeSet<String>, &mut JointEffortLimits),
        cx: &mut Cx<'_>,
    ) {
        let node = any.node;
        let kind = node.tag_name().name();
        if let Some((_, why)) = REFUSED.iter().find(|(refused, _)| *refused == kind) {
            let message = format!("actuator `<{kind}>` is not supported");
            cx.report_error(&element_source_position(node, cx), message, |d| {
                d.add_help(*why).add_help(OTHER_INPUTS)
            });
            return;
        }
        if !ALL.contains(&kind) {
            // The schema check reports unknown elements.
            return;
        }
        let classes = self.defaults.defaults_by_class(node, &ALL, 0, cx);
        if let Some(found) = any.nonzero_attribute_number("delay", cx) {
            cx.report_error(&found.place, "`delay` of an actuator is not supported", |d| {
                d.add_help(OTHER_INPUTS)
            });
        }
        let Some((on, turns)) = self.read_transmission(any, tendons, false, cx) else { return };
        let said = node.has_attribute("name").then(|| read_name_attribute(node, "name", cx)).flatten();
        let named = said.unwrap_or_else(|| {
            let joint = on.weighted_joints().first().map(|(joint, _)| joint.text.as_str());
            let target = joint.or(any.trimmed_attribute_text("site")).unwrap_or("motor");
            Name {
                text: unused_name(&format!("{target}_{kind}"), |name| names.contains(name)),
                place: element_source_position(node, cx),
            }
        });
        names.insert(named.text.clone());
        let states = &self.robot.states;
        let unused_state_name = |word: &str| {
            let is_state_name_taken = |name: &str| states.iter().any(|(field, _)| field.ident == name);
            unused_name(&identifier_of_names(&named.text, word, "actuator"), is_state_name_taken)
        };
        let unused_input_name = |word: &str| match word {
            "" => named.text.clone(),
            word => unused_name(&format!("{}_{word}", named.text), |name| names.contains(name)),
        };
        let length = if turns { "rad" } else { "m" };
        let quantities = ActuatorNames {
            actuator: &named.text,
            length,
            field: &unused_state_name,
            input: &unused_input_name,
        };
        let Some(force) = read_actuator_force(any, &classes, &quantities, cx) else { return };
        match force {
            ActuatorForceLaw::Affine { gain, bias } => {
                let servo = bias[1] != 0.0;
                let Some((on, _)) = self.read_transmission(any, tendons, servo, cx) else { return };
                self.add_effort_limit(any, &on, ((gain, bias), None), efforts, cx);
                self.add_affine_actuator(&named, on, (gain, bias), input_unit(kind, turns, (gain, bias)));
            }
            ActuatorForceLaw::Law(law) => {
                let Some((on, _)) = self.read_transmission(any, tendons, true, cx) else { return };
                self.add_effort_limit(any, &on, ((1.0, [1.0; 3]), law.limit.clone()), efforts, cx);
                let limited = self.read_range(any, "actlimited", "actrange", cx).is_some();
                self.count_skipped_contents("ranges of activations", usize::from(limited));
                names.extend(law.inputs.iter().map(|(input, _)| input.clone()));
                self.add_actuator_law(named, on, *law);
            }
        }
    }

    /// Adds the input of an actuator, and a spring and a damper for the force that does not depend on it.
    fn add_affine_actuator(
        &mut self,
        name: &Name,
        on: FileForceTarget,
        (gain, [constant, stiffness, damping]): (f64, [f64; 3]),
        unit: &'static str,
    ) {
        let mut push_drive = |on: FileForceTarget, law: FileForceLaw| {
            self.robot.drives.push(FileForceElement { name: name.clone(), on, law });
        };
        push_drive(on.with_scaled_weights(gain), FileForceLaw::Input(unit));
        // The length of an actuator on a site is zero.
        let stiffness = if matches!(on, FileForceTarget::Wrench(_)) { 0.0 } else { stiffness };
        if stiffness != 0.0 {
            push_drive(
                on.clone(),
                FileForceLaw::Spring { stiffness: -stiffness, free: constant / -stiffness },
            );
        } else if constant != 0.0 {
            push_drive(on.clone(), FileForceLaw::Push(constant));
        }
        if damping != 0.0 {
            push_drive(on, FileForceLaw::Damper(-damping));
        }
    }

    /// Adds the inputs, the states and the force of an actuator.
    fn add_actuator_law(&mut self, name: Name, on: FileForceTarget, law: SymbolicActuatorLaw) {
        for (input, unit) in law.inputs {
            let name = Name { text: input, place: name.place.clone() };
            let on = FileForceTarget::Sum(Vec::new());
            self.robot.drives.push(FileForceElement { name, on, law: FileForceLaw::Input(unit) });
        }
        for state in law.states {
            let field = FileField {
                ident: state.ident,
                kind: FileFieldKind::Number,
                of: name.text.clone(),
                about: state.about,
                values: vec![0.0],
                units: vec![state.unit],
            };
            let ActuatorLawExpression(rate) = state.rate;
            self.robot.states.push((field, rate));
        }
        let ActuatorLawExpression(force) = law.force;
        let law = FileForceLaw::Expression { force: Box::new(force), offset: 0.0 };
        self.robot.drives.push(FileForceElement { name, on, law });
    }

    /// Returns what an actuator acts on, scaled by the gear ratio, and whether its force is a torque.
    fn read_transmission(
        &self,
        element: &ElementWithDefaults<'a>,
        tendons: &[Tendon],
        servo: bool,
        cx: &mut Cx<'_>,
    ) -> Option<(FileForceTarget, bool)> {
        let said: Vec<&str> =
            TARGETS.into_iter().filter(|target| element.node.has_attribute(*target)).collect();
        match said.as_slice() {
            [_] | ["slidersite", "cranksite"] => {}
            [] => {
                let message = "an actuator without a target";
                cx.report_error(&element_source_position(element.node, cx), message, |d| {
                    d.add_help("expected `joint`, `tendon` or `site`").add_help(OTHER_INPUTS)
                });
                return None;
            }
            several => {
                let message =
                    format!("an actuator has one target, but here are `{}`", several.join("` and `"));
                cx.report_error(&element_source_position(element.node, cx), message, |d| {
                    d.add_help(OTHER_INPUTS)
                });
                return None;
            }
        }
        if let Some(site) = element.attribute_text_with_span("site", cx) {
            return self.site_transmission(&site, element, servo, cx);
        }
        let gear = element
            .numbers_with_defaults("gear", [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], cx)
            .map_or(1.0, |gear| gear.value[0]);
        if let Some(joint) = element
            .attribute_text_with_span("joint", cx)
            .or_else(|| element.attribute_text_with_span("jointinparent", cx))
        {
            if !self.check_single_coordinate_joint(&joint, "drive", cx) {
                return None;
            }
            let is_pin = |known: &crate::import::robot::FileJoint| {
                known.name.text == joint.text && known.kind == JointKind::Pin
            };
            let turns = self.robot.joints.iter().any(is_pin);
            return Some((FileForceTarget::Sum(vec![(joint, gear)]), turns));
        }
        if let Some(tendon) = element.attribute_text_with_span("tendon", cx) {
            return Some((
                Tendon::tendon_force_target(&tendon, tendons, OTHER_INPUTS, cx)?.with_scaled_weights(gear),
                false,
            ));
        }
        let message = "an actuator on no joint, tendon or site is not supported";
        cx.report_error(&element_source_position(element.node, cx), message, |d| d.add_help(OTHER_INPUTS));
        None
    }

    /// Adds the rotor inertia and the viscous damping of an actuator. They act on the joint or tendon even if
    /// the actuator is not used.
    fn add_rotor_inertia_and_damping(
        &mut self,
        element: &ElementWithDefaults<'a>,
        tendons: &[Tendon],
        cx: &mut Cx<'_>,
    ) {
        let gear =
            element.numbers_with_defaults("gear", [1.0; 6], cx).map_or(1.0, |gear| gear.value[0].abs());
        let damping =
            element.polynomial_force_coefficients("damping", cx).filter(|_| self.dampers && gear > 0.0);
        // MuJoCo multiplies all coefficients by the square of the gear ratio.
        let damping = damping.map(|Located { value: [linear, square, cube], place }| Located {
            value: [linear, square / gear, cube / (gear * gear)],
            place,
        });
        let rotor = element.nonzero_attribute_number("armature", cx);
        let laws = [
            damping.map(|found| (FileForceLaw::polynomial_damper_law(found.value), found.place)),
            rotor.as_ref().map(|found| (FileForceLaw::Inerter(found.value), found.place.clone())),
        ];
        let laws: Vec<_> = laws.into_iter().flatten().collect();
        let Some((_, at)) = laws.first() else { return };
        if element.node.has_attribute("site") {
            let message = "`damping` and `armature` of an actuator on a site are not supported";
            cx.report_error(at, message, |d| d.add_help("MuJoCo has them only on joints and tendons"));
            return;
        }
        if let Some(rotor) = rotor.filter(|rotor| rotor.value < 0.0) {
            cx.report_error(&rotor.place, format!("negative armature `{}`", rotor.value), |d| d);
        }
        let Some((on, _)) = self.read_transmission(element, tendons, false, cx) else { return };
        let target = ["joint", "jointinparent", "tendon"]
            .into_iter()
            .find_map(|target| element.trimmed_attribute_text(target));
        let text = target.unwrap_or("motor");
        for (law, place) in laws {
            let name = Name { text: text.to_string(), place };
            self.robot.drives.push(FileForceElement { name, on: on.clone(), law });
        }
    }

    /// Adds the maximum force of an actuator to the maximum efforts of the joints that it acts on.
    fn add_effort_limit(
        &mut self,
        element: &ElementWithDefaults<'a>,
        on: &FileForceTarget,
        ((gain, bias), saturation): ((f64, [f64; 3]), Option<Located<f64>>),
        efforts: &mut JointEffortLimits,
        cx: &mut Cx<'_>,
    ) {
        let largest_magnitude = |ends: [Located<f64>; 2]| {
            let [low, high] = ends;
            Located { value: low.value.abs().max(high.value.abs()), place: low.place }
        };
        let by_force = self.read_range(element, "forcelimited", "forcerange", cx).map(largest_magnitude);
        let saturation = saturation.filter(|_| self.options.limits != LimitOption::Ignore);
        let by_force = saturation.or(by_force);
        let by_input = self.read_range(element, "ctrllimited", "ctrlrange", cx).map(largest_magnitude);
        let by_input = by_input.filter(|_| self.settings.clamped);
        let inherits = element.nonzero_attribute_number("inheritrange", cx).is_some();
        let is_servo = bias != [0.0; 3];
        let servos = usize::from((by_input.is_some() || inherits) && is_servo);
        self.count_skipped_contents("ranges of servo commands", servos);
        let by_input =
            by_input.filter(|_| !is_servo).map(|found| Located { value: found.value * gain.abs(), ..found });
        let limit = match (by_force, by_input) {
            (Some(a), Some(b)) => Some(if a.value <= b.value { a } else { b }),
            (a, b) => a.or(b),
        };
        let add_to_joint_effort_limit =
            |joint: String, more: Option<Located<f64>>, efforts: &mut JointEffortLimits| match efforts
                .get_mut(&joint)
            {
                Some(known) => {
                    *known = known
                        .take()
                        .zip(more)
                        .map(|(known, more)| Located { value: known.value + more.value, place: known.place });
                }
                None => {
                    efforts.insert(joint, more);
                }
            };
        if let FileForceTarget::Sum(terms) = on {
            for (joint, weight) in terms {
                let more = limit.clone().map(|limit| Located { value: limit.value * weight.abs(), ..limit });
                add_to_joint_effort_limit(joint.text.clone(), more, efforts);
            }
            return;
        }
        self.count_skipped_contents("limits of actuators on cables and sites", usize::from(limit.is_some()));
        for joint in self.joint_names_to_ground(on) {
            add_to_joint_effort_limit(joint, None, efforts);
        }
    }

    /// Returns the names of all joints between the ground and the bodies that a length or a wrench refers to.
    fn joint_names_to_ground(&self, on: &FileForceTarget) -> Vec<String> {
        let ends = match on {
            FileForceTarget::Sum(_) => Vec::new(),
            FileForceTarget::Length(e) => e.all_subexpressions(),
            FileForceTarget::Wrench(wrench) => std::iter::once(&wrench.on)
                .chain(&wrench.against)
                .flat_map(Expr::all_subexpressions)
                .collect(),
        };
        let mut found = Vec::new();
        for mut body in ends.into_iter().filter_map(Expr::as_name) {
            while let Some(joint) = self.robot.joints.iter().find(|joint| joint.child.text == body) {
                found.push(joint.name.text.clone());
                body = &joint.parent.text;
            }
        }
        found.sort();
        found.dedup();
        found
    }

    /// Limits the effort of each joint to the sum of its actuators' maximum forces.
    fn limit_joint_efforts_to_actuators(&mut self, mut efforts: JointEffortLimits) {
        if self.options.limits == LimitOption::Ignore {
            return;
        }
        for joint in &mut self.robot.joints {
            let Some(found) = efforts.remove(&joint.name.text).flatten() else { continue };
            let effort = &mut joint.limits.effort;
            if effort.as_ref().is_none_or(|known| found.value < known.value) {
                *effort = Some(found);
            }
        }
    }
}

/// Returns the unit of an actuator's input, as text.
fn input_unit(kind: &str, turns: bool, (gain, bias): (f64, [f64; 3])) -> &'static str {
    match (kind, turns) {
        ("motor", true) => "N·m",
        ("motor", false) => "N",
        ("position", true) => "rad",
        ("position", false) => "m",
        ("velocity", true) => "rad/s",
        ("velocity", false) => "m/s",
        // The input of a servo is its set-point.
        (_, true) if gain == -bias[1] => "rad",
        (_, false) if gain == -bias[1] => "m",
        _ => "any",
    }
}
