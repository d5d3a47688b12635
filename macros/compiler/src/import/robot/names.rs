//! Checks of names: links, joints, endpoints of joints and locks must exist, and names must be unique. Also
//! generates unused names.

use super::joint::FileJoint;
use super::parts::{Robot, massless_link};
use crate::import::context::{Cx, format_position, quote_word};
use crate::syntax::{BaseAttachment, FileFormat, GROUND, Name};
use std::collections::{BTreeMap, BTreeSet};

/// Reports links that share a name, and joints that share a name.
pub(in crate::import) fn check_unique_names(robot: &Robot, format: FileFormat, cx: &mut Cx<'_>) {
    report_repeated_names(robot.links.iter().map(|link| &link.name), format.word_for_body(), cx);
    report_repeated_names(robot.joints.iter().map(|joint| &joint.name), "joint", cx);
}

/// Link that files use as a parent without declaring it.
const WORLD: &str = "world";

/// Declares the link `world` if joints have it as parent and the file does not define it, as other tools do.
pub(in crate::import) fn declare_world_link(robot: &mut Robot) {
    let is_known = robot.links.iter().any(|link| link.name.text == WORLD)
        || robot.joints.iter().any(|joint| joint.child.text == WORLD);
    let used = robot.joints.iter().find(|joint| joint.parent.text == WORLD);
    if let Some(world) = used.filter(|_| !is_known).map(|joint| joint.parent.clone()) {
        robot.links.push(massless_link(world));
    }
}

/// Renames a link `ground` to `ground_link`, because `ground` is the name of the fixed frame. The root of a
/// fixed mechanism may be called `ground`.
pub(in crate::import) fn rename_link_named_ground(robot: &mut Robot, base: BaseAttachment) {
    if base == BaseAttachment::Fixed && !robot.joints.iter().any(|joint| joint.child.text == GROUND) {
        return;
    }
    let other = unused_name("ground_link", |name| robot.links.iter().any(|link| link.name.text == name));
    let ends = robot.joints.iter_mut().flat_map(|joint| [&mut joint.parent, &mut joint.child]);
    let names = robot.links.iter_mut().map(|link| &mut link.name).chain(ends);
    for name in names.filter(|name| name.text == GROUND) {
        name.text.clone_from(&other);
    }
}

/// Returns the name, with a number appended if it is already used.
pub(in crate::import) fn unused_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let mut text = name.to_string();
    for k in 2.. {
        if !is_taken(&text) {
            break;
        }
        text = format!("{name}{k}");
    }
    text
}

/// Reports names that occur more than once among the elements of one kind.
pub(in crate::import) fn report_repeated_names<'a>(
    names: impl Iterator<Item = &'a Name>,
    what: &str,
    cx: &mut Cx<'_>,
) {
    let mut seen = BTreeMap::new();
    for name in names {
        if let Some(first) = seen.get(name.text.as_str()).copied() {
            let message = format!("second {what} with the name {}", quote_word(&name.text));
            cx.report_error(&name.place, message, |d| {
                d.add_help(format!("the first is at {}", format_position(first)))
            });
        } else {
            seen.insert(name.text.as_str(), &name.place);
        }
    }
}

/// Reports joints with unknown links.
pub(in crate::import) fn report_unknown_links(robot: &Robot, cx: &mut Cx<'_>) {
    let links: Vec<&str> = robot.links.iter().map(|link| link.name.text.as_str()).collect();
    let known: BTreeSet<&str> = links.iter().copied().collect();
    for end in robot.joints.iter().flat_map(|joint| [&joint.parent, &joint.child]) {
        if !known.contains(end.text.as_str()) {
            let message = format!("unknown link {}", quote_word(&end.text));
            cx.report_error(&end.place, message, |d| d.suggest_name(&end.text, links.iter().copied()));
        }
    }
}

/// Reports joints from a link to itself, and links with two parents.
pub(in crate::import) fn report_wrong_joint_ends(robot: &Robot, format: FileFormat, cx: &mut Cx<'_>) {
    let mut parents: BTreeMap<&str, &FileJoint> = BTreeMap::new();
    for joint in &robot.joints {
        if joint.parent.text == joint.child.text {
            let message = format!("joint {} connects a link to itself", quote_word(&joint.name.text));
            cx.report_error(&joint.child.place, message, |d| d);
        } else if let Some(first) = parents.get(joint.child.text.as_str()) {
            // Repeated joint names are reported by `check_unique_names`.
            if first.name.text == joint.name.text {
                continue;
            }
            report_two_parents(first, joint, format, cx);
        } else {
            parents.insert(&joint.child.text, joint);
        }
    }
}

fn report_two_parents(first: &FileJoint, second: &FileJoint, format: FileFormat, cx: &mut Cx<'_>) {
    let (link, a, b) =
        (quote_word(&second.child.text), quote_word(&first.name.text), quote_word(&second.name.text));
    cx.report_error(
        &second.child.place,
        format!("link {link} is the child of two joints, {a} and {b}"),
        |d| {
            d.add_help(format!("the first is at {}", format_position(&first.child.place)));
            match format {
                FileFormat::Urdf => {
                    d.add_help("if one of them closes a loop, write `#[mechanism(…, loops = close)]`")
                }
                _ => d.add_help("the links of a file form a tree; it has no closed loops"),
            }
        },
    );
}

/// Reports names in the option `lock` that no joint has.
pub(in crate::import) fn check_locked_names(joints: &[FileJoint], locks: &[Name], cx: &mut Cx<'_>) {
    for lock in locks.iter().filter(|lock| joints.iter().all(|joint| joint.name.text != lock.text)) {
        let names = joints.iter().map(|joint| joint.name.text.as_str());
        let message = format!("unknown joint {} in `lock`", quote_word(&lock.text));
        cx.report_error(&lock.place, message, |d| d.suggest_name(&lock.text, names));
    }
}
