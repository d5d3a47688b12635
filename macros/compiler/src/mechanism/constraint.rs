//! Constraints of a mechanism, as scalar rows.

use super::index::InV;
use crate::diag::Place;
use crate::expr::{Expr, Vec3};

/// A scalar constraint: `rate` is zero, and so is `residual` if the constraint is holonomic.
#[derive(Clone, Debug)]
pub struct Constraint<'g> {
    /// Name: that of the joint or constraint, and the component.
    pub name: String,
    /// Source position of the constraint's name.
    pub place: Place,
    /// Expression of configuration and time whose time derivative is `rate`; `None` for a constraint on
    /// velocities only.
    pub residual: Option<Expr<'g>>,
    /// Expression that is linear in the velocities, with a velocity-free term if motion is prescribed in
    /// time.
    pub rate: Expr<'g>,
    /// Time derivative of `rate` at zero accelerations: the constraint at acceleration level without its
    /// terms in `v̇`.
    pub bias: Expr<'g>,
    /// Quantity measured by `residual`; without a residual, the quantity whose time derivative is `rate`.
    pub measure: MeasuredQuantity,
    /// Forces and torques per unit of its multiplier in a joint that closes a loop.
    pub transmits: Vec<ReactionComponent<'g>>,
    /// Index of the group of constraints that are components of the same vector. The magnitude of a component
    /// is compared with the other components of its group.
    pub group: usize,
    /// True if the constraint determines coordinates that may have no inertia.
    pub determines: bool,
    /// Friction proportional to the multiplier, which is the normal force of a sliding contact.
    pub friction: Vec<FrictionTerm<'g>>,
}

/// Friction along a direction. Its power is `share × rate` per unit of the magnitude of the normal force,
/// whether this is compressive or tensile.
#[derive(Clone, Copy, Debug)]
pub struct FrictionTerm<'g> {
    /// Slip velocity of the contact, linear in the velocities.
    pub rate: Expr<'g>,
    /// Friction force along the slip velocity per unit of normal force, an expression of state and time.
    pub share: Expr<'g>,
}

/// Quantity that a scalar constraint measures, which determines the unit of its residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeasuredQuantity {
    /// The constraint residual is a length between two points or surfaces, m.
    Length,
    /// Sine of an angle, or difference of a cosine, which is zero at the required angle.
    Angle,
    /// Value of an expression, or a velocity, of the declared constraint with this index.
    Declared(usize),
}

/// Component of the force or torque that a joint's parent exerts on its child.
#[derive(Clone, Copy, Debug)]
pub struct ReactionComponent<'g> {
    /// Index of the joint that transmits the force or torque.
    pub joint: usize,
    /// True if the reaction component is a torque, false for a force.
    pub torque: bool,
    /// Direction of the reaction component in ground axes.
    pub direction: Vec3<'g>,
}

/// A joint for which a loop is solved in closed form. It rotates about an axis or slides along it; the axis
/// is given in the joint's frame on the parent.
#[derive(Clone, Debug)]
pub struct ClosedFormJoint<'g> {
    /// Index of the joint that closes the loop.
    pub joint: usize,
    /// True if the closing joint is a Pin, false for a Sleeve.
    pub turns: bool,
    /// Axis of the joint that closes the loop.
    pub axis: Vec3<'g>,
}

/// Velocity that a constraint determines if generalized speeds are independent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstraintPivot {
    /// Index of the constraint whose multiplier is the reaction component.
    pub constraint: usize,
    /// Index of the velocity whose generalized force is the reaction component.
    pub velocity: InV,
}

/// Numbers of independent coordinates and velocities of a mechanism.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DegreeOfFreedomCounts {
    /// Number of independent coordinates of the mechanism.
    pub coordinates: usize,
    /// Number of independent velocities of the mechanism.
    pub velocities: usize,
}
