//! Detection of two structs with one name in one module. The Rust compiler reports the name once, but also
//! each function that both structs define; therefore the second struct gets no functions.

use proc_macro2::TokenStream;
use quote::quote;
use syn::{Attribute, Item, ItemStruct, Stmt};

/// Returns the struct without fields if the source file defines its name in the same scope before the
/// attribute's line, counted from one.
pub fn struct_without_fields_if_duplicate(
    item: &TokenStream,
    text: &str,
    line: usize,
) -> Option<TokenStream> {
    let positions_of_definitions = |ident: &str| {
        let definition = format!("struct {ident}");
        let is_end_of_word =
            |end: usize| text[end..].chars().next().is_none_or(|next| !next.is_alphanumeric() && next != '_');
        let found = text.match_indices(&definition).map(|(at, word)| (at, at + word.len()));
        found.filter(|(_, end)| is_end_of_word(*end)).map(|(at, _)| at).collect::<Vec<_>>()
    };
    // Cheap test first: nearly every file has only one such struct.
    let ItemStruct { vis, ident, .. } = match text.matches("struct ").count() {
        0 | 1 => return None,
        _ => syn::parse2(item.clone()).ok()?,
    };
    let found = positions_of_definitions(&ident.to_string());
    let first = found.first().map(|at| 1 + text[..*at].matches('\n').count())?;
    if found.len() < 2 || first >= line {
        return None;
    }
    let mut scopes = vec![syn::parse_file(text).ok()?.items];
    while let Some(items) = scopes.pop() {
        let same = items.iter().filter(|item| match item {
            Item::Struct(item) => item.ident == ident && !item.attrs.iter().any(is_cfg_attribute),
            _ => false,
        });
        if same.count() > 1 {
            return Some(quote!(#vis struct #ident;));
        }
        scopes.extend(items.into_iter().filter_map(|item| match item {
            Item::Mod(module) => module.content.map(|(_, items)| items),
            Item::Fn(function) => {
                let statements = function.block.stmts.into_iter();
                let items =
                    statements.filter_map(|s| if let Stmt::Item(item) = s { Some(item) } else { None });
                Some(items.collect())
            }
            _ => None,
        }));
    }
    None
}

/// Returns whether an attribute may remove the struct, as `cfg` does.
fn is_cfg_attribute(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg") || attribute.path().is_ident("cfg_attr")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_second_definition(text: &str, line: usize) -> bool {
        struct_without_fields_if_duplicate(
            &quote!(
                pub struct Cart {
                    mass: f64,
                }
            ),
            text,
            line,
        )
        .is_some()
    }

    #[test]
    fn duplicate_names_in_one_scope_are_found() {
        let one = "#[mechanism]\nstruct Cart { mass: f64 }\n";
        let twice = format!("{one}{one}");
        assert!(
            !is_second_definition(one, 1)
                && !is_second_definition(&twice, 1)
                && is_second_definition(&twice, 3)
        );
        for scope in [format!("mod carts {{\n{twice}}}"), format!("fn main() {{\n{twice}}}")] {
            assert!(!is_second_definition(&scope, 2) && is_second_definition(&scope, 4), "{scope}");
        }
    }

    #[test]
    fn equal_names_in_different_scopes_are_accepted() {
        let one = "#[mechanism]\nstruct Cart { mass: f64 }\n";
        for other in [
            format!("{one}mod more {{\n{one}}}"),
            format!("#[cfg(a)]\n{one}#[cfg(not(a))]\n{one}"),
            format!("{one}struct Carts;\nstruct Carts;\n"),
            format!("// struct Cart\n{one}"),
        ] {
            assert!((1..8).all(|line| !is_second_definition(&other, line)), "{other}");
        }
    }
}
