//! Python module that compiles and launches the CUDA kernels.

use super::super::signatures::python_array_list;
use super::Kernels;
use std::fmt::Write;

/// Returns the text of the Python module that launches the kernels.
pub fn python_module(kernels: &Kernels<'_>) -> String {
    let format_name_list = |list: &[String]| {
        let quoted: Vec<String> = list.iter().map(|name| format!("{name:?}")).collect();
        format!("[{}]", quoted.join(", "))
    };
    let mut all = String::new();
    for f in &kernels.functions {
        let frame = if f.of_frame { "True" } else { "False" };
        let _ = writeln!(
            all,
            "    {:?}: ({frame}, {}, {}),",
            f.name,
            python_array_list(&f.arguments),
            python_array_list(&f.results)
        );
    }
    include_str!("templates/cuda.py")
        .replace("@PREFIX@", &kernels.i.prefix)
        .replace("@SCALAR@", kernels.scalar)
        .replace("@PARAMETERS@", &format_name_list(&kernels.i.parameters))
        .replace("@TABLES@", &format_name_list(&kernels.i.tables))
        .replace("    # @FUNCTIONS@\n", &all)
}
