//! The mass matrix factorised, `M = Lᵀ D L`, with the zeros of a tree kept (Featherstone 2008, ch. 6.5), for both an
//! acceleration and the inverse.

use super::super::crba::Matrix;
use super::super::ldl::{elimination_order, inverses};
use crate::expr::Expr;
use crate::kinematics::Joint;

/// `M = Lᵀ D L`, `L` with a unit diagonal.
pub struct Factor<'g> {
    /// Entries of `v` from the leaves to the root.
    order: Vec<usize>,
    /// By entry: the entries of its row of `L` that are not zero, without the diagonal.
    rows: Vec<Vec<(usize, Expr<'g>)>>,
    /// Diagonal of `D⁻¹`.
    inverse: Vec<Expr<'g>>,
}

impl<'g> Factor<'g> {
    /// Factorises.
    pub fn of(mass: &Matrix<'g>, joints: &[Joint<'g>]) -> Factor<'g> {
        Factor::in_order(mass, &elimination_order(joints, mass.len()))
    }

    /// Factorises the block of some entries of `v`, from the leaves to the root.
    pub fn in_order(mass: &Matrix<'g>, order: &[usize]) -> Factor<'g> {
        let mut m = mass.clone();
        let mut rows = vec![Vec::new(); m.len()];
        let mut inverse: Vec<Expr<'g>> = (0..m.len()).map(|k| m[k][k].num(1.0)).collect();
        let mut known = Vec::new().into_iter();
        for (step, &k) in order.iter().enumerate() {
            inverse[k] = known.next().unwrap_or_else(|| {
                known = inverses(&m, &order[step..]).into_iter();
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
        Factor { order: order.to_vec(), rows, inverse }
    }

    /// `M⁻¹ r`.
    pub fn solve(&self, mut r: Vec<Expr<'g>>) -> Vec<Expr<'g>> {
        for &k in &self.order {
            for (i, factor) in &self.rows[k] {
                r[*i] = r[*i] - *factor * r[k];
            }
        }
        for &k in self.order.iter().rev() {
            r[k] = self.rows[k].iter().fold(r[k] * self.inverse[k], |x, (i, factor)| x - *factor * r[*i]);
        }
        r
    }

    /// The inverse, zero outside the block, from the root to the leaves: a unit force on an entry reaches only those
    /// above it, so for all others the substitution starts from zero, and symmetry gives the rest.
    pub fn inverse(&self) -> Matrix<'g> {
        let n = self.rows.len();
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
