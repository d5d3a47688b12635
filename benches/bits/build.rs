//! Build script: adds the arithmetic that the Cargo feature selects to the options of the mechanisms.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    println!("cargo::rerun-if-changed=src/mechanisms.rs");
    let is_reproducible = env::var_os("CARGO_FEATURE_REPRODUCIBLE").is_some();
    let arithmetic = if is_reproducible { "reproducible" } else { "fast" };
    let text = fs::read_to_string("src/mechanisms.rs").expect("the mechanisms");
    let text = text.replace("#[mechanism(", &format!("#[mechanism(arithmetic = {arithmetic}, "));
    let folder = PathBuf::from(env::var_os("OUT_DIR").expect("the folder of cargo"));
    fs::write(folder.join("mechanisms.rs"), text).expect("a file in the folder of cargo");
}
