//! `crate = path::to::linkwork` among the arguments of the attribute: where generated code finds the runtime,
//! if its crate has another name or is re-exported by one.

use crate::diag::Diagnostics;
use proc_macro2::{TokenStream, TokenTree};
use syn::Path;
use syn::parse::Parser;

/// The path that the arguments name, if they name one, and the arguments without it.
pub fn take_path(arguments: TokenStream, cx: &mut Diagnostics) -> (TokenStream, Option<Path>) {
    let mut rest: Vec<TokenTree> = Vec::new();
    let mut found = None;
    let mut tokens = arguments.into_iter().peekable();
    while let Some(token) = tokens.next() {
        let starts = rest.last().is_none_or(|last| is(last, ','));
        let is_crate = matches!(&token, TokenTree::Ident(word) if word == "crate");
        if !(starts && is_crate && tokens.peek().is_some_and(|next| is(next, '='))) {
            rest.push(token);
            continue;
        }
        tokens.next();
        let mut path = Vec::new();
        while let Some(part) = tokens.next_if(|part| !is(part, ',')) {
            path.push(part);
        }
        tokens.next();
        if found.is_some() {
            cx.error(token.span(), "`crate` is given twice");
        }
        let span = path.first().map_or(token.span(), TokenTree::span);
        match Path::parse_mod_style.parse2(path.into_iter().collect()) {
            Ok(path) => found = Some(path),
            Err(_) => {
                cx.error(span, "expected a path for `crate`")
                    .help("write `crate = name` if the dependency has another name, `crate = other::linkwork` if another crate re-exports it");
            }
        }
    }
    (rest.into_iter().collect(), found)
}

fn is(token: &TokenTree, sign: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == sign)
}
