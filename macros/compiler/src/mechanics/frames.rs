//! Placements and motions of links and named frames, each link from its parent. Generated code calls one step
//! after another along the path to a frame, so only the links of this path are computed.
//!
//! The parent's values are arguments: placements as nine entries of the rotation by rows and three of the
//! position, twists and accelerations as linear and angular component in link axes.

use crate::expr::{Expr, Graph, Mat3, Vec3};
use crate::kinematics::{Joint, SpatialVector};
use crate::mechanism::{Model, NamedFrame, Pose, Quantity, SuppliedQuantity};

/// Placement of a frame in the ground: rotation matrix and position.
#[derive(Clone, Copy)]
pub struct Placement<'g> {
    /// Rotation matrix whose columns are the frame's axes in ground axes.
    pub rotation: Mat3<'g>,
    /// Position of the frame's origin in ground axes.
    pub position: Vec3<'g>,
}

impl<'g> Placement<'g> {
    /// Returns twelve numbers: the rotation by rows, then the position.
    pub fn rotation_and_position(&self) -> Vec<Expr<'g>> {
        self.rotation.0.iter().flatten().chain(&self.position.0).copied().collect()
    }

    /// Returns the placement of the ground frame: zero position and identity rotation.
    pub fn ground_placement(graph: &'g Graph) -> Placement<'g> {
        Placement { rotation: Mat3::identity(graph), position: Vec3::zero(graph) }
    }

    /// Returns the placement of a frame that has the pose `pose` in this frame.
    pub fn compose_with(&self, pose: &Pose<'g>) -> Placement<'g> {
        // R_parent R: rows are rotated, so that the steps of the child's rotation apply to them one by one.
        let rows: [Vec3<'g>; 3] =
            std::array::from_fn(|i| pose.rotation.vector_in_child_axes(self.rotation.row(i)));
        Placement {
            rotation: Mat3(rows.map(|r| r.0)),
            position: self.position + self.rotation * pose.translation,
        }
    }
}

/// Returns three entries of a function argument as a vector.
fn vector_argument<'g>(model: &Model<'g>, block: SuppliedQuantity, first: usize) -> Vec3<'g> {
    Vec3(std::array::from_fn(|k| Quantity::Given(block, first + k).expr(model.graph)))
}

/// Returns the placement of the parent, which is the first part of its motion in the arguments.
fn parent_placement_argument<'g>(model: &Model<'g>) -> Placement<'g> {
    let [a, b, c, position] =
        [0, 3, 6, 9].map(|first| vector_argument(model, SuppliedQuantity::Parent, first));
    Placement { rotation: Mat3([a.0, b.0, c.0]), position }
}

/// Returns six entries of the motion of the parent as a spatial vector.
fn spatial_argument<'g>(model: &Model<'g>, first: usize) -> SpatialVector<'g> {
    let [linear, angular] =
        [first, first + 3].map(|first| vector_argument(model, SuppliedQuantity::Parent, first));
    SpatialVector { linear, angular }
}

/// Returns the six components of a spatial vector.
pub fn spatial_components<'g>(s: &SpatialVector<'g>) -> Vec<Expr<'g>> {
    s.linear.0.iter().chain(&s.angular.0).copied().collect()
}

/// Returns the placement of a link from its parent's (12 arguments, none for a root).
pub fn link_placement<'g>(model: &Model<'g>, joint: &Joint<'g>) -> Placement<'g> {
    let parent = if joint.parent.is_some() {
        parent_placement_argument(model)
    } else {
        Placement::ground_placement(model.graph)
    };
    parent.compose_with(&Pose { rotation: joint.rotation.clone(), translation: joint.translation })
}

/// Returns the placement of a named frame from its link's (12 arguments, none if it is fixed to the ground).
pub fn frame_placement<'g>(model: &Model<'g>, frame: &NamedFrame<'g>) -> Placement<'g> {
    let link = if frame.link.is_some() {
        parent_placement_argument(model)
    } else {
        Placement::ground_placement(model.graph)
    };
    link.compose_with(&frame.pose)
}

/// Returns the twist of a link from its parent's (6 arguments, none for a root).
pub fn link_twist<'g>(model: &Model<'g>, joint: &Joint<'g>, v: &[Expr<'g>]) -> SpatialVector<'g> {
    let own = joint.twist_with_prescribed_motion(model, v);
    match joint.parent {
        None => own,
        Some(_) => joint.twist_to_child(&spatial_argument(model, 0)).plus(&own),
    }
}

/// Returns the acceleration of a link (of its origin, angular; classical, without gravity; link axes) from
/// its parent's twist and acceleration (12 arguments, none for a root).
pub fn link_acceleration<'g>(
    model: &Model<'g>,
    joint: &Joint<'g>,
    v: &[Expr<'g>],
    a: &[Expr<'g>],
) -> SpatialVector<'g> {
    let (twist, parent) = (spatial_argument(model, 0), spatial_argument(model, 6));
    joint.link_acceleration(model, joint.parent.map(|_| (&twist, &parent)), v, a)
}

/// Returns the twist of a named frame in ground axes, from its link's placement and twist (18 arguments).
pub fn frame_twist<'g>(model: &Model<'g>, frame: &NamedFrame<'g>) -> SpatialVector<'g> {
    if frame.link.is_none() {
        return SpatialVector::zero(model);
    }
    let (placement, twist) = (parent_placement_argument(model), spatial_argument(model, 12));
    let p = frame.pose.translation;
    SpatialVector {
        linear: placement.rotation * (twist.linear + twist.angular.cross(p)),
        angular: placement.rotation * twist.angular,
    }
}

/// Returns the acceleration of a named frame in ground axes, from its link's placement, twist and
/// acceleration (24 arguments).
pub fn frame_acceleration<'g>(model: &Model<'g>, frame: &NamedFrame<'g>) -> SpatialVector<'g> {
    if frame.link.is_none() {
        return SpatialVector::zero(model);
    }
    let placement = parent_placement_argument(model);
    let (twist, acceleration) = (spatial_argument(model, 12), spatial_argument(model, 18));
    let (p, w) = (frame.pose.translation, twist.angular);
    let point = acceleration.linear + acceleration.angular.cross(p) + w.cross(w.cross(p));
    SpatialVector { linear: placement.rotation * point, angular: placement.rotation * acceleration.angular }
}

/// Returns the columns of a frame's Jacobian for the degrees of freedom of one link: the twist of the frame
/// per unit of velocity, in ground axes, from the link's placement and the frame's position (15 arguments).
pub fn frame_jacobian_columns<'g>(model: &Model<'g>, joint: &Joint<'g>) -> Vec<SpatialVector<'g>> {
    let placement = parent_placement_argument(model);
    let arm = vector_argument(model, SuppliedQuantity::Origin, 0) - placement.position;
    joint
        .dofs
        .iter()
        .map(|dof| {
            let s = dof.subspace.times_scalar(model.graph.num(dof.ratio));
            let angular = placement.rotation * s.angular;
            SpatialVector { linear: placement.rotation * s.linear + angular.cross(arm), angular }
        })
        .collect()
}
