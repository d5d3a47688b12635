//! Removes locked joints from force elements on coordinates. A locked joint transmits no force, but its
//! coordinate contributes a constant to the length of an element.

use super::joint::FileJoint;
use super::motion::{JointMotion, locked_coordinates};
use crate::syntax::{FileForceElement, FileForceLaw, FileForceTarget};
use std::collections::BTreeMap;

/// Returns the elements that act on at least one moving joint. Inputs without a joint are preserved, because
/// callers rely on the input's index.
pub(super) fn drives_of_moving_joints(
    drives: Vec<FileForceElement>,
    joints: &[Option<(FileJoint, JointMotion)>],
) -> Vec<FileForceElement> {
    let frozen = locked_coordinates(joints);
    drives.into_iter().filter_map(|drive| drive_without_locked_joints(drive, &frozen)).collect()
}

/// Returns the element without the locked joints. Their contributions are subtracted from free lengths and
/// ranges.
fn drive_without_locked_joints(
    mut drive: FileForceElement,
    frozen: &BTreeMap<&str, f64>,
) -> Option<FileForceElement> {
    let FileForceTarget::Sum(terms) = &mut drive.on else { return Some(drive) };
    let mut offset = 0.0;
    terms.retain(|(joint, weight)| match frozen.get(joint.text.as_str()) {
        Some(at) => {
            offset += weight * at;
            false
        }
        None => true,
    });
    match &mut drive.law {
        FileForceLaw::Spring { free, .. } => *free -= offset,
        FileForceLaw::Slack { range, .. } => range.iter_mut().for_each(|end| *end -= offset),
        FileForceLaw::Expression { offset: constant, .. } => *constant = offset,
        FileForceLaw::Damper(_)
        | FileForceLaw::PolynomialDamper(_)
        | FileForceLaw::Friction(_)
        | FileForceLaw::Inerter(_)
        | FileForceLaw::Push(_)
        | FileForceLaw::Input(_) => {}
    }
    // The rates of states may contain the length of an element that acts on nothing.
    let is_kept = matches!(drive.law, FileForceLaw::Input(_) | FileForceLaw::Expression { .. });
    (!terms.is_empty() || is_kept).then_some(drive)
}
