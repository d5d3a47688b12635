//! Contracted second derivatives of inverse dynamics: those of `λᵀ τ(q, v, a)`, on the tangent space.
//!
//! With the virtual twists `W` at the velocities `λ`, `λᵀ τ` is the power `Σ W · f` of the wrenches on all
//! bodies (Jourdain's principle). A variation of a degree of freedom moves all its descendants as one rigid
//! body: in axes that move with them, velocities change by `α`, accelerations by `β + α × V` and `W` by `γ`,
//! the same for every body. Each entry is therefore a product of two factors: the sums over the outer degree
//! of freedom's links, applied to the outer direction, and the direction of the inner degree of freedom. The
//! first derivatives have the same structure (Singh, Russell and Wensing, *Efficient analytical derivatives
//! of rigid-body dynamics using spatial vector algebra*, 2022; *Second-order derivatives of rigid-body
//! dynamics*, 2023, which gives the tensor that is contracted here).
//!
//! | direction | `α` | `β` | `γ` |
//! | --- | --- | --- | --- |
//! | displacement | `Ψ̇` | `Ψ̈` | `Ω = W × S`, `W` of the parent |
//! | velocity | `S` | `Ψ̇ + Ṡ` | – |
//! | acceleration | – | `S` | – |
//!
//! Let `I`, `F`, `B` be the sums of the first derivatives, `P = Σ I W`, `N = Σ Bᵀ W` and
//! `Q = Σ (W×)ᵀ I + I (W×)`. The matrix `Q` has the structure of mass properties with zero mass and the first
//! moment `−P`. An entry is
//!
//! `γ · (I β′ + B α′) + γ′ · (I β + B α) + α · Q α′ + P · (α × α′)`,
//!
//! plus the terms that result from the change of the outer direction itself.

use super::super::crba::{Matrix, momentum};
use super::super::{acceleration_symbols, constraints, rnea, velocity_symbols};
use super::columns::{DofMotionChanges, cross, derivative_columns, link_motions};
use super::subtree::{SubtreeMassAndWrench, subtree_sums, sums_of_single_body};
use super::{analytic, supports_recursive_derivatives, symbolic};
use crate::expr::{Expr, Sym3, Vec3};
use crate::kinematics::{Joint, SpatialVector, twists};
use crate::mechanics::passive::passive_forces;
use crate::mechanism::{Chart, Inertia, Model, Quantity, SuppliedQuantity};
use crate::vectorise::{LaneGroup, PathsToRoot, PropagatedQuantity, RootPropagationVisitor};

/// Second derivatives of a function of configuration, velocity and acceleration. The function is linear in
/// the acceleration, without mixed derivatives with respect to velocity and acceleration.
pub struct Hessian<'g> {
    /// Second derivatives with respect to displacements of the configuration, a symmetric matrix: entry
    /// `(i, j)` is `∂²/∂x ∂y` at `x = y = 0` of the function at `q ⊕ (x eᵢ + y eⱼ)`.
    pub qq: Matrix<'g>,
    /// Mixed derivatives with respect to configuration (rows) and velocity (columns).
    pub qv: Matrix<'g>,
    /// Second derivatives with respect to the velocity.
    pub vv: Matrix<'g>,
    /// Mixed derivatives with respect to configuration (rows) and acceleration (columns).
    pub qa: Matrix<'g>,
}

/// Returns the factors `λ` of the forces as symbols of an argument.
pub fn force_factor_symbols<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.nv()).map(|k| Quantity::Given(SuppliedQuantity::Factor, k).expr(model.graph)).collect()
}

/// Returns the second derivatives of `λᵀ τ` of inverse dynamics by recursion, in up to `most` lanes, or
/// `None` if a motion subspace is not constant in link axes.
pub fn hessian_by_recursion<'g>(model: &Model<'g>, joints: &[Joint<'g>], most: usize) -> Option<Hessian<'g>> {
    if !supports_recursive_derivatives(model) {
        return None;
    }
    let (v, a, lambda) = (velocity_symbols(model), acceleration_symbols(model), force_factor_symbols(model));
    let motions = link_motions(model, joints, &v, &a);
    let virtual_twists = twists(model, joints, &lambda);
    let columns: Vec<Vec<ColumnWithTwistChange<'g>>> = joints
        .iter()
        .zip(&motions)
        .map(|(joint, motion)| {
            let ground = SpatialVector::zero(model);
            let above = joint.parent.map_or(ground, |p| joint.twist_to_child(&virtual_twists[p.0]));
            let column_with_twist_change = |column: DofMotionChanges<'g>| ColumnWithTwistChange {
                factor: cross(&above, &column.subspace),
                column,
            };
            derivative_columns(joint, motion).into_iter().map(column_with_twist_change).collect()
        })
        .collect();
    let own: Vec<SpatialVector<'g>> = motions.iter().map(|m| m.own.twist()).collect();
    let wrenches = rnea::link_wrenches(model, joints, &v, Some(&a));
    let sums = subtree_sums(model, joints, &own, &wrenches, 2.0);
    let sums = subtree_sums_with_virtual_twists(model, joints, (&own, &virtual_twists), sums);
    let zero_matrix = || vec![vec![model.graph.zero(); model.nv()]; model.nv()];
    let out = Hessian { qq: zero_matrix(), qv: zero_matrix(), vv: zero_matrix(), qa: zero_matrix() };
    let paths = PathsToRoot::new(joints, most);
    let mut entries = HessianVisitor {
        columns: &columns,
        all: columns.concat(),
        links: paths.links_of_freedoms(),
        sums: &sums,
        out,
    };
    paths.propagate_to_root(&mut entries);
    let mut out = entries.out;
    out.add_hessian(&passive_hessian(model, &lambda));
    Some(out)
}

/// Returns the second derivatives of `λᵀ τ` of inverse dynamics by differentiation.
pub fn hessian_by_differentiation<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Hessian<'g> {
    let (v, a) = (velocity_symbols(model), acceleration_symbols(model));
    let tau = rnea::inverse_dynamics(model, joints, &v, Some(&a));
    hessian_of_power(model, &tau, &force_factor_symbols(model))
}

/// Returns the second derivatives of the power of springs, dashpots, friction, potentials and loads.
fn passive_hessian<'g>(model: &Model<'g>, lambda: &[Expr<'g>]) -> Hessian<'g> {
    hessian_of_power(model, &passive_forces(model, true), lambda)
}

/// Returns the second derivatives of `λᵀ τ` for forces `tau` that are given as expressions.
pub fn hessian_of_power<'g>(model: &Model<'g>, tau: &[Expr<'g>], lambda: &[Expr<'g>]) -> Hessian<'g> {
    let zero = model.graph.zero();
    let power = tau.iter().zip(lambda).fold(zero, |sum, (tau, factor)| sum + *tau * *factor);
    let first = symbolic::configuration_and_velocity_derivatives(model, &[power]);
    let by_q = first.by_q.into_iter().next().unwrap_or_default();
    let by_v = first.by_v.into_iter().next().unwrap_or_default();
    let mut second = symbolic::configuration_and_velocity_derivatives(model, &by_q);
    symmetrise_configuration_block(model, &mut second.by_q);
    Hessian {
        qq: second.by_q,
        qv: second.by_v,
        vv: symbolic::configuration_and_velocity_derivatives(model, &by_v).by_v,
        qa: symbolic::acceleration_derivative_matrix(model, &by_q),
    }
}

/// Second derivatives of the power `λᵀ τ` of the input forces.
pub struct InputPowerHessian<'g> {
    /// Second derivatives with respect to configuration and velocity.
    pub state: Hessian<'g>,
    /// Mixed derivatives with respect to configuration (rows) and input (columns).
    pub qu: Matrix<'g>,
    /// Mixed derivatives with respect to velocity (rows) and input (columns).
    pub vu: Matrix<'g>,
    /// Second derivatives with respect to pairs of inputs.
    pub uu: Matrix<'g>,
}

/// Returns the second derivatives of the power `λᵀ τ` of the input forces `tau`.
pub fn hessian_of_input_power<'g>(model: &Model<'g>, tau: &[Expr<'g>]) -> InputPowerHessian<'g> {
    let lambda = force_factor_symbols(model);
    let zero = model.graph.zero();
    let power = tau.iter().zip(&lambda).fold(zero, |sum, (tau, factor)| sum + *tau * *factor);
    let by_u =
        symbolic::input_derivatives_of_expressions(model, &[power]).into_iter().next().unwrap_or_default();
    let mixed = symbolic::configuration_and_velocity_derivatives(model, &by_u);
    let transposed_matrix =
        |m: Matrix<'g>| (0..model.nv()).map(|k| m.iter().map(|row| row[k]).collect()).collect();
    InputPowerHessian {
        state: hessian_of_power(model, tau, &lambda),
        qu: transposed_matrix(mixed.by_q),
        vu: transposed_matrix(mixed.by_v),
        uu: symbolic::input_derivatives_of_expressions(model, &by_u),
    }
}

/// Second derivatives of the constraint forces and of the constraint equations, contracted with factors.
pub struct ConstraintHessian<'g> {
    /// Second derivatives with respect to the state and the accelerations.
    pub state: Hessian<'g>,
    /// Mixed derivatives with respect to configuration (rows) and multiplier (columns).
    pub q_lambda: Matrix<'g>,
}

/// Returns the second derivatives of `−λᵀ J w + zᵀ (J a + b) + yᵀ (J v + …)` at constant accelerations `a`.
/// The arguments of the generated function are the multipliers `λ`, then `w`, `z` and `y`.
pub fn hessian_of_constraints<'g>(model: &Model<'g>) -> ConstraintHessian<'g> {
    let (nv, nc, zero) = (model.nv(), model.constraints.len(), model.graph.zero());
    let supplied_argument_symbols = |block: SuppliedQuantity, n: usize| -> Vec<Expr<'g>> {
        (0..n).map(|k| Quantity::Given(block, k).expr(model.graph)).collect()
    };
    let dot_product =
        |a: &[Expr<'g>], b: &[Expr<'g>]| a.iter().zip(b).fold(zero, |sum, (a, b)| sum + *a * *b);
    let (lambda, w) = (
        constraints::multiplier_argument_symbols(model),
        supplied_argument_symbols(SuppliedQuantity::Direction, nv),
    );
    let (z, y) = (
        supplied_argument_symbols(SuppliedQuantity::AccelerationFactor, nc),
        supplied_argument_symbols(SuppliedQuantity::VelocityFactor, nc),
    );
    let (rows, a) = (constraints::jacobian(model), acceleration_symbols(model));
    let along: Vec<Expr<'g>> = rows.iter().map(|row| dot_product(row, &w)).collect();
    let biases = constraints::constraint_biases(model);
    let accelerated: Vec<Expr<'g>> =
        rows.iter().zip(biases).map(|(row, bias)| dot_product(row, &a) + bias).collect();
    let sum = dot_product(&z, &accelerated) + dot_product(&y, &constraints::constraint_velocities(model))
        - dot_product(&lambda, &along);
    let by_q = symbolic::configuration_derivatives(model, &along);
    let q_lambda = (0..nv).map(|i| by_q.iter().map(|row| -row[i]).collect()).collect();
    ConstraintHessian { state: hessian_of_power(model, &[sum], &[model.graph.one()]), q_lambda }
}

/// Symmetrises the configuration block `m`. If axes rotate, the result of two successive displacements
/// depends on their order; the mean of both orders is the second derivative along their sum.
pub fn symmetrise_configuration_block<'g>(model: &Model<'g>, m: &mut Matrix<'g>) {
    for chart in &model.charts {
        let block = match *chart {
            Chart::Plain(..) => continue,
            Chart::Ball(_, v) => v.range_of_entries(3),
            Chart::Free(_, v) => v.range_of_entries(6),
        };
        for i in block.clone() {
            for j in block.start..i {
                let mean = (m[i][j] + m[j][i]) * 0.5;
                (m[i][j], m[j][i]) = (mean, mean);
            }
        }
    }
}

/// Column of a degree of freedom together with `Ω`, the change of the virtual twists with its displacement.
#[derive(Clone, Copy)]
struct ColumnWithTwistChange<'g> {
    column: DofMotionChanges<'g>,
    factor: SpatialVector<'g>,
}

impl<'g> ColumnWithTwistChange<'g> {
    fn map(&self, f: &dyn Fn(Expr<'g>) -> Expr<'g>) -> ColumnWithTwistChange<'g> {
        let factor = SpatialVector { linear: self.factor.linear.map(f), angular: self.factor.angular.map(f) };
        ColumnWithTwistChange { column: self.column.map(f), factor }
    }
}

/// Sums over one link and its descendants, including sums of the virtual twists.
struct SubtreeSums<'g> {
    plain: SubtreeMassAndWrench<'g>,
    /// Momentum `P = Σ I W` at the virtual twists.
    momentum: SpatialVector<'g>,
    /// Moment `N = Σ Bᵀ W` of the virtual twists.
    moment: Vec3<'g>,
    /// Block of `Q` that corresponds to a tensor of inertia.
    tensor: Sym3<'g>,
}

impl<'g> SubtreeSums<'g> {
    /// Returns the moment of `Q X + X ×* P`, which has no force.
    fn inertia_rate_and_momentum_moment(&self, x: &SpatialVector<'g>) -> Vec3<'g> {
        self.inertia_rate_wrench_moment(x)
            + x.angular.cross(self.momentum.angular)
            + x.linear.cross(self.momentum.linear)
    }

    /// Returns the moment of the wrench `Q X` for a spatial vector `X`.
    fn inertia_rate_wrench_moment(&self, x: &SpatialVector<'g>) -> Vec3<'g> {
        x.linear.cross(self.momentum.linear) + self.tensor * x.angular
    }
}

fn subtree_sums_with_virtual_twists<'g>(
    model: &Model<'g>,
    joints: &[Joint<'g>],
    (own, virtual_twists): (&[SpatialVector<'g>], &[SpatialVector<'g>]),
    sums: Vec<SubtreeMassAndWrench<'g>>,
) -> Vec<SubtreeSums<'g>> {
    let mut changes: Vec<Inertia<'g>> = Vec::with_capacity(joints.len());
    let mut wrenches: Vec<[SpatialVector<'g>; 2]> = Vec::with_capacity(joints.len());
    for ((link, own), w) in model.links.iter().zip(own).zip(virtual_twists) {
        let p = momentum(&link.inertia, w);
        let zero = Vec3::zero(model.graph);
        let n = sums_of_single_body(&link.inertia, own, 2.0).transposed_velocity_derivative_moment(w);
        changes.push(inertia_rate(&link.inertia, w, p.linear));
        wrenches.push([p, SpatialVector { linear: zero, angular: n }]);
    }
    for (k, joint) in joints.iter().enumerate().rev() {
        if let Some(parent) = joint.parent {
            changes[parent.0] = joint.add_inertia_to_parent(&changes[parent.0], &changes[k]);
            let [p, n] = wrenches[k];
            let above = wrenches[parent.0];
            wrenches[parent.0] =
                [joint.add_wrench_to_parent(&above[0], &p), joint.add_wrench_to_parent(&above[1], &n)];
        }
    }
    let parts = changes.into_iter().zip(wrenches);
    sums.into_iter()
        .zip(parts)
        .map(|(plain, (change, [momentum, moment]))| SubtreeSums {
            plain,
            momentum,
            moment: moment.angular,
            tensor: change.tensor,
        })
        .collect()
}

/// Returns `(W×)ᵀ I + I (W×)` of a body with the momentum `p` at the twist `W = (a, b)`: zero mass, the first
/// moment `−p`, and the tensor `h aᵀ + a hᵀ − 2 (h · a) + J [b]× − [b]× J`.
fn inertia_rate<'g>(body: &Inertia<'g>, w: &SpatialVector<'g>, p: Vec3<'g>) -> Inertia<'g> {
    let (h, a, b, j) = (body.moment, w.linear, w.angular, &body.tensor);
    let lever = (h.dot(a)) * 2.0;
    // Row i of J [b]× is (column i of J) × b.
    let cross_row = |i: usize| Vec3([j.entry(i, 0), j.entry(i, 1), j.entry(i, 2)]).cross(b);
    let rows = [cross_row(0), cross_row(1), cross_row(2)];
    let tensor_entry = |i: usize, k: usize| rows[i][k] + rows[k][i] + h[i] * a[k] + a[i] * h[k];
    Inertia {
        mass: body.mass.zero(),
        moment: -p,
        tensor: Sym3 {
            diagonal: [tensor_entry(0, 0) - lever, tensor_entry(1, 1) - lever, tensor_entry(2, 2) - lever],
            off: [tensor_entry(0, 1), tensor_entry(0, 2), tensor_entry(1, 2)],
        },
    }
}

struct HessianVisitor<'a, 'g> {
    /// Columns of the degrees of freedom of each link; the field `all` holds the same columns in one list.
    columns: &'a [Vec<ColumnWithTwistChange<'g>>],
    all: Vec<ColumnWithTwistChange<'g>>,
    links: &'a [usize],
    sums: &'a [SubtreeSums<'g>],
    out: Hessian<'g>,
}

impl<'g> RootPropagationVisitor<'g> for HessianVisitor<'_, 'g> {
    type Propagated = DofHessianContribution<'g>;

    fn initial_quantity_of_dof(&mut self, dof: usize) -> DofHessianContribution<'g> {
        let (own, sums) = (self.all[dof], &self.sums[self.links[dof]]);
        let changes = DofHessianContribution::new(&own, sums);
        let out = &mut self.out;
        for other in &self.columns[self.links[dof]] {
            let [qq, _, vq, _, _, aq] = changes.hessian_entries_with_ancestor(other);
            // Half of the value for each of the two orders.
            out.add_entry(|h| &mut h.qq, &own, other, qq * 0.5);
            out.add_entry(|h| &mut h.qq, other, &own, qq * 0.5);
            out.add_entry(|h| &mut h.qv, other, &own, vq);
            out.add_entry(|h| &mut h.qa, other, &own, aq);
            let vv = sums.inertia_rate_wrench_moment(&own.column.subspace).dot(other.column.subspace.angular)
                + sums.momentum.linear.cross(own.column.subspace.angular).dot(other.column.subspace.linear);
            out.add_entry(|h| &mut h.vv, &own, other, vv);
        }
        changes
    }

    fn process_transformed_group(&mut self, group: &LaneGroup<DofHessianContribution<'g>>) {
        for other in &self.columns[group.link] {
            let met =
                group.item.hessian_entries_with_ancestor(&other.map(&|e| group.repeat_for_group_members(e)));
            for (part, entry) in met.into_iter().enumerate() {
                for (dof, entry) in group.lanes_of_members(entry) {
                    let own = &self.all[dof];
                    let out = &mut self.out;
                    match part {
                        0 => {
                            out.add_entry(|h| &mut h.qq, own, other, entry);
                            out.add_entry(|h| &mut h.qq, other, own, entry);
                        }
                        1 => out.add_entry(|h| &mut h.qv, own, other, entry),
                        2 => out.add_entry(|h| &mut h.qv, other, own, entry),
                        3 => {
                            out.add_entry(|h| &mut h.vv, own, other, entry);
                            out.add_entry(|h| &mut h.vv, other, own, entry);
                        }
                        4 => out.add_entry(|h| &mut h.qa, own, other, entry),
                        _ => out.add_entry(|h| &mut h.qa, other, own, entry),
                    }
                }
            }
        }
    }
}

impl<'g> Hessian<'g> {
    fn add_entry(
        &mut self,
        block: for<'h> fn(&'h mut Hessian<'g>) -> &'h mut Matrix<'g>,
        row: &ColumnWithTwistChange<'g>,
        column: &ColumnWithTwistChange<'g>,
        entry: Expr<'g>,
    ) {
        let (row, column) = (&row.column, &column.column);
        block(self)[row.index][column.index] += entry * entry.num(row.ratio * column.ratio);
    }

    /// Adds another Hessian to this one, entry by entry.
    fn add_hessian(&mut self, other: &Hessian<'g>) {
        let blocks = [
            (&mut self.qq, &other.qq),
            (&mut self.qv, &other.qv),
            (&mut self.vv, &other.vv),
            (&mut self.qa, &other.qa),
        ];
        for (to, from) in blocks {
            for (entry, change) in to.iter_mut().flatten().zip(from.iter().flatten()) {
                *entry += *change;
            }
        }
    }
}

/// Contribution of one degree of freedom to the entries with its ancestors, as wrenches about an ancestor's
/// origin in the ancestor's axes. Moments are wrenches without force.
struct DofHessianContribution<'g> {
    /// Wrench `I Ψ̈ + B Ψ̇ + S ×* F`: change with the displacement.
    by_q: SpatialVector<'g>,
    /// Virtual wrench `I Ω + S ×* P`: change with the displacement.
    factored: SpatialVector<'g>,
    /// Moment `Bᵀ Ω + Q Ψ̇ + Ψ̇ ×* P + S ×* N`: change with the displacement.
    moment_by_q: Vec3<'g>,
    /// Wrench `I (Ψ̇ + Ṡ) + B S`: change with the velocity.
    by_v: SpatialVector<'g>,
    /// Moment `Q S + S ×* P`: change with the velocity.
    moment_by_v: Vec3<'g>,
    /// Momentum `I S` at unit velocity of the degree of freedom.
    momentum: SpatialVector<'g>,
}

impl<'g> DofHessianContribution<'g> {
    fn new(own: &ColumnWithTwistChange<'g>, sums: &SubtreeSums<'g>) -> DofHessianContribution<'g> {
        let (column, plain) = (&own.column, &sums.plain);
        let s = &column.subspace;
        let momentum_of_twist = |x: &SpatialVector<'g>| momentum(&plain.inertia, x);
        DofHessianContribution {
            by_q: momentum_of_twist(&column.second)
                .plus(&plain.velocity_derivative_wrench(&column.first))
                .plus(&analytic::cross_force(s, &plain.wrench)),
            factored: momentum_of_twist(&own.factor).plus(&analytic::cross_force(s, &sums.momentum)),
            moment_by_q: plain.transposed_velocity_derivative_moment(&own.factor)
                + sums.inertia_rate_and_momentum_moment(&column.first)
                + s.angular.cross(sums.moment),
            by_v: momentum_of_twist(&column.rate).plus(&plain.velocity_derivative_wrench(s)),
            moment_by_v: sums.inertia_rate_and_momentum_moment(s),
            momentum: momentum_of_twist(s),
        }
    }

    /// Returns the six entries with a degree of freedom of an ancestor, by the variation of this degree of
    /// freedom and that of the other: displacement and displacement; displacement and velocity; velocity and
    /// displacement; velocity and velocity; displacement and acceleration; acceleration and displacement.
    fn hessian_entries_with_ancestor(&self, other: &ColumnWithTwistChange<'g>) -> [Expr<'g>; 6] {
        let DofMotionChanges { subspace, first, second, rate, .. } = &other.column;
        [
            other.factor.dot(&self.by_q) + second.dot(&self.factored) + first.angular.dot(self.moment_by_q),
            subspace.angular.dot(self.moment_by_q) + rate.dot(&self.factored),
            other.factor.dot(&self.by_v) + first.angular.dot(self.moment_by_v),
            subspace.angular.dot(self.moment_by_v),
            subspace.dot(&self.factored),
            other.factor.dot(&self.momentum),
        ]
    }
}

impl_propagated!(DofHessianContribution { by_q, factored, moment_by_q, by_v, moment_by_v, momentum });
