//! Passive forces: those of springs, dashpots and the like.

use crate::expr::replace::replace;
use crate::expr::{Expr, Function};
use crate::kinematics::{energy_gradient, known_gradient, position, rate};
use crate::mechanism::{Model, Quantity};

/// Sum of the generalized forces of springs, dashpots and the like, with the sign of `h`: what resists motion is
/// positive. Without velocity, those of potential energies alone. Where another function computes them, they are given.
pub fn passive_forces<'g>(model: &Model<'g>, with_velocity: bool) -> Vec<Expr<'g>> {
    if let Some(passive) = model.passive.as_ref().filter(|_| with_velocity) {
        return passive.given_forces();
    }
    let g = model.graph;
    let mut h = vec![g.zero(); model.nv()];
    for spring in &model.springs {
        let stretch = position(model, &spring.on) - spring.free;
        h[spring.on.v.0] += spring.stiffness * stretch * g.num(spring.on.ratio);
    }
    for energy in &model.potentials {
        // ∂U/∂q along the velocities, at a given time: time itself does no work on the coordinates.
        for (k, d) in energy_gradient(model, *energy) {
            h[k] += d;
        }
    }
    if with_velocity {
        for dashpot in &model.dashpots {
            h[dashpot.on.v.0] += dashpot.damping * rate(model, &dashpot.on) * g.num(dashpot.on.ratio);
        }
        for dry in &model.frictions {
            let slip = (rate(model, &dry.on) / model.friction_speed).call(Function::Tanh);
            h[dry.on.v.0] += dry.friction * slip * g.num(dry.on.ratio);
        }
        for function in &model.dissipations {
            for (k, d) in known_gradient(model, *function) {
                h[k] += d;
            }
        }
        for load in &model.loads {
            let no_input = |s| matches!(Quantity::of(s), Quantity::Input(_)).then(|| g.zero());
            let force = replace(load.force, &no_input);
            for (k, d) in known_gradient(model, load.rate) {
                h[k] -= force * d;
            }
        }
    }
    h
}
