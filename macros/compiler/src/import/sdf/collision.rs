//! `<collision>` → collision shapes of links, which contacts refer to.

use super::frames::{Frames, origin_in};
use super::scope::Scope;
use crate::import::context::Cx;
use crate::import::element::{
    Node, check_attributes, children, content, elements, place, required, tag, word,
};
use crate::import::mesh;
use crate::import::robot::FileCollision;
use crate::syntax::{MeshVertices, Name, Shape};
use std::path::Path;

/// Shapes of collision geometry that are supported.
pub(super) const SHAPES: [&str; 6] = ["sphere", "box", "cylinder", "capsule", "ellipsoid", "mesh"];

/// Reads all collision geometry of a link. Paths of meshes are relative to `folder`.
pub(super) fn read(
    node: Node<'_>,
    link: (&Name, &Scope),
    frames: &Frames,
    folder: &Path,
    cx: &mut Cx<'_>,
) -> Vec<FileCollision> {
    let parts = elements(node).filter(|node| node.tag_name().name() == "collision");
    parts.filter_map(|part| read_part(part, link, frames, folder, cx)).collect()
}

fn read_part(
    node: Node<'_>,
    link: (&Name, &Scope),
    frames: &Frames,
    folder: &Path,
    cx: &mut Cx<'_>,
) -> Option<FileCollision> {
    let geometry = elements(node).find(|child| child.tag_name().name() == "geometry");
    let geometry = required(geometry, node, "geometry", &[], cx)?;
    let mut shapes = elements(geometry).filter(|child| child.tag_name().name() != "empty");
    let form = shapes.next()?;
    if let Some(second) = shapes.next() {
        let help = "write a `<collision>` for each shape";
        cx.error(&place(second, cx), "second shape of one geometry", |d| d.help(help));
    }
    let origin = origin_in(node, link, frames, cx)?;
    let shape = read_shape(form, cx)?;
    let mesh = match shape {
        Shape::Mesh => read_mesh(form, folder, cx),
        _ => None,
    };
    Some(FileCollision { origin, shape, mesh, place: place(node, cx) })
}

/// Returns the source of the vertices of a mesh; `None` for a part of a mesh.
fn read_mesh(form: Node<'_>, folder: &Path, cx: &mut Cx<'_>) -> Option<MeshVertices> {
    let [uri, scale, submesh] = children(form, ["uri", "scale", "submesh"], cx);
    let path = word(required(uri, form, "uri", &[], cx)?, cx)?;
    let scale = match scale {
        Some(scale) => content(scale, cx)?.value,
        None => [1.0; 3],
    };
    let paths = mesh::candidates(folder, &path.text);
    submesh.is_none().then(|| MeshVertices::scaled(path, paths, scale))
}

/// Reads a child element of `<geometry>` as a shape.
pub(super) fn read_shape(shape: Node<'_>, cx: &mut Cx<'_>) -> Option<Shape> {
    check_attributes(shape, &[], &[], cx);
    match shape.tag_name().name() {
        "sphere" => {
            let [radius] = children(shape, ["radius"], cx);
            let [radius] = lengths(radius, shape, "radius", cx)?;
            Some(Shape::Sphere(radius))
        }
        "box" => {
            let [size] = children(shape, ["size"], cx);
            Some(Shape::Cuboid(lengths(size, shape, "size", cx)?))
        }
        "ellipsoid" => {
            let [radii] = children(shape, ["radii"], cx);
            Some(Shape::Ellipsoid(lengths(radii, shape, "radii", cx)?))
        }
        kind @ ("cylinder" | "capsule") => {
            let [radius, length] = children(shape, ["radius", "length"], cx);
            let ([radius], [length]) =
                (lengths(radius, shape, "radius", cx)?, lengths(length, shape, "length", cx)?);
            Some(if kind == "cylinder" {
                Shape::Cylinder(radius, length)
            } else {
                Shape::Capsule(radius, length)
            })
        }
        "mesh" => Some(Shape::Mesh),
        kind => {
            let message = format!("collision geometry {} is not supported", tag(shape));
            cx.error(&place(shape, cx), message, |d| d.suggest(kind, SHAPES));
            None
        }
    }
}

/// Reads positive lengths of a shape, m.
fn lengths<const N: usize>(
    child: Option<Node<'_>>,
    shape: Node<'_>,
    element: &str,
    cx: &mut Cx<'_>,
) -> Option<[f64; N]> {
    let found = content::<N>(required(child, shape, element, &[], cx)?, cx)?;
    if let Some(x) = found.value.iter().find(|x| **x <= 0.0) {
        let help = "sizes of collision geometry are lengths in m";
        cx.error(&found.place, format!("this length must be positive, but it is {x}"), |d| d.help(help));
        return None;
    }
    Some(found.value)
}
