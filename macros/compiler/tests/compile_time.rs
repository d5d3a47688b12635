//! Properties of generated code on which rustc's time and memory depend: its length, and the number of calls,
//! bindings and statements.

use linkwork_compiler::expand;
use std::fmt::Write;
use std::path::Path;

/// Returns the code generated for a chain of revolute joints, with derivatives.
fn generated_chain_code(pins: usize) -> String {
    let mut item = "struct S {\n".to_string();
    let mut parent = "ground".to_string();
    for k in 0..pins {
        let axis = ["z", "y", "x"][k % 3];
        let _ = writeln!(
            item,
            "#[body(mass = 2, com = 0.2 * z, inertia = diagonal(0.03, 0.04, 0.02))] link{k}: Body,
            #[joint({parent} -> link{k}, about = {axis})] joint{k}: Pin,"
        );
        parent = format!("link{k}.at(0.4 * z)");
    }
    item += "}";
    let arguments = "gravity = -9.81 * z, derivatives".parse().unwrap();
    let emitted = expand(arguments, item.parse().unwrap(), Path::new(""));
    format!("{}{}", emitted.tokens, emitted.text)
}

#[test]
fn generated_code_of_chains_grows_linearly() {
    let (short, long) = (generated_chain_code(16), generated_chain_code(32));

    // Jacobians of frames grow linearly with the number of links.
    let count_jacobians = |code: &str| code.matches("_columns(").count();
    assert!(
        count_jacobians(&long) < 3 * count_jacobians(&short),
        "{} and {}",
        count_jacobians(&short),
        count_jacobians(&long)
    );

    // The product of a number and lanes is one call, and blocks assign values instead of returning tuples.
    for code in [&short, &long] {
        assert!(code.contains("scale_add8(") && !code.contains("(splat8("), "numbers are not spread first");
        let bodies = code.replace("const _: () = {\n", "");
        assert!(!bodies.contains(") = {\n"), "blocks have no values");
    }
    assert!(long.contains("\n{\n"), "large bodies have blocks");

    // The lanes of a vector are stored to a column, or to adjacent columns, by one call. Derivatives of longer
    // chains are computed in loops.
    let middle = generated_chain_code(11);
    let each = middle.matches("Ops::store_two_lanes_in_column").count();
    let together =
        middle.matches("Ops::store_lanes_in_column").count() + middle.matches("Ops::store_two_rows").count();
    assert!(together > 4 * each, "{each} pairs and {together} vectors are stored");
}

/// Returns the identifiers that occur in a text of Rust code.
fn identifiers_in_text(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|name| !name.is_empty())
}

/// rustc searches all definitions of a crate for each unused variable.
#[test]
fn unused_inputs_are_not_bound() {
    let code = generated_chain_code(6);
    let mut bound = 0;
    for function in code.split("fn ") {
        for line in function.lines().filter(|line| line.starts_with("let [")) {
            let pattern = line.split('=').next().unwrap();
            for name in identifiers_in_text(pattern)
                .filter(|name| !matches!(*name, "let" | "_") && !name.starts_with("dv"))
            {
                assert!(
                    identifiers_in_text(function).filter(|other| *other == name).count() > 1,
                    "{name} in\n{function}"
                );
                bound += 1;
            }
        }
    }
    assert!(bound > 50, "{bound}");
}

/// Checks that the statements of a long function are generated once: the function that returns matrices calls
/// the function that fills matrices of the caller.
#[test]
fn statements_of_long_functions_are_generated_once() {
    let head = "fn inverse_dynamics_derivatives(";
    let body_of_function =
        |code: &str| code.split(head).nth(1).and_then(|rest| rest.split("fn ").next()).map(str::to_string);
    let (short, long) = (
        body_of_function(&generated_chain_code(3)).unwrap(),
        body_of_function(&generated_chain_code(18)).unwrap(),
    );
    assert!(long.contains("self.inverse_dynamics_derivatives_into("), "{long}");
    assert!(!short.contains("self.inverse_dynamics_derivatives_into("), "{short}");
}
