//! Masses of bodies and particles, which are added to the links that carry them.

use super::inertia::check_inertia;
use super::range::FiniteParameterRange;
use super::scope::{MassProperties, Scope};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Sym3, Vec3};
use crate::language::{Callable, Solid};
use crate::mechanism::{Model, Rule};
use crate::syntax::{self, Body, Callee, ExprKind, InertiaOption, Particle};

/// Returns the mass of a particle.
pub fn resolve_particle_mass<'g>(
    scope: &Scope<'_, 'g>,
    particle: &Particle,
    cx: &mut Diagnostics,
) -> Option<Expr<'g>> {
    let mass = scope.resolve_scalar(&particle.mass, cx);
    if let Some(mass) = mass {
        FiniteParameterRange::range_of_scalar_type(&scope.description.scalar).check_mass_in_range(
            mass,
            &particle.mass.place,
            cx,
        );
        scope.record_parameter_condition(
            Rule::Mass,
            || format!("the mass of `{}`", particle.name.text),
            &[mass],
        );
    }
    if let Some(m) = mass.and_then(|m| m.constant_value()).filter(|m| *m <= 0.0) {
        cx.report_error(
            particle.mass.place.clone(),
            format!("the mass of `{}` must be positive, but it is {m}", particle.name.text),
        )
        .add_help("a point without mass is a `Point`");
    }
    mass
}

/// Reports inertial parameters whose products are not finite.
pub fn check_products_of_inertial_parameters<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    cx: &mut Diagnostics,
) {
    if !cx.is_empty() {
        return;
    }
    let range = FiniteParameterRange::range_of_scalar_type(&scope.description.scalar);
    let is_infinite =
        |e: &Expr<'g>| e.constant_value().is_some_and(|n| !n.is_finite() || n.abs() > range.max);
    for body in &scope.description.bodies {
        let placed = scope.kinematics.places.get(&body.name.text);
        let Some(link) = placed.and_then(|placed| placed.link) else { continue };
        let i = &model.links[link.0].inertia;
        let all = i.moment.0.iter().chain(&i.tensor.diagonal).chain(&i.tensor.off).chain([&i.mass]);
        if all.into_iter().any(is_infinite) {
            let name = &body.name;
            cx.report_error(
                name.place.clone(),
                format!("the inertial parameters of `{}` are too large", name.text),
            )
            .add_help("mass times the square of the distance from the joint overflows in products");
            return;
        }
    }
}

/// Returns mass, centre of mass and central inertia of a body.
pub fn body_mass_properties<'g>(
    scope: &Scope<'_, 'g>,
    body: &Body,
    cx: &mut Diagnostics,
) -> Option<MassProperties<'g>> {
    let graph = scope.graph;
    let name = &body.name.text;
    let mass = body.mass.as_ref().map_or(Some(graph.zero()), |e| scope.resolve_scalar(e, cx));
    if let Some(mass) = mass {
        scope.record_parameter_condition(Rule::Mass, || format!("the mass of `{name}`"), &[mass]);
    }
    let com = body.com.as_ref().map_or(Some(Vec3::zero(graph)), |e| scope.resolve_own_axes_vector(e, cx));
    let inertia = body.inertia.as_ref().map_or(Some(Sym3::zero(graph)), |e| scope.resolve_inertia(e, cx));
    let inertia = match &body.about {
        Some(about) => inertia_about_center(scope, body, about, (mass, com, inertia), cx),
        None => inertia,
    };
    if let (Some(e), Some(m)) = (&body.mass, mass.and_then(|m| m.constant_value()))
        && m < 0.0
    {
        cx.report_error(e.place.clone(), format!("the mass of `{name}` cannot be negative, but it is {m}"))
            .add_help("a mass is zero or more, kg; the sign belongs to gravity");
    }
    let range = FiniteParameterRange::range_of_scalar_type(&scope.description.scalar);
    let mut is_valid = true;
    if let (Some(e), Some(m)) = (&body.mass, mass) {
        is_valid &= range.check_mass_in_range(m, &e.place, cx);
    }
    if let (Some(e), Some(com)) = (&body.com, com) {
        is_valid &= com.0.iter().all(|c| range.check_length(*c, &e.place, cx));
    }
    if let (Some(e), Some(i)) = (&body.inertia, &inertia) {
        is_valid = is_valid && i.diagonal.iter().all(|c| range.check_mass_in_range(*c, &e.place, cx));
    }
    if !is_valid {
        return None;
    }
    if let (Some(e), Some(inertia)) = (&body.inertia, &inertia)
        && scope.description.inertias == InertiaOption::Check
    {
        let hint = match e.place.file {
            None if body.about.is_some() => {
                "these are the moments about the centre of mass, transformed from `about`; to accept the \
                 inertia unchanged, write `#[mechanism(…, inertia = trust)]`"
            }
            Some(_) => {
                "correct the file, or write `#[mechanism(urdf = \"…\", inertia = trust)]` to accept the \
                 inertia unchanged"
            }
            None => "to accept the inertia unchanged, write `#[mechanism(…, inertia = trust)]`",
        };
        check_inertia(name, mass.and_then(|m| m.constant_value()), inertia, &e.place, hint, cx);
    }
    let found = (mass?, com?, inertia?);
    record_inertia_requirements(scope, name, &found);
    Some(found)
}

/// Converts an inertia about another point to one about the centre of mass by the parallel-axis theorem.
fn inertia_about_center<'g>(
    scope: &Scope<'_, 'g>,
    body: &Body,
    about: &syntax::Expr,
    (mass, com, inertia): (Option<Expr<'g>>, Option<Vec3<'g>>, Option<Sym3<'g>>),
    cx: &mut Diagnostics,
) -> Option<Sym3<'g>> {
    let solid = body.inertia.as_ref().and_then(|e| {
        e.all_subexpressions().into_iter().find_map(|part| match &part.kind {
            ExprKind::Call(Callee { id: Some(Callable::Solid(solid)), .. }, _) => Some(*solid),
            _ => None,
        })
    });
    if let Some(solid) = solid.filter(|solid| *solid != Solid::Diagonal) {
        cx.report_error(
            about.place.clone(),
            format!("the inertia of a `{}` is about its centre", solid.name()),
        )
        .add_help(
            "remove `about`, and give the centre by `com`; `about` is for `diagonal(xx, yy, zz)` or \
                 a matrix",
        );
        return None;
    }
    let about = match about.literal_number() {
        Some(0.0) => Some(Vec3::zero(scope.graph)),
        _ => scope.resolve_own_axes_vector(about, cx),
    };
    Some(inertia? - Sym3::point_mass_inertia(mass?, com? - about?))
}

/// Adds the requirements for inertial parameters that can be checked only at run time, when their
/// parameters have values.
fn record_inertia_requirements<'g>(
    scope: &Scope<'_, 'g>,
    name: &str,
    (mass, com, inertia): &MassProperties<'g>,
) {
    for c in com.0 {
        scope.record_parameter_condition(Rule::Length, || format!("the centre of mass of `{name}`"), &[c]);
    }
    let entries: Vec<Expr<'g>> = inertia.diagonal.iter().chain(&inertia.off).chain([mass]).copied().collect();
    let describe_inertia = || format!("the inertia of `{name}`");
    match scope.description.inertias {
        InertiaOption::Check => scope.record_parameter_condition(Rule::Inertia, describe_inertia, &entries),
        _ => entries
            .iter()
            .for_each(|entry| scope.record_parameter_condition(Rule::Finite, describe_inertia, &[*entry])),
    }
}
