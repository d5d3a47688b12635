//! Quantities that the symbols of expressions denote.

use crate::expr::{Expr, Graph, Symbol};

/// Quantity that a symbol denotes, with its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A parameter of the struct.
    Parameter(usize),
    /// An entry of `q`.
    Configuration(usize),
    /// An entry of `v`.
    Velocity(usize),
    /// An entry of `a`.
    Acceleration(usize),
    /// An entry of `tau`.
    Force(usize),
    /// An entry of `u`.
    Input(usize),
    /// Time.
    Time,
    /// An argument of a generated function: an entry of an intermediate result that the caller supplies.
    Given(usize),
    /// A generalized momentum, in Hamilton's and Routh's equations.
    Momentum(usize),
    /// The deviation of a coordinate, or of a state after these, in linear equations.
    Deviation(usize),
    /// The Laplace variable: a root of the characteristic polynomial of linear equations.
    Laplace,
    /// The stretch of a spring while its law is read.
    Stretch,
    /// A component of a displacement of the point at which a gradient is taken.
    Displacement(usize),
    /// The operand that decides between the pieces of a law while they are read, by their nesting.
    Deciding(usize),
    /// A value that is precomputed from the parameters.
    Prepared(usize),
    /// A component of a joint reaction: six for each joint, a force and then a torque. From
    /// [`Quantity::MULTIPLIERS`] on, the multiplier of a constraint.
    Reaction(usize),
    /// The passive force of a velocity, computed by a separate function.
    PassiveForce(usize),
    /// A derivative of passive forces, computed by a separate function, in the order of its results.
    PassiveDerivative(usize),
    /// A contact force, in the order of the contact velocities of all contacts.
    ContactForce(usize),
}

impl Quantity {
    const SHIFT: u32 = 20;

    /// First symbols of the blocks that are ordered with given values.
    const MOMENTA: usize = 1 << 18;
    const DEVIATIONS: usize = 1 << 19;
    const PLACEHOLDERS: usize = 3 << 18;
    const DECIDING: usize = Quantity::PLACEHOLDERS + 64;

    /// First index of multipliers among the reactions.
    pub const MULTIPLIERS: usize = 1 << 19;

    /// Returns the symbol of the quantity.
    pub fn symbol(self) -> Symbol {
        let (kind, index) = match self {
            Quantity::Parameter(k) => (0, k),
            Quantity::Configuration(k) => (1, k),
            Quantity::Velocity(k) => (2, k),
            Quantity::Acceleration(k) => (3, k),
            Quantity::Force(k) => (4, k),
            Quantity::Input(k) => (5, k),
            Quantity::Time => (6, 0),
            Quantity::Laplace => (6, 1),
            Quantity::Given(k) => (7, k),
            Quantity::Momentum(k) => (7, Quantity::MOMENTA + k),
            Quantity::Deviation(k) => (7, Quantity::DEVIATIONS + k),
            Quantity::Stretch => (7, Quantity::PLACEHOLDERS),
            Quantity::Displacement(k) => (7, Quantity::PLACEHOLDERS + 1 + k),
            Quantity::Deciding(k) => (7, Quantity::DECIDING + k),
            Quantity::Prepared(k) => (8, k),
            Quantity::Reaction(k) => (9, k),
            Quantity::PassiveForce(k) => (10, k),
            Quantity::PassiveDerivative(k) => (11, k),
            Quantity::ContactForce(k) => (12, k),
        };
        Symbol((kind << Quantity::SHIFT) | index as u32)
    }

    /// Returns the quantity that a symbol denotes.
    pub fn of(symbol: Symbol) -> Quantity {
        let index = (symbol.0 & ((1 << Quantity::SHIFT) - 1)) as usize;
        match symbol.0 >> Quantity::SHIFT {
            0 => Quantity::Parameter(index),
            1 => Quantity::Configuration(index),
            2 => Quantity::Velocity(index),
            3 => Quantity::Acceleration(index),
            4 => Quantity::Force(index),
            5 => Quantity::Input(index),
            6 if index == 0 => Quantity::Time,
            6 => Quantity::Laplace,
            7 if index >= Quantity::DECIDING => Quantity::Deciding(index - Quantity::DECIDING),
            7 if index > Quantity::PLACEHOLDERS => Quantity::Displacement(index - Quantity::PLACEHOLDERS - 1),
            7 if index == Quantity::PLACEHOLDERS => Quantity::Stretch,
            7 if index >= Quantity::DEVIATIONS => Quantity::Deviation(index - Quantity::DEVIATIONS),
            7 if index >= Quantity::MOMENTA => Quantity::Momentum(index - Quantity::MOMENTA),
            7 => Quantity::Given(index),
            8 => Quantity::Prepared(index),
            9 => Quantity::Reaction(index),
            10 => Quantity::PassiveForce(index),
            11 => Quantity::PassiveDerivative(index),
            _ => Quantity::ContactForce(index),
        }
    }

    /// Returns the quantity as an expression.
    pub fn expr(self, graph: &Graph) -> Expr<'_> {
        graph.symbol(self.symbol())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_denote_their_quantities() {
        let indexed: [fn(usize) -> Quantity; 15] = [
            Quantity::Parameter,
            Quantity::Configuration,
            Quantity::Velocity,
            Quantity::Acceleration,
            Quantity::Force,
            Quantity::Input,
            Quantity::Given,
            Quantity::Momentum,
            Quantity::Deviation,
            Quantity::Deciding,
            Quantity::Prepared,
            Quantity::Reaction,
            Quantity::PassiveForce,
            Quantity::PassiveDerivative,
            Quantity::ContactForce,
        ];
        let all = indexed.into_iter().flat_map(|quantity| [0, 1, 255, 65_535].map(quantity));
        let displacements = (0..3).map(Quantity::Displacement);
        let single = [Quantity::Time, Quantity::Laplace, Quantity::Stretch];
        for quantity in all.chain(displacements).chain(single) {
            assert_eq!(Quantity::of(quantity.symbol()), quantity);
        }
    }
}
