//! Quantities that the symbols of expressions denote.

use crate::expr::{Expr, Graph, Symbol};

/// Quantity that a symbol denotes, with its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Parameter of the struct, by its index.
    Parameter(usize),
    /// Entry of the configuration `q`.
    Configuration(usize),
    /// Entry of the velocity `v`.
    Velocity(usize),
    /// Entry of the acceleration `a`.
    Acceleration(usize),
    /// Entry of the generalized force `tau`.
    Force(usize),
    /// Entry of the input `u`.
    Input(usize),
    /// The time, s.
    Time,
    /// An entry of an argument of a generated function: an intermediate result that the caller supplies.
    Given(SuppliedQuantity, usize),
    /// Generalized momentum, in Hamilton's and Routh's equations.
    Momentum(usize),
    /// The deviation of a coordinate, or of a state after these, in linear equations.
    Deviation(usize),
    /// The Laplace variable: a root of the characteristic polynomial of linear equations.
    Laplace,
    /// The stretch of a spring while its law is read.
    Stretch,
    /// A component of a displacement of the point at which a gradient is taken.
    Displacement(usize),
    /// Operand that decides between the pieces of a law while its source is parsed, numbered by nesting
    /// depth.
    Deciding(usize),
    /// Value of a prepared mechanism that is precomputed from the parameters.
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
    /// A feature of polytopes in contact, computed by a separate function, in the order of its results.
    ContactFeature(usize),
}

/// Intermediate results that callers of generated functions supply as arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SuppliedQuantity {
    /// Applied forces minus bias forces, one entry for each velocity.
    Force,
    /// Bias terms of the constraint accelerations, `J̇ v + …`.
    Bias,
    /// Signs of the normal forces between slipping surfaces.
    Side,
    /// Lagrange multipliers of the constraints.
    Multiplier,
    /// Factors of forces or results of which a function returns derivatives.
    Factor,
    /// Factors of the transposed constraint Jacobian, one for each velocity.
    Direction,
    /// Factors that contract the constraint accelerations in second derivatives.
    AccelerationFactor,
    /// Factors that contract the constraint velocities in second derivatives.
    VelocityFactor,
    /// Standard inertial parameters of all bodies.
    Inertia,
    /// Motion of the link before a frame or a link: placement, twist and acceleration, as far as known.
    Parent,
    /// Position of a frame's origin in ground axes, m.
    Origin,
    /// Position at which the height of a terrain is evaluated.
    Position,
    /// A configuration or a velocity of a function that is not computed by a program.
    State,
    /// Factors of the results in the derivatives of a function along them.
    ResultFactor,
    /// Forces of all contacts; their entries are [`Quantity::ContactForce`].
    ContactForces,
}

impl SuppliedQuantity {
    /// All kinds of values whose symbols are ordered with those of momenta.
    const ALL: [SuppliedQuantity; SuppliedQuantity::ResultFactor as usize] = {
        use SuppliedQuantity::*;
        [
            Force,
            Bias,
            Side,
            Multiplier,
            Factor,
            Direction,
            AccelerationFactor,
            VelocityFactor,
            Inertia,
            Parent,
            Origin,
            Position,
            State,
        ]
    };
}

impl Quantity {
    const SHIFT: u32 = 20;

    /// Number of symbols reserved for each kind of supplied values.
    const GIVEN: usize = 1 << 14;

    /// First symbols of the blocks that are ordered with given values.
    const MOMENTA: usize = 1 << 18;
    const DEVIATIONS: usize = 1 << 19;
    const PLACEHOLDERS: usize = 3 << 18;
    const DECIDING: usize = Quantity::PLACEHOLDERS + 64;

    /// First symbol index of multipliers among the reaction symbols.
    pub const MULTIPLIERS: usize = 1 << 19;

    /// Returns the symbol that denotes this quantity.
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
            Quantity::Given(SuppliedQuantity::ResultFactor, k) => (13, k),
            Quantity::ContactFeature(k) => (14, k),
            Quantity::ContactForce(k) | Quantity::Given(SuppliedQuantity::ContactForces, k) => (12, k),
            Quantity::Given(block, k) => (7, block as usize * Quantity::GIVEN + k),
            Quantity::Momentum(k) => (7, Quantity::MOMENTA + k),
            Quantity::Deviation(k) => (7, Quantity::DEVIATIONS + k),
            Quantity::Stretch => (7, Quantity::PLACEHOLDERS),
            Quantity::Displacement(k) => (7, Quantity::PLACEHOLDERS + 1 + k),
            Quantity::Deciding(k) => (7, Quantity::DECIDING + k),
            Quantity::Prepared(k) => (8, k),
            Quantity::Reaction(k) => (9, k),
            Quantity::PassiveForce(k) => (10, k),
            Quantity::PassiveDerivative(k) => (11, k),
        };
        Symbol((kind << Quantity::SHIFT) | index as u32)
    }

    /// Returns the quantity that a symbol denotes.
    pub fn from_symbol(symbol: Symbol) -> Quantity {
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
            7 => {
                let block = SuppliedQuantity::ALL.get(index / Quantity::GIVEN).copied();
                Quantity::Given(block.unwrap_or(SuppliedQuantity::State), index % Quantity::GIVEN)
            }
            8 => Quantity::Prepared(index),
            9 => Quantity::Reaction(index),
            10 => Quantity::PassiveForce(index),
            11 => Quantity::PassiveDerivative(index),
            12 => Quantity::ContactForce(index),
            14 => Quantity::ContactFeature(index),
            _ => Quantity::Given(SuppliedQuantity::ResultFactor, index),
        }
    }

    /// Returns the symbol of this quantity as an expression.
    pub fn expr(self, graph: &Graph) -> Expr<'_> {
        graph.symbol(self.symbol())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_convert_to_their_quantities() {
        let indexed: [fn(usize) -> Quantity; 15] = [
            Quantity::Parameter,
            Quantity::Configuration,
            Quantity::Velocity,
            Quantity::Acceleration,
            Quantity::Force,
            Quantity::Input,
            Quantity::Momentum,
            Quantity::Deviation,
            Quantity::Deciding,
            Quantity::Prepared,
            Quantity::Reaction,
            Quantity::PassiveForce,
            Quantity::PassiveDerivative,
            Quantity::ContactForce,
            Quantity::ContactFeature,
        ];
        let all = indexed.into_iter().flat_map(|quantity| [0, 1, 255, 65_535].map(quantity));
        let given = SuppliedQuantity::ALL
            .into_iter()
            .flat_map(|block| [0, 1, 16_383].map(|k| Quantity::Given(block, k)));
        let factors = [0, 1, 65_535].map(|k| Quantity::Given(SuppliedQuantity::ResultFactor, k));
        let displacements = (0..3).map(Quantity::Displacement);
        let single = [Quantity::Time, Quantity::Laplace, Quantity::Stretch];
        for quantity in all.chain(given).chain(factors).chain(displacements).chain(single) {
            assert_eq!(Quantity::from_symbol(quantity.symbol()), quantity);
        }
    }
}
