//! Restrictions of motion: constraints, contacts, limits.

use super::{Expr, Name};
use crate::language::{Callable, OtherKind};

/// Kind of a constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintKind {
    /// Restricts configurations.
    Holonomic,
    /// Restricts velocities.
    Nonholonomic,
    /// Two surfaces in contact that do not slip.
    Rolling,
    /// Two surfaces in contact that slip with friction.
    Slipping,
}

impl ConstraintKind {
    /// Returns the function of a pair of surfaces; `None` for an equation.
    pub fn pair(self) -> Option<Callable> {
        match self {
            ConstraintKind::Rolling => Some(Callable::Rolls),
            ConstraintKind::Slipping => Some(Callable::Slips),
            ConstraintKind::Holonomic | ConstraintKind::Nonholonomic => None,
        }
    }

    /// Returns the row of the element in the table.
    pub fn element(self) -> OtherKind {
        match self {
            ConstraintKind::Holonomic => OtherKind::Holonomic,
            ConstraintKind::Nonholonomic => OtherKind::Nonholonomic,
            ConstraintKind::Rolling => OtherKind::Rolling,
            ConstraintKind::Slipping => OtherKind::Slipping,
        }
    }
}

/// Coulomb friction of slipping surfaces.
#[derive(Clone, Debug)]
pub struct SlipFriction {
    /// Coefficient of friction.
    pub coefficient: Expr,
    /// Speed at which friction is regularised; that of the mechanism if absent.
    pub speed: Option<Expr>,
}

/// An expression that remains zero, two that remain equal, or a pair of surfaces.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Name of the constraint.
    pub name: Name,
    /// Kind of the constraint.
    pub kind: ConstraintKind,
    /// Expression, a scalar or a vector, or `rolls(surface, surface)` or `slips(surface, surface)`.
    pub value: Expr,
    /// Right side of the equation; zero if absent.
    pub other: Option<Expr>,
    /// Friction of slipping surfaces.
    pub friction: Option<SlipFriction>,
}

/// Bounds of a coordinate.
#[derive(Clone, Debug)]
pub struct Limit {
    /// Name of the limit; that of the joint if it is from a file.
    pub name: Name,
    /// Joint, coordinate of a joint, declared coordinate, or expression.
    pub on: Expr,
    /// Lower bound.
    pub from: Option<Expr>,
    /// Upper bound.
    pub to: Option<Expr>,
    /// Maximum speed, in both directions.
    pub max_speed: Option<Expr>,
    /// Maximum force or torque, in both directions.
    pub max_effort: Option<Expr>,
    /// Coefficient of restitution; if present, the bounds are stops.
    pub restitution: Option<Restitution>,
}

/// A coefficient of restitution.
#[derive(Clone, Debug)]
pub struct Restitution {
    /// Value of the coefficient.
    pub value: Expr,
    /// Whether it is a ratio of impulses (Poisson) instead of velocities (Newton).
    pub of_impulses: bool,
}

/// Two surfaces that may separate, collide, slide and stick.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Name of the contact.
    pub name: Name,
    /// First surface.
    pub first: Expr,
    /// Second surface.
    pub second: Expr,
    /// Coefficient of friction; zero if absent.
    pub friction: Option<Expr>,
    /// Coefficient of static friction; that of sliding if absent.
    pub stiction: Option<Expr>,
    /// Maximum friction moment about the normal per unit normal force, m; zero if absent.
    pub torsional: Option<Expr>,
    /// Maximum friction moment about the tangents per unit normal force, m; zero if absent.
    pub rolling: Option<Expr>,
    /// Coefficient of restitution; zero if absent.
    pub restitution: Option<Restitution>,
    /// Stiffness and dissipation of compliant surfaces; rigid if absent.
    pub soft: Option<Compliance>,
    /// Whether the contact is from a file. Pairs that never separate are then omitted.
    pub of_file: bool,
}

/// Stiffness and dissipation of compliant surfaces.
#[derive(Clone, Debug)]
pub struct Compliance {
    /// Force per penetration, or per penetration to the power of 3/2.
    pub stiffness: Expr,
    /// Whether the power is 3/2, that of round bodies (Hertz).
    pub hertz: bool,
    /// Dissipation per speed of approach (Hunt and Crossley), s/m; zero if absent.
    pub dissipation: Option<Expr>,
    /// Slip speed below which friction is regularised, m/s.
    pub speed: Option<Expr>,
}
