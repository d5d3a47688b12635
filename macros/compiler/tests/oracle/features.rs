//! Random mechanisms with all features of the language. Each compiles or is rejected with an error of the
//! user's, never with an internal error. Generated code refers only to values that it defines, and its
//! results are consistent.

mod agreement;
mod bodies;
mod chosen;
mod constrained;
mod source;
mod values;

use crate::test_seeds;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::{check_mechanism, compile, expand, parse_source_and_import};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Returns the values `t0`, `t1`, … in a function's text.
fn numbered_value_names(text: &str) -> BTreeSet<&str> {
    let is_word_character = |c: char| c.is_ascii_alphanumeric() || c == '_';
    text.split(|c| !is_word_character(c))
        .filter(|word| {
            word.strip_prefix('t').is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
        })
        .collect()
}

/// Returns the values that functions use but do not define. A definition is between `let` and `=` or `;`, or
/// precedes ` = ` at the start of a line.
fn unbound_values(text: &str) -> Vec<String> {
    let mut missing = Vec::new();
    for function in text.split("fn ").skip(1) {
        let mut bound = BTreeSet::new();
        for line in function.lines().map(str::trim_start) {
            let statement = line.strip_prefix("let ").unwrap_or(line);
            let is_binding = line.starts_with("let ") || line.starts_with('t') || line.starts_with('(');
            if let Some(left) = statement.split([';', '=']).next().filter(|_| is_binding) {
                bound.extend(numbered_value_names(left));
            }
        }
        missing.extend(
            numbered_value_names(function)
                .difference(&bound)
                .map(|name| format!("{name} in {}", function.lines().next().unwrap_or(""))),
        );
    }
    missing
}

/// Returns the generated code of a mechanism as text, or the error messages.
fn generated_code_or_errors(arguments: &str, item: &str) -> String {
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let emitted = expand(parse_tokens(arguments), parse_tokens(item), Path::new(""));
    format!("{}{}", emitted.tokens, emitted.text)
}

/// Returns the messages for the mechanisms of these seeds, ordered by increasing frequency.
fn messages_by_frequency(seeds: std::ops::Range<u64>) -> String {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    for (arguments, item) in seeds.map(source::random_source) {
        let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
        for message in check_mechanism(parse_tokens(&arguments), parse_tokens(&item), Path::new("")) {
            *counts.entry(message.lines().next().unwrap_or_default().to_string()).or_default() += 1;
        }
    }
    let mut lines: Vec<(usize, String)> = counts.into_iter().map(|(message, n)| (n, message)).collect();
    lines.sort();
    lines.iter().map(|(n, message)| format!("{n} {message}\n")).collect()
}

/// Checks that random mechanisms either compile or are rejected with an error. If the variable
/// `LINKWORK_SOURCES` names a file, the compilable ones are written to it, one module each, for a check with
/// rustc.
#[test]
fn random_mechanisms_compile_or_get_an_error() {
    let (mut compiled, mut modules) = (0, String::new());
    let all = test_seeds(120);
    for seed in all.clone() {
        let (arguments, item) = source::random_source(seed);
        let text = generated_code_or_errors(&arguments, &item);
        assert!(!text.contains("Linkwork made a mistake"), "seed {seed}\n#[mechanism({arguments})]\n{item}");
        let missing = unbound_values(&text);
        assert!(missing.is_empty(), "seed {seed}: {missing:?}\n#[mechanism({arguments})]\n{item}");
        if !text.contains("compile_error") {
            compiled += 1;
            modules += &format!(
                "pub mod seed_{seed} {{\nuse linkwork::prelude::*;\n#[mechanism({arguments})]\n{item}\n}}\n"
            );
        }
    }
    if let Ok(path) = std::env::var("LINKWORK_SOURCES") {
        std::fs::write(path, modules).expect("the file is written");
    }
    // Usually two of five mechanisms compile.
    let most = all.end - all.start;
    assert!(
        4 * compiled > most,
        "only {compiled} of {most} compile; others are answered\n{}",
        messages_by_frequency(all)
    );
}

/// A mechanism that exceeds the capacity for expressions is always rejected because its equations are too
/// long, for any capacity.
#[test]
fn overlong_mechanisms_are_rejected_at_any_capacity() {
    let parse_tokens = |text: &str| text.parse().expect("the source is Rust");
    let (mut long, all) = (0, test_seeds(60));
    for seed in all.clone() {
        let (arguments, item) = source::random_source(seed);
        let mut cx = Diagnostics::new();
        let Some(source) =
            parse_source_and_import(parse_tokens(&arguments), parse_tokens(&item), Path::new(""), &mut cx)
        else {
            continue;
        };
        for room in [40, 300 + 40 * (seed as usize % 100)] {
            let (graph, mut cx) = (Graph::graph_with_node_limit(room), Diagnostics::new());
            let compiled = compile(&source, &graph, &mut cx);
            assert!(graph.len() <= room);
            if graph.is_full() {
                long += 1;
                assert!(compiled.is_none() && cx.len() == 1, "seed {seed}: {:?}", cx.full_message_texts());
                assert!(
                    cx.full_message_texts()[0].contains("would be too long"),
                    "seed {seed}: {:?}",
                    cx.full_message_texts()
                );
            }
        }
    }
    assert!(long > all.end - all.start, "only {long} are too long");
}

#[test]
fn generated_functions_of_random_mechanisms_agree() {
    let all = test_seeds(60);
    let compared: Vec<usize> = all.clone().map(agreement::check_random_mechanism).collect();
    let (many, most) = (compared.iter().filter(|n| **n > 20).count() as u64, all.end - all.start);
    assert!(8 * many > most, "only {many} of {most} mechanisms have much to compare");
}

#[test]
fn generated_functions_of_chosen_mechanisms_agree() {
    for (arguments, fields, functions) in chosen::MECHANISMS {
        let item = format!("pub struct Any {{ {fields} }}");
        let compared = agreement::check_functions_of_mechanism(arguments, &item, functions, 0);
        assert!(compared > 20, "{compared} comparisons of #[mechanism({arguments})]\n{item}");
    }
    let item = format!("pub struct Any {{ {} }}", chosen::body_with_limbs_source(2, 3));
    let functions = ["inverse_dynamics_derivatives_into", "mass_matrix_into"];
    assert!(
        agreement::check_functions_of_mechanism(
            "gravity = -9.81 * y, derivatives, packed",
            &item,
            &functions,
            0
        ) > 20
    );
}

/// Checks a mechanism with many springs, whose passive forces are computed by one function that other
/// functions call.
#[test]
fn separately_computed_passive_forces_agree() {
    let fields = chosen::body_with_springs_source(SPRINGS);
    let item = format!("pub struct Any {{ {fields} }}");
    let functions = ["__passive_forces", "__passive_derivatives", "inverse_dynamics_derivatives"];
    assert!(
        agreement::check_functions_of_mechanism("gravity = -9.81 * y, derivatives", &item, &functions, 0)
            > 20
    );
    let text = generated_code_or_errors("gravity = -9.81 * y, derivatives", &item);
    for row in
        ["| passive forces, called by other functions |", "| their derivatives, called by other functions |"]
    {
        assert!(text.contains(row), "{row}");
    }
}

/// Number of springs for which the passive forces are a separate function.
const SPRINGS: usize = 120;

/// Bodies that are executed. Body 0 of two is that of debug builds.
const BODIES: [&str; 13] = [
    "mass_matrix, body 0",
    "mass_matrix, body 1",
    "mass_matrix_lanes, body 0",
    "mass_matrix_into, body 1",
    "mass_matrix_inverse, body 0",
    "inverse_dynamics, body 1",
    "forward_dynamics_lanes, body 0",
    "inverse_dynamics_derivatives, body 0",
    "inverse_dynamics_derivatives_into, body 0",
    "inverse_dynamics_derivatives_into, body 1",
    "inverse_dynamics_derivatives_into_lanes, body 1",
    "inverse_dynamics_second_derivatives, body 1",
    "__constrained_dynamics, body 0",
];

#[test]
fn emitted_bodies_compute_their_programs() {
    let mut run = BTreeSet::new();
    for seed in test_seeds(8) {
        let (arguments, item) = source::random_source(seed);
        run.extend(bodies::compare_interpreted_function_bodies(&format!("{arguments}, batch"), &item, seed));
    }
    for (arguments, fields, _) in chosen::MECHANISMS {
        run.extend(bodies::compare_interpreted_function_bodies(
            arguments,
            &format!("pub struct Any {{ {fields} }}"),
            0,
        ));
    }
    for fields in [chosen::chain_source(6), chosen::body_with_limbs_source(4, 2)] {
        let item = format!("pub struct Any {{ {fields} }}");
        run.extend(bodies::compare_interpreted_function_bodies(
            "gravity = -9.81 * y, derivatives, packed",
            &item,
            0,
        ));
    }
    let never: Vec<&str> = BODIES.into_iter().filter(|body| !run.contains(*body)).collect();
    assert_eq!(never, Vec::<&str>::new(), "these are not run");
}

/// Long bodies are divided into blocks, and sines and cosines are computed before the first block. Some of
/// them are results themselves.
#[test]
fn divided_functions_may_return_sines() {
    let text = generated_code_or_errors(
        "gravity = -9.81 * y, derivatives",
        "pub struct Any {
            mass: f64,
            #[body(mass = 0.791, com = [1.53, -1.02, 0.536], inertia = cylinder(0.791, 0.1, 0.3, y))] bolt: Body,
            #[joint(ground -> bolt, about = z, pitch = 0.1)] thread: Screw,
            #[body(mass = 1.05, inertia = rod(1.05, 1, x))] bob: Body,
            #[joint(ground -> bob)] ball: Ball,
            #[body(mass = mass, com = [1.08, -0.428, 0.674], inertia = rod(mass, 1, x))] arm: Body,
            #[joint(bob.at([0.469, -0.852, 0.326]) -> arm, about = unit([1, 2, 3]))] hinge: Pin,
        }",
    );
    assert!(!text.contains("compile_error"), "{text}");
    assert!(numbered_value_names(&text).len() > 200, "bodies are not long");
    assert_eq!(unbound_values(&text), Vec::<String>::new());
}
