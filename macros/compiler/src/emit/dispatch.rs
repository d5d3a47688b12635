//! Large functions choose their arithmetic at run time: their bodies stand in implementations of a trait of the runtime,
//! generic over the arithmetic, and the functions themselves call whichever instance suits the processor.

use super::body::write_body;
use super::function::{write_function, write_head};
use super::instruction::Build;
use super::interface::{ALLOW, Head};
use super::lanes;
use super::signature::{Signature, filled};
use crate::derive::Function;
use crate::machine::DISPATCHED_OPERATIONS;
use std::fmt::Write;

/// Most operations of a function that has a body of its own for debug builds: both are read by the compiler, whichever it
/// takes.
const LARGEST: usize = 5000;

/// The bodies of a type's functions that choose.
pub struct Bodies {
    /// There are any.
    wanted: bool,
    list: Vec<Body>,
}

struct Body {
    /// The types of the arguments, a tuple.
    types: String,
    /// Their names.
    names: String,
    result: String,
    /// It takes several states at once.
    simd: bool,
    text: String,
    /// For debug builds.
    debug: Option<String>,
}

/// True for a function that chooses. What calls others multiplies their matrices.
fn is_large(f: &Function) -> bool {
    // One that calls the one that is given matrices does no more.
    filled(f).is_none() && (f.shape.calls() || f.program.instructions.len() >= DISPATCHED_OPERATIONS)
}

impl Bodies {
    /// None so far, and none ever if they are not wanted.
    pub fn new(wanted: bool) -> Bodies {
        Bodies { wanted, list: Vec::new() }
    }

    /// Writes a function; its body stays here if it is large.
    pub fn write_function(&mut self, out: &mut String, f: &Function, s: &Signature<'_>) {
        // A function of several states does what that of one state does, whatever its lanes.
        if !self.wanted || !is_large(f) {
            return write_function(out, f, s, false);
        }
        let types: Vec<String> = f.arguments.iter().map(|a| s.argument(*a)).collect();
        let names: Vec<&str> = f.arguments.iter().map(|a| a.name()).collect();
        let tuple = |list: String| if list.is_empty() { "()".to_string() } else { format!("({list},)") };
        let (types, names) = (tuple(types.join(", ")), tuple(names.join(", ")));
        write_head(out, f, s);
        let _ = writeln!(
            out,
            "::linkwork::__private::dispatch::<{}, {}, _, _>(self, {names})\n}}",
            self.list.len(),
            s.scalar.one()
        );
        let mut text = String::new();
        write_body(&mut text, f, s, true, Build::Optimised);
        let debug = match s.scalar.is_in_lanes() {
            true => lanes::one_by_one(f),
            // What calls others multiplies their matrices.
            false if f.shape.calls() || f.program.instructions.len() > LARGEST => None,
            false => {
                let mut text = String::new();
                write_body(&mut text, f, s, true, Build::Debug);
                Some(text)
            }
        };
        self.list.push(Body { types, names, result: s.result(f), simd: s.scalar.is_in_lanes(), text, debug });
    }

    /// Writes the bodies of the functions of a type of this name.
    pub fn write(&self, out: &mut String, name: &str, head: &Head) {
        let Head { generics, arguments, bounds } = head;
        for (k, body) in self.list.iter().enumerate() {
            let Body { types, names, result, text, debug, .. } = body;
            let own =
                generics.trim().trim_start_matches('<').trim_end_matches('>').trim().trim_end_matches(',');
            let lanes = if body.simd { "const LANES: usize" } else { "" };
            let comma = if own.is_empty() || lanes.is_empty() { "" } else { ", " };
            let _ = writeln!(
                out,
                "{ALLOW}#[doc(hidden)]\nimpl<{own}{comma}{lanes}> ::linkwork::__private::Evaluate<{k}, {types}> for {name}{arguments} {bounds} {{
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
