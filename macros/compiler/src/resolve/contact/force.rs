//! Forces and moments at contacts, for the outputs that name them.

use super::unilateral::Point;
use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::kinematics::{symbols_in, velocity_gradient};
use crate::mechanism::Quantity;
use crate::resolve::scope::{Allowed, Axes, Scope, Value};
use crate::syntax::{self, Name};

/// Whether expressions that name forces at contacts name no reactions and accelerations, which are those
/// without contacts.
pub fn stands_alone(values: &[Expr<'_>]) -> bool {
    let quantities: Vec<Quantity> = symbols_in(values).into_iter().map(Quantity::of).collect();
    let any = |f: fn(&Quantity) -> bool| quantities.iter().any(f);
    !any(|q| matches!(q, Quantity::ContactForce(_)))
        || !any(|q| matches!(q, Quantity::Reaction(_) | Quantity::Acceleration(_)))
}

impl<'g> Scope<'_, 'g> {
    /// `contact_force(name)` and `contact_moment(name)`: what the second surface exerts on the first, at all
    /// points where they touch; of moments those of friction against spin and rolling.
    pub fn exerted(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let kinematics = self.kinematics.borrow();
        let known = || kinematics.touches.keys().map(String::as_str);
        let [e] = arguments else {
            let word = &function.text;
            cx.error(function.place.clone(), format!("`{word}` takes one contact"))
                .help(format!("write `{word}(foot)`"));
            return None;
        };
        let Some(name) = e.name() else {
            cx.error(e.place.clone(), "expected a contact").suggest("", known());
            return None;
        };
        if !self.check_allowed(Allowed::Reaction, "a force at a contact", &function.place, cx) {
            return None;
        }
        let Some(exerted) = kinematics.touches.get(name) else {
            if self.is_news(name, cx) {
                let error = cx.error(e.place.clone(), format!("unknown contact `{name}`"));
                error.suggest(name, known());
                if error.is_bare() {
                    error.help(
                        "name a field of type `Contact`; what stops transmit is among `contact::acting`",
                    );
                }
            }
            return None;
        };
        let of_moments = function.text == "contact_moment";
        let forces = if of_moments { &exerted.moments } else { &exerted.forces };
        if of_moments && forces.is_empty() {
            cx.error(e.place.clone(), format!("`{name}` has no moments of friction"))
                .help("`torsional = …` and `rolling = …`, m, are moments by the normal force");
            return None;
        }
        let mut terms: Vec<(Axes, Vec3<'g>)> = Vec::new();
        for (link, force) in forces {
            let axes = Axes::Link(*link);
            match terms.iter_mut().find(|(known, _)| *known == axes) {
                Some((_, sum)) => *sum += *force,
                None => terms.push((axes, *force)),
            }
        }
        Some(Value::Vector(terms))
    }
}

/// Reports moments of friction against what does not turn.
pub(super) fn check_turns(contact: &syntax::Contact, points: &[&Point<'_>], cx: &mut Diagnostics) {
    let still = |axis: usize| points.iter().all(|point| velocity_gradient(point.turns[axis]).is_empty());
    let asked = [
        (&contact.torsional, "about the normal of this contact", still(0)),
        (&contact.rolling, "about the tangents of this contact", still(1) && still(2)),
    ];
    for (e, about, _) in asked.into_iter().filter(|(.., still)| *still && !contact.of_file) {
        let Some(e) = e else { continue };
        cx.error(e.place.clone(), format!("nothing turns {about}"))
            .help("`torsional` brakes spin about the normal, `rolling` what turns about the tangents");
    }
}
