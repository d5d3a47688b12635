//! Pairs of surfaces in contact. Surfaces of a rolling pair have equal velocities at the contact; those of a
//! slipping pair do not. The contact point has a closed form. A convex body touches a plane at its farthest
//! point along the normal (its support function). A sphere touches along the normal through its centre. Cones
//! touch along a line. On a surface given by its points, two coordinates determine the contact point.

mod boxes;
mod candidates;
mod coefficients;
mod collision;
mod cones;
mod contact_point;
mod curves;
mod cylinders;
mod drawing;
mod force;
mod geometry;
mod hull;
mod pair;
mod polytope_shapes;
mod polytopes;
mod read;
mod slipping;
mod soft;
mod stops;
mod surface;
mod terrain;
mod unilateral;

pub use drawing::surface_pieces;
pub use force::uses_contact_forces_consistently;
pub use slipping::{report_undetermined_normal_forces, slipping_rows};
pub use stops::resolve_stops;
pub use surface::Surface;
pub use terrain::TERRAIN_COORDINATES;
pub use unilateral::resolve_contact;

use super::rows::{ConstraintRows, constraint_from_residual_and_rate};
use super::scope::Scope;
use crate::diag::Diagnostics;
use crate::expr::Vec3;
use crate::kinematics::time_derivative;
use crate::language::Callable;
use crate::mechanism::{Constraint, FrictionTerm, MeasuredQuantity, Model};
use crate::syntax::{self, ExprKind};
use cones::constraint_rows_of_rolling_cone;
use geometry::PointContact;
use pair::{SurfacePair, surfaces_in_accepted_order};
use read::read_surface;
use surface::SurfaceForm;

const SUPPORTED_PAIRS: &str = "supported are a circle, a torus, a sphere, an ellipsoid or a cone on a plane; \
                               all but the cone on a surface given by its points; a sphere also on a sphere, \
                               a cylinder or a cone, or inside of a bowl, a tube or a funnel; a cone also on \
                               a cone or inside of a funnel";

/// Returns the constraint rows of a rolling pair; `None` after an error.
pub fn rolling_rows<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    constraint: &syntax::Constraint,
    cx: &mut Diagnostics,
) -> Option<ConstraintRows<'g>> {
    let pair = read_surface_pair(scope, model, constraint, cx)?;
    if let SurfaceForm::Cone(..) = pair.a.form {
        return constraint_rows_of_rolling_cone(scope, constraint, &pair, cx);
    }
    let contact = pair.contact_of_pair()?;
    let slip = pair.slip(contact.point);
    let mut rows = contact_rows(scope, constraint, &contact, slip, Vec::new());
    let [_, tangents @ ..] = contact.axes;
    for (word, e) in tangents {
        let name = format!("{}.{word}", constraint.name.text);
        rows.push(constraint_from_residual_and_rate(
            scope,
            (name, &constraint.name.place),
            MeasuredQuantity::Length,
            None,
            e.dot(slip),
        ));
    }
    let contact_point = Some(pair.contact_position(contact.point));
    let surfaces = pair.written_surfaces();
    Some(ConstraintRows { rows, contact_point, surfaces, redundant: Vec::new() })
}

/// Returns the rows that keep a pair in contact: the distance, with the friction caused by its normal
/// force, and the conditions for the contact coordinates of a surface given by its points.
fn contact_rows<'g>(
    scope: &Scope<'_, 'g>,
    constraint: &syntax::Constraint,
    contact: &PointContact<'g>,
    slip: Vec3<'g>,
    friction: Vec<FrictionTerm<'g>>,
) -> Vec<Constraint<'g>> {
    let ((word, normal), place) = (contact.axes[0], &constraint.name.place);
    // The normal of a surface given by its points depends on the contact coordinates. Away from the
    // contact, their velocities change the distance as well.
    let rate = match contact.conditions.is_empty() {
        true => normal.dot(slip),
        false => time_derivative(scope.configuration_space(), contact.gap),
    };
    let name_and_place_of_row = |word| (format!("{}.{word}", constraint.name.text), place);
    let distance = constraint_from_residual_and_rate(
        scope,
        name_and_place_of_row(word),
        MeasuredQuantity::Length,
        Some(contact.gap),
        rate,
    );
    let conditions = contact.conditions.iter().map(|(word, distance)| {
        let rate = time_derivative(scope.configuration_space(), *distance);
        let row = constraint_from_residual_and_rate(
            scope,
            name_and_place_of_row(word),
            MeasuredQuantity::Length,
            Some(*distance),
            rate,
        );
        Constraint { determines: true, ..row }
    });
    [Constraint { friction, ..distance }].into_iter().chain(conditions).collect()
}

/// Reports the errors of a pair.
pub fn report_surface_pair_errors<'g>(
    scope: &Scope<'_, 'g>,
    model: &Model<'g>,
    constraint: &syntax::Constraint,
    cx: &mut Diagnostics,
) {
    let _ = read_surface_pair(scope, model, constraint, cx);
}

/// Parses `rolls(surface, surface)` or `slips(surface, surface)`. The first surface of the result is the
/// one that rolls.
fn read_surface_pair<'s, 'g>(
    scope: &'s Scope<'_, 'g>,
    model: &Model<'g>,
    constraint: &syntax::Constraint,
    cx: &mut Diagnostics,
) -> Option<SurfacePair<'s, 'g>> {
    let e = &constraint.value;
    let kind = constraint.kind.surface_pair_function();
    let known = kind.map_or("", Callable::rolls_or_slips_name);
    let example = format!("write `{known}(disk.circle(radius, y), ground.plane(z))`");
    let (first, second) = match &e.kind {
        ExprKind::Call(word, pair) if word.id == kind && pair.len() == 2 => (&pair[0], &pair[1]),
        _ => {
            cx.report_error(e.place.clone(), format!("expected a pair that {known}")).add_help(example);
            return None;
        }
    };
    let a = read_surface(scope, first, &example, cx);
    // Two bodies written instead of two surfaces are one error.
    if a.is_none() && !matches!(second.kind, ExprKind::Method(..)) {
        return None;
    }
    let b = read_surface(scope, second, &example, cx);
    let pair = surfaces_in_accepted_order(scope, model, a?, b?, SurfaceForm::can_roll_on, second, cx)?;
    if !pair.a.form.can_roll_on(&pair.b.form) {
        cx.report_error(e.place.clone(), "the contact point of these surfaces is not supported")
            .add_help(SUPPORTED_PAIRS);
        return None;
    }
    Some(pair)
}

impl<'g> SurfaceForm<'g> {
    /// Whether the surface can roll on the other surface.
    fn can_roll_on(&self, b: &SurfaceForm<'g>) -> bool {
        let rollers = b.id().map_or(&[][..], |id| id.row().rollers);
        self.id().is_some_and(|id| rollers.contains(&id))
    }
}
