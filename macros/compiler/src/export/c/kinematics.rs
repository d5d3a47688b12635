//! Functions that templates in C define: of the configuration manifold, of steps and of named frames.

use super::super::body::{CBodyScope, write_program};
use super::super::handwritten::{LIMITS, joint_manifold_signatures};
use super::super::mechanism::{ExportedMechanism, is_zero_output};
use super::super::signatures::ExportedSignature;
use super::super::template::TemplateValues;
use super::functions::{function_definition, function_head};
use crate::catalogue::{Argument, GeneratedId};
use crate::lower::Program;
use crate::mechanism::{Chart, SuppliedQuantity};
use std::fmt::Write;

/// Returns the placeholders and conditions of the templates for a mechanism.
pub fn mechanism_template_values(i: &ExportedMechanism<'_>) -> TemplateValues {
    let (n, m, time) = (i.nv(), i.nu(), i.model.time);
    let mut template = TemplateValues::default();
    let (handwritten, joints) =
        (&i.functions[i.public.len() + i.reactions.len()..], joint_manifold_signatures(i));
    for f in handwritten {
        template.add_value(&f.name, &function_head(i, f));
    }
    let (functions, kind) =
        if i.has_generalized_speeds() { (&joints[..], "static ") } else { (handwritten, "") };
    for f in functions {
        let name = f.name.strip_prefix("joints_").unwrap_or(&f.name);
        template.add_value(&format!("{name}_of_joints"), &format!("{kind}{}", function_head(i, f)));
    }
    let chart_indices = |wanted: fn(&Chart) -> Option<usize>| -> Vec<usize> {
        i.output.charts.iter().filter_map(wanted).collect()
    };
    let velocities = [
        (
            "PLAINS",
            "PLAIN_JOINTS",
            chart_indices(|chart| if let Chart::Plain(_, v) = chart { Some(v.0) } else { None }),
        ),
        (
            "BALLS",
            "BALL_JOINTS",
            chart_indices(|chart| if let Chart::Ball(_, v) = chart { Some(v.0) } else { None }),
        ),
        (
            "FREES",
            "FREE_JOINTS",
            chart_indices(|chart| if let Chart::Free(_, v) = chart { Some(v.0) } else { None }),
        ),
    ];
    for (count, list, velocities) in velocities {
        template.add_condition(count, !velocities.is_empty());
        template.add_value(count, &velocities.len());
        template.add_value(list, &join_with_commas(&velocities));
    }
    let derivatives = i.find_derived_function(GeneratedId::InputDerivatives);
    let has_nonzero_block =
        |at: usize| derivatives.is_some_and(|f| (at..at + n * n).any(|k| !is_zero_output(f, k)));
    let conditions = [
        ("OWN", i.takes_parameter_struct()),
        ("TIME", time),
        ("INPUTS", m > 0),
        ("SPEEDS", i.has_generalized_speeds()),
        ("DERIVATIVES", i.has_derivatives()),
        ("TRANSITIONS", i.has_transitions),
        ("LINKS", !i.output.links.is_empty()),
        ("FORCES_BY_Q", has_nonzero_block(n)),
        ("FORCES_BY_V", has_nonzero_block(n + n * n)),
    ];
    conditions.into_iter().for_each(|(name, holds)| template.add_condition(name, holds));
    add_placeholder_values(&mut template, i);
    template
}

/// Adds the values of placeholders for arguments, names and sizes.
fn add_placeholder_values(template: &mut TemplateValues, i: &ExportedMechanism<'_>) {
    let (n, m, time) = (i.nv(), i.nu(), i.model.time);
    let text_if = |holds: bool, text: &'static str| if holds { text } else { "" };
    let (rates, changes) = if i.has_generalized_speeds() { ("rates", "changes") } else { ("v", "a") };
    let start =
        if i.has_generalized_speeds() { ["@OWN@q, ", "@OWN_DECLARED@const double *q, "] } else { ["", ""] };
    let forces =
        i.function_call_text("generalized_forces", &[i.input_force_argument_names(), &["tau"]].concat());
    let values: [(&str, &dyn ToString); 22] = [
        ("FORCES", &forces),
        ("RATES", &rates),
        ("CHANGES", &changes),
        ("START", &start[0]),
        ("START_DECLARED", &start[1]),
        ("OWN", &text_if(i.takes_parameter_struct(), "self, ")),
        ("OWN_DECLARED", &text_if(i.takes_parameter_struct(), "const struct @PREFIX@ *self, ")),
        (
            "UNUSED",
            &(text_if(i.takes_parameter_struct(), "    (void)(self);\n").to_string()
                + text_if(time, "    (void)(t);\n")),
        ),
        ("T", &text_if(time, "t, ")),
        ("T_DECLARED", &text_if(time, "double t, ")),
        ("LATER", &text_if(time, "t + s, ")),
        ("H_DECLARED", &text_if(!time, ", double *by_h")),
        ("H_PASSED", &text_if(!time, ", by_h")),
        ("PREFIX", &i.prefix),
        ("NQ", &i.nq().max(1)),
        ("NV", &n.max(1)),
        ("NU", &m.max(1)),
        ("N", &n),
        ("M", &m),
        ("COLUMNS", &(2 * n + m + usize::from(!time))),
        ("LINKS", &i.output.links.len()),
        ("FRAMES", &i.output.frames.len()),
    ];
    values.iter().for_each(|(name, value)| template.add_value(name, *value));
}

/// Returns the definitions of limits, and of functions of the configuration manifold, of steps and of frames.
pub fn kinematic_definitions(i: &ExportedMechanism<'_>, is_late: bool) -> String {
    let template = mechanism_template_values(i);
    let mut text = limits_definition(i);
    let joints = joint_manifold_signatures(i);
    let (functions, hidden) =
        if i.has_generalized_speeds() { (&joints, "static ") } else { (&i.functions, "") };
    for name in ["integrate", "difference", "tangent_rate"] {
        let has_name_without_prefix =
            |f: &&ExportedSignature| f.name.strip_prefix("joints_").unwrap_or(&f.name) == name;
        if let Some(f) = functions.iter().rev().find(has_name_without_prefix) {
            let _ = writeln!(
                text,
                "{hidden}{}",
                function_definition(i, f, &manifold_function_statements(i, name))
            );
        }
    }
    let mut write =
        |holds: bool, part: &str| text.push_str(&if holds { template.fill(part) } else { String::new() });
    write(i.has_derivatives(), include_str!("templates/manifold.c"));
    write(i.has_generalized_speeds(), include_str!("templates/speeds.c"));
    write(i.has_steps, include_str!("templates/steps.c"));
    if !i.output.frames.is_empty() {
        text.push_str(&frame_definitions(i, template, is_late));
    }
    text
}

/// Returns the statements of a function of the configuration manifold, joint by joint.
pub fn manifold_function_statements(i: &ExportedMechanism<'_>, name: &str) -> String {
    let mut text = String::new();
    for chart in &i.output.charts {
        let (kind, q, v) = match *chart {
            Chart::Plain(q, v) => ("plain", q.0, v.0),
            Chart::Ball(q, v) => ("ball", q.0, v.0),
            Chart::Free(q, v) => ("free", q.0, v.0),
        };
        let _ = match (kind, name) {
            ("plain", "integrate") => writeln!(text, "    result[{q}] = q[{q}] + dv[{v}];"),
            ("plain", "difference") => writeln!(text, "    result[{v}] = to[{q}] - from[{q}];"),
            ("plain", _) => writeln!(text, "    result[{v}] = v[{v}];"),
            (_, "integrate") => writeln!(text, "    lw_{kind}_integrate(q + {q}, dv + {v}, result + {q});"),
            (_, "difference") => {
                writeln!(text, "    lw_{kind}_difference(from + {q}, to + {q}, result + {v});")
            }
            _ => writeln!(text, "    lw_{kind}_tangent_rate(dv + {v}, v + {v}, result + {v});"),
        };
    }
    text
}

/// Returns the function for the bounds of coordinates, velocities and forces.
fn limits_definition(i: &ExportedMechanism<'_>) -> String {
    let (Some(limits), Some(signature)) = (i.limits, i.signature(LIMITS)) else { return String::new() };
    let mut places = Vec::new();
    for limit in &i.model.limits {
        let bounds = limit.bounds().into_iter().zip(&signature.results);
        places.extend(
            bounds
                .filter(|(bound, _)| bound.is_some())
                .map(|(_, array)| format!("{}[{}]", array.name, limit.v)),
        );
    }
    let mut body = format!("    for (int k = 0; k < {}; ++k) {{\n", i.nv());
    for (array, sign) in signature.results.iter().zip(["-", "", "", ""]) {
        let _ = writeln!(body, "        {}[k] = {sign}HUGE_VAL;", array.name);
    }
    body.push_str("    }\n");
    let scope = CBodyScope { arguments: &[], parameters: &i.parameters, tables: &i.tables, is_late: false };
    write_program(&mut body, &limits.program, &scope, &|k| places.get(k).cloned());
    function_definition(i, signature, &body) + "\n"
}

/// Returns the functions of named frames. Links are traversed from the ground outwards, with one step per
/// link.
fn frame_definitions(i: &ExportedMechanism<'_>, mut template: TemplateValues, is_late: bool) -> String {
    use Argument::{A, Q, V};
    let (links, frames) = (&i.output.links, &i.output.frames);
    let parent_argument = |n| Argument::Given("p", SuppliedQuantity::Parent, n);
    let link_index_text = |link: Option<usize>| link.map_or("-1".to_string(), |k| k.to_string());
    let mut add_recursion_step =
        |name: &str, is_link: bool, given: &[Argument], programs: Vec<Option<&Program>>| {
            let time = (is_link && i.model.time).then_some(Argument::T);
            let arguments: Vec<Argument> = time.into_iter().chain(given.iter().copied()).collect();
            template.add_value(name, &recursion_step_definition(i, name, &arguments, &programs, is_late));
        };
    let programs_of_links = |program: fn(&crate::derive::LinkRecursionPrograms) -> &Program| {
        links.iter().map(|link| Some(program(link))).collect::<Vec<_>>()
    };
    add_recursion_step(
        "link_placement",
        true,
        &[Q, parent_argument(12)],
        programs_of_links(|link| &link.placement),
    );
    add_recursion_step(
        "link_twist",
        true,
        &[Q, V, parent_argument(6)],
        programs_of_links(|link| &link.twist),
    );
    add_recursion_step(
        "link_acceleration",
        true,
        &[Q, V, A, parent_argument(12)],
        programs_of_links(|link| &link.acceleration),
    );
    let origin = Argument::Given("o", SuppliedQuantity::Origin, 3);
    add_recursion_step(
        "link_columns",
        true,
        &[Q, parent_argument(12), origin],
        programs_of_links(|link| &link.columns),
    );
    let has_placement_of_link =
        |frame: &crate::derive::FrameRecursionPrograms| frame.is_link && frame.link.is_some();
    let placements =
        frames.iter().map(|frame| (!has_placement_of_link(frame)).then_some(&frame.placement)).collect();
    add_recursion_step("placement_on_link", false, &[parent_argument(12)], placements);
    add_recursion_step(
        "twist_on_link",
        false,
        &[parent_argument(18)],
        frames.iter().map(|f| Some(&f.twist)).collect(),
    );
    let accelerations = frames.iter().map(|f| Some(&f.acceleration)).collect();
    add_recursion_step("acceleration_on_link", false, &[parent_argument(24)], accelerations);
    let columns: Vec<usize> = links.iter().flat_map(|link| link.velocities.iter().copied()).collect();
    let counts = links.iter().map(|link| link.velocities.len());
    let firsts = counts.clone().scan(0, |sum, count| Some(std::mem::replace(sum, *sum + count)));
    let firsts: Vec<usize> = firsts.chain([columns.len()]).collect();
    let parents: Vec<String> = links.iter().map(|link| link_index_text(link.parent)).collect();
    let carriers: Vec<String> = frames.iter().map(|frame| link_index_text(frame.link)).collect();
    template.add_value("PARENTS", &join_with_commas(&parents));
    template.add_value("CARRIERS", &join_with_commas(&carriers));
    template.add_value("FIRST_COLUMNS", &join_with_commas(&firsts));
    template.add_value(
        "COLUMNS_OF_LINKS",
        &if columns.is_empty() { "0".to_string() } else { join_with_commas(&columns) },
    );
    template.add_value("MOST_COLUMNS", &counts.max().unwrap_or(1).max(1));
    template.fill(include_str!("templates/frames.c"))
}

/// Returns the function of a step of the recursion: a switch over links or frames. Without a program, the
/// placement is that of the link.
fn recursion_step_definition(
    i: &ExportedMechanism<'_>,
    name: &str,
    arguments: &[Argument],
    programs: &[Option<&Program>],
    is_late: bool,
) -> String {
    let scope = CBodyScope { arguments, parameters: &i.parameters, tables: &i.tables, is_late };
    let mut body = String::new();
    for (k, program) in programs.iter().enumerate() {
        let _ = writeln!(body, "    case {k}: {{");
        match program {
            Some(program) => {
                write_program(&mut body, program, &scope, &|k| Some(format!("result[{k}]")));
            }
            None => body.push_str("    for (int k = 0; k < 12; ++k) {\n        result[k] = p[k];\n    }\n"),
        }
        body.push_str("    break;\n    }\n");
    }
    let own =
        if i.takes_parameter_struct() { format!("const struct {} *self, ", i.prefix) } else { String::new() };
    let declared: String = arguments
        .iter()
        .map(|a| {
            if *a == Argument::T {
                "double t, ".to_string()
            } else {
                format!("const double *{}, ", a.argument_name())
            }
        })
        .collect();
    let names =
        arguments.iter().map(|a| a.argument_name()).chain(i.takes_parameter_struct().then_some("self"));
    let unused: String = names.map(|name| format!("    (void)({name});\n")).collect();
    format!(
        "static void lw_{name}(int which, {own}{declared}double *result) {{\n{unused}    \
         (void)(result);\n    switch (which) {{\n{body}    default:\n        break;\n    }}\n}}\n\n"
    )
}

fn join_with_commas<T: ToString>(list: &[T]) -> String {
    list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}
