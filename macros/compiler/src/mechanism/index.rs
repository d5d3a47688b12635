//! Indices of coordinates and of velocities, which count differently where a quaternion stands.

use super::quantity::Quantity;
use crate::expr::{Expr, Graph};
use std::fmt::{Display, Formatter, Result};
use std::ops::{Add, Range};

/// The index of an entry of `q`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct InQ(pub usize);

/// The index of an entry of `v`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct InV(pub usize);

impl InQ {
    /// The coordinate.
    pub fn expr<'g>(self, graph: &'g Graph) -> Expr<'g> {
        Quantity::Configuration(self.0).expr(graph)
    }

    /// The entries of `q` from this one on.
    pub fn and_next(self, count: usize) -> Range<usize> {
        self.0..self.0 + count
    }
}

impl InV {
    /// The velocity.
    pub fn expr<'g>(self, graph: &'g Graph) -> Expr<'g> {
        Quantity::Velocity(self.0).expr(graph)
    }

    /// The entries of `v` from this one on.
    pub fn and_next(self, count: usize) -> Range<usize> {
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
