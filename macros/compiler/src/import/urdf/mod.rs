//! Import of URDF: `<robot>` → bodies and joints in coordinate order.
//!
//! The whole file is read before its topology is checked: joints may precede their links, and all errors of
//! one kind are reported together. The topology is checked only if every element could be read, because a
//! missing joint creates roots and cycles that are not in the file.

use super::context::Cx;
use super::element::{
    Node, child_elements, element_source_position, quoted_tag, report_misspelt_element_name,
};
use super::misplaced;
use crate::import::imported::ImportedMechanism;
use crate::import::robot::{self, MAX_ELEMENTS, Robot};
use crate::syntax::{FileOptions, LoopOption};
use std::path::Path;

mod collision;
mod gazebo;
mod joint;
mod limit;
mod link;
mod loops;
mod origin;
mod standing;
mod visual;

/// Reads the root element of a URDF file in `folder`.
pub(super) fn mechanism_from_root_element(
    node: Node<'_>,
    folder: &Path,
    options: &FileOptions,
    cx: &mut Cx<'_>,
) -> Option<ImportedMechanism> {
    if !check_root_element(node, cx) {
        return None;
    }
    let mut robot = read_robot(node, folder, options, cx)?;
    robot::check_unique_names(&robot, options.format, cx);
    robot::declare_world_link(&mut robot);
    robot::rename_link_named_ground(&mut robot, options.base);
    if !cx.has_errors() {
        robot::report_unknown_links(&robot, cx);
        match options.loops {
            LoopOption::Refuse => robot::refuse_declared_loops(&robot, cx),
            LoopOption::Close => robot::separate_loop_closing_joints(&mut robot, cx),
            LoopOption::Ignore => robot::remove_loop_closing_joints(&mut robot),
        }
    }
    robot::report_wrong_joint_ends(&robot, options.format, cx);
    robot::check_locked_names(&robot.joints, &options.lock, cx);
    if cx.has_errors() {
        return None;
    }
    let order = robot::order_joints_along_tree(&robot, cx);
    let motions = robot::resolve_motions(&robot.joints, &options.lock, cx);
    let (Some(order), Some(motions)) = (order, motions) else {
        return None;
    };
    let standing = standing::links_fixed_to_ground(node, options)
        .into_iter()
        .map(ToString::to_string)
        .collect::<Vec<_>>();
    let closing = std::mem::take(&mut robot.closing);
    let mut imported = robot::assemble_mechanism(robot, &order, motions, options, cx);
    robot::make_value_fields(&mut imported, &standing, options, cx);
    imported.joints.extend(closing);
    (!cx.has_errors()).then_some(imported)
}

/// Returns true if the root element is `<robot>`; otherwise reports an error.
fn check_root_element(node: Node<'_>, cx: &mut Cx<'_>) -> bool {
    let name = node.tag_name().name();
    if name == "robot" {
        return true;
    }
    let message = format!("expected `<robot>`, found {}", quoted_tag(node));
    cx.report_error(&element_source_position(node, cx), message, |d| match name {
        "sdf" => d.add_help("this is an SDF file: write `sdf = \"…\"` instead of `urdf = \"…\"`"),
        "mujoco" => d.add_help("this is an MJCF file: write `mjcf = \"…\"` instead of `urdf = \"…\"`"),
        _ => d.suggest_name(name, ["robot"]),
    });
    false
}

fn read_robot(node: Node<'_>, folder: &Path, options: &FileOptions, cx: &mut Cx<'_>) -> Option<Robot> {
    let mut counts = [0, 0];
    let standing = standing::links_fixed_to_ground(node, options);
    let mut robot = Robot::default();
    misplaced::report_misplaced_contents(
        node,
        &["link", "joint"],
        "expected `<link>` and `<joint>`, which describe all moving parts",
        cx,
    );
    for child in child_elements(node) {
        let kind = match child.tag_name().name() {
            "link" => 0,
            "joint" => 1,
            loops::LOOP_JOINT => continue,
            _ => {
                report_misspelt_element_name(child, &["link", "joint"], cx);
                continue;
            }
        };
        counts[kind] += 1;
        if counts[kind] > MAX_ELEMENTS {
            cx.report_error(
                &element_source_position(child, cx),
                format!("more than {MAX_ELEMENTS} elements {}", quoted_tag(child)),
                |d| d,
            );
            return None;
        }
        match kind {
            0 => {
                let number = robot.links.len();
                robot.links.extend(link::read_link(child, |link| standing.contains(link), options, cx));
                if options.visuals {
                    robot
                        .visuals
                        .extend(visual::read_visuals(child, cx).into_iter().map(|part| (number, part)));
                }
                if options.collisions {
                    let parts = collision::read_collisions(child, folder, cx).into_iter();
                    robot.collisions.extend(parts.map(|part| (number, part)));
                }
            }
            _ => robot.joints.extend(joint::read_joint(child, options, &mut robot.left_out, cx)),
        }
    }
    loops::read_declared_loops(node, options, &mut robot, cx);
    if let Some(tolerance) = options.snap.filter(|_| !cx.has_errors()) {
        robot.snapped =
            robot.joints.iter_mut().flat_map(|joint| robot::snap_joint_frame(joint, tolerance)).collect();
    }
    if counts[0] == 0 && !cx.has_errors() {
        cx.report_error(&element_source_position(node, cx), "robot without a link", |d| {
            d.add_help("expected `<link name=\"…\"/>`")
        });
    }
    Some(robot)
}
