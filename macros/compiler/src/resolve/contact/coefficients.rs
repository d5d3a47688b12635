//! Coefficients of friction and restitution of contacts.

use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::language::Key;
use crate::mechanism::{Contact, Rule};
use crate::resolve::scope::{AllowedQuantities, Context, Scope};
use crate::syntax::{self, WrittenArguments};

/// Coefficients of friction and restitution of a contact.
#[derive(Clone, Copy)]
pub(super) struct ContactCoefficients<'g> {
    pub(super) friction: Expr<'g>,
    /// Coefficient of static friction.
    pub(super) stiction: Expr<'g>,
    /// Maximum friction moment about the normal per unit normal force, m.
    pub(super) torsional: Expr<'g>,
    /// Maximum friction moment about the tangents per unit normal force, m.
    pub(super) rolling: Expr<'g>,
    pub(super) restitution: Expr<'g>,
    /// Whether restitution is a ratio of impulses (Poisson) instead of velocities (Newton).
    pub(super) of_impulses: bool,
}

impl<'g> ContactCoefficients<'g> {
    /// Returns a contact with these coefficients. `turns` is true for a gap that is an angle.
    pub(super) fn contact_with_coefficients(
        self,
        name: String,
        (gap, turns): (Expr<'g>, bool),
        pressed_by: Option<usize>,
        rates: Vec<Expr<'g>>,
    ) -> Contact<'g> {
        let ContactCoefficients { friction, stiction, restitution, of_impulses, .. } = self;
        Contact { name, gap, turns, pressed_by, rates, friction, stiction, restitution, of_impulses }
    }
}

/// Reads the coefficients of a contact; `None` after an error.
pub(super) fn read_contact_coefficients<'g>(
    scope: &Scope<'_, 'g>,
    contact: &syntax::Contact,
    cx: &mut Diagnostics,
) -> Option<ContactCoefficients<'g>> {
    let (name, given) = (&contact.name.text, &contact.arguments);
    let mut read = |key, what| {
        resolve_contact_coefficient(scope, given.expression_of_key(key), what, Rule::NotNegative, name, cx)
    };
    let friction = read(Key::Friction, "friction");
    let stiction = match given.expression_of_key(Key::StaticFriction) {
        Some(_) => read(Key::StaticFriction, "static friction"),
        None => friction,
    };
    let torsional = read(Key::TorsionalFriction, "torsional friction");
    let rolling = read(Key::RollingFriction, "rolling friction");
    let restitution = read_restitution(scope, given, name, cx);
    let (friction, stiction) = (friction?, stiction?);
    if let Some(e) = given
        .expression_of_key(Key::StaticFriction)
        .filter(|_| given.expression_of_key(Key::Friction).is_some())
    {
        match (friction.constant_value(), stiction.constant_value()) {
            (Some(kinetic), Some(static_value)) if static_value < kinetic || kinetic == 0.0 => {
                let message = match kinetic == 0.0 {
                    true => format!("`{name}` has stiction, but no sliding friction"),
                    false => format!("stiction, {static_value}, is less than friction, {kinetic}"),
                };
                cx.report_error(e.place.clone(), message).add_help(
                    "`friction` is the coefficient while surfaces slide, `stiction` the larger one at \
                     rest",
                );
                return None;
            }
            _ => {
                let describe_friction_and_stiction = || format!("the friction of `{name}` and its stiction");
                scope.record_parameter_condition(
                    Rule::Order,
                    describe_friction_and_stiction,
                    &[friction, stiction],
                );
            }
        }
    }
    Some(ContactCoefficients {
        friction,
        stiction,
        torsional: torsional?,
        rolling: rolling?,
        restitution: restitution.0?,
        of_impulses: restitution.1,
    })
}

/// Reads a coefficient of restitution, `None` after an error, and whether it is a ratio of impulses.
pub(super) fn read_restitution<'g>(
    scope: &Scope<'_, 'g>,
    given: &WrittenArguments,
    name: &str,
    cx: &mut Diagnostics,
) -> (Option<Expr<'g>>, bool) {
    let (e, of_impulses) =
        given.expression_of_key(Key::Restitution).map(syntax::restitution_value_and_kind).unzip();
    let value = resolve_contact_coefficient(scope, e, "restitution", Rule::Fraction, name, cx);
    (value, of_impulses == Some(true))
}

/// Reads a coefficient, zero if it is absent; `None` after an error.
pub(super) fn resolve_contact_coefficient<'g>(
    scope: &Scope<'_, 'g>,
    e: Option<&syntax::Expr>,
    what: &str,
    rule: Rule,
    name: &str,
    cx: &mut Diagnostics,
) -> Option<Expr<'g>> {
    let Some(e) = e else { return Some(scope.graph.zero()) };
    let value = scope
        .call_in_context(Context::new(AllowedQuantities::Constant, None), |s| s.resolve_scalar(e, cx))?;
    let maximum = if rule == Rule::Fraction { 1.0 } else { f64::INFINITY };
    if let Some(n) = value.constant_value().filter(|n| !(0.0..=maximum).contains(n)) {
        let range = if maximum < 2.0 { "must be between 0 and 1" } else { "cannot be negative" };
        cx.report_error(e.place.clone(), format!("a coefficient of {what} {range}, but it is {n}")).add_help(
            match maximum < 2.0 {
                true => {
                    "the ratio of the speeds after and before the impact: 0 without rebound, 1 without \
                     loss of energy"
                }
                false => "it opposes the motion by definition: give its magnitude",
            },
        );
        return None;
    }
    scope.record_parameter_condition(rule, || format!("the {what} of `{name}`"), &[value]);
    Some(value)
}
