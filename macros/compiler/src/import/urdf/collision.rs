//! `<collision>` → collision shapes of links, which contacts refer to.

use super::origin::read_origin;
use crate::diag::Place;
use crate::import::context::Cx;
use crate::import::element::{
    Node, child_elements, child_for_each_name, element_source_position, read_name_attribute,
    read_number_attribute, read_numbers_attribute, report_missing_or_misspelt_attributes, required_child,
};
use crate::import::imported::Located;
use crate::import::mesh;
use crate::import::robot::FileCollisionShape;
use crate::syntax::{MeshVertices, Shape};
use std::path::Path;

/// Names of the URDF shapes that are supported as collision geometry.
const SHAPES: [&str; 5] = ["sphere", "box", "cylinder", "capsule", "mesh"];

/// Reads all collision geometry of a link. Paths of meshes are relative to `folder`.
pub(super) fn read_collisions(link: Node<'_>, folder: &Path, cx: &mut Cx<'_>) -> Vec<FileCollisionShape> {
    let parts = child_elements(link).filter(|node| node.tag_name().name() == "collision");
    parts.filter_map(|part| read_collision(part, folder, cx)).collect()
}

fn read_collision(node: Node<'_>, folder: &Path, cx: &mut Cx<'_>) -> Option<FileCollisionShape> {
    let [origin, geometry] = child_for_each_name(node, ["origin", "geometry"], cx);
    let origin = read_origin(origin, node, cx);
    let geometry = required_child(geometry, node, "geometry", &[], cx)?;
    let [sphere, cuboid, cylinder, capsule, mesh] = child_for_each_name(geometry, SHAPES, cx);
    report_additional_shapes(&[sphere, cuboid, cylinder, capsule, mesh], cx);
    let mut vertices = None;
    let shape = match (sphere, cuboid, cylinder, capsule, mesh) {
        (Some(sphere), ..) => {
            report_missing_or_misspelt_attributes(sphere, &["radius"], &[], cx);
            Shape::Sphere(read_positive_length(sphere, "radius", cx)?)
        }
        (_, Some(cuboid), ..) => {
            report_missing_or_misspelt_attributes(cuboid, &["size"], &[], cx);
            let size: Located<[f64; 3]> = read_numbers_attribute(cuboid, "size", cx)?;
            for x in size.value {
                require_positive_length(x, &size.place, cx)?;
            }
            Shape::Cuboid(size.value)
        }
        (_, _, Some(round), ..) | (_, _, _, Some(round), _) => {
            report_missing_or_misspelt_attributes(round, &["radius", "length"], &[], cx);
            let (radius, length) =
                (read_positive_length(round, "radius", cx), read_positive_length(round, "length", cx));
            if cylinder.is_some() {
                Shape::Cylinder(radius?, length?)
            } else {
                Shape::Capsule(radius?, length?)
            }
        }
        (.., Some(mesh)) => {
            report_missing_or_misspelt_attributes(mesh, &["filename"], &["scale"], cx);
            let path = read_name_attribute(mesh, "filename", cx)?;
            let scale = match mesh.has_attribute("scale") {
                true => read_numbers_attribute(mesh, "scale", cx)?.value,
                false => [1.0; 3],
            };
            let paths = mesh::candidate_paths(folder, &path.text);
            vertices = Some(MeshVertices::scaled_vertices_of_file(path, paths, scale));
            Shape::Mesh
        }
        _ => {
            let message = "collision geometry without a supported shape";
            let help = "supported are `<sphere>`, `<box>`, `<cylinder>`, `<capsule>` and `<mesh>`";
            cx.report_error(&element_source_position(geometry, cx), message.to_string(), |d| {
                d.add_help(help)
            });
            return None;
        }
    };
    Some(FileCollisionShape { origin, shape, mesh: vertices, place: element_source_position(node, cx) })
}

/// Reports shapes of a URDF geometry in addition to the first one.
fn report_additional_shapes(shapes: &[Option<Node<'_>>], cx: &mut Cx<'_>) {
    if let Some(second) = shapes.iter().flatten().nth(1) {
        let help = "write a `<collision>` for each shape";
        cx.report_error(&element_source_position(*second, cx), "second shape of one geometry", |d| {
            d.add_help(help)
        });
    }
}

fn read_positive_length(node: Node<'_>, attribute: &str, cx: &mut Cx<'_>) -> Option<f64> {
    let read = read_number_attribute(node, attribute, cx)?;
    require_positive_length(read.value, &read.place, cx)
}

fn require_positive_length(x: f64, place: &Place, cx: &mut Cx<'_>) -> Option<f64> {
    if x <= 0.0 {
        let help = "sizes of collision geometry are lengths in m";
        cx.report_error(place, format!("this length must be positive, but it is {x}"), |d| d.add_help(help));
        return None;
    }
    Some(x)
}
