//! `linkwork new`: creates an executable project.

use crate::sources::manifest_dependency;
use crate::{Stop, sources};
use clap::ArgMatches;
use std::path::{Path, PathBuf};

const MAIN: &str = include_str!("starter/main.rs");

pub fn create_package(matches: &ArgMatches) -> Result<(), Stop> {
    let folder: &PathBuf =
        matches.get_one("folder").ok_or_else(|| Stop::Failure("expected a folder".to_string()))?;
    let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    check_package_name(&name)?;
    if folder.exists() {
        return Err(Stop::Failure(format!("{} already exists", folder.display())));
    }
    let creation_failure =
        |error: std::io::Error| Stop::Failure(format!("cannot make {}: {error}", folder.display()));
    std::fs::create_dir_all(folder.join("src")).map_err(creation_failure)?;
    let write_project_file =
        |path: &str, text: &str| std::fs::write(folder.join(Path::new(path)), text).map_err(creation_failure);
    let sources = matches.get_one::<PathBuf>("linkwork").map(std::fs::canonicalize).transpose();
    let sources = sources.map_err(|error| Stop::Failure(format!("`--linkwork`: {error}")))?;
    let sources = sources.or_else(sources::source_repository_of_binary);
    write_project_file("Cargo.toml", &manifest_text(&name, sources.as_deref()))?;
    write_project_file("src/main.rs", MAIN)?;
    write_project_file(".gitignore", "/target\n/motion.html\n")?;
    crate::say!("{0}: `cd {0}`, then `cargo run`, and open motion.html", folder.display());
    Ok(())
}

/// Checks that Cargo accepts the name of a package.
fn check_package_name(name: &str) -> Result<(), Stop> {
    let is_name_character = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let is_word = syn::parse_str::<syn::Ident>(&name.replace('-', "_")).is_err();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic()) || !name.chars().all(is_name_character) || is_word
    {
        return Err(Stop::Failure(format!(
            "`{name}` is not a name of a package: expected letters, digits, `-` and `_`, a letter first"
        )));
    }
    if ["test", "core", "std", "alloc", "linkwork", "linkwork-view"].contains(&name) {
        return Err(Stop::Failure(format!("a package `{name}` would hide another one: choose another name")));
    }
    Ok(())
}

/// Returns the manifest, which depends on the Linkwork sources in a folder or on the release.
fn manifest_text(name: &str, sources: Option<&Path>) -> String {
    let linkwork = manifest_dependency("linkwork", "runtime", sources);
    let view = manifest_dependency("linkwork-view", "runtime/view", sources);
    format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n\
         [dependencies]\n{linkwork}\n{view}\n\n\
         # Most of the speed of a release build, with its checks on.\n[profile.dev]\nopt-level = \
             1\n\n[workspace]\n"
    )
}
