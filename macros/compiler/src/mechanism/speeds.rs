//! Generalized speeds declared by the user in place of joint velocities.

use super::index::InV;
use super::quantity::Quantity;
use crate::diag::Place;
use crate::expr::{Expr, Graph};

/// Kane's generalized speeds `u` (Kane and Levinson, *Dynamics: Theory and Applications*, 1985, § 2.12):
/// `u = Y(q) v` and `v = Z(q) u`, where `v` are the joint velocities. Both matrices are square. Rows and
/// columns of joint velocities that are retained are those of the identity matrix.
#[derive(Clone, Debug)]
pub struct Speeds<'g> {
    /// Matrix `Y` of the speeds in terms of the joint velocities, row by row.
    pub velocity_to_speed_matrix: Vec<Vec<Expr<'g>>>,
    /// Matrix `Z` of the joint velocities in terms of the speeds, row by row.
    pub rates: Vec<Vec<Expr<'g>>>,
    /// Indices of the joint velocities that declared speeds replace.
    pub replaced: Vec<InV>,
    /// Names of all joint velocities, with the places of the joints.
    pub velocities: Vec<(String, Place)>,
}

impl<'g> Speeds<'g> {
    /// Returns a joint velocity as an expression of the speeds, which are then the entries of `v`.
    pub fn joint_velocity(&self, graph: &'g Graph, velocity: InV) -> Expr<'g> {
        let terms = self.rates[velocity.0].iter().enumerate().filter(|(_, z)| !z.is_zero());
        terms.fold(graph.zero(), |sum, (j, z)| sum + *z * Quantity::Velocity(j).expr(graph))
    }
}
