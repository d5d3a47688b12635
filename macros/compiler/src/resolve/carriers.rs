//! Particles whose axes matter because a position, a direction or a joint is defined relative to them.

use crate::syntax::{Description, Expr, ExprKind, Target};

/// Whether the axes of a particle are used: by a joint on it, by `name.at(…)` or `name.x`, or by a force on
/// it.
pub fn are_particle_axes_used(d: &Description, name: &str) -> bool {
    let has_searched_name = |e: &Expr| e.as_name() == Some(name);
    let acts_on_particle = |target: &Target| matches!(target, Target::On(e) if has_searched_name(e));
    d.joints.iter().any(|joint| joint.parent.body.text == name)
        || d.points.iter().filter_map(|p| p.on.as_ref()).any(has_searched_name)
        || d.outputs.iter().filter_map(|o| o.resolved_in.as_ref()).any(has_searched_name)
        || d.bodies.iter().filter_map(|b| b.frame.as_ref()).any(has_searched_name)
        || d.actions.iter().any(|action| acts_on_particle(&action.on))
        || expressions_that_may_contain_positions(d).into_iter().any(|e| uses_axes_or_points_of(e, name))
}

/// Returns whether an expression contains `name.at(…)` or an axis such as `name.x`.
fn uses_axes_or_points_of(e: &Expr, name: &str) -> bool {
    e.all_subexpressions().into_iter().any(|part| match &part.kind {
        ExprKind::Field(base, _) | ExprKind::Method(base, ..) => base.as_name() == Some(name),
        _ => false,
    })
}

/// Returns the expressions of a description that can contain positions.
pub fn expressions_that_may_contain_positions(d: &Description) -> Vec<&Expr> {
    let mut all: Vec<&Expr> = Vec::new();
    all.extend(d.bodies.iter().filter_map(|b| b.at.as_ref()));
    all.extend(d.particles.iter().filter_map(|p| p.at.as_ref()));
    all.extend(d.points.iter().flat_map(|p| p.on.iter().chain(&p.at)));
    all.extend(d.definitions.iter().chain(&d.outputs).map(|definition| &definition.value));
    all.extend(d.energies.iter().chain(&d.dissipations).map(|(_, e)| e));
    for c in &d.constraints {
        all.extend(c.other.iter().chain([&c.value]).chain(c.arguments.keyed_expressions().map(|(_, e)| e)));
    }
    all.extend(d.contacts.iter().flat_map(|c| [&c.first, &c.second]));
    for action in &d.actions {
        match &action.on {
            Target::On(e) => all.push(e),
            Target::Between(a, b) => all.extend([a, b]),
        }
        all.extend(action.arguments.keyed_expressions().map(|(_, e)| e));
    }
    all
}
