//! Large functions, which select their arithmetic at run time. Their bodies are implementations of a runtime
//! trait, generic over the arithmetic. The functions themselves call the instance that suits the processor.

use super::body::write_body;
use super::function::{write_function, write_function_head};
use super::instruction::BuildKind;
use super::interface::{ALLOW, ImplGenerics};
use super::lanes;
use super::signature::{SignatureContext, variant_matrix_argument_count};
use crate::derive::Function;
use crate::machine::DISPATCHED_OPERATIONS;
use std::fmt::Write;

/// Maximum number of operations of a function with a separate body for debug builds. The compiler processes
/// both bodies in any build.
const LARGEST: usize = 5000;

/// Bodies of the functions of a type that select their arithmetic at run time.
pub struct ArithmeticDispatchedBodies {
    /// True if functions may select their arithmetic at run time.
    wanted: bool,
    /// Function bodies that have been added so far.
    list: Vec<ArithmeticGenericBody>,
}

/// Body of a large function, generic over the arithmetic.
struct ArithmeticGenericBody {
    /// Types of the arguments, as the text of a tuple.
    types: String,
    /// Names of the arguments, as the text of a tuple.
    names: String,
    /// Rust type of the function's result.
    result: String,
    /// True for a function of several states in SIMD lanes.
    simd: bool,
    /// Statements of the function body.
    text: String,
    /// Statements of the body for debug builds, if it is separate.
    debug: Option<String>,
}

/// Returns true for a function that selects its arithmetic at run time. A function that calls other functions
/// multiplies their matrices and counts as large.
fn dispatches_at_run_time(f: &Function) -> bool {
    // A function that only calls its variant with matrix arguments has no arithmetic of its own.
    variant_matrix_argument_count(f).is_none()
        && (f.shape.is_assembled_from_calls() || f.program.instructions.len() >= DISPATCHED_OPERATIONS)
}

impl ArithmeticDispatchedBodies {
    /// Returns an empty list of function bodies, which stays empty if `wanted` is false.
    pub fn new(wanted: bool) -> ArithmeticDispatchedBodies {
        ArithmeticDispatchedBodies { wanted, list: Vec::new() }
    }

    /// Writes a function. The body of a large function is added to the list instead.
    pub fn write_function(&mut self, out: &mut String, f: &Function, s: &SignatureContext<'_>) {
        // The functions of one state and of several states are equally large.
        if !self.wanted || !dispatches_at_run_time(f) {
            return write_function(out, f, s, false);
        }
        let types: Vec<String> = f.arguments.iter().map(|a| s.argument_type(*a)).collect();
        let names: Vec<&str> = f.arguments.iter().map(|a| a.argument_name()).collect();
        let format_tuple =
            |list: String| if list.is_empty() { "()".to_string() } else { format!("({list},)") };
        let (types, names) = (format_tuple(types.join(", ")), format_tuple(names.join(", ")));
        write_function_head(out, f, s);
        let _ = writeln!(
            out,
            "::linkwork::__private::dispatch::<{}, {}, _, _>(self, {names})\n}}",
            self.list.len(),
            s.scalar.single_lane_scalar_type()
        );
        let mut text = String::new();
        write_body(&mut text, f, s, true, BuildKind::Optimised);
        let debug = match s.scalar.uses_batch_lanes() {
            true => lanes::sequential_debug_body(f),
            // Calls of other functions are followed by products of their matrices, which are large.
            false if f.shape.is_assembled_from_calls() || f.program.instructions.len() > LARGEST => None,
            false => {
                let mut text = String::new();
                write_body(&mut text, f, s, true, BuildKind::Debug);
                Some(text)
            }
        };
        self.list.push(ArithmeticGenericBody {
            types,
            names,
            result: s.result_type(f),
            simd: s.scalar.uses_batch_lanes(),
            text,
            debug,
        });
    }

    /// Writes the bodies of the functions of the type `name`.
    pub fn write_function_bodies(&self, out: &mut String, name: &str, head: &ImplGenerics) {
        let ImplGenerics { generics, arguments, bounds } = head;
        for (k, body) in self.list.iter().enumerate() {
            let ArithmeticGenericBody { types, names, result, text, debug, .. } = body;
            let own =
                generics.trim().trim_start_matches('<').trim_end_matches('>').trim().trim_end_matches(',');
            let lanes = if body.simd { "const LANES: usize" } else { "" };
            let comma = if own.is_empty() || lanes.is_empty() { "" } else { ", " };
            let _ = writeln!(
                out,
                "{ALLOW}#[doc(hidden)]\nimpl<{own}{comma}{lanes}> ::linkwork::__private::Evaluate<{k}, \
                 {types}> for {name}{arguments} {bounds} {{
                type Output = {result};"
            );
            let head = format!(
                "fn evaluate<Ops: ::linkwork::__private::Arithmetic>(&self, {names}: {types}) -> {result}"
            );
            if let Some(debug) = debug {
                let _ = writeln!(out, "#[cfg(debug_assertions)]\n{head} {{\n{debug}}}");
                out.push_str("#[cfg(not(debug_assertions))]\n");
            }
            let _ = writeln!(out, "#[inline(always)]\n{head} {{\n{text}}}\n}}");
        }
    }
}
