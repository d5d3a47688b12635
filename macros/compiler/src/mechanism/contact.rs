//! Unilateral contacts of a mechanism, as data of the model.

use crate::expr::Expr;

/// Unilateral contact of two surfaces, or of a coordinate with its stop: separation, impact, sliding and
/// sticking.
#[derive(Clone, Debug)]
pub struct Contact<'g> {
    /// Name of the contact, with the index of the point if a pair of surfaces has several points.
    pub name: String,
    /// Gap function, an expression of configuration and time: negative if the surfaces penetrate.
    pub gap: Expr<'g>,
    /// True if the gap is an angle, as for the stop of a pin.
    pub turns: bool,
    /// Index of the contact that supplies the normal force, if this entry is a friction moment of that
    /// contact. A friction moment has the gap of that contact, and only angular velocities.
    pub pressed_by: Option<usize>,
    /// Contact velocities, linear in the velocities: the normal (gap) velocity, followed by slip velocities
    /// along one or two tangents if there is friction.
    pub rates: Vec<Expr<'g>>,
    /// Coefficient of friction; for a friction moment, the maximum moment per unit of normal force.
    pub friction: Expr<'g>,
    /// Coefficient of friction at rest; that of sliding unless `stiction` is given.
    pub stiction: Expr<'g>,
    /// Coefficient of restitution of the contact.
    pub restitution: Expr<'g>,
    /// True if the coefficient of restitution is a ratio of impulses (Poisson), false if it is a ratio of
    /// velocities (Newton).
    pub of_impulses: bool,
}
