//! Attribution of expressions to fields and arguments, for notes of errors.

use crate::language::Callable;
use crate::syntax::{Callee, Description, Expr, ExprKind, Target};

/// Returns the argument and the field that contain an expression, as in ``in `com` of `arm` ``; empty if
/// unknown.
pub fn location_text_of_expression(d: &Description, e: &Expr) -> String {
    let contains_expression =
        |whole: &&Expr| whole.all_subexpressions().into_iter().any(|part| std::ptr::eq(part, e));
    let found = expressions_with_owners(d).into_iter().find(|(.., whole)| contains_expression(whole));
    match found {
        Some(("", field, _)) => format!(" in `{field}`"),
        Some((argument, field, _)) => format!(" in `{argument}` of `{field}`"),
        None => String::new(),
    }
}

/// Returns the solid that has an expression as an argument, with its syntax.
pub fn solid_containing_argument<'a>(d: &'a Description, e: &Expr) -> Option<(&'a Expr, String)> {
    let inertias = d.bodies.iter().filter_map(|body| body.inertia.as_ref());
    inertias.flat_map(Expr::all_subexpressions).find_map(|call| {
        let ExprKind::Call(Callee { id: Some(Callable::Solid(solid)), .. }, arguments) = &call.kind else {
            return None;
        };
        let holds =
            arguments.iter().any(|a| a.all_subexpressions().into_iter().any(|part| std::ptr::eq(part, e)));
        holds.then(|| (call, solid.usage_syntax()))
    })
}

type ExpressionsWithOwners<'a> = Vec<(&'static str, &'a str, &'a Expr)>;

/// Returns every expression of a description with the argument and the field in which it is written.
fn expressions_with_owners(d: &Description) -> ExpressionsWithOwners<'_> {
    let mut all: ExpressionsWithOwners<'_> = Vec::new();
    all.extend(d.gravity.iter().map(|e| ("gravity", d.name.text.as_str(), e)));
    for (k, unit) in &d.units {
        all.extend(d.parameters.get(*k).map(|p| ("unit", p.text.as_str(), unit)));
    }
    for body in &d.bodies {
        let name = body.name.text.as_str();
        let parts = [
            ("mass", &body.mass),
            ("com", &body.com),
            ("inertia", &body.inertia),
            ("about", &body.about),
            ("at", &body.at),
        ];
        all.extend(parts.into_iter().filter_map(|(word, e)| Some((word, name, e.as_ref()?))));
    }
    for particle in &d.particles {
        let name = particle.name.text.as_str();
        all.push(("mass", name, &particle.mass));
        all.extend(particle.at.iter().map(|e| ("at", name, e)));
    }
    for joint in &d.joints {
        let name = joint.name.text.as_str();
        let ends = [&joint.parent, &joint.child];
        all.extend(ends.iter().flat_map(|end| end.at.iter().map(|e| ("at", name, e))));
        all.extend(ends.iter().flat_map(|end| end.rotated.iter().map(|e| ("rotated", name, e))));
        all.extend(joint.about.iter().map(|e| ("about", name, e)));
        all.extend(joint.along.iter().map(|e| ("along", name, e)));
        all.extend(joint.pitch.iter().map(|e| ("pitch", name, e)));
        all.extend(joint.lead.iter().map(|e| ("lead", name, e)));
    }
    for action in &d.actions {
        let name = action.name.text.as_str();
        let (Target::On(first) | Target::Between(first, _)) = &action.on;
        all.push(("on", name, first));
        if let Target::Between(_, second) = &action.on {
            all.push(("between", name, second));
        }
        all.extend(action.arguments.keyed_expressions().map(|(key, e)| (key.name(), name, e)));
    }
    for point in &d.points {
        all.extend(point.at.iter().map(|e| ("at", point.name.text.as_str(), e)));
    }
    for frame in &d.frames {
        all.extend(frame.rotations.iter().map(|e| ("", frame.name.text.as_str(), e)));
    }
    let definitions = d.definitions.iter().chain(&d.outputs).map(|d| (&d.name, &d.value));
    let energies = d.energies.iter().chain(&d.dissipations).map(|(name, e)| (name, e));
    all.extend(definitions.chain(energies).map(|(name, e)| ("", name.text.as_str(), e)));
    for constraint in &d.constraints {
        let sides = [Some(&constraint.value), constraint.other.as_ref()].into_iter().flatten();
        all.extend(sides.map(|e| ("", constraint.name.text.as_str(), e)));
        let name = constraint.name.text.as_str();
        all.extend(constraint.arguments.keyed_expressions().map(|(key, e)| (key.name(), name, e)));
    }
    all
}
