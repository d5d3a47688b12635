//! What restricts motion: constraints, contacts, limits.

use super::{Expr, Name};
use crate::language::{Callable, OtherKind};

/// What a constraint restricts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintKind {
    /// Configurations.
    Holonomic,
    /// Velocities.
    Nonholonomic,
    /// Two surfaces that touch and do not slip.
    Rolling,
    /// Two surfaces that touch and slip with friction.
    Slipping,
}

impl ConstraintKind {
    /// Returns the word of a pair of surfaces; `None` for an equation.
    pub fn pair(self) -> Option<Callable> {
        match self {
            ConstraintKind::Rolling => Some(Callable::Rolls),
            ConstraintKind::Slipping => Some(Callable::Slips),
            ConstraintKind::Holonomic | ConstraintKind::Nonholonomic => None,
        }
    }

    /// Returns the row of the element.
    pub fn element(self) -> OtherKind {
        match self {
            ConstraintKind::Holonomic => OtherKind::Holonomic,
            ConstraintKind::Nonholonomic => OtherKind::Nonholonomic,
            ConstraintKind::Rolling => OtherKind::Rolling,
            ConstraintKind::Slipping => OtherKind::Slipping,
        }
    }
}

/// Coulomb's friction of surfaces that slip.
#[derive(Clone, Debug)]
pub struct SlipFriction {
    /// Coefficient of friction.
    pub coefficient: Expr,
    /// Speed around which it is smooth; the mechanism's if absent.
    pub speed: Option<Expr>,
}

/// An expression that stays zero, or two that stay equal; or a pair of surfaces.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Its name.
    pub name: Name,
    /// What it restricts.
    pub kind: ConstraintKind,
    /// The expression, a scalar or a vector, or `rolls(surface, surface)` or `slips(surface, surface)`.
    pub value: Expr,
    /// What it stays equal to; zero if absent.
    pub other: Option<Expr>,
    /// Friction of surfaces that slip.
    pub friction: Option<SlipFriction>,
}

/// Bounds of a coordinate.
#[derive(Clone, Debug)]
pub struct Limit {
    /// Its name; that of the joint if it comes from a file.
    pub name: Name,
    /// The joint, or the coordinate of a joint, or a coordinate of its own.
    pub on: Expr,
    /// Least value.
    pub from: Option<Expr>,
    /// Largest value.
    pub to: Option<Expr>,
    /// Largest rate, in both directions.
    pub max_speed: Option<Expr>,
    /// Largest force or torque, in both directions.
    pub max_effort: Option<Expr>,
    /// How much of its speed a coordinate keeps that strikes a bound, which is a stop then.
    pub restitution: Option<Restitution>,
}

/// A coefficient of restitution.
#[derive(Clone, Debug)]
pub struct Restitution {
    /// Its value.
    pub value: Expr,
    /// It is a ratio of impulses (Poisson), not of velocities (Newton).
    pub of_impulses: bool,
}

/// Two surfaces that may part, strike, slide and stick.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Its name.
    pub name: Name,
    /// One surface.
    pub first: Expr,
    /// The other.
    pub second: Expr,
    /// Coefficient of friction; none if absent.
    pub friction: Option<Expr>,
    /// Coefficient of friction at rest; that of sliding if absent.
    pub stiction: Option<Expr>,
    /// Largest moment of friction about the normal, by the normal force; none if absent.
    pub torsional: Option<Expr>,
    /// Largest moment of friction about the tangents, by the normal force; none if absent.
    pub rolling: Option<Expr>,
    /// Coefficient of restitution; zero if absent.
    pub restitution: Option<Restitution>,
    /// The surfaces yield instead of being rigid.
    pub soft: Option<Softness>,
    /// A file says it: what never parts is left out.
    pub of_file: bool,
}

/// How surfaces yield.
#[derive(Clone, Debug)]
pub struct Softness {
    /// Force by overlap, or by its power of 3/2.
    pub stiffness: Expr,
    /// The power is that of bodies with round surfaces (Hertz).
    pub hertz: bool,
    /// Dissipation by speed of approach (Hunt and Crossley); none if absent.
    pub dissipation: Option<Expr>,
    /// Speed of slip below which friction falls off.
    pub speed: Option<Expr>,
}
