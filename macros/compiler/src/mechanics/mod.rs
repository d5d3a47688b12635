//! The mechanism's equations as expressions, by the recursive algorithms of rigid-body dynamics run
//! symbolically (Featherstone, *Rigid Body Dynamics Algorithms*, 2008; the linear components of spatial
//! vectors come first here). Every algorithm works in link axes, in which the motion subspaces of joints are
//! constant. Independent of the syntax tree.

use crate::expr::Expr;
use crate::mechanism::{Coordinate, Model, Quantity};

pub mod aba;
pub mod added_mass;
pub mod conserved;
pub mod constraints;
pub mod crba;
pub mod derivatives;
pub mod energy;
pub mod forces;
pub mod frames;
pub mod friction;
pub mod hamilton;
pub mod independence;
pub mod inertances;
pub mod lagrange;
pub mod ldl;
pub mod limb_contacts;
pub mod limb_responses;
pub mod massless;
pub mod momentum;
pub mod passive;
pub mod power;
pub mod reactions;
pub mod regressor;
pub mod regularity;
pub mod rnea;
pub mod routh;
mod shared_motions;
pub mod speeds;

/// Returns all velocities as symbols.
pub fn velocity_symbols<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.nv()).map(|k| Quantity::Velocity(k).expr(model.graph)).collect()
}

/// Returns all accelerations as symbols.
pub fn acceleration_symbols<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.nv()).map(|k| Quantity::Acceleration(k).expr(model.graph)).collect()
}

/// Returns all generalized forces as symbols.
pub fn generalized_force_symbols<'g>(model: &Model<'g>) -> Vec<Expr<'g>> {
    (0..model.nv()).map(|k| Quantity::Force(k).expr(model.graph)).collect()
}

/// Returns whether every velocity belongs to exactly one joint coordinate, so that the articulated-body
/// algorithm applies.
pub fn supports_articulated_body_algorithm(model: &Model<'_>) -> bool {
    let mut seen = vec![false; model.nv()];
    model.inertances.is_empty()
        && model.acceleration_forces.is_empty()
        && model.links.iter().all(|link| {
            let mut has_own_velocity =
                |c: &Coordinate| c.ratio == 1.0 && !std::mem::replace(&mut seen[c.v.0], true);
            link.motion.has_constant_subspace()
                && link.motion.single_coordinate().is_none_or(&mut has_own_velocity)
        })
}
