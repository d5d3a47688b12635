//! Functions that a mechanism does not have, declared with bounds that never hold. The error message of a
//! call then states the missing option or property.

use super::interface::{ALLOW, AbsentFunctions, ImplGenerics, Interface};
use super::signature::SignatureContext;
use crate::catalogue::{self, BY_PARAMETERS, DERIVATIVES, Facts, FunctionNeed, JACOBIAN, Row};
use crate::derive::Function;
use crate::syntax::RequestOption;
use std::fmt::Write;

/// Returns all functions, constants and traits that a mechanism with these functions and outputs lacks.
pub fn items_that_mechanism_lacks(
    facts: &Facts,
    functions: &[Function],
    outputs: &[String],
) -> Vec<AbsentFunctions> {
    let lane_variant_name = |name: &str| format!("{name}_lanes");
    let absent_for_need = |(need, rows): (FunctionNeed, Vec<&Row>)| {
        let mut names: Vec<String> = rows.iter().map(|row| row.name.to_string()).collect();
        if need == FunctionNeed::Asks(RequestOption::Derivatives) && !facts.requests.derivatives {
            names.extend(OF_TRAITS.map(ToString::to_string));
        }
        if facts.requests.batch {
            names.extend(rows.iter().filter(|row| row.batched).map(|row| lane_variant_name(row.name)));
        } else if need == FunctionNeed::Asks(RequestOption::Batch) {
            let of_state = functions.iter().filter(|f| !f.is_hidden() && !f.arguments.is_empty());
            names.extend(of_state.map(|f| lane_variant_name(&f.name)));
            names.extend(catalogue::handwritten_batched_functions(facts).map(lane_variant_name));
        }
        let constants = catalogue::absent_constants(need, facts);
        Some(AbsentFunctions { reason: need.trait_name_of_need()?, functions: names, constants })
    };
    let mut all: Vec<AbsentFunctions> =
        catalogue::absent_functions(facts).into_iter().filter_map(absent_for_need).collect();
    let of_outputs =
        |suffix: &str| -> Vec<String> { outputs.iter().map(|name| format!("{name}{suffix}")).collect() };
    for (suffix, reason, asked) in [
        (JACOBIAN, "", true),
        (DERIVATIVES, "AsksForDerivatives", facts.requests.derivatives),
        (BY_PARAMETERS, "AsksForSensitivities", facts.requests.sensitivities),
    ] {
        let reason = if asked { "HasJacobian" } else { reason };
        let mut functions = of_outputs(suffix);
        if facts.requests.batch {
            functions.extend(of_outputs(&format!("{suffix}_lanes")));
        }
        all.push(AbsentFunctions { reason, functions, constants: Vec::new() });
    }
    // An output may have the name of a missing function.
    for absent in &mut all {
        absent.functions.retain(|name| functions.iter().all(|f| f.name != *name));
    }
    all
}

/// Functions of the runtime's traits that are available with derivatives.
const OF_TRAITS: [&str; 2] = ["linear_motion", "output_derivatives"];

/// Functions of frames, which only the unprepared mechanism has.
const OF_FRAMES: [&str; 6] = [
    "frame_acceleration",
    "frame_index",
    "frame_jacobian",
    "frame_placement",
    "frame_placements",
    "frame_velocity",
];

/// Functions of parameters, which only the unprepared mechanism has.
const OF_FIGURES: [&str; 5] = ["from_file", "inertials", "set_base_parameters", "set_inertials", "validate"];

impl AbsentFunctions {
    /// Returns the functions and constants of frames, which a prepared mechanism lacks.
    fn frame_items_absent_after_prepare() -> AbsentFunctions {
        AbsentFunctions {
            reason: "HasFrames",
            functions: OF_FRAMES.map(ToString::to_string).to_vec(),
            constants: vec!["FRAMES"],
        }
    }

    /// Returns the functions and constants of parameters, which a prepared mechanism lacks.
    fn parameter_functions_absent_after_prepare(facts: &Facts) -> AbsentFunctions {
        let rows = catalogue::function_catalogue_rows().filter(|row| row.first_unmet_need(facts).is_none());
        let functions = rows.filter(|row| OF_FIGURES.contains(&row.name)).map(|row| row.name.to_string());
        let constants = [("FILE", FunctionNeed::FileParameters), ("LINKS", FunctionNeed::FileInertials)];
        let present = constants.into_iter().filter(|(_, need)| facts.meets_need(*need));
        AbsentFunctions {
            reason: "HoldsParameters",
            functions: functions.collect(),
            constants: present.map(|(name, _)| name).collect(),
        }
    }
}

/// Writes declarations of all functions and traits that the struct lacks, so that calls get an explanation.
pub fn write_missing_item_declarations(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    let name = i.shell.ident.to_string();
    for absent in &i.absent {
        write_absent_declarations(out, &name, absent, &ImplGenerics::new(i, s));
    }
}

/// Writes declarations of everything that the prepared struct `name` lacks.
pub fn write_items_absent_after_prepare(
    out: &mut String,
    name: &str,
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    for absent in i.absent.iter().chain([
        &AbsentFunctions::frame_items_absent_after_prepare(),
        &AbsentFunctions::parameter_functions_absent_after_prepare(&i.facts),
    ]) {
        write_absent_declarations(out, name, absent, &ImplGenerics::new(i, s));
    }
}

/// Writes declarations of missing functions and constants. Their unsatisfied trait bounds prevent conflicts
/// with other functions of the same names.
fn write_absent_declarations(out: &mut String, name: &str, absent: &AbsentFunctions, head: &ImplGenerics) {
    if absent.functions.is_empty() && absent.constants.is_empty() {
        return;
    }
    let ImplGenerics { generics, arguments, bounds } = head;
    let start = if bounds.is_empty() { "where" } else { bounds.trim_end_matches(',') };
    let comma = if bounds.is_empty() { "" } else { "," };
    let _ = writeln!(
        out,
        "{ALLOW}#[doc(hidden)]\nimpl{generics} {name}{arguments} {start}{comma} for<'a> Self: \
         ::linkwork::__private::absent::{}<'a> {{",
        absent.reason
    );
    for function in &absent.functions {
        let _ = writeln!(out, "#[inline]\npub fn {function}(&self) {{}}");
    }
    for constant in &absent.constants {
        let _ = writeln!(out, "pub const {constant}: () = ();");
    }
    out.push_str("}\n");
}
