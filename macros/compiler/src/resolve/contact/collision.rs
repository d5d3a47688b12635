//! Collision geometry of the links of a file, as surfaces of contacts.

use super::surface::{ConvexHull, Surface, SurfaceForm};
use crate::diag::{Diagnostics, Place};
use crate::expr::Vec3;
use crate::hull::{Hull, MAX_VERTICES};
use crate::resolve::scope::{PlacedElement, Scope};
use crate::syntax::contact::collision_shape_indices;
use crate::syntax::{self, CollisionShape, ExprKind, Name, Shape};

/// Resolves the collision geometry of a link, `link.collision()`, or of all links, `collision()`.
pub fn read_collisions<'g>(
    scope: &Scope<'_, 'g>,
    e: &syntax::Expr,
    link: Option<&syntax::Expr>,
    cx: &mut Diagnostics,
) -> Option<Vec<Surface<'g>>> {
    let known = &scope.description.collisions;
    let frame = match link {
        Some(link) => Some(scope.resolve_placement(link, cx)?),
        None => None,
    };
    let name = link.and_then(|link| link.as_name());
    let selected = collision_shape_indices(e, known).unwrap_or_default();
    let parts: Vec<&CollisionShape> = selected.into_iter().map(|k| &known[k]).collect();
    if parts.is_empty() {
        let whose = name.map_or_else(|| "this mechanism".to_string(), |name| format!("`{name}`"));
        cx.report_error(e.place.clone(), format!("{whose} has no collision geometry"))
            .add_help("only links of a file have it: name a surface instead, as in `foot.sphere(0.02)`");
        return None;
    }
    let mut meshes: Vec<&Name> =
        parts.iter().filter(|part| part.is_mesh_without_hull()).map(|part| &part.on.body).collect();
    meshes.dedup_by(|a, b| a.text == b.text);
    if !meshes.is_empty() {
        let names: Vec<String> = meshes.iter().map(|name| format!("`{}`", name.text)).collect();
        let message =
            format!("the collision geometry of {} is a mesh without a convex hull", names.join(", "));
        cx.report_error(e.place.clone(), message)
            .add_help("approximate it by surfaces, as in `foot.sphere(0.02)`, or list the other links");
        return None;
    }
    let surfaces =
        parts.into_iter().map(|part| surface_of_collision(scope, part, frame.as_ref(), &e.place, cx));
    surfaces.collect()
}

/// Returns the surface of a shape of the collision geometry, with its pose.
fn surface_of_collision<'g>(
    scope: &Scope<'_, 'g>,
    part: &CollisionShape,
    frame: Option<&PlacedElement<'g>>,
    place: &Place,
    cx: &mut Diagnostics,
) -> Option<Surface<'g>> {
    let g = scope.graph;
    let frame = match frame {
        Some(frame) => frame.clone(),
        None => {
            let link = ExprKind::Name(part.on.body.text.clone());
            scope.resolve_placement(&syntax::Expr { kind: link, place: place.clone() }, cx)?
        }
    };
    let pose = frame.pose.compose_with(&scope.frame_of_endpoint(&part.on, cx)?);
    let (z, length) = (Vec3::coordinate_axis(g, 2), |x: f64| g.num(x));
    let form = match part.shape {
        Shape::Sphere(radius) => SurfaceForm::Sphere(length(radius)),
        Shape::Cuboid(edges) => SurfaceForm::Cuboid(edges.map(length)),
        Shape::Cylinder(radius, along) => SurfaceForm::Drum(length(radius), length(along), z),
        Shape::Capsule(radius, along) => SurfaceForm::Capsule(length(radius), length(along), z),
        Shape::Ellipsoid(radii) => SurfaceForm::Ellipsoid(radii.map(length)),
        Shape::Mesh => {
            let vertices: Vec<Vec3<'g>> =
                part.hull.iter().map(|p| Vec3::vector_from_constants(g, *p)).collect();
            SurfaceForm::Hull(ConvexHull { shape: Hull::new(&part.hull, MAX_VERTICES).ok(), vertices })
        }
    };
    Some(Surface { frame: PlacedElement { pose, ..frame }, form })
}
