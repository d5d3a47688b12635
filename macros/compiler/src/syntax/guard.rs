//! A first pass over the tokens, without recursion, that rejects input on which the recursive parsers could
//! exhaust their stack. A level of recursion is a bracket, a prefix operator, or any token of a type, because
//! Rust's grammar of types nests without brackets, as in `&mut &mut f64`.

use crate::diag::Diagnostics;
use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Maximum total nesting of brackets, prefix operators and pieces of a law.
pub const MAX_DEPTH: usize = 48;
/// Maximum number of tokens since the last separators of all open brackets, outside attributes.
const MAX_TYPE_TOKENS: usize = 100;
/// Maximum number of digits of a number in the source.
const MAX_DIGITS: usize = 1000;
/// Maximum number of tokens in one struct with the attribute.
const MAX_TOKENS: usize = 400_000;
/// Stack that an expansion may use, in bytes: a quarter of the stack of rustc's threads. A nesting level of
/// the unoptimised compiler takes at most 32 KiB of it; a test expands the deepest input of every kind within
/// this stack.
pub const MAX_STACK: usize = MAX_DEPTH * (32 << 10) + (512 << 10);

/// Open bracket in the traversal of a token stream.
struct OpenBracket {
    /// Tokens in the bracket that have not been visited.
    tokens: proc_macro2::token_stream::IntoIter,
    /// Number of brackets and prefix operators that enclose the tokens.
    depth: usize,
    /// Number of type tokens that enclose the bracket.
    outer: usize,
    /// Whether types are possible; false within attributes, whose expressions have a separate parser.
    has_types: bool,
    /// Whether the previous token is `#`, so that a bracket begins an attribute.
    after_hash: bool,
}

impl OpenBracket {
    fn bracket_around_stream(tokens: &TokenStream, has_types: bool) -> Self {
        Self { tokens: tokens.clone().into_iter(), depth: 1, outer: 0, has_types, after_hash: false }
    }
}

/// Reports an attribute's arguments that are nested too deeply or have too many tokens. Returns whether
/// parsing may continue.
pub fn check_argument_size(tokens: &TokenStream, cx: &mut Diagnostics) -> bool {
    check_token_limits(OpenBracket::bracket_around_stream(tokens, false), cx)
}

/// Reports an item whose tokens are nested too deeply or are too many. Returns whether parsing may continue.
pub fn check_item_size(tokens: &TokenStream, cx: &mut Diagnostics) -> bool {
    check_token_limits(OpenBracket::bracket_around_stream(tokens, true), cx)
}

fn check_token_limits(outermost: OpenBracket, cx: &mut Diagnostics) -> bool {
    let mut count = 0;
    let mut angle = 0_usize;
    let mut run = 0_usize;
    let mut types = 0_usize;
    let mut levels = vec![outermost];
    while let Some(level) = levels.last_mut() {
        let Some(token) = level.tokens.next() else {
            types = level.outer;
            levels.pop();
            continue;
        };
        count += 1;
        types += usize::from(level.has_types);
        let after_hash = std::mem::replace(&mut level.after_hash, false);
        let place = token.span();
        match &token {
            TokenTree::Punct(p) => {
                run += 1;
                angle = match p.as_char() {
                    '<' => angle + 1,
                    '>' => angle.saturating_sub(1),
                    ',' | ';' | '=' => 0,
                    _ => angle,
                };
                match p.as_char() {
                    ',' | ';' => types = level.outer,
                    '#' => level.after_hash = true,
                    _ => {}
                }
            }
            TokenTree::Group(g) => {
                // The first sign of a run may be a binary operator.
                let depth = level.depth + run.saturating_sub(1) + 1;
                run = 0;
                let is_attribute = after_hash && g.delimiter() == Delimiter::Bracket;
                let has_types = level.has_types && !is_attribute;
                if is_attribute || g.delimiter() == Delimiter::Brace {
                    types = level.outer;
                }
                if g.delimiter() != Delimiter::None || !g.stream().is_empty() {
                    let tokens = g.stream().into_iter();
                    levels.push(OpenBracket { tokens, depth, outer: types, has_types, after_hash: false });
                }
            }
            TokenTree::Ident(_) => run = 0,
            TokenTree::Literal(literal) => {
                run = 0;
                let text = literal.to_string();
                // The time to parse a number grows with the square of its length.
                if text.len() > MAX_DIGITS && text.starts_with(|c: char| c.is_ascii_digit()) {
                    cx.report_error(place, format!("this number has more than {MAX_DIGITS} digits"));
                    return false;
                }
            }
        }
        let depth = levels.last().map_or(0, |level| level.depth) + run.saturating_sub(1);
        if depth > MAX_DEPTH || angle > MAX_DEPTH {
            cx.report_error(place, "this is nested too deeply")
                .add_help("name a part of it as a parameter, or simplify the expression");
            return false;
        }
        if types > MAX_TYPE_TOKENS {
            cx.report_error(place, format!("this type has more than {MAX_TYPE_TOKENS} tokens"))
                .add_help("give it a name, `type Name = …;`, outside the struct");
            return false;
        }
        if count > MAX_TOKENS {
            cx.report_error(place, format!("this struct has more than {MAX_TOKENS} tokens"));
            return false;
        }
    }
    true
}
