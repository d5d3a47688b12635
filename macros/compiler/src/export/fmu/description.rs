//! Texts of `modelDescription.xml` and `buildDescription.xml` of an FMU.

use super::units::{BASES, exponents_of_unit};
use super::variables::{FmuVariables, ScalarVariable, VariableRole};
use crate::mechanism::Model;
use std::fmt::Write;

/// Returns a text that is valid in an attribute of XML.
fn escape_xml(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let plain = plain.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    plain.replace('"', "&quot;").replace('\'', "&apos;")
}

/// Returns the text of `modelDescription.xml`.
pub fn model_description_text(
    model: &Model<'_>,
    identifier: &str,
    token: &str,
    variables: &FmuVariables,
) -> String {
    let mut abilities = r#"canGetAndSetFMUState="true" canSerializeFMUState="true""#.to_string();
    if variables.is_differentiable {
        abilities.push_str(r#" providesDirectionalDerivatives="true" providesAdjointDerivatives="true""#);
    }
    let mut units = String::new();
    write_units(&mut units, variables);
    let mut list = String::new();
    for (reference, variable) in variables.all.iter().enumerate() {
        write_variable(&mut list, reference, variable, variables);
    }
    let mut structure = String::new();
    write_model_structure(&mut structure, variables);
    let exchange = match variables.has_model_exchange {
        true => include_str!("templates/model_exchange.xml"),
        false => "",
    };
    include_str!("templates/model_description.xml")
        .replace("@EXCHANGE@", exchange)
        .replace("@VERSION@", env!("CARGO_PKG_VERSION"))
        .replace("@TOKEN@", token)
        .replace("@IDENTIFIER@", identifier)
        .replace("@ABILITIES@", &abilities)
        .replace("@UNITS@", &units)
        .replace("@STRUCTURE@", &structure)
        .replace("@NAME@", &escape_xml(&model.name))
        .replace("@VARIABLES@", &list)
}

/// Writes the definition of every known unit to `modelDescription.xml`.
fn write_units(text: &mut String, variables: &FmuVariables) {
    let mut units: Vec<&str> =
        variables.all.iter().map(|v| v.unit.as_str()).filter(|u| is_known_unit(u)).collect();
    units.sort_unstable();
    units.dedup();
    for unit in units {
        let base = exponents_of_unit(unit).map_or(String::new(), |all| {
            let powers = BASES.iter().zip(all).filter(|(_, power)| *power != 0);
            let powers: Vec<String> = powers.map(|(name, power)| format!(r#" {name}="{power}""#)).collect();
            format!("<BaseUnit{}/>", powers.concat())
        });
        let _ = writeln!(text, r#"    <Unit name="{}">{base}</Unit>"#, escape_xml(unit));
    }
}

fn is_known_unit(unit: &str) -> bool {
    !matches!(unit, "any" | "")
}

fn write_variable(text: &mut String, reference: usize, variable: &ScalarVariable, variables: &FmuVariables) {
    let initial = if variables.is_constrained { "approx" } else { "exact" };
    let reinit = if variables.is_projected { r#" reinit="true""# } else { "" };
    let start = variable.start;
    let causality = match variable.role {
        VariableRole::Time => "independent",
        VariableRole::State | VariableRole::Output => "output",
        VariableRole::Rate(_) | VariableRole::Indicator => "local",
        VariableRole::Input => "input",
        VariableRole::Parameter => "parameter",
    };
    let further = match variable.role {
        VariableRole::Time => String::new(),
        VariableRole::State => format!(r#" initial="{initial}" start="{start:?}"{reinit}"#),
        VariableRole::Rate(state) => format!(r#" initial="calculated" derivative="{state}""#),
        VariableRole::Input => format!(r#" start="{start:?}""#),
        VariableRole::Parameter => format!(r#" initial="exact" start="{start:?}""#),
        VariableRole::Output | VariableRole::Indicator => r#" initial="calculated""#.to_string(),
    };
    let variability = if variable.role == VariableRole::Parameter { "tunable" } else { "continuous" };
    let attributes = format!(r#"causality="{causality}" variability="{variability}"{further}"#);
    let unit = match is_known_unit(&variable.unit) {
        true => format!(r#" unit="{}""#, escape_xml(&variable.unit)),
        false => String::new(),
    };
    let _ = writeln!(
        text,
        r#"    <Float64 name="{}" valueReference="{reference}" {attributes}{unit}/>"#,
        escape_xml(&variable.name)
    );
}

/// Writes the outputs, the rates of the states, the variables that initialization computes, and the event
/// indicators.
fn write_model_structure(text: &mut String, variables: &FmuVariables) {
    let mut write_listed_variables = |element: &str, is_listed: &dyn Fn(VariableRole) -> bool| {
        for (reference, _) in variables.all.iter().enumerate().filter(|(_, v)| is_listed(v.role)) {
            let _ = writeln!(text, r#"    <{element} valueReference="{reference}"/>"#);
        }
    };
    write_listed_variables("Output", &|role| matches!(role, VariableRole::State | VariableRole::Output));
    write_listed_variables("ContinuousStateDerivative", &|role| matches!(role, VariableRole::Rate(_)));
    write_listed_variables("InitialUnknown", &|role| match role {
        VariableRole::State => variables.is_constrained,
        role => matches!(role, VariableRole::Rate(_) | VariableRole::Output),
    });
    write_listed_variables("EventIndicator", &|role| role == VariableRole::Indicator);
}

/// Returns the text of `buildDescription.xml`.
pub fn build_description_xml(identifier: &str, main: &str) -> String {
    include_str!("templates/build_description.xml")
        .replace("@IDENTIFIER@", identifier)
        .replace("@MAIN@", main)
}
