//! Constraints as rows of numbers: residuals and Jacobian in a configuration.

use super::rates::velocity_gradients;
use crate::expr::eval::Tape;
use crate::expr::sample::sample;
use crate::expr::{Expr, Symbol};
use crate::mechanism::{Model, Quantity};

/// Constraints to be evaluated, in their order.
pub struct Rows<'g> {
    residuals: Tape<'g>,
    /// Entries of the Jacobian that are not zero: row, column.
    at: Vec<(usize, usize)>,
    entries: Tape<'g>,
    rates: Tape<'g>,
    /// Constraints, velocities.
    size: (usize, usize),
}

impl<'g> Rows<'g> {
    /// Of all constraints of a model.
    pub fn of(model: &Model<'g>) -> Rows<'g> {
        let rates: Vec<Expr<'g>> = model.constraints.iter().map(|c| c.rate).collect();
        let gradients = velocity_gradients(&rates).into_iter().enumerate();
        let (at, entries): (Vec<_>, Vec<_>) = gradients
            .flat_map(|(row, gradient)| {
                gradient.into_iter().map(move |(column, entry)| ((row, column), entry))
            })
            .unzip();
        let residuals: Vec<Expr<'g>> = model.constraints.iter().filter_map(|c| c.residual).collect();
        Rows {
            residuals: Tape::of(&residuals),
            at,
            entries: Tape::of(&entries),
            rates: Tape::of(&rates),
            size: (model.constraints.len(), model.nv()),
        }
    }

    /// Operations of an evaluation of residuals and Jacobian and of solving a system with them, roughly.
    pub fn cost(&self) -> u64 {
        let (rows, columns) = (self.size.0 as u64, self.size.1 as u64);
        2 * self.residuals.steps() as u64
            + self.entries.steps() as u64
            + rows * rows * (rows / 3 + columns / 2)
    }

    /// True for a row that no velocity influences.
    pub fn is_constant(&self, row: usize) -> bool {
        self.at.iter().all(|(r, _)| *r != row)
    }

    /// What is left of those constraints that have residuals: the first ones.
    pub fn residuals(&self, q: &[f64], seed: u64) -> Vec<f64> {
        self.residuals.values(&|s| value_of(s, q, seed))
    }

    /// Coefficients of the velocities in a configuration, parameters sampled by `seed`.
    pub fn jacobian(&self, q: &[f64], seed: u64) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; self.size.1]; self.size.0];
        let values = self.entries.values(&|s| value_of(s, q, seed));
        for ((row, column), value) in self.at.iter().zip(values) {
            rows[*row][*column] = value;
        }
        rows
    }

    /// Whether some constraint does not hold in a configuration at rest, beyond rounding: its rate has a term without
    /// velocities.
    pub fn has_drift(&self, q: &[f64], seed: u64) -> bool {
        self.rates.rounded(&|s| value_of(s, q, seed)).iter().any(|rate| !rate.may_be_zero())
    }

    /// By row, whether all of its coefficients in a configuration may be what rounding has left of zero.
    pub fn may_be_zero(&self, q: &[f64], seed: u64) -> Vec<bool> {
        let mut may_be = vec![true; self.size.0];
        let entries = self.entries.rounded(&|s| value_of(s, q, seed));
        for ((row, _), entry) in self.at.iter().zip(entries) {
            may_be[*row] &= entry.may_be_zero();
        }
        may_be
    }
}

/// The value of a symbol at rest, parameters sampled by `seed`.
pub fn value_of(s: Symbol, q: &[f64], seed: u64) -> f64 {
    match Quantity::of(s) {
        Quantity::Configuration(k) => q[k],
        Quantity::Velocity(_) => 0.0,
        _ => sample(s, seed),
    }
}

/// Random coordinates with unit quaternions.
pub fn random_configuration(model: &Model<'_>, seed: u64) -> Vec<f64> {
    let mut q: Vec<f64> =
        (0..model.nq()).map(|k| 2.0 * sample(Quantity::Configuration(k).symbol(), seed) - 2.0).collect();
    for first in model.links.iter().filter_map(|link| link.motion.quaternion()) {
        let norm = q[first.and_next(4)].iter().map(|c| c * c).sum::<f64>().sqrt();
        for c in &mut q[first.and_next(4)] {
            *c /= norm;
        }
    }
    q
}
