//! `<sdf>` → bodies and joints in coordinate order (SDFormat specification, versions 1.2 to 1.12).
//!
//! Links, joints, models and `<frame>` elements are frames, and a pose is relative to any of them. Nested
//! models become one mechanism; names of their links and joints contain `::`.

use super::context::{Cx, quote_word};
use super::element::{
    Node, child_elements, element_source_position, nonblank_texts_and_own_elements, quoted_tag,
    read_name_attribute, read_numbers_content, read_trimmed_content, report_missing_or_misspelt_attributes,
    report_misspelt_element_name,
};
use super::misplaced;
use super::pose::NumericPose;
use crate::diag::Diagnostics;
use crate::import::imported::ImportedMechanism;
use crate::import::robot::{self, MAX_ELEMENTS, Robot, origin_from_pose};
use crate::import::whole::import_composed_text;
use crate::syntax::{Expr, FileFormat, FileOptions, GROUND, JointKind, Name};
use frames::{Frames, SdfFrame, frame_elements_inside, full_name_in_owner, read_relative_pose};
use scope::{Scope, WORLD, WorldNames};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::rc::Rc;

mod collision;
mod frames;
mod include;
mod joint;
mod link;
mod scope;
mod version;
mod visual;

/// Child elements that an SDF model may have.
const MODEL: [&str; 10] =
    ["link", "joint", "frame", "model", "pose", "static", "include", "plugin", "self_collide", "gripper"];

const MODEL_HELP: &str = "a model holds `<link>`, `<joint>`, `<frame>` and `<model>`";

/// Child elements that an SDF world may have.
const WORLD_PARTS: [&str; 20] = [
    "model",
    "joint",
    "frame",
    "include",
    "gravity",
    "physics",
    "light",
    "scene",
    "state",
    "plugin",
    "actor",
    "road",
    "gui",
    "atmosphere",
    "wind",
    "audio",
    "magnetic_field",
    "population",
    "spherical_coordinates",
    "name",
];

/// First version in which gravity is an element of the world instead of its `<physics>`.
const GRAVITY_OF_WORLD: (u32, u32) = (1, 6);

/// Elements that are skipped unless the options request them, with the text that the generated documentation
/// lists for each.
const ASIDE: [(&str, &str); 12] = [
    ("include", "models that the world includes and that are not next to the file"),
    ("visual", "visual geometry of links"),
    ("collision", "geometry of links, for contact"),
    ("sensor", "sensors"),
    ("light", "lights"),
    ("plugin", "plug-ins, and their effect on the motion"),
    ("battery", "batteries"),
    ("particle_emitter", "emitters of particles"),
    ("actor", "actors"),
    ("gripper", "grippers"),
    ("population", "populations of models"),
    ("state", "states of the world"),
];

/// Elements of an SDF file, collected before their contents are read.
#[derive(Default)]
struct CollectedSdfElements<'a> {
    frames: Frames,
    links: Vec<(Node<'a>, Name, Scope)>,
    /// Names of the frames that `<frame>` elements define.
    marks: Vec<Name>,
    joints: Vec<(Node<'a>, Name, Scope)>,
}

/// Models of the mechanism, each with the prefix of the full names of its elements.
struct PrefixedModels<'a> {
    moving: Vec<(Node<'a>, String)>,
    /// Static models in the world of the mechanism.
    fixed: Vec<(Node<'a>, String)>,
    /// SDF world that contains the models, if the file has one.
    world: Option<Node<'a>>,
}

/// Reads the text of the file at `path` and the models that it includes.
pub(super) fn import_sdf(
    text: &str,
    path: &Path,
    options: &FileOptions,
    cx: &mut Diagnostics,
) -> Option<ImportedMechanism> {
    let whole = include::read_with_includes(text, path, &options.path, cx)?;
    let folder = path.parent().unwrap_or(path);
    import_composed_text(whole, &options.path, FileFormat::Sdf, cx, |root, cx| {
        mechanism_from_root_element(root, folder, options, cx)
    })
}

/// Imports the mechanism from the root element of an SDF file, whose meshes are looked up in `folder`.
fn mechanism_from_root_element<'a>(
    root_node: Node<'a>,
    folder: &Path,
    options: &FileOptions,
    cx: &mut Cx<'_>,
) -> Option<ImportedMechanism> {
    let top = find_models(root_node, cx)?;
    let mut reader = CollectedSdfElements::default();
    reader.collect_top_model_elements(&top, cx)?;
    let mut robot = Robot::default();
    for (node, name, scope) in &reader.links {
        let number = robot.links.len();
        robot.links.extend(link::read_link(*node, (name, scope), &reader.frames, options, cx));
        if options.visuals {
            let parts = visual::read_visuals(*node, (name, scope), &reader.frames, cx);
            robot.visuals.extend(parts.into_iter().map(|part| (number, part)));
        }
        if options.collisions {
            let parts = collision::read_collisions(*node, (name, scope), &reader.frames, folder, cx);
            robot.collisions.extend(parts.into_iter().map(|part| (number, part)));
        }
    }
    for (node, name, scope) in &reader.joints {
        joint::read_joint((*node, name, scope), &reader.frames, options, &mut robot, cx);
    }
    if robot.links.is_empty() && !cx.has_errors() {
        cx.report_error(&element_source_position(top.moving[0].0, cx), "model without a link", |d| {
            d.add_help("expected `<link name=\"…\"/>`")
        });
    }
    if !cx.has_errors() {
        reader.add_frame_links(&mut robot, cx);
        robot::separate_loop_closing_joints(&mut robot, cx);
    }
    robot::check_unique_names(&robot, options.format, cx);
    robot::declare_world_link(&mut robot);
    robot::rename_link_named_ground(&mut robot, options.base);
    robot::report_unknown_links(&robot, cx);
    robot::report_wrong_joint_ends(&robot, options.format, cx);
    robot::check_locked_names(&robot.joints, &options.lock, cx);
    if let Some(tolerance) = options.snap.filter(|_| !cx.has_errors()) {
        robot.snapped =
            robot.joints.iter_mut().flat_map(|joint| robot::snap_joint_frame(joint, tolerance)).collect();
    }
    if cx.has_errors() {
        return None;
    }
    let order = robot::order_joints_along_tree(&robot, cx)?;
    let motions = robot::resolve_motions(&robot.joints, &options.lock, cx)?;
    let root = robot.links.get(order.root)?.name.clone();
    // If the root is a frame of the file, its pose relative to the world is known.
    if reader.frames.known.contains_key(&root.text) {
        robot.root = Some(origin_from_pose(&reader.frames.resolve_world_pose(&root, cx)?, &root.place));
    }
    robot.gravity = gravity_of_world(top.world.or_else(|| first_child_with_tag(root_node, "world")), cx);
    robot.left_out.extend(ignored_contents(root_node, options));
    let standing = links_fixed_to_ground(&robot, &root.text, options);
    let closing = std::mem::take(&mut robot.closing);
    let mut imported = robot::assemble_mechanism(robot, &order, motions, options, cx);
    robot::make_value_fields(&mut imported, &standing, options, cx);
    imported.joints.extend(closing);
    (!cx.has_errors()).then_some(imported)
}

/// Returns the contents of the file that the mechanism does not represent, for the generated documentation.
fn ignored_contents(root: Node<'_>, options: &FileOptions) -> Vec<String> {
    let mut counts = [0; ASIDE.len()];
    for node in root.descendants().filter(Node::is_element) {
        for (count, (element, _)) in counts.iter_mut().zip(ASIDE) {
            let named =
                options.collisions && element == "collision" || options.visuals && element == "visual";
            *count += usize::from(node.tag_name().name() == element && !named);
        }
    }
    let all = root.descendants().filter(|node| node.tag_name().name() == "model");
    let standing = all.filter(|model| is_static(*model)).count();
    let models = ("", "static models of the world");
    let found = ASIDE.into_iter().zip(counts).chain([(models, standing)]).filter(|(_, count)| *count > 0);
    found.map(|((_, what), count)| format!("{what}: {count}")).collect()
}

/// Returns the only moving model of a file, or several models that joints of their world connect.
fn find_models<'a>(root: Node<'a>, cx: &mut Cx<'_>) -> Option<PrefixedModels<'a>> {
    let kind = root.tag_name().name();
    if kind != "sdf" {
        let message = format!("expected `<sdf>`, found {}", quoted_tag(root));
        cx.report_error(&element_source_position(root, cx), message, |d| match kind {
            "robot" => d.add_help("this is a URDF file: write `urdf = \"…\"` instead of `sdf = \"…\"`"),
            "gazebo" => d.add_help(
                "files of versions 1.0 and 1.2 begin so: convert the file, `gz sdf -p robot.sdf > \
                 converted.sdf`, after writing `<sdf version=\"…\">`",
            ),
            "mujoco" => d.add_help("this is an MJCF file: write `mjcf = \"…\"` instead of `sdf = \"…\"`"),
            _ => d.suggest_name(kind, ["sdf"]),
        });
        return None;
    }
    let children_with_tag = |node: Node<'a>, what: &str| -> Vec<Node<'a>> {
        child_elements(node).filter(|child| child.tag_name().name() == what).collect()
    };
    let mut found = children_with_tag(root, "model");
    found.extend(
        children_with_tag(root, "world").into_iter().flat_map(|world| children_with_tag(world, "model")),
    );
    // If another model moves, static models of a world are not part of the mechanism.
    let mut fixed = Vec::new();
    if found.len() > 1 {
        (fixed, found) = found.into_iter().partition(|model| is_static(*model));
    }
    let world_of_model =
        |model: &Node<'a>| model.parent_element().filter(|above| above.tag_name().name() == "world");
    let world = found.first().and_then(world_of_model);
    let has_child_of_kind =
        |kind: &str| world.is_some_and(|world| !children_with_tag(world, kind).is_empty());
    let is_joined = has_child_of_kind("joint") && found.iter().all(|model| world_of_model(model) == world);
    let models_with_prefix = |models: Vec<Node<'a>>, before: &str| -> Vec<(Node<'a>, String)> {
        let name_prefix =
            |model: Node<'a>| format!("{before}{}::", model.attribute("name").unwrap_or_default());
        models.into_iter().map(|model| (model, name_prefix(model))).collect()
    };
    match found.as_slice() {
        [one] => {
            fixed.retain(|model| {
                world_of_model(model) == world && (has_child_of_kind("joint") || has_child_of_kind("frame"))
            });
            let fixed = models_with_prefix(fixed, &format!("{WORLD}::"));
            return Some(PrefixedModels { moving: vec![(*one, String::new())], fixed, world });
        }
        [_, _, ..] if is_joined => {
            fixed.retain(|model| world_of_model(model) == world);
            let fixed = models_with_prefix(fixed, &format!("{WORLD}::"));
            return Some(PrefixedModels { moving: models_with_prefix(found, ""), fixed, world });
        }
        [] => cx.report_error(&element_source_position(root, cx), "SDF file without a model", |d| {
            d.add_help("expected `<sdf version=\"…\"><model name=\"…\"> … </model></sdf>`")
        }),
        [_, second, ..] => {
            cx.report_error(&element_source_position(*second, cx), "SDF file with several models", |d| {
                d.add_help(
                    "a mechanism is one model, or several that joints of their world connect: put the others \
                 into files of their own",
                )
            })
        }
    }
    None
}

/// Returns the first child element of an XML element with this name.
fn first_child_with_tag<'a>(node: Node<'a>, kind: &str) -> Option<Node<'a>> {
    child_elements(node).find(|child| child.tag_name().name() == kind)
}

/// Returns whether an SDF model is static, so that its links do not move.
fn is_static(model: Node<'_>) -> bool {
    let text = first_child_with_tag(model, "static")
        .and_then(|said| nonblank_texts_and_own_elements(said).find_map(|text| text.text()));
    text.is_some_and(|word| matches!(word.trim(), "true" | "1"))
}

/// Returns the gravitational acceleration of a world, by default 9.8 m/s² downwards. Returns `None` for a
/// model without a world.
fn gravity_of_world(world: Option<Node<'_>>, cx: &mut Cx<'_>) -> Option<Expr> {
    let world = world?;
    let said = first_child_with_tag(world, "gravity").or_else(|| {
        let of_physics = first_child_with_tag(first_child_with_tag(world, "physics")?, "gravity")?;
        if !version::is_before_version(world, GRAVITY_OF_WORLD) {
            let message = "`<gravity>` is an element of the world since version 1.6 of SDF";
            cx.report_error(&element_source_position(of_physics, cx), message, |d| {
                d.add_help("move it from `<physics>` into `<world>`")
            });
        }
        Some(of_physics)
    });
    let at = element_source_position(said.unwrap_or(world), cx);
    let value =
        said.and_then(|said| read_numbers_content(said, cx)).map_or([0.0, 0.0, -9.8], |found| found.value);
    Some(Expr::vector_at(value, &at))
}

impl<'a> CollectedSdfElements<'a> {
    /// Collects the links, joints and frames of the models and of their world.
    fn collect_top_model_elements(&mut self, top: &PrefixedModels<'a>, cx: &mut Cx<'_>) -> Option<()> {
        let all = [top.moving.as_slice(), &top.fixed].concat();
        let world = Scope::WorldNames(Rc::new(WorldNames::new(top.world, &all)));
        for (model, prefix) in &top.moving {
            self.collect_model_and_nested_elements((*model, prefix), &world, false, cx)?;
        }
        for (model, prefix) in &top.fixed {
            self.collect_model_and_nested_elements((*model, prefix), &world, true, cx)?;
        }
        if let Some(node) = top.world {
            misplaced::report_misplaced_contents(
                node,
                &["joint"],
                "links and their parts belong to a `<model>`",
                cx,
            );
        }
        for child in top.world.into_iter().flat_map(child_elements) {
            match child.tag_name().name() {
                kind @ ("joint" | "frame") => self.collect_element_of_model(child, kind, &world, false, cx),
                _ => report_misspelt_element_name(child, &WORLD_PARTS, cx),
            }
        }
        Some(())
    }

    /// Collects the links, joints and frames of a model and of its nested models. Of a static model only
    /// frames are collected.
    fn collect_model_and_nested_elements(
        &mut self,
        (top, prefix): (Node<'a>, &str),
        world: &Scope,
        is_fixed: bool,
        cx: &mut Cx<'_>,
    ) -> Option<()> {
        let mut open = vec![(top, prefix.to_string(), world.clone())];
        while let Some((node, prefix, outer)) = open.pop() {
            let scope = Scope::Model(prefix.clone());
            report_missing_or_misspelt_attributes(
                node,
                &["name"],
                &["canonical_link", "placement_frame"],
                cx,
            );
            misplaced::report_misplaced_contents(node, &["link", "joint", "pose"], MODEL_HELP, cx);
            if let Some(frame) =
                node.attribute_node("placement_frame").filter(|frame| !frame.value().is_empty())
            {
                let at = cx.source_position(frame.range_value().start);
                cx.report_error(&at, "`placement_frame` is not supported", |d| {
                    d.add_help("give the model a `<pose>`")
                });
            }
            let own = scope.full_name_of_scope_frame();
            let mut frame = read_relative_pose(node, &outer, &outer.full_name_of_scope_frame(), cx);
            frame.attached = match is_fixed {
                true => Some(Name { text: WORLD.to_string(), place: element_source_position(node, cx) }),
                false => canonical_link(node, &scope, cx),
            };
            if !prefix.is_empty() {
                let short = prefix.trim_end_matches("::").to_string();
                let base = Name { text: own.clone(), place: element_source_position(node, cx) };
                let same = SdfFrame { attached: Some(base.clone()), base, pose: NumericPose::ZERO };
                self.frames.known.insert(short, same);
            }
            self.frames.known.insert(own.clone(), frame);
            for child in child_elements(node) {
                match child.tag_name().name() {
                    kind @ ("link" | "joint" | "frame") => {
                        self.collect_element_of_model(child, kind, &scope, is_fixed, cx)
                    }
                    "model" => {
                        if let Some(inner) = read_name_attribute(child, "name", cx) {
                            open.push((child, format!("{prefix}{}::", inner.text), scope.clone()));
                        }
                    }
                    "static"
                        if !is_fixed
                            && read_trimmed_content(child, cx)
                                .is_some_and(|word| matches!(word.text.as_str(), "true" | "1")) =>
                    {
                        cx.report_error(
                            &element_source_position(child, cx),
                            "the model is static and cannot move",
                            |d| d.add_help("remove `<static>`"),
                        );
                    }
                    _ => report_misspelt_element_name(child, &MODEL, cx),
                }
            }
            if self.links.len() > MAX_ELEMENTS || self.joints.len() > MAX_ELEMENTS {
                cx.report_error(
                    &element_source_position(node, cx),
                    format!("more than {MAX_ELEMENTS} links or joints"),
                    |d| d,
                );
                return None;
            }
        }
        Some(())
    }

    /// Collects a link, a joint or a frame. Each of them defines a frame.
    fn collect_element_of_model(
        &mut self,
        node: Node<'a>,
        kind: &str,
        scope: &Scope,
        is_fixed: bool,
        cx: &mut Cx<'_>,
    ) {
        let Some(mut part) = read_name_attribute(node, "name", cx) else {
            report_missing_or_misspelt_attributes(node, &["name"], &[], cx);
            return;
        };
        part.text = scope.full_name_of_declared_element(&part.text);
        let base = match kind {
            // The pose of a joint is relative to its child by default.
            "joint" => joint::frame_name_at_joint_end(node, "child", scope, cx)
                .map_or(scope.full_name_of_scope_frame(), |child| child.text),
            "frame" => match node.attribute("attached_to").filter(|to| !to.is_empty()) {
                Some(to) => scope.full_name(to),
                None => scope.full_name_of_scope_frame(),
            },
            _ => scope.full_name_of_scope_frame(),
        };
        let mut frame = read_relative_pose(node, scope, &base, cx);
        let at = element_source_position(node, cx);
        let name_with_element_span = |text: &str| Name { text: text.to_string(), place: at.clone() };
        frame.attached = match kind {
            "link" => is_fixed.then(|| name_with_element_span(WORLD)),
            _ => Some(name_with_element_span(&base)),
        };
        for own in frame_elements_inside(node) {
            let mut frame = read_relative_pose(own, scope, &part.text, cx);
            frame.attached = Some(name_with_element_span(&part.text));
            self.frames
                .known
                .insert(full_name_in_owner(&part.text, own.attribute("name").unwrap_or_default()), frame);
        }
        if self.frames.known.insert(part.text.clone(), frame).is_some() && kind != "link" {
            let message = format!("second link, joint or frame with the name {}", quote_word(&part.text));
            cx.report_error(&part.place, message, |d| {
                d.add_help("they are all frames: choose different names")
            });
        }
        match kind {
            _ if is_fixed => {}
            "link" => self.links.push((node, part, scope.clone())),
            "joint" => self.joints.push((node, part, scope.clone())),
            _ => self.marks.push(part),
        }
    }

    /// Adds a massless link for each `<frame>`, welded to the link that the frame is attached to.
    fn add_frame_links(&self, robot: &mut Robot, cx: &mut Cx<'_>) -> Option<()> {
        let mut names: BTreeSet<String> = robot.joints.iter().map(|joint| joint.name.text.clone()).collect();
        let hangs_from_world = robot.joints.iter().any(|joint| joint.parent.text == WORLD);
        for mark in &self.marks {
            let carrier = self.frames.link_of_frame(mark, cx)?;
            // Without joints that start at the world, the world is not a link, and nothing can be welded
            // to it.
            if carrier.text == WORLD && !hangs_from_world {
                continue;
            }
            let (at, base) =
                (self.frames.resolve_world_pose(mark, cx)?, self.frames.resolve_world_pose(&carrier, cx)?);
            let text = robot::unused_name(&format!("{}_weld", mark.text), |name| names.contains(name));
            names.insert(text.clone());
            let name = Name { text, place: mark.place.clone() };
            robot.joints.push(joint::fixed_joint_between_links(
                name,
                carrier,
                mark.clone(),
                origin_from_pose(&base.inverse_pose().compose_with(&at), &mark.place),
            ));
            robot.links.push(robot::massless_link(mark.clone()));
        }
        Some(())
    }
}

/// Returns the link that the frame of a model is attached to: the canonical link, or the first link by
/// default.
fn canonical_link(node: Node<'_>, scope: &Scope, cx: &Cx<'_>) -> Option<Name> {
    if let Some(said) = node.attribute_node("canonical_link").filter(|said| !said.value().is_empty()) {
        let text = scope.full_name(said.value());
        return Some(Name { text, place: cx.source_position(said.range_value().start) });
    }
    let child_name = |what: &str| {
        let found = first_child_with_tag(node, what)?;
        Some(Name {
            text: scope.full_name(found.attribute("name")?),
            place: element_source_position(found, cx),
        })
    };
    child_name("link").or_else(|| child_name("model"))
}

/// Returns the names of the links that are fixed to the ground.
fn links_fixed_to_ground(robot: &Robot, root: &str, options: &FileOptions) -> Vec<String> {
    if options.base == crate::syntax::BaseAttachment::Free {
        return Vec::new();
    }
    let mut standing = BTreeSet::from([GROUND, root]);
    let joints: BTreeMap<&str, &robot::FileJoint> =
        robot.joints.iter().map(|joint| (joint.child.text.as_str(), joint)).collect();
    // Repeated until no link is added.
    loop {
        let before = standing.len();
        for (child, joint) in &joints {
            let held =
                joint.kind == JointKind::Weld || options.lock.iter().any(|lock| lock.text == joint.name.text);
            if held && standing.contains(joint.parent.text.as_str()) {
                standing.insert(*child);
            }
        }
        if standing.len() == before {
            return standing.into_iter().map(str::to_string).collect();
        }
    }
}
