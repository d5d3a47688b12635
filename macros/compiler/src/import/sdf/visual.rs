//! `<visual>` → shapes to draw. They appear in no equation, so unsupported shapes are skipped without an
//! error.

use super::collision::{SHAPES, read_shape};
use super::frames::{Frames, element_origin_in_link};
use super::scope::Scope;
use crate::import::context::Cx;
use crate::import::element::{Node, child_elements, read_numbers_content, read_trimmed_content};
use crate::import::robot::FileVisual;
use crate::syntax::{Mesh, Name, Shape};

/// Reads all visual geometry of an SDF link.
pub(super) fn read_visuals(
    node: Node<'_>,
    link: (&Name, &Scope),
    frames: &Frames,
    cx: &mut Cx<'_>,
) -> Vec<FileVisual> {
    let parts = child_elements(node).filter(|node| node.tag_name().name() == "visual");
    parts.filter_map(|part| read_visual(part, link, frames, cx)).collect()
}

fn read_visual(
    node: Node<'_>,
    link: (&Name, &Scope),
    frames: &Frames,
    cx: &mut Cx<'_>,
) -> Option<FileVisual> {
    let geometry = child_elements(node).find(|child| child.tag_name().name() == "geometry")?;
    let is_shape = |child: &Node<'_>| SHAPES.contains(&child.tag_name().name());
    let form = child_elements(geometry).find(is_shape)?;
    let origin = element_origin_in_link(node, link, frames, cx)?;
    let shape = read_shape(form, cx)?;
    let mesh = if shape == Shape::Mesh { Some(read_mesh(form, cx)?) } else { None };
    Some(FileVisual { origin, shape, mesh })
}

fn read_mesh(form: Node<'_>, cx: &mut Cx<'_>) -> Option<Mesh> {
    let find_child_by_tag = |name: &str| child_elements(form).find(|child| child.tag_name().name() == name);
    let path = read_trimmed_content(find_child_by_tag("uri")?, cx)?.text;
    let scale = find_child_by_tag("scale")
        .map_or(Some([1.0; 3]), |scale| read_numbers_content(scale, cx).map(|found| found.value))?;
    Some(Mesh { path, scale })
}
