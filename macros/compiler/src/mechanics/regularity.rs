//! Whether the mass matrix can be inverted: a coordinate that moves no mass is a mistake in the model.

use super::crba::Matrix;
use crate::expr::Symbol;
use crate::expr::eval::eval;
use crate::kinematics::{Joint, random_configuration};
use crate::mechanism::{Model, Quantity};

/// Pivots below this part of their diagonal entry's first value, times the number of velocities, count as zero. Elimination
/// of a positive definite matrix leaves no more than a few units of rounding for each row (Higham, *Accuracy and Stability
/// of Numerical Algorithms*, 2002, theorem 10.3), and a light body that carries a heavy one keeps a pivot of their ratio:
/// masses may lie twelve powers of ten apart.
const TOLERANCE: f64 = 32.0 * f64::EPSILON;

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

fn failing_pivots(model: &Model<'_>, joints: &[Joint<'_>], mass: &Matrix<'_>, seed: u64) -> Vec<usize> {
    let n = model.nv();
    let q = random_configuration(model, seed);
    let entries: Vec<_> = mass.iter().flatten().copied().collect();
    let values = eval(&entries, &|s: Symbol| match Quantity::of(s) {
        Quantity::Configuration(k) => q[k],
        _ => crate::expr::sample::sample(s, seed),
    });
    let mut m: Vec<Vec<f64>> = values.chunks(n.max(1)).map(<[f64]>::to_vec).collect();
    // Root first: an entry that fails is then one that adds nothing to those before it.
    let mut order: Vec<usize> = Vec::new();
    // Coordinates that place nothing come last.
    for index in joints.iter().flat_map(|j| j.dofs.iter().map(|d| d.index)).chain(0..n) {
        if !order.contains(&index) {
            order.push(index);
        }
    }
    let scale: Vec<f64> = (0..n).map(|k| m[k][k]).collect();
    let smallest = TOLERANCE * n as f64;
    let mut failing = Vec::new();
    for (step, &k) in order.iter().enumerate() {
        // Parameters at random may make an inertia that no body has: then a pivot is negative, and not zero all the same.
        if m[k][k].abs() <= smallest * scale[k].abs() || scale[k] == 0.0 {
            failing.push(k);
            continue;
        }
        for &i in &order[step + 1..] {
            let factor = m[i][k] / m[k][k];
            for &j in &order[step + 1..] {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    failing
}
