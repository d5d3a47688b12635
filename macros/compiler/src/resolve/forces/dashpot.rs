//! Dashpots: linear, and with a force as an expression of the speed.

use super::ActedOn;
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::mechanism::{Dashpot, Load, Pose, Rule};
use crate::resolve::builder::Builder;
use crate::resolve::scope::{Allowed, Context};
use crate::resolve::terms::Stretch;
use crate::syntax::{Action, Key};

impl<'g> Builder<'_, 'g> {
    /// Adds a dashpot. A linear dashpot on a coordinate is stored separately in the model.
    pub(super) fn add_dashpot(&mut self, action: &Action, on: ActedOn<'g>, cx: &mut Diagnostics) {
        let damping = action.get(Key::Damping);
        if let (Some(written), Some(on)) = (damping, on.coordinate) {
            let damping = self.scope.scalar(written, cx);
            if let Some(d) = damping.and_then(|d| d.value()).filter(|d| *d < 0.0) {
                cx.error(written.place.clone(), format!("a damping cannot be negative, but it is {d}"))
                    .help("a dashpot takes energy away by itself; what brings energy in is a `Force` or `Torque` with `value = …`");
            }
            if let Some(damping) = damping {
                let quantity = || format!("the damping of `{}`", action.name.text);
                self.scope.require(Rule::NotNegative, quantity, &[damping]);
                self.model.dashpots.push(Dashpot { on, damping });
            }
            return;
        }
        let Some(Stretch { rate, .. }) = self.stretch_on(on) else { return };
        if let Some(damping) = damping {
            let force = self.scope.scalar(damping, cx).map(|damping| damping * rate);
            self.push_damping(rate, force);
        } else if let Some(force) = action.get(Key::Force) {
            let ground = Some((None, Pose::identity(self.scope.graph)));
            let context = Context::new(Allowed::Motion, ground).with_locals(vec![("speed", rate)]);
            let force = self.scope.in_context(context, |scope| scope.scalar(force, cx));
            self.push_damping(rate, force);
        }
    }

    /// Adds a force that opposes a rate, if it is present.
    pub fn push_damping(&mut self, rate: Expr<'g>, force: Option<Expr<'g>>) {
        self.model.loads.extend(force.map(|force| Load { rate, force: -force, dissipative: true }));
    }
}
