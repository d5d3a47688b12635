//! How generated functions are spelt: their arguments, their results, and what stands around their bodies.

use super::body::write_body;
use super::instruction::Build;
use super::signature::{Signature, given};
use crate::derive::Function;
use std::fmt::Write;

/// Writes what stands before a function's body, with the brace.
pub fn write_head(out: &mut String, f: &Function, s: &Signature<'_>) {
    if f.docs.is_empty() {
        out.push_str("#[doc(hidden)]\n");
    }
    if !f.docs.is_empty() {
        let _ = writeln!(out, "#[doc = {:?}]", format!(" {}", f.docs.join("\n\n ")));
    }
    let result = s.result(f);
    // What goes into given matrices may be all that is wanted.
    let must_use = if given(f).is_empty() { "#[must_use]\n" } else { "" };
    let _ = writeln!(
        out,
        "#[inline]\n{must_use}pub fn {}{}({}) -> {result} {{",
        f.name,
        s.generics(),
        s.parameters(&f.arguments),
    );
}

/// Writes a function; without a program its body never returns, for a mechanism that failed to compile.
pub fn write_function(out: &mut String, f: &Function, s: &Signature<'_>, stub: bool) {
    write_head(out, f, s);
    if stub {
        out.push_str("loop {}\n");
    } else {
        write_body(out, f, s, false, Build::Optimised);
    }
    out.push_str("}\n");
}
