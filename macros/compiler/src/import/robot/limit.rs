//! Limits of a joint as a file specifies them.

use crate::import::imported::Placed;
use crate::syntax::{Expr, ExprKind, Limit, Name, Restitution};

/// Limits of a joint; `None` for a quantity without a limit.
#[derive(Default)]
pub(in crate::import) struct FileLimits {
    /// Lower bound of the coordinate.
    pub(in crate::import) lower: Option<Placed<f64>>,
    /// Upper bound of the coordinate.
    pub(in crate::import) upper: Option<Placed<f64>>,
    /// Maximum speed.
    pub(in crate::import) velocity: Option<Placed<f64>>,
    /// Maximum force or torque.
    pub(in crate::import) effort: Option<Placed<f64>>,
}

/// Help text for invalid limits.
pub(in crate::import) const IGNORE_LIMITS: &str =
    "to leave limits out, write `#[mechanism(…, limits = ignore)]`";

impl FileLimits {
    /// Returns true if any limit is specified.
    pub(in crate::import) fn bounds(&self) -> bool {
        [&self.lower, &self.upper, &self.velocity, &self.effort].into_iter().any(Option::is_some)
    }

    /// Converts the limits of a joint to the language's representation. For a joint that follows another one
    /// (`follows`), the limit of force is dropped, because nothing drives it. With `stops`, the ends of the
    /// range are stops with restitution 0.
    pub(in crate::import) fn of_joint(&self, joint: &Name, follows: bool, stops: bool) -> Option<Limit> {
        let expression =
            |found: &Option<Placed<f64>>| found.as_ref().map(|f| Expr::number(f.value, &f.place));
        let limit = Limit {
            name: joint.clone(),
            on: Expr { kind: ExprKind::Name(joint.text.clone()), place: joint.place.clone() },
            from: expression(&self.lower),
            to: expression(&self.upper),
            max_speed: expression(&self.velocity),
            max_effort: expression(&self.effort).filter(|_| !follows),
            restitution: stops
                .then(|| Restitution { value: Expr::number(0.0, &joint.place), of_impulses: false })
                .filter(|_| self.lower.is_some() || self.upper.is_some()),
        };
        let bounds = [&limit.from, &limit.to, &limit.max_speed, &limit.max_effort];
        bounds.iter().any(|bound| bound.is_some()).then_some(limit)
    }
}
