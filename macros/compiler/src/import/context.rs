//! Context of an import: converts byte offsets of files to [`Place`]s and reports errors to [`Diagnostics`].
//! This module knows no file format.

use crate::diag::{Diagnostic, Diagnostics, FilePosition, Place};
use crate::syntax::Name;
use proc_macro2::Span;
use std::collections::BTreeSet;
use std::rc::Rc;

/// Maximum number of errors that one import reports, since a file of the wrong kind may have thousands.
const MISTAKES_SHOWN: usize = 32;

/// Distance in bytes between positions in a file whose line and column are stored.
const BLOCK: usize = 256;

/// Robot file that was read, with stored line and column positions.
struct File<'a> {
    text: &'a str,
    path: Rc<str>,
    /// Line and column at the start of every block. Otherwise each position would require a pass over the
    /// file.
    blocks: Vec<(u32, u32)>,
}

/// Piece of the text composed of several files that is copied from one file.
#[derive(Clone, Copy)]
pub(super) struct ComposedTextPiece {
    /// Offset of the piece in the text composed of several files, bytes.
    pub(super) start: usize,
    /// Index of the file from which the piece is copied.
    pub(super) file: usize,
    /// Offset of the piece in the file from which it is copied, bytes.
    pub(super) offset: usize,
}

/// Positions in a file, or in a text composed of several files, and the errors found so far.
pub(super) struct Cx<'a> {
    files: Vec<File<'a>>,
    pieces: Vec<ComposedTextPiece>,
    span: Span,
    /// Difference between the parsed text and the file: offset of the insertion, number of bytes, number of
    /// characters.
    added: (usize, usize, u32),
    diagnostics: &'a mut Diagnostics,
    mistakes: usize,
    habits: Vec<&'static str>,
    reported: BTreeSet<((u32, u32), String)>,
}

impl<'a> Cx<'a> {
    /// Creates the import context of the file `text` at `path`.
    pub(super) fn new(text: &'a str, path: &Name, diagnostics: &'a mut Diagnostics) -> Cx<'a> {
        let piece = ComposedTextPiece { start: 0, file: 0, offset: 0 };
        Cx::from_pieces(&[(text, &path.text)], vec![piece], path.place.span, diagnostics)
    }

    /// Creates the context of a text that is composed of pieces of files. `files` contains text and path of
    /// each file; the first piece starts at offset zero.
    pub(super) fn from_pieces(
        files: &[(&'a str, &str)],
        pieces: Vec<ComposedTextPiece>,
        span: Span,
        diagnostics: &'a mut Diagnostics,
    ) -> Cx<'a> {
        let files = files.iter().map(|(text, path)| File::new(text, path)).collect();
        Cx {
            files,
            pieces,
            span,
            added: (0, 0, 0),
            diagnostics,
            mistakes: 0,
            habits: Vec::new(),
            reported: BTreeSet::new(),
        }
    }

    /// Declares that the parsed text differs from the file: `more`, a text without line breaks, is inserted
    /// at byte `offset`. Later positions refer to the parsed text.
    pub(super) fn record_inserted_text(&mut self, offset: usize, more: &str) {
        self.added = (offset, more.len(), more.chars().count() as u32);
    }

    /// Converts an offset in the parsed text to the index of a file and the offset in that file.
    fn offset_in_file(&self, offset: usize) -> (usize, usize) {
        let (start, bytes, _) = self.added;
        let offset = if offset <= start { offset } else { offset.saturating_sub(bytes).max(start) };
        let after = self.pieces.partition_point(|piece| piece.start <= offset);
        let piece = after.checked_sub(1).and_then(|k| self.pieces.get(k)).copied();
        piece.map_or((0, offset), |piece| (piece.file, piece.offset + (offset - piece.start)))
    }

    /// Returns the source position of the byte at `offset` of the parsed text.
    pub(super) fn source_position(&self, offset: usize) -> Place {
        let (file, offset) = self.offset_in_file(offset);
        let (line, column) = self.files[file].line_and_column(offset);
        self.place_of_line_and_column(file, line, column)
    }

    /// Returns the source position for a line and a column of the parsed text, both counted from one.
    pub(super) fn source_position_from_parsed_text(&self, line: u32, column: u32) -> Place {
        let (start, _, characters) = self.added;
        let (first, from) = self.files[0].line_and_column(start);
        if line != first || column <= from {
            return self.place_of_line_and_column(0, line, column);
        }
        self.place_of_line_and_column(0, line, column.saturating_sub(characters).max(from))
    }

    /// Returns the source position for a line and a column of a file, both counted from one.
    fn place_of_line_and_column(&self, file: usize, line: u32, column: u32) -> Place {
        let file = Some(FilePosition { file: self.files[file].path.clone(), line, column });
        Place { span: self.span, end: self.span, file }
    }

    /// Returns the source position of the end of the file.
    pub(super) fn end_of_file(&self) -> Place {
        let (line, column) = self.files[0].line_and_column(usize::MAX);
        self.place_of_line_and_column(0, line, column)
    }

    /// Returns the text of the file in a range of the parsed text. Returns `None` if the range spans several
    /// files or splits a character.
    pub(super) fn file_text_in_range(&self, range: std::ops::Range<usize>) -> Option<&'a str> {
        let ((file, start), (other, end)) =
            (self.offset_in_file(range.start), self.offset_in_file(range.end));
        self.files[file].text.get(start..end).filter(|_| file == other)
    }

    /// Reports an error at a position of the file; `mend` adds the help.
    pub(super) fn report_error(
        &mut self,
        place: &Place,
        message: impl Into<String>,
        mend: impl FnOnce(&mut Diagnostic) -> &mut Diagnostic,
    ) {
        let message = message.into();
        let at = place.file.as_ref().map_or((0, 0), |at| (at.line, at.column));
        // An error in a default is found again at every element that uses the default.
        if !self.reported.insert((at, message.clone())) {
            return;
        }
        self.mistakes += 1;
        if self.mistakes <= MISTAKES_SHOWN {
            mend(self.diagnostics.report_error(place.clone(), message));
        } else if self.mistakes == MISTAKES_SHOWN + 1 {
            let message =
                format!("`{}` has more errors; these are the first {MISTAKES_SHOWN}", self.files[0].path);
            self.diagnostics.report_error(self.span, message);
        }
    }

    /// Reports only the first of many similar errors in a file. Errors with the same `help` are similar.
    pub(super) fn report_first_of_similar_errors(
        &mut self,
        place: &Place,
        message: String,
        help: &'static str,
    ) {
        if self.habits.contains(&help) {
            self.mistakes += 1;
            return;
        }
        self.habits.push(help);
        self.report_error(place, message, |d| d.add_help(help));
    }

    /// Reports an internal error: something that was read from the file has no counterpart in the mechanism,
    /// although no error was reported.
    pub(super) fn report_internal_loss_of_element(&mut self, name: &Name) {
        let message = format!("internal error: {} of the file is lost", quote_word(&name.text));
        self.report_error(&name.place, message, |d| d.add_help("please report this with the file"));
    }

    /// Returns whether the import reported an error.
    pub(super) fn has_errors(&self) -> bool {
        self.mistakes > 0
    }
}

impl<'a> File<'a> {
    fn new(text: &'a str, path: &str) -> File<'a> {
        let mut blocks = vec![(1, 1)];
        let mut position = (1, 1);
        for block in text.as_bytes().chunks(BLOCK) {
            position = block.iter().fold(position, advance_position);
            blocks.push(position);
        }
        File { text, path: Rc::from(path), blocks }
    }

    /// Returns line and column of a byte. Offsets beyond the end return the position of the end.
    fn line_and_column(&self, offset: usize) -> (u32, u32) {
        let offset = offset.min(self.text.len());
        let block = offset / BLOCK;
        let start = self.blocks.get(block).copied().unwrap_or((1, 1));
        self.text.as_bytes()[block * BLOCK..offset].iter().fold(start, advance_position)
    }
}

/// Returns the position after a byte. Columns count characters, as editors do.
fn advance_position((line, column): (u32, u32), byte: &u8) -> (u32, u32) {
    match byte {
        b'\n' => (line + 1, 1),
        0x80..=0xBF => (line, column),
        _ => (line, column + 1),
    }
}

/// Returns a word of the file in backticks, truncated after 60 characters.
pub(super) fn quote_word(word: &str) -> String {
    match word.char_indices().nth(60) {
        Some((end, _)) => format!("`{}…`", &word[..end]),
        None => format!("`{word}`"),
    }
}

/// Returns the words, each in backticks. Words after the eighth are replaced by an ellipsis.
pub(super) fn quote_first_eight_words<'n>(words: impl Iterator<Item = &'n str>) -> String {
    let mut list: Vec<String> = words.take(9).map(quote_word).collect();
    if list.len() == 9 {
        list[8] = "…".to_string();
    }
    list.join(", ")
}

/// Returns `file:line:column` of a position, for the help text of another error.
pub(super) fn format_position(place: &Place) -> String {
    match &place.file {
        Some(at) => format!("{}:{}:{}", at.file, at.line, at.column),
        None => "this attribute".to_string(),
    }
}
