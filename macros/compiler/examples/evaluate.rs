//! Evaluates the functions of a robot file at states from the standard input, by interpreting their programs.
//!
//! `cargo run -p linkwork-compiler --example evaluate -- FORMAT FILE [OPTION…]`
//!
//! `FORMAT` is `urdf`, `mjcf` or `sdf`; an option is an argument of the attribute, such as `"passive =
//! ignore"`. Prints the names of configuration, velocities and inputs, separated by tabs, and the omitted
//! elements of the file. For each input line `q v u τ` of numbers it then prints six lines: the mass matrix,
//! the bias forces, the generalized forces, the accelerations, and residuals and Jacobian of the constraints.
//! The last two are empty without constraints. Errors of the file are printed to the standard error.
//! `tests/peers/run` compares the output with other programs.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::{Graph, Symbol};
use linkwork_compiler::mechanism::Quantity;
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::{derive, parse_source_and_import};
use std::io::{BufRead, Write};
use std::path::Path;
use std::process::ExitCode;

/// Functions whose values are printed for each state.
const FUNCTIONS: [&str; 6] = [
    "mass_matrix",
    "bias_forces",
    "generalized_forces",
    "forward_dynamics",
    "constraint_residuals",
    "constraint_jacobian",
];

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match evaluate_mechanism() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::FAILURE
        }
    }
}

fn evaluate_mechanism() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [format, file, options @ ..] = words.as_slice() else {
        return Err("expected a format and a file".into());
    };
    let more: String = options.iter().map(|option| format!(", {option}")).collect();
    let arguments = format!("{format} = {file:?}{more}").parse()?;
    let mut cx = Diagnostics::new();
    let source = parse_source_and_import(arguments, "pub struct Robot;".parse()?, Path::new("/"), &mut cx);
    let failure_from_diagnostics = |cx: &Diagnostics| Failure::from(cx.full_message_texts().join("\n"));
    let source = source.filter(|_| cx.is_empty()).ok_or_else(|| failure_from_diagnostics(&cx))?;
    let description = &source.mechanism.description;
    let graph = Graph::new();
    let model = build_model(description, &graph, &mut cx).ok_or_else(|| failure_from_diagnostics(&cx))?;
    let derived = derive(&model, &mut cx).ok_or_else(|| failure_from_diagnostics(&cx))?;
    let velocities: Vec<&str> = model.velocities.iter().map(|(name, _)| name.as_str()).collect();
    let inputs: Vec<&str> = model.inputs.iter().map(|(name, _)| name.as_str()).collect();
    let mut out = std::io::stdout().lock();
    writeln!(out, "configuration\t{}", model.configuration.join("\t"))?;
    writeln!(out, "velocities\t{}", velocities.join("\t"))?;
    writeln!(out, "inputs\t{}", inputs.join("\t"))?;
    writeln!(out, "left out\t{}", description.left_out.join("\t"))?;
    out.flush()?;
    let (nq, nv, nu) = (model.nq(), model.nv(), inputs.len());
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let numbers: Vec<f64> = line.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
        let number_at_index_or_nan = |k: usize| numbers.get(k).copied().unwrap_or(f64::NAN);
        let function_values = |name: &str, passive: &[f64]| {
            let given_number_of_symbol = |symbol: Symbol| match Quantity::from_symbol(symbol) {
                Quantity::Configuration(k) => number_at_index_or_nan(k),
                Quantity::Velocity(k) => number_at_index_or_nan(nq + k),
                Quantity::Input(k) => number_at_index_or_nan(nq + nv + k),
                Quantity::Force(k) => number_at_index_or_nan(nq + nv + nu + k),
                Quantity::PassiveForce(k) => passive.get(k).copied().unwrap_or(f64::NAN),
                _ => f64::NAN,
            };
            let found = derived.functions.iter().find(|function| function.name == name);
            found
                .map(|function| function.program.interpret_program(&given_number_of_symbol))
                .unwrap_or_default()
        };
        // If the passive forces are long, the other functions call them.
        let passive = function_values("__passive_forces", &[]);
        for name in FUNCTIONS {
            let text: Vec<String> =
                function_values(name, &passive).iter().map(|value| format!("{value:e}")).collect();
            writeln!(out, "{}", text.join(" "))?;
        }
        out.flush()?;
    }
    Ok(())
}
