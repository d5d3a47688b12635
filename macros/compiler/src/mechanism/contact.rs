//! Unilateral contacts.

use crate::expr::Expr;

/// Unilateral contact of two surfaces, or of a coordinate with its stop: separation, impact, sliding and
/// sticking.
#[derive(Clone, Debug)]
pub struct Contact<'g> {
    /// Name; for one of several points of a pair of surfaces, with the index of the point.
    pub name: String,
    /// Gap function, an expression of configuration and time: negative if the surfaces penetrate.
    pub gap: Expr<'g>,
    /// True if the gap is an angle.
    pub turns: bool,
    /// Index of the contact that supplies the normal force, if this contact is one of its friction moments. A
    /// friction moment has the gap of that contact, and only angular velocities as rates.
    pub pressed_by: Option<usize>,
    /// Normal (gap) velocity, then slip velocities along one or two tangents if there is friction; linear in
    /// the velocities.
    pub rates: Vec<Expr<'g>>,
    /// Coefficient of friction; for a friction moment, the maximum moment per unit of normal force.
    pub friction: Expr<'g>,
    /// Coefficient of friction at rest; that of sliding unless `stiction` is given.
    pub stiction: Expr<'g>,
    /// Coefficient of restitution.
    pub restitution: Expr<'g>,
    /// True for a restitution coefficient of impulses (Poisson), false for one of velocities (Newton).
    pub of_impulses: bool,
}
