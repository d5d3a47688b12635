//! C code of the functions on the configuration manifold: `integrate`, `difference`, `tangent_rate` and their
//! derivatives.

use super::batch::{Array, Batch};
use super::docs;
use super::function::Outline;
use super::in_speeds;
use super::support::Support;
use crate::mechanism::Chart;
use std::fmt::Write;

/// Names, arguments and documentation of the C functions `integrate`, `difference` and `tangent_rate`.
const MANIFOLD: [(&str, [&str; 2], &str); 3] = [
    (
        "integrate",
        ["q", "dv"],
        "The configuration that is reached from `q` with the constant velocity `dv` in one unit of time, \
         with normalised quaternions. The result may be stored in `q`.",
    ),
    (
        "difference",
        ["from", "to"],
        "The velocity that leads from one configuration to another in one unit of time.",
    ),
    ("tangent_rate", ["dv", "v"], "Rate of `dv` for which `integrate(q, dv)` moves with velocity `v`."),
];

pub fn self_parameter(o: &Outline<'_>) -> String {
    if o.has_own() { format!("const {} *self, ", o.prefix) } else { String::new() }
}

fn manifold_signature(o: &Outline<'_>, name: &str, [a, b]: [&str; 2]) -> String {
    let own = self_parameter(o);
    format!("void {}_{name}({own}const double *{a}, const double *{b}, double *result)", o.prefix)
}

/// Returns the signatures of the functions on the configuration manifold.
pub fn manifold_batches(o: &Outline<'_>) -> Vec<Batch> {
    if o.speeds {
        return in_speeds::space_batches(o);
    }
    let length_of_argument = |name: &str| if ["q", "from", "to"].contains(&name) { o.nq } else { o.nv };
    let plain = MANIFOLD.iter().map(|(name, arguments, docs)| {
        let result = if *name == "integrate" { o.nq } else { o.nv };
        let arguments = arguments.map(|argument| (argument, length_of_argument(argument)));
        Batch {
            docs: vec![docs.to_string()],
            ..Batch::vector_signature(name, &arguments, &[("result", result)])
        }
    });
    let derivatives = TO_FIRST_ORDER.iter().filter(|_| o.derivatives).map(|of| {
        let arguments: Vec<_> = of.arguments.iter().map(|name| (*name, o.nv)).collect();
        let mut batch = Batch::vector_signature(&format!("{}_derivatives", of.name), &arguments, &[]);
        batch.results = of.results.iter().map(|name| Array::matrix_array(name, o.nv, o.nv)).collect();
        Batch { docs: vec![of.docs.to_string()], ..batch }
    });
    plain.chain(derivatives).collect()
}

/// Returns the functions of a configuration space without curved joints, with their bodies; none otherwise.
pub fn bodies_of_plain_charts(charts: &[Chart], o: &Outline<'_>) -> Vec<(Batch, String)> {
    if o.speeds || charts.iter().any(|chart| !matches!(chart, Chart::Plain(..))) {
        return Vec::new();
    }
    let statements_of_charts =
        |batch: &Batch| charts.iter().map(|chart| plain_statement(*chart, &batch.name)).collect();
    manifold_batches(o)
        .into_iter()
        .take(MANIFOLD.len())
        .map(|batch| (batch.clone(), statements_of_charts(&batch)))
        .collect()
}

/// Returns the statement of a function for a plain coordinate.
fn plain_statement(chart: Chart, name: &str) -> String {
    let Chart::Plain(q, v) = chart else { return String::new() };
    match name {
        "integrate" => format!("    result[{q}] = q[{q}] + dv[{v}];\n"),
        "difference" => format!("    result[{v}] = to[{q}] - from[{q}];\n"),
        _ => format!("    result[{v}] = v[{v}];\n"),
    }
}

/// Writes the definitions. With declared generalized speeds, the functions of joint velocities are internal,
/// and the public functions call them.
pub fn write_manifold_definitions(
    out: &mut String,
    charts: &[Chart],
    o: &Outline<'_>,
    support: &mut Support,
) {
    for (name, [a, b], _) in MANIFOLD {
        let mut body = String::new();
        for chart in charts {
            let (kind, q, v) = match *chart {
                Chart::Plain(..) => {
                    body.push_str(&plain_statement(*chart, name));
                    continue;
                }
                Chart::Ball(q, v) => ("ball", q.0, v.0),
                Chart::Free(q, v) => ("free", q.0, v.0),
            };
            support.balls |= kind == "ball";
            support.motions |= kind == "free";
            let [r, x, y] = match name {
                "integrate" => [q, q, v],
                "difference" => [v, q, q],
                _ => [v, v, v],
            };
            let _ = writeln!(body, "    lw_{kind}_{name}({a} + {x}, {b} + {y}, result + {r});");
        }
        let unused = o.silence_unused_arguments(&body, &[], &[a, b, "result"]);
        let _ = match o.speeds {
            true => writeln!(
                out,
                "static {} {{\n{unused}{body}}}\n",
                manifold_signature(o, &of_joints(name), [a, b])
            ),
            false => writeln!(out, "{} {{\n{unused}{body}}}\n", manifold_signature(o, name, [a, b])),
        };
    }
    if o.speeds {
        in_speeds::write_space_definitions(out, charts, o, support);
        return;
    }
    if o.derivatives {
        define_all_derivatives(out, charts, o, support);
    }
}

/// Writes the definitions of the derivatives of the functions on the configuration manifold.
pub fn define_all_derivatives(out: &mut String, charts: &[Chart], o: &Outline<'_>, support: &mut Support) {
    TO_FIRST_ORDER.iter().for_each(|of| define_derivatives(out, of, charts, o, support));
}

/// Derivatives of a function of the configuration manifold: its name, further arguments, names of the
/// results, and the first derivative for plain coordinates.
struct ToFirstOrder {
    name: &'static str,
    arguments: &'static [&'static str],
    results: [&'static str; 2],
    plain: &'static str,
    docs: &'static str,
}

const TO_FIRST_ORDER: [ToFirstOrder; 2] = [
    ToFirstOrder {
        name: "integrate",
        arguments: &["dv"],
        results: ["by_q", "by_dv"],
        plain: "1.0",
        docs: "Derivatives of the result of `integrate` by `q` and `dv`, which are the same for all `q`, \
               with displacements of ball and free joints in body axes: NV by NV each, column by column; \
               identities for plain coordinates.",
    },
    ToFirstOrder {
        name: "tangent_rate",
        arguments: &["dv", "v"],
        results: ["by_dv", "by_v"],
        plain: "0.0",
        docs: "Derivatives of `tangent_rate`: NV by NV each, column by column; zero and the identity for \
               plain coordinates.",
    },
];

fn derivatives_signature(o: &Outline<'_>, of: &ToFirstOrder) -> String {
    let name = if o.speeds { of_joints(of.name) } else { of.name.to_string() };
    let given = of.arguments.iter().map(|name| format!("const double *{name}"));
    let results = of.results.iter().map(|name| format!("double *{name}"));
    let list: Vec<String> = given.chain(results).collect();
    format!("void {}_{name}_derivatives({}{})", o.prefix, self_parameter(o), list.join(", "))
}

fn define_derivatives(
    out: &mut String,
    of: &ToFirstOrder,
    charts: &[Chart],
    o: &Outline<'_>,
    support: &mut Support,
) {
    let [first, second] = of.results;
    let mut body = format!(
        "    for (int k = 0; k < {0} * {0}; ++k) {{\n        {first}[k] = k % {1} == 0 ? {2} : 0.0;\n        \
         {second}[k] = k % {1} == 0 ? 1.0 : 0.0;\n    }}\n",
        o.nv,
        o.nv + 1,
        of.plain
    );
    for chart in charts {
        let Some((kind, at, n)) = curved_joint_block(*chart, support) else { continue };
        let given: Vec<String> = of.arguments.iter().map(|name| format!("{name} + {at}")).collect();
        let _ = writeln!(
            body,
            "    {{\n        double a[{0}], b[{0}];\n        lw_{kind}_{1}_derivatives({2}, a, b);\n        \
             for (int k = 0; k < {0}; ++k) {{\n            const int at = ({at} + k / {n}) * {3} + {at} + k \
             % {n};\n            {first}[at] = a[k];\n            {second}[at] = b[k];\n        }}\n    }}",
            n * n,
            of.name,
            given.join(", "),
            o.nv,
        );
    }
    let names = [of.arguments, &of.results].concat();
    let unused = o.silence_unused_arguments(&body, &[], &names);
    let hidden = if o.speeds { "static " } else { "" };
    let _ = writeln!(out, "{hidden}{} {{\n{unused}{body}}}\n", derivatives_signature(o, of));
}

/// Returns the type of a joint with a curved configuration space, the index of its first velocity, and the
/// number of its velocities. Registers the helpers for its derivatives.
pub fn curved_joint_block(chart: Chart, support: &mut Support) -> Option<(&'static str, usize, usize)> {
    match chart {
        Chart::Plain(..) => None,
        Chart::Ball(_, v) => {
            (support.balls, support.jacobians[0]) = (true, true);
            Some(("ball", v.0, 3))
        }
        Chart::Free(_, v) => {
            (support.motions, support.jacobians[1]) = (true, true);
            Some(("free", v.0, 6))
        }
    }
}

/// Returns the internal name of a function of joint velocities in a mechanism with declared generalized
/// speeds.
fn of_joints(name: &str) -> String {
    format!("joints_{name}")
}

/// Returns the declarations of the functions on the configuration manifold.
pub fn manifold_declarations(o: &Outline<'_>) -> String {
    let mut text = String::new();
    if o.speeds {
        return in_speeds::space_declarations(o);
    }
    for (name, arguments, about) in MANIFOLD {
        text.push_str(&docs::wrap_paragraph(about, "/* ", " * "));
        let _ = writeln!(text, " */\n{};\n", manifold_signature(o, name, arguments));
    }
    for of in TO_FIRST_ORDER.iter().filter(|_| o.derivatives) {
        text.push_str(&docs::wrap_paragraph(of.docs, "/* ", " * "));
        let _ = writeln!(text, " */\n{};\n", derivatives_signature(o, of));
    }
    text
}
