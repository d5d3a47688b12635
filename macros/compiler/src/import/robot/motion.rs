//! Resolution of locks and `mimic` elements: for each joint, whether it moves freely, follows another joint
//! or is locked.

use super::joint::FileJoint;
use crate::import::context::{Cx, quote_first_eight_words, quote_word};
use crate::syntax::{MimicRelation, Name};
use std::collections::BTreeMap;

/// Motion of a joint: free, coupled or locked.
pub(in crate::import) enum JointMotion {
    /// Joint whose coordinate is independent.
    Own,
    /// Joint that follows an independent joint by a linear relation.
    Follows(MimicRelation),
    /// Joint that is locked at this coordinate, m or rad.
    Frozen(f64),
}

/// Returns the coordinates of the locked joints by name.
pub(in crate::import) fn locked_coordinates(
    joints: &[Option<(FileJoint, JointMotion)>],
) -> BTreeMap<&str, f64> {
    joints
        .iter()
        .flatten()
        .filter_map(|(joint, motion)| match motion {
            JointMotion::Frozen(at) => Some((joint.name.text.as_str(), *at)),
            _ => None,
        })
        .collect()
}

/// Determines the motion of each joint. Locks have priority: joints that follow a locked joint are locked,
/// too.
pub(in crate::import) fn resolve_motions(
    joints: &[FileJoint],
    locks: &[Name],
    cx: &mut Cx<'_>,
) -> Option<Vec<JointMotion>> {
    let index: BTreeMap<&str, usize> =
        joints.iter().enumerate().map(|(k, joint)| (joint.name.text.as_str(), k)).collect();
    let mut locked: Vec<bool> = joints.iter().map(|joint| joint.held.is_some()).collect();
    for lock in locks.iter().filter_map(|lock| index.get(lock.text.as_str())) {
        locked[*lock] = true;
    }
    let leaders: Vec<Option<usize>> = (0..joints.len())
        .map(|k| if locked[k] { None } else { find_leader(&joints[k], joints, &index, cx) })
        .collect();
    report_leader_cycles(joints, &leaders, cx);
    // Following the leaders terminates only if there are no cycles.
    if cx.has_errors() {
        return None;
    }
    let motions = (0..joints.len()).map(|k| match locked[k] {
        true => JointMotion::Frozen(joints[k].held.unwrap_or(0.0)),
        false => compose_leader_relations(k, joints, &leaders, &locked, cx),
    });
    Some(motions.collect())
}

/// Returns the index of the joint that `joint` follows. Reports unknown leaders, and joints that cannot
/// follow or lead.
fn find_leader(
    joint: &FileJoint,
    joints: &[FileJoint],
    index: &BTreeMap<&str, usize>,
    cx: &mut Cx<'_>,
) -> Option<usize> {
    let mimic = joint.mimic.as_ref()?;
    let place = &mimic.joint.place;
    let Some(leader) = index.get(mimic.joint.text.as_str()).copied() else {
        let names =
            joints.iter().filter(|other| other.has_single_coordinate()).map(|other| other.name.text.as_str());
        let message = format!("unknown joint {}", quote_word(&mimic.joint.text));
        cx.report_error(place, message, |d| d.suggest_name(&mimic.joint.text, names).add_help(MOVE_ALONE));
        return None;
    };
    for (which, one) in [("follow", joint), ("be followed", &joints[leader])] {
        if !one.has_single_coordinate() {
            let name = quote_word(&one.name.text);
            let message = format!("joint {name} is `{}` and cannot {which}", one.word);
            cx.report_error(place, message, |d| d.add_help(MOVE_ALONE));
            return None;
        }
    }
    Some(leader)
}

const MOVE_ALONE: &str =
    "to let joints that follow move on their own, write `#[mechanism(…, mimic = independent)]`";

/// Reports each cycle of joints that follow one another once.
fn report_leader_cycles(joints: &[FileJoint], leaders: &[Option<usize>], cx: &mut Cx<'_>) {
    for start in 0..joints.len() {
        let walk = std::iter::successors(leaders[start], |k| leaders[*k]);
        let circle: Vec<usize> = walk.take(joints.len()).take_while(|k| *k != start).collect();
        let back = circle.last().map_or(leaders[start], |last| leaders[*last]);
        // A walk that starts outside the cycle never returns. Of the joints in the cycle only the first
        // reports it.
        if back != Some(start) || circle.iter().any(|k| *k < start) {
            continue;
        }
        let Some(mimic) = &joints[start].mimic else {
            continue;
        };
        let members = std::iter::once(start).chain(circle.iter().copied());
        let names = quote_first_eight_words(members.map(|k| joints[k].name.text.as_str()));
        let message = match circle.len() {
            0 => format!("joint {names} follows itself"),
            _ => format!("joints {names} follow one another"),
        };
        cx.report_error(&mimic.joint.place, message, |d| d.add_help(MOVE_ALONE));
    }
}

/// Follows the chain of leaders to its end and composes the relations: `q = factor × q_leader + offset`.
fn compose_leader_relations(
    start: usize,
    joints: &[FileJoint],
    leaders: &[Option<usize>],
    locked: &[bool],
    cx: &mut Cx<'_>,
) -> JointMotion {
    let (mut at, mut factor, mut offset) = (start, 1.0, 0.0);
    while let (Some(leader), Some(mimic)) = (leaders[at], &joints[at].mimic) {
        (factor, offset) = (factor * mimic.multiplier, factor * mimic.offset + offset);
        at = leader;
    }
    let Some(mimic) = joints[start].mimic.as_ref().filter(|_| at != start) else {
        return JointMotion::Own;
    };
    if !f64::is_finite(factor) || !f64::is_finite(offset) {
        let message = format!(
            "joint {} follows with an infinite multiplier or offset",
            quote_word(&joints[start].name.text)
        );
        cx.report_error(&mimic.joint.place, message, |d| d);
    }
    if locked[at] || factor == 0.0 {
        return JointMotion::Frozen(offset + factor * joints[at].held.unwrap_or(0.0));
    }
    let joint = Name { text: joints[at].name.text.clone(), place: mimic.joint.place.clone() };
    JointMotion::Follows(MimicRelation { joint, multiplier: factor, offset })
}
