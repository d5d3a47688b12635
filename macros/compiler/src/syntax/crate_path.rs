//! The option `crate = path::to::linkwork` of the attribute: the path of the runtime in generated code, for a
//! renamed or re-exported crate.

use crate::diag::Diagnostics;
use proc_macro2::{TokenStream, TokenTree};
use syn::Path;
use syn::parse::Parser;

/// Returns the arguments without the option `crate`, and its path if it is present.
pub fn take_crate_path(arguments: TokenStream, cx: &mut Diagnostics) -> (TokenStream, Option<Path>) {
    let mut rest: Vec<TokenTree> = Vec::new();
    let mut found = None;
    let mut tokens = arguments.into_iter().peekable();
    while let Some(token) = tokens.next() {
        let starts = rest.last().is_none_or(|last| is_punctuation(last, ','));
        let is_crate = matches!(&token, TokenTree::Ident(word) if word == "crate");
        if !(starts && is_crate && tokens.peek().is_some_and(|next| is_punctuation(next, '='))) {
            rest.push(token);
            continue;
        }
        tokens.next();
        let mut path = Vec::new();
        while let Some(part) = tokens.next_if(|part| !is_punctuation(part, ',')) {
            path.push(part);
        }
        tokens.next();
        if found.is_some() {
            cx.report_error(token.span(), "`crate` is given twice");
        }
        let span = path.first().map_or(token.span(), TokenTree::span);
        match Path::parse_mod_style.parse2(path.into_iter().collect()) {
            Ok(path) => found = Some(path),
            Err(_) => {
                cx.report_error(span, "expected a path for `crate`").add_help(
                    "write `crate = name` if the dependency has another name, `crate = other::linkwork` if \
                     another crate re-exports it",
                );
            }
        }
    }
    (rest.into_iter().collect(), found)
}

fn is_punctuation(token: &TokenTree, sign: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == sign)
}
