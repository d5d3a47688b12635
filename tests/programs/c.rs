//! Controller without the standard library in a C program: `models/examples/controller_for_c`.
#![cfg(unix)]

use linkwork_programs::run_cargo;
use std::path::Path;
use std::process::Command;

#[test]
fn c_program_balances_two_poles() {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let output = run_cargo(&["build"], "../models/examples/controller_for_c", env!("CARGO_TARGET_TMPDIR"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));

    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/examples/controller_for_c/main.c");
    let (library, program) = (target.join("packages/release/libcontroller.a"), target.join("balance"));
    let arguments = ["-Wall", "-Wextra", "-Werror", "-o"];
    let compiled = Command::new("cc").args(arguments).arg(&program).arg(&source).arg(&library).output();
    let Ok(compiled) = compiled else {
        println!("skipped: there is no C compiler `cc`");
        return;
    };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new(program).output().expect("the program starts");
    assert!(
        run.status.success(),
        "the poles stand: {}\n{}",
        run.status,
        String::from_utf8_lossy(&run.stdout)
    );
}
