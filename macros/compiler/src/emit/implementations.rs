//! Implementations of a type: its inherent functions and the runtime's traits.

use super::interface::{ALLOW, ImplGenerics, Interface, inherent_function_arguments};
use super::signature::SignatureContext;
use super::{constraints, contacts, differentiable, lanes, limits};
use crate::catalogue::{self, Argument, ContactCounts};
use std::fmt::Write;

/// Writes the inherent functions `methods` of the type `name` and the implementations of the runtime's
/// traits.
pub fn write_impls(
    head: &ImplGenerics,
    out: &mut String,
    name: &str,
    methods: &str,
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    let ImplGenerics { generics, arguments, bounds } = head;
    let _ = writeln!(out, "{ALLOW}impl{generics} {name}{arguments} {bounds} {{\n{methods}}}");
    let _ = writeln!(
        out,
        "{ALLOW}impl{generics} ::linkwork::Limits<{}, {}> for {name}{arguments} {bounds} {{",
        s.nq, s.nv
    );
    limits::write_trait(out, &i.limits, i.facts.speeds, s);
    out.push_str("}\n");
    if i.facts.kinematic {
        return;
    }
    let begin_impl_block = |out: &mut String, of: &str| {
        let _ = writeln!(
            out,
            "{ALLOW}impl{generics} ::linkwork::{of}<{}, {}, {}> for {name}{arguments} {bounds} {{",
            s.nq, s.nv, s.nu
        );
    };
    begin_impl_block(out, "Mechanism");
    write_mechanism_trait_items(out, i, s);
    out.push_str("}\n");
    let _ = writeln!(
        out,
        "{ALLOW}impl{generics} ::linkwork::integrate::Hooks<{}, {}, {}, {}> for {name}{arguments} {bounds} \
         {{",
        s.scalar.scalar_name(),
        s.nq,
        s.nv,
        s.nu
    );
    write_integrator_hooks(out, i, s);
    out.push_str("}\n");
    if !s.time {
        let _ = writeln!(out, "impl{generics} ::linkwork::Scleronomic for {name}{arguments} {bounds} {{}}");
    }
    if i.facts.requests.derivatives {
        begin_impl_block(out, "Derivatives");
        differentiable::write_derivatives_trait(out, i, s);
        constraints::write_visit_constraints(out, &i.constraints, s);
        out.push_str("}\n");
    }
    if differentiable::has_dynamics_second_derivatives(i) {
        begin_impl_block(out, "SecondDerivatives");
        differentiable::write_second_derivatives_trait(out, i, s);
        out.push_str("}\n");
    }
    if i.facts.requests.batch {
        begin_impl_block(out, "Batch");
        lanes::write_batch_trait_functions(out, i, s);
        out.push_str("}\n");
    }
    if !i.contacts.is_empty() {
        write_contact_trait_impls(head, out, name, i, s);
    }
    if !i.constraints.names.is_empty() {
        write_constraint_trait_impls(head, out, name, i, s);
    }
}

/// Writes the head of the implementation of the trait `of`. Its const arguments are the sizes of state and
/// inputs and the two numbers `more`.
fn write_trait_impl_head(
    ImplGenerics { generics, arguments, bounds }: &ImplGenerics,
    out: &mut String,
    name: &str,
    of: &str,
    s: &SignatureContext<'_>,
    more: [usize; 2],
) {
    let sizes = [s.nq, s.nv, s.nu, more[0], more[1]].map(|n| n.to_string()).join(", ");
    let _ =
        writeln!(out, "{ALLOW}impl{generics} ::linkwork::{of}<{sizes}> for {name}{arguments} {bounds} {{");
}

/// Writes the implementations of the traits for contacts.
fn write_contact_trait_impls(
    head: &ImplGenerics,
    out: &mut String,
    name: &str,
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    let ContactCounts { count, rates } = i.facts.contacts;
    write_trait_impl_head(head, out, name, "Contacts", s, [count, rates]);
    contacts::write_trait(out, i, s);
    out.push_str("}\n");
    if i.facts.requests.derivatives {
        write_trait_impl_head(head, out, name, "contact::ContactDerivatives", s, [count, rates]);
        contacts::write_derivatives(out, i, s);
        out.push_str("}\n");
    }
}

/// Writes the implementations of the traits for constraints.
fn write_constraint_trait_impls(
    head: &ImplGenerics,
    out: &mut String,
    name: &str,
    i: &Interface<'_>,
    s: &SignatureContext<'_>,
) {
    let counts = [i.constraints.holonomic, i.constraints.names.len()];
    write_trait_impl_head(head, out, name, "Constrained", s, counts);
    constraints::write_trait(out, &i.constraints, s);
    let is_differentiable =
        constraints::are_constraints_differentiable(&i.constraints) && i.facts.requests.derivatives;
    if is_differentiable {
        constraints::write_stabilized_motion_derivatives(out, s);
    }
    out.push_str("}\n");
    if is_differentiable {
        write_trait_impl_head(head, out, name, "ConstrainedDerivatives", s, counts);
        constraints::write_derivatives_trait(out, &i.constraints, s);
        out.push_str("}\n");
    }
    if differentiable::has_dynamics_second_derivatives(i) {
        write_trait_impl_head(head, out, name, "ConstrainedSecondDerivatives", s, counts);
        differentiable::write_constrained_second_derivatives_trait(out, i.constraints.names.len(), s);
        out.push_str("}\n");
    }
}

/// Writes the items of the trait `Mechanism`. Its functions call the inherent functions, which take only the
/// arguments that they need.
fn write_mechanism_trait_items(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    let _ = writeln!(out, "type Scalar = {};", s.scalar.scalar_name());
    for (name, n) in [("CONFIGURATION", s.nq), ("VELOCITIES", s.nv), ("INPUTS", s.nu)] {
        let _ = writeln!(out, "const {name}: [&'static str; {n}] = Self::{name};");
    }
    // The units of a mechanism that failed to compile are unknown.
    for (name, units, n) in
        [("VELOCITY_UNITS", &i.units.velocities, s.nv), ("INPUT_UNITS", &i.units.inputs, s.nu)]
    {
        if units.len() == n {
            let _ = writeln!(out, "const {name}: [&'static str; {n}] = {units:?};");
        }
    }
    let (q, v) = (s.vector_type(s.nq), s.vector_type(s.nv));
    for (row, arguments) in catalogue::mechanism_trait_rows() {
        let (name, result) = (row.name, s.shape_type((row.declare)(&i.facts).shape));
        let needed = inherent_function_arguments(row, i);
        let names: Vec<&str> = s.with_time_argument(&needed).iter().map(|a| a.argument_name()).collect();
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}({}) -> {result} {{ Self::{name}(self, {}) }}",
            s.parameter_list(&[&[Argument::T], arguments].concat()),
            names.join(", ")
        );
    }
    let _ = writeln!(
        out,
        "#[inline]\nfn neutral(&self) -> {q} {{ Self::neutral(self) }}
        #[inline]\nfn integrate(&self, q: &{q}, dv: &{v}) -> {q} {{ Self::integrate(self, q, dv) }}
        #[inline]\nfn difference(&self, from: &{q}, to: &{q}) -> {v} {{ Self::difference(self, from, to) }}"
    );
    if i.facts.speeds {
        super::speeds::write_mechanism_trait_overrides(out, s);
    } else {
        let _ = writeln!(
            out,
            "#[inline]\nfn tangent_rate(&self, dv: &{v}, v: &{v}) -> {v} {{ Self::tangent_rate(self, dv, \
             v) }}"
        );
    }
    constraints::write_try_forward_dynamics(out, &i.constraints, s);
}

/// Writes the trait items that integrators use.
fn write_integrator_hooks(out: &mut String, i: &Interface<'_>, s: &SignatureContext<'_>) {
    if i.facts.speeds {
        out.push_str("const SPEEDS: bool = true;\n");
    }
    if i.facts.acceleration_forces {
        out.push_str("const FEEDBACK: bool = true;\n");
    }
    constraints::write_projection_hooks(out, &i.constraints, s);
    if i.facts.requests.derivatives && i.constraints.slipping.is_empty() {
        differentiable::write_acceleration_derivative_hook(out, s);
    }
    contacts::write_contact_integrator_hooks(out, i, s);
}
