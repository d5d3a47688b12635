//! Conversion of C code to functions of a CUDA device: function templates, whose arrays are pointers, or the
//! strided entries of one state.

/// Prefixes of lines of C code that may begin a function definition.
const KINDS: [&str; 5] = ["static inline ", "static ", "void ", "double ", "int "];

/// Converts definitions in C to device functions. Comments and statements do not change, except declarations
/// of pointers.
pub fn convert_to_device_functions(code: &str) -> String {
    let mut out = String::with_capacity(code.len() + code.len() / 8);
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        if let Some(table) = line.strip_prefix("static const int lw_") {
            out.push_str("LW_TABLE const int lw_");
            out.push_str(table);
        } else if KINDS.iter().any(|kind| line.starts_with(kind)) && line.contains('(') {
            let mut head = line.to_string();
            while !head.ends_with('{') {
                let Some(next) = lines.next() else { break };
                head.push(' ');
                head.push_str(next.trim_start());
            }
            out.push_str(&convert_function_head(&head));
        } else {
            out.push_str(&convert_statement(line));
        }
        out.push('\n');
    }
    out
}

/// Converts the first line of a function definition. Each array becomes an argument of a type parameter.
fn convert_function_head(head: &str) -> String {
    let plain = KINDS[..2].iter().fold(head, |head, kind| head.strip_prefix(kind).unwrap_or(head));
    let Some((name, rest)) = plain.split_once('(') else { return head.to_string() };
    let list = rest.rsplit_once(')').map_or(rest, |(list, _)| list);
    let mut types = Vec::new();
    let mut arguments = Vec::new();
    for argument in list.split(", ").filter(|argument| *argument != "void") {
        match array_argument_name(argument) {
            Some(array) => {
                let kind = format!("T{}", types.len());
                arguments.push(format!("{kind} {array}"));
                types.push(format!("class {kind}"));
            }
            None => arguments.push(argument.to_string()),
        }
    }
    let template = if types.is_empty() { String::new() } else { format!("template <{}> ", types.join(", ")) };
    format!("{template}LW_DEVICE {name}({}) {{", arguments.join(", "))
}

/// Returns the name of an argument that is an array of numbers.
fn array_argument_name(argument: &str) -> Option<&str> {
    let plain = argument.strip_prefix("const ").unwrap_or(argument).strip_prefix("double ")?;
    match plain.strip_prefix('*') {
        Some(name) => Some(name),
        None => plain.split_once('[').map(|(name, _)| name),
    }
}

/// Converts a line of a function body: pointers into arrays, and results that are always zero.
fn convert_statement(line: &str) -> String {
    let text = line.trim_start();
    let indent = &line[..line.len() - text.len()];
    let is_zero = text.strip_suffix("] = 0.0;").filter(|place| !place.contains(' '));
    if let Some(place) = is_zero.filter(|_| indent.len() == 4) {
        return format!("{indent}{place}] = lw_zero();");
    }
    for pointer in ["const double *", "double *"] {
        if let Some(rest) = text.strip_prefix(pointer) {
            return format!("{indent}auto {rest}");
        }
    }
    line.to_string()
}

#[cfg(test)]
mod tests {
    use super::convert_to_device_functions;

    #[test]
    fn c_functions_become_cuda_templates() {
        let code = "static const int lw_of[2] = {0, 1};\nstatic void lw_x(int n, const double *a, double \
                    b[3],\n    double *c) {\n    double *d = c + 1;\n    d[2] = 0.0;\n}\nvoid p_y(void) {\n\
                    }\n";
        assert_eq!(
            convert_to_device_functions(code),
            "LW_TABLE const int lw_of[2] = {0, 1};\ntemplate <class T0, class T1, class T2> LW_DEVICE void \
             lw_x(int n, T0 a, T1 b, T2 c) {\n    auto d = c + 1;\n    d[2] = lw_zero();\n}\nLW_DEVICE void \
             p_y() {\n}\n"
        );
    }
}
