//! Generalized speeds of the user's choice in place of velocities of joints.

use super::index::InV;
use super::quantity::Quantity;
use crate::diag::Place;
use crate::expr::{Expr, Graph};

/// Kane's generalized speeds `u` (Kane and Levinson, *Dynamics: Theory and Applications*, 1985, § 2.12): `u = Y(q) v` and
/// `v = Z(q) u`, where `v` are the velocities that the joints have. Both matrices are square; rows and columns of velocities
/// that are kept are those of the identity.
#[derive(Clone, Debug)]
pub struct Speeds<'g> {
    /// `Y`, row by row.
    pub of_rates: Vec<Vec<Expr<'g>>>,
    /// `Z`, row by row.
    pub rates: Vec<Vec<Expr<'g>>>,
    /// Indices of the velocities that speeds replace.
    pub replaced: Vec<InV>,
    /// The names of all velocities without speeds, and where the joints stand.
    pub velocities: Vec<(String, Place)>,
}

impl<'g> Speeds<'g> {
    /// A velocity that a joint has, in the speeds, which are the entries of `v` then.
    pub fn rate(&self, graph: &'g Graph, velocity: InV) -> Expr<'g> {
        let terms = self.rates[velocity.0].iter().enumerate().filter(|(_, z)| !z.is_zero());
        terms.fold(graph.zero(), |sum, (j, z)| sum + *z * Quantity::Velocity(j).expr(graph))
    }
}
