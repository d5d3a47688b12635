//! Separate functions for expensive passive forces, which the other generated functions call.

use crate::expr::Expr;
use crate::lower::operation_count;
use crate::machine::CALLED_OPERATIONS;
use crate::mechanics::derivatives::symbolic;
use crate::mechanics::passive::passive_forces;
use crate::mechanism::{Model, PassiveForces};
use std::rc::Rc;

/// Returns the model with passive forces as symbols if they take enough operations, otherwise `None`. Their
/// derivatives are computed only if `derivatives` is true.
pub(super) fn model_with_passive_force_symbols<'g>(
    model: &Model<'g>,
    derivatives: bool,
) -> Option<Model<'g>> {
    if passive_operation_count(model) < CALLED_OPERATIONS {
        return None;
    }
    let forces = passive_forces(model, true);
    let passive = match derivatives {
        true => {
            let found = symbolic::configuration_and_velocity_derivatives(model, &forces);
            PassiveForces::new(forces, &found.by_q, &found.by_v)
        }
        false => PassiveForces::new(forces, &[], &[]),
    };
    Some(Model { passive: Some(Rc::new(passive)), ..model.clone() })
}

/// Returns the number of operations of the elements' energies and dissipation functions, and of the forces
/// and velocities of all loads, without deriving the generalized forces.
fn passive_operation_count(model: &Model<'_>) -> usize {
    let energies = model.potentials.iter().chain(&model.dissipations).copied();
    let loads = model.loads.iter().flat_map(|load| [load.rate, load.force]);
    operation_count(&energies.chain(loads).collect::<Vec<Expr<'_>>>(), &|_| false)
}
