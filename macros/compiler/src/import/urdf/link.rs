//! `<link>` → [`Body`].

use super::origin::read_origin;
use crate::import::context::Cx;
use crate::import::element::{Node, check_attributes, children, name, number, place, required};
use crate::import::robot::{Origin, bare_link};
use crate::syntax::{Body, Expr, ExprKind, FileOptions, Inertias, Name};

/// The entries of the inertia matrix, as URDF names them.
const INERTIA: [&str; 6] = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];

/// Reads a link; `None` if it has no name. Where nothing needs inertia, it is not read; what `stands` on the ground may lack
/// some.
pub(super) fn read_link(
    node: Node<'_>,
    stands: impl FnOnce(&str) -> bool,
    options: &FileOptions,
    cx: &mut Cx<'_>,
) -> Option<Body> {
    check_attributes(node, &["name"], &[], cx);
    let name = name(node, "name", cx);
    let [inertial] = match options.inertias {
        Inertias::None => [None],
        _ => children(node, ["inertial"], cx),
    };
    let stands = name.as_ref().is_some_and(|name| stands(&name.text));
    let mut body = bare_link(name?);
    if let Some(inertial) = inertial {
        read_inertial(inertial, stands, &mut body, cx);
    }
    Some(body)
}

/// Reads mass, centre of mass and inertia. A link that says that all are zero is one that says nothing.
fn read_inertial(node: Node<'_>, stands: bool, body: &mut Body, cx: &mut Cx<'_>) {
    let [origin, mass, inertia] = children(node, ["origin", "mass", "inertia"], cx);
    let origin = read_origin(origin, node, cx);
    let mut found = |child, element, attributes: &[&str]| match stands {
        true => child,
        false => required(child, node, element, attributes, cx),
    };
    let (mass, inertia) = (found(mass, "mass", &["value"]), found(inertia, "inertia", &INERTIA));
    if let Some(mass) = mass {
        check_attributes(mass, &["value"], &[], cx);
        body.mass = number(mass, "value", cx).map(|m| Expr::number(m.value, &m.place));
    }
    if let Some(inertia) = inertia {
        body.inertia = read_inertia(inertia, &origin, cx);
    }
    body.com = origin.at();
    if is_zero(body.mass.as_ref()) && body.inertia.is_none() {
        (body.mass, body.com) = (None, None);
    }
}

fn is_zero(expr: Option<&Expr>) -> bool {
    matches!(expr, Some(Expr { kind: ExprKind::Number(value), .. }) if *value == 0.0)
}

/// The inertia matrix, turned from the axes of the inertial frame into the link's; `None` if it is zero.
fn read_inertia(node: Node<'_>, origin: &Origin, cx: &mut Cx<'_>) -> Option<Expr> {
    check_attributes(node, &INERTIA, &[], cx);
    let read = INERTIA.map(|entry| number(node, entry, cx));
    if read.iter().flatten().all(|entry| entry.value == 0.0) {
        return None;
    }
    let whole = place(node, cx);
    let [xx, xy, xz, yy, yz, zz] = read.map(|entry| match entry {
        Some(entry) => Expr::number(entry.value, &entry.place),
        None => Expr::number(0.0, &whole),
    });
    let rows = [[xx, xy.clone(), xz.clone()], [xy, yy, yz.clone()], [xz, yz, zz]];
    let rows = rows.map(|row| Expr { kind: ExprKind::Array(row.into()), place: whole.clone() });
    let matrix = Expr { kind: ExprKind::Array(rows.into()), place: whole };
    let turns = origin.rotated();
    if turns.is_empty() {
        return Some(matrix);
    }
    let place = origin.rpy.place.clone();
    let method = Name { text: "rotated".to_string(), place: place.clone() };
    Some(Expr { kind: ExprKind::Method(Box::new(matrix), method, turns), place })
}
