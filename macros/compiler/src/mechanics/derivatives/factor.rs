//! Factorisation `M = Lᵀ D L` of the mass matrix that preserves the zeros of a tree (Featherstone 2008, ch.
//! 6.5), shared by accelerations and the inverse. If forces depend on accelerations, the matrix is not
//! symmetric and the factorisation is `M = U D L` with triangles on both sides, eliminated in the same order.
//! The pivots stay away from zero as long as the symmetric part of the matrix is positive definite (Golub and
//! Van Loan, *Matrix Computations*, 2013, § 4.4).

use super::super::crba::Matrix;
use super::super::ldl::{order_from_leaves_to_root, pivot_inverses};
use crate::expr::Expr;
use crate::kinematics::Joint;

/// The factors `M = Lᵀ D L`, or `U D L` of an unsymmetric matrix; `L` and `U` have unit diagonals.
pub struct MatrixFactorisation<'g> {
    /// Indices of `v` in elimination order: from the leaves to the root.
    order: Vec<usize>,
    /// Nonzero off-diagonal entries of `L`, a row for each entry of `v`.
    rows: Vec<Vec<(usize, Expr<'g>)>>,
    /// Nonzero off-diagonal entries of `U`, a column for each entry of `v`; `None` if `U` is the transpose of
    /// `L`.
    columns: Option<Vec<Vec<(usize, Expr<'g>)>>>,
    /// Diagonal of `D⁻¹` in the factorisation, in the order of `v`.
    inverse: Vec<Expr<'g>>,
}

impl<'g> MatrixFactorisation<'g> {
    /// Factorises a mass matrix, which may be unsymmetric, in an order from leaves to root.
    pub fn new(mass: &Matrix<'g>, joints: &[Joint<'g>]) -> MatrixFactorisation<'g> {
        let order = order_from_leaves_to_root(joints, mass.len());
        let n = mass.len();
        match (0..n).all(|i| (0..i).all(|j| mass[i][j] == mass[j][i])) {
            true => MatrixFactorisation::factorise_from_leaves_to_root(mass, &order),
            false => MatrixFactorisation::factorise_unsymmetric(mass, &order),
        }
    }

    /// Factorises a matrix that need not be symmetric.
    fn factorise_unsymmetric(mass: &Matrix<'g>, order: &[usize]) -> MatrixFactorisation<'g> {
        let mut m = mass.clone();
        let (mut rows, mut columns) = (vec![Vec::new(); m.len()], vec![Vec::new(); m.len()]);
        let mut inverse: Vec<Expr<'g>> = (0..m.len()).map(|k| m[k][k].num(1.0)).collect();
        for (step, &k) in order.iter().enumerate() {
            inverse[k] = inverse[k] / m[k][k];
            let rest = &order[step + 1..];
            let row: Vec<usize> = rest.iter().copied().filter(|&j| !m[k][j].is_zero()).collect();
            let below: Vec<usize> = rest.iter().copied().filter(|&i| !m[i][k].is_zero()).collect();
            for i in below {
                let factor = m[i][k] * inverse[k];
                for &j in &row {
                    let taken = factor * m[k][j];
                    m[i][j] -= taken;
                }
                columns[k].push((i, factor));
            }
            rows[k] = row.into_iter().map(|j| (j, m[k][j] * inverse[k])).collect();
        }
        MatrixFactorisation { order: order.to_vec(), rows, columns: Some(columns), inverse }
    }

    /// Factorises the symmetric block of the entries of `v` in `order`, which lists leaves before the root.
    pub fn factorise_from_leaves_to_root(mass: &Matrix<'g>, order: &[usize]) -> MatrixFactorisation<'g> {
        let mut m = mass.clone();
        let mut rows = vec![Vec::new(); m.len()];
        let mut inverse: Vec<Expr<'g>> = (0..m.len()).map(|k| m[k][k].num(1.0)).collect();
        let mut known = Vec::new().into_iter();
        for (step, &k) in order.iter().enumerate() {
            inverse[k] = known.next().unwrap_or_else(|| {
                known = pivot_inverses(&m, &order[step..]).into_iter();
                known.next().unwrap_or(m[k][k])
            });
            let rest: Vec<usize> =
                order[step + 1..].iter().copied().filter(|&i| !m[k][i].is_zero()).collect();
            for &i in &rest {
                let factor = m[k][i] * inverse[k];
                for &j in rest.iter().filter(|&&j| j <= i) {
                    let reduced = m[i][j] - factor * m[k][j];
                    m[i][j] = reduced;
                    m[j][i] = reduced;
                }
                rows[k].push((i, factor));
            }
        }
        MatrixFactorisation { order: order.to_vec(), rows, columns: None, inverse }
    }

    /// Returns the solution `M⁻¹ r` of a linear system with the factorised matrix.
    pub fn solve_factored(&self, r: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        self.apply_remaining_factors(self.solve_with_first_factor(r))
    }

    /// Returns `L⁻ᵀ r`, or `U⁻¹ r` for an unsymmetric matrix.
    fn solve_with_first_factor(&self, mut r: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        let columns = self.columns.as_ref().unwrap_or(&self.rows);
        for &k in &self.order {
            for (i, factor) in &columns[k] {
                r[*i] = r[*i] - *factor * r[k];
            }
        }
        r
    }

    /// Returns `L⁻¹ D⁻¹ r`, the remaining steps of a solution.
    fn apply_remaining_factors(&self, mut r: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        for &k in self.order.iter().rev() {
            r[k] = self.rows[k].iter().fold(r[k] * self.inverse[k], |x, (i, factor)| x - *factor * r[*i]);
        }
        r
    }

    /// Returns `M⁻¹ Gᵀ`, then `G M⁻¹ Gᵀ`, column by column, for the rows of `G`.
    pub fn constraint_responses(&self, rows: &[Vec<Expr<'g>>]) -> Vec<Expr<'g>> {
        let Some(zero) = self.inverse.first().map(|d| d.zero()) else { return Vec::new() };
        let reduced: Vec<Vec<Expr<'g>>> =
            rows.iter().map(|row| self.solve_with_first_factor(row.clone())).collect();
        let mut out: Vec<Expr<'g>> =
            reduced.iter().flat_map(|row| self.apply_remaining_factors(row.clone())).collect();
        let weighted: Vec<Vec<Expr<'g>>> =
            reduced.iter().map(|row| row.iter().zip(&self.inverse).map(|(r, d)| *r * *d).collect()).collect();
        for i in 0..rows.len() {
            out.extend((0..rows.len()).map(|j| {
                // The lower triangle gives both triangles.
                let (low, high) = (i.min(j), i.max(j));
                let products = reduced[high].iter().zip(&weighted[low]).map(|(a, b)| *a * *b);
                products.fold(zero, |a, b| a + b)
            }));
        }
        out
    }

    /// Returns the inverse, zero outside the block. It is computed from the root to the leaves: a unit force
    /// on an entry reaches only the entries nearer to the root, so for all others the substitution starts
    /// from zero. Symmetry gives the other triangle.
    pub fn inverse(&self) -> Matrix<'g> {
        let n = self.rows.len();
        if self.columns.is_some() {
            let unit_column =
                |c: usize| (0..n).map(|k| self.inverse[k].num(if k == c { 1.0 } else { 0.0 })).collect();
            let columns: Matrix<'g> = (0..n).map(|c| self.solve_factored(unit_column(c))).collect();
            return (0..n).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
        }
        let mut out: Matrix<'g> = self.inverse.iter().map(|d| vec![d.zero(); n]).collect();
        for (step, &k) in self.order.iter().enumerate().rev() {
            for &c in self.order[step..].iter().rev() {
                let start = if c == k { self.inverse[k] } else { self.inverse[k].zero() };
                let entry = self.rows[k].iter().fold(start, |x, (i, factor)| x - *factor * out[*i][c]);
                out[k][c] = entry;
                out[c][k] = entry;
            }
        }
        out
    }
}
