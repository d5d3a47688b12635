//! Texts that are put together from pieces of several files, which know where they come from. Knows no file
//! format.

use super::context::{Cx, Piece, position, quote};
use super::element::Node;
use super::imported::Imported;
use super::{LARGEST_FILE, file, xml};
use crate::diag::Diagnostics;
use crate::syntax::{FileFormat, Name};
use std::cell::OnceCell;
use std::path::{Path, PathBuf};

/// Files that include one another, each in the next.
pub(super) const MAX_DEPTH: usize = 32;
/// Files of one mechanism.
pub(super) const MAX_FILES: usize = 256;

/// A file that was read.
pub(super) struct Read {
    /// Its text.
    pub(super) text: String,
    /// Its path, as a message names it.
    pub(super) shown: String,
    /// Where it is.
    pub(super) path: PathBuf,
}

/// The files, and the text that they make.
pub(super) struct Whole {
    /// The first one is the file that the user names.
    pub(super) files: Vec<Read>,
    /// The text.
    pub(super) text: String,
    /// What of it comes from which file.
    pub(super) pieces: Vec<Piece>,
}

impl Whole {
    /// Nothing yet of the file that the user names.
    pub(super) fn new(text: &str, path: &Path, name: &Name) -> Whole {
        let first = Read { text: text.to_string(), shown: name.text.clone(), path: path.to_path_buf() };
        Whole { files: vec![first], text: String::new(), pieces: Vec::new() }
    }

    /// Adds bytes of a file.
    pub(super) fn copy(
        &mut self,
        file: usize,
        from: usize,
        to: usize,
        name: &Name,
        cx: &mut Diagnostics,
    ) -> Option<()> {
        let piece = self.files.get(file)?.text.get(from..to)?;
        self.pieces.push(Piece { start: self.text.len(), file, offset: from });
        self.text.push_str(piece);
        self.check_size(name, cx)
    }

    /// Adds a text that stands for what is at a place of a file.
    pub(super) fn put(
        &mut self,
        text: &str,
        (file, offset): (usize, usize),
        name: &Name,
        cx: &mut Diagnostics,
    ) -> Option<()> {
        self.pieces.push(Piece { start: self.text.len(), file, offset });
        self.text.push_str(text);
        self.check_size(name, cx)
    }

    fn check_size(&self, name: &Name, cx: &mut Diagnostics) -> Option<()> {
        if self.text.len() > LARGEST_FILE {
            file::report(&file::too_large(self.text.len() as u64), name, cx);
            return None;
        }
        Some(())
    }
}

/// What `read` makes of a text of several files, of which the user names the first one.
pub(super) fn imported(
    whole: Whole,
    name: &Name,
    format: FileFormat,
    cx: &mut Diagnostics,
    read: impl FnOnce(Node<'_>, &mut Cx<'_>) -> Option<Imported>,
) -> Option<Imported> {
    let files: Vec<(&str, &str)> =
        whole.files.iter().map(|file| (file.text.as_str(), file.shown.as_str())).collect();
    let cx = &mut Cx::of_pieces(&files, whole.pieces, name.place.span, cx);
    let declared = OnceCell::new();
    let document = xml::parse(&whole.text, &declared, format, cx)?;
    let mut imported = read(document.root_element(), cx)?;
    imported.files.extend(whole.files.into_iter().skip(1).map(|file| file.path));
    Some(imported)
}

/// Reports a file that includes itself, by way of those that are open, which are included at these places.
pub(super) fn report_circle(
    known: usize,
    open: &[usize],
    files: &[Read],
    places: &[Name],
    at: &Name,
    cx: &mut Diagnostics,
) {
    let shown = files.get(known).map_or("", |read| read.shown.as_str());
    let error = cx.error(at.place.clone(), format!("{} includes itself", quote(shown)));
    let rest = open.iter().skip_while(|file| **file != known).skip(1);
    for by in rest.filter_map(|file| places.get(*file)) {
        error.help(format!("by way of {} at {}", quote(&by.text), position(&by.place)));
    }
}

/// Reports files that are too many or too deep.
pub(super) fn report_many(depth: usize, at: &Name, cx: &mut Diagnostics) {
    let (most, what) = if depth > MAX_DEPTH {
        (MAX_DEPTH, "files inside one another")
    } else {
        (MAX_FILES, "included files")
    };
    cx.error(at.place.clone(), format!("more than {most} {what}"));
}

/// A path without detours, so that one file has one.
pub(super) fn plain(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
}
