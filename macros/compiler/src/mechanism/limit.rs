//! Limits of coordinates.

use super::index::{InQ, InV};
use crate::expr::Expr;

/// What an entry of `v` and the coordinate whose rate it is stay within; nothing where there is no bound.
#[derive(Clone, Copy, Debug)]
pub struct Limit<'g> {
    /// Index of the coordinate in `q`.
    pub q: InQ,
    /// Index of its rate in `v`.
    pub v: InV,
    /// Least value of the coordinate.
    pub lower: Option<Expr<'g>>,
    /// Largest value of the coordinate.
    pub upper: Option<Expr<'g>>,
    /// Largest rate, in both directions.
    pub speed: Option<Expr<'g>>,
    /// Largest generalized force, in both directions.
    pub effort: Option<Expr<'g>>,
}

impl<'g> Limit<'g> {
    /// The bounds: lower, upper, speed, effort.
    pub fn bounds(&self) -> [Option<Expr<'g>>; 4] {
        [self.lower, self.upper, self.speed, self.effort]
    }
}
