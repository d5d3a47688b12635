//! The attribute macro of Linkwork. Use it through the crate `linkwork`, which re-exports it and holds what the
//! generated code calls.

use proc_macro::TokenStream;
use std::path::PathBuf;

/// Compiles a mechanism.
///
/// The struct's fields are parameters, which stay, and elements, which say what the mechanism is made of.
#[proc_macro_attribute]
pub fn mechanism(arguments: TokenStream, item: TokenStream) -> TokenStream {
    let folder = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from).unwrap_or_default();
    let emitted = linkwork_compiler::expand(arguments.into(), item.into(), &folder);
    let mut tokens = TokenStream::from(emitted.tokens);
    match emitted.text.parse::<TokenStream>() {
        Ok(text) => tokens.extend(text),
        Err(error) => {
            let message = format!("a mistake of Linkwork's: {error}");
            tokens.extend(format!("::core::compile_error!({message:?});").parse::<TokenStream>());
        }
    }
    tokens
}
