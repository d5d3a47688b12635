//! Code of the associated constants of a mechanism.

use super::interface::Interface;
use crate::derive::AssociatedConstant;
use crate::equations::PrintedEquations;
use crate::syntax::EquationsOption;
use std::fmt::Write;

/// Writes the sizes of configuration, velocity and inputs, and the names of their entries.
pub fn write_sizes_and_names(out: &mut String, i: &Interface<'_>) {
    let numbers = [
        ("NQ", i.configuration.len(), "configuration numbers"),
        ("NV", i.velocities.len(), "velocities"),
        ("NU", i.inputs.len(), "inputs"),
    ];
    for (name, value, what) in numbers {
        let _ = writeln!(out, "/// Number of {what}.\npub const {name}: usize = {value};");
    }
    let lists = [
        ("CONFIGURATION", &i.configuration, "every entry of `q`"),
        ("VELOCITIES", &i.velocities, "every entry of `v`"),
        ("INPUTS", &i.inputs, "every entry of `u`"),
    ];
    for (name, names, what) in lists {
        write_name_list_constant(out, name, names, what);
    }
}

/// Writes a list of names as a constant.
fn write_name_list_constant(out: &mut String, name: &str, names: &[String], what: &str) {
    let _ =
        writeln!(out, "/// Name of {what}.\npub const {name}: [&'static str; {}] = {names:?};", names.len());
}

/// Writes all constants: sizes, names, additional lists and equations.
pub fn write_constants(
    out: &mut String,
    i: &Interface<'_>,
    equations: &PrintedEquations,
    constants: &[AssociatedConstant],
) {
    write_sizes_and_names(out, i);
    write_name_list_constant(out, "FRAMES", &i.frames, "every frame");
    for AssociatedConstant { name, docs, item, list } in constants {
        let (n, list) = (list.len(), list.join(", "));
        let _ = writeln!(out, "/// {docs}\npub const {name}: [{item}; {n}] = [{list}];");
    }
    let structure = unexpanded_motion_equations(i);
    let (is_short, equations) =
        match equations.plain.is_empty() && !i.velocities.is_empty() && !i.facts.kinematic {
            true => (true, &structure),
            false => (false, equations),
        };
    let texts = [
        (
            "EQUATIONS",
            &equations.plain,
            match is_short {
                true => {
                    "The structure of the equations of motion as text, and the option that prints all of \
                     their terms."
                }
                false => {
                    "The equations of motion as text, in the names of the mechanism, with the Lagrangian, \
                     the kinetic energy, the Hamiltonian or the Routhian before them."
                }
            },
        ),
        (
            "EQUATIONS_LATEX",
            &equations.latex,
            "[`EQUATIONS`](Self::EQUATIONS) as LaTeX: an `aligned` environment of `amsmath`, with line \
             breaks that fit a page, for display mathematics between `\\[` and `\\]`.",
        ),
    ];
    for (name, text, about) in texts {
        let about = match text.as_str() {
            "" if i.velocities.is_empty() => "Empty: nothing moves.",
            "" if i.facts.kinematic => "Empty: without inertia there are no equations of motion.",
            _ => about,
        };
        // Rustdoc would show a plain literal with all its escapes.
        let _ = writeln!(out, "/// {about}\npub const {name}: &'static str = [{text:?}][0];");
    }
}

/// Writes the function that returns the index of a frame by name. For a mechanism that failed to compile it
/// accepts every name: the names of its frames are unknown, and its own errors are already reported.
pub fn write_frame_index_function(out: &mut String, failed: bool) {
    let found = "::linkwork::index_of(&Self::FRAMES, name)";
    let value = match failed {
        true => format!("match {found} {{ None => ::core::option::Option::Some(0), found => found }}"),
        false => found.to_string(),
    };
    let _ = writeln!(
        out,
        "/// Index in `FRAMES` of the frame with a name; `frame!` checks it at compile time.
        #[must_use]
        pub const fn frame_index(name: &str) -> ::core::option::Option<usize> {{ {value} }}"
    );
}

/// Returns the structure of the equations of motion, for mechanisms whose terms are not printed.
fn unexpanded_motion_equations(i: &Interface<'_>) -> PrintedEquations {
    let time = if i.facts.time { "t, " } else { "" };
    let constrained = i.facts.constraints.is_some();
    let (held, held_latex) = if constrained { (" + J^T lambda", " + J^T \\lambda") } else { ("", "") };
    let mut plain = format!("M({time}q) v' + h({time}q, v) = tau{held}\n");
    let mut latex =
        format!("\\begin{{aligned}}\n& M({time}q)\\, \\dot v + h({time}q, v) = \\tau{held_latex}");
    if constrained {
        let _ = writeln!(plain, "J({time}q) v' + b({time}q, v) = 0");
        let _ = write!(latex, " \\\\\n& J({time}q)\\, \\dot v + b({time}q, v) = 0");
    }
    plain.push_str(match i.facts.requests.equations {
        EquationsOption::Structure => "\nThe option `equations = structure` omits the terms.\n",
        _ => {
            "\nThere are too many terms to be readable. The option `equations = lagrange` of `#[mechanism]` \
             prints\nup to some thousand; `kane`, `hamilton` and `routh` print other forms, if available.\n"
        }
    });
    latex.push_str("\n\\end{aligned}\n");
    PrintedEquations { plain, latex, mathml: String::new() }
}
