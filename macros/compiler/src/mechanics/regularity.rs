//! Whether the mass matrix can be inverted: a coordinate that moves no mass is a mistake in the model.

use super::crba::Matrix;
use super::kinematics::Joint;
use crate::expr::Symbol;
use crate::expr::eval::eval;
use crate::model::{Model, Quantity, random_configuration};

/// Pivots below this part of their diagonal entry's first value count as zero.
const TOLERANCE: f64 = 1e-11;

/// The entry of `v` at which the factorisation fails in every one of several random configurations.
pub fn singular_velocity(model: &Model<'_>, joints: &[Joint<'_>], mass: &Matrix<'_>) -> Option<usize> {
    let mut found = None;
    for seed in 0..3 {
        found = failing_pivot(model, joints, mass, seed);
        found?;
    }
    found
}

fn failing_pivot(model: &Model<'_>, joints: &[Joint<'_>], mass: &Matrix<'_>, seed: u64) -> Option<usize> {
    let n = model.nv();
    let q = random_configuration(model, seed);
    let entries: Vec<_> = mass.iter().flatten().copied().collect();
    let values = eval(&entries, &|s: Symbol| match Quantity::of(s) {
        Quantity::Configuration(k) => q[k],
        _ => crate::model::sample(s, seed),
    });
    let mut m: Vec<Vec<f64>> = values.chunks(n.max(1)).map(<[f64]>::to_vec).collect();
    // Root first: the first entry that fails is then the one that adds nothing to those before it; of several that
    // carry nothing at all, the innermost is named.
    let mut order: Vec<usize> = Vec::new();
    // Coordinates that place nothing come last.
    for index in joints.iter().flat_map(|j| j.dofs.iter().map(|d| d.index)).chain(0..n) {
        if !order.contains(&index) {
            order.push(index);
        }
    }
    let scale: Vec<f64> = (0..n).map(|k| m[k][k]).collect();
    for (step, &k) in order.iter().enumerate() {
        if m[k][k] <= TOLERANCE * scale[k] || scale[k] <= 0.0 {
            return Some(k);
        }
        for &i in &order[step + 1..] {
            let factor = m[i][k] / m[k][k];
            for &j in &order[step + 1..] {
                m[i][j] -= factor * m[k][j];
            }
        }
    }
    None
}
