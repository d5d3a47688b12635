//! C++ functions that launch the CUDA kernels.

use super::super::signatures::ExportedSignature;
use super::Kernels;
use std::fmt::Write;

/// Returns the text of the header that launches the kernels.
pub fn header_text(kernels: &Kernels<'_>) -> String {
    let p = &kernels.i.prefix;
    let upper = p.to_ascii_uppercase();
    let mut text = include_str!("templates/launch.cuh").replace("@PREFIX@", p).replace("@UPPER@", &upper);
    kernels.functions.iter().for_each(|f| write_launch_function(&mut text, kernels, f));
    text.push_str("#endif\n");
    text
}

/// Writes the function that launches a kernel, with its documentation.
fn write_launch_function(text: &mut String, kernels: &Kernels<'_>, f: &ExportedSignature) {
    let p = &kernels.i.prefix;
    let upper = p.to_ascii_uppercase();
    let _ = writeln!(text, "{}", kernels.kernel_preprocessor_condition(f));
    text.push_str(&f.function_comment(&f.results));
    let mut declared = vec!["long long states".to_string()];
    let mut passed = vec!["states".to_string()];
    let view_declaration_and_values = |kind: &str, name: &str| {
        (format!("lw_view<{kind}> {name}"), format!("{name}.at, {name}.entry_of(states), {name}.state"))
    };
    if kernels.i.takes_parameter_struct() {
        let (argument, values) = view_declaration_and_values("const double", "parameters");
        declared.push(argument);
        passed.push(values);
    }
    for name in &kernels.i.tables {
        declared.push(format!("{p}_device::{p}_table table_{name}"));
        passed.push(format!("table_{name}"));
    }
    if f.of_frame {
        declared.push("int frame".to_string());
        passed.push("frame".to_string());
    }
    let arguments = f.arguments.iter().map(|a| view_declaration_and_values("const double", &a.name));
    for (argument, values) in
        arguments.chain(f.results.iter().map(|a| view_declaration_and_values("double", &a.name)))
    {
        declared.push(argument);
        passed.push(values);
    }
    let check = match f.of_frame {
        true => {
            format!("    if (frame < 0 || frame >= {upper}_FRAMES) {{\n        return LW_INVALID;\n    }}\n")
        }
        false => String::new(),
    };
    let _ = writeln!(
        text,
        "inline lw_error {p}_{0}_batch({1}, lw_stream stream = 0) {{\n{check}    LW_LAUNCH({p}_{0}_kernel, \
         {2});\n}}\n#endif\n",
        f.name,
        declared.join(", "),
        passed.join(", ")
    );
}
