//! Implementations of the runtime's traits for mechanisms with states of first order.

use super::interface::{ALLOW, ImplGenerics, Interface};
use super::signature::SignatureContext;
use crate::catalogue::{Argument, BY_PARAMETERS, DERIVATIVES, Shape};
use crate::derive::Function;
use crate::syntax::RATE_OF_STATE;
use std::fmt::Write;

/// Returns the name of the function for a state's rate.
pub fn rate_function_name(state: &str) -> String {
    format!("{state}{RATE_OF_STATE}")
}

/// Writes the implementations of the traits of first-order states, if the mechanism has such states and
/// dynamics.
pub fn write_impls(out: &mut String, functions: &[Function], i: &Interface<'_>, s: &SignatureContext<'_>) {
    let rates: Option<Vec<&Function>> = i
        .states
        .iter()
        .map(|(name, _)| functions.iter().find(|f| f.name == rate_function_name(name)))
        .collect();
    let Some(rates) = rates.filter(|rates| !rates.is_empty() && !i.facts.kinematic) else { return };
    let (head, name, n) = (ImplGenerics::new(i, s), i.shell.ident.to_string(), rates.len());
    let begin_impl_block = |out: &mut String, of: &str| {
        let ImplGenerics { generics, arguments, bounds } = &head;
        let sizes = [s.nq, s.nv, s.nu, n, s.nv + n].map(|n| n.to_string()).join(", ");
        let _ = writeln!(
            out,
            "{ALLOW}impl{generics} ::linkwork::{of}<{sizes}> for {name}{arguments} {bounds} {{"
        );
    };
    begin_impl_block(out, "FirstOrder");
    write_first_order_states(out, &rates, i, s);
    // Accelerations under constraints have no derivatives by parameters.
    let differentiable = i.facts.requests.derivatives && i.facts.constraints.is_none();
    if differentiable {
        write_extended_motion_derivatives(out, n, s);
    }
    out.push_str("}\n");
    if differentiable {
        begin_impl_block(out, "FirstOrderDerivatives");
        write_state_derivatives(out, &rates, i, s);
        out.push_str("}\n");
    }
}

/// Returns the expression that calls a rate, or its derivatives with this suffix.
fn rate_call(f: &Function, suffix: &str) -> String {
    let names: Vec<&str> = f.arguments.iter().map(|a| a.argument_name()).collect();
    format!("Self::{}{suffix}(self, {})", f.name, names.join(", "))
}

/// Arguments of the functions that return the rates of the states.
const TAKEN: [Argument; 4] = [Argument::T, Argument::Q, Argument::V, Argument::U];

/// Writes names, units, values and rates of the states of first order.
fn write_first_order_states(
    out: &mut String,
    rates: &[&Function],
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    let n = rates.len();
    let (vector, parameters) = (s.vector_type(n), s.parameter_list(&TAKEN));
    let names: Vec<String> = i.states.iter().map(|(name, _)| format!("{name:?}")).collect();
    let own: Vec<String> =
        i.states.iter().map(|(_, k)| format!("self.{}", s.scalar.parameter_field_name(*k))).collect();
    // All fields are named, because the struct need not be `Clone`.
    let field_name = |field: &syn::Field| field.ident.as_ref().map(ToString::to_string);
    let of_struct = i.shell.parameters.iter().chain(&i.shell.tables).filter_map(field_name);
    let of_file = i.shell.file_fields.iter().map(|field| field.ident.clone());
    let fields = of_struct.chain(of_file).map(|field| {
        let plain = field.trim_start_matches("r#");
        match i.states.iter().position(|(name, _)| name == plain) {
            Some(k) => format!("{field}: x.data.0[0][{k}]"),
            None => format!("{field}: self.{field}"),
        }
    });
    let fields: Vec<String> = fields.collect();
    let values: Vec<String> = rates.iter().map(|f| rate_call(f, "")).collect();
    let unit_of_parameter = |k: usize| i.units.parameters.get(k).map_or("", |unit| unit);
    let units: Vec<&str> = i.states.iter().map(|(_, k)| unit_of_parameter(*k)).collect();
    let _ = writeln!(
        out,
        "const STATES: [&'static str; {n}] = [{}];
        const STATE_UNITS: [&'static str; {n}] = {units:?};
        #[inline]\nfn states(&self) -> {vector} {{ <{vector}>::from([{}]) }}
        #[inline]\nfn with_states(&self, x: &{vector}) -> Self {{ Self {{ {} }} }}
        #[inline]\nfn state_rates({parameters}) -> {vector} {{ <{vector}>::from([{}]) }}",
        names.join(", "),
        own.join(", "),
        fields.join(", "),
        values.join(", "),
    );
}

/// Writes the derivatives of the rates of velocities and states, for implicit integration methods.
fn write_extended_motion_derivatives(out: &mut String, n: usize, s: &SignatureContext<'_>) {
    let all = s.nv + n;
    let _ = writeln!(
        out,
        "#[inline]\nfn extended_derivatives(&self, t: {scalar}, q: &{q}, v: &{v}, u: &{u}) -> \
         ::core::option::Option<({square}, {square}, {inputs})> {{
            ::linkwork::__private::acceleration_derivatives(&::linkwork::FirstOrder::extended(self), t, q, \
                v, u)
        }}",
        scalar = s.scalar.scalar_name(),
        q = s.vector_type(s.nq),
        v = s.vector_type(all),
        u = s.vector_type(s.nu),
        square = s.shape_type(Shape::Square(all)),
        inputs = s.shape_type(Shape::Matrix(all, s.nu)),
    );
}

/// Writes the derivatives of the rates of the states, and the derivatives of the dynamics by the states.
fn write_state_derivatives(
    out: &mut String,
    rates: &[&Function],
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    let (n, scalar) = (rates.len(), s.scalar.scalar_name());
    let which: Vec<String> = i.states.iter().map(|(_, k)| k.to_string()).collect();
    let which = which.join(", ");
    let record = format!("::linkwork::RateDerivatives<{scalar}, {}, {}, {n}>", s.nv, s.nu);
    let _ = writeln!(
        out,
        "#[inline]\nfn state_rate_derivatives({}) -> {record} {{\nlet mut all = <{record}>::zeros();",
        s.parameter_list(&TAKEN)
    );
    for (k, f) in rates.iter().enumerate() {
        let _ = writeln!(
            out,
            "let seen = {};
            ::linkwork::__private::put_rows(&mut all.by_q, {k}, &seen.by_q);
            ::linkwork::__private::put_rows(&mut all.by_v, {k}, &seen.by_v);
            ::linkwork::__private::put_rows(&mut all.by_u, {k}, &seen.by_u);
            ::linkwork::__private::put_rows(&mut all.by_x, {k}, &::linkwork::__private::columns(&{}, \
                [{which}]));",
            rate_call(f, DERIVATIVES),
            rate_call(f, BY_PARAMETERS),
        );
    }
    out.push_str("all\n}\n");
    let by_states = s.shape_type(Shape::Matrix(s.nv, n));
    let time = if s.time { "t, " } else { "" };
    for (function, last) in [
        ("inverse_dynamics", Argument::A),
        ("forward_dynamics", Argument::Tau),
        ("generalized_forces", Argument::U),
    ] {
        let _ = writeln!(
            out,
            "#[inline]\nfn {function}_by_states({}) -> {by_states} {{
                ::linkwork::__private::columns(&Self::{function}{BY_PARAMETERS}(self, {time}q, v, {}), \
                    [{which}])
            }}",
            s.parameter_list(&[Argument::T, Argument::Q, Argument::V, last]),
            last.argument_name(),
        );
    }
}
