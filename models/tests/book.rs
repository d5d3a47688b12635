//! Checks that the table of the book's sections in the gallery's documentation has rows for every chapter,
//! and names existing mechanisms and tests.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders of the tests that the table names: this package, the package of tests, that of design, and the
/// compiler's equations.
const FOLDERS: [&str; 4] =
    ["tests", "../tests", "../runtime/design/tests", "../macros/compiler/src/equations/tests"];

/// Chapters of the textbook; those on flight and linear systems are combined.
const CHAPTERS: [&str; 10] = ["1", "2", "3", "4", "5", "6", "7", "8", "9", "10–16"];

fn collect_source_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect_source_files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// Returns the names of the test functions in the text of a file.
fn test_function_names(text: &str) -> impl Iterator<Item = &str> {
    text.split("#[test]").skip(1).filter_map(|rest| rest.split_once("fn ")?.1.split('(').next())
}

/// Returns the texts between backquotes in a table cell.
fn texts_in_backticks(cell: &str) -> impl Iterator<Item = &str> {
    cell.split('`').skip(1).step_by(2)
}

#[test]
fn table_names_existing_mechanisms_and_tests() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let gallery = fs::read_to_string(root.join("src/lib.rs")).unwrap();
    let mut paths = Vec::new();
    FOLDERS.iter().for_each(|folder| collect_source_files(&root.join(folder), &mut paths));
    let texts: Vec<String> = paths.iter().map(|path| fs::read_to_string(path).unwrap()).collect();
    let functions: BTreeSet<&str> = texts.iter().flat_map(|text| test_function_names(text)).collect();
    let is_test_name = |name: &str| {
        let file = if name.ends_with(".rs") { name.to_string() } else { format!("{name}.rs") };
        functions.contains(name) || paths.iter().any(|path| path.ends_with(&file))
    };
    let exported: BTreeSet<&str> = gallery
        .lines()
        .filter(|line| line.starts_with("pub use "))
        .flat_map(|line| line.split([':', '{', '}', ',', ';', ' ']))
        .collect();

    let table = gallery.split("//! # The book, section by section").nth(1).unwrap();
    let lines = table.lines().skip(1).take_while(|line| line.starts_with("//!"));
    let rows: Vec<&str> = lines.filter(|line| line.starts_with("//! | ")).collect();
    assert!(rows.len() > 60, "the table has {} rows", rows.len());
    let mut mistakes = Vec::new();
    for chapter in CHAPTERS {
        if !rows.iter().any(|row| row.starts_with(&format!("//! | {chapter} | "))) {
            mistakes.push(format!("no row of chapter {chapter}"));
        }
    }
    for row in &rows[2..] {
        let cells: Vec<&str> = row.trim_start_matches("//! |").trim_end_matches('|').split(" | ").collect();
        let [chapter, topic, words, proof] = cells[..] else { panic!("four columns: {row}") };
        if !CHAPTERS.contains(&chapter.trim()) {
            mistakes.push(format!("{topic}: no chapter {chapter}"));
        }
        let reason = words.trim().strip_prefix("left out").and_then(|rest| rest.split_once([':', ',', ';']));
        if texts_in_backticks(proof).next().is_none() && reason.is_none_or(|(_, why)| why.trim().is_empty()) {
            mistakes.push(format!("{topic}: neither proved nor left out with a reason"));
        }
        for name in texts_in_backticks(proof) {
            let exists = if proof.contains(&format!("[`{name}`]")) {
                exported.contains(name)
            } else {
                is_test_name(name)
            };
            if !exists {
                mistakes.push(format!("{topic}: no `{name}`"));
            }
        }
    }
    assert!(mistakes.is_empty(), "{}", mistakes.join("\n"));
}
