//! Collision geometry → shapes that contacts refer to, and contacts with the planes of the world.

use super::body::ElementWithPose;
use super::defaults::Element;
use super::reader::{MjcfReader, origin_of_pose};
use super::touch::{CollisionShape, MjcfContactParameters, Plane};
use crate::import::context::Cx;
use crate::import::element::element_source_position;
use crate::import::pose::FilePose;
use crate::import::robot::{FileCollisionShape, unused_name};
use crate::syntax::Shape;
use crate::syntax::contact::CONTACT_HELP;
use std::collections::BTreeSet;

impl<'a> MjcfReader<'a> {
    /// Adds the collision shapes of a link, if the options request them. Shapes with zero masks are only
    /// counted.
    pub(super) fn add_collision_shapes(
        &mut self,
        link: usize,
        shapes: &[ElementWithPose<'a>],
        cx: &mut Cx<'_>,
    ) {
        if !self.options.collisions {
            self.count_skipped_contents("geometry of bodies", shapes.len());
            return;
        }
        for (shape, outer) in shapes {
            let mut bits =
                |attribute: &str| shape.read_finite_attribute(attribute, cx).map_or(1.0, |bits| bits.value);
            if bits("contype") == 0.0 && bits("conaffinity") == 0.0 {
                self.count_skipped_contents("geometry of bodies", 1);
                continue;
            }
            let Some((kind, pose)) = self.collision_shape(shape, cx) else { continue };
            let at = element_source_position(shape.node, cx);
            let mesh = match kind {
                Shape::Mesh if is_mesh(shape) => self.meshes.vertices_of_shape(shape, cx),
                _ => None,
            };
            let is_known = kind != Shape::Mesh || mesh.is_some();
            self.record_contact_shape(link, shape, is_known, cx);
            let origin = origin_of_pose(&outer.compose_with(&pose), &at);
            let part = FileCollisionShape { origin, shape: kind, mesh, place: at };
            self.robot.collisions.push((link, part));
        }
    }

    /// Records a shape for contacts with the planes of the world. Shapes without known contact points are
    /// only counted.
    fn record_contact_shape(&mut self, link: usize, shape: &Element<'a>, is_known: bool, cx: &mut Cx<'_>) {
        if !self.options.contacts {
            return;
        }
        if !is_known {
            self.count_skipped_contents("shapes fitted to meshes and generated meshes, for contact", 1);
            return;
        }
        let number = self.robot.collisions.iter().filter(|(known, _)| *known == link).count();
        let (law, place) =
            (MjcfContactParameters::read_contact_law(shape, cx), element_source_position(shape.node, cx));
        let name = shape.node.attribute("name").map(str::to_string);
        self.touching.push(CollisionShape { link, number, name, law, place });
    }

    /// Adds the planes of the world for contacts. Other shapes of the world are only counted.
    pub(super) fn add_world_planes(&mut self, shapes: &[ElementWithPose<'a>], cx: &mut Cx<'_>) {
        for (shape, outer) in shapes {
            if !self.options.contacts || shape.trimmed_text("type") != Some("plane") {
                self.count_skipped_contents("geometry of the ground", 1);
                continue;
            }
            let law = MjcfContactParameters::read_contact_law(shape, cx);
            if law.has_no_contacts() {
                self.count_skipped_contents("geometry of the ground", 1);
                continue;
            }
            let pose = outer.compose_with(&super::frame::read_pose(shape, &self.settings, cx));
            let number = self.planes.len() + 1;
            let name = shape.node.attribute("name").map_or_else(|| format!("plane{number}"), str::to_string);
            self.planes.push(Plane { name, pose, law });
        }
    }

    /// Declares a contact for each pair of a shape and a plane whose masks permit contact.
    pub(super) fn add_plane_contacts(&mut self, cx: &mut Cx<'_>) {
        if !self.options.contacts {
            return;
        }
        if !self.settings.has_contacts() {
            self.left_out.push("contacts, which the file disables".to_string());
            return;
        }
        if self.planes.is_empty() {
            let place = &self.options.path.place;
            cx.report_error(place, "the world of the file has no plane to touch", |d| {
                d.add_help(CONTACT_HELP)
            });
            return;
        }
        self.left_out.push("contacts of bodies with each other".to_string());
        let mut names: BTreeSet<String> = self.joint_names.union(&self.link_names).cloned().collect();
        for touching in &self.touching {
            let link = self.robot.links[touching.link].name.text.clone();
            let shape = touching.name.clone().unwrap_or_else(|| format!("{link}_geom{}", touching.number));
            for plane in self.planes.iter().filter(|plane| touching.law.masks_permit_contact(&plane.law)) {
                let end = if self.planes.len() > 1 { format!("_{}", plane.name) } else { String::new() };
                let text = unused_name(&format!("{shape}{end}_contact"), |name| names.contains(name));
                names.insert(text.clone());
                self.robot.contacts.push(touching.contact_with_plane(text, &link, plane));
            }
        }
        if self.robot.contacts.is_empty() {
            let place = &self.options.path.place;
            cx.report_error(
                place,
                "no body of the file has a shape that can touch a plane of its world",
                |d| {
                    d.add_help(
                    "shapes excluded by `contype` and `conaffinity`, or fitted to meshes, have no contacts",
                )
                .add_help("to ignore the contacts of the file, remove `contacts = file`")
                },
            );
        }
    }

    /// Returns a collision shape and its pose relative to the surrounding `<frame>` elements.
    pub(super) fn collision_shape(
        &self,
        shape: &super::defaults::Element<'a>,
        cx: &mut Cx<'_>,
    ) -> Option<(Shape, FilePose)> {
        let kind = shape.trimmed_text("type").unwrap_or("sphere");
        if kind == "mesh" || shape.node_with_attribute("mesh").is_some() {
            let pose = match is_mesh(shape) {
                true => super::frame::read_pose(shape, &self.settings, cx),
                false => FilePose::ZERO,
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
fn is_mesh(shape: &Element<'_>) -> bool {
    shape.trimmed_text("type") == Some("mesh")
}
