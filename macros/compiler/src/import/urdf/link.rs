//! Conversion of a URDF `<link>` element to a [`Body`].

use super::origin::read_origin;
use crate::diag::nearest_candidate;
use crate::import::context::Cx;
use crate::import::element::{
    Node, child_elements, child_for_each_name, element_source_position, quoted_tag, read_name_attribute,
    read_number_attribute, report_missing_or_misspelt_attributes, report_unexpected_contents, required_child,
};
use crate::import::misplaced;
use crate::import::robot::{FileOrigin, massless_link};
use crate::syntax::{Body, Expr, ExprKind, FileOptions, InertiaOption};

/// Attributes of the URDF element `<inertia>`: the entries of the inertia matrix.
const INERTIA: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

/// Redundant entries that some exporters write although the matrix is symmetric, each with its symmetric
/// counterpart.
const BELOW_DIAGONAL: [(&str, &str); 3] = [("iyx", "ixy"), ("izx", "ixz"), ("izy", "iyz")];

/// Maximum difference between an entry and its counterpart, relative to the largest entry. Exporters round
/// the two differently.
const ASYMMETRY: f64 = 0.01;

/// Child elements that the URDF element `<inertial>` may have.
const PARTS: [&str; 3] = ["origin", "mass", "inertia"];

/// Reads a URDF link; `None` if it has no name. Mass properties are skipped if the mechanism needs none, and
/// may be incomplete for a link fixed to the ground (`stands`).
pub(super) fn read_link(
    node: Node<'_>,
    stands: impl FnOnce(&str) -> bool,
    options: &FileOptions,
    cx: &mut Cx<'_>,
) -> Option<Body> {
    report_missing_or_misspelt_attributes(node, &["name"], &[], cx);
    misplaced::report_misplaced_contents(
        node,
        &["inertial"],
        "a link has mass properties by `<inertial>`, and its position by a joint",
        cx,
    );
    let name = read_name_attribute(node, "name", cx);
    let [inertial] = match options.inertias {
        InertiaOption::None => [None],
        _ => child_for_each_name(node, ["inertial"], cx),
    };
    let stands = name.as_ref().is_some_and(|name| stands(&name.text));
    let mut body = massless_link(name?);
    if let Some(inertial) = inertial {
        read_inertial(inertial, stands, &mut body, cx);
    }
    Some(body)
}

/// Reads mass, centre of mass and inertia. If all values are zero, the body has no mass properties.
fn read_inertial(node: Node<'_>, stands: bool, body: &mut Body, cx: &mut Cx<'_>) {
    let [origin, mass, inertia] = child_for_each_name(node, PARTS, cx);
    report_unknown_inertial_contents(node, cx);
    let origin = read_origin(origin, node, cx);
    let mut require_child_unless_grounded = |child, element, attributes: &[&str]| match stands {
        true => child,
        false => required_child(child, node, element, attributes, cx),
    };
    let (mass, inertia) = (
        require_child_unless_grounded(mass, "mass", &["value"]),
        require_child_unless_grounded(inertia, "inertia", &INERTIA),
    );
    if let Some(mass) = mass {
        report_unexpected_contents(mass, &["value"], &[], &[], cx);
        body.mass = read_number_attribute(mass, "value", cx).map(|m| Expr::number_at(m.value, &m.place));
    }
    if let Some(inertia) = inertia {
        body.inertia = read_inertia(inertia, &origin, cx);
    }
    body.com = origin.nonzero_position();
    if is_zero(body.mass.as_ref()) && body.inertia.is_none() {
        (body.mass, body.com) = (None, None);
    }
}

/// Reports contents of `<inertial>` other than its known child elements.
fn report_unknown_inertial_contents(node: Node<'_>, cx: &mut Cx<'_>) {
    let help = "expected `<origin>`, `<mass>` and `<inertia>`";
    for child in child_elements(node).filter(|child| !PARTS.contains(&child.tag_name().name())) {
        if nearest_candidate(child.tag_name().name(), &PARTS).is_none() {
            let message = format!("unexpected {} in `<inertial>`", quoted_tag(child));
            cx.report_error(&element_source_position(child, cx), message, |d| d.add_help(help));
        }
    }
    misplaced::report_misplaced_contents(node, &PARTS, help, cx);
}

fn is_zero(expr: Option<&Expr>) -> bool {
    matches!(expr, Some(Expr { kind: ExprKind::Number(value), .. }) if *value == 0.0)
}

/// Reads the inertia matrix, transformed from the axes of the inertial frame to those of the link. Returns
/// `None` if the matrix is zero.
fn read_inertia(node: Node<'_>, origin: &FileOrigin, cx: &mut Cx<'_>) -> Option<Expr> {
    report_unexpected_contents(node, &INERTIA, &[], &BELOW_DIAGONAL.map(|(entry, _)| entry), cx);
    let read = INERTIA.map(|entry| read_number_attribute(node, entry, cx));
    let largest = read.iter().flatten().fold(0.0, |largest: f64, entry| largest.max(entry.value.abs()));
    for (entry, other) in BELOW_DIAGONAL {
        let Some(found) = read_number_attribute(node, entry, cx) else { continue };
        let above = INERTIA.iter().position(|known| *known == other).and_then(|k| read[k].as_ref());
        if above.is_some_and(|above| (above.value - found.value).abs() > ASYMMETRY * largest) {
            let message = format!("`{entry}` differs from `{other}`: an inertia matrix is symmetric");
            cx.report_error(&found.place, message, |d| d.add_help(format!("remove `{entry}`")));
        }
    }
    if read.iter().flatten().all(|entry| entry.value == 0.0) {
        return None;
    }
    let whole = element_source_position(node, cx);
    let [xx, xy, xz, yy, yz, zz] = read.map(|entry| match entry {
        Some(entry) => Expr::number_at(entry.value, &entry.place),
        None => Expr::number_at(0.0, &whole),
    });
    let rows = [[xx, xy.clone(), xz.clone()], [xy, yy, yz.clone()], [xz, yz, zz]];
    let rows = rows.map(|row| Expr { kind: ExprKind::Array(row.into()), place: whole.clone() });
    let matrix = Expr { kind: ExprKind::Array(rows.into()), place: whole };
    let turns = origin.nonzero_rotations();
    if turns.is_empty() {
        return Some(matrix);
    }
    Some(Expr { place: origin.rpy.place.clone(), ..Expr::method_call(matrix, "rotated", turns) })
}
