//! Mass matrix by the composite-rigid-body algorithm (Walker and Orin 1982; Featherstone 2008, ch. 6).

use super::inertances;
use super::shared_motions::SharedPartialVelocities;
use crate::expr::{Expr, Vec3};
use crate::kinematics::{Dof, Joint, SpatialVector, map_spatial};
use crate::mechanism::{Inertia, Model};
use crate::vectorise::{LaneGroup, PathsToRoot, RootPropagationVisitor};

/// Square matrix of expressions, stored by rows.
pub type Matrix<'g> = Vec<Vec<Expr<'g>>>;

/// Returns the mass matrix `M(q)`, both triangles.
pub fn mass_matrix<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Matrix<'g> {
    mass_matrix_in_lanes(model, joints, 1)
}

/// Returns the mass matrix `M(q)`, both triangles, with up to `most` columns computed in the SIMD lanes of
/// one expression.
pub fn mass_matrix_in_lanes<'g>(model: &Model<'g>, joints: &[Joint<'g>], most: usize) -> Matrix<'g> {
    let paths = PathsToRoot::new(joints, most);
    let dofs =
        joints.iter().enumerate().flat_map(|(k, joint)| (0..joint.dofs.len()).map(move |row| (k, row)));
    let matrix = vec![vec![model.graph.zero(); model.nv()]; model.nv()];
    let (composites, shared) =
        (composite_inertias(model, joints), SharedPartialVelocities::new(model, joints));
    let mut columns = MassMatrixVisitor { joints, dofs: dofs.collect(), composites, shared, matrix };
    paths.propagate_to_root(&mut columns);
    let MassMatrixVisitor { composites, shared, matrix: mut m, .. } = columns;
    shared.add_mass_matrix_entries(&composites, &mut m);
    inertances::add_inertances_to_mass_matrix(model, &mut m);
    m
}

/// Visitor that adds the entries of the mass matrix: of each degree of freedom with itself, with the earlier
/// degrees of freedom of its joint, and with those of all ancestors.
struct MassMatrixVisitor<'a, 'g> {
    joints: &'a [Joint<'g>],
    /// Joint, and index of the degree of freedom in the joint.
    dofs: Vec<(usize, usize)>,
    composites: Vec<Inertia<'g>>,
    shared: SharedPartialVelocities<'g>,
    matrix: Matrix<'g>,
}

impl<'g> MassMatrixVisitor<'_, 'g> {
    fn add_symmetric_entries(&mut self, own: &Dof<'g>, other: &Dof<'g>, entry: Expr<'g>) {
        let entry = entry * entry.num(own.ratio * other.ratio);
        self.matrix[own.index][other.index] += entry;
        if !std::ptr::eq(own, other) {
            self.matrix[other.index][own.index] += entry;
        }
    }
}

impl<'g> RootPropagationVisitor<'g> for MassMatrixVisitor<'_, 'g> {
    type Propagated = SpatialVector<'g>;

    fn initial_quantity_of_dof(&mut self, dof: usize) -> SpatialVector<'g> {
        let ((link, row), joints) = (self.dofs[dof], self.joints);
        let own = &joints[link].dofs[row];
        if self.shared.shares_partial_velocity(link) {
            // A link in `SharedPartialVelocities` is placed on the ground, so no ancestor has entries with
            // it. `SharedPartialVelocities` adds its own entries.
            return own.subspace;
        }
        let wrench = momentum(&self.composites[link], &own.subspace);
        for other in &joints[link].dofs[..=row] {
            self.add_symmetric_entries(own, other, other.subspace.dot(&wrench));
        }
        wrench
    }

    fn process_transformed_group(&mut self, group: &LaneGroup<SpatialVector<'g>>) {
        let joints = self.joints;
        for other in &joints[group.link].dofs {
            let subspace = map_spatial(&other.subspace, |c| group.repeat_for_group_members(c));
            for (dof, entry) in group.lanes_of_members(subspace.dot(&group.item)) {
                let (link, row) = self.dofs[dof];
                self.add_symmetric_entries(&joints[link].dofs[row], other, entry);
            }
        }
    }
}

/// Returns the composite mass properties of each link: those of the link with all its descendants.
pub fn composite_inertias<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Vec<Inertia<'g>> {
    let mut sums: Vec<Inertia<'g>> = model.links.iter().map(|l| l.inertia).collect();
    for (k, joint) in joints.iter().enumerate().rev() {
        if let Some(parent) = joint.parent {
            sums[parent.0] = joint.add_inertia_to_parent(&sums[parent.0], &sums[k]);
        }
    }
    sums
}

/// Returns the momentum (linear, and angular about the link's origin) of a body with a given twist.
pub fn momentum<'g>(inertia: &Inertia<'g>, twist: &SpatialVector<'g>) -> SpatialVector<'g> {
    let h: Vec3<'g> = inertia.moment;
    SpatialVector {
        linear: twist.linear * inertia.mass + twist.angular.cross(h),
        angular: inertia.tensor * twist.angular + h.cross(twist.linear),
    }
}
