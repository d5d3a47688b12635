//! Corrections for common errors in expressions: angles in degrees, members and methods of other languages,
//! arrays that are not matrices.

use super::scope::Scope;
use crate::diag::Diagnostics;
use crate::expr::Expr;
use crate::language::{Callable, Rotation};
use crate::syntax::{self, Callee, ExprKind, Member, Name, words};

impl Scope<'_, '_> {
    /// Reports a method, which expressions do not have, with the correct syntax.
    pub fn report_unknown_method(&self, e: &syntax::Expr, method: &Member, cx: &mut Diagnostics) {
        let text = method.text.as_str();
        let base = match &e.kind {
            ExprKind::Method(base, ..) => base.short_source_text(),
            _ => String::new(),
        };
        let error = cx.report_error(method.place.clone(), format!("`.{text}(…)` has no value here"));
        let is_coordinate = self.kinematics.coordinates.iter().any(|(name, ..)| *name == base);
        if is_coordinate && let Some(meant) = words::meaning_of_word(words::RATES, text, &[]) {
            error.add_help(meant.replace("NAME", &base));
        } else if Callable::is_function_name(text) {
            error.add_help(format!("write `{text}(…)`"));
        } else if !words::add_word_meaning_as_help(error, words::NUMBER_METHODS, text, &[])
            && !words::add_word_meaning_as_help(error, &words::function_synonyms(), text, &[])
        {
            error.add_help(
                "functions precede their arguments, as in `sin(angle)`; `body.at(vector)` is a point",
            );
        }
    }

    /// Reports a member that a joint does not have, with the correct syntax. Returns false if the name is not
    /// a joint.
    pub fn report_unknown_joint_member(
        &self,
        joint: &str,
        inner: &syntax::Expr,
        member: &Name,
        cx: &mut Diagnostics,
    ) -> bool {
        let own =
            |name: &str| name == joint || name.strip_prefix(joint).is_some_and(|end| end.starts_with('.'));
        let kinematics = &self.kinematics;
        let coordinates: Vec<&str> =
            kinematics.coordinates.iter().map(|(name, ..)| name.as_str()).filter(|name| own(name)).collect();
        match coordinates.as_slice() {
            [] => return false,
            [one] => {
                let value = ["angle", "position", "q", "value", "displacement", "x", "pos", "coordinate"];
                let help = match value.contains(&member.text.as_str()) {
                    true => format!("write `{one}` for its coordinate"),
                    false => format!("write `rate({one})` for its rate, `{one}` for its coordinate"),
                };
                cx.report_error(inner.place.clone(), format!("`{joint}` is a joint and has no axes"))
                    .add_help(help);
            }
            several => {
                let message = format!("`{joint}` has no coordinate `{}`", member.text);
                let full = format!("{joint}.{}", member.text);
                cx.report_error(member.place.clone(), message).suggest_name(&full, several.iter().copied());
            }
        }
        true
    }
}

/// Help text on how to write a vector.
pub const VECTOR_SYNTAX: &str = "a vector is written `[a, b, c]` or `a * x + b * y + c * z`";

/// Help text on how to write a matrix.
pub const MATRIX_SYNTAX: &str =
    "a matrix is written by its rows: `[[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]`";

/// Help for a function that is undefined at a number.
pub const DOMAIN_HELP: &str = "its argument is a number here: correct that";

/// Maximum plain number that is accepted as an angle, rad: a full revolution with room for the digits of 2 π.
const FULL_TURN: f64 = 6.3;

/// Converts an angle from degrees to radians. Right angles are exact: 90/180 is exact, and so is its product
/// with π.
pub fn degrees_to_radians(angle: Expr<'_>) -> Expr<'_> {
    match angle.constant_value() {
        Some(n) => angle.num(n / 180.0 * std::f64::consts::PI),
        None => angle * (std::f64::consts::PI / 180.0),
    }
}

/// Checks an angle, and returns false after it has reported a plain number beyond a full revolution. Numbers
/// of files are exempt, because they are not written by hand.
pub fn check_angle(e: &syntax::Expr, cx: &mut Diagnostics) -> bool {
    let Some(n) = e.literal_number().filter(|n| n.abs() > FULL_TURN && e.place.file.is_none()) else {
        return true;
    };
    cx.report_error(e.place.clone(), format!("an angle of {n} rad is more than a full turn")).add_help(
        format!("angles are in radians: write `degrees({n})`, or `1 * {n}` if that many radians are meant"),
    );
    false
}

/// Whether an expression may be a rotation: a call or a matrix.
pub fn may_be_rotation(step: &syntax::Expr) -> bool {
    match &step.kind {
        ExprKind::Call(Callee { id: Some(Callable::Rotation(rotation)), .. }, arguments) => {
            let row = rotation.row();
            row.natural || row.arguments.len() == arguments.len()
        }
        ExprKind::Array(_) => true,
        _ => false,
    }
}

/// Reports that an expression is not a rotation.
pub fn report_expected_rotation(step: &syntax::Expr, cx: &mut Diagnostics) {
    let error = cx.report_error(step.place.clone(), "expected a rotation");
    if let ExprKind::Call(word, _) = &step.kind {
        let known: Vec<&str> = Rotation::names().collect();
        words::add_word_meaning_as_help(error, &words::rotation_synonyms(), &word.text, &known);
    }
    error.add_help(
        "write `x(angle)`, `y(angle)`, `z(angle)`, `eigenaxis(direction, angle)` or `quaternion(x, y, z, w)`",
    );
}

/// Reports that an array of expressions is not a matrix.
pub fn report_invalid_matrix(e: &syntax::Expr, cx: &mut Diagnostics) {
    let ExprKind::Array(items) = &e.kind else {
        cx.report_error(e.place.clone(), "expected a 3×3 matrix").add_help(MATRIX_SYNTAX);
        return;
    };
    let is_matrix_row = |item: &syntax::Expr| matches!(item.kind, ExprKind::Array(_) | ExprKind::Tuple(_));
    let what = if items.iter().any(is_matrix_row) { "rows" } else { "numbers" };
    let count = if items.len() == 3 { "three".to_string() } else { items.len().to_string() };
    let error = cx.report_error(e.place.clone(), format!("expected a 3×3 matrix, found {count} {what}"));
    match (what, items.as_slice()) {
        ("numbers", [a, b, c]) => error.add_help(format!(
            "write `diagonal({}, {}, {})`",
            a.short_source_text(),
            b.short_source_text(),
            c.short_source_text()
        )),
        _ => error.add_help(MATRIX_SYNTAX),
    };
}
