//! Writes the chains for the comparison with other libraries, since a `#[mechanism]` struct must be in a
//! source file.

#[path = "src/chains.rs"]
#[allow(dead_code, reason = "the rest of the module is for the package itself")]
mod chains;

use std::path::Path;

fn main() -> std::io::Result<()> {
    println!("cargo::rerun-if-changed=src/chains.rs");
    if std::env::var_os("CARGO_FEATURE_CHAINS").is_none() {
        return Ok(());
    }
    let mut text = String::new();
    // The longest chains have no derivatives, which would take hundreds of thousands of operations.
    for (n, extra) in [(6, ", derivatives"), (16, ", derivatives"), (32, ""), (64, "")] {
        for symbolic in [false, true] {
            let name = format!("Chain{n}{}", if symbolic { "Parameters" } else { "" });
            let extra = if symbolic { format!("{extra}, prepare") } else { extra.to_string() };
            let source = chains::chain_source(&name, n, symbolic);
            text += &format!(
                "#[linkwork::mechanism({}{extra})]\n#[derive(Clone, Copy)]\n{}\n",
                source.arguments, source.item
            );
            if symbolic {
                text += &format!(
                    "impl {name} {{ fn with_link_values() -> Self {{ {} }} }}\n",
                    chains::chain_struct_expression("Self", n)
                );
            }
        }
    }
    let folder = std::env::var_os("OUT_DIR").unwrap_or_default();
    std::fs::write(Path::new(&folder).join("chains.rs"), text)
}
