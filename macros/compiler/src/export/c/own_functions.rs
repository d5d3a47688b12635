//! Reproducible arithmetic: code whose results have the same bits with every compiler and mathematical
//! library. Elementary functions are defined in the file itself.

use super::scalar::replaced;

/// C definitions of mathematical functions, each after those that it calls and preceded by a line
/// `//// name`.
const DEFINITIONS: [&str; 2] =
    [include_str!("templates/elementary_angles.c"), include_str!("templates/elementary_powers.c")];

/// Functions of the mathematical library that are replaced. Others are exact or correctly rounded.
const REPLACED: &[&str] = &[
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "pow",
    "fmin", "fmax",
];

/// Returns the headers that the code needs in addition to `math.h`.
pub const HEADERS: &[&str] = &["float.h", "stdint.h", "string.h"];

/// Replaces calls of the mathematical library by calls of included functions, and inserts their definitions.
pub fn with_own_functions(code: &str) -> String {
    let code = replaced(code, &|number| number.to_string(), &|word, after| {
        let is_call = after.starts_with('(') && REPLACED.contains(&word);
        if is_call { format!("lw_{word}") } else { word.to_string() }
    });
    let definitions: Vec<(&str, &str)> = DEFINITIONS
        .iter()
        .flat_map(|text| text.split("//// "))
        .filter_map(|section| section.split_once('\n'))
        .collect();
    let mut text = code;
    for (name, definition) in definitions.iter().rev().filter(|(name, _)| !name.is_empty()) {
        if text.contains(&format!("{name}(")) {
            text = format!("{definition}\n{text}");
        }
    }
    format!("{}\n{text}", include_str!("templates/reproducible.c").trim_end())
}
