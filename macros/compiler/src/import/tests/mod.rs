//! Tests of the importers: compare the description, or the errors, as text.

use super::{FileOptions, ImportedMechanism, import_file};
use crate::diag::Diagnostics;
use crate::syntax::{
    BaseAttachment, BinaryOp, Body, ContactOption, Endpoint, Expr, ExprKind, FileForceElement, FileForceLaw,
    FileForceTarget, FileFormat, FileInputSource, InertiaOption, Joint, LoopOption, Name,
};
use proc_macro2::Span;
use std::fs;
use std::path::{Path, PathBuf};

mod contacts;
mod couplings;
mod files;
mod fuzz;
mod hulls;
mod joints;
mod links;
mod loops;
mod malformed;
mod mjcf;
mod names;
mod schema;
mod sdf;
mod spatial;
mod turns;

fn name_at_call_site(text: &str) -> Name {
    Name { text: text.to_string(), place: Span::call_site().into() }
}

/// Temporary folder for the files of one test.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str, files: &[(&str, &str)]) -> Folder {
        let folder = std::env::temp_dir().join(format!("linkwork-{test}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let folder = Folder(folder);
        files.iter().for_each(|(name, text)| folder.write_file(name, text.as_bytes()));
        folder
    }

    /// Writes a file of the folder, in a subfolder that need not exist.
    fn write_file(&self, name: &str, bytes: &[u8]) {
        let path = self.0.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, bytes).expect("a file");
    }

    fn import_as_text(&self, options: &FileOptions, text: &str) -> String {
        let mut cx = Diagnostics::new();
        match import_file(text, &self.0, options, &mut cx) {
            Some(imported) => format!("{}{} files", render_description(&imported), imported.files.len()),
            None => cx.full_message_texts().join("\n"),
        }
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // Files that remain in the folder for temporary files do no harm.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Returns the default options of a robot file.
fn default_file_options() -> FileOptions {
    FileOptions::default_options_of_file(FileFormat::Urdf, name_at_call_site("r.urdf"))
}

fn options_with_locked_joints(joints: &[&str]) -> FileOptions {
    FileOptions {
        lock: joints.iter().map(|joint| name_at_call_site(joint)).collect(),
        ..default_file_options()
    }
}

/// Compares the result for `text` with `expected`. Indentation and empty lines are ignored.
fn check_import_with_options(options: &FileOptions, text: &str, expected: &str) {
    let trim_lines = |text: &str| -> String {
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        lines.map(|line| format!("{line}\n")).collect()
    };
    let actual = import_as_text(options, text);
    assert!(trim_lines(&actual) == trim_lines(expected), "expected\n{expected}\nfound\n{actual}");
}

fn check_import_with_default_options(text: &str, expected: &str) {
    check_import_with_options(&default_file_options(), text, expected);
}

/// Compares the result for elements inside `<robot>`. The elements begin on the second line.
fn check_import_of_robot_elements(inside: &str, expected: &str) {
    check_import_with_default_options(&format!("<robot name=\"r\">\n{inside}\n</robot>"), expected);
}

/// Imports a text that refers to no other files.
fn import_text(text: &str, options: &FileOptions, cx: &mut Diagnostics) -> Option<ImportedMechanism> {
    import_file(text, Path::new(""), options, cx)
}

/// Returns the imported description as text, or the error messages.
fn import_as_text(options: &FileOptions, text: &str) -> String {
    let mut cx = Diagnostics::new();
    let imported = import_text(text, options, &mut cx);
    assert_eq!(imported.is_some(), cx.is_empty(), "nothing is given just when there is a mistake");
    match imported {
        Some(imported) => render_description(&imported),
        None => cx.full_message_texts().join("\n"),
    }
}

fn render_description(imported: &ImportedMechanism) -> String {
    let bodies = imported.bodies.iter().map(render_body);
    let joints = imported.joints.iter().map(render_joint);
    let drives = imported.drives.iter().map(render_drive);
    let constraints = imported.constraints.iter().map(|constraint| {
        let other = constraint.other.as_ref().map_or_else(|| "0".to_string(), render_expr);
        format!("{}: {} = {other}", constraint.name.text, render_expr(&constraint.value))
    });
    let left_out = imported.left_out.iter().map(|line| format!("left out {line}"));
    let rounded = imported.snapped.iter().map(|line| format!("rounded {line}"));
    let ground = imported.is_ground.then(|| "the root is the ground".to_string());
    ground
        .into_iter()
        .chain(bodies)
        .chain(joints)
        .chain(drives)
        .chain(constraints)
        .chain(rounded)
        .chain(left_out)
        .map(|line| line + "\n")
        .collect()
}

fn render_body(body: &Body) -> String {
    let mut line = format!("body {}", body.name.text);
    for (word, value) in [("mass", &body.mass), ("com", &body.com), ("inertia", &body.inertia)] {
        if let Some(value) = value {
            line += &format!(" {word}={}", render_expr(value));
        }
    }
    line
}

fn render_joint(joint: &Joint) -> String {
    let (parent, child) = (render_endpoint(&joint.parent), render_endpoint(&joint.child));
    let mut line = format!("{:?} {}: {parent} -> {child}", joint.kind, joint.name.text);
    for (word, axes) in [("about", &joint.about), ("along", &joint.along)] {
        for axis in axes {
            line += &format!(" {word} {}", render_expr(axis));
        }
    }
    assert_eq!(joint.normalise_axis, !(joint.about.is_empty() && joint.along.is_empty()));
    if let Some(mimic) = &joint.mimic {
        line += &format!(" = {} {} + {}", mimic.multiplier, mimic.joint.text, mimic.offset);
    }
    for (word, value) in [("damping", &joint.damping), ("friction", &joint.friction)] {
        if let Some(value) = value {
            line += &format!(" {word}={}", render_expr(value));
        }
    }
    line + if joint.driven { " driven" } else { "" }
}

fn render_drive(drive: &FileForceElement) -> String {
    let vector_components_text = |vector: [f64; 3]| vector.map(|x| x.to_string()).join(" ");
    let on = match &drive.on {
        FileForceTarget::Sum(terms) => {
            let terms: Vec<String> =
                terms.iter().map(|(joint, weight)| format!("{weight} {}", joint.text)).collect();
            terms.join(" + ")
        }
        FileForceTarget::Length(e) => render_expr(e),
        FileForceTarget::Wrench(wrench) => {
            let against = wrench.against.iter().map(|e| format!(" against {}", render_expr(e)));
            let [force, torque] = [wrench.force, wrench.torque].map(vector_components_text);
            format!("{} by {force}, {torque}{}", render_expr(&wrench.on), against.collect::<String>())
        }
    };
    let law = match &drive.law {
        FileForceLaw::Spring { stiffness, free } => format!("spring {stiffness} from {free}"),
        FileForceLaw::Slack { stiffness, range: [low, high] } => {
            let terms: Vec<String> = stiffness.iter().map(f64::to_string).collect();
            let terms = terms.join(", ").replace(", 0, 0", "");
            format!("spring {terms} outside of {low} to {high}")
        }
        FileForceLaw::Damper(damping) => format!("damper {damping}"),
        FileForceLaw::Friction(force) => format!("friction {force}"),
        FileForceLaw::Inerter(inertance) => format!("inerter {inertance}"),
        FileForceLaw::Push(force) => format!("push {force}"),
        FileForceLaw::Input(unit) => format!("input in {unit}"),
        FileForceLaw::PolynomialDamper(terms) => format!("damper {terms:?}"),
        FileForceLaw::Expression { force, .. } => format!("force {}", render_expr(force)),
    };
    format!("{}: {law} on {on}", drive.name.text)
}

fn render_endpoint(end: &Endpoint) -> String {
    let at = end.at.iter().map(|at| format!(".at({})", render_expr(at)));
    let rotated =
        (!end.rotated.is_empty()).then(|| format!(".rotated({})", render_expressions(&end.rotated)));
    let words = std::iter::once(end.body.text.clone()).chain(at).chain(rotated);
    words.collect()
}

fn render_expressions(list: &[Expr]) -> String {
    list.iter().map(render_expr).collect::<Vec<_>>().join(", ")
}

fn render_expr(expr: &Expr) -> String {
    assert!(expr.place.file.is_some(), "every expression has its place in the file");
    match &expr.kind {
        ExprKind::Number(value) => value.to_string(),
        ExprKind::Array(items) => format!("[{}]", render_expressions(items)),
        ExprKind::Call(function, arguments) => {
            format!("{}({})", function.text, render_expressions(arguments))
        }
        ExprKind::Method(object, method, arguments) => {
            format!("{}.{}({})", render_expr(object), method.text, render_expressions(arguments))
        }
        ExprKind::Name(name) => name.replace('\u{1}', ""),
        ExprKind::Field(base, member) => format!("{}.{}", render_expr(base), member.text),
        ExprKind::Binary(op, a, b, _) => {
            let sign = match op {
                BinaryOp::Add => '+',
                BinaryOp::Sub => '-',
                BinaryOp::Mul => '*',
                BinaryOp::Div => '/',
            };
            format!("({} {sign} {})", render_expr(a), render_expr(b))
        }
        other => unreachable!("{other:?}"),
    }
}

/// Returns the URDF text of a link without mass properties.
fn massless_link(name: &str) -> String {
    format!("<link name=\"{name}\"/>")
}

/// Returns the URDF text of a joint with further elements inside.
fn joint_element(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\">\
         <parent link=\"{parent}\"/><child link=\"{child}\"/>{inside}</joint>"
    )
}

/// Returns a chain of links `l0`, `l1`, … with joints `j1`, … of these types and contents.
fn chain_of_links(joints: &[(&str, &str)]) -> String {
    let mut text = massless_link("l0");
    for (k, (kind, inside)) in joints.iter().enumerate() {
        let (parent, child) = (format!("l{k}"), format!("l{}", k + 1));
        text += &format!(
            "\n{}\n{}",
            massless_link(&child),
            joint_element(&format!("j{}", k + 1), kind, &parent, &child, inside)
        );
    }
    format!("<robot name=\"r\">{text}</robot>")
}

/// Returns the lines of the result of `chain` for the links and the root.
fn expected_chain_lines(joints: usize) -> String {
    let bodies: String = (0..=joints).map(|k| format!("body l{k}\n")).collect();
    bodies + "Weld root_joint: ground -> l0\n"
}
