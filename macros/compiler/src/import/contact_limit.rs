//! Contacts of a file that fit into the number of contact points of a mechanism.

use crate::hull::{Hull, MAX_VERTICES};
use crate::syntax::contact::{MAX_CONTACT_POINTS, collision_shape_indices};
use crate::syntax::{
    BodyOrInertiaMethod, CollisionShape, Contact, Description, Expr, ExprKind, FileContactKind, Key,
    SurfaceFeatureCounts, SurfaceId,
};

/// Maximum number of names in a line of the documentation.
const MAX_NAMES: usize = 12;

/// Removes contacts of the file until the contact points are at most `limit`, and lists them in the
/// documentation. Contacts with planes are always included. Then each contact is included if its points
/// fit, in the order of the kinds of contacts and of the distances of the shapes; contacts of bodies that
/// joints connect are included only if the points of all of them fit into a mechanism without separate
/// contacts.
pub(super) fn select_contacts(description: &mut Description, limit: usize) {
    let (contacts, collisions) = (&description.contacts, &description.collisions);
    let counts: Vec<usize> =
        contacts.iter().map(|contact| contact_point_count(contact, collisions).unwrap_or(0)).collect();
    let bounds_of_stops = description
        .limits
        .iter()
        .filter(|limit| limit.arguments.expression_of_key(Key::Restitution).is_some());
    let stops: usize = bounds_of_stops
        .map(|limit| {
            [Key::From, Key::To]
                .into_iter()
                .filter(|key| limit.arguments.expression_of_key(*key).is_some())
                .count()
        })
        .sum();
    let mut used = stops;
    let mut optional: Vec<usize> = Vec::new();
    for (k, contact) in contacts.iter().enumerate() {
        match contact.of_file {
            Some(of_file) if of_file.kind != FileContactKind::Plane => optional.push(k),
            _ => used += counts[k],
        }
    }
    let file_contact_kind = |k: usize| contacts[k].of_file.map(|of_file| of_file.kind);
    let file_contact_distance = |k: usize| contacts[k].of_file.map_or(0.0, |of_file| of_file.distance);
    optional.sort_by(|a, b| {
        file_contact_kind(*a)
            .cmp(&file_contact_kind(*b))
            .then(file_contact_distance(*a).total_cmp(&file_contact_distance(*b)))
    });
    let is_between_connected_bodies = |k: usize| file_contact_kind(k) == Some(FileContactKind::Connected);
    let connected_points: usize =
        optional.iter().filter(|k| is_between_connected_bodies(**k)).map(|k| counts[*k]).sum();
    let mut omitted = vec![false; contacts.len()];
    let (mut excess, mut connected_excess) = (Vec::new(), 0);
    let mut connected_fit = None;
    for k in optional {
        let free = limit.saturating_sub(used);
        let fits = match is_between_connected_bodies(k) {
            true => {
                let free = limit.min(MAX_CONTACT_POINTS).saturating_sub(used);
                *connected_fit.get_or_insert(connected_points <= free)
            }
            false => counts[k] <= free,
        };
        if fits {
            used += counts[k];
        } else {
            omitted[k] = true;
            match is_between_connected_bodies(k) {
                true => connected_excess += 1,
                false => excess.push(contacts[k].name.text.clone()),
            }
        }
    }
    let mut omitted = omitted.into_iter();
    description.contacts.retain(|_| omitted.next() != Some(true));
    let most = format!("the {limit} contact points of a mechanism");
    if !excess.is_empty() {
        let what = format!("contacts that do not fit into {most}");
        description.left_out.push(list_first_names(&what, &excess));
    }
    if connected_excess > 0 {
        let most = limit.min(MAX_CONTACT_POINTS);
        let what = format!(
            "contacts of bodies that joints connect, which do not fit into the {most} contact points of a \
             mechanism"
        );
        description.left_out.push(format!("{what}: {connected_excess}"));
    }
}

/// Returns a line of the documentation with the first names of a list.
pub(super) fn list_first_names(what: &str, names: &[String]) -> String {
    let first = names.iter().take(MAX_NAMES).cloned().collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(MAX_NAMES) {
        0 => format!("{what}: {first}"),
        more => format!("{what}: {first} and {more} more"),
    }
}

/// Returns the number of friction moments of a contact, and one for the contact itself.
pub(super) fn one_plus_friction_moment_count(contact: &Contact) -> usize {
    let one_if_argument_given = |key| usize::from(contact.arguments.expression_of_key(key).is_some());
    1 + one_if_argument_given(Key::TorsionalFriction) + one_if_argument_given(Key::RollingFriction)
}

/// Returns the number of contact points of a contact, with its moments of friction; `None` if a pair of its
/// surfaces is not supported. A compliant contact has none.
pub(super) fn contact_point_count(contact: &Contact, collisions: &[CollisionShape]) -> Option<usize> {
    if contact.is_compliant() {
        return Some(0);
    }
    let seconds = vertex_and_corner_counts_of_surfaces(&contact.second, collisions);
    let mut points = 0;
    for first in vertex_and_corner_counts_of_surfaces(&contact.first, collisions) {
        for second in &seconds {
            points += first.contact_point_count(second)?;
        }
    }
    Some(points * one_plus_friction_moment_count(contact))
}

/// Returns the numbers of vertices and corners of the surfaces of one side of a contact.
fn vertex_and_corner_counts_of_surfaces(
    surface: &Expr,
    collisions: &[CollisionShape],
) -> Vec<SurfaceFeatureCounts> {
    if let Some(selected) = collision_shape_indices(surface, collisions) {
        return selected
            .into_iter()
            .map(|k| {
                surface_vertex_and_corner_counts(Some(collisions[k].shape.surface_id()), &collisions[k].hull)
            })
            .collect();
    }
    let ExprKind::Method(_, member, arguments) = &surface.kind else {
        return vec![surface_vertex_and_corner_counts(None, &[])];
    };
    let Some(BodyOrInertiaMethod::Surface(id)) = member.id else {
        return vec![surface_vertex_and_corner_counts(None, &[])];
    };
    let points = match arguments.first().map(|points| &points.kind) {
        Some(ExprKind::Array(points)) if id == SurfaceId::Hull => points.as_slice(),
        _ => &[],
    };
    let vertices: Option<Vec<[f64; 3]>> = points.iter().map(constant_vector).collect();
    let size = surface_vertex_and_corner_counts(Some(id), &vertices.unwrap_or_default());
    vec![SurfaceFeatureCounts { vertices: points.len(), ..size }]
}

/// Returns the components of a vector that is written as three numbers.
pub(super) fn constant_vector(e: &Expr) -> Option<[f64; 3]> {
    let ExprKind::Array(components) = &e.kind else { return None };
    let components: Option<Vec<f64>> = components.iter().map(Expr::literal_number).collect();
    components?.try_into().ok()
}

/// Returns the form of a surface with its numbers of vertices and of corners of the largest face; `vertices`
/// are those of a hull.
fn surface_vertex_and_corner_counts(id: Option<SurfaceId>, vertices: &[[f64; 3]]) -> SurfaceFeatureCounts {
    let corners = match id {
        Some(SurfaceId::Cuboid) => 4,
        Some(SurfaceId::Hull) => Hull::new(vertices, MAX_VERTICES)
            .map_or(0, |hull| hull.faces.iter().map(|face| face.corner_indices().len()).fold(0, usize::max)),
        _ => 0,
    };
    SurfaceFeatureCounts { id, vertices: vertices.len(), corners }
}
