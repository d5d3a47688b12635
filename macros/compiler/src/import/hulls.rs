//! Convex hulls of the meshes that contacts use: of collision geometry, and of files named in `hull("…")`.
//! Only these meshes are read.

use super::mesh;
use super::pose::{Vector, add, matrix_times_vector};
use crate::diag::Diagnostics;
use crate::hull::{Hull, HullError, MAX_VERTICES};
use crate::syntax::contact::{MAX_CONTACT_POINTS, select_collisions};
use crate::syntax::{Collision, Contact, Description, Expr, ExprKind, Key, MeshVertices, Name, Shape};
use std::path::{Path, PathBuf};

/// Minimum number of vertices of a hull for a contact that the file declares. With fewer vertices the mesh is
/// omitted.
const MIN_VERTICES: usize = 6;

/// Largest distance of a vertex of a mesh from its hull, relative to the size of the hull.
const MAX_ERROR: f64 = 0.1;

/// Maximum number of triangles of a mesh whose hull is computed.
const MAX_TRIANGLES: usize = 200_000;

/// Reads the meshes that contacts use, and replaces them by the vertices of their convex hulls. Paths in
/// `hull("…")` are relative to `folder`. Returns the paths of the files that were read.
pub fn read_hulls(description: &mut Description, folder: &Path, cx: &mut Diagnostics) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut notes = Vec::new();
    for contact in &mut description.contacts {
        for side in [&mut contact.first, &mut contact.second] {
            replace_hull_file(side, folder, (&mut files, &mut notes), cx);
        }
    }
    let is_mesh = |part: &Collision| part.shape == Shape::Mesh && part.mesh.is_some();
    let share = vertices_per_mesh(&description.contacts, &description.collisions);
    // Vertices allowed for each mesh: zero if no contact uses it.
    let mut maxima = vec![0; description.collisions.len()];
    for contact in &description.contacts {
        let most = if contact.of_file { share } else { MAX_VERTICES };
        for side in [&contact.first, &contact.second] {
            for k in select_collisions(side, &description.collisions).unwrap_or_default() {
                maxima[k] = most.max(maxima[k]);
            }
        }
    }
    for (part, most) in description.collisions.iter_mut().zip(maxima) {
        let Some(source) = part.mesh.as_ref().filter(|_| is_mesh(part) && most >= MIN_VERTICES) else {
            continue;
        };
        if let Some((hull, count)) = hull_of_mesh(source, most, &mut files, cx) {
            notes.extend(omitted_vertices_note(
                &format!("the mesh of `{}`", part.on.body.text),
                &hull,
                count,
            ));
            part.hull = hull.vertices;
        }
    }
    omit_meshes_without_hull(description);
    description.left_out.extend(notes);
    files
}

/// Replaces the file of `body.hull("…")` by the vertices of the hull.
fn replace_hull_file(
    surface: &mut Expr,
    folder: &Path,
    (files, notes): (&mut Vec<PathBuf>, &mut Vec<String>),
    cx: &mut Diagnostics,
) {
    let ExprKind::Method(_, _, arguments) = &mut surface.kind else { return };
    let [Expr { kind: ExprKind::Text(path), place }] = arguments.as_slice() else { return };
    let name = Name { text: path.clone(), place: place.clone() };
    let source = MeshVertices::scaled(name, mesh::candidate_paths(folder, path), [1.0; 3]);
    if let Some((hull, count)) = hull_of_mesh(&source, MAX_VERTICES, files, cx) {
        notes.extend(omitted_vertices_note(&format!("the mesh `{path}`"), &hull, count));
        let points = hull.vertices.iter().map(|p| Expr::vector_at(*p, place)).collect();
        let points = Expr { kind: ExprKind::Array(points), place: place.clone() };
        *arguments = vec![points];
    }
}

/// Returns a line of the documentation for a hull that does not contain all vertices of its mesh.
fn omitted_vertices_note(mesh: &str, hull: &Hull, count: usize) -> Option<String> {
    let (kept, error) = (hull.vertices.len(), hull.error);
    let hull = format!("the convex hull of {kept} of its {count} vertices");
    (error > 0.0).then(|| format!("the part of {mesh} outside of {hull}: at most {error:.2e} m"))
}

/// Returns the hull of a mesh with at most `maximum` vertices, and the number of vertices of the mesh; `None`
/// after an error, or if so few vertices do not represent the mesh.
fn hull_of_mesh(
    source: &MeshVertices,
    maximum: usize,
    files: &mut Vec<PathBuf>,
    cx: &mut Diagnostics,
) -> Option<(Hull, usize)> {
    let (name, place) = (&source.name.text, source.name.place.clone());
    let mut points: Vec<Vector> = source.written.clone();
    if let Some(first) = source.paths.first() {
        let path = source.paths.iter().find(|path| path.is_file()).unwrap_or(first);
        match mesh::read_triangles(path, name) {
            Ok(triangles) if triangles.len() > MAX_TRIANGLES => {
                let message = format!("mesh `{name}` has more than {MAX_TRIANGLES} triangles");
                cx.report_error(place, message).add_help("use a simplified mesh for contacts");
                return None;
            }
            Ok(triangles) => points.extend(triangles.into_iter().flatten()),
            Err(message) => {
                let error = cx.report_error(place, message);
                if !path.is_file() {
                    error.add_help(format!("looked for `{}`", path.display()));
                }
                return None;
            }
        }
        files.push(path.clone());
    }
    points.iter_mut().for_each(|p| *p = add(matrix_times_vector(&source.linear, *p), source.offset));
    points.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    points.dedup();
    match Hull::new(&points, maximum) {
        // Several meshes share the points of contact: this one is omitted.
        Ok(hull) if hull.error > MAX_ERROR * hull.size && maximum < MAX_VERTICES => None,
        Ok(hull) if hull.error > MAX_ERROR * hull.size => {
            let kept = hull.vertices.len();
            let message = format!(
                "the convex hull of {kept} vertices of mesh `{name}` omits {:.2e} m of its {:.2e} m",
                hull.error, hull.size
            );
            cx.report_error(place, message)
                .add_help("approximate it by several surfaces, as in `foot.sphere(0.02)`");
            None
        }
        Ok(hull) => Some((hull, points.len())),
        Err(error) => {
            cx.report_error(
                place,
                format!("mesh `{name}` has no convex hull: {}", describe_hull_error(error)),
            );
            None
        }
    }
}

/// Returns the reason why points have no hull, for messages.
fn describe_hull_error(error: HullError) -> String {
    match error {
        HullError::NotFinite => "a coordinate is not finite".to_string(),
        HullError::TooFew(count) => format!("it has {count} different vertices, fewer than four"),
        HullError::Coplanar => "its vertices are in one plane".to_string(),
    }
}

/// Returns the number of friction moments of a contact, and one for the contact itself.
fn contact_and_moment_count(contact: &Contact) -> usize {
    let count_of_argument = |key| usize::from(contact.arguments.get(key).is_some());
    1 + count_of_argument(Key::TorsionalFriction) + count_of_argument(Key::RollingFriction)
}

/// Returns the number of vertices for each mesh in the contacts with planes that the file declares: the
/// maximum number of contact points without those of other shapes, divided by the number of meshes.
fn vertices_per_mesh(contacts: &[Contact], collisions: &[Collision]) -> usize {
    let (mut others, mut meshes) = (0, 0);
    for contact in contacts.iter().filter(|contact| contact.of_file) {
        for k in select_collisions(&contact.first, collisions).unwrap_or_default() {
            let points = match collisions[k].shape {
                Shape::Cuboid(_) | Shape::Cylinder(..) => 8,
                Shape::Capsule(..) => 2,
                Shape::Sphere(_) | Shape::Ellipsoid(_) => 1,
                Shape::Mesh => 0,
            };
            others += points * contact_and_moment_count(contact);
            meshes += if points == 0 { contact_and_moment_count(contact) } else { 0 };
        }
    }
    (MAX_CONTACT_POINTS.saturating_sub(others) / meshes.max(1)).min(MAX_VERTICES)
}

/// Removes the contacts of the file whose mesh has no hull because there are too many meshes.
fn omit_meshes_without_hull(description: &mut Description) {
    let collisions = &description.collisions;
    let before = description.contacts.len();
    description.contacts.retain(|contact| {
        let parts = select_collisions(&contact.first, collisions).unwrap_or_default();
        !contact.of_file || parts.iter().all(|k| !collisions[*k].is_mesh_without_hull())
    });
    let count = before - description.contacts.len();
    if count > 0 {
        let most = MAX_CONTACT_POINTS;
        let what = format!("contacts of meshes whose hulls would have more than {most} points together");
        description.left_out.push(format!("{what}: {count}"));
    }
}
