//! Detection of common errors in the grammar of arguments, with corrections.

use super::{ArgumentValue, Arguments};
use crate::diag::{Diagnostics, join_with_or, syn_error_with_help};
use crate::syntax::expression::{parse_expr, quote_text, unexpected_token_error};
use crate::syntax::{Expr, ExprKind, words};
use proc_macro2::{TokenStream, TokenTree};
use syn::ext::IdentExt;
use syn::parse::ParseStream;
use syn::{Ident, LitStr, Token, token};

/// Reports an expression that stands where `name = value` is expected.
pub fn report_unnamed_argument(e: &Expr, known: &[&str], example: &str, cx: &mut Diagnostics) {
    if let Some(word) = e.as_name().filter(|word| known.contains(word)) {
        cx.report_error(e.place.clone(), format!("`{word}` has no value"))
            .add_help(format!("write `{word} = …`"));
        return;
    }
    let error = cx.report_error(e.place.clone(), "expected `name = value`");
    match (&e.kind, known) {
        (ExprKind::Call(word, value), _) if known.contains(&word.text.as_str()) && value.len() == 1 => {
            error.add_help(format!("write `{} = {}`", word.text, value[0].short_source_text()))
        }
        (_, []) => error.add_help(format!("write `{example}`")),
        (_, [one]) => error.add_help(format!("write `{one} = {}`", e.short_source_text())),
        (_, [.., _]) if known.len() <= 8 => {
            let list: Vec<String> = known.iter().map(|word| format!("`{word}`")).collect();
            error.add_help(format!("expected {}", join_with_or(&list)))
        }
        _ => error.add_help(format!("write `{example}`")),
    };
}

/// Error for input after an argument; most likely a comma is missing.
pub fn missing_comma_error(input: ParseStream<'_>) -> syn::Error {
    if input.peek(Token![;]) {
        return syn_error_with_help(input.span(), "expected `,`", "arguments are separated by `,`");
    }
    let ahead = input.fork();
    match ahead.call(Ident::parse_any) {
        Ok(word) if ahead.peek(Token![=]) => {
            let help = format!("arguments are separated by `,`: write `…, {word} = …`");
            syn_error_with_help(input.span(), "expected `,`", &help)
        }
        Ok(word) if ahead.is_empty() && words::is_valueless_option(&word.to_string()) => {
            let help = format!("arguments are separated by `,`: write `…, {word}`");
            syn_error_with_help(input.span(), "expected `,`", &help)
        }
        _ => unexpected_token_error(input),
    }
}

/// Returns the error for a string without a key.
pub fn stray_string_error(text: &LitStr) -> syn::Error {
    let value = text.value();
    let is_file = value.rsplit_once('.').is_some_and(|(_, end)| matches!(end, "urdf" | "xml" | "xacro"));
    if is_file {
        let help = format!("write `urdf = {}`", quote_text(&value));
        return syn_error_with_help(text.span(), "expected `name = value`, found a string", &help);
    }
    syn_error_with_help(text.span(), "expected an expression, found a string", "write it without quotes")
}

/// Error for a missing `->` of a joint, or a missing `=` after an argument name, at the token found instead.
pub fn missing_arrow_error(
    input: ParseStream<'_>,
    first: &Expr,
    arguments: &Arguments,
) -> Option<syn::Error> {
    let is_place_expression =
        |e: &Expr| matches!(e.kind, ExprKind::Name(_) | ExprKind::Method(..) | ExprKind::Field(..));
    let is_arrow = input.peek(Token![->]);
    let ends = input.is_empty() || input.peek(Token![,]) || input.peek(token::Bracket);
    if !is_place_expression(first)
        || ends
        || input.peek(Token![::])
        || (is_arrow && !is_arrow_followed_by_greater(input))
    {
        return None;
    }
    let span = input.span();
    let ahead = input.fork();
    let mut signs = String::new();
    while let Ok(sign) = ahead.call(syn::parse::ParseBuffer::parse::<proc_macro2::Punct>) {
        signs.push(sign.as_char());
    }
    if arguments.grammar == super::Grammar::Joint
        && arguments.relation.is_none()
        && arguments.named.is_empty()
    {
        if signs.is_empty() && ahead.peek2(Ident::peek_any) {
            ahead.call(Ident::parse_any).ok()?;
        }
        let second = parse_expr(&ahead).ok().filter(is_place_expression);
        let equation = matches!(signs.as_str(), "=" | "==");
        if equation || (signs.is_empty() && second.is_none()) {
            return None;
        }
        let child = second.map_or("child".to_string(), |e| e.short_source_text());
        return Some(syn_error_with_help(
            span,
            "expected `->`",
            &format!("write `{} -> {child}`", first.short_source_text()),
        ));
    }
    if matches!(signs.as_str(), ":" | ":=" | "+=" | "-=" | "*=" | "/=" | "=>" | "<-" | "~") {
        let help = format!("write `{} = …`", first.short_source_text());
        return first.as_name().map(|_| syn_error_with_help(span, "expected `=`", &help));
    }
    None
}

/// Returns whether the next tokens are the misspelt arrow `->>`.
fn is_arrow_followed_by_greater(input: ParseStream<'_>) -> bool {
    let ahead = input.fork();
    ahead.parse::<Token![->]>().is_ok() && ahead.peek(Token![>])
}

/// Returns the error for a number with a decimal comma: the value of an argument ends in an integer, and
/// another integer follows.
pub fn decimal_comma_error(tokens: &TokenStream) -> Option<syn::Error> {
    let tokens: Vec<TokenTree> = tokens.clone().into_iter().collect();
    let is_whole_number = |text: &str| !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit());
    let is_punctuation =
        |token: &TokenTree, sign| matches!(token, TokenTree::Punct(punct) if punct.as_char() == sign);
    let mut is_value = false;
    for (k, token) in tokens.iter().enumerate() {
        if is_punctuation(token, ',')
            && is_value
            && let (Some(TokenTree::Literal(whole)), Some(TokenTree::Literal(part))) =
                (tokens.get(k.wrapping_sub(1)), tokens.get(k + 1))
            && is_whole_number(&whole.to_string())
            && is_whole_number(&part.to_string())
        {
            let help = format!("numbers have a decimal point: write `{whole}.{part}`");
            return Some(syn_error_with_help(
                whole.span(),
                &format!("`{whole},{part}` is two numbers"),
                &help,
            ));
        }
        is_value = is_punctuation(token, '=') || (is_value && !is_punctuation(token, ','));
    }
    None
}

/// Returns the elements of a list of strings, quoted, for a string or names without brackets or quotes.
pub fn quoted_names(value: &ArgumentValue) -> Option<String> {
    match value {
        ArgumentValue::Text(text) => Some(quote_text(&text.value())),
        ArgumentValue::Expr(Expr { kind: ExprKind::Name(word), .. }) => Some(quote_text(word)),
        ArgumentValue::Expr(Expr { kind: ExprKind::Array(items) | ExprKind::Tuple(items), .. }) => {
            let names: Option<Vec<String>> =
                items.iter().map(|item| item.as_name().map(quote_text)).collect();
            names.map(|names| names.join(", "))
        }
        _ => None,
    }
}
