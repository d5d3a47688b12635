//! Syntax errors of Rust files, located as the Rust compiler locates them: unclosed brackets and missing
//! commas.

use crate::input::SourceError;
use proc_macro2::{Delimiter, LineColumn, TokenStream, TokenTree};
use std::str::FromStr;

/// Returns the error of a text that is not a Rust file; `error` is the error of the parser.
pub fn syntax_error_of_text(text: &str, error: &syn::Error) -> SourceError {
    let (at, message, notes) = match TokenStream::from_str(text) {
        Ok(tokens) if error.to_string().starts_with("expected `,`") => {
            let (before, after) = previous_end_and_found_token(&tokens, error.span().start());
            (before.unwrap_or(error.span().start()), format!("expected `,`{after}"), Vec::new())
        }
        Ok(_) => (error.span().start(), error.to_string(), Vec::new()),
        Err(lexed) => describe_unbalanced_text(text, lexed.span().start()),
    };
    SourceError { at: Some((at.line, at.column + 1)), message, notes, ..SourceError::default() }
}

/// Returns the position, message and notes for a text that cannot be split into tokens beyond `at`: its
/// brackets do not match, or it has characters that begin no token.
fn describe_unbalanced_text(text: &str, at: LineColumn) -> (LineColumn, String, Vec<String>) {
    let (before, found) = text.split_at(byte_index_of_position(text, at));
    let found = found.chars().next();
    match found {
        Some(closing @ (')' | ']' | '}')) => match TokenStream::from_str(before) {
            Ok(_) => (
                at,
                format!("unexpected closing delimiter: `{closing}` has no opening delimiter"),
                Vec::new(),
            ),
            // The innermost bracket that is open before `at` does not match.
            Err(lexed) => {
                let open = lexed.span().start();
                let bracket = text[byte_index_of_position(text, open)..].chars().next().unwrap_or('(');
                let note =
                    format!("`{bracket}` of line {}, column {} is not closed", open.line, open.column + 1);
                (
                    at,
                    format!(
                        "mismatched closing delimiter: expected `{}`, found `{closing}`",
                        closing_bracket_character(bracket)
                    ),
                    vec![note],
                )
            }
        },
        Some(opening @ ('(' | '[' | '{')) => {
            let (at, opening) = find_misaligned_brace(text).map_or((at, opening), |at| (at, '{'));
            (
                at,
                format!("this is never closed: `{}` is missing", closing_bracket_character(opening)),
                Vec::new(),
            )
        }
        _ => (at, "this is not a Rust token, or a string that is never closed".to_string(), Vec::new()),
    }
}

/// Returns the position of the opening brace that is probably not closed, in a text that ends before all its
/// brackets are closed: the first brace whose partner is indented differently from the line of the brace.
fn find_misaligned_brace(text: &str) -> Option<LineColumn> {
    let mut whole = text.to_string();
    // Closes all open brackets at the end of the text.
    let tokens = loop {
        match TokenStream::from_str(&whole) {
            Ok(tokens) => break tokens,
            Err(lexed) => {
                let bracket = whole[byte_index_of_position(&whole, lexed.span().start())..].chars().next()?;
                if !"([{".contains(bracket) || whole.len() > text.len() + 64 {
                    return None;
                }
                whole.push('\n');
                whole.push(closing_bracket_character(bracket));
            }
        }
    };
    let last = text.lines().count();
    let lines: Vec<&str> = text.lines().collect();
    let indentation_of_line =
        |line: usize| lines.get(line - 1).map(|text| text.len() - text.trim_start().len());
    let (mut found, mut todo) = (None, vec![tokens]);
    while let Some(tokens) = todo.pop() {
        for token in tokens {
            let TokenTree::Group(group) = token else { continue };
            let (open, close) = (group.span_open().start(), group.span_close().start());
            let is_first_on_line = |at: LineColumn| indentation_of_line(at.line) == Some(at.column);
            if group.delimiter() == Delimiter::Brace
                && close.line <= last
                && close.line > open.line
                && is_first_on_line(close)
                && indentation_of_line(open.line) != Some(close.column)
            {
                found = found.max(Some(open));
            }
            todo.push(group.stream());
        }
    }
    found
}

/// Returns the end of the last token before a position, and the text `, found …` for the token at it.
fn previous_end_and_found_token(tokens: &TokenStream, at: LineColumn) -> (Option<LineColumn>, String) {
    let (mut before, mut after, mut todo): (Option<LineColumn>, _, _) =
        (None, String::new(), vec![tokens.clone()]);
    while let Some(tokens) = todo.pop() {
        for token in tokens {
            let (span, text) = match &token {
                TokenTree::Group(group) => (group.span_open(), String::new()),
                other => (other.span(), other.to_string()),
            };
            if span.start() == at && !text.is_empty() {
                after = format!(", found `{text}`");
            }
            let end = token.span().end();
            if end <= at {
                before = before.max(Some(end));
            } else if let TokenTree::Group(group) = token {
                before = before.max(Some(group.span_open().end()).filter(|end| *end <= at));
                todo.push(group.stream());
            }
        }
    }
    (before, after)
}

/// Returns the closing bracket that belongs to an opening one.
fn closing_bracket_character(opening: char) -> char {
    match opening {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// Returns the byte index of a position, whose columns count characters.
fn byte_index_of_position(text: &str, at: LineColumn) -> usize {
    let text = text.strip_prefix('\u{feff}').map_or((text, 0), |rest| (rest, '\u{feff}'.len_utf8()));
    let (text, skipped) = text;
    let start: usize = text.split_inclusive('\n').take(at.line - 1).map(str::len).sum();
    let line = &text[start.min(text.len())..];
    let column = line.char_indices().nth(at.column).map_or(line.len(), |(k, _)| k);
    skipped + start.min(text.len()) + column
}

#[cfg(test)]
mod tests {
    use super::syntax_error_of_text;

    /// Compares with the positions of rustc 1.95, except for brackets that are open at the end of a file:
    /// rustc points at the end of the file and labels the bracket.
    #[test]
    fn syntax_errors_are_located_as_by_rustc() {
        for (text, at, message) in [
            ("struct S {\n    a: f64\n    b: f64,\n}", (2, 11), "expected `,`, found `b`"),
            ("struct S {\n    a: f64 #[x] b: f64,\n}", (2, 11), "expected `,`, found `#`"),
            ("struct S {\n    é: [f64; 3] b: f64,\n}", (2, 16), "expected `,`, found `b`"),
            (
                "struct S {\n    #[body(mass = 1, com = -y]\n    b: Body,\n}",
                (2, 30),
                "expected `)`, found `]`",
            ),
            ("struct S {\n    a: f64,\n}\n}\n", (4, 1), "`}` has no opening delimiter"),
            ("// {\nstruct S {\n    a: f64, // }\n", (2, 10), "this is never closed: `}` is missing"),
            ("#[mechanism(gravity = (1, 2)\nstruct S {}\n", (1, 12), "this is never closed: `)` is missing"),
            ("mod a {\n    struct S {\n        a: f64,\n    fn f() {}\n}\n", (2, 14), "this is never closed"),
            ("struct S {\n    a: \"text,\n}", (2, 8), "never closed"),
        ] {
            let Err(error) = syn::parse_file(text) else { panic!("{text} is a file of Rust") };
            let found = syntax_error_of_text(text, &error);
            assert!(
                found.at == Some(at) && found.message.contains(message),
                "{text}\n{:?} {}",
                found.at,
                found.message
            );
        }
    }
}
