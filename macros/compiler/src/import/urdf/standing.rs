//! Links that are fixed to the ground. They are found before the links are read, because their mass
//! properties appear in no equation and may be incomplete.

use crate::import::element::{Node, child_elements};
use crate::syntax::{BaseAttachment, FileOptions};
use std::collections::{BTreeMap, BTreeSet};

/// Returns the names of the links that fixed and locked joints connect to a fixed root. If the file's tree is
/// invalid, the result may contain other links.
pub(super) fn links_fixed_to_ground<'a>(robot: Node<'a>, options: &FileOptions) -> BTreeSet<&'a str> {
    let mut standing = BTreeSet::new();
    if options.base == BaseAttachment::Free {
        return standing;
    }
    let (mut below, mut carried) = (BTreeMap::<&str, Vec<&str>>::new(), BTreeSet::new());
    for joint in child_elements(robot).filter(|node| node.tag_name().name() == "joint") {
        let link_of_joint_end = |name| {
            let end = child_elements(joint).find(|node| node.tag_name().name() == name)?;
            end.attribute("link")
        };
        let (Some(parent), Some(child)) = (link_of_joint_end("parent"), link_of_joint_end("child")) else {
            continue;
        };
        carried.insert(child);
        let is_locked =
            joint.attribute("name").is_some_and(|name| options.lock.iter().any(|l| l.text == name));
        if is_locked || joint.attribute("type") == Some("fixed") {
            below.entry(parent).or_default().push(child);
        }
    }
    let links = child_elements(robot).filter(|node| node.tag_name().name() == "link");
    let mut open: Vec<&str> = links.filter_map(|link| link.attribute("name")).collect();
    open.retain(|link| !carried.contains(link));
    // Links that are used as a parent but not declared are roots, too.
    open.extend(below.keys().filter(|link| !carried.contains(*link)));
    while let Some(link) = open.pop() {
        if standing.insert(link) {
            open.extend(below.get(link).into_iter().flatten());
        }
    }
    standing
}
