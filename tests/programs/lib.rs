//! Packages of their own, in the folders beside this one, that tests build or run.

use std::path::Path;
use std::process::{Command, Output};

/// Calls cargo with a command for a package in release mode; it builds in the folder `packages` of `target`,
/// which is `env!("CARGO_TARGET_TMPDIR")`: all packages share the compiler there. Without network, unless
/// something is missing.
pub fn cargo(command: &[&str], package: &str, target: &str) -> Output {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(package).join("Cargo.toml");
    let cargo = |network: &[&str]| {
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
    let offline = cargo(&["--offline"]);
    let text = String::from_utf8_lossy(&offline.stderr);
    // A crate that nothing else of the workspace needs may not have been fetched yet.
    if offline.status.success() || !text.contains("--offline") { offline } else { cargo(&[]) }
}
