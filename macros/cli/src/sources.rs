//! Folder of the Linkwork sources that generated crates depend on.

use std::path::{Path, PathBuf};

/// Returns the folder of the repository that the command was built from, if it still exists: for
/// `cargo install --path`, or within the repository itself. A command installed from a registry has no such
/// folder.
pub fn source_repository_of_binary() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?.parent()?;
    let has_manifest = |crate_: &str| folder.join(crate_).join("Cargo.toml").is_file();
    ["runtime", "runtime/view", "runtime/library"]
        .iter()
        .all(|name| has_manifest(name))
        .then(|| folder.to_path_buf())
}

/// Returns a dependency of a manifest: by its folder in the sources, or by its version in the registry.
pub fn manifest_dependency(name: &str, folder: &str, sources: Option<&Path>) -> String {
    match sources {
        Some(sources) => format!("{name} = {{ path = {:?} }}", sources.join(folder).display().to_string()),
        None => format!("{name} = {:?}", env!("CARGO_PKG_VERSION")),
    }
}
