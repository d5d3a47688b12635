//! Joints in the syntax of SDF in a `<gazebo>` element of a robot. Gazebo inserts them into the model, so
//! that they close loops.

use super::loops::joint_between;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_for_each_name, element_source_position, read_name_attribute, read_numbers_content,
    read_trimmed_content, report_missing_or_misspelt_attributes, required_child,
};
use crate::import::imported::Located;
use crate::import::pose::{NumericPose, Vector, matrix_times_vector, vector_norm};
use crate::import::robot::{FileJoint, FileOrigin, Robot, has_axis};
use crate::syntax::{Expr, FileOptions, JointKind, Name};
use std::collections::BTreeMap;

/// Types of SDF's joints that close loops.
const SDF_TYPES: [(&str, JointKind); 5] = [
    ("revolute", JointKind::Pin),
    ("continuous", JointKind::Pin),
    ("prismatic", JointKind::Sleeve),
    ("fixed", JointKind::Weld),
    ("ball", JointKind::Ball),
];

/// Reads a joint in the syntax of SDF. Its pose is relative to the child link, and its frame on the parent is
/// where it is in the configuration zero.
pub(super) fn read_gazebo_joint(
    node: Node<'_>,
    options: &FileOptions,
    robot: &mut Robot,
    cx: &mut Cx<'_>,
) -> Option<FileJoint> {
    report_missing_or_misspelt_attributes(node, &["name", "type"], &[], cx);
    let name = read_name_attribute(node, "name", cx);
    let written = node.attribute_node("type")?;
    let Some((word, kind)) = SDF_TYPES.into_iter().find(|(word, _)| *word == written.value()) else {
        let place = cx.source_position(written.range_value().start);
        let message =
            format!("a joint of type {} in `<gazebo>` is not supported", quote_word(written.value()));
        cx.report_error(&place, message, |d| {
            d.suggest_name(written.value(), SDF_TYPES.map(|(word, _)| word))
        });
        return None;
    };
    let [pose, parent, child, axis] = child_for_each_name(node, ["pose", "parent", "child", "axis"], cx);
    let parent = read_trimmed_content(required_child(parent, node, "parent", &[], cx)?, cx)?;
    let child = read_trimmed_content(required_child(child, node, "child", &[], cx)?, cx)?;
    let on_child = read_pose(pose, cx)?;
    let name = name?;
    let (axis, is_expressed_in_model_axes) = match axis.filter(|_| has_axis(kind)) {
        Some(axis) => read_gazebo_axis(axis, &name, options, robot, cx)?,
        None if has_axis(kind) => {
            cx.report_error(
                &element_source_position(node, cx),
                format!("a `{word}` joint without an axis"),
                |d| d.add_help("expected `<axis><xyz>…</xyz></axis>`"),
            );
            return None;
        }
        None => (GazeboAxis::placeholder_axis(&name), false),
    };
    let placements = link_poses_at_zero_coordinates(robot);
    let (Some(outer), Some(inner)) = (placements.get(&parent.text), placements.get(&child.text)) else {
        let unknown = if placements.contains_key(&parent.text) { &child } else { &parent };
        let links = robot.links.iter().map(|link| link.name.text.as_str());
        let message = format!("unknown link {}", quote_word(&unknown.text));
        cx.report_error(&unknown.place, message, |d| d.suggest_name(&unknown.text, links));
        return None;
    };
    let joint = inner.compose_with(&on_child);
    let on_parent = outer.inverse_pose().compose_with(&joint);
    let mut along = axis.direction;
    if is_expressed_in_model_axes {
        along.value = matrix_times_vector(&joint.inverse_pose().axes, along.value);
    }
    let ends = ((parent, on_parent), (child, on_child));
    let mut found = joint_between(name, (kind, word), ends.0, ends.1, &along);
    found.damping = axis.damping;
    Some(found)
}

/// Axis of a joint, and its damping or friction.
struct GazeboAxis {
    direction: Located<Vector>,
    damping: Option<Expr>,
}

impl GazeboAxis {
    /// Returns the placeholder for a joint without an axis.
    fn placeholder_axis(name: &Name) -> GazeboAxis {
        GazeboAxis { direction: Located { value: [0.0, 0.0, 1.0], place: name.place.clone() }, damping: None }
    }
}

/// Reads an axis. Returns true if it is in the axes of the model instead of those of the joint.
fn read_gazebo_axis(
    node: Node<'_>,
    name: &Name,
    options: &FileOptions,
    robot: &mut Robot,
    cx: &mut Cx<'_>,
) -> Option<(GazeboAxis, bool)> {
    let [xyz, limit, dynamics, old] =
        child_for_each_name(node, ["xyz", "limit", "dynamics", "use_parent_model_frame"], cx);
    let direction = match xyz {
        Some(xyz) => read_numbers_content::<3>(xyz, cx)?,
        None => GazeboAxis::placeholder_axis(name).direction,
    };
    if vector_norm(direction.value) < 1e-14 {
        cx.report_error(&direction.place, "axis of zero length has no direction", |d| d);
        return None;
    }
    let expressed_in = xyz.and_then(|xyz| xyz.attribute("expressed_in")).map_or("", str::trim);
    if !matches!(expressed_in, "" | "__model__") {
        let message = format!("an axis in the axes of {} is not supported", quote_word(expressed_in));
        cx.report_error(&direction.place, message, |d| d.add_help("write it in the axes of the joint"));
        return None;
    }
    let is_true_word = |word: Name| matches!(word.text.to_ascii_lowercase().as_str(), "true" | "1");
    let is_expressed_in_model_axes = expressed_in == "__model__"
        || old.and_then(|old| read_trimmed_content(old, cx)).is_some_and(is_true_word);
    let has_finite_bound = |limit: Node<'_>| {
        let bounds = limit.children().filter(|child| matches!(child.tag_name().name(), "lower" | "upper"));
        bounds
            .filter_map(|bound| bound.text())
            .any(|text| text.trim().parse().is_ok_and(|x: f64| x.abs() < 1e15))
    };
    if limit.is_some_and(has_finite_bound) {
        robot.left_out.push(format!("limits of {}, which closes a loop", name.text));
    }
    let mut damping = None;
    if let Some(dynamics) = dynamics.filter(|_| options.honour_passive) {
        let found = child_for_each_name(dynamics, ["damping", "friction", "spring_stiffness"], cx);
        for value in found.into_iter().flatten().filter_map(|part| read_numbers_content::<1>(part, cx)) {
            if value.value != [0.0] {
                damping = Some(Expr::number_at(value.value[0], &value.place));
            }
        }
    }
    Some((GazeboAxis { direction, damping }, is_expressed_in_model_axes))
}

/// Reads a pose relative to the child link; the default is the identity.
fn read_pose(node: Option<Node<'_>>, cx: &mut Cx<'_>) -> Option<NumericPose> {
    let Some(node) = node else { return Some(NumericPose::ZERO) };
    let frame = node.attribute("relative_to").or(node.attribute("frame")).map_or("", str::trim);
    if !frame.is_empty() {
        let message = format!("a pose relative to {} is not supported", quote_word(frame));
        cx.report_error(&element_source_position(node, cx), message, |d| {
            d.add_help("write it relative to the child link, without this attribute")
        });
        return None;
    }
    let found = read_numbers_content::<6>(node, cx)?;
    let [x, y, z, roll, pitch, yaw] = found.value;
    let value_with_source_place = |value| Located { value, place: found.place.clone() };
    Some(
        FileOrigin {
            xyz: value_with_source_place([x, y, z]),
            rpy: value_with_source_place([roll, pitch, yaw]),
        }
        .pose(),
    )
}

/// Returns the poses of the links relative to their root, with all coordinates zero.
fn link_poses_at_zero_coordinates(robot: &Robot) -> BTreeMap<String, NumericPose> {
    let mut below: BTreeMap<&str, Vec<&FileJoint>> = BTreeMap::new();
    let mut roots: BTreeMap<&str, ()> =
        robot.links.iter().map(|link| (link.name.text.as_str(), ())).collect();
    let tree = robot.joints.iter().filter(|joint| !robot.declared_closing.contains(&joint.name.text));
    for joint in tree {
        below.entry(&joint.parent.text).or_default().push(joint);
        roots.entry(&joint.parent.text).or_default();
    }
    for joint in below.values().flatten() {
        roots.remove(joint.child.text.as_str());
    }
    let mut placed = BTreeMap::new();
    let mut stack: Vec<(&str, NumericPose)> =
        roots.into_keys().map(|root| (root, NumericPose::ZERO)).collect();
    while let Some((link, pose)) = stack.pop() {
        if placed.contains_key(link) {
            continue;
        }
        placed.insert(link.to_string(), pose);
        let joints = below.get(link).into_iter().flatten();
        stack
            .extend(joints.map(|joint| (joint.child.text.as_str(), pose.compose_with(&joint.origin.pose()))));
    }
    placed
}
