//! Expressions: Rust's own grammar of numbers, names, calls, fields and the four operations, in a parser whose depth
//! is bounded.

use super::{BinaryOp, Expr, ExprKind, Name};
use proc_macro2::Span;
use syn::ext::IdentExt;
use syn::parse::ParseStream;
use syn::{Ident, Lit, Token, bracketed, parenthesized, token};

/// Deepest expression; a sum of this many terms counts as deep.
const MAX_DEPTH: usize = 400;

/// A parsed expression with its depth.
struct Parsed(Expr, usize);

/// Parses one expression.
pub fn parse_expr(input: ParseStream<'_>) -> syn::Result<Expr> {
    parse_sum(input).map(|p| p.0)
}

/// Parses a name as written, keywords included.
pub fn parse_name(input: ParseStream<'_>) -> syn::Result<Name> {
    Ident::parse_any(input).map(|ident| name(&ident))
}

/// The name of an identifier.
pub fn name(ident: &Ident) -> Name {
    Name { text: ident.unraw().to_string(), place: ident.span().into() }
}

fn node(kind: ExprKind, span: Span, depth: usize) -> syn::Result<Parsed> {
    if depth > MAX_DEPTH {
        return Err(syn::Error::new(
            span,
            "this expression is too long\n\n= help: name a part of it as a parameter",
        ));
    }
    Ok(Parsed(Expr { kind, place: span.into() }, depth))
}

fn parse_sum(input: ParseStream<'_>) -> syn::Result<Parsed> {
    let mut left = parse_product(input)?;
    loop {
        let (op, span) = if input.peek(Token![+]) {
            (BinaryOp::Add, input.parse::<Token![+]>()?.span)
        } else if input.peek(Token![-]) && !input.peek(Token![->]) {
            (BinaryOp::Sub, input.parse::<Token![-]>()?.span)
        } else {
            return Ok(left);
        };
        let right = parse_product(input)?;
        left = binary(op, left, right, span)?;
    }
}

fn parse_product(input: ParseStream<'_>) -> syn::Result<Parsed> {
    let mut left = parse_unary(input)?;
    loop {
        let (op, span) = if input.peek(Token![*]) {
            (BinaryOp::Mul, input.parse::<Token![*]>()?.span)
        } else if input.peek(Token![/]) {
            (BinaryOp::Div, input.parse::<Token![/]>()?.span)
        } else {
            return Ok(left);
        };
        let right = parse_unary(input)?;
        left = binary(op, left, right, span)?;
    }
}

fn binary(op: BinaryOp, left: Parsed, right: Parsed, span: Span) -> syn::Result<Parsed> {
    let depth = left.1.max(right.1) + 1;
    node(ExprKind::Binary(op, Box::new(left.0), Box::new(right.0)), span, depth)
}

fn parse_unary(input: ParseStream<'_>) -> syn::Result<Parsed> {
    if input.peek(Token![-]) && !input.peek(Token![->]) {
        let span = input.parse::<Token![-]>()?.span;
        let inner = parse_unary(input)?;
        return node(ExprKind::Neg(Box::new(inner.0)), span, inner.1 + 1);
    }
    parse_postfix(input)
}

fn parse_postfix(input: ParseStream<'_>) -> syn::Result<Parsed> {
    let mut inner = parse_primary(input)?;
    while input.peek(Token![.]) {
        input.parse::<Token![.]>()?;
        let member = parse_name(input)?;
        let (span, depth) = (member.place.span, inner.1 + 1);
        inner = if input.peek(token::Paren) {
            let (arguments, deepest) = parse_arguments(input)?;
            let kind = ExprKind::Method(Box::new(inner.0), member, arguments);
            node(kind, span, depth.max(deepest + 1))?
        } else {
            node(ExprKind::Field(Box::new(inner.0), member), span, depth)?
        };
    }
    Ok(inner)
}

fn parse_primary(input: ParseStream<'_>) -> syn::Result<Parsed> {
    if input.peek(Lit) {
        return parse_number(input);
    }
    if input.peek(token::Paren) {
        let content;
        let span = parenthesized!(content in input).span.open();
        let (mut items, deepest, trailing) = parse_list(&content)?;
        if items.len() == 1 && !trailing {
            return Ok(Parsed(items.remove(0), deepest + 1));
        }
        return node(ExprKind::Tuple(items), span, deepest + 1);
    }
    if input.peek(token::Bracket) {
        let content;
        let span = bracketed!(content in input).span.open();
        let (items, deepest, _) = parse_list(&content)?;
        return node(ExprKind::Array(items), span, deepest + 1);
    }
    if input.peek(Ident::peek_any) {
        let name = parse_name(input)?;
        let span = name.place.span;
        if input.peek(token::Paren) {
            let (arguments, deepest) = parse_arguments(input)?;
            return node(ExprKind::Call(name, arguments), span, deepest + 1);
        }
        return node(ExprKind::Name(name.text), span, 1);
    }
    Err(input.error("expected an expression: a number, a name, a call or a vector"))
}

fn parse_number(input: ParseStream<'_>) -> syn::Result<Parsed> {
    let literal: Lit = input.parse()?;
    let (digits, suffix) = match &literal {
        Lit::Int(n) => (n.base10_digits().to_string(), n.suffix().to_string()),
        Lit::Float(n) => (n.base10_digits().to_string(), n.suffix().to_string()),
        _ => return Err(syn::Error::new(literal.span(), "expected a number")),
    };
    if !matches!(suffix.as_str(), "" | "f64" | "f32") {
        return Err(syn::Error::new(literal.span(), format!("a number cannot have the suffix `{suffix}`")));
    }
    match digits.parse::<f64>() {
        Ok(value) if value.is_finite() => node(ExprKind::Number(value), literal.span(), 1),
        _ => Err(syn::Error::new(literal.span(), "this number is too large")),
    }
}

fn parse_arguments(input: ParseStream<'_>) -> syn::Result<(Vec<Expr>, usize)> {
    let content;
    parenthesized!(content in input);
    let (items, deepest, _) = parse_list(&content)?;
    Ok((items, deepest))
}

/// Comma-separated expressions to the end: the items, the deepest, whether a comma stands at the end.
fn parse_list(content: ParseStream<'_>) -> syn::Result<(Vec<Expr>, usize, bool)> {
    let (mut items, mut deepest, mut trailing) = (Vec::new(), 0, false);
    while !content.is_empty() {
        let item = parse_sum(content)?;
        deepest = deepest.max(item.1);
        items.push(item.0);
        trailing = content.peek(Token![,]);
        if trailing {
            content.parse::<Token![,]>()?;
        } else if !content.is_empty() {
            return Err(content.error("expected `,` or an operator"));
        }
    }
    Ok((items, deepest, trailing))
}
