//! `<equality>`: joints that follow others, and loops that are closed.

use super::defaults::Element;
use super::reader::{Reader, origin};
use crate::import::context::{Cx, quote};
use crate::import::element::{Node, elements, name, place};
use crate::import::pose::{Pose, of_quaternion};
use crate::import::robot::{bare_joint, unused};
use crate::syntax::{Endpoint, GROUND, JointKind, Mimic, Name};

const LEAVE_OUT: &str = "to leave `<equality>` out, write `#[mechanism(…, mimic = independent)]`";

impl<'a> Reader<'a> {
    /// Reads all couplings.
    pub(super) fn equalities(&mut self, root: Node<'a>, cx: &mut Cx<'_>) {
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
                "connect" => self.close(&element, JointKind::Ball, cx),
                "weld" => self.close(&element, JointKind::Weld, cx),
                kind => {
                    let message = format!("the coupling `<{kind}>` is not supported");
                    cx.error(&place(node, cx), message, |d| d.help(LEAVE_OUT));
                }
            }
        }
    }

    /// `y − y₀ = a₀ + a₁ (x − x₀)`, where the zeros are the pose of the file.
    fn couple(&mut self, element: &Element<'a>, cx: &mut Cx<'_>) {
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

    /// A loop that a ball joint or a weld closes.
    fn close(&mut self, element: &Element<'a>, kind: JointKind, cx: &mut Cx<'_>) {
        let Some([first, second]) = self.ends(element, kind, cx) else { return };
        for (body, _) in [&first, &second] {
            if self.mocap.contains(&body.text) {
                let message = format!("{} is a mocap body, which nothing here moves", quote(&body.text));
                cx.error(&body.place, message, |d| d.help(LEAVE_OUT));
                return;
            }
        }
        if first.0.text == second.0.text {
            let message = format!("body {} closes a loop with itself", quote(&first.0.text));
            cx.error(&second.0.place, message, |d| d.help(LEAVE_OUT));
            return;
        }
        let number = self.robot.closing.len() + 1;
        let said = element.node.has_attribute("name").then(|| name(element.node, "name", cx)).flatten();
        let mut named = said.unwrap_or_else(|| Name {
            text: format!("{}{number}", element.node.tag_name().name()),
            place: place(element.node, cx),
        });
        named.text = unused(&named.text, |name| self.joint_names.contains(name));
        self.joint_names.insert(named.text.clone());
        let [parent, child] = [first, second].map(|(body, pose)| {
            let origin = origin(&pose, &body.place);
            Endpoint { at: origin.at(), rotated: origin.rotated(), body }
        });
        self.robot.closing.push(bare_joint(named, kind, parent, child));
    }

    /// What a loop is closed between, and where on it.
    fn ends(&self, element: &Element<'a>, kind: JointKind, cx: &mut Cx<'_>) -> Option<[(Name, Pose); 2]> {
        if element.node.has_attribute("site1") {
            let mut end = |attribute: &str| {
                let site = name(element.node, attribute, cx)?;
                let Some((body, pose)) = self.poses_of_sites.get(&site.text) else {
                    let known = self.poses_of_sites.keys().map(String::as_str);
                    let message = format!("unknown site {}", quote(&site.text));
                    cx.error(&site.place, message, |d| d.suggest(&site.text, known));
                    return None;
                };
                Some((Name { text: body.clone(), place: site.place }, *pose))
            };
            return Some([end("site1")?, end("site2")?]);
        }
        let mut end = |attribute: &str| {
            let zero = Name { text: GROUND.to_string(), place: place(element.node, cx) };
            if attribute == "body2" && !element.node.has_attribute(attribute) {
                return Some((zero, Pose::ZERO));
            }
            let mut body = name(element.node, attribute, cx)?;
            if body.text == super::body::WORLD {
                return Some((Name { text: GROUND.to_string(), ..body }, Pose::ZERO));
            }
            if body.text == GROUND {
                // It has another name here.
                let renamed = self.poses.keys().find(|known| known.starts_with("ground_link"));
                body.text = renamed.cloned().unwrap_or(body.text);
            }
            let Some(pose) = self.poses.get(&body.text) else {
                let known = self.poses.keys().map(String::as_str);
                let message = format!("unknown body {}", quote(&body.text));
                cx.error(&body.place, message, |d| d.suggest(&body.text, known));
                return None;
            };
            Some((body, *pose))
        };
        let [(first, outer), (second, inner)] = [end("body1")?, end("body2")?];
        // The first body in the axes of the second, in the pose of the file.
        let between = inner.back().then(&outer);
        let anchor = element.numbers("anchor", cx).map_or([0.0; 3], |anchor| anchor.value);
        if kind == JointKind::Ball {
            let at = Pose { at: anchor, ..Pose::ZERO };
            return Some([(first, at), (second, Pose { at: between.then(&at).at, ..Pose::ZERO })]);
        }
        let said = element.numbers::<7>("relpose", cx).map(|said| said.value);
        let pose = match said.filter(|[_, _, _, quat @ ..]| *quat != [0.0; 4]) {
            Some([x, y, z, quat @ ..]) => {
                let size = quat.iter().map(|x| x * x).sum::<f64>().sqrt();
                Pose { at: [x, y, z], axes: of_quaternion(quat.map(|x| x / size)) }
            }
            None => between.back(),
        };
        Some([(first, pose), (second, Pose::ZERO)])
    }
}
