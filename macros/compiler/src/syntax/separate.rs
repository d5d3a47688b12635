//! Structs whose fields are not separated by commas. Rustc says so before it gives the struct to the attribute, which is best
//! served by what was meant: a second error for one mistake helps nobody.

use super::guard;
use crate::diag::{Diagnostics, syn_error};
use proc_macro2::{Delimiter, Group, Ident, TokenStream, TokenTree};
use quote::{ToTokens, quote};
use syn::ext::IdentExt;
use syn::parse::{ParseStream, Parser};
use syn::{Attribute, Token, Type, Visibility, token};

/// The struct with a comma behind every field, and the first place where there was none. `None` if nothing else would make
/// it a struct, or nothing is to be mended.
pub fn separate(item: &TokenStream) -> Option<(TokenStream, syn::Error)> {
    let mut tokens: Vec<TokenTree> = item.clone().into_iter().collect();
    let Some(TokenTree::Group(body)) = tokens.pop() else { return None };
    if body.delimiter() != Delimiter::Brace || !guard::check_tokens(item, &mut Diagnostics::unread()) {
        return None;
    }
    let (fields, first) = parse_fields.parse2(body.stream()).ok()?;
    let mut separated = Group::new(Delimiter::Brace, quote!(#(#fields),*));
    separated.set_span(body.span());
    tokens.push(TokenTree::Group(separated));
    Some((tokens.into_iter().collect(), first?))
}

fn parse_fields(input: ParseStream<'_>) -> syn::Result<(Vec<TokenStream>, Option<syn::Error>)> {
    let (mut fields, mut first) = (Vec::new(), None);
    while !input.is_empty() {
        let attributes = Attribute::parse_outer(input)?;
        let visibility: Visibility = input.parse()?;
        let (name, colon): (Ident, Token![:]) = (input.parse()?, input.parse()?);
        let kind: Type = input.parse()?;
        let written = format!("{name}: {}", kind.to_token_stream()).replace(" :: ", "::");
        fields.push(quote!(#(#attributes)* #visibility #name #colon #kind));
        let (span, help) = if input.is_empty() {
            break;
        } else if input.peek(Token![,]) {
            input.parse::<Token![,]>()?;
            continue;
        } else if input.peek(Token![;]) {
            let semicolon: Token![;] = input.parse()?;
            (semicolon.span, format!("fields are separated by `,`: write `{written},`"))
        } else if input.peek(token::Brace) {
            let value: Group = input.parse()?;
            input.parse::<Option<Token![,]>>()?;
            (value.span_open(), format!("a field has a type and no value: write `{written},`"))
        } else if input.peek(Token![#]) || input.peek(Ident::peek_any) {
            (input.span(), format!("fields are separated by `,`: write `{written},`"))
        } else {
            return Err(input.error("expected `,`"));
        };
        first.get_or_insert_with(|| syn_error(span, "expected `,`", &help));
    }
    Ok((fields, first))
}
