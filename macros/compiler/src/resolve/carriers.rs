//! Particles whose axes matter because a position, a direction or a joint is defined relative to them.

use crate::syntax::{Description, Expr, ExprKind, Target};

/// Whether the axes of a particle are used: by a joint on it, by `name.at(…)` or `name.x`, or by a force on
/// it.
pub fn uses_axes(d: &Description, name: &str) -> bool {
    let is_given_name = |e: &Expr| e.as_name() == Some(name);
    let acts_on_particle = |target: &Target| matches!(target, Target::On(e) if is_given_name(e));
    d.joints.iter().any(|joint| joint.parent.body.text == name)
        || d.points.iter().filter_map(|p| p.on.as_ref()).any(is_given_name)
        || d.outputs.iter().filter_map(|o| o.resolved_in.as_ref()).any(is_given_name)
        || d.bodies.iter().filter_map(|b| b.frame.as_ref()).any(is_given_name)
        || d.actions.iter().any(|action| acts_on_particle(&action.on))
        || position_expressions(d).into_iter().any(|e| contains_axes_of(e, name))
}

/// Returns whether an expression contains `name.at(…)` or an axis such as `name.x`.
fn contains_axes_of(e: &Expr, name: &str) -> bool {
    e.subexpressions().into_iter().any(|part| match &part.kind {
        ExprKind::Field(base, _) | ExprKind::Method(base, ..) => base.as_name() == Some(name),
        _ => false,
    })
}

/// Returns the expressions of a description that can contain positions.
pub fn position_expressions(d: &Description) -> Vec<&Expr> {
    let mut all: Vec<&Expr> = Vec::new();
    all.extend(d.bodies.iter().filter_map(|b| b.at.as_ref()));
    all.extend(d.particles.iter().filter_map(|p| p.at.as_ref()));
    all.extend(d.points.iter().flat_map(|p| p.on.iter().chain(&p.at)));
    all.extend(d.definitions.iter().chain(&d.outputs).map(|definition| &definition.value));
    all.extend(d.energies.iter().chain(&d.dissipations).map(|(_, e)| e));
    for c in &d.constraints {
        all.extend(c.other.iter().chain([&c.value]).chain(c.arguments.iter().map(|(_, e)| e)));
    }
    all.extend(d.contacts.iter().flat_map(|c| [&c.first, &c.second]));
    for action in &d.actions {
        match &action.on {
            Target::On(e) => all.push(e),
            Target::Between(a, b) => all.extend([a, b]),
        }
        all.extend(action.arguments.iter().map(|(_, e)| e));
    }
    all
}
