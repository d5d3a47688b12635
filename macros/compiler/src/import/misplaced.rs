//! Detection of misplaced elements, attributes and texts in robots, links and joints. They are errors,
//! because they would be ignored silently. Elements and attributes of other tools are accepted.

use crate::diag::nearest_candidate;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{Node, child_elements, element_source_position, quoted_tag};

/// Elements and attributes of URDF, SDF and other formats that describe position, mass properties or motion.
const WORDS: [&str; 47] = [
    "armature",
    "axis",
    "axis2",
    "child",
    "cog",
    "com",
    "center_of_mass",
    "centre_of_mass",
    "damping",
    "dynamics",
    "effort",
    "friction",
    "inertia",
    "inertial",
    "ixx",
    "ixy",
    "ixz",
    "iyy",
    "iyz",
    "izz",
    "joint",
    "joint_axis",
    "limit",
    "link",
    "lower",
    "mass",
    "mimic",
    "multiplier",
    "offset",
    "orientation",
    "origin",
    "parent",
    "pos",
    "pose",
    "position",
    "quat",
    "rotation",
    "rpy",
    "screw_thread_pitch",
    "spring_reference",
    "spring_stiffness",
    "stiffness",
    "thread_pitch",
    "translation",
    "upper",
    "velocity",
    "xyz",
];

/// Reports attributes, text, and elements other than `own` in a robot, a link, a joint or a part of them, if
/// they have a meaning elsewhere in the file. Text between links is accepted as a comment.
pub(super) fn report_misplaced_contents(node: Node<'_>, own: &[&str], help: &str, cx: &mut Cx<'_>) {
    for child in child_elements(node).filter(|child| WORDS.contains(&child.tag_name().name())) {
        // Misspelt names of elements in `own` are reported by other functions.
        if nearest_candidate(child.tag_name().name(), own).is_none() && !is_element_without_effect(child) {
            let message = format!("unexpected {} in {}", quoted_tag(child), quoted_tag(node));
            cx.report_error(&element_source_position(child, cx), message, |d| d.add_help(help));
        }
    }
    // `<mimic>` names its leader by `joint`.
    let is_misplaced_word = |name: &str| WORDS.contains(&name) && name != "joint";
    for attribute in node.attributes().filter(|a| a.namespace().is_none() && is_misplaced_word(a.name())) {
        let message = format!("unknown attribute {} of {}", quote_word(attribute.name()), quoted_tag(node));
        cx.report_error(&cx.source_position(attribute.range().start), message, |d| d.add_help(help));
    }
    let is_robot = matches!(node.tag_name().name(), "robot" | "model" | "world");
    let texts = node.children().filter(|child| child.is_text() && !is_robot);
    for text in texts.filter(|text| text.text().is_some_and(|text| text.contains(char::is_alphanumeric))) {
        let words = text.text().unwrap_or_default();
        let start = text.range().start + words.len() - words.trim_start().len();
        let message = format!("unexpected text {} in {}", quote_word(words.trim()), quoted_tag(node));
        cx.report_error(&cx.source_position(start), message, |d| d.add_help(help));
    }
}

/// Returns true for an element without effect: it has no text or children, and all its attributes are zero.
fn is_element_without_effect(node: Node<'_>) -> bool {
    let is_list_of_zeros = |text: &str| text.split_whitespace().all(|word| word.parse() == Ok(0.0));
    node.attributes().all(|attribute| is_list_of_zeros(attribute.value()))
        && node.children().all(|child| child.text().is_none_or(|text| text.trim().is_empty()))
        && !node.children().any(|child| child.is_element())
}
