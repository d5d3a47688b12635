//! Force elements on coordinates, after locks: what stands still adds no force, but its share of a length.

use super::joint::FileJoint;
use super::motion::{Motion, frozen};
use crate::syntax::{Drive, DriveLaw, DriveOn};
use std::collections::BTreeMap;

/// The elements on what still moves. An input on nothing stays: programs count on its entry.
pub(super) fn resolve(drives: Vec<Drive>, joints: &[Option<(FileJoint, Motion)>]) -> Vec<Drive> {
    let frozen = frozen(joints);
    drives.into_iter().filter_map(|drive| without(drive, &frozen)).collect()
}

/// The element without the joints that stand still.
fn without(mut drive: Drive, frozen: &BTreeMap<&str, f64>) -> Option<Drive> {
    let DriveOn::Sum(terms) = &mut drive.on else { return Some(drive) };
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
        _ => {}
    }
    (!terms.is_empty() || matches!(drive.law, DriveLaw::Input(_))).then_some(drive)
}
