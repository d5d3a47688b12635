//! `<worldbody>` → links and joints, in the order of the file.

use super::defaults::{ElementWithDefaults, read_boolean_attribute};
use super::frame::read_pose;
use super::geometry;
use super::joint::{BodyJoint, IGNORE_PASSIVE, is_joint_element};
use super::reader::{MjcfReader, assign_mass_properties, origin_from_pose};
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_elements, element_source_position, quoted_tag, read_name_attribute, read_number_attribute,
};
use crate::import::imported::Located;
use crate::import::pose::{
    NumericPose, axis_rotation, matrix_product, matrix_times_vector, vector_sum, vector_times_scalar,
};
use crate::import::robot::{FileJoint, FileLimits, MAX_ELEMENTS, massless_link, unused_name};
use crate::syntax::{BaseAttachment, BinaryOp, Expr, ExprKind, GROUND, InertiaOption, JointKind, Name};

/// MuJoCo's name of the body that is fixed to the ground.
pub(super) const WORLD: &str = "world";

const WRITTEN_OUT: &str = "MuJoCo can write the expanded model: `mj_saveLastXML`, or its program `compile`";

/// Body of an MJCF file that remains to be read.
struct PendingBody<'a> {
    node: Node<'a>,
    /// Name of the parent link of the body.
    parent: Name,
    /// Pose of the surrounding `<frame>` elements relative to the parent.
    outer: NumericPose,
    /// Pose of the parent relative to the world, in the configuration of the file.
    world: NumericPose,
    class: usize,
}

/// Shape or site, with the pose of its surrounding `<frame>` elements relative to the body.
pub(super) type ElementWithPose<'a> = (ElementWithDefaults<'a>, NumericPose);

/// Contents of a body, including the contents of its `<frame>` elements.
#[derive(Default)]
struct BodyContents<'a> {
    bodies: Vec<(Node<'a>, NumericPose, usize)>,
    shapes: Vec<ElementWithPose<'a>>,
    sites: Vec<ElementWithPose<'a>>,
    inertial: Option<(Node<'a>, NumericPose)>,
    /// Joints, each with the pose of its surrounding `<frame>` elements relative to the body, and its class.
    jointed: Vec<(Node<'a>, NumericPose, usize)>,
}

impl<'a> MjcfReader<'a> {
    /// Reads the world and all bodies of an MJCF file.
    pub(super) fn read_world(&mut self, root: Node<'a>, cx: &mut Cx<'_>) -> Option<()> {
        let world = Name { text: GROUND.to_string(), place: element_source_position(root, cx) };
        self.robot.links.push(massless_link(world.clone()));
        // Generated names must differ from the names in the file.
        let names_of_elements = |kind: fn(Node<'_>) -> bool| {
            let nodes = root.descendants().filter(move |node| node.is_element() && kind(*node));
            nodes.filter_map(|node| node.attribute("name")).map(str::to_string)
        };
        let is_joint_inside_body = |node: Node<'_>| {
            let parent = node.parent_element().map_or("", |parent| parent.tag_name().name());
            is_joint_element(node) && ["body", "frame"].contains(&parent)
        };
        self.joint_names = names_of_elements(is_joint_inside_body).collect();
        self.link_names = names_of_elements(|node| node.tag_name().name() == "body").collect();
        self.link_names.extend([GROUND.to_string(), WORLD.to_string()]);
        let worlds: Vec<Node<'a>> =
            child_elements(root).filter(|node| node.tag_name().name() == "worldbody").collect();
        if worlds.is_empty() {
            cx.report_error(&element_source_position(root, cx), "`<mujoco>` without `<worldbody>`", |d| d);
            return None;
        }
        self.collect_paired_shape_names(root);
        let mut open: Vec<PendingBody<'a>> = Vec::new();
        for node in worlds.into_iter().rev() {
            let class = self.defaults.class_index(node, "childclass", 0, cx);
            let inside = self.contents_of_body(node, class, cx);
            let fixed = inside.jointed.iter().map(|(node, ..)| *node);
            for node in fixed.chain(inside.inertial.map(|(node, _)| node)) {
                let message = format!("{} of the world, which does not move", quoted_tag(node));
                cx.report_error(&element_source_position(node, cx), message, |d| {
                    d.add_help("move it into a `<body>`")
                });
            }
            self.collect_sites(&inside, GROUND, cx);
            self.add_collision_shapes(0, &inside.shapes, cx);
            self.record_named_shapes(GROUND, &inside.shapes, cx);
            open.extend(inside.bodies.into_iter().rev().map(|(node, outer, class)| PendingBody {
                node,
                parent: world.clone(),
                outer,
                world: NumericPose::ZERO,
                class,
            }));
        }
        self.reject_wrong_free_base_option(&open, cx);
        // With an explicit stack, because chains may be long.
        while let Some(next) = open.pop() {
            if self.robot.links.len() > MAX_ELEMENTS {
                cx.report_error(
                    &element_source_position(next.node, cx),
                    format!("more than {MAX_ELEMENTS} bodies"),
                    |d| d,
                );
                return None;
            }
            let below = self.read_body(next, cx);
            open.extend(below.into_iter().rev());
        }
        self.add_site_frames(cx);
        Some(())
    }

    /// Reports the option `base = free` unless the file has exactly one outermost body and it has no joints.
    fn reject_wrong_free_base_option(&self, open: &[PendingBody<'a>], cx: &mut Cx<'_>) {
        if self.options.base != BaseAttachment::Free {
            return;
        }
        let fits = match open {
            [one] => !child_elements(one.node).any(is_joint_element),
            _ => false,
        };
        if !fits {
            let found = match open.len() {
                1 => "its outermost body has joints".to_string(),
                n => format!("there are {n} outermost bodies"),
            };
            let message = format!("`base = free` does not fit this file: {found}");
            let place = self.options.path.place.clone();
            cx.report_error(&place, message, |d| {
                d.add_help(
                    "an MJCF file determines the base itself: write `<freejoint/>` into a body, and remove \
                     `base`",
                )
            });
        }
    }

    fn read_body(&mut self, open: PendingBody<'a>, cx: &mut Cx<'_>) -> Vec<PendingBody<'a>> {
        let node = open.node;
        self.bodies += 1;
        let mocap = read_boolean_attribute(node, "mocap", cx) == Some(true);
        let class = self.defaults.class_index(node, "childclass", open.class, cx);
        let said = node.attribute("name").and_then(|_| read_name_attribute(node, "name", cx));
        let body = self.body_name(said, node, cx);
        let element = self.defaults.element_with_defaults(node, &[], 0, cx);
        let pose = open.outer.compose_with(&read_pose(&element, &self.settings, cx));
        let world = open.world.compose_with(&pose);
        let inside = self.contents_of_body(node, class, cx);
        let mut joints = Vec::new();
        for (child, outer, class) in &inside.jointed {
            joints.extend(self.read_joint((*child, outer, *class), &body, cx));
        }
        if mocap && (open.parent.text != GROUND || !joints.is_empty()) {
            let message = format!("mocap body {} is not fixed to the world", quote_word(&body.text));
            cx.report_error(&body.place, message, |d| {
                d.add_help("a mocap body is a child of `<worldbody>` and has no joint")
            });
        }
        self.report_aligned_free_joint(&inside, cx);
        if self.options.base == BaseAttachment::Free && open.parent.text == GROUND && joints.is_empty() {
            joints.extend(self.generated_free_joint(&body));
        }
        self.reject_gravity_compensation(node, cx);
        let mass = match self.options.inertias {
            InertiaOption::None => None,
            _ => geometry::mass_properties_of_body(
                &inside.inertial,
                &inside.shapes,
                &self.defaults,
                &mut self.meshes,
                (&pose, &self.settings),
                cx,
            ),
        };
        self.collect_sites(&inside, &body.text, cx);
        if mocap {
            self.mocap.insert(body.text.clone());
        }
        self.add_joint_chain(&open.parent, &body, &pose, joints, cx);
        let mut link = massless_link(body.clone());
        if let Some(mass) = &mass {
            assign_mass_properties(&mut link, mass, &source_position_of_mass(&inside, node, cx));
        }
        self.add_collision_shapes(self.robot.links.len(), &inside.shapes, cx);
        self.add_visual_shapes(self.robot.links.len(), &inside.shapes, cx);
        self.record_named_shapes(&body.text, &inside.shapes, cx);
        self.robot.links.push(link);
        self.masses.push(mass);
        self.poses.insert(body.text.clone(), world);
        let next = inside.bodies.into_iter();
        next.map(|(node, outer, class)| PendingBody { node, parent: body.clone(), outer, world, class })
            .collect()
    }

    fn body_name(&mut self, said: Option<Name>, node: Node<'a>, cx: &mut Cx<'_>) -> Name {
        let mut body = said.unwrap_or_else(|| {
            let text = unused_name(&format!("body{}", self.bodies), |name| self.link_names.contains(name));
            Name { text, place: element_source_position(node, cx) }
        });
        if body.text == GROUND {
            body.text = unused_name("ground_link", |name| self.link_names.contains(name));
        }
        if body.text == WORLD {
            let help = "`world` is the fixed world: choose another name";
            cx.report_error(&body.place, "a body with the name `world`", |d| d.add_help(help));
        }
        self.link_names.insert(body.text.clone());
        body
    }

    /// Collects the elements in a body, each with the pose of its surrounding `<frame>` elements.
    fn contents_of_body(&mut self, node: Node<'a>, class: usize, cx: &mut Cx<'_>) -> BodyContents<'a> {
        let mut found = BodyContents::default();
        self.gather_body_contents(node, &NumericPose::ZERO, class, &mut found, cx);
        found
    }

    fn gather_body_contents(
        &mut self,
        node: Node<'a>,
        outer: &NumericPose,
        class: usize,
        found: &mut BodyContents<'a>,
        cx: &mut Cx<'_>,
    ) {
        for child in child_elements(node) {
            match child.tag_name().name() {
                "frame" => {
                    for which in ["scale", "scaling", "massscale"] {
                        if let Some(found) = child.attribute_node(which) {
                            let message = format!("`{which}` of a `<frame>` is not supported");
                            cx.report_error(&cx.source_position(found.range_value().start), message, |d| {
                                d.add_help(WRITTEN_OUT)
                            });
                        }
                    }
                    let class = self.defaults.class_index(child, "childclass", class, cx);
                    let element = self.defaults.element_with_defaults(child, &[], 0, cx);
                    let pose = outer.compose_with(&read_pose(&element, &self.settings, cx));
                    // The recursion depth is that of nested elements, which is limited.
                    self.gather_body_contents(child, &pose, class, found, cx);
                }
                "body" => found.bodies.push((child, *outer, class)),
                "geom" => found
                    .shapes
                    .push((self.defaults.element_with_defaults(child, &["geom"], class, cx), *outer)),
                "site" => found
                    .sites
                    .push((self.defaults.element_with_defaults(child, &["site"], class, cx), *outer)),
                "inertial" if found.inertial.is_some() => {
                    cx.report_error(
                        &element_source_position(child, cx),
                        "second `<inertial>` of one body",
                        |d| d,
                    );
                }
                "inertial" => found.inertial = Some((child, *outer)),
                "joint" | "freejoint" => found.jointed.push((child, *outer, class)),
                "camera" => self.count_skipped_contents("cameras", 1),
                "light" => self.count_skipped_contents("lights", 1),
                "composite" | "flexcomp" | "replicate" | "attach" | "plugin" => {
                    let message = format!("{} is not supported", quoted_tag(child));
                    cx.report_error(&element_source_position(child, cx), message, |d| {
                        d.add_help(WRITTEN_OUT)
                    });
                }
                // Unknown elements are reported by the schema check.
                _ => {}
            }
        }
    }

    /// Reports a free joint that aligns the axes of its body with the principal axes. Its coordinates would
    /// differ from those of the unaligned body.
    fn report_aligned_free_joint(&self, inside: &BodyContents<'a>, cx: &mut Cx<'_>) {
        for (joint, ..) in &inside.jointed {
            let aligned = joint.tag_name().name() == "freejoint"
                && read_boolean_attribute(*joint, "align", cx).unwrap_or(self.settings.align_free);
            if aligned && inside.bodies.is_empty() {
                let message = "a free body in principal axes is not supported";
                cx.report_error(&element_source_position(*joint, cx), message, |d| {
                    d.add_help("write `align=\"false\"` into the joint: the motion is the same in any axes")
                });
            }
        }
    }

    fn reject_gravity_compensation(&mut self, node: Node<'_>, cx: &mut Cx<'_>) {
        if let Some(found) =
            read_number_attribute(node, "gravcomp", cx).filter(|found| self.passive && found.value != 0.0)
        {
            let message = "`gravcomp` is not supported";
            cx.report_error(&found.place, message, |d| d.add_help(IGNORE_PASSIVE));
        }
    }

    /// Adds the joints between a body and its parent as a chain, with massless links between them.
    fn add_joint_chain(
        &mut self,
        parent: &Name,
        body: &Name,
        pose: &NumericPose,
        joints: Vec<BodyJoint>,
        cx: &mut Cx<'_>,
    ) {
        let number = joints.len();
        let free = joints.iter().find(|joint| joint.kind == JointKind::Free);
        if let Some(free) = free.filter(|_| number > 1 || parent.text != GROUND) {
            let message =
                format!("free joint {} of a body with other joints or a parent", quote_word(&free.name.text));
            let help = "a free body is a child of `<worldbody>` and has no other joint";
            cx.report_error(&free.name.place, message, |d| d.add_help(help));
            return;
        }
        if joints.is_empty() {
            let text = unused_name(&format!("{}_weld", body.text), |name| self.joint_names.contains(name));
            self.joint_names.insert(text.clone());
            let name = Name { text, place: body.place.clone() };
            self.robot.joints.push(weld_joint(name, parent.clone(), body.clone(), pose));
            return;
        }
        let mut carrier = parent.clone();
        for (k, joint) in joints.into_iter().enumerate() {
            let child = if k + 1 == number { body.clone() } else { self.add_massless_link(body, &joint) };
            let outer = if k == 0 { *pose } else { NumericPose::ZERO };
            if let Some(damping) = &joint.spread {
                self.add_isotropic_damping(&joint, damping, &carrier, &child);
            }
            self.references.insert(joint.name.text.clone(), joint.reference);
            self.robot.joints.push(joint_with_ends(joint, &carrier, &child, &outer));
            carrier = child;
        }
    }

    /// Adds a massless link between two joints of a body and returns its name.
    fn add_massless_link(&mut self, body: &Name, joint: &BodyJoint) -> Name {
        let text =
            unused_name(&format!("{}_{}", body.text, joint.name.text), |name| self.link_names.contains(name));
        self.link_names.insert(text.clone());
        let name = Name { text, place: body.place.clone() };
        self.robot.links.push(massless_link(name.clone()));
        self.masses.push(None);
        name
    }

    /// Adds isotropic damping of a ball joint or a free body: the Rayleigh dissipation function `½ d (v·v +
    /// ω·ω)`.
    fn add_isotropic_damping(
        &mut self,
        joint: &BodyJoint,
        damping: &Located<f64>,
        carrier: &Name,
        child: &Name,
    ) {
        let at = &damping.place;
        let name_expr = |name: &str| Expr { kind: ExprKind::Name(name.to_string()), place: at.clone() };
        let half_damping_times_square = |e: Expr| {
            let square = Expr::function_call_expression("dot", vec![e.clone(), e], at);
            Expr::binary_operation(BinaryOp::Mul, Expr::number_at(damping.value / 2.0, at), square)
        };
        let quotient = |a, b| Expr::binary_operation(BinaryOp::Div, a, b);
        let turning = Expr::function_call_expression(
            "omega",
            vec![quotient(name_expr(&child.text), name_expr(&carrier.text))],
            at,
        );
        let mut sum = half_damping_times_square(turning);
        if joint.kind == JointKind::Free {
            let path = quotient(quotient(name_expr(&child.text), name_expr(GROUND)), name_expr(GROUND));
            sum = Expr::binary_operation(
                BinaryOp::Add,
                sum,
                half_damping_times_square(Expr::function_call_expression("v", vec![path], at)),
            );
        }
        let text = format!("{}_damping", joint.name.text);
        self.robot.dissipations.push((Name { text, place: at.clone() }, sum));
    }

    fn generated_free_joint(&mut self, body: &Name) -> Option<BodyJoint> {
        let text = unused_name(crate::syntax::ROOT_JOINT, |name| self.joint_names.contains(name));
        self.joint_names.insert(text.clone());
        let place = body.place.clone();
        let value_with_source_place = |value| Located { value, place: place.clone() };
        Some(BodyJoint {
            name: Name { text, place: place.clone() },
            kind: JointKind::Free,
            word: "free",
            anchor: value_with_source_place([0.0; 3]),
            axis: value_with_source_place([0.0, 0.0, 1.0]),
            reference: 0.0,
            limits: FileLimits::default(),
            damping: None,
            friction: None,
            spread: None,
        })
    }

    /// Collects the sites of a body. Sites with names become frames.
    fn collect_sites(&mut self, inside: &BodyContents<'a>, body: &str, cx: &mut Cx<'_>) {
        for (site, outer) in &inside.sites {
            let named =
                site.node.has_attribute("name").then(|| read_name_attribute(site.node, "name", cx)).flatten();
            if let Some(mesh) = site.attribute_text_with_span("mesh", cx) {
                cx.report_error(&mesh.place, "a site that is fitted to a mesh is not supported", |d| d);
            }
            let Some((pose, _)) = geometry::pose_and_half_length(site, &self.settings, cx) else { continue };
            if let Some(named) = named {
                self.poses_of_sites.insert(named.text.clone(), (body.to_string(), outer.compose_with(&pose)));
                self.sites.push((named, body.to_string(), outer.compose_with(&pose)));
            }
        }
    }

    fn add_site_frames(&mut self, cx: &mut Cx<'_>) {
        for (mut site, body, pose) in std::mem::take(&mut self.sites) {
            if self.robot.links.len() > 2 * MAX_ELEMENTS {
                cx.report_error(&site.place, format!("more than {MAX_ELEMENTS} bodies and sites"), |d| d);
                return;
            }
            if self.link_names.contains(&site.text) {
                site.text =
                    unused_name(&format!("{}_site", site.text), |name| self.link_names.contains(name));
            }
            self.link_names.insert(site.text.clone());
            let text = unused_name(&format!("{}_weld", site.text), |name| self.joint_names.contains(name));
            self.joint_names.insert(text.clone());
            let joint = Name { text, place: site.place.clone() };
            let parent = Name { text: body, place: site.place.clone() };
            self.robot.joints.push(weld_joint(joint, parent, site.clone(), &pose));
            self.robot.links.push(massless_link(site));
            self.masses.push(None);
        }
    }
}

/// Returns the source position of the mass properties of a body.
fn source_position_of_mass(inside: &BodyContents<'_>, node: Node<'_>, cx: &Cx<'_>) -> Place {
    element_source_position(inside.inertial.map_or(node, |(node, _)| node), cx)
}

/// Returns a joint that fixes one link to another.
fn weld_joint(name: Name, parent: Name, child: Name, pose: &NumericPose) -> FileJoint {
    let origin = origin_from_pose(pose, &name.place);
    FileJoint::weld(name, "weld", [parent, child], origin)
}

/// Returns the joint with its endpoints. In the configuration of the file, its coordinate equals its
/// reference instead of zero. The coordinates of a free joint are the pose of the body in the world.
fn joint_with_ends(joint: BodyJoint, carrier: &Name, child: &Name, outer: &NumericPose) -> FileJoint {
    let axis = joint.axis.value;
    let mut inner = NumericPose { at: joint.anchor.value, ..NumericPose::ZERO };
    match joint.kind.single_axis_joint_is_rotational() {
        Some(true) if joint.reference != 0.0 => inner.axes = axis_rotation(axis, -joint.reference),
        Some(false) => inner.at = vector_sum(inner.at, vector_times_scalar(axis, -joint.reference)),
        Some(true) | None => {}
    }
    let free = joint.kind == JointKind::Free;
    let initial = match joint.kind {
        JointKind::Free => outer.free_joint_coordinates(),
        _ if joint.reference != 0.0 => vec![joint.reference],
        _ => Vec::new(),
    };
    let pose = if free {
        NumericPose::ZERO
    } else {
        NumericPose {
            at: vector_sum(outer.at, matrix_times_vector(&outer.axes, inner.at)),
            axes: matrix_product(&outer.axes, &inner.axes),
        }
    };
    let origin = origin_from_pose(&pose, &joint.anchor.place);
    let links = [carrier.clone(), child.clone()];
    FileJoint {
        anchor: if free { [0.0; 3] } else { joint.anchor.value },
        limits: joint.limits,
        damping: joint.damping,
        friction: joint.friction,
        initial,
        ..FileJoint::joint_between_links(joint.name, (joint.kind, joint.word), links, origin, joint.axis)
    }
}
