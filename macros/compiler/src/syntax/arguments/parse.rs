//! Grammar of arguments: relations, equations, `key = value`, and expressions alone, separated by commas.

use super::corrections::{missing_arrow_error, missing_comma_error, stray_string_error};
use super::{ArgumentValue, Arguments, Grammar};
use crate::diag::syn_error_with_help;
use crate::syntax::expression::{parse_expr, parse_name};
use crate::syntax::file_parameters;
use proc_macro2::Span;
use syn::parse::ParseStream;
use syn::{Ident, LitStr, Token, bracketed, token};

/// Parses the arguments of an attribute; errors at the end of the input have the given span.
pub fn parse_arguments(input: ParseStream<'_>, span: Span, grammar: Grammar) -> syn::Result<Arguments> {
    let mut arguments = Arguments {
        relation: None,
        equations: Vec::new(),
        plain: Vec::new(),
        named: Vec::new(),
        seen: Vec::new(),
        place: span.into(),
        owner: String::new(),
        grammar,
    };
    while !input.is_empty() {
        parse_argument(input, &mut arguments)?;
        if !input.is_empty() {
            if !input.peek(Token![,]) {
                return Err(missing_comma_error(input));
            }
            input.parse::<Token![,]>()?;
        }
    }
    Ok(arguments)
}

fn parse_argument(input: ParseStream<'_>, arguments: &mut Arguments) -> syn::Result<()> {
    use syn::ext::IdentExt;
    if input.peek(Ident::peek_any)
        && input.peek2(Token![=])
        && !input.peek2(Token![==])
        && !input.peek2(Token![=>])
    {
        let key = parse_name(input)?;
        input.parse::<Token![=]>()?;
        if input.is_empty() || input.peek(Token![,]) {
            let message = format!("`{}` has no value", key.text);
            return Err(syn_error_with_help(key.place.span, &message, &format!("write `{} = …`", key.text)));
        }
        let value = match key.text.as_str() {
            "parameters" => ArgumentValue::FileParameters(file_parameters::parse(input)?),
            _ => parse_argument_value(input)?,
        };
        if let ("between" | "on", ArgumentValue::Expr(first)) = (key.text.as_str(), &value)
            && input.peek(Token![->])
        {
            let arrow: Token![->] = input.parse()?;
            let second =
                parse_expr(input).map_or_else(|_| "…".to_string(), |second| second.short_source_text());
            let help = format!("write `between = ({}, {second})`", first.short_source_text());
            return Err(syn_error_with_help(arrow.spans[0], "expected `,`", &help));
        }
        arguments.named.push((key, value));
        return Ok(());
    }
    if input.peek(LitStr) {
        return Err(stray_string_error(&input.parse()?));
    }
    let first = parse_expr(input)?;
    if let Some(error) = missing_arrow_error(input, &first, arguments) {
        return Err(error);
    }
    if input.peek(Token![->]) {
        let arrow: Token![->] = input.parse()?;
        if input.is_empty() || input.peek(Token![,]) {
            let help = format!("write `{} -> child`", first.short_source_text());
            return Err(syn_error_with_help(arrow.spans[1], "missing body after this arrow", &help));
        }
        let second = parse_expr(input)?;
        if arguments.relation.is_some() {
            let help = "a joint has two ends; write a joint for each `parent -> child`";
            return Err(syn_error_with_help(arrow.spans[0], "a second `parent -> child`", help));
        }
        arguments.relation = Some((first, second));
    } else if (input.peek(Token![=]) && !input.peek(Token![=>])) || input.peek(Token![==]) {
        let sign = input.span();
        let _ = input.parse::<Token![==]>().map(drop).or_else(|_| input.parse::<Token![=]>().map(drop));
        if input.is_empty() || input.peek(Token![,]) {
            return Err(syn_error_with_help(sign, "missing expression after this sign", "write `a = b`"));
        }
        let second = parse_expr(input)?;
        if !arguments.equations.is_empty() && arguments.grammar != Grammar::Equilibrium {
            return Err(syn_error_with_help(sign, "a second equation", "declare a constraint for each"));
        }
        arguments.equations.push((first, second));
    } else {
        arguments.plain.push(first);
    }
    Ok(())
}

/// Parses quoted names that are separated by commas.
fn parse_quoted_names(input: ParseStream<'_>) -> syn::Result<Vec<LitStr>> {
    let mut texts = Vec::new();
    while !input.is_empty() {
        if !input.peek(LitStr) {
            let help = "names in a list are quoted, all of them: `[\"first\", \"second\"]`";
            return Err(syn_error_with_help(input.span(), "expected a name in quotes", help));
        }
        texts.push(input.parse()?);
        if !input.is_empty() {
            if !input.peek(Token![,]) {
                return Err(missing_comma_error(input));
            }
            input.parse::<Token![,]>()?;
        }
    }
    Ok(texts)
}

fn parse_argument_value(input: ParseStream<'_>) -> syn::Result<ArgumentValue> {
    if input.peek(LitStr) {
        return input.parse().map(ArgumentValue::Text);
    }
    if input.peek(token::Bracket) {
        let ahead = input.fork();
        let content;
        bracketed!(content in ahead);
        if content.peek(LitStr) {
            let content;
            bracketed!(content in input);
            return parse_quoted_names(&content).map(ArgumentValue::Texts);
        }
    }
    parse_expr(input).map(ArgumentValue::Expr)
}
