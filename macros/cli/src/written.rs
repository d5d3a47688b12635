//! Expressions as they are written in attributes.

use linkwork_compiler::syntax::{BinaryOp, Expr, ExprKind};

/// A number with all its digits.
pub fn number(x: f64) -> String {
    // Of zero without its sign.
    let x = x + 0.0;
    if x == x.trunc() && x.abs() < 1e9 { format!("{x}") } else { format!("{x:?}") }
}

/// A number that may be an angle of more than a turn, which is written as one that is meant.
pub fn angle(text: &str) -> String {
    let turns = text.parse().is_ok_and(|x: f64| x.abs() > std::f64::consts::TAU);
    if turns { format!("1 * {text}") } else { text.to_string() }
}

/// Role of a name in an expression: a link and a joint of a file may share one name.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// A body: in arguments of functions, and where it has a point or an axis.
    Body,
    /// The coordinate of a joint.
    Coordinate,
}

/// Returns an expression of coordinates as text; `rename` gives the fields of names.
pub fn expression(e: &Expr, rename: &dyn Fn(&str, Role) -> Option<String>) -> String {
    spelled(e, Role::Coordinate, rename)
}

/// Returns a point of a body as text; `rename` gives the fields of bodies.
pub fn place(e: &Expr, rename: &dyn Fn(&str) -> Option<String>) -> String {
    spelled(e, Role::Body, &|name, _| rename(name))
}

fn spelled(e: &Expr, role: Role, rename: &dyn Fn(&str, Role) -> Option<String>) -> String {
    let inner = |e: &Expr| spelled(e, role, rename);
    let on_body = |e: &Expr| spelled(e, Role::Body, rename);
    let list = |all: &[Expr]| all.iter().map(on_body).collect::<Vec<_>>().join(", ");
    match &e.kind {
        ExprKind::Number(x) => number(*x),
        ExprKind::Name(name) => rename(name, role).unwrap_or_else(|| name.clone()),
        ExprKind::Field(of, name) => format!("{}.{}", on_body(of), name.text),
        ExprKind::Method(of, name, arguments) => {
            format!("{}.{}({})", on_body(of), name.text, list(arguments))
        }
        ExprKind::Call(name, arguments) => format!("{}({})", name.text, list(arguments)),
        ExprKind::Neg(of) => format!("-({})", inner(of)),
        ExprKind::Binary(op, a, b, _) => {
            let sign = match op {
                BinaryOp::Add => "+",
                BinaryOp::Sub => "-",
                BinaryOp::Mul => "*",
                BinaryOp::Div => "/",
            };
            let side = |e: &Expr| match e.kind {
                ExprKind::Binary(..) => format!("({})", inner(e)),
                _ => inner(e),
            };
            format!("{} {sign} {}", side(a), side(b))
        }
        ExprKind::Tuple(all) => format!("({})", list(all)),
        ExprKind::Array(all) => format!("[{}]", list(all)),
    }
}

/// The number that an expression is.
fn value(e: &Expr) -> Option<f64> {
    match &e.kind {
        ExprKind::Number(x) => Some(*x),
        ExprKind::Neg(of) => value(of).map(|x| -x),
        _ => None,
    }
}

/// The three numbers that an expression is.
fn values(e: &Expr) -> Option<[f64; 3]> {
    let ExprKind::Array(all) = &e.kind else { return None };
    all.iter().map(value).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// A vector as one writes it: a sum along the axes.
pub fn vector(e: &Expr) -> Option<String> {
    let numbers = values(e)?;
    let mut text = String::new();
    for (x, axis) in numbers.into_iter().zip(["x", "y", "z"]).filter(|(x, _)| *x != 0.0) {
        let sign = match (text.is_empty(), x < 0.0) {
            (true, true) => "-",
            (true, false) => "",
            (false, true) => " - ",
            (false, false) => " + ",
        };
        text.push_str(sign);
        match x.abs() {
            1.0 => text.push_str(axis),
            size => text.push_str(&format!("{} * {axis}", number(size))),
        }
    }
    Some(if text.is_empty() { "0 * x".to_string() } else { text })
}

/// Gravity as a vector.
pub fn gravity(e: &Expr) -> String {
    vector(e).unwrap_or_else(|| expression(e, &|_, _| None))
}

/// A direction of unit length.
pub fn axis(e: &Expr) -> String {
    let Some(numbers) = values(e) else { return expression(e, &|_, _| None) };
    let size = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Along a coordinate axis the length is that entry's.
    let unit = numbers.map(|x| if x.abs() == size { x.signum() } else { x / size });
    let number = |x: f64| Expr { kind: ExprKind::Number(x), place: e.place.clone() };
    let unit = Expr { kind: ExprKind::Array(unit.map(number).to_vec()), place: e.place.clone() };
    vector(&unit).unwrap_or_default()
}

/// Returns an inertia as text: by its moments, if it has no more and none is negative.
pub fn inertia(e: &Expr, written: &str) -> String {
    let ExprKind::Array(rows) = &e.kind else { return written.to_string() };
    let Some(rows) = rows.iter().map(values).collect::<Option<Vec<_>>>() else { return written.to_string() };
    match rows.as_slice() {
        [[xx, 0.0, 0.0], [0.0, yy, 0.0], [0.0, 0.0, zz]] if xx.min(yy.min(*zz)) >= 0.0 => {
            format!("diagonal({}, {}, {})", number(*xx), number(*yy), number(*zz))
        }
        _ => written.to_string(),
    }
}
