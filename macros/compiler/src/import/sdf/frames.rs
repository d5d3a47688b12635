//! Resolution of frames that are defined relative to one another to their poses in the model.

use super::scope::{Scope, WORLD};
use super::version::is_before_version;
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Attribute, Node, check_attributes_of_value_element, child_elements, element_source_position,
    nonblank_texts_and_own_elements, read_numbers_content, report_duplicate, report_likely_degrees,
};
use crate::import::pose::{IDENTITY, NumericPose, axis_rotation, matrix_product, rotation_of_quaternion};
use crate::import::robot::{FileOrigin, origin_from_pose};
use crate::syntax::Name;
use std::collections::BTreeMap;

/// Maximum length of a chain of frames that are relative to one another.
const MAX_DEPTH: usize = 1024;

/// Frame of the file: a link, a joint, a model or a `<frame>`.
#[derive(Clone, Debug)]
pub(super) struct SdfFrame {
    /// Full name of the frame that the pose is relative to.
    pub(super) base: Name,
    /// Pose of the SDF frame relative to the frame `base`.
    pub(super) pose: NumericPose,
    /// Frame that this frame is attached to; `None` for links.
    pub(super) attached: Option<Name>,
}

/// All frames by their full names: `arm::wrist` is the link `wrist` of the model `arm` in the outermost
/// model.
#[derive(Default)]
pub(super) struct Frames {
    /// SDF frames by their full names.
    pub(super) known: BTreeMap<String, SdfFrame>,
}

/// First version in which the attribute `relative_to` of a pose replaces `frame`.
const RELATIVE_TO: (u32, u32) = (1, 7);

/// Reads `<pose relative_to="…">` of an element, or `<pose frame="…">` in old versions. Without either
/// attribute, the pose is relative to `base`.
pub(super) fn read_relative_pose(node: Node<'_>, scope: &Scope, base: &str, cx: &mut Cx<'_>) -> SdfFrame {
    let base_frame_name = |at: Place| Name { text: base.to_string(), place: at };
    let mut poses = child_elements(node).filter(|child| child.tag_name().name() == "pose");
    let Some(found) = poses.next() else {
        return SdfFrame {
            base: base_frame_name(element_source_position(node, cx)),
            pose: NumericPose::ZERO,
            attached: None,
        };
    };
    if let Some(second) = poses.next() {
        report_duplicate(second, Some(found), cx);
    }
    check_attributes_of_value_element(found, &["relative_to", "rotation_format", "degrees", "frame"], cx);
    let base = match reference_frame_attribute(found, cx) {
        Some(said) => {
            let name = said.value().trim();
            let text = full_name_of_inner_frame(found, name, scope).unwrap_or_else(|| scope.full_name(name));
            Name { text, place: cx.source_position(said.range_value().start) }
        }
        None => base_frame_name(element_source_position(found, cx)),
    };
    let is_empty = nonblank_texts_and_own_elements(found).next().is_none();
    let pose = if is_empty { NumericPose::ZERO } else { read_pose(found, cx).unwrap_or(NumericPose::ZERO) };
    SdfFrame { base, pose, attached: None }
}

/// Returns the attribute of a `<pose>` that names its reference frame.
pub(super) fn reference_frame_attribute<'a>(pose: Node<'a>, cx: &mut Cx<'_>) -> Option<Attribute<'a>> {
    let non_blank_attribute = |word| pose.attribute_node(word).filter(|said| !said.value().trim().is_empty());
    let old = non_blank_attribute("frame");
    if let Some(found) = old.filter(|_| !is_before_version(pose, RELATIVE_TO)) {
        let at = cx.source_position(found.range().start);
        cx.report_error(&at, "`frame` of a pose has another name since version 1.7 of SDF", |d| {
            d.add_help(format!("write `relative_to=\"{}\"`", found.value().trim()))
        });
    }
    old.or_else(|| non_blank_attribute("relative_to"))
}

/// Returns the full name of the frame `name` if the link or joint around a pose declares this frame inside
/// itself, as versions 1.5 and 1.6 allow.
fn full_name_of_inner_frame(pose: Node<'_>, name: &str, scope: &Scope) -> Option<String> {
    let owner = pose.ancestors().find(|above| matches!(above.tag_name().name(), "link" | "joint"))?;
    let is_declared = frame_elements_inside(owner).any(|frame| frame.attribute("name") == Some(name));
    is_declared.then(|| {
        full_name_in_owner(
            &scope.full_name_of_declared_element(owner.attribute("name").unwrap_or_default()),
            name,
        )
    })
}

/// Returns the frames that a link or a joint declares inside itself.
pub(super) fn frame_elements_inside<'a>(owner: Node<'a>) -> impl Iterator<Item = Node<'a>> {
    let is_frame = |node: &Node<'a>| node.tag_name().name() == "frame";
    let parts = owner.children().filter(|node| node.is_element());
    let inside = parts.filter(|part| matches!(part.tag_name().name(), "inertial" | "collision" | "visual"));
    let around = std::iter::once(owner).chain(inside);
    around.flat_map(child_elements).filter(is_frame).filter(|frame| is_before_version(*frame, RELATIVE_TO))
}

/// Returns the full name of a frame that a link or a joint declares inside itself.
pub(super) fn full_name_in_owner(owner: &str, name: &str) -> String {
    format!("{owner}::{name}")
}

/// Returns the pose of an element of a link relative to the link.
pub(super) fn pose_in_link(
    node: Node<'_>,
    (link, scope): (&Name, &Scope),
    frames: &Frames,
    cx: &mut Cx<'_>,
) -> Option<NumericPose> {
    let frame = read_relative_pose(node, scope, &link.text, cx);
    Some(
        frames
            .resolve_world_pose(link, cx)?
            .inverse_pose()
            .compose_with(&frames.resolve_world_pose(&frame.base, cx)?.compose_with(&frame.pose)),
    )
}

/// Returns the pose of an element of a link relative to the link, as an [`FileOrigin`].
pub(super) fn element_origin_in_link(
    node: Node<'_>,
    link: (&Name, &Scope),
    frames: &Frames,
    cx: &mut Cx<'_>,
) -> Option<FileOrigin> {
    Some(origin_from_pose(&pose_in_link(node, link, frames, cx)?, &element_source_position(node, cx)))
}

const RADIANS: &str = "a pose is in radians: write the angle that is meant, or `<pose degrees=\"true\">`, \
                       everywhere in the file";

fn read_pose(node: Node<'_>, cx: &mut Cx<'_>) -> Option<NumericPose> {
    if node.attribute("rotation_format") == Some("quat_xyzw") {
        let [x, y, z, a, b, c, w] = read_numbers_content(node, cx)?.value;
        let size = (a * a + b * b + c * c + w * w).sqrt();
        if size < 1e-14 || !size.is_finite() {
            let message = format!("a quaternion of length {size} has no direction");
            cx.report_error(&element_source_position(node, cx), message, |d| d);
            return None;
        }
        return Some(NumericPose {
            at: [x, y, z],
            axes: rotation_of_quaternion([w, a, b, c].map(|x| x / size)),
        });
    }
    let found = read_numbers_content(node, cx)?;
    let [x, y, z, roll, pitch, yaw] = found.value;
    let degrees = node.attribute("degrees").is_some_and(|word| matches!(word.trim(), "true" | "1"));
    if !degrees {
        report_likely_degrees(&[roll, pitch, yaw], &found.place, RADIANS, cx);
    }
    let angle_in_radians = |angle: f64| if degrees { angle.to_radians() } else { angle };
    let turns = [([0.0, 0.0, 1.0], yaw), ([0.0, 1.0, 0.0], pitch), ([1.0, 0.0, 0.0], roll)];
    let axes = turns.into_iter().fold(IDENTITY, |whole, (axis, turn)| {
        matrix_product(&whole, &axis_rotation(axis, angle_in_radians(turn)))
    });
    Some(NumericPose { at: [x, y, z], axes })
}

impl Frames {
    /// Returns the link that a frame is attached to, directly or through other frames, with the source
    /// position of `name`. Reports unknown names and cycles.
    pub(super) fn link_of_frame(&self, name: &Name, cx: &mut Cx<'_>) -> Option<Name> {
        let mut at = name.clone();
        for _ in 0..MAX_DEPTH {
            if at.text == WORLD {
                return Some(Name { text: at.text, place: name.place.clone() });
            }
            let Some(frame) = self.known.get(&at.text) else {
                self.report_unknown_frame(&at, cx);
                return None;
            };
            match &frame.attached {
                Some(next) => at = next.clone(),
                None => return Some(Name { text: at.text, place: name.place.clone() }),
            }
        }
        let message = format!("the frame {} is attached to itself", quote_word(&name.text));
        cx.report_error(&at.place, message, |d| d);
        None
    }

    fn report_unknown_frame(&self, name: &Name, cx: &mut Cx<'_>) {
        let known = self.known.keys().map(String::as_str).filter(|known| !known.ends_with("__model__"));
        let message = format!("unknown frame {}", quote_word(&name.text));
        cx.report_error(&name.place, message, |d| d.suggest_name(&name.text, known));
    }

    /// Returns the pose of a frame relative to the world. Reports unknown names and cycles.
    pub(super) fn resolve_world_pose(&self, name: &Name, cx: &mut Cx<'_>) -> Option<NumericPose> {
        let mut pose = NumericPose::ZERO;
        let mut at = name.clone();
        for _ in 0..MAX_DEPTH {
            if at.text == WORLD {
                return Some(pose);
            }
            let Some(frame) = self.known.get(&at.text) else {
                self.report_unknown_frame(&at, cx);
                return None;
            };
            pose = frame.pose.compose_with(&pose);
            at = frame.base.clone();
        }
        let message = format!("the frame {} is placed relative to itself", quote_word(&name.text));
        cx.report_error(&at.place, message, |d| d);
        None
    }
}
