//! Constrained motion by Lagrange multipliers: `M v̇ + h = τ + Jᵀ λ` with `J v̇ + J̇ v = 0`, one symmetric
//! system
//!
//! ```text
//! | M  Jᵀ | |  v̇ |   | τ − h |
//! | J  0  | | −λ | = | −J̇ v  |
//! ```
//!
//! that is eliminated symbolically, which preserves its structural zeros (Featherstone 2008, ch. 8.5). A
//! multiplier is eliminated after the velocities in its row. Its pivot is then the component of `−J M⁻¹ Jᵀ`
//! that is independent of the other rows eliminated before.

use super::crba::Matrix;
use super::derivatives::{ForceDerivatives, symbolic};
use super::friction;
use super::ldl::{self, solve_in_order};
use crate::expr::{Expr, Function};
use crate::kinematics::{Joint, velocity_gradients};
use crate::mechanism::{ConstraintPivot, Model, Quantity, SuppliedQuantity};

/// Returns `J`, with a row for each constraint and a column for each velocity.
pub fn jacobian<'g>(model: &Model<'g>) -> Matrix<'g> {
    let rates: Vec<Expr<'g>> = model.constraints.iter().map(|c| c.rate).collect();
    jacobian_of_rates(model, &rates)
}

/// Returns the derivatives of `rates` with respect to the velocities: a row for each rate, a column for each
/// velocity.
pub fn jacobian_of_rates<'g>(model: &Model<'g>, rates: &[Expr<'g>]) -> Matrix<'g> {
    let row_from_gradient = |gradient: Vec<(usize, Expr<'g>)>| {
        let mut row = vec![model.graph.zero(); model.nv()];
        gradient.into_iter().for_each(|(k, d)| row[k] = d);
        row
    };
    velocity_gradients(rates).into_iter().map(row_from_gradient).collect()
}

/// Returns the residuals of all holonomic constraints.
pub fn residuals<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    model.constraints.iter().filter_map(|c| c.residual).collect()
}

/// Returns the velocities `J v + …` of all constraints.
pub fn constraint_velocities<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    model.constraints.iter().map(|c| c.rate).collect()
}

/// Returns `J̇ v + …`: the time derivatives of the constraint velocities at zero accelerations.
pub fn constraint_biases<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    model.constraints.iter().map(|c| c.bias).collect()
}

/// Returns accelerations and multipliers for forces `τ − h` and biases `J̇ v`, then measures of their
/// reliability: the pivot of each constraint, and the value of that pivot before the elimination of other
/// constraints reduced it.
pub fn solve_constrained_dynamics<'g>(
    mass: &Matrix<'g>,
    jacobian: &Matrix<'g>,
    force: Vec<Expr<'g>>,
    bias: Vec<Expr<'g>>,
) -> Vec<Expr<'g>> {
    let nv = mass.len();
    let k = constrained_system_matrix(mass, jacobian);
    let (order, _) = elimination_order(&k, nv, &[]);
    solve_in_order(k, constrained_right_side(force, bias), &order, nv).accelerations_with_reliability(nv)
}

/// Returns the right side of the equations of motion with constraints: forces, followed by the negative
/// biases of the constraint accelerations.
pub(super) fn constrained_right_side<'g>(mut force: Vec<Expr<'g>>, bias: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
    force.extend(bias.into_iter().map(|b| -b));
    force
}

/// Returns the terms from which multipliers of minimum norm are computed for dependent constraints: the
/// unconstrained accelerations `M⁻¹ f`, the residuals `−b − J M⁻¹ f` of the constraints, the matrix
/// `J M⁻¹ Jᵀ`, and the accelerations `M⁻¹ Jᵀ` per unit of each multiplier.
pub fn minimum_norm_terms<'g>(
    mass: &Matrix<'g>,
    jacobian: &Matrix<'g>,
    force: Vec<Expr<'g>>,
    bias: &[Expr<'g>],
    joints: &[Joint<'g>],
) -> Vec<Expr<'g>> {
    let dot_product =
        |a: &[Expr<'g>], b: &[Expr<'g>]| a.iter().zip(b).map(|(a, b)| *a * *b).reduce(|a, b| a + b);
    let mut out = ldl::solve_symmetric(mass.clone(), force, joints);
    let given: Matrix<'g> =
        jacobian.iter().map(|row| ldl::solve_symmetric(mass.clone(), row.clone(), joints)).collect();
    let lacking =
        jacobian.iter().zip(bias).map(|(row, b)| dot_product(row, &out).map_or(-*b, |sum| -*b - sum));
    let lacking: Vec<Expr<'g>> = lacking.collect();
    out.extend(lacking);
    for (i, row) in jacobian.iter().enumerate() {
        // The lower triangle gives both triangles.
        out.extend((0..given.len()).filter_map(|j| match j <= i {
            true => dot_product(row, &given[j]),
            false => dot_product(&jacobian[j], &given[i]),
        }));
    }
    out.extend(given.concat());
    out
}

/// Returns the generalized forces `Jᵀ λ` of the constraints, including the friction that is proportional to
/// their normal forces.
pub fn constraint_forces<'g>(model: &Model<'g>, lambda: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let mut forces = vec![model.graph.zero(); model.nv()];
    for ((row, drag), l) in jacobian(model).iter().zip(friction::friction_jacobian(model)).zip(lambda) {
        let size = l.apply_function(Function::Abs);
        for ((force, entry), drag) in forces.iter_mut().zip(row).zip(drag) {
            *force += *entry * *l + drag * size;
        }
    }
    forces
}

/// Returns the constraint multipliers as symbols for arguments of generated functions.
pub fn multiplier_argument_symbols<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.constraints.len())
        .map(|k| Quantity::Given(SuppliedQuantity::Multiplier, k).expr(model.graph))
        .collect()
}

/// Returns the approximate number of products in the elimination of constraints.
pub fn elimination_product_count(model: &Model<'_>, mass: &Matrix<'_>) -> usize {
    elimination_order(
        &constrained_system_matrix(mass, &jacobian(model)),
        mass.len(),
        &friction::sliding_contact_constraints(model),
    )
    .1
}

/// Returns the matrix of the system of accelerations and multipliers.
pub fn constrained_system_matrix<'g>(mass: &Matrix<'g>, jacobian: &Matrix<'g>) -> Matrix<'g> {
    let mut k: Matrix<'g> = mass.clone();
    for (row, c) in k.iter_mut().zip(0..) {
        row.extend(jacobian.iter().map(|j| j[c]));
    }
    for row in jacobian {
        let zeros = row.first().map_or(Vec::new(), |e| vec![e.zero(); jacobian.len()]);
        k.push(row.iter().copied().chain(zeros).collect());
    }
    k
}

/// Solves for accelerations and multipliers by independent velocities (Kane and Levinson, *Dynamics: Theory
/// and Applications*, 1985; the projection `Nᵀ M N` of Gibbs, Appell and Kane), with the same results as
/// [`solve_constrained_dynamics`]. The dependent velocities are eliminated with the given pivots,
/// `a = N s + a₀`, then `Nᵀ M N s = Nᵀ (τ − h − M a₀)`. The multipliers follow from the residuals of the
/// dependent equations.
pub fn solve_by_independent_velocities<'g>(
    model: &Model<'g>,
    mass: &Matrix<'g>,
    force: &[Expr<'g>],
    bias: Vec<Expr<'g>>,
    pivots: &[ConstraintPivot],
) -> Vec<Expr<'g>> {
    let (g, nv) = (model.graph, model.nv());
    let pivots: Vec<(usize, usize)> = pivots.iter().map(|p| (p.constraint, p.velocity.0)).collect();
    let rows = jacobian(model);
    let free: Vec<usize> = (0..nv).filter(|k| pivots.iter().all(|(_, column)| column != k)).collect();
    // Columns of N, with a₀ as the last.
    let mut right: Matrix<'g> = rows.iter().map(|row| free.iter().map(|k| -row[*k]).collect()).collect();
    right.iter_mut().zip(bias).for_each(|(row, b)| row.push(-b));
    let (solved, sizes) = eliminate_rows(rows.clone(), right, &pivots);
    let null_space_column = |c: usize| -> Vec<Expr<'g>> {
        let independent_velocity_derivative =
            |k: usize| if free.get(c) == Some(&k) { g.one() } else { g.zero() };
        let column_entry_of_velocity = |k: usize| {
            pivots
                .iter()
                .find(|(_, j)| *j == k)
                .map_or(independent_velocity_derivative(k), |(row, _)| solved[*row][c])
        };
        (0..nv).map(column_entry_of_velocity).collect()
    };
    let columns: Matrix<'g> = (0..free.len()).map(null_space_column).collect();
    let start = null_space_column(free.len());
    let dot_product =
        |a: &[Expr<'g>], b: &[Expr<'g>]| a.iter().zip(b).fold(g.zero(), |sum, (a, b)| sum + *a * *b);
    let multiply_by_mass =
        |v: &[Expr<'g>]| -> Vec<Expr<'g>> { mass.iter().map(|row| dot_product(row, v)).collect() };
    let carried: Matrix<'g> = columns.iter().map(|c| multiply_by_mass(c)).collect();
    let reduced: Matrix<'g> =
        columns.iter().map(|a| carried.iter().map(|b| dot_product(a, b)).collect()).collect();
    let lacking: Vec<Expr<'g>> = force.iter().zip(multiply_by_mass(&start)).map(|(f, m)| *f - m).collect();
    let r = columns.iter().map(|c| dot_product(c, &lacking)).collect();
    let order: Vec<usize> = (0..free.len()).rev().collect();
    let s = solve_in_order(reduced, r, &order, 0).x;
    let a: Vec<Expr<'g>> =
        (0..nv).map(|k| columns.iter().zip(&s).fold(start[k], |sum, (c, s)| sum + c[k] * *s)).collect();
    // J_dᵀ λ = (M a − f)_d, with the same pivots, rows and columns exchanged.
    let left: Vec<Expr<'g>> = multiply_by_mass(&a).iter().zip(force).map(|(m, f)| *m - *f).collect();
    let transposed: Matrix<'g> = (0..nv).map(|k| rows.iter().map(|row| row[k]).collect()).collect();
    let backwards: Vec<(usize, usize)> = pivots.iter().map(|(row, column)| (*column, *row)).collect();
    let (lambda, _) = eliminate_rows(transposed, left.into_iter().map(|l| vec![l]).collect(), &backwards);
    let mut out = a;
    out.extend((0..rows.len()).map(|c| {
        let at = backwards.iter().find(|(_, row)| *row == c);
        at.map_or(g.zero(), |(k, _)| lambda[*k][0])
    }));
    out.extend(sizes.iter().map(|p| p.square()));
    out.extend(rows.iter().map(|row| dot_product(row, row)));
    out
}

/// Eliminates the rows by the Gauss–Jordan method with the given pivots (row, column), and applies the steps
/// to the right sides. Returns the solved right sides, and the pivot of each row.
fn eliminate_rows<'g>(
    mut rows: Matrix<'g>,
    mut right: Matrix<'g>,
    pivots: &[(usize, usize)],
) -> (Matrix<'g>, Vec<Expr<'g>>) {
    let mut sizes: Vec<Expr<'g>> = rows.iter().filter_map(|row| row.first().map(|e| e.zero())).collect();
    let involved: Vec<usize> = pivots.iter().map(|(row, _)| *row).collect();
    for (step, &(row, column)) in pivots.iter().enumerate() {
        sizes[row] = rows[row][column];
        let inverse = rows[row][column].num(1.0) / rows[row][column];
        right[row].iter_mut().for_each(|e| *e = *e * inverse);
        let later: Vec<usize> = pivots[step + 1..].iter().map(|(_, j)| *j).collect();
        for &j in &later {
            rows[row][j] = rows[row][j] * inverse;
        }
        let (own, own_right) = (rows[row].clone(), right[row].clone());
        for &i in involved.iter().filter(|i| **i != row) {
            let factor = rows[i][column];
            if factor.is_zero() {
                continue;
            }
            for &j in &later {
                rows[i][j] -= factor * own[j];
            }
            right[i].iter_mut().zip(&own_right).for_each(|(x, o)| *x -= factor * *o);
        }
    }
    (right, sizes)
}

/// Returns an elimination order of minimum degree, which limits fill-in, and the approximate number of
/// products. A multiplier comes after the velocities of its row; the multipliers of the rows `last` come
/// after everything else.
pub fn elimination_order(k: &Matrix<'_>, nv: usize, last: &[usize]) -> (Vec<usize>, usize) {
    let n = k.len();
    let is_eliminated_last = |i: usize| i >= nv && last.contains(&(i - nv));
    let mut full: Vec<Vec<bool>> =
        (0..n).map(|i| (0..n).map(|j| !k[i][j].is_zero() || !k[j][i].is_zero()).collect()).collect();
    let waits: Vec<Vec<usize>> = (0..n)
        .map(|i| match (is_eliminated_last(i), i < nv) {
            (true, _) => (0..n).filter(|j| !is_eliminated_last(*j)).collect(),
            (_, true) => Vec::new(),
            _ => (0..nv).filter(|j| full[i][*j]).collect(),
        })
        .collect();
    let mut left: Vec<usize> = (0..n).collect();
    let (mut order, mut done, mut products) = (Vec::with_capacity(n), vec![false; n], 0);
    while !left.is_empty() {
        let elimination_degree = |i: usize| left.iter().filter(|j| **j != i && full[i][**j]).count();
        let ready = left.iter().copied().filter(|i| waits[*i].iter().all(|j| done[*j]));
        // Among equal degrees the last index is taken: leaves precede the links that carry them.
        let Some(next) = ready.min_by_key(|i| (elimination_degree(*i), usize::MAX - i)) else { break };
        left.retain(|i| *i != next);
        order.push(next);
        done[next] = true;
        let near: Vec<usize> = left.iter().copied().filter(|j| full[next][*j]).collect();
        products += near.len() * (near.len() + 1) / 2;
        for &i in &near {
            for &j in &near {
                full[i][j] = true;
            }
        }
    }
    (order, products)
}

/// Returns the forces and biases of the equations of motion as the symbols that
/// [`solve_constrained_dynamics`] takes as arguments at run time.
pub fn force_and_bias_symbols<'g>(model: &Model<'g>) -> (Vec<Expr<'g>>, Vec<Expr<'g>>) {
    let (nv, nc) = (model.nv(), model.constraints.len());
    let supplied_argument_symbols =
        |block, n: usize| (0..n).map(|k| Quantity::Given(block, k).expr(model.graph)).collect();
    (
        supplied_argument_symbols(SuppliedQuantity::Force, nv),
        supplied_argument_symbols(SuppliedQuantity::Bias, nc),
    )
}

/// First derivatives of the terms that constraints add to the equations of motion.
pub struct ConstraintTermDerivatives<'g> {
    /// Derivatives of the constraint forces `Jᵀ λ` at constant multipliers.
    pub forces: ForceDerivatives<'g>,
    /// Derivatives of `J a + b` at the accelerations `a`.
    pub accelerations: ForceDerivatives<'g>,
    /// Derivatives of the constraint velocities with respect to `q`.
    pub rates: Matrix<'g>,
}

/// Returns the derivatives at the accelerations `a`; the multipliers are argument symbols.
pub fn constraint_first_derivatives<'g>(model: &Model<'g>, a: &[Expr<'g>]) -> ConstraintTermDerivatives<'g> {
    let rows = jacobian(model);
    let zero = model.graph.zero();
    let forces = constraint_forces(model, &multiplier_argument_symbols(model));
    let rate_along_accelerations =
        |row: &Vec<Expr<'g>>| row.iter().zip(a).fold(zero, |sum, (j, a)| sum + *j * *a);
    let accelerations: Vec<Expr<'g>> = rows
        .iter()
        .zip(constraint_biases(model))
        .map(|(row, bias)| rate_along_accelerations(row) + bias)
        .collect();
    ConstraintTermDerivatives {
        forces: symbolic::configuration_and_velocity_derivatives(model, &forces),
        accelerations: symbolic::configuration_and_velocity_derivatives(model, &accelerations),
        rates: symbolic::configuration_and_velocity_derivatives(model, &constraint_velocities(model)).by_q,
    }
}
