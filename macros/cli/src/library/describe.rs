//! Self-description of the library: names, shapes, units and documentation as JSON.

use super::{Function, FunctionArgumentKind, LibraryData};
use linkwork_compiler::export::without_doc_links;
use linkwork_compiler::mechanism::CoordinateLimits;
use serde_json::{Value, json};

/// Returns the description of an exported library as JSON.
pub fn description_as_json(known: &LibraryData<'_, '_>) -> String {
    let m = known.model;
    let json_names_with_units = |names: Vec<&str>, units: &[String]| -> Vec<Value> {
        let units = units.iter().map(String::as_str).chain(std::iter::repeat(""));
        names.into_iter().zip(units).map(|(name, unit)| json!({ "name": name, "unit": unit })).collect()
    };
    fn names_as_str(list: &[String]) -> Vec<&str> {
        list.iter().map(String::as_str).collect()
    }
    let docs = super::functions::doc_paragraphs(&known.source.mechanism.shell.attributes);
    let unit_of_output = |function: &str| {
        let at = m.outputs.iter().position(|output| output.name == function)?;
        m.units.outputs.get(at).cloned()
    };
    let functions: Vec<Value> =
        known.functions.iter().map(|f| function_as_json(f, unit_of_output(&f.name))).collect();
    let all = json!({
        "name": known.input.declaration.name,
        "prefix": known.prefix,
        "version": env!("CARGO_PKG_VERSION"),
        "number": known.scalar_type_name(),
        "documentation": without_doc_links(&docs.join("\n\n")),
        "configuration": json_names_with_units(names_as_str(&m.configuration), &m.units.configuration),
        "velocities": json_names_with_units(
            m.velocities.iter().map(|(name, _)| name.as_str()).collect(),
            &m.units.velocities,
        ),
        "inputs": json_names_with_units(
            m.inputs.iter().map(|(name, _)| name.as_str()).collect(),
            &m.units.inputs,
        ),
        "parameters": json_names_with_units(names_as_str(&m.parameters), &m.units.parameters),
        "outputs": json_names_with_units(
            m.outputs.iter().map(|output| output.name.as_str()).collect(),
            &m.units.outputs,
        ),
        "frames": m.frames.iter().map(|frame| frame.name.as_str()).collect::<Vec<_>>(),
        "limits": m.limits.iter().map(limits_as_json).collect::<Vec<_>>(),
        "constraints": m.constraints.len(),
        "contacts": m.contacts.len(),
        "time": m.time,
        "dynamics": !m.kinematic,
        "equations": known.equations,
        "functions": functions,
        "left_out": known.left_out,
    });
    all.to_string()
}

/// Serialises the limits of a joint: numbers, `"parameters"` for a bound that depends on parameters, or null.
fn limits_as_json(limit: &CoordinateLimits<'_>) -> Value {
    let [lower, upper, velocity, effort] = limit.bounds().map(|bound| {
        bound.map(|bound| bound.constant_value().map_or(json!("parameters"), |value| json!(value)))
    });
    json!({ "index": limit.v.0, "lower": lower, "upper": upper, "velocity": velocity, "effort": effort })
}

fn function_as_json(f: &Function, unit: Option<String>) -> Value {
    let (docs, errors) = super::functions::docs_without_rust_notation(&f.docs);
    let arguments: Vec<Value> = f
        .arguments
        .iter()
        .map(|(name, kind)| match kind {
            FunctionArgumentKind::Number => json!({ "name": name, "kind": "number" }),
            FunctionArgumentKind::Frame => json!({ "name": name, "kind": "frame" }),
            FunctionArgumentKind::Marks => json!({ "name": name, "kind": "velocities" }),
            FunctionArgumentKind::Matrix(rows, 1) => {
                json!({ "name": name, "kind": "array", "shape": [rows] })
            }
            FunctionArgumentKind::Matrix(rows, columns) => {
                json!({ "name": name, "kind": "array", "shape": [rows, columns] })
            }
        })
        .collect();
    let results: Vec<Value> =
        f.results.iter().map(|(name, shape)| json!({ "name": name, "shape": shape })).collect();
    json!({
        "name": f.name,
        "documentation": docs.join("\n\n"),
        "errors": errors,
        "arguments": arguments,
        "results": results,
        "unit": unit,
    })
}
