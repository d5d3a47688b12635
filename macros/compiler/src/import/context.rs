//! Byte offsets of an imported file → [`Place`]s, and the file's mistakes → [`Diagnostics`].
//! Knows no file format.

use crate::diag::{Diagnostic, Diagnostics, FilePosition, Place};
use crate::syntax::Name;
use proc_macro2::Span;
use std::collections::BTreeSet;
use std::rc::Rc;

/// Mistakes of one file that are reported; a file that is not what it claims to be has thousands.
const MISTAKES_SHOWN: usize = 32;

/// Bytes from one known position to the next.
const BLOCK: usize = 256;

/// A file that was read.
struct File<'a> {
    text: &'a str,
    path: Rc<str>,
    /// Line and column at the start of every block: without them, each place would cost a pass over the file.
    blocks: Vec<(u32, u32)>,
}

/// From which byte on the whole text comes from which byte of which file.
#[derive(Clone, Copy)]
pub(super) struct Piece {
    /// Its first byte in the whole text.
    pub(super) start: usize,
    /// The file, by number.
    pub(super) file: usize,
    /// The byte there.
    pub(super) offset: usize,
}

/// Positions in one file, or in several that make one text, and their mistakes so far.
pub(super) struct Cx<'a> {
    files: Vec<File<'a>>,
    pieces: Vec<Piece>,
    span: Span,
    /// What the parsed text has that the file has not: where it begins, its bytes, its characters.
    added: (usize, usize, u32),
    diagnostics: &'a mut Diagnostics,
    mistakes: usize,
    habits: Vec<&'static str>,
    reported: BTreeSet<((u32, u32), String)>,
}

impl<'a> Cx<'a> {
    /// The context of the file `text`, named by `path`.
    pub(super) fn new(text: &'a str, path: &Name, diagnostics: &'a mut Diagnostics) -> Cx<'a> {
        let piece = Piece { start: 0, file: 0, offset: 0 };
        Cx::of_pieces(&[(text, &path.text)], vec![piece], path.place.span, diagnostics)
    }

    /// The context of a text that is put together from pieces of files, each with its path; the first piece
    /// begins it.
    pub(super) fn of_pieces(
        files: &[(&'a str, &str)],
        pieces: Vec<Piece>,
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

    /// Places are from now on those of a text that has `more` than the file, in a line, from the byte at
    /// `offset` on.
    pub(super) fn add(&mut self, offset: usize, more: &str) {
        self.added = (offset, more.len(), more.chars().count() as u32);
    }

    /// The file, and the offset in it, of an offset in the parsed text.
    fn in_file(&self, offset: usize) -> (usize, usize) {
        let (start, bytes, _) = self.added;
        let offset = if offset <= start { offset } else { offset.saturating_sub(bytes).max(start) };
        let after = self.pieces.partition_point(|piece| piece.start <= offset);
        let piece = after.checked_sub(1).and_then(|k| self.pieces.get(k)).copied();
        piece.map_or((0, offset), |piece| (piece.file, piece.offset + (offset - piece.start)))
    }

    /// The place of the byte at `offset`.
    pub(super) fn place(&self, offset: usize) -> Place {
        let (file, offset) = self.in_file(offset);
        let (line, column) = self.files[file].position(offset);
        self.place_at(file, line, column)
    }

    /// The place at a line and a column of the parsed text, both from one.
    pub(super) fn parsed_at(&self, line: u32, column: u32) -> Place {
        let (start, _, characters) = self.added;
        let (first, from) = self.files[0].position(start);
        if line != first || column <= from {
            return self.place_at(0, line, column);
        }
        self.place_at(0, line, column.saturating_sub(characters).max(from))
    }

    /// The place at a line and a column of a file, both from one.
    fn place_at(&self, file: usize, line: u32, column: u32) -> Place {
        let file = Some(FilePosition { file: self.files[file].path.clone(), line, column });
        Place { span: self.span, end: self.span, file }
    }

    /// The place of the end of the file.
    pub(super) fn end(&self) -> Place {
        let (line, column) = self.files[0].position(usize::MAX);
        self.place_at(0, line, column)
    }

    /// The file's bytes in a range of the parsed text, if they are whole characters.
    pub(super) fn slice(&self, range: std::ops::Range<usize>) -> Option<&'a str> {
        let ((file, start), (other, end)) = (self.in_file(range.start), self.in_file(range.end));
        self.files[file].text.get(start..end).filter(|_| file == other)
    }

    /// Reports a mistake; `mend` adds the help.
    pub(super) fn error(
        &mut self,
        place: &Place,
        message: impl Into<String>,
        mend: impl FnOnce(&mut Diagnostic) -> &mut Diagnostic,
    ) {
        let message = message.into();
        let at = place.file.as_ref().map_or((0, 0), |at| (at.line, at.column));
        // What a default says wrongly is said for everything that has it.
        if !self.reported.insert((at, message.clone())) {
            return;
        }
        self.mistakes += 1;
        if self.mistakes <= MISTAKES_SHOWN {
            mend(self.diagnostics.error(place.clone(), message));
        } else if self.mistakes == MISTAKES_SHOWN + 1 {
            let message =
                format!("`{}` has more mistakes; these are the first {MISTAKES_SHOWN}", self.files[0].path);
            self.diagnostics.error(self.span, message);
        }
    }

    /// Reports a mistake that a file has all over, once: `help` tells it from others.
    pub(super) fn habit(&mut self, place: &Place, message: String, help: &'static str) {
        if self.habits.contains(&help) {
            self.mistakes += 1;
            return;
        }
        self.habits.push(help);
        self.error(place, message, |d| d.help(help));
    }

    /// True if this file had a mistake.
    pub(super) fn failed(&self) -> bool {
        self.mistakes > 0
    }
}

impl<'a> File<'a> {
    fn new(text: &'a str, path: &str) -> File<'a> {
        let mut blocks = vec![(1, 1)];
        let mut position = (1, 1);
        for block in text.as_bytes().chunks(BLOCK) {
            position = block.iter().fold(position, advance);
            blocks.push(position);
        }
        File { text, path: Rc::from(path), blocks }
    }

    /// Line and column of a byte; of the end, if it is behind that.
    fn position(&self, offset: usize) -> (u32, u32) {
        let offset = offset.min(self.text.len());
        let block = offset / BLOCK;
        let start = self.blocks.get(block).copied().unwrap_or((1, 1));
        self.text.as_bytes()[block * BLOCK..offset].iter().fold(start, advance)
    }
}

/// The position behind a byte: columns count characters, as editors do.
fn advance((line, column): (u32, u32), byte: &u8) -> (u32, u32) {
    match byte {
        b'\n' => (line + 1, 1),
        0x80..=0xBF => (line, column),
        _ => (line, column + 1),
    }
}

/// The user's word in backticks, shortened if it is no word.
pub(super) fn quote(word: &str) -> String {
    match word.char_indices().nth(60) {
        Some((end, _)) => format!("`{}…`", &word[..end]),
        None => format!("`{word}`"),
    }
}

/// The first of many words, each in backticks.
pub(super) fn quote_all<'n>(words: impl Iterator<Item = &'n str>) -> String {
    let mut list: Vec<String> = words.take(9).map(quote).collect();
    if list.len() == 9 {
        list[8] = "…".to_string();
    }
    list.join(", ")
}

/// `file:line:column` of a place, for the help of another one.
pub(super) fn position(place: &Place) -> String {
    match &place.file {
        Some(at) => format!("{}:{}:{}", at.file, at.line, at.column),
        None => "this attribute".to_string(),
    }
}
