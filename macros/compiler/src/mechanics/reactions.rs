//! Joint reactions. In a mechanism with released joints they are the forces of inverse dynamics on the
//! released coordinates, minus those of the constraints and of the inputs. In a joint that closes a loop they
//! are the forces of its multipliers. If a loop is solved in closed form, its multipliers follow from the
//! condition that the two joints for which it is solved transmit no force along their own motion.

use super::crba::Matrix;
use super::{constraints, forces, rnea};
use crate::expr::replace::substitute_symbols_in_all;
use crate::expr::{Expr, Symbol};
use crate::kinematics::{joints_of_model, symbols_in};
use crate::mechanism::{ClosedFormJoint, Model, Quantity, ReleasedMechanism};

/// Number of components of a joint's reaction: force, torque.
const SIX: usize = 6;

/// Returns whether one of the expressions contains a reaction.
pub fn contains_reactions(e: &[Expr<'_>]) -> bool {
    symbols_in(e).into_iter().any(|s| matches!(Quantity::from_symbol(s), Quantity::Reaction(_)))
}

/// Returns the expressions with reactions replaced by expressions of `q`, `v`, `a` and the inputs;
/// multipliers are arguments. With `touched`, contact forces are included; otherwise they are zero.
pub fn replace_reactions<'g>(model: &Model<'g>, e: &[Expr<'g>], touched: bool) -> Vec<Expr<'g>> {
    let multiplier_of_symbol = |s: Symbol, all: &[Expr<'g>]| match Quantity::from_symbol(s) {
        Quantity::Reaction(k) => all.get(k.checked_sub(Quantity::MULTIPLIERS)?).copied(),
        _ => None,
    };
    let Some(released) = &model.released else {
        let all = constraints::multiplier_argument_symbols(model);
        return substitute_symbols_in_all(e, &|s| multiplier_of_symbol(s, &all));
    };
    let (held, multipliers) = forces_fixing_released_joints(model, released, touched);
    let expression_of_reaction_symbol = |s: Symbol| {
        let Quantity::Reaction(k) = Quantity::from_symbol(s) else { return None };
        if k >= Quantity::MULTIPLIERS {
            return multiplier_of_symbol(s, &multipliers);
        }
        let (joint, component) = (k / SIX, k % SIX);
        let index_among_released_joints = || released.joints.iter().position(|j| *j == joint);
        reaction_component_of_loop_joint(model, released, &multipliers, joint, component)
            .or_else(|| Some(held[SIX * index_among_released_joints()? + component]))
    };
    substitute_symbols_in_all(e, &expression_of_reaction_symbol)
}

/// Returns one component of the reaction of a joint that closes a loop; `None` for other joints.
fn reaction_component_of_loop_joint<'g>(
    model: &Model<'g>,
    released: &ReleasedMechanism<'g>,
    multipliers: &[Expr<'g>],
    joint: usize,
    component: usize,
) -> Option<Expr<'g>> {
    let mut sum = None;
    for (c, l) in released.model.constraints.iter().zip(multipliers) {
        for part in c.transmits.iter().filter(|part| part.joint == joint) {
            let sum = sum.get_or_insert(model.graph.zero());
            if part.torque == (component >= 3) {
                *sum += part.direction[component % 3] * *l;
            }
        }
    }
    sum.map(|e| {
        substitute_symbols_in_all(&[e], &|s| is_released_coordinate(model, s).then(|| model.graph.zero()))[0]
    })
}

/// Returns whether a symbol is a coordinate of a released joint, or the velocity of such a coordinate.
fn is_released_coordinate(model: &Model<'_>, s: Symbol) -> bool {
    match Quantity::from_symbol(s) {
        Quantity::Configuration(k) => k >= model.nq(),
        Quantity::Velocity(k) => k >= model.nv(),
        _ => false,
    }
}

/// Returns the forces that fix the coordinates of released joints at zero, and the multipliers of all
/// constraints.
fn forces_fixing_released_joints<'g>(
    model: &Model<'g>,
    released: &ReleasedMechanism<'g>,
    touched: bool,
) -> (Vec<Expr<'g>>, Vec<Expr<'g>>) {
    let (g, open) = (model.graph, &released.model);
    let joints = joints_of_model(open);
    let quantity_or_zero_if_released =
        |k: usize, q: Quantity| if k < model.nv() { q.expr(g) } else { g.zero() };
    let v: Vec<Expr<'g>> =
        (0..open.nv()).map(|k| quantity_or_zero_if_released(k, Quantity::Velocity(k))).collect();
    let a: Vec<Expr<'g>> =
        (0..open.nv()).map(|k| quantity_or_zero_if_released(k, Quantity::Acceleration(k))).collect();
    let mut forces_needed = rnea::inverse_dynamics(open, &joints, &v, Some(&a));
    let inputs = forces::generalized_forces_of_inputs(open, &joints);
    let mut multipliers = constraints::multiplier_argument_symbols(open);
    multipliers.truncate(model.constraints.len());
    let held = constraints::constraint_forces(open, &multipliers);
    for (k, force) in forces_needed.iter_mut().enumerate() {
        *force -= inputs[k] + held[k];
    }
    let rates = if touched { open.contact_rates() } else { Vec::new() };
    for (i, row) in constraints::jacobian_of_rates(open, &rates).into_iter().enumerate() {
        let force = Quantity::ContactForce(i).expr(g);
        forces_needed.iter_mut().zip(row).for_each(|(needed, entry)| *needed -= entry * force);
    }
    let set_open_symbols_to_zero = |e: &[Expr<'g>]| {
        substitute_symbols_in_all(e, &|s| is_released_coordinate(model, s).then(|| g.zero()))
    };
    let mut needed = set_open_symbols_to_zero(&forces_needed[model.nv()..]);
    let rows = constraints::jacobian(open).split_off(multipliers.len());
    let rows: Matrix<'g> = rows.iter().map(|row| set_open_symbols_to_zero(&row[model.nv()..])).collect();
    let solved = closed_form_multipliers(released, &needed, &rows);
    for (row, l) in rows.iter().zip(&solved) {
        needed.iter_mut().zip(row).for_each(|(force, entry)| *force -= *entry * *l);
    }
    multipliers.extend(solved);
    (needed, multipliers)
}

/// Returns the multipliers of the loops that are solved in closed form, two for each loop. `needed` are the
/// forces on the released coordinates, and `rows` are their changes per unit of each multiplier. The
/// multipliers make the forces along the motions of the joints zero for which the loops are solved.
fn closed_form_multipliers<'g>(
    released: &ReleasedMechanism<'g>,
    needed: &[Expr<'g>],
    rows: &Matrix<'g>,
) -> Vec<Expr<'g>> {
    let g = released.model.graph;
    let reaction_along_axis = |side: &ClosedFormJoint<'g>, forces: &[Expr<'g>]| {
        let at = released.joints.iter().position(|j| *j == side.joint)?;
        let first = SIX * at + if side.turns { 3 } else { 0 };
        Some((0..3).fold(g.zero(), |sum, k| sum + side.axis[k] * forces[first + k]))
    };
    let reaction_components_along_axes = |forces: &[Expr<'g>]| -> Vec<Expr<'g>> {
        released.model.solved.iter().filter_map(|side| reaction_along_axis(side, forces)).collect()
    };
    // Equations by side, with their right sides last. Two successive rows and columns belong to one loop.
    let columns: Vec<Vec<Expr<'g>>> = rows
        .iter()
        .map(|row| reaction_components_along_axes(row))
        .chain([reaction_components_along_axes(needed)])
        .collect();
    let sides = columns.last().map_or(0, Vec::len);
    let mut m: Matrix<'g> = (0..sides).map(|k| columns.iter().map(|column| column[k]).collect()).collect();
    for k in (0..sides).step_by(2) {
        let [a, b, c, d] = [m[k][k], m[k][k + 1], m[k + 1][k], m[k + 1][k + 1]];
        let inverse = g.one() / (a * d - b * c);
        for j in k + 2..=sides {
            let (upper, lower) = (m[k][j], m[k + 1][j]);
            m[k][j] = (d * upper - b * lower) * inverse;
            m[k + 1][j] = (a * lower - c * upper) * inverse;
        }
        for i in (0..sides).filter(|i| i / 2 != k / 2) {
            let [upper, lower] = [m[i][k], m[i][k + 1]];
            for j in k + 2..=sides {
                let part = upper * m[k][j] + lower * m[k + 1][j];
                m[i][j] -= part;
            }
        }
    }
    m.iter().map(|row| row[sides]).collect()
}
