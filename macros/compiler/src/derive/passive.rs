//! Passive forces that are long have functions of their own, which the other functions call.

use crate::expr::Expr;
use crate::lower::size;
use crate::machine::CALLED_OPERATIONS;
use crate::mechanics::derivatives::symbolic;
use crate::mechanics::passive::passive_forces;
use crate::mechanism::{Model, PassiveForces};
use std::rc::Rc;

/// The model with passive forces that are given, if they are long enough; their derivatives are found only if they are asked for.
pub(super) fn with_given_forces<'g>(model: &Model<'g>, derivatives: bool) -> Option<Model<'g>> {
    if operations(model) < CALLED_OPERATIONS {
        return None;
    }
    let forces = passive_forces(model, true);
    let passive = match derivatives {
        true => {
            let found = symbolic::derivatives(model, &forces);
            PassiveForces::new(forces, &found.by_q, &found.by_v)
        }
        false => PassiveForces::new(forces, &[], &[]),
    };
    Some(Model { passive: Some(Rc::new(passive)), ..model.clone() })
}

/// Operations of what the elements store and dissipate, and of the forces and rates of all others: nothing is derived for it.
fn operations(model: &Model<'_>) -> usize {
    let energies = model.potentials.iter().chain(&model.dissipations).copied();
    let loads = model.loads.iter().flat_map(|load| [load.rate, load.force]);
    size(&energies.chain(loads).collect::<Vec<Expr<'_>>>(), &|_| false)
}
