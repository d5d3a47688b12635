//! Inerters: forces proportional to relative accelerations.

use super::ActedOn;
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::mechanism::{Inertance, Rule};
use crate::resolve::builder::Builder;
use crate::syntax::{self, Action, Key};

impl<'g> Builder<'_, 'g> {
    /// Adds an inerter.
    pub(super) fn add_inerter(&mut self, action: &Action, on: ActedOn<'g>, cx: &mut Diagnostics) {
        if let (Some(inertance), Some(stretch)) = (action.get(Key::Inertance), self.stretch_on(on)) {
            self.push_inertance(stretch.rate, inertance, cx);
        }
    }

    /// Adds an inertance on a rate.
    pub fn push_inertance(&mut self, rate: Expr<'g>, inertance: &syntax::Expr, cx: &mut Diagnostics) {
        if let Some(b) = self.scope.scalar(inertance, cx) {
            if let Some(n) = b.value().filter(|n| *n < 0.0) {
                cx.error(inertance.place.clone(), format!("an inertance cannot be negative, but it is {n}"))
                    .help("it resists accelerations as a mass does: write its size");
            }
            self.scope.require(Rule::NotNegative, || "an inertance".to_string(), &[b]);
            self.model.inertances.push(Inertance { rate, inertance: b });
        }
    }
}
