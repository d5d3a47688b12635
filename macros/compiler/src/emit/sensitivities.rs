//! Implementation of the runtime's trait of derivatives with respect to parameters.

use super::interface::{ALLOW, ImplGenerics, Interface};
use super::signature::Signature;
use crate::catalogue::{Argument, Shape};
use std::fmt::Write;

/// Writes the trait implementation for the type `name`, if the mechanism has these derivatives.
pub fn write_sensitivities_impl(out: &mut String, name: &str, i: &Interface<'_>, s: &Signature<'_>) {
    use Argument::{A, Q, Tau, U, V};
    let facts = &i.facts;
    if !facts.requests.sensitivities || facts.constraints.is_some() || facts.parameters == 0 {
        return;
    }
    let ImplGenerics { generics, arguments, bounds } = &ImplGenerics::new(i, s);
    let np = facts.parameters;
    let _ = writeln!(
        out,
        "{ALLOW}impl{generics} ::linkwork::Sensitivities<{}, {}, {}, {np}> for {name}{arguments} {bounds} {{
        const PARAMETERS: [&'static str; {np}] = Self::PARAMETERS;",
        s.nq, s.nv, s.nu
    );
    for (function, third) in [
        ("inverse_dynamics_by_parameters", A),
        ("forward_dynamics_by_parameters", Tau),
        ("generalized_forces_by_parameters", U),
    ] {
        let own: Vec<&str> = s.with_time_argument(&[Q, V, third]).iter().map(|a| a.argument_name()).collect();
        let _ = writeln!(
            out,
            "#[inline]\nfn {function}({}) -> {} {{ Self::{function}(self, {}) }}",
            s.parameter_list(&[Argument::T, Q, V, third]),
            s.shape_type(Shape::Matrix(s.nv, np)),
            own.join(", ")
        );
    }
    out.push_str("}\n");
}
