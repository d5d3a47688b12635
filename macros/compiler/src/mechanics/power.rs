//! Power balance: `d(T + U)/dt = control + disturbance − dissipated` for a mechanism without motion
//! prescribed in time. Force elements are conservative (in `U`), dissipative, control (inputs) or disturbance
//! (other applied forces), as in Table 1.4 of Bernstein, Goel and Ansari.

use super::{forces, velocity_symbols};
use crate::expr::replace::substitute_symbols;
use crate::expr::{Expr, Function};
use crate::kinematics::{Joint, coordinate_velocity, velocity_gradient};
use crate::mechanism::{Load, Model, Quantity};

/// Returns the power dissipated by dashpots, friction, dissipation functions and dissipative loads.
pub fn dissipated_power<'g>(model: &Model<'g>) -> Expr<'g> {
    let g = model.graph;
    let mut power = g.zero();
    for dashpot in &model.dashpots {
        power += dashpot.damping * coordinate_velocity(model, &dashpot.on).square();
    }
    for dry in &model.frictions {
        let speed = coordinate_velocity(model, &dry.on);
        power += dry.friction * (speed / model.friction_speed).apply_function(Function::Tanh) * speed;
    }
    for function in &model.dissipations {
        for (k, d) in velocity_gradient(*function) {
            power += d * Quantity::Velocity(k).expr(g);
        }
    }
    let taken = model.loads.iter().filter(|l| l.dissipative);
    taken.fold(power, |sum, load| sum - load.force * load.rate)
}

/// Returns the power of the inputs, `v · τ(u)`.
pub fn control_power<'g>(model: &Model<'g>, joints: &[Joint<'g>]) -> Expr<'g> {
    let tau = forces::generalized_forces_of_inputs(model, joints);
    tau.iter().zip(velocity_symbols(model)).fold(model.graph.zero(), |sum, (tau, v)| sum + *tau * v)
}

/// Returns the power of disturbances: loads that are neither conservative nor dissipative, with inputs set to
/// zero.
pub fn disturbance_power<'g>(model: &Model<'g>) -> Expr<'g> {
    let g = model.graph;
    let force_without_inputs = |load: &Load<'g>| {
        substitute_symbols(load.force, &|s| {
            matches!(Quantity::from_symbol(s), Quantity::Input(_)).then(|| g.zero())
        })
    };
    let applied = model.loads.iter().filter(|l| !l.dissipative);
    applied.fold(g.zero(), |sum, load| sum + force_without_inputs(load) * load.rate)
}
