//! Invertibility of the mass matrix. A coordinate that moves no mass is an error in the model.

use super::crba::Matrix;
use crate::expr::Symbol;
use crate::expr::eval::{Tape, ValueWithRoundingError};
use crate::kinematics::{Joint, random_configuration};
use crate::mechanism::{Model, Quantity};

/// Returns the entries of `v` at which the factorisation of the mass matrix fails, from the root on. Several
/// random configurations are tested. The result is empty if the factorisation succeeds in one of them. If
/// some entries fail in all configurations, only those are returned.
pub fn velocities_with_singular_mass(
    model: &Model<'_>,
    joints: &[Joint<'_>],
    mass: &Matrix<'_>,
) -> Vec<usize> {
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

/// Returns the failing pivots in one random configuration. A pivot is `zᵀ M z` of the motion `z` in which one
/// velocity is 1 and its predecessors minimise the energy. If the entries of `M` have errors up to `E`, the
/// error of the pivot is up to `|z|ᵀ E |z|` (Higham, *Accuracy and Stability of Numerical Algorithms*, 2002,
/// § 10.1), however small the pivot is compared with the diagonal of `M`. `E` bounds the accumulated rounding
/// error of each entry, so that the rounding residue of cancelling lever arms counts as zero. Masses may
/// differ by twelve powers of ten.
fn failing_pivots(model: &Model<'_>, joints: &[Joint<'_>], mass: &Matrix<'_>, seed: u64) -> Vec<usize> {
    let n = model.nv();
    let q = random_configuration(model, seed);
    let entries: Vec<_> = mass.iter().flatten().copied().collect();
    let whole: Vec<Vec<ValueWithRoundingError>> = Tape::new(&entries)
        .evaluate_with_rounding(&|s: Symbol| match Quantity::from_symbol(s) {
            Quantity::Configuration(k) => q[k],
            _ => crate::expr::sample::sample_of_symbol(s, seed),
        })
        .chunks(n.max(1))
        .map(<[ValueWithRoundingError]>::to_vec)
        .collect();
    let mut m: Vec<Vec<f64>> =
        whole.iter().map(|row| row.iter().map(|entry| entry.value).collect()).collect();
    // Root first: an entry that fails then adds nothing to its predecessors.
    let mut order: Vec<usize> = Vec::new();
    // Coordinates that move no link come last.
    for index in joints.iter().flat_map(|j| j.dofs.iter().map(|d| d.index)).chain(0..n) {
        if !order.contains(&index) {
            order.push(index);
        }
    }
    let mut failing = Vec::new();
    let mut eliminated = Vec::new();
    for (step, &k) in order.iter().enumerate() {
        // Random parameters may give an inertia that no body has. A pivot may then be negative, but it is
        // still different from zero.
        let pivot = ValueWithRoundingError {
            value: m[k][k],
            error: rounding_error_of_pivot(&whole, &m, &eliminated, k),
        };
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

/// Returns `|z|ᵀ E |z|` of the motion `z` whose velocity `k` is 1, where `left` is the matrix `M` reduced by
/// elimination.
fn rounding_error_of_pivot(
    whole: &[Vec<ValueWithRoundingError>],
    left: &[Vec<f64>],
    eliminated: &[usize],
    k: usize,
) -> f64 {
    let mut z = vec![(k, 1.0)];
    for &i in eliminated.iter().rev() {
        let others: f64 = z.iter().map(|(j, value)| left[i][*j] * value).sum();
        z.push((i, -others / left[i][i]));
    }
    z.iter().flat_map(|(i, a)| z.iter().map(move |(j, b)| (a * whole[*i][*j].error * b).abs())).sum()
}
