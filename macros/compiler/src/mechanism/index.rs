//! Indices of coordinates and of velocities, which differ in the presence of quaternions.

use super::quantity::Quantity;
use crate::expr::{Expr, Graph};
use std::fmt::{Display, Formatter, Result};
use std::ops::{Add, Range};

/// Index of an entry of the configuration `q`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct InQ(pub usize);

/// Index of an entry of the velocity `v`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct InV(pub usize);

impl InQ {
    /// Returns the coordinate with this index as an expression.
    pub fn expr<'g>(self, graph: &'g Graph) -> Expr<'g> {
        Quantity::Configuration(self.0).expr(graph)
    }

    /// Returns the range of `count` entries of `q` that begins with this index.
    pub fn range_of_entries(self, count: usize) -> Range<usize> {
        self.0..self.0 + count
    }
}

impl InV {
    /// Returns the velocity with this index as an expression.
    pub fn expr<'g>(self, graph: &'g Graph) -> Expr<'g> {
        Quantity::Velocity(self.0).expr(graph)
    }

    /// Returns the range of `count` entries of `v` that begins with this index.
    pub fn range_of_entries(self, count: usize) -> Range<usize> {
        self.0..self.0 + count
    }
}

impl Display for InQ {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        self.0.fmt(f)
    }
}

impl Display for InV {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        self.0.fmt(f)
    }
}

impl Add<usize> for InQ {
    type Output = InQ;

    fn add(self, entries: usize) -> InQ {
        InQ(self.0 + entries)
    }
}

impl Add<usize> for InV {
    type Output = InV;

    fn add(self, entries: usize) -> InV {
        InV(self.0 + entries)
    }
}
