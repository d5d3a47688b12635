//! Size of the generated code. rustc's time and memory grow with the number of calls, bindings and
//! statements, independently of the machine code.

use linkwork_compiler::expand;
use std::fmt::Write;
use std::path::Path;

/// Returns the generated code of a chain of pins.
fn chain_code(n: usize) -> String {
    let (mut item, mut parent) = ("struct Chain {".to_string(), "ground".to_string());
    for k in 1..=n {
        let axis = ["x", "y", "z"][k % 3];
        let _ = writeln!(
            item,
            "#[body(mass = 1, com = 0.2 * z, inertia = diagonal(0.03, 0.04, 0.02))] link{k}: Body,
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
    let (short, long) = (chain_code(16), chain_code(32));

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

    // The lanes of a vector are stored to a column, or to adjacent columns, by one call.
    let each = long.matches("Ops::store_two").count();
    let together = long.matches("Ops::store_rows").count() + long.matches("Ops::store_columns").count();
    assert!(together > 4 * each, "{each} pairs and {together} vectors are stored");
}
