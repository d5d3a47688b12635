//! The sources of Linkwork, which crates that the command writes depend on.

use std::path::{Path, PathBuf};

/// The folder of the repository that the command was built from, if it is still there: by
/// `cargo install --path`, or in the repository itself. A command that was installed from a registry has
/// none.
pub fn of_command() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?.parent()?;
    let is_there = |crate_: &str| folder.join(crate_).join("Cargo.toml").is_file();
    ["runtime", "runtime/view", "runtime/library"]
        .iter()
        .all(|name| is_there(name))
        .then(|| folder.to_path_buf())
}

/// A dependency in a manifest: by its folder in the sources, or by its version in the registry.
pub fn dependency(name: &str, folder: &str, sources: Option<&Path>) -> String {
    match sources {
        Some(sources) => format!("{name} = {{ path = {:?} }}", sources.join(folder).display().to_string()),
        None => format!("{name} = {:?}", env!("CARGO_PKG_VERSION")),
    }
}
