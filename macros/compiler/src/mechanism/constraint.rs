//! Constraints as scalar rows.

use super::index::InV;
use crate::diag::Place;
use crate::expr::{Expr, Vec3};

/// A scalar constraint: `rate` stays zero, and so does `residual` if it restricts configurations.
#[derive(Clone, Debug)]
pub struct Constraint<'g> {
    /// Its name: that of the joint or constraint, and which component.
    pub name: String,
    /// Where that stands.
    pub place: Place,
    /// An expression of configuration and time whose derivative is `rate`; none for a constraint on velocities alone.
    pub residual: Option<Expr<'g>>,
    /// Linear in the velocities, with a term that does not contain them where something is driven in time.
    pub rate: Expr<'g>,
    /// Derivative of `rate` at zero accelerations.
    pub bias: Expr<'g>,
    /// What `residual` measures, or where there is none, what `rate` is the rate of.
    pub measure: Measure,
    /// What its multiplier is in a joint that closes a loop.
    pub transmits: Vec<Transmission<'g>>,
    /// Constraints of one number are components of one vector: how much each of them restricts is measured by all.
    pub group: usize,
    /// It determines coordinates that may have no inertia.
    pub determines: bool,
    /// Friction in proportion to its multiplier, the normal force of a contact that slips.
    pub friction: Vec<FrictionTerm<'g>>,
}

/// Friction along a direction: its power is `share × rate` for each unit of normal force, pressing or pulling.
#[derive(Clone, Copy, Debug)]
pub struct FrictionTerm<'g> {
    /// The rate of slip, linear in the velocities.
    pub rate: Expr<'g>,
    /// Force along it by normal force, an expression of state and time.
    pub share: Expr<'g>,
}

/// What a scalar constraint measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// A length between two points or surfaces.
    Length,
    /// The sine of an angle, or the difference of a cosine, which are zero where the angle is right.
    Angle,
    /// What an expression is, or the rate of something: that of a declared constraint, by its index.
    Declared(usize),
}

/// A part of the force or torque that a joint's parent exerts on its child.
#[derive(Clone, Copy, Debug)]
pub struct Transmission<'g> {
    /// The joint.
    pub joint: usize,
    /// A torque, not a force.
    pub torque: bool,
    /// Direction in ground axes.
    pub direction: Vec3<'g>,
}

/// A joint that a loop is solved for: it turns about an axis or slides along one, in its frame on the parent.
#[derive(Clone, Debug)]
pub struct SolvedSide<'g> {
    /// The joint, by number.
    pub joint: usize,
    /// A Pin, otherwise a Sleeve.
    pub turns: bool,
    /// Its axis.
    pub axis: Vec3<'g>,
}

/// Which velocity follows from a constraint where speeds are independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pivot {
    /// The constraint, by number.
    pub constraint: usize,
    /// The velocity.
    pub velocity: InV,
}

/// Degrees of freedom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Freedom {
    /// How many coordinates are independent.
    pub coordinates: usize,
    /// How many velocities are independent.
    pub velocities: usize,
}
