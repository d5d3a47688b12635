//! `<equality>`: joints that follow others, and loops that are closed.

use super::reader::Reader;
use super::tendon::Tendon;
use crate::import::context::{Cx, quote};
use crate::import::element::{Node, elements, name, place};
use crate::syntax::{Mimic, Name};

const LEAVE_OUT: &str = "to leave `<equality>` out, write `#[mechanism(…, mimic = independent)]`";

impl<'a> Reader<'a> {
    /// Reads all couplings.
    pub(super) fn equalities(&mut self, root: Node<'a>, _: &[Tendon], cx: &mut Cx<'_>) {
        let groups = elements(root).filter(|node| node.tag_name().name() == "equality");
        let nodes: Vec<Node<'a>> = groups.flat_map(elements).collect();
        if !self.options.follow_mimic || !self.settings.equality {
            if !nodes.is_empty() {
                self.left_out.push(format!("{} couplings (`<equality>`)", nodes.len()));
            }
            return;
        }
        for node in nodes {
            let element = self.defaults.element(node, &["equality", node.tag_name().name()], 0, cx);
            if element.choice("active", cx) == Some(false) {
                self.count("couplings that are not active", 1);
                continue;
            }
            match node.tag_name().name() {
                "joint" => self.couple(&element, cx),
                kind => {
                    let message = format!("the coupling `<{kind}>` is not supported");
                    cx.error(&place(node, cx), message, |d| d.help(LEAVE_OUT));
                }
            }
        }
    }

    /// `y − y₀ = a₀ + a₁ (x − x₀)`, where the zeros are the pose of the file.
    fn couple(&mut self, element: &super::defaults::Element<'a>, cx: &mut Cx<'_>) {
        let Some(first) =
            name(element.node, "joint1", cx).filter(|joint| self.check_joint(joint, "follow", cx))
        else {
            return;
        };
        let second = element.node.has_attribute("joint2").then(|| name(element.node, "joint2", cx)).flatten();
        if second.as_ref().is_some_and(|joint| !self.check_joint(joint, "be followed by", cx)) {
            return;
        }
        let polynomial = element.some("polycoef", [0.0, 1.0, 0.0, 0.0, 0.0], cx);
        let [a0, a1, a2, a3, a4] = polynomial.map_or([0.0, 1.0, 0.0, 0.0, 0.0], |found| {
            // What is not written is zero, but for the default as a whole.
            found.value
        });
        if second.is_some() && [a2, a3, a4] != [0.0; 3] {
            let message = "a coupling that is not linear is not supported";
            cx.error(&element.place("polycoef", cx), message, |d| d.help(LEAVE_OUT));
            return;
        }
        let at = |joint: &Name| self.references.get(&joint.text).copied().unwrap_or(0.0);
        let offset = at(&first) + a0 - second.as_ref().map_or(0.0, |joint| a1 * at(joint));
        let Some(joint) = self.robot.joints.iter_mut().find(|joint| joint.name.text == first.text) else {
            return;
        };
        if joint.mimic.is_some() || joint.held.is_some() {
            let message = format!("joint {} follows two joints", quote(&first.text));
            cx.error(&first.place, message, |d| d.help(LEAVE_OUT));
            return;
        }
        match second {
            Some(second) => joint.mimic = Some(Mimic { joint: second, multiplier: a1, offset }),
            None => joint.held = Some(offset),
        }
    }
}
