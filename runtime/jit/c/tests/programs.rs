//! Test programs in C and C++, compiled and run with the library.

use std::path::Path;
use std::process::Command;

fn compile_and_run_program(compiler: &str, file: &str) -> Result<(), Box<dyn std::error::Error>> {
    if Command::new(compiler).arg("--version").output().is_err() {
        println!("skipped: there is no {compiler}");
        return Ok(());
    }
    let own = std::env::current_exe()?;
    // Cargo writes the library next to the tests.
    let folder = own.parent().ok_or("no folder")?;
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = folder.join(format!("linkwork_{}", file.replace('.', "_")));
    let output = Command::new(compiler)
        .args(["-Wall", "-Wextra", "-Werror", "-I"])
        .arg(here.join("include"))
        .arg(here.join("tests").join(file))
        .arg("-o")
        .arg(&program)
        .arg("-L")
        .arg(folder)
        .args(["-llinkwork_c", "-lm"])
        .arg(format!("-Wl,-rpath,{}", folder.display()))
        .output()?;
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output = Command::new(&program).output()?;
    assert!(output.status.success(), "{file}: {}", String::from_utf8_lossy(&output.stderr));
    Ok(())
}

#[test]
fn programs_in_c_run() -> Result<(), Box<dyn std::error::Error>> {
    compile_and_run_program("cc", "pendulum.c")
}

#[test]
fn programs_in_cpp_run() -> Result<(), Box<dyn std::error::Error>> {
    compile_and_run_program("c++", "pendulum.cpp")
}
