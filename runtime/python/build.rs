//! Build script that embeds the sources of the model gallery: declarations, and the robot files that they
//! name.

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn collect_files(folder: &Path, end: &str, found: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            collect_files(&path, end, found)?;
        } else if path.extension().is_some_and(|known| known == end) {
            found.push(path);
        }
    }
    Ok(())
}

fn main() -> io::Result<()> {
    let models = Path::new(&env::var("CARGO_MANIFEST_DIR").unwrap_or_default()).join("../../models");
    let models = models.canonicalize()?;
    let mut text = String::new();
    for (name, folder, end) in [("DECLARATIONS", "src", "rs"), ("ROBOTS", "urdf", "urdf")] {
        let mut found = Vec::new();
        collect_files(&models.join(folder), end, &mut found)?;
        found.sort();
        text += &format!("pub const {name}: &[(&str, &str)] = &[\n");
        for path in found {
            let relative = path.strip_prefix(&models).unwrap_or(&path);
            text += &format!("    ({:?}, include_str!({path:?})),\n", relative.to_string_lossy());
        }
        text += "];\n";
        println!("cargo::rerun-if-changed={}", models.join(folder).display());
    }
    let out = env::var("OUT_DIR").unwrap_or_default();
    fs::write(Path::new(&out).join("gallery.rs"), text)
}
