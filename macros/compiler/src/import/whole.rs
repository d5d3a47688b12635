//! Texts composed of pieces of several files, each with its file of origin. This module knows no file format.

use super::context::{ComposedTextPiece, Cx, format_position, quote_word};
use super::element::Node;
use super::imported::ImportedMechanism;
use super::{LARGEST_FILE, file, xml};
use crate::diag::Diagnostics;
use crate::syntax::{FileFormat, Name};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

/// Maximum nesting depth of included files.
pub(super) const MAX_DEPTH: usize = 32;
/// Maximum number of included files.
pub(super) const MAX_FILES: usize = 256;

/// Robot file that was read: its text and its paths.
pub(super) struct LoadedRobotFile {
    /// Text of the robot file.
    pub(super) text: String,
    /// Path of the file as messages show it.
    pub(super) shown: String,
    /// Canonical path of the file on disk.
    pub(super) path: PathBuf,
}

/// Robot file with its included files, and the text composed of them.
pub(super) struct ComposedText {
    /// Files that were read; the first one is the file that the user names.
    pub(super) files: Vec<LoadedRobotFile>,
    /// Text of the robot file with its included files so far.
    pub(super) text: String,
    /// Pieces of the text, each with its file of origin.
    pub(super) pieces: Vec<ComposedTextPiece>,
}

impl ComposedText {
    /// Creates an empty text. The file that the user names is file 0.
    pub(super) fn new(text: &str, path: &Path, name: &Name) -> ComposedText {
        let first =
            LoadedRobotFile { text: text.to_string(), shown: name.text.clone(), path: path.to_path_buf() };
        ComposedText { files: vec![first], text: String::new(), pieces: Vec::new() }
    }

    /// Appends bytes of a file to the composed text.
    pub(super) fn append_file_excerpt(
        &mut self,
        file: usize,
        from: usize,
        to: usize,
        name: &Name,
        cx: &mut Diagnostics,
    ) -> Option<()> {
        let piece = self.files.get(file)?.text.get(from..to)?;
        self.pieces.push(ComposedTextPiece { start: self.text.len(), file, offset: from });
        self.text.push_str(piece);
        self.check_text_size(name, cx)
    }

    /// Appends a text that is attributed to a position in a file.
    pub(super) fn append_text(
        &mut self,
        text: &str,
        (file, offset): (usize, usize),
        name: &Name,
        cx: &mut Diagnostics,
    ) -> Option<()> {
        self.pieces.push(ComposedTextPiece { start: self.text.len(), file, offset });
        self.text.push_str(text);
        self.check_text_size(name, cx)
    }

    fn check_text_size(&self, name: &Name, cx: &mut Diagnostics) -> Option<()> {
        if self.text.len() > LARGEST_FILE {
            file::report_file_error(&file::too_large_message(self.text.len() as u64), name, cx);
            return None;
        }
        Some(())
    }
}

/// Parses a composed text and calls `read` with its root element. `name` is the file that the user names.
pub(super) fn import_composed_text(
    whole: ComposedText,
    name: &Name,
    format: FileFormat,
    cx: &mut Diagnostics,
    read: impl FnOnce(Node<'_>, &mut Cx<'_>) -> Option<ImportedMechanism>,
) -> Option<ImportedMechanism> {
    let files: Vec<(&str, &str)> =
        whole.files.iter().map(|file| (file.text.as_str(), file.shown.as_str())).collect();
    let cx = &mut Cx::from_pieces(&files, whole.pieces, name.place.span, cx);
    let declared = OnceCell::new();
    let document = xml::parse_document(&whole.text, &declared, format, cx)?;
    let mut imported = read(document.root_element(), cx)?;
    imported.files.extend(whole.files.into_iter().skip(1).map(|file| file.path));
    Some(imported)
}

/// Reports a file that includes itself. `open` are the files of the chain of includes, and `places` the
/// `<include>` of each file.
pub(super) fn report_include_cycle(
    known: usize,
    open: &[usize],
    files: &[LoadedRobotFile],
    places: &[Name],
    at: &Name,
    cx: &mut Diagnostics,
) {
    let shown = files.get(known).map_or("", |read| read.shown.as_str());
    let error = cx.report_error(at.place.clone(), format!("{} includes itself", quote_word(shown)));
    let rest = open.iter().skip_while(|file| **file != known).skip(1);
    for by in rest.filter_map(|file| places.get(*file)) {
        error.add_help(format!("through {} at {}", quote_word(&by.text), format_position(&by.place)));
    }
}

/// Reports too many included files, or includes that are nested too deeply.
pub(super) fn report_too_many_includes(depth: usize, at: &Name, cx: &mut Diagnostics) {
    let (most, what) =
        if depth > MAX_DEPTH { (MAX_DEPTH, "nested files") } else { (MAX_FILES, "included files") };
    cx.report_error(at.place.clone(), format!("more than {most} {what}"));
}

/// Returns the canonical path of a file, so that equal files have equal paths.
pub(super) fn canonical_path(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}
