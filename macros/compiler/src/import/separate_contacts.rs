//! Contacts beyond the contact points of a mechanism, each as a mechanism of its own.
//!
//! A program with all contacts of many bodies would grow with the number of pairs of bodies. Two surfaces
//! only depend on the placements of their bodies. A separate contact is therefore a mechanism of two floating
//! bodies with one contact, in Rust's syntax; pairs with equal surfaces have the same text. Whoever evaluates
//! it passes the placements of the bodies, and multiplies its contact Jacobian by the Jacobians of both
//! bodies.

use super::contact_limit::{constant_vector, contact_point_count};
use crate::syntax::contact::{MAX_CONTACT_POINTS, collision_shape_indices};
use crate::syntax::{
    BodyOrInertiaMethod, CollisionShape, Contact, Description, Endpoint, Expr, ExprKind, GROUND, Key, Name,
    Shape, SurfaceId,
};

/// Name of the struct of a separate contact, and the names of its elements.
const STRUCT: &str = "SeparateContact";
const BODIES: [&str; 2] = ["first_body", "second_body"];
const MOUNTED: [&str; 2] = ["first_mounted", "second_mounted"];
const CONTACT: &str = "touch";
/// Beginning of the names of parameters that replace sizes.
const SIZE: &str = "size_";

/// Contact of two surfaces of bodies, with the mechanism in which they are alone.
#[derive(Clone, Debug)]
pub struct SeparateContact {
    /// Name of the contact in the mechanism. A contact with several pairs of surfaces has an entry for each.
    pub name: String,
    /// Declaration in Rust's syntax of a mechanism of the bodies of both surfaces, which float, with the
    /// contact. A surface of the ground has no body.
    pub declaration: String,
    /// Parameters of the declaration, in order.
    pub parameters: Vec<SeparateContactParameter>,
    /// Bodies of both surfaces; `None` for the ground.
    pub bodies: [Option<String>; 2],
    /// Radius of a sphere about the origin of each body that contains its surface, m; infinite if it is not
    /// known.
    pub radii: [f64; 2],
}

/// Value of a parameter of a separate contact.
#[derive(Clone, Debug, PartialEq)]
pub enum SeparateContactParameter {
    /// A number.
    Number(f64),
    /// The parameter of the mechanism with this name.
    Parameter(String),
}

/// Whether the declared contacts have more contact points than a mechanism.
pub fn exceeds_contact_points(description: &Description) -> bool {
    let Description { contacts, collisions, .. } = description;
    let counts = contacts.iter().map(|contact| contact_point_count(contact, collisions).unwrap_or(0));
    counts.sum::<usize>() > MAX_CONTACT_POINTS
}

/// Removes the contacts without compliance from a description and returns them. Returns `None` if they cannot
/// be separated: surfaces of anything but bodies, sizes that depend on tables or named expressions, or stops
/// with restitution.
pub fn separate_contacts(description: &mut Description) -> Option<Vec<SeparateContact>> {
    let has_stops =
        description.limits.iter().any(|limit| limit.arguments.expression_of_key(Key::Restitution).is_some());
    if has_stops {
        return None;
    }
    let rigid = description.contacts.iter().filter(|contact| !contact.is_compliant());
    let separate: Option<Vec<Vec<SeparateContact>>> =
        rigid.map(|contact| separate_contacts_of_surfaces(description, contact)).collect();
    let separate = separate?.concat();
    description.contacts.retain(Contact::is_compliant);
    let used = separate.iter().flat_map(|contact| &contact.parameters);
    description.separate_contact_parameters = used
        .filter_map(|parameter| match parameter {
            SeparateContactParameter::Parameter(name) => Some(name.clone()),
            SeparateContactParameter::Number(_) => None,
        })
        .collect();
    Some(separate)
}

/// Returns the separate contacts of a declared contact: one for each pair of its surfaces.
fn separate_contacts_of_surfaces(
    description: &Description,
    contact: &Contact,
) -> Option<Vec<SeparateContact>> {
    let [firsts, seconds] =
        [&contact.first, &contact.second].map(|side| surfaces_of_side(side, &description.collisions));
    let mut separate = Vec::new();
    for first in &firsts {
        for second in &seconds {
            if body_of_surface(&first.surface)? != body_of_surface(&second.surface)? {
                separate.push(separate_contact(description, contact, [first, second])?);
            }
        }
    }
    Some(separate)
}

/// Surface, and the pose of its axes on its body if it is rotated.
struct PlacedSurface {
    /// Surface `body.form(…)` or `body.at(…).form(…)`.
    surface: Expr,
    /// Endpoint on the body to which a rotated surface is welded.
    mount: Option<Endpoint>,
}

/// Returns the surfaces of a side of a contact, without reference to the collision geometry of a file.
fn surfaces_of_side(side: &Expr, collisions: &[CollisionShape]) -> Vec<PlacedSurface> {
    match collision_shape_indices(side, collisions) {
        Some(indices) => indices.into_iter().map(|k| surface_of_collision_shape(&collisions[k])).collect(),
        None => vec![PlacedSurface { surface: side.clone(), mount: None }],
    }
}

/// Returns the surface of a shape of the collision geometry.
fn surface_of_collision_shape(part: &CollisionShape) -> PlacedSurface {
    let place = &part.place;
    let mut base = Expr { kind: ExprKind::Name(part.on.body.text.clone()), place: place.clone() };
    let mount = (!part.on.rotated.is_empty()).then(|| part.on.clone());
    if let Some(at) = part.on.at.as_ref().filter(|_| mount.is_none()) {
        base = Expr::method_call(base, "at", vec![at.clone()]);
    }
    let number = |value: f64| Expr::number_at(value, place);
    let axis = || Expr::vector_at([0.0, 0.0, 1.0], place);
    let arguments = match part.shape {
        Shape::Sphere(radius) => vec![number(radius)],
        Shape::Cuboid(lengths) | Shape::Ellipsoid(lengths) => lengths.map(number).to_vec(),
        Shape::Cylinder(radius, length) | Shape::Capsule(radius, length) => {
            vec![number(radius), number(length), axis()]
        }
        Shape::Mesh => {
            let points = part.hull.iter().map(|point| Expr::vector_at(*point, place)).collect();
            vec![Expr { kind: ExprKind::Array(points), place: place.clone() }]
        }
    };
    PlacedSurface { surface: Expr::method_call(base, part.shape.surface_id().name(), arguments), mount }
}

/// Returns the name of the body of a surface; `None` for other surfaces than `body.form(…)` and
/// `body.at(…).form(…)`.
fn body_of_surface(surface: &Expr) -> Option<&str> {
    let ExprKind::Method(base, word, _) = &surface.kind else { return None };
    let is_surface = matches!(word.id, Some(BodyOrInertiaMethod::Surface(_)));
    let mut base = base.as_ref();
    while let ExprKind::Method(inner, ..) = &base.kind {
        base = inner;
    }
    base.as_name().filter(|_| is_surface)
}

/// Returns the contact of two surfaces as a mechanism of its own.
fn separate_contact(
    description: &Description,
    contact: &Contact,
    surfaces: [&PlacedSurface; 2],
) -> Option<SeparateContact> {
    let is_body = |name: &str| description.bodies.iter().any(|body| body.name.text == name);
    let names = [body_of_surface(&surfaces[0].surface)?, body_of_surface(&surfaces[1].surface)?];
    if names.iter().any(|name| *name != GROUND && !is_body(name)) {
        return None;
    }
    let mut parameters = Vec::new();
    let has_free_sizes = surfaces.iter().all(|placed| has_free_sizes(&placed.surface));
    let (mut texts, mut bodies) = (Vec::new(), String::new());
    for (k, (placed, name)) in surfaces.into_iter().zip(names).enumerate() {
        let (mut surface, carrier) =
            (placed.surface.clone(), if name == GROUND { GROUND } else { BODIES[k] });
        if name != GROUND {
            bodies +=
                &format!("#[body] {carrier}: Body, #[joint(ground -> {carrier})] {carrier}_joint: Free, ");
        }
        if let Some(mount) = &placed.mount {
            bodies += &mounted_body(mount, carrier, MOUNTED[k]);
        }
        rename_body(&mut surface, if placed.mount.is_some() { MOUNTED[k] } else { carrier });
        if has_free_sizes {
            replace_sizes_by_parameters(&mut surface, &mut parameters);
        }
        texts.push(surface);
    }
    let arguments: Vec<(Key, &Expr)> = contact.arguments.keyed_expressions().collect();
    let used = texts.iter().chain(arguments.iter().map(|(_, e)| *e)).flat_map(Expr::all_subexpressions);
    for e in used {
        match &e.kind {
            // A call of a table.
            ExprKind::Call(word, _) if word.id.is_none() => return None,
            ExprKind::Name(name) => {
                let is_name = |known: &Name| known.text == *name;
                if description.definitions.iter().any(|definition| is_name(&definition.name))
                    || description.states.iter().any(|(state, _)| is_name(state))
                {
                    return None;
                }
                if description.parameters.iter().any(is_name)
                    && !parameters.iter().any(|(known, _)| known == name)
                {
                    parameters.push((name.clone(), SeparateContactParameter::Parameter(name.clone())));
                }
            }
            _ => {}
        }
    }
    let fields: String = parameters.iter().map(|(name, _)| format!("{name}: f64, ")).collect();
    let arguments: String =
        arguments.iter().map(|(key, e)| format!(", {} = {}", key.name(), e.source_text())).collect();
    let [first, second] = [texts[0].source_text(), texts[1].source_text()];
    Some(SeparateContact {
        name: contact.name.text.clone(),
        declaration: format!(
            "#[mechanism(inertia = none)] struct {STRUCT} {{ {fields}{bodies}#[contact({first}, \
             {second}{arguments})] {CONTACT}: Contact }}"
        ),
        parameters: parameters.into_iter().map(|(_, value)| value).collect(),
        bodies: names.map(|name| (name != GROUND).then(|| name.to_string())),
        radii: surfaces.map(bounding_radius_about_body_origin),
    })
}

/// Returns the declaration of a body that is welded to an endpoint on another one.
fn mounted_body(endpoint: &Endpoint, carrier: &str, name: &str) -> String {
    let at = endpoint.at.as_ref().map_or(String::new(), |at| format!(".at({})", at.source_text()));
    let rotations: Vec<String> = endpoint.rotated.iter().map(Expr::source_text).collect();
    let rotations = rotations.join(", ");
    format!(
        "#[body] {name}: Body, #[joint({carrier}{at}.rotated({rotations}) -> {name})] {name}_joint: Weld, "
    )
}

/// Renames the body of a surface.
fn rename_body(surface: &mut Expr, name: &str) {
    match &mut surface.kind {
        ExprKind::Method(base, ..) => rename_body(base, name),
        kind => *kind = ExprKind::Name(name.to_string()),
    }
}

/// Whether contacts of a surface with others of this kind are computed for sizes that are parameters.
fn has_free_sizes(surface: &Expr) -> bool {
    let ExprKind::Method(_, word, _) = &surface.kind else { return false };
    let Some(BodyOrInertiaMethod::Surface(id)) = word.id else { return false };
    matches!(id, SurfaceId::Sphere | SurfaceId::Cuboid | SurfaceId::Capsule | SurfaceId::Plane)
}

/// Replaces the sizes of a surface that are numbers by new parameters.
fn replace_sizes_by_parameters(surface: &mut Expr, parameters: &mut Vec<(String, SeparateContactParameter)>) {
    let ExprKind::Method(_, _, arguments) = &mut surface.kind else { return };
    for argument in arguments {
        // Another number is an error, which names it.
        let Some(value) = argument.literal_number().filter(|value| *value > 0.0) else { continue };
        let name = format!("{SIZE}{}", parameters.len());
        argument.kind = ExprKind::Name(name.clone());
        parameters.push((name, SeparateContactParameter::Number(value)));
    }
}

/// Returns the radius of a sphere about the origin of its body that contains a surface; infinite if the
/// surface is unbounded or its size is not a number.
fn bounding_radius_about_body_origin(PlacedSurface { surface, mount }: &PlacedSurface) -> f64 {
    let mut radius = bounding_radius_about_center(surface).unwrap_or(f64::INFINITY);
    if let Some(at) = mount.as_ref().and_then(|mount| mount.at.as_ref()) {
        radius += constant_vector_norm(at).unwrap_or(f64::INFINITY);
    }
    let ExprKind::Method(base, ..) = &surface.kind else { return f64::INFINITY };
    let mut base = base.as_ref();
    while let ExprKind::Method(inner, word, arguments) = &base.kind {
        if word.id == Some(BodyOrInertiaMethod::At) {
            let distance = arguments.first().and_then(constant_vector_norm);
            radius += distance.unwrap_or(f64::INFINITY);
        }
        base = inner;
    }
    radius
}

/// Returns the radius of a sphere about the centre of a surface that contains it; `None` for unbounded
/// surfaces and for radii that are not numbers.
fn bounding_radius_about_center(surface: &Expr) -> Option<f64> {
    let ExprKind::Method(_, word, arguments) = &surface.kind else { return None };
    let Some(BodyOrInertiaMethod::Surface(id)) = word.id else { return None };
    let size = |k: usize| arguments.get(k).and_then(Expr::literal_number);
    Some(match id {
        SurfaceId::Sphere => size(0)?,
        SurfaceId::Ellipsoid => size(0)?.max(size(1)?).max(size(2)?),
        SurfaceId::Cuboid => size(0)?.hypot(size(1)?).hypot(size(2)?) / 2.0,
        SurfaceId::Capsule => size(0)? + size(1)? / 2.0,
        SurfaceId::Drum => size(0)?.hypot(size(1)? / 2.0),
        SurfaceId::Hull => {
            let ExprKind::Array(points) = &arguments.first()?.kind else { return None };
            let norms: Option<Vec<f64>> = points.iter().map(constant_vector_norm).collect();
            norms?.into_iter().fold(0.0, f64::max)
        }
        _ => return None,
    })
}

/// Returns the norm of a vector that is written as three numbers.
fn constant_vector_norm(e: &Expr) -> Option<f64> {
    constant_vector(e).map(|components| components.into_iter().fold(0.0, f64::hypot))
}
