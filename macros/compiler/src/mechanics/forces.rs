//! Generalized forces of the inputs by virtual work, `τ = Σ Sᵀ W`, summed over the link on which the wrench
//! acts and all ancestors of this link.

use crate::expr::replace::substitute_symbols;
use crate::expr::{Expr, Vec3};
use crate::kinematics::{Joint, SpatialVector, cached_velocity_gradient, express_in_link_axes, symbols_in};
use crate::mechanism::{InputEffect, LinkId, Model, Quantity, SumOfLinkVectors};

/// Returns the generalized forces of the inputs, `τ(q, u)`.
pub fn generalized_forces_of_inputs<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let g = model.graph;
    let mut tau = vec![g.zero(); model.nv()];
    let mut wrenches = vec![SpatialVector::zero(model); joints.len()];
    for (k, (_, input)) in model.inputs.iter().enumerate() {
        let u = Quantity::Input(k).expr(g);
        match input {
            InputEffect::Named => {}
            InputEffect::Coordinate(c) => tau[c.v.0] += u * g.num(c.ratio),
            InputEffect::Sum(terms, _) => {
                for c in terms {
                    tau[c.v.0] += u * g.num(c.ratio);
                }
            }
            InputEffect::Force { link, point, along } => {
                let force = direction_in_link(joints, along, *link, Vec3::zero(g)) * u;
                let wrench = SpatialVector { linear: force, angular: point.cross(force) };
                wrenches[link.0] = wrenches[link.0].plus(&wrench);
            }
            InputEffect::Torque { link, about } => {
                let moment = direction_in_link(joints, about, *link, Vec3::zero(g)) * u;
                wrenches[link.0].angular += moment;
            }
        }
    }
    let is_input = |s| matches!(Quantity::from_symbol(s), Quantity::Input(_));
    // The difference below may be a nonzero expression even for a force that contains no input.
    for load in model.loads.iter().filter(|load| symbols_in(&[load.force]).into_iter().any(is_input)) {
        // The force at zero inputs belongs to the bias.
        let alone = substitute_symbols(load.force, &|s| is_input(s).then(|| g.zero()));
        let by_inputs = load.force - alone;
        if !by_inputs.is_zero() {
            for (k, d) in cached_velocity_gradient(model, load.rate) {
                tau[k] += by_inputs * d;
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

/// Returns a direction in the axes of a link, transformed through the axes of the nearest common ancestor.
fn direction_in_link<'g>(
    joints: &[Joint<'g>],
    direction: &SumOfLinkVectors<'g>,
    link: LinkId,
    zero: Vec3<'g>,
) -> Vec3<'g> {
    direction.iter().fold(zero, |sum, (from, v)| sum + express_in_link_axes(joints, *v, *from, Some(link)))
}
