//! `<collision>` → collision shapes of links, which contacts refer to.

use super::frames::{Frames, element_origin_in_link};
use super::scope::Scope;
use crate::import::context::Cx;
use crate::import::element::{
    Node, child_elements, child_for_each_name, element_source_position, quoted_tag, read_numbers_content,
    read_trimmed_content, report_missing_or_misspelt_attributes, required_child,
};
use crate::import::mesh;
use crate::import::robot::FileCollisionShape;
use crate::syntax::{MeshVertices, Name, Shape};
use std::path::Path;

/// Names of the SDF shapes that are supported as collision geometry.
pub(super) const SHAPES: [&str; 6] = ["sphere", "box", "cylinder", "capsule", "ellipsoid", "mesh"];

/// Reads all collision geometry of a link. Paths of meshes are relative to `folder`.
pub(super) fn read_collisions(
    node: Node<'_>,
    link: (&Name, &Scope),
    frames: &Frames,
    folder: &Path,
    cx: &mut Cx<'_>,
) -> Vec<FileCollisionShape> {
    let parts = child_elements(node).filter(|node| node.tag_name().name() == "collision");
    parts.filter_map(|part| read_collision(part, link, frames, folder, cx)).collect()
}

fn read_collision(
    node: Node<'_>,
    link: (&Name, &Scope),
    frames: &Frames,
    folder: &Path,
    cx: &mut Cx<'_>,
) -> Option<FileCollisionShape> {
    let geometry = child_elements(node).find(|child| child.tag_name().name() == "geometry");
    let geometry = required_child(geometry, node, "geometry", &[], cx)?;
    let mut shapes = child_elements(geometry).filter(|child| child.tag_name().name() != "empty");
    let form = shapes.next()?;
    if let Some(second) = shapes.next() {
        let help = "write a `<collision>` for each shape";
        cx.report_error(&element_source_position(second, cx), "second shape of one geometry", |d| {
            d.add_help(help)
        });
    }
    let origin = element_origin_in_link(node, link, frames, cx)?;
    let shape = read_shape(form, cx)?;
    let mesh = match shape {
        Shape::Mesh => mesh_vertex_source(form, folder, cx),
        _ => None,
    };
    Some(FileCollisionShape { origin, shape, mesh, place: element_source_position(node, cx) })
}

/// Returns the source of the vertices of a mesh; `None` for a part of a mesh.
fn mesh_vertex_source(form: Node<'_>, folder: &Path, cx: &mut Cx<'_>) -> Option<MeshVertices> {
    let [uri, scale, submesh] = child_for_each_name(form, ["uri", "scale", "submesh"], cx);
    let path = read_trimmed_content(required_child(uri, form, "uri", &[], cx)?, cx)?;
    let scale = match scale {
        Some(scale) => read_numbers_content(scale, cx)?.value,
        None => [1.0; 3],
    };
    let paths = mesh::candidate_paths(folder, &path.text);
    submesh.is_none().then(|| MeshVertices::scaled_vertices_of_file(path, paths, scale))
}

/// Reads a child element of an SDF `<geometry>` as a shape.
pub(super) fn read_shape(shape: Node<'_>, cx: &mut Cx<'_>) -> Option<Shape> {
    report_missing_or_misspelt_attributes(shape, &[], &[], cx);
    match shape.tag_name().name() {
        "sphere" => {
            let [radius] = child_for_each_name(shape, ["radius"], cx);
            let [radius] = read_lengths(radius, shape, "radius", cx)?;
            Some(Shape::Sphere(radius))
        }
        "box" => {
            let [size] = child_for_each_name(shape, ["size"], cx);
            Some(Shape::Cuboid(read_lengths(size, shape, "size", cx)?))
        }
        "ellipsoid" => {
            let [radii] = child_for_each_name(shape, ["radii"], cx);
            Some(Shape::Ellipsoid(read_lengths(radii, shape, "radii", cx)?))
        }
        kind @ ("cylinder" | "capsule") => {
            let [radius, length] = child_for_each_name(shape, ["radius", "length"], cx);
            let ([radius], [length]) =
                (read_lengths(radius, shape, "radius", cx)?, read_lengths(length, shape, "length", cx)?);
            Some(if kind == "cylinder" {
                Shape::Cylinder(radius, length)
            } else {
                Shape::Capsule(radius, length)
            })
        }
        "mesh" => Some(Shape::Mesh),
        kind => {
            let message = format!("collision geometry {} is not supported", quoted_tag(shape));
            cx.report_error(&element_source_position(shape, cx), message, |d| d.suggest_name(kind, SHAPES));
            None
        }
    }
}

/// Reads positive lengths of an SDF shape, m.
fn read_lengths<const N: usize>(
    child: Option<Node<'_>>,
    shape: Node<'_>,
    element: &str,
    cx: &mut Cx<'_>,
) -> Option<[f64; N]> {
    let found = read_numbers_content::<N>(required_child(child, shape, element, &[], cx)?, cx)?;
    if let Some(x) = found.value.iter().find(|x| **x <= 0.0) {
        let help = "sizes of collision geometry are lengths in m";
        cx.report_error(&found.place, format!("this length must be positive, but it is {x}"), |d| {
            d.add_help(help)
        });
        return None;
    }
    Some(found.value)
}
