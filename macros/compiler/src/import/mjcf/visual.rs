//! Geometry → shapes to draw. They appear in no equation, so unsupported shapes are skipped without an error.

use super::body::ElementWithPose;
use super::defaults::ElementWithDefaults;
use super::reader::{MjcfReader, origin_from_pose};
use crate::import::context::Cx;
use crate::import::element::element_source_position;
use crate::import::pose::NumericPose;
use crate::import::robot::FileVisual;
use crate::syntax::{Mesh, Shape};

impl<'a> MjcfReader<'a> {
    /// Adds the shapes of a link that are drawn: shapes without contact, which files contain for this
    /// purpose, or else all shapes.
    pub(super) fn add_visual_shapes(&mut self, link: usize, shapes: &[ElementWithPose<'a>], cx: &mut Cx<'_>) {
        if !self.options.visuals {
            return;
        }
        let mut has_nonzero_contact_mask = |shape: &ElementWithDefaults<'a>| {
            let mut bits =
                |attribute: &str| shape.read_finite_attribute(attribute, cx).map_or(1.0, |bits| bits.value);
            bits("contype") != 0.0 || bits("conaffinity") != 0.0
        };
        let seen: Vec<&ElementWithPose<'a>> =
            shapes.iter().filter(|(shape, _)| !has_nonzero_contact_mask(shape)).collect();
        let seen = if seen.is_empty() { shapes.iter().collect() } else { seen };
        for (shape, outer) in seen {
            let Some((kind, mesh, pose)) = self.visual_shape(shape, cx) else { continue };
            let at = element_source_position(shape.node, cx);
            let part =
                FileVisual { origin: origin_from_pose(&outer.compose_with(&pose), &at), shape: kind, mesh };
            self.robot.visuals.push((link, part));
        }
    }

    fn visual_shape(
        &self,
        shape: &ElementWithDefaults<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<(Shape, Option<Mesh>, NumericPose)> {
        match shape.trimmed_attribute_text("type").unwrap_or("sphere") {
            "mesh" => {
                let pose = super::frame::read_pose(shape, &self.settings, cx);
                Some((Shape::Mesh, Some(self.meshes.mesh_to_draw(shape, cx)?), pose))
            }
            "plane" | "hfield" | "sdf" => None,
            _ => self.collision_shape(shape, cx).map(|(kind, pose)| (kind, None, pose)),
        }
    }
}
