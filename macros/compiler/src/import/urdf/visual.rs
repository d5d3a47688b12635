//! `<visual>` → shapes to draw. They appear in no equation, so shapes that cannot be read are skipped without
//! an error.

use crate::import::context::Cx;
use crate::import::element::{Node, child_elements, element_source_position};
use crate::import::imported::Located;
use crate::import::robot::{FileOrigin, FileVisual};
use crate::syntax::{Mesh, Shape};

/// Reads all visual geometry of a URDF link.
pub(super) fn read_visuals(link: Node<'_>, cx: &Cx<'_>) -> Vec<FileVisual> {
    child_elements(link)
        .filter(|node| node.tag_name().name() == "visual")
        .filter_map(|part| read_visual(part, cx))
        .collect()
}

fn read_visual(node: Node<'_>, cx: &Cx<'_>) -> Option<FileVisual> {
    let find_child_by_tag = |name: &str| child_elements(node).find(|child| child.tag_name().name() == name);
    let attribute_of_origin = |name| {
        let value = find_child_by_tag("origin")
            .map_or(Some([0.0; 3]), |origin| parse_three_numbers(origin, name, [0.0; 3]))?;
        Some(Located { value, place: element_source_position(node, cx) })
    };
    let (shape, mesh) = child_elements(find_child_by_tag("geometry")?).find_map(read_shape)?;
    Some(FileVisual {
        origin: FileOrigin { xyz: attribute_of_origin("xyz")?, rpy: attribute_of_origin("rpy")? },
        shape,
        mesh,
    })
}

fn read_shape(node: Node<'_>) -> Option<(Shape, Option<Mesh>)> {
    let length_attribute = |name: &str| parse_length(node.attribute(name)?);
    let shape = match node.tag_name().name() {
        "sphere" => Shape::Sphere(length_attribute("radius")?),
        "cylinder" => Shape::Cylinder(length_attribute("radius")?, length_attribute("length")?),
        "capsule" => Shape::Capsule(length_attribute("radius")?, length_attribute("length")?),
        "box" => {
            let edges = parse_three_numbers(node, "size", [0.0; 3])?;
            Shape::Cuboid(edges.iter().all(|x| *x > 0.0).then_some(edges)?)
        }
        "mesh" => {
            let path = node.attribute("filename")?.to_string();
            return Some((
                Shape::Mesh,
                Some(Mesh { path, scale: parse_three_numbers(node, "scale", [1.0; 3])? }),
            ));
        }
        _ => return None,
    };
    Some((shape, None))
}

/// Parses a length of a URDF shape, which must be positive and finite.
fn parse_length(text: &str) -> Option<f64> {
    text.trim().parse().ok().filter(|x: &f64| x.is_finite() && *x > 0.0)
}

/// Parses an attribute with three numbers. Returns `none` if the attribute is missing.
fn parse_three_numbers(node: Node<'_>, name: &str, none: [f64; 3]) -> Option<[f64; 3]> {
    let Some(text) = node.attribute(name) else { return Some(none) };
    let numbers = text.split_whitespace().map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()));
    let numbers: Option<Vec<f64>> = numbers.collect();
    numbers?.try_into().ok()
}
