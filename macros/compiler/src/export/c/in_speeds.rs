//! Functions of the configuration manifold in declared generalized speeds. They call internal functions of
//! joint velocities, as in Rust.

use super::batch::{Array, Batch};
use super::docs;
use super::function::Outline;
use super::manifold::{self, self_parameter};
use super::support::Support;
use crate::mechanism::Chart;
use std::fmt::Write;

/// Function of the configuration manifold: name, arguments, results and documentation.
struct Space {
    name: &'static str,
    arguments: &'static [&'static str],
    results: &'static [&'static str],
    docs: &'static str,
}

const SPACE: [Space; 3] = [
    Space {
        name: "integrate",
        arguments: &["q", "dv"],
        results: &["result"],
        docs: "The configuration that is reached from `q` in one unit of time with the constant joint \
               velocities to which the generalized speeds `dv` correspond at `q`, with normalised \
               quaternions. The result may be stored in `q`.",
    },
    Space {
        name: "difference",
        arguments: &["from", "to"],
        results: &["result"],
        docs: "The generalized speeds, at `from`, that lead from one configuration to another in one unit of \
               time.",
    },
    Space {
        name: "displacement_rate",
        arguments: &["q", "dv", "v"],
        results: &["result"],
        docs: "Rate of `dv` for which `integrate(q, dv)` moves with the speeds `v`, from `q`.",
    },
];

const TO_FIRST_ORDER: [Space; 2] = [
    Space {
        name: "integrate_derivatives",
        arguments: &["q", "dv"],
        results: &["by_q", "by_dv"],
        docs: "Derivatives of the result of `integrate` by `q` and `dv`, in generalized speeds at the \
               result: NV by NV each, column by column.",
    },
    Space {
        name: "displacement_rate_derivatives",
        arguments: &["q", "dv", "v"],
        results: &["by_q", "by_dv", "by_v"],
        docs: "Derivatives of `displacement_rate`: NV by NV each, column by column.",
    },
];

fn space_functions(o: &Outline<'_>) -> impl Iterator<Item = &'static Space> {
    let derivatives: &[Space] = if o.derivatives { &TO_FIRST_ORDER } else { &[] };
    SPACE.iter().chain(derivatives)
}

/// Returns the signatures of the functions on the configuration space in generalized speeds.
pub fn space_batches(o: &Outline<'_>) -> Vec<Batch> {
    let batch_of_space = |of: &Space| {
        let length_of_argument = |name: &str| if ["q", "from", "to"].contains(&name) { o.nq } else { o.nv };
        let arguments: Vec<_> = of.arguments.iter().map(|name| (*name, length_of_argument(name))).collect();
        let result_array = |name: &&str| match (of.name, *name) {
            ("integrate", name) => Array::new(name, o.nq),
            (_, "result") => Array::new("result", o.nv),
            (_, name) => Array::matrix_array(name, o.nv, o.nv),
        };
        let results = of.results.iter().map(result_array).collect();
        Batch {
            results,
            docs: vec![of.docs.to_string()],
            ..Batch::vector_signature(of.name, &arguments, &[])
        }
    };
    space_functions(o).map(batch_of_space).collect()
}

fn space_signature(o: &Outline<'_>, of: &Space) -> String {
    let given = of.arguments.iter().map(|name| format!("const double *{name}"));
    let results = of.results.iter().map(|name| format!("double *{name}"));
    let list: Vec<String> = given.chain(results).collect();
    format!("void {}_{}({}{})", o.prefix, of.name, self_parameter(o), list.join(", "))
}

/// Returns the declarations of the functions on the configuration space in generalized speeds.
pub fn space_declarations(o: &Outline<'_>) -> String {
    let mut text = String::new();
    for of in space_functions(o) {
        text.push_str(&docs::wrap_paragraph(of.docs, "/* ", " * "));
        let _ = writeln!(text, " */\n{};\n", space_signature(o, of));
    }
    text
}

/// Writes the definitions of the functions on the configuration space in generalized speeds.
pub fn write_space_definitions(out: &mut String, charts: &[Chart], o: &Outline<'_>, support: &mut Support) {
    if o.derivatives {
        support.sums = true;
        manifold::define_all_derivatives(out, charts, o, support);
        out.push_str(&fill_template(include_str!("templates/products_of_squares.c"), o));
    }
    for of in space_functions(o) {
        let body = match of.name {
            "integrate" => include_str!("templates/integrate_in_speeds.c"),
            "difference" => include_str!("templates/difference_in_speeds.c"),
            "displacement_rate" => include_str!("templates/rate_in_speeds.c"),
            "integrate_derivatives" => include_str!("templates/integrate_derivatives_in_speeds.c"),
            _ => include_str!("templates/rate_derivatives_in_speeds.c"),
        };
        let _ = writeln!(out, "{} {{\n{}}}\n", space_signature(o, of), fill_template(body, o));
    }
}

fn fill_template(template: &str, o: &Outline<'_>) -> String {
    let own = if o.has_own() { "self, " } else { "" };
    template
        .replace("@PREFIX@", &o.prefix)
        .replace("@OWN@", own)
        .replace("@NQ@", &o.nq.max(1).to_string())
        .replace("@NV@", &o.nv.max(1).to_string())
}
