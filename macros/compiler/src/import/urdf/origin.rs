//! Conversion of an element `<origin xyz="…" rpy="…"/>` to a [`FileOrigin`].

use crate::import::context::Cx;
use crate::import::element::{
    Node, element_source_position, read_numbers_attribute, report_likely_degrees, report_unexpected_contents,
};
use crate::import::imported::Located;
use crate::import::robot::FileOrigin;

const RADIANS: &str = "`rpy` is in radians: write the angle that is meant, everywhere in the file";

/// Reads the `<origin>` of `owner`. Without an `<origin>`, the pose is the identity.
pub(super) fn read_origin(node: Option<Node<'_>>, owner: Node<'_>, cx: &mut Cx<'_>) -> FileOrigin {
    let zero_vector_at_node = |node| Located { value: [0.0; 3], place: element_source_position(node, cx) };
    let Some(node) = node else {
        return FileOrigin { xyz: zero_vector_at_node(owner), rpy: zero_vector_at_node(owner) };
    };
    let (no_xyz, no_rpy) = (zero_vector_at_node(node), zero_vector_at_node(node));
    if let Some(found) = node.attribute_node("quat_xyzw") {
        let place = cx.source_position(found.range().start);
        cx.report_error(&place, "`quat_xyzw` is not supported", |d| {
            d.add_help("expected `rpy=\"roll pitch yaw\"`")
        });
    } else {
        report_unexpected_contents(node, &[], &["xyz", "rpy"], &[], cx);
    }
    let xyz = read_numbers_attribute(node, "xyz", cx).unwrap_or(no_xyz);
    let rpy = read_numbers_attribute(node, "rpy", cx).unwrap_or(no_rpy);
    report_likely_degrees(&rpy.value, &rpy.place, RADIANS, cx);
    FileOrigin { xyz, rpy }
}
