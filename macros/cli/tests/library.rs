//! C program (`library/main.c`) that uses a library of a constrained mechanism, which the command `linkwork`
//! generates.
#![cfg(unix)]

use linkwork_programs::run_cargo;
use std::path::Path;
use std::process::{Command, Output};

fn assert_success(what: &str, output: &Output) {
    let (stdout, stderr) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{what}: {}\n{stdout}\n{stderr}", output.status);
}

#[test]
fn c_program_simulates_a_bead_on_a_wire() {
    let (target, own) = (Path::new(env!("CARGO_TARGET_TMPDIR")), Path::new(env!("CARGO_MANIFEST_DIR")));
    let folder = target.join("bead");
    let home = own.join("tests/library");
    let arguments = ["export", "library", "bead.rs", "--linkwork", "../../../..", "--out"];
    let mut export = Command::new(env!("CARGO_BIN_EXE_linkwork"));
    assert_success(
        "the library is written",
        &export.args(arguments).arg(&folder).current_dir(&home).output().unwrap(),
    );
    // The versions are those of the other programs, so that all share the compiler.
    std::fs::copy(own.join("../../Cargo.lock"), folder.join("Cargo.lock")).unwrap();
    let package = folder.to_str().expect("a path of this machine");
    // Without optimisation, the library is there in a third of the time.
    let command = ["build", "--config", "profile.release.package.bead.opt-level=0"];
    assert_success("the library is built", &run_cargo(&command, package, env!("CARGO_TARGET_TMPDIR")));

    for (library, name) in [("libbead.a", "static"), ("libbead.so", "shared")] {
        let (library, program) = (target.join("packages/release").join(library), target.join(name));
        if !library.exists() {
            continue;
        }
        let warnings = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I"];
        let compiled = Command::new("cc")
            .args(warnings)
            .arg(folder.join("include"))
            .arg(home.join("main.c"))
            .arg(&library)
            .args(["-lm", "-lpthread", "-ldl", "-o"])
            .arg(&program)
            .output();
        let Ok(compiled) = compiled else {
            println!("skipped: there is no C compiler `cc`");
            return;
        };
        assert_success("the program is compiled", &compiled);
        let mut run = Command::new(program);
        run.env("LD_LIBRARY_PATH", target.join("packages/release"));
        assert_success("the bead is where it should be", &run.output().expect("the program starts"));
    }
}
