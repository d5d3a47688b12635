//! Passive forces that a function of their own computes: all others take them, and their derivatives, as given values. What many
//! springs do would else stand in every function once more.

use super::quantity::Quantity;
use crate::expr::{Expr, Symbol};

/// What the functions for the passive forces and for their derivatives compute.
#[derive(Clone, Debug)]
pub struct PassiveForces<'g> {
    /// By velocity.
    pub forces: Vec<Expr<'g>>,
    /// The derivatives that are not constant, in the order in which they are given.
    pub derivatives: Vec<Expr<'g>>,
    /// All derivatives, constant ones too: those by configuration, then those by velocity; in each, for the velocity of every
    /// direction, one for every force.
    given: [Vec<Vec<Expr<'g>>>; 2],
}

impl<'g> PassiveForces<'g> {
    /// Of the forces and their derivatives by configuration and by velocity: a row for each force, or none if there are to be
    /// no derivatives.
    pub fn new(forces: Vec<Expr<'g>>, by_q: &[Vec<Expr<'g>>], by_v: &[Vec<Expr<'g>>]) -> PassiveForces<'g> {
        let mut derivatives = Vec::new();
        let mut name = |e: Expr<'g>| match e.value() {
            Some(_) => e,
            None => {
                derivatives.push(e);
                Quantity::PassiveDerivative(derivatives.len() - 1).expr(e.graph())
            }
        };
        let mut columns = |rows: &[Vec<Expr<'g>>]| {
            let count = rows.first().map_or(0, Vec::len);
            (0..count).map(|k| rows.iter().map(|row| name(row[k])).collect()).collect()
        };
        let given = [columns(by_q), columns(by_v)];
        PassiveForces { forces, derivatives, given }
    }

    /// The forces as other functions take them.
    pub fn given_forces(&self) -> Vec<Expr<'g>> {
        let given = |(k, e): (usize, &Expr<'g>)| match e.value() {
            Some(_) => *e,
            None => Quantity::PassiveForce(k).expr(e.graph()),
        };
        self.forces.iter().enumerate().map(given).collect()
    }

    /// How the given forces change with the configuration along the direction of this velocity.
    pub fn changes_by_configuration(&self, velocity: usize) -> impl Iterator<Item = (Symbol, Expr<'g>)> {
        self.changes(0, velocity)
    }

    /// How the given forces change with this velocity.
    pub fn changes_by_velocity(&self, velocity: usize) -> impl Iterator<Item = (Symbol, Expr<'g>)> {
        self.changes(1, velocity)
    }

    fn changes(&self, by: usize, velocity: usize) -> impl Iterator<Item = (Symbol, Expr<'g>)> {
        let column = self.given[by].get(velocity).into_iter().flatten().enumerate();
        column.filter(|(_, e)| !e.is_zero()).map(|(k, e)| (Quantity::PassiveForce(k).symbol(), *e))
    }
}
