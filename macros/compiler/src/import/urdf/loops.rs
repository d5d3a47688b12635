//! Joints and constraints that close loops, in extensions of URDF by other tools:
//!
//! - `<loop_joint>` of Isaac Sim and of exporters, with a frame on each of two links;
//! - joints in the syntax of SDF in a `<gazebo>` element of the robot;
//! - `<drake:ball_constraint>`, which connects a point of one link to a point of another.
//!
//! Elements with forces or constraints that are not supported are errors, because a mechanism without them
//! would move in another way.

use super::gazebo::read_gazebo_joint;
use super::joint::{read_axis, read_joint_type};
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_elements, child_for_each_name, element_source_position, read_name_attribute,
    read_numbers_attribute, report_missing_or_misspelt_attributes, report_unexpected_contents,
    required_child,
};
use crate::import::imported::Located;
use crate::import::pose::{NumericPose, Vector, matrix_times_vector};
use crate::import::robot::{FileJoint, FileOrigin, Robot, has_axis, origin_from_pose, unused_name};
use crate::syntax::{FileOptions, JointKind, LoopOption, Name};

/// Element of Isaac Sim for a joint that closes a loop.
pub(super) const LOOP_JOINT: &str = "loop_joint";

/// Elements of Drake that act on the motion and are not supported.
const UNSUPPORTED: [&str; 4] = ["joint", "linear_bushing_rpy", "linear_spring_damper", "tendon_constraint"];

/// Reads the elements of other tools that close loops, and adds their joints to the robot.
pub(super) fn read_declared_loops(root: Node<'_>, options: &FileOptions, robot: &mut Robot, cx: &mut Cx<'_>) {
    let own = root.tag_name().namespace();
    for node in root.children().filter(Node::is_element) {
        let (name, is_own) = (node.tag_name().name(), node.tag_name().namespace() == own);
        match name {
            LOOP_JOINT if is_own => add_loop_closing_joint(read_loop_joint(node, cx), robot),
            "gazebo" if is_own && !node.has_attribute("reference") => {
                for joint in child_elements(node).filter(|child| child.tag_name().name() == "joint") {
                    let found = read_gazebo_joint(joint, options, robot, cx);
                    add_loop_closing_joint(found, robot);
                }
            }
            "mujoco" if is_own => {
                let equality = child_elements(node).find(|child| child.tag_name().name() == "equality");
                equality
                    .into_iter()
                    .for_each(|node| report_or_list_ignored_element(node, "", options, robot, cx));
            }
            "ball_constraint" if !is_own => {
                let found = read_ball_constraint(node, robot, cx);
                add_loop_closing_joint(found, robot);
            }
            // Joints of Drake have a type; other tools use the name for other things.
            "joint" if !is_own && !node.has_attribute("type") => {}
            name if !is_own && UNSUPPORTED.contains(&name) => {
                report_or_list_ignored_element(node, "drake:", options, robot, cx)
            }
            _ => {}
        }
    }
}

fn add_loop_closing_joint(joint: Option<FileJoint>, robot: &mut Robot) {
    if let Some(joint) = joint {
        robot.declared_closing.insert(joint.name.text.clone());
        robot.joints.push(joint);
    }
}

/// Reports an element that is not supported, or lists it if loops and their constraints are ignored.
fn report_or_list_ignored_element(
    node: Node<'_>,
    prefix: &str,
    options: &FileOptions,
    robot: &mut Robot,
    cx: &mut Cx<'_>,
) {
    let tag = format!("`<{prefix}{}>`", node.tag_name().name());
    if options.loops == LoopOption::Ignore {
        robot.left_out.push(tag);
        return;
    }
    let help = match node.tag_name().name() {
        "joint" => "write `<joint>` with a type of URDF, or with the type `spherical`",
        "equality" => "MuJoCo does not read it in URDF files: write `<loop_joint>`, or an MJCF file",
        "tendon_constraint" => "write `<mimic>` for two joints, or declare the constraint",
        _ => "declare the mechanism with a spring and a dashpot (`linkwork convert`)",
    };
    cx.report_error(&element_source_position(node, cx), format!("{tag} is not supported"), |d| {
        d.add_help(help).add_help("to leave it out, write `#[mechanism(…, loops = ignore)]`")
    });
}

/// Returns a joint with its frames on both links; `axis` is in the axes of the joint.
pub(super) fn joint_between(
    name: Name,
    (kind, word): (JointKind, &'static str),
    (parent, on_parent): (Name, NumericPose),
    (child, on_child): (Name, NumericPose),
    axis: &Located<Vector>,
) -> FileJoint {
    // The child's axes if the frames coincide; the joint is where its frame is.
    let axes = on_parent.compose_with(&on_child.inverse_pose()).axes;
    let place: Place = name.place.clone();
    let origin = origin_from_pose(&NumericPose { at: on_parent.at, axes }, &place);
    let in_child = matrix_times_vector(&on_child.axes, axis.value);
    let axis =
        Located { value: in_child.map(|x| if x.abs() < 1e-15 { 0.0 } else { x }), place: axis.place.clone() };
    FileJoint {
        anchor: on_child.at,
        ..FileJoint::joint_between_links(name, (kind, word), [parent, child], origin, axis)
    }
}

/// Reads `<loop_joint>`. The second link is `<link2>`, or a second `<link1>` as in the documentation of Isaac
/// Sim.
fn read_loop_joint(node: Node<'_>, cx: &mut Cx<'_>) -> Option<FileJoint> {
    report_missing_or_misspelt_attributes(node, &["name", "type"], &[], cx);
    let name = read_name_attribute(node, "name", cx);
    let (word, kind) = read_joint_type(node, cx)?;
    if matches!(kind, JointKind::Free | JointKind::Planar) {
        let message = format!("a loop joint of type {} is not supported", quote_word(word));
        cx.report_error(&element_source_position(node, cx), message, |d| {
            d.add_help("expected `spherical`, `revolute`, `continuous`, `prismatic` or `fixed`")
        });
        return None;
    }
    let mut ends = child_elements(node).filter(|child| matches!(child.tag_name().name(), "link1" | "link2"));
    let attributes = ["link", "xyz", "rpy"];
    let first = required_child(ends.next(), node, "link1", &attributes, cx)?;
    let second = required_child(ends.next(), node, "link2", &attributes, cx)?;
    let axis = child_elements(node).find(|child| child.tag_name().name() == "axis");
    let axis = read_axis(axis.filter(|_| has_axis(kind)), node, cx);
    let mut read_joint_end = |end: Node<'_>| {
        report_unexpected_contents(end, &["link"], &["xyz", "rpy"], &[], cx);
        let link = read_name_attribute(end, "link", cx)?;
        let zero_vector_at_end = || Located { value: [0.0; 3], place: element_source_position(end, cx) };
        let (xyz, rpy) = (zero_vector_at_end(), zero_vector_at_end());
        let xyz = read_numbers_attribute(end, "xyz", cx).unwrap_or(xyz);
        let rpy = read_numbers_attribute(end, "rpy", cx).unwrap_or(rpy);
        Some((link, FileOrigin { xyz, rpy }.pose()))
    };
    let (parent, child) = (read_joint_end(first)?, read_joint_end(second)?);
    Some(joint_between(name?, (kind, word), parent, child, &axis))
}

/// Reads `<drake:ball_constraint>`, which has no name.
fn read_ball_constraint(node: Node<'_>, robot: &Robot, cx: &mut Cx<'_>) -> Option<FileJoint> {
    let parts = ["body_A", "body_B", "p_AP", "p_BQ"].map(|part| format!("ball_constraint_{part}"));
    let parts = parts.each_ref().map(String::as_str);
    let found = child_for_each_name(node, parts, cx);
    let mut missing = parts.iter().zip(found).filter(|(_, part)| part.is_none());
    if let Some((part, _)) = missing.next() {
        let message = format!("`<drake:ball_constraint>` without `<drake:{part}>`");
        cx.report_error(&element_source_position(node, cx), message, |d| d);
        return None;
    }
    let [a, b, p, q] = found;
    let link_name_of_element =
        |part: Option<Node<'_>>, cx: &mut Cx<'_>| read_name_attribute(part?, "name", cx);
    let pose_of_point_element = |part: Option<Node<'_>>, cx: &mut Cx<'_>| {
        let part = part?;
        report_missing_or_misspelt_attributes(part, &["value"], &[], cx);
        read_numbers_attribute::<3>(part, "value", cx)
            .map(|at| NumericPose { at: at.value, ..NumericPose::ZERO })
    };
    for link in [a, b].into_iter().flatten() {
        report_missing_or_misspelt_attributes(link, &["name"], &[], cx);
    }
    let (parent, child) = (link_name_of_element(a, cx), link_name_of_element(b, cx));
    let (on_parent, on_child) = (pose_of_point_element(p, cx), pose_of_point_element(q, cx));
    let is_joint_name_taken = |name: &str| robot.joints.iter().any(|joint| joint.name.text == name);
    let place = element_source_position(node, cx);
    let name = Name { text: unused_name("ball_constraint", is_joint_name_taken), place: place.clone() };
    let axis = Located { value: [1.0, 0.0, 0.0], place };
    let kind = (JointKind::Ball, "spherical");
    Some(joint_between(name, kind, (parent?, on_parent?), (child?, on_child?), &axis))
}
