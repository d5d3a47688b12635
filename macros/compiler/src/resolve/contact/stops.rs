//! Stops: contacts of coordinates and expressions at the bounds of limits.

use super::unilateral::ContactCoefficients;
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::kinematics::{time_derivative, velocity_gradient};
use crate::language::Key;
use crate::resolve::builder::Builder;
use crate::resolve::scope::{Allowed, Context};
use crate::syntax;

impl<'g> Builder<'_, 'g> {
    /// Adds contacts for the stops at the bounds of a limit.
    pub(super) fn add_stops(&mut self, limit: &syntax::Limit, cx: &mut Diagnostics) {
        let (restitution, of_impulses) = self.restitution(&limit.arguments, &limit.name.text, cx);
        let (Some(restitution), Some((limited, rate, turns))) = (restitution, self.stop_value(limit, cx))
        else {
            return;
        };
        let g = self.scope.graph;
        let bound_value = |e: &syntax::Expr| match turns && e.place.file.is_none() {
            // Errors are reported by the pass that reads the limit.
            true => self.scope.plane_angle(e, &mut Diagnostics::discarded_diagnostics()),
            false => self.scope.resolve_scalar(e, &mut Diagnostics::discarded_diagnostics()),
        };
        let bounds = [(Key::From, 1.0), (Key::To, -1.0)]
            .map(|(key, side)| Some((key, bound_value(limit.arguments.get(key)?)?, side)));
        for (key, bound, side) in bounds.into_iter().flatten() {
            let gap = (limited - bound) * g.num(side);
            let name = format!("{}.{}", limit.name.text, key.name());
            let (friction, torsional, rolling) = (g.zero(), g.zero(), g.zero());
            let coefficients = ContactCoefficients {
                friction,
                stiction: friction,
                torsional,
                rolling,
                restitution,
                of_impulses,
            };
            self.push_contact(name, (gap, turns), None, vec![rate * g.num(side)], coefficients);
        }
    }

    /// Returns the limited value, its rate, and whether it is an angle.
    fn stop_value(&self, limit: &syntax::Limit, cx: &mut Diagnostics) -> Option<(Expr<'g>, Expr<'g>, bool)> {
        let g = self.scope.graph;
        if !self.scope.is_moving(&limit.on) {
            let (c, angle) = self.resolve_limited_coordinate(&limit.on, cx)?;
            let (q, v) = (c.q.expr(g), c.v.expr(g));
            let ratio = g.num(c.ratio);
            return Some((q * ratio + g.num(c.offset), v * ratio, angle == Some(true)));
        }
        let value = self.scope.in_context(Context::new(Allowed::Placement, None), |scope| {
            scope.resolve_scalar(&limit.on, cx)
        })?;
        let rate = time_derivative(self.model.configuration_space(), value);
        if velocity_gradient(rate).is_empty() {
            cx.report_error(limit.on.place.clone(), "the limited quantity is constant").add_help(
                "a limit bounds an expression of coordinates, such as a distance `norm(r(ball / anchor))`",
            );
            return None;
        }
        Some((value, rate, false))
    }
}
