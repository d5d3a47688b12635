//! Implementation of the runtime's trait of derivatives with respect to parameters.

use super::interface::{ALLOW, ImplGenerics, Interface};
use super::signature::SignatureContext;
use crate::catalogue::{Argument, ContactCounts, Shape};
use std::fmt::Write;

/// Writes the trait implementation for the type `name`, if the mechanism has these derivatives.
pub fn write_sensitivities_impl(out: &mut String, name: &str, i: &Interface<'_>, s: &SignatureContext<'_>) {
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
    let has_contact_sensitivities = facts.contacts.count > 0 && facts.requests.derivatives && !facts.speeds;
    if !has_contact_sensitivities {
        return out.push_str("}\n");
    }
    let (scalar, q, v, matrix) = (
        s.scalar.scalar_name(),
        s.vector_type(s.nq),
        s.vector_type(s.nv),
        s.shape_type(Shape::Matrix(s.nv, np)),
    );
    let ContactCounts { count, rates } = facts.contacts;
    let time = if s.time { "t, " } else { "" };
    let _ = writeln!(
        out,
        "#[inline]\nfn differentiate_contact_step_by_parameters(&self, \
            method: &::linkwork::integrate::TimeStepping<{scalar}>, t: {scalar}, state: (&{q}, &{v}), \
            u: &{}) -> ::core::option::Option<::core::result::Result<({matrix}, {matrix}), \
            ::linkwork::integrate::Error>> {{
            ::core::option::Option::Some(::linkwork::__private::differentiate_step_by_parameters(self, \
                method, t, state, u))
        }}
        }}
        {ALLOW}impl{generics} \
            ::linkwork::contact::ContactSensitivities<{}, {}, {}, {np}, {count}, {rates}> for \
            {name}{arguments} {bounds} {{
        #[inline]\nfn contact_derivatives_by_parameters(&self, t: {scalar}, q: &{q}, v: &{v}, \
            forces: &{}) -> ::linkwork::contact::ContactsByParameters<{scalar}, {}, {np}, {count}, {rates}> {{
            ::linkwork::contact::ContactsByParameters::from_list(\
                &self.__contact_derivatives_by_parameters({time}q, v, &forces.data.0[0]))
        }}
        }}",
        s.vector_type(s.nu),
        s.nq,
        s.nv,
        s.nu,
        s.vector_type(rates),
        s.nv,
    );
}
