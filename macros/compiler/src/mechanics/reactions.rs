//! What joints transmit: in a mechanism with opened joints the forces that inverse dynamics asks for on their
//! coordinates, less those of the constraints and of the inputs; in a joint that closes a loop the forces of its
//! multipliers.

use super::kinematics::joints;
use super::{constraints, forces, rnea};
use crate::expr::replace::replace_all;
use crate::expr::{Expr, Symbol};
use crate::model::kinematics::symbols_in;
use crate::model::{Model, Opened, Quantity};

/// Components of a joint's reaction: force, torque.
const SIX: usize = 6;

/// True if an expression names a reaction.
pub fn names_one(e: &[Expr<'_>]) -> bool {
    symbols_in(e).into_iter().any(|s| matches!(Quantity::of(s), Quantity::Reaction(_)))
}

/// Expressions with the reactions in place: of `q`, `v`, `a`, the inputs, and the multipliers as given numbers.
pub fn resolved<'g>(model: &Model<'g>, e: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let opened = model.opened.as_ref().map(|opened| (opened, on_open_coordinates(model, opened)));
    let of = |s: Symbol| {
        let Quantity::Reaction(k) = Quantity::of(s) else { return None };
        let (joint, component) = (k / SIX, k % SIX);
        let at = opened.as_ref().and_then(|(o, all)| Some((all, o.joints.iter().position(|j| *j == joint)?)));
        let closing = of_multipliers(model, joint, component);
        Some(closing.or_else(|| at.map(|(all, at)| all[SIX * at + component])).unwrap_or(model.graph.zero()))
    };
    replace_all(e, &of)
}

/// The component of what a loop's joint transmits; `None` if it closes none.
fn of_multipliers<'g>(model: &Model<'g>, joint: usize, component: usize) -> Option<Expr<'g>> {
    let mut sum = None;
    for (k, c) in model.constraints.iter().enumerate() {
        for part in c.transmits.iter().filter(|part| part.joint == joint) {
            let sum = sum.get_or_insert(model.graph.zero());
            if part.torque == (component >= 3) {
                *sum += part.direction[component % 3] * Quantity::Given(k).expr(model.graph);
            }
        }
    }
    sum
}

/// The forces that hold the coordinates of opened joints at zero.
fn on_open_coordinates<'g>(model: &Model<'g>, opened: &Opened<'g>) -> Vec<Expr<'g>> {
    let (g, open) = (model.graph, &opened.model);
    let joints = joints(open);
    let closed = |k: usize, q: Quantity| if k < model.nv() { q.expr(g) } else { g.zero() };
    let v: Vec<Expr<'g>> = (0..open.nv()).map(|k| closed(k, Quantity::Velocity(k))).collect();
    let a: Vec<Expr<'g>> = (0..open.nv()).map(|k| closed(k, Quantity::Acceleration(k))).collect();
    let mut forces_needed = rnea::inverse_dynamics(open, &joints, &v, Some(&a));
    let inputs = forces::generalized_forces(open, &joints);
    let held = constraints::forces(open, &constraints::multipliers(open));
    for (k, force) in forces_needed.iter_mut().enumerate() {
        *force -= inputs[k] + held[k];
    }
    let is_open = |s: Symbol| match Quantity::of(s) {
        Quantity::Configuration(k) => k >= model.nq(),
        Quantity::Velocity(k) => k >= model.nv(),
        _ => false,
    };
    replace_all(&forces_needed[model.nv()..], &|s| is_open(s).then(|| g.zero()))
}
