//! Forces at contacts, for the outputs that name them.

use crate::diag::Diagnostics;
use crate::expr::{Expr, Vec3};
use crate::kinematics::symbols_in;
use crate::mechanism::Quantity;
use crate::resolve::scope::{Allowed, Axes, Scope, Value};
use crate::syntax::{self, Name};

/// Whether expressions that name forces at contacts name no reactions and accelerations, which are those without contacts.
pub fn stands_alone(values: &[Expr<'_>]) -> bool {
    let quantities: Vec<Quantity> = symbols_in(values).into_iter().map(Quantity::of).collect();
    let any = |f: fn(&Quantity) -> bool| quantities.iter().any(f);
    !any(|q| matches!(q, Quantity::ContactForce(_)))
        || !any(|q| matches!(q, Quantity::Reaction(_) | Quantity::Acceleration(_)))
}

impl<'g> Scope<'_, 'g> {
    /// `contact_force(name)`: what the second surface exerts on the first, at all points where they touch.
    pub fn contact_force(
        &self,
        function: &Name,
        arguments: &[syntax::Expr],
        cx: &mut Diagnostics,
    ) -> Option<Value<'g>> {
        let kinematics = self.kinematics.borrow();
        let known = || kinematics.touches.keys().map(String::as_str);
        let [e] = arguments else {
            cx.error(function.place.clone(), "`contact_force` takes one contact")
                .help("write `contact_force(foot)`");
            return None;
        };
        let Some(name) = e.name() else {
            cx.error(e.place.clone(), "expected a contact").suggest("", known());
            return None;
        };
        if !self.check_allowed(Allowed::Reaction, "a force at a contact", &function.place, cx) {
            return None;
        }
        let Some(forces) = kinematics.touches.get(name) else {
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
