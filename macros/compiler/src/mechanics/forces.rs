//! Generalized forces of the inputs: by virtual work, `τ = Σ Sᵀ W` over the links that a wrench's link hangs from.

use super::Spatial;
use super::kinematics::Joint;
use crate::expr::{Expr, Vec3};
use crate::model::{Direction, Input, LinkId, Model, Quantity};

/// What the inputs `u` contribute to `τ`.
pub fn generalized_forces<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let g = model.graph;
    let mut tau = vec![g.zero(); model.nv()];
    let mut wrenches = vec![Spatial::zero(model); joints.len()];
    for (k, (_, input)) in model.inputs.iter().enumerate() {
        let u = Quantity::Input(k).expr(g);
        match input {
            Input::Coordinate(c) => tau[c.v] += u * g.num(c.ratio),
            Input::Force { link, point, along } => {
                let force = resolve(joints, along, *link, Vec3::zero(g)) * u;
                let wrench = Spatial { linear: force, angular: point.cross(force) };
                wrenches[link.0] = wrenches[link.0].plus(&wrench);
            }
            Input::Torque { link, about } => {
                let moment = resolve(joints, about, *link, Vec3::zero(g)) * u;
                wrenches[link.0].angular += moment;
            }
        }
    }
    for (k, joint) in joints.iter().enumerate().rev() {
        let wrench = wrenches[k];
        for dof in &joint.dofs {
            tau[dof.index] += dof.subspace.dot(&wrench) * g.num(dof.ratio);
        }
        if let Some(parent) = joint.parent {
            wrenches[parent.0] = wrenches[parent.0].plus(&joint.wrench_to_parent(&wrench));
        }
    }
    tau
}

/// A direction in the axes of a link, by way of the nearest common ancestor's.
fn resolve<'g>(joints: &[Joint<'g>], direction: &Direction<'g>, link: LinkId, zero: Vec3<'g>) -> Vec3<'g> {
    direction.iter().fold(zero, |sum, (from, v)| sum + change_axes(joints, *v, *from, Some(link)))
}

/// Components in the axes of `to` of a vector given in the axes of `from`.
pub fn change_axes<'g>(
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
                v = joints[f.0].rotation.to_parent(v);
                from = joints[f.0].parent;
            }
            (_, Some(a)) => {
                down.push(a);
                at = joints[a.0].parent;
            }
            _ => break,
        }
    }
    down.iter().rev().fold(v, |v, link| joints[link.0].rotation.to_child(v))
}
