//! Declared constraints, contacts and limits.

use super::{Expr, ExprKind, Name, WrittenArguments};
use crate::language::{Callable, Key, OtherKind};

/// Kind of a declared constraint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ConstraintKind {
    /// Constraint on the configuration.
    Holonomic,
    /// Constraint on the velocity.
    Nonholonomic,
    /// Rolling of two surfaces in contact without slip.
    Rolling,
    /// Slipping of two surfaces in contact with friction.
    Slipping,
}

impl ConstraintKind {
    /// Returns the function of a pair of surfaces; `None` for an equation.
    pub fn surface_pair_function(self) -> Option<Callable> {
        match self {
            ConstraintKind::Rolling => Some(Callable::Rolls),
            ConstraintKind::Slipping => Some(Callable::Slips),
            ConstraintKind::Holonomic | ConstraintKind::Nonholonomic => None,
        }
    }

    /// Returns the row of the constraint element in the table of elements.
    pub fn catalogue_row(self) -> OtherKind {
        match self {
            ConstraintKind::Holonomic => OtherKind::Holonomic,
            ConstraintKind::Nonholonomic => OtherKind::Nonholonomic,
            ConstraintKind::Rolling => OtherKind::Rolling,
            ConstraintKind::Slipping => OtherKind::Slipping,
        }
    }
}

/// An expression that remains zero, two that remain equal, or a pair of surfaces.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Name of the declared constraint.
    pub name: Name,
    /// Kind of the constraint.
    pub kind: ConstraintKind,
    /// Expression, a scalar or a vector, or `rolls(surface, surface)` or `slips(surface, surface)`.
    pub value: Expr,
    /// Right side of the constraint equation; zero if absent.
    pub other: Option<Expr>,
    /// Friction of slipping surfaces and speed at which it is regularised.
    pub arguments: WrittenArguments,
}

/// Limit of a coordinate.
#[derive(Clone, Debug)]
pub struct Limit {
    /// Name of the limit; that of the joint if it is from a file.
    pub name: Name,
    /// Limited quantity: joint, coordinate of a joint, declared coordinate, or expression.
    pub on: Expr,
    /// Bounds of the limit; with a restitution they are stops.
    pub arguments: WrittenArguments,
}

/// Unilateral contact of two surfaces that may separate, collide, slide and stick.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Name of the contact.
    pub name: Name,
    /// Expression of the first surface.
    pub first: Expr,
    /// Expression of the second surface.
    pub second: Expr,
    /// Coefficients of friction and restitution, stiffness and dissipation; surfaces without a stiffness are
    /// rigid.
    pub arguments: WrittenArguments,
    /// Source of the contact, if it is from a file. Pairs that never separate are then omitted.
    pub of_file: Option<FileContact>,
}

/// Contact of a file: its priority among those that share the contact points of a mechanism.
#[derive(Clone, Copy, Debug)]
pub struct FileContact {
    /// Kind of the contact.
    pub kind: FileContactKind,
    /// Distance of the spheres around both shapes in the configuration of the file, m.
    pub distance: f64,
}

/// Kind of a contact of a file, in the order in which contacts are included.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FileContactKind {
    /// Contact with a plane of the world.
    Plane,
    /// Contact that the file declares for two shapes.
    Pair,
    /// Contact with another shape of the world.
    World,
    /// Contact of bodies that no joints connect.
    Bodies,
    /// Contact of bodies that joints connect.
    Connected,
}

impl Contact {
    /// Returns whether the contact has a stiffness, so that its surfaces are compliant.
    pub fn is_compliant(&self) -> bool {
        [Key::Stiffness, Key::Hertz].into_iter().any(|key| self.arguments.expression_of_key(key).is_some())
    }
}

/// Returns the value of a coefficient of restitution, and whether it is a ratio of impulses, `poisson(e)`,
/// instead of velocities.
pub fn restitution_value_and_kind(e: &Expr) -> (&Expr, bool) {
    match &e.kind {
        ExprKind::Call(word, list) if word.id == Some(Callable::Poisson) => (list.first().unwrap_or(e), true),
        _ => (e, false),
    }
}
