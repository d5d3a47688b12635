//! Limits of the coordinates of a mechanism.

use super::index::{InQ, InV};
use crate::expr::Expr;

/// Limits of a coordinate, its velocity and its generalized force; `None` for each missing bound.
#[derive(Clone, Copy, Debug)]
pub struct Limit<'g> {
    /// Index of the coordinate in `q`.
    pub q: InQ,
    /// Index of the coordinate's velocity in `v`.
    pub v: InV,
    /// Minimum value of the coordinate.
    pub lower: Option<Expr<'g>>,
    /// Maximum value of the coordinate.
    pub upper: Option<Expr<'g>>,
    /// Maximum velocity of the coordinate, in both directions.
    pub speed: Option<Expr<'g>>,
    /// Maximum generalized force on the coordinate, in both directions.
    pub effort: Option<Expr<'g>>,
}

impl<'g> Limit<'g> {
    /// Returns the limits of the coordinate, its velocity and its force: lower, upper, velocity, force.
    pub fn bounds(&self) -> [Option<Expr<'g>>; 4] {
        [self.lower, self.upper, self.speed, self.effort]
    }
}
