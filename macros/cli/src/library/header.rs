//! C header of an exported library.

use super::{Function, FunctionArgumentKind, LibraryData};
use linkwork_compiler::export::{comment_safe_text, wrap_paragraph};
use std::fmt::Write;

/// Returns the text of the C header of an exported library.
pub fn header_text(known: &LibraryData<'_, '_>) -> String {
    let m = known.model;
    let (prefix, number) = (known.prefix, if known.is_single_precision() { "float" } else { "double" });
    let upper = prefix.to_ascii_uppercase();
    let mut text = format!(
        "/* The mechanism `{}`, compiled by Linkwork: link lib{prefix}.a (with -lpthread -ldl -lm) or load \
         the shared library.\n *\n * SI units, angles in radians. Vectors are arrays, and matrices are \
         stored column by column. Quaternions are stored\n * as x y z w. Functions have no state, and any \
         number of threads may call them. They return 0, or 1 for an\n * error: results are then NaN, and \
         {prefix}_message() returns the reason.\n",
        known.input.declaration.name
    );
    let velocities: Vec<String> = m.velocities.iter().map(|(name, _)| name.clone()).collect();
    let inputs: Vec<String> = m.inputs.iter().map(|(name, _)| name.clone()).collect();
    for (title, names, units) in [
        ("Parameters `own`, which every function takes first", &m.parameters, &m.units.parameters),
        ("Configuration q", &m.configuration, &m.units.configuration),
        (
            "Velocity v; accelerations a and generalized forces tau in the same order",
            &velocities,
            &m.units.velocities,
        ),
        ("Inputs u", &inputs, &m.units.inputs),
    ] {
        if names.is_empty() {
            continue;
        }
        let _ = writeln!(text, " *\n * {title}:");
        for (k, name) in names.iter().enumerate() {
            let unit = units.get(k).map_or("", String::as_str);
            let line = format!(" *   {k:3}  {:30} {}", comment_safe_text(name), comment_safe_text(unit));
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
    let _ = write!(
        text,
        " */\n#ifndef {upper}_LIBRARY_H\n#define {upper}_LIBRARY_H\n\n#include <stddef.h>\n\n#define \
         {upper}_NQ {}\n#define {upper}_NV {}\n#define {upper}_NU {}\n#define {upper}_PARAMETERS {}\n\n\
         #ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n",
        m.nq(),
        m.nv(),
        m.nu(),
        m.parameters.len()
    );
    write_frame_number_enum(&mut text, known, &upper);
    for f in &known.functions {
        write_function_declaration(&mut text, f, known, number);
    }
    write_common_declarations(&mut text, prefix, number, !m.parameters.is_empty());
    text.push_str("#ifdef __cplusplus\n}\n#endif\n\n#endif\n");
    text
}

fn write_frame_number_enum(text: &mut String, known: &LibraryData<'_, '_>, upper: &str) {
    if known.model.frames.is_empty() {
        return;
    }
    let spoken: Vec<String> = known.model.frames.iter().map(|frame| frame.name.clone()).collect();
    let names = linkwork_compiler::export::unique_constant_suffixes(&spoken);
    text.push_str("/* Frames by number. */\nenum {\n");
    for (k, (name, says)) in names.iter().zip(&spoken).enumerate() {
        let comma = if k + 1 < names.len() { "," } else { "" };
        let _ = writeln!(text, "    {upper}_FRAME_{name} = {k}{comma} /* {} */", comment_safe_text(says));
    }
    text.push_str("};\n\n");
}

fn write_function_declaration(text: &mut String, f: &Function, known: &LibraryData<'_, '_>, number: &str) {
    let nv = known.model.nv();
    let (mut docs, errors) = super::functions::docs_without_rust_notation(&f.docs);
    if !errors.is_empty() {
        docs.push(format!("Returns 1 {errors}"));
    }
    for (k, paragraph) in docs.iter().enumerate() {
        let first = if k == 0 { "/* " } else { " * " };
        text.push_str(&wrap_paragraph(paragraph, first, " * "));
    }
    text.push_str(if docs.is_empty() { "/*\n" } else { " *\n" });
    for (name, kind) in &f.arguments {
        let about = match kind {
            FunctionArgumentKind::Number => continue,
            FunctionArgumentKind::Frame => format!("one of {}_FRAME_…", known.prefix.to_ascii_uppercase()),
            FunctionArgumentKind::Marks => format!("{nv} numbers, nonzero for each selected velocity"),
            FunctionArgumentKind::Matrix(..) => format!("{} numbers", Function::argument_length(kind, nv)),
        };
        let _ = writeln!(text, " * {name:12} {about}");
    }
    for (name, shape) in &f.results {
        let about = match shape.as_slice() {
            [] => "a number".to_string(),
            [n] => format!("{n} numbers"),
            [rows, columns] => format!("{rows} by {columns}, column by column"),
            [count, rows, columns] => format!("{count} of {rows} by {columns}, column by column"),
            _ => continue,
        };
        let _ = writeln!(text, " * to_{name:9} out: {about}");
    }
    let own = (!known.model.parameters.is_empty()).then(|| format!("const {number} *own"));
    let given = f.arguments.iter().map(|(name, kind)| match kind {
        FunctionArgumentKind::Number => format!("{number} {name}"),
        FunctionArgumentKind::Frame => format!("int {name}"),
        _ => format!("const {number} *{name}"),
    });
    let wanted = f.results.iter().map(|(name, _)| format!("{number} *to_{name}"));
    let list: Vec<String> = own.into_iter().chain(given).chain(wanted).collect();
    let _ = writeln!(text, " */\nint {}_{}({});\n", known.prefix, f.name, list.join(", "));
}

fn write_common_declarations(text: &mut String, prefix: &str, number: &str, has_parameters: bool) {
    if has_parameters {
        let _ = write!(
            text,
            "/* Returns 0 if the parameters are valid, else 1. */
int {prefix}_validate(const {number} *own);

/* Writes the parameters that a robot file defines; others are NaN. */
void {prefix}_defaults({number} *to_own);

"
        );
    }
    let _ = write!(
        text,
        "/* Returns why the last call of this thread returned 1; the text is valid until the next call. */
const char *{prefix}_message(void);

/* Returns names, shapes, units and documentation as JSON, with functions in the order of their indices. */
const char *{prefix}_description(void);

/* Calls the function with an index for many states. Each argument and each result is an array with the values
 * of the first state, then those of the second, and so on. The states are distributed over `threads` threads,
 * or over one for each processor if it is 0. All states have the same parameters. */
int {prefix}_call(size_t function, const {number} *own, const {number} *const *arguments,
                  {number} *const *results, size_t states, size_t threads);

/* Controller: writes the inputs u at the time t, s. Returns 0, or another value to end the simulation. */
typedef int (*{prefix}_control)(void *user, {number} t, const {number} *q, const {number} *v, {number} *u);

typedef struct {prefix}_settings {{
    {number} start;    /* time at the start, s */
    {number} duration; /* s */
    {number} interval; /* time between samples, s */
    /* With a tolerance: \"dormand_prince\", \"dormand_prince8\", \"rodas\" (stiff), with contacts
     * \"event_driven\". With a step: \"rk4\", \"implicit_midpoint\", with contacts \"time_stepping\",
     * \"time_stepping_midpoint\", \"time_stepping_leapfrog\". */
    const char *method;
    {number} setting;  /* tolerance, or step in s */
    {number} period;   /* period of the controller, s; 0 to call it at each evaluation of the dynamics */
    {prefix}_control control; /* NULL for inputs that are zero */
    void *user;        /* first argument of the controller */
}} {prefix}_settings;

/* Simulates, and writes at most `rows` rows of t, q, v, u, and their number to to_count. */
int {prefix}_simulate(const {number} *own, const {number} *q, const {number} *v,
                      const {prefix}_settings *settings, {number} *to_samples, size_t rows,
                      size_t *to_count);

typedef struct {prefix}_rollout {{
    {number} start;  /* time at the start, s */
    {number} step;   /* step of the classical Runge-Kutta method, s */
    size_t steps;
    size_t states;
    size_t threads;  /* 0 for one thread for each processor */
    int inputs_of;   /* 0: the inputs are zero; 1: inputs of each step, equal for all states;
                      * 2: inputs of each state and step */
}} {prefix}_rollout;

/* Simulates many states with inputs that are constant during each step. to_q and to_v contain steps + 1
 * configurations and velocities for each state: the first one is the start, and the others are written.
 * Inputs are ordered by state, then by step. */
int {prefix}_roll_out(const {number} *own, const {prefix}_rollout *settings, const {number} *inputs,
                      {number} *to_q, {number} *to_v);

"
    );
}
