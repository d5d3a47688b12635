//! Reading of robot files as text, for all formats.

use super::context::quote_word;
use crate::diag::{Diagnostics, nearest_candidate};
use crate::syntax::{FileFormat, FileOptions, Name};
use std::borrow::Cow;
use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

/// Maximum size of a robot file, bytes. The largest published robots take less than one mebibyte.
pub const LARGEST_FILE: usize = 16 << 20;

/// Maximum number of entries of a folder that are searched for names similar to a missing file.
const NEIGHBOURS: usize = 1000;

/// Zero-width characters that Unicode does not count as whitespace: zero-width space, word joiner and byte
/// order mark.
const INVISIBLE: [char; 3] = ['\u{200b}', '\u{2060}', '\u{feff}'];

/// Removes a byte order mark at the start of a text, and replaces whitespace and invisible characters that
/// parsers of XML and of numbers do not know, such as no-break spaces, by spaces.
pub fn with_standard_whitespace(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let is_invisible_character = |c: char| !c.is_ascii() && (c.is_whitespace() || INVISIBLE.contains(&c));
    match text.contains(is_invisible_character) {
        true => Cow::Owned(text.replace(is_invisible_character, " ")),
        false => Cow::Borrowed(text),
    }
}

/// Reads the file at `path`. `options` contain the path as the user wrote it and its source position.
pub fn read_imported_file(path: &Path, options: &FileOptions, cx: &mut Diagnostics) -> Option<String> {
    read_named_file(path, &options.path, options.format, cx)
}

/// Reads the file at `path`. `name` is the path as shown in messages, with its source position.
pub(super) fn read_named_file(
    path: &Path,
    name: &Name,
    format: FileFormat,
    cx: &mut Diagnostics,
) -> Option<String> {
    let bytes = fs::metadata(path).and_then(|about| match reason_not_to_open_file(&about, format) {
        Some(reason) => Ok(Err(reason)),
        None => read_bytes_of_limited_file(path).map(Ok),
    });
    match bytes {
        Ok(Ok(bytes)) if bytes.len() > LARGEST_FILE => {
            report_file_error(&too_large_message(bytes.len() as u64), name, cx)
        }
        Ok(Ok(bytes)) => return decode_text(bytes, name, cx),
        Ok(Err(reason)) => report_file_error(&reason, name, cx),
        Err(error) => report_unreadable(path, &error, name, format, cx),
    }
    None
}

/// Returns the reason why a file must not be opened, such as being a pipe or a device.
fn reason_not_to_open_file(about: &fs::Metadata, format: FileFormat) -> Option<String> {
    match () {
        _ if about.is_dir() => Some(format!("is a directory, expected {}", format.file_format_phrase())),
        _ if !about.is_file() => Some("is not a regular file".to_string()),
        _ if about.len() > LARGEST_FILE as u64 => Some(too_large_message(about.len())),
        _ => None,
    }
}

/// Returns the error text for a file that exceeds the maximum size.
pub(super) fn too_large_message(bytes: u64) -> String {
    format!("has {} MiB, expected at most {} MiB", bytes.div_ceil(1 << 20), LARGEST_FILE >> 20)
}

/// Reports an error that concerns a robot file as a whole.
pub(super) fn report_file_error(reason: &str, name: &Name, cx: &mut Diagnostics) {
    cx.report_error(name.place.clone(), format!("{} {reason}", quote_word(&name.text)));
}

/// Reads the bytes of the file. If the file has grown since the check, at most one byte more than the maximum
/// size is read.
fn read_bytes_of_limited_file(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    fs::File::open(path)?.take(LARGEST_FILE as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn decode_text(bytes: Vec<u8>, name: &Name, cx: &mut Diagnostics) -> Option<String> {
    match String::from_utf8(bytes) {
        Ok(text) => Some(text),
        Err(error) => {
            let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            let line = 1 + good.iter().filter(|b| **b == b'\n').count();
            let message = format!("{} is not UTF-8 text: line {line}", quote_word(&name.text));
            cx.report_error(name.place.clone(), message).add_help("save the file in UTF-8");
            None
        }
    }
}

fn report_unreadable(
    path: &Path,
    error: &std::io::Error,
    name: &Name,
    format: FileFormat,
    cx: &mut Diagnostics,
) {
    let (place, written) = (name.place.clone(), &name.text);
    if !matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) {
        cx.report_error(place, format!("cannot read {}: {error}", quote_word(written)));
        return;
    }
    let diagnostic = cx.report_error(place, format!("there is no file {}", quote_word(written)));
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            diagnostic.add_help(format!("there is no directory `{}` either", folder.display()));
        }
        _ => {
            let neighbours = neighbouring_files(path, written, format);
            let near = nearest_candidate(written, &neighbours.iter().map(String::as_str).collect::<Vec<_>>());
            diagnostic.suggest_name(written, neighbours.iter().map(String::as_str));
            // The path is shown only if the name has no similar neighbour.
            if near.is_none() {
                diagnostic.add_help(format!("looked for `{}`", path.display()));
            }
        }
    }
}

/// Returns the files of the same format in the folder of a missing file, with the path as the user would
/// write it.
fn neighbouring_files(path: &Path, written: &str, format: FileFormat) -> Vec<String> {
    let Some(Ok(entries)) = path.parent().map(|folder| match folder.as_os_str().is_empty() {
        true => fs::read_dir("."),
        false => fs::read_dir(folder),
    }) else {
        return Vec::new();
    };
    let stem = &written[..written.rfind(['/', '\\']).map_or(0, |slash| slash + 1)];
    let names = entries.take(NEIGHBOURS).flatten().filter_map(|entry| entry.file_name().into_string().ok());
    let has_description_extension = |name: &String| {
        let end = name.rsplit('.').next().unwrap_or_default();
        format.extensions_of_file_format().iter().any(|known| end.eq_ignore_ascii_case(known))
    };
    let mut list: Vec<String> =
        names.filter(has_description_extension).map(|name| format!("{stem}{name}")).collect();
    // The order of directory entries depends on the machine.
    list.sort();
    list
}
