//! Importers of URDF, MJCF and SDF files. They produce the bodies and joints of a
//! [`Description`](crate::syntax::Description), with line and column of every name and number.
//!
//! The importers know no mechanics: they do not check masses and inertias. URDF transmissions and the
//! extensions of simulators are not read.

use crate::diag::Diagnostics;
use crate::syntax::FileFormat;
pub use crate::syntax::FileOptions;
use std::cell::OnceCell;
use std::path::Path;

mod contact_limit;
mod context;
mod element;
mod file;
mod hulls;
mod imported;
mod mesh;
mod misplaced;
mod mjcf;
mod pose;
mod robot;
mod sdf;
mod separate_contacts;
mod urdf;
mod whole;
mod xml;

#[cfg(test)]
mod tests;

pub use file::{LARGEST_FILE, read_imported_file, with_standard_whitespace};
pub use hulls::read_hulls;
pub use imported::ImportedMechanism;
pub use separate_contacts::{
    SeparateContact, SeparateContactParameter, exceeds_contact_points, separate_contacts,
};

/// Reads the text of a file. Paths of other files are relative to the folder of the file, which is
/// `options.path` in `folder`.
///
/// Reports every error to `cx`, at the path's literal in the attribute and with line and column in the file.
/// Returns `None` if there is an error.
pub fn import_file(
    text: &str,
    folder: &Path,
    options: &FileOptions,
    cx: &mut Diagnostics,
) -> Option<ImportedMechanism> {
    if text.len() > LARGEST_FILE {
        file::report_file_error(&file::too_large_message(text.len() as u64), &options.path, cx);
        return None;
    }
    let text = &*xml::blank_out_nonstandard_xml(text);
    match options.format {
        FileFormat::Urdf => import_urdf(text, &folder.join(&options.path.text), options, cx),
        FileFormat::Mjcf => mjcf::import_file(text, &folder.join(&options.path.text), options, cx),
        FileFormat::Sdf => sdf::import_sdf(text, &folder.join(&options.path.text), options, cx),
    }
}

fn import_urdf(
    text: &str,
    path: &Path,
    options: &FileOptions,
    cx: &mut Diagnostics,
) -> Option<ImportedMechanism> {
    let cx = &mut context::Cx::new(text, &options.path, cx);
    let declared = OnceCell::new();
    let document = xml::parse_document(text, &declared, options.format, cx)?;
    urdf::mechanism_from_root_element(document.root_element(), path.parent().unwrap_or(path), options, cx)
}
