//! Exported functions in the form that CasADi and acados load.

use crate::compiled::{available_c_compilers, export_c_code, test_folder};
use std::path::Path;
use std::process::Command;

/// Returns a Python interpreter that has CasADi: that of `LINKWORK_PYTHON`, or the system's.
fn python_with_casadi() -> Option<String> {
    let python = std::env::var("LINKWORK_PYTHON").unwrap_or_else(|_| "python3".to_string());
    let has =
        Command::new(&python).args(["-c", "import casadi, numpy"]).output().is_ok_and(|o| o.status.success());
    has.then_some(python)
}

/// Checks that CasADi loads functions with the correct values and Jacobians, and that acados' functions have
/// consistent sizes.
#[test]
fn casadi_functions_have_correct_values_and_jacobians() {
    let Some(compiler) = available_c_compilers().into_iter().next() else {
        println!("skipped: there is no C compiler");
        return;
    };
    let folder = test_folder("casadi");
    let fixed = ["cart_mass=1.2", "pole_mass=0.3", "pole_length=0.8", "rail_damping=0.4"];
    let set: Vec<&str> = fixed.iter().flat_map(|value| ["--set", value]).collect();
    export_c_code(
        &folder,
        &[&["../../models/src/cart_pole.rs", "--prefix", "fixed", "--casadi"], &set[..]].concat(),
    );
    export_c_code(
        &folder,
        &["../../models/src/cart_pole.rs", "--prefix", "open", "--casadi", "--set", "cart_mass=1.2"],
    );
    export_c_code(
        &folder,
        &["tests/mechanisms/mod.rs", "--struct", "Balloon", "--prefix", "timed", "--casadi"],
    );
    for prefix in ["fixed", "open", "timed"] {
        let done = Command::new(compiler)
            .current_dir(&folder)
            .args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O1", "-fPIC", "-shared", "-o"])
            .args([
                format!("lib{prefix}.so"),
                format!("{prefix}.c"),
                format!("{prefix}_casadi.c"),
                "-lm".to_string(),
            ])
            .output()
            .expect("the compiler starts");
        assert!(done.status.success(), "{prefix}: {}", String::from_utf8_lossy(&done.stderr));
    }
    let Some(python) = python_with_casadi() else {
        println!("skipped: there is no CasADi (LINKWORK_PYTHON names a Python that has it)");
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/casadi_functions.py");
    let run = Command::new(python).arg(script).current_dir(&folder).output().expect("Python starts");
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
}

/// Checks the errors for parameters that cannot be fixed, and for single precision, which CasADi does not
/// support.
#[test]
fn options_without_casadi_support_are_rejected() {
    for (arguments, part) in [
        (["--set", "mass=1"], "there is no parameter `mass` to be fixed"),
        (["--scalar", "float"], "CasADi has no functions of single precision"),
        (["--set", "cart_mass"], "expected NAME=VALUE"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_linkwork"))
            .args(["export", "c", "../../models/src/cart_pole.rs", "--casadi"])
            .args(arguments)
            .arg("--out")
            .arg(test_folder("refused"))
            .output()
            .expect("the command starts");
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!output.status.success() && stderr.contains(part), "{stderr}");
    }
}
