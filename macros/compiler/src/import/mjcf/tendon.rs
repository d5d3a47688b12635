//! `<tendon>`: fixed tendons are weighted sums of coordinates, spatial tendons are lengths.

use super::defaults::{ElementWithDefaults, numbers_with_defaults};
use super::joint::{IGNORE_PASSIVE, report_unsupported_spring_yield};
use super::reader::MjcfReader;
use super::spatial::ErrorTextWithHelp;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_elements, element_source_position, quoted_tag, read_name_attribute, read_number_attribute,
    report_missing_or_misspelt_attributes,
};
use crate::import::robot::has_single_coordinate;
use crate::syntax::{FileForceElement, FileForceLaw, FileForceTarget, Name};
use std::collections::BTreeSet;

/// Tendon of an MJCF file. An unsupported spatial tendon is an error only if something acts on it.
pub(super) struct Tendon {
    pub(super) name: Name,
    path: Result<FileForceTarget, ErrorTextWithHelp>,
}

impl Tendon {
    fn find_tendon<'t>(name: &Name, tendons: &'t [Tendon], cx: &mut Cx<'_>) -> Option<&'t Tendon> {
        let found = tendons.iter().find(|known| known.name.text == name.text);
        if found.is_none() {
            let known = tendons.iter().map(|known| known.name.text.as_str());
            let message = format!("unknown tendon {}", quote_word(&name.text));
            cx.report_error(&name.place, message, |d| d.suggest_name(&name.text, known));
        }
        found
    }

    /// Returns the joints and weights of a coupled tendon. Reports a spatial tendon, for which couplings are
    /// not supported.
    pub(super) fn terms_of_tendon(
        name: &Name,
        tendons: &[Tendon],
        help: &'static str,
        cx: &mut Cx<'_>,
    ) -> Option<Vec<(Name, f64)>> {
        match &Tendon::find_tendon(name, tendons, cx)?.path {
            Ok(FileForceTarget::Sum(terms)) => Some(terms.clone()),
            _ => {
                let message = format!("tendon {} is spatial and cannot be coupled", quote_word(&name.text));
                cx.report_error(&name.place, message, |d| d.add_help(help));
                None
            }
        }
    }

    /// Returns the coordinate or length that forces on a tendon act on.
    pub(super) fn tendon_force_target(
        name: &Name,
        tendons: &[Tendon],
        help: &'static str,
        cx: &mut Cx<'_>,
    ) -> Option<FileForceTarget> {
        target_or_reported_error(&Tendon::find_tendon(name, tendons, cx)?.path, help, cx).cloned()
    }
}

/// Returns the coordinate or length that forces on a tendon act on, or reports an unsupported path.
fn target_or_reported_error<'t>(
    path: &'t Result<FileForceTarget, ErrorTextWithHelp>,
    help: &'static str,
    cx: &mut Cx<'_>,
) -> Option<&'t FileForceTarget> {
    match path {
        Ok(on) => Some(on),
        Err(refusal) => {
            cx.report_error(&refusal.place, format!("{} is not supported", refusal.message), |d| {
                d.add_help(help)
            });
            None
        }
    }
}

impl<'a> MjcfReader<'a> {
    /// Reads all tendons of an MJCF file with their springs and dampers.
    pub(super) fn read_tendons(&mut self, root: Node<'a>, cx: &mut Cx<'_>) -> Vec<Tendon> {
        let groups = child_elements(root).filter(|node| node.tag_name().name() == "tendon");
        let nodes: Vec<Node<'a>> = groups.flat_map(child_elements).collect();
        nodes.into_iter().filter_map(|node| self.read_tendon(node, cx)).collect()
    }

    fn read_tendon(&mut self, node: Node<'a>, cx: &mut Cx<'_>) -> Option<Tendon> {
        let fixed = match node.tag_name().name() {
            "fixed" => true,
            "spatial" => false,
            // Unknown elements are reported by the schema check.
            _ => return None,
        };
        let element = self.defaults.element_with_defaults(node, &["tendon"], 0, cx);
        let said = node.has_attribute("name").then(|| read_name_attribute(node, "name", cx)).flatten();
        let named = said
            .unwrap_or_else(|| Name { text: "tendon".to_string(), place: element_source_position(node, cx) });
        let (path, rest) = if fixed {
            let terms = self.read_tendon_terms(node, cx);
            let rest_coordinate_of_joint = |joint: &Name| self.rests.get(&joint.text).copied().unwrap_or(0.0);
            let rest = terms.iter().map(|(joint, weight)| weight * rest_coordinate_of_joint(joint)).sum();
            (Ok(FileForceTarget::Sum(terms)), rest)
        } else {
            let path = self.read_tendon_path(node, cx)?;
            let rest = path.as_ref().map_or(0.0, |path| path.path_length(&self.poses_with_relaxed_springs()));
            (path.map(|path| FileForceTarget::Length(path.path_length_expression())), rest)
        };
        for (limited, range, what) in
            [("limited", "range", "limits"), ("actuatorfrclimited", "actuatorfrcrange", "largest force")]
        {
            if self.read_range(&element, limited, range, cx).is_some() {
                self.left_out.push(format!("the {what} of the tendon `{}`", named.text));
            }
        }
        let mut laws = Vec::new();
        if let Some(found) = element.nonzero_attribute_number("armature", cx) {
            if found.value < 0.0 {
                cx.report_error(&found.place, format!("negative armature `{}`", found.value), |d| d);
            }
            laws.push((FileForceLaw::Inerter(found.value), "write `armature=\"0\"` into the tendon"));
        }
        if self.springs {
            report_unsupported_spring_yield(&element, cx);
            let stiffness = element.polynomial_force_coefficients("stiffness", cx);
            laws.extend(stiffness.map(|k| (read_tendon_spring(k.value, &element, rest, cx), IGNORE_PASSIVE)));
        }
        if self.dampers {
            let damping = element.polynomial_force_coefficients("damping", cx);
            laws.extend(
                damping.map(|found| (FileForceLaw::polynomial_damper_law(found.value), IGNORE_PASSIVE)),
            );
        }
        if self.friction {
            let loss = element.nonzero_attribute_number("frictionloss", cx);
            laws.extend(loss.map(|found| (FileForceLaw::Friction(found.value), IGNORE_PASSIVE)));
        }
        if let Some((_, help)) = laws.first()
            && let Some(on) = target_or_reported_error(&path, help, cx)
        {
            let tendon_force_element = |law| FileForceElement { name: named.clone(), on: on.clone(), law };
            self.robot.drives.extend(laws.iter().map(|(law, _)| tendon_force_element(law.clone())));
        }
        Some(Tendon { name: named, path })
    }

    fn read_tendon_terms(&self, node: Node<'a>, cx: &mut Cx<'_>) -> Vec<(Name, f64)> {
        let (mut terms, mut known) = (Vec::new(), BTreeSet::new());
        if child_elements(node).next().is_none() {
            let message = format!("{} without a joint", quoted_tag(node));
            cx.report_error(&element_source_position(node, cx), message, |d| {
                d.add_help("expected `<joint joint=\"…\" coef=\"…\"/>`")
            });
        }
        for child in child_elements(node) {
            report_missing_or_misspelt_attributes(child, &["joint", "coef"], &[], cx);
            let joint = read_name_attribute(child, "joint", cx)
                .filter(|joint| self.check_single_coordinate_joint(joint, "pull on", cx));
            if let Some(joint) = &joint
                && !known.insert(joint.text.clone())
            {
                let message = format!("joint {} occurs twice in one tendon", quote_word(&joint.text));
                cx.report_error(&joint.place, message, |d| d.add_help("add its two coefficients"));
            }
            let weight = read_number_attribute(child, "coef", cx).map(|weight| weight.value);
            terms.extend(joint.zip(weight).filter(|(_, weight)| *weight != 0.0));
        }
        terms
    }

    /// Returns true for a joint with exactly one coordinate; reports unknown joints and joints of other
    /// types.
    pub(super) fn check_single_coordinate_joint(&self, joint: &Name, verb: &str, cx: &mut Cx<'_>) -> bool {
        let Some(found) = self.robot.joints.iter().find(|known| known.name.text == joint.text) else {
            let known = self.robot.joints.iter().filter(|joint| has_single_coordinate(joint.kind));
            let known: Vec<&str> = known.map(|joint| joint.name.text.as_str()).collect();
            let message = format!("unknown joint {}", quote_word(&joint.text));
            cx.report_error(&joint.place, message, |d| d.suggest_name(&joint.text, known.iter().copied()));
            return false;
        };
        if !found.has_single_coordinate() {
            let message = format!(
                "joint {} is `{}`: a joint with several coordinates cannot {verb}",
                quote_word(&joint.text),
                found.word
            );
            cx.report_error(&joint.place, message, |d| d.add_help("expected a `hinge` or a `slide`"));
            return false;
        }
        true
    }
}

/// Reads the spring of a tendon. The attribute `springlength` specifies its free length or a range of free
/// lengths; −1 means that neither is specified. In this case the free length is that in the configuration in
/// which all joint springs are relaxed.
fn read_tendon_spring(
    stiffness: [f64; 3],
    element: &ElementWithDefaults<'_>,
    rest: f64,
    cx: &mut Cx<'_>,
) -> FileForceLaw {
    const NONE: f64 = -1.0;
    // A single length is the range of two equal ones, even if the defaults have two different ones.
    let found = element
        .node_with_attribute("springlength")
        .and_then(|node| numbers_with_defaults(node, "springlength", [f64::NAN; 2], cx));
    let [low, high] = found.as_ref().map_or([NONE; 2], |found| found.value);
    let high = if high.is_nan() { low } else { high };
    if let Some(found) = found.filter(|_| high < low) {
        let message = format!("`springlength` from {low} to {high}, which is below it");
        cx.report_error(&found.place, message, |d| {
            d.add_help("expected one length, or two from the smaller to the larger")
        });
    }
    match [low, high] {
        [NONE, NONE] => FileForceLaw::polynomial_spring_law(stiffness, rest),
        [low, high] if low < high => FileForceLaw::Slack { stiffness, range: [low, high] },
        [low, _] => FileForceLaw::polynomial_spring_law(stiffness, low),
    }
}
