//! Rows of constraints.

use super::contact::Surface;
use super::scope::{Scope, VectorTerms};
use crate::diag::Place;
use crate::expr::Expr;
use crate::kinematics::time_derivative;
use crate::mechanism::{Constraint, MeasuredQuantity};

/// Rows of a constraint, which the builder adds to those of the other constraints.
#[derive(Default)]
pub struct ConstraintRows<'g> {
    /// Scalar rows of the constraint; their groups count from zero.
    pub rows: Vec<Constraint<'g>>,
    /// Names of components of the constraint that vanish identically.
    pub redundant: Vec<String>,
    /// Contact point of the surfaces, relative to the ground's origin.
    pub contact_point: Option<VectorTerms<'g>>,
    /// Surfaces of a pair that rolls or slips.
    pub surfaces: Vec<Surface<'g>>,
}

/// Returns a row of a declared constraint with this rate.
pub fn constraint_from_residual_and_rate<'g>(
    scope: &Scope<'_, 'g>,
    (name, place): (String, &Place),
    measure: MeasuredQuantity,
    residual: Option<Expr<'g>>,
    rate: Expr<'g>,
) -> Constraint<'g> {
    Constraint {
        name,
        place: place.clone(),
        residual,
        rate,
        bias: time_derivative(scope.configuration_space(), rate),
        measure,
        transmits: Vec::new(),
        group: 0,
        determines: false,
        friction: Vec::new(),
    }
}
