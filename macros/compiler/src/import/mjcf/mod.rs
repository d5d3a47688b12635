//! Import of MJCF: `<mujoco>` → bodies and joints in coordinate order.
//!
//! Contents of the file that affect the equations of motion without contacts are imported or reported as
//! errors. Other contents are skipped and listed in the generated documentation.

use super::context::{Cx, quote_word};
use super::element::{Node, child_elements, element_source_position, quoted_tag};
use super::whole::import_composed_text;
use crate::diag::Diagnostics;
use crate::import::imported::ImportedMechanism;
use crate::import::robot::{self, JointOrder};
use crate::syntax::{
    ContactOption, Expr, FileForceLaw, FileForceTarget, FileFormat, FileOptions, GROUND, JointKind,
};
use defaults::Defaults;
use mesh::Meshes;
use reader::MjcfReader;
use settings::MjcfSettings;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

mod activation;
mod actuator;
mod body;
mod contact;
mod dc_motor;
mod defaults;
mod equality;
mod formula;
mod frame;
mod geometry;
mod include;
mod joint;
mod law;
mod medium;
mod mesh;
mod muscle;
mod pairs;
mod reader;
mod record;
mod rest;
pub(in crate::import) mod schema;
mod settings;
mod site;
mod spatial;
mod tendon;
mod touch;
mod visual;
mod winding;

/// Sections without influence on the motion, with the text that the generated documentation lists for each.
const ASIDE: [(&str, &str); 3] =
    [("contact", "pairs and exceptions of contact"), ("sensor", "sensors"), ("keyframe", "keyframes")];

/// Imports the text of the MJCF file at `path`.
pub(super) fn import_file(
    text: &str,
    path: &Path,
    options: &FileOptions,
    cx: &mut Diagnostics,
) -> Option<ImportedMechanism> {
    let whole = include::read_with_includes(text, path, &options.path, cx)?;
    let folder = path.parent().unwrap_or(path);
    import_composed_text(whole, &options.path, FileFormat::Mjcf, cx, |root, cx| {
        read_mjcf_root(root, folder, options, cx)
    })
}

fn read_mjcf_root(
    root: Node<'_>,
    folder: &Path,
    options: &FileOptions,
    cx: &mut Cx<'_>,
) -> Option<ImportedMechanism> {
    if !check_root_element(root, cx) {
        return None;
    }
    schema::check_schema(root, cx);
    if let Some(node) = child_elements(root).find(|node| node.tag_name().name() == "deformable")
        && child_elements(node).next().is_some()
    {
        cx.report_error(&element_source_position(node, cx), "deformable bodies are not supported", |d| {
            d.add_help("remove `<deformable>`")
        });
    }
    let settings = MjcfSettings::read_settings(root, cx);
    let defaults = Defaults::read_defaults(root, cx);
    let meshes = Meshes::list_meshes(root, folder, &settings, &defaults, cx);
    let mut reader = MjcfReader::new(options, settings, defaults, meshes);
    reader.read_world(root, cx)?;
    reader.scale_masses();
    reader.add_fluid_drag(cx);
    robot::check_unique_names(&reader.robot, options.format, cx);
    reader.add_contacts(root, cx);
    let tendons = reader.read_tendons(root, cx);
    reader.read_equalities(root, &tendons, cx);
    reader.read_actuators(root, &tendons, cx);
    for (section, what) in ASIDE {
        let is_read = section == "contact" && options.contacts != ContactOption::Ignore;
        let nodes = child_elements(root).filter(|node| node.tag_name().name() == section && !is_read);
        reader.count_skipped_contents(what, nodes.map(|node| child_elements(node).count()).sum());
    }
    let gravity = &reader.settings.gravity;
    reader.robot.gravity = Some(Expr::vector_at(gravity.value, &gravity.place));
    reader.robot.left_out = ignored_contents(&reader);
    assemble_imported_mechanism(reader, options, cx)
}

/// Assembles the imported mechanism from the contents that the reader collected.
fn assemble_imported_mechanism(
    reader: MjcfReader<'_>,
    options: &FileOptions,
    cx: &mut Cx<'_>,
) -> Option<ImportedMechanism> {
    let mut robot = reader.robot;
    robot::check_locked_names(&robot.joints, &options.lock, cx);
    report_infinite_values(&robot, cx);
    if cx.has_errors() {
        return None;
    }
    if let Some(tolerance) = options.snap {
        robot.snapped =
            robot.joints.iter_mut().flat_map(|joint| robot::snap_joint_frame(joint, tolerance)).collect();
    }
    let motions = robot::resolve_motions(&robot.joints, &options.lock, cx)?;
    let links: BTreeMap<&str, usize> =
        robot.links.iter().enumerate().map(|(k, link)| (link.name.text.as_str(), k)).collect();
    let children = robot.joints.iter().enumerate();
    let joints =
        children.filter_map(|(k, joint)| Some((k, *links.get(joint.child.text.as_str())?))).collect();
    let order = JointOrder { root: 0, joints };
    let standing = links_fixed_to_ground(&robot, options);
    let closing = std::mem::take(&mut robot.closing);
    let files = reader.meshes.files;
    let mut imported = robot::assemble_mechanism(robot, &order, motions, options, cx);
    robot::make_value_fields(&mut imported, &standing, options, cx);
    imported.joints.extend(closing);
    imported.files = files;
    (!cx.has_errors()).then_some(imported)
}

/// Reports values of an MJCF file that overflow as products of finite numbers.
fn report_infinite_values(robot: &robot::Robot, cx: &mut Cx<'_>) {
    let has_finite_literals =
        |e: &Expr| e.all_subexpressions().into_iter().filter_map(Expr::literal_number).all(f64::is_finite);
    for link in &robot.links {
        if ![&link.mass, &link.com, &link.inertia].into_iter().flatten().all(has_finite_literals) {
            let message = format!(
                "body {} is too large, too heavy or too far away for floating-point numbers",
                quote_word(&link.name.text)
            );
            cx.report_error(&link.name.place, message, |d| d);
        }
    }
    for joint in &robot.joints {
        if !joint.origin.xyz.value.iter().chain(&joint.origin.rpy.value).all(|x| x.is_finite()) {
            let message =
                format!("joint {} is too far away for floating-point numbers", quote_word(&joint.name.text));
            cx.report_error(&joint.name.place, message, |d| d);
        }
    }
    for joint in &robot.joints {
        let follows = joint.mimic.as_ref().map_or([0.0; 2], |mimic| [mimic.multiplier, mimic.offset]);
        if !follows.into_iter().chain(joint.held).all(f64::is_finite) {
            let message = format!(
                "the value that joint {} follows is too large for floating-point numbers",
                quote_word(&joint.name.text)
            );
            cx.report_error(&joint.name.place, message, |d| d);
        }
    }
    for constraint in &robot.constraints {
        if ![Some(&constraint.value), constraint.other.as_ref()]
            .into_iter()
            .flatten()
            .all(has_finite_literals)
        {
            let message = format!(
                "the coupling {} is too large for floating-point numbers",
                quote_word(&constraint.name.text)
            );
            cx.report_error(&constraint.name.place, message, |d| d);
        }
    }
    for drive in &robot.drives {
        let law = match drive.law {
            FileForceLaw::Spring { stiffness, free } => stiffness.is_finite() && free.is_finite(),
            FileForceLaw::Slack { stiffness, range } => {
                stiffness.into_iter().chain(range).all(f64::is_finite)
            }
            FileForceLaw::PolynomialDamper(damping) => damping.into_iter().all(f64::is_finite),
            FileForceLaw::Expression { ref force, .. } => has_finite_literals(force),
            FileForceLaw::Damper(x)
            | FileForceLaw::Friction(x)
            | FileForceLaw::Inerter(x)
            | FileForceLaw::Push(x) => x.is_finite(),
            FileForceLaw::Input(_) => true,
        };
        let on = match &drive.on {
            FileForceTarget::Sum(terms) => terms.iter().all(|(_, weight)| weight.is_finite()),
            FileForceTarget::Length(e) => has_finite_literals(e),
            FileForceTarget::Wrench(wrench) => {
                wrench.force.into_iter().chain(wrench.torque).all(f64::is_finite)
            }
        };
        if !law || !on {
            let message = format!(
                "a force of {} is too large for floating-point numbers",
                quote_word(&drive.name.text)
            );
            cx.report_error(&drive.name.place, message, |d| d);
        }
    }
}

/// Returns the names of the links that are fixed to the ground.
fn links_fixed_to_ground(robot: &robot::Robot, options: &FileOptions) -> Vec<String> {
    let mut standing = BTreeSet::from([GROUND]);
    for joint in &robot.joints {
        let held =
            joint.kind == JointKind::Weld || options.lock.iter().any(|lock| lock.text == joint.name.text);
        if held && standing.contains(joint.parent.text.as_str()) {
            standing.insert(&joint.child.text);
        }
    }
    standing.into_iter().map(str::to_string).collect()
}

/// Returns true if the root element is `<mujoco>`; otherwise reports an error.
fn check_root_element(node: Node<'_>, cx: &mut Cx<'_>) -> bool {
    let name = node.tag_name().name();
    if name == "mujoco" {
        return true;
    }
    let message = format!("expected `<mujoco>`, found {}", quoted_tag(node));
    cx.report_error(&element_source_position(node, cx), message, |d| match name {
        "robot" => d.add_help("this is a URDF file: write `urdf = \"…\"` instead of `mjcf = \"…\"`"),
        "sdf" => d.add_help("this is an SDF file: write `sdf = \"…\"` instead of `mjcf = \"…\"`"),
        "mujocoinclude" => d.add_help("this is a part of a model: name the file that includes it"),
        _ => d.suggest_name(name, ["mujoco"]),
    });
    false
}

/// Returns the contents of the file that the mechanism does not represent, for the generated documentation.
fn ignored_contents(reader: &MjcfReader<'_>) -> Vec<String> {
    let mut lines: Vec<String> = reader
        .counts
        .iter()
        .filter(|(_, count)| **count > 0)
        .map(|(what, count)| match what.starts_with("geometry") {
            true => format!("{what}, for contact: {count} shapes"),
            false => format!("{what}: {count}"),
        })
        .collect();
    lines.extend(reader.left_out.iter().cloned());
    lines
}
