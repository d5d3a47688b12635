//! Inerters: force elements with a force proportional to a relative acceleration.

use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::mechanism::{Inertance, Rule};
use crate::resolve::element_forces::ElementForces;
use crate::resolve::scope::Scope;
use crate::resolve::terms::ForceElementCoordinate;
use crate::syntax::{self, Action, Key};

/// Returns the force of an inerter as `ElementForces`.
pub fn inerter_force<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    on: ForceElementCoordinate<'g>,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    inertance_force(scope, on.stretch(scope)?.rate, action.expression_of_key(Key::Inertance)?, cx)
}

/// Returns the force of an inertance on the rate of a length.
pub fn inertance_force<'g>(
    scope: &Scope<'_, 'g>,
    rate: Expr<'g>,
    written: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let inertance = scope.resolve_scalar(written, cx)?;
    if let Some(n) = inertance.constant_value().filter(|n| *n < 0.0) {
        cx.report_error(written.place.clone(), format!("an inertance cannot be negative, but it is {n}"))
            .add_help("it resists accelerations as a mass does: give its magnitude");
    }
    scope.record_parameter_condition(Rule::NotNegative, || "an inertance".to_string(), &[inertance]);
    Some(ElementForces { inertances: vec![Inertance { rate, inertance }], ..ElementForces::default() })
}
