//! Conversion of SI units to exponents of base units for an FMU.

/// Exponents of kilogram, metre, second and radian in a unit.
pub type Exponents = [i32; 4];

/// Base units of FMU variables, in the order of their exponents.
pub const BASES: [&str; 4] = ["kg", "m", "s", "rad"];

/// Named units with their exponents of base units.
const NAMED: [(&str, Exponents); 11] = [
    ("1", [0, 0, 0, 0]),
    ("kg", [1, 0, 0, 0]),
    ("m", [0, 1, 0, 0]),
    ("s", [0, 0, 1, 0]),
    ("rad", [0, 0, 0, 1]),
    ("N", [1, 1, -2, 0]),
    ("J", [1, 2, -2, 0]),
    ("W", [1, 2, -3, 0]),
    ("Hz", [0, 0, -1, 0]),
    ("Pa", [1, -1, -2, 0]),
    ("V", [1, 2, -3, 0]),
];

/// Returns the exponents of a unit; `None` for text that is not a product of known units.
pub fn exponents_of_unit(unit: &str) -> Option<Exponents> {
    let (mut sum, mut sign, mut depth_sign) = ([0; 4], 1, 1);
    let mut rest = unit;
    while let Some(first) = rest.chars().next() {
        let length = rest.find(['·', '/', '(', ')']).unwrap_or(rest.len());
        match first {
            '·' => sign = depth_sign,
            '/' => sign = -depth_sign,
            '(' => depth_sign = sign,
            ')' => depth_sign = 1,
            _ => {
                let (word, after) = rest.split_at(length);
                let (name, power) = split_power(word)?;
                let (_, of_name) = NAMED.iter().find(|(known, _)| *known == name)?;
                sum.iter_mut().zip(of_name).for_each(|(sum, one)| *sum += sign * power * one);
                rest = after;
                continue;
            }
        }
        rest = &rest[first.len_utf8()..];
    }
    (!unit.is_empty()).then_some(sum)
}

/// Splits a unit symbol from its exponent in superscripts.
fn split_power(word: &str) -> Option<(&str, i32)> {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let Some(at) = word.find(|c: char| DIGITS.contains(&c)) else { return Some((word, 1)) };
    let (name, power) = word.split_at(at);
    let value_of_superscript =
        |c: char| DIGITS.iter().position(|d| *d == c).and_then(|d| i32::try_from(d).ok());
    power.chars().try_fold(0, |sum, c| Some(sum * 10 + value_of_superscript(c)?)).map(|power| (name, power))
}

/// Returns the unit of the time derivative of a quantity.
pub fn unit_of_rate(unit: &str) -> String {
    match unit {
        "any" | "" => "any".to_string(),
        "1" => "1/s".to_string(),
        simple if simple.ends_with("/s") => format!("{simple}²"),
        simple if !simple.contains('/') => format!("{simple}/s"),
        other => format!("({other})/s"),
    }
}

#[cfg(test)]
mod tests {
    use super::{exponents_of_unit, unit_of_rate};

    #[test]
    fn unit_products_and_quotients_become_base_unit_exponents() {
        for (unit, expected) in [
            ("1", [0, 0, 0, 0]),
            ("kg·m²/s", [1, 2, -1, 0]),
            ("m³/(kg·s²)", [-1, 3, -2, 0]),
            ("N·s/m", [1, 0, -1, 0]),
            ("rad/s", [0, 0, -1, 1]),
            ("(m/s)/s", [0, 1, -2, 0]),
        ] {
            assert_eq!(exponents_of_unit(unit), Some(expected), "{unit}");
        }
        assert_eq!(
            [exponents_of_unit("any"), exponents_of_unit(""), exponents_of_unit("m^(1/2)")],
            [None; 3]
        );
        assert_eq!(["m", "rad/s", "1", "m²/s²"].map(unit_of_rate), ["m/s", "rad/s²", "1/s", "(m²/s²)/s"]);
    }
}
