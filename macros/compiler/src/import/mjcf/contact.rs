//! Geometry for contact → shapes that contacts name.

use super::body::Shaped;
use super::reader::{Reader, origin};
use crate::import::context::Cx;
use crate::import::element::place;
use crate::import::pose::Pose;
use crate::import::robot::FileCollision;
use crate::syntax::Shape;

impl<'a> Reader<'a> {
    /// Adds those shapes of a link that touch others, if contacts name any.
    pub(super) fn add_collisions(&mut self, link: usize, shapes: &[Shaped<'a>], cx: &mut Cx<'_>) {
        if !self.options.collisions {
            self.count("geometry of bodies", shapes.len());
            return;
        }
        for (shape, outer) in shapes {
            let mut bits = |attribute: &str| shape.number(attribute, cx).map_or(1.0, |bits| bits.value);
            if bits("contype") == 0.0 && bits("conaffinity") == 0.0 {
                self.count("geometry of bodies", 1);
                continue;
            }
            let Some((kind, pose)) = self.collision(shape, cx) else { continue };
            let at = place(shape.node, cx);
            let part = FileCollision { origin: origin(&outer.then(&pose), &at), shape: kind, place: at };
            self.robot.collisions.push((link, part));
        }
    }

    /// The form of a shape, and its pose in the frames around it.
    pub(super) fn collision(
        &self,
        shape: &super::defaults::Element<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<(Shape, Pose)> {
        let kind = shape.text("type").unwrap_or("sphere");
        if kind == "mesh" || shape.with("mesh").is_some() {
            return Some((Shape::Mesh, Pose::ZERO));
        }
        let (pose, [x, y, z]) = super::geometry::dimensions(kind, shape, &self.settings, cx)?;
        let shape = match kind {
            "sphere" => Shape::Sphere(x),
            "capsule" => Shape::Capsule(x, 2.0 * z),
            "cylinder" => Shape::Cylinder(x, 2.0 * z),
            "box" => Shape::Cuboid([2.0 * x, 2.0 * y, 2.0 * z]),
            _ => Shape::Ellipsoid([x, y, z]),
        };
        Some((shape, pose))
    }
}
