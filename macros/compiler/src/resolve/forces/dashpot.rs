//! Dashpots: linear, and with a force as an expression of the speed.

use crate::diag::Diagnostics;
use crate::mechanism::{Dashpot, Pose, Rule};
use crate::resolve::element_forces::ElementForces;
use crate::resolve::scope::{AllowedQuantities, Context, Scope};
use crate::resolve::terms::ForceElementCoordinate;
use crate::syntax::{Action, Key};

/// Returns the force of a dashpot. A linear dashpot on a coordinate is stored separately in the model.
pub fn dashpot_force<'g>(
    scope: &Scope<'_, 'g>,
    action: &Action,
    on: ForceElementCoordinate<'g>,
    cx: &mut Diagnostics,
) -> Option<ElementForces<'g>> {
    let damping = action.expression_of_key(Key::Damping);
    if let (Some(written), Some(on)) = (damping, on.coordinate) {
        let damping = scope.resolve_scalar(written, cx)?;
        if let Some(d) = damping.constant_value().filter(|d| *d < 0.0) {
            cx.report_error(written.place.clone(), format!("a damping cannot be negative, but it is {d}"))
                .add_help("a dashpot dissipates energy; an element that supplies energy is a `Force` or `Torque` with `value = …`");
        }
        scope.record_parameter_condition(
            Rule::NotNegative,
            || format!("the damping of `{}`", action.name.text),
            &[damping],
        );
        return Some(ElementForces { dashpots: vec![Dashpot { on, damping }], ..ElementForces::default() });
    }
    let rate = on.stretch(scope)?.rate;
    let force = match damping {
        Some(damping) => scope.resolve_scalar(damping, cx)? * rate,
        None => {
            let ground = Some((None, Pose::identity(scope.graph)));
            let context = Context::new(AllowedQuantities::Motion, ground).with_locals(vec![("speed", rate)]);
            let written = action.expression_of_key(Key::Force)?;
            scope.call_in_context(context, |scope| scope.resolve_scalar(written, cx))?
        }
    };
    Some(ElementForces::resisting_force(rate, force))
}
