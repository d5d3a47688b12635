//! Helper functions that the mathematical library does not have. Each is defined only if it is called. Their
//! names begin with `lw_`, which no name of a mechanism does (`names::c_name_prefix`).

use super::super::mechanism::ExportedMechanism;
use super::super::template::TemplateValues;
use super::super::tokens::replace_numbers_and_words;

/// Arithmetic of the code.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Arithmetic {
    /// Double precision, with fused products where the processor has them.
    Double,
    /// Single precision.
    Single,
    /// Every operation is rounded by itself, and elementary functions are defined in the file.
    Reproducible,
    /// The target defines fused products, sines and cosines.
    Kernel,
}

/// Helper functions with double precision and their arguments, in sections that begin with `//// name`. Each
/// comes after those that it calls.
const LIBRARY: [&str; 3] = [
    include_str!("templates/functions.c"),
    include_str!("templates/matrices.c"),
    include_str!("templates/rotations.c"),
];

/// Elementary functions for reproducible results, in sections.
const ELEMENTARY: [&str; 2] =
    [include_str!("templates/elementary_angles.c"), include_str!("templates/elementary_powers.c")];

/// Functions of the mathematical library that are replaced. Others are exact or correctly rounded.
const REPLACED: &[&str] = &[
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "pow",
    "fmin", "fmax",
];

/// Inserts the definitions of all helper functions that the code calls.
pub fn with_helpers(code: &str, i: &ExportedMechanism<'_>, arithmetic: Arithmetic) -> String {
    let angles = match arithmetic {
        Arithmetic::Double | Arithmetic::Reproducible => include_str!("templates/angles.c"),
        Arithmetic::Single => include_str!("templates/single_angles.c"),
        Arithmetic::Kernel => "",
    };
    let mut template = TemplateValues::default();
    template.add_condition("OWN_SINES", arithmetic == Arithmetic::Reproducible);
    let columns = 2 * i.nv() + i.nu() + usize::from(!i.model.time);
    template.add_value("PREFIX", &i.prefix);
    template.add_value("NV", &i.nv().max(1));
    template.add_value("NU", &i.nu().max(1));
    template.add_value("COLUMNS", &columns);
    let helpers = template.fill(&called_sections(code, &[&[angles], &LIBRARY[..]].concat()));
    match arithmetic {
        Arithmetic::Double | Arithmetic::Single => {
            format!("{}\n{helpers}{code}", include_str!("templates/fused.c"))
        }
        Arithmetic::Kernel => format!("{helpers}{code}"),
        Arithmetic::Reproducible => {
            let code = replace_math_library_calls(&format!("{helpers}{code}"));
            format!("{}\n{code}", include_str!("templates/reproducible.c").trim_end())
        }
    }
}

/// Returns the sections whose functions the code calls, directly or through others.
fn called_sections(code: &str, library: &[&str]) -> String {
    let sections = library.iter().flat_map(|text| text.split("//// "));
    let sections: Vec<(&str, &str)> = sections.filter_map(|section| section.split_once('\n')).collect();
    let mut text = String::new();
    for (name, definition) in sections.iter().rev().filter(|(name, _)| !name.is_empty()) {
        let call = format!("{name}(");
        if code.contains(&call) || text.contains(&call) {
            text = format!("{definition}\n{text}");
        }
    }
    text
}

/// Replaces calls of the mathematical library by calls of included functions, and inserts their definitions.
fn replace_math_library_calls(code: &str) -> String {
    let code = replace_numbers_and_words(code, &|number| number.to_string(), &|word, after| {
        let is_call = after.starts_with('(') && REPLACED.contains(&word);
        if is_call { format!("lw_{word}") } else { word.to_string() }
    });
    format!("{}{code}", called_sections(&code, &ELEMENTARY))
}
