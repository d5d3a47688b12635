//! Definitions of derived functions in C.

use super::super::body::{CBodyScope, MISSING, write_program};
use super::super::mechanism::ExportedMechanism;
use super::super::signatures::{ArrayArgument, ExportedSignature, public_identifier};
use super::super::tokens::contains_word;
use super::composed::write_composed_body;
use crate::catalogue::{Argument, CalledFunction, GeneratedId, Shape};
use crate::derive::Function;
use crate::lower::Program;
use std::borrow::Cow;
use std::fmt::Write;

/// Returns the C signature of a function.
pub fn function_head(i: &ExportedMechanism<'_>, f: &ExportedSignature) -> String {
    let kind = match (f.of_frame, f.returns) {
        (true, _) => "int",
        (_, true) => "double",
        _ => "void",
    };
    let own = i.takes_parameter_struct().then(|| format!("const {} *self", i.prefix));
    let frame = f.of_frame.then(|| "int frame".to_string());
    let arguments = f.arguments.iter().map(|a| match a.is_value {
        true => format!("double {}", a.name),
        false => format!("const double *{}", a.name),
    });
    let results = f.results.iter().filter(|_| !f.returns).map(|a| format!("double *{}", a.name));
    let list: Vec<String> = own.into_iter().chain(frame).chain(arguments).chain(results).collect();
    let list = if list.is_empty() { "void".to_string() } else { list.join(", ") };
    format!("{kind} {}_{}({list})", i.prefix, f.name)
}

/// Returns the definition of a function with a body. Unused arguments cause no compiler warnings.
pub fn function_definition(i: &ExportedMechanism<'_>, f: &ExportedSignature, body: &str) -> String {
    let own = i.takes_parameter_struct().then_some("self");
    let unused: String = own
        .into_iter()
        .chain(f.array_names())
        .filter(|name| !contains_word(body, name))
        .map(|name| format!("    (void)({name});\n"))
        .collect();
    format!("{} {{\n{unused}{body}}}\n", function_head(i, f))
}

/// Returns the definitions of all derived functions. With `is_late`, bodies are for processors that keep all
/// values in registers.
pub fn definitions_of_derived_functions(i: &ExportedMechanism<'_>, is_late: bool) -> String {
    let mut text = String::new();
    let derived_function_definition = |f: &Function| {
        function_definition(i, &ExportedSignature::from_function(f, i), &derived_function_body(i, f, is_late))
    };
    i.hidden.iter().for_each(|f| text.push_str(&format!("static {}\n", derived_function_definition(f))));
    i.public.iter().for_each(|f| text.push_str(&format!("{}\n", derived_function_definition(f))));
    let signatures = i.functions.iter().skip(i.public.len());
    for (f, signature) in i.reactions.iter().zip(signatures) {
        let body = reaction_body(i, f);
        let _ = writeln!(
            text,
            "static {}\n{}",
            derived_function_definition(f),
            function_definition(i, signature, &body)
        );
    }
    text
}

/// Returns the body of a derived function.
fn derived_function_body(i: &ExportedMechanism<'_>, f: &Function, is_late: bool) -> String {
    let mut body = String::new();
    let arguments: Vec<Argument> =
        f.arguments.iter().copied().chain(CalledFunction::ALL.map(Argument::Called)).collect();
    let scope = CBodyScope { arguments: &arguments, parameters: &i.parameters, tables: &i.tables, is_late };
    CalledFunction::ALL.into_iter().for_each(|called| write_call_if_needed(&mut body, f, called, i));
    match f.shape {
        Shape::Scalar => {
            let result = write_program(&mut body, &f.program, &scope, &|_| None);
            let _ = writeln!(body, "    return {result};");
        }
        Shape::Inverse(_)
        | Shape::Forward(_)
        | Shape::Linear(..)
        | Shape::Accelerated(_)
        | Shape::ForwardDerivativesByCalls(_)
        | Shape::CalledLinear(..) => write_composed_body(&mut body, f, &scope, i),
        _ => {
            let signature = ExportedSignature::from_function(f, i);
            let program = program_of_own_results(f, i);
            let count: usize = signature.results.iter().map(ArrayArgument::length).sum();
            if count != program.outputs.len() {
                let _ = writeln!(body, "    {MISSING};");
            }
            write_program(&mut body, &program, &scope, &|k| signature.element_of_output(k));
        }
    }
    body
}

/// Returns the program of a function without the outputs that are not results: the forces of inputs, which
/// are the results of another function, before their derivatives.
pub fn program_of_own_results<'f>(f: &'f Function, i: &ExportedMechanism<'_>) -> Cow<'f, Program> {
    if f.id != GeneratedId::InputDerivatives {
        return Cow::Borrowed(&f.program);
    }
    let mut program = f.program.clone();
    program.outputs.drain(..i.nv().min(program.outputs.len()));
    program.remove_unused_instructions();
    Cow::Owned(program)
}

/// Writes the call of a function whose results are inputs of the program, if the program uses them.
fn write_call_if_needed(body: &mut String, f: &Function, called: CalledFunction, i: &ExportedMechanism<'_>) {
    if !f.reads_results_of(called) {
        return;
    }
    let id = match called {
        CalledFunction::PassiveForces => GeneratedId::PassiveForces,
        CalledFunction::PassiveDerivatives => GeneratedId::PassiveDerivatives,
        // C lacks the functions that read them.
        CalledFunction::ContactFeatures => return,
    };
    let name = Argument::Called(called).argument_name();
    let length = i.find_derived_function(id).map_or(0, |f| f.program.outputs.len());
    let call = i.function_call_text(&public_identifier(called.function_name()), &["q", "v", name]);
    let _ = writeln!(body, "    double {name}[{length}];\n    {call};");
}

/// Returns the body of the function for a reaction, in the motion that state and inputs determine.
fn reaction_body(i: &ExportedMechanism<'_>, f: &Function) -> String {
    let (n, m) = (i.nv().max(1), i.nu());
    let mut body = format!("    double a[{n}], tau[{n}];\n");
    let forces = match m {
        0 => format!("for (int k = 0; k < {n}; ++k) {{\n        tau[k] = 0.0;\n    }}"),
        _ => format!(
            "{};",
            i.function_call_text("generalized_forces", &[i.input_force_argument_names(), &["tau"]].concat())
        ),
    };
    let _ = writeln!(
        body,
        "    {forces}\n    {};",
        i.function_call_text("forward_dynamics", &["q", "v", "tau", "a"])
    );
    let mut given = vec!["q", "v", "a"];
    given.extend((m > 0).then_some("u"));
    let hidden = public_identifier(&f.name);
    let _ = match f.shape {
        Shape::Scalar => writeln!(body, "    return {};", i.function_call_text(&hidden, &given)),
        _ => writeln!(body, "    {};", i.function_call_text(&hidden, &[&given[..], &["result"]].concat())),
    };
    body
}
