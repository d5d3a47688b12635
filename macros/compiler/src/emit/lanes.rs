//! Code of functions of several states at once, which the option `batch` requests. Their bodies equal those
//! of single states, with SIMD lanes in place of scalars.

use super::dispatch::ArithmeticDispatchedBodies;
use super::function::write_function;
use super::interface::{Interface, inherent_function_arguments};
use super::manifold::write_manifold;
use super::signature::{SignatureContext, result_matrix_names};
use crate::catalogue::{self, Argument, GeneratedId, Shape};
use crate::derive::Function;
use crate::mechanism::Chart;
use std::fmt::Write;

/// Writes the variant of every public function of the state for several states, with the suffix `_lanes`, if
/// the option `batch` is set. Without `charts`, for a mechanism that failed to compile, these are stubs.
pub fn write_methods(
    out: &mut String,
    bodies: &mut ArithmeticDispatchedBodies,
    i: &Interface<'_>,
    functions: &[Function],
    charts: Option<&[Chart]>,
    s: &SignatureContext<'_>,
) {
    if !i.facts.requests.batch {
        return;
    }
    let in_lanes = s.scalar.spelling_in_lanes();
    let lanes = SignatureContext { scalar: &in_lanes, ..*s };
    let is_batched = |f: &&Function| match f.id {
        GeneratedId::ConstrainedDynamics => !i.constraints.overdetermined,
        // Hidden functions that other functions call.
        GeneratedId::AccelerationsAndInverse
        | GeneratedId::PassiveForces
        | GeneratedId::PassiveDerivatives => true,
        _ => !f.is_hidden() && !f.arguments.is_empty(),
    };
    for f in functions.iter().filter(is_batched) {
        let exact = match &f.program.simd {
            _ if f.loops.is_some() => {
                "up to rounding: the function of a single state uses loops over the links"
            }
            Some(_) if !i.facts.requests.reproducible => {
                "up to rounding: the function of a single state uses the lanes for limbs or joints"
            }
            _ => "bit for bit",
        };
        let docs = vec![format!("[`{0}`](Self::{0}) of the state in every lane, {exact}.", f.name)];
        let docs = if f.is_hidden() { Vec::new() } else { docs };
        let twin = Function { docs, ..f.clone() };
        match charts {
            Some(_) => bodies.write_function(out, &twin, &lanes),
            None => write_function(out, &twin, &lanes, true),
        }
    }
    if !i.constraints.names.is_empty() {
        write_constrained_dynamics_lanes(out, i, &lanes);
    }
    write_manifold(out, charts, i.facts.speeds, &lanes);
}

/// Returns the body of a function of several states for debug builds, which computes one state after another:
/// lanes would need more stack than a thread has. Returns `None` for hidden functions that are called only
/// from such bodies.
pub fn sequential_debug_body(f: &Function) -> Option<String> {
    let lane_argument = |a: &Argument| match a {
        Argument::T => Some("t.0[k]".to_string()),
        Argument::Into(name, _) => Some(format!("&mut one_{name}")),
        Argument::Given(..) => None,
        a => Some(format!("&lane({}, k)", a.argument_name())),
    };
    let arguments: Option<Vec<String>> = f.arguments.iter().map(lane_argument).collect();
    let call = format!("self.{}({})", f.name, arguments?.join(", "));
    let given = result_matrix_names(f);
    if !given.is_empty() {
        let concatenate_for_arguments =
            |form: &dyn Fn(&str) -> String| given.iter().map(|name| form(name)).collect::<String>();
        let (first, last) = (
            concatenate_for_arguments(&|name| format!("let mut one_{name} = lane({name}, k);\n")),
            concatenate_for_arguments(&|name| format!("set_lane({name}, k, &one_{name});\n")),
        );
        if matches!(f.shape, Shape::Forward(_) | Shape::ForwardDerivativesByCalls(_)) {
            return Some(format!(
                "use ::linkwork::__private::{{Lanes, lane, lane_by_lane, set_lane}};\nlane_by_lane(|k| {{\n\
                 {first}let found = {call};\n{last}found\n}})\n"
            ));
        }
        return (!matches!(f.shape, Shape::Accelerated(_))).then(|| {
            format!(
                "use ::linkwork::__private::{{lane, set_lane}};\nfor k in 0..LANES {{\n{first}{call};\n\
                 {last}}}\n"
            )
        });
    }
    let format_tuple_of_parts = |count: usize| {
        let format_lane_part = |part| format!("lane_by_lane(|k| all[k].{part})");
        let parts: Vec<String> = (0..count).map(format_lane_part).collect();
        format!("let all: [_; LANES] = ::core::array::from_fn(|k| {call});\n({})", parts.join(", "))
    };
    let result = match f.shape {
        Shape::Scalar => format!("Lanes(::core::array::from_fn(|k| {call}))"),
        Shape::Vector(_) | Shape::Square(_) | Shape::Matrix(..) | Shape::Inverse(_) => {
            format!("lane_by_lane(|k| {call})")
        }
        Shape::Pair(_) | Shape::Linear(..) | Shape::CalledLinear(..) => format_tuple_of_parts(2),
        Shape::Forward(_) | Shape::ForwardDerivativesByCalls(_) => format_tuple_of_parts(3),
        Shape::Hessian(_) => format_tuple_of_parts(4),
        Shape::Jacobians(..) => {
            let all = format_tuple_of_parts(0);
            let all = all.trim_end_matches("()");
            let format_lane_field = |name: &str| format!("{name}: lane_by_lane(|k| all[k].{name})");
            let fields = ["by_q", "by_v", "by_a", "by_u"].map(format_lane_field).join(", ");
            format!("{all}::linkwork::OutputJacobians {{ {fields} }}")
        }
        Shape::InputPowerHessian(..) => format_tuple_of_parts(6),
        Shape::Accelerated(_) | Shape::Array(_) | Shape::Record(_) | Shape::Symmetric(_) => return None,
    };
    Some(format!("use ::linkwork::__private::{{Lanes, lane, lane_by_lane}};\n{result}\n"))
}

/// Writes forward dynamics with constraints. If the elimination fails in a lane, all lanes use the function
/// of a single state.
fn write_constrained_dynamics_lanes(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    let nv = s.nv;
    let arguments = s.with_time_argument(&[Argument::Q, Argument::V, Argument::Tau]);
    let names: Vec<&str> = arguments.iter().map(|a| a.argument_name()).collect();
    let one: Vec<String> = arguments
        .iter()
        .map(|a| match a {
            Argument::T => "t.0[k]".to_string(),
            _ => format!("&lane({}, k)", a.argument_name()),
        })
        .collect();
    let single = format!("lane_by_lane(|k| self.forward_dynamics({}))", one.join(", "));
    if i.constraints.overdetermined {
        let _ = writeln!(
            out,
            "/// [`forward_dynamics`](Self::forward_dynamics) of the state in every lane, computed one after \
             another, bit for bit.
            #[inline]\n#[must_use]
            pub fn forward_dynamics_lanes<const LANES: usize>({}) -> {} {{
                use ::linkwork::__private::{{lane, lane_by_lane}};
                {single}
            }}",
            s.parameter_list(&arguments),
            s.vector_type(nv),
        );
        return;
    }
    let slipping = &i.constraints.slipping;
    let sides = match slipping.len() {
        0 => String::new(),
        k => format!(", &[::linkwork::__private::constant::<{}>(1.0); {k}]", s.scalar.scalar_name()),
    };
    let quick = match i.constraints.independent {
        true => "solution_with_predetermined_pivots(&found)".to_string(),
        false => format!("pressing_solution(&{slipping:?}, &Self::__STRUCTURE.groups, &found)"),
    };
    let _ = writeln!(
        out,
        "/// [`forward_dynamics`](Self::forward_dynamics) of the state in every lane, bit for bit.
        #[inline]\n#[must_use]
        pub fn forward_dynamics_lanes<const LANES: usize>({}) -> {} {{
            use ::linkwork::__private::{{lane, lane_by_lane}};
            let found = self.__constrained_dynamics_lanes({}{sides});
            match ::linkwork::__private::{quick} {{
                ::core::option::Option::Some(solution) => solution.0,
                ::core::option::Option::None => {single},
            }}
        }}",
        s.parameter_list(&arguments),
        s.vector_type(nv),
        names.join(", "),
    );
}

/// Writes the functions of the trait `Batch`, which call the inherent functions. They always take time as the
/// first argument.
pub fn write_batch_trait_functions(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    let in_lanes = s.scalar.spelling_in_lanes();
    let s = &SignatureContext { scalar: &in_lanes, ..*s };
    for (row, arguments) in catalogue::mechanism_trait_rows() {
        let name = row.name;
        let all: Vec<Argument> = [&[Argument::T], arguments].concat();
        let needed = s.with_time_argument(&inherent_function_arguments(row, i));
        let names: Vec<&str> = needed.iter().map(|a| a.argument_name()).collect();
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}_lanes<const LANES: usize>({}) -> {} {{ Self::{name}_lanes(self, {}) }}",
            s.parameter_list(&all),
            s.shape_type((row.declare)(&i.facts).shape),
            names.join(", ")
        );
    }
    let (q, v) = (s.vector_type(s.nq), s.vector_type(s.nv));
    let _ = writeln!(
        out,
        "#[inline]\nfn integrate_lanes<const LANES: usize>(&self, q: &{q}, dv: &{v}) -> {q} {{ \
         Self::integrate_lanes(self, q, dv) }}
        #[inline]\nfn difference_lanes<const LANES: usize>(&self, from: &{q}, to: &{q}) -> {v} {{ \
            Self::difference_lanes(self, from, to) }}"
    );
    if i.facts.speeds {
        super::speeds::write_batch_configuration_functions(out, s);
        return;
    }
    let _ = writeln!(
        out,
        "#[inline]\nfn tangent_rate_lanes<const LANES: usize>(&self, dv: &{v}, v: &{v}) -> {v} \
         {{ Self::tangent_rate_lanes(self, dv, v) }}"
    );
}
