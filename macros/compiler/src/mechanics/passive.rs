//! Passive forces: forces of springs, dashpots, friction and other elements that act without inputs.

use crate::expr::replace::substitute_symbols;
use crate::expr::{Expr, Function};
use crate::kinematics::{
    cached_velocity_gradient, coordinate_in_terms_of_q, coordinate_velocity,
    generalized_force_opposing_energy,
};
use crate::mechanism::{Model, Quantity};

/// Returns the generalized forces of springs, dashpots, friction, potentials and loads, with the sign of `h`:
/// resistance to motion is positive. Without `with_velocity`, returns only the forces of potential energies.
/// If another function computes the passive forces, returns its results as symbols.
pub fn passive_forces<'g>(model: &Model<'g>, with_velocity: bool) -> Vec<Expr<'g>> {
    if let Some(passive) = model.passive.as_ref().filter(|_| with_velocity) {
        return passive.forces_as_arguments();
    }
    let g = model.graph;
    let mut h = vec![g.zero(); model.nv()];
    for spring in &model.springs {
        let stretch = coordinate_in_terms_of_q(model, &spring.on) - spring.free;
        h[spring.on.v.0] += spring.stiffness * stretch * g.num(spring.on.ratio);
    }
    for energy in &model.potentials {
        // ∂U/∂q along the velocities at constant time, since time itself does no work on the coordinates.
        for (k, d) in generalized_force_opposing_energy(model, *energy) {
            h[k] += d;
        }
    }
    if with_velocity {
        for dashpot in &model.dashpots {
            h[dashpot.on.v.0] +=
                dashpot.damping * coordinate_velocity(model, &dashpot.on) * g.num(dashpot.on.ratio);
        }
        for dry in &model.frictions {
            let slip =
                (coordinate_velocity(model, &dry.on) / model.friction_speed).apply_function(Function::Tanh);
            h[dry.on.v.0] += dry.friction * slip * g.num(dry.on.ratio);
        }
        for function in &model.dissipations {
            for (k, d) in cached_velocity_gradient(model, *function) {
                h[k] += d;
            }
        }
        for load in &model.loads {
            let zero_for_input_symbol =
                |s| matches!(Quantity::from_symbol(s), Quantity::Input(_)).then(|| g.zero());
            let force = substitute_symbols(load.force, &zero_for_input_symbol);
            for (k, d) in cached_velocity_gradient(model, load.rate) {
                h[k] -= force * d;
            }
        }
    }
    h
}
