//! Contacts that open and close.

use crate::expr::Expr;

/// Two surfaces, or a coordinate and its stop, that may part, strike, slide and stick.
#[derive(Clone, Debug)]
pub struct Contact<'g> {
    /// Its name; of several points of one pair with the number of the point.
    pub name: String,
    /// The distance, an expression of configuration and time: negative where the surfaces overlap.
    pub gap: Expr<'g>,
    /// The gap is an angle.
    pub turns: bool,
    /// The contact whose normal force presses, where this is one of its moments of friction: it has the gap of that contact, and rates
    /// of turning alone.
    pub pressed_by: Option<usize>,
    /// The rate of the gap, then those of the slip along one or two tangents if there is friction; linear in the velocities.
    pub rates: Vec<Expr<'g>>,
    /// Coefficient of friction; of a moment of friction the largest by the normal force.
    pub friction: Expr<'g>,
    /// Coefficient of restitution.
    pub restitution: Expr<'g>,
    /// It is a ratio of impulses (Poisson), not of velocities (Newton).
    pub of_impulses: bool,
}
