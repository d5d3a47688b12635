//! Bounds of a coordinate as a file has them.

use crate::import::imported::Placed;
use crate::syntax::{Expr, ExprKind, Limit, Name, Restitution};

/// What a file says of the limits of a joint; nothing where it bounds nothing.
#[derive(Default)]
pub(in crate::import) struct FileLimits {
    /// Least value.
    pub(in crate::import) lower: Option<Placed<f64>>,
    /// Largest value.
    pub(in crate::import) upper: Option<Placed<f64>>,
    /// Largest rate.
    pub(in crate::import) velocity: Option<Placed<f64>>,
    /// Largest force or torque.
    pub(in crate::import) effort: Option<Placed<f64>>,
}

/// What to do with limits that are none.
pub(in crate::import) const IGNORE_LIMITS: &str =
    "to leave limits out, write `#[mechanism(…, limits = ignore)]`";

impl FileLimits {
    /// True if there is any.
    pub(in crate::import) fn bounds(&self) -> bool {
        [&self.lower, &self.upper, &self.velocity, &self.effort].into_iter().any(Option::is_some)
    }

    /// The limits of a joint in the words of the language. A joint that follows another one bounds that one's
    /// motion, and not what drives it.
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
