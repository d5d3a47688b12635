//! Error messages as rustc prints them, one of each kind. The tables of the compiler's `tests/mistakes`
//! contain all others, which a test checks without rustc.
//!
//! `TRYBUILD=overwrite cargo test -p linkwork-ui` writes the messages again; read them before a commit.

use std::fs;
use std::path::Path;

/// Crate that trybuild generates to compile the files: paths of URDF files are relative to it.
const CRATE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/../tests/trybuild/", env!("CARGO_PKG_NAME"));

#[test]
fn compile_errors_have_the_expected_messages() {
    let robots = Path::new(CRATE).join("urdf");
    fs::create_dir_all(&robots).unwrap();
    for name in ["broken_xml.urdf", "slips.urdf"] {
        fs::copy(Path::new("urdf").join(name), robots.join(name)).unwrap();
    }
    trybuild::TestCases::new().compile_fail("*/*.rs");
}
