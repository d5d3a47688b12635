//! FMUs for co-simulation whose binary contains the run-time library.

use super::super::names::{c_name_prefix, to_snake_case};
use super::description;
use super::model::{array_definition, chart_index_definitions, escape_character, variable_names_definition};
use super::values::StartValues;
use super::variables::{ENERGIES, FmuVariables, OutputFunction, VariableRole};
use super::{FmuFiles, MAIN, SOURCES, instantiation_token};
use crate::catalogue::{Argument, GeneratedId, REACTION, TOUCHED};
use crate::derive::DerivationOutput;
use crate::mechanism::Model;
use std::fmt::Write;

/// Exports a mechanism whose declaration the run-time library reads. Outputs that need accelerations or
/// forces are left out; their names are returned.
pub fn export_fmu_for_runtime_library(
    model: &Model<'_>,
    output: &DerivationOutput,
    declaration: &str,
    prefix: &str,
    start: &StartValues,
) -> (FmuFiles, Vec<String>) {
    let identifier = match prefix {
        "" => c_name_prefix(&to_snake_case(&model.name)),
        given => c_name_prefix(given),
    };
    let (mut outputs, mut left_out) = (Vec::new(), Vec::new());
    for f in output
        .functions
        .iter()
        .filter(|f| matches!(f.id, GeneratedId::Output | GeneratedId::Reaction | GeneratedId::Touched))
    {
        let is_time_state_or_input =
            |a: &Argument| matches!(a, Argument::T | Argument::Q | Argument::V | Argument::U);
        let size = f.program.outputs.len();
        match f.id == GeneratedId::Output && f.arguments.iter().all(is_time_state_or_input) {
            true => outputs.push(OutputFunction { name: f.name.clone(), size, is_differentiable: false }),
            false => {
                let name = f.name.strip_prefix(REACTION).or(f.name.strip_prefix(TOUCHED));
                left_out.push(name.unwrap_or(&f.name).to_string());
            }
        }
    }
    let variables = FmuVariables::library_variables(model, outputs, start);
    let text = library_header(model, output, declaration, &variables, start);
    let token = instantiation_token(&[declaration, &text]);
    let text_of_description = description::model_description_text(model, &identifier, &token, &variables);
    let mut files = vec![
        ("modelDescription.xml".to_string(), text_of_description),
        ("sources/lw_model.h".to_string(), text.replace("@TOKEN@", &token)),
    ];
    files.extend(SOURCES.map(|(name, text)| (format!("sources/{name}"), text.to_string())));
    (FmuFiles { identifier, files, sources: vec![format!("sources/{MAIN}")], has_sources: false }, left_out)
}

/// Returns the header `lw_model.h`, with the placeholder `@TOKEN@` for the instantiation token.
fn library_header(
    model: &Model<'_>,
    output: &DerivationOutput,
    declaration: &str,
    variables: &FmuVariables,
    start: &StartValues,
) -> String {
    let mut text = String::from("#define LW_TOKEN \"@TOKEN@\"\n#define LW_LIBRARY 1\n");
    let variable_count_with_role =
        |role: VariableRole| variables.all.iter().filter(|v| v.role == role).count();
    let balls = model.charts.iter().filter(|chart| chart.first_quaternion_index().is_some()).count();
    let has_contacts = !model.contacts.is_empty();
    let sizes = [
        ("NQ", model.nq()),
        ("NV", model.nv()),
        ("NX", start.states.len()),
        ("NU", model.nu()),
        ("NP", variables.parameters.len()),
        ("NY", variable_count_with_role(VariableRole::Output)),
        ("OUTPUTS", variables.outputs.len() + ENERGIES.len()),
        ("CONTACTS", 0),
        ("CONSTRAINTS", model.constraints.len()),
        ("BALLS", balls),
        ("DIFFERENTIABLE", 0),
        ("HAS_STEPS", usize::from(has_contacts)),
    ];
    for (name, size) in sizes {
        let _ = writeln!(text, "#define LW_{name} {size}");
    }
    let method = if has_contacts { "time_stepping" } else { "automatic" };
    let _ = writeln!(text, "#define LW_METHOD \"{method}\"\n");
    text.push_str(&chart_index_definitions(&output.charts));
    text.push_str(&variable_names_definition(variables));
    let roles = [VariableRole::State, VariableRole::Input, VariableRole::Parameter];
    let values = roles.iter().flat_map(|role| variables.all.iter().filter(move |v| v.role == *role));
    text.push_str(&array_definition("lw_start", &values.map(|v| v.start).collect::<Vec<_>>()));
    let indices: Vec<String> =
        start.states.iter().chain(&variables.parameters).chain(&[0]).map(ToString::to_string).collect();
    let _ = writeln!(text, "static const size_t lw_indices[] = {{{}}};", indices.join(", "));
    text.push_str("static const struct {\n    const char *name;\n    int size;\n} lw_outputs[] = {\n");
    let energies = ENERGIES.iter().map(|name| (*name, 1));
    for (name, size) in variables.outputs.iter().map(|one| (one.name.as_str(), one.size)).chain(energies) {
        let _ = writeln!(text, "    {{\"{name}\", {size}}},");
    }
    text.push_str("};\n\nstatic const char lw_declaration[] =\n");
    for line in declaration.lines() {
        let line: String = line.chars().flat_map(escape_character).collect();
        let _ = writeln!(text, "    \"{line}\\n\"");
    }
    text + "    ;\n"
}
