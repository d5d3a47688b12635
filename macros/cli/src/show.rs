//! `linkwork show`: prints the compiled model of a mechanism.

use crate::Stop;
use crate::input::{DerivedMechanism, MechanismInput};
use clap::ArgMatches;
use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Model;
use serde_json::{Value, json};

pub fn run_show(matches: &ArgMatches) -> Result<(), Stop> {
    let as_json = matches.get_flag("json");
    let mut all = Vec::new();
    for input in &MechanismInput::select_mechanisms(matches)? {
        let graph = Graph::new();
        let DerivedMechanism { source, model, output } = input.derive_mechanism(&graph)?;
        let shown =
            ShownMechanism { model: &model, output: &output, structure: source.joint_structure_lines() };
        match as_json {
            true => all.push(shown.summary_as_json()),
            false => crate::print_or_exit(format_args!("{}", shown.mechanism_summary_text())),
        }
    }
    if as_json {
        crate::say!("{:#}", json!({ "mechanisms": all }));
    }
    Ok(())
}

struct ShownMechanism<'a, 'g> {
    model: &'a Model<'g>,
    output: &'a DerivationOutput,
    structure: Vec<String>,
}

/// Printed list: its title, its JSON key, and the names with their units.
type NameListWithUnits<'a> = (&'static str, &'static str, Vec<&'a str>, &'a [String]);

impl ShownMechanism<'_, '_> {
    fn lists_of_names(&self) -> Vec<NameListWithUnits<'_>> {
        let m = self.model;
        fn names_as_str(list: &[String]) -> Vec<&str> {
            list.iter().map(String::as_str).collect()
        }
        vec![
            ("Parameters", "parameters", names_as_str(&m.parameters), &m.units.parameters),
            ("Configuration q", "configuration", names_as_str(&m.configuration), &m.units.configuration),
            (
                "Velocity v",
                "velocity",
                m.velocities.iter().map(|(name, _)| name.as_str()).collect(),
                &m.units.velocities,
            ),
            ("Inputs u", "inputs", m.inputs.iter().map(|(name, _)| name.as_str()).collect(), &m.units.inputs),
            (
                "Outputs",
                "outputs",
                m.outputs.iter().map(|output| output.name.as_str()).collect(),
                &m.units.outputs,
            ),
        ]
    }

    fn mechanism_summary_text(&self) -> String {
        let m = self.model;
        let mut text = format!("{}: NQ = {}, NV = {}, NU = {}\n", m.name, m.nq(), m.nv(), m.nu());
        for (title, _, names, units) in self.lists_of_names() {
            if names.is_empty() {
                continue;
            }
            text.push_str(&format!("\n{title}\n"));
            let width = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
            for (k, name) in names.iter().enumerate() {
                let unit = units.get(k).map_or("", String::as_str);
                text.push_str(format!("{k:5}  {name:width$}  {unit}").trim_end());
                text.push('\n');
            }
        }
        let frames: Vec<&str> = m.frames.iter().map(|frame| frame.name.as_str()).collect();
        if !frames.is_empty() {
            text.push_str(&format!("\nFrames\n       {}\n", frames.join(", ")));
        }
        if !self.structure.is_empty() {
            text.push_str("\nJoints\n");
            self.structure
                .iter()
                .for_each(|line| text.push_str(&format!("       {}\n", line.replace('`', ""))));
        }
        let equations = self.output.equations.plain.trim_end();
        if !equations.is_empty() {
            text.push_str("\nEquations of motion\n");
            equations.lines().for_each(|line| text.push_str(&format!("       {line}\n")));
        }
        text.push_str(&format!("\n{:38}{:>8}{:>8}{:>8}{:>8}\n", "Operations", "mul", "add", "div", "calls"));
        for f in self.output.functions.iter().filter(|f| !f.is_hidden()) {
            let c = f.program.counts;
            text.push_str(&format!("  {:36}{:>8}{:>8}{:>8}{:>8}\n", f.name, c.mul, c.add, c.div, c.calls));
        }
        text
    }

    fn summary_as_json(&self) -> Value {
        let m = self.model;
        let mut all = json!({
            "name": m.name,
            "nq": m.nq(),
            "nv": m.nv(),
            "nu": m.nu(),
            "constraints": m.constraints.len(),
            "degrees_of_freedom": m.freedom.velocities,
            "frames": m.frames.iter().map(|frame| frame.name.as_str()).collect::<Vec<_>>(),
            "joints": self.structure,
            "equations": self.output.equations.plain,
            "operations": self.output.functions.iter().filter(|f| !f.is_hidden()).map(|f| {
                let c = f.program.counts;
                json!({
                    "function": f.name,
                    "multiplications": c.mul,
                    "additions": c.add,
                    "divisions": c.div,
                    "functions": c.calls,
                })
            }).collect::<Vec<_>>(),
        });
        for (_, key, names, units) in self.lists_of_names() {
            let unit_at_index = |k: usize| units.get(k).map_or("", String::as_str);
            let list: Vec<Value> = names
                .iter()
                .enumerate()
                .map(|(k, name)| json!({ "name": name, "unit": unit_at_index(k) }))
                .collect();
            all[key] = list.into();
        }
        all
    }
}
