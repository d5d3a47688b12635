//! Conversion of a `<joint>` element to a [`FileJoint`], before locks and `mimic` are resolved.

use super::limit::read_limits;
use super::origin::read_origin;
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_for_each_name, element_source_position, read_name_attribute, read_number_attribute,
    read_numbers_attribute, report_missing_or_misspelt_attributes, report_unexpected_contents,
    required_child,
};
use crate::import::imported::Located;
use crate::import::misplaced;
use crate::import::robot::{FileJoint, has_axis, has_single_coordinate};
use crate::syntax::{Expr, FileOptions, JointKind, LimitOption, MimicRelation, Name};

/// URDF's names of the joint types, and `spherical`, which simulators also accept.
const TYPES: [(&str, JointKind); 7] = [
    ("revolute", JointKind::Pin),
    ("continuous", JointKind::Pin),
    ("prismatic", JointKind::Sleeve),
    ("fixed", JointKind::Weld),
    ("floating", JointKind::Free),
    ("planar", JointKind::Planar),
    ("spherical", JointKind::Ball),
];

/// Child elements of the URDF element `<joint>` that are read.
const PARTS: [&str; 7] = ["origin", "parent", "child", "axis", "dynamics", "mimic", "limit"];

const ELEMENTS: &str = "a joint has elements: `<parent link=\"…\"/>`, `<child link=\"…\"/>`, `<origin \
                        xyz=\"…\" rpy=\"…\"/>`, `<axis xyz=\"…\"/>`";

/// Attributes of the URDF element `<dynamics>` that parametrise controllers of other tools.
const OF_CONTROLLERS: [&str; 4] = ["D", "K", "mu_coulomb", "mu_viscous"];

/// Reads a joint. Returns `None` if its name, parent or child is missing. Adds the `mimic` of a fixed joint
/// and the limits of a joint with several coordinates to `left_out`.
pub(super) fn read_joint(
    node: Node<'_>,
    options: &FileOptions,
    left_out: &mut Vec<String>,
    cx: &mut Cx<'_>,
) -> Option<FileJoint> {
    report_missing_or_misspelt_attributes(node, &["name", "type"], &[], cx);
    let joint = read_name_attribute(node, "name", cx);
    let kind = read_joint_type(node, cx);
    let [origin, parent, child, axis, dynamics, mimic, limit] = child_for_each_name(node, PARTS, cx);
    misplaced::report_misplaced_contents(node, &PARTS, ELEMENTS, cx);
    let origin = read_origin(origin, node, cx);
    let parent = read_end_link(parent, node, "parent", cx);
    let child = read_end_link(child, node, "child", cx);
    // Exporters write an axis of zeros and damping into fixed joints.
    let (word, kind) = kind.unwrap_or(("fixed", JointKind::Weld));
    let moves = kind != JointKind::Weld;
    let axis = read_axis(axis.filter(|_| has_axis(kind)), node, cx);
    let [damping, friction] =
        read_dynamics(dynamics.filter(|_| moves && options.honour_passive), word, kind, cx);
    let mimic = mimic.filter(|_| options.follow_mimic).and_then(|mimic| read_mimic(mimic, cx));
    if let (Some(joint), Some(mimic), false) = (&joint, &mimic, moves) {
        left_out
            .push(format!("`mimic` of {}: a fixed joint does not follow {}", joint.text, mimic.joint.text));
    }
    let mimic = mimic.filter(|_| moves);
    let limit = limit.filter(|_| moves && options.limits != LimitOption::Ignore);
    if let (Some(joint), Some(_), false) = (&joint, limit, has_single_coordinate(kind)) {
        left_out.push(format!("limits of {}, which is `{word}`", joint.text));
    }
    let limit = limit.filter(|_| has_single_coordinate(kind));
    let limits = read_limits(limit, joint.as_ref(), word == "continuous", cx);
    let (name, parent, child) = (joint?, parent?, child?);
    Some(FileJoint {
        mimic,
        limits,
        damping,
        friction,
        ..FileJoint::joint_between_links(name, (kind, word), [parent, child], origin, axis)
    })
}

/// Reads the joint type. Reports an unknown type.
pub(super) fn read_joint_type(node: Node<'_>, cx: &mut Cx<'_>) -> Option<(&'static str, JointKind)> {
    let found = node.attribute_node("type")?;
    let known = TYPES.iter().find(|(word, _)| *word == found.value());
    if known.is_none() {
        let place = cx.source_position(found.range_value().start);
        let message = format!("unknown joint type {}", quote_word(found.value()));
        cx.report_error(&place, message, |d| d.suggest_name(found.value(), TYPES.map(|(word, _)| word)));
    }
    known.copied()
}

/// Reads the name of the parent or child link of a joint.
fn read_end_link(end: Option<Node<'_>>, node: Node<'_>, which: &str, cx: &mut Cx<'_>) -> Option<Name> {
    let end = required_child(end, node, which, &["link"], cx)?;
    report_unexpected_contents(end, &["link"], &[], &[], cx);
    read_name_attribute(end, "link", cx)
}

/// Reads the axis of a joint; the default of URDF is x.
pub(super) fn read_axis(axis: Option<Node<'_>>, node: Node<'_>, cx: &mut Cx<'_>) -> Located<[f64; 3]> {
    let default_axis = |place: Place| Located { value: [1.0, 0.0, 0.0], place };
    let Some(axis) = axis else {
        return default_axis(element_source_position(node, cx));
    };
    // Some exporters add an identity orientation to the axis.
    let has_rpy =
        axis.attribute("rpy").is_some_and(|rpy| rpy.split_whitespace().all(|x| x.parse() == Ok(0.0)));
    report_unexpected_contents(axis, &["xyz"], &[], if has_rpy { &["rpy"] } else { &[] }, cx);
    let axis =
        read_numbers_attribute(axis, "xyz", cx).unwrap_or(default_axis(element_source_position(axis, cx)));
    if axis.value == [0.0; 3] {
        cx.report_error(&axis.place, "axis of zero length has no direction", |d| d);
    }
    axis
}

/// Reads damping and friction coefficients of a URDF joint, in this order.
fn read_dynamics(node: Option<Node<'_>>, word: &str, kind: JointKind, cx: &mut Cx<'_>) -> [Option<Expr>; 2] {
    let Some(node) = node else {
        return [None, None];
    };
    report_unexpected_contents(node, &[], &["damping", "friction"], &OF_CONTROLLERS, cx);
    ["damping", "friction"].map(|which| {
        let found = read_number_attribute(node, which, cx).filter(|found| found.value != 0.0)?;
        if found.value < 0.0 {
            let message = format!("negative {which} `{}`", found.value);
            cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
        } else if !matches!(kind, JointKind::Pin | JointKind::Sleeve) {
            let message = format!("`{which}` of a `{word}` joint is not supported");
            cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
        }
        Some(Expr::number_at(found.value, &found.place))
    })
}

const IGNORE_PASSIVE: &str = "to ignore damping and friction, write `#[mechanism(…, passive = ignore)]`";

fn read_mimic(node: Node<'_>, cx: &mut Cx<'_>) -> Option<MimicRelation> {
    report_unexpected_contents(node, &["joint"], &["multiplier", "offset"], &[], cx);
    let multiplier = read_number_attribute(node, "multiplier", cx).map_or(1.0, |found| found.value);
    let offset = read_number_attribute(node, "offset", cx).map_or(0.0, |found| found.value);
    Some(MimicRelation { joint: read_name_attribute(node, "joint", cx)?, multiplier, offset })
}
