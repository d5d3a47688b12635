//! Collision geometry → shapes that contacts refer to.

use super::body::ElementWithPose;
use super::defaults::ElementWithDefaults;
use super::reader::{MjcfReader, origin_from_pose};
use super::touch::{ContactGeometry, ContactShape, MjcfContactParameters};
use crate::import::context::Cx;
use crate::import::element::element_source_position;
use crate::import::pose::NumericPose;
use crate::import::robot::FileCollisionShape;
use crate::syntax::{ContactOption, Shape};

impl<'a> MjcfReader<'a> {
    /// Adds the collision shapes of a link, if the options request them: those of the world only for contacts
    /// of the file. Shapes with zero masks are only counted, unless the file declares contacts for them.
    pub(super) fn add_collision_shapes(
        &mut self,
        link: usize,
        shapes: &[ElementWithPose<'a>],
        cx: &mut Cx<'_>,
    ) {
        let has_contacts = self.options.contacts != ContactOption::Ignore;
        let (is_world, what) = match link {
            0 => (true, "geometry of the ground"),
            _ => (false, "geometry of bodies"),
        };
        if !self.options.collisions || is_world && !has_contacts {
            self.count_skipped_contents(what, shapes.len());
            return;
        }
        for (shape, outer) in shapes {
            let name = shape.node.attribute("name");
            let is_paired = name.is_some_and(|name| self.paired_shapes.contains(name));
            let masks = MjcfContactParameters::read_masks(shape, cx);
            let form = shape.trimmed_attribute_text("type").unwrap_or("sphere");
            let is_plane = form == "plane";
            if masks == [0; 2] && !is_paired || is_plane && !has_contacts || ["hfield", "sdf"].contains(&form)
            {
                self.count_skipped_contents(what, 1);
                continue;
            }
            if is_plane {
                let pose = outer.compose_with(&super::frame::read_pose(shape, &self.settings, cx));
                self.record_contact_shape(link, shape, ContactGeometry::Plane(pose), cx);
                continue;
            }
            let Some((kind, pose)) = self.collision_shape(shape, cx) else { continue };
            let at = element_source_position(shape.node, cx);
            let mesh = match kind {
                Shape::Mesh if is_mesh(shape) => self.meshes.vertex_source_of_mesh_shape(shape, cx),
                _ => None,
            };
            let pose = outer.compose_with(&pose);
            if kind == Shape::Mesh && mesh.is_none() {
                if has_contacts {
                    self.count_skipped_contents(
                        "shapes fitted to meshes and generated meshes, for contact",
                        1,
                    );
                }
            } else {
                let number = self.robot.collisions.iter().filter(|(known, _)| *known == link).count();
                let form = ContactGeometry::Solid { number, shape: kind, center: pose.at };
                self.record_contact_shape(link, shape, form, cx);
            }
            let origin = origin_from_pose(&pose, &at);
            let part = FileCollisionShape { origin, shape: kind, mesh, place: at };
            self.robot.collisions.push((link, part));
        }
    }

    /// Records a shape for the contacts of the file.
    fn record_contact_shape(
        &mut self,
        link: usize,
        shape: &ElementWithDefaults<'a>,
        form: ContactGeometry,
        cx: &mut Cx<'_>,
    ) {
        if self.options.contacts == ContactOption::Ignore {
            return;
        }
        if shape.nonzero_attribute_number("margin", cx).is_some() {
            self.count_skipped_contents("margins of contacts", 1);
        }
        let (law, place) = (
            MjcfContactParameters::read_contact_parameters(shape, cx),
            element_source_position(shape.node, cx),
        );
        let name = shape.node.attribute("name").map(str::to_string);
        self.contact_shapes.push(ContactShape { link, form, name, law, place });
    }

    /// Returns a collision shape and its pose relative to the surrounding `<frame>` elements.
    pub(super) fn collision_shape(
        &self,
        shape: &super::defaults::ElementWithDefaults<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<(Shape, NumericPose)> {
        let kind = shape.trimmed_attribute_text("type").unwrap_or("sphere");
        if kind == "mesh" || shape.node_with_attribute("mesh").is_some() {
            let pose = match is_mesh(shape) {
                true => super::frame::read_pose(shape, &self.settings, cx),
                false => NumericPose::ZERO,
            };
            return Some((Shape::Mesh, pose));
        }
        let (pose, [x, y, z]) = super::geometry::shape_pose_and_dimensions(kind, shape, &self.settings, cx)?;
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

/// Whether a shape is a mesh, and not another shape that is fitted to a mesh.
fn is_mesh(shape: &ElementWithDefaults<'_>) -> bool {
    shape.trimmed_attribute_text("type") == Some("mesh")
}
