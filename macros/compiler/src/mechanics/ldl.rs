//! `M x = r` by a sparse factorisation `M = Lᵀ D L` run symbolically: the zeros that the branches of a tree leave stay
//! zeros when the leaves are eliminated first (Featherstone 2008, ch. 6.5).

use super::crba::Matrix;
use super::kinematics::Joint;
use crate::expr::Expr;

/// The solution of `m x = r`.
pub fn solve<'g>(mut m: Matrix<'g>, mut r: Vec<Expr<'g>>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let Some(graph) = r.first().map(|e| e.graph()) else {
        return r;
    };
    let order = elimination_order(joints, r.len());
    let mut inverse = vec![graph.zero(); r.len()];
    for (step, &k) in order.iter().enumerate() {
        inverse[k] = graph.one() / m[k][k];
        let rest: Vec<usize> = order[step + 1..].iter().copied().filter(|&i| !m[k][i].is_zero()).collect();
        for &i in &rest {
            let factor = m[k][i] * inverse[k];
            for &j in rest.iter().filter(|&&j| j <= i) {
                let reduced = m[i][j] - factor * m[k][j];
                m[i][j] = reduced;
                m[j][i] = reduced;
            }
            r[i] = r[i] - factor * r[k];
        }
    }
    let mut x = vec![graph.zero(); r.len()];
    for (step, &k) in order.iter().enumerate().rev() {
        let mut sum = r[k];
        for &i in order[step + 1..].iter().filter(|&&i| !m[k][i].is_zero()) {
            sum -= m[k][i] * x[i];
        }
        x[k] = sum * inverse[k];
    }
    x
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
