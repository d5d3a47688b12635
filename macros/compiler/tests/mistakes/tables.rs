//! Individual errors, in the files of the folder `tables`. Each row contains the source text, in which `‹`
//! and `›` enclose the tokens that the message points at, and the message. To regenerate the files, run
//! `LINKWORK_WRITE=1 cargo test -p linkwork-compiler --test mistakes` and review the difference.
//!
//! A section begins with `== mechanism(arguments)` and fields, which are common to its rows. Rows of `==
//! items` are complete items. Several messages of a row are in the order of their tokens.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::{compile, parse_source_and_import};
use proc_macro2::{Span, TokenStream, TokenTree};
use std::fs;
use std::path::{Path, PathBuf};

/// Marks around the tokens at which an error message points, in the table files.
const MARKS: [char; 2] = ['‹', '›'];

/// Returns the folder of the tables and of the robots' files.
fn tables_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mistakes")
}

/// Message with its byte range in the source. The range is empty for the attribute as a whole.
struct ShownMessage {
    from: usize,
    to: usize,
    text: String,
}

/// Returns the error messages of the compiler for the source `#[mechanism(…)] item`, ordered by position.
fn messages_of_mechanism(source: &str) -> Vec<ShownMessage> {
    let mut tokens = source.parse::<TokenStream>().expect("these are tokens").into_iter().skip(1);
    let Some(TokenTree::Group(attribute)) = tokens.next() else { panic!("{source} has no attribute") };
    let arguments = attribute.stream().into_iter().find_map(|token| match token {
        TokenTree::Group(arguments) => Some(arguments.stream()),
        _ => None,
    });
    let mut cx = Diagnostics::new();
    if let Some(source) =
        parse_source_and_import(arguments.unwrap_or_default(), tokens.collect(), &tables_folder(), &mut cx)
    {
        compile(&source, &Graph::new(), &mut cx);
    }
    let texts = cx.full_message_texts();
    // Each error is `::core::compile_error! { "…" }`: eight tokens, of which the first and the last have the
    // spans of the error.
    let errors: Vec<Span> = cx.into_tokens().into_iter().map(|token| token.span()).collect();
    let mut found: Vec<ShownMessage> = errors
        .chunks((errors.len() / texts.len().max(1)).max(1))
        .zip(texts)
        .map(|(spans, text)| ShownMessage {
            from: spans[0].byte_range().start,
            to: spans[spans.len() - 1].byte_range().end,
            text,
        })
        .collect();
    found.sort_by_key(|one| (one.from, std::cmp::Reverse(one.to)));
    found
}

/// Returns a row of a table: the source with marks, followed by the messages.
fn table_row_with_messages(before: &str, row: &str, after: &str) -> String {
    let source = format!("{before}{row}{after}");
    let found = messages_of_mechanism(&source);
    let mut marked = String::new();
    for (k, letter) in source.char_indices().chain([(source.len(), ' ')]) {
        if k < before.len() || k > before.len() + row.len() {
            continue;
        }
        let has_nonempty_range = |one: &&ShownMessage| one.from < one.to;
        let ends =
            found.iter().filter(has_nonempty_range).filter(|one| one.to == k && one.from >= before.len());
        marked.extend(ends.map(|_| MARKS[1]));
        let starts = found
            .iter()
            .filter(has_nonempty_range)
            .filter(|one| one.from == k && k < before.len() + row.len());
        marked.extend(starts.map(|_| MARKS[0]));
        if k < before.len() + row.len() {
            marked.push(letter);
        }
    }
    for one in &found {
        let place = match (one.from == one.to, (before.len()..before.len() + row.len()).contains(&one.from)) {
            (true, _) => " at the attribute".to_string(),
            (_, true) => String::new(),
            (_, false) => format!(" at `{}` above", &source[one.from..one.to]),
        };
        let mut lines = one.text.lines().filter(|line| !line.is_empty());
        marked += &format!("\n    error{place}: {}", lines.next().unwrap_or_default());
        marked.extend(lines.map(|line| format!("\n    {}", line.trim_start_matches("= "))));
    }
    marked
}

/// Returns a table with the current messages of all rows.
fn table_with_current_messages(text: &str) -> String {
    let (mut before, mut after) = (String::new(), "");
    let mut blocks = Vec::new();
    for block in text.trim_end().split("\n\n") {
        if let Some(header) = block.strip_prefix("== ") {
            let (arguments, fields) = header.split_once('\n').unwrap_or((header, ""));
            (before, after) = match arguments {
                "items" => (String::new(), ""),
                _ => (format!("#[{arguments}] struct Machine {{\n{fields}\n"), "\n}"),
            };
            blocks.push(block.to_string());
            continue;
        }
        let source: Vec<&str> = block.lines().filter(|line| !line.starts_with("    ")).collect();
        blocks.push(table_row_with_messages(&before, &source.join("\n").replace(MARKS, ""), after));
    }
    blocks.join("\n\n") + "\n"
}

#[test]
fn table_errors_have_expected_messages_and_tokens() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for file in fs::read_dir(tables_folder().join("tables")).unwrap() {
        let path = file.unwrap().path();
        let expected = fs::read_to_string(&path).unwrap();
        let found = table_with_current_messages(&expected);
        if std::env::var_os("LINKWORK_WRITE").is_some() {
            fs::write(&path, &found).unwrap();
        }
        let split_paragraphs = |text: &str| text.split("\n\n").map(String::from).collect::<Vec<_>>();
        for (is, was) in split_paragraphs(&found).into_iter().zip(split_paragraphs(&expected)) {
            count += usize::from(is.contains("\n    error"));
            if is != was {
                wrong.push(format!("{}\nexpected\n{was}\nfound\n{is}", path.display()));
            } else if !is.starts_with("== ") && !is.contains("\n    error") {
                wrong.push(format!("{}\nnothing is said of\n{is}", path.display()));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {count}, which `LINKWORK_WRITE=1` writes anew:\n\n{}",
        wrong.len(),
        wrong.join("\n\n")
    );
}
