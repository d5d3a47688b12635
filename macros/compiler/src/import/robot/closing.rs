//! Detection of joints that close kinematic loops.

use super::assemble::joint_of;
use super::parts::Robot;
use crate::import::context::{Cx, quote};
use std::collections::BTreeSet;

/// Moves the joints that close loops from the tree to `robot.closing`. A joint closes a loop if an earlier
/// joint has the same child link.
///
/// Loop-closing joints have no coordinates, so nothing can act on one: drives, damping, friction and `mimic`
/// of such joints are reported.
pub(in crate::import) fn close_loops(robot: &mut Robot, cx: &mut Cx<'_>) {
    let links: BTreeSet<&str> = robot.links.iter().map(|link| link.name.text.as_str()).collect();
    let mut carried: BTreeSet<String> = BTreeSet::new();
    let (mut tree, mut closing) = (Vec::new(), Vec::new());
    for joint in std::mem::take(&mut robot.joints) {
        let is_first = carried.insert(joint.child.text.clone());
        // Unknown links are reported by another check.
        let known = [&joint.parent, &joint.child].into_iter().all(|end| links.contains(end.text.as_str()));
        match is_first || !known || joint.parent.text == joint.child.text {
            true => tree.push(joint),
            false => closing.push(joint),
        }
    }
    robot.joints = tree;
    for joint in closing {
        let driven = robot.drives.iter().any(|drive| drive.name.text == joint.name.text);
        if driven || joint.damping.is_some() || joint.friction.is_some() || joint.mimic.is_some() {
            let message =
                format!("joint {} closes a loop, and has forces or a leader", quote(&joint.name.text));
            cx.error(&joint.name.place, message, |d| {
                d.help("another joint of the loop may close it: write the one that does last")
                    .help("or leave them out: `#[mechanism(…, passive = ignore, mimic = independent)]`")
            });
        }
        if joint.limits.bounds() {
            robot.left_out.push(format!("limits of {}, which closes a loop", joint.name.text));
        }
        robot.closing.push(joint_of(joint));
    }
}
