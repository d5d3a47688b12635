//! Parser of expressions: Rust's grammar of numbers, names, calls, fields and the four operations, with
//! bounded depth.

use super::{BinaryOp, Callee, Expr, ExprKind, Member, Name, guard};
use crate::diag::{Place, syn_error_with_help};
use crate::language::SurfaceId;
use crate::language::callable::IF;
use proc_macro2::{Span, TokenTree};
use syn::ext::IdentExt;
use syn::parse::discouraged::Speculative;
use syn::parse::{ParseStream, Parser};
use syn::{Ident, Lit, LitStr, Token, braced, bracketed, parenthesized, token};

/// Maximum length of a chain of operators or member accesses in an expression.
const MAX_LENGTH: usize = 400;

const PIECEWISE_HELP: &str =
    "a piecewise law is written `if stretch < gap { 0 } else { k * (stretch - gap) }`";

/// Parsed expression with its size, for the limit on nesting.
struct ParsedExpression(Expr, ExpressionSize);

/// Size of an expression, whose bounds limit the recursion of every traversal.
#[derive(Clone, Copy, Default)]
struct ExpressionSize {
    /// Nesting of operands, arguments and pieces; left operands of operators are not nested.
    depth: usize,
    /// Length of the longest path of operators, members and calls.
    length: usize,
}

impl ExpressionSize {
    const ONE: Self = Self { depth: 1, length: 1 };

    fn componentwise_maximum_size(self, other: Self) -> Self {
        Self { depth: self.depth.max(other.depth), length: self.length.max(other.length) }
    }

    /// Returns the size of an expression in which these operands are nested.
    fn size_of_nested_expression(self) -> Self {
        Self { depth: self.depth + 1, length: self.length + 1 }
    }

    /// Returns the size of a chain with one more link, at the same nesting depth.
    fn size_of_longer_chain(self) -> Self {
        Self { length: self.length + 1, ..self }
    }
}

/// Parses one expression of the language.
pub fn parse_expr(input: ParseStream<'_>) -> syn::Result<Expr> {
    parse_sum(input).map(|p| p.0)
}

/// Parses a name of the language, which may be a keyword of Rust.
pub fn parse_name(input: ParseStream<'_>) -> syn::Result<Name> {
    Ident::parse_any(input).map(|ident| name_from_identifier(&ident))
}

/// Converts an identifier token to a name with its span.
pub fn name_from_identifier(ident: &Ident) -> Name {
    Name { text: ident.unraw().to_string(), place: ident.span().into() }
}

fn expression_within_size_limits(
    kind: ExprKind,
    place: Place,
    size: ExpressionSize,
) -> syn::Result<ParsedExpression> {
    let message = if size.depth > guard::MAX_DEPTH {
        "this expression is nested too deeply"
    } else if size.length > MAX_LENGTH {
        "this expression is too long"
    } else {
        return Ok(ParsedExpression(Expr { kind, place }, size));
    };
    Err(syn_error_with_help(
        place.span,
        message,
        "define a part of it as a quantity of its own with `#[define(…)]`",
    ))
}

fn parse_sum(input: ParseStream<'_>) -> syn::Result<ParsedExpression> {
    let mut left = parse_product(input)?;
    loop {
        let assigns = input.peek(Token![+=]) || input.peek(Token![-=]);
        let (op, span) = if input.peek(Token![+]) && !assigns {
            (BinaryOp::Add, input.parse::<Token![+]>()?.span)
        } else if input.peek(Token![-]) && !assigns && !input.peek(Token![->]) && !input.peek2(Token![->]) {
            (BinaryOp::Sub, input.parse::<Token![-]>()?.span)
        } else {
            return Ok(left);
        };
        let right = parse_operand(span, input, parse_product)?;
        left = binary_expression(op, span, left, right)?;
    }
}

fn parse_product(input: ParseStream<'_>) -> syn::Result<ParsedExpression> {
    let mut left = parse_unary(input)?;
    loop {
        if input.peek(Token![*=]) || input.peek(Token![/=]) {
            return Ok(left);
        }
        let (op, span) = if input.peek(Token![*]) {
            (BinaryOp::Mul, input.parse::<Token![*]>()?.span)
        } else if input.peek(Token![/]) {
            (BinaryOp::Div, input.parse::<Token![/]>()?.span)
        } else {
            return Ok(left);
        };
        let right = parse_operand(span, input, parse_unary)?;
        left = binary_expression(op, span, left, right)?;
    }
}

/// Parses the operand after an operator. An error at the end of the input is reported at the operator,
/// because no other token is left.
fn parse_operand(
    operator: Span,
    input: ParseStream<'_>,
    parse: fn(ParseStream<'_>) -> syn::Result<ParsedExpression>,
) -> syn::Result<ParsedExpression> {
    if input.is_empty() || input.peek(Token![,]) {
        return Err(syn_error_with_help(
            operator,
            "missing operand after this operator",
            "write an operand, or remove it",
        ));
    }
    parse(input)
}

fn binary_expression(
    op: BinaryOp,
    operator: Span,
    left: ParsedExpression,
    right: ParsedExpression,
) -> syn::Result<ParsedExpression> {
    let size = left.1.size_of_longer_chain().componentwise_maximum_size(right.1.size_of_nested_expression());
    let place = left.0.place.extend_to_end_of(&right.0.place);
    expression_within_size_limits(
        ExprKind::Binary(op, Box::new(left.0), Box::new(right.0), operator.into()),
        place,
        size,
    )
}

fn parse_unary(input: ParseStream<'_>) -> syn::Result<ParsedExpression> {
    if input.peek(Token![-]) && !input.peek(Token![->]) {
        let span = input.parse::<Token![-]>()?.span;
        let inner = parse_operand(span, input, parse_unary)?;
        let place = Place::from(span).extend_to_end_of(&inner.0.place);
        return expression_within_size_limits(
            ExprKind::Neg(Box::new(inner.0)),
            place,
            inner.1.size_of_nested_expression(),
        );
    }
    parse_postfix(input)
}

fn parse_postfix(input: ParseStream<'_>) -> syn::Result<ParsedExpression> {
    let mut inner = parse_primary(input)?;
    while input.peek(Token![.]) {
        let dot = input.parse::<Token![.]>()?.span;
        if !input.peek(Ident::peek_any) {
            let help = "`body.x` is an axis of a body, `body.at(vector)` a point of it";
            return Err(syn_error_with_help(dot, "expected a name after this dot", help));
        }
        let member = parse_name(input)?;
        let size = inner.1.size_of_longer_chain();
        inner = if input.peek(token::Paren) {
            let (arguments, arguments_size, close) = match member.text == SurfaceId::Hull.name() {
                true => parse_hull_arguments(input)?,
                false => parse_parenthesised_arguments(input)?,
            };
            let place = inner.0.place.extend_to_end_of(&close.into());
            expression_within_size_limits(
                ExprKind::Method(Box::new(inner.0), Member::new(member, arguments.len()), arguments),
                place,
                size.componentwise_maximum_size(arguments_size.size_of_nested_expression()),
            )?
        } else {
            let place = inner.0.place.extend_to_end_of(&member.place);
            expression_within_size_limits(ExprKind::Field(Box::new(inner.0), member), place, size)?
        };
    }
    Ok(inner)
}

fn parse_primary(input: ParseStream<'_>) -> syn::Result<ParsedExpression> {
    if input.peek(token::Group) {
        return parse_macro_fragment(input);
    }
    if input.peek(Lit) {
        return parse_number(input);
    }
    if input.peek(token::Paren) {
        let content;
        let span = parenthesized!(content in input).span;
        let place = Place::from(span.open()).extend_to_end_of(&span.close().into());
        let (mut items, size, trailing) = parse_list(&content)?;
        if items.len() == 1 && !trailing {
            let item = items.remove(0);
            return Ok(ParsedExpression(Expr { place, ..item }, size.size_of_nested_expression()));
        }
        return expression_within_size_limits(
            ExprKind::Tuple(items),
            place,
            size.size_of_nested_expression(),
        );
    }
    if input.peek(token::Bracket) {
        let content;
        let span = bracketed!(content in input).span;
        let place = Place::from(span.open()).extend_to_end_of(&span.close().into());
        let (items, size, _) = parse_list(&content)?;
        return expression_within_size_limits(
            ExprKind::Array(items),
            place,
            size.size_of_nested_expression(),
        );
    }
    if input.peek(Token![if]) {
        return parse_if_expression(input);
    }
    let keyword = input.peek(Token![match]) || input.peek(Token![let]);
    if input.peek(Ident::peek_any) && !keyword {
        let name = parse_name(input)?;
        let place = name.place.clone();
        if input.peek(token::Paren) {
            let (arguments, size, close) = parse_parenthesised_arguments(input)?;
            return expression_within_size_limits(
                ExprKind::Call(Callee::new(name), arguments),
                place.extend_to_end_of(&close.into()),
                size.size_of_nested_expression(),
            );
        }
        return expression_within_size_limits(ExprKind::Name(name.text), place, ExpressionSize::ONE);
    }
    Err(missing_expression_error(input))
}

/// One branch `if left < right { piece }` of a piecewise law.
struct PiecewiseBranch {
    keyword: Span,
    left: ParsedExpression,
    right: ParsedExpression,
    is_less: bool,
    piece: ParsedExpression,
}

/// Parses `if a < b { below } else { above }` into a call of `IF`. Its arguments are the operands of the
/// comparison, the piece below and the piece above the border; `a > b` swaps the pieces. Further branches
/// `else if` are nested in the last argument.
fn parse_if_expression(input: ParseStream<'_>) -> syn::Result<ParsedExpression> {
    let mut branches = vec![parse_branch(input)?];
    let (mut last, end) = loop {
        if !input.peek(Token![else]) {
            let message = "an `if` needs an `else`: both branches need a value";
            let keyword = branches.last().map_or(input.span(), |branch| branch.keyword);
            return Err(syn_error_with_help(keyword, message, PIECEWISE_HELP));
        }
        input.parse::<Token![else]>()?;
        if input.peek(Token![if]) {
            branches.push(parse_branch(input)?);
        } else if input.peek(token::Brace) {
            break parse_braced_expression(input)?;
        } else {
            return Err(syn_error_with_help(
                input.span(),
                "expected `{` or `if` after `else`",
                PIECEWISE_HELP,
            ));
        }
    };
    for PiecewiseBranch { keyword, left, right, is_less, piece } in branches.into_iter().rev() {
        let size = left
            .1
            .componentwise_maximum_size(right.1)
            .componentwise_maximum_size(piece.1)
            .componentwise_maximum_size(last.1)
            .size_of_nested_expression();
        let pieces = if is_less { [piece.0, last.0] } else { [last.0, piece.0] };
        let arguments = [left.0, right.0].into_iter().chain(pieces).collect();
        let place = Place::from(keyword);
        let name = Name { text: IF.to_string(), place: place.clone() };
        last = expression_within_size_limits(
            ExprKind::Call(Callee::new(name), arguments),
            place.extend_to_end_of(&end),
            size,
        )?;
    }
    Ok(last)
}

/// Parses the branch `if a < b { piece }` of a piecewise expression.
fn parse_branch(input: ParseStream<'_>) -> syn::Result<PiecewiseBranch> {
    let keyword = input.parse::<Token![if]>()?.span;
    let left = parse_operand(keyword, input, parse_sum)?;
    let is_less = input.peek(Token![<]) || input.peek(Token![<=]);
    if input.peek(Token![<=]) {
        input.parse::<Token![<=]>()?;
    } else if is_less {
        input.parse::<Token![<]>()?;
    } else if input.peek(Token![>=]) {
        input.parse::<Token![>=]>()?;
    } else if input.peek(Token![>]) {
        input.parse::<Token![>]>()?;
    } else {
        let message = "expected `<` or `>`: a condition compares two quantities";
        return Err(syn_error_with_help(input.span(), message, PIECEWISE_HELP));
    }
    let right = parse_sum(input)?;
    if !input.peek(token::Brace) {
        return Err(syn_error_with_help(
            input.span(),
            "expected `{` and the expression for a true comparison",
            PIECEWISE_HELP,
        ));
    }
    let piece = parse_braced_expression(input)?.0;
    Ok(PiecewiseBranch { keyword, left, right, is_less, piece })
}

/// Parses an expression in braces; returns it with the position of the closing brace.
fn parse_braced_expression(input: ParseStream<'_>) -> syn::Result<(ParsedExpression, Place)> {
    let content;
    let close = braced!(content in input).span.close();
    if content.is_empty() {
        return Err(syn_error_with_help(close, "expected an expression in these braces", PIECEWISE_HELP));
    }
    let piece = parse_sum(&content)?;
    if content.is_empty() { Ok((piece, close.into())) } else { Err(unexpected_token_error(&content)) }
}

/// Parses an expression that a macro of the user passes on: one operand without parentheses.
fn parse_macro_fragment(input: ParseStream<'_>) -> syn::Result<ParsedExpression> {
    let TokenTree::Group(group) = input.parse()? else { return Err(missing_expression_error(input)) };
    let parse_whole_fragment = |inner: ParseStream<'_>| {
        let parsed = parse_sum(inner)?;
        if inner.is_empty() { Ok(parsed) } else { Err(unexpected_token_error(inner)) }
    };
    parse_whole_fragment.parse2(group.stream())
}

/// Returns the error for a missing expression.
fn missing_expression_error(input: ParseStream<'_>) -> syn::Error {
    let message = "expected an expression: a number, a name, a call or a vector";
    let help = if input.peek(Token![*]) {
        "`*` is a binary operator; write `pow(a, n)` for a power"
    } else if input.peek(Token![+]) {
        "remove the `+`: it is a binary operator"
    } else if input.peek(Token![|]) {
        "an expression consists of parameters, coordinates and functions of the language; it has no closures"
    } else if input.peek(Token![=]) {
        "write `name = value`"
    } else if input.peek(Token![->]) {
        "write `parent -> child`"
    } else if input.peek(Token![&]) {
        "parameters are used without references: remove the `&`"
    } else if input.peek(token::Brace) || input.peek(Token![match]) {
        "an expression has no blocks; a continuous piecewise expression is `if a < b { … } else { … }`"
    } else if input.is_empty() {
        return input.error(message);
    } else {
        "expressions are made of numbers, names, `+`, `-`, `*`, `/`, parentheses and calls"
    };
    syn_error_with_help(input.span(), message, help)
}

/// Returns the error for an unexpected token after an expression.
pub fn unexpected_token_error(input: ParseStream<'_>) -> syn::Error {
    let message = "expected `,` or an operator";
    let help = if input.peek(Token![->]) {
        "a joint has two ends; write a joint for each `parent -> child`"
    } else if input.peek(Token![<]) && input.peek2(Token![-]) || input.peek(Token![=>]) {
        "write `parent -> child`"
    } else if input.peek(Token![<]) || input.peek(Token![>]) || input.peek(Token![!=]) {
        "comparisons are allowed in `if a < b { … } else { … }`, and a constraint is an equation, `a = b`"
    } else if input.peek(Token![::]) {
        "names have no path: the number π is `pi`, a vector `[a, b, c]`, a constant a parameter"
    } else if input.peek(token::Bracket) {
        "coordinates have names, that of a joint or `joint.x` if it has several; numbered elements are \
         declared as a list, `hinge: [Pin; 2]`"
    } else if input.peek(Token![=]) {
        "arguments of a function are positional, without names"
    } else if input.peek(Token![:]) {
        "write `name = value`"
    } else if input.peek(Token![^]) {
        "write `pow(a, n)` for a power"
    } else if input.peek(Token![as]) {
        "all numbers have one type: remove the conversion"
    } else if input.peek(Token![!]) {
        "an expression calls functions, not macros"
    } else if input.peek(Ident::peek_any) || input.peek(Lit) || input.peek(token::Paren) {
        "arguments are separated by `,` and factors by `*`"
    } else {
        "the operators are `+`, `-`, `*` and `/`"
    };
    syn_error_with_help(input.span(), message, help)
}

/// Returns a text in quotes.
pub fn quote_text(text: &str) -> String {
    format!("\"{text}\"")
}

fn parse_number(input: ParseStream<'_>) -> syn::Result<ParsedExpression> {
    let literal: Lit = input.parse()?;
    let (digits, suffix) = match &literal {
        Lit::Int(n) => (n.base10_digits().to_string(), n.suffix().to_string()),
        Lit::Float(n) => (n.base10_digits().to_string(), n.suffix().to_string()),
        // Words; the error at their use is more helpful.
        Lit::Bool(b) => {
            return expression_within_size_limits(
                ExprKind::Name(b.value.to_string()),
                b.span.into(),
                ExpressionSize::ONE,
            );
        }
        Lit::Str(_) | Lit::Char(_) => {
            let message = "expected an expression, found a string";
            return Err(syn_error_with_help(literal.span(), message, "write it without quotes"));
        }
        _ => {
            return Err(syn_error_with_help(
                literal.span(),
                "expected a number",
                "write it in digits, as in `9.81`",
            ));
        }
    };
    if !matches!(suffix.as_str(), "" | "f64" | "f32") {
        let message = format!("a number cannot have the suffix `{suffix}`");
        return Err(syn_error_with_help(
            literal.span(),
            &message,
            "all quantities are in SI units, all angles in radians",
        ));
    }
    match digits.parse::<f64>() {
        Ok(value) if value.is_finite() => {
            expression_within_size_limits(ExprKind::Number(value), literal.span().into(), ExpressionSize::ONE)
        }
        _ => {
            Err(syn_error_with_help(literal.span(), "this number is too large", "the largest is about 1e308"))
        }
    }
}

/// Parses expressions in parentheses; returns them with their common size and the closing parenthesis.
fn parse_parenthesised_arguments(input: ParseStream<'_>) -> syn::Result<(Vec<Expr>, ExpressionSize, Span)> {
    let content;
    let close = parenthesized!(content in input).span.close();
    let (items, size, _) = parse_list(&content)?;
    Ok((items, size, close))
}

/// Parses the arguments of `hull(points)` or `hull("path")` with their size, and the closing parenthesis.
fn parse_hull_arguments(input: ParseStream<'_>) -> syn::Result<(Vec<Expr>, ExpressionSize, Span)> {
    let ahead = input.fork();
    let content;
    let close = parenthesized!(content in ahead).span.close();
    if !content.peek(LitStr) {
        return parse_parenthesised_arguments(input);
    }
    let path: LitStr = content.parse()?;
    if !content.is_empty() {
        return Err(unexpected_token_error(&content));
    }
    input.advance_to(&ahead);
    let path = Expr { kind: ExprKind::Text(path.value()), place: path.span().into() };
    Ok((vec![path], ExpressionSize::ONE, close))
}

/// Parses comma-separated expressions to the end; returns their common size, and whether the last one is
/// followed by a comma.
fn parse_list(content: ParseStream<'_>) -> syn::Result<(Vec<Expr>, ExpressionSize, bool)> {
    let (mut items, mut size, mut trailing) = (Vec::new(), ExpressionSize::default(), false);
    while !content.is_empty() {
        let item = parse_sum(content)?;
        size = size.componentwise_maximum_size(item.1);
        items.push(item.0);
        trailing = content.peek(Token![,]);
        if trailing {
            content.parse::<Token![,]>()?;
        } else if !content.is_empty() {
            return Err(unexpected_token_error(content));
        }
    }
    Ok((items, size, trailing))
}
