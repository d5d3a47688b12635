//! Documentation of the user's struct: what the mechanism is, in order of its coordinates, with operation counts.

use super::item::{Interface, Output};
use std::fmt::Write;

/// Paragraphs for the struct's rustdoc.
pub fn struct_docs(interface: &Interface<'_>, output: &Output) -> String {
    let mut text = String::from("\n\n# Mechanism\n\n");
    let _ = writeln!(
        text,
        "`NQ` = {}, `NV` = {}, `NU` = {}. SI units, angles in radians.\n",
        interface.configuration.len(),
        interface.velocities.len(),
        interface.inputs.len()
    );
    list(&mut text, "Configuration `q`", &interface.configuration);
    if interface.velocities != interface.configuration {
        list(&mut text, "Velocity `v`", &interface.velocities);
    } else if !interface.velocities.is_empty() {
        text.push_str("- Velocity `v`: their rates\n");
    }
    list(&mut text, "Inputs `u`", &interface.inputs);
    list(&mut text, "Frames", &interface.frames);
    if !output.equations.is_empty() {
        let _ = writeln!(text, "\n# Equations of motion\n\n```text\n{}\n```", output.equations.trim_end());
    }
    text.push_str("\n# Operations\n\n| method | multiplications | additions | divisions | functions |\n| --- | ---: | ---: | ---: | ---: |\n");
    for f in output.functions.iter().filter(|f| !f.docs.is_empty()) {
        let c = f.program.counts;
        if c.total() + c.calls > 0 {
            let _ = writeln!(text, "| `{}` | {} | {} | {} | {} |", f.name, c.mul, c.add, c.div, c.calls);
        }
    }
    text
}

fn list(text: &mut String, what: &str, names: &[String]) {
    if !names.is_empty() {
        let names: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
        let _ = writeln!(text, "- {what}: {}", names.join(", "));
    }
}
