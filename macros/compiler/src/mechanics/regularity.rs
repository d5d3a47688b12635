//! Whether the mass matrix can be inverted: a coordinate that moves no mass is a mistake in the model.

use super::crba::Matrix;
use crate::expr::Symbol;
use crate::expr::eval::{Rounded, Tape};
use crate::kinematics::{Joint, random_configuration};
use crate::mechanism::{Model, Quantity};

/// The entries of `v` at which the factorisation fails, from the root on. None if it does not fail in every one of several
/// random configurations; those where it fails in all of them, if there are such.
pub fn singular_velocities(model: &Model<'_>, joints: &[Joint<'_>], mass: &Matrix<'_>) -> Vec<usize> {
    let mut found = failing_pivots(model, joints, mass, 0);
    for seed in 1..3 {
        if found.is_empty() {
            break;
        }
        let again = failing_pivots(model, joints, mass, seed);
        let both: Vec<usize> = found.iter().copied().filter(|k| again.contains(k)).collect();
        found = if both.is_empty() { again } else { both };
    }
    found
}

/// A pivot is `zᵀ M z` of a motion `z` in which one velocity is 1 and those before it are what leaves the least energy. If
/// the entries of `M` are off by `E`, the pivot is by up to `|z|ᵀ E |z|` (Higham, *Accuracy and Stability of Numerical Algorithms*,
/// 2002, § 10.1), however small it is beside the diagonal of `M`. `E` is what rounding does on the way to each entry, so that levers
/// which cancel leave less than it, too. Masses may lie twelve powers of ten apart.
fn failing_pivots(model: &Model<'_>, joints: &[Joint<'_>], mass: &Matrix<'_>, seed: u64) -> Vec<usize> {
    let n = model.nv();
    let q = random_configuration(model, seed);
    let entries: Vec<_> = mass.iter().flatten().copied().collect();
    let whole: Vec<Vec<Rounded>> = Tape::of(&entries)
        .rounded(&|s: Symbol| match Quantity::of(s) {
            Quantity::Configuration(k) => q[k],
            _ => crate::expr::sample::sample(s, seed),
        })
        .chunks(n.max(1))
        .map(<[Rounded]>::to_vec)
        .collect();
    let mut m: Vec<Vec<f64>> =
        whole.iter().map(|row| row.iter().map(|entry| entry.value).collect()).collect();
    // Root first: an entry that fails is then one that adds nothing to those before it.
    let mut order: Vec<usize> = Vec::new();
    // Coordinates that place nothing come last.
    for index in joints.iter().flat_map(|j| j.dofs.iter().map(|d| d.index)).chain(0..n) {
        if !order.contains(&index) {
            order.push(index);
        }
    }
    let mut failing = Vec::new();
    let mut eliminated = Vec::new();
    for (step, &k) in order.iter().enumerate() {
        // Parameters at random may make an inertia that no body has: then a pivot is negative, and not zero all the same.
        let pivot = Rounded { value: m[k][k], error: rounding(&whole, &m, &eliminated, k) };
        if pivot.may_be_zero() {
            failing.push(k);
            continue;
        }
        for &i in &order[step + 1..] {
            let factor = m[i][k] / m[k][k];
            for &j in &order[step + 1..] {
                m[i][j] -= factor * m[k][j];
            }
        }
        eliminated.push(k);
    }
    failing
}

/// `|z|ᵀ E |z|` of the motion `z` whose velocity `k` is 1, with what elimination has left of `M`.
fn rounding(whole: &[Vec<Rounded>], left: &[Vec<f64>], eliminated: &[usize], k: usize) -> f64 {
    let mut z = vec![(k, 1.0)];
    for &i in eliminated.iter().rev() {
        let others: f64 = z.iter().map(|(j, value)| left[i][*j] * value).sum();
        z.push((i, -others / left[i][i]));
    }
    z.iter().flat_map(|(i, a)| z.iter().map(move |(j, b)| (a * whole[*i][*j].error * b).abs())).sum()
}
