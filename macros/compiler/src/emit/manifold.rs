//! Code generation for functions on the configuration manifold.

use super::signature::SignatureContext;
use crate::mechanism::Chart;
use std::fmt::Write;

/// Writes `integrate`, `difference` and `tangent_rate`, with statements for each joint's coordinate chart.
/// Without `charts`, for a mechanism that failed to compile, their bodies never return.
///
/// With generalized speeds these functions are hidden, and the public functions call them.
pub fn write_manifold(out: &mut String, charts: Option<&[Chart]>, speeds: bool, s: &SignatureContext<'_>) {
    let (q, v) = (s.vector_type(s.nq), s.vector_type(s.nv));
    let new_manifold_function = |kind,
                                 about,
                                 signature: String,
                                 arguments: [(&'static str, usize); 2],
                                 result| {
        ManifoldFunction { kind, about, signature, arguments, result }
    };
    let functions = [
        new_manifold_function(
            ManifoldFunctionKind::Integrate,
            "Returns `q ⊕ dv`: the configuration reached from `q` with the constant velocity `dv` in one \
             unit of time, with normalised quaternions.",
            format!("q: &{q}, dv: &{v}) -> {q}"),
            [("q", s.nq), ("dv", s.nv)],
            s.nq,
        ),
        new_manifold_function(
            ManifoldFunctionKind::Difference,
            "Returns `to ⊖ from`: the constant velocity that leads from one configuration to another in one \
             unit of time, so that `integrate(from, difference(from, to))` is `to`.",
            format!("from: &{q}, to: &{q}) -> {v}"),
            [("from", s.nq), ("to", s.nq)],
            s.nv,
        ),
        new_manifold_function(
            ManifoldFunctionKind::TangentRate,
            "Returns the rate of `dv` for which `q ⊕ dv` moves with velocity `v` (inverse of the derivative \
             of the exponential map).",
            format!("dv: &{v}, v: &{v}) -> {v}"),
            [("dv", s.nv), ("v", s.nv)],
            s.nv,
        ),
    ];
    let prefix = if speeds { "__" } else { "" };
    for function in &functions {
        function.write_manifold_function(out, prefix, charts, s);
    }
    if speeds {
        super::speeds::write_manifold(out, charts.is_none(), s);
    }
}

/// Writes the hidden functions that transport velocities, which contacts need. With generalized speeds there
/// is only `carry`.
pub fn write_velocity_transport_functions(
    out: &mut String,
    charts: Option<&[Chart]>,
    speeds: bool,
    s: &SignatureContext<'_>,
) {
    let v = s.vector_type(s.nv);
    let mut write_transport_function = |kind, about| {
        let function = ManifoldFunction {
            kind,
            about,
            signature: format!("dv: &{v}, v: &{v}) -> {v}"),
            arguments: [("dv", s.nv), ("v", s.nv)],
            result: s.nv,
        };
        function.write_manifold_function(out, "__", charts, s);
    };
    write_transport_function(
        ManifoldFunctionKind::Carry,
        "The velocity `v` in the axes that ball and free joints have after the displacement `dv`.",
    );
    if !speeds {
        write_transport_function(
            ManifoldFunctionKind::CarryRate,
            "The rate of the components of a velocity that is `v`, and constant in space, during a motion \
             with velocity `dv`.",
        );
        write_linear_velocity_selection(out, charts, s);
    }
}

/// Writes the hidden function that selects the linear velocities of free joints.
fn write_linear_velocity_selection(out: &mut String, charts: Option<&[Chart]>, s: &SignatureContext<'_>) {
    let v = s.vector_type(s.nv);
    let _ = writeln!(
        out,
        "#[doc(hidden)]\n/// The part of the displacement `dv` that is linear velocities of free joints.\n\
         #[inline]\n#[must_use]\npub fn __translation{}(&self, dv: &{v}) -> {v} {{",
        s.lanes_suffix_and_generics()
    );
    match charts {
        Some(charts) => {
            let is_linear_velocity_of_free_joint = |k: usize| {
                charts.iter().any(|chart| matches!(chart, Chart::Free(_, v) if (v.0..v.0 + 3).contains(&k)))
            };
            let linear_velocity_or_zero = |k: usize| {
                if is_linear_velocity_of_free_joint(k) { format!("r{k}") } else { "0.0".to_owned() }
            };
            let name =
                |k: usize| if is_linear_velocity_of_free_joint(k) { format!("r{k}") } else { "_".to_owned() };
            let join_velocity_texts =
                |of: &dyn Fn(usize) -> String| (0..s.nv).map(of).collect::<Vec<_>>().join(", ");
            let _ = writeln!(
                out,
                "let [[{}]] = dv.data.0;\n::linkwork::nalgebra::SVector::from_array_storage(\
                 ::linkwork::nalgebra::ArrayStorage([[{}]]))",
                join_velocity_texts(&name),
                join_velocity_texts(&linear_velocity_or_zero)
            );
        }
        None => out.push_str("loop {}\n"),
    }
    out.push_str("}\n");
}

/// Functions on the configuration manifold that treat each joint's coordinate chart separately.
#[derive(Clone, Copy)]
enum ManifoldFunctionKind {
    Integrate,
    Difference,
    TangentRate,
    Carry,
    CarryRate,
}

impl ManifoldFunctionKind {
    /// Returns the name of the generated function.
    fn generated_function_name(self) -> &'static str {
        match self {
            Self::Integrate => "integrate",
            Self::Difference => "difference",
            Self::TangentRate => "tangent_rate",
            Self::Carry => "carry",
            Self::CarryRate => "carry_rate",
        }
    }
}

/// Function on the configuration manifold, as data for code generation.
struct ManifoldFunction {
    kind: ManifoldFunctionKind,
    /// Documentation of the generated function.
    about: &'static str,
    /// Parameters of the function after `&self`, and its result type.
    signature: String,
    /// Names and lengths of the function's arguments.
    arguments: [(&'static str, usize); 2],
    /// Length of the function's result.
    result: usize,
}

impl ManifoldFunction {
    fn write_manifold_function(
        &self,
        out: &mut String,
        prefix: &str,
        charts: Option<&[Chart]>,
        s: &SignatureContext<'_>,
    ) {
        let hidden = if prefix.is_empty() { "" } else { "#[doc(hidden)]\n" };
        let _ = writeln!(
            out,
            "{hidden}/// {}\n#[inline]\n#[must_use]\npub fn {prefix}{}{}(&self, {} {{",
            self.about,
            self.kind.generated_function_name(),
            s.lanes_suffix_and_generics(),
            self.signature
        );
        match charts {
            Some(charts) => self.write_body(out, charts),
            None => out.push_str("loop {}\n"),
        }
        out.push_str("}\n");
    }

    fn write_body(&self, out: &mut String, charts: &[Chart]) {
        let format_name_range = |first: usize, n: usize, name: &str| {
            let list: Vec<String> = (first..first + n).map(|k| format!("{name}{k}")).collect();
            format!("[{}]", list.join(", "))
        };
        for (name, n) in &self.arguments {
            let _ = writeln!(out, "let [{}] = {name}.data.0;", format_name_range(0, *n, name));
        }
        let [(first, _), (second, _)] = self.arguments;
        for chart in charts {
            let (kind, (q, nq), (v, nv)) = match *chart {
                Chart::Plain(q, v) => {
                    let _ = match self.kind {
                        ManifoldFunctionKind::Integrate => writeln!(out, "let r{q} = q{q} + dv{v};"),
                        ManifoldFunctionKind::Difference => writeln!(out, "let r{v} = to{q} - from{q};"),
                        ManifoldFunctionKind::CarryRate => writeln!(out, "let r{v} = 0.0;"),
                        ManifoldFunctionKind::TangentRate | ManifoldFunctionKind::Carry => {
                            writeln!(out, "let r{v} = v{v};")
                        }
                    };
                    continue;
                }
                Chart::Ball(q, v) => ("ball", (q.0, 4), (v.0, 3)),
                Chart::Free(q, v) => ("free", (q.0, 7), (v.0, 6)),
            };
            // Entries of the result and of the two arguments: configurations or velocities.
            let (on_q, on_v) = ((q, nq), (v, nv));
            let (r, a, b) = match self.kind {
                ManifoldFunctionKind::Integrate => (on_q, on_q, on_v),
                ManifoldFunctionKind::Difference => (on_v, on_q, on_q),
                _ => (on_v, on_v, on_v),
            };
            let _ = writeln!(
                out,
                "let {} = ::linkwork::__private::{kind}_{}({}, {});",
                format_name_range(r.0, r.1, "r"),
                self.kind.generated_function_name(),
                format_name_range(a.0, a.1, first),
                format_name_range(b.0, b.1, second)
            );
        }
        let _ = writeln!(
            out,
            "::linkwork::nalgebra::SVector::from_array_storage(::linkwork::nalgebra::ArrayStorage([{}]))",
            format_name_range(0, self.result, "r")
        );
    }
}
