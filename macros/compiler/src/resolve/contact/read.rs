//! Resolution of surfaces, written as `body.form(arguments)`.

use super::contact_point::resolve_parametric_surface;
use super::hull::read_hull;
use super::surface::{Surface, SurfaceForm};
use super::terrain::read_terrain;
use crate::diag::{Diagnostics, join_names_with_and};
use crate::expr::{Expr, Vec3};
use crate::language::{Argument, ArgumentKind, BodyOrInertiaMethod, SurfaceId};
use crate::mechanism::Rule;
use crate::resolve::scope::{AllowedQuantities, Context, Scope};
use crate::syntax::{self, ExprKind, GROUND};
use std::f64::consts::FRAC_PI_2;

/// Parses `body.form(arguments)`; `example` is the syntax of a pair, for errors.
pub fn read_surface<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    example: &str,
    cx: &mut Diagnostics,
) -> Option<Surface<'g>> {
    let ExprKind::Method(base, word, arguments) = &e.kind else {
        let error = cx.report_error(e.place.clone(), "expected a surface");
        match e.as_name() {
            Some(GROUND) => error.add_help("write `ground.plane(z)`"),
            Some(name) => {
                error.add_help(format!("write `{name}.circle(radius, y)`, `{name}.sphere(radius)`, …"))
            }
            None => error.add_help(example),
        };
        return None;
    };
    let Some(BodyOrInertiaMethod::Surface(id)) = word.id else {
        let error = cx.report_error(word.place.clone(), format!("unknown surface `{}`", word.text));
        error.suggest_name(&word.text, SurfaceId::names());
        if error.has_no_help() {
            let mut list: Vec<String> = SurfaceId::names().map(|word| format!("`{word}`")).collect();
            list.dedup();
            error.add_help(format!("the surfaces are {}", join_names_with_and(&list)));
        }
        return None;
    };
    let row = id.row();
    let frame = scope.resolve_placement(base, cx);
    if arguments.len() != row.arguments.len() {
        let usage = format!(
            "this surface is written `{}({})`",
            row.name,
            Argument::list_argument_names(row.arguments)
        );
        cx.report_error(word.place.clone(), usage)
            .add_help("lengths are in m, angles in rad, axes in those of the body");
        return None;
    }
    match (id, arguments.as_slice()) {
        (SurfaceId::ParametricSurface, [u, w, point]) => {
            let frame = frame?;
            let form =
                SurfaceForm::ParametricSurface(resolve_parametric_surface(scope, &frame, [u, w, point], cx)?);
            return Some(Surface { frame, form });
        }
        (SurfaceId::Terrain, [height]) => {
            let terrain = read_terrain(scope, height, cx);
            return Some(Surface { frame: frame?, form: SurfaceForm::Terrain(Box::new(terrain?)) });
        }
        (SurfaceId::Hull, [points]) => return read_hull(scope, frame, points, cx),
        _ => {}
    }
    let (mut numbers, mut axis) = (Vec::new(), None);
    for (e, Argument { name, kind }) in arguments.iter().zip(row.arguments) {
        let context = Context::new(AllowedQuantities::Constant, None);
        if kind.is_direction() {
            axis = Some(scope.call_in_context(context, |s| s.resolve_unit_vector(e, false, cx))?);
            continue;
        }
        let value = scope.call_in_context(context, |s| s.resolve_scalar(e, cx))?;
        let is_angle = *kind == ArgumentKind::HalfAngle;
        if !check_size(is_angle, e, value, cx) {
            return None;
        }
        let rule = if is_angle { Rule::HalfAngle } else { Rule::Positive };
        let describe_quantity = || format!("the {} of a {}", name.replace('_', " "), row.name);
        scope.record_parameter_condition(rule, describe_quantity, &[value]);
        numbers.push(value);
    }
    Some(Surface {
        frame: frame?,
        form: surface_form_from_numbers(id, &numbers, axis.unwrap_or_else(|| Vec3::zero(scope.graph)))?,
    })
}

/// Returns the form of a surface with the values of its lengths and angles, and its direction.
fn surface_form_from_numbers<'g>(
    id: SurfaceId,
    numbers: &[Expr<'g>],
    n: Vec3<'g>,
) -> Option<SurfaceForm<'g>> {
    let number_at_index = |k: usize| numbers.get(k).copied();
    Some(match id {
        SurfaceId::Circle => SurfaceForm::Circle(number_at_index(0)?, n),
        SurfaceId::Torus => SurfaceForm::Torus(number_at_index(0)?, number_at_index(1)?, n),
        SurfaceId::Sphere => SurfaceForm::Sphere(number_at_index(0)?),
        SurfaceId::Ellipsoid => {
            SurfaceForm::Ellipsoid([number_at_index(0)?, number_at_index(1)?, number_at_index(2)?])
        }
        SurfaceId::Plane => SurfaceForm::Plane(n),
        SurfaceId::Bowl => SurfaceForm::Bowl(number_at_index(0)?),
        SurfaceId::Cylinder => SurfaceForm::Cylinder(number_at_index(0)?, n),
        SurfaceId::Drum => SurfaceForm::Drum(number_at_index(0)?, number_at_index(1)?, n),
        SurfaceId::Tube => SurfaceForm::Tube(number_at_index(0)?, n),
        SurfaceId::Cone => SurfaceForm::Cone(number_at_index(0)?, n),
        SurfaceId::Funnel => SurfaceForm::Funnel(number_at_index(0)?, n),
        SurfaceId::Cuboid => {
            SurfaceForm::Cuboid([number_at_index(0)?, number_at_index(1)?, number_at_index(2)?])
        }
        SurfaceId::Capsule => SurfaceForm::Capsule(number_at_index(0)?, number_at_index(1)?, n),
        // The arguments of these surfaces are not numbers and a direction.
        SurfaceId::ParametricSurface | SurfaceId::Terrain | SurfaceId::Hull => return None,
    })
}

/// Reports a length that is not positive, and a half angle that is not between 0 and π/2. Returns false then.
fn check_size(is_angle: bool, e: &syntax::Expr, value: Expr<'_>, cx: &mut Diagnostics) -> bool {
    let Some(n) = value.constant_value() else { return true };
    if is_angle {
        if n <= 0.0 || n >= FRAC_PI_2 {
            cx.report_error(e.place.clone(), format!("this half angle is not between 0 and π/2: it is {n}"))
                .add_help("it is the angle between the axis and the surface, rad");
            return false;
        }
    } else if n <= 0.0 {
        cx.report_error(e.place.clone(), format!("this length must be positive, but it is {n}"))
            .add_help("lengths are positive: the kind of the surface determines its side");
        return false;
    }
    true
}
