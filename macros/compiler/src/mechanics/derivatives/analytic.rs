//! Derivatives of inverse dynamics by recursion (Singh, Russell and Wensing, *Efficient analytical
//! derivatives of rigid-body dynamics using spatial vector algebra*, 2022; linear components first here), and
//! the Coriolis matrix (Echeandia and Wensing, *Numerical methods to compute the Coriolis matrix and
//! Christoffel symbols*, 2021), in link axes.
//!
//! With the sums `I`, `F` and `B` (inertia, wrench, velocity map) over a link and its descendants, and the
//! columns `S`, `Ψ̇`, `Ψ̈` of a degree of freedom, for `j` on the link and `i` on the link itself or on one
//! of its ancestors:
//!
//! - `∂τᵢ/∂qⱼ = Sᵢ · (Sⱼ ×* F + I Ψ̈ⱼ + B Ψ̇ⱼ)`, without the first term if `i` is on the same link;
//! - `∂τⱼ/∂qᵢ = (I Sⱼ) · Ψ̈ᵢ + (Bᵀ Sⱼ) · Ψ̇ᵢ`;
//! - `∂τᵢ/∂vⱼ = Sᵢ · (B Sⱼ + I (Ψ̇ⱼ + Ṡⱼ))`;
//! - `∂τⱼ/∂vᵢ = (Bᵀ Sⱼ) · Sᵢ + (I Sⱼ) · (Ψ̇ᵢ + Ṡᵢ)`.

use super::super::crba::{Matrix, momentum};
use super::super::rnea;
use super::ForceDerivatives;
use super::columns::{DofMotionChanges, coriolis_columns, derivative_columns, link_motions};
use super::subtree::{SubtreeMassAndWrench, subtree_sums};
use crate::expr::{Expr, Vec3};
use crate::kinematics::{Joint, SpatialVector, time_derivative, twists, velocity_gradient};
use crate::mechanism::Model;
use crate::vectorise::{LaneGroup, PathsToRoot, PropagatedQuantity, RootPropagationVisitor};

/// Returns the derivatives of `M a + h` without springs, dashpots and other loads, in up to `most` lanes; one
/// lane gives scalar code.
pub fn inverse_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: &[Expr<'g>],
    most: usize,
) -> ForceDerivatives<'g> {
    let motions = link_motions(model, joints, v, a);
    let columns: Vec<Vec<DofMotionChanges<'g>>> =
        joints.iter().zip(&motions).map(|(j, m)| derivative_columns(j, m)).collect();
    let twists: Vec<SpatialVector<'g>> = motions.iter().map(|m| m.own.twist()).collect();
    let wrenches = rnea::link_wrenches(model, joints, v, Some(a));
    let sums = subtree_sums(model, joints, &twists, &wrenches, 2.0);
    derivative_entries(model, joints, &columns, &sums, most)
}

/// Returns a matrix `C` such that `C v` are the Coriolis and centrifugal forces and `Ṁ − 2 C` is
/// skew-symmetric, from half of the velocity map and `Ṡ`, in up to `most` lanes (one: scalar code).
pub fn coriolis_matrix<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    most: usize,
) -> Matrix<'g> {
    let twists = twists(model, joints, v);
    let columns: Vec<Vec<DofMotionChanges<'g>>> =
        joints.iter().zip(&twists).map(|(j, t)| coriolis_columns(model, j, t)).collect();
    let still = vec![SpatialVector::zero(model); joints.len()];
    let sums = subtree_sums(model, joints, &twists, &still, 1.0);
    let mut matrix = derivative_entries(model, joints, &columns, &sums, most).by_v;
    add_inertances(model, &mut matrix);
    matrix
}

/// Adds `b Jᵀ J̇` for each inertance `b` on a velocity `J v`.
fn add_inertances<'g>(model: &Model<'g>, matrix: &mut Matrix<'g>) {
    for element in &model.inertances {
        let gradient = velocity_gradient(element.rate);
        for (j, d) in &gradient {
            let change = element.inertance * time_derivative(model.configuration_space(), *d);
            for (i, d) in &gradient {
                matrix[*i][*j] += *d * change;
            }
        }
    }
}

/// Returns the derivatives for all pairs of degrees of freedom on one path to the root, with up to `most`
/// paths in lanes.
fn derivative_entries<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    columns: &[Vec<DofMotionChanges<'g>>],
    sums: &[SubtreeMassAndWrench<'g>],
    most: usize,
) -> ForceDerivatives<'g> {
    let zero_matrix = || vec![vec![model.graph.zero(); model.nv()]; model.nv()];
    let out = ForceDerivatives { by_q: zero_matrix(), by_v: zero_matrix() };
    let paths = PathsToRoot::new(joints, most);
    let mut entries = ForceDerivativeVisitor {
        columns,
        all: columns.concat(),
        links: paths.links_of_freedoms(),
        sums,
        out,
    };
    paths.propagate_to_root(&mut entries);
    entries.out
}

struct ForceDerivativeVisitor<'a, 'g> {
    /// Columns of the degrees of freedom of each link; the field `all` holds the same columns in one list.
    columns: &'a [Vec<DofMotionChanges<'g>>],
    all: Vec<DofMotionChanges<'g>>,
    links: &'a [usize],
    sums: &'a [SubtreeMassAndWrench<'g>],
    out: ForceDerivatives<'g>,
}

impl<'g> RootPropagationVisitor<'g> for ForceDerivativeVisitor<'_, 'g> {
    type Propagated = DofWrenchDerivatives<'g>;

    fn initial_quantity_of_dof(&mut self, dof: usize) -> DofWrenchDerivatives<'g> {
        let (own, link) = (&self.all[dof], self.links[dof]);
        let mut changes = DofWrenchDerivatives::new(own, &self.sums[link]);
        for row in &self.columns[link] {
            self.out.add_derivative_entries(
                row,
                own,
                row.subspace.dot(&changes.by_q),
                row.subspace.dot(&changes.by_v),
            );
        }
        changes.by_q = changes.by_q.plus(&cross_force(&own.subspace, &self.sums[link].wrench));
        changes
    }

    fn process_transformed_group(&mut self, group: &LaneGroup<DofWrenchDerivatives<'g>>) {
        for other in &self.columns[group.link] {
            let [above, below] = group
                .item
                .force_derivatives_with_ancestor(&other.map(&|e| group.repeat_for_group_members(e)));
            let pair_entries_by_dof =
                |[by_q, by_v]: [Expr<'g>; 2]| group.lanes_of_members(by_q).zip(group.lanes_of_members(by_v));
            for ((dof, by_q), (_, by_v)) in pair_entries_by_dof(above) {
                self.out.add_derivative_entries(other, &self.all[dof], by_q, by_v);
            }
            for ((dof, by_q), (_, by_v)) in pair_entries_by_dof(below) {
                self.out.add_derivative_entries(&self.all[dof], other, by_q, by_v);
            }
        }
    }
}

/// Contribution of one degree of freedom to the entries with its ancestors, as wrenches about an ancestor's
/// origin in the ancestor's axes.
struct DofWrenchDerivatives<'g> {
    /// Change of the wrench with the displacement of the degree of freedom.
    by_q: SpatialVector<'g>,
    /// Change of the wrench with the velocity of the degree of freedom.
    by_v: SpatialVector<'g>,
    /// Momentum `I S` of the link and its descendants at unit velocity of the degree of freedom.
    momentum: SpatialVector<'g>,
    /// Transposed velocity map `Bᵀ S`, a pure moment.
    moment: Vec3<'g>,
}

impl<'g> DofWrenchDerivatives<'g> {
    fn new(column: &DofMotionChanges<'g>, sum: &SubtreeMassAndWrench<'g>) -> DofWrenchDerivatives<'g> {
        DofWrenchDerivatives {
            by_q: momentum(&sum.inertia, &column.second).plus(&sum.velocity_derivative_wrench(&column.first)),
            by_v: sum
                .velocity_derivative_wrench(&column.subspace)
                .plus(&momentum(&sum.inertia, &column.rate)),
            momentum: momentum(&sum.inertia, &column.subspace),
            moment: sum.transposed_velocity_derivative_moment(&column.subspace),
        }
    }

    /// Returns the derivatives of the force of an ancestor's degree of freedom with respect to `q` and `v` of
    /// this degree of freedom, then the derivatives with the two degrees of freedom exchanged.
    fn force_derivatives_with_ancestor(&self, other: &DofMotionChanges<'g>) -> [[Expr<'g>; 2]; 2] {
        let s = &other.subspace;
        let by_q = self.momentum.dot(&other.second) + self.moment.dot(other.first.angular);
        let by_v = self.momentum.dot(&other.rate) + self.moment.dot(s.angular);
        [[s.dot(&self.by_q), s.dot(&self.by_v)], [by_q, by_v]]
    }
}

impl_propagated!(DofWrenchDerivatives { by_q, by_v, momentum, moment });

impl<'g> ForceDerivatives<'g> {
    fn add_derivative_entries(
        &mut self,
        row: &DofMotionChanges<'g>,
        column: &DofMotionChanges<'g>,
        by_q: Expr<'g>,
        by_v: Expr<'g>,
    ) {
        let ratio = by_q.num(row.ratio * column.ratio);
        self.by_q[row.index][column.index] += by_q * ratio;
        self.by_v[row.index][column.index] += by_v * ratio;
    }
}

/// Returns `S ×* F`, the change of a wrench `F` that moves along `S`.
pub fn cross_force<'g>(s: &SpatialVector<'g>, f: &SpatialVector<'g>) -> SpatialVector<'g> {
    SpatialVector {
        linear: s.angular.cross(f.linear),
        angular: s.angular.cross(f.angular) + s.linear.cross(f.linear),
    }
}
