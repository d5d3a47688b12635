//! Structs whose fields are not separated by commas, or have no colon. The Rust compiler reports this before
//! it calls the attribute. The attribute then continues with the corrected struct, to avoid a second error
//! for the same cause.

use super::{element, guard};
use crate::diag::{Diagnostics, syn_error_with_help};
use proc_macro2::{Delimiter, Group, Ident, Span, TokenStream, TokenTree};
use quote::{ToTokens, quote};
use syn::ext::IdentExt;
use syn::parse::{ParseStream, Parser};
use syn::{Attribute, Token, Type, Visibility, token};

/// Returns the struct with a comma after every field, and the error at the first missing comma. Returns
/// `None` if the struct remains invalid or lacks no comma.
pub fn insert_missing_commas(item: &TokenStream) -> Option<(TokenStream, syn::Error)> {
    let mut tokens: Vec<TokenTree> = item.clone().into_iter().collect();
    let Some(TokenTree::Group(body)) = tokens.pop() else { return None };
    if body.delimiter() != Delimiter::Brace
        || !guard::check_item_size(item, &mut Diagnostics::silent_diagnostics())
    {
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
        let mut name: Ident = input.parse()?;
        let (colon, place) = parse_colon(input)?;
        let mut kind: Type = input.parse()?;
        // The type precedes the name, as in other languages.
        if let Some((known, other)) = swapped_type_and_name(&name, &kind).filter(|_| place.is_some()) {
            (name, kind) = (other, known);
        }
        let written = format!("{name}: {}", kind.to_token_stream()).replace(" :: ", "::");
        if let Some(place) = place {
            let help = format!("a field is a name and its type: write `{written},`");
            first.get_or_insert_with(|| syn_error_with_help(place, "expected `:`", &help));
        }
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
        first.get_or_insert_with(|| syn_error_with_help(span, "expected `,`", &help));
    }
    Ok((fields, first))
}

/// Parses the colon between a name and a type. If it is missing or an equals sign, returns a substitute and
/// the span of the error.
fn parse_colon(input: ParseStream<'_>) -> syn::Result<(Token![:], Option<Span>)> {
    if input.peek(Token![=]) {
        let sign: Token![=] = input.parse()?;
        return Ok((Token![:](sign.span), Some(sign.span)));
    }
    if input.peek(syn::Ident) {
        return Ok((Token![:](input.span()), Some(input.span())));
    }
    Ok((input.parse()?, None))
}

/// Returns the type and the name of a field whose type and name are swapped: its name is the type of an
/// element.
fn swapped_type_and_name(name: &Ident, kind: &Type) -> Option<(Type, Ident)> {
    let other: Ident = syn::parse2(kind.to_token_stream()).ok()?;
    let is_language_element_type = |word: &Ident| element::is_element_or_parameter_type(&word.to_string());
    (is_language_element_type(name) && !is_language_element_type(&other))
        .then(|| (Type::Verbatim(name.to_token_stream()), other))
}
