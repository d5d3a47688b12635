//! Locks and `mimic` tags → what moves each joint.

use super::joint::FileJoint;
use crate::import::context::{Cx, quote, quote_all};
use crate::syntax::{Mimic, Name};
use std::collections::BTreeMap;

/// What moves a joint.
pub(in crate::import) enum Motion {
    /// It moves on its own.
    Own,
    /// It follows a joint that moves on its own.
    Follows(Mimic),
    /// It stands still at this coordinate.
    Frozen(f64),
}

/// The coordinates of the joints that stand still.
pub(in crate::import) fn frozen(joints: &[Option<(FileJoint, Motion)>]) -> BTreeMap<&str, f64> {
    joints
        .iter()
        .flatten()
        .filter_map(|(joint, motion)| match motion {
            Motion::Frozen(at) => Some((joint.name.text.as_str(), *at)),
            _ => None,
        })
        .collect()
}

/// Finds out what moves each joint. Locks come first: what follows a locked joint stands still as well.
pub(in crate::import) fn resolve_motions(
    joints: &[FileJoint],
    locks: &[Name],
    cx: &mut Cx<'_>,
) -> Option<Vec<Motion>> {
    let index: BTreeMap<&str, usize> =
        joints.iter().enumerate().map(|(k, joint)| (joint.name.text.as_str(), k)).collect();
    let mut locked: Vec<bool> = joints.iter().map(|joint| joint.held.is_some()).collect();
    for lock in locks.iter().filter_map(|lock| index.get(lock.text.as_str())) {
        locked[*lock] = true;
    }
    let leaders: Vec<Option<usize>> = (0..joints.len())
        .map(|k| if locked[k] { None } else { find_leader(&joints[k], joints, &index, cx) })
        .collect();
    report_circles(joints, &leaders, cx);
    // The chains end only if there are no circles.
    if cx.failed() {
        return None;
    }
    let motions = (0..joints.len()).map(|k| match locked[k] {
        true => Motion::Frozen(joints[k].held.unwrap_or(0.0)),
        false => follow(k, joints, &leaders, &locked, cx),
    });
    Some(motions.collect())
}

/// The joint that `joint` follows, both being such as can.
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
            joints.iter().filter(|other| other.has_coordinate()).map(|other| other.name.text.as_str());
        let message = format!("unknown joint {}", quote(&mimic.joint.text));
        cx.error(place, message, |d| d.suggest(&mimic.joint.text, names).help(MOVE_ALONE));
        return None;
    };
    for (which, one) in [("follow", joint), ("be followed", &joints[leader])] {
        if !one.has_coordinate() {
            let name = quote(&one.name.text);
            let message = format!("joint {name} is `{}` and cannot {which}", one.word);
            cx.error(place, message, |d| d.help(MOVE_ALONE));
            return None;
        }
    }
    Some(leader)
}

const MOVE_ALONE: &str =
    "to let joints that follow move on their own, write `#[mechanism(…, mimic = independent)]`";

/// Reports joints that follow one another, each circle once.
fn report_circles(joints: &[FileJoint], leaders: &[Option<usize>], cx: &mut Cx<'_>) {
    for start in 0..joints.len() {
        let walk = std::iter::successors(leaders[start], |k| leaders[*k]);
        let circle: Vec<usize> = walk.take(joints.len()).take_while(|k| *k != start).collect();
        let back = circle.last().map_or(leaders[start], |last| leaders[*last]);
        // From outside the circle the walk never comes back; inside it, the first joint speaks for all.
        if back != Some(start) || circle.iter().any(|k| *k < start) {
            continue;
        }
        let Some(mimic) = &joints[start].mimic else {
            continue;
        };
        let members = std::iter::once(start).chain(circle.iter().copied());
        let names = quote_all(members.map(|k| joints[k].name.text.as_str()));
        let message = match circle.len() {
            0 => format!("joint {names} follows itself"),
            _ => format!("joints {names} follow one another"),
        };
        cx.error(&mimic.joint.place, message, |d| d.help(MOVE_ALONE));
    }
}

/// Follows the chain of leaders to its end: `q = factor × q_leader + offset`.
fn follow(
    start: usize,
    joints: &[FileJoint],
    leaders: &[Option<usize>],
    locked: &[bool],
    cx: &mut Cx<'_>,
) -> Motion {
    let (mut at, mut factor, mut offset) = (start, 1.0, 0.0);
    while let (Some(leader), Some(mimic)) = (leaders[at], &joints[at].mimic) {
        (factor, offset) = (factor * mimic.multiplier, factor * mimic.offset + offset);
        at = leader;
    }
    let Some(mimic) = joints[start].mimic.as_ref().filter(|_| at != start) else {
        return Motion::Own;
    };
    if !f64::is_finite(factor) || !f64::is_finite(offset) {
        let message = format!(
            "joint {} follows with an infinite multiplier or offset",
            quote(&joints[start].name.text)
        );
        cx.error(&mimic.joint.place, message, |d| d);
    }
    if locked[at] || factor == 0.0 {
        return Motion::Frozen(offset + factor * joints[at].held.unwrap_or(0.0));
    }
    let joint = Name { text: joints[at].name.text.clone(), place: mimic.joint.place.clone() };
    Motion::Follows(Mimic { joint, multiplier: factor, offset })
}
