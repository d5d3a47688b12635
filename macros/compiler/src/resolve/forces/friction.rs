//! Force elements of dry and viscous friction.

use crate::diag::{Diagnostics, Place};
use crate::expr::{Expr, Function};
use crate::mechanism::Rule;
use crate::resolve::element_forces::ElementForces;
use crate::resolve::scope::Scope;
use crate::resolve::terms::ForceElementCoordinate;
use crate::syntax::{self, Action, Key};

/// Default regularisation speed of friction, m/s or rad/s.
const FRICTION_SPEED: f64 = 0.01;

/// Returns the force of a dry or viscous friction element.
pub fn friction_force<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    on: ForceElementCoordinate<'g>,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let all = [Key::Coulomb, Key::Stiction, Key::StribeckSpeed, Key::Viscous, Key::Speed];
    dry_friction(
        scope,
        on.stretch(scope)?.rate,
        all.map(|key| action.expression_of_key(key)),
        action.on.source_position_of_target(),
        cx,
    )
}

/// Returns dry friction with breakaway (Stribeck), regularised with a hyperbolic tangent, and viscous
/// friction: `(fc + (fs − fc) exp(−(v / vs)²)) tanh(v / v0) + c v`.
pub fn dry_friction<'g>(
    scope: &Scope<'_, 'g>,
    v: Expr<'g>,
    [coulomb, stiction, stribeck, viscous, speed]: [Option<&syntax::Expr>; 5],
    place: &Place,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let g = scope.graph;
    let mut resolve_scalar_or_default = |e: Option<&syntax::Expr>, default: f64| match e {
        Some(e) => scope.resolve_scalar(e, cx),
        None => Some(g.num(default)),
    };
    let (fc, c, v0) = (
        resolve_scalar_or_default(coulomb, 0.0),
        resolve_scalar_or_default(viscous, 0.0),
        resolve_scalar_or_default(speed, FRICTION_SPEED),
    );
    let (fs, vs) = (
        stiction.map(|e| resolve_scalar_or_default(Some(e), 0.0)),
        stribeck.map(|e| resolve_scalar_or_default(Some(e), 0.0)),
    );
    let mut check_coefficient_sign =
        |written: Option<&syntax::Expr>, found: Option<Expr<'g>>, positive: bool, what: &str| {
            if let Some(found) = found {
                let rule = if positive { Rule::Positive } else { Rule::NotNegative };
                scope.record_parameter_condition(rule, || format!("a {what} of dry friction"), &[found]);
            }
            let (Some(written), Some(n)) = (written, found.and_then(|e| e.constant_value())) else { return };
            if n < 0.0 || positive && n == 0.0 {
                let must = if positive { "must be positive" } else { "cannot be negative" };
                cx.report_error(written.place.clone(), format!("this {what} {must}, but it is {n}"));
            }
        };
    for (written, found) in [(coulomb, fc), (stiction, fs.flatten()), (viscous, c)] {
        check_coefficient_sign(written, found, false, "friction");
    }
    for (written, found) in [(stribeck, vs.flatten()), (speed, v0)] {
        check_coefficient_sign(written, found, true, "speed");
    }
    let (Some(fc), Some(c), Some(v0)) = (fc, c, v0) else { return None };
    let dry = match (fs, vs) {
        (None, None) => fc,
        (Some(Some(fs)), Some(Some(vs))) => {
            fc + (fs - fc) * (-(v / vs).square()).apply_function(Function::Exp)
        }
        (Some(None), _) | (_, Some(None)) => return None,
        _ => {
            cx.report_error(place.clone(), "`stiction` and `stribeck_speed` must be given together")
                .add_help("the force falls from `stiction` to `coulomb` at about `stribeck_speed`");
            return None;
        }
    };
    let force = dry * (v / v0).apply_function(Function::Tanh) + c * v;
    Some(ElementForces::resisting_force(v, force))
}
