//! Generalized momentum and its rate (Hamilton's and the Euler–Poincaré equations), and the total momentum of
//! the mechanism.

use super::crba::{composite_inertias, momentum};
use super::energy::center_of_mass;
use super::frames::{Placement, spatial_components};
use super::inertances;
use super::rnea::link_wrenches;
use super::shared_motions::SharedPartialVelocities;
use crate::expr::{Expr, Vec3};
use crate::kinematics::{Joint, SpatialVector, twists};
use crate::mechanics::passive::passive_forces;
use crate::mechanism::{Model, Pose};

/// Returns the momentum of each link with all its descendants, about the link's origin in its axes.
fn composite_momenta<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    twists: &[SpatialVector<'g>],
) -> Vec<SpatialVector<'g>> {
    let own = model.links.iter().zip(twists).map(|(link, twist)| momentum(&link.inertia, twist)).collect();
    accumulate_wrenches(joints, own)
}

/// Sums wrenches of the links from the leaves to the roots of the tree.
fn accumulate_wrenches<'g>(
    joints: &[Joint<'g>],
    mut wrenches: Vec<SpatialVector<'g>>,
) -> Vec<SpatialVector<'g>> {
    for (k, joint) in joints.iter().enumerate().rev() {
        if let Some(parent) = joint.parent {
            wrenches[parent.0] = wrenches[parent.0].plus(&joint.wrench_to_parent(&wrenches[k]));
        }
    }
    wrenches
}

fn project_wrenches<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    wrenches: &[SpatialVector<'g>],
) -> Vec<Expr<'g>> {
    let mut out = vec![model.graph.zero(); model.nv()];
    let shared = SharedPartialVelocities::new(model, joints);
    for (_, (joint, wrench)) in
        joints.iter().zip(wrenches).enumerate().filter(|(k, _)| !shared.shares_partial_velocity(*k))
    {
        for dof in &joint.dofs {
            out[dof.index] += dof.subspace.dot(wrench) * model.graph.num(dof.ratio);
        }
    }
    shared.add_generalized_forces_of_wrenches(wrenches, &mut out);
    out
}

/// Returns the generalized momentum `p = M v`, without forming `M`.
pub fn generalized_momentum<'g>(model: &Model<'g>, joints: &[Joint<'g>], v: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let momenta = composite_momenta(model, joints, &twists(model, joints, v));
    let mut p = project_wrenches(model, joints, &momenta);
    inertances::add_inerter_momentum(model, &mut p);
    p
}

/// Returns `ṗ − τ`. For a joint with subspace `S`, constant in link axes, `p = Sᵀ F` with `F` the momentum of
/// the link and all its descendants. The components of `F` change due to the forces and due to the rotation
/// and motion of the link: `ṗ = τ + Sᵀ (gravity − V ×* F)`.
pub fn momentum_rate_without_inputs<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
) -> Vec<Expr<'g>> {
    let twists = twists(model, joints, v);
    let momenta = composite_momenta(model, joints, &twists);
    let weights = accumulate_wrenches(joints, link_weight_wrenches(model, joints));
    let wrenches: Vec<SpatialVector<'g>> = (0..joints.len())
        .map(|k| {
            let (t, f) = (&twists[k], &momenta[k]);
            SpatialVector {
                linear: weights[k].linear - t.angular.cross(f.linear),
                angular: weights[k].angular - (t.angular.cross(f.angular) + t.linear.cross(f.linear)),
            }
        })
        .collect();
    let mut rate = project_wrenches(model, joints, &wrenches);
    // Contribution of a subspace that is not constant: Ṡᵀ F.
    let shared = SharedPartialVelocities::shared_subspace_rates(model, joints);
    shared.add_generalized_forces_of_wrenches(&momenta, &mut rate);
    for (_, (joint, momentum)) in
        joints.iter().zip(&momenta).enumerate().filter(|(k, _)| !shared.shares_partial_velocity(*k))
    {
        for (dof, change) in joint.dofs.iter().zip(joint.drift.iter().flat_map(|d| &d.subspace_rates)) {
            rate[dof.index] += change.dot(momentum) * model.graph.num(dof.ratio);
        }
    }
    inertances::add_inerter_momentum_rate(model, &mut rate);
    for (rate, passive_forces) in rate.iter_mut().zip(passive_forces(model, true)) {
        *rate -= passive_forces;
    }
    rate
}

/// Returns the weight of each link as a wrench about the link's origin in its axes.
fn link_weight_wrenches<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<SpatialVector<'g>> {
    let mut gravity: Vec<Vec3<'g>> = Vec::new();
    for joint in joints {
        let parent = joint.parent.map_or(model.gravity, |p| gravity[p.0]);
        gravity.push(joint.rotation.vector_in_child_axes(parent));
    }
    model
        .links
        .iter()
        .zip(gravity)
        .map(|(link, g)| SpatialVector {
            linear: g * link.inertia.mass,
            angular: link.inertia.moment.cross(g),
        })
        .collect()
}

/// Returns the total momentum in ground axes: linear, and angular about the centre of mass.
pub fn centroidal_momentum<'g>(model: &Model<'g>, joints: &[Joint<'g>], v: &[Expr<'g>]) -> SpatialVector<'g> {
    root_sum_about_center_of_mass(model, joints, &composite_momenta(model, joints, &twists(model, joints, v)))
}

/// Returns the sum of the roots' accumulated wrenches or momenta, in ground axes about the centre of mass.
fn root_sum_about_center_of_mass<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    sums: &[SpatialVector<'g>],
) -> SpatialVector<'g> {
    let mut sum = SpatialVector::zero(model);
    for (joint, wrench) in joints.iter().zip(sums).filter(|(joint, _)| joint.parent.is_none()) {
        sum = sum.plus(&joint.wrench_to_parent(wrench));
    }
    let center = center_of_mass(model, joints);
    SpatialVector { linear: sum.linear, angular: sum.angular - center.cross(sum.linear) }
}

/// Returns the matrix `A` of the total momentum `A v`, column by column. A column is the momentum of the
/// descendants of a degree of freedom at unit velocity of that degree of freedom (Orin, Goswami and Lee
/// 2013).
pub fn centroidal_momentum_matrix<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let g = model.graph;
    let composites = composite_inertias(model, joints);
    let center = center_of_mass(model, joints);
    let mut places: Vec<Placement<'g>> = Vec::with_capacity(joints.len());
    let mut columns = vec![SpatialVector::zero(model); model.nv()];
    for (joint, composite) in joints.iter().zip(&composites) {
        let parent = joint.parent.map_or(Placement::ground_placement(g), |p| places[p.0]);
        let place =
            parent.compose_with(&Pose { rotation: joint.rotation.clone(), translation: joint.translation });
        for dof in &joint.dofs {
            let own = momentum(composite, &dof.subspace.times_scalar(g.num(dof.ratio)));
            let linear = place.rotation * own.linear;
            let angular = place.rotation * own.angular + (place.position - center).cross(linear);
            columns[dof.index] = columns[dof.index].plus(&SpatialVector { linear, angular });
        }
        places.push(place);
    }
    columns.iter().flat_map(spatial_components).collect()
}

/// Returns the rate of the total momentum at zero accelerations, without gravity.
pub fn centroidal_bias<'g>(model: &Model<'g>, joints: &[Joint<'g>], v: &[Expr<'g>]) -> SpatialVector<'g> {
    let weightless = Model { gravity: Vec3::zero(model.graph), ..model.clone() };
    let wrenches = link_wrenches(&weightless, joints, v, None);
    root_sum_about_center_of_mass(model, joints, &accumulate_wrenches(joints, wrenches))
}
