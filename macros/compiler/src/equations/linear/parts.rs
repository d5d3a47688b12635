//! Construction of the symbols, rows and coefficients of linear equations.

use crate::algebra::polynomial::AtomRank;
use crate::expr::{Expr, Symbol};
use crate::mechanics::crba::Matrix;
use crate::mechanism::{Equilibrium, Model, Quantity};

/// Returns the symbol of a deviation: of the coordinate whose rate is velocity `k`; after these, of the
/// states.
pub fn deviation_symbol(k: usize) -> Quantity {
    Quantity::Deviation(k)
}

/// Returns the symbol of the multiplier of a constraint, at rest or as a deviation.
pub fn multiplier_symbol(k: usize) -> Quantity {
    Quantity::Force(k)
}

/// Symbol of the roots of the characteristic polynomial.
pub const ROOT: Quantity = Quantity::Laplace;

/// Coefficients of the linear equations, evaluated at the equilibrium.
pub struct EquilibriumCoefficients<'g> {
    /// Coefficients of the deviations, of their first and of their second derivatives, by row.
    pub orders: [Matrix<'g>; 3],
    /// Coefficients of the inputs, by row of the linear equations.
    pub inputs: Matrix<'g>,
    /// Coefficients of the constraint multipliers, by row of the linear equations.
    pub multipliers: Matrix<'g>,
}

/// Returns the expression behind each row of the linear equations: force balances, residuals or rates of the
/// constraints, and negative rates of the states.
pub fn expressions_to_linearise<'g>(
    model: &Model<'g>,
    balance: &[Expr<'g>],
    at: &Equilibrium<'g>,
) -> Vec<Expr<'g>> {
    let kept = model.constraints.iter().map(|c| c.residual.unwrap_or(c.rate));
    balance.iter().copied().chain(kept).chain(at.states.iter().map(|state| -state.rate)).collect()
}

/// Returns the rank of a symbol of the linear equations, which determines its position in a printed product.
pub fn rank_of_symbol(symbol: Symbol) -> AtomRank {
    match Quantity::from_symbol(symbol) {
        Quantity::Deviation(_) => AtomRank::Position,
        Quantity::Velocity(_) | Quantity::Laplace => AtomRank::Rate,
        Quantity::Acceleration(_) => AtomRank::Acceleration,
        Quantity::Input(_) | Quantity::Force(_) => AtomRank::Input,
        _ => AtomRank::Parameter,
    }
}
