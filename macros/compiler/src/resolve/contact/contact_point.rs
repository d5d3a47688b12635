//! A convex body that rolls or slips on a surface given by its points: `surface(u, w, point)`. The contact
//! point has no closed form. The parameters `u` and `w` of the surface are therefore massless coordinates.
//! Constraints determine them such that the body's farthest point against the normal coincides with the point
//! of the surface.

use super::geometry::PointContact;
use super::pair::{SurfacePair, support_point};
use super::surface::ParametricSurface;
use crate::diag::Diagnostics;
use crate::expr::Vec3;
use crate::expr::diff::DirectionalDerivative;
use crate::kinematics::symbols_in;
use crate::mechanism::{Coordinate, Quantity};
use crate::resolve::scope::{AllowedQuantities, Context, PlacedElement, Scope};
use crate::syntax;

impl<'g> SurfacePair<'_, 'g> {
    /// Returns the contact of a convex body, with the distances that determine the coordinates of the
    /// surface.
    pub(super) fn contact_of_convex_body(&self, sheet: &ParametricSurface<'g>) -> Option<PointContact<'g>> {
        let second_surface_to_common_axes = |v| self.direction_of_second_body(v).value;
        let [u, w] = sheet.tangents.map(second_surface_to_common_axes);
        let first = u.map(|x| x / u.norm());
        let across = u.cross(w);
        let normal = across.map(|x| x / across.norm());
        let second = normal.cross(first);
        let point = -support_point(&self.a.form, normal, 0.0, &|v| self.direction_of_first_body(v).value)?;
        let offset = self.center.value - self.base.value + point - second_surface_to_common_axes(sheet.point);
        Some(PointContact {
            gap: normal.dot(offset),
            point,
            axes: [("normal", normal), ("first", first), ("second", second)],
            conditions: vec![("foot_first", first.dot(offset)), ("foot_second", second.dot(offset))],
        })
    }
}

/// Parses the points of a surface, in the axes of its body, with the two coordinates on which they
/// depend.
pub(super) fn resolve_parametric_surface<'g>(
    scope: &Scope<'_, 'g>,
    frame: &PlacedElement<'g>,
    [u, w, point]: [&syntax::Expr; 3],
    cx: &mut Diagnostics,
) -> Option<ParametricSurface<'g>> {
    let (first, second) = (declared_coordinate(scope, u, cx), declared_coordinate(scope, w, cx));
    let context = Context::new(AllowedQuantities::Placement, Some((frame.link, frame.pose.clone())));
    let terms = scope.call_in_context(context, |scope| scope.resolve_vector_terms(point, cx));
    let (first, second, terms) = (first?, second?, terms?);
    let zero = Vec3::zero(scope.graph);
    let in_link = scope.kinematics.components_in_link_axes(&terms, frame.link, zero);
    let position = frame.pose.rotation.vector_in_child_axes(in_link);
    let is_allowed_quantity = |q: Quantity| match q {
        Quantity::Configuration(k) => k == first.q.0 || k == second.q.0,
        q => matches!(q, Quantity::Parameter(_)),
    };
    if !symbols_in(&position.0).into_iter().all(|s| is_allowed_quantity(Quantity::from_symbol(s))) {
        cx.report_error(point.place.clone(), "the points of a surface depend only on its two coordinates")
            .add_help("parameters and the axes of the body of the surface are allowed as well");
        return None;
    }
    let position_derivatives = |c: &Coordinate| {
        let mut d =
            DirectionalDerivative::with_respect_to(Quantity::Configuration(c.q.0).symbol(), scope.graph);
        position.map(|e| d.differentiate(e))
    };
    let tangents = [position_derivatives(&first), position_derivatives(&second)];
    if tangents[0].cross(tangents[1]).is_zero() {
        cx.report_error(
            point.place.clone(),
            "these points do not form a surface: they do not depend on both coordinates",
        )
        .add_help(
            "write the points as a function of two coordinates, as in `surface(u, w, u * x + w * y + u * \
             w / size * z)`",
        );
        return None;
    }
    Some(ParametricSurface { point: position, tangents })
}

/// Returns the coordinate with this name, which must be declared as a field of its own.
fn declared_coordinate<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<Coordinate> {
    let kinematics = &scope.kinematics;
    let coordinate_names = || scope.description.coordinates.iter().map(|c| c.name.text.as_str());
    let name = e.as_name().unwrap_or("");
    let found =
        kinematics.coordinates.iter().find(|(n, ..)| n == name && coordinate_names().any(|k| k == name));
    if found.is_none() && (name.is_empty() || scope.record_first_report(name, cx)) {
        cx.report_error(e.place.clone(), "expected a coordinate of the surface")
            .suggest_name(name, coordinate_names())
            .add_help("declare it as a field of its own: `u: Coordinate`");
    }
    found.map(|(_, c, _)| *c)
}
