//! Equilibrium configurations that the user declares.

use crate::diag::Place;
use crate::expr::Expr;

/// Help for an equilibrium that requires linearisation of dry friction.
pub const DRY_FRICTION: &str = "at rest it balances every smaller force: use a `Dashpot` for damping, or \
                                declare the equilibrium in a mechanism without friction";

/// An equilibrium configuration with all values that belong to it: expressions of the parameters.
#[derive(Clone, Debug)]
pub struct Equilibrium<'g> {
    /// Name of the declared equilibrium.
    pub name: String,
    /// Source position of the equilibrium's name.
    pub place: Place,
    /// Values of all entries of `q` at the equilibrium.
    pub configuration: Vec<Expr<'g>>,
    /// Values of all entries of `u` at the equilibrium.
    pub inputs: Vec<Expr<'g>>,
    /// Values of the first-order states at the equilibrium.
    pub states: Vec<FirstOrderStateAtEquilibrium<'g>>,
}

/// Value of a first-order state at an equilibrium.
#[derive(Clone, Debug)]
pub struct FirstOrderStateAtEquilibrium<'g> {
    /// Index of the first-order state among the parameters.
    pub parameter: usize,
    /// Value of the state at the equilibrium.
    pub value: Expr<'g>,
    /// Time derivative of the first-order state in any state of the mechanism.
    pub rate: Expr<'g>,
}
