//! A first look at the tokens, without recursion: input that would exhaust the stack of the parsers is refused.

use crate::diag::Diagnostics;
use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// Deepest nesting of brackets.
const MAX_DEPTH: usize = 48;
/// Longest run of prefix operators and opening angle brackets.
const MAX_RUN: usize = 48;
/// Most digits of a number.
const MAX_DIGITS: usize = 1000;
/// Most tokens in one struct.
const MAX_TOKENS: usize = 400_000;

/// Reports tokens that are nested too deeply or are too many. True if parsing may go on.
pub fn check_tokens(tokens: &TokenStream, cx: &mut Diagnostics) -> bool {
    let mut count = 0;
    let mut angle = 0_usize;
    let mut run = 0_usize;
    let mut todo = vec![tokens.clone().into_iter()];
    while let Some(stream) = todo.last_mut() {
        let Some(token) = stream.next() else {
            todo.pop();
            continue;
        };
        count += 1;
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
            }
            TokenTree::Group(g) => {
                run = 0;
                if g.delimiter() != Delimiter::None || !g.stream().is_empty() {
                    todo.push(g.stream().into_iter());
                }
            }
            TokenTree::Ident(_) => run = 0,
            TokenTree::Literal(literal) => {
                run = 0;
                let text = literal.to_string();
                // Reading a number takes time that grows as the square of its length.
                if text.len() > MAX_DIGITS && text.starts_with(|c: char| c.is_ascii_digit()) {
                    cx.error(place, format!("this number has more than {MAX_DIGITS} digits"));
                    return false;
                }
            }
        }
        if todo.len() > MAX_DEPTH || angle > MAX_RUN || run > MAX_RUN {
            cx.error(place, "this is nested too deeply")
                .help("name a part of it as a parameter, or simplify the expression");
            return false;
        }
        if count > MAX_TOKENS {
            cx.error(place, format!("this struct has more than {MAX_TOKENS} tokens"));
            return false;
        }
    }
    true
}
