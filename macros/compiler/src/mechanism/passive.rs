//! Passive forces that a separate generated function computes. The other functions take these forces and
//! their derivatives as arguments; otherwise each of them would repeat the expressions of many springs.

use super::quantity::Quantity;
use crate::expr::{Expr, Symbol};

/// Outputs of the functions for the passive forces and for their derivatives.
#[derive(Clone, Debug)]
pub struct PassiveForces<'g> {
    /// Passive force along each velocity, as expressions.
    pub forces: Vec<Expr<'g>>,
    /// Derivatives that are not constant, in the order of the function's results.
    pub derivatives: Vec<Expr<'g>>,
    /// All derivatives, including constant ones: those with respect to the configuration, then those with
    /// respect to the velocity. The outer index is the velocity of the direction, the inner index the force.
    given: [Vec<Vec<Expr<'g>>>; 2],
}

impl<'g> PassiveForces<'g> {
    /// Returns the passive forces with their derivatives with respect to configuration and velocity: a row
    /// for each force, or no rows to leave out derivatives.
    pub fn new(forces: Vec<Expr<'g>>, by_q: &[Vec<Expr<'g>>], by_v: &[Vec<Expr<'g>>]) -> PassiveForces<'g> {
        let mut derivatives = Vec::new();
        let mut replace_derivative_by_symbol = |e: Expr<'g>| match e.constant_value() {
            Some(_) => e,
            None => {
                derivatives.push(e);
                Quantity::PassiveDerivative(derivatives.len() - 1).expr(e.graph())
            }
        };
        let mut columns_with_derivative_symbols = |rows: &[Vec<Expr<'g>>]| {
            let count = rows.first().map_or(0, Vec::len);
            (0..count)
                .map(|k| rows.iter().map(|row| replace_derivative_by_symbol(row[k])).collect())
                .collect()
        };
        let given = [columns_with_derivative_symbols(by_q), columns_with_derivative_symbols(by_v)];
        PassiveForces { forces, derivatives, given }
    }

    /// Returns the forces as symbols for the other functions; constant forces as constants.
    pub fn forces_as_arguments(&self) -> Vec<Expr<'g>> {
        let constant_or_force_symbol = |(k, e): (usize, &Expr<'g>)| match e.constant_value() {
            Some(_) => *e,
            None => Quantity::PassiveForce(k).expr(e.graph()),
        };
        self.forces.iter().enumerate().map(constant_or_force_symbol).collect()
    }

    /// Returns the derivatives of the force symbols with respect to the configuration along the direction of
    /// a velocity.
    pub fn force_symbol_position_derivatives(
        &self,
        velocity: usize,
    ) -> impl Iterator<Item = (Symbol, Expr<'g>)> {
        self.passive_force_derivatives(0, velocity)
    }

    /// Returns the derivatives of the force symbols with respect to a velocity.
    pub fn velocity_derivatives_of_forces(
        &self,
        velocity: usize,
    ) -> impl Iterator<Item = (Symbol, Expr<'g>)> {
        self.passive_force_derivatives(1, velocity)
    }

    fn passive_force_derivatives(
        &self,
        by: usize,
        velocity: usize,
    ) -> impl Iterator<Item = (Symbol, Expr<'g>)> {
        let column = self.given[by].get(velocity).into_iter().flatten().enumerate();
        column.filter(|(_, e)| !e.is_zero()).map(|(k, e)| (Quantity::PassiveForce(k).symbol(), *e))
    }
}
