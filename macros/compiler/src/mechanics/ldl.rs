//! `M x = r` by a sparse factorisation `M = Lᵀ D L` run symbolically: the zeros that the branches of a tree leave stay
//! zeros when the leaves are eliminated first (Featherstone 2008, ch. 6.5).

use super::crba::Matrix;
use super::kinematics::Joint;
use crate::expr::Expr;

/// The solution of `m x = r`.
pub fn solve<'g>(m: Matrix<'g>, r: Vec<Expr<'g>>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let order = elimination_order(joints, r.len());
    solve_in(m, r, &order, 0).x
}

/// A solution with what tells whether it can be trusted.
pub struct Solution<'g> {
    /// The unknowns.
    pub x: Vec<Expr<'g>>,
    /// By index: the pivot.
    pub pivots: Vec<Expr<'g>>,
    /// By index: what the first so many indices have taken from the diagonal entry.
    pub taken: Vec<Expr<'g>>,
}

/// The solution of `m x = r` for a symmetric `m`, eliminated in a given order.
pub fn solve_in<'g>(mut m: Matrix<'g>, mut r: Vec<Expr<'g>>, order: &[usize], first: usize) -> Solution<'g> {
    let zeros = || r.first().map_or(Vec::new(), |e| vec![e.zero(); r.len()]);
    let (mut inverse, mut x, mut pivots, mut taken) = (zeros(), zeros(), zeros(), zeros());
    let mut second = None;
    for (step, &k) in order.iter().enumerate() {
        pivots[k] = m[k][k];
        // Where pivots are asked for they are there to be divided by.
        let first_of_two = first == 0 && second.is_none();
        inverse[k] = second.take().unwrap_or_else(|| m[k][k].num(1.0) / m[k][k]);
        if let Some(&i) = order.get(step + 1).filter(|_| first_of_two) {
            second = second_inverse(m[k][k], m[k][i], m[i][i]);
        }
        let rest: Vec<usize> = order[step + 1..].iter().copied().filter(|&i| !m[k][i].is_zero()).collect();
        for &i in &rest {
            let factor = m[k][i] * inverse[k];
            if k < first {
                taken[i] += factor * m[k][i];
            }
            for &j in rest.iter().filter(|&&j| j <= i) {
                let reduced = m[i][j] - factor * m[k][j];
                m[i][j] = reduced;
                m[j][i] = reduced;
            }
            r[i] = r[i] - factor * r[k];
        }
    }
    for (step, &k) in order.iter().enumerate().rev() {
        let mut sum = r[k];
        for &i in order[step + 1..].iter().filter(|&&i| !m[k][i].is_zero()) {
            sum -= m[k][i] * x[i];
        }
        x[k] = sum * inverse[k];
    }
    Solution { x, pivots, taken }
}

/// The inverse of the second pivot of a symmetric matrix `[a b; b c]`, `1 / (c − b² / a) = a / (a c − b²)`, which does not
/// wait for the inverse of the first: of two divisions one after another the time of one is saved. `None` for `b = 0`.
pub fn second_inverse<'g>(a: Expr<'g>, b: Expr<'g>, c: Expr<'g>) -> Option<Expr<'g>> {
    (!b.is_zero()).then(|| a / (a * c - b * b))
}

/// Entries of `v` from the leaves to the root.
fn elimination_order(joints: &[Joint<'_>], nv: usize) -> Vec<usize> {
    let mut seen = vec![false; nv];
    let mut order = Vec::new();
    for joint in joints.iter().rev() {
        for dof in joint.dofs.iter().rev() {
            if !std::mem::replace(&mut seen[dof.index], true) {
                order.push(dof.index);
            }
        }
    }
    order
}
