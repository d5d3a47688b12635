//! Mechanisms for web pages that simulate them: their programs as WebAssembly, and their data as JSON.

mod module;

use crate::error::Error;
use crate::functions::{LoadedFunction, ResultAssembly};
use crate::layout::InputLayout;
use crate::robot::Robot;
use crate::shared::Quantity;
use crate::table::{AnyTable, TableData};
use linkwork_compiler::catalogue::Argument;
use linkwork_compiler::lower::Program;
use linkwork_compiler::mechanism::{Chart, InQ, InV};
use module::BinaryModule;
use std::fmt::Write;

/// State and inputs at the start of a simulation in a web page.
#[derive(Clone, Copy, Debug)]
pub struct WebStart<'a> {
    /// Initial configuration of the simulation.
    pub q: &'a [f64],
    /// Initial velocity of the simulation.
    pub v: &'a [f64],
    /// Initial first-order states of the simulation.
    pub x: &'a [f64],
    /// Initial inputs of the simulation.
    pub u: &'a [f64],
}

/// Names of the functions that a web page needs for a mechanism without constraints and contacts.
const FREE: &[&str] = &["forward_dynamics"];
/// Names of the functions that a web page needs for a mechanism with constraints or contacts.
const BOUND: &[&str] = &["mass_matrix", "bias_forces"];
/// Names of the functions that a web page includes for every mechanism that has them.
const ALL: &[&str] = &[
    "generalized_forces",
    "rates_of_speeds",
    "kinetic_energy",
    "potential_energy",
    "constraint_residuals",
    "constraint_rates",
    "constraint_jacobian",
    "constraint_bias",
    "contact_gaps",
    "contact_rates",
    "contact_jacobian",
    "__contact_laws",
];
/// Name of the function that returns the accelerations with friction of sliding contacts that never open.
const SLIPPING: &str = "__constrained_dynamics";

/// WebAssembly module, with the signatures of its functions as JSON.
#[derive(Default)]
struct WebModule {
    module: BinaryModule,
    signatures: Vec<String>,
}

impl WebModule {
    fn add(
        &mut self,
        robot: &Robot,
        name: &str,
        program: &Program,
        arguments: &[Argument],
    ) -> Result<(), String> {
        let layout = InputLayout::new(arguments).ok_or_else(|| format!("`{name}` has too many arguments"))?;
        self.module.add(name, program, &layout)?;
        let list = arguments.iter().map(|argument| {
            format!("[{},{}]", json_string(argument.argument_name()), robot.shared.sizes.length(*argument))
        });
        let (list, length) = (json_list(list), program.outputs.len());
        self.signatures.push(format!("{}:{{\"args\":{list},\"length\":{length}}}", json_string(name)));
        Ok(())
    }

    fn add_program_of_entry(&mut self, robot: &Robot, entry: &LoadedFunction) -> Result<(), String> {
        match &entry.plan {
            ResultAssembly::Program(routine) => match routine.program() {
                Some(program) => self.add(robot, &entry.name, program, &entry.arguments),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }
}

impl Robot {
    /// Returns the data of the mechanism for a page that simulates it, as JSON (names, units, structure,
    /// values of the parameters and the start), and a WebAssembly module of its functions. `drawing` computes
    /// the numbers of the drawing from the parameters.
    ///
    /// # Errors
    ///
    /// The mechanism has no inertia, or a parameter or table has no value.
    #[doc(hidden)]
    pub fn web_data(&self, drawing: &Program, start: WebStart<'_>) -> Result<(String, Vec<u8>), Error> {
        self.validate()?;
        let shared = &self.shared;
        let refused =
            |why: &str| Error::Value(format!("`{}` cannot be simulated in a page: {why}", self.name()));
        if shared.kinematic {
            return Err(refused("it has no masses (`inertia = none`), so it has no equations of motion"));
        }
        if !shared.polytopes.is_empty() {
            return Err(refused(
                "it has contacts of hulls and cylinders with each other, or of hulls with boxes or capsules",
            ));
        }
        let module = self.web_module(drawing).map_err(Error::Internal)?;
        let mut fields = self.web_structure();
        let parameters = self.parameter_values();
        for (name, list) in
            [("parameterValues", parameters), ("q", start.q), ("v", start.v), ("x", start.x), ("u", start.u)]
        {
            fields.push((name, json_numbers(list)));
        }
        fields.push((
            "tables",
            json_list(self.interpolation_tables().iter().filter_map(AnyTable::grid).map(table_json)),
        ));
        fields.push(("functions", format!("{{{}}}", module.signatures.join(","))));
        let fields: Vec<String> =
            fields.into_iter().map(|(name, value)| format!("{}:{value}", json_string(name))).collect();
        Ok((format!("{{{}}}", fields.join(",")), module.module.bytes()))
    }

    fn web_module(&self, drawing: &Program) -> Result<WebModule, String> {
        let shared = &self.shared;
        if !shared.separate.is_empty() {
            return Err(format!(
                "a page simulates at most 128 contact points, but `{}` has {}",
                shared.name,
                shared.contacts.len()
            ));
        }
        let is_bound = !(shared.constraints.names.is_empty() && shared.contacts.is_empty());
        let slips = !shared.constraints.slipping.is_empty();
        let own = if is_bound { BOUND } else { FREE };
        let outputs = self.outputs().iter().map(|output| output.name.as_str());
        let names = own.iter().chain(ALL).copied().chain(slips.then_some(SLIPPING)).chain(outputs);
        let mut indices: Vec<usize> = names.filter_map(|name| shared.index.get(name).copied()).collect();
        indices.extend(shared.states.iter().filter_map(|state| state.rate));
        indices.sort_unstable();
        indices.dedup();
        let mut written = WebModule::default();
        for index in indices {
            written.add_program_of_entry(self, &shared.entries[index])?;
        }
        let time = shared.time.then_some(Argument::T);
        let arguments: Vec<Argument> = time.into_iter().chain([Argument::Q]).collect();
        written.add(self, "placements", &shared.frames.frame_placements_program(), &arguments)?;
        written.add(self, "drawing", drawing, &[])?;
        Ok(written)
    }

    /// Returns the structure of the mechanism for a web page, as names and values of JSON fields.
    fn web_structure(&self) -> Vec<(&'static str, String)> {
        let shared = &self.shared;
        let quantities_as_json = |list: &[Quantity]| {
            json_list(
                list.iter().map(|one| format!("[{},{}]", json_string(&one.name), json_string(&one.unit))),
            )
        };
        let indices_as_json = |list: &[usize]| json_list(list.iter().map(ToString::to_string));
        let charts = json_list(shared.charts.iter().map(|chart| match chart {
            Chart::Plain(InQ(q), InV(v)) => format!("[0,{q},{v}]"),
            Chart::Ball(InQ(q), InV(v)) => format!("[1,{q},{v}]"),
            Chart::Free(InQ(q), InV(v)) => format!("[2,{q},{v}]"),
        }));
        let contacts = json_list(shared.contacts.iter().map(|contact| {
            let [first, count] = contact.rows;
            format!(
                "{{\"name\":{},\"first\":{first},\"count\":{count},\"pressedBy\":{}}}",
                json_string(&contact.name),
                contact.pressed_by
            )
        }));
        let states = json_list(shared.states.iter().map(|state| {
            let rate = state.rate.map_or("null".to_string(), |k| json_string(&shared.entries[k].name));
            format!("[{},{rate}]", state.parameter)
        }));
        let constraints = &shared.constraints;
        let states_of = shared.states.iter().map(|state| &shared.parameters[state.parameter].name);
        vec![
            ("name", json_string(&shared.name)),
            ("configuration", quantities_as_json(&shared.configuration)),
            ("velocities", quantities_as_json(&shared.velocities)),
            ("inputs", quantities_as_json(&shared.inputs)),
            ("parameters", quantities_as_json(&shared.parameters)),
            ("outputs", quantities_as_json(self.outputs())),
            ("frames", json_list(shared.frames.names.iter().map(|name| json_string(name)))),
            ("charts", charts),
            ("states", states),
            ("stateNames", json_list(states_of.map(|name| json_string(name)))),
            ("constraints", constraints.names.len().to_string()),
            ("holonomic", constraints.holonomic.to_string()),
            ("slipping", indices_as_json(&constraints.slipping)),
            ("contacts", contacts),
        ]
    }
}

/// Returns a table as JSON: axes, values, and whether it is smooth and extrapolated.
fn table_json(grid: TableData<'_>) -> String {
    let axes = json_list(grid.axes.iter().map(|axis| json_numbers(axis)));
    let values = json_numbers(grid.values);
    format!("[{axes},{values},{},{}]", grid.is_smooth, grid.is_extrapolated)
}

/// Returns a JSON list of items that are already JSON.
fn json_list(items: impl Iterator<Item = String>) -> String {
    format!("[{}]", items.collect::<Vec<_>>().join(","))
}

/// Formats a JSON array of numbers, with `null` for numbers that are not finite.
fn json_numbers(list: &[f64]) -> String {
    json_list(list.iter().map(|x| if x.is_finite() { format!("{x:?}") } else { "null".to_string() }))
}

/// Formats a text as a JSON string without characters of HTML markup.
fn json_string(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' | '<' | '>' | '&' | '\u{7f}' | '\u{2028}' | '\u{2029}' | '\0'..='\u{1f}' => {
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strings_contain_no_markup() {
        assert_eq!(json_string("a<\"b\n"), "\"a\\u003c\\u0022b\\u000a\"");
    }
}
