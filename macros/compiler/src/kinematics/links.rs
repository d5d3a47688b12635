//! Velocities and accelerations of all links, and transformation of vectors between the axes of links.

use super::joint::Joint;
use super::spatial::SpatialVector;
use crate::expr::{Expr, Vec3};
use crate::mechanism::{LinkId, Model};

/// Returns the twists of all links (velocity of the origin, angular velocity; link axes) for the velocities
/// `v`.
pub fn twists<'g>(model: &Model<'g>, joints: &[Joint<'g>], v: &[Expr<'g>]) -> Vec<SpatialVector<'g>> {
    let mut twists: Vec<SpatialVector<'g>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let own = joint.twist_with_prescribed_motion(model, v);
        twists.push(match joint.parent {
            None => own,
            Some(p) => joint.twist_to_child(&twists[p.0]).plus(&own),
        });
    }
    twists
}

/// Returns the accelerations of all links (of the origin, angular; relative to the ground; link axes) for the
/// velocities `v` and the accelerations `a`.
pub fn accelerations<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    twists: &[SpatialVector<'g>],
    v: &[Expr<'g>],
    a: &[Expr<'g>],
) -> Vec<SpatialVector<'g>> {
    let mut all: Vec<SpatialVector<'g>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let parent = joint.parent.map(|p| (twists[p.0], all[p.0]));
        all.push(joint.link_acceleration(model, parent.as_ref().map(|(t, a)| (t, a)), v, a));
    }
    all
}

/// Returns the components in the axes of `to` of a vector given in the axes of `from`.
pub fn express_in_link_axes<'g>(
    joints: &[Joint<'g>],
    mut v: Vec3<'g>,
    mut from: Option<LinkId>,
    to: Option<LinkId>,
) -> Vec3<'g> {
    // Parents have smaller indices, so the deeper of two links is the one with the larger index.
    let mut down: Vec<LinkId> = Vec::new();
    let mut at = to;
    while from != at {
        match (from, at) {
            (Some(f), a) if a.is_none_or(|a| f > a) => {
                v = joints[f.0].rotation.vector_in_parent_axes(v);
                from = joints[f.0].parent;
            }
            (_, Some(a)) => {
                down.push(a);
                at = joints[a.0].parent;
            }
            _ => break,
        }
    }
    down.iter().rev().fold(v, |v, link| joints[link.0].rotation.vector_in_child_axes(v))
}
