//! Limits of the coordinates of a mechanism, as data of the model.

use super::index::{InQ, InV};
use crate::expr::Expr;

/// Limits of a coordinate, its velocity and its generalized force; `None` for each missing bound.
#[derive(Clone, Copy, Debug)]
pub struct CoordinateLimits<'g> {
    /// Index in `q` of the limited coordinate.
    pub q: InQ,
    /// Index in `v` of the limited coordinate's velocity.
    pub v: InV,
    /// Minimum value of the limited coordinate.
    pub lower: Option<Expr<'g>>,
    /// Maximum value of the limited coordinate.
    pub upper: Option<Expr<'g>>,
    /// Maximum magnitude of the coordinate's velocity.
    pub speed: Option<Expr<'g>>,
    /// Maximum magnitude of the generalized force on the coordinate.
    pub effort: Option<Expr<'g>>,
}

impl<'g> CoordinateLimits<'g> {
    /// Returns the limits of the coordinate, its velocity and its force: lower, upper, velocity, force.
    pub fn bounds(&self) -> [Option<Expr<'g>>; 4] {
        [self.lower, self.upper, self.speed, self.effort]
    }
}
