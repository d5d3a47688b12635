//! Python module that compiles and launches the CUDA kernels.

use super::{Array, Kernels};
use std::fmt::Write;

/// Returns the text of the Python module that launches the kernels.
pub fn python_module(kernels: &Kernels<'_>) -> String {
    let parts = kernels.parts;
    let format_name_list = |list: &[String]| {
        let quoted: Vec<String> = list.iter().map(|name| format!("{name:?}")).collect();
        format!("[{}]", quoted.join(", "))
    };
    let format_array_list = |list: &[Array]| {
        let entries: Vec<String> = list.iter().map(|a| format!("({:?}, {})", a.name, a.length)).collect();
        format!("[{}]", entries.join(", "))
    };
    let mut all = String::new();
    for f in &kernels.functions {
        let frame = if f.of_frame { "True" } else { "False" };
        let _ = writeln!(
            all,
            "    {:?}: ({frame}, {}, {}),",
            f.name,
            format_array_list(&f.arguments),
            format_array_list(&f.results)
        );
    }
    include_str!("templates/cuda.py")
        .replace("@PREFIX@", &parts.prefix)
        .replace("@SCALAR@", kernels.scalar)
        .replace("@PARAMETERS@", &format_name_list(&parts.parameters))
        .replace("@TABLES@", &format_name_list(&parts.tables))
        .replace("    # @FUNCTIONS@\n", &all)
}
