//! SI units: names and notation of dimensions, and parsing of `#[unit(…)]`.

use crate::diag::{Diagnostics, nearest_candidate};
use crate::language::dimension::{
    ACCELERATION, Dimension, ENERGY, FORCE, INERTIA, LENGTH, MASS, PLAIN, POWER, RATE, RATE_OF_RATE, SPEED,
    STRENGTH, TIME,
};
use crate::language::ratio::Ratio;
use crate::syntax::{BinaryOp, Expr, ExprKind};
use std::fmt::Write;

/// Named dimensions, and units that are not written in m, kg and s.
static NAMES: [(Dimension, &str, &str); 17] = [
    (PLAIN, "a plain number", "1"),
    (LENGTH, "a length", "m"),
    (MASS, "a mass", "kg"),
    (TIME, "a time", "s"),
    (SPEED, "a speed", "m/s"),
    (ACCELERATION, "an acceleration", "m/s²"),
    (RATE, "an angular velocity", "1/s"),
    (RATE_OF_RATE, "an angular acceleration", "1/s²"),
    (INERTIA, "a moment of inertia", "kg·m²"),
    (FORCE, "a force", "N"),
    (ENERGY, "a torque or an energy", "N·m"),
    (POWER, "a power", "W"),
    (STRENGTH, "", "N·m²"),
    (Dimension::new(2, 0, 0), "an area", "m²"),
    (Dimension::new(3, 0, 0), "a volume", "m³"),
    (Dimension::new(0, 1, -2), "a stiffness", "N/m"),
    (Dimension::new(0, 1, -1), "a damping", "N·s/m"),
];

/// Units that `#[unit(…)]` accepts, also with powers such as `m2` and `s3`.
static UNITS: [(&str, Dimension); 9] = [
    ("m", LENGTH),
    ("kg", MASS),
    ("s", TIME),
    ("rad", PLAIN),
    ("N", FORCE),
    ("J", ENERGY),
    ("W", POWER),
    ("Hz", RATE),
    ("Pa", Dimension::new(-1, 1, -2)),
];

/// Units of other systems, with the SI unit to write instead.
static FOREIGN_UNITS: [(&str, &str); 32] = [
    ("mm", "m"),
    ("cm", "m"),
    ("km", "m"),
    ("inch", "m"),
    ("ft", "m"),
    ("g", "kg"),
    ("t", "kg"),
    ("lb", "kg"),
    ("ms", "s"),
    ("min", "s"),
    ("h", "s"),
    ("kN", "N"),
    ("lbf", "N"),
    ("deg", "rad"),
    ("rpm", "rad / s"),
    ("Nm", "N * m"),
    ("meter", "m"),
    ("meters", "m"),
    ("metre", "m"),
    ("metres", "m"),
    ("kilogram", "kg"),
    ("kilograms", "kg"),
    ("second", "s"),
    ("seconds", "s"),
    ("sec", "s"),
    ("newton", "N"),
    ("newtons", "N"),
    ("joule", "J"),
    ("watt", "W"),
    ("degrees", "rad"),
    ("radian", "rad"),
    ("radians", "rad"),
];

/// Returns the name of a dimension with its article and its unit: `a mass (kg)`.
pub fn describe_dimension(dimension: &Dimension) -> String {
    match NAMES.iter().find(|(known, ..)| known == dimension) {
        Some((_, name, _)) if dimension.is_plain() => (*name).to_string(),
        Some((_, name, unit)) if !name.is_empty() => format!("{name} ({unit})"),
        _ => format!("a quantity in {}", unit_of_dimension(dimension)),
    }
}

/// Returns the unit of a dimension; `any` if it is unknown.
pub fn unit_of_dimension(dimension: &Dimension) -> String {
    if !dimension.is_known() {
        return "any".to_string();
    }
    if let Some((_, _, unit)) = NAMES.iter().find(|(known, ..)| known == dimension) {
        return (*unit).to_string();
    }
    let [length, mass, time] = dimension.base;
    format_unit_powers(&[("kg", mass), ("m", length), ("s", time)])
}

/// Formats powers of units as a fraction: `kg·m²/s`, `m³/(kg·s²)`.
fn format_unit_powers(powers: &[(&str, Ratio)]) -> String {
    let (mut above, mut below) = (Vec::new(), Vec::new());
    for (name, e) in powers.iter().filter(|(_, e)| !e.is_zero()) {
        let side = if e.numerator_and_denominator().0 > 0 { &mut above } else { &mut below };
        side.push(format!("{name}{}", format_exponent(*e)));
    }
    let above = if above.is_empty() { "1".to_string() } else { above.join("·") };
    match below.as_slice() {
        [] => above,
        [one] => format!("{above}/{one}"),
        _ => format!("{above}/({})", below.join("·")),
    }
}

/// Formats the magnitude of an exponent as superscripts; fractions are in parentheses.
fn format_exponent(e: Ratio) -> String {
    let (n, d) = e.numerator_and_denominator();
    if d != 1 {
        return format!("^({}/{d})", n.abs());
    }
    let superscript_digit = |c: char| match c {
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4'..='9' => char::from_u32(c as u32 - '4' as u32 + '⁴' as u32).unwrap_or(c),
        _ => '⁰',
    };
    if n.abs() == 1 { String::new() } else { n.abs().to_string().chars().map(superscript_digit).collect() }
}

/// Parses the unit of `#[unit(…)]`: products and quotients of units and their powers. Returns the dimension
/// and the unit as shown to users.
pub fn parse_unit(e: &Expr, cx: &mut Diagnostics) -> Option<(Dimension, String)> {
    match &e.kind {
        ExprKind::Number(1.0) => Some((PLAIN, "1".to_string())),
        ExprKind::Name(name) => parse_unit_name(name, e, cx),
        ExprKind::Binary(op @ (BinaryOp::Mul | BinaryOp::Div), left, right, _) => {
            let ((a, mut text), (b, factor)) = (parse_unit(left, cx)?, parse_unit(right, cx)?);
            let divide = *op == BinaryOp::Div;
            let is_compound_unit = |t: &str| t.contains(['·', '/']);
            let _ = match (divide, is_compound_unit(&factor)) {
                (true, true) => write!(text, "/({factor})"),
                (true, false) => write!(text, "/{factor}"),
                (false, _) if text.contains('/') => write!(text, "·({factor})"),
                (false, _) => write!(text, "·{factor}"),
            };
            let dimension = if divide { a.dimension_of_quotient(&b)? } else { a.dimension_of_product(&b)? };
            Some((dimension, text))
        }
        _ => {
            cx.report_error(e.place.clone(), "expected a unit").add_help(
                "units are products and quotients: `#[unit(kg)]`, `#[unit(N * m / rad)]`, `#[unit(kg * m2)]`",
            );
            None
        }
    }
}

fn parse_unit_name(name: &str, e: &Expr, cx: &mut Diagnostics) -> Option<(Dimension, String)> {
    let letters = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let power = match name.get(letters.len()..) {
        None | Some("") => Some(1),
        Some(digits) => digits.parse::<i64>().ok().filter(|n| (2..=9).contains(n)),
    };
    let known = UNITS.iter().find(|(unit, _)| *unit == letters);
    if let (Some((unit, dimension)), Some(power)) = (known, power) {
        let power = Ratio::from_integer(power);
        return Some((dimension.dimension_of_power(power)?, format!("{unit}{}", format_exponent(power))));
    }
    let diagnostic = cx.report_error(e.place.clone(), format!("unknown unit `{name}`"));
    let units: Vec<&str> = UNITS.iter().map(|(unit, _)| *unit).collect();
    match FOREIGN_UNITS.iter().find(|(other, _)| *other == name) {
        Some((_, si)) => {
            diagnostic.add_help(format!("all quantities are in SI units, angles in radians: write `{si}`"))
        }
        None if nearest_candidate(name, &units).is_some() => diagnostic.suggest_name(name, units),
        None => diagnostic.add_help(
            "the units are `m`, `kg`, `s`, `rad`, `N`, `J`, `W`, `Hz` and `Pa`, and their powers such as \
             `m2`",
        ),
    };
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::dimension::GRAVITATION;

    #[test]
    fn dimensions_are_spelt_in_si() {
        let all = [
            (MASS, "kg"),
            (INERTIA, "kg·m²"),
            (GRAVITATION, "m³/(kg·s²)"),
            (Dimension::new(0, 1, -2), "N/m"),
            (Dimension::new(-3, 1, 0), "kg/m³"),
            (Dimension::new(-12, 0, 0), "1/m¹²"),
            (Dimension::new(5, 0, 0), "m⁵"),
            (Dimension::unknown_dimension(0), "any"),
        ];
        for (dimension, text) in all {
            assert_eq!(unit_of_dimension(&dimension), text);
        }
        let root = LENGTH.dimension_of_power(Ratio::new(1, 2).unwrap()).unwrap();
        assert_eq!(unit_of_dimension(&root), "m^(1/2)");
    }
}
