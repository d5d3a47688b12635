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
use super::super::rnea;
use super::ForceDerivatives;
use super::columns::{Column, columns, motions, rate_columns};
use super::subtree::{Subtree, subtrees};
use crate::expr::{Expr, Vec3};
use crate::kinematics::{Joint, Spatial, time_derivative, twists, velocity_gradient};
use crate::mechanism::Model;
use crate::vectorise::{LaneGroup, Paths, Propagated, Visitor};

/// Derivatives of `M a + h`, springs, dashpots and other loads left out; in up to `most` lanes, one for none.
pub fn inverse_dynamics<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    a: &[Expr<'g>],
    most: usize,
) -> ForceDerivatives<'g> {
    let motions = motions(model, joints, v, a);
    let columns: Vec<Vec<Column<'g>>> = joints.iter().zip(&motions).map(|(j, m)| columns(j, m)).collect();
    let twists: Vec<Spatial<'g>> = motions.iter().map(|m| m.own.twist()).collect();
    let wrenches = rnea::wrenches(model, joints, v, Some(a));
    let sums = subtrees(model, joints, &twists, &wrenches, 2.0);
    entries(model, joints, &columns, &sums, most)
}

/// A matrix with `C v` the Coriolis and centrifugal forces and `Ṁ − 2 C` skew: half of the velocity map, and `Ṡ`; in
/// up to `most` lanes, one for none.
pub fn coriolis_matrix<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    v: &[Expr<'g>],
    most: usize,
) -> Matrix<'g> {
    let twists = twists(model, joints, v);
    let columns: Vec<Vec<Column<'g>>> =
        joints.iter().zip(&twists).map(|(j, t)| rate_columns(model, j, t)).collect();
    let still = vec![Spatial::zero(model); joints.len()];
    let sums = subtrees(model, joints, &twists, &still, 1.0);
    let mut matrix = entries(model, joints, &columns, &sums, most).by_v;
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

/// All pairs of degrees of freedom on one path to the root; up to `most` go there in lanes.
fn entries<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    columns: &[Vec<Column<'g>>],
    sums: &[Subtree<'g>],
    most: usize,
) -> ForceDerivatives<'g> {
    let zero = || vec![vec![model.graph.zero(); model.nv()]; model.nv()];
    let out = ForceDerivatives { by_q: zero(), by_v: zero() };
    let paths = Paths::of(joints, most);
    let mut entries = Entries { columns, all: columns.concat(), links: paths.links(), sums, out };
    paths.propagate(&mut entries);
    entries.out
}

struct Entries<'a, 'g> {
    /// Degrees of freedom, by link and all together.
    columns: &'a [Vec<Column<'g>>],
    all: Vec<Column<'g>>,
    links: &'a [usize],
    sums: &'a [Subtree<'g>],
    out: ForceDerivatives<'g>,
}

impl<'g> Visitor<'g> for Entries<'_, 'g> {
    type Item = Changes<'g>;

    fn start(&mut self, dof: usize) -> Changes<'g> {
        let (own, link) = (&self.all[dof], self.links[dof]);
        let mut changes = Changes::new(own, &self.sums[link]);
        for row in &self.columns[link] {
            self.out.add(row, own, row.subspace.dot(&changes.by_q), row.subspace.dot(&changes.by_v));
        }
        changes.by_q = changes.by_q.plus(&cross_force(&own.subspace, &self.sums[link].wrench));
        changes
    }

    fn visit(&mut self, group: &LaneGroup<Changes<'g>>) {
        for other in &self.columns[group.link] {
            let [above, below] = group.item.meet(&other.map(&|e| group.spread(e)));
            let parts = |[by_q, by_v]: [Expr<'g>; 2]| group.parts(by_q).zip(group.parts(by_v));
            for ((dof, by_q), (_, by_v)) in parts(above) {
                self.out.add(other, &self.all[dof], by_q, by_v);
            }
            for ((dof, by_q), (_, by_v)) in parts(below) {
                self.out.add(&self.all[dof], other, by_q, by_v);
            }
        }
    }
}

/// What one degree of freedom brings to its ancestors: wrenches about their origins in their axes.
struct Changes<'g> {
    /// Change of the forces with its displacement.
    by_q: Spatial<'g>,
    /// Change of the forces with its rate.
    by_v: Spatial<'g>,
    /// `I S`.
    momentum: Spatial<'g>,
    /// `Bᵀ S`, a moment.
    moment: Vec3<'g>,
}

impl<'g> Changes<'g> {
    fn new(column: &Column<'g>, sum: &Subtree<'g>) -> Changes<'g> {
        Changes {
            by_q: momentum(&sum.inertia, &column.second).plus(&sum.map(&column.first)),
            by_v: sum.map(&column.subspace).plus(&momentum(&sum.inertia, &column.rate)),
            momentum: momentum(&sum.inertia, &column.subspace),
            moment: sum.transposed_map(&column.subspace),
        }
    }

    /// The derivatives of the force of a degree of freedom of an ancestor by `q` and `v` of this one, and the other way
    /// round.
    fn meet(&self, other: &Column<'g>) -> [[Expr<'g>; 2]; 2] {
        let s = &other.subspace;
        let by_q = self.momentum.dot(&other.second) + self.moment.dot(other.first.angular);
        let by_v = self.momentum.dot(&other.rate) + self.moment.dot(s.angular);
        [[s.dot(&self.by_q), s.dot(&self.by_v)], [by_q, by_v]]
    }
}

impl<'g> Propagated<'g> for Changes<'g> {
    fn zip_with(&self, other: &Self, f: &dyn Fn(Expr<'g>, Expr<'g>) -> Expr<'g>) -> Self {
        Changes {
            by_q: self.by_q.zip_with(&other.by_q, f),
            by_v: self.by_v.zip_with(&other.by_v, f),
            momentum: self.momentum.zip_with(&other.momentum, f),
            moment: self.moment.zip_with(&other.moment, f),
        }
    }

    fn to_parent(&self, joint: &Joint<'g>) -> Self {
        Changes {
            by_q: self.by_q.to_parent(joint),
            by_v: self.by_v.to_parent(joint),
            momentum: self.momentum.to_parent(joint),
            moment: self.moment.to_parent(joint),
        }
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
pub fn cross_force<'g>(s: &Spatial<'g>, f: &Spatial<'g>) -> Spatial<'g> {
    Spatial {
        linear: s.angular.cross(f.linear),
        angular: s.angular.cross(f.angular) + s.linear.cross(f.linear),
    }
}
