//! Tests of generated projects and of completions for shells.

#[path = "../src/starter/main.rs"]
#[allow(dead_code, reason = "the `main` of another program")]
mod starter;

use std::path::{Path, PathBuf};
use std::process::Command;

fn test_folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn run_linkwork(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_linkwork")).current_dir(folder).args(arguments).output().unwrap();
    let decode_utf8 = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), decode_utf8(output.stdout), decode_utf8(output.stderr))
}

/// Checks the program of a new project: one pole falls, and the other one is kept upright.
#[test]
fn new_project_balances_one_of_two_poles() {
    let page = starter::cart_pole_page().unwrap().html();
    assert!(page.contains("It falls") && page.contains("It is kept upright"));
    let cart_pole = starter::CartPole { pole_length: 1.0 };
    // At a positive angle, the acceleration increases the angle: the upright pole is unstable.
    let a = cart_pole.forward_dynamics(&[0.0, 0.2].into(), &[0.0; 2].into(), &[0.0; 2].into());
    assert!(a[1] > 0.0, "{a}");
}

#[test]
fn existing_projects_are_not_overwritten() {
    let here = test_folder("new");
    let (status, stderr, _) = run_linkwork(&here, &["new", "my-arm"]);
    assert!(status == 0 && stderr.contains("cargo run"), "{stderr}");
    let main = std::fs::read_to_string(here.join("my-arm/src/main.rs")).unwrap();
    assert_eq!(main, include_str!("../src/starter/main.rs"));
    // A command built from the repository depends on the repository, and Cargo accepts the manifest.
    let path = here.join("my-arm/Cargo.toml");
    let manifest = std::fs::read_to_string(&path).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    for (name, at) in [("linkwork", "runtime"), ("linkwork-view", "runtime/view")] {
        let local = format!("\n{name} = {{ path = {:?} }}\n", root.join(at).display().to_string());
        assert!(manifest.contains(&local), "{manifest}");
    }
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["metadata", "--no-deps", "--offline", "--format-version=1"]);
    let cargo = cargo.current_dir(here.join("my-arm")).output().unwrap();
    let read: serde_json::Value = serde_json::from_slice(&cargo.stdout).unwrap();
    assert_eq!(read["packages"][0]["name"], "my-arm");

    // With `--linkwork FOLDER`, the manifest names the sources in that folder.
    let (status, _, stderr) = run_linkwork(&here, &["new", "own", "--linkwork", root.to_str().unwrap()]);
    assert_eq!(status, 0, "{stderr}");
    let own = std::fs::read_to_string(here.join("own/Cargo.toml")).unwrap();
    assert_eq!(own.replace("\"own\"", "\"my-arm\""), manifest);
    let (status, _, stderr) = run_linkwork(&here, &["new", "other", "--linkwork", "nowhere"]);
    assert!(status == 2 && stderr.contains("`--linkwork`: "), "{stderr}");

    for (name, part) in [
        ("my-arm", "already exists"),
        ("2d", "is not a name of a package"),
        ("fn", "is not a name"),
        ("std", "hide"),
    ] {
        let (status, _, stderr) = run_linkwork(&here, &["new", name]);
        assert!(status == 2 && stderr.contains(part), "{name}: {stderr}");
    }
}

#[test]
fn shell_completions_cover_all_commands() {
    let here = test_folder("completions");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (status, text, _) = run_linkwork(&here, &["completions", shell]);
        let all = ["check", "show", "simulate", "view", "convert", "export", "new", "without-contacts"];
        assert!(status == 0 && all.iter().all(|word| text.contains(word)), "{shell}");
    }
    assert_eq!(run_linkwork(&here, &["completions", "tcsh"]).0, 2);
}

/// Checks that the command exits silently if its standard output is closed after the first bytes, or its
/// standard error at once.
#[test]
fn commands_exit_silently_on_closed_pipes() {
    use std::io::Read;
    use std::process::Stdio;
    let here = test_folder("pipes");
    std::fs::write(
        here.join("bad.rs"),
        "#[mechanism]\npub struct Bad {\n    #[body(mas = 1)]\n    b: Body,\n}\n",
    )
    .unwrap();
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/motions/flail.rs");
    for arguments in [
        &["completions", "zsh"][..],
        &["--help"],
        &["show", own],
        &["export", "rust", own],
        &["simulate", own, "--set", "handle=0.5", "--duration", "1", "--every", "0.001"],
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_linkwork"));
        let command = command.args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut first = [0; 1];
        let mut out = child.stdout.take().unwrap();
        out.read_exact(&mut first).unwrap();
        drop(out);
        let done = child.wait_with_output().unwrap();
        assert_eq!(
            (done.status.code(), String::from_utf8(done.stderr).unwrap().as_str()),
            (Some(0), ""),
            "{arguments:?}"
        );
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_linkwork"));
    let mut child =
        command.current_dir(&here).args(["check", "bad.rs"]).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(1));
}
