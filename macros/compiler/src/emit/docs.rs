//! Documentation of the user's struct: coordinates, units, limits, constraints, contacts, equations and
//! operation counts.

use super::interface::Interface;
use super::{contacts, limits};
use crate::catalogue::GeneratedId;
use crate::derive::{DerivationOutput, Function};
use crate::equations::PrintedEquations;
use crate::expr::Symbol;
use crate::lower::Program;
use crate::mechanism::{DegreeOfFreedomCounts, Quantity};
use crate::syntax::EquationsOption;
use std::fmt::Write;

/// Part of the struct's documentation, with the medium that shows it.
pub enum DocumentationPart {
    /// Text shown on rustdoc pages and in editors.
    Everywhere(String),
    /// HTML shown on rustdoc pages only.
    Pages(String),
    /// Plain text shown in editors only.
    Editors(String),
}

/// Returns the documentation of the struct.
pub fn struct_docs(interface: &Interface<'_>, output: &DerivationOutput) -> Vec<DocumentationPart> {
    let mut parts = Vec::new();
    let mut text = String::from("\n\n");
    add_user_declaration_source(&mut text, interface);
    text.push_str("# Mechanism\n\n");
    let _ = writeln!(
        text,
        "`NQ` = {}, `NV` = {}, `NU` = {}. SI units, angles in radians.\n",
        interface.configuration.len(),
        interface.velocities.len(),
        interface.inputs.len()
    );
    add_name_list(&mut text, "Configuration `q`", &interface.configuration);
    if interface.velocities != interface.configuration {
        add_name_list(&mut text, "Velocity `v`", &interface.velocities);
    } else if !interface.velocities.is_empty() {
        text.push_str("- Velocity `v`: their rates\n");
    }
    if interface.facts.speeds {
        text.push_str(
            "- Generalized speeds are among the velocities: `rates_of_speeds` returns the joint velocities\n",
        );
    }
    add_name_list(&mut text, "Inputs `u`", &interface.inputs);
    add_name_list(&mut text, "Frames", &interface.frames);
    for name in &interface.frames {
        if let Some(note) = doc_comment_of_field(interface, name) {
            let _ = writeln!(text, "  - `{name}`: {note}");
        }
    }
    add_unit_table(&mut text, interface);
    limits::write_documentation_table(&mut text, &interface.limits);
    add_constraint_section(&mut text, interface);
    contacts::write_documentation_table(&mut text, &interface.contacts);
    if !interface.snapped.is_empty() {
        text.push_str("\n# Rounded numbers\n\nNumbers of the file that `snap` has rounded:\n\n");
        for number in interface.snapped {
            let _ = writeln!(text, "- {number}");
        }
    }
    if !interface.left_out.is_empty() {
        text.push_str("\n# Omitted\n\nElements of the file that are not in the mechanism:\n\n");
        for line in interface.left_out {
            let _ = writeln!(text, "- {line}");
        }
    }
    if output.equations.plain.is_empty() && !interface.structure.is_empty() {
        let about = match interface.facts.kinematic {
            true => {
                "There are no dynamics, by `inertia = none`: functions that need masses and inertias are \
                 omitted, and so is the trait `Mechanism`."
            }
            false if interface.velocities.is_empty() => "Nothing moves.",
            false if interface.facts.requests.equations == EquationsOption::Structure => {
                "`M(q) v̇ + h(q, v) = τ`, whose terms are omitted by `equations = structure`."
            }
            false => {
                "`M(q) v̇ + h(q, v) = τ`, which has too many terms to be readable; the option `equations = \
                 lagrange` prints up to some thousand."
            }
        };
        let _ = writeln!(text, "\n# Structure\n\n{about}\n");
        for joint in &interface.structure {
            let _ = writeln!(text, "- {joint}");
        }
    }
    if !output.equations.plain.is_empty() {
        add_equation_section(&mut parts, &mut text, "Equations of motion", &output.equations, "<details>");
    }
    for linear in &output.linear_equations {
        // The text contains more than the equations.
        add_equation_section(&mut parts, &mut text, "Linear equations", linear, "<details open>");
    }
    if let Some(kept) = output.constants.iter().find(|c| c.name == "CONSERVED") {
        text.push_str("\n# Conserved\n\n");
        text.push_str(if kept.list.is_empty() { "None of the tested quantities.\n" } else { "" });
        kept.list.iter().for_each(|name| {
            let _ = writeln!(text, "- {}", name.trim_matches('"'));
        });
    }
    text.push_str(&operation_count_table(&output.functions));
    add_lane_section(&mut text, interface, output);
    parts.push(DocumentationPart::Everywhere(text));
    parts
}

/// Adds a section with equations: typeset on pages, with the text folded below; in editors the text alone.
fn add_equation_section(
    parts: &mut Vec<DocumentationPart>,
    text: &mut String,
    title: &str,
    equations: &PrintedEquations,
    details: &str,
) {
    let _ = writeln!(text, "\n# {title}");
    parts.push(DocumentationPart::Everywhere(std::mem::take(text)));
    let plain = format!("\n```text\n{}\n```\n", equations.plain.trim_end());
    let page = &equations.mathml;
    parts.push(DocumentationPart::Pages(format!(
        "\n{page}\n\n{details}<summary>As text</summary>\n{plain}\n</details>\n\n"
    )));
    parts.push(DocumentationPart::Editors(plain));
    // An HTML block ends at an empty line, and rustdoc drops one empty line.
    text.push('\n');
}

/// Returns a table of the operation counts of the functions, with the values from which a worst-case
/// execution time is estimated; empty if no function has any operation.
pub fn operation_count_table(functions: &[Function]) -> String {
    let mut lines = String::new();
    let mut write_operation_count_row = |name: &str, program: &Program| {
        let c = program.counts;
        let (held, branches) = (program.max_live(), program.possibly_branching_instruction_count());
        let _ = writeln!(
            lines,
            "| {name} | {} | {} | {} | {} | {held} | {branches} |",
            c.mul, c.add, c.div, c.calls
        );
    };
    for f in functions {
        let name = match f.id {
            GeneratedId::PassiveForces => "passive forces, called by other functions".to_string(),
            GeneratedId::PassiveDerivatives => "their derivatives, called by other functions".to_string(),
            GeneratedId::ConstrainedDynamics => format!("`{}`", f.name.trim_start_matches('_')),
            _ if f.is_hidden() => continue,
            _ => format!("`{}`", f.name),
        };
        if f.program.counts.total_operations() + f.program.counts.calls > 0 {
            write_operation_count_row(&name, &f.program);
        }
        if let Some(program) = &f.program.simd {
            write_operation_count_row("its variant in lanes", program);
        }
        if let Some(loops) = &f.loops {
            write_operation_count_row(
                "its variant with loops over links, which are not counted",
                &loops.program,
            );
        }
    }
    if lines.is_empty() {
        return lines;
    }
    format!(
        "\n# Operations\n\n| method | multiplications | additions | divisions | functions | live values | \
         branches |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n{lines}\nThe code is straight-line, \
         without loops and recursion. *Live values* is the maximum number of values that are live at once in \
         addition to the arguments, including returned values. With 8 bytes each (`f64`) they are the stack \
         that an optimised build needs, apart from copies of the result. *Branches* are possible for angles \
         beyond 10⁵ rad (one for all angles), in tables and in functions of the math library. The chapter \
         `speed` of the guide explains how to estimate a worst-case execution time.\n"
    )
}

/// Adds the section on constraints and degrees of freedom.
fn add_constraint_section(text: &mut String, i: &Interface<'_>) {
    let c = &i.constraints;
    if c.names.is_empty() {
        return;
    }
    let DegreeOfFreedomCounts { coordinates, velocities: speeds } = c.freedom;
    let _ = writeln!(
        text,
        "\n# Constraints\n\nThe coordinates are not independent: `NC` = {}, of which `NH` = {} are on \
         configurations. Degrees of freedom: `NP` = {coordinates} of configurations, `NS` = {speeds} of \
         velocities.\n",
        c.names.len(),
        c.holonomic
    );
    text.push_str(
        "| | constraint | restricts | residual or rate | multiplier |\n| --- | --- | --- | --- | --- |\n",
    );
    for (k, (name, [residual, multiplier])) in c.names.iter().zip(&i.units.constraints).enumerate() {
        let what = if k < c.holonomic { "configurations" } else { "velocities" };
        let _ = writeln!(text, "| `λ[{k}]` | `{name}` | {what} | {residual} | {multiplier} |");
    }
    text.push('\n');
    add_name_list(text, "Omitted, because they depend on these", &c.redundant);
    let dependent = (speeds + c.names.len()).saturating_sub(i.velocities.len());
    if dependent > 0 {
        let _ = writeln!(
            text,
            "- Redundant if the constraints hold: {dependent}; the multipliers have minimum norm"
        );
    }
}

/// Adds the section on SIMD lanes: the functions that evaluate identical limbs or joints as lanes, and the
/// coordinates of these limbs.
fn add_lane_section(text: &mut String, i: &Interface<'_>, output: &DerivationOutput) {
    let shown = output.functions.iter().filter(|f| !f.name.starts_with("__"));
    let in_lanes: Vec<(&str, &Program)> =
        shown.filter_map(|f| Some((f.name.as_str(), f.program.simd.as_deref()?))).collect();
    let Some((_, most)) = in_lanes.iter().max_by_key(|(_, program)| program.gathers.len()) else { return };
    let names: Vec<String> = in_lanes.iter().map(|(name, _)| format!("`{name}`")).collect();
    let _ = writeln!(
        text,
        "\n# Lanes\n\nIdentical limbs, or joints of one path to the root, are evaluated as SIMD lanes by {}. \
         An operation on all lanes counts once.",
        names.join(", ")
    );
    if !most.gathers.is_empty() {
        text.push_str("Corresponding coordinates of the limbs:\n\n");
    }
    for gather in &most.gathers {
        let coordinate_name = |s: &Symbol| match Quantity::from_symbol(*s) {
            Quantity::Configuration(k) => i.configuration.get(k).map(|name| format!("`{name}`")),
            _ => None,
        };
        let mut names: Vec<String> = gather.iter().filter_map(coordinate_name).collect();
        names.dedup();
        if !names.is_empty() {
            let _ = writeln!(text, "- {}", names.join(", "));
        }
    }
}

/// Adds the table of the units of parameters, coordinates, inputs, tables and outputs.
fn add_unit_table(text: &mut String, i: &Interface<'_>) {
    let strip_raw_prefix = |name: String| name.trim_start_matches("r#").to_string();
    let parameters: Vec<String> =
        i.shell.parameter_access_paths().into_iter().map(strip_raw_prefix).collect();
    let lists: [(&str, &[String], &[String]); 4] = [
        ("", &parameters, &i.units.parameters),
        ("q", &i.configuration, &i.units.configuration),
        ("v", &i.velocities, &i.units.velocities),
        ("u", &i.inputs, &i.units.inputs),
    ];
    text.push_str("\n# Units\n\nInferred from use; `any` where nothing determines one.\n\n");
    text.push_str(match i.shell.notes.is_empty() {
        true => "| | name | unit |\n| --- | --- | --- |\n",
        false => "| | name | unit | |\n| --- | --- | --- | --- |\n",
    });
    let mut said = Vec::new();
    let mut write_unit_row = |what: &str, name: &str, unit: &str| {
        let _ = write!(text, "| {what} | `{name}` | {unit} |");
        if !i.shell.notes.is_empty() {
            // The note of a joint is printed once, for the first of its coordinates.
            let note = doc_comment_of_field(i, name).filter(|note| !said.contains(note));
            said.extend(note);
            let _ = write!(text, " {} |", note.unwrap_or_default().replace('|', "\\|"));
        }
        text.push('\n');
    };
    for (what, names, units) in lists {
        for (k, (name, unit)) in names.iter().zip(units).enumerate() {
            let what = if what.is_empty() { "parameter".to_string() } else { format!("`{what}[{k}]`") };
            write_unit_row(&what, name, unit);
        }
    }
    for (name, units) in i.shell.table_names().into_iter().zip(&i.units.tables) {
        if let Some((value, variables)) = units.split_last() {
            write_unit_row(
                "table",
                &strip_raw_prefix(name),
                &format!("{value} over {}", variables.join(", ")),
            );
        }
    }
    for (name, unit) in i.outputs.iter().zip(&i.units.outputs) {
        write_unit_row("output", name, unit);
    }
}

/// Returns the user's doc comment of the field to which a name belongs.
pub fn doc_comment_of_field<'a>(i: &'a Interface<'_>, name: &str) -> Option<&'a str> {
    let field = name.split('.').next().unwrap_or(name);
    i.shell.notes.iter().find(|(known, _)| known == field).map(|(_, note)| note.as_str())
}

/// Returns the documentation of an output's function: the user's doc comment, then the description `what`.
pub fn output_function_documentation(i: &Interface<'_>, name: &str, what: &str) -> String {
    match doc_comment_of_field(i, name) {
        Some(note) => format!(" {note}\n\n The output `{name}`, {what}"),
        None => format!(" The output `{name}`, {what}"),
    }
}

/// Maximum number of lines of a declaration that is not folded.
const UNFOLDED: usize = 40;

/// Adds the user's declaration as source text to the documentation.
fn add_user_declaration_source(text: &mut String, i: &Interface<'_>) {
    let Some(code) = &i.shell.declaration else { return };
    // Doc comments may contain code.
    let mut fence = "```".to_string();
    while code.contains(&fence) {
        fence.push('`');
    }
    let code = format!("{fence}text\n{code}\n{fence}\n");
    let _ = match code.lines().count() > UNFOLDED {
        true => writeln!(text, "# Declaration\n\n<details><summary>Source</summary>\n\n{code}\n</details>\n"),
        false => writeln!(text, "# Declaration\n\n{code}"),
    };
}

fn add_name_list(text: &mut String, what: &str, names: &[String]) {
    if !names.is_empty() {
        let names: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
        let _ = writeln!(text, "- {what}: {}", names.join(", "));
    }
}
