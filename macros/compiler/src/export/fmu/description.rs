//! The file `modelDescription.xml`, and the description of the sources.

use super::units::{BASES, exponents};
use super::variables::{Role, Variable, Variables};
use crate::mechanism::Model;
use std::fmt::Write;

/// Returns a text that is valid in an attribute of XML.
fn escaped(text: &str) -> String {
    let plain: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let plain = plain.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    plain.replace('"', "&quot;").replace('\'', "&apos;")
}

/// Returns the text of `modelDescription.xml`.
pub fn text(model: &Model<'_>, identifier: &str, token: &str, variables: &Variables) -> String {
    let derivatives = match variables.is_differentiable {
        true => " providesDirectionalDerivatives=\"true\" providesAdjointDerivatives=\"true\"",
        false => "",
    };
    let states = "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"";
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{}\" generationTool=\"Linkwork {}\" instantiationToken=\"{token}\">\n  <ModelExchange modelIdentifier=\"{identifier}\" needsCompletedIntegratorStep=\"true\" {states}{derivatives}/>\n  <CoSimulation modelIdentifier=\"{identifier}\" canHandleVariableCommunicationStepSize=\"true\" {states}{derivatives}/>\n",
        escaped(&model.name),
        env!("CARGO_PKG_VERSION"),
    );
    write_units(&mut text, variables);
    text.push_str("  <LogCategories>\n    <Category name=\"logStatusError\" description=\"Errors\"/>\n  </LogCategories>\n  <DefaultExperiment startTime=\"0\" stopTime=\"10\" stepSize=\"0.01\"/>\n  <ModelVariables>\n");
    for (reference, variable) in variables.all.iter().enumerate() {
        write_variable(&mut text, reference, variable, variables);
    }
    text.push_str("  </ModelVariables>\n  <ModelStructure>\n");
    write_structure(&mut text, variables);
    text.push_str("  </ModelStructure>\n</fmiModelDescription>\n");
    text
}

/// Writes the definition of every known unit.
fn write_units(text: &mut String, variables: &Variables) {
    let mut units: Vec<&str> =
        variables.all.iter().map(|v| v.unit.as_str()).filter(|u| is_known(u)).collect();
    units.sort_unstable();
    units.dedup();
    text.push_str("  <UnitDefinitions>\n");
    for unit in units {
        let base = exponents(unit).map_or(String::new(), |all| {
            let powers = BASES.iter().zip(all).filter(|(_, power)| *power != 0);
            let powers: Vec<String> = powers.map(|(name, power)| format!(" {name}=\"{power}\"")).collect();
            format!("<BaseUnit{}/>", powers.concat())
        });
        let _ = writeln!(text, "    <Unit name=\"{}\">{base}</Unit>", escaped(unit));
    }
    text.push_str("  </UnitDefinitions>\n");
}

fn is_known(unit: &str) -> bool {
    !matches!(unit, "any" | "")
}

fn write_variable(text: &mut String, reference: usize, variable: &Variable, variables: &Variables) {
    let initial = if variables.is_constrained { "approx" } else { "exact" };
    let reinit = if variables.is_projected { " reinit=\"true\"" } else { "" };
    let start = variable.start;
    let attributes = match variable.role {
        Role::Time => "causality=\"independent\" variability=\"continuous\"".to_string(),
        Role::State => format!(
            "causality=\"output\" variability=\"continuous\" initial=\"{initial}\" start=\"{start:?}\"{reinit}"
        ),
        Role::Rate(state) => format!(
            "causality=\"local\" variability=\"continuous\" initial=\"calculated\" derivative=\"{state}\""
        ),
        Role::Input => format!("causality=\"input\" variability=\"continuous\" start=\"{start:?}\""),
        Role::Parameter => {
            format!("causality=\"parameter\" variability=\"tunable\" initial=\"exact\" start=\"{start:?}\"")
        }
        Role::Output => "causality=\"output\" variability=\"continuous\" initial=\"calculated\"".to_string(),
        Role::Indicator => {
            "causality=\"local\" variability=\"continuous\" initial=\"calculated\"".to_string()
        }
    };
    let unit = match is_known(&variable.unit) {
        true => format!(" unit=\"{}\"", escaped(&variable.unit)),
        false => String::new(),
    };
    let _ = writeln!(
        text,
        "    <Float64 name=\"{}\" valueReference=\"{reference}\" {attributes}{unit}/>",
        escaped(&variable.name)
    );
}

/// Writes the outputs, the rates of the states, the variables that initialization computes, and the event
/// indicators.
fn write_structure(text: &mut String, variables: &Variables) {
    let mut write = |element: &str, is_listed: &dyn Fn(Role) -> bool| {
        for (reference, _) in variables.all.iter().enumerate().filter(|(_, v)| is_listed(v.role)) {
            let _ = writeln!(text, "    <{element} valueReference=\"{reference}\"/>");
        }
    };
    write("Output", &|role| matches!(role, Role::State | Role::Output));
    write("ContinuousStateDerivative", &|role| matches!(role, Role::Rate(_)));
    write("InitialUnknown", &|role| match role {
        Role::State => variables.is_constrained,
        role => matches!(role, Role::Rate(_) | Role::Output),
    });
    write("EventIndicator", &|role| role == Role::Indicator);
}

/// Returns the text of `buildDescription.xml`.
pub fn build(identifier: &str, main: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n  <BuildConfiguration modelIdentifier=\"{identifier}\">\n    <SourceFileSet language=\"C99\">\n      <SourceFile name=\"{identifier}.c\"/>\n      <SourceFile name=\"{main}\"/>\n    </SourceFileSet>\n  </BuildConfiguration>\n</fmiBuildDescription>\n"
    )
}
