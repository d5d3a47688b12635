//! `<visual>` → shapes to draw. Nothing that is drawn enters an equation: what has no form is left out.

use super::collision::{SHAPES, read_shape};
use super::frames::{Frames, origin, read_frame};
use crate::import::context::Cx;
use crate::import::element::{Node, content, elements, place, word};
use crate::import::robot::FileVisual;
use crate::syntax::{Mesh, Name, Shape};

/// Reads all visual geometry of a link.
pub(super) fn read(
    link: Node<'_>,
    (name, prefix): (&Name, &str),
    frames: &Frames,
    cx: &mut Cx<'_>,
) -> Vec<FileVisual> {
    let parts = elements(link).filter(|node| node.tag_name().name() == "visual");
    parts.filter_map(|part| read_part(part, (name, prefix), frames, cx)).collect()
}

fn read_part(
    node: Node<'_>,
    (name, prefix): (&Name, &str),
    frames: &Frames,
    cx: &mut Cx<'_>,
) -> Option<FileVisual> {
    let geometry = elements(node).find(|child| child.tag_name().name() == "geometry")?;
    let known = |child: &Node<'_>| SHAPES.contains(&child.tag_name().name());
    let form = elements(geometry).find(known)?;
    let frame = read_frame(node, prefix, &name.text, cx);
    let pose = frames.resolve(name, cx)?.back().then(&frames.resolve(&frame.base, cx)?.then(&frame.pose));
    let shape = read_shape(form, cx)?;
    let mesh = if shape == Shape::Mesh { Some(read_mesh(form, cx)?) } else { None };
    Some(FileVisual { origin: origin(&pose, &place(node, cx)), shape, mesh })
}

fn read_mesh(form: Node<'_>, cx: &mut Cx<'_>) -> Option<Mesh> {
    let child = |name: &str| elements(form).find(|child| child.tag_name().name() == name);
    let path = word(child("uri")?, cx)?.text;
    let scale = child("scale").map_or(Some([1.0; 3]), |scale| content(scale, cx).map(|found| found.value))?;
    Some(Mesh { path, scale })
}
