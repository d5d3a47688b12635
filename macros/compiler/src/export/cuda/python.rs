//! Module for Python that compiles and launches the kernels.

use super::{Array, Kernels};
use std::fmt::Write;

/// Returns the module.
pub fn text(kernels: &Kernels<'_>) -> String {
    let parts = kernels.parts;
    let names = |list: &[String]| {
        let quoted: Vec<String> = list.iter().map(|name| format!("{name:?}")).collect();
        format!("[{}]", quoted.join(", "))
    };
    let arrays = |list: &[Array]| {
        let entries: Vec<String> = list.iter().map(|a| format!("({:?}, {})", a.name, a.length)).collect();
        format!("[{}]", entries.join(", "))
    };
    let mut all = String::new();
    for f in &kernels.functions {
        let frame = if f.of_frame { "True" } else { "False" };
        let _ =
            writeln!(all, "    {:?}: ({frame}, {}, {}),", f.name, arrays(&f.arguments), arrays(&f.results));
    }
    include_str!("templates/cuda.py")
        .replace("@PREFIX@", &parts.prefix)
        .replace("@SCALAR@", kernels.scalar)
        .replace("@PARAMETERS@", &names(&parts.parameters))
        .replace("@TABLES@", &names(&parts.tables))
        .replace("    # @FUNCTIONS@\n", &all)
}
