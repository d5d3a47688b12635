//! The links that stand on the ground, found before anything is read: their mass properties enter no
//! equation.

use crate::import::element::{Node, elements};
use crate::syntax::{Base, FileOptions};
use std::collections::{BTreeMap, BTreeSet};

/// Names of the links that fixed and locked joints hold to a fixed root. A file with mistakes in its tree may
/// have others.
pub(super) fn links<'a>(robot: Node<'a>, options: &FileOptions) -> BTreeSet<&'a str> {
    let mut standing = BTreeSet::new();
    if options.base == Base::Free {
        return standing;
    }
    let (mut below, mut carried) = (BTreeMap::<&str, Vec<&str>>::new(), BTreeSet::new());
    for joint in elements(robot).filter(|node| node.tag_name().name() == "joint") {
        let end = |name| {
            let end = elements(joint).find(|node| node.tag_name().name() == name)?;
            end.attribute("link")
        };
        let (Some(parent), Some(child)) = (end("parent"), end("child")) else { continue };
        carried.insert(child);
        let is_locked =
            joint.attribute("name").is_some_and(|name| options.lock.iter().any(|l| l.text == name));
        if is_locked || joint.attribute("type") == Some("fixed") {
            below.entry(parent).or_default().push(child);
        }
    }
    let links = elements(robot).filter(|node| node.tag_name().name() == "link");
    let mut open: Vec<&str> = links.filter_map(|link| link.attribute("name")).collect();
    open.retain(|link| !carried.contains(link));
    // A root that is used and not declared.
    open.extend(below.keys().filter(|link| !carried.contains(*link)));
    while let Some(link) = open.pop() {
        if standing.insert(link) {
            open.extend(below.get(link).into_iter().flatten());
        }
    }
    standing
}
