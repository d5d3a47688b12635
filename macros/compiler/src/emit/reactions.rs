//! Outputs that contain joint reactions or contact forces. The generated functions first compute the motion,
//! then the outputs from its accelerations, multipliers or contact forces.

use super::docs::output_function_documentation;
use super::interface::Interface;
use super::signature::SignatureContext;
use crate::catalogue::{Argument, REACTION, TOUCHED};
use crate::derive::Function;
use crate::mechanism::{ActionOrigin, FreeBodyDiagram};
use std::fmt::Write;

/// Writes the functions of outputs that contain joint reactions, and of free-body diagrams, for the hidden
/// functions among `functions`.
pub fn write_methods(out: &mut String, i: &Interface<'_>, functions: &[Function], s: &SignatureContext<'_>) {
    let c = &i.constraints;
    let t = if s.time { "t, " } else { "" };
    for f in functions {
        let Some(name) = f.name.strip_prefix(REACTION) else { continue };
        let mut arguments = vec![Argument::Q, Argument::V];
        let mut pass = String::from("q, v, &a");
        if s.nu > 0 {
            arguments.push(Argument::U);
            pass.push_str(", u");
        }
        let tau = match (s.nu > 0, i.facts.velocity_inputs) {
            (true, true) => format!("self.generalized_forces({t}q, v, u)"),
            (true, false) => format!("self.generalized_forces({t}q, u)"),
            _ => format!("<{}>::zeros()", s.vector_type(s.nv)),
        };
        let solve = match c.names.is_empty() {
            true => format!("let a = self.forward_dynamics({t}q, v, &tau);"),
            false => {
                pass.push_str(", &lambda.data.0[0]");
                format!("let (a, lambda) = self.constrained_dynamics({t}q, v, &tau);")
            }
        };
        let diagram = i.diagrams.iter().find(|(known, _)| known == name).map(|(_, diagram)| diagram);
        if let Some(diagram) = diagram.filter(|_| !i.contacts.is_empty()) {
            let call = format!("self.{}({t}{pass}, &forces.data.0[0])", f.name);
            write_contact_free_body_diagram(out, i, (name, diagram), (&arguments, &tau, &solve, &call), s);
            continue;
        }
        let call = format!("self.{}({t}{pass})", f.name);
        let (docs, shape, result) = match diagram {
            Some(diagram) => (
                diagram_docs(diagram, s),
                free_body_diagram_type(diagram, s),
                diagram_expression(diagram, &call),
            ),
            None => (reaction_docs(i, s), s.shape_type(f.shape), call),
        };
        let _ = writeln!(
            out,
            "#[doc = {:?}]
            #[must_use]
            pub fn {name}({}) -> {shape} {{
                let tau = {tau};
                {solve}
                {result}
            }}",
            output_function_documentation(i, name, &docs),
            s.parameter_list(&s.with_time_argument(&arguments)),
        );
    }
}

/// Writes the two functions of a free-body diagram of a mechanism with contacts: under the forces that the
/// contacts exert in the state, and under contact forces passed as an argument.
fn write_contact_free_body_diagram(
    out: &mut String,
    i: &Interface<'_>,
    (name, diagram): (&str, &FreeBodyDiagram),
    (arguments, tau, solve, call): (&[Argument], &str, &str, &str),
    s: &SignatureContext<'_>,
) {
    let (scalar, kind) = (s.scalar.scalar_name(), free_body_diagram_type(diagram, s));
    let parameters = s.parameter_list(&s.with_time_argument(arguments));
    let (pass, t) = match s.time {
        true => ("t, ", "t".to_string()),
        false => ("", format!("::linkwork::__private::constant::<{scalar}>(0.0)")),
    };
    let (own, inputs) = match s.nu {
        0 => ("q, v", format!("&<{}>::zeros()", s.vector_type(0))),
        _ => ("q, v, u", "u".to_string()),
    };
    let acting = format!(
        "{} Under the forces that contacts exert in this state (`linkwork::contact::acting`); an error if \
         friction and constraints contradict each other.",
        diagram_docs(diagram, s)
    );
    let under = format!(
        "{} Under the contact forces `forces`, N and N·m, in the order of `CONTACT_ROWS`.",
        diagram_docs(diagram, s)
    );
    let _ = writeln!(
        out,
        "#[doc = {:?}]
        pub fn {name}({parameters}) -> ::core::result::Result<{kind}, ::linkwork::ConstraintError> {{
            let forces = ::linkwork::contact::acting(self, {t}, q, v, {inputs})?;
            ::core::result::Result::Ok(self.{name}_under({pass}{own}, &forces))
        }}
        #[doc = {:?}]
        #[must_use]
        pub fn {name}_under({parameters}, forces: &{}) -> {kind} {{
            let tau = {tau} + ::linkwork::Contacts::contact_jacobian(self, {t}, q).tr_mul(forces);
            {solve}
            {}
        }}",
        output_function_documentation(i, name, &acting),
        output_function_documentation(i, name, &under),
        s.vector_type(i.facts.contacts.rates),
        diagram_expression(diagram, call)
    );
}

/// Writes stubs of contact force outputs and free-body diagrams for a mechanism that failed to compile. Its
/// contact forces are unknown.
pub fn write_contact_output_stubs(
    out: &mut String,
    i: &Interface<'_>,
    functions: &[Function],
    s: &SignatureContext<'_>,
) {
    let mut arguments = vec![Argument::Q, Argument::V];
    arguments.extend((s.nu > 0).then_some(Argument::U));
    let parameters = s.parameter_list(&s.with_time_argument(&arguments));
    for f in functions {
        let Some(name) = f.name.strip_prefix(TOUCHED) else { continue };
        let shape = s.shape_type(f.shape);
        let _ = writeln!(
            out,
            "pub fn {name}({parameters}) -> ::core::result::Result<{shape}, ::linkwork::ConstraintError> \
             {{ loop {{}} }}"
        );
    }
    for (name, diagram) in &i.diagrams {
        let kind = free_body_diagram_type(diagram, s);
        if i.contacts.is_empty() {
            let _ = writeln!(out, "pub fn {name}({parameters}) -> {kind} {{ loop {{}} }}");
        } else {
            let forces = s.vector_type(i.facts.contacts.rates);
            let _ = writeln!(
                out,
                "pub fn {name}({parameters}) -> ::core::result::Result<{kind}, ::linkwork::ConstraintError> \
                 {{ loop {{}} }}
                pub fn {name}_under({parameters}, forces: &{forces}) -> {kind} {{ loop {{}} }}"
            );
        }
    }
}

/// Returns the Rust type of a free-body diagram.
fn free_body_diagram_type(diagram: &FreeBodyDiagram, s: &SignatureContext<'_>) -> String {
    format!("::linkwork::free_body::Diagram<{}, {}>", s.scalar.scalar_name(), diagram.actions.len())
}

/// Returns the expression that constructs a free-body diagram from the expression `numbers` of its values.
fn diagram_expression(diagram: &FreeBodyDiagram, numbers: &str) -> String {
    let format_action_origin = |(name, origin): &(String, ActionOrigin)| {
        format!("({name:?}, ::linkwork::free_body::Origin::{origin:?})")
    };
    let actions: Vec<String> = diagram.actions.iter().map(format_action_origin).collect();
    format!(
        "::linkwork::free_body::Diagram::new({:?}, [{}], ({numbers}).as_slice())",
        diagram.body,
        actions.join(", ")
    )
}

/// Returns the description of the function of a free-body diagram.
fn diagram_docs(diagram: &FreeBodyDiagram, s: &SignatureContext<'_>) -> String {
    let motion = match s.nu {
        0 => "in the motion that the state determines",
        _ => "in the motion under the inputs",
    };
    let all: Vec<String> = diagram.actions.iter().map(|(name, _)| format!("`{name}`")).collect();
    let actions = match all.is_empty() {
        true => "nothing acts".to_string(),
        false => all.join(", "),
    };
    format!(
        "the free-body diagram of `{}` {motion}: {actions}. Points are from the centre of mass, m, forces in \
         N, torques about their points in N·m.",
        diagram.body
    )
}

/// Returns the description of the function of an output that contains reactions.
fn reaction_docs(i: &Interface<'_>, s: &SignatureContext<'_>) -> String {
    let motion = match s.nu {
        0 => "in the motion that the state determines",
        _ => "in the motion under the inputs",
    };
    let contacts = match i.contacts.is_empty() {
        true => "",
        false => " without the forces of unilateral contacts",
    };
    format!(
        "{motion}{contacts}: a reaction is the force or torque that the parent of a joint exerts on its \
         child, at the origin of the joint's frame. Along the joint's own coordinate it includes the forces \
         of its motor, springs and dashpots. It has no derivatives yet."
    )
}

/// Writes the functions of outputs that contain contact forces, which are computed from the motion first.
pub fn write_contact_force_outputs(
    out: &mut String,
    i: &Interface<'_>,
    functions: &[Function],
    s: &SignatureContext<'_>,
) {
    let pass = if s.time { "t, " } else { "" };
    let scalar = s.scalar.scalar_name();
    let t =
        if s.time { "t".to_string() } else { format!("::linkwork::__private::constant::<{scalar}>(0.0)") };
    for f in functions {
        let Some(name) = f.name.strip_prefix(TOUCHED) else { continue };
        let mut arguments = vec![Argument::Q, Argument::V];
        let (mut own, mut inputs) = ("q, v", format!("&<{}>::zeros()", s.vector_type(0)));
        if s.nu > 0 {
            arguments.push(Argument::U);
            (own, inputs) = ("q, v, u", "u".to_string());
        }
        let _ = writeln!(
            out,
            "#[doc = {:?}]
            pub fn {name}({}) -> ::core::result::Result<{}, ::linkwork::ConstraintError> {{
                let forces = ::linkwork::contact::acting(self, {t}, q, v, {inputs})?;
                ::core::result::Result::Ok(self.{}({pass}{own}, &forces.data.0[0]))
            }}",
            output_function_documentation(i, name, ABOUT_FORCES),
            s.parameter_list(&s.with_time_argument(&arguments)),
            s.shape_type(f.shape),
            f.name
        );
    }
}

/// Description of the function of an output that contains contact forces.
const ABOUT_FORCES: &str = "under the forces that contacts exert in this state \
                            (`linkwork::contact::acting`). An error if friction and constraints contradict \
                            each other. It has no derivatives.";
