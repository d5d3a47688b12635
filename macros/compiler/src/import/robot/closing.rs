//! Joints to a link that another joint carries → joints that close loops.

use super::assemble::joint_of;
use super::parts::Robot;
use crate::import::context::{Cx, quote};
use std::collections::BTreeSet;

/// Takes the joints that close loops out of the tree: those whose child an earlier joint carries.
///
/// They have no coordinate, so nothing may act on one: springs and dampers on them are reported.
pub(in crate::import) fn close_loops(robot: &mut Robot, cx: &mut Cx<'_>) {
    let links: BTreeSet<&str> = robot.links.iter().map(|link| link.name.text.as_str()).collect();
    let mut carried: BTreeSet<String> = BTreeSet::new();
    let (mut tree, mut closing) = (Vec::new(), Vec::new());
    for joint in std::mem::take(&mut robot.joints) {
        let is_first = carried.insert(joint.child.text.clone());
        // What the ends are that a mistake names is said elsewhere.
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
