//! Arm with a row of springs, compiled in process: derivation and generated code for few springs and for
//! many.

use linkwork_compiler::derive::DerivationOutput;
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::mechanism::Quantity;
use linkwork_compiler::{compile, expand, parse_source_and_import};
use proc_macro2::TokenStream;
use std::ops::Range;
use std::path::Path;
use support::compare::assert_close_relative_to_largest;
use support::random::Random;

/// Returns the source of an arm of three spatial pins with a range of springs from a row, some of them with
/// dashpots in parallel.
fn arm_source_with_springs(springs: Range<usize>) -> [TokenStream; 2] {
    let mut item = "struct Arm {".to_string();
    let mut parent = "ground".to_string();
    for (k, axis) in ["z", "y", "x"].into_iter().enumerate() {
        item += &format!(
            "#[body(mass = 2, com = 0.2 * z, inertia = diagonal(0.03, 0.04, 0.02))] link{k}: Body,
            #[joint({parent} -> link{k}, about = {axis})] joint{k}: Pin,"
        );
        parent = format!("link{k}.at(0.4 * z)");
    }
    for k in springs {
        let (x, y, z) = (0.1 + 0.01 * k as f64, 0.3 + 0.003 * k as f64, 0.1 + 0.002 * k as f64);
        item += &format!(
            "#[acts(between = (ground.at({x:.3} * x + {y:.3} * y), link{}.at({z:.3} * z)), stiffness = {}, \
             free_length = 0.{})] spring{k}: Spring,",
            k % 3,
            10 + k,
            1 + k % 9
        );
        if k.is_multiple_of(5) {
            item += &format!(
                "#[acts(between = (ground.at({y:.3} * x), link2.at({z:.3} * x)), damping = 2)] dashpot{k}: \
                 Dashpot,"
            );
        }
    }
    item.push('}');
    ["gravity = -9.81 * z, derivatives", &item].map(|text| text.parse().expect("the source is Rust"))
}

fn compile_mechanism([arguments, item]: [TokenStream; 2]) -> DerivationOutput {
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let source = parse_source_and_import(arguments, item, Path::new(""), &mut cx);
    let Some((_, output)) = source.and_then(|source| compile(&source, &graph, &mut cx)) else {
        panic!("{}", cx.full_message_texts().join("\n"));
    };
    output
}

/// Evaluates a generated function and the functions that it calls, at a state and an acceleration.
fn run_function(output: &DerivationOutput, name: &str, state: &[[f64; 3]; 3]) -> Option<Vec<f64>> {
    let f = output.functions.iter().find(|f| f.name == name)?;
    let called = ["__passive_forces", "__passive_derivatives"].map(|other| match other == name {
        true => Vec::new(),
        false if name.starts_with("__") => Vec::new(),
        false => run_function(output, other, state).unwrap_or_default(),
    });
    let state_value_of_symbol = |s| match Quantity::from_symbol(s) {
        Quantity::Configuration(k) => state[0][k],
        Quantity::Velocity(k) => state[1][k],
        Quantity::Acceleration(k) => state[2][k],
        Quantity::PassiveForce(k) => called[0][k],
        Quantity::PassiveDerivative(k) => called[1][k],
        _ => f64::NAN,
    };
    Some(f.program.interpret_program(&state_value_of_symbol))
}

/// Checks that the forces of springs add up. With few springs every function contains their forces; with many
/// springs all functions call a shared one.
#[test]
fn forces_of_many_springs_equal_sums_of_few() {
    const EACH: usize = 20;
    let (whole, none) = (
        compile_mechanism(arm_source_with_springs(0..5 * EACH)),
        compile_mechanism(arm_source_with_springs(0..0)),
    );
    let parts: Vec<DerivationOutput> =
        (0..5).map(|k| compile_mechanism(arm_source_with_springs(k * EACH..(k + 1) * EACH))).collect();
    let has_passive_forces_function =
        |output: &DerivationOutput| output.functions.iter().any(|f| f.name == "__passive_forces");
    assert!(
        has_passive_forces_function(&whole) && !parts.iter().any(has_passive_forces_function),
        "what is compared is derived in two ways"
    );
    let mut random = Random::new(36);
    for _ in 0..5 {
        let state: [[f64; 3]; 3] = std::array::from_fn(|_| random.random_vector::<3>(1.5).into());
        for name in ["bias_forces", "inverse_dynamics", "inverse_dynamics_derivatives", "momentum_rate"] {
            let values_of_output = |output: &DerivationOutput| {
                run_function(output, name, &state).expect("the function is there")
            };
            let without = values_of_output(&none);
            let mut sum = without.clone();
            for part in &parts {
                for (k, x) in values_of_output(part).into_iter().enumerate() {
                    sum[k] += x - without[k];
                }
            }
            assert_close_relative_to_largest(name, &values_of_output(&whole), &sum, 1e-11);
        }
    }
}

/// Checks that the numbers of operations and the length of generated code are linear in the number of
/// springs, which occur once in the forces, once in their derivatives and once in the energy.
#[test]
fn code_length_is_linear_in_the_number_of_springs() {
    let size_of_generated_code = |springs: usize| {
        let output = compile_mechanism(arm_source_with_springs(0..springs));
        let operation_count = |name: &str| {
            let f = output.functions.iter().find(|f| f.name == name).expect("the function is there");
            f.program.counts.total_operations()
        };
        for name in
            ["bias_forces", "inverse_dynamics", "forward_dynamics", "momentum_rate", "coriolis_matrix"]
        {
            assert!(operation_count(name) < 200, "{name}: {}", operation_count(name));
        }
        for name in ["inverse_dynamics_derivatives", "forward_dynamics_derivatives", "linearize"] {
            assert!(operation_count(name) < 600, "{name}: {}", operation_count(name));
        }
        let all: usize = output.functions.iter().map(|f| f.program.counts.total_operations()).sum();
        let [arguments, item] = arm_source_with_springs(0..springs);
        [all, expand(arguments, item, Path::new("")).text.len()]
    };
    let (some, more) = (size_of_generated_code(150), size_of_generated_code(300));
    for (some, more) in some.into_iter().zip(more) {
        assert!(10 * more <= 21 * some, "{more} of twice as many springs instead of {some}");
    }
}
