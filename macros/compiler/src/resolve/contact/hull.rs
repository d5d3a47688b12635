//! Convex hulls: `hull(points)`. A hull touches planes and terrains with its vertices; each is a contact
//! point. A sphere touches a hull at the nearest point of a face, an edge or a vertex.
//!
//! The height of the centre of the sphere above the planes of all faces determines the highest plane. If the
//! perpendicular foot on this plane belongs to the hull, it is the nearest point; this includes centres
//! inside of the hull. Otherwise the nearest point of all edges is.

use super::geometry::{PointContact, indicator_of_positive, tangents_of};
use super::surface::{ConvexHull, Surface, SurfaceForm};
use crate::diag::Diagnostics;
use crate::expr::{Expr, Extreme, Vec3};
use crate::hull::{Hull, HullError, MAX_VERTICES};
use crate::mechanism::Rule;
use crate::resolve::scope::{AllowedQuantities, Context, PlacedElement, Scope};
use crate::syntax::{self, ExprKind};

/// Distance from a face below which a point is treated as part of it, relative to the size of the hull.
const ON_FACE: f64 = 1e-9;

/// Example of a hull in error messages.
const EXAMPLE: &str = "write at least four points that are not in one plane, as in `hull([0 * x, 0.1 * x, \
                       0.1 * y, 0.1 * z])`, or the path of a mesh, as in `hull(\"foot.stl\")`";

/// Parses the hull of a list of points; `None` after an error.
pub(super) fn read_hull<'g>(
    scope: &Scope<'_, 'g>,
    frame: Option<PlacedElement<'g>>,
    points: &syntax::Expr,
    cx: &mut Diagnostics,
) -> Option<Surface<'g>> {
    let place = &points.place;
    let items = match &points.kind {
        ExprKind::Array(items) | ExprKind::Tuple(items) => items,
        // The mesh could not be read; the error is reported.
        ExprKind::Text(_) => return None,
        _ => {
            cx.report_error(place.clone(), "expected the points of a hull").add_help(EXAMPLE);
            return None;
        }
    };
    let constant_context = || Context::new(AllowedQuantities::Constant, None);
    let points: Vec<Option<Vec3<'g>>> = items
        .iter()
        .map(|e| scope.call_in_context(constant_context(), |s| s.resolve_own_axes_vector(e, cx)))
        .collect();
    let points: Vec<Vec3<'g>> = points.into_iter().collect::<Option<_>>()?;
    points.iter().flat_map(|p| p.0).for_each(|x| {
        scope.record_parameter_condition(Rule::Length, || "a point of a hull".to_string(), &[x]);
    });
    let report_too_many_vertices = |count: usize, cx: &mut Diagnostics| {
        let message = format!("a hull of {count} vertices, more than {MAX_VERTICES}");
        cx.report_error(place.clone(), message).add_help("each vertex is a point of contact: write fewer");
    };
    let numbers: Option<Vec<[f64; 3]>> = points.iter().map(|p| p.constant_components()).collect();
    let hull = match numbers {
        // The coordinates depend on parameters, and so does which points are vertices.
        None if (4..=MAX_VERTICES).contains(&points.len()) => ConvexHull { vertices: points, shape: None },
        None if points.len() > MAX_VERTICES => {
            report_too_many_vertices(points.len(), cx);
            return None;
        }
        None => {
            cx.report_error(place.clone(), format!("a hull of {} points", points.len())).add_help(EXAMPLE);
            return None;
        }
        Some(numbers) => match Hull::new(&numbers, MAX_VERTICES) {
            Ok(shape) if shape.error > 0.0 => {
                report_too_many_vertices(numbers.len(), cx);
                return None;
            }
            Ok(shape) => {
                let vertices =
                    shape.vertices.iter().map(|p| Vec3::vector_from_constants(scope.graph, *p)).collect();
                ConvexHull { vertices, shape: Some(shape) }
            }
            Err(error) => {
                let message = match error {
                    HullError::NotFinite => "a point of this hull is not finite".to_string(),
                    HullError::TooFew(count) => format!("a hull of {count} different points"),
                    HullError::Coplanar => "the points of this hull are in one plane".to_string(),
                };
                cx.report_error(place.clone(), message).add_help(EXAMPLE);
                return None;
            }
        },
    };
    Some(Surface { frame: frame?, form: SurfaceForm::Hull(hull) })
}

/// Returns the contact of a sphere with a hull. `c` is the centre of the sphere relative to the frame of the
/// hull, and `axes` are the axes of the hull, both in common axes.
pub(super) fn sphere_on_hull<'g>(
    radius: Expr<'g>,
    hull: &Hull,
    c: Vec3<'g>,
    axes: &[Vec3<'g>; 3],
) -> Option<PointContact<'g>> {
    let g = radius.graph();
    let p = Vec3(axes.map(|axis| axis.dot(c)));
    let planes: Vec<(Vec3<'g>, Expr<'g>)> = hull
        .faces
        .iter()
        .map(|face| (Vec3::vector_from_constants(g, face.normal), g.num(face.offset)))
        .collect();
    let (mut normal, mut height) = planes.first().map(|(n, offset)| (*n, n.dot(p) - *offset))?;
    for (n, offset) in &planes[1..] {
        let other = n.dot(p) - *offset;
        normal += (*n - normal) * indicator_of_positive(other - height);
        height = height.minimum_or_maximum(Extreme::Max, other);
    }
    let foot = p - normal * height;
    let outside = planes.iter().map(|(n, offset)| n.dot(foot) - *offset);
    let outside = outside.reduce(|a, b| a.minimum_or_maximum(Extreme::Max, b))?;
    let on_face = indicator_of_positive(g.num(ON_FACE * hull.size) - outside);
    let (offset, square) = offset_from_nearest_edge(hull, p)?;
    let distance = square.minimum_or_maximum(Extreme::Max, g.num((ON_FACE * hull.size).powi(2))).sqrt();
    let from_edge = offset.map(|x| x / distance);
    let normal = from_edge + (normal - from_edge) * on_face;
    let normal = axes[0] * normal[0] + axes[1] * normal[1] + axes[2] * normal[2];
    let (first, second) = tangents_of(normal);
    Some(PointContact {
        gap: distance + (height - distance) * on_face - radius,
        point: -(normal * radius),
        axes: [("normal", normal), ("first", first), ("second", second)],
        conditions: Vec::new(),
    })
}

/// Returns the position of a point relative to the nearest point of the edges, and its square.
fn offset_from_nearest_edge<'g>(hull: &Hull, p: Vec3<'g>) -> Option<(Vec3<'g>, Expr<'g>)> {
    let g = p[0].graph();
    let mut nearest: Option<(Vec3<'g>, Expr<'g>)> = None;
    for [from, to] in hull.edges.iter().map(|edge| edge.map(|k| hull.vertices[k])) {
        let along: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
        let square = along.iter().map(|x| x * x).sum::<f64>();
        let (along, offset) =
            (Vec3::vector_from_constants(g, along), p - Vec3::vector_from_constants(g, from));
        let t = along.dot(offset) * (1.0 / square);
        let t = t.minimum_or_maximum(Extreme::Max, g.zero()).minimum_or_maximum(Extreme::Min, g.one());
        let offset = offset - along * t;
        let square = offset.dot(offset);
        nearest = Some(match nearest {
            None => (offset, square),
            Some((known, least)) => {
                let is_nearer = indicator_of_positive(least - square);
                (known + (offset - known) * is_nearer, least.minimum_or_maximum(Extreme::Min, square))
            }
        });
    }
    nearest
}
