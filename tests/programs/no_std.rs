//! Generated code needs no standard library and no allocator, and contains no panic: the program in
//! `tests/no_std` has a panic handler that cannot be linked.
#![cfg(unix)]

use linkwork_programs::run_cargo;
use std::path::Path;
use std::process::{Command, Output};

fn build_program(program: &str) -> Output {
    run_cargo(&["build", "--bin", program], "no_std", env!("CARGO_TARGET_TMPDIR"))
}

#[test]
fn control_step_contains_no_panic_path() {
    let output = build_program("linkwork-no-std");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("packages/release/linkwork-no-std");
    let status = Command::new(program).status().expect("the program starts");
    assert!(status.success(), "the arm arrives, and everything agrees: {status}");
}

#[test]
fn panic_path_in_a_control_step_is_detected() {
    let output = build_program("panics");
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success(), "a program that can panic was linked");
    assert!(text.contains("linkwork_panic_path_reached"), "{text}");
}
