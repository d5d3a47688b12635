//! Sliding contacts with dry friction: the normal force is a multiplier `λ`, and the friction force is
//! proportional to it. With `J` the rows of all constraints and `T` the rows of friction (the generalized
//! friction force per unit of each normal force),
//!
//! ```text
//! M v̇ + h = τ + Jᵀ λ + Tᵀ |λ|,   J v̇ + J̇ v = 0.
//! ```
//!
//! For known signs `σ` of the normal forces this is a linear system, which is not symmetric:
//!
//! ```text
//! | M  (J + σ T)ᵀ | |  v̇ |   | τ − h |
//! | J      0      | | −λ | = | −J̇ v  |
//! ```
//!
//! The multipliers of these contacts are eliminated last. Their reduced matrix is then `−J M⁻¹ (J + σ T)ᵀ`,
//! restricted to the motions that the other constraints allow. It determines the normal forces as long as its
//! pivots keep their sign. If a pivot changes sign, friction jams (Painlevé's paradox: Génot and Brogliato,
//! *New results on Painlevé paradoxes*, Eur. J. Mech. A 18, 1999).

use super::constraints::{constrained_right_side, constrained_system_matrix, elimination_order, jacobian};
use super::crba::Matrix;
use super::ldl::Solution;
use crate::expr::{Expr, Function};
use crate::kinematics::velocity_gradients;
use crate::mechanism::{Model, Quantity, SuppliedQuantity};

/// Returns the constraints whose multipliers are normal forces of sliding contacts with friction.
pub fn sliding_contact_constraints(model: &Model<'_>) -> Vec<usize> {
    let all = model.constraints.iter().enumerate();
    all.filter(|(_, c)| !c.friction.is_empty()).map(|(k, _)| k).collect()
}

/// Returns `T`, with a row for each constraint and a column for each velocity.
pub fn friction_jacobian<'g>(model: &Model<'g>) -> Matrix<'g> {
    let friction_jacobian_row = |c: &crate::mechanism::Constraint<'g>| {
        let mut row = vec![model.graph.zero(); model.nv()];
        let rates: Vec<Expr<'g>> = c.friction.iter().map(|d| d.rate).collect();
        for (gradient, drag) in velocity_gradients(&rates).into_iter().zip(&c.friction) {
            gradient.into_iter().for_each(|(k, d)| row[k] += d * drag.share);
        }
        row
    };
    model.constraints.iter().map(friction_jacobian_row).collect()
}

/// Returns accelerations and multipliers for forces `τ − h` and biases, then measures of their reliability,
/// as [`super::constraints::solve_constrained_dynamics`] does. The signs `σ` are arguments.
pub fn solve_with_friction<'g>(
    model: &Model<'g>,
    mass: &Matrix<'g>,
    force: Vec<Expr<'g>>,
    bias: Vec<Expr<'g>>,
) -> Vec<Expr<'g>> {
    let nv = mass.len();
    let rows = jacobian(model);
    let (friction, last) = (friction_jacobian(model), sliding_contact_constraints(model));
    let mut k = constrained_system_matrix(mass, &rows);
    for (n, row) in last.iter().enumerate() {
        let side = Quantity::Given(SuppliedQuantity::Side, n).expr(model.graph);
        for (equation, drag) in k.iter_mut().zip(&friction[*row]) {
            equation[nv + row] += side * *drag;
        }
    }
    let (order, _) = elimination_order(&k, nv, &last);
    solve_by_ordered_elimination(k, constrained_right_side(force, bias), &order, nv)
        .accelerations_with_reliability(nv)
}

/// Solves `m x = r` by elimination in a given order. Also returns the magnitudes that the elimination of the
/// first `first` indices has subtracted from each diagonal entry.
fn solve_by_ordered_elimination<'g>(
    mut m: Matrix<'g>,
    mut r: Vec<Expr<'g>>,
    order: &[usize],
    first: usize,
) -> Solution<'g> {
    let zero_vector = || r.first().map_or(Vec::new(), |e| vec![e.zero(); r.len()]);
    let (mut inverse, mut x, mut pivots, mut taken) =
        (zero_vector(), zero_vector(), zero_vector(), zero_vector());
    for (step, &k) in order.iter().enumerate() {
        pivots[k] = m[k][k];
        inverse[k] = m[k][k].num(1.0) / m[k][k];
        let left = &order[step + 1..];
        let columns: Vec<usize> = left.iter().copied().filter(|&j| !m[k][j].is_zero()).collect();
        for &i in left.iter().filter(|&&i| !m[i][k].is_zero()).collect::<Vec<_>>() {
            let factor = m[i][k] * inverse[k];
            if k < first {
                taken[i] += (factor * m[k][i]).apply_function(Function::Abs);
            }
            for &j in &columns {
                let part = factor * m[k][j];
                m[i][j] -= part;
            }
            let part = factor * r[k];
            r[i] -= part;
        }
    }
    for (step, &k) in order.iter().enumerate().rev() {
        let later = order[step + 1..].iter().filter(|&&j| !m[k][j].is_zero());
        x[k] = later.fold(r[k], |sum, &j| sum - m[k][j] * x[j]) * inverse[k];
    }
    Solution { x, pivots, taken }
}
