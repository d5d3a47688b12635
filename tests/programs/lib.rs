//! Runs cargo for the packages in the neighbouring folders, which tests build or run.

use std::path::Path;
use std::process::{Command, Output};

/// Calls cargo with a command for a package in release mode. It builds in the folder `packages` of `target`,
/// which is `env!("CARGO_TARGET_TMPDIR")`, so that all packages share the compiler. It uses the network only
/// if a dependency is missing.
pub fn run_cargo(command: &[&str], package: &str, target: &str) -> Output {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(package).join("Cargo.toml");
    let run_cargo = |network: &[&str]| {
        Command::new(env!("CARGO"))
            .args(command)
            .arg("--release")
            .args(network)
            .arg("--manifest-path")
            .arg(&manifest)
            .arg("--target-dir")
            .arg(Path::new(target).join("packages"))
            .output()
            .expect("cargo starts")
    };
    let offline = run_cargo(&["--offline"]);
    let text = String::from_utf8_lossy(&offline.stderr);
    // A crate that no other package of the workspace needs may not have been downloaded yet.
    if offline.status.success() || !text.contains("--offline") { offline } else { run_cargo(&[]) }
}
