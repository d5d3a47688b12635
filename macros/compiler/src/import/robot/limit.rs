//! Limits of a joint as a robot file specifies them.

use crate::import::imported::Located;
use crate::syntax::{Expr, ExprKind, Key, Limit, Name, WrittenArguments};

/// Limits of a joint; `None` for a quantity without a limit.
#[derive(Default)]
pub(in crate::import) struct FileLimits {
    /// Lower bound of the joint coordinate.
    pub(in crate::import) lower: Option<Located<f64>>,
    /// Upper bound of the joint coordinate.
    pub(in crate::import) upper: Option<Located<f64>>,
    /// Maximum magnitude of the joint velocity.
    pub(in crate::import) velocity: Option<Located<f64>>,
    /// Maximum magnitude of the joint force or torque.
    pub(in crate::import) effort: Option<Located<f64>>,
}

/// Help text for limits of a robot file that are invalid.
pub(in crate::import) const IGNORE_LIMITS: &str =
    "to ignore limits, write `#[mechanism(…, limits = ignore)]`";

impl FileLimits {
    /// Returns whether the file specifies any limit of the joint.
    pub(in crate::import) fn has_limits(&self) -> bool {
        [&self.lower, &self.upper, &self.velocity, &self.effort].into_iter().any(Option::is_some)
    }

    /// Converts the limits of a joint to the language's representation. For a joint that follows another one
    /// (`follows`), the limit of force is dropped, because nothing drives it. With `stops`, the ends of the
    /// range are stops with restitution 0.
    pub(in crate::import) fn convert_joint_limits(
        &self,
        joint: &Name,
        follows: bool,
        stops: bool,
    ) -> Option<Limit> {
        let limit_expression =
            |found: &Option<Located<f64>>| found.as_ref().map(|f| Expr::number_at(f.value, &f.place));
        let bounds = [
            (Key::From, limit_expression(&self.lower)),
            (Key::To, limit_expression(&self.upper)),
            (Key::MaxSpeed, limit_expression(&self.velocity)),
            (Key::MaxEffort, limit_expression(&self.effort).filter(|_| !follows)),
        ];
        let mut given: Vec<(Key, Expr)> =
            bounds.into_iter().filter_map(|(key, bound)| Some((key, bound?))).collect();
        if given.is_empty() {
            return None;
        }
        if stops && (self.lower.is_some() || self.upper.is_some()) {
            given.push((Key::Restitution, Expr::number_at(0.0, &joint.place)));
        }
        let on = Expr { kind: ExprKind::Name(joint.text.clone()), place: joint.place.clone() };
        Some(Limit { name: joint.clone(), on, arguments: WrittenArguments(given) })
    }
}
