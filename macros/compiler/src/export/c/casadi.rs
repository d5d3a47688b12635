//! Functions with the interface that CasADi loads (`casadi.external`) and acados accepts: an additional
//! source file, which calls the functions of the mechanism.
//!
//! Each function `f` comes with `f_n_in`, `f_sparsity_in`, `f_work` and so on; `jac_f` returns its Jacobians,
//! as blocks of all results with respect to all arguments. Jacobians exist if they are exact: for plain
//! coordinates, without time, and with all parameters fixed. Matrices are dense, or have an empty sparsity
//! pattern if they are always zero.

use super::super::comments::wrap_paragraph;
use super::super::handwritten::METHODS;
use super::super::mechanism::{ExportObstacle, ExportedMechanism};
use super::super::names::replace_invalid_characters;
use super::super::signatures::{ArrayArgument, ExportedSignature};
use super::super::template::TemplateValues;
use super::super::tokens::{c_numeric_literal, contains_word};
use std::fmt::Write;

/// Matrix argument or result, with its size as C expressions.
struct MatrixArgument {
    name: String,
    rows: String,
    columns: String,
    /// Whether the sparsity pattern is dense; otherwise it is empty.
    is_dense: bool,
}

impl MatrixArgument {
    fn from_array(array: &ArrayArgument) -> MatrixArgument {
        let (rows, columns) = (array.rows.to_string(), array.columns.to_string());
        MatrixArgument { name: array.name.clone(), rows, columns, is_dense: true }
    }

    /// Reads `name:rows` of a vector, or `name:rows:columns`. Without columns the pattern is empty.
    fn from_text(text: &str) -> MatrixArgument {
        let mut parts = text.split(':').map(ToString::to_string);
        let mut next_part_or_one = || parts.next().unwrap_or_else(|| "1".to_string());
        let (name, rows, columns) = (next_part_or_one(), next_part_or_one(), next_part_or_one());
        let is_dense = columns != "0";
        MatrixArgument { name, rows, columns: if is_dense { columns } else { "1".to_string() }, is_dense }
    }

    fn length_expression(&self) -> String {
        format!("({}) * ({})", self.rows, self.columns)
    }
}

/// External function in the CasADi source file.
struct CasadiExternalFunction {
    name: String,
    inputs: Vec<MatrixArgument>,
    outputs: Vec<MatrixArgument>,
    /// Number of workspace entries in addition to the entries of the results, as a C expression.
    work: String,
    body: String,
}

/// CasADi source file of a mechanism.
struct CasadiWriter<'a> {
    i: &'a ExportedMechanism<'a>,
    /// Value of each fixed parameter; `None` for a parameter that is an argument.
    fixed: Vec<Option<f64>>,
    template: TemplateValues,
}

/// Returns the text of the CasADi source file; `given` are the values of the fixed parameters.
///
/// # Errors
/// A fixed parameter does not exist.
pub fn casadi_source(i: &ExportedMechanism<'_>, given: &[(String, f64)]) -> Result<String, ExportObstacle> {
    let mut fixed = vec![None; i.model.parameters.len()];
    for (name, value) in given {
        let at = i.model.parameters.iter().position(|known| known == name);
        fixed[at.ok_or_else(|| ExportObstacle::NoParameter(name.clone()))?] = Some(*value);
    }
    let mut w = CasadiWriter { i, fixed, template: TemplateValues::default() };
    w.define_placeholders();
    let mut text = w.template.fill(include_str!("templates/casadi.c"));
    w.external_functions().iter().for_each(|external| w.write_external(&mut text, external));
    Ok(text)
}

impl CasadiWriter<'_> {
    /// Returns true if the Jacobians with respect to all arguments are known.
    fn has_exact_jacobians(&self) -> bool {
        self.i.nq() == self.i.nv() && !self.i.model.time && self.free_parameter_names().is_empty()
    }

    /// Returns true if the state is a vector with respect to which derivatives are taken.
    fn has_vector_state(&self) -> bool {
        self.i.nq() == self.i.nv() && !self.i.model.time && self.i.has_transitions
    }

    /// Returns the names of the parameters that remain arguments of the CasADi functions.
    fn free_parameter_names(&self) -> Vec<&String> {
        let all = self.i.parameters.iter().zip(&self.fixed);
        all.filter(|(_, value)| value.is_none()).map(|(name, _)| name).collect()
    }

    fn define_placeholders(&mut self) {
        let i = self.i;
        let has_function = |name: &str| i.signature(name).is_some();
        let is_plain = i.model.acceleration_forces.is_empty();
        let forces = i.signature("generalized_forces").map(|f| {
            let velocity = format!("x + {}", i.nv());
            let call_argument_of_array = |a: &ArrayArgument| match a.name.as_str() {
                "q" => "x".to_string(),
                "v" => velocity.clone(),
                other => other.to_string(),
            };
            let list: Vec<String> =
                f.arguments.iter().map(call_argument_of_array).chain(["force".to_string()]).collect();
            i.function_call_text("generalized_forces", &list.iter().map(String::as_str).collect::<Vec<_>>())
        });
        let conditions = [
            ("OWN", i.takes_parameter_struct()),
            ("INPUTS", i.nu() > 0 && forces.is_some()),
            ("STATES", self.has_vector_state()),
            ("EXACT", self.has_exact_jacobians()),
            (
                "EXACT_FORWARD",
                self.has_exact_jacobians()
                    && has_function("forward_dynamics")
                    && has_function("forward_dynamics_derivatives"),
            ),
            (
                "EXACT_INVERSE",
                self.has_exact_jacobians()
                    && is_plain
                    && ["inverse_dynamics", "inverse_dynamics_derivatives", "mass_matrix"]
                        .into_iter()
                        .all(has_function),
            ),
        ];
        let values: [(&str, &dyn ToString); 15] = [
            ("NOTES", &self.header_notes()),
            ("TABLES", &self.table_declarations()),
            ("MEMBERS", &self.member_assignments()),
            ("FORCES", &forces.unwrap_or_default()),
            ("OWN_DECLARED", &if i.takes_parameter_struct() { "const struct @PREFIX@ *self, " } else { "" }),
            ("SELF", &if i.takes_parameter_struct() { "&self, " } else { "" }),
            ("T_INPUT", &if i.model.time { "t:1 " } else { "" }),
            ("T", &if i.model.time { "t[0], " } else { "" }),
            ("UPPER", &i.prefix.to_ascii_uppercase()),
            ("PREFIX", &i.prefix),
            ("FREE", &self.free_parameter_names().len()),
            ("NQ", &i.nq()),
            ("N", &i.nv()),
            ("M", &i.nu()),
            ("X", &(2 * i.nv())),
        ];
        values.iter().for_each(|(name, value)| self.template.add_value(name, *value));
        conditions.iter().for_each(|(name, holds)| self.template.add_condition(name, *holds));
    }

    fn header_notes(&self) -> String {
        let mut lines: Vec<String> = Vec::new();
        if !self.has_exact_jacobians() {
            let why = match (self.i.model.time, self.i.nq() == self.i.nv()) {
                (true, _) => "the equations contain time",
                (_, false) => {
                    "configurations with quaternions have more entries than degrees of freedom; the \
                     transitions of steps have Jacobians along displacements"
                }
                _ => "parameters are arguments; fix them by --set NAME=VALUE",
            };
            lines.push(format!("Functions jac_… with exact Jacobians are not there: {why}."));
        }
        if self.has_vector_state() {
            lines.push(
                "For acados: …_expl_ode_fun, …_expl_vde_forw, …_expl_vde_adj, and by the classical method of \
                 Runge and Kutta …_dyn_disc_phi_fun and …_dyn_disc_phi_fun_jac, with x = (q, v); p holds the \
                 length of the step (only for disc), then the parameters that are not fixed."
                    .to_string(),
            );
        }
        lines.iter().map(|line| format!(" *\n{}", wrap_paragraph(line, " * ", " * "))).collect()
    }

    /// Returns the declarations of the tables, which the program defines.
    fn table_declarations(&self) -> String {
        let p = &self.i.prefix;
        let table_declaration = |table: &String| {
            format!("/* A table, which the program defines. */\nextern const {p}_table {p}_{table};\n\n")
        };
        self.i.tables.iter().map(table_declaration).collect()
    }

    /// Returns the assignments that fill the parameter struct from fixed values and arguments.
    fn member_assignments(&self) -> String {
        let mut text = String::new();
        let mut next = 0;
        for (member, value) in self.i.parameters.iter().zip(&self.fixed) {
            let value = value.map(c_numeric_literal).unwrap_or_else(|| {
                next += 1;
                format!("given ? given[{}] : 0.0", next - 1)
            });
            let _ = writeln!(text, "    self.{member} = {value};");
        }
        for table in &self.i.tables {
            let _ = writeln!(text, "    self.{table} = {}_{table};", self.i.prefix);
        }
        text
    }

    fn external_functions(&self) -> Vec<CasadiExternalFunction> {
        let public = self.i.public.len();
        let mut all: Vec<CasadiExternalFunction> =
            self.i.functions[..public].iter().map(|f| self.external_from_signature(f)).collect();
        for (method, _) in METHODS.iter().filter(|_| self.i.has_steps) {
            let step = self.i.signature(&format!("{method}_step"));
            all.extend(step.map(|f| self.external_from_signature(f)));
            if self.has_exact_jacobians() && self.i.has_transitions {
                let mut template = TemplateValues::default();
                template.add_value("METHOD", method);
                all.extend(self.template_functions(&template, include_str!("templates/casadi_step.c")));
            }
        }
        for (constant, _) in self.i.frame_names().iter().filter(|_| !self.i.output.frames.is_empty()) {
            let mut template = TemplateValues::default();
            template.add_value("FRAME", constant);
            template.add_value("POINT", &replace_invalid_characters(constant).to_ascii_lowercase());
            all.extend(self.template_functions(&template, include_str!("templates/casadi_position.c")));
        }
        let template = TemplateValues::default();
        all.extend(self.template_functions(&template, include_str!("templates/casadi_functions.c")));
        all
    }

    /// Returns the function that calls a function of the mechanism.
    fn external_from_signature(&self, f: &ExportedSignature) -> CasadiExternalFunction {
        let call_argument_of_array =
            |a: &ArrayArgument| if a.is_value { format!("{}[0]", a.name) } else { a.name.clone() };
        let results = (0..f.results.len()).filter(|_| !f.returns).map(|k| format!("r{k}"));
        let own = self.i.takes_parameter_struct().then(|| "&self".to_string());
        let list: Vec<String> =
            own.into_iter().chain(f.arguments.iter().map(call_argument_of_array)).chain(results).collect();
        let call = format!("{}_{}({});\n", self.i.prefix, f.name, list.join(", "));
        CasadiExternalFunction {
            name: format!("{}_casadi_{}", self.i.prefix, f.name),
            inputs: f.arguments.iter().map(MatrixArgument::from_array).collect(),
            outputs: f.results.iter().map(MatrixArgument::from_array).collect(),
            work: "0".to_string(),
            body: if f.returns { format!("    r0[0] = {call}") } else { format!("    {call}") },
        }
    }

    /// Returns the functions of a template. A line `//// name : inputs -> outputs + work` precedes each body.
    fn template_functions(&self, values: &TemplateValues, text: &str) -> Vec<CasadiExternalFunction> {
        let text = values.fill(&self.template.fill(text));
        let sections = text.split("//// ").filter_map(|section| section.split_once('\n'));
        let parse_external_function = |(head, body): (&str, &str)| {
            let (name, head) = head.split_once(" : ")?;
            let (inputs, outputs) = head.split_once(" -> ")?;
            let (outputs, work) = outputs.split_once(" + ").unwrap_or((outputs, "0"));
            let parse_matrix_arguments =
                |text: &str| text.split_whitespace().map(MatrixArgument::from_text).collect();
            Some(CasadiExternalFunction {
                name: name.to_string(),
                inputs: parse_matrix_arguments(inputs),
                outputs: parse_matrix_arguments(outputs),
                work: work.to_string(),
                body: body.to_string(),
            })
        };
        sections.filter_map(parse_external_function).collect()
    }

    fn write_external(&self, text: &mut String, f: &CasadiExternalFunction) {
        let (name, free) = (&f.name, self.free_parameter_names().len());
        let mut inputs: Vec<&MatrixArgument> = f.inputs.iter().collect();
        let shared = MatrixArgument::from_text(&format!("parameters:{free}"));
        // The last argument of acados' functions contains the parameters, after the length of a step.
        let parameters = match inputs.last() {
            Some(entry) if entry.name == "p" && entry.rows.ends_with("+1") => "p + 1",
            Some(entry) if entry.name == "p" => "p",
            _ if free == 0 => "0",
            _ => {
                inputs.push(&shared);
                "parameters"
            }
        };
        let mut body = String::new();
        for (k, output) in f.outputs.iter().enumerate() {
            let (result, length) = (&output.name, output.length_expression());
            let _ = writeln!(
                body,
                "    casadi_real *r{k} = res[{k}] ? res[{k}] : w; /* {result} */\n    w += {length};"
            );
        }
        for (k, input) in inputs.iter().enumerate().filter(|(_, input)| input.is_dense) {
            let (name, length) = (&input.name, input.length_expression());
            let _ = writeln!(
                body,
                "    static const casadi_real no_{name}[{length} + 1] = {{0}};\n    \
                 const casadi_real *{name} = arg[{k}] ? arg[{k}] : no_{name};"
            );
            if !contains_word(&f.body, name) {
                let _ = writeln!(body, "    (void)({name});");
            }
        }
        if contains_word(&f.body, "extra") {
            body.push_str("    casadi_real *extra = w;\n");
        }
        if self.i.takes_parameter_struct() {
            let _ = writeln!(body, "    const struct {} self = lw_own({parameters});", self.i.prefix);
        }
        let outputs: Vec<&MatrixArgument> = f.outputs.iter().collect();
        let lengths: String =
            outputs.iter().map(|entry| format!("{} + ", entry.length_expression())).collect();
        let _ = writeln!(
            text,
            "int {name}(const casadi_real **arg, casadi_real **res, casadi_int *iw, casadi_real *w, int mem) \
             {{\n    (void)(arg);\n    (void)(iw);\n    (void)(mem);\n{body}{}    (void)(w);\n    return \
             0;\n}}\n\n{}{}EXTERNAL({name}, {}, {}, {lengths}{})\n",
            f.body,
            name_and_sparsity_arrays(name, "in", &inputs),
            name_and_sparsity_arrays(name, "out", &outputs),
            inputs.len(),
            outputs.len(),
            f.work
        );
    }
}

/// Returns the arrays of names and sparsity patterns: rows, columns, and 1 for a dense matrix or the column
/// offsets of an empty one with a single column.
fn name_and_sparsity_arrays(function: &str, side: &str, entries: &[&MatrixArgument]) -> String {
    // Arrays in C have at least one element.
    let join_or_placeholder =
        |all: Vec<String>, none: &str| if all.is_empty() { none.to_string() } else { all.join(", ") };
    let names = entries.iter().map(|entry| format!("\"{}\"", entry.name)).collect();
    let shape_initializer =
        |e: &&MatrixArgument| format!("{{{}, {}, {}, 0}}", e.rows, e.columns, i32::from(e.is_dense));
    format!(
        "static const char *const {function}_names_{side}[] = {{{}}};\nstatic const casadi_int \
         {function}_shapes_{side}[][4] = {{{}}};\n",
        join_or_placeholder(names, "0"),
        join_or_placeholder(entries.iter().map(shape_initializer).collect(), "{0}")
    )
}
