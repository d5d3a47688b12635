//! Implementations for a type: its inherent functions and the runtime's traits.

use super::interface::{ALLOW, Head, Interface, needed};
use super::signature::Signature;
use super::{constraints, contacts, differentiable, lanes, limits};
use crate::catalogue;
use std::fmt::Write;

/// The inherent functions of a type of this name, and the trait's.
pub fn write_impls(
    head: &Head,
    out: &mut String,
    name: &str,
    methods: &str,
    i: &Interface<'_>,
    s: &Signature<'_>,
) {
    let Head { generics, arguments, bounds } = head;
    let _ = writeln!(out, "{ALLOW}impl{generics} {name}{arguments} {bounds} {{\n{methods}}}");
    let _ = writeln!(
        out,
        "{ALLOW}impl{generics} ::linkwork::Limits<{}, {}> for {name}{arguments} {bounds} {{",
        s.nq, s.nv
    );
    limits::write_trait(out, &i.limits, s);
    out.push_str("}\n");
    if i.facts.kinematic {
        return;
    }
    let begin = |out: &mut String, of: &str| {
        let _ = writeln!(
            out,
            "{ALLOW}impl{generics} ::linkwork::{of}<{}, {}, {}> for {name}{arguments} {bounds} {{",
            s.nq, s.nv, s.nu
        );
    };
    begin(out, if s.time { "Rheonomic" } else { "Mechanism" });
    write_trait(out, i, s);
    out.push_str("}\n");
    if i.facts.requests.derivatives {
        begin(out, if s.time { "RheonomicDerivatives" } else { "Derivatives" });
        differentiable::write_trait(out, i, s);
        constraints::write_visit(out, &i.constraints, s);
        out.push_str("}\n");
    }
    if differentiable::has_second(i) {
        begin(out, if s.time { "RheonomicSecondDerivatives" } else { "SecondDerivatives" });
        differentiable::write_second_trait(out, i, s);
        out.push_str("}\n");
    }
    if i.facts.requests.batch {
        begin(out, "Batch");
        lanes::write_trait(out, i, s);
        out.push_str("}\n");
    }
    if !i.contacts.is_empty() {
        let sizes = [s.nq, s.nv, s.nu, i.facts.contacts[0], i.facts.contacts[1]];
        let sizes = sizes.map(|n| n.to_string()).join(", ");
        let _ = writeln!(
            out,
            "{ALLOW}impl{generics} ::linkwork::Contacts<{sizes}> for {name}{arguments} {bounds} {{"
        );
        contacts::write_trait(out, i, s);
        out.push_str("}\n");
        if i.facts.requests.derivatives {
            let _ = writeln!(
                out,
                "{ALLOW}impl{generics} ::linkwork::contact::ContactDerivatives<{sizes}> for {name}{arguments} {bounds} {{"
            );
            contacts::write_derivatives(out, i, s);
            out.push_str("}\n");
        }
    }
    if !i.constraints.names.is_empty() {
        let sizes = [s.nq, s.nv, s.nu, i.constraints.holonomic, i.constraints.names.len()];
        let sizes = sizes.map(|n| n.to_string()).join(", ");
        let _ = writeln!(
            out,
            "{ALLOW}impl{generics} ::linkwork::Constrained<{sizes}> for {name}{arguments} {bounds} {{"
        );
        constraints::write_trait(out, &i.constraints, s);
        out.push_str("}\n");
        if constraints::are_differentiable(&i.constraints) && i.facts.requests.derivatives {
            let _ = writeln!(
                out,
                "{ALLOW}impl{generics} ::linkwork::ConstrainedDerivatives<{sizes}> for {name}{arguments} {bounds} {{"
            );
            constraints::write_derivatives_trait(out, &i.constraints, s);
            out.push_str("}\n");
        }
        if differentiable::has_second(i) {
            let _ = writeln!(
                out,
                "{ALLOW}impl{generics} ::linkwork::ConstrainedSecondDerivatives<{sizes}> for {name}{arguments} {bounds} {{"
            );
            differentiable::write_constrained_second_trait(out, i.constraints.names.len(), s);
            out.push_str("}\n");
        }
    }
}

/// The trait's functions, in terms of the inherent ones, which take only what they need.
fn write_trait(out: &mut String, i: &Interface<'_>, s: &Signature<'_>) {
    let _ = writeln!(out, "type Scalar = {};", s.scalar.name());
    for (name, n) in [("CONFIGURATION", s.nq), ("VELOCITIES", s.nv), ("INPUTS", s.nu)] {
        let _ = writeln!(out, "const {name}: [&'static str; {n}] = Self::{name};");
    }
    // A mechanism that failed to compile has none.
    for (name, units, n) in
        [("VELOCITY_UNITS", &i.units.velocities, s.nv), ("INPUT_UNITS", &i.units.inputs, s.nu)]
    {
        if units.len() == n {
            let _ = writeln!(out, "const {name}: [&'static str; {n}] = {units:?};");
        }
    }
    let (q, v) = (s.vector(s.nq), s.vector(s.nv));
    for (row, arguments) in catalogue::of_trait() {
        let (name, result) = (row.name, s.shape((row.declare)(&i.facts).shape));
        let needed = needed(row, i);
        let names: Vec<&str> = s.timed(&needed).iter().map(|a| a.name()).collect();
        let _ = writeln!(
            out,
            "#[inline]\nfn {name}({}) -> {result} {{ Self::{name}(self, {}) }}",
            s.parameters(&s.timed(arguments)),
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
        super::speeds::write_trait(out, s);
    } else {
        let _ = writeln!(
            out,
            "#[inline]\nfn tangent_rate(&self, dv: &{v}, v: &{v}) -> {v} {{ Self::tangent_rate(self, dv, v) }}"
        );
    }
    if i.facts.acceleration_forces {
        out.push_str("const FEEDBACK: bool = true;\n");
    }
    constraints::write_projection(out, &i.constraints, s);
    if i.facts.requests.derivatives && i.constraints.slipping.is_empty() {
        differentiable::write_accelerations(out, s);
    }
    contacts::write_steps(out, i, s);
}
