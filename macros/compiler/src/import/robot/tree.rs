//! Ordering of joints by the kinematic tree.

use super::parts::Robot;
use crate::import::context::{Cx, quote_first_eight_words, quote_word};
use std::collections::BTreeMap;

/// Root of the kinematic tree, and the joints in coordinate order.
pub(in crate::import) struct JointOrder {
    /// Index of the link that is no joint's child.
    pub(in crate::import) root: usize,
    /// Pairs of the index of a joint and of its child link, depth first. Joints of one parent are sorted by
    /// name.
    pub(in crate::import) joints: Vec<(usize, usize)>,
}

/// Orders the joints. Names must have been checked before. Returns `None` with the error in `cx` if the links
/// do not form a single tree.
pub(in crate::import) fn order_joints_along_tree(robot: &Robot, cx: &mut Cx<'_>) -> Option<JointOrder> {
    let name_with_index = |(k, name): (usize, &str)| (name.to_string(), k);
    let links: BTreeMap<String, usize> =
        robot.links.iter().map(|link| link.name.text.as_str()).enumerate().map(name_with_index).collect();
    let ends: Option<Vec<(usize, usize)>> = robot
        .joints
        .iter()
        .map(|joint| Some((*links.get(&joint.parent.text)?, *links.get(&joint.child.text)?)))
        .collect();
    let ends = ends?;
    let mut above = vec![None; robot.links.len()];
    for (joint, (_, child)) in ends.iter().enumerate() {
        above[*child] = Some(joint);
    }
    report_all_link_cycles(robot, &ends, &above, cx);
    let root = find_root(robot, &above, cx)?;
    Some(JointOrder { root, joints: depth_first_order(robot, root, &ends) })
}

/// Returns the link that is no joint's child, the root. Returns `None` if there is a cycle, which is reported
/// separately.
fn find_root(robot: &Robot, above: &[Option<usize>], cx: &mut Cx<'_>) -> Option<usize> {
    let mut roots = (0..above.len()).filter(|link| above[*link].is_none());
    let root = roots.next()?;
    if let Some(second) = roots.next() {
        let all = [root, second].into_iter().chain(roots);
        let names = quote_first_eight_words(all.map(|link| robot.links[link].name.text.as_str()));
        let message = format!("expected one link that is not the child of a joint, found {names}");
        let help = "every link but one needs a joint that has it as its child";
        let closing = robot.closing.iter().map(|joint| joint.name.text.as_str());
        cx.report_error(&robot.links[second].name.place, message, |d| {
            let d = d.add_help(help);
            match robot.closing.is_empty() {
                true => d,
                false => d.add_help(format!(
                    "joints that close loops carry no link: {}",
                    quote_first_eight_words(closing)
                )),
            }
        });
        return None;
    }
    Some(root)
}

/// Reports every cycle of links and joints once.
fn report_all_link_cycles(robot: &Robot, ends: &[(usize, usize)], above: &[Option<usize>], cx: &mut Cx<'_>) {
    // Each upward walk marks its links with its own number. It ends at the root, at an earlier walk or at
    // itself.
    let mut walks = vec![None; above.len()];
    for start in 0..above.len() {
        let mut link = start;
        while let (None, Some(joint)) = (walks[link], above[link]) {
            walks[link] = Some(start);
            link = ends[joint].0;
        }
        if walks[link] == Some(start) {
            report_link_cycle(robot, ends, above, link, cx);
        }
        walks[link].get_or_insert(start);
    }
}

fn report_link_cycle(
    robot: &Robot,
    ends: &[(usize, usize)],
    above: &[Option<usize>],
    link: usize,
    cx: &mut Cx<'_>,
) {
    let parent_link = |from: &usize| above[*from].map(|joint| ends[joint].0);
    let Some(joint) = above[link].map(|joint| &robot.joints[joint]) else {
        return;
    };
    let rest = std::iter::successors(parent_link(&link), parent_link).take_while(|l| *l != link);
    let links = std::iter::once(link).chain(rest).map(|l| robot.links[l].name.text.as_str());
    let message = format!("links {} form a cycle", quote_first_eight_words(links));
    let help = format!("joint {} closes the cycle; a tree has a root", quote_word(&joint.name.text));
    cx.report_error(&joint.parent.place, message, |d| d.add_help(help));
}

/// Traverses the tree depth first. An explicit stack replaces recursion, because chains may be long.
fn depth_first_order(robot: &Robot, root: usize, ends: &[(usize, usize)]) -> Vec<(usize, usize)> {
    let mut below: Vec<Vec<(usize, usize)>> = vec![Vec::new(); robot.links.len()];
    for (joint, (parent, child)) in ends.iter().enumerate() {
        below[*parent].push((joint, *child));
    }
    for joints in &mut below {
        // In reverse order, because the stack is popped from its end.
        joints.sort_by(|a, b| robot.joints[b.0].name.text.cmp(&robot.joints[a.0].name.text));
    }
    let mut order = Vec::with_capacity(ends.len());
    let mut stack = std::mem::take(&mut below[root]);
    while let Some((joint, child)) = stack.pop() {
        order.push((joint, child));
        stack.append(&mut below[child]);
    }
    order
}
