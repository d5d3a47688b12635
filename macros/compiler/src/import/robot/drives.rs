//! Removes locked joints from force elements on coordinates. A locked joint transmits no force, but its
//! coordinate contributes a constant to the length of an element.

use super::joint::FileJoint;
use super::motion::{JointMotion, locked_coordinates};
use crate::syntax::{Drive, DriveLaw, DriveTarget};
use std::collections::BTreeMap;

/// Returns the elements that act on at least one moving joint. Inputs without a joint are preserved, because
/// callers rely on the input's index.
pub(super) fn drives_of_moving_joints(
    drives: Vec<Drive>,
    joints: &[Option<(FileJoint, JointMotion)>],
) -> Vec<Drive> {
    let frozen = locked_coordinates(joints);
    drives.into_iter().filter_map(|drive| without_locked_joints(drive, &frozen)).collect()
}

/// Returns the element without the locked joints. Their contributions are subtracted from free lengths and
/// ranges.
fn without_locked_joints(mut drive: Drive, frozen: &BTreeMap<&str, f64>) -> Option<Drive> {
    let DriveTarget::Sum(terms) = &mut drive.on else { return Some(drive) };
    let mut offset = 0.0;
    terms.retain(|(joint, weight)| match frozen.get(joint.text.as_str()) {
        Some(at) => {
            offset += weight * at;
            false
        }
        None => true,
    });
    match &mut drive.law {
        DriveLaw::Spring { free, .. } => *free -= offset,
        DriveLaw::Slack { range, .. } => range.iter_mut().for_each(|end| *end -= offset),
        DriveLaw::Expression { offset: constant, .. } => *constant = offset,
        DriveLaw::Damper(_)
        | DriveLaw::PolynomialDamper(_)
        | DriveLaw::Friction(_)
        | DriveLaw::Inerter(_)
        | DriveLaw::Push(_)
        | DriveLaw::Input(_) => {}
    }
    // The rates of states may contain the length of an element that acts on nothing.
    let is_kept = matches!(drive.law, DriveLaw::Input(_) | DriveLaw::Expression { .. });
    (!terms.is_empty() || is_kept).then_some(drive)
}
