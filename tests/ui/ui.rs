//! Mistakes as the user meets them: what rustc prints for one of each kind. All others are in the tables of the compiler's
//! `tests/mistakes`, where a test tries them without rustc.
//!
//! `TRYBUILD=overwrite cargo test -p linkwork-ui` writes the messages anew; read them before they are committed.

use std::fs;
use std::path::Path;

/// The generated crate that trybuild compiles the files in: the paths of URDF files start there.
const CRATE: &str = concat!(env!("CARGO_TARGET_TMPDIR"), "/../tests/trybuild/", env!("CARGO_PKG_NAME"));

#[test]
fn messages() {
    let robots = Path::new(CRATE).join("urdf");
    fs::create_dir_all(&robots).unwrap();
    for name in ["broken_xml.urdf", "slips.urdf"] {
        fs::copy(Path::new("urdf").join(name), robots.join(name)).unwrap();
    }
    trybuild::TestCases::new().compile_fail("*/*.rs");
}
