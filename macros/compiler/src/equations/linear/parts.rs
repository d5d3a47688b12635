//! What all parts of linear equations go by: which symbols stand for what, their rows, and their coefficients.

use crate::algebra::polynomial::Rank;
use crate::expr::{Expr, Symbol};
use crate::mechanics::crba::Matrix;
use crate::mechanism::{Equilibrium, Model, Quantity};

/// The deviation of what a velocity is the rate of; after those of all velocities those of states.
pub fn deviation(k: usize) -> Quantity {
    Quantity::Given(k)
}

/// The multiplier of a constraint, at rest or its deviation.
pub fn multiplier(k: usize) -> Quantity {
    Quantity::Force(k)
}

/// What the roots of the characteristic polynomial are called.
pub const ROOT: Quantity = Quantity::Time;

/// Coefficients of the linear equations, at rest.
pub struct Coefficients<'g> {
    /// By row: of the deviations, of their rates, and of the rates of these.
    pub orders: [Matrix<'g>; 3],
    /// By row, of the inputs.
    pub inputs: Matrix<'g>,
    /// By row, of the multipliers.
    pub multipliers: Matrix<'g>,
}

/// By row of the linear equations, what is zero or balanced in every motion.
pub fn rows<'g>(model: &Model<'g>, balance: &[Expr<'g>], at: &Equilibrium<'g>) -> Vec<Expr<'g>> {
    let kept = model.constraints.iter().map(|c| c.residual.unwrap_or(c.rate));
    balance.iter().copied().chain(kept).chain(at.states.iter().map(|state| -state.rate)).collect()
}

/// Where the symbols of linear equations stand in a product.
pub fn rank(symbol: Symbol) -> Rank {
    match Quantity::of(symbol) {
        Quantity::Given(_) => Rank::Position,
        Quantity::Velocity(_) | Quantity::Time => Rank::Rate,
        Quantity::Acceleration(_) => Rank::Acceleration,
        Quantity::Input(_) | Quantity::Force(_) => Rank::Input,
        _ => Rank::Parameter,
    }
}
