//! Random typing errors in the mechanisms of the gallery: one token is removed, repeated, exchanged with its
//! neighbour, misspelt or replaced by another one. Each must cause few errors, each with help. The random
//! numbers are seeded, so failures are reproducible; `MUTATIONS=20000` tries more cases, and `SEED=2` tries
//! others.

use linkwork_compiler::diag::Diagnostics;
use linkwork_compiler::expr::Graph;
use linkwork_compiler::resolve::build_model;
use linkwork_compiler::{check_elements_without_syntax_errors, parse_source_and_import};
use proc_macro2::{Group, TokenStream, TokenTree};
use quote::ToTokens;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

/// Number of random mutations that are tested.
const CASES: u64 = 600;
/// Seed of the random mutations.
const SEED: u64 = 20;
/// Maximum number of errors that one mutation of a token may cause.
const MAX_ERRORS: usize = 3;
/// Maximum number of tokens of a mechanism. Larger mechanisms take long and have no other kinds of elements.
const LARGEST: usize = 1500;
/// Maximum time for one mutated mechanism in a debug build on a busy machine.
const PATIENCE: Duration = Duration::from_secs(30);

/// Source of a mechanism of the gallery, to which mutations are applied.
struct GalleryMechanism {
    name: String,
    arguments: TokenStream,
    item: TokenStream,
}

/// Reads the mechanisms of the gallery of models.
fn gallery_mechanisms() -> Vec<GalleryMechanism> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/src");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut all = Vec::new();
    for file in files.iter().filter(|file| file.extension().is_some_and(|end| end == "rs")) {
        let text = std::fs::read_to_string(file).unwrap();
        for item in syn::parse_file(&text).unwrap().items {
            let syn::Item::Struct(mut item) = item else { continue };
            let is_mechanism_attribute =
                |a: &syn::Attribute| a.path().segments.last().is_some_and(|s| s.ident == "mechanism");
            let Some(at) = item.attrs.iter().position(is_mechanism_attribute) else { continue };
            let arguments = match item.attrs.remove(at).meta {
                syn::Meta::List(list) => list.tokens,
                _ => TokenStream::new(),
            };
            item.attrs.clear();
            let name = item.ident.to_string();
            all.push(GalleryMechanism { name, arguments, item: item.into_token_stream() });
        }
    }
    all.retain(|subject| {
        count_tokens(&subject.item) <= LARGEST && !subject.arguments.to_string().contains("urdf")
    });
    all
}

/// Returns the number of tokens in a stream, including groups and their contents.
fn count_tokens(tokens: &TokenStream) -> usize {
    let count_nested_tokens = |token: TokenTree| match token {
        TokenTree::Group(group) => 1 + count_tokens(&group.stream()),
        _ => 1,
    };
    tokens.clone().into_iter().map(count_nested_tokens).sum()
}

/// Random number generator (splitmix64).
struct Random(u64);

impl Random {
    fn index_below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) % n.max(1) as u64) as usize
    }
}

/// Kind of mutation of one token, which imitates a typing error.
#[derive(Clone, Copy, Debug)]
enum TypingError {
    Lost,
    Doubled,
    Exchanged,
    /// One character of an identifier or a number is replaced.
    Misspelt,
    /// The token is replaced by another token of the mechanism.
    Mistaken,
}

const SLIPS: [TypingError; 5] = [
    TypingError::Lost,
    TypingError::Doubled,
    TypingError::Exchanged,
    TypingError::Misspelt,
    TypingError::Mistaken,
];

/// Collects all tokens of a stream that are not groups.
fn collect_leaf_tokens(tokens: &TokenStream, found: &mut Vec<TokenTree>) {
    for token in tokens.clone() {
        match &token {
            TokenTree::Group(group) => collect_leaf_tokens(&group.stream(), found),
            _ => found.push(token),
        }
    }
}

/// Applies a mutation to the token with index `at`, counted in depth-first order.
fn mutate_token_at(
    tokens: TokenStream,
    at: &mut usize,
    slip_: TypingError,
    others: &[TokenTree],
    random: &mut Random,
) -> TokenStream {
    let mut out: Vec<TokenTree> = Vec::new();
    let mut rest = tokens.into_iter().peekable();
    while let Some(token) = rest.next() {
        let here = *at == 0;
        *at = at.wrapping_sub(1);
        if here {
            match slip_ {
                TypingError::Lost => {}
                TypingError::Doubled => out.extend([token.clone(), token]),
                TypingError::Exchanged => {
                    out.extend(rest.next());
                    out.push(token);
                }
                TypingError::Misspelt => out.push(misspell_token(token, random)),
                TypingError::Mistaken => out.push(others[random.index_below(others.len())].clone()),
            }
            continue;
        }
        match token {
            TokenTree::Group(group) => {
                let inner = mutate_token_at(group.stream(), at, slip_, others, random);
                out.push(Group::new(group.delimiter(), inner).into());
            }
            other => out.push(other),
        }
    }
    out.into_iter().collect()
}

fn misspell_token(token: TokenTree, random: &mut Random) -> TokenTree {
    let text = token.to_string();
    let mut letters: Vec<char> = text.chars().collect();
    let at = random.index_below(letters.len());
    let letter = (b'a' + random.index_below(26) as u8) as char;
    match (&token, random.index_below(3)) {
        (TokenTree::Ident(_), 0) => letters.insert(at, letter),
        (TokenTree::Ident(_), 1) if letters.len() > 1 => drop(letters.remove(at)),
        (TokenTree::Ident(_), _) => letters[at] = letter,
        (TokenTree::Literal(_), _) => letters.insert(at, '9'),
        _ => {}
    }
    let text: String = letters.into_iter().collect();
    text.parse::<TokenStream>().ok().and_then(|t| t.into_iter().next()).unwrap_or(token)
}

/// Returns the messages of the parser and the model.
fn parser_and_model_messages(arguments: &TokenStream, item: TokenStream) -> Vec<String> {
    let mut cx = Diagnostics::new();
    if let Some(source) = parse_source_and_import(arguments.clone(), item, Path::new(""), &mut cx) {
        match cx.is_empty() {
            true => drop(build_model(&source.mechanism.description, &Graph::new(), &mut cx)),
            false => check_elements_without_syntax_errors(&source, &Graph::new(), &mut cx),
        }
    }
    cx.full_message_texts()
}

/// Returns the first line of a message without its names: the class of the message.
fn message_without_names(message: &str) -> String {
    let first = message.lines().next().unwrap_or_default();
    first.split('`').step_by(2).collect::<Vec<_>>().join("`…`")
}

#[test]
fn single_token_mutations_get_short_errors() {
    let number_from_environment = |name: &str| std::env::var(name).ok().and_then(|n| n.parse::<u64>().ok());
    let cases = number_from_environment("MUTATIONS").unwrap_or(CASES);
    let gallery = gallery_mechanisms();
    assert!(gallery.len() > 40, "{} mechanisms", gallery.len());
    let mut random = Random(number_from_environment("SEED").unwrap_or(SEED));
    let mut wrong: BTreeMap<String, (usize, String)> = BTreeMap::new();
    for case in 0..cases {
        let subject = &gallery[random.index_below(gallery.len())];
        let mut others = Vec::new();
        collect_leaf_tokens(&subject.item, &mut others);
        let kind = SLIPS[random.index_below(SLIPS.len())];
        let mut at = random.index_below(count_tokens(&subject.item));
        let item = mutate_token_at(subject.item.clone(), &mut at, kind, &others, &mut random);
        // rustc itself reports items that are no structs.
        if syn::parse2::<syn::ItemStruct>(item.clone()).is_err() {
            continue;
        }
        let text = item.to_string();
        let begun = Instant::now();
        let run = std::panic::catch_unwind(|| parser_and_model_messages(&subject.arguments, item));
        let mut record_failure = |what: String| {
            let example = format!("case {case}, {} {kind:?}: {text}", subject.name);
            wrong.entry(what).or_insert((0, example)).0 += 1;
        };
        if begun.elapsed() > PATIENCE {
            record_failure("slow".to_string());
        }
        match run {
            Err(_) => record_failure("panics".to_string()),
            Ok(found) => {
                if found.len() > MAX_ERRORS {
                    record_failure(format!("{} errors:\n{}", found.len(), found.join("\n")));
                }
                for message in found.iter().filter(|m| !m.contains("= help: ")) {
                    record_failure(format!("no help: {}", message_without_names(message)));
                }
            }
        }
    }
    let list: Vec<String> =
        wrong.iter().map(|(what, (n, example))| format!("{n} × {what}\n    {example}")).collect();
    assert!(list.is_empty(), "{} classes:\n{}", list.len(), list.join("\n\n"));
}

/// Returns the error messages of the parser alone, before the model is built.
fn parser_messages(arguments: &TokenStream, item: TokenStream) -> Vec<String> {
    let mut cx = Diagnostics::new();
    parse_source_and_import(arguments.clone(), item, Path::new(""), &mut cx);
    cx.full_message_texts()
}

/// Returns the mechanism with a syntax error in one field: an unknown argument, or an invalid type of a
/// parameter.
fn mechanism_with_syntax_error(item: &TokenStream, at: usize) -> Option<TokenStream> {
    let mut item: syn::ItemStruct = syn::parse2(item.clone()).unwrap();
    let field = item.fields.iter_mut().nth(at)?;
    match field.attrs.iter_mut().find(|a| !a.path().is_ident("doc")) {
        Some(attribute) => {
            let syn::Meta::List(list) = &mut attribute.meta else { return None };
            list.tokens.extend(", nothing = 1".parse::<TokenStream>().unwrap());
        }
        None => field.ty = syn::parse_str("Vec<f64>").unwrap(),
    }
    Some(item.into_token_stream())
}

#[test]
fn unreadable_field_causes_no_other_errors() {
    let mut wrong = Vec::new();
    let mut tried = 0;
    for subject in gallery_mechanisms() {
        let fields = syn::parse2::<syn::ItemStruct>(subject.item.clone()).unwrap().fields.len();
        for item in (0..fields).filter_map(|at| mechanism_with_syntax_error(&subject.item, at)) {
            tried += 1;
            let grammar = parser_messages(&subject.arguments, item.clone());
            let all = parser_and_model_messages(&subject.arguments, item);
            if grammar.is_empty() || all.len() > grammar.len() {
                wrong.push(format!("{}: {}", subject.name, all.join("\n  and ")));
            }
        }
    }
    assert!(tried > 500, "{tried} fields");
    assert!(wrong.is_empty(), "{} of {tried}:\n{}", wrong.len(), wrong.join("\n\n"));
}

#[test]
fn wrongly_declared_name_is_reported_once() {
    let mut wrong = Vec::new();
    for subject in gallery_mechanisms() {
        let item: syn::ItemStruct = syn::parse2(subject.item).unwrap();
        for at in 0..item.fields.len() {
            let mut other = item.clone();
            let field = other.fields.iter_mut().nth(at).unwrap();
            let name = field.ident.replace(syn::parse_str("declared_otherwise").unwrap()).unwrap();
            let found = parser_and_model_messages(&subject.arguments, other.into_token_stream());
            if found.len() > 1 {
                wrong.push(format!("{}, {name}: {}", subject.name, found.join("\n  and ")));
            }
        }
    }
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n\n"));
}
