//! Convex hulls of the meshes that contacts use: of collision geometry, and of files named in `hull("…")`.
//! Only these meshes are read.

use super::contact_limit::{
    contact_point_count, list_first_names, one_plus_friction_moment_count, select_contacts,
};
use super::mesh;
use super::pose::{Vector, matrix_times_vector, vector_sum};
use crate::diag::Diagnostics;
use crate::hull::{Hull, HullError, MAX_VERTICES};
use crate::syntax::contact::collision_shape_indices;
use crate::syntax::{
    CollisionShape, Contact, Description, Expr, ExprKind, FileContactKind, MeshVertices, Name, Shape,
};
use std::path::{Path, PathBuf};

/// Minimum number of vertices of a hull for a contact that the file declares. With fewer vertices the mesh is
/// omitted.
const MIN_VERTICES: usize = 6;

/// Largest distance of a vertex of a mesh from its hull, relative to the size of the hull.
const MAX_ERROR: f64 = 0.1;

/// Maximum number of triangles of a mesh whose hull is computed.
const MAX_TRIANGLES: usize = 200_000;

/// Reads the meshes that contacts use, and replaces them by the vertices of their convex hulls. Paths in
/// `hull("…")` are relative to `folder`. The mechanism has at most `limit` contact points. Returns the paths
/// of the files that were read.
pub fn read_hulls(
    description: &mut Description,
    folder: &Path,
    limit: usize,
    cx: &mut Diagnostics,
) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut notes = Vec::new();
    for contact in &mut description.contacts {
        for side in [&mut contact.first, &mut contact.second] {
            replace_hull_file_by_vertices(side, folder, (&mut files, &mut notes), cx);
        }
    }
    let is_mesh = |part: &CollisionShape| part.shape == Shape::Mesh && part.mesh.is_some();
    let share = max_vertices_per_mesh(&description.contacts, &description.collisions, limit);
    // Vertices allowed for each mesh, zero if no contact uses it, and whether a mechanism without its hull is
    // an error. Declared contacts take precedence over contacts of the file with planes, and these over other
    // contacts of the file.
    let mut maxima = vec![(0, false); description.collisions.len()];
    let is_file_contact_with_plane =
        |contact: &Contact| contact.of_file.map(|of_file| of_file.kind == FileContactKind::Plane);
    for (kind, most) in [(Some(false), MAX_VERTICES), (Some(true), share), (None, MAX_VERTICES)] {
        for contact in
            description.contacts.iter().filter(|contact| is_file_contact_with_plane(contact) == kind)
        {
            for side in [&contact.first, &contact.second] {
                for k in collision_shape_indices(side, &description.collisions).unwrap_or_default() {
                    maxima[k] = (most, kind.is_none());
                }
            }
        }
    }
    for (part, (most, is_required)) in description.collisions.iter_mut().zip(maxima) {
        let Some(source) = part.mesh.as_ref().filter(|_| is_mesh(part) && most >= MIN_VERTICES) else {
            continue;
        };
        if let Some((hull, count)) = hull_of_mesh(source, (most, is_required), &mut files, cx) {
            notes.extend(omitted_vertices_note(
                &format!("the mesh of `{}`", part.on.body.text),
                &hull,
                count,
            ));
            part.hull = hull.vertices;
        }
    }
    omit_contacts_without_hulls(description, share, limit);
    select_contacts(description, limit);
    description.left_out.extend(notes);
    files
}

/// Replaces the file of `body.hull("…")` by the vertices of the hull.
fn replace_hull_file_by_vertices(
    surface: &mut Expr,
    folder: &Path,
    (files, notes): (&mut Vec<PathBuf>, &mut Vec<String>),
    cx: &mut Diagnostics,
) {
    let ExprKind::Method(_, _, arguments) = &mut surface.kind else { return };
    let [Expr { kind: ExprKind::Text(path), place }] = arguments.as_slice() else { return };
    let name = Name { text: path.clone(), place: place.clone() };
    let source = MeshVertices::scaled_vertices_of_file(name, mesh::candidate_paths(folder, path), [1.0; 3]);
    if let Some((hull, count)) = hull_of_mesh(&source, (MAX_VERTICES, true), files, cx) {
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
/// after an error, or if so few vertices do not represent the mesh. The latter is an error if the hull is
/// required.
fn hull_of_mesh(
    source: &MeshVertices,
    (maximum, is_required): (usize, bool),
    files: &mut Vec<PathBuf>,
    cx: &mut Diagnostics,
) -> Option<(Hull, usize)> {
    let (name, place) = (&source.name.text, source.name.place.clone());
    let mut points: Vec<Vector> = source.written.clone();
    if let Some(first) = source.paths.first() {
        let path = source.paths.iter().find(|path| path.is_file()).unwrap_or(first);
        match mesh::read_triangles(path, name) {
            Ok(triangles) if triangles.len() > MAX_TRIANGLES && !is_required => return None,
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
    points.iter_mut().for_each(|p| *p = vector_sum(matrix_times_vector(&source.linear, *p), source.offset));
    points.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    points.dedup();
    match Hull::new(&points, maximum) {
        Ok(hull) if hull.error > MAX_ERROR * hull.size && !is_required => None,
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
        Err(_) if !is_required => None,
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

/// Returns the number of vertices for each mesh in the contacts with planes that the file declares: the
/// limit of contact points without those of other shapes, divided by the number of meshes.
fn max_vertices_per_mesh(contacts: &[Contact], collisions: &[CollisionShape], limit: usize) -> usize {
    let (mut others, mut meshes) = (0, 0);
    let is_on_plane =
        |contact: &&Contact| contact.of_file.is_some_and(|of_file| of_file.kind == FileContactKind::Plane);
    for contact in contacts.iter().filter(is_on_plane) {
        // Meshes have no vertices yet.
        match contact_point_count(contact, collisions) {
            Some(points) if points > 0 => others += points,
            _ => meshes += one_plus_friction_moment_count(contact),
        }
    }
    (limit.saturating_sub(others) / meshes.max(1)).min(MAX_VERTICES)
}

/// Removes the contacts of the file whose mesh has no hull: there are too many meshes, so that each has at
/// most `share` vertices, or no convex hull represents the mesh.
fn omit_contacts_without_hulls(description: &mut Description, share: usize, limit: usize) {
    let collisions = &description.collisions;
    let has_all_mesh_hulls = |contact: &Contact| {
        let sides = [&contact.first, &contact.second].into_iter();
        let parts = sides.flat_map(|side| collision_shape_indices(side, collisions).unwrap_or_default());
        contact.of_file.is_none() || parts.into_iter().all(|k| !collisions[k].is_mesh_without_hull())
    };
    let (with_hulls, without): (Vec<Contact>, Vec<Contact>) =
        std::mem::take(&mut description.contacts).into_iter().partition(has_all_mesh_hulls);
    description.contacts = with_hulls;
    if without.is_empty() {
        return;
    }
    description.left_out.push(if share < MAX_VERTICES {
        let what = format!("contacts of meshes whose hulls would have more than {limit} points together");
        format!("{what}: {}", without.len())
    } else {
        let what = format!("contacts of meshes that no convex hull with {MAX_VERTICES} vertices represents");
        list_first_names(&what, &without.into_iter().map(|contact| contact.name.text).collect::<Vec<_>>())
    });
}
