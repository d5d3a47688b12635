//! Definitions of generated functions: attributes, signature and body.

use super::body::write_body;
use super::instruction::BuildKind;
use super::signature::{SignatureContext, result_matrix_names};
use crate::derive::Function;
use std::fmt::Write;

/// Writes a function's attributes and its signature up to the opening brace.
pub fn write_function_head(out: &mut String, f: &Function, s: &SignatureContext<'_>) {
    if f.docs.is_empty() {
        out.push_str("#[doc(hidden)]\n");
    }
    if !f.docs.is_empty() {
        let _ = writeln!(out, "#[doc = {:?}]", format!(" {}", f.docs.join("\n\n ")));
    }
    let result = s.result_type(f);
    // The caller may need only the matrix arguments and ignore the result.
    let must_use = if result_matrix_names(f).is_empty() { "#[must_use]\n" } else { "" };
    let _ = writeln!(
        out,
        "#[inline]\n{must_use}pub fn {}{}({}) -> {result} {{",
        f.name,
        s.lanes_suffix_and_generics(),
        s.parameter_list(&f.arguments),
    );
}

/// Writes a function. The body of a stub, for a mechanism that failed to compile, never returns.
pub fn write_function(out: &mut String, f: &Function, s: &SignatureContext<'_>, stub: bool) {
    write_function_head(out, f, s);
    if stub {
        out.push_str("loop {}\n");
    } else {
        write_body(out, f, s, false, BuildKind::Optimised);
    }
    out.push_str("}\n");
}
