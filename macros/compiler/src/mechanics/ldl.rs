//! Solution of `M x = r` by a sparse factorisation `M = Lᵀ D L` run symbolically. Eliminating the leaves
//! first preserves the zeros between the branches of a tree (Featherstone 2008, ch. 6.5).

use super::crba::Matrix;
use crate::expr::Expr;
use crate::kinematics::Joint;

/// Returns the solution of `m x = r` for a symmetric matrix `m`.
pub fn solve_symmetric<'g>(m: Matrix<'g>, r: Vec<Expr<'g>>, joints: &[Joint<'g>]) -> Vec<Expr<'g>> {
    let order = order_from_leaves_to_root(joints, r.len());
    solve_in_order(m, r, &order, 0).x
}

/// Solution of a linear system with measures of its reliability.
pub struct Solution<'g> {
    /// Unknowns `x` of the linear system.
    pub x: Vec<Expr<'g>>,
    /// Pivot of each unknown in the factorisation.
    pub pivots: Vec<Expr<'g>>,
    /// Amount that the elimination of the first `first` indices has subtracted from each diagonal entry.
    pub taken: Vec<Expr<'g>>,
}

impl<'g> Solution<'g> {
    /// Returns the accelerations, of which there are `nv`, and the multipliers, then measures of the
    /// reliability of the multipliers: their pivots, and the amounts that the elimination has subtracted.
    pub fn accelerations_with_reliability(mut self, nv: usize) -> Vec<Expr<'g>> {
        for multiplier in &mut self.x[nv..] {
            *multiplier = -*multiplier;
        }
        self.x.extend(self.pivots[nv..].iter().map(|p| -*p));
        self.x.extend_from_slice(&self.taken[nv..]);
        self.x
    }
}

/// Solves `m x = r` for a symmetric `m`, eliminated in a given order.
pub fn solve_in_order<'g>(
    mut m: Matrix<'g>,
    mut r: Vec<Expr<'g>>,
    order: &[usize],
    first: usize,
) -> Solution<'g> {
    let zero_vector = || r.first().map_or(Vec::new(), |e| vec![e.zero(); r.len()]);
    let (mut inverse, mut x, mut pivots, mut taken) =
        (zero_vector(), zero_vector(), zero_vector(), zero_vector());
    // For each index: the rows from which its row is subtracted, each with the multiple.
    let mut factors: Vec<Vec<(usize, Expr<'g>)>> = vec![Vec::new(); r.len()];
    let mut known = Vec::new().into_iter();
    for (step, &k) in order.iter().enumerate() {
        pivots[k] = m[k][k];
        inverse[k] = match known.next() {
            Some(inverse) => inverse,
            // If pivots are an output, they are computed in any case, so the inverse is one division.
            None if first > 0 => m[k][k].num(1.0) / m[k][k],
            None => {
                known = pivot_inverses(&m, &order[step..]).into_iter();
                known.next().unwrap_or(m[k][k])
            }
        };
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
            factors[k].push((i, factor));
        }
    }
    for &k in order.iter().rev() {
        x[k] = factors[k].iter().rev().fold(r[k] * inverse[k], |sum, (i, factor)| sum - *factor * x[*i]);
    }
    Solution { x, pivots, taken }
}

/// Returns the inverses of up to two pivots of a symmetric matrix, in elimination order. The second does not
/// depend on the first, so the latency of one of two successive divisions is saved. A third inverse by
/// leading minors would be a ratio of determinants, whose rounding error grows with the square of the
/// condition number if two pivots are small compared with the first (light links that carry a heavy load,
/// velocities that follow from others by large factors).
pub fn pivot_inverses<'g>(m: &Matrix<'g>, order: &[usize]) -> Vec<Expr<'g>> {
    let permuted_entry = |i: usize, j: usize| m[order[i]][order[j]];
    let Some(a) = order.first().map(|_| permuted_entry(0, 0)) else { return Vec::new() };
    let second = (order.len() > 1)
        .then(|| inverse_of_second_ldl_pivot(a, permuted_entry(0, 1), permuted_entry(1, 1)))
        .flatten();
    std::iter::once(a.num(1.0) / a).chain(second).collect()
}

/// Returns the inverse of the second pivot of a symmetric matrix `[a b; b c]`,
/// `1 / (c − b² / a) = a / (a c − b²)`, which does not depend on the inverse of the first pivot. Returns
/// `None` for `b = 0`.
pub fn inverse_of_second_ldl_pivot<'g>(a: Expr<'g>, b: Expr<'g>, c: Expr<'g>) -> Option<Expr<'g>> {
    (!b.is_zero()).then(|| a / (a * c - b * b))
}

/// Returns the entries of `v` from the leaves to the root. Entries that move no link and appear only in
/// elements come first.
pub fn order_from_leaves_to_root(joints: &[Joint<'_>], nv: usize) -> Vec<usize> {
    let mut seen = vec![true; nv];
    joints.iter().flat_map(|joint| &joint.dofs).for_each(|dof| seen[dof.index] = false);
    let mut order: Vec<usize> = (0..nv).filter(|k| seen[*k]).collect();
    for joint in joints.iter().rev() {
        for dof in joint.dofs.iter().rev() {
            if !std::mem::replace(&mut seen[dof.index], true) {
                order.push(dof.index);
            }
        }
    }
    order
}
