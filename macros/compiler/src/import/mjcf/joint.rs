//! `<joint>` and `<freejoint>` → joints with one degree of freedom, ball joints and free joints.

use super::defaults::ElementWithDefaults;
use super::reader::MjcfReader;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, element_source_position, read_name_attribute};
use crate::import::imported::Located;
use crate::import::pose::{
    NumericPose, Vector, matrix_times_vector, vector_norm, vector_sum, vector_times_scalar,
};
use crate::import::robot::{FileLimits, unused_name};
use crate::syntax::{Expr, FileForceElement, FileForceLaw, FileForceTarget, JointKind, LimitOption, Name};

/// MJCF's names of the joint types.
const TYPES: [(&str, JointKind); 4] = [
    ("hinge", JointKind::Pin),
    ("slide", JointKind::Sleeve),
    ("ball", JointKind::Ball),
    ("free", JointKind::Free),
];

pub(super) const IGNORE_PASSIVE: &str =
    "to ignore springs, damping and friction, write `#[mechanism(…, passive = ignore)]`";

/// Joint of a body as an MJCF file describes it.
pub(super) struct BodyJoint {
    pub(super) name: Name,
    pub(super) kind: JointKind,
    pub(super) word: &'static str,
    /// Position of the joint relative to its body, m.
    pub(super) anchor: Located<Vector>,
    /// Unit vector of the joint's axis in body axes.
    pub(super) axis: Located<Vector>,
    /// Joint coordinate in the configuration of the file (`ref`).
    pub(super) reference: f64,
    pub(super) limits: FileLimits,
    pub(super) damping: Option<Expr>,
    pub(super) friction: Option<Expr>,
    /// Isotropic damping of a ball or free joint.
    pub(super) spread: Option<Located<f64>>,
}

impl<'a> MjcfReader<'a> {
    /// Reads a joint of a body. `outer` is the pose of the surrounding `<frame>` elements relative to the
    /// body.
    pub(super) fn read_joint(
        &mut self,
        (node, outer, class): (Node<'a>, &NumericPose, usize),
        body: &Name,
        cx: &mut Cx<'_>,
    ) -> Option<BodyJoint> {
        let free = node.tag_name().name() == "freejoint";
        let tags: &[&str] = if free { &[] } else { &["joint"] };
        let element = self.defaults.element_with_defaults(node, tags, class, cx);
        self.read_joint_element((&element, outer), free, body, cx)
    }

    fn read_joint_element(
        &mut self,
        (element, outer): (&ElementWithDefaults<'a>, &NumericPose),
        free: bool,
        body: &Name,
        cx: &mut Cx<'_>,
    ) -> Option<BodyJoint> {
        let (word, kind) = if free { ("free", JointKind::Free) } else { read_joint_type(element, cx)? };
        let name = self.joint_name(element.node, word, body, cx);
        let alone = kind.single_axis_joint_is_rotational().is_some();
        let zero_vector_at_attribute = |at: &str, cx: &Cx<'_>| Located {
            value: [0.0; 3],
            place: element.place_of_attribute_value(at, cx),
        };
        let mut anchor =
            element.read_exactly_n_numbers("pos", cx).unwrap_or(zero_vector_at_attribute("pos", cx));
        anchor.value = vector_sum(outer.at, matrix_times_vector(&outer.axes, anchor.value));
        let mut axis =
            element.read_exactly_n_numbers("axis", cx).unwrap_or(zero_vector_at_attribute("axis", cx));
        if element.node_with_attribute("axis").is_none() {
            axis.value = [0.0, 0.0, 1.0];
        }
        let size = vector_norm(axis.value);
        if alone && size < 1e-14 {
            cx.report_error(&axis.place, "axis of zero length has no direction", |d| d);
            return None;
        }
        axis.value = matrix_times_vector(
            &outer.axes,
            vector_times_scalar(axis.value, if alone { 1.0 / size } else { 1.0 }),
        );
        let turns = kind == JointKind::Pin;
        let angle_or_length =
            |reader: &Self, value: f64| if turns { reader.settings.angle_in_radians(value) } else { value };
        let angle_or_length_of_attribute = |reader: &Self, attribute: &str, cx: &mut Cx<'_>| {
            element
                .read_finite_attribute(attribute, cx)
                .map_or(0.0, |found| angle_or_length(reader, found.value))
        };
        let reference = if alone { angle_or_length_of_attribute(self, "ref", cx) } else { 0.0 };
        let rest = angle_or_length_of_attribute(self, "springref", cx);
        let limits = if alone {
            self.read_joint_limits(element, turns, cx)
        } else {
            self.report_ignored_limits(element, &name, cx)
        };
        let mut joint = BodyJoint {
            name,
            kind,
            word,
            anchor,
            axis,
            reference,
            limits,
            damping: None,
            friction: None,
            spread: None,
        };
        self.rests.insert(joint.name.text.clone(), rest);
        self.read_armature(element, &joint, cx);
        if self.springs || self.dampers {
            self.refuse_time_constants(element, cx);
        }
        if self.springs {
            self.read_joint_spring(element, &joint, rest, cx);
        }
        self.read_damping_and_friction_loss(element, &mut joint, cx);
        Some(joint)
    }

    /// Returns the name of a joint. The default is composed of the names of the body and the joint type.
    fn joint_name(&mut self, node: Node<'_>, word: &str, body: &Name, cx: &mut Cx<'_>) -> Name {
        let found = node.attribute("name").and_then(|_| read_name_attribute(node, "name", cx));
        let name = found.unwrap_or_else(|| Name {
            text: unused_name(&format!("{}_{word}", body.text), |name| self.joint_names.contains(name)),
            place: element_source_position(node, cx),
        });
        self.joint_names.insert(name.text.clone());
        name
    }

    fn read_joint_limits(
        &self,
        element: &ElementWithDefaults<'a>,
        turns: bool,
        cx: &mut Cx<'_>,
    ) -> FileLimits {
        let mut limits = FileLimits::default();
        if let Some([low, high]) = self.read_range(element, "limited", "range", cx)
            && self.settings.are_limits_enabled()
        {
            let range_end_in_radians = |end: Located<f64>| Located {
                value: if turns { self.settings.angle_in_radians(end.value) } else { end.value },
                place: end.place,
            };
            (limits.lower, limits.upper) =
                (Some(range_end_in_radians(low)), Some(range_end_in_radians(high)));
        }
        if let Some([low, high]) = self.read_range(element, "actuatorfrclimited", "actuatorfrcrange", cx) {
            let value = low.value.abs().max(high.value.abs());
            limits.effort = Some(Located { value, place: low.place });
        }
        limits
    }

    /// Returns the lower and upper end of a range attribute, if the range is active.
    pub(super) fn read_range(
        &self,
        element: &ElementWithDefaults<'a>,
        limited: &str,
        range: &str,
        cx: &mut Cx<'_>,
    ) -> Option<[Located<f64>; 2]> {
        if self.options.limits == LimitOption::Ignore {
            return None;
        }
        let said = element
            .node_with_attribute(limited)
            .is_some()
            .then(|| element.read_boolean_attribute(limited, cx))
            .flatten();
        let found = element.read_exactly_n_numbers::<2>(range, cx);
        if found.is_none() && element.node_with_attribute(range).is_some() {
            return None;
        }
        // A range of two zeros means no range.
        let found = found.filter(|found| found.value != [0.0; 2]);
        match (said, &found) {
            (Some(false), _) | (None, None) => return None,
            (None, Some(found)) if !self.settings.autolimits => {
                let message = format!("`{range}` without `{limited}` has no effect");
                cx.report_error(&found.place, message, |d| {
                    d.add_help(format!(
                        "write `{limited}=\"true\"` or `\"false\"`, or remove `autolimits=\"false\"`"
                    ))
                });
                return None;
            }
            _ => {}
        }
        let Some(Located { value: [low, high], place }) = found else {
            let message = format!("`{limited}=\"true\"` without `{range}`");
            cx.report_error(&element.place_of_attribute_value(limited, cx), message, |d| d);
            return None;
        };
        if low >= high {
            let message = format!("`{range}` from {low} to {high}, which is not above it");
            cx.report_error(&place, message, |d| d.add_help(crate::import::robot::IGNORE_LIMITS));
            return None;
        }
        Some([low, high].map(|value| Located { value, place: place.clone() }))
    }

    fn report_ignored_limits(
        &mut self,
        element: &ElementWithDefaults<'a>,
        name: &Name,
        cx: &mut Cx<'_>,
    ) -> FileLimits {
        let kind = element.trimmed_attribute_text("type").filter(|kind| *kind == "ball").unwrap_or("free");
        for (limited, range, what) in
            [("limited", "range", "limit"), ("actuatorfrclimited", "actuatorfrcrange", "largest force")]
        {
            if self.read_range(element, limited, range, cx).is_some() {
                self.left_out.push(format!("the {what} of the {kind} joint `{}`", name.text));
            }
        }
        FileLimits::default()
    }

    fn read_armature(&mut self, element: &ElementWithDefaults<'a>, joint: &BodyJoint, cx: &mut Cx<'_>) {
        let Some(armature) = element.nonzero_attribute_number("armature", cx) else { return };
        if joint.kind.single_axis_joint_is_rotational().is_some() {
            if armature.value < 0.0 {
                cx.report_error(&armature.place, format!("negative armature `{}`", armature.value), |d| d);
            }
            self.add_joint_force_element(joint, FileForceLaw::Inerter(armature.value));
            return;
        }
        let message = format!("`armature` of a `{}` joint is not supported", joint.word);
        cx.report_error(&armature.place, message, |d| {
            d.add_help("it adds to the mass matrix as no body does: write `armature=\"0\"` into the joint")
        });
    }

    fn refuse_time_constants(&self, element: &ElementWithDefaults<'a>, cx: &mut Cx<'_>) {
        if let Some(pair) =
            element.read_exactly_n_numbers::<2>("springdamper", cx).filter(|pair| pair.value != [0.0; 2])
        {
            let message = "`springdamper` is not supported";
            cx.report_error(&pair.place, message, |d| {
                d.add_help("write `stiffness` and `damping`").add_help(IGNORE_PASSIVE)
            });
        }
    }

    fn read_joint_spring(
        &mut self,
        element: &ElementWithDefaults<'a>,
        joint: &BodyJoint,
        rest: f64,
        cx: &mut Cx<'_>,
    ) {
        report_unsupported_spring_yield(element, cx);
        if joint.kind.single_axis_joint_is_rotational().is_some() {
            if let Some(stiffness) = element.polynomial_force_coefficients("stiffness", cx) {
                self.add_joint_force_element(
                    joint,
                    FileForceLaw::polynomial_spring_law(stiffness.value, rest),
                );
            }
        } else if let Some(stiffness) = element.linear_coefficient("stiffness", IGNORE_PASSIVE, cx) {
            let message = format!("`stiffness` of a `{}` joint is not supported", joint.word);
            cx.report_error(&stiffness.place, message, |d| d.add_help(IGNORE_PASSIVE));
        }
    }

    fn read_damping_and_friction_loss(
        &mut self,
        element: &ElementWithDefaults<'a>,
        joint: &mut BodyJoint,
        cx: &mut Cx<'_>,
    ) {
        for (which, is_damping, acts) in
            [("damping", true, self.dampers), ("frictionloss", false, self.friction)]
        {
            if !acts {
                continue;
            }
            if is_damping
                && joint.kind.single_axis_joint_is_rotational().is_some()
                && let Some(found) = element.polynomial_force_coefficients(which, cx)
                && found.value[1..] != [0.0; 2]
            {
                self.add_joint_force_element(joint, FileForceLaw::polynomial_damper_law(found.value));
                continue;
            }
            let found = match is_damping {
                true => element.linear_coefficient(which, IGNORE_PASSIVE, cx),
                false => element.nonzero_attribute_number(which, cx),
            };
            let Some(found) = found else { continue };
            if found.value < 0.0 {
                let message = format!("negative {which} `{}`", found.value);
                cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
            }
            let coefficient_expression = || Some(Expr::number_at(found.value, &found.place));
            match (joint.kind.single_axis_joint_is_rotational(), is_damping) {
                (Some(_), true) => joint.damping = coefficient_expression(),
                (Some(_), false) => joint.friction = coefficient_expression(),
                (None, true) => joint.spread = Some(found),
                (None, false) => {
                    let message = format!("`{which}` of a `{}` joint is not supported", joint.word);
                    cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
                }
            }
        }
    }

    fn add_joint_force_element(&mut self, joint: &BodyJoint, law: FileForceLaw) {
        let on = FileForceTarget::Sum(vec![(joint.name.clone(), 1.0)]);
        self.robot.drives.push(FileForceElement { name: joint.name.clone(), on, law });
    }
}

/// Reports a nonzero attribute `springyield`, which is not supported.
pub(super) fn report_unsupported_spring_yield(element: &ElementWithDefaults<'_>, cx: &mut Cx<'_>) {
    if let Some(found) = element.nonzero_attribute_number("springyield", cx) {
        let message = "`springyield` is not supported: a spring that yields has a state of its own";
        cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
    }
}

/// Returns true for `<joint>` and `<freejoint>` elements.
pub(super) fn is_joint_element(node: Node<'_>) -> bool {
    matches!(node.tag_name().name(), "joint" | "freejoint")
}

fn read_joint_type(element: &ElementWithDefaults<'_>, cx: &mut Cx<'_>) -> Option<(&'static str, JointKind)> {
    let word = element.trimmed_attribute_text("type").unwrap_or("hinge");
    let known = TYPES.iter().find(|(known, _)| *known == word);
    if known.is_none() {
        let message = format!("unknown joint type {}", quote_word(word));
        cx.report_error(&element.place_of_attribute_value("type", cx), message, |d| {
            d.suggest_name(word, TYPES.map(|(word, _)| word))
        });
    }
    known.copied()
}
