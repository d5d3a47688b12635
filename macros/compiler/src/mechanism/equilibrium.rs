//! Configurations at rest that a user declares.

use crate::diag::Place;
use crate::expr::Expr;

/// What to do where dry friction is to be linear.
pub const DRY_FRICTION: &str = "at rest it holds whatever is too weak to overcome it: write a `Dashpot` for damping, or declare the equilibrium in a mechanism without friction";

/// A configuration at rest, with all values that belong to it: expressions of the parameters.
#[derive(Clone, Debug)]
pub struct Equilibrium<'g> {
    /// Its name.
    pub name: String,
    /// Where that stands.
    pub place: Place,
    /// Every entry of `q`.
    pub configuration: Vec<Expr<'g>>,
    /// Every entry of `u`.
    pub inputs: Vec<Expr<'g>>,
    /// The states of first order.
    pub states: Vec<RestingState<'g>>,
}

/// A state of first order that does not change.
#[derive(Clone, Debug)]
pub struct RestingState<'g> {
    /// Its number among the parameters.
    pub parameter: usize,
    /// Its value.
    pub value: Expr<'g>,
    /// Its rate in any state of the mechanism.
    pub rate: Expr<'g>,
}
