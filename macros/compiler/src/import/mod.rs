//! Files of other formats → the lists of bodies and joints of a [`Description`](crate::syntax::Description),
//! with line and column of every word and number.
//!
//! Knows XML, URDF, MJCF and SDF; no mechanics. It does not judge masses and inertias, and it does not read
//! geometry, limits, transmissions or the extensions of simulators.

use crate::diag::Diagnostics;
use crate::syntax::FileFormat;
pub use crate::syntax::FileOptions;
use std::cell::OnceCell;
use std::path::Path;

mod context;
mod element;
mod file;
mod imported;
mod mjcf;
mod pose;
mod robot;
mod sdf;
mod urdf;
mod whole;
mod xml;

#[cfg(test)]
mod tests;

pub use file::{LARGEST_FILE, read_file, with_plain_blanks};
pub use imported::Imported;

/// Reads the text of a file; other files that it names are looked up beside it, at `options.path` in
/// `folder`.
///
/// Every mistake is reported to `cx`, at the option's literal and with the file's own line and column;
/// `None` if there was any.
pub fn import(text: &str, folder: &Path, options: &FileOptions, cx: &mut Diagnostics) -> Option<Imported> {
    if text.len() > LARGEST_FILE {
        file::report(&file::too_large(text.len() as u64), &options.path, cx);
        return None;
    }
    let text = &*xml::cleaned(text);
    match options.format {
        FileFormat::Urdf => import_urdf(text, options, cx),
        FileFormat::Mjcf => mjcf::import(text, &folder.join(&options.path.text), options, cx),
        FileFormat::Sdf => sdf::import(text, &folder.join(&options.path.text), options, cx),
    }
}

fn import_urdf(text: &str, options: &FileOptions, cx: &mut Diagnostics) -> Option<Imported> {
    let cx = &mut context::Cx::new(text, &options.path, cx);
    let declared = OnceCell::new();
    let document = xml::parse(text, &declared, options.format, cx)?;
    urdf::read(document.root_element(), options, cx)
}
