//! Mistakes as the user meets them: what the compiler says about each file of `ui`, and what it accepts.
//!
//! `TRYBUILD=overwrite cargo test --test ui` writes the messages anew; read them before they are committed.

use std::fs;
use std::path::Path;

/// The generated crate that trybuild compiles the files in: the paths of URDF files start there.
const CRATE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/../tests/trybuild/", env!("CARGO_PKG_NAME"));

/// The folders of `ui` with mistakes.
const TOPICS: [&str; 18] = [
    "actions",
    "arguments",
    "axes",
    "constraints",
    "expressions",
    "laws",
    "masses",
    "names",
    "outputs",
    "placement",
    "requests",
    "several",
    "structs",
    "topology",
    "units",
    "urdf",
    "uses",
    "vectors",
];

#[test]
fn messages() {
    copy_files("ui/urdf", &Path::new(CRATE).join("urdf"));
    let cases = trybuild::TestCases::new();
    cases.pass("ui/pass/*.rs");
    for topic in TOPICS {
        cases.compile_fail(format!("ui/{topic}/*.rs"));
    }
}

/// Copies the robots of a folder.
fn copy_files(from: &str, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        if entry.path().extension().is_some_and(|end| end == "urdf" || end == "xacro") {
            fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
        }
    }
}
