//! Derivatives of inverse dynamics by recursion (Singh, Russell and Wensing, *Efficient analytical derivatives of
//! rigid-body dynamics using spatial vector algebra*, 2022; linear part first here), and the Coriolis matrix (Echeandia
//! and Wensing, *Numerical methods to compute the Coriolis matrix and Christoffel symbols*, 2021), in link axes.
//!
//! With the sums `I`, `F` and `B` (inertia, wrench, velocity map) over a link and all that it carries, and the columns
//! `S`, `Ψ̇`, `Ψ̈` of a degree of freedom, for `j` on the link and `i` on an ancestor of it or on the link itself:
//!
//! - `∂τᵢ/∂qⱼ = Sᵢ · (Sⱼ ×* F + I Ψ̈ⱼ + B Ψ̇ⱼ)`, without the first term if `i` is on the same link;
//! - `∂τⱼ/∂qᵢ = (I Sⱼ) · Ψ̈ᵢ + (Bᵀ Sⱼ) · Ψ̇ᵢ`;
//! - `∂τᵢ/∂vⱼ = Sᵢ · (B Sⱼ + I (Ψ̇ⱼ + Ṡⱼ))`;
//! - `∂τⱼ/∂vᵢ = (Bᵀ Sⱼ) · Sᵢ + (I Sⱼ) · (Ψ̇ᵢ + Ṡᵢ)`.

use super::super::crba::{Matrix, momentum};
use super::super::kinematics::{Joint, time_derivative, twists, velocity_gradient};
use super::super::{Spatial, rnea};
use super::ForceDerivatives;
use super::columns::{Column, columns, motions, rate_columns};
use super::subtree::{Subtree, subtrees};
use crate::expr::{Expr, Vec3};
use crate::model::Model;

/// Derivatives of `M a + h`, springs, dashpots and other loads left out.
pub fn inverse_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: &[Expr<'g>],
) -> ForceDerivatives<'g> {
    let motions = motions(model, joints, v, a);
    let columns: Vec<Vec<Column<'g>>> = joints.iter().zip(&motions).map(|(j, m)| columns(j, m)).collect();
    let twists: Vec<Spatial<'g>> = motions.iter().map(|m| m.own.twist()).collect();
    let wrenches = rnea::wrenches(model, joints, v, Some(a));
    let sums = subtrees(model, joints, &twists, &wrenches, 2.0);
    entries(model, joints, &columns, &sums)
}

/// A matrix with `C v` the Coriolis and centrifugal forces and `Ṁ − 2 C` skew: half of the velocity map, and `Ṡ`.
pub fn coriolis_matrix<'g>(model: &Model<'g>, joints: &[Joint<'g>], v: &[Expr<'g>]) -> Matrix<'g> {
    let twists = twists(model, joints, v);
    let columns: Vec<Vec<Column<'g>>> =
        joints.iter().zip(&twists).map(|(j, t)| rate_columns(model, j, t)).collect();
    let still = vec![Spatial::zero(model); joints.len()];
    let sums = subtrees(model, joints, &twists, &still, 1.0);
    let mut matrix = entries(model, joints, &columns, &sums).by_v;
    add_inertances(model, &mut matrix);
    matrix
}

/// An inertance `b` on a rate `J v` adds `b Jᵀ J̇`.
fn add_inertances<'g>(model: &Model<'g>, matrix: &mut Matrix<'g>) {
    for element in &model.inertances {
        let gradient = velocity_gradient(element.rate);
        for (j, d) in &gradient {
            let change = element.inertance * time_derivative(model.space(), *d);
            for (i, d) in &gradient {
                matrix[*i][*j] += *d * change;
            }
        }
    }
}

/// All pairs of degrees of freedom on one path to the root.
fn entries<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    columns: &[Vec<Column<'g>>],
    sums: &[Subtree<'g>],
) -> ForceDerivatives<'g> {
    let zero = || vec![vec![model.graph.zero(); model.nv()]; model.nv()];
    let mut out = ForceDerivatives { by_q: zero(), by_v: zero() };
    for (link, sum) in sums.iter().enumerate() {
        for own in &columns[link] {
            let mut carried = Carried::new(own, sum);
            for row in &columns[link] {
                out.add(row, own, row.subspace.dot(&carried.by_q), row.subspace.dot(&carried.by_v));
            }
            carried.by_q = carried.by_q.plus(&cross_force(&own.subspace, &sum.wrench));
            let mut at = link;
            while let Some(parent) = joints[at].parent {
                carried.move_to_parent(&joints[at]);
                at = parent.0;
                for other in &columns[at] {
                    carried.meet(own, other, &mut out);
                }
            }
        }
    }
    out
}

/// What one degree of freedom brings to its ancestors: wrenches about their origins in their axes.
struct Carried<'g> {
    /// Change of the forces with its displacement.
    by_q: Spatial<'g>,
    /// Change of the forces with its rate.
    by_v: Spatial<'g>,
    /// `I S`.
    momentum: Spatial<'g>,
    /// `Bᵀ S`, a moment.
    moment: Vec3<'g>,
}

impl<'g> Carried<'g> {
    fn new(column: &Column<'g>, sum: &Subtree<'g>) -> Carried<'g> {
        Carried {
            by_q: momentum(&sum.inertia, &column.second).plus(&sum.map(&column.first)),
            by_v: sum.map(&column.subspace).plus(&momentum(&sum.inertia, &column.rate)),
            momentum: momentum(&sum.inertia, &column.subspace),
            moment: sum.transposed_map(&column.subspace),
        }
    }

    fn move_to_parent(&mut self, joint: &Joint<'g>) {
        self.by_q = joint.wrench_to_parent(&self.by_q);
        self.by_v = joint.wrench_to_parent(&self.by_v);
        self.momentum = joint.wrench_to_parent(&self.momentum);
        self.moment = joint.rotation.to_parent(self.moment);
    }

    /// The entries of the degree of freedom with one of an ancestor.
    fn meet(&self, own: &Column<'g>, other: &Column<'g>, out: &mut ForceDerivatives<'g>) {
        let s = &other.subspace;
        out.add(other, own, s.dot(&self.by_q), s.dot(&self.by_v));
        let by_q = self.momentum.dot(&other.second) + self.moment.dot(other.first.angular);
        let by_v = self.momentum.dot(&other.rate) + self.moment.dot(s.angular);
        out.add(own, other, by_q, by_v);
    }
}

impl<'g> ForceDerivatives<'g> {
    fn add(&mut self, row: &Column<'g>, column: &Column<'g>, by_q: Expr<'g>, by_v: Expr<'g>) {
        let ratio = by_q.num(row.ratio * column.ratio);
        self.by_q[row.index][column.index] += by_q * ratio;
        self.by_v[row.index][column.index] += by_v * ratio;
    }
}

/// `S ×* F`: the change of a wrench that moves along `S`.
fn cross_force<'g>(s: &Spatial<'g>, f: &Spatial<'g>) -> Spatial<'g> {
    Spatial {
        linear: s.angular.cross(f.linear),
        angular: s.angular.cross(f.angular) + s.linear.cross(f.linear),
    }
}
