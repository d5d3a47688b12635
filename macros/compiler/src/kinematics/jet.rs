//! Jets: values with their first time derivatives, and their second time derivatives at zero accelerations.
//! Motions are taken relative to the nearest common ancestor of both links, so that the common motion
//! cancels.

use super::joint::Joint;
use super::links::express_in_link_axes;
use super::spatial::SpatialVector;
use crate::expr::{Expr, Vec3};
use crate::mechanism::{LinkId, Model, Quantity};

/// A scalar with its first time derivative, and its second time derivative at zero accelerations.
pub struct Jet<'g> {
    /// Value of the scalar.
    pub value: Expr<'g>,
    /// First time derivative of the moving scalar.
    pub rate: Expr<'g>,
    /// Second time derivative of the scalar at zero accelerations.
    pub second: Expr<'g>,
}

/// A vector with its first time derivative, and its second time derivative at zero accelerations, in the axes
/// of a link that is treated as fixed.
#[derive(Clone, Copy)]
pub struct MovingVector<'g> {
    /// Value of the vector, in the axes of one link.
    pub value: Vec3<'g>,
    /// First time derivative of the moving vector.
    pub rate: Vec3<'g>,
    /// Second time derivative of the vector at zero accelerations.
    pub second: Vec3<'g>,
}

impl<'g> MovingVector<'g> {
    /// Returns the difference of two moving vectors.
    pub fn minus(&self, b: &MovingVector<'g>) -> MovingVector<'g> {
        MovingVector { value: self.value - b.value, rate: self.rate - b.rate, second: self.second - b.second }
    }

    /// Returns the inner product of two moving vectors.
    pub fn dot(&self, b: &MovingVector<'g>) -> Jet<'g> {
        let twice = self.rate.dot(b.rate) * 2.0;
        Jet {
            value: self.value.dot(b.value),
            rate: self.rate.dot(b.value) + self.value.dot(b.rate),
            second: self.second.dot(b.value) + twice + self.value.dot(b.second),
        }
    }

    /// Returns component `k` of the moving vector.
    pub fn component(&self, k: usize) -> Jet<'g> {
        Jet { value: self.value[k], rate: self.rate[k], second: self.second[k] }
    }
}

/// Motion of a link relative to one of its ancestors, in the link's axes.
pub struct RelativeLinkMotion<'g> {
    /// Link whose relative motion is described; `None` for the ground.
    pub link: Option<LinkId>,
    /// Ancestor that the motion is relative to; `None` for the ground.
    pub ancestor: Option<LinkId>,
    /// Relative velocity of the link's origin, and relative angular velocity.
    pub twist: SpatialVector<'g>,
    /// Acceleration of the origin, angular acceleration, at zero accelerations of the coordinates.
    pub acceleration: SpatialVector<'g>,
}

/// Returns the motion of a link relative to the nearest common ancestor of this link and another.
pub fn relative_motion<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    link: Option<LinkId>,
    other: Option<LinkId>,
) -> RelativeLinkMotion<'g> {
    let parent_of_link = |l: LinkId| joints[l.0].parent;
    let (mut a, mut b) = (link, other);
    let mut path = Vec::new();
    // Parents have smaller indices, so the deeper of two links is the one with the larger index.
    while a != b {
        if a > b {
            path.extend(a);
            a = a.and_then(parent_of_link);
        } else {
            b = b.and_then(parent_of_link);
        }
    }
    let g = model.graph;
    let v: Vec<Expr<'g>> = (0..model.nv()).map(|k| Quantity::Velocity(k).expr(g)).collect();
    let still = vec![g.zero(); model.nv()];
    let zero = SpatialVector::zero(model);
    let mut motion: Option<(SpatialVector<'g>, SpatialVector<'g>)> = None;
    for l in path.iter().rev() {
        let joint = &joints[l.0];
        let own = joint.twist_with_prescribed_motion(model, &v);
        let twist = motion.as_ref().map_or(own, |(twist, _)| joint.twist_to_child(twist).plus(&own));
        let before = motion.as_ref().map(|(twist, acceleration)| (twist, acceleration));
        let acceleration = joint.link_acceleration(model, before, &v, &still);
        motion = Some((twist, acceleration));
    }
    let (twist, acceleration) = motion.unwrap_or((zero, zero));
    RelativeLinkMotion { link, ancestor: a, twist, acceleration }
}

/// Returns the motion of a point of a link, in the axes of the ancestor.
pub fn motion_of_point<'g>(
    joints: &[Joint<'g>],
    on: &RelativeLinkMotion<'g>,
    p: Vec3<'g>,
) -> MovingVector<'g> {
    let mut value = p;
    let mut at = on.link;
    while at != on.ancestor {
        let Some(l) = at else { break };
        let joint = &joints[l.0];
        value = joint.translation + joint.rotation.vector_in_parent_axes(value);
        at = joint.parent;
    }
    let (w, a) = (on.twist.angular, &on.acceleration);
    let rate = on.twist.linear + w.cross(p);
    let second = a.linear + a.angular.cross(p) + w.cross(w.cross(p));
    let vector_in_ancestor = |v| express_in_link_axes(joints, v, on.link, on.ancestor);
    MovingVector { value, rate: vector_in_ancestor(rate), second: vector_in_ancestor(second) }
}

/// Returns the motion of a direction fixed in a link, in the axes of the ancestor.
pub fn motion_of_direction<'g>(
    joints: &[Joint<'g>],
    on: &RelativeLinkMotion<'g>,
    e: Vec3<'g>,
) -> MovingVector<'g> {
    let w = on.twist.angular;
    let second = on.acceleration.angular.cross(e) + w.cross(w.cross(e));
    let vector_in_ancestor = |v| direction_in_ancestor(joints, on, v);
    MovingVector {
        value: vector_in_ancestor(e),
        rate: vector_in_ancestor(w.cross(e)),
        second: vector_in_ancestor(second),
    }
}

/// Returns the components of a vector, given in a link's axes, in the axes of the ancestor.
pub fn direction_in_ancestor<'g>(joints: &[Joint<'g>], on: &RelativeLinkMotion<'g>, v: Vec3<'g>) -> Vec3<'g> {
    express_in_link_axes(joints, v, on.link, on.ancestor)
}
