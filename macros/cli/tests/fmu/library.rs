//! FMUs whose binary contains the run-time library, which simulates contacts with friction.

use super::{compare_states, find_c_compiler, run_linkwork, set_option_arguments, unpack_archive};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Returns the shared library `linkwork-c`, which cargo writes next to the tests of the workspace.
fn shared_library_path() -> Option<PathBuf> {
    let own = std::env::current_exe().expect("a path of the test");
    let deps = own.parent()?;
    let found = [deps.join("liblinkwork_c.so"), deps.parent()?.join("liblinkwork_c.so")];
    let found = found.into_iter().find(|path| path.is_file());
    if found.is_none() {
        println!("skipped: there is no liblinkwork_c.so (cargo build -p linkwork-c)");
    }
    found
}

/// Exports a mechanism with the library, and compiles the importer with its binary. Returns the program and
/// the token.
fn export_and_compile_importer(name: &str, arguments: &[&str]) -> Option<(PathBuf, String)> {
    let (compiler, library) = (find_c_compiler()?, shared_library_path()?);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fmu").join(name);
    fs::create_dir_all(&folder).expect("a folder of the tests");
    let archive = folder.join("model.fmu");
    let path_text = |path: &Path| path.to_str().expect("a path in UTF-8").to_string();
    let (out, library) = (path_text(&archive), path_text(&library));
    let options = ["--out", &out, "--prefix", name, "--library", &library];
    run_linkwork(&[&["export", "fmu"], arguments, &options].concat())
        .unwrap_or_else(|error| panic!("{error}"));
    let mut binary = PathBuf::new();
    let mut token = String::new();
    for (path, bytes) in unpack_archive(&fs::read(&archive).expect("the archive is written")) {
        assert!(!path.starts_with("sources"), "{path}");
        let to = folder.join(&path);
        fs::create_dir_all(to.parent().expect("a folder")).expect("a folder of the tests");
        fs::write(&to, &bytes).expect("a file of the tests");
        if path == "modelDescription.xml" {
            let description = String::from_utf8_lossy(&bytes).into_owned();
            assert!(!description.contains("ModelExchange") && !description.contains("der("), "{description}");
            let (_, rest) = description.split_once("instantiationToken=\"").expect("a token");
            token = rest.split('"').next().unwrap_or_default().to_string();
        } else if !path.contains("liblinkwork") {
            binary = to;
        }
    }
    let program = folder.join("importer");
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sources = tests.join("../compiler/src/export/fmu/templates");
    let output = Command::new(compiler)
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-I"])
        .arg(sources)
        .arg(tests.join("tests/fmu/importer.c"))
        .arg("-o")
        .arg(&program)
        .arg(&binary)
        .arg(format!("-Wl,-rpath,{}", binary.parent()?.display()))
        .arg("-lm")
        .output()
        .expect("the compiler starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some((program, token))
}

/// Returns the rows of states of a co-simulation.
fn co_simulate(program: &Path, token: &str, stop: f64, samples: usize) -> Vec<Vec<f64>> {
    let output = Command::new(program)
        .args(["co-simulation", token, &stop.to_string(), &samples.to_string(), "0"])
        .output()
        .expect("the program starts");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    text.lines().map(|line| line.split(' ').map(|x| x.parse().expect("a number")).collect()).collect()
}

/// A box slides `v² / (2 μ g)` on a rough floor and stays there. The motion equals that of the command.
#[test]
fn a_box_slides_and_stops() {
    let values = set_option_arguments(&["q.pose.z=0.05", "v.pose.vx=1"]);
    let arguments = [&["tests/fmu/mechanisms.rs", "--struct", "Crate"], &values[..]].concat();
    let Some((program, token)) = export_and_compile_importer("crate", &arguments) else { return };
    let rows = co_simulate(&program, &token, 0.3, 3);
    let last = &rows[3];
    assert!((last[1] - 1.0 / (2.0 * 0.4 * 9.81)).abs() < 1e-4 && (last[3] - 0.05).abs() < 1e-6, "{last:?}");
    let times = ["--duration", "0.3", "--every", "0.1"];
    let text = run_linkwork(&[&["simulate"], &arguments[..], &times].concat()).expect("a motion");
    let parse_number_row =
        |line: &str| line.split(',').map(|x| x.parse().expect("a number")).collect::<Vec<f64>>();
    let expected: Vec<Vec<f64>> = text.lines().skip(1).map(parse_number_row).collect();
    compare_states("crate", &rows, &expected, 1e-9);
    let restored =
        Command::new(&program).args(["states", &token, "0", "0", "0"]).output().expect("it starts");
    let restored = String::from_utf8_lossy(&restored.stdout).into_owned();
    let lines: Vec<&str> = restored.lines().collect();
    assert_eq!((lines[0], lines[0]), (lines[1], lines[2]), "after restoring the state");
}

/// A ball with Poisson's restitution rebounds to a quarter of the height from which it falls.
#[test]
fn a_ball_bounces_with_restitution_of_poisson() {
    let values = set_option_arguments(&["bounce=0.5", "q.height=1"]);
    let arguments = [&["tests/fmu/mechanisms.rs", "--struct", "Stack"], &values[..]].concat();
    let Some((program, token)) = export_and_compile_importer("stack", &arguments) else { return };
    let fall = (2.0 * 0.9 / 9.81_f64).sqrt();
    let last = co_simulate(&program, &token, 1.5 * fall, 1).pop().expect("rows");
    assert!((last[1] - 0.1 - 0.9 / 4.0).abs() < 1e-2 && last[2].abs() < 2e-2, "{last:?}");
}
