//! `<tendon>`: fixed ones are weighted sums of coordinates. Those through space are left out where they only show or limit.

use super::joint::IGNORE_PASSIVE;
use super::reader::Reader;
use crate::import::context::{Cx, quote};
use crate::import::element::{Node, check_attributes, elements, name, number, place, tag};
use crate::import::robot::has_coordinate;
use crate::syntax::{Drive, DriveLaw, Name};

/// A weighted sum of coordinates; nothing of a tendon through space.
pub(super) struct Tendon {
    pub(super) name: Name,
    pub(super) terms: Option<Vec<(Name, f64)>>,
}

impl Tendon {
    /// The joints, with their weights, of a tendon that something `does` things to: none of those through space.
    pub(super) fn terms_of(
        name: &Name,
        tendons: &[Tendon],
        (does, help): (&str, &str),
        cx: &mut Cx<'_>,
    ) -> Option<Vec<(Name, f64)>> {
        let Some(found) = tendons.iter().find(|known| known.name.text == name.text) else {
            let known = tendons.iter().map(|known| known.name.text.as_str());
            let message = format!("unknown tendon {}", quote(&name.text));
            cx.error(&name.place, message, |d| d.suggest(&name.text, known));
            return None;
        };
        if found.terms.is_none() {
            let message = format!("tendon {} goes through space, where none is {does}", quote(&name.text));
            cx.error(&name.place, message, |d| d.help(help));
        }
        found.terms.clone()
    }
}

impl<'a> Reader<'a> {
    /// Reads all tendons, with their springs and dampers.
    pub(super) fn tendons(&mut self, root: Node<'a>, cx: &mut Cx<'_>) -> Vec<Tendon> {
        let groups = elements(root).filter(|node| node.tag_name().name() == "tendon");
        let nodes: Vec<Node<'a>> = groups.flat_map(elements).collect();
        nodes.into_iter().filter_map(|node| self.tendon(node, cx)).collect()
    }

    fn tendon(&mut self, node: Node<'a>, cx: &mut Cx<'_>) -> Option<Tendon> {
        let fixed = match node.tag_name().name() {
            "fixed" => true,
            "spatial" => false,
            _ => {
                cx.error(&place(node, cx), format!("unknown element {}", tag(node)), |d| {
                    d.help("tendons are `<fixed>` or `<spatial>`")
                });
                return None;
            }
        };
        let element = self.defaults.element(node, &["tendon"], 0, cx);
        let said = node.has_attribute("name").then(|| name(node, "name", cx)).flatten();
        let named = said.unwrap_or_else(|| Name { text: "tendon".to_string(), place: place(node, cx) });
        let terms = fixed.then(|| self.terms(node, cx));
        for (limited, range, what) in
            [("limited", "range", "limits"), ("actuatorfrclimited", "actuatorfrcrange", "largest force")]
        {
            if self.range(&element, limited, range, cx).is_some() {
                self.left_out.push(format!("the {what} of the tendon `{}`", named.text));
            }
        }
        if let Some(found) = element.nonzero("armature", cx) {
            match &terms {
                Some(terms) => self.on_tendon(&named, terms, DriveLaw::Inerter(found.value)),
                None => {
                    let message = "`armature` of a tendon through space is not supported";
                    cx.error(&found.place, message, |d| d);
                }
            }
        }
        if !self.passive {
            return Some(Tendon { name: named, terms });
        }
        for which in ["stiffness", "damping", "frictionloss"] {
            if which == "frictionloss" && !self.settings.friction {
                continue;
            }
            let Some(found) = element.nonzero(which, cx) else { continue };
            let Some(terms) = &terms else {
                let message = format!("`{which}` of a tendon through space is not supported");
                cx.error(&found.place, message, |d| d.help(IGNORE_PASSIVE));
                continue;
            };
            let law = match which {
                "stiffness" => {
                    let Some(free) = self.rest(&element, terms, cx) else { continue };
                    DriveLaw::Spring { stiffness: found.value, free }
                }
                "damping" => DriveLaw::Damper(found.value),
                _ => DriveLaw::Friction(found.value),
            };
            self.on_tendon(&named, terms, law);
        }
        Some(Tendon { name: named, terms })
    }

    fn on_tendon(&mut self, name: &Name, terms: &[(Name, f64)], law: DriveLaw) {
        self.robot.drives.push(Drive { name: name.clone(), terms: terms.to_vec(), law });
    }

    /// Length at which the spring of a tendon is free: as it says, or while all joints stand where their own springs are free.
    fn rest(
        &self,
        element: &super::defaults::Element<'a>,
        terms: &[(Name, f64)],
        cx: &mut Cx<'_>,
    ) -> Option<f64> {
        let [low, high] =
            element.some("springlength", [f64::NAN; 2], cx).map_or([-1.0; 2], |found| found.value);
        let high = if high.is_nan() { low } else { high };
        if low != high {
            let message = "`springlength` with a range is not supported";
            cx.error(&element.place("springlength", cx), message, |d| d.help(IGNORE_PASSIVE));
            return None;
        }
        let at = |joint: &Name| self.rests.get(&joint.text).copied().unwrap_or(0.0);
        Some(if low < 0.0 { terms.iter().map(|(joint, weight)| weight * at(joint)).sum() } else { low })
    }

    fn terms(&self, node: Node<'a>, cx: &mut Cx<'_>) -> Vec<(Name, f64)> {
        let mut terms = Vec::new();
        for child in elements(node) {
            check_attributes(child, &["joint", "coef"], &[], cx);
            let joint = name(child, "joint", cx).filter(|joint| self.check_joint(joint, "pull on", cx));
            let weight = number(child, "coef", cx).map(|weight| weight.value);
            terms.extend(joint.zip(weight).filter(|(_, weight)| *weight != 0.0));
        }
        terms
    }

    /// True for a joint with one coordinate; reports others.
    pub(super) fn check_joint(&self, joint: &Name, verb: &str, cx: &mut Cx<'_>) -> bool {
        let Some(found) = self.robot.joints.iter().find(|known| known.name.text == joint.text) else {
            let known = self.robot.joints.iter().filter(|joint| has_coordinate(joint.kind));
            let known: Vec<&str> = known.map(|joint| joint.name.text.as_str()).collect();
            let message = format!("unknown joint {}", quote(&joint.text));
            cx.error(&joint.place, message, |d| d.suggest(&joint.text, known.iter().copied()));
            return false;
        };
        if !found.has_coordinate() {
            let message = format!(
                "joint {} is `{}`: what can {verb} it has one coordinate",
                quote(&joint.text),
                found.word
            );
            cx.error(&joint.place, message, |d| d.help("expected a `hinge` or a `slide`"));
            return false;
        }
        true
    }
}
