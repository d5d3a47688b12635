//! Rows of constraints that say nothing: spatial joints in a planar mechanism, loops that share a condition. Found in
//! random configurations and in some that fulfil the constraints, for random parameters, where only what holds
//! everywhere is seen.

use super::kinematics::velocity_gradient;
use super::mobility::Witness;
use super::{Model, Motion, Quantity, sample};
use crate::diag::Diagnostics;
use crate::expr::Symbol;
use crate::expr::eval::eval;

/// A row counts as a combination of others if so little of it is left.
const TOLERANCE: f64 = 1e-9;
/// Random configurations tried.
const SAMPLES: u64 = 3;

/// Reports rows that no velocity influences and that are not fulfilled.
pub fn check_constant(model: &Model<'_>, cx: &mut Diagnostics) {
    for (row, c) in model.constraints.iter().enumerate() {
        if let Some(gap) = constant_gap(model, row) {
            cx.error(c.place.clone(), format!("`{}` can never hold: it stays {gap} away from zero", c.name))
                .help("no configuration closes this loop: check the lengths and axes on its way");
        }
    }
}

/// Drops rows that follow from the others wherever the mechanism is.
pub fn prune(model: &mut Model<'_>, witnesses: &[Witness]) {
    let rows = model.constraints.len();
    let random = (0..SAMPLES).map(|seed| (random_configuration(model, seed), seed));
    let all = random.chain(witnesses.iter().cloned());
    let samples: Vec<Vec<Vec<f64>>> = all.map(|(q, seed)| jacobian(model, &q, seed)).collect();
    let mut bases: Vec<Basis> = samples.iter().map(|_| Basis::default()).collect();
    let mut kept: Vec<usize> = Vec::new();
    for row in 0..rows {
        // Where no configuration is known that fulfils the constraints, only rows without any influence go.
        let none = Basis::default();
        let depends = samples.iter().zip(&bases).all(|(j, basis)| {
            let others = if witnesses.is_empty() { &none } else { basis };
            others.explains(&j[row], TOLERANCE)
        });
        if !depends {
            kept.push(row);
            bases.iter_mut().zip(&samples).for_each(|(basis, j)| basis.add(&j[row], TOLERANCE));
        }
    }
    let all = std::mem::take(&mut model.constraints);
    for (row, constraint) in all.into_iter().enumerate() {
        match kept.contains(&row) {
            true => model.constraints.push(constraint),
            false => model.redundant.push(constraint.name),
        }
    }
}

/// How far a row without influence is from being fulfilled, if it is: the same everywhere.
fn constant_gap(model: &Model<'_>, row: usize) -> Option<f64> {
    let c = &model.constraints[row];
    if !velocity_gradient(c.rate).is_empty() {
        return None;
    }
    let value = |seed| {
        let q = random_configuration(model, seed);
        let e = c.residual.unwrap_or(c.rate);
        eval(&[e], &|s| value_of(s, &q, seed)).first().copied().unwrap_or(0.0)
    };
    let (first, second) = (value(0), value(1));
    let gone = |x: f64| x.abs() <= TOLERANCE;
    (!gone(first) && !gone(second)).then_some(first)
}

fn value_of(s: Symbol, q: &[f64], seed: u64) -> f64 {
    match Quantity::of(s) {
        Quantity::Configuration(k) => q[k],
        Quantity::Velocity(_) => 0.0,
        _ => sample(s, seed),
    }
}

/// Coefficients of the velocities in a configuration.
fn jacobian(model: &Model<'_>, q: &[f64], seed: u64) -> Vec<Vec<f64>> {
    let mut rows = Vec::new();
    for c in &model.constraints {
        let (indices, entries): (Vec<usize>, Vec<_>) = velocity_gradient(c.rate).into_iter().unzip();
        let mut row = vec![0.0; model.nv()];
        for (k, value) in indices.into_iter().zip(eval(&entries, &|s| value_of(s, q, seed))) {
            row[k] = value;
        }
        rows.push(row);
    }
    rows
}

/// Orthonormal combinations of rows.
#[derive(Default)]
pub struct Basis(Vec<Vec<f64>>);

impl Basis {
    /// How many rows are independent.
    pub fn rank(&self) -> usize {
        self.0.len()
    }

    /// Adds a row, unless it is a combination of those before up to a relative tolerance.
    pub fn add(&mut self, row: &[f64], tolerance: f64) {
        let rest = self.rest(row);
        let size = dot(&rest, &rest).sqrt();
        if size > tolerance * dot(row, row).sqrt().max(tolerance) {
            self.0.push(rest.iter().map(|x| x / size).collect());
        }
    }

    /// True for a row that is a combination of those before, or zero; a row that has no value is none.
    fn explains(&self, row: &[f64], tolerance: f64) -> bool {
        let rest = self.rest(row);
        dot(&rest, &rest).sqrt() <= tolerance * dot(row, row).sqrt().max(tolerance)
    }

    /// What is left of a row without its parts along those before.
    fn rest(&self, row: &[f64]) -> Vec<f64> {
        let mut rest = row.to_vec();
        // Twice, since the first time leaves the rounding of what it takes away.
        for b in self.0.iter().chain(&self.0) {
            let part = dot(&rest, b);
            rest.iter_mut().zip(b).for_each(|(x, b)| *x -= part * b);
        }
        rest
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Random coordinates with unit quaternions.
pub fn random_configuration(model: &Model<'_>, seed: u64) -> Vec<f64> {
    let mut q: Vec<f64> =
        (0..model.nq()).map(|k| 2.0 * sample(Quantity::Configuration(k).symbol(), seed) - 2.0).collect();
    for link in &model.links {
        let first = match link.motion {
            Motion::Ball { q, .. } => q,
            Motion::Free { q, .. } => q + 3,
            _ => continue,
        };
        let norm = q[first..first + 4].iter().map(|c| c * c).sum::<f64>().sqrt();
        for c in &mut q[first..first + 4] {
            *c /= norm;
        }
    }
    q
}
