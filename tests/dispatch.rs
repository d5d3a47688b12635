//! The choice of instructions at run time: the program in `dispatch/` compares both ways.
#![cfg(unix)]

use std::path::Path;
use std::process::Command;

#[test]
fn both_ways_agree() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("dispatch/Cargo.toml");
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("dispatch");
    let cargo = |network: &[&str]| {
        Command::new(env!("CARGO"))
            .args(["run", "--release"])
            .args(network)
            .arg("--manifest-path")
            .arg(&manifest)
            .arg("--target-dir")
            .arg(&target)
            .output()
            .expect("cargo starts")
    };
    let offline = cargo(&["--offline"]);
    let text = String::from_utf8_lossy(&offline.stderr);
    // A crate that nothing else of the workspace needs may not have been fetched yet.
    let output = if offline.status.success() || !text.contains("--offline") { offline } else { cargo(&[]) };
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}
