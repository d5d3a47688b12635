//! Conversion of expressions of robot files to the text of attributes.

use linkwork_compiler::syntax::{BinaryOp, Expr, ExprKind};

/// Formats a number so that parsing the text restores it exactly.
pub fn format_number(x: f64) -> String {
    // Removes the sign of zero.
    let x = x + 0.0;
    if x == x.trunc() && x.abs() < 1e9 { format!("{x}") } else { format!("{x:?}") }
}

/// Formats a number that may be an angle. A literal of more than one revolution is written as a product,
/// which the compiler accepts as intended.
pub fn format_angle(text: &str) -> String {
    let turns = text.parse().is_ok_and(|x: f64| x.abs() > std::f64::consts::TAU);
    if turns { format!("1 * {text}") } else { text.to_string() }
}

/// Role of a name in an expression, since a link and a joint of a file may share one name.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum NameRole {
    /// Body: in arguments of functions, and before a point or an axis.
    Body,
    /// Name of the coordinate of a joint.
    Coordinate,
}

/// Returns an expression of coordinates as text; `rename` returns the field names.
pub fn format_expression(e: &Expr, rename: &dyn Fn(&str, NameRole) -> Option<String>) -> String {
    renamed_expression_text(e, NameRole::Coordinate, rename)
}

/// Returns a point of a body as text; `rename` returns the field names of bodies.
pub fn format_point(e: &Expr, rename: &dyn Fn(&str) -> Option<String>) -> String {
    renamed_expression_text(e, NameRole::Body, &|name, _| rename(name))
}

fn renamed_expression_text(
    e: &Expr,
    role: NameRole,
    rename: &dyn Fn(&str, NameRole) -> Option<String>,
) -> String {
    let renamed_subexpression_text = |e: &Expr| renamed_expression_text(e, role, rename);
    let renamed_text_in_body_role = |e: &Expr| renamed_expression_text(e, NameRole::Body, rename);
    let spell_comma_separated =
        |all: &[Expr]| all.iter().map(renamed_text_in_body_role).collect::<Vec<_>>().join(", ");
    match &e.kind {
        ExprKind::Number(x) => format_number(*x),
        ExprKind::Text(text) => format!("{text:?}"),
        ExprKind::Name(name) => rename(name, role).unwrap_or_else(|| name.clone()),
        ExprKind::Field(of, name) => format!("{}.{}", renamed_text_in_body_role(of), name.text),
        ExprKind::Method(of, name, arguments) => {
            format!("{}.{}({})", renamed_text_in_body_role(of), name.text, spell_comma_separated(arguments))
        }
        ExprKind::Call(name, arguments) => format!("{}({})", name.text, spell_comma_separated(arguments)),
        ExprKind::Neg(of) => format!("-({})", renamed_subexpression_text(of)),
        ExprKind::Binary(op, a, b, _) => {
            let sign = match op {
                BinaryOp::Add => "+",
                BinaryOp::Sub => "-",
                BinaryOp::Mul => "*",
                BinaryOp::Div => "/",
            };
            let parenthesised_if_binary = |e: &Expr| match e.kind {
                ExprKind::Binary(..) => format!("({})", renamed_subexpression_text(e)),
                _ => renamed_subexpression_text(e),
            };
            format!("{} {sign} {}", parenthesised_if_binary(a), parenthesised_if_binary(b))
        }
        ExprKind::Tuple(all) => format!("({})", spell_comma_separated(all)),
        ExprKind::Array(all) => format!("[{}]", spell_comma_separated(all)),
    }
}

/// Returns the value of a literal expression, with its sign.
fn literal_value(e: &Expr) -> Option<f64> {
    match &e.kind {
        ExprKind::Number(x) => Some(*x),
        ExprKind::Neg(of) => literal_value(of).map(|x| -x),
        _ => None,
    }
}

/// Returns the three values of a literal array.
fn literal_vector(e: &Expr) -> Option<[f64; 3]> {
    let ExprKind::Array(all) = &e.kind else { return None };
    all.iter().map(literal_value).collect::<Option<Vec<f64>>>()?.try_into().ok()
}

/// Formats a vector as a sum along the axes.
pub fn format_vector(e: &Expr) -> Option<String> {
    let numbers = literal_vector(e)?;
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
            size => text.push_str(&format!("{} * {axis}", format_number(size))),
        }
    }
    Some(if text.is_empty() { "0 * x".to_string() } else { text })
}

/// Formats the gravity of a robot file as a vector expression.
pub fn format_gravity(e: &Expr) -> String {
    format_vector(e).unwrap_or_else(|| format_expression(e, &|_, _| None))
}

/// Formats a direction as a vector expression of unit length.
pub fn format_axis(e: &Expr) -> String {
    let Some(numbers) = literal_vector(e) else { return format_expression(e, &|_, _| None) };
    let size = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Along a coordinate axis, the length is the magnitude of the single nonzero entry.
    let unit = numbers.map(|x| if x.abs() == size { x.signum() } else { x / size });
    let number_expression = |x: f64| Expr { kind: ExprKind::Number(x), place: e.place.clone() };
    let unit = Expr { kind: ExprKind::Array(unit.map(number_expression).to_vec()), place: e.place.clone() };
    format_vector(&unit).unwrap_or_default()
}

/// Returns an inertia as text: as `diagonal(…)` if it is diagonal without negative moments.
pub fn format_inertia(e: &Expr, written: &str) -> String {
    let ExprKind::Array(rows) = &e.kind else { return written.to_string() };
    let Some(rows) = rows.iter().map(literal_vector).collect::<Option<Vec<_>>>() else {
        return written.to_string();
    };
    match rows.as_slice() {
        [[xx, 0.0, 0.0], [0.0, yy, 0.0], [0.0, 0.0, zz]] if xx.min(yy.min(*zz)) >= 0.0 => {
            format!("diagonal({}, {}, {})", format_number(*xx), format_number(*yy), format_number(*zz))
        }
        _ => written.to_string(),
    }
}

/// Returns the law of a damper whose force is a polynomial of the magnitude of the speed.
pub fn polynomial_damper_law(damping: [f64; 3]) -> String {
    let [first, second, third] = damping.map(format_number);
    format!("force = ({first} + ({second} + {third} * abs(speed)) * abs(speed)) * speed")
}

/// Returns the energy of a spring that is slack within a range, and whose force is a polynomial of the excess
/// beyond it, with these coefficients of its first three powers.
pub fn slack_spring_energy_source(stiffness: [f64; 3], [low, high]: [f64; 2]) -> String {
    let (from, to) = (format_number(low), format_number(high));
    let power_of_excess_text = |n: u8| match low == high {
        true => format!("pow(stretch - {from}, {n})"),
        false => format!("(pow(min(stretch - {from}, 0), {n}) + pow(max(stretch - {to}, 0), {n}))"),
    };
    let terms = [(stiffness[0] / 2.0, 2), (stiffness[1] / 3.0, 3), (stiffness[2] / 4.0, 4)];
    let terms = terms.into_iter().filter(|(k, _)| *k != 0.0);
    let terms: Vec<String> =
        terms.map(|(k, n)| format!("{} * {}", format_number(k), power_of_excess_text(n))).collect();
    format!("energy = {}", terms.join(" + "))
}

/// Returns the law of a damper; one with a negative coefficient, which adds energy, is written as a force.
pub fn damper_law_text(damping: f64) -> String {
    match damping < 0.0 {
        true => format!("force = {} * speed", format_number(damping)),
        false => format!("damping = {}", format_number(damping)),
    }
}
