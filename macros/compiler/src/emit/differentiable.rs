//! Implementations of the runtime's traits of derivatives, and the functions that do not result from the
//! equations of motion: derivatives on the configuration space and those of the forces of inputs.

use super::interface::Interface;
use super::signature::SignatureContext;
use crate::catalogue::{Argument, GeneratedId, Shape};
use crate::derive::Function;
use crate::lower::Operand;
use crate::mechanism::Chart;
use std::fmt::Write;

/// Writes the derivatives of the functions on the configuration space and of the forces of inputs. Without
/// `charts`, for a mechanism that failed to compile, the bodies never return.
pub fn write_configuration_and_input_derivatives(
    out: &mut String,
    charts: Option<&[Chart]>,
    functions: &[Function],
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    if !i.facts.requests.derivatives {
        return;
    }
    let direct = functions
        .iter()
        .find(|f| f.id == GeneratedId::InputDerivatives)
        .and_then(|f| velocity_driven_by_each_input(f, s));
    let _ = writeln!(
        out,
        "#[doc(hidden)]\npub const __DIRECT_INPUTS: ::core::option::Option<[usize; {}]> = {};",
        s.nu,
        direct.map_or("::core::option::Option::None".to_string(), |all| format!(
            "::core::option::Option::Some({all:?})"
        ))
    );
    let turned =
        charts.filter(|_| !i.facts.speeds).map_or("::core::option::Option::None".to_string(), |charts| {
            let (first, end) = rotational_velocity_range(charts);
            format!("::core::option::Option::Some(({first}, {end}))")
        });
    let _ = writeln!(
        out,
        "#[doc(hidden)]\npub const __TURNED: ::core::option::Option<(usize, usize)> = {turned};"
    );
    let (v, square) = (s.vector_type(s.nv), s.shape_type(Shape::Square(s.nv)));
    for (name, about, arguments, first) in [
        (
            "integrate",
            "Returns the derivatives `(∂/∂q, ∂/∂dv)` of [`integrate`](Self::integrate), `q ⊕ dv`, which are \
             the same for all `q`. Displacements of ball and free joints are in body axes. The derivatives \
             are identities for plain coordinates.",
            format!("dv: &{v}"),
            "identity",
        ),
        (
            "tangent_rate",
            "Returns the derivatives `(∂/∂dv, ∂/∂v)` of [`tangent_rate`](Self::tangent_rate): zero and the \
             identity for plain coordinates.",
            format!("dv: &{v}, v: &{v}"),
            "zeros",
        ),
    ] {
        let (hidden, prefix) = if i.facts.speeds { ("#[doc(hidden)]\n", "__") } else { ("", "") };
        let _ = writeln!(
            out,
            "{hidden}/// {about}\n#[inline]\n#[must_use]\npub fn {prefix}{name}_derivatives(&self, \
             {arguments}) -> ({square}, {square}) {{"
        );
        match charts {
            None => out.push_str("loop {}\n"),
            Some(charts) => {
                let _ = writeln!(
                    out,
                    "let (mut first, mut second) = (<{square}>::{first}(), <{square}>::identity());"
                );
                let of: &[&str] = if name == "integrate" { &["dv"] } else { &["dv", "v"] };
                write_joint_derivative_blocks(out, name, of, charts);
            }
        }
        out.push_str("}\n");
    }
    let inputs = s.shape_type(Shape::Matrix(s.nv, s.nu));
    let pass = if s.time { "t, " } else { "" };
    let format_matrix_from_columns = |list: &str| {
        format!(
            "::linkwork::nalgebra::SMatrix::from_array_storage(::linkwork::nalgebra::ArrayStorage(found.{list}))"
        )
    };
    let _ = writeln!(
        out,
        "/// `(∂τ/∂q, ∂τ/∂v, ∂τ/∂u)` of the inputs' [`generalized_forces`](Self::generalized_forces).
        ///
        /// Column `i` of a derivative by `q` is along `q ⊕ ε eᵢ` (see `integrate`).
        #[inline]\n#[must_use]
        pub fn generalized_forces_derivatives({}) -> ({square}, {square}, {inputs}) {{
            let found = self.__input_derivatives({pass}q, v, u);
            ({}, {}, {})
        }}",
        s.parameter_list(&s.with_time_argument(&[Argument::Q, Argument::V, Argument::U])),
        format_matrix_from_columns("by_q"),
        format_matrix_from_columns("by_v"),
        format_matrix_from_columns("by_u"),
    );
}

/// Returns the index of the velocity along which each input acts, if every input is exactly one entry of the
/// generalized forces. Without inputs these forces are zero; if their derivatives by the inputs are constant,
/// the derivatives do not depend on the state.
fn velocity_driven_by_each_input(f: &Function, s: &SignatureContext<'_>) -> Option<Vec<usize>> {
    let by_inputs = f.program.outputs.get(s.nv + 2 * s.nv * s.nv..)?;
    let is_constant_equal_to = |o: &Operand, x: f64| *o == Operand::Const(x);
    let columns = (0..s.nu).map(|k| {
        let column = by_inputs.get(k * s.nv..(k + 1) * s.nv)?;
        let place = column.iter().position(|o| is_constant_equal_to(o, 1.0))?;
        let rest = column.iter().enumerate().filter(|(row, _)| *row != place);
        rest.into_iter().all(|(_, o)| is_constant_equal_to(o, 0.0)).then_some(place)
    });
    columns.collect()
}

/// Writes the second derivatives of forward dynamics. They combine the second derivatives of inverse dynamics
/// with the first derivatives of the accelerations, and for mechanisms with constraints with those of the
/// multipliers.
pub fn write_forward_second_derivatives(
    out: &mut String,
    charts: Option<&[Chart]>,
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    if !has_dynamics_second_derivatives(i) {
        return;
    }
    if has_curved_configurations(i, s) {
        write_displacement_rate_second_derivatives(out, charts, s);
    }
    let (square, pass) = (s.shape_type(Shape::Square(s.nv)), if s.time { "t, " } else { "" });
    let arguments = s.with_time_argument(&[Argument::Q, Argument::V, Argument::Tau, Argument::Factors(s.nv)]);
    let (source, body) = if i.facts.constraints.is_some() {
        let zero = format!("::linkwork::__private::constant::<{}>(0.0)", s.scalar.scalar_name());
        let t = if s.time { "t" } else { &zero };
        (
            "They combine the second derivatives of the equations of motion and of the constraints, `M v̇ + h − Jᵀ μ = τ` and `J v̇ + b = 0`, contracted with `−w` and `−z`, where `M w + Jᵀ z = λ` and `J \
             w = 0`, with the first derivatives of accelerations and multipliers.",
            format!("::linkwork::__private::constrained_second_derivatives(self, {t}, q, v, tau, lambda)"),
        )
    } else {
        (
            "With `μ = M⁻¹ λ` they are the second derivatives of `−μᵀ τ` by [`inverse_dynamics`](Self::inverse_dynamics), whose accelerations depend on `q` and `v` by \
             [`forward_dynamics_derivatives`](Self::forward_dynamics_derivatives).",
            format!(
                "let first = self.forward_dynamics_derivatives({pass}q, v, tau);
            let a = self.forward_dynamics({pass}q, v, tau);
            ::linkwork::__private::forward_second_derivatives(&first, lambda, |mu| self.inverse_dynamics_second_derivatives({pass}q, v, &a, mu))"
            ),
        )
    };
    let _ = writeln!(
        out,
        "/// `(∂²/∂q∂q, ∂²/∂q∂v, ∂²/∂v∂v, ∂²/∂q∂τ)` of `λᵀ v̇`, with `v̇` by [`forward_dynamics`](Self::forward_dynamics): the Hessians of
        /// its entries, contracted with the factors `lambda`. Rows of mixed derivatives belong to `q`. All
        /// others are zero.
        ///
        /// Along `q ⊕ ε dq` the function changes by `½ ε² dqᵀ H dq` beyond the first order, with `H` the
        /// first matrix; for ball and free joints `dq` is a motion in body axes.
        ///
        /// {source}
        #[inline]\n#[must_use]
        pub fn forward_dynamics_second_derivatives({}) -> ({square}, {square}, {square}, {square}) {{
            {body}
        }}",
        s.parameter_list(&arguments),
    );
}

/// Returns true if second derivatives of forward dynamics are available: they are requested and no contact
/// slides.
pub fn has_dynamics_second_derivatives(i: &Interface<'_>) -> bool {
    let slips = i.facts.constraints.is_some_and(|c| c.slipping > 0);
    i.facts.requests.second_derivatives && !slips
}

/// Returns true if the configuration space is curved and the second derivatives of the rate of displacements
/// are therefore generated. They are not generated with generalized speeds.
fn has_curved_configurations(i: &Interface<'_>, s: &SignatureContext<'_>) -> bool {
    s.nq != s.nv && !i.facts.speeds
}

/// Writes the second derivatives of the rate of displacements.
fn write_displacement_rate_second_derivatives(
    out: &mut String,
    charts: Option<&[Chart]>,
    s: &SignatureContext<'_>,
) {
    let (v, square) = (s.vector_type(s.nv), s.shape_type(Shape::Square(s.nv)));
    let _ = writeln!(
        out,
        "#[doc(hidden)]\n#[inline]\n#[must_use]\npub fn __tangent_rate_second_derivatives(&self, dv: &{v}, v: &{v}, lambda: &{v}) -> ({square}, {square}) {{"
    );
    match charts {
        None => out.push_str("loop {}\n"),
        Some(charts) => {
            let _ =
                writeln!(out, "let (mut first, mut second) = (<{square}>::zeros(), <{square}>::zeros());");
            write_joint_derivative_blocks(out, "tangent_rate_second", &["dv", "v", "lambda"], charts);
        }
    }
    out.push_str("}\n");
}

/// Writes `equation_second_derivatives`, the function of the trait `ConstrainedSecondDerivatives`.
pub fn write_constrained_second_derivatives_trait(out: &mut String, nc: usize, s: &SignatureContext<'_>) {
    let (scalar, nv) = (s.scalar.scalar_name(), s.nv);
    let (q, v, multipliers) = (s.vector_type(s.nq), s.vector_type(nv), s.vector_type(nc));
    let (t, pass) = (Argument::T.argument_name(), if s.time { "t, " } else { "" });
    let _ = writeln!(
        out,
        "#[inline]\nfn equation_second_derivatives(&self, {t}: {scalar}, q: &{q}, v: &{v}, a: &{v}, lambda: \
         &{multipliers}, w: &{v}, z: &{multipliers}, y: &{multipliers}) -> \
         ::linkwork::constraint::EquationSecondDerivatives<{scalar}, {nv}, {nc}> {{
            let found = self.__constraint_curvature({pass}q, v, a, &lambda.data.0[0], &w.data.0[0], \
                &z.data.0[0], &y.data.0[0]);
            ::linkwork::__private::with_curvature(self.inverse_dynamics_second_derivatives({pass}q, v, a, \
                w), found)
        }}"
    );
}

/// Returns the half-open range that contains all velocities of ball and free joints.
fn rotational_velocity_range(charts: &[Chart]) -> (usize, usize) {
    let velocities = charts.iter().filter_map(|chart| match *chart {
        Chart::Plain(..) => None,
        Chart::Ball(_, v) => Some((v.0, v.0 + 3)),
        Chart::Free(_, v) => Some((v.0, v.0 + 6)),
    });
    let union_of_ranges = |a: (usize, usize), b: (usize, usize)| (a.0.min(b.0), a.1.max(b.1));
    velocities.reduce(union_of_ranges).unwrap_or((0, 0))
}

/// Writes the statements that compute the diagonal blocks of ball and free joints and put them into the
/// result.
fn write_joint_derivative_blocks(out: &mut String, name: &str, of: &[&str], charts: &[Chart]) {
    for chart in charts {
        let (kind, v, n) = match *chart {
            Chart::Plain(..) => continue,
            Chart::Ball(_, v) => ("ball", v, 3),
            Chart::Free(_, v) => ("free", v, 6),
        };
        let format_block_entries = |of: &&str| {
            let list: Vec<String> = v.range_of_entries(n).map(|k| format!("{of}.data.0[0][{k}]")).collect();
            format!("[{}]", list.join(", "))
        };
        let arguments: Vec<String> = of.iter().map(format_block_entries).collect();
        let _ = writeln!(
            out,
            "let blocks = ::linkwork::__private::{kind}_{name}_derivatives({});
            ::linkwork::__private::put_block(&mut first, {v}, &blocks.0);
            ::linkwork::__private::put_block(&mut second, {v}, &blocks.1);",
            arguments.join(", ")
        );
    }
    out.push_str("(first, second)\n");
}

/// Writes the functions of the trait `SecondDerivatives`, which call the inherent functions.
pub fn write_second_derivatives_trait(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    use Argument::{A, Q, Tau, U, V};
    if i.facts.constraints.is_some() {
        let _ = writeln!(
            out,
            "#[inline]\nfn visit_constraint_curvature<V: ::linkwork::constraint::CurvatureVisitor<{}, {}, \
             {}, {}>>(&self, visitor: V) -> ::core::option::Option<V::Output> {{
                ::core::option::Option::Some(::linkwork::constraint::CurvatureVisitor::visit(visitor, self))
            }}",
            s.scalar.scalar_name(),
            s.nq,
            s.nv,
            s.nu
        );
    }
    if has_curved_configurations(i, s) {
        let (v, square) = (s.vector_type(s.nv), s.shape_type(Shape::Square(s.nv)));
        let _ = writeln!(
            out,
            "#[inline]\nfn tangent_rate_second_derivatives(&self, dv: &{v}, v: &{v}, lambda: &{v}) \
             -> ({square}, {square}) {{ self.__tangent_rate_second_derivatives(dv, v, lambda) }}"
        );
    }
    if i.facts.speeds {
        super::speeds::write_manifold_second_derivatives(out, s);
    }
    let n = s.nv;
    for (name, third, shape) in [
        ("inverse_dynamics_second_derivatives", A, Shape::Hessian(n)),
        ("forward_dynamics_second_derivatives", Tau, Shape::Hessian(n)),
        ("generalized_forces_second_derivatives", U, Shape::InputPowerHessian(n, s.nu)),
    ] {
        let arguments = [Q, V, third, Argument::Factors(n)];
        let names: Vec<&str> = s.with_time_argument(&arguments).iter().map(|a| a.argument_name()).collect();
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}({}) -> {} {{ Self::{name}(self, {}) }}",
            s.parameter_list(&[&[Argument::T], &arguments[..]].concat()),
            s.shape_type(shape),
            names.join(", ")
        );
    }
}

/// Writes the functions of the trait `Derivatives`, which call the inherent functions.
pub fn write_derivatives_trait(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    use Argument::{A, Q, Tau, U, V};
    let (v, square) = (s.vector_type(s.nv), s.shape_type(Shape::Square(s.nv)));
    if i.facts.speeds {
        super::speeds::write_configuration_space_derivatives(out, s);
    } else {
        let _ = writeln!(
            out,
            "#[inline]\nfn integrate_derivatives(&self, dv: &{v}) -> ({square}, {square}) {{ \
             Self::integrate_derivatives(self, dv) }}
            #[inline]\nfn tangent_rate_derivatives(&self, dv: &{v}, v: &{v}) -> ({square}, {square}) {{ \
                Self::tangent_rate_derivatives(self, dv, v) }}"
        );
    }
    let inputs = s.shape_type(Shape::Matrix(s.nv, s.nu));
    let pair = format!("({square}, {square})");
    let mut functions = vec![
        ("coriolis_matrix", vec![Q, V], square.clone()),
        ("inverse_dynamics_derivatives", vec![Q, V, A], pair.clone()),
        ("forward_dynamics_derivatives", vec![Q, V, Tau], format!("({square}, {square}, {square})")),
        ("generalized_forces_derivatives", vec![Q, V, U], format!("({square}, {square}, {inputs})")),
    ];
    if i.facts.requests.momentum_derivatives {
        out.push_str("const MOMENTUM_DERIVATIVES: bool = true;\n");
        functions.push(("generalized_momentum_derivatives", vec![Q, V], square));
        functions.push(("momentum_rate_derivatives", vec![Q, V], pair));
    }
    let _ = writeln!(
        out,
        "const DIRECT_INPUTS: ::core::option::Option<[usize; {}]> = Self::__DIRECT_INPUTS;
        const TURNED: ::core::option::Option<(usize, usize)> = Self::__TURNED;",
        s.nu
    );
    if i.facts.constraints.is_none() {
        let into = ["by_q", "by_v", "by_tau"].map(|name| Argument::Into(name, s.nv));
        functions.push(("forward_dynamics_derivatives_into", [vec![Q, V, Tau], into.to_vec()].concat(), v));
    }
    for (name, arguments, result) in functions {
        let names: Vec<&str> = s.with_time_argument(&arguments).iter().map(|a| a.argument_name()).collect();
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}({}) -> {result} {{ Self::{name}(self, {}) }}",
            s.parameter_list(&[vec![Argument::T], arguments].concat()),
            names.join(", ")
        );
    }
}

/// Writes the hook with the derivatives of accelerations under inputs, for implicit integration methods.
pub fn write_acceleration_derivative_hook(out: &mut String, s: &SignatureContext<'_>) {
    use Argument::{Q, U, V};
    let _ = writeln!(
        out,
        "#[inline]\nfn acceleration_derivatives({}) -> ::core::option::Option<({square}, {square}, \
         {inputs})> {{
            ::linkwork::__private::acceleration_derivatives(self, t, q, v, u)
        }}",
        s.parameter_list(&[Argument::T, Q, V, U]),
        square = s.shape_type(Shape::Square(s.nv)),
        inputs = s.shape_type(Shape::Matrix(s.nv, s.nu)),
    );
}
