//! Mass matrix by the composite-rigid-body algorithm (Walker and Orin 1982; Featherstone 2008, ch. 6).

use super::kinematics::Joint;
use super::{Spatial, inertances};
use crate::expr::{Expr, Vec3};
use crate::model::{Inertia, Model};

/// A square matrix of expressions by rows.
pub type Matrix<'g> = Vec<Vec<Expr<'g>>>;

/// `M(q)`, both triangles.
pub fn mass_matrix<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Matrix<'g> {
    let g = model.graph;
    let composites = composites(model, joints);
    let mut m = vec![vec![g.zero(); model.nv()]; model.nv()];
    for (k, joint) in joints.iter().enumerate() {
        for (row, dof) in joint.dofs.iter().enumerate() {
            let wrench = momentum(&composites[k], &dof.subspace);
            add_column(model, joints, k, row, wrench, &mut m);
        }
    }
    inertances::add_to_mass_matrix(model, &mut m);
    m
}

/// The entries of one degree of freedom with itself, the earlier ones of its joint, and all of its ancestors.
fn add_column<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    link: usize,
    row: usize,
    mut wrench: Spatial<'g>,
    m: &mut Matrix<'g>,
) {
    let own = &joints[link].dofs[row];
    let mut at = link;
    loop {
        let dofs = if at == link { &joints[at].dofs[..=row] } else { &joints[at].dofs[..] };
        for (k, other) in dofs.iter().enumerate() {
            let entry = other.subspace.dot(&wrench) * model.graph.num(own.ratio * other.ratio);
            m[own.index][other.index] += entry;
            if !(at == link && k == row) {
                m[other.index][own.index] += entry;
            }
        }
        let Some(parent) = joints[at].parent else { return };
        wrench = joints[at].wrench_to_parent(&wrench);
        at = parent.0;
    }
}

/// Mass properties of each link with everything that it carries.
pub fn composites<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Inertia<'g>> {
    let mut sums: Vec<Inertia<'g>> = model.links.iter().map(|l| l.inertia).collect();
    for (k, joint) in joints.iter().enumerate().rev() {
        if let Some(parent) = joint.parent {
            sums[parent.0] = joint.lump(&sums[parent.0], &sums[k]);
        }
    }
    sums
}

/// Momentum (linear, and angular about the link's origin) of a body with a given twist.
pub fn momentum<'g>(inertia: &Inertia<'g>, twist: &Spatial<'g>) -> Spatial<'g> {
    let h: Vec3<'g> = inertia.moment;
    Spatial {
        linear: twist.linear * inertia.mass + twist.angular.cross(h),
        angular: inertia.tensor * twist.angular + h.cross(twist.linear),
    }
}
