//! Numerical rows of constraints: residuals and Jacobian at a configuration.

use super::rates::velocity_gradients;
use crate::expr::eval::Tape;
use crate::expr::sample::sample_of_symbol;
use crate::expr::{Expr, Symbol};
use crate::mechanism::{Model, Quantity};

/// Constraints compiled for numerical evaluation, in the order of the model.
pub struct CompiledConstraintRows<'g> {
    residuals: Tape<'g>,
    /// Row and column of each nonzero entry of the Jacobian.
    at: Vec<(usize, usize)>,
    entries: Tape<'g>,
    rates: Tape<'g>,
    /// Number of constraints, and number of velocities of the model.
    size: (usize, usize),
}

impl<'g> CompiledConstraintRows<'g> {
    /// Compiles the residuals and Jacobians of all constraints of a model.
    pub fn new(model: &Model<'g>) -> CompiledConstraintRows<'g> {
        let rates: Vec<Expr<'g>> = model.constraints.iter().map(|c| c.rate).collect();
        let gradients = velocity_gradients(&rates).into_iter().enumerate();
        let (at, entries): (Vec<_>, Vec<_>) = gradients
            .flat_map(|(row, gradient)| {
                gradient.into_iter().map(move |(column, entry)| ((row, column), entry))
            })
            .unzip();
        let residuals: Vec<Expr<'g>> = model.constraints.iter().filter_map(|c| c.residual).collect();
        CompiledConstraintRows {
            residuals: Tape::new(&residuals),
            at,
            entries: Tape::new(&entries),
            rates: Tape::new(&rates),
            size: (model.constraints.len(), model.nv()),
        }
    }

    /// Returns the approximate number of operations for evaluating residuals and Jacobian and solving a
    /// linear system with them.
    pub fn evaluation_cost(&self) -> u64 {
        let (rows, columns) = (self.size.0 as u64, self.size.1 as u64);
        2 * self.residuals.node_count() as u64
            + self.entries.node_count() as u64
            + rows * rows * (rows / 3 + columns / 2)
    }

    /// Returns true for a constraint row that no velocity influences.
    pub fn is_velocity_independent(&self, row: usize) -> bool {
        self.at.iter().all(|(r, _)| *r != row)
    }

    /// Returns the residuals of the holonomic constraints, which come first.
    pub fn residuals(&self, q: &[f64], seed: u64) -> Vec<f64> {
        self.residuals.evaluate_at(&|s| symbol_value_at_rest(s, q, seed))
    }

    /// Returns the coefficients of the velocities at a configuration, with parameters sampled by `seed`.
    pub fn jacobian(&self, q: &[f64], seed: u64) -> Vec<Vec<f64>> {
        let mut rows = vec![vec![0.0; self.size.1]; self.size.0];
        let values = self.entries.evaluate_at(&|s| symbol_value_at_rest(s, q, seed));
        for ((row, column), value) in self.at.iter().zip(values) {
            rows[*row][*column] = value;
        }
        rows
    }

    /// Returns true if some constraint is violated at zero velocities beyond rounding: its rate has a
    /// velocity-free term.
    pub fn is_violated_at_zero_velocity(&self, q: &[f64], seed: u64) -> bool {
        self.rates
            .evaluate_with_rounding(&|s| symbol_value_at_rest(s, q, seed))
            .iter()
            .any(|rate| !rate.may_be_zero())
    }

    /// Returns for each row whether all of its coefficients at a configuration are zero up to rounding
    /// errors.
    pub fn numerically_zero_row_flags(&self, q: &[f64], seed: u64) -> Vec<bool> {
        let mut may_be = vec![true; self.size.0];
        let entries = self.entries.evaluate_with_rounding(&|s| symbol_value_at_rest(s, q, seed));
        for ((row, _), entry) in self.at.iter().zip(entries) {
            may_be[*row] &= entry.may_be_zero();
        }
        may_be
    }
}

/// Returns the value of a symbol at zero velocities, with parameters sampled by `seed`.
pub fn symbol_value_at_rest(s: Symbol, q: &[f64], seed: u64) -> f64 {
    match Quantity::from_symbol(s) {
        Quantity::Configuration(k) => q[k],
        Quantity::Velocity(_) => 0.0,
        _ => sample_of_symbol(s, seed),
    }
}

/// Returns a random configuration with unit quaternions.
pub fn random_configuration(model: &Model<'_>, seed: u64) -> Vec<f64> {
    let mut q: Vec<f64> = (0..model.nq())
        .map(|k| 2.0 * sample_of_symbol(Quantity::Configuration(k).symbol(), seed) - 2.0)
        .collect();
    for first in model.links.iter().filter_map(|link| link.motion.first_quaternion_index()) {
        let norm = q[first.range_of_entries(4)].iter().map(|c| c * c).sum::<f64>().sqrt();
        for c in &mut q[first.range_of_entries(4)] {
            *c /= norm;
        }
    }
    q
}
