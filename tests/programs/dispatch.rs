//! Selection of instructions at run time: the program in `tests/dispatch` compares it with compile-time
//! selection.
#![cfg(unix)]

use linkwork_programs::run_cargo;

/// Runs the program, which fails if the selections disagree.
fn run(options: &[&str]) {
    let output = run_cargo(&[&["run"], options].concat(), "dispatch", env!("CARGO_TARGET_TMPDIR"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn both_selections_agree() {
    run(&[]);
}

#[test]
fn both_selections_have_the_same_bits_in_reproducible_arithmetic() {
    run(&["--features", "reproducible"]);
}
