//! Expands `<include file="…"/>` elements. The result is one text composed of pieces, each with its file of
//! origin.
//!
//! Each file is first parsed separately, so that errors are reported at their positions in that file. A file
//! may be included only once, so the composed text is not longer than all files together.

use crate::diag::Diagnostics;
use crate::import::context::{Cx, format_position, quote_word};
use crate::import::element::{Node, read_name_attribute, report_missing_or_misspelt_attributes};
use crate::import::whole::{
    ComposedText, LoadedRobotFile, MAX_DEPTH, MAX_FILES, canonical_path, report_include_cycle,
    report_too_many_includes,
};
use crate::import::{file, xml};
use crate::syntax::{FileFormat, Name};
use std::cell::OnceCell;
use std::path::Path;

/// Step of the expansion. The list of steps is a stack: the last step is executed first.
enum ExpansionStep {
    /// Expansion step that copies a range of bytes of the file with this index.
    Copy { file: usize, from: usize, to: usize },
    /// Contents of the root of an included file, with the nesting depth.
    Include { by: usize, at: Name, depth: usize },
    /// End of an included file. A later `<include>` of the same file is a repetition, not a cycle.
    Leave,
}

/// Reads an MJCF file together with all files that it includes.
pub(super) fn read_with_includes(
    text: &str,
    path: &Path,
    name: &Name,
    cx: &mut Diagnostics,
) -> Option<ComposedText> {
    let mut whole = ComposedText::new(text, path, name);
    let mut places = vec![name.clone()];
    let mut open = vec![0];
    let mut steps = expansion_steps(&whole.files, 0, name, true, 0, cx)?;
    while let Some(step) = steps.pop() {
        match step {
            ExpansionStep::Copy { file, from, to } => whole.append_file_excerpt(file, from, to, name, cx)?,
            ExpansionStep::Leave => {
                open.pop();
            }
            ExpansionStep::Include { by, at, depth } => {
                let found = find_included_file(&whole.files, by, &at, cx)?;
                if let Some(known) = whole.files.iter().position(|read| read.path == found.path) {
                    report_repeated_include(known, &open, &whole.files, &places, &at, cx);
                    return None;
                }
                if depth > MAX_DEPTH || whole.files.len() >= MAX_FILES {
                    report_too_many_includes(depth, &at, cx);
                    return None;
                }
                let file = whole.files.len();
                whole.files.push(found);
                places.push(at.clone());
                open.push(file);
                steps.push(ExpansionStep::Leave);
                steps.extend(expansion_steps(&whole.files, file, &at, false, depth, cx)?);
            }
        }
    }
    Some(whole)
}

fn report_repeated_include(
    known: usize,
    open: &[usize],
    files: &[LoadedRobotFile],
    places: &[Name],
    at: &Name,
    cx: &mut Diagnostics,
) {
    if open.contains(&known) {
        report_include_cycle(known, open, files, places, at, cx);
        return;
    }
    let shown = files.get(known).map_or("", |read| read.shown.as_str());
    let first = places.get(known).map(|by| format_position(&by.place)).unwrap_or_default();
    cx.report_error(at.place.clone(), format!("{} is included twice", quote_word(shown))).add_help(format!(
        "the first time is at {first}; MJCF takes a file once: copy it under another name"
    ));
}

/// Returns the steps that expand a file, last first: the whole file if `entire`, otherwise the contents of
/// its root.
fn expansion_steps(
    files: &[LoadedRobotFile],
    file: usize,
    name: &Name,
    entire: bool,
    depth: usize,
    cx: &mut Diagnostics,
) -> Option<Vec<ExpansionStep>> {
    let read = files.get(file)?;
    let shown = Name { text: read.shown.clone(), place: name.place.clone() };
    let cx = &mut Cx::new(&read.text, &shown, cx);
    let declared = OnceCell::new();
    let document = xml::parse_document(&read.text, &declared, FileFormat::Mjcf, cx)?;
    let root = document.root_element();
    if declared.get().is_some() {
        let message = "prefixes of names are not declared";
        cx.report_error(&cx.source_position(root.range().start), message, |d| d.add_help("MJCF has none"));
        return None;
    }
    let mut at = if entire { 0 } else { root.first_child().map_or(0, |child| child.range().start) };
    let end = match entire {
        true => read.text.len(),
        false => root.last_child().map_or(0, |child| child.range().end),
    };
    let mut steps = Vec::new();
    for node in root.descendants().filter(|node| is_include_element(*node)) {
        report_missing_or_misspelt_attributes(node, &["file"], &[], cx);
        let written = read_name_attribute(node, "file", cx)?;
        steps.push(ExpansionStep::Copy { file, from: at, to: node.range().start });
        steps.push(ExpansionStep::Include { by: file, at: written, depth: depth + 1 });
        at = node.range().end;
    }
    steps.push(ExpansionStep::Copy { file, from: at, to: end });
    steps.reverse();
    (!cx.has_errors()).then_some(steps)
}

fn is_include_element(node: Node<'_>) -> bool {
    node.is_element() && node.tag_name().name() == "include"
}

/// Finds and reads an included file: in the folder of the user's file, or else in the folder of the including
/// file.
fn find_included_file(
    files: &[LoadedRobotFile],
    by: usize,
    at: &Name,
    cx: &mut Diagnostics,
) -> Option<LoadedRobotFile> {
    let sibling_file_path = |file: usize| {
        let read = files.get(file)?;
        let shown = Path::new(&read.shown).with_file_name(&at.text);
        Some((read.path.with_file_name(&at.text), shown.to_string_lossy().into_owned()))
    };
    let first = sibling_file_path(0)?;
    let (path, shown) = match sibling_file_path(by).filter(|(path, _)| !first.0.is_file() && path.is_file()) {
        Some(other) => other,
        None => first,
    };
    let name = Name { text: shown.clone(), place: at.place.clone() };
    let text = file::read_named_file(&path, &name, FileFormat::Mjcf, cx)?;
    let text = xml::blank_out_nonstandard_xml(&text).into_owned();
    Some(LoadedRobotFile { text, shown, path: canonical_path(&path) })
}
