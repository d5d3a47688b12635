//! Whether the mass matrix can be inverted: a coordinate that moves no mass is a mistake in the model.

use super::crba::Matrix;
use crate::expr::Symbol;
use crate::expr::eval::eval;
use crate::kinematics::{Joint, random_configuration};
use crate::mechanism::{Model, Quantity};

/// A pivot is `zᵀ M z` of a motion `z` in which one velocity is 1 and those before it are what leaves the least energy. If
/// every entry of `M` is off by a part `ε` of itself, the pivot is by up to `ε |z|ᵀ |M| |z|` (Higham, *Accuracy and Stability of
/// Numerical Algorithms*, 2002, § 10.1), however small it is beside the diagonal of `M`. Levers that cancel leave more of an entry than
/// that, a part of its row's diagonal. Pivots below this part of either, of the diagonal as often as there are velocities, are zero. Masses
/// may lie twelve powers of ten apart.
const TOLERANCE: f64 = 32.0 * f64::EPSILON;

/// Where all levers of a velocity cancel, its entry of the diagonal is the square of what rounding leaves of them: below this part of the
/// largest entry it is none.
const SQUARED_TOLERANCE: f64 = TOLERANCE * TOLERANCE;

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
    let whole = m.clone();
    let none = SQUARED_TOLERANCE * (0..n).map(|k| whole[k][k].abs()).fold(0.0, f64::max);
    let mut failing = Vec::new();
    let mut eliminated = Vec::new();
    for (step, &k) in order.iter().enumerate() {
        // Parameters at random may make an inertia that no body has: then a pivot is negative, and not zero all the same.
        let own = whole[k][k].abs();
        let lost = TOLERANCE * rounding(&whole, &m, &eliminated, k).max(n as f64 * own);
        if own <= none || m[k][k].abs() <= lost {
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

/// `|z|ᵀ |M| |z|` of the motion `z` whose velocity `k` is 1, with what elimination has left of `M`.
fn rounding(whole: &[Vec<f64>], left: &[Vec<f64>], eliminated: &[usize], k: usize) -> f64 {
    let mut z = vec![(k, 1.0)];
    for &i in eliminated.iter().rev() {
        let others: f64 = z.iter().map(|(j, value)| left[i][*j] * value).sum();
        z.push((i, -others / left[i][i]));
    }
    z.iter().flat_map(|(i, a)| z.iter().map(move |(j, b)| (a * whole[*i][*j] * b).abs())).sum()
}
