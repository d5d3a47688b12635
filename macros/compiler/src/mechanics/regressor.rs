//! Inverse dynamics as a linear function of the mass properties: `τ = Y π`, with ten parameters for each
//! frame in which mass properties are declared (Atkeson, An and Hollerbach 1986). Springs, friction and other
//! elements are excluded.

use super::rnea::{link_motions, newton_euler_wrench};
use crate::expr::{Expr, Sym3, Vec3};
use crate::kinematics::{Joint, SpatialVector};
use crate::mechanism::{Inertia, LinkId, Model, Pose};

/// Number of inertial parameters of a rigid body.
pub const COUNT: usize = 10;

/// Names of the inertial parameters: mass, first moment `m c`, inertia about the frame's origin, in
/// Pinocchio's order.
pub const NAMES: [&str; COUNT] = ["m", "mx", "my", "mz", "xx", "xy", "yy", "xz", "yz", "zz"];

/// Row and column in the tensor of inertia of each parameter after the fourth.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];

/// Frame fixed in a link, whose inertial parameters are identified.
#[derive(Clone)]
pub struct RegressorFrame<'g> {
    /// Link in which the parameter frame is fixed.
    pub link: LinkId,
    /// Pose of the parameter frame relative to the link's frame.
    pub pose: Pose<'g>,
}

/// Returns the ten inertial parameters of mass properties.
pub fn inertial_parameters<'g>(inertia: &Inertia<'g>) -> [Expr<'g>; COUNT] {
    std::array::from_fn(|k| match k {
        0 => inertia.mass,
        1..4 => inertia.moment[k - 1],
        _ => inertia.tensor.entry(ENTRIES[k - 4].0, ENTRIES[k - 4].1),
    })
}

/// Returns the mass properties with the given ten parameters.
pub fn inertia_from_parameters<'g>(parameters: [Expr<'g>; COUNT]) -> Inertia<'g> {
    let [mass, x, y, z, xx, xy, yy, xz, yz, zz] = parameters;
    let tensor = Sym3 { diagonal: [xx, yy, zz], off: [xy, xz, yz] };
    Inertia { mass, moment: Vec3([x, y, z]), tensor }
}

/// Returns the columns of `Y` for the inertial parameters of frames: the generalized forces per unit of each
/// parameter. `wanted` are pairs of a frame's index and a parameter's index.
pub fn regressor_columns<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: &[Expr<'g>],
    sites: &[RegressorFrame<'g>],
    wanted: &[(usize, usize)],
) -> Vec<Vec<Expr<'g>>> {
    let g = model.graph;
    let states = link_motions(model, joints, v, Some(a));
    let subspaces = partial_twists_of_links(model, joints);
    let mut columns = Vec::with_capacity(wanted.len());
    let mut at: Option<(usize, Vec<(usize, SpatialVector<'g>)>)> = None;
    for &(index, parameter) in wanted {
        let site = &sites[index];
        let state = states[site.link.0].motion_of_fixed_frame(&site.pose);
        let mut unit = [g.zero(); COUNT];
        unit[parameter] = g.one();
        let wrench = newton_euler_wrench(&inertia_from_parameters(unit), &state);
        let seen = match at.take().filter(|(known, _)| *known == index) {
            Some((_, seen)) => seen,
            None => subspaces[site.link.0].iter().map(|(k, s)| (*k, twist_in_frame(&site.pose, s))).collect(),
        };
        let mut column = vec![g.zero(); model.nv()];
        for (k, subspace) in &seen {
            column[*k] += subspace.dot(&wrench);
        }
        columns.push(column);
        at = Some((index, seen));
    }
    columns
}

/// Returns for each link its twist per unit of each velocity, in the link's axes.
fn partial_twists_of_links<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
) -> Vec<Vec<(usize, SpatialVector<'g>)>> {
    let mut all: Vec<Vec<(usize, SpatialVector<'g>)>> = Vec::with_capacity(joints.len());
    for joint in joints {
        let carried = joint.parent.map_or(&[][..], |p| &all[p.0]);
        let mut own: Vec<_> = carried.iter().map(|(k, s)| (*k, joint.twist_to_child(s))).collect();
        own.extend(joint.dofs.iter().map(|d| (d.index, d.subspace.times_scalar(model.graph.num(d.ratio)))));
        all.push(own);
    }
    all
}

/// Transforms a twist of a link to a frame that is fixed in the link.
fn twist_in_frame<'g>(pose: &Pose<'g>, twist: &SpatialVector<'g>) -> SpatialVector<'g> {
    SpatialVector {
        linear: pose.rotation.vector_in_child_axes(twist.linear + twist.angular.cross(pose.translation)),
        angular: pose.rotation.vector_in_child_axes(twist.angular),
    }
}
