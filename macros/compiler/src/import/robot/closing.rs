//! Detection of joints that close kinematic loops.

use super::assemble::convert_file_joint;
use super::joint::FileJoint;
use super::parts::Robot;
use crate::import::context::{Cx, quote_word};
use std::collections::{BTreeMap, BTreeSet};

/// Moves the joints that close loops from the tree to `robot.closing`. Of several joints with the same child
/// link, the first whose parent does not hang from that link belongs to the tree; the others close loops, and
/// so do joints that are declared to.
///
/// Loop-closing joints have no coordinates, so nothing can act on one: drives, damping, friction and `mimic`
/// of such joints are reported.
pub(in crate::import) fn separate_loop_closing_joints(robot: &mut Robot, cx: &mut Cx<'_>) {
    for joint in take_loop_closing_joints(robot) {
        let driven = robot.drives.iter().any(|drive| drive.name.text == joint.name.text);
        if driven || joint.damping.is_some() || joint.friction.is_some() || joint.mimic.is_some() {
            let message = format!(
                "joint {} closes a loop, and has forces or follows another joint",
                quote_word(&joint.name.text)
            );
            cx.report_error(&joint.name.place, message, |d| {
                d.add_help("another joint of the loop can close it: write that joint last")
                    .add_help("or ignore them: `#[mechanism(…, passive = ignore, mimic = independent)]`")
            });
        }
        if joint.limits.has_limits() {
            robot.left_out.push(format!("limits of {}, which closes a loop", joint.name.text));
        }
        robot.closing.push(convert_file_joint(joint));
    }
}

/// Removes the joints that close loops, and lists them among what the mechanism does not represent.
pub(in crate::import) fn remove_loop_closing_joints(robot: &mut Robot) {
    for joint in take_loop_closing_joints(robot) {
        robot.left_out.push(format!("joint {}, which closes a loop", joint.name.text));
    }
}

/// Reports the first joint that is declared to close a loop.
pub(in crate::import) fn refuse_declared_loops(robot: &Robot, cx: &mut Cx<'_>) {
    let is_declared_closing_joint = |joint: &&FileJoint| robot.declared_closing.contains(&joint.name.text);
    if let Some(joint) = robot.joints.iter().find(is_declared_closing_joint) {
        let message = format!("{} closes a loop", quote_word(&joint.name.text));
        cx.report_error(&joint.name.place, message, |d| d.add_help(CLOSE).add_help(OPEN));
    }
}

/// Advice for files with loops.
const CLOSE: &str = "to close it, write `#[mechanism(…, loops = close)]`";
const OPEN: &str = "to leave it open, write `#[mechanism(…, loops = ignore)]`";

/// Removes the joints that close loops from the tree and returns them.
fn take_loop_closing_joints(robot: &mut Robot) -> Vec<FileJoint> {
    let chosen = loop_closing_joints(robot);
    let joints = std::mem::take(&mut robot.joints).into_iter().enumerate();
    let (closing, tree): (Vec<_>, Vec<_>) = joints.partition(|(k, _)| chosen.contains(k));
    robot.joints = tree.into_iter().map(|(_, joint)| joint).collect();
    closing.into_iter().map(|(_, joint)| joint).collect()
}

/// Returns the indices of the joints that close loops. Joints with unknown links, or from a link to itself,
/// are reported by another check.
fn loop_closing_joints(robot: &Robot) -> BTreeSet<usize> {
    let links: BTreeSet<&str> = robot.links.iter().map(|link| link.name.text.as_str()).collect();
    let mut joints_above: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    let mut links_below: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    let mut closing = BTreeSet::new();
    for (k, joint) in robot.joints.iter().enumerate() {
        if robot.declared_closing.contains(&joint.name.text) {
            closing.insert(k);
            continue;
        }
        let (parent, child) = (joint.parent.text.as_str(), joint.child.text.as_str());
        if links.contains(parent) && links.contains(child) && parent != child {
            joints_above.entry(child).or_default().push(k);
            links_below.entry(parent).or_default().push(child);
        }
    }
    for (child, joints) in joints_above.into_iter().filter(|(_, joints)| joints.len() > 1) {
        let mut below = BTreeSet::from([child]);
        let mut stack = vec![child];
        while let Some(link) = stack.pop() {
            let next = links_below.get(link).into_iter().flatten();
            stack.extend(next.copied().filter(|link| below.insert(*link)));
        }
        let has_parent_outside = |k: &usize| !below.contains(robot.joints[*k].parent.text.as_str());
        let kept = joints.iter().copied().find(has_parent_outside).unwrap_or(joints[0]);
        closing.extend(joints.into_iter().filter(|k| *k != kept));
    }
    closing
}
