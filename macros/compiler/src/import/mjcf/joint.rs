//! `<joint>` and `<freejoint>` → what one degree of freedom, or a ball, or a free body does.

use super::defaults::Element;
use super::reader::Reader;
use crate::import::context::{Cx, quote};
use crate::import::element::{Node, check_attributes, name, place};
use crate::import::imported::Placed;
use crate::import::pose::{Vector, length, scale};
use crate::import::robot::{FileLimits, unused};
use crate::syntax::{Drive, DriveLaw, DriveOn, Expr, JointKind, Name};

/// MJCF's words for the joints.
const TYPES: [(&str, JointKind); 4] = [
    ("hinge", JointKind::Pin),
    ("slide", JointKind::Sleeve),
    ("ball", JointKind::Ball),
    ("free", JointKind::Free),
];

const JOINT: [&str; 30] = [
    "name",
    "class",
    "type",
    "group",
    "pos",
    "axis",
    "springdamper",
    "limited",
    "range",
    "ref",
    "springref",
    "stiffness",
    "damping",
    "armature",
    "frictionloss",
    "actuatorfrclimited",
    "actuatorfrcrange",
    "solreflimit",
    "solimplimit",
    "solreffriction",
    "solimpfriction",
    "margin",
    "user",
    "actuatorgravcomp",
    "align",
    "stiffnesspoly",
    "dampingpoly",
    "solref",
    "solimp",
    "childclass",
];

pub(super) const IGNORE_PASSIVE: &str =
    "to leave springs, damping and friction out, write `#[mechanism(…, passive = ignore)]`";

/// A joint of a body.
pub(super) struct BodyJoint {
    pub(super) name: Name,
    pub(super) kind: JointKind,
    pub(super) word: &'static str,
    /// Its place in the body.
    pub(super) anchor: Placed<Vector>,
    /// Its axis in the body, of unit length.
    pub(super) axis: Placed<Vector>,
    /// Its coordinate in the pose of the file.
    pub(super) reference: f64,
    pub(super) limits: FileLimits,
    pub(super) damping: Option<Expr>,
    pub(super) friction: Option<Expr>,
    /// Damping of a joint without a coordinate of its own.
    pub(super) spread: Option<Placed<f64>>,
}

impl<'a> Reader<'a> {
    /// Reads a joint of a body.
    pub(super) fn read_joint(
        &mut self,
        node: Node<'a>,
        body: &Name,
        class: usize,
        cx: &mut Cx<'_>,
    ) -> Option<BodyJoint> {
        let free = node.tag_name().name() == "freejoint";
        let tags: &[&str] = if free { &[] } else { &["joint"] };
        let element = self.defaults.element(node, tags, class, cx);
        self.joint(&element, free, body, cx)
    }

    fn joint(
        &mut self,
        element: &Element<'a>,
        free: bool,
        body: &Name,
        cx: &mut Cx<'_>,
    ) -> Option<BodyJoint> {
        check_attributes(element.node, &[], &JOINT, cx);
        let (word, kind) = if free { ("free", JointKind::Free) } else { read_type(element, cx)? };
        let name = self.joint_name(element.node, word, body, cx);
        let alone = matches!(kind, JointKind::Pin | JointKind::Sleeve);
        let zero = |at: &str, cx: &Cx<'_>| Placed { value: [0.0; 3], place: element.place(at, cx) };
        let anchor = element.numbers("pos", cx).unwrap_or(zero("pos", cx));
        let mut axis = element.numbers("axis", cx).unwrap_or(zero("axis", cx));
        if element.with("axis").is_none() {
            axis.value = [0.0, 0.0, 1.0];
        }
        let size = length(axis.value);
        if alone && size < 1e-14 {
            cx.error(&axis.place, "axis of zero length has no direction", |d| d);
            return None;
        }
        axis.value = scale(axis.value, if alone { 1.0 / size } else { 1.0 });
        let turns = kind == JointKind::Pin;
        let angle = |reader: &Self, value: f64| if turns { reader.settings.angle(value) } else { value };
        let value = |reader: &Self, attribute: &str, cx: &mut Cx<'_>| {
            element.number(attribute, cx).map_or(0.0, |found| angle(reader, found.value))
        };
        let reference = if alone { value(self, "ref", cx) } else { 0.0 };
        let rest = value(self, "springref", cx);
        let limits =
            if alone { self.joint_limits(element, turns, cx) } else { self.no_limits(element, &name, cx) };
        let mut joint = BodyJoint {
            name,
            kind,
            word,
            anchor,
            axis,
            reference,
            limits,
            damping: None,
            friction: None,
            spread: None,
        };
        self.rests.insert(joint.name.text.clone(), rest);
        self.armature(element, &joint, cx);
        if self.passive {
            self.spring(element, &joint, rest, cx);
            self.dissipation(element, &mut joint, cx);
        }
        Some(joint)
    }

    /// The name of a joint; one that has none is called after its body and what it is.
    fn joint_name(&mut self, node: Node<'_>, word: &str, body: &Name, cx: &mut Cx<'_>) -> Name {
        let found = node.attribute("name").and_then(|_| name(node, "name", cx));
        let name = found.unwrap_or_else(|| Name {
            text: unused(&format!("{}_{word}", body.text), |name| self.joint_names.contains(name)),
            place: place(node, cx),
        });
        self.joint_names.insert(name.text.clone());
        name
    }

    fn joint_limits(&self, element: &Element<'a>, turns: bool, cx: &mut Cx<'_>) -> FileLimits {
        let mut limits = FileLimits::default();
        if self.options.limits == crate::syntax::LimitOption::Ignore {
            return limits;
        }
        if let Some([low, high]) = self.range(element, "limited", "range", cx) {
            let placed = |end: Placed<f64>| Placed {
                value: if turns { self.settings.angle(end.value) } else { end.value },
                place: end.place,
            };
            (limits.lower, limits.upper) = (Some(placed(low)), Some(placed(high)));
        }
        if let Some([low, high]) = self.range(element, "actuatorfrclimited", "actuatorfrcrange", cx) {
            let value = low.value.abs().max(high.value.abs());
            limits.effort = Some(Placed { value, place: low.place });
        }
        limits
    }

    /// The ends of a range, if it holds.
    pub(super) fn range(
        &self,
        element: &Element<'a>,
        limited: &str,
        range: &str,
        cx: &mut Cx<'_>,
    ) -> Option<[Placed<f64>; 2]> {
        let said = element.with(limited).is_some().then(|| element.choice(limited, cx)).flatten();
        let found = element.numbers::<2>(range, cx);
        if !said.unwrap_or(self.settings.autolimits && found.is_some()) {
            return None;
        }
        let Some(Placed { value: [low, high], place }) = found else {
            let message = format!("`{limited}=\"true\"` without `{range}`");
            cx.error(&element.place(limited, cx), message, |d| d);
            return None;
        };
        if low >= high {
            let message = format!("`{range}` from {low} to {high}, which is not above it");
            cx.error(&place, message, |d| d.help(crate::import::robot::IGNORE_LIMITS));
            return None;
        }
        Some([low, high].map(|value| Placed { value, place: place.clone() }))
    }

    fn no_limits(&mut self, element: &Element<'a>, name: &Name, cx: &mut Cx<'_>) -> FileLimits {
        let ball = element.text("type") == Some("ball");
        if ball && self.range(element, "limited", "range", cx).is_some() {
            self.left_out.push(format!("the limit of the ball joint `{}`", name.text));
        }
        FileLimits::default()
    }

    fn armature(&mut self, element: &Element<'a>, joint: &BodyJoint, cx: &mut Cx<'_>) {
        let Some(armature) = element.nonzero("armature", cx) else { return };
        match joint.kind {
            JointKind::Pin | JointKind::Sleeve => {
                if armature.value < 0.0 {
                    cx.error(&armature.place, format!("negative armature `{}`", armature.value), |d| d);
                }
                self.drive(joint, DriveLaw::Inerter(armature.value));
            }
            _ => {
                let message = format!("`armature` of a `{}` joint is not supported", joint.word);
                cx.error(&armature.place, message, |d| {
                    d.help(
                        "it adds to the mass matrix what no body does: write `armature=\"0\"` into the joint",
                    )
                });
            }
        }
    }

    fn spring(&mut self, element: &Element<'a>, joint: &BodyJoint, rest: f64, cx: &mut Cx<'_>) {
        if let Some(pair) = element.numbers::<2>("springdamper", cx).filter(|pair| pair.value != [0.0; 2]) {
            let message = "`springdamper` is not supported";
            cx.error(&pair.place, message, |d| {
                d.help("write `stiffness` and `damping`").help(IGNORE_PASSIVE)
            });
        }
        for which in ["stiffnesspoly", "dampingpoly"] {
            let found = element.some(which, [0.0; 2], cx).filter(|found| found.value != [0.0; 2]);
            if let Some(found) = found {
                let message = format!("`{which}` is not supported");
                cx.error(&found.place, message, |d| d.help(IGNORE_PASSIVE));
            }
        }
        let Some(stiffness) = element.nonzero("stiffness", cx) else { return };
        match joint.kind {
            JointKind::Pin | JointKind::Sleeve => {
                self.drive(joint, DriveLaw::Spring { stiffness: stiffness.value, free: rest });
            }
            _ => {
                let message = format!("`stiffness` of a `{}` joint is not supported", joint.word);
                cx.error(&stiffness.place, message, |d| d.help(IGNORE_PASSIVE));
            }
        }
    }

    fn dissipation(&mut self, element: &Element<'a>, joint: &mut BodyJoint, cx: &mut Cx<'_>) {
        for which in ["damping", "frictionloss"] {
            if which == "frictionloss" && !self.settings.friction {
                continue;
            }
            let Some(found) = element.nonzero(which, cx) else { continue };
            if found.value < 0.0 {
                let message = format!("negative {which} `{}`", found.value);
                cx.error(&found.place, message, |d| d.help(IGNORE_PASSIVE));
            }
            let value = || Some(Expr::number(found.value, &found.place));
            match (joint.kind, which) {
                (JointKind::Pin | JointKind::Sleeve, "damping") => joint.damping = value(),
                (JointKind::Pin | JointKind::Sleeve, _) => joint.friction = value(),
                (_, "damping") => joint.spread = Some(found),
                _ => {
                    let message = format!("`{which}` of a `{}` joint is not supported", joint.word);
                    cx.error(&found.place, message, |d| d.help(IGNORE_PASSIVE));
                }
            }
        }
    }

    fn drive(&mut self, joint: &BodyJoint, law: DriveLaw) {
        let on = DriveOn::Sum(vec![(joint.name.clone(), 1.0)]);
        self.robot.drives.push(Drive { name: joint.name.clone(), on, law });
    }
}

/// True for elements that are joints.
pub(super) fn is_joint(node: Node<'_>) -> bool {
    matches!(node.tag_name().name(), "joint" | "freejoint")
}

fn read_type(element: &Element<'_>, cx: &mut Cx<'_>) -> Option<(&'static str, JointKind)> {
    let word = element.text("type").unwrap_or("hinge");
    let known = TYPES.iter().find(|(known, _)| *known == word);
    if known.is_none() {
        let message = format!("unknown joint type {}", quote(word));
        cx.error(&element.place("type", cx), message, |d| d.suggest(word, TYPES.map(|(word, _)| word)));
    }
    known.copied()
}
