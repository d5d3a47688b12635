//! SDF version of the file in which an element is written.

use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, element_source_position};

/// Attribute in which an included model stores the version of its own file.
pub(super) const OF_INCLUDED: &str = "sdf_version";

/// First version in which links, joints and poses are elements with text.
const FIRST: (u32, u32) = (1, 2);

/// Returns true if an element belongs to a file of an earlier version than `number`. A file without a version
/// is treated as the latest version.
pub(super) fn is_before_version(node: Node<'_>, number: (u32, u32)) -> bool {
    let version = node.ancestors().find_map(|above| {
        above
            .attribute(OF_INCLUDED)
            .or_else(|| above.attribute("version").filter(|_| above.tag_name().name() == "sdf"))
    });
    version.and_then(parse_version).is_some_and(|version| version < number)
}

/// Reports an invalid or unsupported version of SDF.
pub(super) fn report_unsupported_sdf_version(root: Node<'_>, cx: &mut Cx<'_>) {
    let is_sdf = root.tag_name().name() == "sdf";
    let Some(version) = root.attribute_node("version").filter(|_| is_sdf) else { return };
    let at = cx.source_position(version.range_value().start);
    match parse_version(version.value()) {
        None => {
            let message = format!("{} is not a version of SDF", quote_word(version.value()));
            cx.report_error(&at, message, |d| d.add_help("expected a number, as in `version=\"1.9\"`"));
        }
        Some(found) if found < FIRST => report_version_one(root, cx),
        Some(_) => {}
    }
}

/// Reports an SDF file of version 1.0, whose elements have other names.
pub(super) fn report_version_one(root: Node<'_>, cx: &mut Cx<'_>) {
    cx.report_error(&element_source_position(root, cx), "version 1.0 of SDF is not supported", |d| {
        d.add_help("convert the file: `gz sdf -p robot.sdf > converted.sdf`")
    });
}

/// Returns the major and minor number of an SDF version.
fn parse_version(text: &str) -> Option<(u32, u32)> {
    let (major, minor) = text.trim().split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}
