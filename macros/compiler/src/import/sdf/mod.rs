//! `<sdf>` → bodies and joints in coordinate order (SDFormat specification, versions 1.5 to 1.12).
//!
//! A link, a joint, a model and a `<frame>` are frames, and a pose is relative to any of them. Nested models become one
//! mechanism; their links and joints have names with `::`.

use super::context::{Cx, quote};
use super::element::{Node, check_attributes, check_element_name, content, elements, name, place, tag, word};
use super::pose::Pose;
use crate::diag::Diagnostics;
use crate::import::imported::Imported;
use crate::import::robot::{self, MAX_ELEMENTS, Robot};
use crate::import::whole::imported;
use crate::syntax::{Expr, FileFormat, FileOptions, GROUND, JointKind, Name};
use frames::{Frame, Frames, WORLD, model, origin, read_frame};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

mod collision;
mod frames;
mod include;
mod joint;
mod link;
mod visual;

/// What a model holds.
const MODEL: [&str; 10] =
    ["link", "joint", "frame", "model", "pose", "static", "include", "plugin", "self_collide", "gripper"];

/// What the motion without contact does not depend on.
const ASIDE: [(&str, &str); 9] = [
    ("include", "models that the world includes and that are not beside the file"),
    ("visual", "visual geometry of links"),
    ("collision", "geometry of links, for contact"),
    ("sensor", "sensors"),
    ("light", "lights"),
    ("plugin", "plug-ins, and what they do to the motion"),
    ("battery", "batteries"),
    ("particle_emitter", "emitters of particles"),
    ("actor", "actors"),
];

/// What is read of a file.
#[derive(Default)]
struct Reader<'a> {
    frames: Frames,
    links: Vec<(Node<'a>, Name, String)>,
    /// Frames that are nothing else.
    marks: Vec<Name>,
    joints: Vec<(Node<'a>, Name, String)>,
}

/// Reads the text of the file at `path`, with the models that it includes.
pub(super) fn import(
    text: &str,
    path: &Path,
    options: &FileOptions,
    cx: &mut Diagnostics,
) -> Option<Imported> {
    let whole = include::read_whole(text, path, &options.path, cx)?;
    imported(whole, &options.path, FileFormat::Sdf, cx, |root, cx| read(root, options, cx))
}

/// Reads the root element.
fn read<'a>(root_node: Node<'a>, options: &FileOptions, cx: &mut Cx<'_>) -> Option<Imported> {
    let top = find_model(root_node, cx)?;
    let mut reader = Reader::default();
    reader.read_models(top, cx)?;
    let mut robot = Robot::default();
    for (node, name, prefix) in &reader.links {
        let number = robot.links.len();
        robot.links.extend(link::read_link(*node, name, &reader.frames, options, cx));
        if options.visuals {
            let parts = visual::read(*node, (name, prefix), &reader.frames, cx);
            robot.visuals.extend(parts.into_iter().map(|part| (number, part)));
        }
        if options.collisions {
            let parts = collision::read(*node, (name, prefix), &reader.frames, cx);
            robot.collisions.extend(parts.into_iter().map(|part| (number, part)));
        }
    }
    for (node, name, prefix) in &reader.joints {
        joint::read_joint((*node, name, prefix), &reader.frames, options, &mut robot, cx);
    }
    if robot.links.is_empty() && !cx.failed() {
        cx.error(&place(top, cx), "model without a link", |d| d.help("expected `<link name=\"…\"/>`"));
    }
    if !cx.failed() {
        reader.mark(&mut robot, cx);
        robot::close_loops(&mut robot, cx);
    }
    robot::check_names(&robot, options.format, cx);
    robot::declare_world(&mut robot);
    robot::rename_ground(&mut robot, options.base);
    robot::check_ends(&robot, cx);
    robot::check_locks(&robot.joints, &options.lock, cx);
    if let Some(tolerance) = options.snap.filter(|_| !cx.failed()) {
        robot.snapped = robot.joints.iter_mut().flat_map(|joint| robot::snap(joint, tolerance)).collect();
    }
    if cx.failed() {
        return None;
    }
    let order = robot::order_joints(&robot, cx)?;
    let motions = robot::resolve_motions(&robot.joints, &options.lock, cx)?;
    let root = robot.links.get(order.root)?.name.clone();
    // What the world itself is called stands where it is.
    if reader.frames.known.contains_key(&root.text) {
        robot.root = Some(origin(&reader.frames.resolve(&root, cx)?, &root.place));
    }
    robot.gravity = gravity(root_node, cx);
    robot.left_out.extend(left_out(root_node, options));
    let standing = standing(&robot, &root.text, options);
    let closing = std::mem::take(&mut robot.closing);
    let mut imported = robot::assemble(robot, &order, motions, options, cx);
    robot::make_fields(&mut imported, &standing, options, cx);
    imported.joints.extend(closing);
    (!cx.failed()).then_some(imported)
}

/// What the generated documentation lists.
fn left_out(root: Node<'_>, options: &FileOptions) -> Vec<String> {
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

/// The one model of a file.
fn find_model<'a>(root: Node<'a>, cx: &mut Cx<'_>) -> Option<Node<'a>> {
    let kind = root.tag_name().name();
    if kind != "sdf" {
        let message = format!("expected `<sdf>`, found {}", tag(root));
        cx.error(&place(root, cx), message, |d| match kind {
            "robot" => d.help("this is a URDF file: write `urdf = \"…\"` instead of `sdf = \"…\"`"),
            "mujoco" => d.help("this is an MJCF file: write `mjcf = \"…\"` instead of `sdf = \"…\"`"),
            _ => d.suggest(kind, ["sdf"]),
        });
        return None;
    }
    let named = |node: Node<'a>, what: &str| -> Vec<Node<'a>> {
        elements(node).filter(|child| child.tag_name().name() == what).collect()
    };
    let mut found = named(root, "model");
    found.extend(named(root, "world").into_iter().flat_map(|world| named(world, "model")));
    // What stands in the world is not the mechanism, where there is one that moves.
    if found.len() > 1 {
        found.retain(|model| !is_static(*model));
    }
    match found.as_slice() {
        [one] => return Some(*one),
        [] => cx.error(&place(root, cx), "SDF file without a model", |d| {
            d.help("expected `<sdf version=\"…\"><model name=\"…\"> … </model></sdf>`")
        }),
        [_, second, ..] => cx.error(&place(*second, cx), "SDF file with several models", |d| {
            d.help(
                "a mechanism is one model: put the others into files of their own, or all into one `<model>`",
            )
        }),
    }
    None
}

/// True for a model that nothing moves.
fn is_static(model: Node<'_>) -> bool {
    let said = elements(model).find(|child| child.tag_name().name() == "static");
    said.and_then(|said| said.text()).is_some_and(|word| matches!(word.trim(), "true" | "1"))
}

/// Gravity of a world, which is 9.8 m/s² unless it says another; a model alone says nothing of it.
fn gravity(root: Node<'_>, cx: &mut Cx<'_>) -> Option<Expr> {
    let world = elements(root).find(|child| child.tag_name().name() == "world")?;
    let said = elements(world).find(|child| child.tag_name().name() == "gravity");
    let at = place(said.unwrap_or(world), cx);
    let value = said.and_then(|said| content(said, cx)).map_or([0.0, 0.0, -9.8], |found| found.value);
    Some(Expr::vector(value, &at))
}

impl<'a> Reader<'a> {
    /// Gathers the links, joints and frames of a model and of those in it.
    fn read_models(&mut self, top: Node<'a>, cx: &mut Cx<'_>) -> Option<()> {
        let mut open = vec![(top, String::new(), WORLD.to_string())];
        while let Some((node, prefix, base)) = open.pop() {
            let outer = prefix.trim_end_matches("::").rsplit_once("::").map_or("", |(outer, _)| outer);
            let outer = if outer.is_empty() { String::new() } else { format!("{outer}::") };
            check_attributes(node, &["name"], &["canonical_link", "placement_frame"], cx);
            if let Some(frame) =
                node.attribute_node("placement_frame").filter(|frame| !frame.value().is_empty())
            {
                let at = cx.place(frame.range_value().start);
                cx.error(&at, "`placement_frame` is not supported", |d| d.help("give the model a `<pose>`"));
            }
            let own = model(&prefix);
            let mut frame = read_frame(node, &outer, &base, cx);
            frame.attached = canonical_link(node, &prefix, cx);
            if !prefix.is_empty() {
                let short = prefix.trim_end_matches("::").to_string();
                let base = Name { text: own.clone(), place: place(node, cx) };
                let same = Frame { attached: Some(base.clone()), base, pose: Pose::ZERO };
                self.frames.known.insert(short, same);
            }
            self.frames.known.insert(own.clone(), frame);
            for child in elements(node) {
                match child.tag_name().name() {
                    kind @ ("link" | "joint" | "frame") => self.read_part(child, kind, &prefix, &own, cx),
                    "model" => {
                        if let Some(inner) = name(child, "name", cx) {
                            open.push((child, format!("{prefix}{}::", inner.text), own.clone()));
                        }
                    }
                    "static"
                        if word(child, cx).is_some_and(|word| matches!(word.text.as_str(), "true" | "1")) =>
                    {
                        cx.error(&place(child, cx), "the model is static: nothing of it moves", |d| {
                            d.help("remove `<static>`")
                        });
                    }
                    _ => check_element_name(child, &MODEL, cx),
                }
            }
            if self.links.len() > MAX_ELEMENTS || self.joints.len() > MAX_ELEMENTS {
                cx.error(&place(node, cx), format!("more than {MAX_ELEMENTS} links or joints"), |d| d);
                return None;
            }
        }
        Some(())
    }

    /// A link, a joint or a frame: all of them are frames.
    fn read_part(&mut self, node: Node<'a>, kind: &str, prefix: &str, own: &str, cx: &mut Cx<'_>) {
        let Some(mut part) = name(node, "name", cx) else {
            check_attributes(node, &["name"], &[], cx);
            return;
        };
        part.text = format!("{prefix}{}", part.text);
        let base = match kind {
            // Joints stand on their children.
            "joint" => joint::end(node, "child", prefix, cx).map_or(own.to_string(), |child| child.text),
            "frame" => match node.attribute("attached_to").filter(|to| !to.is_empty()) {
                Some(to) => frames::whole(prefix, to),
                None => own.to_string(),
            },
            _ => own.to_string(),
        };
        let mut frame = read_frame(node, prefix, &base, cx);
        let at = || place(node, cx);
        frame.attached = (kind != "link").then(|| Name { text: base, place: at() });
        if self.frames.known.insert(part.text.clone(), frame).is_some() && kind != "link" {
            let message = format!("second link, joint or frame with the name {}", quote(&part.text));
            cx.error(&part.place, message, |d| d.help("all of them are frames: names of frames differ"));
        }
        match kind {
            "link" => self.links.push((node, part, prefix.to_string())),
            "joint" => self.joints.push((node, part, prefix.to_string())),
            _ => self.marks.push(part),
        }
    }

    /// Frames that are nothing else become links without mass, welded to what they are attached to.
    fn mark(&self, robot: &mut Robot, cx: &mut Cx<'_>) -> Option<()> {
        let mut names: BTreeSet<String> = robot.joints.iter().map(|joint| joint.name.text.clone()).collect();
        for mark in &self.marks {
            let carrier = self.frames.carrier(mark, cx)?;
            let (at, base) = (self.frames.resolve(mark, cx)?, self.frames.resolve(&carrier, cx)?);
            let text = robot::unused(&format!("{}_weld", mark.text), |name| names.contains(name));
            names.insert(text.clone());
            let name = Name { text, place: mark.place.clone() };
            robot.joints.push(joint::weld(
                name,
                carrier,
                mark.clone(),
                origin(&base.back().then(&at), &mark.place),
            ));
            robot.links.push(robot::bare_link(mark.clone()));
        }
        Some(())
    }
}

/// The link that a model's own frame moves with: the one that it says, or its first.
fn canonical_link(node: Node<'_>, prefix: &str, cx: &Cx<'_>) -> Option<Name> {
    if let Some(said) = node.attribute_node("canonical_link").filter(|said| !said.value().is_empty()) {
        let text = frames::whole(prefix, said.value());
        return Some(Name { text, place: cx.place(said.range_value().start) });
    }
    let named = |what: &str| {
        let found = elements(node).find(|child| child.tag_name().name() == what)?;
        Some(Name { text: frames::whole(prefix, found.attribute("name")?), place: place(found, cx) })
    };
    named("link").or_else(|| named("model"))
}

/// Names of the links that nothing lets move.
fn standing(robot: &Robot, root: &str, options: &FileOptions) -> Vec<String> {
    if options.base == crate::syntax::Base::Free {
        return Vec::new();
    }
    let mut standing = BTreeSet::from([GROUND, root]);
    let joints: BTreeMap<&str, &robot::FileJoint> =
        robot.joints.iter().map(|joint| (joint.child.text.as_str(), joint)).collect();
    // As often as links can stand on one another.
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
