//! Operations of all functions of the mechanisms in the gallery, and how long their code is, with all that can be asked for by a word, as
//! `gallery.txt` says.

use crate::measure::measure;
use linkwork_compiler::derive::{Output, Prepared};
use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::lower::{Counts, Program};
use linkwork_compiler::{compile, read};
use proc_macro2::TokenStream;
use quote::ToTokens;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

const WORDS: [&str; 5] = ["derivatives", "centroidal", "regressor", "packed", "batch"];
/// Those that have a meaning where there are parameters.
const OF_PARAMETERS: [&str; 2] = ["sensitivities", "prepare"];

/// Columns of the table.
const WIDTH: usize = 120;

/// A mechanism of a file: its name, what the attribute is given, and the struct without it.
fn mechanisms(path: &Path) -> Vec<(String, TokenStream, TokenStream)> {
    let file = syn::parse_file(&fs::read_to_string(path).expect("it can be read")).expect("it is Rust");
    let taken = |item: syn::Item| {
        let syn::Item::Struct(mut item) = item else { return None };
        let is_it = |attribute: &syn::Attribute| attribute.path().is_ident("mechanism");
        let attribute = item.attrs.iter().find(|attribute| is_it(attribute))?;
        let given = attribute.meta.require_list().map(|list| list.tokens.clone()).unwrap_or_default();
        item.attrs.retain(|attribute| !is_it(attribute));
        Some((item.ident.to_string(), given, item.to_token_stream()))
    };
    file.items.into_iter().filter_map(taken).collect()
}

/// Multiplications, additions and divisions, sines, cosines and the like, and the instructions that are left where products are fused
/// into sums: those of lanes in brackets. Nothing where there are none.
fn operations(name: &str, program: &Program) -> Option<String> {
    if program.counts == Counts::default() {
        return None;
    }
    let of = |p: &Program| format!("{}+{}/{}", p.counts.total(), p.counts.calls, super::instructions(p));
    let lanes = program.simd.as_deref().map(|lanes| format!("[{}]", of(lanes))).unwrap_or_default();
    Some(format!("{name} {}{lanes}", of(program)))
}

fn counted(Output { functions, links, frames, prepared, .. }: &Output) -> Vec<String> {
    let mut all: Vec<Option<String>> = functions.iter().map(|f| operations(&f.name, &f.program)).collect();
    if let Some(Prepared { numbers, functions }) = prepared {
        all.push(operations("prepared", numbers));
        all.extend(functions.iter().map(|f| operations(&format!("prepared.{}", f.name), &f.program)));
    }
    for (k, link) in links.iter().enumerate() {
        let parts = [&link.placement, &link.twist, &link.acceleration, &link.columns];
        all.extend(parts.map(|part| operations(&format!("link{k}"), part)));
    }
    for frame in frames {
        let parts = [&frame.placement, &frame.twist, &frame.acceleration];
        all.extend(parts.map(|part| operations(&frame.name, part)));
    }
    all.into_iter().flatten().collect()
}

/// The code, measured, and what its functions cost.
fn costs(arguments: TokenStream, item: TokenStream, folder: &Path) -> Option<(String, Vec<String>)> {
    let (mut cx, graph) = (Diagnostics::new(), Graph::new());
    let source = read(arguments, item, folder, &mut cx)?;
    let (model, output) = compile(&source, &graph, &mut cx)?;
    Some((measure(&source.emit(&model, &output).text), counted(&output)))
}

/// The table of a file.
fn table(path: &Path, folder: &Path) -> String {
    let mut text = String::new();
    for (name, arguments, item) in mechanisms(path) {
        let given: Vec<String> = arguments.clone().into_iter().map(|token| token.to_string()).collect();
        let comma = if given.last().is_none_or(|last| last == ",") { "" } else { "," };
        let with = |words: &[&str]| {
            let more: Vec<&str> =
                words.iter().copied().filter(|word| !given.iter().any(|given| given == word)).collect();
            let words: TokenStream = format!("{comma}{}", more.join(",")).parse().expect("words are tokens");
            costs(TokenStream::from_iter([arguments.clone(), words]), item.clone(), folder)
        };
        let all = with(&[&WORDS[..], &OF_PARAMETERS].concat()).or_else(|| with(&WORDS));
        let (code, functions) = all.expect("the gallery has no mistakes");
        writeln!(text, "{name}, {code}").expect("a string takes all");
        let mut line = String::from(" ");
        for entry in functions {
            if line.len() + entry.len() >= WIDTH {
                writeln!(text, "{line}").expect("a string takes all");
                line = String::from(" ");
            }
            write!(line, " {entry},").expect("a string takes all");
        }
        writeln!(text, "{}", line.trim_end_matches(',')).expect("a string takes all");
    }
    text
}

/// What a change of any pass, of its order, or of a choice among candidates costs or saves shows up in the table. It is written anew with
/// `LINKWORK_WRITE=1 cargo test -p linkwork-compiler --test operation_counts`, and its difference is for reading.
#[test]
fn the_gallery_costs_what_its_table_says() {
    // Relative, for the code has the paths of files.
    let models = Path::new("../../models");
    let mut files: Vec<PathBuf> = fs::read_dir(models.join("src"))
        .expect("the gallery has sources")
        .map(|entry| entry.expect("it can be read").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect();
    files.sort();
    let path = "tests/operation_counts/gallery.txt";
    let writes = std::env::var_os("LINKWORK_WRITE").is_some();
    let expected = fs::read_to_string(path).expect("there is a table");
    let mut found = String::new();
    for file in files {
        found += &table(&file, models);
        if !writes && !expected.starts_with(&found) {
            let differs = found.lines().zip(expected.lines()).find(|(now, before)| now != before);
            panic!("{}, now and before: {differs:?}", file.display());
        }
    }
    if writes {
        fs::write(path, &found).expect("the table can be written");
    } else {
        assert_eq!(found.len(), expected.len(), "there are mechanisms no more");
    }
}
